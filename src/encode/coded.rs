//! Lines of PWG raster and of Apple raster, as groups.
//!
//! ```text
//!   line     | 3 a 254 b c | 127 a 127 a | 12 d ...     blocks, each coded by itself
//!   above    | 3 a 254 b b | 127 a 127 a | 12 d ...     only the first differs: it is coded anew, the others are copied
//! ```
//!
//! Drawings are coherent from line to line. A repeat or a literal ends with its block, so a block's bytes follow from its pixels alone, and what did not change since the line before is a
//! copy of bytes. Blocks are so long that the few bytes more do not matter.

use std::ops::Range;

use super::changes::Shown;
use super::groups::Code;
use super::literals::{Literals, Pwg, bits, pixels};
use super::pgm;
use crate::run::{Header, Inks, Lines, Pixels, Rgb, Run};

/// The byte that says that the rest of a row is white.
const REST: u8 = 128;

/// The colours of paper and of the inks, of which one is a pixel of `N` bytes.
struct Units<const N: usize> {
    /// Of those that are listed, paper first.
    listed: Vec<[u8; N]>,
    inks: Inks,
    unit: fn(Rgb) -> [u8; N],
}

impl<const N: usize> Units<N> {
    fn new(inks: &Inks, unit: fn(Rgb) -> [u8; N]) -> Units<N> {
        let listed = match inks {
            Inks::Listed(list) => (0..=list.len() as u32).map(|pixel| unit(inks.pixel(pixel))).collect(),
            Inks::Shaded { .. } => Vec::new(),
        };
        Units { listed, inks: inks.clone(), unit }
    }

    /// Of a pixel: 0 is paper, the inks count from 1.
    fn of(&self, pixel: u32) -> [u8; N] {
        self.listed.get(pixel as usize).copied().unwrap_or_else(|| (self.unit)(self.inks.pixel(pixel)))
    }

    /// Writes some columns of a line.
    fn write(&self, columns: Range<u32>, runs: &[Run], out: &mut Vec<u8>) {
        let mut row = Literals::<_, Pwg>::new(out);
        pixels(&mut row, columns, runs, self.of(0), |ink| self.of(ink + 1));
        row.end();
    }

    /// The column behind the last one that is not white.
    fn white_from(&self, width: u32, runs: &[Run]) -> u32 {
        let is_white = |pixel| self.of(pixel) == [0xff; N];
        let mut end = width;
        for run in runs.iter().rev() {
            if run.end < end && !is_white(0) {
                return end;
            }
            if !is_white(run.ink + 1) {
                return run.end;
            }
            end = run.start;
        }
        if is_white(0) { 0 } else { end }
    }
}

/// Bytes of eight pixels, or pixels, that are coded by themselves.
const BLOCK: u32 = 512;

/// Groups as PWG raster and Apple raster have them: a byte, the lines but one, and the line.
///
/// A line is coded block by block, so that what did not change since the line before is a copy of bytes.
pub struct Coded {
    width: u32,
    units: Coding,
    /// Columns of a block.
    block: u32,
    shown: Shown,
    /// The line that is shown: its bytes, and where each block ends in them.
    code: Blocks,
    /// The next one, while it is made.
    next: Blocks,
}

enum Coding {
    Black,
    Gray(Units<1>),
    Rgb(Units<3>),
}

impl Coding {
    /// Writes some columns of a line.
    fn write(&self, columns: Range<u32>, runs: &[Run], out: &mut Vec<u8>) {
        match self {
            Coding::Black => {
                let mut row = Literals::<_, Pwg>::new(out);
                bits(&mut row, columns, runs);
                row.end();
            }
            Coding::Gray(units) => units.write(columns, runs, out),
            Coding::Rgb(units) => units.write(columns, runs, out),
        }
    }
}

#[derive(Default)]
struct Blocks {
    bytes: Vec<u8>,
    ends: Vec<usize>,
}

impl Blocks {
    /// Where a block begins.
    fn start(&self, block: u32) -> usize {
        block.checked_sub(1).map_or(0, |before| self.ends[before as usize])
    }

    /// Adds some blocks of others.
    fn copy(&mut self, blocks: Range<u32>, from: &Blocks) {
        if blocks.is_empty() {
            return;
        }
        let (start, end) = (from.start(blocks.start), from.start(blocks.end));
        let before = self.bytes.len();
        self.bytes.extend_from_slice(&from.bytes[start..end]);
        self.ends.extend(from.ends[blocks.start as usize..blocks.end as usize].iter().map(|end| end - start + before));
    }
}

impl Coded {
    /// Of rasters of such pixels.
    pub fn new(header: &Header, pixels: Pixels) -> Coded {
        let units = match pixels {
            Pixels::Black => Coding::Black,
            Pixels::Gray => Coding::Gray(Units::new(&header.inks, |colour| [pgm::luma(colour)])),
            Pixels::Rgb => Coding::Rgb(Units::new(&header.inks, |colour| colour)),
        };
        let block = if pixels == Pixels::Black { 8 * BLOCK } else { BLOCK };
        let (code, next) = (Blocks::default(), Blocks::default());
        // Coding a run costs more than painting one: changes are worth looking for as if a row had many bytes.
        let mut coded = Coded { width: header.width, units, block, shown: Shown::new(header.width, 24), code, next };
        (0..coded.blocks()).for_each(|block| coded.write(block, &[]));
        std::mem::swap(&mut coded.code, &mut coded.next);
        coded
    }

    fn blocks(&self) -> u32 {
        self.width.div_ceil(self.block)
    }

    /// Adds a block of a line to the next one.
    fn write(&mut self, block: u32, runs: &[Run]) {
        let start = block * self.block;
        self.units.write(start..(start + self.block).min(self.width), runs, &mut self.next.bytes);
        self.next.ends.push(self.next.bytes.len());
    }

    /// Shows a line.
    fn show(&mut self, runs: &[Run]) {
        self.shown.show(runs);
        let mut at = 0;
        for i in 0..self.shown.changes().len() {
            let change = self.shown.changes()[i];
            let (first, end) = ((change.start / self.block).max(at), (change.end - 1) / self.block + 1);
            if end > at {
                self.next.copy(at..first, &self.code);
                (first..end).for_each(|block| self.write(block, runs));
                at = end;
            }
        }
        if at > 0 {
            self.next.copy(at..self.blocks(), &self.code);
            std::mem::swap(&mut self.code, &mut self.next);
            self.next.bytes.clear();
            self.next.ends.clear();
        }
    }
}

impl Code for Coded {
    const LEANS: bool = false;

    fn group(&mut self, lines: Lines<'_>, out: &mut Vec<u8>) {
        self.show(lines.runs);
        out.push((lines.n - 1) as u8);
        out.extend_from_slice(&self.code.bytes);
    }

    fn above(&mut self, _runs: &[Run]) {}
}

/// The same where white at the end of a line is one byte.
pub struct Ending(Coded);

impl Code for Ending {
    const LEANS: bool = false;

    fn group(&mut self, lines: Lines<'_>, out: &mut Vec<u8>) {
        let Ending(coded) = self;
        coded.show(lines.runs);
        out.push((lines.n - 1) as u8);
        let white = match &coded.units {
            Coding::Black => coded.width,
            Coding::Gray(units) => units.white_from(coded.width, lines.runs),
            Coding::Rgb(units) => units.white_from(coded.width, lines.runs),
        };
        if white == coded.width {
            out.extend_from_slice(&coded.code.bytes);
            return;
        }
        let block = white / coded.block;
        out.extend_from_slice(&coded.code.bytes[..coded.code.start(block)]);
        coded.units.write(block * coded.block..white, lines.runs, out);
        out.push(REST);
    }

    fn above(&mut self, _runs: &[Run]) {}
}

impl Ending {
    /// Of rasters of such pixels.
    pub fn new(header: &Header, pixels: Pixels) -> Ending {
        Ending(Coded::new(header, pixels))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::Sheet;
    use proptest::prelude::*;

    /// Lines of pieces that are the same or not, and what they show: 0 paper, or an ink.
    fn lines() -> impl Strategy<Value = (u32, Vec<Vec<Run>>)> {
        let piece = (prop_oneof![1..4u32, 1..90u32, 300..3000u32], prop::collection::vec(0..4u32, 4));
        prop::collection::vec(piece, 1..40).prop_map(|pieces| {
            let line = |i: usize| {
                let (mut at, mut runs) = (0, Vec::<Run>::new());
                for (n, shows) in &pieces {
                    // Many pieces stay.
                    let show = shows[if n % 3 > 0 { 0 } else { i }];
                    match runs.last_mut() {
                        Some(last) if show == last.ink + 1 && last.end == at => last.end += n,
                        _ if show > 0 => runs.push(Run { start: at, end: at + n, ink: show - 1 }),
                        _ => {}
                    }
                    at += n;
                }
                runs
            };
            (pieces.iter().map(|piece| piece.0).sum(), (0..4).map(line).collect())
        })
    }

    proptest! {
        #[test]
        fn a_line_is_coded_as_if_it_were_the_first((width, lines) in lines(), white in 0..3usize, shaded: bool) {
            let mut list = vec![[0; 3], [9, 8, 7], [200; 3]];
            list[white] = [255; 3];
            let inks = if shaded { Inks::Shaded { paper: [255, 255, white as u8] } } else { Inks::Listed(list) };
            let header = Header { width, lines: 0..9, inks, dpi: None, sheet: Sheet::default() };
            for pixels in [Pixels::Black, Pixels::Gray, Pixels::Rgb] {
                let (mut kept, mut ending) = (Coded::new(&header, pixels), Ending::new(&header, pixels));
                for (y, runs) in (0..).zip(&lines) {
                    let lines = Lines { y, n: 1, runs };
                    let [mut got, mut expected, mut ended, mut fresh] = [(); 4].map(|()| Vec::new());
                    kept.group(lines, &mut got);
                    Coded::new(&header, pixels).group(lines, &mut expected);
                    prop_assert!(got == expected);
                    // Block by block.
                    let mut plain = vec![0];
                    let block = if pixels == Pixels::Black { 4096 } else { 512 };
                    for start in (0..width).step_by(block) {
                        kept.units.write(start..(start + block as u32).min(width), runs, &mut plain);
                    }
                    prop_assert!(got == plain);
                    ending.group(lines, &mut ended);
                    Ending::new(&header, pixels).group(lines, &mut fresh);
                    prop_assert!(ended == fresh);
                }
            }
        }
    }
}
