//! A set of small integers that finds its first or last member at once.
//!
//! Each level holds one bit for a word of the level below, so a set over n numbers is log64 n levels deep: one word up to 64, two
//! levels up to 4,096, three up to 262,144.
//!
//! ```text
//! level 1   0 0 1 1           bit w: word w of level 0 is not zero
//! level 0   0000 0000 0100 1010
//! ```
//!
//! Uses: the next node to settle in [`crate::count`] (lowest first), the topmost layer in painter's order (highest).

/// A set of integers below a fixed bound.
#[derive(Clone, Debug)]
pub struct BitSet {
    /// From the members up, without the single word at the top.
    levels: Vec<Vec<u64>>,
    top: u64,
}

impl BitSet {
    /// An empty set for members `0..bound`.
    pub fn new(bound: usize) -> BitSet {
        let mut levels = Vec::new();
        let mut words = bound.div_ceil(64);
        while words > 1 {
            levels.push(vec![0; words]);
            words = words.div_ceil(64);
        }
        BitSet { levels, top: 0 }
    }

    /// Adds a member; it may be there already.
    #[inline]
    pub fn insert(&mut self, member: usize) {
        let mut at = member;
        for level in &mut self.levels {
            let word = &mut level[at / 64];
            let was = *word;
            *word |= 1 << (at % 64);
            if was != 0 {
                return;
            }
            at /= 64;
        }
        self.top |= 1 << (at % 64);
    }

    /// Removes a member; it may be absent.
    #[inline]
    pub fn remove(&mut self, member: usize) {
        let mut at = member;
        for level in &mut self.levels {
            let word = &mut level[at / 64];
            *word &= !(1 << (at % 64));
            if *word != 0 {
                return;
            }
            at /= 64;
        }
        self.top &= !(1 << (at % 64));
    }

    /// Adds a member or removes it.
    pub fn set(&mut self, member: usize, is_in: bool) {
        if is_in { self.insert(member) } else { self.remove(member) }
    }

    /// The smallest member.
    #[inline]
    pub fn first(&self) -> Option<usize> {
        self.descend(|word| word.trailing_zeros() as usize)
    }

    /// The largest member.
    #[inline]
    pub fn last(&self) -> Option<usize> {
        self.descend(|word| 63 - word.leading_zeros() as usize)
    }

    fn descend(&self, choose: impl Fn(u64) -> usize) -> Option<usize> {
        if self.top == 0 {
            return None;
        }
        Some(self.levels.iter().rev().fold(choose(self.top), |at, level| at * 64 + choose(level[at])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn agrees_with_a_tree_set() {
        for bound in [1, 64, 65, 4096, 5000, 300_000] {
            let mut bits = BitSet::new(bound);
            let mut tree = BTreeSet::new();
            let mut seed = 7u64;
            for _ in 0..3000 {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                let member = (seed >> 33) as usize % bound;
                if seed >> 63 == 0 {
                    bits.insert(member);
                    tree.insert(member);
                } else {
                    let gone = if seed >> 62 & 1 == 0 { tree.first().copied().unwrap_or(member) } else { member };
                    bits.remove(gone);
                    tree.remove(&gone);
                }
                assert_eq!((bits.first(), bits.last()), (tree.first().copied(), tree.last().copied()));
            }
        }
    }
}
