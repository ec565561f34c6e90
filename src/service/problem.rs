//! Errors as a client sees them: RFC 9457, `application/problem+json`, with the place in the document or in the expression where there is one.

use axum::Json;
use axum::http::header::{CONTENT_TYPE, RETRY_AFTER, WWW_AUTHENTICATE};
use axum::http::{HeaderName, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use utoipa::ToSchema;

use super::meters;
use crate::error::{Error, Kind, Origin, Place};

/// Why a request is not answered as asked.
#[derive(Clone, Debug)]
pub struct Problem {
    status: StatusCode,
    name: &'static str,
    detail: String,
    place: Option<Place>,
    /// In a box: problems are handed from function to function.
    header: Option<Box<(HeaderName, HeaderValue)>>,
}

/// A problem as it is sent (RFC 9457).
#[derive(Serialize, ToSchema)]
#[schema(as = Problem)]
pub struct Details {
    /// `urn:runset:problem:NAME`
    #[serde(rename = "type")]
    kind: String,
    /// The status in words.
    title: String,
    /// The HTTP status.
    #[schema(minimum = 400, maximum = 599)]
    status: u16,
    /// What is wrong, and what to do.
    detail: String,
    /// Line of the document or the expression, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<u32>,
    /// Column in characters, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    column: Option<u32>,
}

impl Problem {
    /// A problem with a name, which stays the same for ever, and words for people.
    pub fn new(status: StatusCode, name: &'static str, detail: impl Into<String>) -> Problem {
        Problem { status, name, detail: detail.into(), place: None, header: None }
    }

    /// A query or a body that is not what it should be.
    pub fn malformed(detail: impl Into<String>) -> Problem {
        Problem::new(StatusCode::BAD_REQUEST, "malformed", detail)
    }

    /// No such job.
    pub fn no_job() -> Problem {
        Problem::new(StatusCode::NOT_FOUND, "no-job", "there is no job of this id: it may have been deleted, or forgotten for its age")
    }

    /// A fault of the service itself.
    pub fn internal(what: impl std::fmt::Display) -> Problem {
        tracing::error!("fault: {what}");
        Problem::new(StatusCode::INTERNAL_SERVER_ERROR, "internal", "a fault of the service: its log has more")
    }

    /// Too much is going on.
    pub fn busy(limit: &'static str, detail: impl Into<String>, seconds: u32) -> Problem {
        meters::refused(limit);
        Problem::new(StatusCode::SERVICE_UNAVAILABLE, "busy", detail).after(seconds)
    }

    /// Not now, but in so many seconds.
    #[must_use]
    pub fn after(self, seconds: u32) -> Problem {
        self.with(RETRY_AFTER, HeaderValue::from(seconds))
    }

    /// Nobody said who is asking.
    pub fn unauthorized(detail: &str) -> Problem {
        let challenge = HeaderValue::from_static("Bearer realm=\"runset\"");
        Problem::new(StatusCode::UNAUTHORIZED, "unauthorized", detail).with(WWW_AUTHENTICATE, challenge)
    }

    /// With a header beside it.
    #[must_use]
    pub fn with(self, name: HeaderName, value: HeaderValue) -> Problem {
        Problem { header: Some(Box::new((name, value))), ..self }
    }

    /// What is wrong, and what to do.
    pub fn detail(&self) -> &str {
        &self.detail
    }

    /// Whether the same request may be answered later.
    pub fn is_passing(&self) -> bool {
        self.status == StatusCode::SERVICE_UNAVAILABLE
    }

    /// A document or a file that the disk has no room for, or another fault of the disk.
    pub fn storing(error: &std::io::Error) -> Problem {
        use std::io::ErrorKind as E;
        if matches!(error.kind(), E::StorageFull | E::QuotaExceeded | E::FileTooLarge) {
            meters::refused("disk");
            return Problem::new(StatusCode::INSUFFICIENT_STORAGE, "disk-full", "the disk of the service is full: nothing was stored");
        }
        Problem::internal(error)
    }
}

impl From<Error> for Problem {
    fn from(error: Error) -> Problem {
        let (status, name) = match (error.kind, error.origin) {
            (Kind::Malformed, _) => (StatusCode::BAD_REQUEST, "malformed"),
            (Kind::Refused, _) => (StatusCode::UNPROCESSABLE_ENTITY, "refused"),
            (Kind::Limit, _) => (StatusCode::UNPROCESSABLE_ENTITY, "limit"),
            (Kind::Io | Kind::Closed, _) => return Problem::internal(error),
        };
        if error.kind == Kind::Limit {
            meters::refused("document");
        }
        let of = if error.origin == Origin::Expression { "expr: " } else { "" };
        Problem { place: error.place, ..Problem::new(status, name, format!("{of}{}", error.what)) }
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let details = Details {
            kind: format!("urn:runset:problem:{}", self.name),
            title: self.status.canonical_reason().unwrap_or("Error").to_owned(),
            status: self.status.as_u16(),
            detail: self.detail,
            line: self.place.map(|place| place.line),
            column: self.place.map(|place| place.column),
        };
        let mut response = (self.status, Json(details)).into_response();
        response.headers_mut().insert(CONTENT_TYPE, HeaderValue::from_static("application/problem+json"));
        response.headers_mut().extend(self.header.map(|header| *header));
        response
    }
}
