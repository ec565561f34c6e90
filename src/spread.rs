//! Work on many items, spread over threads.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::{panic, thread};

/// What `work` makes of each item, in the order of the items, by at most so many threads, this one among them. The result does not depend on
/// how many there are.
pub(crate) fn spread<T: Sync, R: Send>(items: &[T], threads: usize, work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let push = |all: &mut Vec<R>, made| {
        all.push(made);
        true
    };
    joined(items, threads, work, Vec::with_capacity(items.len()), push).unwrap_or_default()
}

/// `whole`, to which `join` has put what `work` makes of each item, in the order of the items. Each is put there as soon as those before it are, so that
/// little waits. `None` once `join` says no, which is not called again.
pub(crate) fn joined<T: Sync, R: Send, W: Send>(
    items: &[T],
    threads: usize,
    work: impl Fn(&T) -> R + Sync,
    whole: W,
    join: impl Fn(&mut W, R) -> bool + Sync,
) -> Option<W> {
    let next = AtomicUsize::new(0);
    // What is whole up to an item, that item's index, and what was made of later ones.
    let shared = Mutex::new((Some(whole), 0, BTreeMap::new()));
    let some = || {
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(item) = items.get(i) else { return };
            let made = work(item);
            let (whole, first, waiting) = &mut *shared.lock().unwrap_or_else(PoisonError::into_inner);
            waiting.insert(i, made);
            while let Some(made) = waiting.remove(first) {
                *whole = whole.take().and_then(|mut whole| join(&mut whole, made).then_some(whole));
                *first += 1;
            }
            if whole.is_none() {
                return;
            }
        }
    };
    thread::scope(|scope| {
        // A thread that cannot be had is done without.
        let others: Vec<_> = (1..threads.min(items.len())).filter_map(|_| thread::Builder::new().spawn_scoped(scope, some).ok()).collect();
        some();
        others.into_iter().for_each(|other| other.join().unwrap_or_else(|fault| panic::resume_unwind(fault)));
    });
    shared.into_inner().unwrap_or_else(PoisonError::into_inner).0
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

    #[test]
    fn joining_ends_where_it_is_refused() {
        let items: Vec<u64> = (0..1000).collect();
        for (threads, refused) in [(1, 0), (3, 0), (3, 500), (8, 999), (8, 1000)] {
            let seen = Mutex::new(Vec::new());
            let whole = joined(
                &items,
                threads,
                |&i| i,
                0,
                |sum, i| {
                    seen.lock().unwrap().push(i);
                    *sum += i;
                    i != refused
                },
            );
            assert_eq!(whole, (refused == 1000).then_some(999 * 500));
            assert!(seen.into_inner().unwrap().into_iter().eq(0..=refused.min(999)), "{threads} threads, {refused}");
        }
    }
}
