//! What reading a map costs: 600,000 vertices in about 10 MB.
//!
//! Measured on the binary that `RUNSET_RELEASE` names; without it the figures of cargo's own are printed and not judged.

#![allow(clippy::unwrap_used)] // all of this is tests

use std::fmt::Write;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};

/// CPU seconds of the children that have been waited for.
fn children() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
    let fields: Vec<&str> = stat.rsplit_once(')').unwrap().1.split_whitespace().collect();
    // Fields 16 and 17 of proc(5), in ticks of 1/100 s, counted here from the third.
    (fields[13].parse::<f64>().unwrap() + fields[14].parse::<f64>().unwrap()) / 100.0
}

/// Closed lines around the cells of a grid, wandering, 200 vertices each, as coast lines and parcels are written.
fn map(vertices: usize) -> String {
    let mut text = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 10000 10000\" width=\"1000mm\" height=\"1000mm\">\n<g id=\"map\">\n",
    );
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 24)
    };
    for cell in 0..vertices / 200 {
        let centre = [(cell % 60) as f64 * 166.0 + 80.0, (cell / 60) as f64 * 166.0 + 80.0];
        write!(text, "<path id=\"area{cell}\" fill=\"#{:02x}{:02x}40\" d=\"", cell % 7 * 36, cell % 5 * 50).unwrap();
        for k in 0..200 {
            let (sin, cos) = (f64::from(k) / 200.0 * std::f64::consts::TAU).sin_cos();
            let radius = 60.0 + 40.0 * random();
            write!(text, "{}{:.3},{:.3} ", if k == 0 { "M" } else { "L" }, centre[0] + radius * cos, centre[1] + radius * sin).unwrap();
        }
        text.push_str("Z\"/>\n");
    }
    text + "</g>\n</svg>\n"
}

#[test]
fn a_map_is_read_in_a_second_and_a_few_times_its_size() {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("map.svg");
    let text = map(600_000);
    std::fs::write(&file, &text).unwrap();
    let release = std::env::var_os("RUNSET_RELEASE");
    let binary = release.clone().unwrap_or_else(|| env!("CARGO_BIN_EXE_runset").into());
    let before = children();
    let mut child = Command::new(binary).args(["info", "--json"]).arg(&file).stdout(Stdio::piped()).spawn().unwrap();
    // The answer is larger than a pipe holds: when its first byte is here, the program waits with everything in memory.
    let (mut out, mut answer) = (child.stdout.take().unwrap(), vec![0]);
    out.read_exact(&mut answer).unwrap();
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
    let mib = |name: &str| {
        let line = status.lines().find_map(|l| l.strip_prefix(name)?.trim().strip_suffix(" kB")).unwrap();
        line.parse::<f64>().unwrap() / 1024.0
    };
    // The program itself and its libraries, which the system maps from files as it likes, are no cost of the document.
    let (peak, code) = (mib("VmHWM:"), mib("RssFile:"));
    out.read_to_end(&mut answer).unwrap();
    assert!(child.wait().unwrap().success() && answer.len() > 1 << 17);
    let seconds = children() - before;
    let size = text.len() as f64 / f64::from(1 << 20);
    println!(
        "600,000 vertices in {size:.1} MiB: {seconds:.2} s of CPU time, {peak:.1} MiB at most, {:.2} times the file, {:.2} without the program's {code:.1} MiB",
        peak / size,
        (peak - code) / size
    );
    let info: serde_json::Value = serde_json::from_slice(&answer).unwrap();
    assert_eq!((info["ids"].as_array().unwrap().len(), info["ids"][0]["edges"].as_u64().unwrap()), (3001, 600_000));
    if release.is_some() {
        assert!(seconds < 1.0, "{seconds} s");
        assert!(peak - code <= 2.3 * size, "{peak} MiB, of which {code} MiB are the program, for {size} MiB");
    }
}
