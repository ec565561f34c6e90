//! Anti-aliasing: a picture on a finer grid, averaged over squares of its pixels.
//!
//! ```text
//!     finer lines    ..####    n = 2: a pixel is the mean of its n² finer pixels, paper among them
//!                    .#####
//!     the page       \/\/\/    here 1/4, 4/4, 4/4 of the face and 3/4 of paper in the first
//! ```
//!
//! The mean is that of the sRGB bytes as they are, of each channel for itself, rounded to the nearest, halves up. What has been painted in one of its finer pixels is
//! a pixel that is painted, whatever colour comes of it. Runs are added to sums of differences along the page's line: a finer line costs its runs, not its pixels.

use std::ops::Range;

use crate::run::{Rgb, Run};

/// Sums along a line of the page: by how much the sum over finer pixels changes from one pixel to the next.
#[derive(Debug)]
pub(super) struct Average {
    /// Finer pixels along a side of a pixel.
    n: u32,
    paper: [i32; 3],
    /// What is above paper in red, green and blue, and how many finer pixels are painted.
    changes: Vec<[i32; 4]>,
    /// The first pixel that changes, and behind the last.
    from: usize,
    to: usize,
}

impl Average {
    /// Of pages so wide, in pixels of their own.
    pub(super) fn new(n: u32, width: u32, paper: Rgb) -> Average {
        let changes = vec![[0; 4]; width as usize + 2];
        Average { n, paper: paper.map(i32::from), from: changes.len(), to: 0, changes }
    }

    /// Adds a finer line.
    pub(super) fn add(&mut self, runs: &[Run]) {
        let [Some(first), Some(last)] = [runs.first(), runs.last()] else { return };
        self.from = self.from.min((first.start / self.n) as usize);
        self.to = self.to.max((last.end / self.n) as usize + 2);
        let n = self.n as i32;
        for run in runs {
            let [_, red, green, blue] = run.ink.to_be_bytes().map(i32::from);
            let [r, g, b] = self.paper;
            let ink = [red - r, green - g, blue - b, 1];
            let mut change = |pixel: u32, by: i32| {
                self.changes[pixel as usize].iter_mut().zip(ink).for_each(|(sum, ink)| *sum += by * ink);
            };
            // So many finer pixels of the first pixel are left of the run, and so many of the last are in it.
            let (left, rest) = ((run.start % self.n) as i32, (run.end % self.n) as i32);
            let (first, last) = (run.start / self.n, run.end / self.n);
            change(first, n - left);
            change(first + 1, left);
            change(last, rest - n);
            change(last + 1, -rest);
        }
    }

    /// Gives the runs of the page's line, and begins the next.
    pub(super) fn finish(&mut self, runs: &mut Vec<Run>) {
        runs.clear();
        let of = (self.n * self.n) as i32;
        let mut sum = [0; 4];
        for (x, change) in (self.from as u32..).zip(&mut self.changes[self.from.min(self.to)..self.to]) {
            let change = std::mem::take(change);
            sum.iter_mut().zip(change).for_each(|(sum, by)| *sum += by);
            if sum[3] == 0 {
                continue;
            }
            if change == [0; 4]
                && let Some(last) = runs.last_mut()
            {
                last.end += 1;
                continue;
            }
            let mean = |i: usize| ((2 * (of * self.paper[i] + sum[i]) + of) / (2 * of)) as u32;
            push(runs, x..x + 1, mean(0) << 16 | mean(1) << 8 | mean(2));
        }
        (self.from, self.to) = (self.changes.len(), 0);
    }
}

/// Appends a run, as one with the last if that ends where it begins and shows the same.
#[inline]
pub(super) fn push(runs: &mut Vec<Run>, columns: Range<u32>, ink: u32) {
    match runs.last_mut() {
        Some(last) if last.end == columns.start && last.ink == ink => last.end = columns.end,
        _ => runs.push(Run { start: columns.start, end: columns.end, ink }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_pixel_is_the_mean_of_its_finer_pixels(
            n in 2u32..=8,
            width in 1u32..20,
            paper: Rgb,
            pieces in prop::collection::vec(prop::collection::vec((0u32..3, 1u32..30, 0u32..4), 0..6), 16),
            inks: [Rgb; 4],
        ) {
            let mut average = Average::new(n, width, paper);
            let mut runs = Vec::new();
            for lines in pieces.chunks(n as usize).filter(|lines| lines.len() == n as usize) {
                let mut pixels = vec![vec![None; (n * width) as usize]; n as usize];
                for (line, pixels) in lines.iter().zip(&mut pixels) {
                    let (mut fine, mut x) = (Vec::new(), 0);
                    for &(gap, wide, ink) in line {
                        let ink = inks[ink as usize];
                        let (start, end) = (x + gap, (x + gap + wide).min(n * width));
                        if start < end {
                            let value = u32::from_be_bytes([0, ink[0], ink[1], ink[2]]);
                            push(&mut fine, start..end, value);
                            pixels[start as usize..end as usize].fill(Some(ink));
                        }
                        x = end.max(start);
                    }
                    average.add(&fine);
                }
                average.finish(&mut runs);
                let mut shown = vec![None; width as usize];
                prop_assert!(runs.windows(2).all(|w| w[0].end < w[1].start || (w[0].end == w[1].start && w[0].ink != w[1].ink)));
                for run in &runs {
                    shown[run.start as usize..run.end as usize].fill(Some(run.ink));
                }
                for (x, shown) in shown.into_iter().enumerate() {
                    let square = || pixels.iter().flat_map(|line| &line[x * n as usize..(x + 1) * n as usize]);
                    let mean = |i: usize| {
                        let sum: f64 = square().map(|ink| f64::from(ink.unwrap_or(paper)[i])).sum();
                        (sum / f64::from(n * n) + 0.5).floor() as u32
                    };
                    let painted = square().any(Option::is_some);
                    prop_assert_eq!(shown, painted.then(|| mean(0) << 16 | mean(1) << 8 | mean(2)));
                }
            }
        }
    }
}
