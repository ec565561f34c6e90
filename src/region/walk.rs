//! The walk along the active list that counts shapes in and out, and finds where the visible ink changes.
//!
//! Edges in one column, a group, are counted together, then the topmost layer that holds is looked up; where its ink changes, a run ends or begins
//! ("CSG" in ARCHITECTURE.md, section 2.2.3, step 3, and 3.2 for layers: the paper's list of active polygons by priority is a bit set of layers here).
//!
//! ```text
//!   columns    2     5     5     9            the walk of  a - b
//!   edges      a+    a-    b+    b-
//!   ink     .  |  #  |     .     |  .         boundaries: edge 0 -> ink 0, edge 1 -> paper
//! ```
//!
//! Where something changes on every scanline, most of the list is as it was all the same. The new list is compared with the one that was counted last; a
//! stretch that is equal has the boundaries that it had, as long as it begins with the same windings:
//!
//! ```text
//!   last     a1  b1  c1  c2  b2  d1  d2  a2
//!   now      a1  b1  b2  e1  e2  d1  d2  a2            c ended, e entered
//!           |same   |counted       |same   |
//! ```
//!
//! Counting begins at the first group that differs, and ends where the windings passed in one list and in the other are the same again, shape by shape. That is the
//! paper's skipped counting (2.2.3), for parts of a scanline. Behind a stretch that is skipped each shape has the winding that it had behind its last edge
//! there, so a few edges are looked at, from the stretch's end, where shapes are few.

use crate::bits::BitSet;
use crate::count::Counters;
use crate::edge::Side;
use crate::sweep::{Entry, Sweep};

use super::{PAPER, Picture};

/// A place where the visible ink changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Boundary {
    /// Index into the active list of the first of the edges in its column; [`LEFT_SIDE`] for what holds before any.
    pub(super) edge: u32,
    /// The ink from there on, or [`PAPER`].
    pub(super) ink: u32,
}

pub(super) const LEFT_SIDE: u32 = u32::MAX;

/// What is known of the line that was counted last.
#[derive(Clone, Debug)]
pub(super) struct Walk {
    counters: Counters,
    layers: BitSet,
    list: Vec<Entry>,
    boundaries: Vec<Boundary>,
    /// The boundaries before the last count.
    before: Vec<Boundary>,
    difference: Difference,
    windings: Windings,
}

impl Walk {
    pub(super) fn new(picture: &Picture) -> Walk {
        let counters = Counters::new(&picture.program);
        let mut layers = BitSet::new(picture.inks.len());
        (0..picture.inks.len()).filter(|&i| counters.output(&picture.program, i)).for_each(|i| layers.insert(i));
        let difference = Difference { windings: vec![0; picture.program.nodes()], unequal: 0 };
        let windings = Windings { behind: Vec::new(), seen: vec![0; picture.program.nodes()], stretch: 0 };
        Walk { counters, layers, list: Vec::new(), boundaries: Vec::new(), before: Vec::new(), difference, windings }
    }

    /// Where the visible ink changes on the line that was counted last.
    pub(super) fn boundaries(&self) -> &[Boundary] {
        &self.boundaries
    }

    /// Counts the whole list. Gives the number of crossings counted.
    pub(super) fn whole(&mut self, picture: &Picture, sweep: &Sweep<Side>) -> u64 {
        let new = sweep.list();
        self.boundaries.clear();
        self.windings.behind.resize(sweep.tags().len(), 0);
        let mut line =
            Line::new(picture, sweep.tags(), new, &mut self.counters, &mut self.layers, &mut self.boundaries, &mut self.windings);
        let mut i = 0;
        while i < new.len() {
            i = line.group(i);
        }
        self.finish(picture, sweep);
        new.len() as u64
    }

    /// Counts what differs from the line that was counted last, the one above `y` with the edges that have entered and left since. Gives the number of crossings counted.
    pub(super) fn changes(&mut self, picture: &Picture, sweep: &Sweep<Side>, y: u32) -> u64 {
        let (new, old, sides) = (sweep.list(), &self.list, sweep.tags());
        let tied = |list: &[Entry], i: usize| list.get(i).is_some_and(|entry| entry.is_tied());
        std::mem::swap(&mut self.boundaries, &mut self.before);
        self.boundaries.clear();
        self.windings.behind.resize(sides.len(), 0);
        let mut line = Line::new(picture, sides, new, &mut self.counters, &mut self.layers, &mut self.boundaries, &mut self.windings);
        let difference = &mut self.difference;
        let mut counted = 0;
        // The boundary at the left side stands already.
        let mut kept = 1;
        let (mut i, mut j) = (0, 0);
        loop {
            // What is equal, up to the group that what differs belongs to.
            let mut same = equal(&new[i..], &old[j..]);
            if same > 0 && (tied(new, i + same) || tied(old, j + same)) {
                same -= 1;
                while new[i + same].is_tied() {
                    same -= 1;
                }
            }
            while self.before.get(kept).is_some_and(|boundary| (boundary.edge as usize) < j) {
                kept += 1;
            }
            let known = self.before[kept..].iter().take_while(|boundary| (boundary.edge as usize) < j + same).count();
            line.keep(&self.before[kept..kept + known], i as isize - j as isize);
            kept += known;
            line.skip(i..i + same);
            (i, j) = (i + same, j + same);
            if i == new.len() && j == old.len() {
                break;
            }
            // What differs, until the windings are the same again.
            let start = i;
            loop {
                let end = if i < new.len() { line.group(i) } else { i };
                for entry in &new[i..end] {
                    difference.add(sides[entry.slot()], 1);
                    if sweep.has_entered(entry.slot(), y) {
                        continue;
                    }
                    while old.get(j).is_some_and(|entry| sweep.has_ended(entry.slot())) {
                        difference.add(sides[old[j].slot()], -1);
                        j += 1;
                    }
                    if let Some(entry) = old.get(j) {
                        difference.add(sides[entry.slot()], -1);
                        j += 1;
                    }
                }
                i = end;
                while j < old.len() && (i == new.len() || sweep.has_ended(old[j].slot())) {
                    difference.add(sides[old[j].slot()], -1);
                    j += 1;
                }
                if i == new.len() || (difference.unequal == 0 && j < old.len() && new[i] == old[j]) {
                    break;
                }
            }
            counted += i - start;
            if i == new.len() {
                difference.clear(sides, new, old);
                break;
            }
        }
        self.finish(picture, sweep);
        counted as u64
    }

    /// Takes the counters back to the left side, and keeps the list.
    fn finish(&mut self, picture: &Picture, sweep: &Sweep<Side>) {
        let layers = &mut self.layers;
        if picture.outlines.open {
            sweep.list().iter().for_each(|entry| self.counters.set(sweep.tags()[entry.slot()].leaf, 0));
        }
        self.counters.settle(&picture.program, |layer, holds| layers.set(layer as usize, holds));
        self.list.clear();
        self.list.extend_from_slice(sweep.list());
    }
}

/// A line that is being counted.
struct Line<'a> {
    picture: &'a Picture,
    sides: &'a [Side],
    list: &'a [Entry],
    counters: &'a mut Counters,
    layers: &'a mut BitSet,
    boundaries: &'a mut Vec<Boundary>,
    windings: &'a mut Windings,
    /// What is visible here.
    ink: u32,
}

impl<'a> Line<'a> {
    /// A line at its left side, where the counters are at rest.
    fn new(
        picture: &'a Picture,
        sides: &'a [Side],
        list: &'a [Entry],
        counters: &'a mut Counters,
        layers: &'a mut BitSet,
        boundaries: &'a mut Vec<Boundary>,
        windings: &'a mut Windings,
    ) -> Line<'a> {
        let ink = visible(picture, layers);
        boundaries.push(Boundary { edge: LEFT_SIDE, ink });
        Line { picture, sides, list, counters, layers, boundaries, windings, ink }
    }

    fn boundary(&mut self, edge: usize, ink: u32) {
        self.ink = ink;
        self.boundaries.push(Boundary { edge: edge as u32, ink });
    }

    /// Takes over boundaries whose edges stand further on in the list, or further back.
    fn keep(&mut self, boundaries: &[Boundary], shift: isize) {
        let moved = |boundary: &Boundary| Boundary { edge: boundary.edge.wrapping_add(shift as u32), ..*boundary };
        self.boundaries.extend(boundaries.iter().map(moved));
        if let Some(last) = boundaries.last() {
            self.ink = last.ink;
        }
    }

    /// Goes to the end of a stretch whose boundaries are known.
    fn skip(&mut self, edges: std::ops::Range<usize>) {
        let Windings { behind, seen, stretch } = &mut *self.windings;
        *stretch += 1;
        let mut unseen = self.picture.outlines.leaves;
        for entry in self.list[edges].iter().rev() {
            let leaf = self.sides[entry.slot()].leaf;
            if std::mem::replace(&mut seen[leaf as usize], *stretch) != *stretch {
                self.counters.set(leaf, behind[entry.slot()]);
                unseen -= 1;
                if unseen == 0 {
                    break;
                }
            }
        }
        let layers = &mut *self.layers;
        self.counters.settle(&self.picture.program, |layer, holds| layers.set(layer as usize, holds));
        debug_assert_eq!(self.ink, visible(self.picture, self.layers), "the boundaries that were known are right");
    }

    /// Counts the group that begins at an index, and gives the index behind it.
    #[inline]
    fn group(&mut self, edge: usize) -> usize {
        let (layers, program) = (&mut *self.layers, &self.picture.program);
        let mut flipped = false;
        let flip = |layer: u32, holds| {
            layers.set(layer as usize, holds);
            flipped = true;
        };
        let slot = self.list[edge].slot();
        let side = self.sides[slot];
        let mut next = edge + 1;
        if self.list.get(next).is_some_and(|entry| entry.is_tied()) {
            self.windings.behind[slot] = self.counters.add(side.leaf, side.winding);
            while let Some(entry) = self.list.get(next).filter(|entry| entry.is_tied()) {
                let side = self.sides[entry.slot()];
                self.windings.behind[entry.slot()] = self.counters.add(side.leaf, side.winding);
                next += 1;
            }
            self.counters.settle(program, flip);
        } else {
            self.windings.behind[slot] = self.counters.cross(program, side.leaf, side.winding, flip);
        }
        if flipped {
            let ink = visible(self.picture, self.layers);
            if ink != self.ink {
                self.boundary(edge, ink);
            }
        }
        next
    }
}

fn visible(picture: &Picture, layers: &BitSet) -> u32 {
    layers.last().map_or(PAPER, |layer| picture.inks[layer])
}

/// How long two lists are equal.
fn equal(a: &[Entry], b: &[Entry]) -> usize {
    const BLOCK: usize = 16;
    let blocks = a.chunks_exact(BLOCK).zip(b.chunks_exact(BLOCK)).take_while(|(a, b)| a == b).count();
    let start = blocks * BLOCK;
    start + a[start..].iter().zip(&b[start..]).take_while(|(a, b)| a == b).count()
}

/// Windings of the shapes along the line that was counted last.
#[derive(Clone, Debug)]
struct Windings {
    /// By slot: the winding of its own shape behind an edge.
    behind: Vec<i32>,
    /// By leaf: the number of the last stretch in which it was seen.
    seen: Vec<u64>,
    stretch: u64,
}

/// By leaf: windings passed in one list less those passed in the other.
#[derive(Clone, Debug)]
struct Difference {
    windings: Vec<i32>,
    /// How many are not 0.
    unequal: usize,
}

impl Difference {
    #[inline]
    fn add(&mut self, side: Side, sign: i32) {
        let winding = &mut self.windings[side.leaf as usize];
        self.unequal -= usize::from(*winding != 0);
        *winding += sign * side.winding;
        self.unequal += usize::from(*winding != 0);
    }

    /// All 0 again, after lists that do not come back to 0 at their ends.
    fn clear(&mut self, sides: &[Side], new: &[Entry], old: &[Entry]) {
        if self.unequal > 0 {
            new.iter().chain(old).for_each(|entry| self.windings[sides[entry.slot()].leaf as usize] = 0);
            self.unequal = 0;
        }
    }
}
