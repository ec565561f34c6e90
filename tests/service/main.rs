//! What the service promises, held against the program on a port of its own. What is timed is in `tests/service_load`.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, dead_code)] // all of this is tests; of the support each binary uses its part

mod access;
mod answers;
mod cuts;
mod ending;
mod events;
mod full;
mod kept;
mod keys;
mod kills;
mod models;
mod moves;
mod outside;
mod solids;
mod support;

/// Nothing here is measured.
const TIMED: bool = false;
