//! Runs: what the sweep hands to the writers, and what the readers of line streams hand back.
//!
//! A raster is described by its [`Header`]; its lines come as [`Lines`], from top to bottom, every line
//! once. [`Merge`] turns them into records: maximal groups of equal lines, broken at multiples of
//! [`RECORD_LINES`], so that no record depends on how the page was cut into bands.

use std::ops::Range;

/// Records break at multiples of this many lines.
pub const RECORD_LINES: u32 = 4096;

/// A colour: red, green, blue, 0 to 255.
pub type Rgb = [u8; 3];

/// Pixels `start..end` of a line that show `ink`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Run {
    /// First column.
    pub start: u32,
    /// Column behind the last.
    pub end: u32,
    /// Index into [`Header::inks`].
    pub ink: u32,
}

/// What is known of a raster before its first line.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Width in pixels.
    pub width: u32,
    /// The scanlines it holds; the first is not 0 in a slice of a page.
    pub lines: Range<u32>,
    /// The distinct inks in the order of first use. One region is one ink, black.
    pub inks: Vec<Rgb>,
    /// Resolution in dots an inch, where it was asked for.
    pub dpi: Option<f64>,
}

/// The ink of a region that was given no colour.
pub const BLACK: Rgb = [0, 0, 0];

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
    /// Whether the invariants of the type hold on a page `width` pixels wide with `inks` inks.
    pub fn check(&self, width: u32, inks: usize) -> bool {
        let ordered = self.runs.windows(2).all(|w| w[0].end < w[1].start || (w[0].end == w[1].start && w[0].ink != w[1].ink));
        self.n >= 1 && ordered && self.runs.iter().all(|r| r.start < r.end && r.end <= width && (r.ink as usize) < inks)
    }
}

/// Gathers lines into records: maximal groups of equal lines within [`RECORD_LINES`].
///
/// ```text
/// in   y0 n1 [a]   y1 n2 [a]   y3 n1 [b] ...      out   y0 n3 [a]   y3 n1 [b] ...
/// ```
#[derive(Debug, Default)]
pub struct Merge {
    y: u32,
    n: u32,
    runs: Vec<Run>,
}

impl Merge {
    /// Takes the next lines (they must follow those taken before) and hands finished records to `emit`.
    /// `lines` may span a record boundary.
    pub fn push(&mut self, lines: Lines<'_>, mut emit: impl FnMut(Lines<'_>)) {
        debug_assert!(self.n == 0 || self.y + self.n == lines.y, "lines follow each other");
        let (mut y, mut left) = (lines.y, lines.n);
        while left > 0 {
            if self.n > 0 && (y.is_multiple_of(RECORD_LINES) || self.runs != lines.runs) {
                self.flush(&mut emit);
            }
            if self.n == 0 {
                self.y = y;
                self.runs.clear();
                self.runs.extend_from_slice(lines.runs);
            }
            let take = left.min(RECORD_LINES - y % RECORD_LINES);
            self.n += take;
            y += take;
            left -= take;
        }
    }

    /// Hands out the record that is still open, if there is one.
    pub fn flush(&mut self, mut emit: impl FnMut(Lines<'_>)) {
        if self.n > 0 {
            emit(Lines { y: self.y, n: self.n, runs: &self.runs });
            self.n = 0;
        }
    }
}
