//! What the service counts, as Prometheus reads it.

use std::sync::OnceLock;
use std::time::Duration;

use metrics::{counter, describe_counter, describe_gauge, describe_histogram, gauge, histogram};
use metrics_exporter_prometheus::{Matcher, PrometheusBuilder, PrometheusHandle};

/// The text of all counters of the process (Prometheus's exposition format 0.0.4).
pub fn text() -> String {
    let handle = handle();
    handle.run_upkeep();
    handle.render()
}

/// Gathers what was measured since it was done last, which would grow if nobody asked for [`text`].
pub fn gather() {
    handle().run_upkeep();
}

/// Starts counting, once in a process.
pub fn start() {
    handle();
}

fn handle() -> &'static PrometheusHandle {
    static HANDLE: OnceLock<PrometheusHandle> = OnceLock::new();
    HANDLE.get_or_init(|| {
        const SECONDS: [f64; 11] = [0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 1.0, 5.0, 30.0];
        let builder = PrometheusBuilder::new().set_buckets_for_metric(Matcher::Suffix("_seconds".to_owned()), &SECONDS);
        let recorder = builder.expect("the buckets are not empty").build_recorder();
        let handle = recorder.handle();
        if metrics::set_global_recorder(recorder).is_err() {
            tracing::warn!("another recorder of metrics is installed: /metrics stays empty");
        }
        describe_counter!("runset_requests_total", "Requests by status");
        describe_counter!("runset_renders_total", "Rasters that were begun, by kind and format");
        describe_counter!("runset_ends_total", "Rasters that ended: complete, left, stalled, failed, limit, shutdown");
        describe_counter!("runset_prints_total", "Prints that ended: printed, failed");
        describe_counter!("runset_lines_total", "Scanlines handed to readers");
        describe_counter!("runset_bytes_total", "Bytes of rasters handed to readers");
        describe_counter!("runset_refusals_total", "Requests refused, by limit");
        describe_counter!("runset_connections_ended_total", "Connections ended by the service, by reason");
        describe_gauge!("runset_streams", "Rasters that are being read");
        describe_gauge!("runset_connections", "Connections that are open");
        describe_gauge!("runset_queue", "Portions and preparations that wait for a thread, by queue");
        describe_gauge!("runset_jobs", "Jobs that are kept");
        describe_gauge!("runset_drawings_bytes", "Bytes of prepared drawings, estimated");
        describe_gauge!("runset_models_bytes", "Bytes of kept models, estimated");
        describe_histogram!("runset_first_line_seconds", "From a request to its first line");
        handle
    })
}

/// A request was answered.
pub fn request(status: u16) {
    counter!("runset_requests_total", "status" => status.to_string()).increment(1);
}

/// A raster begins.
pub fn render(kind: &'static str, format: &'static str) {
    counter!("runset_renders_total", "kind" => kind, "format" => format).increment(1);
}

/// Its first line is there.
pub fn first_line(after: Duration) {
    histogram!("runset_first_line_seconds").record(after);
}

/// Lines and bytes went to a reader.
pub fn delivered(lines: u32, bytes: u64) {
    counter!("runset_lines_total").increment(lines.into());
    counter!("runset_bytes_total").increment(bytes);
}

/// A raster ended.
pub fn end(how: &'static str) {
    counter!("runset_ends_total", "end" => how).increment(1);
}

/// A print ended.
pub fn printed(how: &'static str) {
    counter!("runset_prints_total", "end" => how).increment(1);
}

/// Something was refused for a limit.
pub fn refused(limit: &'static str) {
    counter!("runset_refusals_total", "limit" => limit).increment(1);
}

/// The service ended a connection.
pub fn connection_ended(why: &'static str) {
    counter!("runset_connections_ended_total", "reason" => why).increment(1);
}

/// How many there are now.
pub fn level(name: &'static str, n: usize) {
    gauge!(name).set(n as f64);
}

/// One more or less while it lives: `runset_streams`, `runset_connections`.
pub struct Held(&'static str);

impl Held {
    /// One more of `name`.
    pub fn new(name: &'static str) -> Held {
        gauge!(name).increment(1.0);
        Held(name)
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        gauge!(self.0).decrement(1.0);
    }
}

/// One that waits in a queue while it lives.
pub struct Waits(&'static str);

impl Waits {
    /// One more in `queue`.
    pub fn new(queue: &'static str) -> Waits {
        gauge!("runset_queue", "queue" => queue).increment(1.0);
        Waits(queue)
    }
}

impl Drop for Waits {
    fn drop(&mut self) {
        gauge!("runset_queue", "queue" => self.0).decrement(1.0);
    }
}
