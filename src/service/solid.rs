//! `POST /v1/solid`: a model in, its picture out.

use axum::body::Body;
use axum::extract::{RawQuery, State};
use axum::http::HeaderMap;
use axum::response::Response;

use super::Service;
use super::answer::{self, Asker};
use super::params::{Params, SolidParams};
use super::problem::{Details, Problem};

/// Show a model, directly
///
/// The picture is streamed from its first line on. An error after the first byte breaks the connection. Warnings about what is left out or put right
/// are in `runset-warning` headers.
#[utoipa::path(
    post,
    path = "/v1/solid",
    tag = "solid",
    params(SolidParams),
    request_body(description = "OpenSCAD's .csg or an STL, plain or gzipped", content((String = "text/plain"), (String = "model/stl"))),
    responses(
        (status = 200, description = "The raster"),
        (status = 400, description = "The query or the document is malformed", body = Details, content_type = "application/problem+json"),
        (status = 408, description = "The body stopped", body = Details, content_type = "application/problem+json"),
        (status = 413, description = "The document is too large", body = Details, content_type = "application/problem+json"),
        (status = 406, description = "No such media type", body = Details, content_type = "application/problem+json"),
        (status = 415, description = "Not a document that can be read", body = Details, content_type = "application/problem+json"),
        (status = 422, description = "Understood, and refused: imports, limits", body = Details, content_type = "application/problem+json"),
        (status = 503, description = "Busy: try again later", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn solid(
    State(service): State<Service>,
    asker: Asker,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
    body: Body,
) -> Result<Response, Problem> {
    let params = Params::Solid(SolidParams::read(&query.unwrap_or_default())?);
    answer::raster(service, asker, &params, &headers, body).await
}
