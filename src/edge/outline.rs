//! A ring of points becomes chains of edges that run in one vertical direction.
//!
//! Points come in parts, so that a ring of any length passes through a small buffer. Edges that meet no scanline of the page are dropped (they
//! cannot change a pixel), edges between two pixels' centres become vertical, those left of the page too, at column 0 (they still count), edges right of it are
//! dropped.
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

use crate::grid::{self, Point};
use crate::line::Line;
use crate::line::exact::{self, Piece};
use crate::shape::flatten::PART;
use crate::sweep::Edge;

/// Whether all of them are finite.
pub(super) fn are_finite(values: &[f64]) -> bool {
    // A sum is not finite if one of them is not; only seldom otherwise.
    let (blocks, rest) = values.as_chunks::<8>();
    let mut sums = [0.0; 8];
    blocks.iter().for_each(|block| sums.iter_mut().zip(block).for_each(|(sum, v)| *sum += v));
    sums.iter().chain(rest).sum::<f64>().is_finite() || values.iter().all(|v| v.is_finite())
}

/// Points whose scanlines are compared at once.
const BLOCK: usize = 16;

/// Which of them differ from the next: a bit for each.
fn differing(rows: &[u32; BLOCK + 1]) -> u32 {
    (0..BLOCK).fold(0, |bits, i| bits | u32::from(rows[i] != rows[i + 1]) << i)
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

    /// Goes on with an edge. Vertical edges that follow each other in one column are one.
    #[inline]
    fn push(&mut self, stretch: Stretch) {
        match self.stretches.last_mut() {
            Some(end) if end.edge.line == stretch.edge.line && end.edge.line.is_vertical() => {
                end.first = end.first.min(stretch.first);
                end.edge.last = end.edge.last.max(stretch.edge.last);
            }
            _ => self.stretches.push(stretch),
        }
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
    /// Of the points at hand: the first scanlines that are not above them.
    rows: Box<[u32; PART + BLOCK]>,
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
            rows: Box::new([0; PART + BLOCK]),
            open: false,
        }
    }

    /// Goes on with the ring, by at most [`PART`] points, all of them finite. Hands the chains that end to `add`: edges from the top
    /// down, and what they add to the winding. Gives the number of edges.
    pub(super) fn points(&mut self, xs: &[f64], ys: &[f64], add: &mut impl FnMut(&[Stretch], i32)) -> u64 {
        let (&[x, ..], &[y, ..]) = (xs, ys) else { return 0 };
        let height = f64::from(self.height);
        self.rows.iter_mut().zip(ys).for_each(|(row, &y)| *row = grid::first_within(y, height));
        let last = xs.len() - 1;
        // Behind the last nothing differs.
        let end = self.rows[last];
        self.rows[last + 1..][..BLOCK].fill(end);
        let first = Vertex { point: [x, y], row: self.rows[0] };
        let [start, before] = self.ring.unwrap_or([first; 2]);
        if before.row != first.row {
            self.between(before, first, add);
        }
        // Most edges of fine outlines meet no scanline.
        for start in (0..last).step_by(BLOCK) {
            let mut meet = differing(self.rows[start..].first_chunk().expect("there is room for one more block"));
            while meet != 0 {
                let from = start + meet.trailing_zeros() as usize;
                meet &= meet - 1;
                // Which end is the upper one is as good as random: it is looked up, not asked.
                let [before, behind] = [self.rows[from], self.rows[from + 1]];
                let downwards = before < behind;
                let (top, bottom) = (from + usize::from(!downwards), from + usize::from(downwards));
                let rows = before.min(behind)..before.max(behind);
                self.edge((xs[top], ys[top]), (xs[bottom], ys[bottom]), rows, downwards, add);
            }
        }
        self.ring = Some([start, Vertex { point: [xs[last], ys[last]], row: end }]);
        let differ = |[a, b]: [f64; 2], [c, d]: [f64; 2]| u64::from((a != c) | (b != d));
        let pairs = xs.iter().zip(&xs[1..]).zip(ys.iter().zip(&ys[1..]));
        differ(before.point, first.point) + pairs.fold(0, |seen, ((&a, &c), (&b, &d))| seen + differ([a, b], [c, d]))
    }

    /// Closes the ring. Where it began no chain is cut: the last goes on with the first. Gives the number of edges that this adds.
    pub(super) fn end(&mut self, add: &mut impl FnMut(&[Stretch], i32)) -> u64 {
        let Some([start, at]) = self.ring.take() else { return 0 };
        if start.row != at.row {
            self.between(at, start, add);
        }
        if std::mem::take(&mut self.has_opened) {
            let Chain { stretches, downwards } = &mut self.opening;
            if !self.chain.goes_on(*downwards, stretches[0].first, stretches[0].edge.last) {
                hand_on(&mut self.chain, add);
            }
            self.chain.downwards = *downwards;
            self.chain.push(stretches[0]);
            self.chain.stretches.extend_from_slice(&stretches[1..]);
            stretches.clear();
        }
        hand_on(&mut self.chain, add);
        u64::from(start.point != at.point)
    }

    /// Adds the edge between two points on different scanlines.
    fn between(&mut self, from: Vertex, to: Vertex, add: &mut impl FnMut(&[Stretch], i32)) {
        let downwards = from.row < to.row;
        let (top, bottom) = if downwards { (from, to) } else { (to, from) };
        self.edge(top.point.into(), bottom.point.into(), top.row..bottom.row, downwards, add);
    }

    /// Adds an edge, given by its upper and its lower end, that meets the scanlines `rows`.
    #[inline]
    fn edge(&mut self, top: (f64, f64), bottom: (f64, f64), rows: Range<u32>, downwards: bool, add: &mut impl FnMut(&[Stretch], i32)) {
        let [top, bottom] = [top, bottom].map(Point::from);
        // Between the ends' columns, on the page, lie all others.
        let width = f64::from(self.width);
        let (from, to) = (grid::first_within(top[0], width), grid::first_within(bottom[0], width));
        let line = if from == to {
            if from == self.width {
                self.open = true;
                return;
            }
            Some(Line::vertical(from))
        } else if grid::is_near(top) && grid::is_near(bottom) {
            let [top, bottom] = [top, bottom].map(|point| point.map(grid::steps));
            Line::through(top, bottom, rows.start, rows.end - rows.start, self.width)
        } else {
            None
        };
        if !self.chain.goes_on(downwards, rows.start, rows.end) {
            self.begin(downwards, add);
        }
        match line {
            Some(line) => self.chain.push(Stretch { first: rows.start, edge: Edge { last: rows.end, line } }),
            None => self.pieces(top, bottom, rows),
        }
    }

    /// Begins a chain. The first that ends is where the ring began.
    fn begin(&mut self, downwards: bool, add: &mut impl FnMut(&[Stretch], i32)) {
        if !self.has_opened && !self.chain.stretches.is_empty() {
            std::mem::swap(&mut self.opening, &mut self.chain);
            self.has_opened = true;
        } else {
            hand_on(&mut self.chain, add);
        }
        self.chain.downwards = downwards;
    }

    /// Goes on with an edge that no single line stands for.
    #[cold]
    fn pieces(&mut self, top: Point, bottom: Point, rows: Range<u32>) {
        let mut pieces = Vec::new();
        exact::pieces(grid::snap_point(top), grid::snap_point(bottom), rows.clone(), self.width, &mut pieces);
        let firsts = [rows.start].into_iter().chain(pieces.iter().map(|piece| piece.last));
        let stretches = firsts.zip(&pieces).map(|(first, &Piece { last, line })| Stretch { first, edge: Edge { last, line } });
        let mut stretches: Vec<Stretch> = stretches.collect();
        if !self.chain.downwards {
            stretches.reverse();
        }
        stretches.into_iter().for_each(|stretch| self.chain.push(stretch));
    }
}

/// Hands a chain on and empties it.
fn hand_on(chain: &mut Chain, add: &mut impl FnMut(&[Stretch], i32)) {
    let Chain { stretches, downwards } = chain;
    if !*downwards {
        stretches.reverse();
    }
    if !stretches.is_empty() {
        add(stretches, if *downwards { 1 } else { -1 });
        stretches.clear();
    }
}
