//! Lines that are kept for a while, and written apart from those above them: what lets threads share the work of one writer.
//!
//! ```text
//!   strip     | = = = - - - - - - - - - = = |      lines kept, as runs
//!   part            |---------------|              bytes of those that can be written without their neighbours
//!   the rest  |=====|               |===|          lines for the raster's own writer, before and behind
//! ```
//!
//! A line of a pixmap stands for itself, so a part is the whole strip; a record of equal lines may have begun above the strip or go on
//! below it; a segment of a PNG begins and ends at certain lines.

use std::ops::Range;

use crate::run::{Lines, Run};

/// Lines that follow each other, with their runs.
#[derive(Clone, Debug, Default)]
pub struct Strip {
    start: u32,
    /// For every group of equal lines, the line behind it and the end of its runs.
    groups: Vec<(u32, usize)>,
    runs: Vec<Run>,
}

impl Strip {
    /// Forgets all lines.
    pub fn clear(&mut self) {
        self.groups.clear();
        self.runs.clear();
    }

    /// Keeps the next lines (they must follow those kept before).
    pub fn push(&mut self, lines: Lines<'_>) {
        if self.groups.is_empty() {
            self.start = lines.y;
        }
        debug_assert_eq!(self.lines().end, lines.y, "lines follow each other");
        self.runs.extend_from_slice(lines.runs);
        self.groups.push((lines.y + lines.n, self.runs.len()));
    }

    /// The lines it holds.
    pub fn lines(&self) -> Range<u32> {
        self.start..self.groups.last().map_or(self.start, |group| group.0)
    }

    /// How many runs are stored.
    pub fn stored_runs(&self) -> usize {
        self.runs.len()
    }

    /// Those of the lines that are in `range`, in the groups in which they were kept.
    pub fn within(&self, range: Range<u32>) -> impl Iterator<Item = Lines<'_>> {
        let first = self.groups.partition_point(|group| group.0 <= range.start);
        let before = first.checked_sub(1).map_or((self.start, 0), |i| self.groups[i]);
        let groups = self.groups[first..].iter().scan(before, |before, &group| Some((std::mem::replace(before, group), group)));
        groups.map_while(move |((start, first_run), (end, end_run))| {
            let (y, end) = (start.max(range.start), end.min(range.end));
            (y < end).then(|| Lines { y, n: end - y, runs: &self.runs[first_run..end_run] })
        })
    }
}

/// What a writer made of lines out of a strip.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Part {
    /// The lines whose bytes it is.
    pub lines: Range<u32>,
    /// What the raster's own writer has to know of them: sums that only the format understands.
    pub tally: [u64; 3],
}

impl Part {
    /// No line of a strip: all are left to the raster's own writer.
    pub fn none(strip: &Strip) -> Part {
        let start = strip.lines().start;
        Part { lines: start..start, tally: [0; 3] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn any_range_holds_the_lines_that_were_kept(
            start in 0u32..5, groups in prop::collection::vec((1u32..9, 0u32..3), 1..9), cut in (0u32..80, 0u32..80),
        ) {
            let (mut strip, mut all) = (Strip::default(), Vec::new());
            for &(n, runs) in &groups {
                let runs: Vec<Run> = (0..runs).map(|i| Run { start: 9 * i, end: 9 * i + n, ink: 0 }).collect();
                let y = start + all.len() as u32;
                strip.push(Lines { y, n, runs: &runs });
                all.extend((y..y + n).map(|y| (y, runs.clone())));
            }
            prop_assert_eq!(strip.lines(), start..start + all.len() as u32);
            let range = cut.0.min(cut.1)..cut.0.max(cut.1);
            let expected: Vec<_> = all.into_iter().filter(|line| range.contains(&line.0)).collect();
            let got: Vec<_> = strip.within(range).flat_map(|l| (l.y..l.y + l.n).map(move |y| (y, l.runs.to_vec()))).collect();
            prop_assert_eq!(got, expected);
        }
    }
}
