//! Rows as repeats and literals, of pixels of one or three bytes or of bytes of eight pixels: what PWG raster, Apple raster and PCL share.
//!
//! ```text
//!   a a a a b c c d        3 a   253 b c c d
//!   count (PWG raster)     n < 128: the next unit n + 1 times      n > 128: 257 - n units as they are
//! ```
//!
//! PCL counts the other way round, as TIFF's PackBits do.
//!
//! Rows are made of runs, and a run is one unit and a number, so what a row costs follows its runs and not its pixels. Which units become
//! literals follows from the units alone: those that come once, and bytes that come twice behind a literal, where a repeat would not be
//! shorter.
//!
//! Source: PWG 5102.4, section 4.3; TIFF 6.0, section 9.

use std::marker::PhantomData;
use std::ops::Range;

use crate::run::Run;

/// Most units behind a count.
const MOST: usize = 128;

/// How many units follow, in a byte. One unit alone is counted as a literal, in a byte that says the same as a repeat would.
pub trait Count {
    /// Of so many equal ones.
    fn repeat(n: usize) -> u8;
    /// Of so many as they are.
    fn literals(n: usize) -> u8;
}

/// The counts of PWG raster and Apple raster.
pub struct Pwg;

impl Count for Pwg {
    fn repeat(n: usize) -> u8 {
        (n - 1) as u8
    }

    /// A single one is 257 - 1, which is 0 in a byte.
    fn literals(n: usize) -> u8 {
        (257 - n) as u8
    }
}

/// Those of PCL.
pub struct PackBits;

impl Count for PackBits {
    fn repeat(n: usize) -> u8 {
        Pwg::literals(n)
    }

    fn literals(n: usize) -> u8 {
        Pwg::repeat(n)
    }
}

/// A row of units of `N` bytes on its way out.
pub struct Literals<'o, const N: usize, C> {
    out: &'o mut Vec<u8>,
    /// The unit at the end, and how often it stands there: not among `out` yet, as more may follow.
    last: ([u8; N], usize),
    /// Where the count of the literals at the end of `out` stands, and how many there are.
    open: (usize, usize),
    counts: PhantomData<C>,
}

impl<'o, const N: usize, C: Count> Literals<'o, N, C> {
    /// An empty row.
    pub fn new(out: &'o mut Vec<u8>) -> Literals<'o, N, C> {
        Literals { out, last: ([0; N], 0), open: (0, 0), counts: PhantomData }
    }

    /// Takes `n` times the same unit. How equal ones were divided among calls makes no difference.
    pub fn push(&mut self, unit: [u8; N], n: usize) {
        if n > 0 && unit != self.last.0 {
            self.write();
            self.last.0 = unit;
        }
        self.last.1 += n;
    }

    /// Ends the row.
    pub fn end(mut self) {
        self.write();
        self.close();
    }

    /// Ends the row; in the place of units at its end that are `blank`, `stand_in` is written.
    pub fn end_blank(mut self, blank: [u8; N], stand_in: &[u8]) {
        let is_blank = self.last.0 == blank && self.last.1 > 0;
        if !is_blank {
            self.write();
        }
        self.close();
        if is_blank {
            self.out.extend_from_slice(stand_in);
        }
    }

    /// Writes the equal units at the end.
    fn write(&mut self) {
        let (unit, n) = self.last;
        self.last.1 = 0;
        let (whole, rest) = (n / MOST, n % MOST);
        for _ in 0..whole {
            self.repeat(unit, MOST);
        }
        if rest > 2 || rest == 2 && (N > 1 || self.open.1 == 0) {
            self.repeat(unit, rest);
        } else {
            (0..rest).for_each(|_| self.literal(unit));
        }
    }

    fn repeat(&mut self, unit: [u8; N], n: usize) {
        self.close();
        self.out.push(C::repeat(n));
        self.out.extend_from_slice(&unit);
    }

    fn literal(&mut self, unit: [u8; N]) {
        if self.open.1 == MOST {
            self.close();
        }
        if self.open.1 == 0 {
            self.open.0 = self.out.len();
            self.out.push(0);
        }
        self.out.extend_from_slice(&unit);
        self.open.1 += 1;
    }

    /// Counts the open literals.
    fn close(&mut self) {
        let (at, n) = std::mem::take(&mut self.open);
        if n > 0 {
            self.out[at] = C::literals(n);
        }
    }
}

/// Those of a line's runs that are in some columns at least in part.
fn within<'r>(runs: &'r [Run], columns: &Range<u32>) -> &'r [Run] {
    let first = runs.partition_point(|run| run.end <= columns.start);
    let end = runs.partition_point(|run| run.start < columns.end);
    runs.get(first..end).unwrap_or_default()
}

/// Pushes the pixels of some columns of a line, of `N` bytes each; `unit` gives that of an ink.
pub fn pixels<const N: usize, C: Count>(
    row: &mut Literals<'_, N, C>,
    columns: Range<u32>,
    runs: &[Run],
    paper: [u8; N],
    unit: impl Fn(u32) -> [u8; N],
) {
    let mut at = columns.start;
    for run in within(runs, &columns) {
        let (start, end) = (run.start.max(at), run.end.min(columns.end));
        row.push(paper, (start - at) as usize);
        row.push(unit(run.ink), (end - start) as usize);
        at = end;
    }
    row.push(paper, (columns.end - at) as usize);
}

/// Pushes the bytes of some columns of a line at a bit a pixel, leftmost in the high bit, 1 where anything is painted. The first column is that of a byte.
pub fn bits<C: Count>(row: &mut Literals<'_, 1, C>, columns: Range<u32>, runs: &[Run]) {
    // The byte at hand, and what of it is painted.
    let (mut at, mut byte) = (columns.start / 8, 0);
    for run in within(runs, &columns) {
        let run = Run { start: run.start.max(columns.start), end: run.end.min(columns.end), ink: 0 };
        let (first, last) = (run.start / 8, run.end / 8);
        if first > at {
            row.push([byte], 1);
            row.push([0], (first - at - 1) as usize);
            (at, byte) = (first, 0);
        }
        let (head, tail) = (0xff >> (run.start % 8), !(0xff >> (run.end % 8)));
        if first == last {
            byte |= head & tail;
        } else {
            row.push([byte | head], 1);
            row.push([0xff], (last - first - 1) as usize);
            (at, byte) = (last, tail);
        }
    }
    let bytes = columns.end.div_ceil(8);
    if at < bytes {
        row.push([byte], 1);
        row.push([0], (bytes - at - 1) as usize);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The same from the row, unit by unit.
    fn plainly<const N: usize>(row: &[[u8; N]]) -> Vec<u8> {
        let (mut out, mut literals): (Vec<u8>, Vec<[u8; N]>) = (Vec::new(), Vec::new());
        let close = |literals: &mut Vec<[u8; N]>, out: &mut Vec<u8>| {
            for some in literals.chunks(128) {
                out.push(if let [_] = some { 0 } else { (257 - some.len()) as u8 });
                out.extend(some.as_flattened());
            }
            literals.clear();
        };
        for some in row.chunk_by(|a, b| a == b).flat_map(|equal| equal.chunks(128)) {
            if some.len() == 1 || some.len() == 2 && N == 1 && !literals.is_empty() {
                literals.extend(some);
            } else {
                close(&mut literals, &mut out);
                out.push(some.len() as u8 - 1);
                out.extend(some[0]);
            }
        }
        close(&mut literals, &mut out);
        out
    }

    /// Runs of a few inks, apart or touching, and the line's pixels, 0 paper.
    fn line() -> impl Strategy<Value = (Vec<Run>, Vec<u32>)> {
        let piece = (prop_oneof![Just(1..2u32), Just(1..10), Just(100..300)], 0..4u32);
        prop::collection::vec(piece.prop_flat_map(|(n, pixel)| (n, Just(pixel))), 1..60).prop_map(|pieces| {
            let pixels: Vec<u32> = pieces.iter().flat_map(|&(n, pixel)| std::iter::repeat_n(pixel, n as usize)).collect();
            let mut at = 0;
            let groups = pixels.chunk_by(|a, b| a == b).map(|group| {
                at += group.len() as u32;
                (at - group.len() as u32, at, group[0])
            });
            (groups.filter(|group| group.2 > 0).map(|(start, end, pixel)| Run { start, end, ink: pixel - 1 }).collect(), pixels)
        })
    }

    proptest! {
        #[test]
        fn rows_are_as_their_units_say((runs, line) in line(), inks in any::<[[u8; 3]; 3]>(), paper in any::<[u8; 3]>()) {
            let width = line.len() as u32;
            let colour = |pixel: u32| pixel.checked_sub(1).map_or(paper, |ink| inks[ink as usize]);
            let rgb: Vec<_> = line.iter().map(|&pixel| colour(pixel)).collect();
            let grey: Vec<_> = rgb.iter().map(|colour| [colour[0] / 64]).collect();
            let packed: Vec<_> = line.chunks(8).map(|eight| {
                [eight.iter().enumerate().fold(0, |byte, (i, &pixel)| byte | u8::from(pixel > 0) << (7 - i))]
            }).collect();
            let mut out = Vec::new();
            let mut row = Literals::<_, Pwg>::new(&mut out);
            pixels(&mut row, 0..width, &runs, paper, |ink| inks[ink as usize]);
            row.end();
            prop_assert_eq!(&out, &plainly(&rgb));
            out.clear();
            let mut row = Literals::<_, Pwg>::new(&mut out);
            pixels(&mut row, 0..width, &runs, [paper[0] / 64], |ink| [inks[ink as usize][0] / 64]);
            row.end();
            prop_assert_eq!(&out, &plainly(&grey));
            out.clear();
            let mut row = Literals::<_, Pwg>::new(&mut out);
            bits(&mut row, 0..width, &runs);
            row.end();
            prop_assert_eq!(&out, &plainly(&packed));
            out.clear();
            let mut row = Literals::<_, Pwg>::new(&mut out);
            pixels(&mut row, 0..width, &runs, paper, |ink| inks[ink as usize]);
            row.end_blank(rgb[0], &[128]);
            let blank = rgb.iter().rev().take_while(|colour| **colour == rgb[0]).count();
            let mut expected = plainly(&rgb[..rgb.len() - blank]);
            expected.extend((blank > 0).then_some(128));
            prop_assert_eq!(&out, &expected);
            // The same with the other counts: what one of them calls a repeat the other calls literals, but for single units.
            out.clear();
            let mut row = Literals::<_, PackBits>::new(&mut out);
            bits(&mut row, 0..width, &runs);
            row.end();
            let mut expected = plainly(&packed);
            let mut at = 0;
            while let Some(count) = expected.get_mut(at) {
                at += if *count < 128 { 2 } else { 258 - usize::from(*count) };
                *count = 0_u8.wrapping_sub(*count);
            }
            prop_assert_eq!(&out, &expected);
        }
    }
}
