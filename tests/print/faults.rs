//! Printers that are busy, go away, come back, or lose the connection: no job is lost without a word, none is printed twice.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use crate::support::{Folder, Printer, Proxy, Rules, ran, wait_until};

#[test]
fn a_busy_printer_is_asked_again_before_anything_is_sent() {
    let Some(printer) = Printer::start("image/x-portable-bitmap", "sleep 2") else { return };
    let folder = Folder::new();
    let print = || folder.runset(&format!("print page.json --to {}", printer.uri())).spawn().unwrap();
    let runs = [print(), print(), print()].map(ran);
    runs.iter().for_each(|ran| ran.printed());
    assert!(runs.iter().any(|ran| ran.stderr.contains("server-error-busy") && ran.stderr.contains("waiting")), "{runs:?}");
    let page = folder.fill("page.json --dpi 600 --format pbm");
    assert!(printer.documents() == [page.clone(), page.clone(), page], "each once");

    let first = print();
    wait_until("the printer prints", || printer.jobs().last().is_some_and(|(id, state)| *id == 4 && state == "processing"));
    let second = folder.run(&format!("print page.json --to {} --wait 0.3", printer.uri()));
    second.failed(1, &["server-error-busy", "--wait says for how long"]);
    ran(first).printed();
    assert_eq!(printer.documents().len(), 4);
}

#[test]
fn a_document_that_is_cut_off_is_cancelled_and_never_called_printed() {
    let folder = Folder::new();
    let cut = || Rules { cut: AtomicU64::new(1 << 20), ..Rules::default() };
    // A printer that takes some time for what it has: there is something to cancel.
    let Some(printer) = Printer::start("image/x-portable-bitmap", "sleep 2") else { return };
    for spool in ["", "--spool"] {
        let proxy = Proxy::start(printer.port, cut());
        let ran = folder.run(&format!("print page.json --to {} {spool}", proxy.uri()));
        ran.failed(1, &["broke after", "the job"]);
    }
    let states = printer.ended();
    assert!(states.len() == 2 && states.iter().all(|state| state != "completed"), "{states:?}");
    // The printer is as it was: the next job is printed.
    folder.run(&format!("print page.json --to {}", printer.uri())).printed();

    // This one takes the end of a connection for the end of a document, and is done at once.
    let Some(printer) = Printer::start("image/x-portable-bitmap", "true") else { return };
    let proxy = Proxy::start(printer.port, cut());
    let ran = folder.run(&format!("print page.json --to {}", proxy.uri()));
    ran.failed(1, &["broke after", "the job 1"]);
    assert_eq!(printer.jobs().len(), 1);
}

#[test]
fn an_answer_that_is_lost_behind_the_whole_document_is_no_success() {
    let Some(printer) = Printer::start("image/x-portable-bitmap", "true") else { return };
    let folder = Folder::new();
    let proxy = Proxy::start(printer.port, Rules { mute: AtomicBool::new(true), ..Rules::default() });
    let ran = folder.run(&format!("print page.json --to {}", proxy.uri()));
    ran.failed(1, &["the job 1"]);
    assert_eq!(printer.documents().len(), 1, "sent once");
    assert_eq!(printer.jobs().len(), 1);
}

#[test]
fn a_printer_that_is_away_is_waited_for() {
    let Some(printer) = Printer::start("image/x-portable-bitmap", "sleep 3") else { return };
    let folder = Folder::new();
    let proxy = Proxy::start(printer.port, Rules { gone: AtomicBool::new(true), ..Rules::default() });
    let child = folder.runset(&format!("print page.json --to {}", proxy.uri())).spawn().unwrap();
    std::thread::sleep(Duration::from_secs(1));
    proxy.rules.gone.store(false, Ordering::Relaxed);
    // And again while it prints.
    wait_until("the printer prints", || printer.jobs().last().is_some_and(|(_, state)| state == "processing"));
    proxy.rules.gone.store(true, Ordering::Relaxed);
    std::thread::sleep(Duration::from_secs(1));
    proxy.rules.gone.store(false, Ordering::Relaxed);
    let ran = ran(child);
    ran.printed();
    assert!(ran.stderr.contains("broke") || ran.stderr.contains("cannot be reached"), "it says so: {ran:?}");
    assert!(printer.documents() == [folder.fill("page.json --dpi 600 --format pbm")], "once");

    let lost = folder.run("print page.json --to ipp://127.0.0.1:1/ --wait 0.3");
    lost.failed(1, &["ipp://127.0.0.1:1/", "cannot be reached", "refused"]);
}

#[test]
fn a_printer_that_goes_away_for_good_leaves_no_claim() {
    let Some(printer) = Printer::start("image/x-portable-bitmap", "sleep 3") else { return };
    let folder = Folder::new();
    let proxy = Proxy::start(printer.port, Rules::default());
    let child = folder.runset(&format!("print page.json --to {} --wait 0.5", proxy.uri())).spawn().unwrap();
    wait_until("the printer prints", || printer.jobs().last().is_some_and(|(_, state)| state == "processing"));
    std::thread::sleep(Duration::from_millis(700));
    proxy.rules.gone.store(true, Ordering::Relaxed);
    ran(child).failed(1, &["it has the whole document", "whether the job 1 is printed is not known"]);
}

#[test]
fn a_printer_without_chunks_gets_the_length() {
    let Some(printer) = Printer::start("image/x-portable-bitmap", "true") else { return };
    let folder = Folder::new();
    let proxy = Proxy::start(printer.port, Rules { no_chunks: AtomicBool::new(true), ..Rules::default() });
    folder.run(&format!("print page.json --to {}", proxy.uri())).printed();
    assert!(printer.documents() == [folder.fill("page.json --dpi 600 --format pbm")]);
    assert_eq!(printer.jobs().len(), 1);
}
