//! What a request brings: a document, read to its end within limits of time and memory.

use std::sync::Arc;

use axum::body::{Body, Bytes};
use axum::http::header::{CONTENT_ENCODING, CONTENT_LENGTH, CONTENT_TYPE, HeaderValue};
use axum::http::{HeaderMap, StatusCode};
use http_body_util::BodyExt;
use mediatype::MediaType;
use sha2::{Digest as _, Sha256};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use super::config::Config;
use super::meters;
use super::problem::Problem;

/// Bytes that a permit of [`Uploads`] stands for.
const UNIT: u64 = 64 << 10;

/// A document as it came.
pub struct Document {
    /// Its bytes.
    pub bytes: Bytes,
    /// Their SHA-256.
    pub digest: [u8; 32],
    /// Room that it takes of that for uploads.
    pub room: OwnedSemaphorePermit,
}

/// Room for bodies.
#[derive(Clone)]
pub struct Uploads(Arc<Semaphore>);

impl Uploads {
    /// Room for so many bytes.
    pub fn new(bytes: u64) -> Uploads {
        Uploads(Arc::new(Semaphore::new(bytes.div_ceil(UNIT).min(u32::MAX.into()) as usize)))
    }

    /// Reads a document, whose media type is one of `kinds`.
    ///
    /// # Errors
    /// Another kind of document; too large; a body that stops; no room now.
    pub async fn read(&self, config: &Config, kinds: &[&str], headers: &HeaderMap, mut body: Body) -> Result<Document, Problem> {
        check_type(kinds, headers)?;
        let length = headers.get(CONTENT_LENGTH).and_then(|length| length.to_str().ok()?.parse::<u64>().ok());
        if length.is_some_and(|length| length > config.limits.input) {
            return Err(too_large(config));
        }
        let full = || Problem::busy("uploads", "too many documents are being sent to this service: try again later", 5);
        let units = |bytes: u64| bytes.div_ceil(UNIT) as u32;
        let mut room = self.0.clone().try_acquire_many_owned(units(length.unwrap_or(0))).map_err(|_| full())?;
        let mut bytes = Vec::with_capacity(length.unwrap_or(0) as usize);
        let mut digest = Sha256::new();
        loop {
            let frame = tokio::time::timeout(config.body_timeout, body.frame()).await.map_err(|_| {
                meters::refused("body-timeout");
                let what = format!("nothing of the body came for {} s", config.body_timeout.as_secs_f64());
                Problem::new(StatusCode::REQUEST_TIMEOUT, "timeout", what)
                    .with(axum::http::header::CONNECTION, HeaderValue::from_static("close"))
            })?;
            let Some(frame) = frame else { break };
            let frame = frame.map_err(|error| Problem::malformed(format!("the body ends too early: {error}")))?;
            let Ok(data) = frame.into_data() else { continue };
            if (bytes.len() + data.len()) as u64 > config.limits.input {
                return Err(too_large(config));
            }
            let needed = units((bytes.len() + data.len()) as u64).saturating_sub(room.num_permits() as u32);
            if needed > 0 {
                room.merge(self.0.clone().try_acquire_many_owned(needed).map_err(|_| full())?);
            }
            digest.update(&data);
            bytes.extend_from_slice(&data);
        }
        if bytes.is_empty() {
            return Err(Problem::malformed("the body is empty: send a document"));
        }
        Ok(Document { bytes: bytes.into(), digest: digest.finalize().into(), room })
    }
}

fn check_type(kinds: &[&str], headers: &HeaderMap) -> Result<(), Problem> {
    let text = |name| headers.get(name).and_then(|value| value.to_str().ok()).unwrap_or_default();
    let given = text(CONTENT_TYPE);
    let unsupported = |what: String| Err(Problem::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, "unsupported-media-type", what));
    let known =
        MediaType::parse(given).is_ok_and(|given| kinds.iter().any(|known| given.essence().to_string().eq_ignore_ascii_case(known)));
    if !known {
        let given = if given.is_empty() { "there is no Content-Type".to_owned() } else { format!("the body is {given:?}") };
        return unsupported(format!("{given}: send one of {}", kinds.join(", ")));
    }
    // Gzipped documents are told by their first bytes, however they are announced.
    if !matches!(text(CONTENT_ENCODING).to_ascii_lowercase().as_str(), "" | "identity" | "gzip" | "x-gzip") {
        return unsupported("the body is encoded in a way that is not known here: send it plain or gzipped".to_owned());
    }
    Ok(())
}

fn too_large(config: &Config) -> Problem {
    meters::refused("input");
    let what = format!("the document is larger than {} bytes", config.limits.input);
    Problem::new(StatusCode::PAYLOAD_TOO_LARGE, "too-large", what)
}
