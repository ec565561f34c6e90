//! A job as it is in memory, as it is shown, and as it is stored.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use tokio::sync::watch;
use utoipa::ToSchema;

use super::super::Service;
use super::super::cache::{Key, Shared};
use super::super::drawings::Drawing;
use super::super::params::{Kind, Params};
use super::super::printing::{Canceller, Print, Stored};
use super::super::problem::Problem;
use super::super::raster::Follow;
use super::store::Row;
use super::trail::Trail;
use crate::encode::Format;
use crate::job::Stream;

/// How a job is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Phase {
    /// Stored, and read by nobody at the moment.
    Ready,
    /// Being read.
    Reading,
    /// Its raster was handed to a reader up to the last byte.
    Done,
    /// Its document cannot be rendered any more.
    Failed,
    /// Deleted.
    Cancelled,
}

/// When a job came into a state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Change {
    /// The state.
    pub(super) state: Phase,
    /// When, in UTC (RFC 3339).
    #[schema(value_type = String, format = DateTime)]
    pub(super) at: Timestamp,
}

/// A job as it is shown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Job)]
pub struct View {
    /// Its id; later jobs have greater ones.
    pub(super) id: String,
    /// What is made of its document.
    pub(super) kind: Kind,
    /// How it is.
    pub(super) state: Phase,
    /// Name of the raster's format.
    pub(super) format: String,
    /// Width of the raster in pixels.
    pub(super) width: u32,
    /// Height of the raster in pixels.
    pub(super) height: u32,
    /// Its scanlines.
    pub(super) lines: u32,
    /// Scanlines that were handed to a reader, at least in part.
    pub(super) lines_delivered: u32,
    /// Length of the raster in bytes, once it is known.
    pub(super) bytes: Option<u64>,
    /// When it was accepted, in UTC (RFC 3339).
    #[schema(value_type = String, format = DateTime)]
    pub(super) created: Timestamp,
    /// When its last byte was first handed to a reader, or when it failed.
    #[schema(value_type = Option<String>, format = DateTime)]
    pub(super) finished: Option<Timestamp>,
    /// Why it failed.
    pub(super) error: Option<String>,
    /// What is drawn but not supported.
    pub(super) warnings: Vec<String>,
    /// The states that it was in, the last few of them.
    pub(super) history: Vec<Change>,
    /// Its last print.
    #[serde(default)]
    pub(super) print: Option<Print>,
}

impl View {
    /// How it is.
    pub fn state(&self) -> Phase {
        self.state
    }

    /// What is made of its document.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Its last print.
    pub fn print(&self) -> Option<&Print> {
        self.print.as_ref()
    }
}

/// States that are remembered.
const HISTORY: usize = 32;

/// A job as it is stored.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Record {
    #[serde(flatten)]
    pub(super) view: View,
    pub(super) params: Params,
    /// What tells its drawing from others.
    pub(super) key: Key,
    /// Bytes of the document.
    pub(super) size: u64,
    /// The raster's tag: another one means other bytes.
    pub(super) tag: String,
    pub(super) idempotency_key: Option<String>,
    /// When it was made or read last.
    pub(super) used: Timestamp,
    /// What its print needs to go on.
    #[serde(default)]
    pub(super) errand: Option<Stored>,
}

/// A job.
pub struct Live {
    pub(in super::super) id: String,
    pub(in super::super) key: Key,
    pub(in super::super) params: Params,
    pub(super) format: &'static Format,
    pub(super) size: u64,
    pub(super) tag: String,
    pub(super) idempotency_key: Option<String>,
    pub(super) now: Mutex<Now>,
    pub(super) readers: AtomicUsize,
    pub(in super::super) deleted: AtomicBool,
    pub(in super::super) canceller: Canceller,
    /// Whether the store knows less.
    pub(super) dirty: AtomicBool,
    /// Counts changes, for those who follow.
    pub(super) changes: watch::Sender<()>,
}

/// What changes of a job.
pub(in super::super) struct Now {
    pub(super) view: View,
    pub(super) trail: Trail,
    pub(super) used: Timestamp,
    pub(in super::super) errand: Option<Stored>,
}

impl Now {
    /// Changes its print.
    pub(in super::super) fn print(&mut self, how: impl FnOnce(&mut Print)) {
        self.view.print.as_mut().map(how);
    }
}

impl Live {
    pub(super) fn new(record: Record, format: &'static Format, trail: Trail) -> Live {
        let Record { view, params, key, size, tag, idempotency_key, used, errand } = record;
        Live {
            id: view.id.clone(),
            key,
            params,
            format,
            size,
            tag,
            idempotency_key,
            now: Mutex::new(Now { view, trail, used, errand }),
            readers: AtomicUsize::new(0),
            deleted: AtomicBool::new(false),
            canceller: Canceller::default(),
            dirty: AtomicBool::new(false),
            changes: watch::Sender::new(()),
        }
    }

    pub(super) fn now(&self) -> MutexGuard<'_, Now> {
        self.now.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// As it is shown.
    pub fn view(&self) -> View {
        self.now().view.clone()
    }

    pub(super) fn row(&self) -> Row {
        let now = self.now();
        let record = Record {
            view: now.view.clone(),
            params: self.params.clone(),
            key: self.key,
            size: self.size,
            tag: self.tag.clone(),
            idempotency_key: self.idempotency_key.clone(),
            used: now.used,
            errand: now.errand.clone(),
        };
        let record = serde_json::to_string(&record).expect("numbers and strings under fixed names are JSON");
        Row { id: self.id.clone(), record, trail: now.trail.to_bytes() }
    }

    /// Changes it, and tells those who follow.
    pub(in super::super) fn change(&self, how: impl FnOnce(&mut Now)) {
        how(&mut self.now());
        self.dirty.store(true, Ordering::Release);
        self.changes.send_replace(());
    }

    /// Begins a print, unless there is one under way.
    pub fn begin_print(&self, print: Print, errand: Stored) -> bool {
        let mut now = self.now();
        if now.errand.is_some() {
            return false;
        }
        now.used = Timestamp::now();
        (now.view.print, now.errand) = (Some(print), Some(errand));
        drop(now);
        self.change(|_| {});
        true
    }

    /// A print has ended.
    pub fn end_print(&self, how: impl FnOnce(&mut Print)) {
        self.change(|now| {
            now.errand = None;
            now.used = Timestamp::now();
            now.print(how);
        });
    }

    /// Forgets a print that has ended.
    pub fn forget_print(&self) {
        self.change(|now| {
            if now.errand.is_none() {
                now.view.print = None;
            }
        });
    }

    pub(super) fn enter(now: &mut Now, state: Phase) {
        if now.view.state != state {
            now.view.state = state;
            now.view.history.push(Change { state, at: Timestamp::now() });
            let old = now.view.history.len().saturating_sub(HISTORY);
            // The first stays: it tells when the job was accepted.
            now.view.history.drain(1.min(old)..old + 1.min(old));
        }
    }

    pub(super) fn fail(&self, why: &str) {
        self.change(|now| {
            Live::enter(now, Phase::Failed);
            now.view.finished = Some(Timestamp::now());
            now.view.error = Some(why.to_owned());
        });
    }

    /// Its drawing, prepared.
    pub(super) async fn drawing(&self, service: &Service) -> Result<Shared<Drawing>, Problem> {
        let path = service.jobs.store.document(&self.id);
        let drawing = service.drawings.get(self.key, self.params.ask()?.of(Box::new(move || std::fs::read(path)))).await;
        // Its document may have been deleted in between.
        drawing.map_err(|problem| service.jobs.find(&self.id).err().unwrap_or(problem))
    }

    /// A reader comes.
    pub(super) fn read(self: &Arc<Live>) -> Reading {
        self.readers.fetch_add(1, Ordering::AcqRel);
        self.change(|now| {
            now.used = Timestamp::now();
            if now.view.state == Phase::Ready {
                Live::enter(now, Phase::Reading);
            }
        });
        Reading(self.clone())
    }

    /// Notes where its raster can be taken up again, and its length and its table once they are known.
    pub(super) fn note(&self, stream: &Stream) {
        let mut now = self.now();
        if now.view.bytes.is_none() {
            now.trail.add(stream.checkpoint());
            self.dirty.store(true, Ordering::Release);
            if let Some(length) = stream.length() {
                now.view.bytes = Some(length);
                now.trail.table = stream.table();
                drop(now);
                self.changes.send_replace(());
            }
        }
    }
}

/// A job that is being read, as long as this lives.
pub struct Reading(Arc<Live>);

impl Follow for Reading {
    fn made(&self, stream: &Stream) {
        self.0.note(stream);
    }

    fn handed(&self, offset: u64, lines: u32) {
        self.0.change(|now| {
            now.view.lines_delivered = now.view.lines_delivered.max(lines);
            if now.view.bytes == Some(offset) && now.view.state != Phase::Done {
                Live::enter(now, Phase::Done);
                now.view.finished = Some(Timestamp::now());
            }
        });
    }

    fn stop(&self) -> bool {
        self.0.deleted.load(Ordering::Relaxed)
    }
}

impl Drop for Reading {
    fn drop(&mut self) {
        let last = self.0.readers.fetch_sub(1, Ordering::AcqRel) == 1;
        self.0.change(|now| {
            now.used = Timestamp::now();
            if last && now.view.state == Phase::Reading {
                Live::enter(now, Phase::Ready);
            }
        });
    }
}
