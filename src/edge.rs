//! From shapes to edges: flattened, rounded to the grid, cut to the page, gathered into chains.
//!
//! A ring of points becomes chains of edges that run in one vertical direction. Edges that meet no scanline of the page are dropped (they
//! cannot change a pixel), edges left of the page become vertical at column 0 (they still count), edges right of it are dropped.
//! What remains of one direction stays one chain, whatever was dropped between, so the next edge of an outline takes the place of the one before
//! without an event.
//!
//! ```text
//!        1
//!       / \             ring 1 2 3 4 5: chain 1-2-3 with winding +1, chain 1-5 with winding -1
//!      /   \ 2
//!    5 \    |           between 4 and 5 lies no centre of a scanline: that edge is dropped, and 3-4 with it
//!      4\_  | 3
//! ```

use std::ops::Range;

use crate::count::Node;
use crate::error::{Error, Kind, Result};
use crate::grid::{self, Point};
use crate::line::Line;
use crate::line::exact::{self, Piece};
use crate::shape::flatten::Flattening;
use crate::shape::{Shape, Transform, Verb};
use crate::sweep::{Edge, Edges};

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

/// An edge with its first scanline.
#[derive(Clone, Copy, Debug)]
struct Part {
    first: u32,
    edge: Edge,
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
    open: bool,
    /// Parts of the chain that is being gathered, in the order of the ring.
    chain: Vec<Part>,
    downwards: bool,
    pieces: Vec<Piece>,
    /// For every point of a ring the first scanline that is not above it.
    rows: Vec<u32>,
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
            open: false,
            chain: Vec::new(),
            downwards: true,
            pieces: Vec::new(),
            rows: Vec::new(),
        }
    }

    /// Adds the edges of a shape, counted for `leaf`.
    ///
    /// # Errors
    /// Coordinates past what a double holds; too many edges or dashes; a stroke under a homography.
    pub fn add(&mut self, shape: &Shape, leaf: Node) -> Result<()> {
        let transform = shape.transform.then_place(self.placement.scale, self.placement.offset);
        let window = [0.0, 0.0, f64::from(self.width), f64::from(self.height)];
        let how = Flattening { tolerance: self.tolerance, window };
        shape.rings(&transform, &how, |ring| self.add_ring(ring, leaf, &shape.name))
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

    /// Puts the edges of another builder for the same page behind those of this. False, and nothing is to be made of it, if together they are too many.
    #[must_use]
    pub fn append(&mut self, other: Builder) -> bool {
        self.seen += other.seen;
        self.open |= other.open;
        let within = self.seen <= self.limit;
        if within {
            self.edges.append(other.edges);
        }
        within
    }

    /// The edges, sorted; whether windings stay open at the right end of scanlines; and how many edges were seen before any was dropped.
    pub fn finish(self) -> (Edges<Side>, bool, u64) {
        (self.edges.finish(), self.open, self.seen)
    }

    fn add_ring(&mut self, ring: &[Point], leaf: Node, name: &str) -> Result<()> {
        let near = ring.as_flattened().iter().fold(true, |near, v| near & (v.abs() <= grid::NEAR));
        if !near && !ring.as_flattened().iter().all(|v| v.is_finite()) {
            let what = format!("\"{name}\" reaches beyond 1.8e308 pixels: use smaller coordinates or transforms");
            return Err(Error::input(Kind::Refused, what));
        }
        self.seen += ring.windows(2).filter(|pair| pair[0] != pair[1]).count() as u64 + u64::from(ring.first() != ring.last());
        if self.seen > self.limit {
            let what = format!("\"{name}\": more than {} edges: raise --tolerance or draw less", self.limit);
            return Err(Error::input(Kind::Limit, what));
        }
        let height = f64::from(self.height);
        let mut rows = std::mem::take(&mut self.rows);
        rows.clear();
        if near {
            let height = i64::from(self.height);
            rows.extend(ring.iter().map(|p| grid::first_centre(grid::steps(p[1])).clamp(0, height) as u32));
        } else {
            rows.extend(ring.iter().map(|p| exact::row(grid::snap(p[1])).clamp(0.0, height) as u32));
        }
        // From a topmost point on, so that no chain is cut where the ring happens to begin.
        let least = rows.iter().fold(u32::MAX, |least, &row| least.min(row));
        let top = rows.iter().position(|&row| row == least).unwrap_or(0);
        // Most edges of fine outlines meet no scanline.
        for i in (top..ring.len()).chain(0..top) {
            let next = if i + 1 < ring.len() { i + 1 } else { 0 };
            if rows[i] != rows[next] {
                self.add_edge(ring[i], ring[next], rows[i]..rows[next], near, leaf);
            }
        }
        self.rows = rows;
        self.end_chain(leaf);
        Ok(())
    }

    /// Adds the edge between two points that meets scanlines, going down or up: those from the first row on, or back from it.
    fn add_edge(&mut self, from: Point, to: Point, rows: Range<u32>, near: bool, leaf: Node) {
        let downwards = rows.start < rows.end;
        let (top, bottom, rows) = if downwards { (from, to, rows) } else { (to, from, rows.end..rows.start) };
        let steps = |p: Point| p.map(grid::steps);
        let [x, y] = [top, bottom].map(|p| grid::snap(p[0]));
        if x.min(y) > f64::from(self.width) - 0.5 {
            self.open = true;
            return;
        }
        self.pieces.clear();
        if x.max(y) <= 0.5 {
            self.pieces.push(Piece { last: rows.end, line: Line::vertical(0) });
        } else if let Some(line) =
            near.then(|| Line::through(steps(top), steps(bottom), rows.start, rows.end - rows.start, self.width)).flatten()
        {
            self.pieces.push(Piece { last: rows.end, line });
        } else {
            exact::pieces(grid::snap_point(top), grid::snap_point(bottom), rows.clone(), self.width, &mut self.pieces);
        }
        let joined = self
            .chain
            .last()
            .is_some_and(|end| self.downwards == downwards && if downwards { end.edge.last == rows.start } else { end.first == rows.end });
        if !joined {
            self.end_chain(leaf);
        }
        self.downwards = downwards;
        let mut first = rows.start;
        let behind = self.chain.len();
        for piece in &self.pieces {
            self.chain.push(Part { first, edge: Edge { last: piece.last, line: piece.line } });
            first = piece.last;
        }
        if !downwards {
            self.chain[behind..].reverse();
        }
    }

    /// Hands the chain that was gathered to the sweep.
    fn end_chain(&mut self, leaf: Node) {
        if !self.downwards {
            self.chain.reverse();
        }
        // Vertical edges that follow each other in one column are one.
        self.chain.dedup_by(|below, above| {
            let same = above.edge.line == below.edge.line && above.edge.line.is_vertical();
            if same {
                above.edge.last = below.edge.last;
            }
            same
        });
        if let Some(&Part { first, .. }) = self.chain.first() {
            let winding = if self.downwards { 1 } else { -1 };
            self.edges.add(first, self.chain.drain(..).map(|part| part.edge), Side { leaf, winding });
        }
    }
}
