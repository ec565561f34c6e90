//! What is seen on scanlines that are alike ("CSG" in ARCHITECTURE.md, section 3.4.2, b1 to b4).
//!
//! Between two edges that are neighbours on a scanline is a *cell*. It goes on below for as long as they are neighbours and the same faces are active in it. The depths of
//! faces are linear over the page, so if two of them do not change their order at the corners of what is between the edges down to some scanline, they do not change it
//! inside; and if none of those do on which it depends what is seen, that is seen in all of the cell:
//!
//! ```text
//!              L      R
//!       y      *------*        looked at once: the order of faces at the four corners
//!             /        \
//!            /  cell    \
//!           /            \
//!   until  *--------------*
//! ```
//!
//! The paper's conditions are of whole scanlines: no edge enters or leaves, none changes places. Here they are of cells, so that what happens elsewhere on the scanline
//! does not matter: edges that entered or left, or were passed in another order, left of a cell do not count once the faces that they changed have been changed back.

use std::ops::Range;

use super::stage::Crossing;
use crate::sweep::{Entry, Scanline, Sweep};

/// No edge.
const NONE: u32 = u32::MAX;

/// A face, and whether it is seen from inside of its part.
pub(super) type Seen = Option<(u32, bool)>;

/// A cell: what is right of an edge, up to the next.
#[derive(Clone, Copy, Debug)]
struct Cell {
    /// Slot of the edge.
    left: u32,
    /// Slot of the next, or [`NONE`].
    right: u32,
    /// What is known of it.
    known: Known,
}

/// What is known of a cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Known {
    /// What is seen in all of it.
    pub(super) seen: Seen,
    /// Behind the last scanline of which this is known.
    pub(super) until: u32,
    /// The scanline from which on it is worth a look down to where the cell ends.
    pub(super) again: u32,
}

/// Neighbouring cells that show the same.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    /// The entry at its left, and that at its right; behind the last the page's side.
    from: usize,
    to: usize,
    shows: (u32, bool),
}

/// The cells of a scanline and of the one above.
#[derive(Debug)]
pub(super) struct Cells {
    /// By entry of the sweep's list. That of the last of several entries in one column is the cell.
    cells: Vec<Cell>,
    /// Those of the scanline above, while entries of another list are looked up there.
    above: Vec<Cell>,
    /// For every slot its entry in the list above.
    places: Vec<u32>,
    /// How many entries of the list above are passed, or lie left of one that is; how many of them are gone.
    covered: usize,
    gone: usize,
    /// How many entries that were there were passed.
    passed: usize,
    /// By how much the turns of faces differ from what they were, of how many, and which ones may.
    turns: Vec<i32>,
    differing: usize,
    touched: Vec<u32>,
    /// Whether the list is another than that of the scanline above.
    changed: bool,
    /// Whether nothing is known of that.
    stale: bool,
    /// The scanline behind the last on which all cells are known.
    until: u32,
    stretches: Vec<Stretch>,
}

impl Cells {
    pub(super) fn new(faces: usize) -> Cells {
        Cells {
            cells: Vec::new(),
            above: Vec::new(),
            places: Vec::new(),
            covered: 0,
            gone: 0,
            passed: 0,
            turns: vec![0; faces],
            differing: 0,
            touched: Vec::new(),
            changed: true,
            stale: false,
            until: 0,
            stretches: Vec::new(),
        }
    }

    /// What a scanline shows if all of it is known from the one above: columns, and what is seen there.
    pub(super) fn all(
        &self,
        scanline: &Scanline,
        columns: &[u32],
        width: u32,
    ) -> Option<impl ExactSizeIterator<Item = (u32, u32, (u32, bool))>> {
        let column = move |i: usize| columns.get(i).map_or(width, |&column| column.min(width));
        let known = !scanline.changed && scanline.y < self.until;
        known.then(|| self.stretches.iter().map(move |&Stretch { from, to, shows }| (column(from), column(to), shows)))
    }

    /// Forgets what is known, before scanlines that are not noted.
    pub(super) fn forget(&mut self) {
        self.cells.clear();
        (self.until, self.stale) = (0, true);
    }

    /// Begins a scanline.
    pub(super) fn start(&mut self, scanline: &Scanline, sweep: &Sweep<Crossing>) {
        self.until = u32::MAX;
        self.stretches.clear();
        self.changed = scanline.changed || std::mem::take(&mut self.stale);
        if !self.changed {
            return;
        }
        (self.covered, self.gone, self.passed, self.differing) = (0, 0, 0, 0);
        self.touched.drain(..).for_each(|face| self.turns[face as usize] = 0);
        std::mem::swap(&mut self.cells, &mut self.above);
        if sweep.is_renumbered() {
            self.above.clear();
        }
        self.places.resize(sweep.tags().len(), 0);
        self.above.iter().zip(0..).for_each(|(cell, place)| self.places[cell.left as usize] = place);
        self.cells.clear();
        let cell = |entry: &Entry| Cell { left: entry.slot() as u32, right: NONE, known: Known::default() };
        self.cells.extend(sweep.list().iter().map(cell));
    }

    /// Passes an entry of the list.
    #[inline]
    pub(super) fn pass(&mut self, entry: Entry, sweep: &Sweep<Crossing>) {
        if !self.changed || self.above.is_empty() {
            return;
        }
        if entry.has_entered() {
            self.differ(sweep.tags()[entry.slot()], 1);
            return;
        }
        self.passed += 1;
        let place = self.places[entry.slot()] as usize;
        while self.covered <= place {
            let slot = self.above[self.covered].left as usize;
            if sweep.has_ended(slot) {
                self.differ(sweep.tags()[slot], -1);
                self.gone += 1;
            }
            self.covered += 1;
        }
    }

    fn differ(&mut self, edge: Crossing, sign: i32) {
        for (face, turns) in [(edge.left, sign * edge.turns), (edge.right, -sign * edge.turns)] {
            if let Some(all) = self.turns.get_mut(face as usize) {
                self.differing += usize::from(*all == 0);
                *all += turns;
                self.differing -= usize::from(*all == 0);
                self.touched.push(face);
            }
        }
    }

    /// Notes that more than the cells that are noted is known up to a scanline only.
    pub(super) fn bound(&mut self, until: u32) {
        self.until = self.until.min(until);
    }

    /// What the scanline above knows of the cell behind the entries of a group, which share a column and were just passed.
    #[inline]
    pub(super) fn known(&self, group: &Range<usize>) -> Option<Known> {
        let right = self.cells.get(group.end).map_or(NONE, |cell| cell.left);
        let mut cell = &self.cells[group.end - 1];
        if self.changed {
            let place = self.places[cell.left as usize] as usize;
            let same = self.covered == place + 1 && self.passed + self.gone == self.covered && self.differing == 0;
            cell = self.above.get(place).filter(|above| same && above.left == cell.left)?;
        }
        (cell.right == right).then_some(cell.known)
    }

    /// Notes what is known of the cell behind a group of entries.
    #[inline]
    pub(super) fn note(&mut self, group: &Range<usize>, known: Known) {
        self.bound(known.until);
        let right = self.cells.get(group.end).map_or(NONE, |cell| cell.left);
        let cell = &mut self.cells[group.end - 1];
        *cell = Cell { left: cell.left, right, known };
        let Some(shows) = known.seen else { return };
        match self.stretches.last_mut() {
            Some(last) if last.to == group.start && last.shows == shows => last.to = group.end,
            _ => self.stretches.push(Stretch { from: group.start, to: group.end, shows }),
        }
    }
}
