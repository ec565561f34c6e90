//! How far the work is, on standard error: a bar on a terminal, a line a second elsewhere if it was asked for.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressFinish, ProgressStyle};

use super::messages::tell;

/// When progress is shown.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum When {
    /// A bar if standard error is a terminal and the output is not
    Auto,
    /// A bar on a terminal, else a line a second
    Always,
    /// Nothing
    Never,
}

/// What the user says about progress.
#[derive(clap::Args)]
pub struct Watch {
    /// Progress on standard error
    #[arg(long, value_name = "WHEN", value_enum, default_value_t = When::Auto)]
    progress: When,
}

/// What shows the progress; dropped, it takes the bar away.
pub struct Progress {
    total: Option<u32>,
    shown: Shown,
}

enum Shown {
    Nothing,
    Bar(ProgressBar),
    /// When the last line was printed.
    Lines(Option<Instant>),
}

impl Progress {
    /// Progress towards `total` lines, if that is known.
    pub fn new(watch: &Watch, total: Option<u32>, output_is_terminal: bool) -> Progress {
        let terminal = io::stderr().is_terminal();
        let shown = match watch.progress {
            When::Never => Shown::Nothing,
            When::Auto if !terminal || output_is_terminal => Shown::Nothing,
            _ if terminal => Shown::Bar(bar(total)),
            _ => Shown::Lines(None),
        };
        Progress { total, shown }
    }

    /// So many lines are done.
    pub fn set(&mut self, done: u32) {
        match &mut self.shown {
            Shown::Nothing => {}
            Shown::Bar(bar) => bar.set_position(done.into()),
            Shown::Lines(last) => {
                if last.is_none_or(|last| last.elapsed() >= Duration::from_secs(1)) {
                    *last = Some(Instant::now());
                    tell(&match self.total {
                        Some(total) => format!("{done} of {total} lines ({} %)", u64::from(done) * 100 / u64::from(total.max(1))),
                        None => format!("{done} lines"),
                    });
                }
            }
        }
    }
}

fn bar(total: Option<u32>) -> ProgressBar {
    let (bar, template) = match total {
        Some(total) => (ProgressBar::new(total.into()), "{wide_bar} {human_pos} of {human_len} lines, {eta} left"),
        None => (ProgressBar::new_spinner(), "{spinner} {human_pos} lines"),
    };
    bar.with_style(ProgressStyle::with_template(template).expect("the template is well-formed")).with_finish(ProgressFinish::AndClear)
}
