//! Models that are kept to be seen from anywhere: read and identified once, and only staged and swept for each view.
//!
//! ```text
//!   PUT /v1/models --read, closed, identified--> kept, under the SHA-256 of the body      once a model
//!   GET /v1/models/{id}/view?camera=...  --staged--> drawing --swept--> picture           each view
//! ```
//!
//! They are in memory alone, [`Config::max_models`](super::Config::max_models) bytes of them; what was asked for longest ago goes first. Whoever finds that his is gone sends it
//! again, and has it under the same id.

use std::sync::Arc;

use axum::Json;
use axum::body::Body;
use axum::extract::{FromRequestParts, Path, RawQuery, State};
use axum::http::header::LOCATION;
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use utoipa::ToSchema;

use super::answer;
use super::ask;
use super::cache::{Cache, Key, Weigh};
use super::params::Kind;
use super::problem::{Details, Problem};
use super::{Service, meters};
use crate::error::{self, Error, Warning};
use crate::job::Kept;

/// The models of a service.
pub type Models = Cache<Model>;

/// A model that is kept.
pub struct Model {
    /// The SHA-256 of its document.
    pub key: Key,
    /// The model.
    pub kept: Arc<Kept>,
    /// What is left out, or was put right.
    pub warnings: Vec<Warning>,
}

impl Weigh for Model {
    fn weight(&self) -> u64 {
        const FEWEST: u64 = 64 << 10;
        FEWEST + self.kept.weight()
    }
}

/// A kept model as it is shown.
#[derive(Serialize, ToSchema)]
#[schema(as = Model)]
pub struct View {
    /// The SHA-256 of its document, in hexadecimal digits.
    id: String,
    /// Its parts.
    parts: u64,
    /// Faces of all parts.
    faces: u64,
    /// About how many bytes it takes of those for models.
    bytes: u64,
    /// Least and greatest x, y, z of a box that it stays within; none if it is empty.
    bounds: Option<[[f64; 3]; 2]>,
    /// What is left out, or was put right.
    warnings: Vec<String>,
}

impl From<&Model> for View {
    fn from(model: &Model) -> View {
        View {
            id: model.key.iter().map(|byte| format!("{byte:02x}")).collect(),
            parts: model.kept.parts(),
            faces: model.kept.faces(),
            bytes: model.weight(),
            bounds: model.kept.bounds(),
            warnings: model.warnings.iter().map(answer::said).collect(),
        }
    }
}

/// The models that are kept, those that were asked for last first.
#[derive(Serialize, ToSchema)]
#[schema(as = Models)]
pub struct List {
    models: Vec<View>,
}

/// A model's id in an address.
pub struct Id(Key);

impl<S: Send + Sync> FromRequestParts<S> for Id {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Id, Problem> {
        let Path(id) = Path::<String>::from_request_parts(parts, state).await.map_err(|_| no_model())?;
        let (pairs, rest) = id.as_bytes().as_chunks::<2>();
        let digit = |byte: u8| (byte as char).to_digit(16).filter(|_| !byte.is_ascii_uppercase());
        let bytes: Option<Vec<u8>> = pairs.iter().map(|&[high, low]| Some((digit(high)? << 4 | digit(low)?) as u8)).collect();
        let key = bytes.filter(|_| rest.is_empty()).and_then(|bytes| Key::try_from(bytes).ok());
        key.map(Id).ok_or_else(no_model)
    }
}

fn no_model() -> Problem {
    let what = "no model of this id is kept: it may have made room for others, or been deleted: PUT it again to /v1/models";
    Problem::new(StatusCode::NOT_FOUND, "no-model", what)
}

impl Service {
    /// The model of that id.
    ///
    /// # Errors
    /// None is kept.
    pub fn model(&self, Id(key): &Id) -> Result<Arc<Model>, Problem> {
        self.models.find(key).ok_or_else(no_model)
    }

    /// Tells the meters how much is kept.
    pub fn tell_models(&self) {
        meters::level("runset_models_bytes", (self.models.weight() + self.moved.weight()) as usize);
    }
}

/// Keep a model, to be seen from anywhere
///
/// Its id is that of its content: the same document is kept once, and answered with 200 if it is there already. Models are in memory alone, and what was asked for longest ago
/// makes room for others.
#[utoipa::path(
    put,
    path = "/v1/models",
    operation_id = "keep_model",
    tag = "solid",
    request_body(description = "OpenSCAD's .csg or an STL, plain or gzipped", content((String = "text/plain"), (String = "model/stl"))),
    responses(
        (status = 200, description = "It was kept already", body = View, headers(("location" = String, description = "The model's address"))),
        (status = 201, description = "It is kept", body = View, headers(("location" = String, description = "The model's address"))),
        (status = 400, description = "The document is malformed", body = Details, content_type = "application/problem+json"),
        (status = 408, description = "The body stopped", body = Details, content_type = "application/problem+json"),
        (status = 413, description = "The document is too large", body = Details, content_type = "application/problem+json"),
        (status = 415, description = "Not a document that can be read", body = Details, content_type = "application/problem+json"),
        (status = 422, description = "Understood, and refused: imports, limits", body = Details, content_type = "application/problem+json"),
        (status = 503, description = "Busy: try again later", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn put(State(service): State<Service>, RawQuery(query): RawQuery, headers: HeaderMap, body: Body) -> Result<Response, Problem> {
    super::params::nothing(query.as_deref())?;
    let document = service.uploads.read(&service.config, Kind::Solid.documents(), &headers, body).await?;
    let key = document.digest;
    let most = service.config.max_models;
    let make = async || {
        let read = service.drawings.work(move |config| {
            let (kept, warnings) = ask::model(config, &document.bytes)?;
            drop(document);
            Ok(Model { key, kept: Arc::new(kept), warnings })
        });
        let model = read.await?;
        if model.weight() > most {
            let what =
                format!("the model takes {} bytes: at most {most} are kept here (--max-models); POST it to /v1/solid", model.weight());
            return Err(Error::input(error::Kind::Limit, what).into());
        }
        Ok::<Model, Problem>(model)
    };
    let shared = service.models.get(key, most, make).await;
    service.tell_models();
    let shared = shared?;
    let view = View::from(&*shared.thing);
    let location = HeaderValue::from_str(&format!("/v1/models/{}", view.id)).map_err(Problem::internal)?;
    let status = if shared.fresh { StatusCode::CREATED } else { StatusCode::OK };
    Ok((status, [(LOCATION, location)], Json(view)).into_response())
}

/// The models that are kept
#[utoipa::path(
    get,
    path = "/v1/models",
    operation_id = "list_models",
    tag = "solid",
    responses(
        (status = 200, description = "All of them, those that were asked for last first", body = List),
        (status = 400, description = "The query is malformed", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn list(State(service): State<Service>, RawQuery(query): RawQuery) -> Result<Json<List>, Problem> {
    super::params::nothing(query.as_deref())?;
    Ok(Json(List { models: service.models.all().iter().map(|model| View::from(&**model)).collect() }))
}

/// A model that is kept
#[utoipa::path(
    get,
    path = "/v1/models/{id}",
    operation_id = "show_model",
    tag = "solid",
    params(("id" = String, Path, description = "The model's id")),
    responses(
        (status = 200, description = "The model", body = View),
        (status = 404, description = "None of this id is kept", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn show(State(service): State<Service>, id: Id) -> Result<Json<View>, Problem> {
    service.model(&id).map(|model| Json(View::from(&*model)))
}

/// Keep a model no more
///
/// Pictures of it that are being read go on.
#[utoipa::path(
    delete,
    path = "/v1/models/{id}",
    operation_id = "delete_model",
    tag = "solid",
    params(("id" = String, Path, description = "The model's id")),
    responses(
        (status = 204, description = "It is gone"),
        (status = 404, description = "None of this id is kept", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn delete(State(service): State<Service>, Id(key): Id) -> Result<StatusCode, Problem> {
    let removed = service.models.remove(&key);
    service.tell_models();
    if removed { Ok(StatusCode::NO_CONTENT) } else { Err(no_model()) }
}
