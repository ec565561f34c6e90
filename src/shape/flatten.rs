//! Paths to rings of points in pixels.
//!
//! Rings are handed over in parts, so that one of any length passes through a small buffer.
//!
//! Curves are flattened in pixels, behind the transform, so that the tolerance holds at any resolution. Parts of a curve that cannot
//! reach the page are replaced by their chords: a curve and its chord on one side of the page leave the same windings on it, and a curve of
//! a thousand kilometres costs what is seen of it.

use std::ops::Range;

use lyon_geom::{CubicBezierSegment, LineSegment, point};

use super::{Path, Verb};
use crate::error::Result;
use crate::grid::Point;

/// What is seen: left, top, right, bottom in pixels.
pub type Window = [f64; 4];

/// How fine, and for which part of the plane.
#[derive(Clone, Copy, Debug)]
pub struct Flattening {
    /// Largest distance between a curve and its edges, in pixels.
    pub tolerance: f64,
    /// Beyond it curves may become chords.
    pub window: Window,
}

/// Curves larger than so many tolerances are halved before they are flattened.
const LARGE: f64 = 655_360.0;

/// Points of a ring that follow those of the part before: one to [`PART`], in pixels, columns and rows apart.
#[derive(Clone, Copy, Debug)]
pub struct Part<'p> {
    /// By point: x.
    pub xs: &'p [f64],
    /// By point: y.
    pub ys: &'p [f64],
    /// Whether the ring ends with them.
    pub last: bool,
}

impl Part<'_> {
    /// The points one by one.
    pub fn points(&self) -> impl Iterator<Item = Point> {
        self.xs.iter().zip(self.ys).map(|(&x, &y)| [x, y])
    }
}

/// Most points of a [`Part`].
pub const PART: usize = 256;

/// Hands a ring that is at hand to `part`.
pub(super) fn whole(ring: &[Point], part: impl FnMut(Part<'_>) -> Result<()>) -> Result<()> {
    let mut held = Held::new(part);
    held.lines(ring, |p| p)?;
    held.end()
}

/// Hands the rings of a path under an affine map to `part`; see [`super::Shape::rings`].
pub(super) fn rings(path: &Path, matrix: &[f64; 6], how: &Flattening, part: impl FnMut(Part<'_>) -> Result<()>) -> Result<()> {
    let mut held = Held::new(part);
    for piece in pieces(path) {
        match piece {
            Piece::Start(p) => {
                held.end()?;
                held.push(affine(matrix, p))?;
            }
            Piece::Lines(ends) => held.lines(ends, |p| affine(matrix, p))?,
            Piece::Cubic(cubic) => {
                let mut done = Ok(());
                flatten(cubic.map(|p| affine(matrix, p)), how, |_, _, p| {
                    if done.is_ok() {
                        done = held.push(p);
                    }
                });
                done?;
            }
            Piece::Close(_) => {}
        }
    }
    held.end()
}

/// Points of a ring on their way out.
struct Held<P> {
    xs: [f64; PART],
    ys: [f64; PART],
    len: usize,
    part: P,
}

impl<P: FnMut(Part<'_>) -> Result<()>> Held<P> {
    fn new(part: P) -> Held<P> {
        Held { xs: [0.0; PART], ys: [0.0; PART], len: 0, part }
    }

    /// Hands on what is held.
    fn hand_on(&mut self, last: bool) -> Result<()> {
        let len = std::mem::take(&mut self.len);
        (self.part)(Part { xs: &self.xs[..len], ys: &self.ys[..len], last })
    }

    /// Adds the points, each mapped. What is handed on for want of room keeps the ring open: a point follows.
    #[inline]
    fn lines(&mut self, mut ends: &[Point], map: impl Fn(Point) -> Point) -> Result<()> {
        while !ends.is_empty() {
            if self.len == PART {
                self.hand_on(false)?;
            }
            let (xs, ys) = (&mut self.xs[self.len..], &mut self.ys[self.len..]);
            let now;
            (now, ends) = ends.split_at(xs.len().min(ends.len()));
            xs.iter_mut().zip(ys).zip(now).for_each(|((x, y), &p)| [*x, *y] = map(p));
            self.len += now.len();
        }
        Ok(())
    }

    fn push(&mut self, p: Point) -> Result<()> {
        self.lines(&[p], |p| p)
    }

    /// Ends the ring, if there is one.
    fn end(&mut self) -> Result<()> {
        if self.len > 0 { self.hand_on(true) } else { Ok(()) }
    }
}

pub(super) fn affine(&[a, b, c, d, e, f]: &[f64; 6], [x, y]: Point) -> Point {
    [a * x + c * y + e, b * x + d * y + f]
}

/// A part of a path.
#[derive(Clone, Copy, Debug)]
pub(super) enum Piece<'p> {
    /// A ring begins; the one before is closed.
    Start(Point),
    /// Straight lines one behind the other, to each of these points; at least one.
    Lines(&'p [Point]),
    /// A curve, where it begins included.
    Cubic([Point; 4]),
    /// Back to where the ring began, which is here.
    Close(Point),
}

/// The pieces of a path; quadratic curves are raised to cubic ones. What follows a `Close` without a `Move` begins where the closed ring began.
pub(super) fn pieces(path: &Path) -> impl Iterator<Item = Piece<'_>> {
    Pieces { verbs: path.verbs(), points: path.points(), start: [0.0; 2], at: [0.0; 2], open: false }
}

struct Pieces<'p> {
    verbs: &'p [Verb],
    points: &'p [Point],
    start: Point,
    at: Point,
    open: bool,
}

impl<'p> Pieces<'p> {
    /// The next verb or, as long outlines are mostly lines, run of lines, with its points.
    #[inline]
    fn take(&mut self, verb: Verb) -> &'p [Point] {
        let (verbs, points) = match verb {
            Verb::Move => (1, 1),
            Verb::Line => {
                let all = |verbs: &&[Verb]| verbs.iter().fold(true, |all, &verb| all & (verb == Verb::Line));
                let blocks = 64 * self.verbs.chunks_exact(64).take_while(all).count();
                let lines = blocks + self.verbs[blocks..].iter().take_while(|&&verb| verb == Verb::Line).count();
                (lines, lines)
            }
            Verb::Quad => (1, 2),
            Verb::Cubic => (1, 3),
            Verb::Close => (1, 0),
        };
        self.verbs = &self.verbs[verbs..];
        let taken;
        (taken, self.points) = self.points.split_at(points);
        taken
    }
}

impl<'p> Iterator for Pieces<'p> {
    type Item = Piece<'p>;

    #[inline]
    fn next(&mut self) -> Option<Piece<'p>> {
        let mut verb = *self.verbs.first()?;
        while verb == Verb::Close && !self.open {
            self.take(verb);
            self.at = self.start;
            verb = *self.verbs.first()?;
        }
        if !std::mem::replace(&mut self.open, true) && verb != Verb::Move {
            return Some(Piece::Start(self.at));
        }
        let (from, taken) = (self.at, self.take(verb));
        self.at = taken.last().copied().unwrap_or(self.start);
        Some(match (verb, taken) {
            (Verb::Move, _) => {
                self.start = self.at;
                Piece::Start(self.at)
            }
            (Verb::Quad, &[c, to]) => {
                let third = |p: Point| [0, 1].map(|i| p[i] / 3.0 + c[i] * (2.0 / 3.0));
                Piece::Cubic([from, third(from), third(to), to])
            }
            (Verb::Cubic, &[c, d, to]) => Piece::Cubic([from, c, d, to]),
            (Verb::Close, _) => {
                self.open = false;
                Piece::Close(self.start)
            }
            _ => Piece::Lines(taken),
        })
    }
}

/// Hands the points of a curve behind its first to `vertex`, each with a cubic and the part of it that the edge to the point stands for.
pub(super) fn flatten(cubic: [Point; 4], how: &Flattening, mut vertex: impl FnMut(&[Point; 4], Range<f64>, Point)) {
    if !cubic.as_flattened().iter().all(|v| v.is_finite()) {
        return vertex(&cubic, 0.0..1.0, cubic[3]);
    }
    // Most curves are not halved: the stack takes no memory until one is.
    let (mut next, mut stack) = (Some(cubic), Vec::new());
    while let Some(cubic) = next.take().or_else(|| stack.pop()) {
        if beside(&cubic, &how.window) {
            vertex(&cubic, 0.0..1.0, cubic[3]);
        } else if size(&cubic) > LARGE * how.tolerance {
            let (first, second) = halves(&cubic);
            stack.extend([second, first]);
        } else {
            let [from, ctrl1, ctrl2, to] = cubic.map(|[x, y]| point(x, y));
            let curve = CubicBezierSegment { from, ctrl1, ctrl2, to };
            curve.for_each_flattened_with_t(how.tolerance, &mut |edge: &LineSegment<f64>, part| {
                // The end is a vertex of the document: exactly it, whatever the flattening computed.
                let p = if part.end == 1.0 { cubic[3] } else { [edge.to.x, edge.to.y] };
                vertex(&cubic, part, p);
            });
        }
    }
}

/// Whether all points lie on one side of the window.
pub(super) fn beside(points: &[Point], &[left, top, right, bottom]: &Window) -> bool {
    let all = |test: &dyn Fn(&Point) -> bool| points.iter().all(test);
    all(&|p| p[0] < left) || all(&|p| p[0] > right) || all(&|p| p[1] < top) || all(&|p| p[1] > bottom)
}

/// The larger side of the box around the points; halves are taken first so that it cannot overflow.
fn size(points: &[Point]) -> f64 {
    let span = |axis: usize| {
        let values = points.iter().map(|p| p[axis] * 0.5);
        values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
    };
    2.0 * span(0).max(span(1)).min(f64::MAX / 4.0)
}

/// Both halves of a cubic (de Casteljau).
pub(super) fn halves<const N: usize>(&[p, q, r, s]: &[[f64; N]; 4]) -> ([[f64; N]; 4], [[f64; N]; 4]) {
    let middle = |a: [f64; N], b: [f64; N]| std::array::from_fn(|i| a[i] * 0.5 + b[i] * 0.5);
    let (pq, qr, rs) = (middle(p, q), middle(q, r), middle(r, s));
    let (pqr, qrs) = (middle(pq, qr), middle(qr, rs));
    let pqrs = middle(pqr, qrs);
    ([p, pq, pqr, pqrs], [pqrs, qrs, rs, s])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(r: f64) -> Path {
        let mut path = Path::default();
        path.circle([0.0, 0.0], r);
        path
    }

    fn points(path: &Path, matrix: &[f64; 6], how: Flattening) -> Vec<Vec<Point>> {
        let (mut all, mut ring) = (Vec::new(), Vec::new());
        rings(path, matrix, &how, |part| {
            gather(part, &mut ring, &mut all);
            Ok(())
        })
        .unwrap();
        assert!(ring.is_empty(), "the last ring ends");
        all
    }

    /// Puts a part behind those of its ring, and the ring to the others where it ends.
    fn gather(part: Part<'_>, ring: &mut Vec<Point>, all: &mut Vec<Vec<Point>>) {
        assert!((1..=PART).contains(&part.xs.len()) && part.xs.len() == part.ys.len());
        ring.extend(part.points());
        if part.last {
            all.push(std::mem::take(ring));
        }
    }

    /// Distance from points of the true cubic to the polyline.
    fn worst(cubic: [Point; 4], polyline: &[Point]) -> f64 {
        let at = |t: f64| -> Point {
            let u = 1.0 - t;
            [0, 1]
                .map(|i| u * u * u * cubic[0][i] + 3.0 * u * u * t * cubic[1][i] + 3.0 * u * t * t * cubic[2][i] + t * t * t * cubic[3][i])
        };
        (0..=2000)
            .map(|k| at(f64::from(k) / 2000.0))
            .map(|p| polyline.windows(2).map(|w| distance(p, w[0], w[1])).fold(f64::MAX, f64::min))
            .fold(0.0, f64::max)
    }

    fn distance(p: Point, a: Point, b: Point) -> f64 {
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let t = (((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy).max(1e-300)).clamp(0.0, 1.0);
        (p[0] - a[0] - t * dx).hypot(p[1] - a[1] - t * dy)
    }

    #[test]
    fn curves_stay_within_the_tolerance_in_pixels() {
        let everywhere = [-1e9, -1e9, 1e9, 1e9];
        let mut seed = 5u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 40) as f64 / 1e4 - 800.0
        };
        for tolerance in [0.001, 0.1, 16.0] {
            for _ in 0..60 {
                let cubic: [Point; 4] = std::array::from_fn(|_| [random(), random()]);
                let mut polyline = vec![cubic[0]];
                flatten(cubic, &Flattening { tolerance, window: everywhere }, |_, _, p| polyline.push(p));
                let far = worst(cubic, &polyline);
                assert!(far <= tolerance * 1.001, "{far} > {tolerance}: {cubic:?}");
                assert_eq!(polyline.last(), Some(&cubic[3]));
            }
        }
    }

    #[test]
    fn the_tolerance_follows_the_transform() {
        let window = [-1e6, -1e6, 1e6, 1e6];
        let how = Flattening { tolerance: 0.1, window };
        let small = points(&circle(10.0), &[1.0, 0.0, 0.0, 1.0, 0.0, 0.0], how)[0].len();
        let large = points(&circle(10.0), &[100.0, 0.0, 0.0, 100.0, 0.0, 0.0], how)[0].len();
        assert!(large > 5 * small, "{small} {large}");
    }

    #[test]
    fn huge_curves_cost_what_is_seen_of_them() {
        for r in [1e6, 1e12, 1e100, 1e300] {
            let how = Flattening { tolerance: 0.1, window: [0.0, 0.0, 1000.0, 1000.0] };
            let all = points(&circle(r), &[1.0, 0.0, 0.0, 1.0, -r + 500.0, 500.0], how);
            assert!(all[0].len() < 20_000, "{r}: {}", all[0].len());
            assert!(all[0].iter().flatten().all(|v| v.is_finite()));
        }
    }

    #[test]
    fn rings_of_any_length_come_whole() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
        for length in [1, 2, PART - 1, PART, PART + 1, 3 * PART, 3 * PART + 7] {
            let long: Vec<Point> = (0..length).map(|i| [i as f64, (i * i % 7) as f64]).collect();
            let mut path = Path::default();
            path.ring(&long);
            path.ring(&square);
            path.ring(&long);
            let all = points(&path, &[1.0, 0.0, 0.0, 1.0, 0.0, 0.0], Flattening { tolerance: 0.1, window: [0.0, 0.0, 9.0, 9.0] });
            assert_eq!(all, [&long[..], &square, &long], "{length}");
            let (mut at_once, mut ring) = (Vec::new(), Vec::new());
            whole(&long, |part| {
                gather(part, &mut ring, &mut at_once);
                Ok(())
            })
            .unwrap();
            assert_eq!(at_once, [&long[..]], "{length}");
        }
    }

    #[test]
    fn a_closed_subpath_goes_on_where_it_began() {
        let mut path = Path::default();
        path.ring(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]);
        path.line_to([5.0, 5.0]);
        path.quad_to([6.0, 5.0], [6.0, 6.0]);
        path.close();
        let all = points(&path, &[1.0, 0.0, 0.0, 1.0, 0.0, 0.0], Flattening { tolerance: 0.1, window: [0.0, 0.0, 9.0, 9.0] });
        assert_eq!(all[0], [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]);
        assert_eq!((all[1][0], all[1][1], all[1].last()), ([0.0, 0.0], [5.0, 5.0], Some(&[6.0, 6.0])));
    }
}
