//! From active edges to runs: the walk along a scanline that counts shapes in and out.
//!
//! Edges in one column are counted together, then the topmost layer that holds is looked up; where its ink changes, a run ends or begins
//! ("CSG" in ARCHITECTURE.md, section 2.2.3, step 3, and 3.2 for layers: the paper's list of active polygons by priority is a bit set of layers here).
//!
//! ```text
//!   columns    2     5     5     9            the walk of  a - b
//!   edges      a+    a-    b+    b-
//!   ink     .  |  #  |     .     |  .         boundaries: edge 0 -> ink 0, edge 1 -> paper
//! ```
//!
//! The boundaries are kept as indices into the active list. As long as no edge enters or leaves and neither the order of the edges nor
//! their ties change, the same boundaries hold on the next scanline and nothing is counted; only their columns are read. So
//! the number of scanlines that are counted follows the drawing and not the resolution.

use std::ops::Range;
use std::sync::Arc;

use crate::bits::BitSet;
use crate::count::{Counters, Program};
use crate::edge::Side;
use crate::run::{Lines, Run};
use crate::sweep::{Edges, Sweep};

/// A picture ready to be swept.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// The edges.
    pub edges: Edges<Side>,
    /// The expressions of the layers: output i is layer i, the last on top.
    pub program: Program,
    /// Ink of each layer.
    pub inks: Vec<u32>,
    /// Whether edges right of the page were left out, so that windings do not come back to 0 at a scanline's end.
    pub open: bool,
}

/// What a walk has cost so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Scanlines on which was counted.
    pub counted: u64,
    /// Scanlines that repeat the one above without any work.
    pub repeated: u64,
    /// Crossings counted.
    pub toggles: u64,
    /// Largest number of active edges.
    pub peak_active: u64,
}

impl Cost {
    /// Adds what another walk has cost.
    pub fn add(&mut self, other: &Cost) {
        self.counted += other.counted;
        self.repeated += other.repeated;
        self.toggles += other.toggles;
        self.peak_active = self.peak_active.max(other.peak_active);
    }
}

/// A place where the visible ink changes.
#[derive(Clone, Copy, Debug)]
struct Boundary {
    /// Index of the first of the edges in its column; [`LEFT_SIDE`] for what holds before any.
    edge: u32,
    /// The ink from there on, or [`PAPER`].
    ink: u32,
}

const LEFT_SIDE: u32 = u32::MAX;
const PAPER: u32 = u32::MAX;

/// The rows of a picture, pulled from top to bottom.
#[derive(Clone, Debug)]
pub struct Rows {
    picture: Arc<Picture>,
    sweep: Sweep<Side>,
    counters: Counters,
    layers: BitSet,
    boundaries: Vec<Boundary>,
    runs: Vec<Run>,
    cost: Cost,
}

impl Rows {
    /// The rows `rows` of a picture.
    pub fn new(picture: Arc<Picture>, rows: Range<u32>) -> Rows {
        let counters = Counters::new(&picture.program);
        let mut layers = BitSet::new(picture.inks.len());
        (0..picture.inks.len()).filter(|&i| counters.output(&picture.program, i)).for_each(|i| layers.insert(i));
        Rows { sweep: Sweep::new(rows), counters, layers, boundaries: Vec::new(), runs: Vec::new(), cost: Cost::default(), picture }
    }

    /// The next row or rows; `None` behind the last. Rows that follow each other may be equal.
    #[expect(clippy::should_implement_trait, reason = "the rows are lent, not given")]
    pub fn next(&mut self) -> Option<Lines<'_>> {
        let scanline = self.sweep.next(&self.picture.edges)?;
        if scanline.changed {
            self.count();
        }
        self.cost.repeated += u64::from(scanline.n - 1);
        self.emit();
        Some(Lines { y: scanline.y, n: scanline.n, runs: &self.runs })
    }

    /// The runs of the row that was given last.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// What the rows have cost so far.
    pub fn cost(&self) -> &Cost {
        &self.cost
    }

    /// Walks the active list and notes where the visible ink changes.
    fn count(&mut self) {
        let Picture { program, inks, open, .. } = &*self.picture;
        let (columns, list, tags) = (self.sweep.columns(), self.sweep.list(), self.sweep.tags());
        let side = |i: usize| tags[list[i].slot()];
        let visible = |layers: &BitSet| layers.last().map_or(PAPER, |layer| inks[layer]);
        let paint = |layers: &mut BitSet, layer: u32, holds| {
            if holds { layers.insert(layer as usize) } else { layers.remove(layer as usize) }
        };
        self.cost.counted += 1;
        self.cost.toggles += columns.len() as u64;
        self.cost.peak_active = self.cost.peak_active.max(columns.len() as u64);

        let mut ink = visible(&self.layers);
        self.boundaries.clear();
        self.boundaries.push(Boundary { edge: LEFT_SIDE, ink });
        let mut edge = 0;
        while edge < columns.len() {
            let flip = |layer, holds| paint(&mut self.layers, layer, holds);
            let mut next = edge + 1;
            if columns.get(next) == Some(&columns[edge]) {
                self.counters.add(side(edge).leaf, side(edge).winding);
                while columns.get(next) == Some(&columns[edge]) {
                    self.counters.add(side(next).leaf, side(next).winding);
                    next += 1;
                }
                self.counters.settle(program, flip);
            } else {
                self.counters.cross(program, side(edge).leaf, side(edge).winding, flip);
            }
            let now = visible(&self.layers);
            if now != ink {
                ink = now;
                self.boundaries.push(Boundary { edge: edge as u32, ink });
            }
            edge = next;
        }
        if *open {
            list.iter().for_each(|entry| self.counters.clear(tags[entry.slot()].leaf));
            self.counters.settle(program, |layer, holds| paint(&mut self.layers, layer, holds));
        }
    }

    /// Turns boundaries and columns into runs. A boundary at the left side and one in column 0 coincide, and one in the last column is
    /// behind the page: both leave an empty run, which is dropped.
    fn emit(&mut self) {
        let columns = self.sweep.columns();
        let column = |boundary: &Boundary| if boundary.edge == LEFT_SIDE { 0 } else { columns[boundary.edge as usize] };
        self.runs.clear();
        for (i, boundary) in self.boundaries.iter().enumerate() {
            let start = column(boundary);
            let end = self.boundaries.get(i + 1).map_or(self.picture.width, column);
            if boundary.ink != PAPER && start < end {
                self.runs.push(Run { start, end, ink: boundary.ink });
            }
        }
    }
}
