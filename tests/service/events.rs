//! How a job gets on, as its followers are told.

use std::io::{BufRead, BufReader, Read};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::support::{Folder, SCENE, Server, header, triangle};

/// The jobs that a stream of events tells of.
fn follow(server: &Server, job: &str) -> impl Iterator<Item = Value> {
    let response = server.open("GET", &format!("{job}/events"), &[], b"");
    assert_eq!((response.status().as_u16(), header(response.headers(), "content-type")), (200, "text/event-stream"));
    let lines = BufReader::new(response.into_body().into_reader()).lines();
    lines
        .map(|line| line.expect("the stream ends well"))
        .filter_map(|line| Some(serde_json::from_str(line.strip_prefix("data:")?).unwrap()))
}

/// The states that events tell of, each once.
fn states(events: &[Value]) -> Vec<&str> {
    let mut states: Vec<_> = events.iter().map(|job| job["state"].as_str().unwrap()).collect();
    states.dedup();
    states
}

#[test]
fn from_ready_to_done() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let job = server.job("?format=pbm", triangle(20_000, 40_000));
    let mut events = follow(&server, &job);
    let mut told = vec![events.next().unwrap()];
    assert_eq!(told[0]["state"], "ready");
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut body = server.open("GET", &format!("{job}/raster"), &[], b"").into_body().into_reader();
            // Held until the events have told of it.
            std::io::copy(&mut Read::by_ref(&mut body).take(1 << 20), &mut std::io::sink()).unwrap();
            std::thread::sleep(Duration::from_millis(700));
            std::io::copy(&mut body, &mut std::io::sink()).unwrap();
        });
        let began = Instant::now();
        told.extend(events);
        assert!((told.len() as f64) < 3.0 + began.elapsed().as_secs_f64() * 5.0, "{} events", told.len());
    });
    assert_eq!(states(&told), ["ready", "reading", "done"]);
    let delivered: Vec<_> = told.iter().map(|job| job["lines_delivered"].as_u64().unwrap()).collect();
    assert!(delivered.is_sorted() && delivered.last() == Some(&40_000), "{delivered:?}");
    let last = told.last().unwrap();
    assert_eq!(last["bytes"], 100_000_000 + "P4\n20000 40000\n".len() as u64);
    assert!(last["finished"].is_string());
    // Of a job that is done there is one event.
    assert_eq!(follow(&server, &job).count(), 1);
}

#[test]
fn deleted_while_it_is_followed() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--max-events", "2"]);
    let job = server.job("", SCENE);
    let (mut events, other) = (follow(&server, &job), follow(&server, &job));
    assert_eq!(events.next().unwrap()["state"], "ready");
    let full = server.get(&format!("{job}/events"));
    full.problem(503, "busy");
    assert_ne!(full.header("retry-after"), "");
    server.ask("DELETE", &job, &[], b"").ok(204);
    let told: Vec<_> = events.collect();
    assert_eq!(states(&told).last(), Some(&"cancelled"));
    assert_eq!(states(&other.collect::<Vec<_>>()).last(), Some(&"cancelled"));
    server.get(&job).problem(404, "no-job");
    server.ask("DELETE", &job, &[], b"").problem(404, "no-job");
    let job = server.job("", SCENE);
    drop(follow(&server, &job));
    // Places of those that have gone are free.
    crate::support::wait_until("the places are free", || server.open("GET", &format!("{job}/events"), &[], b"").status() == 200);
}

#[test]
fn a_reader_that_breaks_off_leaves_it_ready() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let job = server.job("?format=pbm", triangle(20_000, 40_000));
    let mut body = server.open("GET", &format!("{job}/raster"), &[], b"").into_body().into_reader();
    body.read_exact(&mut [0; 1000]).unwrap();
    assert_eq!(server.get(&job).json()["state"], "reading");
    drop(body);
    crate::support::wait_until("it is ready again", || server.get(&job).json()["state"] == "ready");
    let view = server.get(&job).json();
    let states: Vec<_> = view["history"].as_array().unwrap().iter().map(|change| change["state"].as_str().unwrap()).collect();
    assert_eq!(states, ["ready", "reading", "ready"]);
    for change in view["history"].as_array().unwrap() {
        assert!(change["at"].as_str().unwrap().ends_with('Z'));
    }
}
