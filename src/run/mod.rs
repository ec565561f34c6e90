//! Runs: what the sweep hands to the writers, and what the readers of line streams hand back.
//!
//! A raster is described by its [`Header`]; its lines come as [`Lines`], from top to bottom, every line
//! once. [`Merge`] turns them into groups of equal lines, broken at multiples of a number of lines ([`RECORD_LINES`] in
//! line streams), so that no group depends on how the page was cut into bands.

mod colour;
mod inks;
mod sheet;

pub use colour::{BLACK, Hex, Rgb, WHITE};
pub use inks::{Inks, MAX_INKS, Told, colour_of, ink_of};
pub use sheet::{Pixels, Sheet};

use std::ops::Range;

/// Records break at multiples of this many lines.
pub const RECORD_LINES: u32 = 4096;

/// Pixels `start..end` of a line that show `ink`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Run {
    /// First column.
    pub start: u32,
    /// Column behind the last.
    pub end: u32,
    /// What they show: [`Header::inks`] says how.
    pub ink: u32,
}

/// What is known of a raster before its first line.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Width in pixels.
    pub width: u32,
    /// The scanlines it holds; the first is not 0 in a slice of a page.
    pub lines: Range<u32>,
    /// What its runs show, and what paper is.
    pub inks: Inks,
    /// Resolution in dots an inch, where it was asked for.
    pub dpi: Option<f64>,
    /// Which page it is, where a file holds several.
    pub sheet: Sheet,
}

impl Header {
    /// Number of lines.
    pub fn height(&self) -> u32 {
        self.lines.end - self.lines.start
    }
}

/// `n` equal lines, the first of them at `y`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lines<'a> {
    /// Number of the first line on the page.
    pub y: u32,
    /// How many lines, at least 1.
    pub n: u32,
    /// Maximal runs, sorted, not empty, not overlapping; runs that touch have different inks.
    pub runs: &'a [Run],
}

impl Lines<'_> {
    /// Whether the invariants of the type hold in a raster of that width and those inks.
    pub fn check(&self, header: &Header) -> bool {
        let (width, inks) = (header.width, header.inks.end());
        let ordered = self.runs.windows(2).all(|w| w[0].end < w[1].start || (w[0].end == w[1].start && w[0].ink != w[1].ink));
        self.n >= 1 && ordered && self.runs.iter().all(|r| r.start < r.end && r.end <= width && r.ink < inks)
    }
}

/// Gathers lines into groups: equal lines, as many as follow each other between two multiples of a number of lines.
///
/// ```text
/// in   y0 n1 [a]   y1 n2 [a]   y3 n1 [b] ...      out   y0 n3 [a]   y3 n1 [b] ...
/// ```
#[derive(Debug)]
pub struct Merge {
    most: u32,
    y: u32,
    n: u32,
    runs: Vec<Run>,
}

impl Merge {
    /// Groups that break at multiples of `most` lines of the page.
    pub fn new(most: u32) -> Merge {
        Merge { most, y: 0, n: 0, runs: Vec::new() }
    }

    /// Takes the next lines (they must follow those taken before) and hands finished groups to `emit`.
    /// `lines` may span a multiple at which groups break.
    pub fn push(&mut self, lines: Lines<'_>, mut emit: impl FnMut(Lines<'_>)) {
        debug_assert!(self.n == 0 || self.y + self.n == lines.y, "lines follow each other");
        let (mut y, end) = (lines.y, lines.y + lines.n);
        while y < end {
            if y.is_multiple_of(self.most) || self.runs != lines.runs {
                self.flush(&mut emit);
            }
            if self.n == 0 {
                self.y = y;
                self.runs.clear();
                self.runs.extend_from_slice(lines.runs);
            }
            let take = (end - y).min(self.most - y % self.most);
            self.n += take;
            y += take;
        }
    }

    /// Hands out the group that is still open, if there is one.
    pub fn flush(&mut self, emit: impl FnOnce(Lines<'_>)) {
        if self.n > 0 {
            emit(Lines { y: self.y, n: self.n, runs: &self.runs });
            self.n = 0;
        }
    }

    /// Forgets the group that is still open, and says at which line it began. There must be one.
    pub fn forget(&mut self) -> u32 {
        debug_assert!(self.n > 0, "lines were taken");
        self.n = 0;
        self.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The lines one by one, and what they are as records by the rule: a record begins at the first line, at a multiple of
    /// 4096 and where a line differs from the one above.
    fn by_rule(first: u32, lines: &[Vec<Run>]) -> Vec<(u32, u32, Vec<Run>)> {
        let mut records: Vec<(u32, u32, Vec<Run>)> = Vec::new();
        for (y, runs) in (first..).zip(lines) {
            match records.last_mut() {
                Some((_, n, last)) if last == runs && y % 4096 != 0 => *n += 1,
                _ => records.push((y, 1, runs.clone())),
            }
        }
        records
    }

    proptest! {
        #[test]
        fn records_are_those_of_the_rule(
            first in prop_oneof![0u32..3, 4090..4100u32, 8180..8200u32],
            pieces in prop::collection::vec((prop_oneof![1u32..20, 4090..4100u32, 8190..8200u32], 0u32..3), 1..12),
        ) {
            let row = |kind: u32| (0..kind).map(|i| Run { start: 10 * i, end: 10 * i + 5, ink: 0 }).collect::<Vec<_>>();
            let (mut merge, mut y, mut got, mut lines) = (Merge::new(RECORD_LINES), first, Vec::new(), Vec::new());
            let mut keep = |r: Lines<'_>| got.push((r.y, r.n, r.runs.to_vec()));
            for (n, kind) in pieces {
                let runs = row(kind);
                merge.push(Lines { y, n, runs: &runs }, &mut keep);
                y += n;
                lines.resize(lines.len() + n as usize, runs);
            }
            merge.flush(&mut keep);
            merge.flush(&mut keep);
            prop_assert_eq!(got, by_rule(first, &lines));
        }
    }
}
