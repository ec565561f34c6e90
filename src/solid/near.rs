//! Things near each other, by a grid: what may be the same is in one cell of it or in neighbours.

use std::collections::HashMap;
use std::hash::BuildHasher;

use foldhash::fast::FixedState;

use super::body::NOTHING;

/// A place in units of cells, and how near to it, at most half a cell, what may be the same is.
#[derive(Clone, Copy)]
pub(super) struct Place<const N: usize> {
    pub(super) at: [f64; N],
    pub(super) near: f64,
}

impl<const N: usize> Place<N> {
    fn cell(&self) -> [i32; N] {
        self.at.map(|x| x.floor() as i32)
    }

    /// Its cell and those beside it that are nearer than `near`.
    fn around(&self) -> impl Iterator<Item = [i32; N]> + use<N> {
        let cell = self.cell();
        let (mut beside, mut ways) = ([(0, 0); N], 0);
        for (i, x) in self.at.into_iter().enumerate() {
            let within = x - x.floor();
            if within < self.near || within > 1.0 - self.near {
                beside[ways] = (i, if within < self.near { -1 } else { 1 });
                ways += 1;
            }
        }
        (0..1_u32 << ways).map(move |choice| {
            let mut other = cell;
            for &(i, step) in beside[..ways].iter().enumerate().filter(|(k, _)| choice >> k & 1 == 1).map(|(_, side)| side) {
                other[i] = i32::wrapping_add(other[i], step);
            }
            other
        })
    }
}

/// For every place whether there may be others near it: none is if it is told so, and most of those that have none are told.
pub(super) fn crowded<const N: usize>(places: &[Place<N>]) -> Vec<bool> {
    /// Counters for each place: one that another place uses by chance makes a place look crowded.
    const COUNTERS: usize = 8;
    let mut counters = vec![0_u8; (COUNTERS * places.len()).next_power_of_two()];
    let (hasher, mask) = (FixedState::default(), counters.len() - 1);
    let counter = |cell: [i32; N]| hasher.hash_one(cell) as usize & mask;
    for cell in places.iter().flat_map(Place::around) {
        let counter = &mut counters[counter(cell)];
        *counter = counter.saturating_add(1);
    }
    places.iter().map(|place| place.around().any(|cell| counters[counter(cell)] > 1)).collect()
}

/// Items by the cell of a grid that they are in.
pub(super) struct Cells<const N: usize> {
    /// The last item of a cell.
    last: HashMap<[i32; N], u32, FixedState>,
    /// For every item the one before it in its cell.
    before: Vec<u32>,
    /// The first item.
    first: u32,
}

impl<const N: usize> Cells<N> {
    /// Room for so many items, numbered from `first` on.
    pub(super) fn new(items: usize, first: u32) -> Cells<N> {
        Cells { last: HashMap::with_capacity_and_hasher(items, FixedState::default()), before: Vec::new(), first }
    }

    /// Adds the next item.
    pub(super) fn add(&mut self, place: &Place<N>) -> u32 {
        let item = self.first + self.before.len() as u32;
        let before = self.last.insert(place.cell(), item);
        self.before.push(before.unwrap_or(NOTHING));
        item
    }

    /// The first item that is the same as one at that place, among those near it, as long as it may be compared.
    pub(super) fn find(&self, place: &Place<N>, may_compare: impl Fn() -> bool, same: impl Fn(u32) -> bool) -> Option<u32> {
        let mut found = None;
        for cell in place.around() {
            let mut item = self.last.get(&cell).copied().unwrap_or(NOTHING);
            while item != NOTHING && may_compare() {
                if found.is_none_or(|found| item < found) && same(item) {
                    found = Some(item);
                }
                item = self.before[(item - self.first) as usize];
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_has_something_near_is_told(at in prop::collection::vec((prop::array::uniform2(-2..14_i32), 0..3_u32), 1..40)) {
            // Quarters of cells, and how near up to half a cell.
            let places: Vec<Place<2>> = at.iter().map(|(at, near)| Place { at: at.map(|x| f64::from(x) / 4.0), near: f64::from(*near) / 4.0 }).collect();
            let told = crowded(&places);
            for (i, a) in places.iter().enumerate() {
                for (k, b) in places.iter().enumerate().filter(|(k, _)| *k != i) {
                    let apart = a.at.iter().zip(b.at).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                    if apart < a.near {
                        prop_assert!(told[i] && told[k], "{i} {k}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_alone_is_mostly_told_so() {
        let places: Vec<Place<2>> =
            (0..1000).map(|i| Place { at: [f64::from(i % 40) * 2.0 + 0.5, f64::from(i / 40) * 3.0 + 0.5], near: 0.1 }).collect();
        assert!(crowded(&places).iter().filter(|crowded| **crowded).count() < 300);
    }
}
