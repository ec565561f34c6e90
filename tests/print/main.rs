//! Printing, against a printer that is not ours (`ippeveprinter`), another client (`ipptool`), and printers that misbehave.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)] // all of this is tests

mod command;
mod faults;
mod garbage;
mod service;
#[allow(dead_code)] // of it these tests use a part
#[path = "../service/support.rs"]
mod serving;
mod support;

/// Nothing here is measured.
const TIMED: bool = false;
