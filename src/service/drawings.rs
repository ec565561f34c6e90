//! Prepared drawings, shared by all who read them: the edges are there once, whoever waits for them waits for one preparation.
//!
//! Some that nobody reads are kept for the next request. Their keys are SHA-256 of the document and of all that is asked but its format. How many there are is bounded by what they weigh: those in use together
//! ([`Config::max_drawings`]), and those that are only kept ([`Config::cache`]).

use std::sync::Arc;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use super::ask::Make;
use super::cache::{Cache, Key, Shared, Weigh};
use super::config::Config;
use super::meters;
use super::problem::Problem;
use crate::error::{Error, Kind, Warning};
use crate::job::Job;
use crate::run::Header;

/// A prepared drawing.
#[derive(Debug)]
pub struct Drawing {
    /// Ready to be swept.
    pub job: Job,
    /// What is worth saying about it.
    pub warnings: Vec<Warning>,
}

impl Weigh for Drawing {
    fn weight(&self) -> u64 {
        const FEWEST: u64 = 64 << 10;
        FEWEST + self.job.weight()
    }
}

/// The drawings that are there.
pub struct Drawings {
    config: Arc<Config>,
    cache: Cache<Drawing>,
    preparing: Arc<Semaphore>,
    waiting: Arc<Semaphore>,
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
            cache: Cache::default(),
            preparing: Arc::new(Semaphore::new(config.max_preparing)),
            waiting: Arc::new(Semaphore::new(config.max_waiting + config.max_preparing)),
            config,
        }
    }

    /// The drawing of that key, made if it is not there.
    ///
    /// # Errors
    /// What is wrong with the document or what is asked of it; too many wait.
    pub async fn get(&self, key: Key, make: Make) -> Result<Shared<Drawing>, Problem> {
        let shared = self.cache.get(key, self.config.cache, async || self.prepare(make).await).await;
        meters::level("runset_drawings_bytes", self.cache.weight() as usize);
        shared
    }

    async fn prepare(&self, make: Make) -> Result<Drawing, Problem> {
        let places = self.places().await?;
        if self.cache.weight() > self.config.max_drawings {
            return Err(Problem::busy("drawings", "the drawings being read fill the memory that is theirs: try again later", 10));
        }
        let config = self.config.clone();
        places.work(move || prepare(&config, make)).await
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
}

fn prepare(config: &Config, make: Make) -> Result<Drawing, Problem> {
    let (job, warnings) = make(config)?;
    bounded(config, job.header())?;
    Ok(Drawing { job, warnings })
}

/// Refuses a raster that is too large.
///
/// # Errors
/// More pixels than are allowed.
pub fn bounded(config: &Config, header: &Header) -> Result<(), Problem> {
    let pixels = u64::from(header.width) * u64::from(header.height());
    if pixels > config.max_pixels {
        let what =
            format!("the raster would have {pixels} pixels: at most {} are allowed here, so ask for a smaller size", config.max_pixels);
        return Err(Error::input(Kind::Limit, what).into());
    }
    Ok(())
}
