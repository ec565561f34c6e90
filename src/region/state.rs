//! What holds at a place of a scanline: windings of the shapes, and the ink that is visible there.
//!
//! With few shapes all that can hold at once is written out beforehand: a bit for each shape that is inside, and by these bits the ink. A crossing is
//! then a sum, a bit and a look-up. With more shapes the counters of [`crate::count`] carry on what changes, and a bit set of layers knows the topmost.

use crate::bits::BitSet;
use crate::count::{Counters, Program, Rule};
use crate::edge::Side;
use crate::sweep::Entry;

use super::{PAPER, Picture};

/// Most leaves for which all that can hold is written out.
const FEW: usize = 8;

/// The state at a place of a scanline.
#[derive(Clone, Debug)]
pub(super) enum State {
    Table(Table),
    Program(Counted),
}

/// All that can hold, written out.
#[derive(Clone, Debug)]
pub(super) struct Table {
    /// By leaf.
    counts: [i32; FEW],
    /// By leaf: the bits of its count of which one is set where it holds.
    masks: [i32; FEW],
    /// The leaves that hold, here and at the left side.
    inside: usize,
    outside: usize,
    /// By the leaves that hold.
    inks: Vec<u32>,
    leaves: usize,
    /// By slot, and by leaf: `counts` behind the group that the edge is the last of.
    behind: Vec<i32>,
}

/// Counters, and the layers that hold.
#[derive(Clone, Debug)]
pub(super) struct Counted {
    counters: Counters,
    layers: BitSet,
    /// By slot: the winding of its own shape behind an edge.
    behind: Vec<i32>,
    /// By leaf: the number of the last stretch in which it was seen.
    seen: Vec<u64>,
    stretch: u64,
}

impl State {
    /// The state at the left side of a scanline.
    pub(super) fn new(program: &Program, inks: &[u32]) -> State {
        let counters = Counters::new(program);
        let mut layers = BitSet::new(inks.len());
        (0..inks.len()).filter(|&i| counters.output(program, i)).for_each(|i| layers.insert(i));
        let counted = Counted { counters, layers, behind: Vec::new(), seen: vec![0; program.leaves()], stretch: 0 };
        if program.leaves() <= FEW { State::Table(Table::new(program, inks, counted)) } else { State::Program(counted) }
    }

    /// The visible ink, once everything is settled.
    pub(super) fn ink(&self, inks: &[u32]) -> u32 {
        match self {
            State::Table(table) => table.inks[table.inside],
            State::Program(counted) => counted.ink(inks),
        }
    }

    /// Makes room for what is known of so many slots.
    pub(super) fn resize(&mut self, slots: usize) {
        match self {
            State::Table(table) => table.behind.resize(slots * table.leaves, 0),
            State::Program(counted) => counted.behind.resize(slots, 0),
        }
    }

    /// Goes to the end of a stretch that begins with the same windings as on the scanline above.
    #[inline]
    pub(super) fn skip(&mut self, picture: &Picture, sides: &[Side], stretch: &[Entry]) {
        match self {
            State::Table(table) => {
                if let Some(last) = stretch.last() {
                    for leaf in 0..table.leaves {
                        let winding = table.behind[last.slot() * table.leaves + leaf] - table.counts[leaf];
                        // A leaf that holds everywhere has no edges, and no count that says so.
                        if winding != 0 {
                            table.add(Side { leaf: leaf as u32, winding });
                        }
                    }
                }
            }
            State::Program(counted) => counted.skip(picture, sides, stretch),
        }
    }

    /// Goes back to the left side from where not all windings are 0: those of the edges passed are taken back. To be settled.
    pub(super) fn rewind(&mut self, sides: &[Side], list: &[Entry]) {
        match self {
            State::Table(table) => (table.counts, table.inside) = ([0; FEW], table.outside),
            State::Program(counted) => list.iter().for_each(|entry| counted.counters.set(sides[entry.slot()].leaf, 0)),
        }
    }

    /// Brings everything up to date with what was set.
    pub(super) fn settle(&mut self, program: &Program) {
        if let State::Program(Counted { counters, layers, .. }) = self {
            counters.settle(program, |layer, holds| layers.set(layer as usize, holds));
        }
    }

    /// Crosses the edges of the group that begins at `edge`, and if it is to be `known` puts down by slot what the windings are behind them. Gives
    /// the index behind the group, and the ink there.
    #[inline(always)]
    pub(super) fn group(&mut self, picture: &Picture, sides: &[Side], list: &[Entry], edge: usize, known: bool) -> (usize, u32) {
        let tied = |edge: usize| list.get(edge).is_some_and(|entry| entry.is_tied());
        let mut slot = list[edge].slot();
        let mut next = edge + 1;
        match self {
            State::Table(table) => {
                table.add(sides[slot]);
                while tied(next) {
                    slot = list[next].slot();
                    table.add(sides[slot]);
                    next += 1;
                }
                if known {
                    let behind = &mut table.behind[slot * table.leaves..][..table.leaves];
                    behind.iter_mut().zip(&table.counts).for_each(|(behind, count)| *behind = *count);
                }
                (next, table.inks[table.inside])
            }
            State::Program(Counted { counters, layers, behind, .. }) => {
                let Side { leaf, winding } = sides[slot];
                let flip = |layer: u32, holds| layers.set(layer as usize, holds);
                if tied(next) {
                    behind[slot] = counters.add(leaf, winding);
                    while tied(next) {
                        let slot = list[next].slot();
                        behind[slot] = counters.add(sides[slot].leaf, sides[slot].winding);
                        next += 1;
                    }
                    counters.settle(&picture.program, flip);
                } else {
                    behind[slot] = counters.cross(&picture.program, leaf, winding, flip);
                }
                (next, layers.last().map_or(PAPER, |layer| picture.inks[layer]))
            }
        }
    }
}

impl Counted {
    fn ink(&self, inks: &[u32]) -> u32 {
        self.layers.last().map_or(PAPER, |layer| inks[layer])
    }

    /// Behind a stretch each shape has the winding that it had behind its last edge there: looked for from the end.
    fn skip(&mut self, picture: &Picture, sides: &[Side], stretch: &[Entry]) {
        self.stretch += 1;
        let mut unseen = picture.outlines.leaves;
        for entry in stretch.iter().rev() {
            let leaf = sides[entry.slot()].leaf;
            if std::mem::replace(&mut self.seen[leaf as usize], self.stretch) != self.stretch {
                self.counters.set(leaf, self.behind[entry.slot()]);
                unseen -= 1;
                if unseen == 0 {
                    break;
                }
            }
        }
        self.counters.settle(&picture.program, |layer, holds| self.layers.set(layer as usize, holds));
    }
}

impl Table {
    /// Writes out what `counted`, which is at rest, makes of every set of leaves.
    fn new(program: &Program, inks: &[u32], mut counted: Counted) -> Table {
        let leaves = program.leaves();
        let rule = |leaf: usize| program.rule(leaf as u32);
        // A count that makes a leaf hold, and one that does not; leaves that hold everywhere have no edges.
        let count = |leaf: usize, holds: bool| if let Rule::AtLeast(k) = rule(leaf) { k - i32::from(!holds) } else { i32::from(holds) };
        let mut table = Table { counts: [0; FEW], masks: [0; FEW], inside: 0, outside: 0, inks: Vec::new(), leaves, behind: Vec::new() };
        for leaf in 0..leaves {
            table.masks[leaf] = if rule(leaf) == Rule::Odd { 1 } else { -1 };
            table.inside |= usize::from(rule(leaf).holds(0)) << leaf;
        }
        table.outside = table.inside;
        for inside in 0..1 << leaves {
            let Counted { counters, layers, .. } = &mut counted;
            (0..leaves).for_each(|leaf| counters.set(leaf as u32, count(leaf, inside >> leaf & 1 == 1)));
            counters.settle(program, |layer, holds| layers.set(layer as usize, holds));
            table.inks.push(counted.ink(inks));
        }
        table
    }

    #[inline]
    fn add(&mut self, side: Side) {
        let leaf = side.leaf as usize % FEW;
        let count = self.counts[leaf] + side.winding;
        self.counts[leaf] = count;
        self.inside = self.inside & !(1 << leaf) | usize::from(count & self.masks[leaf] != 0) << leaf;
    }
}
