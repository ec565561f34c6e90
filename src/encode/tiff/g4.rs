//! CCITT group 4 (ITU-T T.6), from the places where a line changes its colour.
//!
//! A line is coded against the one above it; above the first is white. Changes of the line are `a`, those of the line above `b`:
//!
//! ```text
//!   above   ......#####...........        b1: the first change behind a0 to the other colour than a0's; b2: the next one
//!                 b1   b2
//!   line    .....########....####.        a0: where coding stands; a1, a2: the next changes
//!           a0   a1      a2
//!
//!   vertical    a1 is at most 3 beside b1      1 to 7 bits     a0 goes to a1
//!   pass        b2 is before a1                4 bits          a0 goes to below b2
//!   horizontal  else                           two runs        a0 goes to a2
//! ```
//!
//! Where a line is as the one above, every change is in its place, which is the bit 1, and so is the end of the line: equal lines are nothing but ones, of a white line a single one.
//!
//! Cost: a step for every change of the line or of the one above; equal lines by words.
//!
//! Source: Recommendation ITU-T T.6 (1988); a strip ends with the end-of-facsimile-block, as TIFF Revision 6.0, section 11, has it.

use super::codes::{CODES, Code, LONGEST};
use super::strips::Coder;
use crate::run::Run;

/// The codes of a1 from 3 left of b1 to 3 right of it.
const VERTICAL: [Code; 7] = [(0b000_0010, 7), (0b00_0010, 6), (0b010, 3), (0b1, 1), (0b011, 3), (0b00_0011, 6), (0b000_0011, 7)];
const PASS: Code = (0b0001, 4);
const HORIZONTAL: Code = (0b001, 3);
/// End of facsimile block.
const END: Code = (0x00_1001, 24);

/// Codes strips of lines of one ink.
pub struct G4 {
    width: u32,
    /// Changes of the line above, and of the one at hand: white to black, black to white, …, before the right edge; then the edge, [`EDGES`] times.
    above: Vec<u32>,
    line: Vec<u32>,
    bits: Bits,
}

/// As often as is looked behind the last change.
const EDGES: usize = 4;

impl G4 {
    /// Of lines of so many pixels.
    pub fn new(width: u32) -> G4 {
        G4 { width, above: vec![width; EDGES], line: Vec::new(), bits: Bits::default() }
    }

    /// Codes the line at hand against the one above.
    fn code(&mut self) {
        let (line, above, bits) = (&self.line[..], &self.above[..], &mut self.bits);
        let (mut i, mut j, mut at) = (0, 0, 0);
        loop {
            let (a1, b1, b2) = (line[i], above[j], above[j + 1]);
            if b2 < a1 {
                bits.put(PASS);
                (at, j) = (b2, j + 2);
                continue;
            }
            let beside = (a1 + 3).wrapping_sub(b1);
            if let Some(code) = VERTICAL.get(beside as usize) {
                bits.put(*code);
                (at, i) = (a1, i + 1);
                // Of the other colour now: the change before b1 may still be right of a1, as that may be left of b1.
                j = if j > 0 { j - 1 } else { 1 };
            } else {
                let a2 = line[i + 1];
                bits.put(HORIZONTAL);
                bits.put_run(i % 2, a1 - at);
                bits.put_run(1 - i % 2, a2 - a1);
                (at, i) = (a2, i + 2);
            }
            if at == self.width {
                return;
            }
            while above[j] <= at {
                j += 2;
            }
        }
    }
}

impl Coder for G4 {
    fn rows(&mut self, runs: &[Run], n: u32) {
        self.line.clear();
        self.line.extend(runs.iter().flat_map(|run| [run.start, run.end]));
        self.line.pop_if(|last| *last == self.width);
        let changes = self.line.len() as u64;
        self.line.extend([self.width; EDGES]);
        self.code();
        self.bits.put_ones(u64::from(n - 1) * (changes + 1));
        std::mem::swap(&mut self.line, &mut self.above);
    }

    fn end(&mut self, out: &mut Vec<u8>) {
        self.bits.put(END);
        self.bits.end(out);
        self.above.clear();
        self.above.extend([self.width; EDGES]);
    }
}

/// Bits on their way out, the high ones of a code first.
#[derive(Default)]
struct Bits {
    bytes: Vec<u8>,
    /// The last bits, in the low ones: fewer than 32.
    held: u64,
    n: u32,
}

impl Bits {
    /// Puts a code of at most 32 bits.
    #[inline]
    fn put(&mut self, (code, bits): Code) {
        self.held = self.held << bits | u64::from(code);
        self.n += bits;
        if self.n >= 32 {
            self.n -= 32;
            self.bytes.extend_from_slice(&((self.held >> self.n) as u32).to_be_bytes());
        }
    }

    /// Puts a run of a colour, 0 white, 1 black.
    #[inline]
    fn put_run(&mut self, colour: usize, run: u32) {
        let codes = &CODES[colour];
        let mut left = run;
        while left >= LONGEST + 64 {
            self.put(codes[63 + (LONGEST / 64) as usize]);
            left -= LONGEST;
        }
        if left >= 64 {
            self.put(codes[63 + (left / 64) as usize]);
        }
        self.put(codes[(left % 64) as usize]);
    }

    /// Puts so many ones.
    fn put_ones(&mut self, count: u64) {
        let mut left = count;
        if left >= 64 {
            // The bits held, filled up; then whole words; as many ones are held again.
            self.put((u32::MAX, 32));
            left -= 32;
            self.bytes.resize(self.bytes.len() + (left / 32 * 4) as usize, 0xff);
            left %= 32;
        }
        while left > 0 {
            let n = left.min(32) as u32;
            self.put((u32::MAX >> (32 - n), n));
            left -= u64::from(n);
        }
    }

    /// Fills up the last byte with zeros, and appends all to `out`.
    fn end(&mut self, out: &mut Vec<u8>) {
        let bits = self.held.checked_shl(64 - self.n).unwrap_or(0);
        self.bytes.extend_from_slice(&bits.to_be_bytes()[..self.n.div_ceil(8) as usize]);
        out.append(&mut self.bytes);
        (self.held, self.n) = (0, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// T.6 by its words, pixel by pixel, into a text of bits: too simple to be wrong.
    fn by_the_book(width: usize, rows: &[Vec<bool>]) -> String {
        let mut text = String::new();
        let mut above = vec![false; width];
        for row in rows {
            // The first changing element of `pixels` right of `at`, of that colour if one is asked for; behind the last pixel if there is none.
            let change = |pixels: &[bool], at: isize, colour: Option<bool>| {
                let start = (at + 1) as usize;
                (start..width)
                    .find(|&x| pixels[x] != (x > 0 && pixels[x - 1]) && colour.is_none_or(|colour| pixels[x] == colour))
                    .unwrap_or(width)
            };
            let (mut a0, mut colour) = (-1_isize, false);
            while a0 < width as isize {
                let a1 = (a0.max(0) as usize..width).find(|&x| row[x] != colour).unwrap_or(width);
                let b1 = change(&above, a0, Some(!colour));
                let b2 = change(&above, b1 as isize, None);
                if b2 < a1 {
                    text += "0001";
                    a0 = b2 as isize;
                } else if a1.abs_diff(b1) <= 3 {
                    text += match a1 as isize - b1 as isize {
                        0 => "1",
                        1 => "011",
                        2 => "000011",
                        3 => "0000011",
                        -1 => "010",
                        -2 => "000010",
                        _ => "0000010",
                    };
                    (a0, colour) = (a1 as isize, !colour);
                } else {
                    let a2 = (a1..width).find(|&x| row[x] == colour).unwrap_or(width);
                    text += "001";
                    for (colour, run) in [(colour, a1 - a0.max(0) as usize), (!colour, a2 - a1)] {
                        let codes = &CODES[usize::from(colour)];
                        let mut left = run;
                        let mut put = |index: usize| text += &format!("{:0n$b}", codes[index].0, n = codes[index].1 as usize);
                        while left > 2623 {
                            put(63 + 40);
                            left -= 2560;
                        }
                        if left > 63 {
                            put(63 + left / 64);
                        }
                        put(left % 64);
                    }
                    a0 = a2 as isize;
                }
            }
            above.clone_from(row);
        }
        text + "000000000001000000000001"
    }

    fn runs(row: &[bool]) -> Vec<Run> {
        let mut x = 0;
        let groups = row.chunk_by(|a, b| a == b).map(|group| {
            x += group.len() as u32;
            (group[0], Run { start: x - group.len() as u32, end: x, ink: 0 })
        });
        groups.filter(|group| group.0).map(|group| group.1).collect()
    }

    /// The strip as groups of equal rows, as large as they come or a row each.
    fn coded(width: usize, rows: &[Vec<bool>], grouped: bool) -> Vec<u8> {
        let (mut coder, mut out) = (G4::new(width as u32), Vec::new());
        // A strip before: what it leaves must not matter.
        coder.rows(&[Run { start: 0, end: 1, ink: 0 }], 3);
        coder.end(&mut out);
        out.clear();
        for group in rows.chunk_by(|a, b| grouped && a == b) {
            coder.rows(&runs(&group[0]), group.len() as u32);
        }
        coder.end(&mut out);
        out
    }

    fn check(width: usize, rows: &[Vec<bool>]) {
        let bytes = coded(width, rows, true);
        assert_eq!(bytes, coded(width, rows, false), "{width}");
        let text: String = bytes.iter().map(|byte| format!("{byte:08b}")).collect();
        let expected = by_the_book(width, rows);
        assert!(text.len() < expected.len() + 8 && text.trim_end_matches('0') == expected.trim_end_matches('0'), "{width} {rows:?}");
        // A decoder that is not ours.
        let (width, mut read) = (width as u32, Vec::new());
        fax::decoder::decode_g4(bytes.iter().copied(), width, None, |changes| {
            read.push(fax::decoder::pels(changes, width).map(|colour| colour == fax::Color::Black).collect::<Vec<_>>());
        });
        assert_eq!(read, rows, "{width}");
    }

    proptest! {
        #[test]
        fn lines_are_coded_by_the_book(
            width in prop_oneof![1..10usize, 1..200usize, 2000..9000usize],
            rows in prop::collection::vec((0..6u8, prop::collection::vec((0..1000u32, -4..5i32), 0..12), 1..5usize), 1..12),
        ) {
            let mut all: Vec<Vec<bool>> = Vec::new();
            for (kind, changes, n) in rows {
                let mut row = match kind {
                    0 => vec![false; width],
                    1 => vec![true; width],
                    2 => (0..width).map(|x| x % 2 == changes.len() % 2).collect(),
                    _ => all.last().cloned().unwrap_or(vec![false; width]),
                };
                // Flips from somewhere to somewhere, or a few pixels beside a change that is there.
                for (at, beside) in changes {
                    let at = at as usize * width / 1000;
                    let near = (at..width).find(|&x| x > 0 && row[x] != row[x - 1]);
                    let range = match near {
                        Some(x) if !at.is_multiple_of(3) => (x as i32 + beside.min(0)).max(0) as usize..(x as i32 + beside.max(0)) as usize,
                        _ => at..at + (beside.unsigned_abs() as usize + 1) * width / 9,
                    };
                    row[range.start.min(width)..range.end.min(width)].iter_mut().for_each(|pixel| *pixel = !*pixel);
                }
                all.extend(std::iter::repeat_n(row, n));
            }
            check(width, &all);
        }
    }

    /// Every line of a few pixels below every other.
    #[test]
    fn all_pairs_of_short_lines() {
        for width in 1..=7 {
            let row = |bits: usize| (0..width).map(|x| bits >> x & 1 == 1).collect::<Vec<bool>>();
            for (above, line) in (0..1 << width).flat_map(|above| (0..1 << width).map(move |line| (above, line))) {
                check(width, &[row(above), row(line)]);
            }
        }
    }

    /// Every length of a run up to where make-up codes are repeated, in both colours; and the widest line.
    #[test]
    fn runs_of_all_lengths() {
        let width = 5400;
        for run in (0..2700).chain([5118, 5119, 5120, 5121, 5183, 5184, 5185]) {
            let mut row = vec![false; width];
            row[10..10 + run].fill(true);
            let inverse = row.iter().map(|pixel| !pixel).collect();
            check(width, &[row, vec![false; width], inverse]);
        }
        let width = 1 << 20;
        let mut row = vec![false; width];
        row[width - 1] = true;
        check(width, &[row, vec![true; width], vec![false; width]]);
    }

    #[test]
    fn white_lines_are_a_bit_each() {
        let (mut coder, mut out) = (G4::new(79_465), Vec::new());
        coder.rows(&[], 64);
        coder.end(&mut out);
        assert_eq!(out, [&[0xff; 8][..], &[0x00, 0x10, 0x01]].concat());
    }
}
