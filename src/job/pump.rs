//! Between rows and bytes: hands lines to an encoder in portions, so that what is pending stays small.

use crate::encode::{Encode, Restart};
use crate::run::{Header, Lines, RECORD_LINES};

/// About how many bytes are gathered before they are written.
pub const PORTION: usize = 64 << 10;

/// An encoder that is fed in portions.
pub struct Pump {
    encoder: Box<dyn Encode>,
    /// How many equal lines it is given at once.
    portion: u32,
    /// Runs seen, those of repeated lines too.
    pub runs: u64,
    /// Lines seen, and those before the one that was taken up.
    pub lines: u32,
}

impl Pump {
    /// Writes the beginning of the raster to `out`.
    pub fn new(mut encoder: Box<dyn Encode>, out: &mut Vec<u8>) -> Pump {
        encoder.begin(out);
        Pump::of(encoder, 0)
    }

    /// Takes up a raster whose first lines, up to `restart.line`, were written by others.
    pub fn resume(mut encoder: Box<dyn Encode>, header: &Header, restart: &Restart) -> Pump {
        encoder.resume(restart);
        Pump::of(encoder, restart.line.saturating_sub(header.lines.start))
    }

    fn of(encoder: Box<dyn Encode>, lines: u32) -> Pump {
        let portion = PORTION.checked_div(encoder.line_bytes()).map_or(RECORD_LINES, |lines| lines.clamp(1, RECORD_LINES as usize) as u32);
        Pump { encoder, portion, runs: 0, lines }
    }

    /// Writes the first of `lines` to `out`, as many as make a portion, and says how many that were.
    pub fn push(&mut self, lines: Lines<'_>, out: &mut Vec<u8>) -> u32 {
        let lines = Lines { n: lines.n.min(self.portion), ..lines };
        self.runs += lines.runs.len() as u64 * u64::from(lines.n);
        self.lines += lines.n;
        self.encoder.lines(lines, out);
        lines.n
    }

    /// The encoder.
    pub fn encoder(&self) -> &dyn Encode {
        &*self.encoder
    }

    /// Where another writer can go on.
    pub fn restart(&self) -> Restart {
        self.encoder.restart()
    }

    /// Writes the end of the raster to `out`.
    pub fn finish(&mut self, out: &mut Vec<u8>) {
        self.encoder.end(out);
    }
}
