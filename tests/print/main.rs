//! Printing, against a printer that is not ours (`ippeveprinter`), another client (`ipptool`), and printers that misbehave.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)] // all of this is tests

mod command;
mod faults;
mod garbage;
mod support;
