//! Lines that no single [`Line`] stands for, as several: the same column on every scanline, exactly.
//!
//! Where a line leaves the page at a side it becomes vertical there. What is left on the page may be too tall for one [`Line`], or have ends that are
//! not near: coordinates of a document may be any finite double, and clipping at the page's border and rounding the cut would move the line by a fraction
//! of a pixel. Such a line is replaced on the page by the lower convex hull of the pixel centres that
//! are not left of it: for every scanline the first such centre lies on or right of the hull, and the hull on or right of the line, so both have the
//! same columns. The hull of a line over n scanlines has O(log n) vertices, and Euclid's algorithm finds them
//! (compare Harvey, "Computing two-dimensional integer hulls", SIAM J. Computing 28, 1999); the denominators of its sides are their heights.
//!
//! ```text
//!     x(row)  \ .   .           . centres not left of the line
//!              \o   .           o vertices of their hull
//!               \\  .
//!                \ o.           between two vertices the hull is a line with small integers
//! ```
//!
//! Cost: O(log) steps a line, in 128-bit integers if its ends are near, else in big ones.

use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::{Signed, ToPrimitive};

use super::{BOUND, Line, fits};
use crate::grid::{Point, SUB, is_near};

/// A line for the scanlines up to `last`, which is not included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece {
    /// The scanline behind the last.
    pub last: u32,
    /// The line, at the scanline where the piece before ended.
    pub line: Line,
}

/// Appends the pieces of the line from `top` down to `bottom` for `rows`, all of which it meets, with columns clamped to `0..=width`.
/// Points are in pixels, snapped to 1/256, of any finite size.
pub fn pieces(top: Point, bottom: Point, rows: std::ops::Range<u32>, width: u32, pieces: &mut Vec<Piece>) {
    if is_near(top) && is_near(bottom) {
        let steps = |x: f64| i128::from((x * SUB as f64) as i64);
        Exact::through(top.map(steps), bottom.map(steps), rows.start).pieces(rows, width, pieces);
    } else {
        Exact::through(top.map(in_grid_steps), bottom.map(in_grid_steps), rows.start).pieces(rows, width, pieces);
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Left,
    On,
    Right,
}

/// Integers that are wide enough for a line: its coordinates in 1/256 px, two of them multiplied, and a page's width.
trait Wide: Integer + Signed + Clone + From<i64> + ToPrimitive {}

impl<I: Integer + Signed + Clone + From<i64> + ToPrimitive> Wide for I {}

/// `x(row) = (a + b row) / d` in pixels from the centre of pixel 0.
struct Exact<I> {
    a: I,
    b: I,
    d: I,
}

impl<I: Wide> Exact<I> {
    /// The line through two points in 1/256 px, from scanline `row` on.
    fn through([x0, y0]: [I; 2], [x1, y1]: [I; 2], row: u32) -> Exact<I> {
        let [sub, half, row] = [SUB, SUB / 2, row.into()].map(I::from);
        let (dx, dy) = (x1 - x0.clone(), y1 - y0.clone());
        let a = (x0 - half.clone()) * dy.clone() + (row * sub.clone() + half - y0) * dx.clone();
        Exact { a, b: dx * sub.clone(), d: dy * sub }
    }

    fn pieces(&self, rows: std::ops::Range<u32>, width: u32, pieces: &mut Vec<Piece>) {
        let side = |row: u32| self.side(row - rows.start, width);
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
                Side::Right => pieces.push(Piece { last: past, line: Line::vertical(width) }),
                Side::On => self.on_page(start - rows.start, past - start, past, pieces),
            }
            start = past;
        }
    }

    /// `a + b row`.
    fn numerator(&self, row: u32) -> I {
        self.a.clone() + self.b.clone() * I::from(row.into())
    }

    /// Where the column of a scanline falls: at most 0, at least `width`, or between.
    fn side(&self, row: u32, width: u32) -> Side {
        let x = self.numerator(row);
        if !x.is_positive() {
            Side::Left
        } else if x > self.d.clone() * I::from(i64::from(width) - 1) {
            Side::Right
        } else {
            Side::On
        }
    }

    /// `ceil(x)` and the slack of that centre, in 1/d px.
    fn column(&self, row: u32) -> (i64, I) {
        let x = self.numerator(row);
        let column = x.div_ceil(&self.d);
        let slack = column.clone() * self.d.clone() - x;
        (small(&column), slack)
    }

    /// The pieces for `n` scanlines from `first` on, all on the page; they end at `last`.
    fn on_page(&self, first: u32, n: u32, last: u32, pieces: &mut Vec<Piece>) {
        let numbers = [&self.numerator(first), &self.b, &self.d].map(ToPrimitive::to_i64);
        if let [Some(a), Some(b), Some(d)] = numbers
            && fits(d, n)
        {
            pieces.push(Piece { last, line: Line::new(a, b, d, n) });
        } else {
            self.hull(first, n, last, pieces);
        }
    }

    /// The same as a hull.
    fn hull(&self, first: u32, n: u32, last: u32, pieces: &mut Vec<Piece>) {
        let start = last - n;
        let end = i64::from(n) - 1;
        let (column, slack) = self.column(first);
        let (mirror_column, mirror_slack) = self.column(first + n - 1);
        // Down from the first scanline and up from the last, both to a centre with the least slack.
        let mut vertices = vec![(0, column)];
        vertices.extend(descend(slack, &self.b, &self.d, end).into_iter().map(|(i, c)| (i, column + c)));
        let mut up = vec![(end, mirror_column)];
        up.extend(descend(mirror_slack, &-self.b.clone(), &self.d, end).into_iter().map(|(i, c)| (end - i, mirror_column + c)));
        vertices.extend(up.into_iter().rev());
        vertices.dedup();
        for pair in vertices.windows(2) {
            let (rows, columns) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
            // A side of the hull as tall as it is may need to be cut: it has lattice points enough only at its ends.
            let most = (BOUND / rows).min(rows);
            let mut done = 0;
            while done < rows {
                let some = most.min(rows - done);
                let a = pair[0].1 * rows + columns * done;
                done += some;
                pieces.push(Piece { last: start + (pair[0].0 + done) as u32, line: Line::new(a, columns, rows, some as u32) });
            }
        }
        pieces.push(Piece { last, line: Line::vertical(mirror_column as u32) });
    }
}

/// Vertices (row, column), relative to the first centre, of the part of the hull along which the slack falls, for a line of slope `b / d` and at most `end`
/// rows. `slack` is that of the first centre, in 1/d px.
///
/// `left` and `right` are the neighbours of the slope in the Stern-Brocot tree: a step along `left` takes `fall` from the slack, one along
/// `right` adds `rise`. The hull goes along `left` as often as the slack allows; then `left` is moved closer to the slope.
fn descend<I: Wide>(mut slack: I, b: &I, d: &I, end: i64) -> Vec<(i64, i64)> {
    let whole = b.div_floor(d);
    let mut fall = b.clone() - whole.clone() * d.clone();
    let mut rise = d.clone();
    let (mut left, mut right) = ((I::one(), whole), (I::zero(), I::one()));
    let mut vertices = Vec::new();
    let (mut row, mut column) = (0, 0);
    while fall.is_positive() && left.0 <= I::from(end - row) {
        if slack >= fall {
            let often = (slack.clone() / fall.clone()).min(I::from(end - row) / left.0.clone());
            slack = slack - often.clone() * fall.clone();
            row += small(&(often.clone() * left.0.clone()));
            column += small(&(often * left.1.clone()));
            vertices.push((row, column));
        } else if fall >= rise {
            let needed = (fall.clone() - slack.clone()).div_ceil(&rise);
            let often = needed.min(fall.clone() / rise.clone());
            fall = fall - often.clone() * rise.clone();
            left = (left.0 + often.clone() * right.0.clone(), left.1 + often * right.1.clone());
        } else {
            let often = (rise.clone() - I::one()) / fall.clone();
            rise = rise - often.clone() * fall.clone();
            right = (right.0 + often.clone() * left.0.clone(), right.1 + often * left.1.clone());
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

fn small(v: &impl ToPrimitive) -> i64 {
    v.to_i64().expect("rows and columns of a page")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{snap, snap_point};

    /// The first scanline whose centre is not above `y`, in pixels, snapped to 1/256; without any bound.
    fn row(y: f64) -> f64 {
        // A snapped coordinate of modest size has an exact half; one past 2^30 px is off every page anyway.
        (y - 0.5).ceil()
    }

    fn agrees(top: Point, bottom: Point, width: u32, height: u32) -> usize {
        let (top, bottom) = (snap_point(top), snap_point(bottom));
        let rows = row(top[1]).clamp(0.0, f64::from(height)) as u32..row(bottom[1]).clamp(0.0, f64::from(height)) as u32;
        let mut pieces = Vec::new();
        super::pieces(top, bottom, rows.clone(), width, &mut pieces);
        let exact = Exact::through(top.map(in_grid_steps), bottom.map(in_grid_steps), rows.start);
        let (mut row, mut count) = (rows.start, 0);
        for piece in &pieces {
            assert!(piece.last > row, "no empty piece");
            let mut line = piece.line;
            while row < piece.last {
                // ceil(x) clamped, from the definition: the number of centres 0..width that are left of the line.
                let x = exact.numerator(row - rows.start);
                let brute = x.div_ceil(&exact.d).clamp(BigInt::from(0), BigInt::from(width));
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
