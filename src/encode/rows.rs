//! Runs become rows of bytes, and formats that are nothing but a head and such rows.
//!
//! A row is kept, which is paper at first, and line after line what changes is painted over it, a byte at a time. What goes out are copies of it.

use std::borrow::Borrow;
use std::ops::Range;

use super::changes::Shown;
use super::{Encode, Part, Restart, Strip};
use crate::run::{Header, Inks, Lines, Rgb, Run};

/// A byte of equal pixels of `depth` bits (1, 2, 4 or 8): at 2 bits, pixel 3 is 3 · 0b01010101.
pub fn spread(depth: u32, pixel: u8) -> u8 {
    255 / ((1u16 << depth) - 1) as u8 * pixel
}

/// Writes the pixels of `runs` into `row` at `depth` bits a pixel (1, 2, 4 or 8), leftmost in the high bits. `value`
/// gives the pixel of an ink.
pub fn packed(row: &mut [u8], depth: u32, runs: &[Run], value: impl Fn(u32) -> u8) {
    for run in runs {
        fill_bits(row, (run.start * depth) as usize, (run.end * depth) as usize, spread(depth, value(run.ink)));
    }
}

/// Copies the bits of `pattern` to bits `start..end` of `row`, of which there is at least one. Bit 0 is the high bit of byte 0.
fn fill_bits(row: &mut [u8], start: usize, end: usize, pattern: u8) {
    let (first, last) = (start / 8, (end - 1) / 8);
    let (head, tail) = (0xff >> (start % 8), 0xff << (7 - (end - 1) % 8));
    let put = |byte: &mut u8, mask: u8| *byte = *byte & !mask | pattern & mask;
    if first == last {
        put(&mut row[first], head & tail);
    } else {
        put(&mut row[first], head);
        put(&mut row[last], tail);
        // Without a middle, as in dense rows, the call would cost more than all else.
        if last - first > 1 {
            row[first + 1..last].fill(pattern);
        }
    }
}

/// Sixteen equal pixels of three bytes, which are whole registers of any width.
type Block = [u8; 48];

fn block(colour: Rgb) -> Block {
    let mut block = [0; 48];
    block.as_chunks_mut().0.fill(colour);
    block
}

/// What paints runs at three bytes a pixel; their inks are as in [`Shown::changes`].
pub enum Colours {
    /// The blocks of paper and of the inks.
    Listed(Vec<Block>),
    /// They are made for every run.
    Shaded(Inks),
}

impl Colours {
    /// Of a raster's paper and inks.
    pub fn new(inks: &Inks) -> Colours {
        match inks {
            Inks::Listed(list) => Colours::Listed((0..=list.len() as u32).map(|pixel| block(inks.pixel(pixel))).collect()),
            Inks::Shaded { .. } => Colours::Shaded(inks.clone()),
        }
    }

    /// Writes the pixels of `runs` into `row`.
    pub fn paint(&self, row: &mut [u8], runs: &[Run]) {
        match self {
            Colours::Listed(blocks) => rgb(row, runs, |pixel| &blocks[pixel as usize]),
            Colours::Shaded(inks) => rgb(row, runs, |pixel| block(inks.pixel(pixel))),
        }
    }
}

fn rgb<B: Borrow<Block>>(row: &mut [u8], runs: &[Run], block: impl Fn(u32) -> B) {
    for run in runs {
        let block = block(run.ink);
        let block = block.borrow();
        let (whole, rest) = row[run.start as usize * 3..run.end as usize * 3].as_chunks_mut();
        whole.iter_mut().for_each(|pixels| *pixels = *block);
        rest.copy_from_slice(&block[..rest.len()]);
    }
}

/// About how many bytes of rows are a strip, and so are written at once: half of what a core's second cache holds; smaller ones
/// cost more on the way than they save in it.
const STRIP_BYTES: usize = 1 << 19;

/// A writer of `head` and then rows of pixels of `depth` bits, over which `paint` writes paper and then changes, as [`Shown`] gives them. What fills up
/// a row's last byte is 0.
pub fn plain(head: Vec<u8>, header: &Header, depth: u32, paint: impl Fn(&[Run], &mut [u8]) + Send + 'static) -> Box<dyn Encode> {
    let shown = Shown::new(header.width, depth);
    let raster = header.lines.clone();
    let mut row = vec![0; shown.row_bytes()];
    paint(&[shown.paper()], &mut row);
    Box::new(Plain { head, next: raster.start, raster, row, shown, paint })
}

struct Plain<P> {
    head: Vec<u8>,
    /// The lines of the raster, and the one that is written next.
    raster: Range<u32>,
    next: u32,
    row: Vec<u8>,
    shown: Shown,
    paint: P,
}

impl<P: Fn(&[Run], &mut [u8]) + Send> Encode for Plain<P> {
    fn line_bytes(&self) -> usize {
        self.row.len()
    }

    fn begin(&mut self, out: &mut Vec<u8>) {
        out.extend_from_slice(&self.head);
    }

    fn lines(&mut self, lines: Lines<'_>, out: &mut Vec<u8>) {
        self.shown.show(lines.runs);
        (self.paint)(self.shown.changes(), &mut self.row);
        (0..lines.n).for_each(|_| out.extend_from_slice(&self.row));
        self.next = lines.y + lines.n;
    }

    fn end(&mut self, _out: &mut Vec<u8>) {}

    fn strip_lines(&self) -> u32 {
        lines_of(STRIP_BYTES, self.row.len())
    }

    fn part(&mut self, strip: &Strip, out: &mut Vec<u8>) -> Part {
        strip.within(strip.lines()).for_each(|lines| self.lines(lines, out));
        Part { lines: strip.lines(), tally: [0; 3] }
    }

    fn join(&mut self, part: &Part, _out: &mut Vec<u8>) {
        self.next = part.lines.end;
    }

    fn length(&self) -> Option<u64> {
        Some(self.head.len() as u64 + self.raster.len() as u64 * self.row.len() as u64)
    }

    fn restart(&self) -> Restart {
        Restart { line: self.next, tally: [0; 3] }
    }

    fn resume(&mut self, restart: &Restart) {
        self.next = restart.line;
    }

    /// The beginning of a line, or the end.
    fn seek(&self, offset: u64) -> Option<(u64, Restart)> {
        let (head, row) = (self.head.len() as u64, self.row.len() as u64);
        let lines = (offset.checked_sub(head)? / row).min(self.raster.len() as u64);
        Some((head + lines * row, Restart { line: self.raster.start + lines as u32, tally: [0; 3] }))
    }
}

/// How many rows of `row_bytes` bytes are about `bytes` bytes: a power of two.
pub fn lines_of(bytes: usize, row_bytes: usize) -> u32 {
    1 << (bytes / row_bytes.max(1)).max(1).ilog2()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn packed_rows_hold_the_pixels_of_the_runs(
            pixels in prop::collection::vec(0u8..3, 1..80), log in 0u32..4, paper in any::<u8>(), inks in any::<[u8; 3]>(),
        ) {
            let depth = 1 << log;
            let value = |ink: u32| inks[ink as usize] & ((1u16 << depth) - 1) as u8;
            let paper = paper & ((1u16 << depth) - 1) as u8;
            // Pixel 0 is paper, others are a run of one pixel each.
            let runs: Vec<Run> = (0u32..).zip(&pixels).filter(|p| *p.1 > 0)
                .map(|(x, &ink)| Run { start: x, end: x + 1, ink: u32::from(ink) - 1 }).collect();
            let mut row = vec![spread(depth, paper); (pixels.len() * depth as usize).div_ceil(8)];
            packed(&mut row, depth, &runs, value);
            let expected: String = pixels.iter().map(|&p| if p == 0 { paper } else { value(u32::from(p) - 1) })
                .map(|v| format!("{v:08b}")[8 - depth as usize..].to_string()).collect();
            let got: String = row.iter().map(|b| format!("{b:08b}")).collect();
            prop_assert_eq!(&got[..expected.len()], &expected[..]);
        }

        #[test]
        fn a_long_run_is_its_pixels(start in 0usize..70, len in 1usize..70, pattern: u8, ground: u8) {
            let mut row = vec![ground; 18];
            fill_bits(&mut row, start, start + len, pattern);
            for bit in 0..18 * 8 {
                let source = if (start..start + len).contains(&bit) { pattern } else { ground };
                prop_assert_eq!(row[bit / 8] << (bit % 8) & 0x80, source << (bit % 8) & 0x80);
            }
        }
    }
}
