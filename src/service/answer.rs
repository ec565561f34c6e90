//! A document in, its raster out, from the first line on: what `POST /v1/fill` and `POST /v1/solid` have in common.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Instant;

use axum::body::{Body, Bytes};
use axum::extract::FromRequestParts;
use axum::http::header::{CONTENT_LENGTH, CONTENT_TYPE, IF_MATCH, IF_NONE_MATCH};
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use headers::{ETag, HeaderMapExt, IfMatch, IfNoneMatch};
use sha2::{Digest as _, Sha256};
use tokio::sync::OwnedSemaphorePermit;

use super::access::Started;
use super::cache::{Key, Shared};
use super::connection::Connection;
use super::drawings::Drawing;
use super::params::{Kind, Params, content_type};
use super::problem::Problem;
use super::raster::Raster;
use super::{Service, meters};
use crate::encode::Format;
use crate::error::Warning;
use crate::input::Fonts;

/// Who asks: a connection, and when the request came on it.
pub struct Asker {
    /// The connection, where there is one.
    pub connection: Option<Arc<Connection>>,
    /// When the request came.
    pub started: Instant,
}

impl FromRequestParts<Service> for Asker {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, _: &Service) -> Result<Asker, Infallible> {
        let connection = parts.extensions.get::<Arc<Connection>>().cloned();
        let started = parts.extensions.get::<Started>().map_or_else(Instant::now, |started| started.0);
        Ok(Asker { connection, started })
    }
}

/// Answers a document with its raster.
///
/// # Errors
/// What is wrong with the query, the body, the document, or what is asked of it; busy.
pub async fn raster(service: Service, asker: Asker, params: &Params, headers: &HeaderMap, body: Body) -> Result<Response, Problem> {
    let (format, ask) = (params.format(headers)?, params.ask()?);
    let place = service.place()?;
    let document = service.uploads.read(&service.config, params.kind().documents(), headers, body).await?;
    let key = params.key(&document.digest);
    let (bytes, room) = (document.bytes, document.room);
    let source = Box::new(move || {
        let _room = room;
        Ok(bytes.into())
    });
    let shared = service.drawings.get(key, ask.of(source)).await?;
    stream(service, asker, params.kind(), shared, format, place)
}

/// The raster of a drawing as an answer.
///
/// # Errors
/// The format cannot hold it.
pub fn stream(
    service: Service,
    asker: Asker,
    kind: Kind,
    shared: Shared<Drawing>,
    format: &'static Format,
    place: OwnedSemaphorePermit,
) -> Result<Response, Problem> {
    let drawing = shared.thing.clone();
    format.check(drawing.job.header())?;
    meters::render(kind.name(), format.name);
    let raster = Raster::new(service, shared, drawing.job.stream(format), place, asker.connection).timed(asker.started);
    let mut response = raster.into_body().into_response();
    let headers = response.headers_mut();
    headers.insert(CONTENT_TYPE, content_type(format));
    if let Some(length) = drawing.job.length(format) {
        headers.insert(CONTENT_LENGTH, HeaderValue::from(length));
    }
    warn(&drawing.warnings, headers);
    Ok(response)
}

/// The first bytes of a digest over a raster's key and its format, as a strong tag (RFC 9110, section 8.8.3).
pub fn tag(key: &Key, fonts: &Fonts, format: &Format) -> String {
    let by = format!("{} {} {} {}", env!("CARGO_PKG_VERSION"), fonts.fingerprint(), format.name, format.version);
    let digest = Sha256::new().chain_update(key).chain_update(by).finalize();
    let hex: String = digest[..16].iter().map(|byte| format!("{byte:02x}")).collect();
    format!("\"{hex}\"")
}

/// A tag that [`tag`] made.
pub fn etag(tag: &str) -> ETag {
    tag.parse().expect("a tag of hexadecimal digits in quotes is one")
}

/// Whether the reader of a raster of that tag says that it has it already (RFC 9110, section 13.1).
///
/// # Errors
/// It wants another one.
pub fn is_known(tag: &str, headers: &HeaderMap) -> Result<bool, Problem> {
    let etag = etag(tag);
    if headers.contains_key(IF_MATCH) && !headers.typed_get::<IfMatch>().is_some_and(|tags| tags.precondition_passes(&etag)) {
        return Err(Problem::new(StatusCode::PRECONDITION_FAILED, "changed", "the raster has another tag"));
    }
    Ok(headers.contains_key(IF_NONE_MATCH) && !headers.typed_get::<IfNoneMatch>().is_none_or(|tags| tags.precondition_passes(&etag)))
}

/// The body of an answer that has none and does not tell its length: an empty one would tell a length of 0.
pub fn no_body() -> Body {
    Body::from_stream(futures_util::stream::empty::<Result<Bytes, Infallible>>())
}

/// Names warnings in headers, as far as there is room.
fn warn(warnings: &[Warning], headers: &mut HeaderMap) {
    const MOST: usize = 20;
    const NAME: HeaderName = HeaderName::from_static("runset-warning");
    for warning in warnings.iter().take(MOST) {
        // Header fields are visible ASCII.
        let text: String = said(warning)
            .chars()
            .flat_map(|c| if c.is_ascii() && !c.is_ascii_control() { vec![c] } else { c.escape_unicode().collect() })
            .collect();
        if let Ok(value) = HeaderValue::from_str(&text) {
            headers.append(NAME, value);
        }
    }
    if warnings.len() > MOST {
        headers.append(NAME, HeaderValue::from_str(&format!("and {} more", warnings.len() - MOST)).expect("ASCII"));
    }
}

/// A warning in one line.
pub fn said(warning: &Warning) -> String {
    warning.place.map_or_else(|| warning.what.clone(), |place| format!("{}:{}: {}", place.line, place.column, warning.what))
}
