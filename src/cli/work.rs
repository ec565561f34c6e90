//! Options of whatever makes a raster of a document.

use runset::job::Stats;
use runset::scene::Limits;

use super::input::Limit;
use super::messages::tell;
use super::progress::Watch;
use super::values;

/// How the work is done, and what is told of it.
#[derive(clap::Args)]
pub struct Work {
    /// Threads, 1 to 1024; the output does not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = values::whole(1..=1024), allow_negative_numbers = true)]
    threads: Option<u32>,

    #[command(flatten)]
    pub limit: Limit,

    /// Treat warnings as errors: status 1, and nothing is written
    #[arg(long)]
    pub strict: bool,

    /// Print what the run cost as one JSON object, the last line on standard error (times in seconds)
    #[arg(long)]
    stats: bool,

    #[command(flatten)]
    pub watch: Watch,
}

impl Work {
    /// The limits that follow.
    pub fn limits(&self) -> Limits {
        let limits = Limits { input: self.limit.max_input, ..Limits::default() };
        Limits { threads: self.threads.map_or(limits.threads, |n| n as usize), ..limits }
    }

    /// Tells what a run has cost, if that was asked for.
    pub fn tell(&self, stats: &Stats) {
        if self.stats {
            tell(&serde_json::to_string(stats).expect("numbers under fixed names are JSON"));
        }
    }
}
