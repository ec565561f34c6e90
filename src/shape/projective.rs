//! Paths under a homography: polygons that may pass through infinity.
//!
//! A point (x, y) becomes (X, Y, w) = M (x, y, 1), a pixel (X / w, Y / w). Where w changes its sign along an edge the edge leaves the page through
//! infinity and returns on the other side. "Niizeki" in ARCHITECTURE.md, section 3, displays such a figure in two passes: the part with positive weight, and
//! the part with negative weight with all signs turned. Each pass clips every ring at a line of constant weight (Sutherland and Hodgman's way, which
//! keeps winding numbers on the side that is kept), and what it leaves is an ordinary ring.
//!
//! ```text
//!        w > 0      |   w < 0          a triangle with one corner beyond the line at infinity is seen
//!     1___          |        3 \       as two parts: between 1 and 2 away from 3, and behind 3
//!     2___----      |     ----- >
//! ```
//!
//! The clipping line lies where no pixel of the page is: a pixel's weight is 1 / (third row of the inverse of M · (x, y, 1)), and the line is taken at a
//! sixteenth of the least weight that the page's corners have.

use super::Path;
use super::flatten::{Flattening, Piece, Window, beside, halves, pieces};
use crate::error::Result;
use crate::grid::Point;

/// A point with its weight.
type Weighted = [f64; 3];

/// A curve is halved at most this often.
const DEPTH: u32 = 24;

/// Hands the rings of a path under a homography, given row by row, to `ring`; see [`super::Shape::rings`].
pub(super) fn rings(path: &Path, matrix: &[f64; 9], how: &Flattening, mut ring: impl FnMut(&[Point]) -> Result<()>) -> Result<()> {
    let horizon = least_weight(matrix, &how.window) / 16.0;
    let mut points = Vec::new();
    let mut emit = |points: &[Weighted]| -> Result<()> {
        for sign in [1.0, -1.0] {
            let mut seen = clip(points, sign, horizon);
            if sign < 0.0 {
                // Behind infinity the plane is seen from its other side.
                seen.reverse();
            }
            if !seen.is_empty() {
                ring(&seen)?;
            }
        }
        Ok(())
    };
    for piece in pieces(path) {
        match piece {
            Piece::Start(p) => {
                emit(&points)?;
                points.clear();
                points.push(weigh(matrix, p));
            }
            Piece::Lines(ends) => points.extend(ends.iter().map(|&p| weigh(matrix, p))),
            Piece::Cubic(cubic) => flatten(cubic.map(|p| weigh(matrix, p)), how, horizon, &mut points),
            Piece::Close(_) => {}
        }
    }
    emit(&points)
}

fn weigh(&[a, b, c, d, e, f, g, h, i]: &[f64; 9], [x, y]: Point) -> Weighted {
    [a * x + b * y + c, d * x + e * y + f, g * x + h * y + i]
}

fn project([x, y, w]: Weighted) -> Point {
    [x / w, y / w]
}

/// The smallest absolute weight of any point of the window. The matrix is not singular.
fn least_weight(&[a, b, c, d, e, f, g, h, i]: &[f64; 9], &[left, top, right, bottom]: &Window) -> f64 {
    // Rows and then columns are brought to size 1: a product of three numbers of the matrix may be out of a double's range.
    let unit = |v: [f64; 3]| {
        let size = v.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
        (v.map(|x| x / size), size)
    };
    let [(x, x_size), (y, y_size), (w, w_size)] = [[a, b, c], [d, e, f], [g, h, i]].map(unit);
    let [([a, d, g], _), ([b, e, h], _), ([c, f, i], size)] = [0, 1, 2].map(|k| unit([x[k], y[k], w[k]]));
    let row = [d * h - e * g, b * g - a * h, a * e - b * d];
    let determinant = (c * row[0] + f * row[1] + i * row[2]) * size;
    let row = [row[0] / determinant / x_size, row[1] / determinant / y_size, row[2] / determinant / w_size];
    let corners = [[left, top], [right, top], [left, bottom], [right, bottom]];
    1.0 / corners.map(|[x, y]| (row[0] * x + row[1] * y + row[2]).abs()).into_iter().fold(f64::MIN_POSITIVE, f64::max)
}

/// The part of a ring whose weight times `sign` is at least `horizon`, in pixels.
fn clip(ring: &[Weighted], sign: f64, horizon: f64) -> Vec<Point> {
    let mut kept = Vec::with_capacity(ring.len() + 2);
    let Some(&last) = ring.last() else { return kept };
    let mut from = last;
    for &to in ring {
        let (before, after) = (from[2] * sign - horizon, to[2] * sign - horizon);
        if (before >= 0.0) != (after >= 0.0) {
            let t = before / (before - after);
            let cut = |k: usize| from[k] + t * (to[k] - from[k]);
            kept.push(project([cut(0), cut(1), horizon * sign]));
        }
        if after >= 0.0 {
            kept.push(project(to));
        }
        from = to;
    }
    kept
}

/// Appends the points of a curve behind its first. A curve whose control points all have weights on one side of the horizon lies in the hull
/// of their projections, so it is as flat as they are.
fn flatten(cubic: [Weighted; 4], how: &Flattening, horizon: f64, points: &mut Vec<Weighted>) {
    let mut stack = vec![(cubic, 0)];
    while let Some((cubic, depth)) = stack.pop() {
        if depth == DEPTH || is_flat(&cubic, how, horizon) || !cubic.as_flattened().iter().all(|v| v.is_finite()) {
            points.push(cubic[3]);
        } else {
            let (first, second) = halves(&cubic);
            stack.extend([(second, depth + 1), (first, depth + 1)]);
        }
    }
}

fn is_flat(cubic: &[Weighted; 4], how: &Flattening, horizon: f64) -> bool {
    let sign = cubic[0][2].signum();
    if cubic.iter().all(|p| p[2].abs() < horizon) {
        return true;
    }
    if cubic.iter().any(|p| p[2] * sign < horizon) {
        return false;
    }
    let [p, q, r, s] = cubic.map(project);
    if beside(&[p, q, r, s], &how.window) {
        return true;
    }
    // Distance of the inner control points from the chord, or from its ends where they lie beyond them.
    let chord = [s[0] - p[0], s[1] - p[1]];
    let length = chord[0].hypot(chord[1]);
    [q, r].iter().all(|c| {
        let to = [c[0] - p[0], c[1] - p[1]];
        let along = (to[0] * chord[0] + to[1] * chord[1]) / (length * length).max(f64::MIN_POSITIVE);
        let nearest = along.clamp(0.0, 1.0);
        (to[0] - nearest * chord[0]).hypot(to[1] - nearest * chord[1]) <= how.tolerance
    })
}
