//! What differs between a line and the one above it.
//!
//! ```text
//!   above    aaaaa     bbb
//!   line     aaaaaa    b cc
//!   changes       a     .cc       each of one ink, or of paper
//! ```
//!
//! Drawings are coherent from line to line: who keeps a painted row paints, compares and compresses what changes alone. Where runs are many
//! for the bytes that they are, looking for changes would cost more than painting all again.

use std::ops::Range;

use crate::run::Run;

/// Bytes of a row for which a run or a change is worth looking at by itself.
const NEAR: usize = 64;

/// The line that a row shows, and where it differs from the one shown before.
pub struct Shown {
    width: u32,
    /// Bits of a pixel.
    depth: u32,
    runs: Vec<Run>,
    changes: Vec<Run>,
}

impl Shown {
    /// Paper.
    pub fn new(width: u32, depth: u32) -> Shown {
        Shown { width, depth, runs: Vec::new(), changes: Vec::new() }
    }

    /// Shows another line.
    pub fn show(&mut self, runs: &[Run]) {
        self.changes.clear();
        if runs.len() * NEAR <= self.row_bytes() {
            changes(&self.runs, runs, &mut self.changes);
        } else {
            self.changes.push(self.paper());
            self.changes.extend(runs.iter().map(|run| Run { ink: run.ink + 1, ..*run }));
        }
        self.runs.clear();
        self.runs.extend_from_slice(runs);
    }

    /// A line of paper, as a change.
    pub fn paper(&self) -> Run {
        Run { start: 0, end: self.width, ink: 0 }
    }

    /// Bytes of the row.
    pub fn row_bytes(&self) -> usize {
        (self.width as usize * self.depth as usize).div_ceil(8)
    }

    /// The runs of the line.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// What makes the line of the one before, painted in this order: runs of which ink 0 is paper, and the inks count from 1.
    pub fn changes(&self) -> &[Run] {
        &self.changes
    }

    /// Fills `stretches` with bytes of the row that hold all changes: in order, apart from each other.
    pub fn stretches(&self, stretches: &mut Vec<Range<usize>>) {
        stretches.clear();
        for run in &self.changes {
            let [start, end] = [run.start, run.end].map(|column| column as usize * self.depth as usize);
            let (start, end) = (start / 8, end.div_ceil(8));
            match stretches.last_mut() {
                Some(last) if start <= last.end + NEAR => last.end = last.end.max(end),
                _ => stretches.push(start..end),
            }
        }
    }
}

/// Adds the pixels in which the line of runs `new` differs from that of runs `old` to `changes`.
fn changes(old: &[Run], new: &[Run], changes: &mut Vec<Run>) {
    let (mut old, mut new, mut start) = (old, new, 0);
    loop {
        let end = match (old, new) {
            ([], []) => return,
            ([was, ..], [is, ..]) if was == is => was.end,
            _ => {
                let ((was, was_end), (is, is_end)) = (at(old, start), at(new, start));
                let end = was_end.min(is_end);
                if was != is {
                    changes.push(Run { start, end, ink: is });
                }
                end
            }
        };
        start = end;
        old = behind(old, end);
        new = behind(new, end);
    }
}

/// What a column shows, and where that ends. Runs that end before it are not among `runs`.
fn at(runs: &[Run], column: u32) -> (u32, u32) {
    match runs.first() {
        Some(run) if run.start <= column => (run.ink + 1, run.end),
        Some(run) => (0, run.start),
        None => (0, u32::MAX),
    }
}

/// The runs without the first if that ends at `end`.
fn behind(runs: &[Run], end: u32) -> &[Run] {
    match runs {
        [first, rest @ ..] if first.end == end => rest,
        _ => runs,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Maximal runs of a line of pixels, 0 paper.
    fn runs(pixels: &[u32]) -> Vec<Run> {
        let mut start = 0;
        let groups = pixels.chunk_by(|a, b| a == b).map(|group| {
            start += group.len() as u32;
            (start - group.len() as u32, start, group[0])
        });
        groups.filter(|group| group.2 > 0).map(|(start, end, pixel)| Run { start, end, ink: pixel - 1 }).collect()
    }

    proptest! {
        #[test]
        fn what_changes_makes_the_next_line(
            pieces in prop::collection::vec((1..900usize, 0..3u32, prop_oneof![Just(None), (0..3u32).prop_map(Some)]), 0..12),
            depth in prop_oneof![Just(1), Just(2), Just(4), Just(8), Just(24)],
        ) {
            let line = |pixel: fn(u32, Option<u32>) -> u32| -> Vec<u32> {
                pieces.iter().flat_map(|&(n, old, new)| std::iter::repeat_n(pixel(old, new), n)).collect()
            };
            let (old, new) = (line(|old, _| old), line(|old, new| new.unwrap_or(old)));
            let (mut shown, mut stretches) = (Shown::new(old.len() as u32, depth), Vec::new());
            for line in [&old, &new] {
                shown.show(&runs(line));
                shown.stretches(&mut stretches);
            }
            prop_assert_eq!(shown.runs(), runs(&new));
            prop_assert!(stretches.windows(2).all(|pair| pair[0].end + NEAR < pair[1].start));
            prop_assert!(stretches.iter().all(|bytes| bytes.end <= shown.row_bytes()));
            let mut painted = old;
            for run in shown.changes() {
                painted[run.start as usize..run.end as usize].fill(run.ink);
                let bits = run.start as usize * depth as usize..run.end as usize * depth as usize;
                prop_assert!(stretches.iter().any(|bytes| bytes.start * 8 <= bits.start && bits.end <= bytes.end * 8));
            }
            prop_assert_eq!(painted, new);
        }

        #[test]
        fn what_stays_is_no_change(pixels in prop::collection::vec((0..3u32, 0..3u32), 0..40)) {
            let (old, new): (Vec<u32>, Vec<u32>) = pixels.into_iter().unzip();
            let mut found = Vec::new();
            changes(&runs(&old), &runs(&new), &mut found);
            let changed: Vec<u32> = found.iter().flat_map(|run| run.start..run.end).collect();
            let differ: Vec<u32> = (0..old.len() as u32).filter(|&x| old[x as usize] != new[x as usize]).collect();
            prop_assert_eq!(changed, differ);
        }
    }
}
