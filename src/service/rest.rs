//! What is left of a request's body when the answer is an error.
//!
//! Such an answer may be clear before the body has come. Where the connection is closed on a client that is still sending, the client may never see the answer: its
//! writing fails first, or the kernel throws away what it has not read. So what comes soon is read and thrown away, up to a limit.

use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll};
use std::time::Duration;

use axum::body::{Body, Bytes};
use axum::extract::Request;
use axum::http::header::EXPECT;
use http_body::{Body as _, Frame, SizeHint};
use http_body_util::BodyExt;

/// What of a request's body nobody has read.
pub struct Rest(Option<Arc<Mutex<Body>>>);

/// Bytes of a body, and time, that are spent on that.
const LINGER_BYTES: usize = 1 << 20;
const LINGER: Duration = Duration::from_millis(100);

impl Rest {
    /// Lends the body of a request to those behind. Who waits to be told to go on sends nothing yet, and has nothing to lose.
    pub fn of(request: &mut Request) -> Rest {
        if request.headers().contains_key(EXPECT) || request.body().is_end_stream() {
            return Rest(None);
        }
        let body = Arc::new(Mutex::new(std::mem::take(request.body_mut())));
        *request.body_mut() = Body::new(Lent(body.clone()));
        Rest(Some(body))
    }

    /// Reads it and throws it away, as far as it comes soon.
    pub async fn linger(self) {
        let Some(body) = self.0 else { return };
        let mut body = Lent(body);
        let read = async {
            let mut bytes = 0;
            while let Some(Ok(frame)) = body.frame().await {
                bytes += frame.data_ref().map_or(0, Bytes::len);
                if bytes > LINGER_BYTES {
                    return;
                }
            }
        };
        // Out of time it is as if nothing had been read.
        let _ = tokio::time::timeout(LINGER, read).await;
    }
}

/// A body that somebody else may go on reading.
struct Lent(Arc<Mutex<Body>>);

impl http_body::Body for Lent {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        Pin::new(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner)).poll_frame(cx)
    }

    fn is_end_stream(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).size_hint()
    }
}
