//! Between rows and bytes: hands lines to an encoder in portions, so that what is pending stays small.

use crate::encode::{Encode, Format};
use crate::run::{Header, Lines, Merge, RECORD_LINES};

/// About how many bytes are gathered before they are written.
pub const PORTION: usize = 64 << 10;

/// An encoder with what it needs before it: records merged for the formats that have records.
pub struct Pump {
    encoder: Box<dyn Encode>,
    /// Lines of a portion where lines are written one by one; none where equal lines are one record.
    portion: Option<u32>,
    merge: Merge,
    /// Runs seen, those of repeated lines too.
    pub runs: u64,
    /// Lines seen.
    pub lines: u32,
}

impl Pump {
    /// Writes the beginning of the raster to `out`.
    pub fn new(format: &Format, header: &Header, out: &mut Vec<u8>) -> Pump {
        let mut encoder = (format.encoder)(header);
        encoder.begin(out);
        let portion = encoder.line_bytes().map(|bytes| (PORTION / bytes.max(1)).clamp(1, RECORD_LINES as usize) as u32);
        Pump { encoder, portion, merge: Merge::default(), runs: 0, lines: 0 }
    }

    /// Writes the first of `lines` to `out`, as many as make a portion, and says how many that were.
    pub fn push(&mut self, lines: Lines<'_>, out: &mut Vec<u8>) -> u32 {
        let most = self.portion.unwrap_or(RECORD_LINES - lines.y % RECORD_LINES);
        let lines = Lines { n: lines.n.min(most), ..lines };
        self.runs += lines.runs.len() as u64 * u64::from(lines.n);
        self.lines += lines.n;
        if self.portion.is_some() {
            self.encoder.lines(lines, out);
        } else {
            self.merge.push(lines, |record| self.encoder.lines(record, out));
        }
        lines.n
    }

    /// Writes what is still open and the end of the raster to `out`.
    pub fn finish(&mut self, out: &mut Vec<u8>) {
        self.merge.flush(|record| self.encoder.lines(record, out));
        self.encoder.end(out);
    }
}
