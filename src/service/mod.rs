//! The service: rasters over HTTP as they are made, and jobs that survive.
//!
//! ```text
//!   server      accepts, HTTP/1.1, ends            connection   times of a connection, stalled readers
//!   access      token, origin, log                 problem      errors as RFC 9457
//!   params      the query                          intake       the body
//!   ask         what is made of a document         drawings     prepared once, shared
//!   cache       made once, shared, some kept
//!   answer      a document in, its raster out      raster       a suspended sweep as a body
//!   fill        POST /v1/fill                      solid        POST /v1/solid
//!   models      kept to be seen from anywhere      views        what is seen of them
//!   jobs        stored, resumable at any byte
//!   printing    jobs on printers
//!   inspect     names of a drawing, how its lines come about
//!   page        what a browser shows at /
//!   about       health, metrics, OpenAPI
//! ```
//!
//! Nothing is rendered on the threads that serve connections: preparing a document and making a portion of a raster are tasks for
//! other threads, as many at once as [`Config::max_preparing`] and [`Config::max_bands`] say. A raster that waits for its reader holds no
//! thread.

mod about;
mod access;
mod answer;
mod ask;
mod cache;
mod config;
mod connection;
mod drawings;
mod fill;
mod inspect;
mod intake;
#[allow(unused_qualifications, reason = "the macro that describes handlers writes them")]
mod jobs;
mod meters;
mod models;
mod page;
mod params;
#[allow(unused_qualifications, reason = "the macro that describes handlers writes them")]
mod printing;
mod problem;
mod raster;
mod rest;
mod server;
mod solid;
mod views;

pub use config::Config;
pub use server::run;

use std::io;
use std::sync::Arc;

use axum::http::header::{self, HeaderName, HeaderValue};
use axum::http::{Method, StatusCode};
use axum::{Router, middleware};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio_util::sync::CancellationToken;
use tower_http::cors::{AllowOrigin, CorsLayer};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use self::connection::Connections;
use self::drawings::Drawings;
use self::intake::Uploads;
use self::jobs::Jobs;
use self::models::Models;
use self::problem::Problem;
use self::views::Moved;

/// A service: what its handlers share. A clone is cheap.
#[derive(Clone)]
pub struct Service {
    config: Arc<Config>,
    connections: Arc<Connections>,
    drawings: Arc<Drawings>,
    models: Arc<Models>,
    moved: Arc<Moved>,
    uploads: Uploads,
    jobs: Arc<Jobs>,
    /// Places for rasters that are being read.
    streams: Arc<Semaphore>,
    /// Places for bands under way, given in the order of asking.
    bands: Arc<Semaphore>,
    /// Places for event streams.
    events: Arc<Semaphore>,
    /// Places for prints under way.
    prints: Arc<Semaphore>,
    /// Cancelled when the service is asked to end.
    ending: CancellationToken,
}

impl Service {
    /// A service with the jobs that its folder holds.
    ///
    /// # Errors
    /// The folder cannot be used, or another service uses it.
    pub fn open(config: Config) -> io::Result<Service> {
        meters::start();
        let config = Arc::new(config);
        Ok(Service {
            connections: Arc::default(),
            drawings: Arc::new(Drawings::new(config.clone())),
            models: Arc::default(),
            moved: Arc::default(),
            uploads: Uploads::new(config.max_uploads),
            jobs: Arc::new(Jobs::open(&config)?),
            streams: Arc::new(Semaphore::new(config.max_streams)),
            bands: Arc::new(Semaphore::new(config.max_bands)),
            events: Arc::new(Semaphore::new(config.max_events)),
            prints: Arc::new(Semaphore::new(config.max_prints)),
            ending: CancellationToken::new(),
            config,
        })
    }

    /// A place among the open streams.
    fn place(&self) -> Result<OwnedSemaphorePermit, Problem> {
        if self.ending.is_cancelled() {
            return Err(Problem::busy("ending", "the service is about to end: try again later", 5));
        }
        let full = || Problem::busy("streams", format!("{} rasters are being read: try again later", self.config.max_streams), 5);
        self.streams.clone().try_acquire_owned().map_err(|_| full())
    }
}

/// All that the service answers.
pub fn app(service: &Service) -> Router {
    let (router, api) = OpenApiRouter::with_openapi(about::api())
        .routes(routes!(fill::fill))
        .routes(routes!(solid::solid))
        .routes(routes!(models::list, models::put))
        .routes(routes!(models::show, models::delete))
        .routes(routes!(views::view, views::view_head))
        .routes(routes!(views::pick))
        .routes(routes!(inspect::info))
        .routes(routes!(inspect::explain))
        .routes(routes!(jobs::list, jobs::create))
        .routes(routes!(jobs::show, jobs::delete))
        .routes(routes!(jobs::raster::read, jobs::raster::head))
        .routes(routes!(jobs::events::events))
        .routes(routes!(printing::printers))
        .routes(routes!(printing::print, printing::show, printing::cancel))
        .routes(routes!(about::healthz))
        .routes(routes!(about::readyz))
        .routes(routes!(about::metrics))
        .split_for_parts();
    let description = about::describe(api);
    let described = axum::routing::get(move || about::openapi(description.clone()));
    let app = router
        .route("/openapi.json", described)
        .merge(page::routes())
        .fallback(|| async { Problem::new(StatusCode::NOT_FOUND, "not-found", "there is nothing here: see /openapi.json") })
        .method_not_allowed_fallback(|| async {
            Problem::new(StatusCode::METHOD_NOT_ALLOWED, "method-not-allowed", "this method is not for this address: see /openapi.json")
        })
        .layer(middleware::from_fn_with_state(service.clone(), access::pass))
        .with_state(service.clone());
    if service.config.origins.is_empty() { app } else { app.layer(cors(&service.config.origins)) }
}

/// Pages of other origins may use the service only where these are named.
fn cors(origins: &[String]) -> CorsLayer {
    let origins: Vec<HeaderValue> = origins.iter().filter_map(|origin| origin.parse().ok()).collect();
    let exposed = [header::CONTENT_LENGTH, header::CONTENT_RANGE, header::ETAG, header::LOCATION, header::RETRY_AFTER, access::REQUEST_ID];
    let taken = [
        header::AUTHORIZATION,
        header::CONTENT_TYPE,
        header::IF_NONE_MATCH,
        header::IF_RANGE,
        header::RANGE,
        HeaderName::from_static("idempotency-key"),
    ];
    CorsLayer::new()
        .allow_origin(AllowOrigin::list(origins))
        .allow_methods([Method::GET, Method::HEAD, Method::POST, Method::PUT, Method::DELETE])
        .allow_headers(taken)
        .expose_headers(exposed)
}
