//! A straight line as columns: for every scanline the first pixel whose centre is not left of it, exactly.
//!
//! A line meets the centre of scanline `row` at `x(row) = (a + b row) / d` pixels, counted from the centre of pixel 0, with integers
//! a, b and d > 0; its column there is `ceil(x)`. Stepping down one scanline adds `b / d`: a whole part and a remainder, in integers
//! only ("CSG" in ARCHITECTURE.md, section 2.1.1: Bresenham's way with a trapezoid's sides). Nothing is rounded, however long the line.
//!
//! ```text
//!    column   0   1   2   3
//!    row 0  | . | .\| . |        the line passes right of centre 1: column 2
//!    row 1  | . | . |\. |        it passes left of centre 2:        column 2
//!    row 2  | . | . | . \        it passes right of centre 2:       column 3
//! ```
//!
//! A straight line stays one under every affine and projective map, so this type serves outlines, silhouettes and homogeneous
//! edges alike. [`far`] reduces lines through points far beyond the page to this type.

pub mod far;

use crate::grid::SUB;

/// A line at one scanline, ready to step to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// `ceil(x)` at this scanline.
    column: i32,
    /// Whole part of `b / d`, rounded down.
    step: i32,
    /// How far column's centre is right of the line, in 1/d px: `column d - (a + b row)`, in `0..d`.
    slack: i64,
    /// `b mod d`, in `0..d`: what a step takes from the slack.
    slope: i64,
    /// The denominator, at most 2^42.
    d: i64,
}

impl Line {
    /// The line that is at `a / d` on its first scanline and `b / d` further right on each next one.
    /// `d` is in `1..=2^42`; columns and steps must stay within 32 bits.
    pub fn new(a: i128, b: i128, d: i64) -> Line {
        let wide = i128::from(d);
        let column = a.div_euclid(wide) + i128::from(a.rem_euclid(wide) != 0);
        let narrow = |v: i128| i32::try_from(v).expect("columns near the page fit 32 bits");
        Line {
            column: narrow(column),
            step: narrow(b.div_euclid(wide)),
            slack: i64::try_from(column * wide - a).expect("below d"),
            slope: i64::try_from(b.rem_euclid(wide)).expect("below d"),
            d,
        }
    }

    /// The vertical line with this column.
    pub fn vertical(column: i32) -> Line {
        Line { column, step: 0, slack: 0, slope: 0, d: 1 }
    }

    /// The line through two near points in 1/256 px, `top` above `bottom`, at scanline `row`, which it meets. `rows` is the number of scanlines
    /// that will be asked of it: on a single one its direction does not matter and it is taken as vertical.
    pub fn through(top: [i64; 2], bottom: [i64; 2], row: u32, rows: u32) -> Line {
        let [dx, dy] = [bottom[0] - top[0], bottom[1] - top[1]].map(i128::from);
        let down = i128::from(i64::from(row) * SUB + SUB / 2 - top[1]);
        let a = (i128::from(top[0]) - i128::from(SUB / 2)) * dy + down * dx;
        let d = i64::try_from(dy).expect("near points") * SUB;
        if dx == 0 || rows <= 1 { Line::vertical(Line::new(a, 0, d).column) } else { Line::new(a, dx * i128::from(SUB), d) }
    }

    /// The column at this scanline.
    pub fn column(&self) -> i32 {
        self.column
    }

    /// Whether the column is the same on all scanlines.
    pub fn is_vertical(&self) -> bool {
        self.step == 0 && self.slope == 0
    }

    /// Goes down one scanline.
    #[inline]
    pub fn step(&mut self) {
        self.column += self.step;
        self.slack -= self.slope;
        if self.slack < 0 {
            self.slack += self.d;
            self.column += 1;
        }
    }

    /// The line `rows` scanlines further down: the same as stepping so often.
    #[must_use]
    pub fn down(&self, rows: u32) -> Line {
        let slack = i128::from(self.slack) - i128::from(rows) * i128::from(self.slope);
        let d = i128::from(self.d);
        let carry = -slack.div_euclid(d);
        let column = i128::from(self.column) + i128::from(rows) * i128::from(self.step) + carry;
        Line {
            column: i32::try_from(column).expect("columns near the page fit 32 bits"),
            slack: i64::try_from(slack + carry * d).expect("below d"),
            ..*self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first pixel centre not left of the line, by trying pixels with a cross product: no division, no stepping.
    fn brute(top: [i64; 2], bottom: [i64; 2], row: i64, guess: i64) -> i64 {
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

    fn agrees(top: [i64; 2], bottom: [i64; 2]) {
        let rows = crate::grid::first_centre(top[1])..crate::grid::first_centre(bottom[1]);
        let start = rows.start.max(0);
        if start >= rows.end {
            return;
        }
        let many = u32::try_from(rows.end - start).unwrap();
        let first = Line::through(top, bottom, u32::try_from(start).unwrap(), many);
        let mut line = first;
        for row in start..rows.end {
            let share = (row * SUB + SUB / 2 - top[1]) as f64 / (bottom[1] - top[1]) as f64;
            let guess = ((top[0] as f64 + share * (bottom[0] - top[0]) as f64 - 128.0) / 256.0).ceil() as i64;
            assert_eq!(i64::from(line.column()), brute(top, bottom, row, guess), "{top:?} {bottom:?} row {row}");
            assert_eq!(line, first.down(u32::try_from(row - start).unwrap()));
            line.step();
        }
    }

    #[test]
    fn columns_are_exact_on_random_lines() {
        let mut seed = 3u64;
        let mut random = |n: i64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 20) as i64 % n
        };
        for _ in 0..3000 {
            let size = [40, 3000, 60_000][random(3) as usize];
            let top = [random(2 * size) - size, random(size) - size / 2];
            agrees(top, [random(2 * size) - size, top[1] + 1 + random(size)]);
        }
    }

    /// `m` with `m a = 1 (mod n)`, by Euclid's algorithm; `a` and `n` have no common divisor.
    fn inverse(a: i128, n: i128) -> i128 {
        let (mut r, mut s) = ((n, a.rem_euclid(n)), (0, 1));
        while r.1 > 0 {
            let q = r.0 / r.1;
            (r, s) = ((r.1, r.0 - q * r.1), (s.1, s.0 - q * s.1));
        }
        assert_eq!(r.0, 1);
        s.0.rem_euclid(n)
    }

    /// Lines 70,000 scanlines tall that pass a pixel centre at 1/dy of a grid step (2e-10 px) on either side: where `m dx = near (mod dy)`, m grid steps below the top, the line is that near to a whole grid step.
    #[test]
    fn columns_are_exact_beside_pixel_centres() {
        for column in [0, 1_000_000] {
            for (dy, dx) in [(70_000 * 256 + 1, 262_147), (70_001 * 256 - 85, -1_234_567), (17_920_021, 13), (17_920_019, 180_000_001)] {
                for near in [-1, 1] {
                    let m = (near * inverse(dx, dy)).rem_euclid(dy);
                    let row = i64::try_from((m - 1) / 256).unwrap();
                    let y0 = i64::try_from(i128::from(row) * 256 + 128 - m).unwrap();
                    let x0 = column * SUB + SUB / 2 - i64::try_from((m * dx - near) / dy).unwrap();
                    let (top, bottom) = ([x0, y0], [x0 + i64::try_from(dx).unwrap(), y0 + i64::try_from(dy).unwrap()]);
                    let row = u32::try_from(row).unwrap();
                    assert_eq!(i64::from(Line::through(top, bottom, row, 2).column()), column + i64::from(near > 0));
                    agrees(top, bottom);
                    agrees([top[0], top[1] - 256 * 100], [bottom[0], bottom[1] - 256 * 100]);
                }
            }
        }
        // Exactly through centres on every other scanline.
        agrees([128, 128], [128 + 70_000 * 128, 128 + 70_000 * 256]);
        agrees([256_000_128, 128], [256_000_128 - 70_000 * 128, 128 + 70_000 * 256]);
    }
}
