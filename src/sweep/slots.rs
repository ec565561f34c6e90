//! Slots: the active edges as they are stepped, in no order.
//!
//! An active chain has a slot for as long as it is active. Positions and steps stand in arrays of their own, so that a scanline is one addition along
//! them; an edge that takes the place of another changes its slot and nothing else.

use super::{Chain, Edge, Edges};
use crate::line;

/// What is rarely looked at of an active chain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Active {
    /// Index of its edge, and behind the last of its chain.
    edge: u32,
    end: u32,
    /// The scanline on which the chain became active, and that on which its edge did.
    pub(super) since: u32,
    pub(super) renewed: u32,
    /// Whether it has ended.
    pub(super) ended: bool,
}

/// The slots of a sweep.
#[derive(Clone, Debug)]
pub(super) struct Slots<T> {
    /// Positions and steps of [`line::Line::parts`]; a free slot has step 0.
    pub(super) at: Vec<u64>,
    pub(super) steps: Vec<u64>,
    /// The scanline behind the last of the edge; `u32::MAX` if the slot is free.
    pub(super) until: Vec<u32>,
    pub(super) actives: Vec<Active>,
    pub(super) tags: Vec<T>,
    pub(super) free: Vec<u32>,
    /// Slots whose chains ended on this scanline, with their columns on the one above. They are free from the next on.
    pub(super) ended: Vec<(u32, u32)>,
    /// How many active edges are not vertical.
    pub(super) moving: usize,
    /// The first scanline at which an active edge has ended.
    pub(super) leave: u32,
}

impl<T: Copy> Slots<T> {
    pub(super) fn new() -> Slots<T> {
        Slots {
            at: Vec::new(),
            steps: Vec::new(),
            until: Vec::new(),
            actives: Vec::new(),
            tags: Vec::new(),
            free: Vec::new(),
            ended: Vec::new(),
            moving: 0,
            leave: u32::MAX,
        }
    }

    /// Number of slots, free ones too.
    pub(super) fn len(&self) -> usize {
        self.at.len()
    }

    /// The column of a slot.
    #[inline]
    pub(super) fn column(&self, slot: usize) -> u32 {
        line::column(self.at[slot])
    }

    /// The column of a slot on the scanline above, if its edge was there.
    pub(super) fn column_above(&self, slot: usize, y: u32) -> Option<u32> {
        (self.actives[slot].renewed < y).then(|| line::column(self.at[slot].wrapping_sub(self.steps[slot])))
    }

    /// Goes down one scanline. True if columns may differ.
    pub(super) fn step(&mut self) -> bool {
        self.free.extend(self.ended.drain(..).map(|(slot, _)| slot));
        if self.moving > 0 {
            self.at.iter_mut().zip(&self.steps).for_each(|(at, step)| *at = at.wrapping_add(*step));
        }
        self.moving > 0
    }

    /// Puts the next edges of their chains in the place of those that have ended, and notes the chains that have. True if an edge was replaced.
    pub(super) fn replace(&mut self, edges: &Edges<T>, y: u32) -> bool {
        if y < self.leave {
            return false;
        }
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
                        active.renewed = y;
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

    /// Gives a chain a slot, with the edge that it has on scanline `y`.
    pub(super) fn occupy(&mut self, edges: &Edges<T>, chain: &Chain<T>, y: u32) -> u32 {
        let (edge, line) = edges.edge_at(chain, y);
        let ((at, step), until) = (line.parts(), edges.edges[edge as usize].last);
        let active = Active { edge, end: chain.end, since: y, renewed: y, ended: false };
        debug_assert!(until > y);
        self.moving += usize::from(step != 0);
        self.leave = self.leave.min(until);
        if let Some(slot) = self.free.pop() {
            let i = slot as usize;
            (self.at[i], self.steps[i], self.until[i], self.actives[i], self.tags[i]) = (at, step, until, active, chain.tag);
            return slot;
        }
        self.at.push(at);
        self.steps.push(step);
        self.until.push(until);
        self.actives.push(active);
        self.tags.push(chain.tag);
        self.len() as u32 - 1
    }

    /// Gives the active slots new numbers, in that order; no free ones are left.
    pub(super) fn renumber(&mut self, order: &[usize]) {
        self.at = order.iter().map(|&slot| self.at[slot]).collect();
        self.steps = order.iter().map(|&slot| self.steps[slot]).collect();
        self.until = order.iter().map(|&slot| self.until[slot]).collect();
        self.actives = order.iter().map(|&slot| self.actives[slot]).collect();
        self.tags = order.iter().map(|&slot| self.tags[slot]).collect();
        self.free.clear();
        self.ended.clear();
    }

    /// Fills the slots of chains that have ended with the last ones.
    pub(super) fn close_gaps(&mut self) {
        self.ended.sort_unstable();
        for (slot, _) in self.ended.drain(..).rev() {
            let slot = slot as usize;
            self.at.swap_remove(slot);
            self.steps.swap_remove(slot);
            self.until.swap_remove(slot);
            self.actives.swap_remove(slot);
            self.tags.swap_remove(slot);
        }
    }
}
