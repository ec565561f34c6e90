//! Answers that are no IPP: one line, status 1, in bounded time and memory.

use std::time::{Duration, Instant};

use crate::support::{Folder, answering};

fn http(length: Option<usize>, kind: &str, body: &[u8]) -> Vec<u8> {
    let length = length.map_or(String::new(), |length| format!("Content-Length: {length}\r\n"));
    let mut answer = format!("HTTP/1.1 200 OK\r\nContent-Type: {kind}\r\n{length}Connection: close\r\n\r\n").into_bytes();
    answer.extend(body);
    answer
}

#[test]
fn answers_that_are_none_are_one_line() {
    let folder = Folder::new();
    let ipp = "application/ipp";
    let deep = [&[1, 1, 0, 0, 0, 0, 0, 1, 4, 0x34, 0, 1, b'a', 0, 0][..], &[0x34, 0, 0, 0, 0].repeat(100_000), &[3]].concat();
    let huge = vec![0x44; 5 << 20];
    let cases: [(&str, Vec<u8>, usize, &[&str]); 13] = [
        ("nothing", Vec::new(), 1, &["broke"]),
        ("no HTTP", b"220 ready\r\n".to_vec(), 1, &["broke"]),
        ("endless, no HTTP", vec![b'x'; 65536], 1000, &["broke"]),
        ("a page", http(Some(4), "text/html", b"<p>x"), 1, &["this is no printer", "text/html"]),
        ("not found", b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n".to_vec(), 1, &["no printer at this path", "404"]),
        ("password", b"HTTP/1.1 401 Unauthorized\r\nContent-Length: 0\r\n\r\n".to_vec(), 1, &["password", "401"]),
        ("empty", http(Some(0), ipp, b""), 1, &["is no IPP", "breaks off at byte 0"]),
        ("cut in the head", http(Some(5), ipp, &[1, 1, 0, 0, 0]), 1, &["is no IPP", "breaks off"]),
        ("cut within its length", http(Some(500), ipp, &[1, 1, 0, 0, 0, 0, 0, 1, 4]), 1, &["broke"]),
        ("garbage", http(None, ipp, &[0xa5; 3000]), 1, &["is no IPP"]),
        ("deep", http(Some(deep.len()), ipp, &deep), 1, &["16 collections"]),
        ("huge", http(Some(huge.len()), ipp, &huge), 1, &["longer than 4194304 bytes"]),
        ("endless", http(None, ipp, &[0x44; 65536]), 10_000, &["longer than 4194304 bytes"]),
    ];
    for (name, answer, times, says) in cases {
        let addr = answering(answer, times);
        let began = Instant::now();
        let ran = folder.run(&format!("print page.json --to ipp://{addr}/ipp/print --wait 0.1"));
        ran.failed(1, says);
        let lines = ran.stderr.lines().count();
        assert!(lines <= 2, "{name}: one line, and one that it waits: {ran:?}");
        assert!(began.elapsed() < Duration::from_secs(10), "{name}: {:?}", began.elapsed());
    }
}

#[test]
fn a_printer_that_can_nothing_is_told_so() {
    let folder = Folder::new();
    let nothing = [1, 1, 0, 0, 0, 0, 0, 1, 1, 4, 3];
    let addr = answering(http(Some(nothing.len()), "application/ipp", &nothing), 1);
    folder.run(&format!("print page.json --to ipp://{addr}/ipp/print")).failed(1, &["takes no format that can be written"]);
    let refused = [1, 1, 5, 7, 0, 0, 0, 1, 1, 3];
    let addr = answering(http(Some(refused.len()), "application/ipp", &refused), 1);
    folder.run(&format!("print page.json --to ipp://{addr}/ipp/print --wait 0.1")).failed(1, &["server-error-busy"]);
}
