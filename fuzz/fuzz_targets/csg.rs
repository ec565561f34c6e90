//! `cargo +nightly fuzz run csg`: see `tests/doors/mod.rs`.
#![no_main]

#[path = "../../tests/doors/mod.rs"]
mod doors;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| doors::csg(bytes));
