//! Time that a bound may rest on: what the processor spent on this thread, however busy the machine is.

use std::fs;
use std::time::Duration;

/// Processor time of the calling thread since it began. Threads that it starts do not count.
pub fn cpu() -> Duration {
    let spent = fs::read_to_string("/proc/thread-self/schedstat").expect("Linux keeps it");
    Duration::from_nanos(spent.split(' ').next().and_then(|ns| ns.parse().ok()).expect("nanoseconds come first"))
}
