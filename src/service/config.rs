//! What a service is started with: where it keeps its jobs, who may use it, and its limits, each with a name.

use std::path::PathBuf;
use std::time::Duration;

use crate::input::Fonts;
use crate::print::Address;
use crate::scene::Limits;

/// Settings of a service.
#[derive(Clone, Debug)]
pub struct Config {
    /// The folder of the jobs. It is made if it is not there, and used by one service at a time.
    pub data: PathBuf,
    /// What `Authorization: Bearer` has to carry on every call under `/v1`; none: nobody is asked.
    pub token: Option<String>,
    /// Whether to answer only requests whose `Host` and `Origin` are this machine: for a service that listens on loopback, so that no page of another
    /// site reaches it through a browser.
    pub local_only: bool,
    /// Origins, besides its own, whose pages may use the service (CORS).
    pub origins: Vec<String>,
    /// Printers that the service prints on; it talks to no others.
    pub printers: Vec<Address>,
    /// Fonts for text.
    pub fonts: Fonts,
    /// Limits of what a document holds. `input` bounds a body too, before and after decompression.
    pub limits: Limits,
    /// Pixels of a page.
    pub max_pixels: u64,
    /// Processor time in rows and encoding of one raster.
    pub max_render: Duration,
    /// Bands that are computed at the same time.
    pub max_bands: usize,
    /// Rasters that are being read at the same time.
    pub max_streams: usize,
    /// Documents that are prepared at the same time.
    pub max_preparing: usize,
    /// Requests that wait for a preparation.
    pub max_waiting: usize,
    /// Bytes of all bodies that are being received or wait for their preparation.
    pub max_uploads: u64,
    /// Bytes of all prepared drawings, used or kept.
    pub max_drawings: u64,
    /// Bytes of prepared drawings that are kept although nobody reads them at the moment.
    pub cache: u64,
    /// Bytes of models that are kept, about.
    pub max_models: u64,
    /// Event streams that are open at the same time.
    pub max_events: usize,
    /// Connections that are open at the same time.
    pub max_connections: usize,
    /// Jobs that are kept.
    pub max_jobs: usize,
    /// Jobs that nobody has used for so long are forgotten.
    pub keep: Duration,
    /// Bytes of the documents of all jobs; the oldest that are done go first.
    pub max_store: u64,
    /// Jobs that are being printed at the same time.
    pub max_prints: usize,
    /// How long a printer that is busy or does not answer is asked again.
    pub print_wait: Duration,
    /// How long a job is followed that its printer has.
    pub print_follow: Duration,
    /// Bytes of a document that is put into a file before it is sent, for printers that take no other.
    pub max_spool: u64,
    /// Time for the head of a request.
    pub head_timeout: Duration,
    /// Time in which a body has to make progress.
    pub body_timeout: Duration,
    /// Time after which an idle connection ends.
    pub idle_timeout: Duration,
    /// Time after which a reader that acknowledges nothing is dropped.
    pub stall_timeout: Duration,
    /// Time for what is under way when the service is asked to end.
    pub grace: Duration,
}

impl Config {
    /// The defaults, for a service on loopback with its jobs in `data`.
    pub fn new(data: PathBuf) -> Config {
        let limits = Limits { edges: 20_000_000, faces: 1_000_000, pairs: 1 << 32, ..Limits::default() };
        Config {
            data,
            token: None,
            local_only: true,
            origins: Vec::new(),
            printers: Vec::new(),
            fonts: Fonts::default(),
            max_pixels: 1 << 40,
            max_render: Duration::from_secs(3600),
            max_bands: limits.threads,
            max_streams: 1024,
            max_preparing: limits.threads,
            max_waiting: 256,
            max_uploads: 1 << 30,
            max_drawings: 2 << 30,
            cache: 64 << 20,
            max_models: 512 << 20,
            max_events: 1024,
            max_connections: 4096,
            max_jobs: 10_000,
            keep: Duration::from_secs(7 * 24 * 3600),
            max_store: 4 << 30,
            max_prints: 16,
            print_wait: Duration::from_secs(3600),
            print_follow: Duration::from_secs(24 * 3600),
            max_spool: 16 << 30,
            head_timeout: Duration::from_secs(10),
            body_timeout: Duration::from_secs(30),
            idle_timeout: Duration::from_secs(60),
            stall_timeout: Duration::from_secs(120),
            grace: Duration::from_secs(30),
            limits,
        }
    }
}
