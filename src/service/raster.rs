//! A raster on its way to a reader: a suspended sweep, which holds a thread only while it makes its next portion.
//!
//! ```text
//!   reader takes a portion --> wait for one of the places for bands --> a thread makes the next --> reader ...
//! ```
//!
//! Nothing is made before it can be taken, so a slow reader slows its own raster alone; what it costs in between is the sweep, the encoder and a portion
//! or two. When the reader goes away the body is dropped, and with it the raster, at the latest when the portion at hand is made. A fault after
//! the first byte is an error of the body, on which the connection breaks: no raster that ends early looks whole.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::body::{Body, Bytes};
use futures_util::stream;
use tokio::sync::OwnedSemaphorePermit;

use super::cache::Shared;
use super::connection::Connection;
use super::drawings::Drawing;
use super::{Service, meters};
use crate::job::{More, Stream};

/// Who is told of a raster's way.
pub trait Follow: Send + Sync {
    /// The stream has made a portion.
    fn made(&self, stream: &Stream);
    /// The reader's connection was given the bytes up to `offset` of the raster, and so many of its lines at least in part.
    fn handed(&self, offset: u64, lines: u32);
    /// Whether to stop.
    fn stop(&self) -> bool;
}

/// A raster, or a part of it, for one reader.
pub struct Raster {
    service: Service,
    _drawing: Shared<Drawing>,
    /// None while a thread has it.
    stream: Option<Box<Stream>>,
    /// Bytes that are not wanted, before those that are.
    skip: u64,
    /// Bytes that are wanted still.
    left: u64,
    /// Offset in the raster of the next of them.
    at: u64,
    lines: u32,
    computed: Duration,
    started: Option<Instant>,
    follow: Option<Arc<dyn Follow>>,
    /// It counts as one of the open streams while it lives.
    _place: OwnedSemaphorePermit,
    _held: meters::Held,
    end: End,
}

/// What becomes of a raster, counted when it is dropped.
struct End {
    how: &'static str,
    connection: Option<Arc<Connection>>,
}

impl Drop for End {
    fn drop(&mut self) {
        let how = match self.connection.as_ref().and_then(|connection| connection.why()) {
            Some(why) if self.how == "left" => why.word(),
            _ => self.how,
        };
        meters::end(how);
    }
}

/// A portion, and what it took.
struct Portion {
    bytes: Vec<u8>,
    more: More,
    stream: Box<Stream>,
    took: Duration,
}

impl Raster {
    /// The bytes of `stream` behind the first `skip`, at most `left` of them. `started` is when the request came, if its first line is to be timed.
    pub fn new(
        service: Service,
        drawing: Shared<Drawing>,
        stream: Stream,
        place: OwnedSemaphorePermit,
        connection: Option<Arc<Connection>>,
    ) -> Raster {
        Raster {
            service,
            _drawing: drawing,
            lines: stream.lines(),
            at: stream.offset(),
            stream: Some(Box::new(stream)),
            skip: 0,
            left: u64::MAX,
            computed: Duration::ZERO,
            started: None,
            follow: None,
            _place: place,
            _held: meters::Held::new("runset_streams"),
            end: End { how: "left", connection },
        }
    }

    /// Only `left` bytes behind the first `skip` of the stream.
    #[must_use]
    pub fn part(self, skip: u64, left: u64) -> Raster {
        Raster { skip, left, at: self.at + skip, ..self }
    }

    /// Times the first line.
    #[must_use]
    pub fn timed(self, started: Instant) -> Raster {
        Raster { started: Some(started), ..self }
    }

    /// Tells of its way.
    #[must_use]
    pub fn followed(self, follow: Arc<dyn Follow>) -> Raster {
        Raster { follow: Some(follow), ..self }
    }

    /// The body of an answer.
    pub fn into_body(self) -> Body {
        Body::from_stream(stream::try_unfold(self, |mut raster| async move {
            let bytes = raster.next().await?;
            Ok::<_, std::io::Error>(bytes.map(|bytes| (bytes, raster)))
        }))
    }

    /// The next bytes that are wanted; none at the end.
    async fn next(&mut self) -> std::io::Result<Option<Bytes>> {
        loop {
            let Some(stream) = self.stream.take().filter(|_| self.left > 0) else { return Ok(None) };
            if self.follow.as_ref().is_some_and(|follow| follow.stop()) {
                return Err(self.fault("failed", "the job was deleted"));
            }
            if self.computed > self.service.config.max_render {
                meters::refused("render");
                return Err(self.fault("limit", "the raster takes more processor time than is allowed here"));
            }
            let Portion { bytes, more, stream, took } = match portion(&self.service, stream).await {
                Ok(portion) => portion,
                Err(what) => return Err(self.fault("failed", &what)),
            };
            self.computed += took;
            let lines = stream.lines();
            if let Some(follow) = &self.follow {
                follow.made(&stream);
            }
            self.stream = (more == More::More).then_some(stream);
            if let Some(started) = self.started.take_if(|_| !bytes.is_empty()) {
                meters::first_line(started.elapsed());
            }
            let skipped = self.skip.min(bytes.len() as u64);
            self.skip -= skipped;
            let wanted = Bytes::from(bytes).slice(skipped as usize..);
            let wanted = wanted.slice(..wanted.len().min(usize::try_from(self.left).unwrap_or(usize::MAX)));
            self.left -= wanted.len() as u64;
            self.at += wanted.len() as u64;
            meters::delivered(lines - self.lines, wanted.len() as u64);
            self.lines = lines;
            if let Some(follow) = &self.follow {
                follow.handed(self.at, lines);
            }
            if self.left == 0 || more == More::End {
                // A body of known length is not asked again behind its last byte.
                self.end.how = "complete";
            }
            if !wanted.is_empty() {
                return Ok(Some(wanted));
            }
        }
    }

    fn fault(&mut self, how: &'static str, what: &str) -> std::io::Error {
        self.end.how = how;
        tracing::warn!("a raster ends early: {what}");
        std::io::Error::other(what.to_owned())
    }
}

/// Has the next portion of a stream made, when there is a place for it.
async fn portion(service: &Service, mut stream: Box<Stream>) -> Result<Portion, String> {
    let place = {
        let _waits = meters::Waits::new("bands");
        service.bands.clone().acquire_owned().await.map_err(|error| error.to_string())?
    };
    let made = tokio::task::spawn_blocking(move || {
        let (began, _place) = (Instant::now(), place);
        let mut bytes = Vec::new();
        let more = stream.next_band(&mut bytes);
        Portion { bytes, more, stream, took: began.elapsed() }
    });
    made.await.map_err(|fault| format!("a fault while it was made: {fault}"))
}

/// Follows a stream to its end and throws its bytes away.
pub async fn exhaust(service: &Service, stream: Stream, follow: &dyn Follow) -> Result<(), String> {
    let mut stream = Some(Box::new(stream));
    let mut computed = Duration::ZERO;
    while let Some(at_hand) = stream.take() {
        if follow.stop() {
            return Ok(());
        }
        if computed > service.config.max_render {
            return Err("it takes more processor time than is allowed here".to_owned());
        }
        let Portion { more, stream: next, took, .. } = portion(service, at_hand).await?;
        computed += took;
        follow.made(&next);
        stream = (more == More::More).then_some(next);
    }
    Ok(())
}
