//! The service under readers that are slow, stalled or gone, and under requests that mean harm: times and memory are measured, so one test runs at a time.
//!
//! `RUNSET_RELEASE` names the binary to measure; without it the one that cargo built for the tests is taken, and given longer.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, dead_code)] // all of this is tests; of the support each binary uses its part

mod bombs;
mod leaving;
mod slow;
#[path = "../service/support.rs"]
mod support;

use std::sync::{Mutex, MutexGuard, PoisonError};

/// What is measured is the release.
const TIMED: bool = true;

/// One test at a time.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// How much longer than a release the program may take.
fn slower() -> u32 {
    if std::env::var_os("RUNSET_RELEASE").is_some() { 1 } else { 4 }
}
