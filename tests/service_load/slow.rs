//! Readers that take little, and those that take nothing any more.

use std::io::{ErrorKind, Read};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use rustix::process::{Resource, getrlimit, setrlimit};

use crate::support::{Folder, JSON, SCENE, Server, effort, triangle, wait_until, wait_within};
use crate::{alone, slower};

/// So little room that what a slow reader takes is acknowledged within a second or two.
const SMALL: usize = 2304;

/// Takes at most so many bytes; tells whether the connection still stands.
fn take(stream: &mut TcpStream, bytes: usize) -> (usize, bool) {
    let mut part = vec![0; bytes];
    match stream.read(&mut part) {
        Ok(0) => (0, false),
        Ok(n) => (n, true),
        Err(error) => (0, error.kind() == ErrorKind::WouldBlock),
    }
}

#[test]
fn a_thousand_slow_readers_and_a_quick_one() {
    let _alone = alone();
    let readers = effort(100).min(1000) as usize;
    let mut files = getrlimit(Resource::Nofile);
    files.current = files.maximum.map(|most| most.min(4096)).or(Some(4096));
    setrlimit(Resource::Nofile, files).unwrap();
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--log", "warn"]);
    // Pages of 4.3 gigapixel: a triangle's lines all differ. The lengths of most are being measured meanwhile.
    let jobs: Vec<String> =
        ["pbm", "png", "ndjson", "rls", "pgm", "ppm"].map(|f| server.job(&format!("?format={f}"), triangle(65_536, 65_536))).into();
    let mut streams: Vec<TcpStream> = (0..readers).map(|i| server.asked(SMALL, &format!("{}/raster", jobs[i % jobs.len()]))).collect();
    streams.iter().for_each(|stream| stream.set_nonblocking(true).unwrap());
    wait_until("all are being read", || server.metric("runset_streams", "") == readers as f64);
    let (stop, taken) = (AtomicBool::new(false), AtomicU64::new(0));
    let mut times = Vec::new();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            // A sixteenth of them every sixteenth of a second: 1 KiB/s each.
            let share = streams.len().div_ceil(16);
            let mut turns = (0..16).cycle();
            while !stop.load(Ordering::Relaxed) {
                let began = Instant::now();
                for stream in streams.iter_mut().skip(turns.next().unwrap() * share).take(share) {
                    let (n, stands) = take(stream, 1024);
                    assert!(stands, "a slow reader was cut");
                    taken.fetch_add(n as u64, Ordering::Relaxed);
                }
                std::thread::sleep(Duration::from_millis(62).saturating_sub(began.elapsed()));
            }
        });
        for i in 0..200 {
            let began = Instant::now();
            let document = SCENE.replace("16", &(16 + i % 50).to_string());
            let mut body = server.open("POST", "/v1/fill", &[("content-type", JSON)], document.as_bytes()).into_body().into_reader();
            body.read_exact(&mut [0; 40]).unwrap();
            times.push(began.elapsed());
            std::thread::sleep(Duration::from_millis(30));
        }
        stop.store(true, Ordering::Relaxed);
    });
    times.sort();
    let (p50, p99, peak) = (times[times.len() / 2], times[times.len() * 99 / 100 - 1], server.status("VmHWM"));
    eprintln!(
        "{readers} slow readers: {peak} KiB at most, {} threads, first line p50 {p50:?}, p99 {p99:?}, {} bytes taken",
        server.status("Threads"),
        taken.load(Ordering::Relaxed)
    );
    assert!(peak < 256 << 10, "{peak} KiB");
    assert!(p99 < slower() * Duration::from_millis(250), "{p99:?}");
    assert_eq!(server.metric("runset_streams", ""), readers as f64, "all of them are still there");
    assert!(taken.load(Ordering::Relaxed) as usize > readers * 4096);
    drop(streams);
    wait_within(slower() * Duration::from_secs(2), "all streams have ended", || server.metric("runset_streams", "") == 0.0);
    assert_eq!(server.metric("runset_ends_total", "left"), readers as f64);
}

#[test]
fn a_reader_that_has_stalled_is_told_from_one_that_is_slow() {
    let _alone = alone();
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--stall-timeout", "3"]);
    let raster = server.job("?format=pbm", triangle(65_536, 65_536)) + "/raster";
    let [mut slow, mut stalled] = [(); 2].map(|()| server.asked(SMALL, &raster));
    slow.set_nonblocking(true).unwrap();
    assert!(take(&mut stalled, 500).1);
    let began = Instant::now();
    let mut gone = None;
    while began.elapsed() < Duration::from_secs(14) {
        assert!(take(&mut slow, 1024 / 4).1, "1 KiB/s was cut after {:?}", began.elapsed());
        if gone.is_none() && server.metric("runset_ends_total", "stalled") == 1.0 {
            gone = Some(began.elapsed());
            assert_eq!(server.metric("runset_streams", ""), 1.0, "its stream has gone with it");
        }
        std::thread::sleep(Duration::from_millis(250));
    }
    let gone = gone.expect("the stalled reader is dropped");
    eprintln!("a stalled reader was dropped after {gone:?}, of 3 s");
    assert!(gone > Duration::from_millis(2900) && gone < Duration::from_secs(8), "{gone:?}");
    assert_eq!((server.metric("runset_ends_total", "stalled"), server.metric("runset_ends_total", "left")), (1.0, 0.0));
    drop(slow);
    wait_until("the other has left", || server.metric("runset_ends_total", "left") == 1.0);
    assert_eq!((server.metric("runset_streams", ""), server.metric("runset_connections_ended_total", "stalled")), (0.0, 1.0));
}

#[test]
fn the_last_bytes_wait_for_a_slow_reader_too() {
    let _alone = alone();
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--idle-timeout", "1"]);
    // The service has done its part at once; what is left stands in buffers.
    let raster = server.job("?format=pbm", triangle(1000, 1600)) + "/raster";
    let mut slow = server.asked(SMALL, &raster);
    let (mut all, mut part) = (Vec::new(), [0; 1200]);
    loop {
        match slow.read(&mut part) {
            Ok(0) => break,
            Ok(n) => all.extend_from_slice(&part[..n]),
            Err(error) => panic!("{error} behind {} bytes", all.len()),
        }
        // About 30 KB/s: seconds for the whole.
        std::thread::sleep(Duration::from_millis(40));
    }
    let body = all.windows(4).position(|at| at == b"\r\n\r\n").unwrap() + 4;
    assert_eq!(all.len() - body, 125 * 1600 + "P4\n1000 1600\n".len());
}
