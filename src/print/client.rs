//! HTTP below IPP: a connection a request, answers bounded in time and size, and a document that is taken as fast as the printer takes it.
//!
//! The answer is read while the document is sent: a printer that refuses it says so at once, and not behind the last byte. Dropping a request closes its connection.

use std::pin::{Pin, pin};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::task::{Context, Poll, ready};

use bytes::Bytes;
use http_body_util::{BodyExt, Limited};
use hyper::body::{Body as HttpBody, Frame, SizeHint};
use hyper::http::header::{CONNECTION, CONTENT_TYPE, HOST, USER_AGENT};
use hyper::{Response, StatusCode, Version};
use hyper_util::rt::TokioIo;
use tokio::net::TcpStream;
use tokio::time::timeout;

use super::Limits;
use super::address::Address;
use super::body::Body;
use super::failure::{Failure, Why};
use super::message::{Answer, Request};

/// Who asks, as printers log it.
const AGENT: &str = concat!("runset/", env!("CARGO_PKG_VERSION"));

/// A way to a printer.
#[derive(Clone, Debug)]
pub struct Client {
    /// Where it is.
    pub address: Address,
    /// What it may cost.
    pub limits: Limits,
    /// Whether the printer has answered in a version of HTTP that knows no chunks.
    old: Arc<AtomicBool>,
}

/// How far a document has come; shared with who watches it.
#[derive(Debug, Default)]
pub struct Way {
    bytes: AtomicU64,
    whole: AtomicBool,
}

impl Way {
    /// Bytes of the document that were handed to the connection.
    pub fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Acquire)
    }

    /// Whether its last byte was.
    pub fn is_whole(&self) -> bool {
        self.whole.load(Ordering::Acquire)
    }
}

impl Client {
    /// A way to the printer at `address`.
    pub fn new(address: Address, limits: Limits) -> Client {
        Client { address, limits, old: Arc::default() }
    }

    /// The printer's address, for messages.
    pub fn name(&self) -> String {
        self.address.to_string()
    }

    /// Whether a document has to be sent with its length.
    pub fn wants_length(&self) -> bool {
        self.old.load(Ordering::Relaxed)
    }

    /// Sends a request without a document.
    ///
    /// # Errors
    /// The printer does not answer in time, or not in IPP.
    pub(super) async fn ask(&self, request: &Request) -> Result<Answer, Failure> {
        let body = Sent { head: Some(request.bytes()), document: None, way: Arc::default() };
        let answered = timeout(self.limits.answer, self.exchange(body, None)).await;
        answered.unwrap_or_else(|_| {
            let what = format!("{}: no answer within {} s: is this a printer?", self.name(), self.limits.answer.as_secs_f32());
            Err(Failure::new(Why::Unreachable, what))
        })
    }

    /// Sends a request with a document, however long that takes.
    ///
    /// # Errors
    /// Those of [`Client::ask`], and of the document.
    pub(super) async fn send(&self, request: &Request, document: Body, way: Arc<Way>) -> Result<Answer, Failure> {
        self.exchange(Sent { head: Some(request.bytes()), document: Some(document), way: way.clone() }, Some(way)).await
    }

    async fn exchange(&self, body: Sent, way: Option<Arc<Way>>) -> Result<Answer, Failure> {
        let name = self.name();
        let unreachable = |what: &dyn std::fmt::Display| Failure::new(Why::Unreachable, format!("{name}: cannot be reached: {what}"));
        let connect = TcpStream::connect((self.address.host(), self.address.port()));
        let stream = match timeout(self.limits.connect, connect).await {
            Ok(Ok(stream)) => stream,
            Ok(Err(error)) => return Err(unreachable(&without_number(&error))),
            Err(_) => return Err(unreachable(&format!("no connection within {} s", self.limits.connect.as_secs_f32()))),
        };
        let _ = stream.set_nodelay(true);
        let (mut sender, connection) = hyper::client::conn::http1::handshake(TokioIo::new(stream)).await.map_err(|e| unreachable(&e))?;
        let request = hyper::Request::post(self.address.path())
            .header(HOST, self.address.authority())
            .header(USER_AGENT, AGENT)
            .header(CONTENT_TYPE, "application/ipp")
            .header(CONNECTION, "close")
            .body(body)
            .map_err(|error| Failure::new(Why::Wish, format!("{name}: {error}")))?;
        let failed = body_fault(&way);
        let answer = async {
            let response = sender.send_request(request).await.map_err(|error| failed(&name, &error))?;
            self.read(response).await
        };
        let (mut answer, mut connection) = (pin!(answer), pin!(connection));
        tokio::select! {
            answer = &mut answer => answer,
            // How it ended is told by the request.
            _ = &mut connection => answer.await,
        }
    }

    async fn read(&self, response: Response<hyper::body::Incoming>) -> Result<Answer, Failure> {
        let name = self.name();
        if response.version() < Version::HTTP_11 {
            self.old.store(true, Ordering::Relaxed);
        }
        let status = response.status();
        if status != StatusCode::OK {
            let (why, what) = match status {
                StatusCode::LENGTH_REQUIRED => (Why::Length, "it wants documents with their length"),
                StatusCode::UNAUTHORIZED | StatusCode::FORBIDDEN => (Why::Refused, "it asks for a name and a password, which are not sent"),
                StatusCode::UPGRADE_REQUIRED => (Why::Refused, "it wants TLS (ipps), which is not built in"),
                StatusCode::SERVICE_UNAVAILABLE | StatusCode::TOO_MANY_REQUESTS => (Why::Busy, "it is busy"),
                StatusCode::NOT_FOUND => (Why::Refused, "there is no printer at this path: see runset printers --probe HOST"),
                _ => (Why::Malformed, "this is no printer"),
            };
            return Err(Failure::new(why, format!("{name}: {what} (HTTP status {})", status.as_u16())));
        }
        let kind = response.headers().get(CONTENT_TYPE).and_then(|kind| kind.to_str().ok()).unwrap_or_default();
        if !kind.trim_start().to_ascii_lowercase().starts_with("application/ipp") {
            return Err(Failure::new(Why::Malformed, format!("{name}: this is no printer: it answers {kind:?} and not application/ipp")));
        }
        let limited = Limited::new(response.into_body(), self.limits.answer_bytes);
        let collected = match timeout(self.limits.answer, limited.collect()).await {
            Ok(Ok(collected)) => collected.to_bytes(),
            Ok(Err(error)) if error.is::<http_body_util::LengthLimitError>() => {
                let what = format!("{name}: the printer's answer is longer than {} bytes", self.limits.answer_bytes);
                return Err(Failure::new(Why::Malformed, what));
            }
            Ok(Err(_)) => return Err(Failure::new(Why::Broken, format!("{name}: the connection broke within the printer's answer"))),
            Err(_) => {
                let what = format!("{name}: the printer's answer did not end within {} s", self.limits.answer.as_secs_f32());
                return Err(Failure::new(Why::Malformed, what));
            }
        };
        Answer::read(collected).map_err(|failure| Failure::new(failure.why, format!("{name}: {}", failure.what)))
    }
}

/// The failure that an error of a connection is: one of the document, or of the network.
fn body_fault(way: &Option<Arc<Way>>) -> impl Fn(&str, &hyper::Error) -> Failure {
    let sent = way.clone();
    move |name, error| {
        use std::error::Error as _;
        let cause = error.source().map_or_else(|| error.to_string(), ToString::to_string);
        if error.is_user() {
            return Failure::new(Why::Raster, cause);
        }
        let cause = cause.split(" (os error").next().unwrap_or_default().to_owned();
        match &sent {
            Some(way) => Failure::new(Why::Broken, format!("{name}: the connection broke after {} bytes: {cause}", way.bytes())),
            None => Failure::new(Why::Broken, format!("{name}: the connection broke: {cause}")),
        }
    }
}

fn without_number(error: &std::io::Error) -> String {
    error.to_string().split(" (os error").next().unwrap_or_default().to_owned()
}

/// A request on its way: its attributes, then its document, counted.
struct Sent {
    head: Option<Bytes>,
    document: Option<Body>,
    way: Arc<Way>,
}

impl HttpBody for Sent {
    type Data = Bytes;
    type Error = std::io::Error;

    fn poll_frame(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<Result<Frame<Bytes>, std::io::Error>>> {
        if let Some(head) = self.head.take() {
            return Poll::Ready(Some(Ok(Frame::data(head))));
        }
        let Some(document) = &mut self.document else { return Poll::Ready(None) };
        let frame = ready!(Pin::new(document).poll_frame(context));
        match &frame {
            Some(Ok(frame)) => {
                let bytes = frame.data_ref().map_or(0, |data| data.len() as u64);
                self.way.bytes.fetch_add(bytes, Ordering::AcqRel);
                // A body of known length is not asked again behind its last byte.
                if self.document.as_ref().is_some_and(HttpBody::is_end_stream) {
                    self.way.whole.store(true, Ordering::Release);
                }
            }
            Some(Err(_)) => {}
            None => self.way.whole.store(true, Ordering::Release),
        }
        Poll::Ready(frame)
    }

    fn is_end_stream(&self) -> bool {
        self.head.is_none() && self.document.as_ref().is_none_or(HttpBody::is_end_stream)
    }

    fn size_hint(&self) -> SizeHint {
        let head = self.head.as_ref().map_or(0, |head| head.len() as u64);
        match self.document.as_ref().map(HttpBody::size_hint) {
            None => SizeHint::with_exact(head),
            Some(hint) => hint.exact().map_or_else(SizeHint::default, |length| SizeHint::with_exact(head + length)),
        }
    }
}
