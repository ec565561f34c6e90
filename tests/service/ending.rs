//! How the service ends, and when it does not begin.

use std::io::Read;
use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::support::{Folder, RUNSET, Server, command, ids, triangle, wait_until, wait_within};

/// Waits until it ends, and gives its status.
fn end(server: &mut Server, time: Duration) -> Option<i32> {
    let mut status = None;
    wait_within(time, "the service ends", || {
        status = server.ended();
        status.is_some()
    });
    status.unwrap().code()
}

#[test]
fn a_reader_is_waited_for() {
    let folder = Folder::new();
    let mut server = Server::start(&folder.data(), &[]);
    let job = server.job("?format=pbm", triangle(8000, 40_000));
    let mut body = server.open("GET", &format!("{job}/raster"), &[], b"").into_body().into_reader();
    body.read_exact(&mut [0; 1000]).unwrap();
    server.signal("TERM");
    wait_until("nobody is accepted any more", || std::net::TcpStream::connect(server.addr).is_err());
    assert!(server.ended().is_none());
    let mut rest = Vec::new();
    body.read_to_end(&mut rest).unwrap();
    assert_eq!(rest.len(), 40_000_000 + "P4\n8000 40000\n".len() - 1000);
    assert_eq!(end(&mut server, Duration::from_secs(10)), Some(0));
    let server = Server::start(&folder.data(), &[]);
    let view = server.get(&job).json();
    assert_eq!((&view["state"], &view["lines_delivered"]), (&"done".into(), &40_000.into()), "what was known is stored");
}

#[test]
fn a_reader_that_does_not_come_to_an_end_is_cut() {
    let folder = Folder::new();
    let mut server = Server::start(&folder.data(), &["--grace", "1"]);
    let [pbm, png] = ["pbm", "png"].map(|format| server.job(&format!("?format={format}"), triangle(60_000, 500_000)));
    let stalled = [&pbm, &png].map(|job| server.asked(4096, &format!("{job}/raster")));
    // Others that hold a connection: idle, within a head, followers of events.
    let idle = server.connect(4096);
    let mut events = server.open("GET", &format!("{png}/events"), &[], b"").into_body().into_reader();
    let mut lines = 0;
    wait_until("lines go out", || {
        lines = server.get(&pbm).json()["lines_delivered"].as_u64().unwrap();
        lines > 0
    });
    let began = Instant::now();
    server.signal("TERM");
    assert_eq!(end(&mut server, Duration::from_secs(8)), Some(0));
    assert!(began.elapsed() > Duration::from_millis(900), "{:?}", began.elapsed());
    let _ = events.read_to_end(&mut Vec::new());
    drop((stalled, idle));
    let server = Server::start(&folder.data(), &[]);
    let view = server.get(&pbm).json();
    assert_eq!(view["state"], "ready");
    assert!(view["lines_delivered"].as_u64().unwrap() >= lines);
}

#[test]
fn the_second_signal_ends_it_at_once() {
    let folder = Folder::new();
    let mut server = Server::start(&folder.data(), &["--grace", "100"]);
    let job = server.job("?format=pbm", triangle(60_000, 500_000));
    let _stalled = server.asked(4096, &format!("{job}/raster"));
    wait_until("it is read", || server.get(&job).json()["state"] == "reading");
    server.signal("TERM");
    wait_until("it is about to end", || std::net::TcpStream::connect(server.addr).is_err());
    server.signal("TERM");
    assert_eq!(end(&mut server, Duration::from_secs(2)), Some(143));
    let server = Server::start(&folder.data(), &[]);
    assert_eq!(ids(&server).len(), 1);
}

#[test]
fn it_ends_at_once_when_nobody_reads() {
    let folder = Folder::new();
    let mut server = Server::start(&folder.data(), &[]);
    // Its length is being measured, for many seconds.
    server.job("?format=png", triangle(60_000, 5_000_000));
    let _idle = server.connect(4096);
    server.signal("INT");
    assert_eq!(end(&mut server, Duration::from_secs(3)), Some(0));
    let said = server.said();
    assert!(!said.contains("\"ERROR\""), "{said}");
    assert_eq!(ids(&Server::start(&folder.data(), &[])).len(), 1);
}

#[test]
fn one_service_a_folder_and_a_port() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let refused = |mut command: std::process::Command, what: &str| {
        let output = command.stderr(Stdio::piped()).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), said.lines().count()), (Some(1), 1), "{said}");
        assert!(said.contains(what), "{said}");
    };
    refused(command(&folder.data(), &[]), "another service uses this folder");
    let other = Folder::new();
    let mut taken = std::process::Command::new(RUNSET);
    taken.args(["serve", "--addr", &server.addr.to_string(), "--data"]).arg(other.data());
    refused(taken, &format!("{}: cannot listen", server.addr));
    std::fs::write(other.data(), "a file").unwrap();
    refused(command(&other.data(), &[]), other.data().to_str().unwrap());
    std::fs::remove_file(other.data()).unwrap();
    std::fs::create_dir(other.data()).unwrap();
    std::fs::write(other.data().join("jobs.sqlite"), "no database".repeat(100)).unwrap();
    refused(command(&other.data(), &[]), other.data().to_str().unwrap());
    // What it had is still its own.
    server.job("", crate::support::SCENE);
}
