//! What differs between a line and the one above it.
//!
//! ```text
//!   above    aaaaa     bbb
//!   line     aaaaaa    b cc
//!   changes       a     .cc       each of one ink, or of paper
//! ```
//!
//! Drawings are coherent from line to line: who keeps a painted row paints, compares and compresses what changes alone.

use std::ops::Range;

use crate::run::Run;

/// Fills `changes` with the pixels in which the line of runs `new` differs from that of runs `old`: runs of what is there now, of which ink 0 is
/// paper, and the inks count from 1.
pub fn changes(old: &[Run], new: &[Run], changes: &mut Vec<Run>) {
    changes.clear();
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

/// Changed bytes that are so near each other are looked at together with what lies between.
const NEAR: usize = 64;

/// Fills `stretches` with the bytes of a row that hold those pixels, of `depth` bits each: in order, apart from each other.
pub fn stretches(changes: &[Run], depth: usize, stretches: &mut Vec<Range<usize>>) {
    stretches.clear();
    for run in changes {
        let (start, end) = (run.start as usize * depth / 8, (run.end as usize * depth).div_ceil(8));
        match stretches.last_mut() {
            Some(last) if start <= last.end + NEAR => last.end = end,
            _ => stretches.push(start..end),
        }
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
        fn changes_are_the_pixels_that_differ(
            pieces in prop::collection::vec((1..9usize, 0..3u32, prop_oneof![Just(None), (0..3u32).prop_map(Some)]), 0..12),
        ) {
            let line = |pixel: fn(u32, Option<u32>) -> u32| -> Vec<u32> {
                pieces.iter().flat_map(|&(n, old, new)| std::iter::repeat_n(pixel(old, new), n)).collect()
            };
            let (old, new) = (line(|old, _| old), line(|old, new| new.unwrap_or(old)));
            let mut found = vec![Run { start: 7, end: 9, ink: 1 }];
            changes(&runs(&old), &runs(&new), &mut found);
            prop_assert!(found.windows(2).all(|pair| pair[0].end <= pair[1].start));
            let mut painted = old.clone();
            for run in &found {
                prop_assert!(old[run.start as usize..run.end as usize].iter().all(|pixel| *pixel != run.ink));
                painted[run.start as usize..run.end as usize].fill(run.ink);
            }
            prop_assert_eq!(painted, new);
        }

        #[test]
        fn stretches_hold_all_changes(pieces in prop::collection::vec((1..900u32, 1..90u32), 0..9), depth in prop_oneof![Just(1), Just(2), Just(4), Just(8), Just(24)]) {
            let mut start = 0;
            let changed: Vec<Run> = pieces.iter().map(|&(gap, n)| {
                start += gap + n;
                Run { start: start - n, end: start, ink: 0 }
            }).collect();
            let mut found = Vec::new();
            stretches(&changed, depth, &mut found);
            prop_assert!(found.windows(2).all(|pair| pair[0].end + NEAR < pair[1].start));
            for run in changed {
                let bits = run.start as usize * depth..run.end as usize * depth;
                prop_assert!(found.iter().any(|bytes| bytes.start * 8 <= bits.start && bits.end <= bytes.end * 8));
            }
        }
    }
}
