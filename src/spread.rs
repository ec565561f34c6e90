//! Work on many items, spread over threads.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::{panic, thread};

/// What `work` makes of each item, in the order of the items, by at most so many threads, this one among them. The result does not depend on
/// how many there are.
pub(crate) fn spread<T: Sync, R: Send>(items: &[T], threads: usize, work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let take = || {
        let i = next.fetch_add(1, Ordering::Relaxed);
        Some((i, work(items.get(i)?)))
    };
    let some = || std::iter::from_fn(take).collect::<Vec<_>>();
    let mut all = thread::scope(|scope| {
        // A thread that cannot be had is done without.
        let others: Vec<_> = (1..threads.min(items.len())).filter_map(|_| thread::Builder::new().spawn_scoped(scope, some).ok()).collect();
        let mut all = some();
        others.into_iter().for_each(|other| all.extend(other.join().unwrap_or_else(|fault| panic::resume_unwind(fault))));
        all
    });
    all.sort_unstable_by_key(|&(i, _)| i);
    all.into_iter().map(|(_, made)| made).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_stand_in_the_order_of_the_items() {
        let items: Vec<u64> = (0..1000).collect();
        let slow = |&i: &u64| (0..i % 7 * 1000).fold(i, |sum, k| sum.wrapping_add(k * k));
        let expected: Vec<u64> = items.iter().map(slow).collect();
        for threads in [0, 1, 2, 5, 2000] {
            assert_eq!(spread(&items, threads, slow), expected);
        }
        assert!(spread(&[], 3, slow).is_empty());
    }
}
