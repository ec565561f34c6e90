//! A raster to be pulled: a suspended sweep and an encoder, no thread.

use std::ops::Range;

use super::Job;
use super::pump::{PORTION, Pump};
use crate::encode::Format;
use crate::region::Rows;
use crate::run::Lines;

/// Whether a stream has more to give.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum More {
    /// There is more.
    More,
    /// That was the end.
    End,
}

/// The raster of a job, pulled portion by portion.
pub struct Stream {
    job: Job,
    /// Bands still to be begun.
    bands: Box<dyn Iterator<Item = Range<u32>> + Send>,
    rows: Option<Rows>,
    /// Lines of the row at hand that were not written yet: the first, and how many.
    left: (u32, u32),
    pump: Pump,
    begun: Vec<u8>,
}

impl Job {
    /// The raster as a stream.
    pub fn stream(&self, format: &Format) -> Stream {
        let mut begun = Vec::new();
        let pump = Pump::new(format, &self.header, &mut begun);
        Stream { job: self.clone(), bands: Box::new(self.bands()), rows: None, left: (0, 0), pump, begun }
    }
}

impl Stream {
    /// Appends about 64 KiB to `out` (more where one line is longer), and tells whether there is more. After the end it appends nothing.
    pub fn next_band(&mut self, out: &mut Vec<u8>) -> More {
        let before = out.len();
        out.append(&mut self.begun);
        while out.len() - before < PORTION {
            if self.left.1 > 0 {
                let Some(rows) = &self.rows else { break };
                let took = self.pump.push(Lines { y: self.left.0, n: self.left.1, runs: rows.runs() }, out);
                self.left = (self.left.0 + took, self.left.1 - took);
            } else if let Some(lines) = self.rows.as_mut().and_then(Rows::next) {
                self.left = (lines.y, lines.n);
            } else if let Some(band) = self.bands.next() {
                self.rows = Some(Rows::new(self.job.picture.clone(), band));
            } else {
                if self.rows.take().is_some() {
                    self.pump.finish(out);
                }
                return More::End;
            }
        }
        More::More
    }
}
