//! Slots: the active edges as they are stepped, in no order.
//!
//! An active chain has a slot for as long as it is active. Positions and steps stand in arrays of their own, so that a scanline is one addition along
//! them; an edge that takes the place of another changes its slot and nothing else. Which edges end on a scanline is known beforehand: those that end within
//! the next scanlines, a *turn* of them, wait in a list for each.

use super::{Chain, Edge, Edges};
use crate::line;

/// What is looked at of an active chain only when its edge ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Active {
    /// Index of the edge behind its edge, and behind the last of its chain.
    next: u32,
    end: u32,
    /// The scanline on which its edge became active.
    renewed: u32,
    /// The scanline behind the last of the edge; [`NEVER`] if the chain has ended or the slot is free.
    pub(super) until: u32,
    /// The next slot that waits for the same scanline.
    next_due: u32,
}

/// Behind every page.
pub(super) const NEVER: u32 = u32::MAX;

/// Scanlines to a turn.
const TURN: u32 = 256;

/// Which scanline of its turn this is.
#[inline]
fn in_turn(row: u32) -> usize {
    (row % TURN) as usize
}

/// No slot.
const NONE: u32 = u32::MAX;

/// The slots of a sweep.
#[derive(Clone, Debug)]
pub(super) struct Slots<T> {
    /// Positions and steps of [`line::Line::parts`]; a free slot has step 0.
    pub(super) at: Vec<u64>,
    pub(super) steps: Vec<u64>,
    pub(super) actives: Vec<Active>,
    pub(super) tags: Vec<T>,
    pub(super) free: Vec<u32>,
    /// For every scanline of the turn the first slot whose edge ends above it.
    due: Box<[u32; TURN as usize]>,
    /// The scanline behind the turn.
    turn: u32,
    /// Slots whose chains ended on this scanline, with their columns on the one above. They are free from the next on.
    pub(super) ended: Vec<(u32, u32)>,
    /// How many active edges are not vertical.
    pub(super) moving: usize,
}

impl<T: Copy> Slots<T> {
    pub(super) fn new() -> Slots<T> {
        Slots {
            at: Vec::new(),
            steps: Vec::new(),
            actives: Vec::new(),
            tags: Vec::new(),
            free: Vec::new(),
            ended: Vec::new(),
            moving: 0,
            due: Box::new([NONE; TURN as usize]),
            turn: 0,
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

    /// The column of a slot on the scanline above, if its edge was there and still is.
    pub(super) fn column_above(&self, slot: usize, y: u32) -> Option<u32> {
        (self.actives[slot].renewed < y && !self.has_ended(slot)).then(|| line::column(self.at[slot].wrapping_sub(self.steps[slot])))
    }

    /// Goes down to scanline `y`: by one, or by as many as repeat. True if columns may differ.
    pub(super) fn step(&mut self, y: u32) -> bool {
        self.free.extend(self.ended.drain(..).map(|(slot, _)| slot));
        self.turn(y);
        if self.moving > 0 {
            self.at.iter_mut().zip(&self.steps).for_each(|(at, step)| *at = at.wrapping_add(*step));
        }
        self.moving > 0
    }

    /// Begins the next turn, if `y` is behind this one.
    pub(super) fn turn(&mut self, y: u32) {
        if y >= self.turn {
            self.turn = (y / TURN + 1) * TURN;
            (0..self.len()).for_each(|slot| self.wait(slot));
        }
    }

    /// Puts a slot to those that wait for a scanline of this turn.
    #[inline]
    fn wait(&mut self, slot: usize) {
        let Active { until, next_due, .. } = &mut self.actives[slot];
        if *until < self.turn {
            *next_due = std::mem::replace(&mut self.due[in_turn(*until)], slot as u32);
        }
    }

    /// The first scanline below `y` at which an active edge has ended.
    pub(super) fn leave(&self, y: u32) -> u32 {
        let soon = (y + 1..self.turn).find(|&row| self.due[in_turn(row)] != NONE);
        soon.unwrap_or_else(|| self.actives.iter().fold(NEVER, |leave, active| leave.min(active.until)))
    }

    /// Puts the next edges of their chains in the place of those that have ended, and notes the chains that have. True if an edge was replaced.
    #[inline]
    pub(super) fn replace(&mut self, edges: &Edges<T>, y: u32) -> bool {
        let mut replaced = false;
        let mut slot = std::mem::replace(&mut self.due[in_turn(y)], NONE);
        while slot != NONE {
            let next = self.actives[slot as usize].next_due;
            replaced |= self.renew(edges, slot as usize, y);
            slot = next;
        }
        replaced
    }

    /// Puts the next edge of its chain in the place of one that has ended, if there is one.
    fn renew(&mut self, edges: &Edges<T>, slot: usize, y: u32) -> bool {
        let active = &mut self.actives[slot];
        let (at, step) = (&mut self.at[slot], &mut self.steps[slot]);
        let moved = *step != 0;
        if active.next == active.end {
            self.moving -= usize::from(moved);
            active.until = NEVER;
            self.ended.push((slot as u32, line::column(at.wrapping_sub(*step))));
            *step = 0;
            return false;
        }
        let Edge { last, line } = edges.edges[active.next as usize];
        (*at, *step) = line.parts();
        self.moving = self.moving + usize::from(*step != 0) - usize::from(moved);
        active.next += 1;
        active.renewed = y;
        active.until = last;
        self.wait(slot);
        true
    }

    /// Gives a chain a slot, with the edge that it has on scanline `y`.
    pub(super) fn occupy(&mut self, edges: &Edges<T>, chain: &Chain<T>, y: u32) -> u32 {
        let (Edge { last: until, line }, next) = edges.edge_at(chain, y);
        let ((at, step), active) = (line.parts(), Active { next, end: chain.end, renewed: y, until, next_due: NONE });
        debug_assert!(until > y);
        self.moving += usize::from(step != 0);
        let slot = if let Some(slot) = self.free.pop() {
            let i = slot as usize;
            (self.at[i], self.steps[i], self.actives[i], self.tags[i]) = (at, step, active, chain.tag);
            slot
        } else {
            self.at.push(at);
            self.steps.push(step);
            self.actives.push(active);
            self.tags.push(chain.tag);
            self.len() as u32 - 1
        };
        self.wait(slot as usize);
        slot
    }

    /// Gives the active slots new numbers, in that order; no free ones are left.
    pub(super) fn renumber(&mut self, order: &[usize]) {
        self.at = order.iter().map(|&slot| self.at[slot]).collect();
        self.steps = order.iter().map(|&slot| self.steps[slot]).collect();
        self.actives = order.iter().map(|&slot| self.actives[slot]).collect();
        self.tags = order.iter().map(|&slot| self.tags[slot]).collect();
        self.free.clear();
        self.ended.clear();
        self.due.fill(NONE);
        (0..self.len()).for_each(|slot| self.wait(slot));
    }

    /// Whether the chain in a slot has ended, on this scanline or before.
    pub(super) fn has_ended(&self, slot: usize) -> bool {
        self.actives[slot].until == NEVER
    }

    /// Lays the slots that are not active in a column, that behind the page's last, where they change nothing.
    pub(super) fn lay_aside(&mut self, width: u32) {
        for &(slot, _) in &self.ended {
            self.at[slot as usize] = line::Line::vertical(width).parts().0;
        }
    }
}
