//! The listener: accepts, serves HTTP/1.1 on each connection, and ends when it is told to.
//!
//! HTTP/2 is not spoken: there one stream that stalls looks like a connection that is well.

use std::convert::Infallible;
use std::io;
use std::sync::Arc;
use std::time::Duration;

use axum::body::Body;
use axum::extract::Request;
use axum::response::Response;
use hyper::body::Incoming;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;
use tower::ServiceExt;

use super::connection::{self, Connection, Socket, Why};
use super::{Service, app, jobs, meters, printing};

/// Bytes that a connection may hold on their way out, besides the kernel's, and of a request's head.
const BUFFER: usize = 64 << 10;

/// Bytes that the kernel may hold for a connection on their way out.
const KERNEL_BUFFER: usize = 64 << 10;

/// Serves until `shutdown` is cancelled, then finishes what can be finished in time.
///
/// # Errors
/// The listener fails for good.
pub async fn run(listener: TcpListener, service: Service, shutdown: CancellationToken) -> io::Result<()> {
    let app = app(&service);
    let tasks = TaskTracker::new();
    let watcher = tokio::spawn(connection::watch(service.connections.clone(), service.config.clone()));
    let keeper = tokio::spawn(jobs::keep(service.clone()));
    let measurer = tokio::spawn(jobs::measure(service.clone()));
    let printer = tokio::spawn(printing::resume(service.clone()));
    let room = Arc::new(Semaphore::new(service.config.max_connections));
    loop {
        // Past the limit new ones wait in the kernel's queue.
        let place = tokio::select! {
            place = room.clone().acquire_owned() => place.expect("it is never closed"),
            () = shutdown.cancelled() => break,
        };
        let stream = tokio::select! {
            accepted = listener.accept() => match accepted {
                Ok((stream, _)) => stream,
                Err(error) if is_passing(&error) => continue,
                Err(error) => {
                    tracing::warn!("cannot accept: {error}");
                    // Most likely no file descriptor is left: one may become free.
                    tokio::time::sleep(Duration::from_millis(100)).await;
                    continue;
                }
            },
            () = shutdown.cancelled() => break,
        };
        let (app, service, shutdown) = (app.clone(), service.clone(), shutdown.clone());
        tasks.spawn(async move {
            let _place = place;
            let _held = meters::Held::new("runset_connections");
            if let Err(error) = serve(stream, app, &service, shutdown).await {
                tracing::debug!("connection: {error}");
            }
        });
    }
    drop(listener);
    service.ending.cancel();
    tasks.close();
    let settled = async { tokio::join!(tasks.wait(), printing::settle(&service)) };
    if tokio::time::timeout(service.config.grace, settled).await.is_err() {
        service.connections.end_all(Why::Shutdown);
        let _ = tokio::time::timeout(Duration::from_secs(5), tasks.wait()).await;
    }
    keeper.abort();
    printer.abort();
    watcher.abort();
    // The measurer ends by itself, behind the portion at hand.
    let _ = tokio::time::timeout(Duration::from_secs(5), measurer).await;
    service.jobs.save_all().await;
    Ok(())
}

async fn serve(
    stream: TcpStream,
    app: axum::Router,
    service: &Service,
    shutdown: CancellationToken,
) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
    stream.set_nodelay(true)?;
    let socket = socket2::SockRef::from(&stream);
    socket.set_send_buffer_size(KERNEL_BUFFER)?;
    let connection = Arc::new(Connection::new(stream.local_addr()?, stream.peer_addr()?));
    service.connections.add(&connection);
    let io = TokioIo::new(Socket::new(stream, connection.clone()));
    let answer = {
        let connection = connection.clone();
        move |request: hyper::Request<Incoming>| {
            let (app, connection) = (app.clone(), connection.clone());
            async move {
                connection.busy();
                let mut request: Request = request.map(Body::new);
                request.extensions_mut().insert(connection);
                let response: Response = app.oneshot(request).await.unwrap_or_else(|never: Infallible| match never {});
                Ok::<_, Infallible>(response)
            }
        }
    };
    let mut http = hyper::server::conn::http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(None).max_buf_size(BUFFER).pipeline_flush(false);
    let served = http.serve_connection(io, service_fn(answer));
    tokio::pin!(served);
    tokio::select! {
        result = served.as_mut() => return Ok(result?),
        () = connection.ended() => return Ok(()),
        () = shutdown.cancelled() => served.as_mut().graceful_shutdown(),
    }
    tokio::select! {
        result = served.as_mut() => Ok(result?),
        () = connection.ended() => Ok(()),
    }
}

/// Whether the fault was that of a connection which was gone before it was accepted.
fn is_passing(error: &io::Error) -> bool {
    use io::ErrorKind as E;
    matches!(error.kind(), E::ConnectionRefused | E::ConnectionAborted | E::ConnectionReset | E::Interrupted)
}
