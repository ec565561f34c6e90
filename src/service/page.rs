//! The page: what a browser shows at `/`, and the samples, all of it in the program.
//!
//! Everything has a tag of its content and is asked for again each time, so that a new program brings a new page at once. Nothing from elsewhere is allowed in: the
//! policy names this origin alone, and neither scripts nor styles within the document.

use axum::extract::Path;
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, ETAG, HeaderName, HeaderValue, IF_NONE_MATCH, REFERRER_POLICY,
    X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use headers::{ETag, HeaderMapExt, IfNoneMatch};
use rust_embed::{EmbeddedFile, RustEmbed};

use super::Service;
use super::problem::Problem;

/// The page. While debug assertions are on it is read from the folder each time.
#[derive(RustEmbed)]
#[folder = "web/"]
struct Web;

/// The sample drawings.
#[derive(RustEmbed)]
#[folder = "examples/art/"]
#[include = "*.svg"]
#[include = "*.json"]
struct Samples;

/// The sample models.
#[derive(RustEmbed)]
#[folder = "examples/models/"]
#[include = "*.csg"]
struct Models;

const POLICY: &str = "default-src 'none'; script-src 'self'; worker-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; \
                      base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// The addresses of the page.
pub fn routes() -> axum::Router<Service> {
    axum::Router::new()
        .route("/", get(|headers: HeaderMap| async move { answer("index.html", Web::get("index.html"), &headers) }))
        .route("/web/{*name}", get(|Path(name): Path<String>, headers: HeaderMap| async move { answer(&name, Web::get(&name), &headers) }))
        .route(
            "/samples/{name}",
            get(|Path(name): Path<String>, headers: HeaderMap| async move {
                answer(&name, Samples::get(&name).or_else(|| Models::get(&name)), &headers)
            }),
        )
}

fn answer(name: &str, file: Option<EmbeddedFile>, asked: &HeaderMap) -> Result<Response, Problem> {
    let missing = || Problem::new(StatusCode::NOT_FOUND, "not-found", "there is nothing here: see /openapi.json");
    let file = file.ok_or_else(missing)?;
    let digest: String = file.metadata.sha256_hash()[..16].iter().map(|byte| format!("{byte:02x}")).collect();
    let tag = format!("\"{digest}\"");
    let etag: ETag = tag.parse().expect("a tag of hexadecimal digits in quotes is one");
    let known = asked.contains_key(IF_NONE_MATCH) && asked.typed_get::<IfNoneMatch>().is_some_and(|tags| !tags.precondition_passes(&etag));
    let mut response = if known { StatusCode::NOT_MODIFIED.into_response() } else { file.data.into_response() };
    let fields: [(HeaderName, &str); 6] = [
        (CONTENT_TYPE, media_type(name)),
        (CACHE_CONTROL, "no-cache"),
        (CONTENT_SECURITY_POLICY, POLICY),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (REFERRER_POLICY, "no-referrer"),
        (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    ];
    for (field, value) in fields {
        response.headers_mut().insert(field, HeaderValue::from_str(value).map_err(Problem::internal)?);
    }
    response.headers_mut().insert(ETAG, HeaderValue::from_str(&tag).map_err(Problem::internal)?);
    Ok(response)
}

fn media_type(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("json") => "application/json",
        Some("csg") => "text/plain; charset=utf-8",
        Some("svg") => "image/svg+xml",
        _ => "application/octet-stream",
    }
}
