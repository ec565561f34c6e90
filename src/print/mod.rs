//! Printing over IPP (RFC 8010, RFC 8011): a raster goes to a printer as it is made, and is followed until the printer says that it is printed.
//!
//! ```text
//!   address    where a printer is           message   requests and answers, bounded
//!   client     HTTP below them              printer   what a printer says it can
//!   media      sizes and their names        choice    format, resolution, medium, and why
//!   wishes     what is asked for            sheet     where a drawing lies
//!   body       a raster on its way          errand    validate, create
//!   sending    the document                 following to the printer's last word
//!   job        as its printer sees it       waited    patience
//!   find       printers on the network
//! ```
//!
//! An errand has stages, and what is known of a stage is told before the next begins, so that another process can go on:
//!
//! ```text
//!   New --Validate-Job, Create-Job--> Created --Send-Document--> Sending --the printer has taken it--> Sent --> printed
//!    ^ busy: waits and asks again        ^                         |
//!                                        +--nothing was received---+--else: cancelled at the printer, and told
//! ```
//!
//! Up to `Created` nothing can be printed, so all of it may be repeated. A document is sent again only if the printer says that it has nothing of it. "Printed" is the
//! state that the printer gives the job, of a document whose receipt it has confirmed; bytes that were sent are no pages.

pub mod address;
pub mod body;
pub mod choice;
mod client;
mod errand;
mod failure;
pub mod find;
mod following;
mod job;
pub mod media;
mod message;
mod printer;
mod sending;
pub mod sheet;
mod waited;
pub mod wishes;

use std::time::Duration;

pub use address::Address;
pub use client::Client;
pub use errand::{Document, Errand, Printed, Stage, Watch, cancel, run};
pub use failure::{Failure, Why};
pub use job::{Job, State, Status};
pub use printer::{Printer, Status as PrinterStatus, ask};

/// Limits of what a printer may cost.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// How long a printer that is busy or does not answer is asked again.
    pub wait: Duration,
    /// How long a job is followed that its printer has.
    pub follow: Duration,
    /// Time to connect.
    pub connect: Duration,
    /// Time for an answer to a request without a document.
    pub answer: Duration,
    /// Bytes of an answer.
    pub answer_bytes: usize,
    /// Bytes of a document that is kept in a file before it is sent.
    pub spool: u64,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits {
            wait: Duration::from_secs(120),
            follow: Duration::from_secs(24 * 3600),
            connect: Duration::from_secs(10),
            answer: Duration::from_secs(30),
            answer_bytes: 4 << 20,
            spool: 16 << 30,
        }
    }
}
