//! Lines through points far beyond the page, as lines near it: the same column on every scanline, exactly.
//!
//! Coordinates of a document may be any finite double, and clipping such a line at the page's border and rounding the cut would
//! move it by a fraction of a pixel. Instead the line is replaced on the page by the lower convex hull of the pixel centres that
//! are not left of it: for every scanline the first such centre lies on or right of the hull, and the hull on or right of the line, so both have the
//! same columns. The hull of a line over n scanlines has O(log n) vertices, and Euclid's algorithm finds them
//! (compare Harvey, "Computing two-dimensional integer hulls", SIAM J. Computing 28, 1999).
//!
//! ```text
//!     x(row)  \ .   .           . centres not left of the line
//!              \o   .           o vertices of their hull
//!               \\  .
//!                \ o.           between two vertices the hull is a line with small integers
//! ```
//!
//! Cost: O(log) steps in big integers a line, and only for lines with a far end.

use num_bigint::{BigInt, Sign};

use super::Line;
use crate::grid::{Point, SUB};

/// A line for the scanlines up to `last`, which is not included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece {
    /// The scanline behind the last.
    pub last: u32,
    /// The line, at the scanline where the piece before ended.
    pub line: Line,
}

/// The scanlines whose centres a line from `top` down to `bottom` meets, within `0..height`. Points are in pixels, snapped to 1/256.
pub fn rows(top: Point, bottom: Point, height: u32) -> std::ops::Range<u32> {
    // A snapped coordinate of modest size has an exact half; one past 2^30 px is off every page anyway.
    let row = |y: f64| (y - 0.5).ceil().clamp(0.0, f64::from(height)) as u32;
    row(top[1])..row(bottom[1])
}

/// Appends the pieces of the line from `top` down to `bottom` for `rows`, all of which it meets, with columns clamped to `0..=width`.
/// Points are in pixels, snapped to 1/256, of any finite size.
pub fn reduce(top: Point, bottom: Point, rows: std::ops::Range<u32>, width: u32, pieces: &mut Vec<Piece>) {
    let line = Exact::through(top, bottom, rows.start);
    let side = |row: u32| line.side(row - rows.start, width);
    let mut start = rows.start;
    while start < rows.end {
        let here = side(start);
        // The column is monotone in the row, so a side is left once: find where.
        let (mut same, mut past) = (start, rows.end);
        while past - same > 1 {
            let middle = same + (past - same) / 2;
            if side(middle) == here { same = middle } else { past = middle }
        }
        match here {
            Side::Left => pieces.push(Piece { last: past, line: Line::vertical(0) }),
            Side::Right => pieces.push(Piece { last: past, line: Line::vertical(i32::try_from(width).expect("a page's width")) }),
            Side::On => line.hull(start - rows.start, past - start, past, pieces),
        }
        start = past;
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Left,
    On,
    Right,
}

/// `x(row) = (a + b row) / d` in pixels from the centre of pixel 0.
struct Exact {
    a: BigInt,
    b: BigInt,
    d: BigInt,
}

impl Exact {
    fn through(top: Point, bottom: Point, row: u32) -> Exact {
        let [x0, y0, x1, y1] = [top[0], top[1], bottom[0], bottom[1]].map(in_grid_steps);
        let (dx, dy) = (x1 - &x0, y1 - &y0);
        let half = SUB / 2;
        let a = (x0 - half) * &dy + (i64::from(row) * SUB + half - y0) * &dx;
        Exact { a, b: dx * SUB, d: dy * SUB }
    }

    /// `a + b row`.
    fn numerator(&self, row: u32) -> BigInt {
        &self.a + &self.b * row
    }

    /// Where the column of a scanline falls: at most 0, at least `width`, or between.
    fn side(&self, row: u32, width: u32) -> Side {
        let x = self.numerator(row);
        if x.sign() != Sign::Plus {
            Side::Left
        } else if x > &self.d * (width - 1) {
            Side::Right
        } else {
            Side::On
        }
    }

    /// `ceil(x)` and the slack of that centre, in 1/d px.
    fn column(&self, row: u32) -> (i64, BigInt) {
        let x = self.numerator(row);
        let column = -floor_div(&-&x, &self.d);
        let slack = &column * &self.d - x;
        (small(&column), slack)
    }

    /// The hull over `n` scanlines from `first` on, as pieces that end at `last`.
    fn hull(&self, first: u32, n: u32, last: u32, pieces: &mut Vec<Piece>) {
        let down = |i: i64| last - n + u32::try_from(i).expect("a row of the page");
        let end = i64::from(n) - 1;
        let (column, slack) = self.column(first);
        let (mirror_column, mirror_slack) = self.column(first + n - 1);
        // Down from the first scanline and up from the last, both to a centre with the least slack.
        let mut vertices = vec![(0, column)];
        vertices.extend(descend(slack, &self.b, &self.d, end).into_iter().map(|(i, c)| (i, column + c)));
        let mut up = vec![(end, mirror_column)];
        up.extend(descend(mirror_slack, &-&self.b, &self.d, end).into_iter().map(|(i, c)| (end - i, mirror_column + c)));
        vertices.extend(up.into_iter().rev());
        vertices.dedup();
        for pair in vertices.windows(2) {
            let (rows, columns) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
            let line = Line::new(i128::from(pair[0].1) * i128::from(rows), i128::from(columns), rows);
            pieces.push(Piece { last: down(pair[1].0), line });
        }
        let bottom = Piece { last, line: Line::vertical(i32::try_from(mirror_column).expect("on the page")) };
        pieces.push(bottom);
    }
}

/// Vertices (row, column), relative to the first centre, of the part of the hull along which the slack falls, for a line of slope `b / d` and at most `end`
/// rows. `slack` is that of the first centre, in 1/d px.
///
/// `left` and `right` are the neighbours of the slope in the Stern-Brocot tree: a step along `left` takes `fall` from the slack, one along
/// `right` adds `rise`. The hull goes along `left` as often as the slack allows; then `left` is moved closer to the slope.
fn descend(mut slack: BigInt, b: &BigInt, d: &BigInt, end: i64) -> Vec<(i64, i64)> {
    let whole = floor_div(b, d);
    let mut fall = b - &whole * d;
    let mut rise = d.clone();
    let (mut left, mut right) = ((BigInt::from(1), whole), (BigInt::from(0), BigInt::from(1)));
    let mut vertices = Vec::new();
    let (mut row, mut column) = (0, 0);
    while fall.sign() == Sign::Plus && left.0 <= BigInt::from(end - row) {
        if slack >= fall {
            let often = (&slack / &fall).min((end - row) / &left.0);
            slack -= &often * &fall;
            row += small(&(&often * &left.0));
            column += small(&(&often * &left.1));
            vertices.push((row, column));
        } else if fall >= rise {
            let needed = -floor_div(&(&slack - &fall), &rise);
            let often = needed.min(&fall / &rise);
            fall -= &often * &rise;
            left = (left.0 + &often * &right.0, left.1 + &often * &right.1);
        } else {
            let often = (&rise - 1u8) / &fall;
            rise -= &often * &fall;
            right = (right.0 + &often * &left.0, right.1 + &often * &left.1);
        }
    }
    vertices
}

/// A snapped coordinate in 1/256 px; any finite double is an integer times a power of 2.
fn in_grid_steps(x: f64) -> BigInt {
    let bits = x.to_bits();
    let exponent = i32::try_from(bits >> 52 & 0x7ff).expect("11 bits");
    let fraction = bits & ((1 << 52) - 1);
    let mantissa = BigInt::from(if exponent == 0 { fraction } else { fraction | 1 << 52 });
    let shift = exponent.max(1) - 1075 + 8;
    let size = if shift >= 0 { mantissa << shift.unsigned_abs() } else { mantissa >> shift.unsigned_abs() };
    if x < 0.0 { -size } else { size }
}

fn floor_div(a: &BigInt, d: &BigInt) -> BigInt {
    let quotient = a / d;
    if (&quotient * d) > *a { quotient - 1 } else { quotient }
}

fn small(v: &BigInt) -> i64 {
    i64::try_from(v).expect("rows and columns of a page")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{snap, snap_point};

    fn agrees(top: Point, bottom: Point, width: u32, height: u32) -> usize {
        let (top, bottom) = (snap_point(top), snap_point(bottom));
        let rows = rows(top, bottom, height);
        let mut pieces = Vec::new();
        reduce(top, bottom, rows.clone(), width, &mut pieces);
        let exact = Exact::through(top, bottom, rows.start);
        let (mut row, mut count) = (rows.start, 0);
        for piece in &pieces {
            assert!(piece.last > row, "no empty piece");
            let mut line = piece.line;
            while row < piece.last {
                // ceil(x) clamped, from the definition: the number of centres 0..width that are left of the line.
                let x = exact.numerator(row - rows.start);
                let quotient = -floor_div(&-&x, &exact.d);
                let brute = quotient.clamp(BigInt::from(0), BigInt::from(width));
                assert_eq!(BigInt::from(line.column()), brute, "{top:?} {bottom:?} row {row}");
                line.step();
                row += 1;
            }
            count += 1;
        }
        assert_eq!(row, rows.end);
        count
    }

    #[test]
    fn grid_steps_of_doubles() {
        assert_eq!(in_grid_steps(-1.5), BigInt::from(-384));
        assert_eq!(in_grid_steps(0.0), BigInt::from(0));
        assert_eq!(in_grid_steps(snap(3.0 / 256.0)), BigInt::from(3));
        assert_eq!(in_grid_steps(2f64.powi(60)), BigInt::from(1u128 << 68));
    }

    #[test]
    fn the_hull_has_the_line_s_columns() {
        let mut seed = 11u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut most = 0;
        for i in 0..4000 {
            let size = 10f64.powi([2, 5, 9, 14, 40, 300][i % 6]);
            let coordinate = |r: f64, near: f64| if near < 0.3 { r * 300.0 } else { (r * 2.0 - 1.0) * size };
            let mut p = [coordinate(random(), random()), coordinate(random(), random())];
            let mut q = [coordinate(random(), random()), coordinate(random(), random())];
            if i % 5 == 0 {
                q[0] = 200.0 - p[0];
                q[1] = 150.0 - p[1];
            }
            if p[1] > q[1] {
                std::mem::swap(&mut p, &mut q);
            }
            if snap(p[1]) < snap(q[1]) {
                most = most.max(agrees(p, q, 300, 200));
            }
        }
        assert!((4..40).contains(&most), "hulls of 200 rows have few vertices, some have several: {most}");
    }

    #[test]
    fn ties_far_out_are_exact() {
        let huge = 2f64.powi(1000);
        for (x, y) in [(0.5, 0.5), (1.5, 0.5), (0.5, 0.0), (0.49609375, 0.5)] {
            for (u, v) in [(huge, huge), (huge * (1.0 + f64::EPSILON), huge), (-huge, huge), (huge / 3.0, huge), (huge, huge / 1e6)] {
                agrees([x, y], [u, v], 4000, 3000);
                agrees([-u, -v], [x, y + 500.0], 4000, 3000);
            }
        }
        agrees([-1e300, -1e300], [1e300, 1e300], 4000, 3000);
        agrees([-1e18, -3e17], [1e18, 3e17], 4000, 3000);
    }
}
