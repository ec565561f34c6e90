//! Readers that go, and rasters that break.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use crate::support::{Folder, JSON, Server, empty, ending, triangle, wait_until, wait_within};
use crate::{alone, slower};

/// Two tangles side by side: what they have in common is nothing, but that has to be found out on every line.
fn silent(height: u32) -> String {
    let tangle = |left: u32| {
        let bar = |i: u32| {
            let (top, bottom) = (left + i * 7 % 401, left + i * 11 % 401);
            format!("[[{top},0],[{},0],[{},{height}],[{bottom},{height}]]", top + 3, bottom + 3)
        };
        (0..200).map(bar).collect::<Vec<_>>().join(",")
    };
    let (a, b) = (tangle(0), tangle(500));
    format!(
        r#"{{ "width": 1000, "height": {height}, "expr": "a & b", "shapes": {{ "a": {{ "rings": [{a}] }}, "b": {{ "rings": [{b}] }} }} }}"#
    )
}

/// Sends a document to be filled.
fn filled(server: &Server, query: &str, document: &str) -> TcpStream {
    let mut stream = server.connect(1 << 16);
    let length = document.len();
    write!(
        stream,
        "POST /v1/fill{query} HTTP/1.1\r\nHost: localhost\r\nContent-Type: {JSON}\r\nContent-Length: {length}\r\n\r\n{document}"
    )
    .unwrap();
    stream
}

#[test]
fn who_leaves_frees_the_stream_at_once() {
    let _alone = alone();
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let tall = 8_388_608;
    let cases = [
        ("pbm, many bytes", "?format=pbm", triangle(65_536, tall)),
        ("png, few bytes", "?format=png", triangle(65_536, tall)),
        ("png, next to none", "?format=png", empty(1_048_576, tall / 8)),
        ("ndjson of nothing", "?format=ndjson", empty(1_048_576, tall)),
        ("rls of nothing", "?format=rls", empty(1_048_576, tall)),
        ("ndjson of much work for nothing", "?format=ndjson", silent(tall)),
        ("tiff, in its first pass", "?format=tiff", triangle(65_536, tall)),
        ("ndjson of lines that differ", "?format=ndjson", triangle(65_536, tall)),
    ];
    for (name, query, document) in &cases {
        let mut stream = filled(&server, query, document);
        stream.read_exact(&mut [0; 200]).unwrap();
        let reading = server.metric("runset_streams", "");
        drop(stream);
        let time = wait_within(slower() * Duration::from_secs(1), name, || server.metric("runset_streams", "") == 0.0);
        eprintln!("{name}: {reading} before, gone after {time:?}");
    }
    let raster = server.job("?format=ndjson", triangle(65_536, tall)) + "/raster";
    let mut stream = server.asked(1 << 16, &raster);
    stream.read_exact(&mut [0; 200]).unwrap();
    drop(stream);
    wait_within(slower() * Duration::from_secs(1), "a job's reader", || server.metric("runset_streams", "") == 0.0);
    wait_until("bands are not made any more", || server.metric("runset_queue", "bands") == 0.0);
}

/// Whether an answer ends as a whole one does.
fn is_whole(answer: &str) -> bool {
    let (head, body) = answer.split_once("\r\n\r\n").expect("a head");
    let length = head.lines().find_map(|line| line.to_ascii_lowercase().strip_prefix("content-length: ")?.parse::<usize>().ok());
    length.map_or_else(|| body.ends_with("0\r\n\r\n"), |length| body.len() == length)
}

#[test]
fn what_fails_behind_the_first_byte_breaks() {
    let _alone = alone();
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let whole = ending({
        let mut stream = server.connect(1 << 16);
        let path = server.job("?format=ndjson", empty(5, 5)) + "/raster";
        write!(stream, "GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n").unwrap();
        stream
    });
    assert!(is_whole(&whole) && whole.contains("\"end\":true"), "{whole}");
    // A job that is deleted while it is read: a length that is not met, chunks without an end.
    for format in ["pbm", "ndjson"] {
        let job = server.job(&format!("?format={format}"), triangle(65_536, 100_000));
        let stream = server.asked(1 << 14, &format!("{job}/raster"));
        wait_until("it is read", || server.get(&job).json()["lines_delivered"].as_u64().unwrap() > 0);
        server.ask("DELETE", &job, &[], b"").ok(204);
        let cut = ending(stream);
        assert!(cut.starts_with("HTTP/1.1 200 OK") && !is_whole(&cut), "{format}: {} bytes", cut.len());
    }
    assert_eq!(server.metric("runset_ends_total", "failed"), 2.0);
    // A client that is not ours takes it for an error as well.
    let job = server.job("?format=ndjson", triangle(65_536, 100_000));
    let mut body = server.open("GET", &format!("{job}/raster"), &[], b"").into_body().into_reader();
    body.read_exact(&mut [0; 1000]).unwrap();
    server.ask("DELETE", &job, &[], b"").ok(204);
    body.read_to_end(&mut Vec::new()).unwrap_err();
    // More processor time than is allowed.
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--max-render", "0.05"]);
    for format in ["ndjson", "png", "pbm"] {
        let cut = ending(filled(&server, &format!("?format={format}"), &triangle(16_384, 8_000_000)));
        assert!(cut.starts_with("HTTP/1.1 200 OK") && !is_whole(&cut), "{format}: {} bytes", cut.len());
    }
    assert_eq!(server.metric("runset_ends_total", "limit"), 3.0);
    // And a job whose length cannot be measured within it has failed.
    let job = server.job("?format=png", triangle(16_384, 2_000_000));
    wait_until("it has failed", || server.get(&job).json()["state"] == "failed");
    server.get(&format!("{job}/raster")).problem(410, "failed");
}
