//! From active edges to runs.
//!
//! The boundaries between inks are kept as indices into the active list (`walk`). As long as no edge enters or leaves and neither the order of the edges nor
//! their ties change, the same boundaries hold on the next scanline and nothing is counted; only their columns are read ("CSG" in ARCHITECTURE.md, section 2.2.3). So
//! the number of scanlines that are counted follows the drawing and not the resolution.
//!
//! Where order is lost from line to line the rows are made without it (`tangle`). That is measured as the sweep goes, on the lines themselves, so that it
//! depends on nothing but the picture and the first line.

mod state;
mod tangle;
mod walk;

use std::ops::Range;
use std::sync::Arc;

use self::state::State;
use self::tangle::Tangle;
use self::walk::Walk;
use crate::count::Program;
use crate::edge::{Outlines, Side};
use crate::run::{Lines, Run};
use crate::sweep::{Loose, Scanline, Sweep};

/// A picture ready to be swept.
#[derive(Clone, Debug)]
pub struct Picture {
    width: u32,
    outlines: Outlines,
    program: Program,
    inks: Vec<u32>,
    counting: Counting,
    /// What holds at the left side of every scanline.
    start: State,
}

impl Picture {
    /// A picture `width` pixels wide. Output i of `program` is the expression of layer i, the last on top, and `inks[i]` its ink; the leaves of the
    /// program are those of `outlines`.
    pub fn new(width: u32, outlines: Outlines, program: Program, inks: Vec<u32>, counting: Counting) -> Picture {
        let start = State::new(&program, &inks);
        Picture { width, outlines, program, inks, counting, start }
    }

    /// The edges that are swept.
    pub fn outlines(&self) -> &Outlines {
        &self.outlines
    }
}

/// How crossings are counted. The rows do not depend on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Counting {
    /// In order, or by columns where order was measured to cost more than it saves.
    #[default]
    Measured,
    /// Always in order.
    Ordered,
    /// By columns wherever the picture has few enough shapes, layers and gates.
    Unordered,
}

/// What a walk has cost so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Scanlines on which was counted.
    pub counted: u64,
    /// Scanlines that repeat the one above without any work.
    pub repeated: u64,
    /// Scanlines counted without order, by columns.
    pub unordered: u64,
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
        self.unordered += other.unordered;
        self.toggles += other.toggles;
        self.known += other.known;
        self.peak_active = self.peak_active.max(other.peak_active);
    }
}

/// Fewer edges are always kept in order.
const FEW: usize = 256;

/// Lines for which order is kept after it was given up in vain.
const PATIENCE: u32 = 64;

/// Lines one behind the other on which order has to cost too much before it is given up.
const DOUBT: u32 = 2;

/// Lines that are counted whole, before it is tried again to count what changed.
const BUSY: u32 = 7;

/// About what an edge in order costs on a line, a crossing where a list changed, and a place by which an edge is moved: in nanoseconds on the machine
/// of docs/performance.md, where [`Tangle::cost`] and [`Walk::crossing`] were measured too.
const STEP: usize = 3;
const CHANGE: usize = 20;
const MOVE: usize = 10;

/// No ink.
const PAPER: u32 = u32::MAX;

/// The rows of a picture, pulled from top to bottom.
#[derive(Clone, Debug)]
pub struct Rows {
    picture: Arc<Picture>,
    sweep: Sweep<Side>,
    walk: Walk,
    /// Made when it is needed, if it can be.
    tangle: Option<Option<Tangle>>,
    /// Whether the sweep keeps no order.
    loose: bool,
    /// Lines until order is given up, counted down from [`DOUBT`] while it costs too much; above that it is not tried.
    patience: u32,
    /// What counting has cost on the last line in order that was counted.
    counting: usize,
    /// So many more lines are counted whole, because so much of one above had changed.
    busy: u32,
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
            patience: DOUBT,
            counting: 0,
            busy: 0,
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
        self.cost.repeated += u64::from(n - 1);
        if changed {
            let renumbered = self.sweep.is_renumbered();
            self.count(renumbered);
        }
        self.emit();
        if changed && self.is_tangled() {
            self.sweep.loosen();
            self.loose = true;
        }
        Some((y, n))
    }

    /// A row without order, or if it may not differ from the one above the first in order again.
    fn next_loose(&mut self) -> Option<(u32, u32)> {
        let Loose { y, active, changed } = self.sweep.next_loose(&self.picture.outlines.edges, self.picture.width)?;
        let (positions, sides) = (self.sweep.positions(), self.sweep.tags());
        // With fewer edges even counting all of them in order is no dearer.
        let pays = |tangle: &Tangle| tangle.cost(active) <= (STEP + MOVE + self.walk.crossing()) * active;
        let go_on = |tangle: &&mut Tangle| self.picture.counting == Counting::Unordered || (changed && pays(tangle));
        if let Some(tangle) = self.tangle.as_mut().and_then(Option::as_mut).filter(go_on) {
            tangle.runs(&self.picture, positions, sides, &mut self.runs);
            self.cost.counted += 1;
            self.cost.unordered += 1;
            self.cost.toggles += active as u64;
            self.cost.peak_active = self.cost.peak_active.max(active as u64);
        } else {
            self.sweep.tighten();
            self.loose = false;
            self.patience = PATIENCE;
            self.count(true);
            self.emit();
        }
        Some((y, 1))
    }

    /// Whether to give up order: where it costs more than it saves on this line, and did on the one above.
    fn is_tangled(&mut self) -> bool {
        let (edges, moved) = (self.sweep.list().len(), self.sweep.moved());
        let always = self.picture.counting == Counting::Unordered;
        self.patience = match self.patience {
            _ if always => 0,
            wait if wait > DOUBT => wait - 1,
            // As long as little is out of order there is nothing to be saved.
            _ if edges < FEW || moved * 8 < edges || self.picture.counting == Counting::Ordered => DOUBT,
            doubt => {
                let ordered = STEP * edges + self.counting + MOVE * moved;
                let tangle = self.tangle.get_or_insert_with(|| Tangle::new(&self.picture));
                if tangle.as_ref().is_some_and(|tangle| tangle.cost(edges) * 5 < ordered * 4) { doubt - 1 } else { DOUBT }
            }
        };
        self.patience == 0 && self.tangle.get_or_insert_with(|| Tangle::new(&self.picture)).is_some()
    }

    fn count(&mut self, whole: bool) {
        let edges = self.sweep.list().len();
        let all = self.walk.crossing() * edges;
        let toggles = if whole || self.busy > 0 {
            self.busy = self.busy.saturating_sub(1);
            self.counting = all;
            self.walk.whole(&self.picture, &self.sweep, self.busy == 0)
        } else {
            let toggles = self.walk.changes(&self.picture, &self.sweep);
            self.counting = CHANGE * toggles;
            if self.counting > all {
                self.busy = BUSY;
            }
            toggles
        };
        self.cost.counted += 1;
        self.cost.toggles += toggles as u64;
        self.cost.known += (edges - toggles) as u64;
        self.cost.peak_active = self.cost.peak_active.max(edges as u64);
    }

    /// The runs of the row that was given last.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// About how many edges were stepped to the row that was given last.
    pub fn stepped(&self) -> usize {
        self.sweep.tags().len()
    }

    /// What the rows have cost so far.
    pub fn cost(&self) -> &Cost {
        &self.cost
    }

    /// Turns boundaries and columns into runs. A boundary in column 0 is at the left side, and one in the last column is
    /// behind the page: both leave an empty run, which is dropped.
    fn emit(&mut self) {
        let columns = self.sweep.columns();
        let (left, boundaries) = self.walk.boundaries();
        self.runs.clear();
        let (mut start, mut ink) = (0, left);
        for boundary in boundaries {
            let end = columns[boundary.edge as usize];
            if ink != PAPER && start < end {
                self.runs.push(Run { start, end, ink });
            }
            (start, ink) = (end, boundary.ink);
        }
        if ink != PAPER && start < self.picture.width {
            self.runs.push(Run { start, end: self.picture.width, ink });
        }
    }
}
