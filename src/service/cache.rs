//! What is made once and shared by all who want it: whoever comes while it is being made waits for that.
//!
//! It is there as long as somebody uses it. Some of what nobody uses is kept for the next, as many bytes as the owner of a cache allows; what was asked for longest
//! ago goes first.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use tokio::sync::OnceCell;

/// What tells one thing in a cache from others: a SHA-256.
pub type Key = [u8; 32];

/// What has a weight.
pub trait Weigh {
    /// About how many bytes it holds.
    fn weight(&self) -> u64;
}

/// Things by their keys.
pub struct Cache<T> {
    known: Mutex<Known<T>>,
}

struct Known<T> {
    slots: HashMap<Key, Slot<T>>,
    /// Counts requests.
    now: u64,
}

type Cell<T> = Arc<OnceCell<Arc<T>>>;

struct Slot<T> {
    asked: u64,
    /// Being made, or used somewhere.
    shared: Weak<OnceCell<Arc<T>>>,
    /// Kept although it may not be used.
    kept: Option<Cell<T>>,
}

/// A thing that is used: as long as this lives others find it.
pub struct Shared<T> {
    /// The thing.
    pub thing: Arc<T>,
    /// Whether it was made for this request.
    pub fresh: bool,
    _cell: Cell<T>,
}

impl<T> Clone for Shared<T> {
    fn clone(&self) -> Shared<T> {
        Shared { thing: self.thing.clone(), fresh: self.fresh, _cell: self._cell.clone() }
    }
}

impl<T> Default for Cache<T> {
    fn default() -> Cache<T> {
        Cache { known: Mutex::new(Known { slots: HashMap::new(), now: 0 }) }
    }
}

impl<T: Weigh> Cache<T> {
    fn lock(&self) -> MutexGuard<'_, Known<T>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The thing of that key, made if it is not there. So many bytes of what nobody uses are kept.
    ///
    /// # Errors
    /// Those of making it.
    pub async fn get<E>(&self, key: Key, keep: u64, make: impl AsyncFnOnce() -> Result<T, E>) -> Result<Shared<T>, E> {
        let cell = self.cell(key);
        let mut fresh = false;
        let made = cell
            .get_or_try_init(async || {
                fresh = true;
                make().await.map(Arc::new)
            })
            .await
            .cloned();
        let shared = match made {
            Ok(thing) => Ok(Shared { thing, fresh, _cell: cell }),
            Err(error) => {
                // Nothing of what failed stays.
                drop(cell);
                Err(error)
            }
        };
        self.trim(keep);
        shared
    }

    fn cell(&self, key: Key) -> Cell<T> {
        let known = &mut *self.lock();
        known.now += 1;
        let slot = known.slots.entry(key).or_insert_with(|| Slot { asked: 0, shared: Weak::new(), kept: None });
        slot.asked = known.now;
        let cell = slot.shared.upgrade().unwrap_or_default();
        slot.shared = Arc::downgrade(&cell);
        slot.kept = Some(cell.clone());
        cell
    }

    /// The thing of that key, if it is kept; it counts as asked for.
    pub fn find(&self, key: &Key) -> Option<Arc<T>> {
        let known = &mut *self.lock();
        known.now += 1;
        let slot = known.slots.get_mut(key)?;
        slot.asked = known.now;
        slot.thing().cloned()
    }

    /// All that are kept, those that were asked for last first.
    pub fn all(&self) -> Vec<Arc<T>> {
        let known = self.lock();
        let mut all: Vec<_> = known.slots.values().filter_map(|slot| Some((slot.asked, slot.thing()?.clone()))).collect();
        all.sort_unstable_by_key(|(asked, _)| std::cmp::Reverse(*asked));
        all.into_iter().map(|(_, thing)| thing).collect()
    }

    /// Keeps the thing of that key no more, and tells whether it was kept.
    pub fn remove(&self, key: &Key) -> bool {
        let known = &mut *self.lock();
        known.slots.get_mut(key).and_then(|slot| slot.kept.take_if(|cell| cell.get().is_some())).is_some()
    }

    /// What all weigh that are there.
    pub fn weight(&self) -> u64 {
        let cells: Vec<_> = self.lock().slots.values().filter_map(|slot| slot.shared.upgrade()).collect();
        cells.iter().filter_map(|cell| cell.get()).map(|thing| thing.weight()).sum()
    }

    /// Lets go of what is kept past so many bytes, longest unused first.
    fn trim(&self, keep: u64) {
        let known = &mut *self.lock();
        let mut kept: Vec<(u64, Key, u64)> =
            known.slots.iter().filter_map(|(key, slot)| Some((slot.asked, *key, slot.thing()?.weight()))).collect();
        kept.sort_unstable();
        let mut sum: u64 = kept.iter().map(|kept| kept.2).sum();
        for (_, key, weight) in kept {
            if sum <= keep {
                break;
            }
            sum -= weight;
            if let Some(slot) = known.slots.get_mut(&key) {
                slot.kept = None;
            }
        }
        // What failed to be made is kept by nobody.
        known
            .slots
            .values_mut()
            .for_each(|slot| slot.kept = slot.kept.take().filter(|cell| cell.get().is_some() || Arc::strong_count(cell) > 1));
        known.slots.retain(|_, slot| slot.shared.strong_count() > 0);
    }
}

impl<T> Slot<T> {
    /// What is kept, if it has been made.
    fn thing(&self) -> Option<&Arc<T>> {
        self.kept.as_ref()?.get()
    }
}
