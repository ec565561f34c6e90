//! The active list: which edges a scanline meets, in the order of their columns ("CSG" in ARCHITECTURE.md, section 2.1.2).
//!
//! What is stepped stands apart ([`Slots`]) from what is ordered: the list holds slots in order of
//! columns, each with a mark where it shares its column with the one before:
//!
//! ```text
//!   slot      0    1    2    3                list       2    0 ~ 3    1        ~ tied
//!   at      5.3  8.1  2.7  5.9                columns    2    5   5    8
//!   step    0.5   0  -1.0  0.1
//! ```
//!
//! Only crossings and chains that enter or leave touch the list.
//!
//! Cost of a scanline: an addition, a look-up and two comparisons for every active edge; a scanline on which all of them are vertical costs
//! nothing until one enters or leaves.

use std::ops::Range;

use super::Edges;
use super::slots::{NEVER, Slots};
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

/// Set where an entry was not in the list on the scanline above.
const ENTERED: u32 = 1 << 30;

const MARKS: u32 = TIED | ENTERED;

impl Entry {
    /// The slot of the edge: the same for as long as its chain is active.
    #[inline]
    pub fn slot(self) -> usize {
        (self.0 & !MARKS) as usize
    }

    /// Whether it is in the column of the entry before.
    #[inline]
    pub fn is_tied(self) -> bool {
        self.0 & TIED != 0
    }

    /// Whether the chain entered on this scanline.
    #[inline]
    pub fn has_entered(self) -> bool {
        self.0 & ENTERED != 0
    }

    /// Whether both are of one slot and tied alike: of this scanline and the one above, the same chain in the same relation to the one before.
    #[inline]
    pub fn is_same(self, other: Entry) -> bool {
        (self.0 ^ other.0) & !ENTERED == 0
    }
}

/// A sweep over a range of scanlines: the active list, and where it stands. The edges are lent to each call, so that a suspended sweep is only its list.
#[derive(Clone, Debug)]
pub struct Sweep<T> {
    /// The scanlines still to come.
    pub(super) rows: Range<u32>,
    /// The first chain that has not entered.
    pub(super) entry: usize,

    pub(super) slots: Slots<T>,
    pub(super) list: Vec<Entry>,
    pub(super) columns: Vec<u32>,
    /// By how many places edges were moved on this scanline.
    moved: usize,
    /// Whether entries of this scanline are marked as entered.
    pub(super) entered: bool,
    started: bool,
    /// Whether slots were given new numbers on this scanline.
    pub(super) renumbered: bool,
}

/// A list may have so many slots without an edge before it is made anew, beside three for each with one.
const SPARE: usize = 64;

/// The bits of a position behind the point.
const FRACTIONS: u64 = (1 << line::FRACTION) - 1;

/// Columns that are looked through at once for order.
const BLOCK: usize = 32;

/// To find an edge's place in the list by halving takes about as long as to pass so many.
const HALVING: usize = 16;

impl<T: Copy> Sweep<T> {
    /// A sweep over `rows`.
    pub fn new(rows: Range<u32>) -> Sweep<T> {
        Sweep {
            rows,
            entry: 0,
            slots: Slots::new(),
            list: Vec::new(),
            columns: Vec::new(),
            moved: 0,
            entered: false,
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
        &self.slots.tags
    }

    /// The scanline behind the last of the edge in a slot.
    #[inline]
    pub fn until(&self, slot: usize) -> u32 {
        self.slots.actives[slot].until
    }

    /// Where the edge in a slot passes a scanline so many below, if it reaches that far: right of where pixel 0 is looked at, in units of 2^-43 px ([`line::FRACTION`]).
    #[inline]
    pub fn position_below(&self, slot: usize, rows: u32) -> i128 {
        let at = self.slots.at[slot].wrapping_add(self.slots.steps[slot].wrapping_mul(rows.into()));
        i128::from(at as i64) - i128::from(FRACTIONS)
    }

    /// How far the edge in a slot is at least from the next pixel to the left and to the right of it, in the same units, on this scanline and so many below.
    pub fn room_below(&self, slot: usize, rows: u32) -> [u64; 2] {
        let (mut at, step) = (self.slots.at[slot], self.slots.steps[slot]);
        let [mut left, mut right] = [u64::MAX; 2];
        for _ in 0..=rows {
            let past = at & FRACTIONS;
            (left, right) = (left.min(past + 1), right.min(FRACTIONS - past));
            at = at.wrapping_add(step);
        }
        [left, right]
    }

    /// Whether the chain in a slot, which was active on the scanline above, has ended.
    #[inline]
    pub fn has_ended(&self, slot: usize) -> bool {
        self.slots.has_ended(slot)
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
        let n = if self.slots.moving > 0 { 1 } else { self.slots.leave(y).min(edges.first(self.entry)).min(self.rows.end) - y };
        self.rows.start = y + n;
        debug_assert!(self.check(y));
        Some(Scanline { y, n, changed })
    }

    /// Whether the list is what it should be at scanline `y`.
    fn check(&self, y: u32) -> bool {
        let slots = &self.slots;
        let active = || self.list.iter().map(|entry| entry.slot());
        let placed = self.columns.iter().zip(active()).all(|(&column, slot)| column == slots.column(slot));
        let tie = |i: usize| i > 0 && self.columns[i] == self.columns[i - 1];
        let ties = self.list.iter().enumerate().all(|(i, entry)| entry.is_tied() == tie(i));
        let leave = active().map(|slot| slots.actives[slot].until).min().unwrap_or(NEVER);
        let leave = leave == slots.leave(y) && leave > y;
        let moving = active().filter(|&slot| slots.steps[slot] != 0).count();
        let free = slots.len() - self.list.len() == slots.free.len() + slots.ended.len();
        self.columns.is_sorted() && placed && ties && leave && moving == slots.moving && free
    }

    /// Fills the list for the first scanline.
    fn start(&mut self, edges: &Edges<T>, y: u32) -> bool {
        self.started = true;
        self.entry = edges.entry(y);
        self.slots.turn(y);
        edges.straddling(y).for_each(|chain| _ = self.slots.occupy(edges, chain, y));
        self.order();
        self.enter(edges, y);
        self.tie();
        true
    }

    /// Makes the list anew from the slots, none of which is free.
    pub(super) fn order(&mut self) {
        self.list = (0..self.slots.len() as u32).map(Entry).collect();
        self.columns = self.slots.at.iter().map(|&at| line::column(at)).collect();
        self.sort();
    }

    /// From the scanline before to `y`. True if anything but columns changed.
    fn advance(&mut self, edges: &Edges<T>, y: u32) -> bool {
        if std::mem::take(&mut self.entered) {
            self.list.iter_mut().for_each(|entry| entry.0 &= !ENTERED);
        }
        let moved = self.slots.step(y);
        let replaced = self.slots.replace(edges, y);
        let left = !self.slots.ended.is_empty();
        if left {
            self.remove();
        }
        self.moved = 0;
        let mut ordered = true;
        if moved || replaced {
            self.place();
            ordered = !self.settle();
        }
        let entered = self.enter(edges, y);
        // Not in the expression: tie() also renews the ties.
        let parted = self.tie();
        if left && self.slots.len() > 4 * self.list.len() + SPARE {
            self.renumber();
        }
        left || entered || !ordered || parted
    }

    /// Takes the chains that have ended out of the list, whose columns are still those of the scanline above.
    fn remove(&mut self) {
        if self.slots.ended.len() * HALVING > self.list.len() {
            let mut kept = 0;
            for i in 0..self.list.len() {
                let ended = self.has_ended(self.list[i].slot());
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
        let mut places: Vec<usize> = self.slots.ended.iter().map(place).collect();
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

    /// Looks up the columns of this scanline.
    fn place(&mut self) {
        let at = &self.slots.at[..];
        let (columns, last_columns) = self.columns.as_chunks_mut::<8>();
        let (list, last) = self.list.as_chunks::<8>();
        for (columns, list) in columns.iter_mut().zip(list) {
            *columns = list.map(|entry| line::column(at[entry.slot()]));
        }
        last_columns.iter_mut().zip(last).for_each(|(column, entry)| *column = line::column(at[entry.slot()]));
    }

    /// Puts the list in order of columns: by insertion where little is out of place, as coherence lets expect (section 2.2.3), else by
    /// sorting. True if something was out of order.
    fn settle(&mut self) -> bool {
        // Columns of a page are below 2^31: signed numbers, many of which are compared at once.
        let sorted = |columns: &[u32; BLOCK + 1]| (0..BLOCK).fold(true, |sorted, i| sorted & (columns[i] as i32 <= columns[i + 1] as i32));
        let mut budget = 4 * self.columns.len() + 64;
        let mut end = 1;
        while end < self.columns.len() {
            let (start, rest) = (end, &self.columns[end - 1..]);
            end = self.columns.len().min(start + BLOCK);
            if rest.first_chunk().map_or_else(|| rest.is_sorted(), sorted) {
                continue;
            }
            for i in start..end {
                if self.columns[i - 1] <= self.columns[i] {
                    continue;
                }
                let moved = self.insert(i);
                self.moved += moved;
                match budget.checked_sub(moved) {
                    Some(left) => budget = left,
                    None => {
                        self.sort();
                        return true;
                    }
                }
            }
        }
        self.moved > 0
    }

    /// Moves an entry to its place in front of it, if those there are in order. Gives by how many places.
    fn insert(&mut self, i: usize) -> usize {
        let (column, entry) = (self.columns[i], self.list[i]);
        let mut to = i;
        while to > 0 && self.columns[to - 1] > column {
            (self.columns[to], self.list[to]) = (self.columns[to - 1], self.list[to - 1]);
            to -= 1;
        }
        (self.columns[to], self.list[to]) = (column, entry);
        i - to
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
        self.entered = true;
        self.entry += entering.len();
        let mut old = self.list.len();
        self.list.resize(old + entering.len(), Entry(0));
        self.columns.resize(old + entering.len(), 0);
        // Many that enter are merged by passing all, few by halving.
        let many = entering.len() * HALVING > self.list.len();
        for (i, chain) in entering.iter().enumerate().rev() {
            let slot = self.slots.occupy(edges, chain, y);
            let column = chain.edge.line.column();
            if many {
                while old > 0 && self.columns[old - 1] > column {
                    old -= 1;
                    (self.columns[old + i + 1], self.list[old + i + 1]) = (self.columns[old], self.list[old]);
                }
            } else {
                let place = self.columns[..old].partition_point(|&other| other <= column);
                self.list.copy_within(place..old, place + i + 1);
                self.columns.copy_within(place..old, place + i + 1);
                old = place;
            }
            (self.columns[old + i], self.list[old + i]) = (column, Entry(slot | ENTERED));
        }
        true
    }

    /// Renews the ties; true if one formed or parted, of edges that were in the list before.
    pub(super) fn tie(&mut self) -> bool {
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
    pub(super) fn renumber(&mut self) {
        self.renumbered = true;
        self.slots.renumber(&self.list.iter().map(|entry| entry.slot()).collect::<Vec<_>>());
        self.list.iter_mut().zip(0..).for_each(|(entry, slot)| entry.0 = entry.0 & MARKS | slot);
    }

    /// By how many places edges were moved in the list on this scanline to restore its order.
    pub fn moved(&self) -> usize {
        self.moved
    }
}
