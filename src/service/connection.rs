//! Connections and the times that they are given.
//!
//! ```text
//!   opened --head within 10 s--> a request is answered --> idle, at most 60 s --first byte--> head within 10 s ...
//!                                 |
//!                                 bytes wait to be taken: if nothing is acknowledged for 120 s, the reader has stalled
//! ```
//!
//! The connection notes what happens to it ([`Connection`]), one task looks at all of them a few times in a timeout ([`watch`]), and whoever is out of
//! time is told to end. A reader that takes 1 KiB a second leaves more than a minute between two writes, because the kernel's buffers are that large;
//! what tells it from one that has stalled is that the bytes not yet acknowledged become fewer.
//!
//! Where the kernel does not tell those (not Linux), only writes count.

// The kernel's own TCP_USER_TIMEOUT ends slow readers too: where a segment is larger than the window that is left, as on loopback, it goes on
// counting although bytes are acknowledged (tried on Linux 6.18: 16 kB/s with a timeout of 4 s were cut after 4.5 s).

use std::collections::HashMap;
use std::io::{self, IoSlice};
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::task::{Context, Poll};
use std::time::{Duration, Instant};

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;
use tokio_util::sync::CancellationToken;

use super::config::Config;
use super::meters;

/// What a connection is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// The head of a request is expected, or has begun to arrive.
    Head = 0,
    /// A request is being answered.
    Busy = 1,
    /// Nothing since the last answer.
    Idle = 2,
}

/// Why the service ends a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Why {
    /// The head of a request took too long.
    Head = 1,
    /// There was no request for too long.
    Idle = 2,
    /// Its reader acknowledges nothing any more.
    Stalled = 3,
    /// The service ends.
    Shutdown = 4,
}

impl Why {
    /// One word for logs and metrics.
    pub fn word(self) -> &'static str {
        match self {
            Why::Head => "head",
            Why::Idle => "idle",
            Why::Stalled => "stalled",
            Why::Shutdown => "shutdown",
        }
    }
}

/// A connection, as others see it.
#[derive(Debug)]
pub struct Connection {
    local: SocketAddr,
    peer: SocketAddr,
    opened: Instant,
    phase: AtomicU8,
    /// When the phase began, in milliseconds since `opened`.
    since: AtomicU64,
    /// Bytes that the kernel took.
    written: AtomicU64,
    /// Whether more wait that it does not take.
    waits: AtomicU8,
    why: AtomicU8,
    end: CancellationToken,
}

impl Connection {
    /// A connection that was just accepted.
    pub fn new(local: SocketAddr, peer: SocketAddr) -> Connection {
        Connection {
            local,
            peer,
            opened: Instant::now(),
            phase: AtomicU8::new(Phase::Head as u8),
            since: AtomicU64::new(0),
            written: AtomicU64::new(0),
            waits: AtomicU8::new(0),
            why: AtomicU8::new(0),
            end: CancellationToken::new(),
        }
    }

    /// The other end.
    pub fn peer(&self) -> SocketAddr {
        self.peer
    }

    /// A request has arrived.
    pub fn busy(&self) {
        self.enter(Phase::Busy);
    }

    /// It is answered, to the last byte.
    pub fn idle(&self) {
        self.enter(Phase::Idle);
    }

    fn enter(&self, phase: Phase) {
        self.since.store(self.opened.elapsed().as_millis() as u64, Ordering::Relaxed);
        self.phase.store(phase as u8, Ordering::Relaxed);
    }

    /// For how long it has been in a phase.
    fn lasts(&self, phase: Phase) -> Option<Duration> {
        let since = Duration::from_millis(self.since.load(Ordering::Relaxed));
        (self.phase.load(Ordering::Relaxed) == phase as u8).then(|| self.opened.elapsed().saturating_sub(since))
    }

    /// Ends it. Only the first reason counts.
    pub fn end(&self, why: Why) {
        if self.why.compare_exchange(0, why as u8, Ordering::Relaxed, Ordering::Relaxed).is_ok() {
            meters::connection_ended(why.word());
            self.end.cancel();
        }
    }

    /// Waits until it is told to end.
    pub async fn ended(&self) {
        self.end.cancelled().await;
    }

    /// Why it was told to end, if it was.
    pub fn why(&self) -> Option<Why> {
        match self.why.load(Ordering::Relaxed) {
            1 => Some(Why::Head),
            2 => Some(Why::Idle),
            3 => Some(Why::Stalled),
            4 => Some(Why::Shutdown),
            _ => None,
        }
    }
}

/// A socket that notes what happens to it.
pub struct Socket {
    stream: TcpStream,
    connection: Arc<Connection>,
}

impl Socket {
    /// Around an accepted socket.
    pub fn new(stream: TcpStream, connection: Arc<Connection>) -> Socket {
        Socket { stream, connection }
    }

    fn wrote(&self, result: &Poll<io::Result<usize>>) {
        match result {
            Poll::Pending => self.connection.waits.store(1, Ordering::Relaxed),
            Poll::Ready(taken) => {
                self.connection.waits.store(0, Ordering::Relaxed);
                self.connection.written.fetch_add(*taken.as_ref().unwrap_or(&0) as u64, Ordering::Relaxed);
            }
        }
    }
}

impl AsyncRead for Socket {
    fn poll_read(mut self: Pin<&mut Self>, cx: &mut Context<'_>, buf: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        let before = buf.filled().len();
        let result = Pin::new(&mut self.stream).poll_read(cx, buf);
        if buf.filled().len() > before && self.connection.lasts(Phase::Idle).is_some() {
            self.connection.enter(Phase::Head);
        }
        result
    }
}

impl AsyncWrite for Socket {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, buf: &[u8]) -> Poll<io::Result<usize>> {
        let result = Pin::new(&mut self.stream).poll_write(cx, buf);
        self.wrote(&result);
        result
    }

    fn poll_write_vectored(mut self: Pin<&mut Self>, cx: &mut Context<'_>, bufs: &[IoSlice<'_>]) -> Poll<io::Result<usize>> {
        let result = Pin::new(&mut self.stream).poll_write_vectored(cx, bufs);
        self.wrote(&result);
        result
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}

/// The open connections.
#[derive(Debug, Default)]
pub struct Connections(Mutex<Vec<Weak<Connection>>>);

impl Connections {
    /// One more, which is forgotten when its last owner drops it.
    pub fn add(&self, connection: &Arc<Connection>) {
        self.lock().push(Arc::downgrade(connection));
    }

    /// Ends them all.
    pub fn end_all(&self, why: Why) {
        self.open().iter().for_each(|connection| connection.end(why));
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Weak<Connection>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn open(&self) -> Vec<Arc<Connection>> {
        let mut all = self.lock();
        all.retain(|connection| connection.strong_count() > 0);
        all.iter().filter_map(Weak::upgrade).collect()
    }
}

/// How far a reader has got, and when that was seen.
struct Progress {
    written: u64,
    queued: Option<u64>,
    at: Instant,
}

/// Ends connections that are out of time, for ever.
pub async fn watch(connections: Arc<Connections>, config: Arc<Config>) {
    let shortest = [config.head_timeout, config.idle_timeout, config.stall_timeout].into_iter().min().unwrap_or_default();
    let mut tick = tokio::time::interval((shortest / 8).clamp(Duration::from_millis(20), Duration::from_secs(1)));
    let mut progress: HashMap<(SocketAddr, SocketAddr), Progress> = HashMap::new();
    loop {
        tick.tick().await;
        let open = connections.open();
        let mut waiting = Vec::new();
        for connection in &open {
            if connection.lasts(Phase::Head).is_some_and(|time| time > config.head_timeout) {
                connection.end(Why::Head);
            } else if connection.waits.load(Ordering::Relaxed) > 0 {
                // Also behind the end of an answer, whose last bytes may take a slow reader longer than an idle connection is kept.
                waiting.push(connection);
            } else if connection.lasts(Phase::Idle).is_some_and(|time| time > config.idle_timeout) {
                connection.end(Why::Idle);
            }
        }
        let key = |connection: &Connection| (connection.local, connection.peer);
        let mut before = std::mem::take(&mut progress);
        // Who has written since is well; the kernel is asked only about the others, and not at once.
        let mut quiet = false;
        for connection in &waiting {
            let written = connection.written.load(Ordering::Relaxed);
            let known = before.remove(&key(connection)).filter(|p| p.written == written);
            let known = known.unwrap_or(Progress { written, queued: None, at: Instant::now() });
            quiet |= known.at.elapsed() > config.stall_timeout / 4;
            progress.insert(key(connection), known);
        }
        if !quiet {
            continue;
        }
        let queues = tokio::task::spawn_blocking(queues).await.unwrap_or_default();
        for connection in waiting {
            let Some(known) = progress.get_mut(&key(connection)) else { continue };
            let queued = queues.get(&key(connection)).copied();
            if queued.is_some() && queued != known.queued {
                // The first look says nothing yet, but costs the reader nothing either.
                known.at = if known.queued.is_some() { Instant::now() } else { known.at };
                known.queued = queued;
            }
            if known.at.elapsed() > config.stall_timeout {
                connection.end(Why::Stalled);
            }
        }
    }
}

/// Bytes that were sent or wait to be, and that the other end has not acknowledged, of all connections (proc(5), `/proc/net/tcp`).
#[cfg(target_os = "linux")]
fn queues() -> HashMap<(SocketAddr, SocketAddr), u64> {
    let all = procfs::net::tcp().into_iter().flatten().chain(procfs::net::tcp6().into_iter().flatten());
    all.map(|entry| ((entry.local_address, entry.remote_address), entry.tx_queue.into())).collect()
}

#[cfg(not(target_os = "linux"))]
fn queues() -> HashMap<(SocketAddr, SocketAddr), u64> {
    HashMap::new()
}
