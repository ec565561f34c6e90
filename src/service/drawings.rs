//! Prepared drawings, shared by all who read them: the edges are there once, whoever waits for them waits for one preparation.
//!
//! Some that nobody reads are kept for the next request. How many there are is bounded by what they weigh: those in use together
//! ([`Config::max_drawings`]), and those that are only kept ([`Config::cache`]).

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use tokio::sync::{OnceCell, OwnedSemaphorePermit, Semaphore};

use super::ask::Make;
use super::config::Config;
use super::meters;
use super::problem::Problem;
use crate::error::{Error, Kind, Warning};
use crate::job::Job;

/// What tells one prepared drawing from others: SHA-256 of the document and of all that is asked but its format.
pub type Key = [u8; 32];

/// A prepared drawing.
#[derive(Debug)]
pub struct Drawing {
    /// Ready to be swept.
    pub job: Job,
    /// What is worth saying about it.
    pub warnings: Vec<Warning>,
}

impl Drawing {
    /// About how many bytes it holds.
    fn weight(&self) -> u64 {
        const FEWEST: u64 = 64 << 10;
        FEWEST + self.job.weight()
    }
}

/// The drawings that are there.
pub struct Drawings {
    config: Arc<Config>,
    known: Mutex<Known>,
    preparing: Arc<Semaphore>,
    waiting: Arc<Semaphore>,
}

#[derive(Default)]
struct Known {
    slots: HashMap<Key, Slot>,
    /// Counts requests: what was asked for longest ago goes first.
    now: u64,
}

struct Slot {
    asked: u64,
    /// Being prepared, or used somewhere.
    shared: Weak<OnceCell<Arc<Drawing>>>,
    /// Kept although it may not be used.
    kept: Option<Arc<OnceCell<Arc<Drawing>>>>,
}

/// A drawing that is used: as long as this lives others find it.
#[derive(Clone)]
pub struct Shared {
    /// The drawing.
    pub drawing: Arc<Drawing>,
    _cell: Arc<OnceCell<Arc<Drawing>>>,
}

/// A place among those who prepare, and one among those who wait for that.
struct Places {
    _waiting: OwnedSemaphorePermit,
    _preparing: OwnedSemaphorePermit,
}

impl Places {
    /// Works on another thread. It goes on when the client has gone, and counts until it ends.
    async fn work<T: Send + 'static>(self, work: impl FnOnce() -> Result<T, Problem> + Send + 'static) -> Result<T, Problem> {
        let done = tokio::task::spawn_blocking(move || {
            let _places = self;
            work()
        });
        done.await.map_err(Problem::internal)?
    }
}

impl Drawings {
    /// None yet.
    pub fn new(config: Arc<Config>) -> Drawings {
        Drawings {
            known: Mutex::default(),
            preparing: Arc::new(Semaphore::new(config.max_preparing)),
            waiting: Arc::new(Semaphore::new(config.max_waiting + config.max_preparing)),
            config,
        }
    }

    fn lock(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The drawing of that key, made if it is not there.
    ///
    /// # Errors
    /// What is wrong with the document or what is asked of it; too many wait.
    pub async fn get(&self, key: Key, make: Make) -> Result<Shared, Problem> {
        let cell = self.cell(key);
        let shared = match cell.get_or_try_init(|| self.prepare(make)).await {
            Ok(drawing) => Ok(Shared { drawing: drawing.clone(), _cell: cell }),
            Err(problem) => {
                // Nothing of what failed stays.
                drop(cell);
                Err(problem)
            }
        };
        self.trim();
        shared
    }

    fn cell(&self, key: Key) -> Arc<OnceCell<Arc<Drawing>>> {
        let known = &mut *self.lock();
        known.now += 1;
        let slot = known.slots.entry(key).or_insert_with(|| Slot { asked: 0, shared: Weak::new(), kept: None });
        slot.asked = known.now;
        let cell = slot.shared.upgrade().unwrap_or_default();
        slot.shared = Arc::downgrade(&cell);
        slot.kept = Some(cell.clone());
        cell
    }

    async fn prepare(&self, make: Make) -> Result<Arc<Drawing>, Problem> {
        let places = self.places().await?;
        if self.weight() > self.config.max_drawings {
            return Err(Problem::busy("drawings", "the drawings being read fill the memory that is theirs: try again later", 10));
        }
        let config = self.config.clone();
        places.work(move || prepare(&config, make)).await.map(Arc::new)
    }

    /// Has something done with a document, when there is a place among those who prepare.
    ///
    /// # Errors
    /// Those of the work; too many wait.
    pub async fn work<T: Send + 'static>(&self, work: impl FnOnce(&Config) -> Result<T, Problem> + Send + 'static) -> Result<T, Problem> {
        let (places, config) = (self.places().await?, self.config.clone());
        places.work(move || work(&config)).await
    }

    async fn places(&self) -> Result<Places, Problem> {
        let busy = || Problem::busy("preparations", "too many drawings wait to be prepared: try again later", 2);
        let _waiting = self.waiting.clone().try_acquire_owned().map_err(|_| busy())?;
        let _waits = meters::Waits::new("preparations");
        let _preparing = self.preparing.clone().acquire_owned().await.map_err(Problem::internal)?;
        Ok(Places { _waiting, _preparing })
    }

    /// What all drawings weigh that are there.
    fn weight(&self) -> u64 {
        let cells: Vec<_> = self.lock().slots.values().filter_map(|slot| slot.shared.upgrade()).collect();
        cells.iter().filter_map(|cell| cell.get()).map(|drawing| drawing.weight()).sum()
    }

    /// Lets go of what is kept past the limit, longest unused first.
    fn trim(&self) {
        let known = &mut *self.lock();
        let mut kept: Vec<(u64, Key, u64)> = Vec::new();
        let mut all = 0;
        for (key, slot) in &mut known.slots {
            let drawing = slot.shared.upgrade();
            let weight = drawing.as_ref().and_then(|cell| cell.get()).map(|drawing| drawing.weight());
            all += weight.unwrap_or(0);
            if let (Some(weight), Some(_)) = (weight, &slot.kept) {
                kept.push((slot.asked, *key, weight));
            }
        }
        kept.sort_unstable();
        let mut sum: u64 = kept.iter().map(|kept| kept.2).sum();
        for (_, key, weight) in kept {
            if sum <= self.config.cache {
                break;
            }
            sum -= weight;
            if let Some(slot) = known.slots.get_mut(&key) {
                slot.kept = None;
            }
        }
        // What failed to be prepared is kept by nobody.
        known
            .slots
            .values_mut()
            .for_each(|slot| slot.kept = slot.kept.take().filter(|cell| cell.get().is_some() || Arc::strong_count(cell) > 1));
        known.slots.retain(|_, slot| slot.shared.strong_count() > 0);
        meters::level("runset_drawings_bytes", all as usize);
    }
}

fn prepare(config: &Config, make: Make) -> Result<Drawing, Problem> {
    let (job, warnings) = make(config)?;
    let header = job.header();
    let pixels = u64::from(header.width) * u64::from(header.height());
    if pixels > config.max_pixels {
        let what =
            format!("the raster would have {pixels} pixels: at most {} are allowed here, so ask for a smaller size", config.max_pixels);
        return Err(Error::input(Kind::Limit, what).into());
    }
    Ok(Drawing { job, warnings })
}
