//! What the command line promises of printing.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use crate::support::{Folder, Printer, ran, wait_until};

#[test]
fn a_printer_gets_what_fill_makes() {
    let Some(printer) = Printer::start("image/png,image/x-portable-bitmap", "true") else { return };
    let folder = Folder::new();
    let mut expected = Vec::new();
    for (args, fill) in [
        ("", "--format png"),
        ("--format pbm", "--format pbm"),
        ("--format pbm --spool --threads 1", "--format pbm"),
        ("--format pbm --expr a&b", "--format pbm --expr a&b"),
    ] {
        let ran = folder.run(&format!("print page.json --to {} {args}", printer.uri()));
        ran.printed();
        expected.push(folder.fill(&format!("page.json --dpi 600 {fill}")));
        assert_eq!(ran.stdout, format!("{}/{}\n", printer.uri(), expected.len()), "the job's address");
    }
    assert!(printer.documents() == expected, "documents differ");
    assert_eq!(printer.jobs(), (1..=4).map(|id| (id, "completed".to_owned())).collect::<Vec<_>>());
}

#[test]
fn the_choice_is_told_and_a_dry_run_sends_nothing() {
    let Some(printer) = Printer::start("image/png,image/x-portable-bitmap", "true") else { return };
    let folder = Folder::new();
    let ran = folder.run(&format!("print page.json --to {} --dry-run --copies 2", printer.uri()));
    assert_eq!((ran.status, ran.stdout.as_str()), (Some(0), ""), "{ran:?}");
    let line = ran.stderr.lines().next().unwrap();
    for what in [
        "png at 600 dpi on na_letter_8.5x11in, scaling none",
        "png is the best of pbm, png",
        "finest of 600",
        "of the drawing's size, and ready",
        "does not reach the edge",
        "at most 1 copies",
    ] {
        assert!(line.contains(what), "{what}: {line}");
    }
    assert!(
        ran.stderr.contains("5100 x 6600 px") && ran.stderr.contains("media=na_letter_8.5x11in") && ran.stderr.contains("nothing was sent"),
        "{ran:?}"
    );
    assert!(printer.jobs().is_empty());

    // Legal is larger than the page, and its margins are a quarter of an inch: 14 x 25.4 mm less twice 6.35.
    let ran = folder.run(&format!("print page.json --to {} --dry-run --media legal --print-scaling fit", printer.uri()));
    assert!(ran.stderr.contains("na_legal_8.5x14in, scaling fit") && ran.stderr.contains("5100 x 8400 px"), "{ran:?}");
    // 8 inches of width for 816 units: 4800 / 816 px.
    assert!(ran.stderr.contains("5.8824 px to a user unit"), "{ran:?}");
}

#[test]
fn pages_of_a_document_and_copies_within_it() {
    let folder = Folder::new();
    for (name, side) in [("a", 300), ("b", 500)] {
        let square = format!(
            r#"{{ "width": 816, "height": 1056, "shapes": {{ "s": {{ "rings": [[[0, 0], [{side}, 0], [{side}, {side}], [0, {side}]]] }} }}, "expr": "s" }}"#
        );
        std::fs::write(folder.path(&format!("{name}.json")), square).unwrap();
    }
    for (format, media_type) in [("pwg", "image/pwg-raster"), ("urf", "image/urf"), ("pcl", "application/vnd.hp-PCL")] {
        let Some(printer) = Printer::start(media_type, "true") else { return };
        let ran = folder.run(&format!("print a.json b.json --copies 2 --to {}", printer.uri()));
        ran.printed();
        assert!(ran.stderr.contains(&format!("{format} at 600 dpi")), "{ran:?}");
        let expected = folder.fill(&format!("a.json b.json a.json b.json --dpi 600 --format {format}"));
        assert!(printer.documents() == [expected], "{format}: one document of four pages");
        assert_eq!(printer.jobs().len(), 1);
    }
}

#[test]
fn pages_and_copies_that_a_printer_does_not_make_are_jobs_of_their_own() {
    let Some(printer) = Printer::start("image/x-portable-bitmap", "true") else { return };
    let folder = Folder::new();
    for (name, side) in [("a", 100), ("b", 200), ("c", 300)] {
        let square = format!(
            r#"{{ "width": 816, "height": 1056, "shapes": {{ "s": {{ "rings": [[[0, 0], [{side}, 0], [{side}, {side}], [0, {side}]]] }} }}, "expr": "s" }}"#
        );
        std::fs::write(folder.path(&format!("{name}.json")), square).unwrap();
    }
    let ran = folder.run(&format!("print a.json b.json c.json --pages 3,1 --copies 2 --to {}", printer.uri()));
    ran.printed();
    let page = |name: &str| folder.fill(&format!("{name}.json --dpi 600 --format pbm"));
    assert!(printer.documents() == ["c", "a", "c", "a"].map(page), "c and a, twice");
    folder.run(&format!("print a.json --pages 2 --to {}", printer.uri())).failed(2, &["there is no page 2: 1 files are given"]);
}

#[test]
fn what_the_printer_cannot_is_refused_before_anything_is_sent() {
    let Some(printer) = Printer::start("image/png", "true") else { return };
    let folder = Folder::new();
    let print = |args: &str| folder.run(&format!("print page.json --to {} {args}", printer.uri()));
    // By the printer itself, because of ipp-attribute-fidelity.
    print("--media iso_a0_841x1189mm").failed(1, &["it refuses the job", "client-error", "media=iso_a0_841x1189mm"]);
    print("--media a1").failed(2, &["no medium is called \"a1\"", "na_letter_8.5x11in", "see runset print --help"]);
    print("--dpi 1200").failed(2, &["no 1200 dpi", "it has 600"]);
    print("--expr nothing").failed(1, &["--expr:1:1: unknown name"]);
    folder.run("print page.json").failed(2, &["no printer is remembered"]);
    folder.run("print page.json --to ipps://localhost/").failed(2, &["ipps"]);
    folder.run("print page.json --to http://user:secret@localhost/").failed(2, &["not sent"]);
    assert!(printer.documents().is_empty());
}

#[test]
fn a_printer_that_gives_a_job_up_is_believed() {
    let Some(printer) = Printer::start("image/png", "echo 'STATE: +marker-supply-empty-error' >&2; exit 1") else { return };
    let folder = Folder::new();
    folder.run(&format!("print page.json --to {}", printer.uri())).failed(1, &["gave up", "aborted"]);
    assert_eq!(printer.ended(), ["aborted"]);
}

#[test]
fn jobs_are_cancelled_at_the_printer() {
    let Some(printer) = Printer::start("image/png", "sleep 3") else { return };
    let folder = Folder::new();
    for by_signal in [true, false] {
        let mut child = folder.runset(&format!("print page.json --to {}", printer.uri())).spawn().unwrap();
        let mut uri = String::new();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        out.read_line(&mut uri).unwrap();
        wait_until("it prints", || printer.jobs().last().is_some_and(|(_, state)| state == "processing"));
        if by_signal {
            assert!(Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap().success());
        } else {
            let cancelled = folder.run(&format!("print --cancel {}", uri.trim()));
            assert_eq!((cancelled.status, cancelled.stderr.as_str()), (Some(0), ""));
        }
        let ran = ran(child);
        if by_signal {
            assert_eq!(ran.status, None, "it died of the signal: {ran:?}");
            assert!(ran.stderr.contains("cancelled"), "{ran:?}");
        } else {
            ran.failed(1, &["somebody cancelled the job 2"]);
        }
        printer.ended();
    }
    assert_eq!(printer.ended(), ["canceled", "canceled"]);
    let ran = folder.run(&format!("print --cancel {}/99", printer.uri()));
    ran.failed(1, &["it does not cancel the job", "not-found"]);
}

#[test]
fn a_printer_is_remembered_and_found() {
    let Some(printer) = Printer::start("image/png,image/x-portable-bitmap", "true") else { return };
    let folder = Folder::new();
    folder.run(&format!("print page.json --to {} --remember --dry-run", printer.uri()));
    folder.run("print page.json").printed();
    let ran = folder.run(&format!("printers --probe 127.0.0.1:{}", printer.port));
    assert_eq!(ran.status, Some(0), "{ran:?}");
    let row: Vec<&str> = ran.stdout.lines().nth(1).unwrap().split("  ").map(str::trim).filter(|cell| !cell.is_empty()).collect();
    assert_eq!(row[..4], [&format!("{} *", printer.uri()), "virtual", "pbm png", "600"]);
    folder.run("printers --forget");
    folder.run("print page.json").failed(2, &["no printer is remembered"]);

    // Nobody listens at this port.
    let none = folder.run("printers --probe 127.0.0.1:1");
    assert_eq!((none.status, none.stderr.lines().count()), (Some(1), 2), "{none:?}");
    let quiet = folder.run("printers --time 0.2");
    assert!(quiet.status == Some(0) || quiet.stderr.contains("no printer within 0.2 s") && quiet.status == Some(1), "{quiet:?}");
}

#[test]
fn standard_input_is_a_page() {
    let Some(printer) = Printer::start("image/x-portable-bitmap", "true") else { return };
    let folder = Folder::new();
    let file = std::fs::File::open(folder.path("page.json")).unwrap();
    let child = folder.runset(&format!("print - --to {}", printer.uri())).stdin(Stdio::from(file)).spawn().unwrap();
    ran(child).printed();
    assert!(printer.documents() == [folder.fill("page.json --dpi 600 --format pbm")]);
}

#[test]
fn a_drawing_that_is_wrong_makes_no_job() {
    let Some(printer) = Printer::start("image/png", "true") else { return };
    let folder = Folder::new();
    std::fs::write(folder.path("bad.json"), "{").unwrap();
    folder.run(&format!("print bad.json --to {}", printer.uri())).failed(1, &["bad.json:1:"]);
    assert!(printer.jobs().is_empty());
}

#[test]
fn what_the_network_tells_of_is_listed() {
    let Some(printer) = Printer::start("image/png,image/x-portable-bitmap", "true") else { return };
    // Told by this process, as a printer tells it (RFC 6763), with the addresses of this machine.
    let daemon = mdns_sd::ServiceDaemon::new().unwrap();
    let told = [("rp", "ipp/print"), ("pdl", "image/png"), ("note", "")];
    let service = mdns_sd::ServiceInfo::new("_ipp._tcp.local.", "runset test", "runset-test.local.", "", printer.port, &told[..]);
    daemon.register(service.unwrap().enable_addr_auto()).unwrap();
    let folder = Folder::new();
    let ran = folder.run("printers --time 5");
    let row = ran.stdout.lines().find(|line| line.contains(&format!(":{}/ipp/print", printer.port)));
    assert!(row.is_some_and(|row| row.contains("virtual") && row.contains("pbm png") && row.contains("600")), "{ran:?}");
    let _ = daemon.shutdown();
}
