//! A print on its way: the printer is asked, the drawing prepared for it, sent through the service's own places for bands, and followed.

use std::io;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use http_body_util::BodyExt as _;
use jiff::Timestamp;
use sha2::{Digest as _, Sha256};
use tokio::sync::OwnedSemaphorePermit;
use tokio_util::sync::CancellationToken;

use super::super::cache::{Key, Shared};
use super::super::drawings::Drawing;
use super::super::jobs::Live;
use super::super::params::Params;
use super::super::raster::{Follow, Raster};
use super::super::{Service, ask as asking, meters};
use super::{Print, PrintState, Stored};
use crate::job::{Job, Options, Stream};
use crate::print::body::Body;
use crate::print::choice::{self, Choice};
use crate::print::{self, Address, Client, Document, Errand, Failure, Limits, Stage, Status, Watch, Why, sheet};

/// Prints in the background.
pub fn begin(service: Service, live: Arc<Live>, stored: Stored, cancelled: CancellationToken, place: OwnedSemaphorePermit) {
    tokio::spawn(async move {
        let _place = place;
        let ended = see_through(&service, &live, stored, &cancelled).await;
        live.end_print(|print| {
            print.finished = Some(Timestamp::now());
            match &ended {
                Ok(status) => {
                    print.state = PrintState::Printed;
                    print.impressions = status.impressions;
                    print.told = Some(status.told());
                }
                Err(failure) => {
                    print.state = if failure.why == Why::Cancelled { PrintState::Cancelled } else { PrintState::Failed };
                    print.error = Some(failure.what.clone());
                }
            }
        });
        match &ended {
            Ok(_) => tracing::info!("the job {} is printed", live.id),
            Err(failure) => tracing::warn!("the job {} is not printed: {failure}", live.id),
        }
        meters::printed(if ended.is_ok() { "printed" } else { "failed" });
        // Stored at once where that is possible; else within a second, as all that changes.
        let _ = service.jobs.store_now(&live).await;
    });
}

/// Takes up the prints that were under way when the service ended.
pub async fn resume(service: Service) {
    for (live, stored) in service.jobs.printing() {
        let Ok(place) = service.prints.clone().acquire_owned().await else { return };
        let cancelled = live.canceller.begin();
        begin(service.clone(), live, stored, cancelled, place);
    }
}

/// Waits until no document is on its way to a printer.
pub async fn settle(service: &Service) {
    while service.jobs.printing().iter().any(|(_, stored)| matches!(stored.stage, Stage::Sending(_))) {
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
}

async fn see_through(service: &Service, live: &Arc<Live>, stored: Stored, cancelled: &CancellationToken) -> Result<Status, Failure> {
    let named = stored.request.printer.clone().unwrap_or_default();
    let address = Address::parse(&named).map_err(|what| Failure::new(Why::Wish, what))?;
    let Some(address) = service.config.printers.iter().find(|printer| **printer == address).cloned() else {
        return Err(Failure::new(
            Why::Wish,
            format!("{named}: this service does not print on it any more: --printer names those that it does"),
        ));
    };
    live.change(|now| now.print(|print| show(print, &stored.stage)));
    let config = &service.config;
    let limits = Limits { wait: config.print_wait, follow: config.print_follow, spool: config.max_spool, ..Limits::default() };
    let client = Client::new(address, limits);
    let mut watch = Watcher { service, live };
    let mut document = Drawn { service, live, cancelled, choice: None, shared: None };
    let errand = match &stored.stage {
        // Nothing is left to be sent.
        Stage::Sent(_) => Errand { title: String::new(), format: "", attributes: Vec::new(), pages: 1, spool: false },
        _ => {
            let prepared = async {
                let printer = print::ask(&client, |why| watch.waits(&why.what)).await?;
                document.prepare(&stored, &printer).await
            };
            let choice = tokio::select! {
                choice = prepared => choice?,
                () = cancelled.cancelled() => return Err(cancel_early(&client, &stored.stage).await),
            };
            live.change(|now| now.print(|print| print.choice = Some(choice.line())));
            Errand {
                title: format!("runset {}", live.id),
                format: choice.format.media_type,
                attributes: choice.attributes,
                pages: 1,
                spool: false,
            }
        }
    };
    print::run(&client, &errand, &mut document, stored.stage, &mut watch, cancelled).await.map(|printed| printed.status)
}

/// Cancels what an earlier process has begun, and this one has not taken up yet.
async fn cancel_early(client: &Client, stage: &Stage) -> Failure {
    let Some(address) = stage.job().and_then(|job| Address::parse(&job.uri).ok()) else {
        return Failure::new(Why::Cancelled, "cancelled: nothing was sent");
    };
    match print::cancel(client, &address).await {
        Ok(()) => Failure::new(Why::Cancelled, "cancelled at the printer"),
        Err(failure) => Failure::new(Why::Cancelled, format!("cancelled here, but not at the printer: {failure}")),
    }
}

/// The drawing of a job, on a sheet.
struct Drawn<'s> {
    service: &'s Service,
    live: &'s Arc<Live>,
    cancelled: &'s CancellationToken,
    choice: Option<Choice>,
    shared: Option<Shared<Drawing>>,
}

impl Drawn<'_> {
    /// Reads and prepares it for a printer, once.
    async fn prepare(&mut self, stored: &Stored, printer: &print::Printer) -> Result<Choice, Failure> {
        let failed = |what: &str| Failure::new(Why::Raster, what.to_owned());
        let wishes = stored.request.wishes().map_err(|problem| failed(problem.detail()))?;
        let Params::Fill(params) = self.live.params.clone() else { return Err(failed("only drawings are printed")) };
        let asked = params.options().map_err(|problem| failed(problem.detail()))?;
        let bleed = stored.request.bleed.unwrap_or(0.0) * 100.0;
        let path = self.service.jobs.document(&self.live.id);
        let (chosen, refused) = (Arc::new(Mutex::new(None)), Arc::new(Mutex::new(None)));
        let (told, refuses, printer) = (chosen.clone(), refused.clone(), printer.clone());
        let make = Box::new(move |config: &super::super::Config| {
            let bytes = std::fs::read(path).map_err(|error| super::super::problem::Problem::storing(&error))?;
            let (mut scene, mut warnings) = asking::scene(config, bytes)?;
            let inks = sheet::pixels(&scene, asked.expr.as_deref());
            let choice = choice::choose(&printer, &wishes, sheet::size(&scene), inks);
            let choice = choice.and_then(|choice| match choice.repeats {
                1 => Ok(choice),
                n => Err(Failure::new(Why::Wish, format!("the printer makes fewer than {n} copies of a document: print it as often"))),
            });
            let choice = match choice {
                Ok(choice) => choice,
                Err(failure) => {
                    let problem = super::super::problem::Problem::malformed(failure.what.clone());
                    *refuses.lock().unwrap_or_else(PoisonError::into_inner) = Some(failure);
                    return Err(problem);
                }
            };
            let options = sheet::compose(&mut scene, asked.expr.as_deref(), bleed, &choice.sheet, &config.limits, &mut warnings)?;
            let job = Job::prepare(scene, &Options { tolerance: asked.tolerance, ..options }, &mut warnings)?;
            choice.format.check(job.header())?;
            *told.lock().unwrap_or_else(PoisonError::into_inner) = Some(choice);
            Ok((job, warnings))
        });
        // Of its own: what the printer can belongs to it.
        let key: Key = Sha256::new().chain_update(self.live.key).chain_update(uuid::Uuid::now_v7()).finalize().into();
        let made = self.service.drawings.get(key, make).await;
        if let Some(failure) = refused.lock().unwrap_or_else(PoisonError::into_inner).take() {
            return Err(failure);
        }
        self.shared = Some(made.map_err(|problem| failed(problem.detail()))?);
        let choice = chosen.lock().unwrap_or_else(PoisonError::into_inner).take().ok_or_else(|| failed("the drawing was not prepared"))?;
        self.choice = Some(choice.clone());
        Ok(choice)
    }
}

impl Document for Drawn<'_> {
    async fn open(&mut self, _length: bool) -> Result<Body, Failure> {
        let (Some(shared), Some(choice)) = (&self.shared, &self.choice) else {
            return Err(Failure::new(Why::Raster, "the drawing was not prepared"));
        };
        let place = self.service.streams.clone().acquire_owned().await;
        let place = place.map_err(|error| Failure::new(Why::Raster, error.to_string()))?;
        meters::render("fill", choice.format.name);
        let stream = shared.thing.job.stream(choice.format);
        let follow = Following { live: self.live.clone(), cancelled: self.cancelled.clone() };
        let raster = Raster::new(self.service.clone(), shared.clone(), stream, place, None).followed(Arc::new(follow));
        Ok(Body::pulled(raster.into_body().map_err(io::Error::other)))
    }
}

/// Ends a raster whose job is gone, or whose print is cancelled.
struct Following {
    live: Arc<Live>,
    cancelled: CancellationToken,
}

impl Follow for Following {
    fn made(&self, _stream: &Stream) {}

    fn handed(&self, _offset: u64, _lines: u32) {}

    fn stop(&self) -> bool {
        self.cancelled.is_cancelled() || self.live.deleted.load(Ordering::Relaxed)
    }
}

/// Shows the stage that a print has come to.
fn show(print: &mut Print, stage: &Stage) {
    print.state = match stage {
        Stage::New | Stage::Created(_) => PrintState::Waiting,
        Stage::Sending(_) => PrintState::Sending,
        Stage::Sent(_) => PrintState::Printing,
    };
    print.job = stage.job().map(|job| job.uri.clone());
    print.told = None;
}

/// Keeps what is known of a print.
struct Watcher<'s> {
    service: &'s Service,
    live: &'s Arc<Live>,
}

impl Watch for Watcher<'_> {
    async fn reached(&mut self, stage: &Stage) -> Result<(), Failure> {
        if matches!(stage, Stage::Sending(_)) && self.service.ending.is_cancelled() {
            // A service that ends sends nothing any more: the next one does.
            std::future::pending::<()>().await;
        }
        self.live.change(|now| now.errand.iter_mut().for_each(|errand| errand.stage = stage.clone()));
        let kept = self.service.jobs.store_now(self.live).await;
        kept.map_err(|problem| Failure::new(Why::Kept, format!("what is known of the print cannot be stored: {}", problem.detail())))?;
        // Nobody is told of a stage that a restart would not know.
        self.live.change(|now| now.print(|print| show(print, stage)));
        Ok(())
    }

    fn waits(&mut self, why: &str) {
        self.live.change(|now| now.print(|print| print.told = Some(why.to_owned())));
    }

    fn sent(&mut self, bytes: u64) {
        self.live.change(|now| now.print(|print| print.sent = bytes));
    }

    fn prints(&mut self, status: &Status) {
        let told = Some(status.told());
        let known = |print: &Print| print.told == told && print.impressions == status.impressions;
        if self.live.view().print().is_some_and(known) {
            return;
        }
        self.live.change(|now| {
            now.print(|print| {
                print.told.clone_from(&told);
                print.impressions = status.impressions;
            });
        });
    }
}
