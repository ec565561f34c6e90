//! Views of kept models: pictures, also with primitives moved, and what a pixel of one shows.
//!
//! ```text
//!   kept --moved--> as long as it is dragged --staged--> drawing --swept--> all lines, or those that a move has changed
//! ```
//!
//! A model that was moved is identified once, and kept for the next picture, which is made from it or compared with it: those that were asked for last, [`Config::cache`](super::Config::cache)
//! bytes of them, and two of a larger model.

use std::sync::Arc;

use axum::Json;
use axum::extract::{RawQuery, State};
use axum::http::header::{CONTENT_LENGTH, CONTENT_TYPE, ETAG, VARY};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use sha2::{Digest as _, Sha256};
use utoipa::ToSchema;

use super::Service;
use super::answer::{self, Asker};
use super::cache::{Cache, Key, Weigh};
use super::drawings::bounded;
use super::models::{Id, Model};
use super::params::{Kind, MoveParams, Params, SolidParams, ViewParams, content_type, take_number};
use super::problem::{Details, Problem};
use crate::encode::Format;
use crate::job::{Job, Kept, Move, SolidOptions};

/// Models with primitives moved.
pub type Moved = Cache<Kept>;

impl Weigh for Kept {
    fn weight(&self) -> u64 {
        Kept::weight(self)
    }
}

/// A view of a model that is kept
///
/// Nothing is read again: it is the picture that `POST /v1/solid` makes of the same document and query, but for primitives that are moved. The tag is strong and stands for model, query, format and
/// version. With `from`, the raster is a slice: line streams say in their header which lines it holds, and over the picture that the client has they make the whole.
#[utoipa::path(
    get,
    path = "/v1/models/{id}/view",
    operation_id = "view_model",
    tag = "solid",
    params(
        ("id" = String, Path, description = "The model's id"),
        ("If-None-Match" = Option<String>, Header, description = "Nothing if this is the picture's tag"),
        SolidParams,
        MoveParams,
    ),
    responses(
        (status = 200, description = "The picture"),
        (status = 304, description = "It has not changed"),
        (status = 400, description = "The query is malformed", body = Details, content_type = "application/problem+json"),
        (status = 404, description = "None of this id is kept", body = Details, content_type = "application/problem+json"),
        (status = 406, description = "No such media type", body = Details, content_type = "application/problem+json"),
        (status = 422, description = "Understood, and refused: limits", body = Details, content_type = "application/problem+json"),
        (status = 503, description = "Busy: try again later", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn view(
    State(service): State<Service>,
    id: Id,
    asker: Asker,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let picture = match picture(&service, &id, query.as_deref(), &headers)? {
        Ok(picture) => picture,
        Err(unchanged) => return Ok(unchanged),
    };
    let place = service.place()?;
    let Picture { model, options, moves, from, key, format, tag } = picture;
    let kept = service.moved(&model, moves).await?;
    let before = match from {
        Some(moves) => Some(service.moved(&model, moves).await?),
        None => None,
    };
    let make = move |_: &_| {
        let lines = match before {
            Some(before) => Some(hull(&kept.changed(&before, &options)?)),
            None => options.lines.clone(),
        };
        Ok((Job::solid(&kept, &SolidOptions { started: asker.started, lines, ..options })?, model.warnings.clone()))
    };
    let shared = service.drawings.get(key, Box::new(make)).await?;
    let mut response = answer::stream(service, asker, Kind::Solid, shared, format, place)?;
    response.headers_mut().insert(ETAG, tag);
    response.headers_mut().insert(VARY, HeaderValue::from_static("accept"));
    Ok(response)
}

/// What is known of a view of a model, without it
#[utoipa::path(
    head,
    path = "/v1/models/{id}/view",
    operation_id = "head_of_view",
    tag = "solid",
    params(("id" = String, Path, description = "The model's id"), SolidParams, MoveParams),
    responses((status = 200, description = "Its type, tag, and length if the format fixes it"), (status = 404, description = "None of this id is kept"))
)]
pub async fn view_head(State(service): State<Service>, id: Id, RawQuery(query): RawQuery, headers: HeaderMap) -> Result<Response, Problem> {
    let picture = match picture(&service, &id, query.as_deref(), &headers)? {
        Ok(picture) => picture,
        Err(unchanged) => return Ok(unchanged),
    };
    let mut response = answer::no_body().into_response();
    let fields = response.headers_mut();
    fields.insert(CONTENT_TYPE, content_type(picture.format));
    fields.insert(ETAG, picture.tag);
    fields.insert(VARY, HeaderValue::from_static("accept"));
    // Which lines a move has changed is not known without the model.
    let length = if picture.from.is_none() { (picture.format.encoder)(&picture.options.header()?).length() } else { None };
    if let Some(length) = length {
        fields.insert(CONTENT_LENGTH, HeaderValue::from(length));
    }
    Ok(response)
}

/// The lines from the first range to the last; one where there is none.
fn hull(ranges: &[std::ops::Range<u32>]) -> std::ops::Range<u32> {
    ranges.iter().cloned().reduce(|all, range| all.start..range.end).unwrap_or(0..1)
}

impl Service {
    /// A kept model with some of its primitives moved.
    async fn moved(&self, model: &Arc<Model>, moves: Vec<Move>) -> Result<Arc<Kept>, Problem> {
        if moves.is_empty() {
            return Ok(model.kept.clone());
        }
        let keep = self.config.cache.max(2 * model.kept.weight()).min(self.config.max_models);
        let numbers = moves.iter().flat_map(|Move { part, by }| [*part as u64].into_iter().chain(by.map(f64::to_bits)));
        let key = numbers.fold(Sha256::new().chain_update(model.key), |key, number| key.chain_update(number.to_be_bytes()));
        let kept = model.kept.clone();
        let make = async || self.drawings.work(move |config| Ok(kept.moved(&moves, &config.limits)?)).await;
        let shared = self.moved.get(key.finalize().into(), keep, make).await;
        self.tell_models();
        shared.map(|shared| shared.thing)
    }
}

/// A view that is asked for.
struct Picture {
    model: Arc<Model>,
    options: SolidOptions,
    moves: Vec<Move>,
    /// The moves of the picture that the client has.
    from: Option<Vec<Move>>,
    /// That of the drawing: the same as of the document with that query.
    key: Key,
    format: &'static Format,
    tag: HeaderValue,
}

/// What is asked for, or that nothing has changed.
fn picture(service: &Service, id: &Id, query: Option<&str>, headers: &HeaderMap) -> Result<Result<Picture, Response>, Problem> {
    let model = service.model(id)?;
    let asked = ViewParams::read(query.unwrap_or_default())?;
    let (moves, from, options) = (asked.moves.moves()?, asked.moves.from()?, asked.solid.options()?);
    let key = key(&model, &asked);
    let format = Params::Solid(asked.solid).format(headers)?;
    bounded(&service.config, &options.header()?)?;
    let tag = answer::tag(&key, &service.config.fonts, format);
    let known = answer::is_known(&tag, headers)?;
    let tag = HeaderValue::from_str(&tag).map_err(Problem::internal)?;
    Ok(if known {
        Err((StatusCode::NOT_MODIFIED, [(ETAG, tag)]).into_response())
    } else {
        Ok(Picture { model, options, moves, from, key, format, tag })
    })
}

/// The key of a drawing: without moves that of the document with that query.
fn key(model: &Model, asked: &ViewParams) -> Key {
    let params = Params::Solid(asked.solid.clone());
    if asked.moves == MoveParams::default() {
        return params.key(&model.key);
    }
    let moves = serde_json::to_string(&asked.moves).expect("strings under fixed names are JSON");
    params.key(&Sha256::new().chain_update(model.key).chain_update(moves).finalize().into())
}

/// What a pixel shows.
#[derive(Serialize, ToSchema)]
pub struct Picked {
    /// The primitive, counted from 1 in document order.
    primitive: u64,
    /// What it is, in one word: `cube`, `polyhedron`.
    kind: &'static str,
    /// The line on which it begins in the document, from 1; none in an STL.
    line: Option<u32>,
    /// The column in characters, from 1.
    column: Option<u32>,
    /// Whether it is seen from inside: it is taken away there.
    inside: bool,
    /// The normal of the surface there, towards the eye.
    normal: [f64; 3],
    /// The point of the surface.
    point: [f64; 3],
    /// Its distance from the eye along the view.
    depth: f64,
    /// The first three rows of the matrix from the primitive's own coordinates to the model's, without moves of the query.
    matrix: [[f64; 4]; 3],
}

/// What a pixel of a view shows
///
/// The primitive that is seen there, with its place in the document, and the point of its surface; `null` where that is the background. One scanline of the view is drawn. `lines` and `format` are of no
/// use here.
#[utoipa::path(
    get,
    path = "/v1/models/{id}/pick",
    operation_id = "pick",
    tag = "solid",
    params(
        ("id" = String, Path, description = "The model's id"),
        ("x" = u32, Query, description = "The column, counted from 0"),
        ("y" = u32, Query, description = "The scanline, counted from 0"),
        ("move" = Option<Vec<String>>, Query, description = "As of the view"),
        SolidParams,
    ),
    responses(
        (status = 200, description = "What is seen there", body = Option<Picked>),
        (status = 400, description = "The query is malformed, or the pixel not on the page", body = Details, content_type = "application/problem+json"),
        (status = 404, description = "None of this id is kept", body = Details, content_type = "application/problem+json"),
        (status = 422, description = "Understood, and refused: limits", body = Details, content_type = "application/problem+json"),
        (status = 503, description = "Busy: try again later", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn pick(State(service): State<Service>, id: Id, RawQuery(query): RawQuery) -> Result<Json<Option<Picked>>, Problem> {
    let model = service.model(&id)?;
    let (x, rest) = take_number(&query.unwrap_or_default(), "x")?;
    let (y, rest) = take_number(&rest, "y")?;
    let mut asked = ViewParams::read(&rest)?;
    if !asked.moves.from.is_empty() {
        return Err(Problem::malformed("from is for pictures: leave it out"));
    }
    Params::Solid(asked.solid.clone()).format(&HeaderMap::new())?;
    let (moves, options) = (asked.moves.moves()?, asked.solid.options()?);
    let (width, height) = (options.setup.width, options.setup.height);
    if x >= width || y >= height {
        return Err(Problem::malformed(format!("pixel {x}, {y} is not on the page: it has {width} x {height}")));
    }
    let options = SolidOptions { lines: None, ..options };
    bounded(&service.config, &options.header()?)?;
    // The drawing of the whole page: whoever points at a pixel has just been shown it.
    asked.solid.lines = None;
    let key = key(&model, &asked);
    let kept = service.moved(&model, moves).await?;
    let warnings = model.warnings.clone();
    let make = move |_: &_| Ok((Job::solid(&kept, &options)?, warnings));
    let shared = service.drawings.get(key, Box::new(make)).await?;
    let found = service.drawings.work(move |_| Ok(shared.thing.job.pick(x, y))).await?;
    Ok(Json(found.and_then(|pick| {
        let part = model.kept.part(pick.part)?;
        Some(Picked {
            primitive: pick.part as u64 + 1,
            kind: part.kind,
            line: part.place.map(|place| place.line),
            column: part.place.map(|place| place.column),
            inside: pick.inside,
            normal: pick.normal,
            point: pick.point,
            depth: pick.depth,
            matrix: part.matrix,
        })
    })))
}
