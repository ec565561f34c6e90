//! What the service tells of itself: whether it lives and is ready, what it counts, and how it is described.

use std::collections::HashSet;

use axum::Json;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use serde_json::{Value, json};
use utoipa::ToSchema;
use utoipa::openapi::{Info, OpenApi, OpenApiBuilder};

use super::{Service, meters};
use crate::encode::FORMATS;

/// How the service is.
#[derive(Serialize, ToSchema)]
pub struct Health {
    /// `ok`, or what is missing.
    status: &'static str,
}

/// Whether the process lives
#[utoipa::path(get, path = "/healthz", tag = "service", responses((status = 200, description = "It does", body = Health)))]
pub async fn healthz() -> Json<Health> {
    Json(Health { status: "ok" })
}

/// Whether requests will be answered: the store can be written, and the service does not end
#[utoipa::path(
    get,
    path = "/readyz",
    tag = "service",
    responses((status = 200, description = "They will", body = Health), (status = 503, description = "They will not", body = Health))
)]
pub async fn readyz(State(service): State<Service>) -> (StatusCode, Json<Health>) {
    let status = if service.ending.is_cancelled() {
        "ending"
    } else if !service.jobs.writable().await {
        "the store cannot be written"
    } else {
        "ok"
    };
    (if status == "ok" { StatusCode::OK } else { StatusCode::SERVICE_UNAVAILABLE }, Json(Health { status }))
}

/// What the service counts, in Prometheus's text format
#[utoipa::path(get, path = "/metrics", tag = "service", responses((status = 200, description = "Counters", body = String, content_type = "text/plain")))]
pub async fn metrics() -> Response {
    ([(CONTENT_TYPE, "text/plain; version=0.0.4")], meters::text()).into_response()
}

/// The head of the description.
pub fn api() -> OpenApi {
    let about =
        "Shapes and boolean expressions in, exact raster lines out, streamed as they are made; jobs whose rasters resume at any byte.";
    let info = Info::builder().title("runset").version(env!("CARGO_PKG_VERSION")).description(Some(about));
    OpenApiBuilder::new().info(info.build()).build()
}

/// The whole description (OpenAPI 3.1), with what comes from tables: the media types of rasters, and who is asked for a token.
pub fn describe(api: OpenApi) -> Value {
    let mut api = serde_json::to_value(api).expect("a description is JSON");
    let rasters: serde_json::Map<String, Value> = FORMATS
        .iter()
        .map(|format| (format.media_type.to_owned(), json!({ "schema": { "type": "string", "format": "binary" } })))
        .collect();
    for (path, method) in [("/v1/fill", "post"), ("/v1/solid", "post"), ("/v1/models/{id}/view", "get"), ("/v1/jobs/{id}/raster", "get")] {
        for status in ["200", "206"] {
            if let Some(answer) = api["paths"][path][method]["responses"].get_mut(status) {
                answer["content"] = rasters.clone().into();
            }
        }
    }
    // Both kinds of jobs have some parameters, which are described once.
    if let Some(parameters) = api["paths"]["/v1/jobs"]["post"]["parameters"].as_array_mut() {
        let mut names = HashSet::new();
        parameters.retain(|parameter| names.insert(parameter["name"].clone()));
    }
    // Of each event: its fields are text, and one of them holds a job.
    api["paths"]["/v1/jobs/{id}/events"]["get"]["responses"]["200"]["content"]["text/event-stream"]["schema"] = json!({
        "type": "object",
        "required": ["event", "data"],
        "properties": {
            "event": { "const": "progress" },
            "data": { "type": "string", "contentMediaType": "application/json", "contentSchema": { "$ref": "#/components/schemas/Job" } },
        },
    });
    let unauthorized = json!({ "description": "A token is asked for", "content": { "application/problem+json": { "schema": { "$ref": "#/components/schemas/Problem" } } } });
    let forbidden = json!({ "description": "Not from there", "content": { "application/problem+json": { "schema": { "$ref": "#/components/schemas/Problem" } } } });
    for (path, methods) in api["paths"].as_object_mut().into_iter().flatten() {
        for (_, operation) in methods.as_object_mut().into_iter().flatten() {
            operation["responses"]["403"] = forbidden.clone();
            // Told before a request is one, so without a problem.
            operation["responses"]["414"] = json!({ "description": "The address is too long" });
            operation["responses"]["431"] = json!({ "description": "The head is too long" });
            if path.starts_with("/v1") {
                operation["security"] = json!([{ "token": [] }, {}]);
                operation["responses"]["401"] = unauthorized.clone();
            }
        }
    }
    api["components"]["securitySchemes"] = json!({ "token": { "type": "http", "scheme": "bearer" } });
    api
}

/// `GET /openapi.json`.
pub async fn openapi(description: Value) -> (HeaderMap, Json<Value>) {
    (HeaderMap::from_iter([(CONTENT_TYPE, HeaderValue::from_static("application/json"))]), Json(description))
}
