//! Jobs: documents that are kept with what is asked of them, and rasters that are made of them whenever somebody reads.
//!
//! ```text
//!   ready --read--> reading --to the last byte--> done          a reader that breaks off leaves it ready; it may be read again at any byte,
//!     \--its document cannot be rendered--> failed               also when it is done
//!   any --DELETE--> cancelled, and forgotten
//! ```
//!
//! All jobs are in memory ([`Live`]), and in the store before anybody is told that they are accepted. What changes later (lines delivered,
//! lengths, checkpoints) is stored a second later at most: losing it costs work, and no bytes.

pub mod events;
mod live;
mod measure;
pub mod raster;
mod store;
mod trail;

use std::collections::BTreeMap;
use std::io;
use std::sync::atomic::Ordering;
use std::sync::{Arc, PoisonError, RwLock};
use std::time::Duration;

use axum::Json;
use axum::body::Body;
use axum::extract::{FromRequestParts, Path, RawQuery, State};
use axum::http::header::LOCATION;
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use tokio::sync::Notify;
use utoipa::{IntoParams, ToSchema};

pub use self::measure::measure;

pub use self::live::{Live, Phase};

use self::live::{Change, Record, View};
use self::store::{Row, Store};
use self::trail::Trail;
use super::cache::Key;
use super::config::Config;
use super::params::{self, FillParams, Kind, Params, SolidParams};
use super::printing::Stored;
use super::problem::{Details, Problem};
use super::{Service, answer, meters};
use crate::encode;

/// The client's key of a request that may be sent again.
const IDEMPOTENCY_KEY: HeaderName = HeaderName::from_static("idempotency-key");

/// Said when the answer is that to an earlier request with the same key.
const REPLAYED: HeaderName = HeaderName::from_static("idempotent-replayed");

/// Jobs of a page of the list, unless it is asked for another number.
const PAGE: usize = 100;

/// The jobs of a service.
pub struct Jobs {
    store: Store,
    all: RwLock<BTreeMap<String, Arc<Live>>>,
    /// There may be something to measure.
    unmeasured: Notify,
}

impl Jobs {
    /// The jobs that a folder holds.
    ///
    /// # Errors
    /// It cannot be used.
    pub fn open(config: &Config) -> io::Result<Jobs> {
        let store = Store::open(&config.data)?;
        let mut all = BTreeMap::new();
        for row in store.all()? {
            let record: Record = match serde_json::from_str(&row.record) {
                Ok(record) => record,
                Err(error) => {
                    tracing::error!("the job {} cannot be read and is left alone: {error}", row.id);
                    continue;
                }
            };
            let compressed = |format: &'static encode::Format| format.compressed(record.params.compression()).ok();
            let Some(format) = encode::by_name(&record.view.format).and_then(compressed) else {
                tracing::error!("the job {} has a format or a compression that is not known: {}", row.id, record.view.format);
                continue;
            };
            let tag = answer::tag(&record.key, &config.fonts, format);
            let same = tag == record.tag;
            let trail = if same { Trail::from_bytes(&row.trail) } else { Trail::default() };
            let live = Live::new(Record { tag, ..record }, format, trail);
            live.change(|now| {
                if !same {
                    // Another version makes other bytes: what was measured is not theirs.
                    now.view.bytes = None;
                }
                if now.view.state == Phase::Reading {
                    Live::enter(now, Phase::Ready);
                }
            });
            if !store.document(&row.id).exists() && live.view().state != Phase::Failed {
                live.fail("its document is lost");
            }
            all.insert(row.id, Arc::new(live));
        }
        meters::level("runset_jobs", all.len());
        Ok(Jobs { store, all: RwLock::new(all), unmeasured: Notify::new() })
    }

    /// The job of an id.
    pub(super) fn find(&self, id: &str) -> Result<Arc<Live>, Problem> {
        self.all.read().unwrap_or_else(PoisonError::into_inner).get(id).cloned().ok_or_else(Problem::no_job)
    }

    fn lives(&self) -> Vec<Arc<Live>> {
        self.all.read().unwrap_or_else(PoisonError::into_inner).values().cloned().collect()
    }

    /// Stores a job. If the client's key has one already, that one is given.
    fn accept(&self, config: &Config, live: Live, document: &[u8]) -> Result<(Arc<Live>, bool), Problem> {
        let live = Arc::new(live);
        // What is there already takes no room: looked up before others are forgotten for it.
        let known = live.idempotency_key.as_deref().map(|key| self.store.job_of(key)).transpose();
        let known = known.map_err(|error| Problem::storing(&error))?.flatten().and_then(|id| self.find(&id).ok());
        if let Some(known) = known {
            return Ok((known, true));
        }
        self.clean(config, live.size.max(1))?;
        self.store.write_document(&live.id, document).map_err(|error| Problem::storing(&error))?;
        // Others see a key in the store and its job here at the same time.
        let mut all = self.all.write().unwrap_or_else(PoisonError::into_inner);
        let added = self.store.add(&live.row(), live.idempotency_key.as_deref());
        if !matches!(added, Ok(None)) {
            self.store.remove_document(&live.id);
        }
        if let Some(known) = added.map_err(|error| Problem::storing(&error))? {
            return all.get(&known).map(|known| (known.clone(), true)).ok_or_else(|| Problem::internal("a key whose job is not there"));
        }
        all.insert(live.id.clone(), live.clone());
        meters::level("runset_jobs", all.len());
        drop(all);
        self.unmeasured.notify_one();
        Ok((live, false))
    }

    /// Forgets a job.
    fn forget(&self, live: &Live) -> io::Result<()> {
        let mut all = self.all.write().unwrap_or_else(PoisonError::into_inner);
        self.store.remove(&live.id)?;
        all.remove(&live.id);
        meters::level("runset_jobs", all.len());
        live.deleted.store(true, Ordering::Relaxed);
        live.canceller.cancel();
        drop(all);
        live.change(|now| Live::enter(now, Phase::Cancelled));
        Ok(())
    }

    /// Stores what the store does not know.
    fn save(&self) {
        let changed: Vec<_> = self.lives().into_iter().filter(|live| live.dirty.swap(false, Ordering::AcqRel)).collect();
        if changed.is_empty() {
            return;
        }
        let rows: Vec<Row> = changed.iter().map(|live| live.row()).collect();
        if let Err(error) = self.store.save(&rows) {
            tracing::error!("what is known of {} jobs cannot be stored: {error}", rows.len());
            changed.iter().for_each(|live| live.dirty.store(true, Ordering::Release));
        }
    }

    /// Forgets jobs past their age, and the oldest that are done where all are too many or too large with another of `room` bytes.
    fn clean(&self, config: &Config, room: u64) -> Result<(), Problem> {
        let mut lives = self.lives();
        let idle = |live: &Live| live.readers.load(Ordering::Acquire) == 0 && live.now().errand.is_none();
        let old = Timestamp::now() - jiff::SignedDuration::try_from(config.keep).unwrap_or(jiff::SignedDuration::MAX / 4);
        let forget = |live: &Live, why: &str| match self.forget(live) {
            Ok(()) => {
                tracing::info!("the job {} is forgotten: {why}", live.id);
                true
            }
            Err(error) => {
                tracing::error!("the job {} cannot be forgotten: {error}", live.id);
                false
            }
        };
        lives.retain(|live| !(idle(live) && live.now().used < old && forget(live, "nobody has used it for long")));
        let (mut count, mut bytes) = (lives.len(), lives.iter().map(|live| live.size).sum::<u64>());
        let more = usize::from(room > 0);
        let ended = |live: &Live| matches!(live.now().view.state, Phase::Done | Phase::Failed);
        for live in lives.iter().filter(|live| idle(live) && ended(live)) {
            if count + more <= config.max_jobs && bytes + room <= config.max_store {
                break;
            }
            if forget(live, "the store is full, and it is done") {
                (count, bytes) = (count - 1, bytes - live.size);
            }
        }
        if count + more > config.max_jobs || bytes + room > config.max_store {
            meters::refused("store");
            let what = "the store is full of jobs that are not done: read or delete some";
            return Err(Problem::new(StatusCode::INSUFFICIENT_STORAGE, "store-full", what));
        }
        Ok(())
    }

    /// Where the document of a job is.
    pub fn document(&self, id: &str) -> std::path::PathBuf {
        self.store.document(id)
    }

    /// The jobs whose print is under way, and what it needs to go on.
    pub fn printing(&self) -> Vec<(Arc<Live>, Stored)> {
        self.lives().into_iter().filter_map(|live| live.now().errand.clone().map(|errand| (live.clone(), errand))).collect()
    }

    /// Stores what is known of a job now, before anything else is done with it.
    ///
    /// # Errors
    /// It could not be stored.
    pub async fn store_now(self: &Arc<Jobs>, live: &Arc<Live>) -> Result<(), Problem> {
        let (jobs, row) = (self.clone(), live.row());
        let stored = tokio::task::spawn_blocking(move || jobs.store.save(&[row])).await;
        stored.map_err(Problem::internal)?.map_err(|error| Problem::storing(&error))
    }

    /// Whether the store can be written.
    pub async fn writable(self: &Arc<Jobs>) -> bool {
        let jobs = self.clone();
        tokio::task::spawn_blocking(move || jobs.store.is_writable()).await.unwrap_or(false)
    }

    /// Stores all that is known.
    pub async fn save_all(self: &Arc<Jobs>) {
        let jobs = self.clone();
        let _ = tokio::task::spawn_blocking(move || jobs.save()).await;
    }
}

/// Stores what changes, and forgets what is old, for ever.
pub async fn keep(service: Service) {
    let mut tick = tokio::time::interval(Duration::from_secs(1));
    for second in 0_u64.. {
        tick.tick().await;
        let service = service.clone();
        let work = tokio::task::spawn_blocking(move || {
            service.jobs.save();
            meters::gather();
            if second.is_multiple_of(60) {
                // A store that is full all the same is told to the next who wants to add to it.
                let _ = service.jobs.clean(&service.config, 0);
            }
        });
        let _ = work.await;
    }
}

/// The list of jobs.
#[derive(Serialize, ToSchema)]
pub struct List {
    /// Oldest first.
    jobs: Vec<View>,
    /// What to give as `after` for the next page, if there is one.
    next: Option<String>,
}

/// What part of the list is wanted.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct ListParams {
    /// Only jobs behind this id
    after: Option<String>,
    /// How many at most
    #[param(minimum = 1, maximum = 1000)]
    limit: Option<usize>,
}

/// The jobs, oldest first
#[utoipa::path(
    get,
    path = "/v1/jobs",
    tag = "jobs",
    params(ListParams),
    responses(
        (status = 200, description = "A page of the list", body = List),
        (status = 400, description = "The query is malformed", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn list(State(service): State<Service>, RawQuery(query): RawQuery) -> Result<Json<List>, Problem> {
    let params: ListParams = params::read(&query.unwrap_or_default())?;
    let limit = params.limit.unwrap_or(PAGE);
    if !(1..=1000).contains(&limit) {
        return Err(Problem::malformed(format!("limit is {limit}: give a whole number from 1 to 1000")));
    }
    let all = service.jobs.all.read().unwrap_or_else(PoisonError::into_inner);
    let after = params.after.map_or(std::ops::Bound::Unbounded, std::ops::Bound::Excluded);
    let mut behind = all.range((after, std::ops::Bound::Unbounded)).map(|(_, live)| live);
    let jobs: Vec<View> = behind.by_ref().take(limit).map(|live| live.view()).collect();
    let next = behind.next().and(jobs.last()).map(|last| last.id.clone());
    Ok(Json(List { jobs, next }))
}

/// Store a document, and what is to be made of it
///
/// It is checked as by `POST /v1/fill` or, with `kind=solid`, by `POST /v1/solid`, whose parameters are then those that count, and stored durably before the answer. The same `Idempotency-Key` with the same request gives the same job; with another
/// request it is refused.
#[utoipa::path(
    post,
    path = "/v1/jobs",
    tag = "jobs",
    params(
        FillParams,
        SolidParams,
        ("kind" = inline(Option<Kind>), Query, description = "What is made of the document"),
        ("Idempotency-Key" = Option<String>, Header, description = "Names the request, so that it can be sent again"),
    ),
    request_body(description = "An SVG or a JSON scene, or a model, plain or gzipped", content((String = "image/svg+xml"), (serde_json::Value = "application/json"), (String = "text/plain"), (String = "model/stl"))),
    responses(
        (status = 201, description = "Accepted and stored", body = View, headers(("location" = String, description = "The job's address"))),
        (status = 400, description = "The query or the document is malformed", body = Details, content_type = "application/problem+json"),
        (status = 408, description = "The body stopped", body = Details, content_type = "application/problem+json"),
        (status = 413, description = "The document is too large", body = Details, content_type = "application/problem+json"),
        (status = 415, description = "Not a document that can be read", body = Details, content_type = "application/problem+json"),
        (status = 422, description = "Understood, and refused: names, references, limits, a key used before", body = Details, content_type = "application/problem+json"),
        (status = 503, description = "Busy: try again later", body = Details, content_type = "application/problem+json"),
        (status = 507, description = "The disk or the store is full", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn create(
    State(service): State<Service>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
    body: Body,
) -> Result<Response, Problem> {
    let params = Params::of_job(&query.unwrap_or_default())?;
    // The raster's format: what is accepted here is the answer's.
    let (format, ask) = (params.format(&HeaderMap::new())?, params.ask()?);
    let idempotency_key = headers.get(IDEMPOTENCY_KEY).map(idempotency_key).transpose()?;
    let document = service.uploads.read(&service.config, params.kind().documents(), &headers, body).await?;
    let (key, bytes) = (params.key(&document.digest), document.bytes.clone());
    let shared = service.drawings.get(key, ask.of(Box::new(move || Ok(bytes.into())))).await?;
    let header = shared.thing.job.header();
    format.check(header)?;
    let now = Timestamp::now();
    let view = View {
        id: uuid::Uuid::now_v7().simple().to_string(),
        kind: params.kind(),
        state: Phase::Ready,
        format: format.name.to_owned(),
        width: header.width,
        height: header.height(),
        lines: header.height(),
        lines_delivered: 0,
        bytes: shared.thing.job.length(format),
        created: now,
        finished: None,
        error: None,
        warnings: shared.thing.warnings.iter().map(answer::said).collect(),
        history: vec![Change { state: Phase::Ready, at: now }],
        print: None,
    };
    let tag = answer::tag(&key, &service.config.fonts, format);
    let record = Record { view, params, key, size: document.bytes.len() as u64, tag, idempotency_key, used: now, errand: None };
    let accepted = tokio::task::spawn_blocking(move || {
        service.jobs.accept(&service.config, Live::new(record, format, Trail::default()), &document.bytes)
    });
    let (live, replayed) = accepted.await.map_err(Problem::internal)??;
    let asked = |key: Key, format: &encode::Format| (key, format.name, format.compression_name());
    if replayed && asked(live.key, live.format) != asked(key, format) {
        let what = "this Idempotency-Key was used for another request: give a new one";
        return Err(Problem::new(StatusCode::UNPROCESSABLE_ENTITY, "key-reused", what));
    }
    let view = live.view();
    let location = HeaderValue::from_str(&format!("/v1/jobs/{}", view.id)).map_err(Problem::internal)?;
    let mut response = (StatusCode::CREATED, Json(view)).into_response();
    response.headers_mut().insert(LOCATION, location);
    if replayed {
        response.headers_mut().insert(REPLAYED, HeaderValue::from_static("true"));
    }
    Ok(response)
}

fn idempotency_key(value: &HeaderValue) -> Result<String, Problem> {
    let plain = |key: &&str| (1..=255).contains(&key.len()) && key.bytes().all(|b| b == b' ' || b.is_ascii_graphic());
    let key = value.to_str().ok().filter(plain).map(str::to_owned);
    key.ok_or_else(|| Problem::malformed("Idempotency-Key: give 1 to 255 visible ASCII characters"))
}

/// A job's id in an address.
pub struct Id(pub String);

impl<S: Send + Sync> FromRequestParts<S> for Id {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Id, Problem> {
        // What is no text names no job.
        Path::from_request_parts(parts, state).await.map(|Path(id)| Id(id)).map_err(|_| Problem::no_job())
    }
}

/// A job
#[utoipa::path(
    get,
    path = "/v1/jobs/{id}",
    tag = "jobs",
    params(("id" = String, Path, description = "The job's id")),
    responses(
        (status = 200, description = "The job", body = View),
        (status = 404, description = "There is none", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn show(State(service): State<Service>, Id(id): Id) -> Result<Json<View>, Problem> {
    Ok(Json(service.jobs.find(&id)?.view()))
}

/// Cancel a job and forget it
///
/// Whoever reads it at the moment is cut off.
#[utoipa::path(
    delete,
    path = "/v1/jobs/{id}",
    tag = "jobs",
    params(("id" = String, Path, description = "The job's id")),
    responses(
        (status = 204, description = "It is gone"),
        (status = 404, description = "There is none", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn delete(State(service): State<Service>, Id(id): Id) -> Result<StatusCode, Problem> {
    let live = service.jobs.find(&id)?;
    let forgotten = tokio::task::spawn_blocking(move || service.jobs.forget(&live)).await.map_err(Problem::internal)?;
    forgotten.map_err(|error| Problem::storing(&error))?;
    Ok(StatusCode::NO_CONTENT)
}
