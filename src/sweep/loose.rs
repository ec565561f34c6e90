//! A sweep without order.
//!
//! Where most edges cross many others on every scanline, order is dear and says nothing. Then a sweep can be *loose*: it steps the slots and keeps no list, and
//! those who count look at columns. Slots of chains that have ended are laid into the column behind the page, where they change nothing, until
//! others take them.

use super::Edges;
use super::active::Sweep;

/// What a loose sweep has come to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Loose {
    /// The scanline.
    pub y: u32,
    /// How many edges are active.
    pub active: usize,
    /// Whether edges entered or left since the scanline before, or some of them certainly crossed.
    pub changed: bool,
}

impl<T: Copy> Sweep<T> {
    /// Gives up the order from the next scanline on.
    pub fn loosen(&mut self) {
        self.renumber();
        self.list.clear();
        self.columns.clear();
        self.entered = false;
    }

    /// Goes to the next scanline without order; `width` is that of the page. `None` behind the last.
    pub fn next_loose(&mut self, edges: &Edges<T>, width: u32) -> Option<Loose> {
        let y = self.rows.start;
        if y >= self.rows.end {
            return None;
        }
        self.rows.start += 1;
        if self.slots.free.len() * 4 > self.slots.len() {
            self.compact();
        }
        self.slots.step(y);
        self.slots.replace(edges, y);
        self.slots.lay_aside(width);
        let entering = edges.entering(self.entry, y);
        self.entry += entering.len();
        entering.iter().for_each(|chain| _ = self.slots.occupy(edges, chain, y));
        let changed = !self.slots.ended.is_empty() || !entering.is_empty() || self.has_crossed(y);
        Some(Loose { y, active: self.slots.len() - self.slots.free.len() - self.slots.ended.len(), changed })
    }

    /// Whether two edges certainly stand in another order than on the scanline above. Neighbours by slot are looked at: in a tangle some of them have crossed.
    fn has_crossed(&self, y: u32) -> bool {
        let slots = &self.slots;
        let order = |slot: usize| {
            let above = slots.column_above(slot, y)?.cmp(&slots.column_above(slot + 1, y)?);
            Some(above != slots.column(slot).cmp(&slots.column(slot + 1)))
        };
        (1..slots.len()).any(|slot| order(slot - 1) == Some(true))
    }

    /// Positions of the edges of a loose sweep, by slot; [`crate::line::column()`] reads them. Those that are not active any more are in the column behind the page.
    pub fn positions(&self) -> &[u64] {
        &self.slots.at
    }

    /// Numbers the slots of a loose sweep without those that are free.
    fn compact(&mut self) {
        let active: Vec<usize> = (0..self.slots.len()).filter(|&slot| !self.slots.has_ended(slot)).collect();
        self.slots.renumber(&active);
    }

    /// Puts a loose sweep in order again, on the scanline where it stands.
    pub fn tighten(&mut self) {
        self.compact();
        self.order();
        self.tie();
        self.renumbered = true;
    }
}
