//! From active edges to runs.
//!
//! The boundaries between inks are kept as indices into the active list ([`walk`]). As long as no edge enters or leaves and neither the order of the edges nor
//! their ties change, the same boundaries hold on the next scanline and nothing is counted; only their columns are read ("CSG" in ARCHITECTURE.md, section 2.2.3). So
//! the number of scanlines that are counted follows the drawing and not the resolution.
//!
//! Where order is lost from line to line the rows are made without it ([`tangle`]). That is measured as the sweep goes, on the lines themselves, so that it
//! depends on nothing but the picture and the first line.

mod tangle;
mod walk;

use std::ops::Range;
use std::sync::Arc;

use self::tangle::Tangle;
use self::walk::{Boundary, LEFT_SIDE, Walk};
use crate::count::Program;
use crate::edge::{Outlines, Side};
use crate::run::{Lines, Run};
use crate::sweep::{Loose, Scanline, Sweep};

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
    /// Scanlines counted without order, by columns.
    pub tangled: u64,
    /// Crossings counted.
    pub toggles: u64,
    /// Crossings on counted scanlines whose part of the line was known from the scanline above.
    pub known: u64,
    /// Largest number of active edges.
    pub peak_active: u64,
}

impl Cost {
    /// Adds what another walk has cost.
    pub fn add(&mut self, other: &Cost) {
        self.counted += other.counted;
        self.repeated += other.repeated;
        self.tangled += other.tangled;
        self.toggles += other.toggles;
        self.known += other.known;
        self.peak_active = self.peak_active.max(other.peak_active);
    }
}

/// Fewer edges are always kept in order.
const FEW: usize = 256;

/// Lines for which order is kept after it was given up in vain.
const PATIENCE: u32 = 64;

/// No ink.
const PAPER: u32 = u32::MAX;

/// The rows of a picture, pulled from top to bottom.
#[derive(Clone, Debug)]
pub struct Rows {
    picture: Arc<Picture>,
    sweep: Sweep<Side>,
    walk: Walk,
    /// Made when it is needed.
    tangle: Option<Tangle>,
    /// Whether the sweep keeps no order.
    loose: bool,
    /// With so many edges giving up order may pay.
    many: usize,
    /// Lines until order is given up, counted down from 2 while it is lost; more while that is not tried.
    patience: u32,
    runs: Vec<Run>,
    cost: Cost,
}

impl Rows {
    /// The rows `rows` of a picture.
    pub fn new(picture: Arc<Picture>, rows: Range<u32>) -> Rows {
        Rows {
            sweep: Sweep::new(rows),
            walk: Walk::new(&picture),
            tangle: None,
            loose: false,
            many: FEW.max(picture.width as usize / 16),
            patience: 2,
            runs: Vec::new(),
            cost: Cost::default(),
            picture,
        }
    }

    /// The next row or rows; `None` behind the last. Rows that follow each other may be equal.
    #[expect(clippy::should_implement_trait, reason = "the rows are lent, not given")]
    pub fn next(&mut self) -> Option<Lines<'_>> {
        let (y, n) = if self.loose { self.next_loose()? } else { self.next_ordered()? };
        Some(Lines { y, n, runs: &self.runs })
    }

    fn next_ordered(&mut self) -> Option<(u32, u32)> {
        let Scanline { y, n, changed } = self.sweep.next(&self.picture.outlines.edges)?;
        if changed {
            let renumbered = self.sweep.is_renumbered();
            self.count(renumbered, y);
        }
        self.cost.repeated += u64::from(n - 1);
        self.emit();
        if self.tangled() {
            self.sweep.loosen();
            self.loose = true;
        }
        Some((y, n))
    }

    /// A row without order, or if it may not differ from the one above the first in order again.
    fn next_loose(&mut self) -> Option<(u32, u32)> {
        let Loose { y, changed } = self.sweep.next_loose(&self.picture.outlines.edges)?;
        let (positions, sides) = (self.sweep.positions(), self.sweep.tags());
        if let Some(tangle) = self.tangle.as_mut().filter(|_| changed && positions.len() >= self.many / 2) {
            tangle.runs(&self.picture, positions, sides, &mut self.runs);
            self.cost.counted += 1;
            self.cost.tangled += 1;
            self.cost.toggles += positions.len() as u64;
            self.cost.peak_active = self.cost.peak_active.max(positions.len() as u64);
        } else {
            self.sweep.tighten();
            self.loose = false;
            self.patience = PATIENCE;
            self.count(true, y);
            self.emit();
        }
        Some((y, 1))
    }

    /// Whether order is lost from line to line: most edges were moved on this one, and on the one above.
    fn tangled(&mut self) -> bool {
        let (edges, moved) = (self.sweep.list().len(), self.sweep.moved());
        self.patience = if self.patience > 2 {
            self.patience - 1
        } else if moved * 2 > edges && edges >= self.many {
            self.patience.saturating_sub(1)
        } else {
            2
        };
        if self.patience > 0 {
            return false;
        }
        if self.tangle.is_none() {
            self.tangle = Tangle::new(&self.picture);
        }
        self.patience = PATIENCE;
        self.tangle.is_some()
    }

    fn count(&mut self, whole: bool, y: u32) {
        let edges = self.sweep.list().len() as u64;
        let toggles = if whole { self.walk.whole(&self.picture, &self.sweep) } else { self.walk.changes(&self.picture, &self.sweep, y) };
        self.cost.counted += 1;
        self.cost.toggles += toggles;
        self.cost.known += edges - toggles;
        self.cost.peak_active = self.cost.peak_active.max(edges);
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
