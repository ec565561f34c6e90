//! From shapes to edges: flattened, rounded to the grid, cut to the page, gathered into chains (`outline`).

mod outline;

use self::outline::{Outline, Stretch};
use crate::count::Node;
use crate::error::{Error, Kind, Result};
use crate::grid::{self, Point};
use crate::shape::flatten::{Flattening, Part};
use crate::shape::{Shape, Transform, Verb};
use crate::sweep::Edges;

/// What an edge does to the winding of its shape when it is crossed from left to right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Side {
    /// The shape's leaf in the counting program.
    pub leaf: Node,
    /// Added to its winding number.
    pub winding: i32,
}

/// Where user units come to lie on the page: scaled, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Pixels to a user unit.
    pub scale: f64,
    /// Where the origin of the drawing lies, in pixels.
    pub offset: Point,
}

/// The edges of a picture.
#[derive(Clone, Debug)]
pub struct Outlines {
    /// The edges on the page, sorted.
    pub edges: Edges<Side>,
    /// How many leaves they count for.
    pub leaves: usize,
    /// Whether edges right of the page were left out, so that windings do not come back to 0 at a scanline's end.
    pub open: bool,
    /// Number of edges before any was dropped.
    pub seen: u64,
}

/// Collects the edges of shapes on a page.
#[derive(Debug)]
pub struct Builder {
    edges: Edges<Side>,
    width: u32,
    height: u32,
    placement: Placement,
    tolerance: f64,
    limit: u64,
    seen: u64,
    leaves: usize,
    outline: Outline,
}

impl Builder {
    /// For a page of `width` x `height` pixels; curves are flattened to `tolerance` pixels. More than `limit` edges are refused.
    pub fn new(width: u32, height: u32, placement: Placement, tolerance: f64, limit: u64) -> Builder {
        Builder {
            edges: Edges::default(),
            width,
            height,
            placement,
            tolerance,
            limit,
            seen: 0,
            leaves: 0,
            outline: Outline::new(width, height),
        }
    }

    /// Adds the edges of a shape, counted for `leaf`, which is given once.
    ///
    /// # Errors
    /// Coordinates past what a double holds; too many edges or dashes; a stroke under a homography.
    pub fn add(&mut self, shape: &Shape, leaf: Node) -> Result<()> {
        let transform = shape.transform.then_place(self.placement.scale, self.placement.offset);
        let window = [0.0, 0.0, f64::from(self.width), f64::from(self.height)];
        let how = Flattening { tolerance: self.tolerance, window };
        let before = self.edges.len();
        shape.rings(&transform, &how, |part| self.add_part(part, leaf, &shape.name))?;
        self.leaves += usize::from(self.edges.len() > before);
        Ok(())
    }

    /// Whether a shape is a rectangle that holds all pixel centres of the page, such as the frame that drawing programs clip everything to.
    pub fn holds_page(&self, shape: &Shape) -> bool {
        let (points, verbs) = (shape.path.points(), shape.path.verbs());
        let lines = verbs.strip_suffix(&[Verb::Close]).unwrap_or(verbs);
        let four = matches!(lines, [Verb::Move, Verb::Line, Verb::Line, Verb::Line]);
        let five = matches!(lines, [Verb::Move, Verb::Line, Verb::Line, Verb::Line, Verb::Line]) && points[0] == points[4];
        let Transform::Affine([a, b, c, d, e, f]) = shape.transform.then_place(self.placement.scale, self.placement.offset) else {
            return false;
        };
        if shape.stroke.is_some() || (!four && !five) {
            return false;
        }
        let corner = |[x, y]: Point| grid::snap_point([a * x + c * y + e, b * x + d * y + f]);
        let [p, q, r, s] = [0, 1, 2, 3].map(|i| corner(points[i]));
        let upright = |i: usize, j: usize| p[i] == q[i] && q[j] == r[j] && r[i] == s[i] && s[j] == p[j];
        let [width, height] = [self.width, self.height].map(f64::from);
        (upright(0, 1) || upright(1, 0))
            && p[0].min(r[0]) <= 0.5
            && p[1].min(r[1]) <= 0.5
            && p[0].max(r[0]) > width - 0.5
            && p[1].max(r[1]) > height - 0.5
    }

    /// Counts the edges of a rectangle that holds the page, which take no part in anything.
    pub fn skip_rectangle(&mut self) {
        self.seen += 4;
    }

    /// Puts the edges of another builder for the same page, of other leaves, behind those of this. False, and nothing is to be made of it, if together they
    /// are too many.
    #[must_use]
    pub fn append(&mut self, other: Builder) -> bool {
        self.seen += other.seen;
        self.leaves += other.leaves;
        self.outline.open |= other.outline.open;
        let within = self.seen <= self.limit;
        if within && self.edges.is_empty() {
            self.edges = other.edges;
        } else if within {
            self.edges.append(other.edges);
        }
        within
    }

    /// The edges, sorted.
    pub fn finish(self) -> Outlines {
        Outlines { edges: self.edges.finish(), leaves: self.leaves, open: self.outline.open, seen: self.seen }
    }

    fn add_part(&mut self, part: Part<'_>, leaf: Node, name: &str) -> Result<()> {
        let edges = &mut self.edges;
        let mut add =
            |chain: &[Stretch], winding| edges.add(chain[0].first, chain.iter().map(|stretch| stretch.edge), Side { leaf, winding });
        if !outline::are_finite(part.xs) || !outline::are_finite(part.ys) {
            let what = format!("\"{name}\" reaches beyond 1.8e308 pixels: use smaller coordinates or transforms");
            return Err(Error::input(Kind::Refused, what));
        }
        self.seen += self.outline.points(part.xs, part.ys, &mut add);
        if self.seen > self.limit {
            let what = format!("\"{name}\": more than {} edges: raise --tolerance or draw less", self.limit);
            return Err(Error::input(Kind::Limit, what));
        }
        if part.last {
            self.seen += self.outline.end(&mut add);
        }
        Ok(())
    }
}
