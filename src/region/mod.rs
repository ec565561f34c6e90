//! From active edges to runs.
//!
//! The boundaries between inks are kept as indices into the active list ([`walk`]). As long as no edge enters or leaves and neither the order of the edges nor
//! their ties change, the same boundaries hold on the next scanline and nothing is counted; only their columns are read ("CSG" in ARCHITECTURE.md, section 2.2.3). So
//! the number of scanlines that are counted follows the drawing and not the resolution.

mod walk;

use std::ops::Range;
use std::sync::Arc;

use self::walk::{Boundary, LEFT_SIDE, Walk};
use crate::count::Program;
use crate::edge::{Outlines, Side};
use crate::run::{Lines, Run};
use crate::sweep::Sweep;

/// A picture ready to be swept.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// The edges.
    pub outlines: Outlines,
    /// The expressions of the layers: output i is layer i, the last on top.
    pub program: Program,
    /// Ink of each layer.
    pub inks: Vec<u32>,
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

/// No ink.
const PAPER: u32 = u32::MAX;

/// The rows of a picture, pulled from top to bottom.
#[derive(Clone, Debug)]
pub struct Rows {
    picture: Arc<Picture>,
    sweep: Sweep<Side>,
    walk: Walk,
    runs: Vec<Run>,
    cost: Cost,
}

impl Rows {
    /// The rows `rows` of a picture.
    pub fn new(picture: Arc<Picture>, rows: Range<u32>) -> Rows {
        Rows { sweep: Sweep::new(rows), walk: Walk::new(&picture), runs: Vec::new(), cost: Cost::default(), picture }
    }

    /// The next row or rows; `None` behind the last. Rows that follow each other may be equal.
    #[expect(clippy::should_implement_trait, reason = "the rows are lent, not given")]
    pub fn next(&mut self) -> Option<Lines<'_>> {
        let scanline = self.sweep.next(&self.picture.outlines.edges)?;
        if scanline.changed {
            self.cost.counted += 1;
            self.cost.peak_active = self.cost.peak_active.max(self.sweep.list().len() as u64);
            self.cost.toggles += if self.sweep.is_renumbered() {
                self.walk.whole(&self.picture, &self.sweep)
            } else {
                self.walk.changes(&self.picture, &self.sweep, scanline.y)
            };
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

    /// Turns boundaries and columns into runs. A boundary at the left side and one in column 0 coincide, and one in the last column is
    /// behind the page: both leave an empty run, which is dropped.
    fn emit(&mut self) {
        let (columns, boundaries) = (self.sweep.columns(), self.walk.boundaries());
        let column = |boundary: &Boundary| if boundary.edge == LEFT_SIDE { 0 } else { columns[boundary.edge as usize] };
        self.runs.clear();
        for (i, boundary) in boundaries.iter().enumerate() {
            let start = column(boundary);
            let end = boundaries.get(i + 1).map_or(self.picture.width, column);
            if boundary.ink != PAPER && start < end {
                self.runs.push(Run { start, end, ink: boundary.ink });
            }
        }
    }
}
