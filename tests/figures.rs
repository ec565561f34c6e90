//! The figures that the program promises, measured on the binary: memory, first bytes, counted lines.
//!
//! `RUNSET_RELEASE` names the binary to measure; without it the one that cargo built for the tests is taken, which is slower.

use std::io::Read;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

fn binary() -> PathBuf {
    std::env::var_os("RUNSET_RELEASE").map_or_else(|| env!("CARGO_BIN_EXE_runset").into(), PathBuf::from)
}

fn poster() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("examples/art/poster.svg")
}

/// What came out of a run.
struct Run {
    bytes: u64,
    /// Largest resident set seen, in KiB. It is read before every read of the pipe.
    peak_kib: u64,
    first: Duration,
    whole: Duration,
    stats: serde_json::Value,
}

/// Runs the program, reading its standard output to the end and its peak memory on the way.
fn run(arguments: &[&str]) -> Run {
    let started = Instant::now();
    let mut child = Command::new(binary())
        .arg("fill")
        .arg(poster())
        .args(arguments)
        .args(["--stats", "--progress", "never"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary runs");
    let mut out = child.stdout.take().expect("piped");
    let status = format!("/proc/{}/status", child.id());
    let (mut bytes, mut peak_kib, mut first) = (0, 0, None);
    let mut buffer = vec![0; 1 << 20];
    loop {
        let resident = std::fs::read_to_string(&status).unwrap_or_default();
        let peak = resident.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB")?.parse().ok());
        peak_kib = peak_kib.max(peak.unwrap_or(0));
        match out.read(&mut buffer).expect("the pipe is read") {
            0 => break,
            n => bytes += n as u64,
        }
        first.get_or_insert_with(|| started.elapsed());
    }
    let whole = started.elapsed();
    let mut messages = String::new();
    child.stderr.take().expect("piped").read_to_string(&mut messages).expect("text");
    assert!(child.wait().expect("it ends").success(), "{messages}");
    let stats = messages.lines().rev().find_map(|line| serde_json::from_str(line).ok()).expect("statistics");
    Run { bytes, peak_kib, first: first.expect("something was written"), whole, stats }
}

/// The expression of the README.
const PLATE: &str = "art & frame - logo";

#[test]
fn a0_at_2400_dpi_streams_in_64_mib() {
    for expression in [&["--expr", PLATE][..], &[]] {
        let large = run(&[&["--dpi", "2400", "--format", "pbm"], expression].concat());
        println!("A0 at 2400 dpi, {expression:?}: {} KiB, first bytes after {:?} of {:?}", large.peak_kib, large.first, large.whole);
        let (width, height) = (79_465u64, 112_346u64);
        assert_eq!(large.bytes, format!("P4\n{width} {height}\n").len() as u64 + width.div_ceil(8) * height);
        assert!(large.peak_kib > 1000 && large.peak_kib <= 64 << 10, "{} KiB", large.peak_kib);
        // A busy machine delays the start of a process by more than the program takes to its first bytes: one quiet run of five shows it.
        let arguments = [&["--dpi", "2400", "--format", "pbm"], expression].concat();
        let early = |run: &Run| run.first < run.whole / 10;
        assert!(early(&large) || (0..4).any(|_| early(&run(&arguments))), "first bytes after {:?} of {:?}", large.first, large.whole);

        let small = run(&[&["--dpi", "600", "--format", "pbm"], expression].concat());
        let counted = |run: &Run| run.stats["lines_counted"].as_u64().expect("a number");
        println!("lines counted: {} at 600 dpi, {} at 2400 dpi", counted(&small), counted(&large));
        assert!(counted(&large) <= 2 * counted(&small), "{} at 2400 dpi, {} at 600", counted(&large), counted(&small));
    }
}
