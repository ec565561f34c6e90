//! Signals that end the program take its unfinished files along.
//!
//! A thread waits for the signals, so that it runs while the work is blocked in a read or a write. It removes the files and lets the
//! signal do what it does by default: whoever started the program sees that it died of that signal. The list is locked while a file
//! is made or renamed, and stays locked from the signal to the end: there is no moment in which a file could be left behind or a
//! half-written one be given its name.

use std::fs;
use std::io;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread;

use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXCPU, SIGXFSZ};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

/// The signals that end the program.
const DEADLY: [i32; 5] = [SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXCPU];

static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// The files to remove when a signal ends the program. While the guard lives no signal does.
pub fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Starts to watch for signals, once.
///
/// # Errors
/// No thread can be started.
pub fn watch() -> io::Result<()> {
    static STARTED: OnceLock<()> = OnceLock::new();
    if STARTED.set(()).is_err() {
        return Ok(());
    }
    let ignored = ignored();
    let mut signals = Signals::new(DEADLY.into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0))?;
    // Caught, it leaves a file past the size limit to be what it is: a write that fails.
    signal_hook::flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)))?;
    thread::Builder::new().name("signals".to_owned()).spawn(move || {
        if let Some(signal) = signals.forever().next() {
            let files = unfinished();
            for file in files.iter() {
                // A file that cannot be removed stays under its temporary name.
                let _ = fs::remove_file(file);
            }
            let _ = emulate_default_handler(signal);
            std::process::exit(128 + signal);
        }
    })?;
    Ok(())
}

/// The signals that whoever started the program wants ignored (`nohup`, a shell's background job), bit `n - 1` for signal `n`.
/// Known on Linux; elsewhere none.
fn ignored() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}
