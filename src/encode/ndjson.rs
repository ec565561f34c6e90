//! A line stream as JSON texts, one a line: a header, records of equal lines, an end record with counts and checksum.
//!
//! ```text
//! {"runset":1,"width":16,"height":3,"from":0,"to":3,"inks":["#000000"]}
//! {"y":0,"n":2,"runs":[[4,12]]}
//! {"y":2,"n":1,"runs":[]}
//! {"end":true,"lines":3,"runs":2,"crc32":"e50720ad"}
//! ```
//!
//! With several inks a run is `[start,end,ink]`. [`crate::encode::rls`] is the same in binary.

use super::Format;
use super::records::{Records, Spelling};
use crate::checksum::Checksum;
use crate::run::{Header, Lines};

/// The format.
pub const FORMAT: Format = Format {
    name: "ndjson",
    extensions: &["ndjson", "jsonl"],
    media_type: "application/x-ndjson",
    about: "line stream: runs as JSON, a record of equal lines a line",
    binary: false,
    version: 1,
    encoder: |header| Records::boxed(header, Spelling { begin, record, end }),
};

fn begin(header: &Header, out: &mut Vec<u8>) {
    let Header { width, lines, inks, .. } = header;
    let inks: Vec<String> = inks.iter().map(|[r, g, b]| format!("\"#{r:02x}{g:02x}{b:02x}\"")).collect();
    let (height, from, to, inks) = (header.height(), lines.start, lines.end, inks.join(","));
    let text = format!("{{\"runset\":1,\"width\":{width},\"height\":{height},\"from\":{from},\"to\":{to},\"inks\":[{inks}]}}\n");
    out.extend_from_slice(text.as_bytes());
}

fn record(lines: Lines<'_>, several: bool, out: &mut Vec<u8>) {
    let mut digits = itoa::Buffer::new();
    let mut put = |before: &str, number: u32| {
        out.extend_from_slice(before.as_bytes());
        out.extend_from_slice(digits.format(number).as_bytes());
    };
    put("{\"y\":", lines.y);
    put(",\"n\":", lines.n);
    let mut before = ",\"runs\":[[";
    for run in lines.runs {
        put(before, run.start);
        put(",", run.end);
        if several {
            put(",", run.ink);
        }
        before = "],[";
    }
    out.extend_from_slice(if lines.runs.is_empty() { b",\"runs\":[]}\n" } else { b"]]}\n" });
}

fn end(sum: &Checksum, out: &mut Vec<u8>) {
    let (lines, runs, crc32) = (sum.lines(), sum.runs(), sum.crc32());
    out.extend_from_slice(format!("{{\"end\":true,\"lines\":{lines},\"runs\":{runs},\"crc32\":\"{crc32:08x}\"}}\n").as_bytes());
}
