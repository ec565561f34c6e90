//! What a query asks for: the same as the options of the command line.

mod fill;
mod solid;
mod view;

pub use self::fill::FillParams;
pub use self::solid::SolidParams;
pub use self::view::{MoveParams, ViewParams};

use axum::http::header::ACCEPT;
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use headers::Header as _;
use headers_accept::Accept;
use mediatype::MediaType;
use serde::de::{DeserializeOwned, Error as _};
use serde::{Deserialize, Deserializer, Serialize};
use sha2::{Digest as _, Sha256};
use utoipa::ToSchema;
use utoipa::openapi::schema::{ObjectBuilder, Schema, Type};

use super::ask::Ask;
use super::cache::Key;
use super::problem::Problem;
use crate::encode::{FORMATS, Format, by_name, variants};
use crate::job;

/// What is made of a document.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Plane shapes.
    Fill,
    /// A model of solids in a view.
    Solid,
}

impl Kind {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Fill => "fill",
            Kind::Solid => "solid",
        }
    }

    /// The media types of its documents.
    pub fn documents(self) -> &'static [&'static str] {
        match self {
            Kind::Fill => &["image/svg+xml", "application/json"],
            // The registered type of an STL, and what browsers and desktops call it.
            Kind::Solid => &["text/plain", "model/stl", "application/sla", "application/vnd.ms-pki.stl"],
        }
    }
}

/// The query of a raster, of one kind or the other. Stored with a job; what is stored without a kind is a fill.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Params {
    /// Of plane shapes.
    Fill(FillParams),
    /// Of a model.
    Solid(SolidParams),
}

impl<'de> Deserialize<'de> for Params {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Params, D::Error> {
        #[derive(Deserialize)]
        struct Stored {
            kind: Option<Kind>,
            #[serde(flatten)]
            rest: serde_json::Value,
        }
        let Stored { kind, rest } = Stored::deserialize(from)?;
        let params = match kind.unwrap_or(Kind::Fill) {
            Kind::Fill => serde_json::from_value(rest).map(Params::Fill),
            Kind::Solid => serde_json::from_value(rest).map(Params::Solid),
        };
        params.map_err(D::Error::custom)
    }
}

impl Params {
    /// Those of a query that says `kind` itself.
    ///
    /// # Errors
    /// Unknown names; values that are none of theirs.
    pub fn of_job(query: &str) -> Result<Params, Problem> {
        let (kinds, rest) = take(query, "kind");
        match kinds.iter().map(String::as_str).collect::<Vec<_>>()[..] {
            [] | ["fill"] => FillParams::read(&rest).map(Params::Fill),
            ["solid"] => SolidParams::read(&rest).map(Params::Solid),
            _ => Err(Problem::malformed(format!("kind is {:?}: give fill or solid, once", kinds.join(", ")))),
        }
    }

    /// What they make of a document.
    pub fn kind(&self) -> Kind {
        match self {
            Params::Fill(_) => Kind::Fill,
            Params::Solid(_) => Kind::Solid,
        }
    }

    /// What they ask of a document.
    ///
    /// # Errors
    /// Values out of bounds, or that contradict each other.
    pub fn ask(&self) -> Result<Ask, Problem> {
        match self {
            Params::Fill(params) => params.options().map(Ask::Fill),
            Params::Solid(params) => params.options().map(Ask::Solid),
        }
    }

    /// The format that was named, or that the client likes best; without a wish the command line's default.
    ///
    /// # Errors
    /// An unknown name; only media types that there are not.
    pub fn format(&self, headers: &HeaderMap) -> Result<&'static Format, Problem> {
        let (name, default) = match self {
            Params::Fill(params) => (&params.format, "ndjson"),
            Params::Solid(params) => (&params.format, "png"),
        };
        format(name.as_deref(), self.compression(), default, headers)
    }

    /// The compression that was named.
    pub fn compression(&self) -> Option<&str> {
        match self {
            Params::Fill(params) => params.compression.as_deref(),
            Params::Solid(params) => params.compression.as_deref(),
        }
    }

    /// What tells the drawing from others: its document and what is asked, but for the format.
    pub fn key(&self, digest: &[u8; 32]) -> Key {
        let asked = match self {
            Params::Fill(params) => serde_json::to_string(&FillParams { format: None, compression: None, ..params.clone() }),
            Params::Solid(params) => {
                serde_json::to_string(&Params::Solid(SolidParams { format: None, compression: None, ..params.clone() }))
            }
        };
        let asked = asked.expect("numbers and strings under fixed names are JSON");
        Sha256::new().chain_update(digest).chain_update(asked).finalize().into()
    }
}

/// Reads a query in which every name stands once.
///
/// # Errors
/// Unknown names; values that are none of theirs.
pub fn read<T: DeserializeOwned>(query: &str) -> Result<T, Problem> {
    let pairs = serde_urlencoded::Deserializer::new(form_urlencoded::parse(query.as_bytes()));
    serde_path_to_error::deserialize(pairs).map_err(|error| Problem::malformed(format!("the query: {error}")))
}

/// Reads the query of a call that takes none.
///
/// # Errors
/// It is one.
pub fn nothing(query: Option<&str>) -> Result<(), Problem> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Nothing {}
    read::<Nothing>(query.unwrap_or_default()).map(|_| ())
}

/// Takes a name out of a query: its values, and the query without it.
fn take(query: &str, name: &str) -> (Vec<String>, String) {
    let mut values = Vec::new();
    let mut rest = form_urlencoded::Serializer::new(String::new());
    for (key, value) in form_urlencoded::parse(query.as_bytes()) {
        if key == name {
            values.push(value.into_owned());
        } else {
            rest.append_pair(&key, &value);
        }
    }
    (values, rest.finish())
}

/// Takes a whole number out of a query, which must give it once.
///
/// # Errors
/// It is missing, given again, or something else.
pub fn take_number(query: &str, name: &str) -> Result<(u32, String), Problem> {
    let (values, rest) = take(query, name);
    let number = if let [value] = &values[..] { value.parse().ok() } else { None };
    let wrong = || Problem::malformed(format!("{name} is {:?}: give a whole number, once", values.join(", ")));
    Ok((number.ok_or_else(wrong)?, rest))
}

/// The scanlines that a query names.
fn lines(text: Option<&str>) -> Result<Option<std::ops::Range<u32>>, Problem> {
    text.map(job::lines).transpose().map_err(|what| Problem::malformed(format!("lines: {what}")))
}

/// The schema of a format's name.
fn format_name() -> Schema {
    let names = FORMATS.iter().map(|format| format.name);
    ObjectBuilder::new().schema_type(Type::String).enum_values(Some(names)).into()
}

/// The schema of a compression's name.
fn compression_name() -> Schema {
    let mut names: Vec<_> = variants().filter_map(Format::compression_name).collect();
    names.sort_unstable();
    names.dedup();
    ObjectBuilder::new().schema_type(Type::String).enum_values(Some(names)).into()
}

/// The format of a name, or the one that the client likes best, which is `default` if it takes everything; in the compression of a name.
///
/// # Errors
/// An unknown name; only media types that there are not; a compression that the format does not have.
pub fn format(name: Option<&str>, compression: Option<&str>, default: &str, headers: &HeaderMap) -> Result<&'static Format, Problem> {
    let format = accepted(name, default, headers)?;
    format.compressed(compression).map_err(|what| Problem::malformed(format!("compression: {what}")))
}

fn accepted(name: Option<&str>, default: &str, headers: &HeaderMap) -> Result<&'static Format, Problem> {
    let names = || FORMATS.iter().map(|format| format.name).collect::<Vec<_>>().join(", ");
    if let Some(name) = name {
        return by_name(name).ok_or_else(|| Problem::malformed(format!("format is {name:?}: give one of {}", names())));
    }
    let default = by_name(default).expect("the default format exists");
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

fn media_type(format: &Format) -> MediaType<'static> {
    MediaType::parse(format.media_type).expect("the table's media types are well-formed")
}

/// The value of `Content-Type`.
pub fn content_type(format: &Format) -> HeaderValue {
    HeaderValue::from_static(format.media_type)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn best(accept: &str) -> Result<&'static str, StatusCode> {
        let headers = HeaderMap::from_iter([(ACCEPT, accept.parse().unwrap())]);
        format(None, None, "ndjson", &headers)
            .map(|format| format.name)
            .map_err(|problem| axum::response::IntoResponse::into_response(problem).status())
    }

    #[test]
    fn what_is_accepted_decides_on_the_format() {
        assert_eq!(format(None, None, "ndjson", &HeaderMap::new()).unwrap().name, "ndjson");
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
        assert_eq!(format(None, None, "png", &HeaderMap::from_iter([(ACCEPT, "image/*".parse().unwrap())])).unwrap().name, "png");
    }

    #[test]
    fn a_job_says_its_kind() {
        let kind = |query: &str| Params::of_job(query).map(|params| params.kind());
        assert_eq!(kind("width=5").unwrap(), Kind::Fill);
        assert_eq!(kind("width=5&kind=fill").unwrap(), Kind::Fill);
        assert_eq!(kind("kind=solid&imgsize=5,5").unwrap(), Kind::Solid);
        for query in ["kind=both", "kind=", "kind=fill&kind=fill", "kind=solid&width=5", "imgsize=5,5", "width=5&width=5"] {
            assert!(kind(query).is_err(), "{query}");
        }
    }

    #[test]
    fn what_was_stored_is_read_again() {
        let stored = |text: &str| serde_json::from_str::<Params>(text).unwrap();
        let fill = FillParams { dpi: Some(0.1), lines: Some("0..4".to_owned()), ..FillParams::default() };
        // As versions that knew one kind stored it.
        assert_eq!(stored(r#"{"dpi":0.1,"lines":"0..4"}"#), Params::Fill(fill.clone()));
        assert_eq!(stored(r#"{"dpi":0.1,"lines":"0..4","kind":"fill"}"#), Params::Fill(fill.clone()));
        let solid = Params::of_job("kind=solid&section=1,0,0,5&section=0,0,1,2&viewall=true").unwrap();
        for params in [Params::Fill(fill), solid] {
            assert_eq!(stored(&serde_json::to_string(&params).unwrap()), params);
        }
    }
}
