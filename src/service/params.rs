//! What a query asks for: the same as the options of the command line.

use axum::extract::FromRequestParts;
use axum::extract::rejection::QueryRejection;
use axum::http::header::ACCEPT;
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use headers::Header as _;
use headers_accept::Accept;
use mediatype::MediaType;
use serde::{Deserialize, Serialize};
use utoipa::openapi::schema::{ObjectBuilder, Schema, Type};
use utoipa::{IntoParams, ToSchema};

use super::problem::Problem;
use crate::encode::{FORMATS, Format, by_name};
use crate::grid::{MAX_HEIGHT, MAX_WIDTH};
use crate::job::{self, Options, Size, TOLERANCE, TOLERANCES};

/// The query of a raster.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct Params {
    /// An expression over the ids of the drawing, instead of its own picture
    #[serde(skip_serializing_if = "Option::is_none")]
    pub expr: Option<String>,
    /// Dots an inch; a user unit is 1/96 inch. One of dpi, scale, and width or height or both
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(minimum = 0.000001, maximum = 1000000000.0)]
    pub dpi: Option<f64>,
    /// Pixels to a user unit
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(minimum = 0.000001, maximum = 1000000000.0)]
    pub scale: Option<f64>,
    /// Width of the page in pixels; alone it keeps the aspect, with height the drawing is fitted inside and centred
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(minimum = 1, maximum = 1048576)]
    pub width: Option<u32>,
    /// Height of the page in pixels; alone it keeps the aspect
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(minimum = 1, maximum = 8388608)]
    pub height: Option<u32>,
    /// Name of the format
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(schema_with = format_name)]
    pub format: Option<String>,
    /// Only these scanlines, Y0..Y1, half-open, counted from 0
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(pattern = r"^\d{1,7}\.\.\d{1,7}$")]
    pub lines: Option<String>,
    /// Farthest that a flattened curve may be from the true one, in pixels
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(minimum = 0.001, maximum = 16.0)]
    pub tolerance: Option<f64>,
    /// For jobs: what is made of the document
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(ignore)]
    pub kind: Option<Kind>,
}

/// What a job makes of its document.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Plane shapes.
    Fill,
}

/// The schema of a format's name.
fn format_name() -> Schema {
    let names = FORMATS.iter().map(|format| format.name);
    ObjectBuilder::new().schema_type(Type::String).enum_values(Some(names)).into()
}

/// Longest expression in a query, in bytes; longer ones go into a scene.
const LONGEST_EXPRESSION: usize = 1 << 16;

impl Params {
    /// What they ask of a document.
    ///
    /// # Errors
    /// Values out of bounds, or that contradict each other.
    pub fn options(&self) -> Result<Options, Problem> {
        let number = |name: &str, value: Option<f64>| match value {
            Some(value) if !(value.is_finite() && value > 0.0) => {
                Err(Problem::malformed(format!("{name} is {value}: give a number above 0")))
            }
            value => Ok(value),
        };
        let pixels = |name: &str, value: Option<u32>, most: u32| match value {
            Some(value) if !(1..=most).contains(&value) => {
                Err(Problem::malformed(format!("{name} is {value}: give a whole number from 1 to {most}")))
            }
            value => Ok(value),
        };
        let size = match (number("dpi", self.dpi)?, number("scale", self.scale)?, self.width, self.height) {
            (None, scale, None, None) => Size::Scale(scale.unwrap_or(1.0)),
            (Some(dpi), None, None, None) => Size::Dpi(dpi),
            (None, None, width, height) => {
                Size::Pixels { width: pixels("width", width, MAX_WIDTH)?, height: pixels("height", height, MAX_HEIGHT)? }
            }
            _ => return Err(Problem::malformed("dpi, scale, and width and height exclude each other: give one of the three")),
        };
        let tolerance = self.tolerance.unwrap_or(TOLERANCE);
        if !TOLERANCES.contains(&tolerance) {
            let what = format!("tolerance is {tolerance}: give a number of pixels from {} to {}", TOLERANCES.start(), TOLERANCES.end());
            return Err(Problem::malformed(what));
        }
        let lines = self.lines.as_deref().map(job::lines).transpose().map_err(|what| Problem::malformed(format!("lines: {what}")))?;
        if self.expr.as_ref().is_some_and(|expr| expr.len() > LONGEST_EXPRESSION) {
            let what = format!("expr has more than {LONGEST_EXPRESSION} bytes: put it into a scene");
            return Err(Problem::new(StatusCode::UNPROCESSABLE_ENTITY, "limit", what));
        }
        Ok(Options { expr: self.expr.clone(), size, lines, tolerance, ..Options::default() })
    }

    /// The format that was named, or that the client likes best; without a wish the command line's default.
    ///
    /// # Errors
    /// An unknown name; only media types that there are not.
    pub fn format(&self, headers: &HeaderMap) -> Result<&'static Format, Problem> {
        let names = || FORMATS.iter().map(|format| format.name).collect::<Vec<_>>().join(", ");
        if let Some(name) = &self.format {
            return by_name(name).ok_or_else(|| Problem::malformed(format!("format is {name:?}: give one of {}", names())));
        }
        let default = by_name("ndjson").expect("the default format exists");
        let mut accepts = headers.get_all(ACCEPT).iter().peekable();
        if accepts.peek().is_none() {
            return Ok(default);
        }
        let accept = Accept::decode(&mut accepts).map_err(|_| Problem::malformed("Accept is not a list of media types"))?;
        // The default first: who takes everything gets it.
        let ours: Vec<_> = std::iter::once(default).chain(FORMATS).map(|format| (media_type(format), format)).collect();
        let best = accept.negotiate(ours.iter().map(|(media_type, _)| media_type));
        let best = best.and_then(|best| ours.iter().find(|(media_type, _)| media_type == best));
        best.map(|(_, format)| *format).ok_or_else(|| {
            let types = FORMATS.iter().map(|format| format.media_type).collect::<Vec<_>>().join(", ");
            let what = format!("no raster of the media types that are accepted: there are {types}, or ?format= with one of {}", names());
            Problem::new(StatusCode::NOT_ACCEPTABLE, "not-acceptable", what)
        })
    }
}

fn media_type(format: &Format) -> MediaType<'static> {
    MediaType::parse(format.media_type).expect("the table's media types are well-formed")
}

/// The value of `Content-Type`.
pub fn content_type(format: &Format) -> HeaderValue {
    HeaderValue::from_static(format.media_type)
}

impl<S: Send + Sync> FromRequestParts<S> for Params {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Params, Problem> {
        let query = axum::extract::Query::<Params>::from_request_parts(parts, state).await;
        query.map(|query| query.0).map_err(|rejection| Problem::malformed(query_fault(&rejection)))
    }
}

/// What is wrong with a query, in one line.
pub fn query_fault(rejection: &QueryRejection) -> String {
    let text = rejection.body_text();
    text.strip_prefix("Failed to deserialize query string: ").map_or(text.clone(), |what| format!("the query: {what}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn best(accept: &str) -> Result<&'static str, StatusCode> {
        let headers = HeaderMap::from_iter([(ACCEPT, accept.parse().unwrap())]);
        Params::default()
            .format(&headers)
            .map(|format| format.name)
            .map_err(|problem| axum::response::IntoResponse::into_response(problem).status())
    }

    #[test]
    fn what_is_accepted_decides_on_the_format() {
        assert_eq!(Params::default().format(&HeaderMap::new()).unwrap().name, "ndjson");
        for (accept, name) in [
            ("*/*", "ndjson"),
            ("image/png", "png"),
            ("image/*", "pbm"),
            ("image/png;q=0.5, image/x-portable-pixmap", "ppm"),
            ("text/html, image/png;q=0.9, */*;q=0.1", "png"),
            ("application/vnd.runset.rls, */*;q=0.1", "rls"),
            ("image/png;q=0, */*;q=0.5", "ndjson"),
        ] {
            assert_eq!(best(accept), Ok(name), "{accept}");
        }
        assert_eq!(best("text/html"), Err(StatusCode::NOT_ACCEPTABLE));
        assert_eq!(best("image/png;q=0"), Err(StatusCode::NOT_ACCEPTABLE));
        assert_eq!(best("nonsense"), Err(StatusCode::BAD_REQUEST));
    }

    #[test]
    fn sizes_exclude_each_other() {
        let bad = |params: Params| assert!(params.options().is_err(), "{params:?}");
        bad(Params { dpi: Some(1.0), scale: Some(1.0), ..Params::default() });
        bad(Params { scale: Some(1.0), width: Some(1), ..Params::default() });
        bad(Params { dpi: Some(f64::NAN), ..Params::default() });
        bad(Params { scale: Some(-1.0), ..Params::default() });
        bad(Params { width: Some(0), ..Params::default() });
        bad(Params { tolerance: Some(0.0), ..Params::default() });
        bad(Params { lines: Some("5..5".to_owned()), ..Params::default() });
        let fit = Params { width: Some(3), height: Some(4), lines: Some("0..4".to_owned()), ..Params::default() }.options().unwrap();
        assert_eq!((fit.size, fit.lines), (Size::Pixels { width: Some(3), height: Some(4) }, Some(0..4)));
    }
}
