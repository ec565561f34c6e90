//! A ring of points becomes chains of edges that run in one vertical direction.
//!
//! Points come in parts, so that a ring of any length passes through a small buffer. Edges that meet no scanline of the page are dropped (they
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

use crate::grid::{self, Point, SUB};
use crate::line::Line;
use crate::line::exact::{self, Piece};
use crate::shape::flatten::PART;
use crate::sweep::Edge;

/// Points no further from the origin, in pixels, find their scanlines many at once.
const CLOSE: f64 = (1 << 22) as f64;

/// Whether points are so close to the origin; they are finite then.
pub(super) fn are_close(points: &[Point]) -> bool {
    points.as_flattened().iter().fold(true, |close, v| close & (v.abs() <= CLOSE))
}

/// A point of a ring, and the first scanline that is not above it, on the page or behind its end.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    point: Point,
    row: u32,
}

/// An edge with its first scanline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    pub(super) first: u32,
    pub(super) edge: Edge,
}

/// Edges that follow each other in the order of the ring.
#[derive(Debug, Default)]
struct Chain {
    stretches: Vec<Stretch>,
    downwards: bool,
}

impl Chain {
    /// Whether an edge in that direction that meets the rows from `first` up to `last` goes on where this chain ends.
    fn goes_on(&self, downwards: bool, first: u32, last: u32) -> bool {
        let ends = |end: &Stretch| if downwards { end.edge.last == first } else { end.first == last };
        self.downwards == downwards && self.stretches.last().is_some_and(ends)
    }
}

/// The ring at hand, and what is known of its chains.
#[derive(Debug)]
pub(super) struct Outline {
    width: u32,
    height: u32,
    /// Where the ring began, and where it has come to.
    ring: Option<[Vertex; 2]>,
    chain: Chain,
    /// The chain that the ring began in the middle of, kept until the ring is closed once it `has_opened`.
    opening: Chain,
    has_opened: bool,
    pieces: Vec<Piece>,
    /// Of the points at hand: the first scanlines that are not above them.
    rows: Box<[u32; PART]>,
    /// Whether edges right of the page were dropped.
    pub(super) open: bool,
}

impl Outline {
    pub(super) fn new(width: u32, height: u32) -> Outline {
        Outline {
            width,
            height,
            ring: None,
            chain: Chain::default(),
            opening: Chain::default(),
            has_opened: false,
            pieces: Vec::new(),
            rows: Box::new([0; PART]),
            open: false,
        }
    }

    /// Goes on with the ring, by at most [`PART`] points, all of them finite, and if it is said [`are_close`]. Hands the chains that end to `add`: edges from the top
    /// down, and what they add to the winding. Gives the number of edges.
    pub(super) fn points(&mut self, points: &[Point], close: bool, add: &mut impl FnMut(&[Stretch], i32)) -> u64 {
        let Some(&first) = points.first() else { return 0 };
        if close {
            let height = f64::from(self.height);
            self.rows.iter_mut().zip(points).for_each(|(to, p)| *to = grid::first_row(p[1], height));
        } else {
            let height = f64::from(self.height);
            self.rows.iter_mut().zip(points).for_each(|(to, p)| *to = exact::row(grid::snap(p[1])).clamp(0.0, height) as u32);
        }
        let first = Vertex { point: first, row: self.rows[0] };
        let [start, before] = self.ring.unwrap_or([first; 2]);
        if before.row != first.row {
            self.edge(before, first, add);
        }
        // Most edges of fine outlines meet no scanline.
        let mut i = 1;
        while i < points.len() {
            let row = self.rows[i - 1];
            if let Some(block) = self.rows[i..points.len()].first_chunk::<16>()
                && block.iter().fold(true, |same, &other| same & (other == row))
            {
                i += 16;
                continue;
            }
            if self.rows[i] != row {
                self.edge(Vertex { point: points[i - 1], row }, Vertex { point: points[i], row: self.rows[i] }, add);
            }
            i += 1;
        }
        let last = Vertex { point: points[points.len() - 1], row: self.rows[points.len() - 1] };
        self.ring = Some([start, last]);
        let differ = |a: &Point, b: &Point| u64::from((a[0] != b[0]) | (a[1] != b[1]));
        differ(&before.point, &first.point) + points.iter().zip(&points[1..]).fold(0, |seen, (a, b)| seen + differ(a, b))
    }

    /// Closes the ring. Where it began no chain is cut: the last goes on with the first. Gives the number of edges that this adds.
    pub(super) fn end(&mut self, add: &mut impl FnMut(&[Stretch], i32)) -> u64 {
        let Some([start, at]) = self.ring.take() else { return 0 };
        if start.row != at.row {
            self.edge(at, start, add);
        }
        if std::mem::take(&mut self.has_opened) {
            let Chain { stretches, downwards } = &mut self.opening;
            if !self.chain.goes_on(*downwards, stretches[0].first, stretches[0].edge.last) {
                hand_on(&mut self.chain, add);
            }
            self.chain.downwards = *downwards;
            self.chain.stretches.append(stretches);
        }
        hand_on(&mut self.chain, add);
        u64::from(start.point != at.point)
    }

    /// Adds an edge that meets scanlines.
    fn edge(&mut self, from: Vertex, to: Vertex, add: &mut impl FnMut(&[Stretch], i32)) {
        let downwards = from.row < to.row;
        let (top, bottom) = if downwards { (from, to) } else { (to, from) };
        // Left of all pixel centres, right of all, or perhaps one straight line.
        let (left, right, line) = if grid::is_near(top.point) && grid::is_near(bottom.point) {
            let [p, q] = [top, bottom].map(|vertex| vertex.point.map(grid::steps));
            let (least, most) = (p[0].min(q[0]), p[0].max(q[0]));
            let line = Line::through(p, q, top.row, bottom.row - top.row, self.width);
            (most <= SUB / 2, least > i64::from(self.width) * SUB - SUB / 2, line)
        } else {
            let [x, y] = [top, bottom].map(|vertex| grid::snap(vertex.point[0]));
            (x.max(y) <= 0.5, x.min(y) > f64::from(self.width) - 0.5, None)
        };
        if right {
            self.open = true;
            return;
        }
        let line = if left { Some(Line::vertical(0)) } else { line };
        if !self.chain.goes_on(downwards, top.row, bottom.row) {
            // The first that ends is where the ring began.
            if !self.has_opened && !self.chain.stretches.is_empty() {
                std::mem::swap(&mut self.opening, &mut self.chain);
                self.has_opened = true;
            } else {
                hand_on(&mut self.chain, add);
            }
            self.chain.downwards = downwards;
        }
        let stretches = &mut self.chain.stretches;
        if let Some(line) = line {
            return stretches.push(Stretch { first: top.row, edge: Edge { last: bottom.row, line } });
        }
        self.pieces.clear();
        exact::pieces(grid::snap_point(top.point), grid::snap_point(bottom.point), top.row..bottom.row, self.width, &mut self.pieces);
        let (mut first, behind) = (top.row, stretches.len());
        for &Piece { last, line } in &self.pieces {
            stretches.push(Stretch { first, edge: Edge { last, line } });
            first = last;
        }
        if !downwards {
            stretches[behind..].reverse();
        }
    }
}

/// Hands a chain on and empties it.
fn hand_on(chain: &mut Chain, add: &mut impl FnMut(&[Stretch], i32)) {
    let Chain { stretches, downwards } = chain;
    if !*downwards {
        stretches.reverse();
    }
    // Vertical edges that follow each other in one column are one.
    stretches.dedup_by(|below, above| {
        let same = above.edge.line == below.edge.line && above.edge.line.is_vertical();
        if same {
            above.edge.last = below.edge.last;
        }
        same
    });
    if !stretches.is_empty() {
        add(stretches, if *downwards { 1 } else { -1 });
        stretches.clear();
    }
}
