//! `GET /v1/jobs/{id}/raster`: the raster of a job, from any byte on.
//!
//! ```text
//!   Range: bytes=N-   --fixed length-->   the line that byte N is in, by arithmetic
//!                     --else----------->  the last checkpoint before N          then skip to N
//! ```
//!
//! The sweep starts at that line: what is above costs nothing but the edges that begin there. Where the format has a table, its arithmetic is known once the raster is
//! measured; before that whoever wants all of it waits while the stream makes its first pass.

use std::sync::Arc;

use axum::body::Body;
use axum::extract::State;
use axum::http::header::{ACCEPT_RANGES, CONTENT_DISPOSITION, CONTENT_LENGTH, CONTENT_RANGE, CONTENT_TYPE, ETAG, IF_RANGE, RANGE};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use headers::{HeaderMapExt, IfRange};
use http_range_header::RangeUnsatisfiableError;

use super::super::answer::{self, Asker};
use super::super::params::content_type;
use super::super::problem::{Details, Problem};
use super::super::raster::Raster;
use super::super::{Service, meters};
use super::{Id, Live, Phase};
use crate::encode::Format;
use crate::job::{Checkpoint, Job, Stream};

/// What of a raster is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wanted {
    All,
    /// From the first byte to the one behind the last.
    Bytes(u64, u64),
}

/// The raster of a job, or a part of it
///
/// It is rendered as it is read. `Range` with one range of bytes gives that part; the tag is strong and stands for content, parameters, format and version,
/// so `If-Range` is safe across restarts and upgrades. A range of a raster whose length is not known yet is answered with 503.
#[utoipa::path(
    get,
    path = "/v1/jobs/{id}/raster",
    tag = "jobs",
    params(
        ("id" = String, Path, description = "The job's id"),
        ("Range" = Option<String>, Header, description = "bytes=N- or bytes=N-M or bytes=-N"),
        ("If-Range" = Option<String>, Header, description = "Only a range if this is still the raster's tag"),
        ("If-None-Match" = Option<String>, Header, description = "Nothing if this is the raster's tag"),
    ),
    responses(
        (status = 200, description = "The raster"),
        (status = 206, description = "A part of it"),
        (status = 304, description = "It has not changed"),
        (status = 404, description = "There is no such job", body = Details, content_type = "application/problem+json"),
        (status = 410, description = "The job has failed", body = Details, content_type = "application/problem+json"),
        (status = 412, description = "It is another raster", body = Details, content_type = "application/problem+json"),
        (status = 416, description = "No such part", body = Details, content_type = "application/problem+json"),
        (status = 503, description = "Busy, or the length is not known yet", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn read(State(service): State<Service>, Id(id): Id, asker: Asker, headers: HeaderMap) -> Result<Response, Problem> {
    let live = service.jobs.find(&id)?;
    let mut response = match about(&live, &headers)? {
        Ok(response) => response,
        Err(unchanged) => return Ok(unchanged),
    };
    let length = live.now().view.bytes;
    let wanted = wanted(&live, &headers, length)?;
    let place = service.place()?;
    let shared = live.drawing(&service).await?;
    let job = shared.thing.job.knowing(live.now().trail.table.clone());
    let (first, end) = match wanted {
        Wanted::All => (0, length.unwrap_or(u64::MAX)),
        Wanted::Bytes(first, end) => (first, end),
    };
    let from = job.seek(live.format, first).or_else(|| live.now().trail.before(first));
    let stream = stream(&job, live.format, from).ok_or_else(|| Problem::internal("a checkpoint that is none of this raster"))?;
    meters::render(live.params.kind().name(), live.format.name);
    let skip = first - stream.offset();
    let raster = Raster::new(service, shared, stream, place, asker.connection).part(skip, end - first);
    *response.body_mut() = raster.timed(asker.started).followed(Arc::new(live.read())).into_body();
    if let (Wanted::Bytes(first, end), Some(length)) = (wanted, length) {
        *response.status_mut() = StatusCode::PARTIAL_CONTENT;
        response.headers_mut().insert(CONTENT_RANGE, range_of(&format!("{first}-{}", end - 1), length));
        response.headers_mut().insert(CONTENT_LENGTH, HeaderValue::from(end - first));
    }
    Ok(response)
}

/// What is known of the raster of a job, without it
#[utoipa::path(
    head,
    path = "/v1/jobs/{id}/raster",
    tag = "jobs",
    params(("id" = String, Path, description = "The job's id")),
    responses((status = 200, description = "Its type, tag, and length if that is known"), (status = 404, description = "There is no such job"))
)]
pub async fn head(State(service): State<Service>, Id(id): Id, headers: HeaderMap) -> Result<Response, Problem> {
    let live = service.jobs.find(&id)?;
    let mut response = about(&live, &headers)?.unwrap_or_else(|unchanged| unchanged);
    if !response.headers().contains_key(CONTENT_LENGTH) {
        // An empty body would tell a length of 0.
        *response.body_mut() = answer::no_body();
    }
    Ok(response)
}

/// An answer without its body, or that nothing has changed.
fn about(live: &Live, headers: &HeaderMap) -> Result<Result<Response, Response>, Problem> {
    let view = live.view();
    if view.state == Phase::Failed {
        let why = view.error.unwrap_or_default();
        return Err(Problem::new(StatusCode::GONE, "failed", format!("this job has failed: {why}")));
    }
    let mut response = Body::empty().into_response();
    let tag = HeaderValue::from_str(&live.tag).map_err(Problem::internal)?;
    response.headers_mut().insert(ETAG, tag);
    if answer::is_known(&live.tag, headers)? {
        *response.status_mut() = StatusCode::NOT_MODIFIED;
        return Ok(Err(response));
    }
    let fields = response.headers_mut();
    fields.insert(CONTENT_TYPE, content_type(live.format));
    fields.insert(ACCEPT_RANGES, HeaderValue::from_static("bytes"));
    let name = format!("inline; filename=\"{}.{}\"", view.id, live.format.extensions[0]);
    fields.insert(CONTENT_DISPOSITION, HeaderValue::from_str(&name).map_err(Problem::internal)?);
    if let Some(length) = view.bytes {
        fields.insert(CONTENT_LENGTH, HeaderValue::from(length));
    }
    Ok(Ok(response))
}

/// What is asked for. A range that is not understood is as none (RFC 9110, section 14.2), and so are several.
fn wanted(live: &Live, headers: &HeaderMap, length: Option<u64>) -> Result<Wanted, Problem> {
    let Some(range) = headers.get(RANGE).and_then(|range| range.to_str().ok()) else { return Ok(Wanted::All) };
    // Dates say nothing here: a tag that is another, or none, means the whole.
    if headers.contains_key(IF_RANGE)
        && headers.typed_get::<IfRange>().is_none_or(|if_range| if_range.is_modified(Some(&answer::etag(&live.tag)), None))
    {
        return Ok(Wanted::All);
    }
    let Ok(ranges) = http_range_header::parse_range_header(range) else { return Ok(Wanted::All) };
    if ranges.len() != 1 {
        return Ok(Wanted::All);
    }
    let Some(length) = length else {
        let what = "the length of this raster is being measured: ask for a part of it later, or for all of it now";
        return Err(Problem::new(StatusCode::SERVICE_UNAVAILABLE, "measuring", what).after(1));
    };
    match ranges.validate(length).as_deref() {
        Ok([range]) => Ok(Wanted::Bytes(*range.start(), range.end() + 1)),
        Err(RangeUnsatisfiableError::Unsatisfiable) => {
            let problem = Problem::new(StatusCode::RANGE_NOT_SATISFIABLE, "range", format!("the raster has {length} bytes"));
            Err(problem.with(CONTENT_RANGE, range_of("*", length)))
        }
        _ => Ok(Wanted::All),
    }
}

fn range_of(part: &str, length: u64) -> HeaderValue {
    HeaderValue::from_str(&format!("bytes {part}/{length}")).expect("digits and punctuation")
}

/// The stream of a raster from a checkpoint on, or from its beginning. None if the checkpoint is none of this raster.
pub fn stream(job: &Job, format: &Format, from: Option<Checkpoint>) -> Option<Stream> {
    match from {
        Some(from) => job.stream_from(format, &from).ok(),
        None => Some(job.stream(format)),
    }
}
