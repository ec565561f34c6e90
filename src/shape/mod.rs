//! Paths, fill rules, strokes and transforms: a shape before it meets the grid.
//!
//! [`flatten`] turns a path under a transform into rings of points in pixels, under a homography too (`projective.rs`); `stroke` does it for the line
//! along a path.

pub mod flatten;
mod projective;
mod stroke;

pub use stroke::DASHES;

use std::sync::Arc;

use self::flatten::{Flattening, Part};
use crate::error::{Error, Kind, Result};
use crate::grid::Point;

/// Which windings are inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum FillRule {
    /// Winding number not 0.
    #[default]
    NonZero,
    /// Winding number odd.
    EvenOdd,
}

/// What the next points of a path mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verb {
    /// One point: starts a subpath.
    Move,
    /// One point: straight to it.
    Line,
    /// Two points: a quadratic Bézier curve.
    Quad,
    /// Three points: a cubic Bézier curve.
    Cubic,
    /// No point: back to the start of the subpath.
    Close,
}

/// A path in user units. Every subpath is filled as if it were closed. Coordinates are finite.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Path {
    verbs: Vec<Verb>,
    points: Vec<Point>,
}

impl Path {
    /// Starts a subpath.
    pub fn move_to(&mut self, p: Point) {
        self.push(Verb::Move, [p]);
    }

    /// A straight line to `p`.
    pub fn line_to(&mut self, p: Point) {
        self.push(Verb::Line, [p]);
    }

    /// A quadratic curve with control point `c` to `p`.
    pub fn quad_to(&mut self, c: Point, p: Point) {
        self.push(Verb::Quad, [c, p]);
    }

    /// A cubic curve with control points `c` and `d` to `p`.
    pub fn cubic_to(&mut self, c: Point, d: Point, p: Point) {
        self.push(Verb::Cubic, [c, d, p]);
    }

    /// Closes the subpath.
    pub fn close(&mut self) {
        self.push(Verb::Close, []);
    }

    /// A closed polygon.
    pub fn ring(&mut self, points: &[Point]) {
        if let Some((&first, rest)) = points.split_first() {
            self.move_to(first);
            rest.iter().for_each(|&p| self.line_to(p));
            self.close();
        }
    }

    /// A closed circle, as four cubic curves that stay within 0.03 % of the radius.
    pub fn circle(&mut self, [x, y]: Point, r: f64) {
        let k = r * 0.552_284_749_830_793_4;
        self.move_to([x + r, y]);
        self.cubic_to([x + r, y + k], [x + k, y + r], [x, y + r]);
        self.cubic_to([x - k, y + r], [x - r, y + k], [x - r, y]);
        self.cubic_to([x - r, y - k], [x - k, y - r], [x, y - r]);
        self.cubic_to([x + k, y - r], [x + r, y - k], [x + r, y]);
        self.close();
    }

    /// The verbs.
    pub fn verbs(&self) -> &[Verb] {
        &self.verbs
    }

    /// The points, in the order in which the verbs take them.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Makes room for so many more verbs of one point each.
    pub(crate) fn reserve(&mut self, verbs: usize) {
        self.verbs.reserve(verbs);
        self.points.reserve(verbs);
    }

    /// Gives back the room that is not used.
    pub(crate) fn shrink_to_fit(&mut self) {
        self.verbs.shrink_to_fit();
        self.points.shrink_to_fit();
    }

    #[inline]
    fn push<const N: usize>(&mut self, verb: Verb, points: [Point; N]) {
        self.verbs.push(verb);
        self.points.extend_from_slice(&points);
    }
}

/// A map of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transform {
    /// `x' = a x + c y + e`, `y' = b x + d y + f`, in SVG's order `[a, b, c, d, e, f]`.
    Affine([f64; 6]),
    /// A homography, row by row: `(x', y', w') = M (x, y, 1)`.
    Projective([f64; 9]),
}

impl Transform {
    /// Every point stays.
    pub const IDENTITY: Transform = Transform::Affine([1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);

    /// This map, followed by a scaling by `scale` and then a move by `offset`.
    #[must_use]
    pub fn then_place(&self, scale: f64, offset: Point) -> Transform {
        let [dx, dy] = offset;
        match *self {
            Transform::Affine([a, b, c, d, e, f]) => {
                Transform::Affine([a * scale, b * scale, c * scale, d * scale, e * scale + dx, f * scale + dy])
            }
            Transform::Projective([a, b, c, d, e, f, g, h, i]) => {
                let x = [a, b, c].map(|v| v * scale);
                let y = [d, e, f].map(|v| v * scale);
                let w = [g, h, i];
                let [x0, x1, x2] = [0, 1, 2].map(|k| x[k] + w[k] * dx);
                let [y0, y1, y2] = [0, 1, 2].map(|k| y[k] + w[k] * dy);
                Transform::Projective([x0, x1, x2, y0, y1, y2, g, h, i])
            }
        }
    }

    /// This map, followed by a quarter turn, clockwise, of a page of that height: `(x, y)` goes to `(height - y, x)`.
    #[must_use]
    pub fn then_turn(&self, height: f64) -> Transform {
        match *self {
            Transform::Affine([a, b, c, d, e, f]) => Transform::Affine([-b, a, -d, c, height - f, e]),
            Transform::Projective([a, b, c, d, e, f, g, h, i]) => {
                let [x0, x1, x2] = [(g, d), (h, e), (i, f)].map(|(w, y)| height * w - y);
                Transform::Projective([x0, x1, x2, a, b, c, g, h, i])
            }
        }
    }
}

/// The line along a path, as SVG describes it. Lengths are in the path's units.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Width; nothing is painted unless it is above 0.
    pub width: f64,
    /// At corners.
    pub join: Join,
    /// At the ends of open subpaths and of dashes.
    pub cap: Cap,
    /// Largest length of a miter, in widths, at least 1.
    pub miter_limit: f64,
    /// Lengths of dashes and gaps in turn; a solid line if there are none, if one is negative or if all are 0.
    pub dashes: Vec<f64>,
    /// How far into the pattern a subpath begins.
    pub dash_offset: f64,
}

impl Stroke {
    /// A solid line with SVG's defaults: miter joins up to 4 widths, butt caps.
    pub fn new(width: f64) -> Stroke {
        Stroke { width, join: Join::Miter, cap: Cap::Butt, miter_limit: 4.0, dashes: Vec::new(), dash_offset: 0.0 }
    }
}

/// What fills the outer side of a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Join {
    /// The edges extended until they meet; past the limit a bevel.
    Miter,
    /// The same; past the limit cut off there.
    MiterClip,
    /// An arc.
    Round,
    /// A straight line.
    Bevel,
}

/// What stands at the ends of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cap {
    /// Nothing.
    Butt,
    /// A half disc.
    Round,
    /// Half a square.
    Square,
}

/// A filled path, or the line along it.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// For messages: the id of the element, or what stands for it.
    pub name: String,
    /// The outline; a fill and a stroke share it, and all places where an element is drawn.
    pub path: Arc<Path>,
    /// Which windings are inside; of a stroke [`FillRule::NonZero`].
    pub rule: FillRule,
    /// If there is one, the shape is this line along the path and not its inside.
    pub stroke: Option<Stroke>,
    /// From the path's coordinates to user units of the page.
    pub transform: Transform,
}

impl Shape {
    /// A path filled by the nonzero rule where it stands.
    pub fn new(name: impl Into<String>, path: impl Into<Arc<Path>>) -> Shape {
        Shape { name: name.into(), path: path.into(), rule: FillRule::NonZero, stroke: None, transform: Transform::IDENTITY }
    }

    /// Hands the rings of the outline under `transform` to `part`, part by part, as points in pixels, not closed by a repeated point. A ring has
    /// at least one point. Points may be infinite or not a number where the transform overflows.
    ///
    /// # Errors
    /// A stroke of more than [`DASHES`], or under a homography; the first that `part` returns.
    pub fn rings(&self, transform: &Transform, how: &Flattening, mut part: impl FnMut(Part<'_>) -> Result<()>) -> Result<()> {
        let whole = |ring: &[Point]| flatten::whole(ring, &mut part);
        match (&self.stroke, transform) {
            (None, Transform::Affine(matrix)) => flatten::rings(&self.path, matrix, how, part),
            (None, Transform::Projective(matrix)) => projective::rings(&self.path, matrix, how, whole),
            (Some(stroke), Transform::Affine(matrix)) => stroke::rings(&self.path, stroke, matrix, how, &self.name, whole),
            (Some(_), Transform::Projective(_)) => {
                Err(Error::input(Kind::Refused, format!("\"{}\": a stroke under a homography: draw its outline", self.name)))
            }
        }
    }
}
