//! Several rasters as the pages of one file.

use std::io::Write;

use super::{Job, Stats};
use crate::encode::Format;
use crate::error::{Error, Result};
use crate::run::Sheet;

/// Writes the rasters of `of` jobs as the pages of one file; `job` makes the one of a page's number, from 0. A job is made when the pages before it are written, and
/// dropped before the next, so that one is in memory at a time. `progress` is called with a page's number and the number of its lines written so far. Gives what each page cost.
///
/// Each job's [`Sheet::pixels`] are kept; its number and the number of pages are set here.
///
/// # Errors
/// Before the first byte: no page, several pages where a file holds one. Then those of `job` and of [`Job::render`]; what was written until then is not a whole file.
pub fn render_sheets(
    of: u32,
    job: &mut dyn FnMut(u32) -> Result<Job>,
    format: &Format,
    threads: usize,
    out: &mut dyn Write,
    progress: &mut dyn FnMut(u32, u32),
) -> Result<Vec<Stats>> {
    if of == 0 {
        return Err(Error::parameter("a file has one page at least: name an input"));
    }
    (0..of).map(|number| job(number)?.as_sheet(number, of).render(format, threads, out, &mut |lines| progress(number, lines))).collect()
}

impl Job {
    /// The same job as the page of that number, from 0, in a file of `of` pages.
    #[must_use]
    pub fn as_sheet(mut self, number: u32, of: u32) -> Job {
        self.header.sheet = Sheet { number, of, ..self.header.sheet };
        self
    }
}
