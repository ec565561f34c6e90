//! `POST /v1/fill`: a drawing in, its raster out.

use axum::body::Body;
use axum::extract::{RawQuery, State};
use axum::http::HeaderMap;
use axum::response::Response;

use super::Service;
use super::answer::{self, Asker};
use super::params::{FillParams, Params};
use super::problem::{Details, Problem};

/// Fill a drawing, or an expression over its shapes
///
/// The raster is streamed from its first line on. An error after the first byte breaks the connection. Warnings about what is drawn but not
/// supported are in `runset-warning` headers.
#[utoipa::path(
    post,
    path = "/v1/fill",
    tag = "fill",
    params(FillParams),
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
    asker: Asker,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
    body: Body,
) -> Result<Response, Problem> {
    let params = Params::Fill(FillParams::read(&query.unwrap_or_default())?);
    answer::raster(service, asker, &params, &headers, body).await
}
