//! What is asked about a drawing besides its raster: `POST /v1/info`, its names, and `POST /v1/explain`, how its scanlines come about.

use axum::Json;
use axum::body::Body;
use axum::extract::{RawQuery, State};
use axum::http::HeaderMap;
use serde::Serialize;
use utoipa::ToSchema;

use super::ask::scene;
use super::params::{FillParams, Kind};
use super::problem::{Details, Problem};
use super::{Service, answer, params};
use crate::job::{Explanation, Info, explain as how, info as names};

/// A drawing's names, and what is drawn but not supported.
#[derive(Serialize, ToSchema)]
pub struct Names {
    #[serde(flatten)]
    info: Info,
    /// What is drawn but not supported.
    warnings: Vec<String>,
}

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
    RawQuery(query): RawQuery,
    headers: HeaderMap,
    body: Body,
) -> Result<Json<Names>, Problem> {
    params::nothing(query.as_deref())?;
    let document = service.uploads.read(&service.config, Kind::Fill.documents(), &headers, body).await?;
    let work = service.drawings.work(move |config| {
        let _room = document.room;
        let (scene, warnings) = scene(config, document.bytes.into())?;
        Ok(Names { info: names(&scene)?, warnings: warnings.iter().map(answer::said).collect() })
    });
    work.await.map(Json)
}

/// How scanlines come about
///
/// Tells of the lines that `lines` names, or all, which of them were counted; if `lines` names one alone, also its crossings from left to right, and what each
/// did to the counts of the expression. `format` and `compression` are of no use here.
#[utoipa::path(
    post,
    path = "/v1/explain",
    tag = "fill",
    params(FillParams),
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
pub async fn explain(
    State(service): State<Service>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
    body: Body,
) -> Result<Json<Explanation>, Problem> {
    let params = FillParams::read(&query.unwrap_or_default())?;
    params::format(params.format.as_deref(), params.compression.as_deref(), "ndjson", &HeaderMap::new())?;
    let mut options = params.options()?;
    let document = service.uploads.read(&service.config, Kind::Fill.documents(), &headers, body).await?;
    let work = service.drawings.work(move |config| {
        let _room = document.room;
        options.limits = config.limits;
        let (scene, mut warnings) = scene(config, document.bytes.into())?;
        Ok(how(scene, &options, &mut warnings)?)
    });
    work.await.map(Json)
}

#[cfg(test)]
mod tests {
    use axum::body::Body;
    use axum::http::{Request, StatusCode};
    use axum::response::Response;
    use http_body_util::BodyExt;
    use serde_json::{Value, json};
    use tower::ServiceExt;

    use crate::service::{Config, Service, app};

    const SCENE: &str = r#"{"width":16,"height":4,"expr":"a - b","shapes":{
        "a":{"rings":[[[4,0],[10,0],[10,4],[4,4]]]},"b":{"rings":[[[7,1],[14,1],[14,4],[7,4]]]}}}"#;

    async fn ask(method: &str, uri: &str, body: &str, header: Option<(&str, &str)>) -> Response {
        let folder = tempfile::tempdir().unwrap();
        let service = Service::open(Config::new(folder.path().to_owned())).unwrap();
        let mut request = Request::builder().method(method).uri(uri).header("host", "localhost").header("content-type", "application/json");
        if let Some((name, value)) = header {
            request = request.header(name, value);
        }
        app(&service).oneshot(request.body(Body::from(body.to_owned())).unwrap()).await.unwrap()
    }

    async fn post(uri: &str) -> (StatusCode, Value) {
        let response = ask("POST", uri, SCENE, None).await;
        let (status, body) = (response.status(), response.into_body().collect().await.unwrap().to_bytes());
        (status, serde_json::from_slice(&body).unwrap())
    }

    #[tokio::test]
    async fn names_and_lines_are_told() {
        let (status, names) = post("/v1/info").await;
        assert_eq!(status, StatusCode::OK);
        let ids: Vec<_> = names["ids"].as_array().unwrap().iter().map(|id| (id["id"].clone(), id["bounds"].clone())).collect();
        assert_eq!(ids, [(json!("a"), json!([4.0, 0.0, 10.0, 4.0])), (json!("b"), json!([7.0, 1.0, 14.0, 4.0]))]);
        assert_eq!(names["warnings"], json!([]));
        assert_eq!(post("/v1/info?width=3").await.0, StatusCode::BAD_REQUEST);

        let (status, all) = post("/v1/explain").await;
        assert_eq!(status, StatusCode::OK);
        assert_eq!(all["lines"], json!([[0, 2, "counted"], [2, 2, "repeated"]]));
        assert_eq!(all["line"], Value::Null);
        let (_, one) = post("/v1/explain?lines=3..4").await;
        assert_eq!((&one["line"]["since"], &one["line"]["runs"]), (&json!(1), &json!([[4, 7, 0]])));
        let columns: Vec<_> = one["line"]["steps"].as_array().unwrap().iter().map(|step| step["column"].clone()).collect();
        assert_eq!(columns, [4, 7, 10, 14]);
        let (status, problem) = post("/v1/explain?expr=a%20-%20c").await;
        assert_eq!((status, &problem["column"]), (StatusCode::UNPROCESSABLE_ENTITY, &json!(5)));
        assert_eq!(post("/v1/explain?lines=4..5").await.0, StatusCode::UNPROCESSABLE_ENTITY);
        assert_eq!(post("/v1/explain?nothing=1").await.0, StatusCode::BAD_REQUEST);
    }

    #[tokio::test]
    async fn the_page_is_sent_once() {
        let page = ask("GET", "/", "", None).await;
        assert_eq!(page.status(), StatusCode::OK);
        assert!(page.headers()["content-security-policy"].to_str().unwrap().starts_with("default-src 'none'; "));
        let tag = page.headers()["etag"].to_str().unwrap().to_owned();
        assert_eq!(ask("GET", "/", "", Some(("if-none-match", &tag))).await.status(), StatusCode::NOT_MODIFIED);
        assert_eq!(ask("HEAD", "/samples/poster.svg", "", None).await.headers()["content-type"], "image/svg+xml");
        for missing in ["/web/../Cargo.toml", "/web/%2e%2e/Cargo.toml", "/samples/poster.py", "/web/"] {
            assert_eq!(ask("GET", missing, "", None).await.status(), StatusCode::NOT_FOUND, "{missing}");
        }
        assert_eq!(ask("POST", "/", "", None).await.status(), StatusCode::METHOD_NOT_ALLOWED);
    }
}
