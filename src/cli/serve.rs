//! `runset serve`: the service on a socket, until a signal ends it.

use std::io::{self, IsTerminal};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use runset::print::Address;
use runset::scene::Limits;
use runset::service::{Config, Service};
use tokio::net::TcpListener;
use tokio_util::sync::CancellationToken;

use super::input::{FontOptions, Limit};
use super::messages::{Failure, reason, tell};
use super::values::{bytes, seconds, whole};

const EXAMPLES: &str = "\
Examples:
  runset serve
      on http://127.0.0.1:8080, for this machine alone
  RUNSET_TOKEN=$(openssl rand -hex 16) runset serve --addr 0.0.0.0:8080 --data /var/lib/runset
      for others, who send Authorization: Bearer with that token

  curl --data-binary @poster.svg -H 'Content-Type: image/svg+xml' 'http://127.0.0.1:8080/v1/fill?format=png&width=2000' -o poster.png

Every option can be given as an environment variable, RUNSET_ and its name: RUNSET_MAX_STREAMS for --max-streams.";

/// Serve rasters over HTTP as they are made, and jobs that survive
///
/// Documents are sent with POST, and their rasters are streamed from the first line on. Jobs are stored: their rasters can be read at any time, from any byte,
/// also after a restart. /openapi.json describes all calls.
#[derive(clap::Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Serve {
    /// Address and port to listen on; any but loopback needs a token
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:8080", env = "RUNSET_ADDR")]
    addr: SocketAddr,

    /// Folder for the jobs [default: runset in the user's folder for data]
    #[arg(long, value_name = "DIR", env = "RUNSET_DATA", value_hint = clap::ValueHint::DirPath)]
    data: Option<PathBuf>,

    /// Token that clients have to send (in the environment it is not seen by other users)
    #[arg(long, value_name = "TOKEN", env = "RUNSET_TOKEN", hide_env_values = true, value_parser = token)]
    token: Option<String>,

    /// Origin whose pages may use the service, such as https://example.org; may be given several times
    #[arg(long, value_name = "ORIGIN", env = "RUNSET_ALLOW_ORIGIN", value_delimiter = ',', value_parser = origin)]
    allow_origin: Vec<String>,

    /// Printer that jobs may be printed on, such as ipp://printer.local/ipp/print; may be given several times. The service talks to no other
    #[arg(long, value_name = "URI", env = "RUNSET_PRINTER", value_delimiter = ',', value_parser = Address::parse)]
    printer: Vec<Address>,

    #[command(flatten)]
    fonts: FontOptions,

    #[command(flatten)]
    limit: Limit,

    #[command(flatten)]
    limits: Bounds,

    /// Format of the log on standard error [default: text on a terminal, else json]
    #[arg(long, value_name = "FORMAT", env = "RUNSET_LOG_FORMAT")]
    log_format: Option<LogFormat>,

    /// What is logged: error, warn, info, debug
    #[arg(long, value_name = "LEVEL", default_value = "info", env = "RUNSET_LOG")]
    log: tracing_subscriber::filter::LevelFilter,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum LogFormat {
    Text,
    Json,
}

/// Limits of the service.
#[derive(clap::Args)]
#[command(next_help_heading = "Limits")]
struct Bounds {
    /// Edges of a drawing after flattening
    #[arg(long, value_name = "N", default_value_t = 20_000_000, env = "RUNSET_MAX_EDGES")]
    max_edges: u64,
    /// Faces of a model, all parts together
    #[arg(long, value_name = "N", default_value_t = 1_000_000, env = "RUNSET_MAX_FACES")]
    max_faces: u64,
    /// Points, edges and faces of a model compared in pairs, to tell which are the same
    #[arg(long, value_name = "N", default_value_t = 1 << 32, env = "RUNSET_MAX_PAIRS")]
    max_pairs: u64,
    /// Pixels of a raster
    #[arg(long, value_name = "N", default_value_t = 1 << 40, env = "RUNSET_MAX_PIXELS")]
    max_pixels: u64,
    /// Processor time in making one raster, in seconds
    #[arg(long, value_name = "S", default_value = "3600", env = "RUNSET_MAX_RENDER", value_parser = seconds)]
    max_render: Duration,
    /// Bands under way at the same time [default: all cores]
    #[arg(long, value_name = "N", env = "RUNSET_MAX_BANDS", value_parser = whole(1..=1024))]
    max_bands: Option<u32>,
    /// Rasters being read at the same time
    #[arg(long, value_name = "N", default_value_t = 1024, env = "RUNSET_MAX_STREAMS", value_parser = whole(1..=1_000_000))]
    max_streams: u32,
    /// Documents being prepared at the same time [default: all cores]
    #[arg(long, value_name = "N", env = "RUNSET_MAX_PREPARING", value_parser = whole(1..=1024))]
    max_preparing: Option<u32>,
    /// Requests that wait for that
    #[arg(long, value_name = "N", default_value_t = 256, env = "RUNSET_MAX_WAITING", value_parser = whole(0..=1_000_000))]
    max_waiting: u32,
    /// Bytes of all documents being received or waiting
    #[arg(long, value_name = "BYTES", default_value = "1G", env = "RUNSET_MAX_UPLOADS", value_parser = bytes)]
    max_uploads: u64,
    /// Bytes of all drawings being read, about
    #[arg(long, value_name = "BYTES", default_value = "2G", env = "RUNSET_MAX_DRAWINGS", value_parser = bytes)]
    max_drawings: u64,
    /// Bytes of drawings kept for the next request, about
    #[arg(long, value_name = "BYTES", default_value = "64M", env = "RUNSET_CACHE", value_parser = bytes)]
    cache: u64,
    /// Bytes of models kept to be seen from anywhere, about
    #[arg(long, value_name = "BYTES", default_value = "512M", env = "RUNSET_MAX_MODELS", value_parser = bytes)]
    max_models: u64,
    /// Event streams open at the same time
    #[arg(long, value_name = "N", default_value_t = 1024, env = "RUNSET_MAX_EVENTS", value_parser = whole(1..=1_000_000))]
    max_events: u32,
    /// Connections open at the same time; more wait
    #[arg(long, value_name = "N", default_value_t = 4096, env = "RUNSET_MAX_CONNECTIONS", value_parser = whole(1..=1_000_000))]
    max_connections: u32,
    /// Jobs kept
    #[arg(long, value_name = "N", default_value_t = 10_000, env = "RUNSET_MAX_JOBS", value_parser = whole(1..=10_000_000))]
    max_jobs: u32,
    /// Bytes of the documents of all jobs; the oldest that are done go first
    #[arg(long, value_name = "BYTES", default_value = "4G", env = "RUNSET_MAX_STORE", value_parser = bytes)]
    max_store: u64,
    /// Jobs that nobody used for so long are forgotten, in seconds
    #[arg(long, value_name = "S", default_value = "604800", env = "RUNSET_KEEP", value_parser = seconds)]
    keep: Duration,
    /// Jobs being printed at the same time
    #[arg(long, value_name = "N", default_value_t = 16, env = "RUNSET_MAX_PRINTS", value_parser = whole(1..=1_000_000))]
    max_prints: u32,
    /// Time for which a printer that is busy or does not answer is asked again, in seconds
    #[arg(long, value_name = "S", default_value = "3600", env = "RUNSET_PRINT_WAIT", value_parser = seconds)]
    print_wait: Duration,
    /// Time for which a job is followed that its printer has, in seconds
    #[arg(long, value_name = "S", default_value = "86400", env = "RUNSET_PRINT_FOLLOW", value_parser = seconds)]
    print_follow: Duration,
    /// Bytes of a document that is put into a file first, for printers that take no other
    #[arg(long, value_name = "BYTES", default_value = "16G", env = "RUNSET_MAX_SPOOL", value_parser = bytes)]
    max_spool: u64,
    /// Time for the head of a request, in seconds
    #[arg(long, value_name = "S", default_value = "10", env = "RUNSET_HEAD_TIMEOUT", value_parser = seconds)]
    head_timeout: Duration,
    /// Time in which a body has to make progress, in seconds
    #[arg(long, value_name = "S", default_value = "30", env = "RUNSET_BODY_TIMEOUT", value_parser = seconds)]
    body_timeout: Duration,
    /// Time after which an idle connection ends, in seconds
    #[arg(long, value_name = "S", default_value = "60", env = "RUNSET_IDLE_TIMEOUT", value_parser = seconds)]
    idle_timeout: Duration,
    /// Time after which a reader that acknowledges nothing is dropped, in seconds
    #[arg(long, value_name = "S", default_value = "120", env = "RUNSET_STALL_TIMEOUT", value_parser = seconds)]
    stall_timeout: Duration,
    /// Time for what is under way when the service is asked to end, in seconds
    #[arg(long, value_name = "S", default_value = "30", env = "RUNSET_GRACE", value_parser = seconds)]
    grace: Duration,
}

fn token(text: &str) -> Result<String, String> {
    let plain = (8..=1024).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_graphic());
    if plain { Ok(text.to_owned()) } else { Err("give 8 to 1024 visible ASCII characters".to_owned()) }
}

fn origin(text: &str) -> Result<String, String> {
    let rest = text.strip_prefix("https://").or_else(|| text.strip_prefix("http://"));
    let plain = rest.is_some_and(|host| !host.is_empty() && host.bytes().all(|b| b.is_ascii_graphic() && !matches!(b, b'/' | b'*')));
    if plain {
        Ok(text.to_owned())
    } else {
        Err("give a scheme, a host and a port if there is one, such as https://example.org".to_owned())
    }
}

impl Serve {
    fn config(&self) -> Result<Config, Failure> {
        let loopback = self.addr.ip().is_loopback();
        if !loopback && self.token.is_none() {
            let what = format!("{} can be reached by others: give a token in RUNSET_TOKEN, or listen on 127.0.0.1", self.addr.ip());
            return Err(Failure::Usage(what));
        }
        let data = match &self.data {
            Some(data) => data.clone(),
            None => folder().ok_or_else(|| Failure::Usage("there is no home folder: name a folder for the jobs with --data".to_owned()))?,
        };
        let bounds = &self.limits;
        let limits = Limits {
            input: self.limit.max_input,
            edges: bounds.max_edges,
            faces: bounds.max_faces,
            pairs: bounds.max_pairs,
            ..Limits::default()
        };
        let or_cores = |n: Option<u32>| n.map_or(limits.threads, |n| n as usize);
        Ok(Config {
            token: self.token.clone(),
            local_only: loopback,
            origins: self.allow_origin.clone(),
            printers: self.printer.clone(),
            fonts: self.fonts.load(&self.limit)?,
            limits,
            max_pixels: bounds.max_pixels,
            max_render: bounds.max_render,
            max_bands: or_cores(bounds.max_bands),
            max_streams: bounds.max_streams as usize,
            max_preparing: or_cores(bounds.max_preparing),
            max_waiting: bounds.max_waiting as usize,
            max_uploads: bounds.max_uploads,
            max_drawings: bounds.max_drawings,
            cache: bounds.cache,
            max_models: bounds.max_models,
            max_events: bounds.max_events as usize,
            max_connections: bounds.max_connections as usize,
            max_jobs: bounds.max_jobs as usize,
            keep: bounds.keep,
            max_store: bounds.max_store,
            max_prints: bounds.max_prints as usize,
            print_wait: bounds.print_wait,
            print_follow: bounds.print_follow,
            max_spool: bounds.max_spool,
            head_timeout: bounds.head_timeout,
            body_timeout: bounds.body_timeout,
            idle_timeout: bounds.idle_timeout,
            stall_timeout: bounds.stall_timeout,
            grace: bounds.grace,
            ..Config::new(data)
        })
    }
}

/// Where a user's programs keep data (XDG Base Directory Specification).
fn folder() -> Option<PathBuf> {
    let absolute = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let data = absolute("XDG_DATA_HOME").or_else(|| absolute("HOME").map(|home| home.join(".local/share")));
    data.map(|data| data.join("runset"))
}

/// Runs the subcommand.
///
/// # Errors
/// The address or the folder cannot be used.
pub fn run(args: &Serve) -> Result<(), Failure> {
    let config = args.config()?;
    log(args);
    let files = files(args.limits.max_connections);
    let data = config.data.clone();
    // Bands and preparations are bounded by their own limits; what is left is the store and files.
    let blocking = config.max_bands + config.max_preparing + 32;
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().max_blocking_threads(blocking).build();
    let runtime = runtime.map_err(|error| Failure::at("runset", reason(&error)))?;
    let ended = runtime.block_on(async {
        let listener = TcpListener::bind(args.addr)
            .await
            .map_err(|error| Failure::at(args.addr, format_args!("cannot listen: {}", reason(&error))))?;
        let service = Service::open(config).map_err(|error| Failure::Failed(error.to_string()))?;
        let shutdown = CancellationToken::new();
        tokio::spawn(signals(shutdown.clone()));
        let addr = listener.local_addr().unwrap_or(args.addr);
        tell(&format!("runset: listening on http://{addr}, jobs in {}", data.display()));
        tracing::info!(%addr, data = %data.display(), files, version = env!("CARGO_PKG_VERSION"), "start");
        runset::service::run(listener, service, shutdown).await.map_err(|error| Failure::at(addr, reason(&error)))?;
        tracing::info!("end");
        Ok(())
    });
    // A drawing that is still being prepared is of no use any more.
    runtime.shutdown_background();
    ended
}

/// Asks the service to end at the first signal; the second ends the process at once.
async fn signals(shutdown: CancellationToken) {
    use tokio::signal::unix::{SignalKind, signal};
    let (Ok(mut term), Ok(mut int)) = (signal(SignalKind::terminate()), signal(SignalKind::interrupt())) else { return };
    for status in [None, Some(143)] {
        tokio::select! {
            _ = term.recv() => {}
            _ = int.recv() => {}
        }
        match status {
            None => shutdown.cancel(),
            Some(status) => std::process::exit(status),
        }
    }
}

fn log(args: &Serve) {
    let json = match args.log_format {
        Some(LogFormat::Json) => true,
        Some(LogFormat::Text) => false,
        None => !io::stderr().is_terminal(),
    };
    let log = tracing_subscriber::fmt().with_writer(io::stderr).with_max_level(args.log).with_target(false);
    // Another one is there if the program is run as a part of another: then that one is used.
    let _ = if json { log.json().flatten_event(true).try_init() } else { log.try_init() };
}

/// Raises the number of files that the process may have open to what the connections need, as far as it may; gives what it is.
fn files(connections: u32) -> Option<u64> {
    use rustix::process::{Resource, getrlimit, setrlimit};
    const OTHERS: u64 = 256;
    let mut limit = getrlimit(Resource::Nofile);
    let wanted = u64::from(connections) + OTHERS;
    if limit.current.is_some_and(|current| current < wanted) {
        limit.current = Some(limit.maximum.map_or(wanted, |maximum| maximum.min(wanted)));
        // What cannot be raised stays: connections then wait for files.
        let _ = setrlimit(Resource::Nofile, limit);
    }
    getrlimit(Resource::Nofile).current
}
