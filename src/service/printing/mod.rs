//! Jobs on printers: `POST /v1/jobs/{id}/print` prints the drawing of a job on one of the printers that the service may talk to.
//!
//! ```text
//!   waiting --> sending --> printing --the printer says completed--> printed
//!      \------------\-----------\--> failed, cancelled              each stage is stored before the next begins
//! ```
//!
//! Only printers that the service was started with are talked to: an address in a request names one of them, and nothing else. Behind a restart a print that was under way is
//! asked for at its printer, by its number there; a document is sent again only if the printer says that it has nothing of it.

mod errand;

use std::sync::{Mutex, PoisonError};

use axum::Json;
use axum::body::Body;
use axum::extract::State;
use axum::http::header::LOCATION;
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use tokio_util::sync::CancellationToken;
use utoipa::ToSchema;

pub use self::errand::{resume, settle};
use super::Service;
use super::jobs::{Id, Live, Phase};
use super::params::Kind;
use super::problem::{Details, Problem};
use crate::encode::Format;
use crate::print::sheet::Scaling;
use crate::print::wishes::{self, Quality, Wishes};
use crate::print::{Address, Stage};

/// Bytes of a request to print.
const LONGEST: usize = 64 << 10;

/// What is wanted of a printer.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PrintRequest {
    /// The printer's address, one of `GET /v1/printers`. May be left out where there is only one
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) printer: Option<String>,
    /// How often, if the printer makes so many copies
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 1, maximum = 9999)]
    copies: Option<u32>,
    /// Medium: its name, a part of it, or a size, such as iso_a4_210x297mm, a4, 914x1200mm
    #[serde(skip_serializing_if = "Option::is_none")]
    media: Option<String>,
    /// Resolution in dots an inch; without it the finest that the printer has
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 1, maximum = 100000)]
    dpi: Option<u32>,
    /// Name of a format; without it the best that the printer takes
    #[serde(skip_serializing_if = "Option::is_none")]
    format: Option<String>,
    /// How the drawing is brought to the size of the sheet: auto, fit, fill, none
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>, pattern = "^(auto|fit|fill|none)$")]
    scaling: Option<Scaling>,
    /// What is printed around the drawing's own page, in millimetres
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0, maximum = 1000)]
    pub(super) bleed: Option<f64>,
    /// Whether the drawing may be turned by a quarter to make it fit; it may if nothing is said
    #[serde(skip_serializing_if = "Option::is_none")]
    turn: Option<bool>,
    /// draft, normal or high
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>, pattern = "^(draft|normal|high)$")]
    quality: Option<Quality>,
}

/// How a print is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
#[schema(as = PrintState)]
pub enum PrintState {
    /// For the printer, or to be prepared.
    Waiting,
    /// The printer takes the document.
    Sending,
    /// The printer has the whole document.
    Printing,
    /// The printer says that the job is completed.
    Printed,
    /// It is not printed, or that is not known: `error` says which.
    Failed,
    /// Cancelled, here or at the printer.
    Cancelled,
}

/// A print of a job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Print)]
pub struct Print {
    /// The printer's address.
    pub(super) printer: String,
    /// How it is.
    pub(super) state: PrintState,
    /// What it waits for, or what the printer says of it.
    pub(super) told: Option<String>,
    /// Format, resolution, medium and scaling, and why.
    pub(super) choice: Option<String>,
    /// The job's address at the printer, once there is one.
    pub(super) job: Option<String>,
    /// Bytes of the document that were sent.
    pub(super) sent: u64,
    /// Sides of sheets that are printed, as the printer says.
    pub(super) impressions: Option<i32>,
    /// Why it is not printed.
    pub(super) error: Option<String>,
    /// When it was asked for, in UTC (RFC 3339).
    #[schema(value_type = String, format = DateTime)]
    pub(super) created: Timestamp,
    /// When it ended.
    #[schema(value_type = Option<String>, format = DateTime)]
    pub(super) finished: Option<Timestamp>,
}

impl Print {
    /// Whether it goes on.
    pub fn is_active(&self) -> bool {
        matches!(self.state, PrintState::Waiting | PrintState::Sending | PrintState::Printing)
    }
}

/// What a print needs to go on, stored with its job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stored {
    pub(super) request: PrintRequest,
    pub(super) stage: Stage,
}

/// What cancels the print of a job, while there is one.
#[derive(Debug, Default)]
pub struct Canceller(Mutex<Option<CancellationToken>>);

impl Canceller {
    /// A print begins.
    pub fn begin(&self) -> CancellationToken {
        let token = CancellationToken::new();
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(token.clone());
        token
    }

    /// Cancels it.
    pub fn cancel(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).iter().for_each(CancellationToken::cancel);
    }
}

impl PrintRequest {
    fn read(bytes: &[u8]) -> Result<PrintRequest, Problem> {
        let mut from = serde_json::Deserializer::from_slice(bytes);
        let wrong = |error: &dyn std::fmt::Display| Problem::malformed(format!("the body: {error}"));
        let request = serde_path_to_error::deserialize(&mut from).map_err(|error| wrong(&error))?;
        from.end().map_err(|error| wrong(&error))?;
        Ok(request)
    }

    /// What is wanted, within bounds.
    pub(super) fn wishes(&self) -> Result<Wishes, Problem> {
        let bounded = |name: &str, value: Option<u32>, most: u32| match value {
            Some(value) if !(1..=most).contains(&value) => {
                Err(Problem::malformed(format!("{name} is {value}: give a whole number from 1 to {most}")))
            }
            value => Ok(value),
        };
        if self.bleed.is_some_and(|bleed| !(0.0..=1000.0).contains(&bleed)) {
            return Err(Problem::malformed("bleed: give a number of millimetres from 0 to 1000"));
        }
        let format = |name: &String| wishes::named(name).map_err(|failure| Problem::malformed(failure.what));
        let format: Option<&'static Format> = self.format.as_ref().map(format).transpose()?;
        Ok(Wishes {
            format,
            dpi: bounded("dpi", self.dpi, 100_000)?,
            media: self.media.clone(),
            scaling: self.scaling.unwrap_or_default(),
            turn: self.turn.unwrap_or(true),
            copies: bounded("copies", self.copies, 9999)?.unwrap_or(1),
            quality: self.quality,
        })
    }
}

/// The printer that a request names, if the service may talk to it.
fn allowed(service: &Service, named: Option<&str>) -> Result<Address, Problem> {
    let printers = &service.config.printers;
    let forbidden = |what: String| Problem::new(StatusCode::FORBIDDEN, "printer-not-allowed", what);
    let Some(named) = named else {
        return match &printers[..] {
            [only] => Ok(only.clone()),
            [] => Err(forbidden("this service prints on no printer: it has to be started with --printer".to_owned())),
            _ => Err(Problem::malformed("the body: printer is missing: give one of GET /v1/printers")),
        };
    };
    let asked = Address::parse(named).map_err(|what| Problem::malformed(format!("printer: {what}")))?;
    printers.iter().find(|printer| **printer == asked).cloned().ok_or_else(|| {
        forbidden(format!("this service does not print on {asked}: only on those of GET /v1/printers, which --printer names"))
    })
}

/// A printer that the service prints on.
#[derive(Serialize, ToSchema)]
pub struct PrinterEntry {
    /// Its address.
    uri: String,
}

/// The printers that the service prints on.
#[derive(Serialize, ToSchema)]
pub struct Printers {
    /// In the order in which they were named.
    printers: Vec<PrinterEntry>,
}

/// The printers that this service prints on
#[utoipa::path(get, path = "/v1/printers", tag = "printing", responses((status = 200, description = "The list; empty where none was named", body = Printers)))]
pub async fn printers(State(service): State<Service>) -> Json<Printers> {
    let printers = service.config.printers.iter().map(|printer| PrinterEntry { uri: printer.to_string() }).collect();
    Json(Printers { printers })
}

/// Print a job
///
/// The drawing is laid on a sheet of the printer and rendered anew, in the best format and the finest resolution that the printer has; the job's own format and size do not
/// count, its expression and tolerance do. Stored durably before the answer.
#[utoipa::path(
    post,
    path = "/v1/jobs/{id}/print",
    operation_id = "print_job",
    tag = "printing",
    params(("id" = String, Path, description = "The job's id")),
    request_body(description = "Where and how", content((PrintRequest = "application/json"))),
    responses(
        (status = 202, description = "It will be printed", body = Print, headers(("location" = String, description = "Where it is seen"))),
        (status = 400, description = "The body is malformed", body = Details, content_type = "application/problem+json"),
        (status = 404, description = "There is no such job", body = Details, content_type = "application/problem+json"),
        (status = 408, description = "The body stopped", body = Details, content_type = "application/problem+json"),
        (status = 409, description = "It is being printed", body = Details, content_type = "application/problem+json"),
        (status = 410, description = "The job has failed", body = Details, content_type = "application/problem+json"),
        (status = 413, description = "The body is too large", body = Details, content_type = "application/problem+json"),
        (status = 415, description = "The body is not JSON", body = Details, content_type = "application/problem+json"),
        (status = 422, description = "A model, which is not printed", body = Details, content_type = "application/problem+json"),
        (status = 503, description = "Too much is being printed", body = Details, content_type = "application/problem+json"),
        (status = 507, description = "The disk is full", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn print(State(service): State<Service>, Id(id): Id, headers: HeaderMap, body: Body) -> Result<Response, Problem> {
    let live = service.jobs.find(&id)?;
    let body = service.uploads.read(&service.config, &["application/json"], &headers, body).await?;
    if body.bytes.len() > LONGEST {
        return Err(Problem::new(StatusCode::PAYLOAD_TOO_LARGE, "too-large", format!("the body is larger than {LONGEST} bytes")));
    }
    let request = PrintRequest::read(&body.bytes)?;
    request.wishes()?;
    let printer = allowed(&service, request.printer.as_deref())?;
    let view = live.view();
    if view.state() == Phase::Failed {
        return Err(Problem::new(StatusCode::GONE, "failed", "this job has failed: its drawing cannot be printed"));
    }
    if view.kind() != Kind::Fill {
        return Err(Problem::new(StatusCode::UNPROCESSABLE_ENTITY, "not-a-drawing", "only drawings are printed, and this job is a model"));
    }
    let full = || Problem::busy("prints", format!("{} jobs are being printed: try again later", service.config.max_prints), 5);
    let place = service.prints.clone().try_acquire_owned().map_err(|_| full())?;
    let print = Print {
        printer: printer.to_string(),
        state: PrintState::Waiting,
        told: None,
        choice: None,
        job: None,
        sent: 0,
        impressions: None,
        error: None,
        created: Timestamp::now(),
        finished: None,
    };
    let stored = Stored { request: PrintRequest { printer: Some(printer.to_string()), ..request }, stage: Stage::New };
    if !live.begin_print(print.clone(), stored.clone()) {
        let what = "this job is being printed: wait, or cancel that with DELETE";
        return Err(Problem::new(StatusCode::CONFLICT, "printing", what));
    }
    let cancelled = live.canceller.begin();
    if let Err(problem) = service.jobs.store_now(&live).await {
        live.end_print(|print| print.state = PrintState::Failed);
        return Err(problem);
    }
    errand::begin(service, live, stored, cancelled, place);
    let location = HeaderValue::from_str(&format!("/v1/jobs/{id}/print")).map_err(Problem::internal)?;
    let mut response = (StatusCode::ACCEPTED, Json(print)).into_response();
    response.headers_mut().insert(LOCATION, location);
    Ok(response)
}

fn no_print() -> Problem {
    Problem::new(StatusCode::NOT_FOUND, "no-print", "this job was not printed: ask for that with POST")
}

fn print_of(live: &Live) -> Result<Print, Problem> {
    live.view().print().cloned().ok_or_else(no_print)
}

/// How the print of a job is
#[utoipa::path(
    get,
    path = "/v1/jobs/{id}/print",
    operation_id = "show_print",
    tag = "printing",
    params(("id" = String, Path, description = "The job's id")),
    responses(
        (status = 200, description = "The last print of the job", body = Print),
        (status = 404, description = "There is no such job, or it was not printed", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn show(State(service): State<Service>, Id(id): Id) -> Result<Json<Print>, Problem> {
    print_of(&*service.jobs.find(&id)?).map(Json)
}

/// Cancel the print of a job, at the printer too
///
/// One that has ended is forgotten instead.
#[utoipa::path(
    delete,
    path = "/v1/jobs/{id}/print",
    operation_id = "cancel_print",
    tag = "printing",
    params(("id" = String, Path, description = "The job's id")),
    responses(
        (status = 202, description = "It is being cancelled", body = Print),
        (status = 204, description = "It had ended, and is forgotten"),
        (status = 404, description = "There is no such job, or it was not printed", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn cancel(State(service): State<Service>, Id(id): Id) -> Result<Response, Problem> {
    let live = service.jobs.find(&id)?;
    let print = print_of(&live)?;
    if print.is_active() {
        live.canceller.cancel();
        return Ok((StatusCode::ACCEPTED, Json(print)).into_response());
    }
    live.forget_print();
    Ok(StatusCode::NO_CONTENT.into_response())
}
