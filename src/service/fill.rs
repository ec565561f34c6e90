//! `POST /v1/fill`: a document in, its raster out, from the first line on.

use std::sync::Arc;

use axum::Extension;
use axum::body::Body;
use axum::extract::State;
use axum::http::header::{CONTENT_LENGTH, CONTENT_TYPE};
use axum::http::{HeaderMap, HeaderName, HeaderValue};
use axum::response::{IntoResponse, Response};
use sha2::{Digest as _, Sha256};

use super::access::Started;
use super::connection::Connection;
use super::drawings::Key;
use super::params::{Params, content_type};
use super::problem::{Details, Problem};
use super::raster::Raster;
use super::{Service, meters};
use crate::encode::Format;
use crate::error::Warning;
use crate::input::Fonts;

/// Fill a drawing, or an expression over its shapes
///
/// The raster is streamed from its first line on. An error after the first byte breaks the connection. Warnings about what is drawn but not
/// supported are in `runset-warning` headers.
#[utoipa::path(
    post,
    path = "/v1/fill",
    tag = "fill",
    params(Params),
    request_body(description = "An SVG or a JSON scene, plain or gzipped", content((String = "image/svg+xml"), (serde_json::Value = "application/json"))),
    responses(
        (status = 200, description = "The raster"),
        (status = 400, description = "The query or the document is malformed", body = Details, content_type = "application/problem+json"),
        (status = 408, description = "The body stopped", body = Details, content_type = "application/problem+json"),
        (status = 413, description = "The document is too large", body = Details, content_type = "application/problem+json"),
        (status = 406, description = "No such media type", body = Details, content_type = "application/problem+json"),
        (status = 415, description = "Not a document that can be read", body = Details, content_type = "application/problem+json"),
        (status = 422, description = "Understood, and refused: names, references, limits", body = Details, content_type = "application/problem+json"),
        (status = 503, description = "Busy: try again later", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn fill(
    State(service): State<Service>,
    connection: Option<Extension<Arc<Connection>>>,
    Extension(Started(started)): Extension<Started>,
    params: Params,
    headers: HeaderMap,
    body: Body,
) -> Result<Response, Problem> {
    if params.kind.is_some() {
        return Err(Problem::malformed("kind is for jobs: POST /v1/jobs"));
    }
    let (format, options) = (params.format(&headers)?, params.options()?);
    let place = service.place()?;
    let document = service.uploads.read(&service.config, &headers, body).await?;
    let key = key(&document.digest, &params);
    let (bytes, room) = (document.bytes, document.room);
    let source = Box::new(move || {
        let _room = room;
        Ok(bytes.into())
    });
    let shared = service.drawings.get(key, options, source).await?;
    meters::render("fill", format.name);
    let drawing = shared.drawing.clone();
    let raster = Raster::new(service, shared, drawing.job.stream(format), place, connection.map(|c| c.0)).timed(started);
    let mut response = raster.into_body().into_response();
    let headers = response.headers_mut();
    headers.insert(CONTENT_TYPE, content_type(format));
    if let Some(length) = drawing.job.length(format) {
        headers.insert(CONTENT_LENGTH, HeaderValue::from(length));
    }
    warn(&drawing.warnings, headers);
    Ok(response)
}

/// What tells the drawing from others: its document and what is asked, but for the format.
pub fn key(digest: &[u8; 32], params: &Params) -> Key {
    let asked = Params { format: None, kind: None, ..params.clone() };
    let asked = serde_json::to_string(&asked).expect("numbers and strings under fixed names are JSON");
    Sha256::new().chain_update(digest).chain_update(asked).finalize().into()
}

/// The first bytes of a digest over a raster's key and its format, as a strong tag (RFC 9110, section 8.8.3).
pub fn tag(key: &Key, fonts: &Fonts, format: &Format) -> String {
    let by = format!("{} {} {} {}", env!("CARGO_PKG_VERSION"), fonts.fingerprint(), format.name, format.version);
    let digest = Sha256::new().chain_update(key).chain_update(by).finalize();
    let hex: String = digest[..16].iter().map(|byte| format!("{byte:02x}")).collect();
    format!("\"{hex}\"")
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
