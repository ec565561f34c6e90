//! The active list: which edges a scanline meets, in the order of their columns ("CSG" in ARCHITECTURE.md, section 2.1.2).
//!
//! What is stepped stands apart from what is ordered. An active chain has a *slot* for as long as it is active; the list holds slots in order of
//! columns, each with a mark where it shares its column with the one before:
//!
//! ```text
//!   slot      0    1    2    3                list       2    0 ~ 3    1        ~ tied
//!   at      5.3  8.1  2.7  5.9                columns    2    5   5    8
//!   step    0.5   0  -1.0  0.1
//! ```
//!
//! Stepping goes along the slots and moves nothing else; an edge that takes the place of another changes its slot; only crossings and chains
//! that enter or leave touch the list.
//!
//! Cost of a scanline: an addition, a look-up and two comparisons for every active edge; a scanline on which all of them are vertical costs
//! nothing until one enters or leaves.

use std::ops::Range;

use super::{Edge, Edges};
use crate::line;

/// What a sweep has come to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scanline {
    /// The scanline.
    pub y: u32,
    /// It and the `n - 1` below have the same edges in the same columns.
    pub n: u32,
    /// Whether edges entered or left since the scanline before, or their order, or which of them share a column. True on the first.
    pub changed: bool,
}

/// An entry of the active list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry(u32);

/// Set where an entry is in the column of the one before.
const TIED: u32 = 1 << 31;

impl Entry {
    /// The slot of the edge: the same for as long as its chain is active.
    #[inline]
    pub fn slot(self) -> usize {
        (self.0 & !TIED) as usize
    }

    /// Whether it is in the column of the entry before.
    #[inline]
    pub fn is_tied(self) -> bool {
        self.0 & TIED != 0
    }
}

/// What is rarely looked at of an active chain.
#[derive(Clone, Copy, Debug)]
struct Active {
    /// Index of its edge, and behind the last of its chain.
    edge: u32,
    end: u32,
    /// The scanline on which it entered the list.
    since: u32,
    /// Whether it has ended.
    ended: bool,
}

/// A sweep over a range of scanlines: the active list, and where it stands. The edges are lent to each call, so that a suspended sweep is only its list.
#[derive(Clone, Debug)]
pub struct Sweep<T> {
    /// The scanlines still to come.
    rows: Range<u32>,
    /// The first chain that has not entered.
    entry: usize,

    /// By slot: positions and steps of [`line::Line::parts`].
    at: Vec<u64>,
    steps: Vec<u64>,
    /// By slot: the scanline behind the last of the edge; `u32::MAX` if the slot is free.
    until: Vec<u32>,
    actives: Vec<Active>,
    tags: Vec<T>,
    free: Vec<u32>,
    /// Slots whose chains ended on this scanline, with their columns on the one above. They are free from the next on.
    ended: Vec<(u32, u32)>,

    list: Vec<Entry>,
    columns: Vec<u32>,

    /// How many active edges are not vertical.
    moving: usize,
    /// The first scanline at which an active edge has ended.
    leave: u32,
    started: bool,
    /// Whether slots were given new numbers on this scanline.
    renumbered: bool,
}

/// A list may have so many slots without an edge before it is made anew, beside three for each with one.
const SPARE: usize = 64;

/// To find an edge's place in the list by halving takes about as long as to pass so many.
const HALVING: usize = 32;

impl<T: Copy> Sweep<T> {
    /// A sweep over `rows`.
    pub fn new(rows: Range<u32>) -> Sweep<T> {
        Sweep {
            rows,
            entry: 0,
            at: Vec::new(),
            steps: Vec::new(),
            until: Vec::new(),
            actives: Vec::new(),
            tags: Vec::new(),
            free: Vec::new(),
            ended: Vec::new(),
            list: Vec::new(),
            columns: Vec::new(),
            moving: 0,
            leave: u32::MAX,
            started: false,
            renumbered: false,
        }
    }

    /// Columns of the active edges, ascending.
    pub fn columns(&self) -> &[u32] {
        &self.columns
    }

    /// The active edges in the same order.
    pub fn list(&self) -> &[Entry] {
        &self.list
    }

    /// Tags by slot; those of free slots mean nothing.
    pub fn tags(&self) -> &[T] {
        &self.tags
    }

    /// Whether the chain in a slot entered on this scanline.
    pub fn has_entered(&self, slot: usize, y: u32) -> bool {
        self.actives[slot].since == y
    }

    /// Whether the chain in a slot, which was active on the scanline above, has ended.
    pub fn has_ended(&self, slot: usize) -> bool {
        self.actives[slot].ended
    }

    /// Whether slots have other numbers than on the scanline above; so it is on the first.
    pub fn is_renumbered(&self) -> bool {
        self.renumbered
    }

    /// Goes to the next scanline that may differ; `None` behind the last.
    pub fn next(&mut self, edges: &Edges<T>) -> Option<Scanline> {
        let y = self.rows.start;
        if y >= self.rows.end {
            return None;
        }
        self.renumbered = !self.started;
        let changed = if self.started { self.advance(edges, y) } else { self.start(edges, y) };
        let n = if self.moving > 0 { 1 } else { self.leave.min(edges.first(self.entry)).min(self.rows.end) - y };
        self.rows.start = y + n;
        debug_assert!(self.check(y));
        Some(Scanline { y, n, changed })
    }

    /// Whether the list is what it should be at scanline `y`.
    fn check(&self, y: u32) -> bool {
        let active = || self.list.iter().map(|entry| entry.slot());
        let placed = self.columns.iter().zip(active()).all(|(&column, slot)| column == line::column(self.at[slot]));
        let tie = |i: usize| i > 0 && self.columns[i] == self.columns[i - 1];
        let ties = self.list.iter().enumerate().all(|(i, entry)| entry.is_tied() == tie(i));
        let leave = active().map(|slot| self.until[slot]).min().unwrap_or(u32::MAX);
        let moving = active().filter(|&slot| self.steps[slot] != 0).count();
        let free = self.at.len() - self.list.len() == self.free.len() + self.ended.len();
        self.columns.is_sorted() && placed && ties && leave == self.leave && leave > y && moving == self.moving && free
    }

    /// Fills the list for the first scanline.
    fn start(&mut self, edges: &Edges<T>, y: u32) -> bool {
        self.started = true;
        self.entry = edges.entry(y);
        for chain in edges.straddling(y) {
            let (edge, line) = edges.edge_at(chain, y);
            self.occupy(
                y,
                Active { edge, end: chain.end, since: y, ended: false },
                line.parts(),
                edges.edges[edge as usize].last,
                chain.tag,
            );
        }
        self.list = (0..self.at.len() as u32).map(Entry).collect();
        self.columns = self.at.iter().map(|&at| line::column(at)).collect();
        self.sort();
        self.enter(edges, y);
        self.tie();
        true
    }

    /// From the scanline before to `y`. True if anything but columns changed.
    fn advance(&mut self, edges: &Edges<T>, y: u32) -> bool {
        self.free.extend(self.ended.drain(..).map(|(slot, _)| slot));
        let moved = self.moving > 0;
        if moved {
            self.at.iter_mut().zip(&self.steps).for_each(|(at, step)| *at = at.wrapping_add(*step));
        }
        let replaced = y >= self.leave && self.replace(edges, y);
        let left = !self.ended.is_empty();
        if left {
            self.remove();
        }
        let ordered = !(moved || replaced) || self.place();
        if !ordered {
            self.settle();
        }
        let entered = self.enter(edges, y);
        // Not in the expression: tie() also renews the ties.
        let parted = self.tie();
        if left && self.at.len() > 4 * self.list.len() + SPARE {
            self.renumber();
        }
        left || entered || !ordered || parted
    }

    /// Puts the next edges of their chains in the place of those that have ended, and notes the chains that have. True if an edge was replaced.
    fn replace(&mut self, edges: &Edges<T>, y: u32) -> bool {
        let mut replaced = false;
        let mut leave = u32::MAX;
        for (block, start) in self.until.chunks_mut(16).zip((0..).step_by(16)) {
            if block.iter().fold(false, |any, &until| any | (until <= y)) {
                for (until, slot) in block.iter_mut().zip(start..).filter(|(until, _)| **until <= y) {
                    let active = &mut self.actives[slot];
                    let (at, step) = (&mut self.at[slot], &mut self.steps[slot]);
                    self.moving -= usize::from(*step != 0);
                    if active.edge + 1 < active.end {
                        active.edge += 1;
                        let Edge { last, line } = edges.edges[active.edge as usize];
                        *until = last;
                        (*at, *step) = line.parts();
                        self.moving += usize::from(*step != 0);
                        replaced = true;
                    } else {
                        active.ended = true;
                        *until = u32::MAX;
                        self.ended.push((slot as u32, line::column(at.wrapping_sub(*step))));
                        *step = 0;
                    }
                }
            }
            leave = block.iter().fold(leave, |leave, &until| leave.min(until));
        }
        self.leave = leave;
        replaced
    }

    /// Takes the chains that have ended out of the list, whose columns are still those of the scanline above.
    fn remove(&mut self) {
        if self.ended.len() * HALVING > self.list.len() {
            let mut kept = 0;
            for i in 0..self.list.len() {
                let ended = self.actives[self.list[i].slot()].ended;
                (self.list[kept], self.columns[kept]) = (self.list[i], self.columns[i]);
                kept += usize::from(!ended);
            }
            self.list.truncate(kept);
            self.columns.truncate(kept);
            return;
        }
        let place = |&(slot, column): &(u32, u32)| {
            let start = self.columns.partition_point(|&other| other < column);
            let place = self.list[start..].iter().position(|entry| entry.slot() == slot as usize);
            start + place.expect("what was active is in the list, in its column")
        };
        let mut places: Vec<usize> = self.ended.iter().map(place).collect();
        places.sort_unstable();
        let (mut to, mut from) = (0, 0);
        for place in places {
            self.list.copy_within(from..place, to);
            self.columns.copy_within(from..place, to);
            to += place - from;
            from = place + 1;
        }
        self.list.copy_within(from.., to);
        self.columns.copy_within(from.., to);
        self.list.truncate(to + self.list.len() - from);
        self.columns.truncate(self.list.len());
    }

    /// Looks up the columns of this scanline. False if they are not in order.
    fn place(&mut self) -> bool {
        let mut before = 0;
        let mut ordered = true;
        for (column, entry) in self.columns.iter_mut().zip(&self.list) {
            *column = line::column(self.at[entry.slot()]);
            ordered &= before <= *column;
            before = *column;
        }
        ordered
    }

    /// Puts the list in order of columns: by insertion where little is out of place, as coherence lets expect (section 2.2.3), else by
    /// sorting.
    fn settle(&mut self) {
        let mut budget = 4 * self.columns.len() + 64;
        for i in 1..self.columns.len() {
            let column = self.columns[i];
            if self.columns[i - 1] <= column {
                continue;
            }
            let entry = self.list[i];
            let mut to = i;
            while to > 0 && self.columns[to - 1] > column {
                (self.columns[to], self.list[to]) = (self.columns[to - 1], self.list[to - 1]);
                to -= 1;
            }
            (self.columns[to], self.list[to]) = (column, entry);
            match budget.checked_sub(i - to) {
                Some(left) => budget = left,
                None => {
                    self.sort();
                    break;
                }
            }
        }
    }

    fn sort(&mut self) {
        let mut order: Vec<u64> =
            self.columns.iter().zip(&self.list).map(|(&column, entry)| u64::from(column) << 32 | u64::from(entry.0)).collect();
        order.sort_unstable();
        self.columns.iter_mut().zip(&order).for_each(|(column, key)| *column = (key >> 32) as u32);
        self.list.iter_mut().zip(&order).for_each(|(entry, key)| *entry = Entry(*key as u32));
    }

    /// Merges the chains that begin at scanline `y` into the list, from its end, so that only what lies right of them moves. True if there are any.
    fn enter(&mut self, edges: &Edges<T>, y: u32) -> bool {
        let entering = edges.entering(self.entry, y);
        if entering.is_empty() {
            return false;
        }
        self.entry += entering.len();
        let mut old = self.list.len();
        self.list.resize(old + entering.len(), Entry(0));
        self.columns.resize(old + entering.len(), 0);
        for (i, chain) in entering.iter().enumerate().rev() {
            let Edge { last, line } = edges.edges[chain.start as usize];
            let active = Active { edge: chain.start, end: chain.end, since: y, ended: false };
            let slot = self.occupy(y, active, line.parts(), last, chain.tag);
            // Many that enter are found by passing all, few by halving.
            let place = if entering.len() * HALVING > self.list.len() {
                self.columns[..old].iter().rposition(|&other| other <= chain.column).map_or(0, |place| place + 1)
            } else {
                self.columns[..old].partition_point(|&other| other <= chain.column)
            };
            self.list.copy_within(place..old, place + i + 1);
            self.columns.copy_within(place..old, place + i + 1);
            old = place;
            (self.list[place + i], self.columns[place + i]) = (Entry(slot), chain.column);
        }
        true
    }

    /// Gives a chain a slot.
    fn occupy(&mut self, y: u32, active: Active, (at, step): (u64, u64), until: u32, tag: T) -> u32 {
        debug_assert!(until > y);
        self.moving += usize::from(step != 0);
        self.leave = self.leave.min(until);
        if let Some(slot) = self.free.pop() {
            let i = slot as usize;
            (self.at[i], self.steps[i], self.until[i], self.actives[i], self.tags[i]) = (at, step, until, active, tag);
            return slot;
        }
        self.at.push(at);
        self.steps.push(step);
        self.until.push(until);
        self.actives.push(active);
        self.tags.push(tag);
        self.at.len() as u32 - 1
    }

    /// Renews the ties; true if one formed or parted, of edges that were in the list before.
    fn tie(&mut self) -> bool {
        let mut changed = 0;
        let mut tie = |entry: &mut Entry, tied: u32| {
            changed |= entry.0 ^ tied;
            entry.0 = entry.0 & !TIED | tied;
        };
        if let Some((first, rest)) = self.list.split_first_mut() {
            tie(first, 0);
            for (entry, pair) in rest.iter_mut().zip(self.columns.windows(2)) {
                tie(entry, if pair[0] == pair[1] { TIED } else { 0 });
            }
        }
        changed & TIED != 0
    }

    /// Numbers the slots in the order of the list, without the free ones.
    fn renumber(&mut self) {
        self.renumbered = true;
        let slots: Vec<usize> = self.list.iter().map(|entry| entry.slot()).collect();
        self.at = slots.iter().map(|&slot| self.at[slot]).collect();
        self.steps = slots.iter().map(|&slot| self.steps[slot]).collect();
        self.until = slots.iter().map(|&slot| self.until[slot]).collect();
        self.actives = slots.iter().map(|&slot| self.actives[slot]).collect();
        self.tags = slots.iter().map(|&slot| self.tags[slot]).collect();
        self.free.clear();
        self.ended.clear();
        self.list.iter_mut().zip(0..).for_each(|(entry, slot)| entry.0 = entry.0 & TIED | slot);
    }
}
