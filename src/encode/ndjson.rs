//! A line stream as JSON texts, one a line: a header, records of equal lines, an end record with counts and checksum.
//!
//! ```text
//! {"runset":1,"width":16,"height":3,"from":0,"to":3,"inks":["#000000"]}
//! {"y":0,"n":2,"runs":[[4,12]]}
//! {"y":2,"n":1,"runs":[]}
//! {"end":true,"lines":3,"runs":2,"crc32":"e50720ad"}
//! ```
//!
//! With several inks a run is `[start,end,ink]`. Of a shaded raster the header has `"inks":"rgb","paper":"#rrggbb"`, and a run is
//! `[start,end,"#rrggbb"]`. [`crate::encode::rls`] is the same in binary.

use super::{Format, holds_all};
use super::records::{Records, Spelling};
use crate::checksum::Checksum;
use crate::run::{Header, Hex, Inks, Lines, Rgb, Told, colour_of};

/// The format.
pub const FORMAT: Format = Format {
    name: "ndjson",
    extensions: &["ndjson", "jsonl"],
    media_type: "application/x-ndjson",
    about: "line stream: runs as JSON, a record of equal lines a line",
    binary: false,
    version: 1,
    pages: false,
    fits: holds_all,
    encoder: |header| Records::boxed(header, Spelling { begin, record, end }),
};

fn begin(header: &Header, out: &mut Vec<u8>) {
    let Header { width, lines, inks, .. } = header;
    let colour = |colour: Rgb| format!("\"{}\"", Hex::of(colour));
    let inks = match inks {
        Inks::Listed(list) => format!("[{}]", list.iter().map(|ink| colour(*ink)).collect::<Vec<_>>().join(",")),
        Inks::Shaded { paper } => format!("\"rgb\",\"paper\":{}", colour(*paper)),
    };
    let (height, from, to) = (header.height(), lines.start, lines.end);
    let text = format!("{{\"runset\":1,\"width\":{width},\"height\":{height},\"from\":{from},\"to\":{to},\"inks\":{inks}}}\n");
    out.extend_from_slice(text.as_bytes());
}

fn record(lines: Lines<'_>, told: Told, out: &mut Vec<u8>) {
    let mut digits = itoa::Buffer::new();
    let mut put = |out: &mut Vec<u8>, before: &str, number: u32| {
        out.extend_from_slice(before.as_bytes());
        out.extend_from_slice(digits.format(number).as_bytes());
    };
    put(out, "{\"y\":", lines.y);
    put(out, ",\"n\":", lines.n);
    let mut before = ",\"runs\":[[";
    for run in lines.runs {
        put(out, before, run.start);
        put(out, ",", run.end);
        match told {
            Told::Nothing => {}
            Told::Index => put(out, ",", run.ink),
            Told::Colour => {
                out.extend_from_slice(b",\"");
                out.extend_from_slice(Hex::of(colour_of(run.ink)).as_bytes());
                out.push(b'"');
            }
        }
        before = "],[";
    }
    out.extend_from_slice(if lines.runs.is_empty() { b",\"runs\":[]}\n" } else { b"]]}\n" });
}

fn end(sum: &Checksum, out: &mut Vec<u8>) {
    let (lines, runs, crc32) = (sum.lines(), sum.runs(), sum.crc32());
    out.extend_from_slice(format!("{{\"end\":true,\"lines\":{lines},\"runs\":{runs},\"crc32\":\"{crc32:08x}\"}}\n").as_bytes());
}
