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

/// A point of a ring, and the first scanline that is not above it, on the page or behind its end.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    point: Point,
    row: u32,
}

/// An edge with its first scanline.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    first: u32,
    edge: Edge,
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

    /// Goes on with the ring, by at most [`PART`] points, all of them finite. Hands the chains that end to `add`: first row, edges, winding. Gives the number of edges.
    pub(super) fn points(&mut self, points: &[Point], add: &mut impl FnMut(u32, &mut dyn Iterator<Item = Edge>, i32)) -> u64 {
        let Some(&first) = points.first() else { return 0 };
        let rows = &mut self.rows;
        if points.iter().fold(true, |near, p| near & (p[1].abs() <= grid::NEAR)) {
            let height = i64::from(self.height);
            rows.iter_mut().zip(points).for_each(|(row, p)| *row = grid::first_centre(grid::steps(p[1])).clamp(0, height) as u32);
        } else {
            let height = f64::from(self.height);
            rows.iter_mut().zip(points).for_each(|(row, p)| *row = exact::row(grid::snap(p[1])).clamp(0.0, height) as u32);
        }
        let first = Vertex { point: first, row: rows[0] };
        let [start, mut at] = self.ring.unwrap_or([first; 2]);
        let mut seen = u64::from(at.point != first.point);
        seen += points.windows(2).fold(0, |seen, pair| seen + u64::from(pair[0] != pair[1]));
        // Most edges of fine outlines meet no scanline.
        for (i, &point) in points.iter().enumerate() {
            let row = self.rows[i];
            if row != at.row {
                self.edge(at, Vertex { point, row }, add);
            }
            at = Vertex { point, row };
        }
        self.ring = Some([start, at]);
        seen
    }

    /// Closes the ring. Where it began no chain is cut: the last goes on with the first. Gives the number of edges that this adds.
    pub(super) fn end(&mut self, add: &mut impl FnMut(u32, &mut dyn Iterator<Item = Edge>, i32)) -> u64 {
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
    fn edge(&mut self, from: Vertex, to: Vertex, add: &mut impl FnMut(u32, &mut dyn Iterator<Item = Edge>, i32)) {
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
fn hand_on(chain: &mut Chain, add: &mut impl FnMut(u32, &mut dyn Iterator<Item = Edge>, i32)) {
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
    if let Some(&Stretch { first, .. }) = stretches.first() {
        let winding = if *downwards { 1 } else { -1 };
        add(first, &mut stretches.drain(..).map(|stretch| stretch.edge), winding);
    }
}
