//! Why something is not printed.

use std::fmt;

/// What kind of failure it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// What is asked for is wrong in itself, or not what the printer can.
    Wish,
    /// The printer refuses it.
    Refused,
    /// The printer is busy: the same may be asked again.
    Busy,
    /// The printer cannot be reached: the same may be asked again.
    Unreachable,
    /// The connection broke while a request was under way.
    Broken,
    /// The answer is no IPP, or past a limit.
    Malformed,
    /// The printer wants to know how long a document is before it comes.
    Length,
    /// The raster could not be made.
    Raster,
    /// It was cancelled, here or at the printer.
    Cancelled,
    /// The printer gave the job up.
    Aborted,
    /// Whether anything was printed is not known.
    Unknown,
    /// What is known could not be kept; nothing more was done.
    Kept,
}

/// Why something is not printed, in one line that says what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// What kind of failure it is.
    pub why: Why,
    /// What happened, and what to do.
    pub what: String,
}

impl Failure {
    /// A failure in words.
    pub fn new(why: Why, what: impl Into<String>) -> Failure {
        /// What a printer says of itself may be long.
        const LONGEST: usize = 600;
        let line: String = what.into().chars().map(|c| if c.is_control() { ' ' } else { c }).take(LONGEST).collect();
        Failure { why, what: line }
    }

    /// Whether the same may be asked again, because nothing has come of it.
    pub fn is_passing(&self) -> bool {
        matches!(self.why, Why::Busy | Why::Unreachable | Why::Broken)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.what)
    }
}

impl std::error::Error for Failure {}
