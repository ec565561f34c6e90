//! What every request passes: who asks, a name for the request, a line in the log, and the state of its connection.

use std::net::IpAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Instant;

use axum::body::{Body, Bytes};
use axum::extract::{Request, State};
use axum::http::header::{AUTHORIZATION, HOST, ORIGIN};
use axum::http::uri::Authority;
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use http_body::{Frame, SizeHint};
use subtle::ConstantTimeEq;

use super::connection::Connection;
use super::problem::Problem;
use super::rest::Rest;
use super::{Service, meters};

pub const REQUEST_ID: HeaderName = HeaderName::from_static("x-request-id");

/// Checks who asks, and logs the answer when its last byte has gone.
pub async fn pass(State(service): State<Service>, mut request: Request, next: Next) -> Response {
    let id = request_id(request.headers());
    let started = Instant::now();
    let connection = request.extensions().get::<Arc<Connection>>().cloned();
    let (method, path) = (request.method().clone(), request.uri().path().to_owned());
    request.extensions_mut().insert(Started(started));
    let rest = Rest::of(&mut request);
    let allowed = local(&service, request.headers()).and_then(|()| authorized(&service, &path, request.headers()));
    let mut response = match allowed {
        Ok(()) => next.run(request).await,
        Err(problem) => problem.into_response(),
    };
    let status = response.status();
    if status.is_client_error() || status.is_server_error() {
        rest.linger().await;
    }
    meters::request(status.as_u16());
    if let Ok(id) = HeaderValue::from_str(&id) {
        response.headers_mut().insert(REQUEST_ID, id);
    }
    let entry = Entry { id, method: method.to_string(), path, status, started, bytes: 0, whole: false, connection };
    response.map(|body| Body::new(Logged { body, entry }))
}

/// When a request's head had arrived.
#[derive(Clone, Copy)]
pub struct Started(pub Instant);

/// The request's own name, if it has one that can stand in a log, or a new one.
fn request_id(headers: &HeaderMap) -> String {
    let own = headers.get(REQUEST_ID).and_then(|id| id.to_str().ok());
    let plain = |id: &&str| (1..=128).contains(&id.len()) && id.bytes().all(|b| b.is_ascii_graphic());
    own.filter(plain).map_or_else(|| uuid::Uuid::now_v7().simple().to_string(), str::to_owned)
}

/// A service on loopback answers this machine alone: a page of another site can make a browser send requests here, but not with these headers.
fn local(service: &Service, headers: &HeaderMap) -> Result<(), Problem> {
    if !service.config.local_only {
        return Ok(());
    }
    let forbidden = |what: &str| Problem::new(StatusCode::FORBIDDEN, "forbidden", what);
    let host = headers.get(HOST).and_then(|host| host.to_str().ok()?.parse::<Authority>().ok());
    if !host.is_some_and(|host| is_local(host.host())) {
        return Err(forbidden("this service is for its own machine: ask it as localhost, 127.0.0.1 or [::1]"));
    }
    let Some(origin) = headers.get(ORIGIN) else { return Ok(()) };
    let origin = origin.to_str().unwrap_or_default();
    let own = origin.parse::<Uri>().ok().and_then(|uri| Some(is_local(uri.host()?))).unwrap_or(false);
    if own || service.config.origins.iter().any(|known| known == origin) {
        return Ok(());
    }
    Err(forbidden("pages of other sites may not use this service: name their origin with --allow-origin"))
}

/// Whether a host is this machine by its name, or by an address of loopback (all of 127.0.0.0/8 are).
fn is_local(host: &str) -> bool {
    let address = host.strip_prefix('[').and_then(|host| host.strip_suffix(']')).unwrap_or(host);
    host.eq_ignore_ascii_case("localhost") || address.parse::<IpAddr>().is_ok_and(|address| address.is_loopback())
}

/// Whether the token is there, where one is asked for.
fn authorized(service: &Service, path: &str, headers: &HeaderMap) -> Result<(), Problem> {
    let Some(token) = service.config.token.as_deref().filter(|_| path.starts_with("/v1")) else { return Ok(()) };
    let given = headers.get(AUTHORIZATION).and_then(|value| value.to_str().ok()).unwrap_or_default();
    let (scheme, given) = given.split_once(' ').unwrap_or((given, ""));
    if !scheme.eq_ignore_ascii_case("bearer") {
        return Err(Problem::unauthorized("this service asks for a token: send Authorization: Bearer TOKEN"));
    }
    if bool::from(given.trim().as_bytes().ct_eq(token.as_bytes())) {
        Ok(())
    } else {
        Err(Problem::unauthorized("the token is not that of this service"))
    }
}

/// What a line of the log says.
struct Entry {
    id: String,
    method: String,
    path: String,
    status: StatusCode,
    started: Instant,
    bytes: u64,
    whole: bool,
    connection: Option<Arc<Connection>>,
}

impl Drop for Entry {
    fn drop(&mut self) {
        if let Some(connection) = &self.connection {
            connection.idle();
        }
        let Entry { id, method, path, status, bytes, whole, .. } = self;
        let (status, peer) = (status.as_u16(), self.connection.as_ref().map(|connection| connection.peer().to_string()));
        let ms = self.started.elapsed().as_secs_f64() * 1e3;
        tracing::info!(id, method, path, status, bytes, whole, ms, peer, "request");
    }
}

/// A body whose end is logged.
struct Logged {
    body: Body,
    entry: Entry,
}

impl http_body::Body for Logged {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        let frame = Pin::new(&mut self.body).poll_frame(cx);
        match &frame {
            Poll::Ready(Some(Ok(frame))) => {
                self.entry.bytes += frame.data_ref().map_or(0, |data| data.len() as u64);
                // A body that knows its end is not asked again.
                self.entry.whole |= self.body.is_end_stream();
            }
            Poll::Ready(None) => self.entry.whole = true,
            _ => {}
        }
        frame
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}
