//! A line stream in binary: what [`crate::encode::ndjson`] says, in a byte or two a number. `docs/rls.md` is its specification.

use super::{Format, holds_all};
use super::records::{Records, Spelling};
use crate::checksum::Checksum;
use crate::run::{Header, Inks, Lines, Told, colour_of};

/// The format.
pub const FORMAT: Format = Format {
    name: "rls",
    extensions: &["rls"],
    media_type: "application/vnd.runset.rls",
    about: "line stream in binary (docs/rls.md)",
    binary: true,
    version: 1,
    pages: false,
    fits: holds_all,
    encoder: |header| Records::boxed(header, Spelling { begin, record, end }),
};

/// What every stream begins with: no text, and it shows when a stream was treated as text.
const MAGIC: [u8; 8] = *b"\x89RLS\r\n\x1a\n";

/// Version of the layout.
const VERSION: u64 = 1;

/// The kind of stream whose runs show inks of a list.
const LISTED: u64 = 0;

/// The kind whose runs carry their colours.
const SHADED: u64 = 1;

fn begin(header: &Header, out: &mut Vec<u8>) {
    let Header { width, lines, inks, .. } = header;
    out.extend_from_slice(&MAGIC);
    let kind = if let Inks::Shaded { .. } = inks { SHADED } else { LISTED };
    for number in [VERSION, kind, u64::from(*width), u64::from(lines.start), u64::from(lines.end)] {
        leb128(out, number);
    }
    match inks {
        Inks::Listed(list) => {
            leb128(out, list.len() as u64);
            out.extend_from_slice(list.as_flattened());
        }
        Inks::Shaded { paper } => out.extend_from_slice(paper),
    }
}

fn record(lines: Lines<'_>, told: Told, out: &mut Vec<u8>) {
    leb128(out, u64::from(lines.n));
    leb128(out, lines.runs.len() as u64);
    let mut end = 0;
    for run in lines.runs {
        leb128(out, u64::from(run.start - end));
        leb128(out, u64::from(run.end - run.start));
        match told {
            Told::Nothing => {}
            Told::Index => leb128(out, u64::from(run.ink)),
            Told::Colour => out.extend_from_slice(&colour_of(run.ink)),
        }
        end = run.end;
    }
}

fn end(sum: &Checksum, out: &mut Vec<u8>) {
    leb128(out, 0);
    leb128(out, u64::from(sum.lines()));
    leb128(out, sum.runs());
    out.extend_from_slice(&sum.crc32().to_be_bytes());
}

/// Appends a number, seven bits a byte, the low ones first, the high bit set in all bytes but the last.
fn leb128(out: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        out.push(number as u8 | 0x80);
        number >>= 7;
    }
    out.push(number as u8);
}
