//! Jobs of the service on printers: what is printed, who may be talked to, and what a restart does.

use std::sync::atomic::{AtomicU64, Ordering};

use serde_json::{Value, json};

use crate::serving::{Folder as Data, JSON, MODEL, Server, wait_until};
use crate::support::{Folder, LETTER, Printer, Proxy, Rules};

/// Asks for a print.
fn print(server: &Server, job: &str, request: &Value) -> crate::serving::Answer {
    server.ask("POST", &format!("{job}/print"), &[("content-type", JSON)], request.to_string().as_bytes())
}

/// How a print is, when it has come to one of these states.
#[track_caller]
fn comes_to(server: &Server, job: &str, states: &[&str]) -> Value {
    let mut print = Value::Null;
    wait_until(&format!("the print is one of {states:?}"), || {
        print = server.get(&format!("{job}/print")).ok(200).json();
        states.contains(&print["state"].as_str().unwrap())
    });
    print
}

const ENDS: [&str; 3] = ["printed", "failed", "cancelled"];

#[test]
fn a_job_is_printed_as_fill_makes_it() {
    let Some(printer) = Printer::start("image/png,image/x-portable-bitmap", "sleep 1") else { return };
    let (folder, data) = (Folder::new(), Data::new());
    let server = Server::start(&data.data(), &["--printer", &printer.uri()]);
    assert_eq!(server.get("/v1/printers").ok(200).json(), json!({ "printers": [{ "uri": printer.uri() }] }));
    let job = server.job("?format=rls&expr=a", LETTER);
    server.get(&format!("{job}/print")).problem(404, "no-print");

    let accepted = print(&server, &job, &json!({ "format": "pbm" })).ok(202);
    assert_eq!((accepted.header("location"), &accepted.json()["state"]), (format!("{job}/print").as_str(), &json!("waiting")));
    print(&server, &job, &json!({})).problem(409, "printing");
    let ended = comes_to(&server, &job, &ENDS);
    assert_eq!(
        (&ended["state"], &ended["error"], &ended["job"]),
        (&json!("printed"), &Value::Null, &json!(format!("{}/1", printer.uri())))
    );
    assert!(ended["choice"].as_str().unwrap().contains("pbm at 600 dpi on na_letter_8.5x11in"), "{ended}");
    assert_eq!(server.get(&job).json()["print"], ended, "the job tells it too");
    assert!(printer.documents() == [folder.fill("page.json --expr a --dpi 600 --format pbm")]);
    assert_eq!(printer.jobs(), [(1, "completed".to_owned())]);

    // Forgotten, and printed again.
    server.ask("DELETE", &format!("{job}/print"), &[], b"").ok(204);
    server.get(&format!("{job}/print")).problem(404, "no-print");
    print(&server, &job, &json!({ "printer": printer.uri() })).ok(202);
    assert_eq!(comes_to(&server, &job, &ENDS)["state"], "printed");
    assert_eq!(printer.documents().len(), 2);
}

#[test]
fn only_printers_that_were_named_are_talked_to() {
    let data = Data::new();
    let server = Server::start(&data.data(), &[]);
    let job = server.job("", LETTER);
    print(&server, &job, &json!({ "printer": "ipp://127.0.0.1:9/ipp/print" })).problem(403, "printer-not-allowed");
    print(&server, &job, &json!({})).problem(403, "printer-not-allowed");
    drop(server);
    let server = Server::start(
        &data.data(),
        &["--printer", "ipp://127.0.0.1:1/ipp/print", "--printer", "ipp://127.0.0.1:2/ipp/print", "--print-wait", "0.2"],
    );
    for other in
        ["ipp://127.0.0.1:9/ipp/print", "ipp://127.0.0.1:1/ipp/other", "http://127.0.0.1:8080/ipp/print", "ipp://localhost:1/ipp/print"]
    {
        let told = print(&server, &job, &json!({ "printer": other })).problem(403, "printer-not-allowed");
        assert!(told["detail"].as_str().unwrap().contains("--printer"), "{told}");
    }
    print(&server, &job, &json!({})).problem(400, "malformed");
    for (body, says) in [
        (json!({ "printer": "file:///etc/passwd" }), "printer"),
        (json!({ "copies": 0 }), "copies"),
        (json!({ "scaling": "zoom" }), "scaling"),
        (json!({ "colour": true }), "colour"),
        (json!([]), "body"),
        (json!({ "format": "nothing" }), "nothing"),
    ] {
        let told = print(&server, &job, &body).problem(400, "malformed");
        assert!(told["detail"].as_str().unwrap().contains(says), "{told}");
    }
    let model = server.job("?kind=solid", MODEL);
    print(&server, &model, &json!({ "printer": "ipp://127.0.0.1:1/ipp/print" })).problem(422, "not-a-drawing");
    print(&server, "/v1/jobs/none", &json!({})).problem(404, "no-job");
    server.ask("POST", &format!("{job}/print"), &[("content-type", "text/plain")], b"{}").problem(415, "unsupported-media-type");

    // Nobody listens there: it says so, and the job can be printed again.
    print(&server, &job, &json!({ "printer": "ipp://127.0.0.1:1/ipp/print" })).ok(202);
    let failed = comes_to(&server, &job, &ENDS);
    assert!(failed["state"] == "failed" && failed["error"].as_str().unwrap().contains("cannot be reached"), "{failed}");
    print(&server, &job, &json!({ "printer": "ipp://127.0.0.1:2/ipp/print" })).ok(202);
}

#[test]
fn a_print_outlives_the_service() {
    let Some(printer) = Printer::start("image/x-portable-bitmap", "sleep 3") else { return };
    let data = Data::new();
    let options = ["--printer", &printer.uri()];
    let server = Server::start(&data.data(), &options);
    let job = server.job("", LETTER);
    print(&server, &job, &json!({})).ok(202);
    comes_to(&server, &job, &["printing"]);
    server.kill();
    let server = Server::start(&data.data(), &options);
    assert_eq!(comes_to(&server, &job, &ENDS)["state"], "printed");
    assert_eq!((printer.documents().len(), printer.jobs()), (1, vec![(1, "completed".to_owned())]), "once");
}

#[test]
fn a_document_that_a_kill_cuts_off_is_not_sent_again() {
    let Some(printer) = Printer::start("image/x-portable-bitmap", "sleep 4") else { return };
    let data = Data::new();
    // Some 160 KiB a second: the document of 4 MiB takes half a minute.
    let proxy = Proxy::start(printer.port, Rules { slow: AtomicU64::new(100), ..Rules::default() });
    let options = ["--printer", &proxy.uri()];
    let server = Server::start(&data.data(), &options);
    let job = server.job("", LETTER);
    print(&server, &job, &json!({})).ok(202);
    wait_until("a part was sent", || server.get(&format!("{job}/print")).json()["sent"].as_u64().unwrap() > 100_000);
    server.kill();
    // What the system still held of it is lost too.
    proxy.rules.cut.store(1, Ordering::Relaxed);
    std::thread::sleep(std::time::Duration::from_millis(500));
    proxy.rules.cut.store(0, Ordering::Relaxed);
    proxy.rules.slow.store(0, Ordering::Relaxed);
    let server = Server::start(&data.data(), &options);
    let failed = comes_to(&server, &job, &ENDS);
    assert!(failed["state"] == "failed" && failed["error"].as_str().unwrap().contains("interrupted"), "{failed}");
    assert!(printer.ended().iter().all(|state| state != "completed") && printer.jobs().len() == 1, "{:?}", printer.jobs());
}

#[test]
fn a_service_that_is_asked_to_end_sends_what_it_has_begun() {
    let Some(printer) = Printer::start("image/x-portable-bitmap", "true") else { return };
    let data = Data::new();
    let proxy = Proxy::start(printer.port, Rules { slow: AtomicU64::new(10), ..Rules::default() });
    let options = ["--printer", &proxy.uri()];
    let mut server = Server::start(&data.data(), &options);
    let job = server.job("", LETTER);
    print(&server, &job, &json!({})).ok(202);
    wait_until("a part was sent", || server.get(&format!("{job}/print")).json()["sent"].as_u64().unwrap() > 100_000);
    server.signal("TERM");
    let mut status = None;
    wait_until("the service has ended", || {
        status = server.ended();
        status.is_some()
    });
    assert!(status.unwrap().success(), "{status:?}");
    let server = Server::start(&data.data(), &options);
    assert_eq!(comes_to(&server, &job, &ENDS)["state"], "printed");
    assert_eq!((printer.documents().len(), printer.jobs().len()), (1, 1));
}

#[test]
fn a_print_is_cancelled_at_the_printer() {
    let Some(printer) = Printer::start("image/x-portable-bitmap", "sleep 3") else { return };
    let data = Data::new();
    let server = Server::start(&data.data(), &["--printer", &printer.uri()]);
    for by_job in [false, true] {
        let job = server.job("", LETTER);
        print(&server, &job, &json!({})).ok(202);
        comes_to(&server, &job, &["printing"]);
        if by_job {
            server.ask("DELETE", &job, &[], b"").ok(204);
        } else {
            server.ask("DELETE", &format!("{job}/print"), &[], b"").ok(202);
            let cancelled = comes_to(&server, &job, &ENDS);
            assert_eq!(cancelled["state"], "cancelled", "{cancelled}");
        }
        wait_until("the printer has ended it", || printer.jobs().last().is_some_and(|(_, state)| state == "canceled"));
    }
    assert_eq!(printer.ended(), ["canceled", "canceled"]);
}
