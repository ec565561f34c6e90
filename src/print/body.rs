//! A document on its way to a printer: made by a thread as the printer takes it, or put into a file first, so that its length is known.
//!
//! ```text
//!   render --Write--> [ 4 portions ] --poll_frame--> connection        a full channel blocks the renderer, a closed one ends it
//! ```
//!
//! The channel ends with a word of its own: a renderer that goes away without it is a fault, on which the connection breaks.

use std::fs::File;
use std::io::{self, Read, Seek, Write};
use std::pin::Pin;
use std::task::{Context, Poll, ready};
use std::thread;

use bytes::Bytes;
use http_body_util::BodyExt;
use hyper::body::{Body as HttpBody, Frame, SizeHint};
use tokio::sync::mpsc;

use super::failure::{Failure, Why};
use crate::error::{Error, Kind};

/// Portions that wait for the connection.
const WAITING: usize = 4;

/// Bytes of a portion.
const PORTION: usize = 64 << 10;

/// What a thread says.
enum Said {
    Bytes(Bytes),
    End,
    Failed(String),
}

/// The bytes of a document.
pub struct Body {
    source: Source,
    /// Bytes that are still to come, where that is known.
    left: Option<u64>,
}

enum Source {
    Thread(mpsc::Receiver<Said>),
    /// A body that somebody else makes.
    Other(Pin<Box<dyn HttpBody<Data = Bytes, Error = io::Error> + Send>>),
    Ended,
}

impl Body {
    /// What `make` writes, on a thread of its own. An error of its writer means that nobody wants the rest.
    ///
    /// # Errors
    /// No thread can be started.
    pub fn made(make: impl FnOnce(&mut dyn Write) -> Result<(), Error> + Send + 'static) -> io::Result<Body> {
        let (sender, receiver) = mpsc::channel(WAITING);
        let mut pipe = Pipe { sender, pending: Vec::new() };
        thread::Builder::new().name("document".to_owned()).spawn(move || {
            let last = match make(&mut pipe).and_then(|()| pipe.flush().map_err(|error| Error::output(&error))) {
                Ok(()) => Said::End,
                Err(error) if error.kind == Kind::Closed => return,
                Err(error) => Said::Failed(error.to_string()),
            };
            // Nobody may be left to hear it.
            let _ = pipe.sender.blocking_send(last);
        })?;
        Ok(Body { source: Source::Thread(receiver), left: None })
    }

    /// A body that is made elsewhere, pulled portion by portion.
    pub fn pulled(body: impl HttpBody<Data = Bytes, Error = io::Error> + Send + 'static) -> Body {
        Body { source: Source::Other(Box::pin(body)), left: None }
    }

    /// The same bytes with their length known: they go through a file that has no name, of at most `limit` bytes.
    ///
    /// # Errors
    /// Those of the document; the disk is full; it is longer than the limit.
    pub async fn spooled(mut self, limit: u64) -> Result<Body, Failure> {
        let fault = |error: io::Error| Failure::new(Why::Raster, format!("the document cannot be kept in a file: {error}"));
        let mut file = tempfile::tempfile().map_err(fault)?;
        let mut length = 0_u64;
        while let Some(frame) = self.frame().await {
            let Ok(bytes) = frame.map_err(|error| Failure::new(Why::Raster, error.to_string()))?.into_data() else { continue };
            length += bytes.len() as u64;
            if length > limit {
                return Err(Failure::new(Why::Raster, format!("the document is longer than the {limit} bytes that may be kept in a file")));
            }
            let written = tokio::task::spawn_blocking(move || file.write_all(&bytes).map(|()| file)).await;
            file = written.map_err(io::Error::other).and_then(|file| file).map_err(fault)?;
        }
        file.rewind().map_err(fault)?;
        let body = Body::made(move |out| copy(file, out)).map_err(fault)?;
        Ok(Body { left: Some(length), ..body })
    }
}

fn copy(mut file: File, out: &mut dyn Write) -> Result<(), Error> {
    let mut buffer = vec![0; PORTION];
    loop {
        match file.read(&mut buffer) {
            Ok(0) => return Ok(()),
            Ok(n) => out.write_all(&buffer[..n]).map_err(|error| Error::output(&error))?,
            Err(error) => return Err(Error::input(Kind::Io, error.to_string())),
        }
    }
}

/// The writer's end of the channel.
struct Pipe {
    sender: mpsc::Sender<Said>,
    pending: Vec<u8>,
}

impl Write for Pipe {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.sender.is_closed() {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        let took = bytes.len().min(PORTION - self.pending.len());
        self.pending.extend_from_slice(&bytes[..took]);
        if self.pending.len() == PORTION {
            self.flush()?;
        }
        Ok(took)
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.pending.is_empty() {
            return Ok(());
        }
        let bytes = std::mem::take(&mut self.pending).into();
        self.sender.blocking_send(Said::Bytes(bytes)).map_err(|_| io::ErrorKind::BrokenPipe.into())
    }
}

impl HttpBody for Body {
    type Data = Bytes;
    type Error = io::Error;

    fn poll_frame(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<Result<Frame<Bytes>, io::Error>>> {
        let frame = match &mut self.source {
            Source::Ended => None,
            Source::Thread(receiver) => match ready!(receiver.poll_recv(context)) {
                Some(Said::Bytes(bytes)) => Some(Ok(Frame::data(bytes))),
                Some(Said::End) => None,
                Some(Said::Failed(what)) => Some(Err(io::Error::other(what))),
                None => Some(Err(io::Error::other("a fault while the raster was made"))),
            },
            Source::Other(body) => ready!(body.as_mut().poll_frame(context)),
        };
        match &frame {
            Some(Ok(frame)) => {
                let bytes = frame.data_ref().map_or(0, |data| data.len() as u64);
                self.left = self.left.map(|left| left.saturating_sub(bytes));
            }
            Some(Err(_)) | None => self.source = Source::Ended,
        }
        Poll::Ready(frame)
    }

    fn is_end_stream(&self) -> bool {
        matches!(self.source, Source::Ended) || self.left == Some(0)
    }

    fn size_hint(&self) -> SizeHint {
        self.left.map_or_else(SizeHint::default, SizeHint::with_exact)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(n: usize) -> Vec<u8> {
        (0..n).map(|i| (i / 7 % 251) as u8).collect()
    }

    #[tokio::test]
    async fn what_is_written_arrives_whole_or_with_an_error() {
        for n in [0, 1, PORTION - 1, PORTION, PORTION + 1, 10 * PORTION + 3] {
            let made = || Body::made(move |out| out.write_all(&numbers(n)).map_err(|error| Error::output(&error))).unwrap();
            assert_eq!(made().collect().await.unwrap().to_bytes(), numbers(n));
            let spooled = made().spooled(1 << 30).await.unwrap();
            assert_eq!(spooled.size_hint().exact(), Some(n as u64));
            assert_eq!(spooled.collect().await.unwrap().to_bytes(), numbers(n));
        }
        let body = Body::made(|out| {
            out.write_all(&[1; 100]).map_err(|error| Error::output(&error))?;
            Err(Error::input(Kind::Refused, "no more"))
        });
        assert_eq!(body.unwrap().collect().await.unwrap_err().to_string(), "no more");
        let body = Body::made(|_| panic!("a fault"));
        assert!(body.unwrap().collect().await.is_err(), "a thread that is gone is no end");
        assert!(Body::made(|out| out.write_all(&[0; 99]).map_err(|e| Error::output(&e))).unwrap().spooled(98).await.is_err());
    }

    #[tokio::test]
    async fn a_body_that_nobody_takes_stops_its_renderer() {
        let (told, hears) = std::sync::mpsc::channel();
        let body = Body::made(move |out| {
            let mut written = 0;
            while out.write_all(&[0; PORTION]).is_ok() {
                written += 1;
            }
            told.send(written).unwrap();
            Ok(())
        });
        let mut body = body.unwrap();
        body.frame().await.unwrap().unwrap();
        tokio::time::sleep(std::time::Duration::from_millis(50)).await;
        drop(body);
        assert!(hears.recv().unwrap() <= WAITING + 3, "no more than the channel holds");
    }
}
