//! A straight line as columns: for every scanline the first pixel whose centre is not left of it, exactly.
//!
//! A line meets the centre of scanline `row` at `x(row) = (a + b row) / d` pixels, counted from the centre of pixel 0, with integers
//! a, b and d > 0; its column there is `ceil(x)`. Stepping down one scanline adds `b / d` ("CSG" in ARCHITECTURE.md, section 2.1.1). Here that is
//! one addition in fixed point, and exact all the same:
//!
//! ```text
//!    column   0   1   2   3
//!    row 0  | . | .\| . |        the line passes right of centre 1: column 2
//!    row 1  | . | . |\. |        it passes left of centre 2:        column 2
//!    row 2  | . | . | . \        it passes right of centre 2:       column 3
//! ```
//!
//! The numerator is an integer, so `ceil(x) = floor((a + b row - 1/2) / d) + 1`, and the number whose floor is taken is never nearer than `1 / 2d`
//! to an integer. An approximation that is off by less has the same floor. In units of 2^-43 px the start and the step are rounded to the
//! nearest, which is off by 2^-44 px each (and 2^-51, because it is done in doubles), so on the n-th scanline by little more than `n 2^-44` in all: less than
//! `1 / 2d` as long as `n d < 0.99 2^43`. A [`Line`] is made for `n d <= 2^42` only. Lines that are too tall for that, leave the page at its sides, or have far ends, become several such
//! lines in [`exact`], where the edges are built; so nothing has to be set right on the way down.
//!
//! A straight line stays one under every affine and projective map, so this type serves outlines, silhouettes and homogeneous
//! edges alike.

// A quotient and a remainder, stepped in integers, need no bound, but three numbers and a branch; and an exact renewal on the way, every so many
// scanlines, is one more thing that can happen to an edge. Pieces of a line that follow each other in one chain already are such renewals.

pub mod exact;

use crate::grid::{SUB, first_centre};

/// Bits of a position's fraction. A page's 2^20 columns and a bit for those that are wider than a page's fill the rest of 64.
pub const FRACTION: u32 = 43;

const ONE: f64 = (1_u64 << FRACTION) as f64;

/// Most that the number of scanlines times the denominator may be.
const BOUND: i64 = 1 << (FRACTION - 1);

/// A line at one scanline, ready to step to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// `(a + b row - 1/2) / d + 1` in units of 2^-43 px.
    at: u64,
    /// `b / d` in the same units, modulo 2^64.
    step: u64,
}

impl Line {
    /// The line that is at `a / d` on its first scanline and `b / d` further right on each next one, for `rows` scanlines with
    /// `rows d` at most 2^42. On all of them the columns must be on a page: `0..=2^20`.
    #[inline]
    fn new(a: i64, b: i64, d: i64, rows: u32) -> Line {
        debug_assert!(fits(d, rows));
        // Of one scanline the slope does not matter, and could be any.
        let line = Line::rounded(a, if rows == 1 { 0 } else { b }, d);
        if rows == 1 { Line::vertical(line.column()) } else { line }
    }

    /// The same, whatever the number of scanlines.
    #[inline]
    fn rounded(a: i64, b: i64, d: i64) -> Line {
        let inverse = 1.0 / d as f64;
        // Whole pixels, to the nearest, and what is left in units of 1/d, of either sign.
        let split = |x: i64| {
            let whole = nearest(x as f64 * inverse);
            let rest = x - whole * d;
            debug_assert!(rest.abs() < d);
            (whole, rest as f64)
        };
        let fixed = |whole: i64, rest: f64| ((whole as u64) << FRACTION).wrapping_add(nearest(rest * inverse * ONE) as u64);
        let ((left, rest), (step, slope)) = (split(a), split(b));
        Line { at: fixed(left + 1, rest - 0.5), step: fixed(step, slope) }
    }

    /// The vertical line with this column, at most 2^20.
    pub const fn vertical(column: u32) -> Line {
        Line { at: ((column as u64) << FRACTION) + (1 << (FRACTION - 1)), step: 0 }
    }

    /// The line through two points in 1/256 px, `top` above `bottom`, at scanline `row`, the first of `rows` that it meets on a page of `width` columns.
    /// Between two centres of pixels it is vertical. None if it leaves the page at a side, or is too tall for one line: see [`exact::pieces`].
    #[inline]
    pub fn through(top: [i64; 2], bottom: [i64; 2], row: u32, rows: u32, width: u32) -> Option<Line> {
        // Between the ends' columns lie all others, and with ends on the page 64 bits hold every product below.
        let [from, to] = [top[0], bottom[0]].map(first_centre);
        let page = 0..=i64::from(width);
        if !page.contains(&from) || !page.contains(&to) {
            return None;
        }
        if from == to {
            return Some(Line::vertical(from as u32));
        }
        let [dx, dy] = [bottom[0] - top[0], bottom[1] - top[1]];
        let d = dy * SUB;
        if dy > BOUND / SUB || !fits(d, rows) {
            return None;
        }
        let down = i64::from(row) * SUB + SUB / 2 - top[1];
        let a = (top[0] - SUB / 2) * dy + down * dx;
        Some(Line::new(a, dx * SUB, d, rows))
    }

    /// The line of a position and a step, as [`Line::parts`] gives them.
    pub fn of_parts(at: u64, step: u64) -> Line {
        Line { at, step }
    }

    /// The column at this scanline.
    #[inline]
    pub fn column(self) -> u32 {
        column(self.at)
    }

    /// Whether the column is the same on all scanlines.
    pub fn is_vertical(self) -> bool {
        self.step == 0
    }

    /// Goes down one scanline.
    #[inline]
    pub fn step(&mut self) {
        self.at = self.at.wrapping_add(self.step);
    }

    /// The line `rows` scanlines further down: the same as stepping so often.
    #[must_use]
    pub fn down(self, rows: u32) -> Line {
        Line { at: self.at.wrapping_add(self.step.wrapping_mul(rows.into())), ..self }
    }

    /// Position and step, for those who keep many lines in arrays: a step adds one to the other, modulo 2^64; [`column()`] reads the position.
    #[inline]
    pub fn parts(self) -> (u64, u64) {
        (self.at, self.step)
    }
}

/// The column of a position of [`Line::parts`].
#[inline]
pub fn column(at: u64) -> u32 {
    (at >> FRACTION) as u32
}

/// Whether so many scanlines of a line with this denominator are exact.
fn fits(d: i64, rows: u32) -> bool {
    d.checked_mul(rows.into()).is_some_and(|product| product <= BOUND)
}

/// Rounds a number below 2^50 in size to the nearest integer: by adding what pushes the fraction out of a double.
fn nearest(x: f64) -> i64 {
    const PUSH: f64 = (3_u64 << 51) as f64;
    (x + PUSH).to_bits() as i64 - PUSH.to_bits() as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The columns by the definition, in 128-bit integers.
    fn brute(a: i64, b: i64, d: i64, row: i64) -> i64 {
        let (x, d) = (i128::from(a) + i128::from(b) * i128::from(row), i128::from(d));
        i64::try_from(x.div_euclid(d) + i128::from(x.rem_euclid(d) != 0)).unwrap()
    }

    /// The first pixel centre not left of the line, by trying pixels with a cross product: no division, no stepping.
    fn crossed(top: [i64; 2], bottom: [i64; 2], row: i64, guess: i64) -> i64 {
        let left_of_line = |i: i64| {
            let (x, y) = (i128::from(i * SUB + SUB / 2 - top[0]), i128::from(row * SUB + SUB / 2 - top[1]));
            x * i128::from(bottom[1] - top[1]) < y * i128::from(bottom[0] - top[0])
        };
        let mut i = guess - 3;
        assert!(left_of_line(i) && !left_of_line(guess + 3), "the guess is near");
        while left_of_line(i) {
            i += 1;
        }
        i
    }

    #[test]
    fn columns_are_exact_on_random_lines() {
        let mut seed = 3u64;
        let mut random = |n: i64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 20) as i64 % n
        };
        let (mut lines, mut tall) = (0, 0);
        for _ in 0..4000 {
            let size = [40, 3000, 60_000, 6_000_000][random(4) as usize];
            let top = [random(size), random(size) - size / 2];
            let bottom = [random(size), top[1] + 1 + random(size)];
            let rows = first_centre(top[1]).max(0)..first_centre(bottom[1]);
            if rows.is_empty() {
                continue;
            }
            let many = u32::try_from(rows.end - rows.start).unwrap();
            let Some(first) = Line::through(top, bottom, rows.start as u32, many, 1 << 20) else {
                tall += 1;
                continue;
            };
            let mut line = first;
            lines += 1;
            for row in rows.clone() {
                let share = (row * SUB + SUB / 2 - top[1]) as f64 / (bottom[1] - top[1]) as f64;
                let guess = ((top[0] as f64 + share * (bottom[0] - top[0]) as f64 - 128.0) / 256.0).ceil() as i64;
                assert_eq!(i64::from(line.column()), crossed(top, bottom, row, guess), "{top:?} {bottom:?} row {row}");
                assert_eq!(line, first.down(u32::try_from(row - rows.start).unwrap()));
                line.step();
            }
        }
        assert!(lines > 2000 && tall > 0, "{lines} {tall}");
    }

    /// Lines of `rows` scanlines with `rows d` about `product`, whose numerator on a late scanline is 0 or 1 modulo d: exactly on a pixel's centre, or as
    /// little right of it as a line can be. Counts the columns that are wrong.
    fn wrong_beside_centres(product: i64) -> (usize, usize) {
        let mut seed = 5u64;
        let mut random = |n: i64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 20) as i64 % n
        };
        let (mut wrong, mut tried) = (0, 0);
        for rows in [2, 3, 17, 100, 1000, 5792, 20_000] {
            for _ in 0..200 {
                let d = product / rows - random(1000);
                // Half a unit off the nearest step, as far as there is such a numerator.
                let b = {
                    let unit = d as f64 / ONE;
                    let off = (random(1 << 20) as f64 + 0.5) * unit;
                    if unit > 1e-3 { off.round() as i64 } else { random(d) }
                };
                let row = rows - 1 - random(2);
                for near in [0, 1] {
                    // a + b row = near + column d
                    let a = (i128::from(near) - i128::from(b) * i128::from(row)).rem_euclid(i128::from(d)) as i64;
                    let line = Line::rounded(a, b, d);
                    tried += 1;
                    wrong += usize::from(i64::from(line.down(row as u32).column()) != brute(a, b, d, row));
                }
            }
        }
        (wrong, tried)
    }

    #[test]
    fn the_bound_holds_beside_pixel_centres_and_is_needed() {
        let (wrong, tried) = wrong_beside_centres(BOUND);
        assert_eq!((wrong, tried), (0, 2800));
        assert!(
            wrong_beside_centres(BOUND << 4).0 > 100,
            "the same lines, sixteen times taller, go wrong: {:?}",
            wrong_beside_centres(BOUND << 4)
        );
    }

    #[test]
    fn a_line_across_the_widest_page() {
        let width = 1_i64 << 20;
        for (from, to) in [(0, width), (width, 0)] {
            let top = [from * SUB, -SUB / 2];
            let mut line = Line::through(top, [to * SUB, 3 * SUB / 2], 0, 2, 1 << 20).unwrap();
            assert_eq!(i64::from(line.column()), brute(256 * from - 128 + 128 * (to - from), 0, 256, 0));
            line.step();
            assert_eq!(i64::from(line.column()), brute(256 * to - 128, 0, 256, 0));
        }
        assert_eq!(Line::vertical(1 << 20).column(), 1 << 20);
    }
}
