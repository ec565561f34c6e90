//! What is asked about a drawing besides its raster: `POST /v1/info`, its names, and `POST /v1/explain`, how its scanlines come about.

use axum::Json;
use axum::body::Body;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Query, State};
use axum::http::HeaderMap;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::drawings::read;
use super::params::{Params, query_fault};
use super::problem::{Details, Problem};
use super::{Service, fill};
use crate::job::{Explanation, Info, explain as how, info as names};

/// A drawing's names, and what is drawn but not supported.
#[derive(Serialize, ToSchema)]
pub struct Names {
    #[serde(flatten)]
    info: Info,
    /// What is drawn but not supported.
    warnings: Vec<String>,
}

/// No query.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Nothing {}

/// The size of a drawing, and its ids with kind, bounds and edges
#[utoipa::path(
    post,
    path = "/v1/info",
    tag = "fill",
    request_body(description = "An SVG or a JSON scene, plain or gzipped", content((String = "image/svg+xml"), (serde_json::Value = "application/json"))),
    responses(
        (status = 200, description = "Its names", body = Names),
        (status = 400, description = "The document is malformed", body = Details, content_type = "application/problem+json"),
        (status = 408, description = "The body stopped", body = Details, content_type = "application/problem+json"),
        (status = 413, description = "The document is too large", body = Details, content_type = "application/problem+json"),
        (status = 415, description = "Not a document that can be read", body = Details, content_type = "application/problem+json"),
        (status = 422, description = "Understood, and refused: references, limits", body = Details, content_type = "application/problem+json"),
        (status = 503, description = "Busy: try again later", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn info(
    State(service): State<Service>,
    query: Result<Query<Nothing>, QueryRejection>,
    headers: HeaderMap,
    body: Body,
) -> Result<Json<Names>, Problem> {
    query.map_err(|rejection| Problem::malformed(query_fault(&rejection)))?;
    let document = service.uploads.read(&service.config, &headers, body).await?;
    let work = service.drawings.work(move |config| {
        let _room = document.room;
        let (scene, warnings) = read(config, document.bytes.into())?;
        Ok(Names { info: names(&scene)?, warnings: warnings.iter().map(fill::said).collect() })
    });
    work.await.map(Json)
}

/// How scanlines come about
///
/// Tells of the lines that `lines` names, or all, which of them were counted; if `lines` names one alone, also its crossings from left to right, and what each
/// did to the counts of the expression. `format` is of no use here.
#[utoipa::path(
    post,
    path = "/v1/explain",
    tag = "fill",
    params(Params),
    request_body(description = "An SVG or a JSON scene, plain or gzipped", content((String = "image/svg+xml"), (serde_json::Value = "application/json"))),
    responses(
        (status = 200, description = "How they come about", body = Explanation),
        (status = 400, description = "The query or the document is malformed", body = Details, content_type = "application/problem+json"),
        (status = 408, description = "The body stopped", body = Details, content_type = "application/problem+json"),
        (status = 413, description = "The document is too large", body = Details, content_type = "application/problem+json"),
        (status = 415, description = "Not a document that can be read", body = Details, content_type = "application/problem+json"),
        (status = 422, description = "Understood, and refused: names, references, limits", body = Details, content_type = "application/problem+json"),
        (status = 503, description = "Busy: try again later", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn explain(State(service): State<Service>, params: Params, headers: HeaderMap, body: Body) -> Result<Json<Explanation>, Problem> {
    if params.kind.is_some() {
        return Err(Problem::malformed("kind is for jobs: POST /v1/jobs"));
    }
    params.format(&HeaderMap::new())?;
    let mut options = params.options()?;
    let document = service.uploads.read(&service.config, &headers, body).await?;
    let work = service.drawings.work(move |config| {
        let _room = document.room;
        options.limits = config.limits;
        let (scene, mut warnings) = read(config, document.bytes.into())?;
        Ok(how(scene, &options, &mut warnings)?)
    });
    work.await.map(Json)
}
