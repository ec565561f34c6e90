//! Lengths of rasters that their format does not fix: made once, behind acceptance, and thrown away.

use std::collections::HashSet;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use super::super::Service;
use super::super::raster::{Follow, exhaust};
use super::live::{Live, Phase};
use super::raster;
use super::trail::Trail;
use crate::job::Stream;

/// Follows a raster that is made to be measured.
struct Measuring<'s> {
    live: &'s Live,
    service: &'s Service,
}

impl Follow for Measuring<'_> {
    fn made(&self, stream: &Stream) {
        self.live.note(stream);
    }

    fn handed(&self, _offset: u64, _lines: u32) {}

    fn stop(&self) -> bool {
        // A reader may have come to the end first.
        self.live.deleted.load(Ordering::Relaxed) || self.service.ending.is_cancelled() || self.live.now().view.bytes.is_some()
    }
}

/// Measures rasters whose length is not known, oldest first, some at a time, until the service ends.
pub async fn measure(service: Service) {
    let mut under_way = tokio::task::JoinSet::new();
    let mut measured: HashSet<String> = HashSet::new();
    loop {
        while let Some(result) = under_way.try_join_next() {
            measured.remove(&result.unwrap_or_default());
        }
        if service.ending.is_cancelled() {
            break;
        }
        let unknown = |live: &Arc<Live>| live.now().view.bytes.is_none() && live.now().view.state != Phase::Failed;
        let waiting = service.jobs.lives().into_iter().filter(|live| !measured.contains(&live.id) && unknown(live));
        for live in waiting.take(service.config.max_bands.saturating_sub(measured.len())).collect::<Vec<_>>() {
            measured.insert(live.id.clone());
            let service = service.clone();
            under_way.spawn(async move {
                measure_one(&service, &live).await;
                live.id.clone()
            });
        }
        tokio::select! {
            Some(result) = under_way.join_next() => { measured.remove(&result.unwrap_or_default()); }
            () = service.jobs.unmeasured.notified() => {}
            () = service.ending.cancelled() => {}
        }
    }
    while under_way.join_next().await.is_some() {}
}

async fn measure_one(service: &Service, live: &Arc<Live>) {
    let drawing = match live.drawing(service).await {
        Ok(drawing) => drawing,
        Err(_) if live.deleted.load(Ordering::Relaxed) => return,
        Err(problem) if problem.is_passing() => return tokio::time::sleep(Duration::from_secs(1)).await,
        Err(problem) => return live.fail(problem.detail()),
    };
    let job = &drawing.thing.job;
    if let Some(length) = job.length(live.format) {
        return live.change(|now| now.view.bytes = Some(length));
    }
    let from = live.now().trail.before(u64::MAX);
    let Some(stream) = raster::stream(job, live.format, from) else {
        // Checkpoints of another raster: they are of no use.
        return live.change(|now| now.trail = Trail::default());
    };
    if let Err(what) = exhaust(service, stream, &Measuring { live, service }).await {
        live.fail(&what);
    }
}
