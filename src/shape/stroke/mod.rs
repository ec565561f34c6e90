//! Strokes: the area that a line of some width covers along a path.
//!
//! Curves become straight pieces, and the stroke is a sum of simple parts that all run the same way round: a rectangle for every piece, a
//! wedge on the outer side of every turn, caps at the ends. So the winding number of a point counts the parts that cover it; it is never
//! negative, no two parts cancel, and filled nonzero the sum is their union, however wide the stroke and however tight the curve. (Outlines made of
//! parallel curves turn inside out there.) Inside a curve a turn has wedges on both sides, as the normals sweep both.
//!
//! ```text
//!      forward  ________________
//!                               |\  wedge on the outer side      edges that two neighbours share cancel,
//!      path     ----------------p \                              what is left is one ring: forward,
//!      backward ______________  |\ \                             then backward in reverse, through p
//!                             \ | \ \                            on the inner side of a turn
//! ```
//!
//! Where a turn is slight and its neighbours long enough, both rectangles are cut at the bisector instead: what they lose there, the
//! other has. All this is done in user units, so that skewed and uneven scales are right, and within a part of the tolerance there that
//! follows from the transform's largest scale. What cannot reach the page is left out first, so that a long line costs what is seen of it.
//!
//! Beginnings and ends are perpendicular to the true tangents. Joins and caps are those of SVG 2, section 13.5; turns within a curve, cusps too, are round.

mod dashes;
mod pen;

use std::ops::Range;

use self::dashes::{Cursor, Dashes};
use self::pen::{Heading, Pen};
use super::flatten::{Flattening, Piece, Window, flatten, pieces};
use super::{Cap, Join, Path, Stroke};
use crate::error::{Error, Kind, Result};
use crate::grid::Point;

/// Most dashes and gaps of one stroke that are on the page.
pub const DASHES: u64 = 10_000_000;

/// Finest tolerance of curves, to the size of what has to be flattened: it counts only where lines are 10^8 pixels wide.
const FINEST: f64 = 1e-11;

/// Hands the rings that the stroke of a path consists of to `ring`, as points in pixels, to be filled nonzero.
///
/// # Errors
/// More than [`DASHES`]; the first that `ring` returns.
pub(super) fn rings(
    path: &Path,
    stroke: &Stroke,
    matrix: &[f64; 6],
    how: &Flattening,
    name: &str,
    ring: impl FnMut(&[Point]) -> Result<()>,
) -> Result<()> {
    let Some(mut walk) = Walk::new(stroke, matrix, how, name, ring) else { return Ok(()) };
    for piece in pieces(path) {
        match piece {
            Piece::Start(p) => {
                walk.end(false)?;
                walk.begin(p);
            }
            Piece::Lines(ends) => ends.iter().try_for_each(|&p| walk.line(p))?,
            Piece::Cubic(cubic) => walk.curve(&cubic)?,
            Piece::Close(start) => {
                walk.line(start)?;
                walk.end(true)?;
            }
        }
    }
    walk.end(false)
}

/// Goes along subpaths, straight piece by straight piece, and lowers and lifts the pen.
struct Walk<'n, R> {
    name: &'n str,
    pen: Pen<R>,
    /// For curves, in user units.
    how: Flattening,
    /// Beyond it nothing is drawn that is seen, in user units.
    reach: Window,
    dashes: Option<Dashes>,
    /// Dashes and gaps on the page so far.
    passed: f64,
    /// Where the subpath begins; none before it has lines.
    start: Option<Point>,
    drawn: bool,
    at: Point,
    /// At the end of a curve, its tangent: it matters unless the next piece goes on smoothly.
    tangent: Option<Heading>,
    /// No straight piece has been walked in this subpath.
    fresh: bool,
    /// Where and whereto the pen was lowered at the very beginning of the subpath, without a cap so far.
    first: Option<(Point, Heading)>,
    /// Distance from where a period begins, and the dash there; none if it has to be looked up.
    place: f64,
    cursor: Option<Cursor>,
}

impl<'n, R: FnMut(&[Point]) -> Result<()>> Walk<'n, R> {
    /// None if nothing is painted.
    fn new(stroke: &Stroke, matrix: &[f64; 6], how: &Flattening, name: &'n str, ring: R) -> Option<Walk<'n, R>> {
        let radius = stroke.width / 2.0;
        let tolerance = how.tolerance / largest_scale(matrix) / 2.0;
        let miter = if matches!(stroke.join, Join::Miter | Join::MiterClip) { stroke.miter_limit.max(1.5) } else { 1.5 };
        let around = |reach: f64| seen(matrix, &how.window, reach + tolerance);
        let window = around(1.5 * radius)?;
        if !(radius > 0.0 && tolerance > 0.0) {
            return None;
        }
        let size = (window[2] - window[0]).max(window[3] - window[1]);
        let pen = Pen::new(stroke, tolerance, around(0.0)?, matrix, ring);
        Some(Walk {
            name,
            pen,
            how: Flattening { tolerance: tolerance.max(size * FINEST), window },
            reach: around(miter * radius)?,
            dashes: Dashes::new(&stroke.dashes, stroke.dash_offset),
            passed: 0.0,
            start: None,
            drawn: false,
            at: [0.0; 2],
            tangent: None,
            fresh: true,
            first: None,
            place: 0.0,
            cursor: None,
        })
    }

    fn begin(&mut self, p: Point) {
        (self.start, self.at, self.drawn, self.fresh) = (Some(p), p, false, true);
        self.place = self.dashes.as_ref().map_or(0.0, |d| d.offset);
        self.cursor = None;
    }

    fn line(&mut self, p: Point) -> Result<()> {
        self.drawn = true;
        match direction(self.at, p, self.pen.least) {
            Some((heading, length)) => {
                self.turn_to_tangent()?;
                self.straight(p, heading, length, false)
            }
            None => Ok(()),
        }
    }

    fn curve(&mut self, cubic: &[Point; 4]) -> Result<()> {
        self.drawn = true;
        let least = self.pen.least;
        let &[p, q, r, s] = cubic;
        let from = [q, r, s].into_iter().find_map(|to| direction(p, to, least));
        let to = [r, q, p].into_iter().find_map(|from| direction(from, s, least));
        let Some(((from, _), (to, _))) = from.zip(to) else { return self.line(s) };
        let smooth = self.tangent.is_some_and(|last| self.pen.is_slight(last, from));
        if !smooth {
            self.turn_to_tangent()?;
            self.straight(self.at, from, 0.0, false)?;
        }
        let how = self.how;
        let mut result = Ok(());
        flatten(*cubic, &how, |part, range, vertex| {
            if let (Ok(()), Some((heading, chord))) = (&result, direction(self.at, vertex, least)) {
                let length = if self.dashes.is_some() { length(part, range).max(chord) } else { chord };
                result = self.straight(vertex, heading, length, true);
            }
        });
        self.tangent = Some(to);
        result
    }

    /// Makes up for the difference between the end of a curve and its last straight piece.
    fn turn_to_tangent(&mut self) -> Result<()> {
        match self.tangent.take() {
            Some(tangent) => self.straight(self.at, tangent, 0.0, true),
            None => Ok(()),
        }
    }

    /// Ends a subpath, if there is one.
    fn end(&mut self, closed: bool) -> Result<()> {
        let Some(start) = self.start.take() else { return Ok(()) };
        self.turn_to_tangent()?;
        let dot = self.fresh;
        if dot && self.drawn && self.pen.cap != Cap::Butt {
            // A subpath without length is a dot.
            self.straight(start, [1.0, 0.0], 0.0, false)?;
        }
        let first = self.first.take();
        match (first, self.pen.heading) {
            (Some((p, heading)), Some(_)) if closed && !dot => {
                self.pen.draw(p, p, heading, false, false)?;
                self.pen.lift()
            }
            (first, down) => {
                if down.is_some() {
                    self.pen.end(self.at)?;
                }
                first.map_or(Ok(()), |(p, [x, y])| self.pen.cap_apart(p, [-x, -y]))
            }
        }
    }

    /// Goes straight on to `to`, which is `length` away along the path. `smooth`: the turn towards it is a part of a curve.
    fn straight(&mut self, to: Point, heading: Heading, length: f64, smooth: bool) -> Result<()> {
        let from = self.at;
        let fresh = std::mem::replace(&mut self.fresh, false);
        let mut place = self.place;
        self.at = to;
        self.place += length;
        let Some(Range { start, end }) = within(from, to, &self.reach) else {
            self.cursor = None;
            return self.pen.lift();
        };
        let at = |t: f64| if t >= 1.0 { to } else { [0, 1].map(|i| from[i] + t * (to[i] - from[i])) };
        let mut fresh = fresh && start == 0.0;
        if start > 0.0 {
            self.pen.lift()?;
        }
        if let Some(dashes) = &self.dashes {
            if start > 0.0 || place > dashes.period * 1e9 {
                self.cursor = None;
                place = (place + start * length).rem_euclid(dashes.period);
            }
            let (begun, last) = (place, place + (end - start) * length);
            self.passed += dashes.number(last - place);
            if self.passed > DASHES as f64 {
                return Err(Error::input(Kind::Limit, format!("\"{}\": more than {DASHES} dashes and gaps: use longer ones", self.name)));
            }
            let point = |place: f64| at(if length > 0.0 { (start + (place - begun) / length).clamp(start, end) } else { start });
            let mut cursor = self.cursor.unwrap_or_else(|| dashes.at(place));
            if fresh && cursor.on() {
                self.first = Some((from, heading));
            }
            while dashes.end(cursor) < last {
                let next = dashes.end(cursor).max(place);
                if cursor.on() {
                    if next > place || self.pen.heading.is_none() {
                        self.pen.draw(point(place), point(next), heading, smooth, fresh)?;
                    }
                    self.pen.end(point(next))?;
                }
                (place, cursor, fresh) = (next, dashes.next(cursor), false);
            }
            if cursor.on() {
                self.pen.draw(point(place), at(end), heading, smooth, fresh)?;
            }
            (self.place, self.cursor) = (last, Some(cursor));
        } else {
            if fresh {
                self.first = Some((from, heading));
            }
            self.pen.draw(at(start), at(end), heading, smooth, fresh)?;
        }
        if end < 1.0 {
            self.place += (1.0 - end) * length;
            self.cursor = None;
            self.pen.lift()?;
        }
        Ok(())
    }
}

/// Heading and distance, if it is more than `least`.
fn direction(from: Point, to: Point, least: f64) -> Option<(Heading, f64)> {
    let [x, y] = [to[0] - from[0], to[1] - from[1]];
    let length = x.hypot(y);
    (length > least && length.is_finite()).then(|| ([x / length, y / length], length))
}

/// Length of a part of a cubic: Gauss's rule with five points on each sixteenth of it.
fn length(&[p, q, r, s]: &[Point; 4], part: Range<f64>) -> f64 {
    const NODES: [(f64, f64); 5] = [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    let speed = |t: f64| {
        let u = 1.0 - t;
        let [x, y] = [0, 1].map(|i| 3.0 * (u * u * (q[i] - p[i]) + 2.0 * u * t * (r[i] - q[i]) + t * t * (s[i] - r[i])));
        x.hypot(y)
    };
    // Whole curves are chords beyond the page; the straight pieces of others are short.
    let parts = if part.end - part.start >= 1.0 { 16 } else { 1 };
    let half = (part.end - part.start) / f64::from(parts) / 2.0;
    let sum = |k: i32| NODES.iter().map(|(x, w)| w * speed(part.start + half * (f64::from(2 * k + 1) + x))).sum::<f64>();
    half * (0..parts).map(sum).sum::<f64>()
}

/// The larger singular value of the linear part.
fn largest_scale(&[a, b, c, d, ..]: &[f64; 6]) -> f64 {
    (a / 2.0 + d / 2.0).hypot(b / 2.0 - c / 2.0) + (a / 2.0 - d / 2.0).hypot(b / 2.0 + c / 2.0)
}

/// A box around the window in user units, with a margin. None if the matrix leaves no area.
fn seen(&[a, b, c, d, e, f]: &[f64; 6], &[left, top, right, bottom]: &Window, margin: f64) -> Option<Window> {
    let determinant = a * d - b * c;
    let back = |x: f64, y: f64| [(d * (x - e) - c * (y - f)) / determinant, (a * (y - f) - b * (x - e)) / determinant];
    let corners = [back(left, top), back(right, top), back(left, bottom), back(right, bottom)];
    let bound = |axis: usize, f: fn(f64, f64) -> f64| corners.iter().map(|p| p[axis]).fold(corners[0][axis], f);
    let window = [bound(0, f64::min) - margin, bound(1, f64::min) - margin, bound(0, f64::max) + margin, bound(1, f64::max) + margin];
    (determinant != 0.0 && window.iter().all(|v| v.is_finite())).then_some(window)
}

/// Which part of a line, from 0 to 1, lies in a window (Liang and Barsky).
fn within(from: Point, to: Point, &[left, top, right, bottom]: &Window) -> Option<Range<f64>> {
    let mut part = 0.0_f64..1.0;
    for (p, q, low, high) in [(from[0], to[0], left, right), (from[1], to[1], top, bottom)] {
        let d = q - p;
        if d == 0.0 {
            if p < low || p > high {
                return None;
            }
            continue;
        }
        let (enter, leave) = if d > 0.0 { (low, high) } else { (high, low) };
        part = part.start.max((enter - p) / d)..part.end.min((leave - p) / d);
    }
    (part.start <= part.end).then_some(part)
}
