//! A raster to be pulled: a suspended sweep and an encoder, no thread.
//!
//! It can be left anywhere and taken up again, by another process too: a [`Checkpoint`] is a byte of the raster, the line that it needs first, and
//! what the format has to know of the lines before (`Encode::restart`). A sweep begins at any line.
//!
//! ```text
//!   bytes     |head|--------------|--------|            given so far: up to the mark
//!   lines          |--------------|= = =                = are in an open record or segment: swept again
//!   checkpoint                    ^ offset, line, tally
//! ```

use std::ops::Range;

use super::Job;
use super::pump::{PORTION, Pump};
use super::source::{Cost, Rows};
use crate::encode::{Format, Restart};
use crate::error::{Error, Result};
use crate::run::Lines;

/// About how much work is done before a portion ends, with however few bytes: edges stepped and lines written. A drawing that leaves no
/// bytes for long does not hold its thread for longer than that.
const WORK: u64 = 1 << 18;

/// Whether a stream has more to give.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum More {
    /// There is more.
    More,
    /// That was the end.
    End,
}

/// A place where the raster of a job can be taken up again: the same job, format and [`Format::version`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Checkpoint {
    /// In the bytes of the whole raster.
    pub offset: u64,
    /// The line on the page that is needed first.
    pub line: u32,
    /// What the format has to know of the lines before.
    pub tally: [u64; 3],
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
    /// What was written before anybody asked.
    begun: Vec<u8>,
    /// Bytes of the raster before the next that is given.
    offset: u64,
    /// Of bands that are done.
    cost: Cost,
    /// Behind the end, the last place that was before it.
    end: Option<Checkpoint>,
}

impl Job {
    /// The raster as a stream. Whether the format can hold it is for the caller to ask ([`Format::check`]).
    pub fn stream(&self, format: &Format) -> Stream {
        let mut begun = Vec::new();
        let pump = Pump::new(format, &self.header, &mut begun);
        self.stream_of(pump, begun, self.header.lines.start, 0)
    }

    /// The rest of the raster from a checkpoint on: the bytes behind its offset.
    ///
    /// # Errors
    /// A place that is not in the raster; in formats of a fixed length, one that is not the beginning of a line. Of another job, or with other
    /// sums, it makes wrong bytes.
    pub fn stream_from(&self, format: &Format, from: &Checkpoint) -> Result<Stream> {
        let encoder = (format.encoder)(&self.header);
        let Range { start, end } = self.header.lines;
        let restart = Restart { line: from.line, tally: from.tally };
        let fixed = encoder.length().is_some();
        if !(start..=end).contains(&from.line) || fixed && encoder.seek(from.offset) != Some((from.offset, restart)) {
            let (name, Checkpoint { offset, line, .. }) = (format.name, from);
            let what = format!("byte {offset}, line {line} is no place in this {name} of lines {start}..{end}: begin at its first byte");
            return Err(Error::parameter(what));
        }
        let pump = Pump::resume(encoder, &self.header, &restart);
        Ok(self.stream_of(pump, Vec::new(), from.line, from.offset))
    }

    fn stream_of(&self, pump: Pump, begun: Vec<u8>, line: u32, offset: u64) -> Stream {
        let bands = Box::new(self.bands_from(line));
        Stream { job: self.clone(), bands, rows: None, left: (0, 0), pump, begun, offset, cost: Cost::default(), end: None }
    }

    /// Bytes of the whole raster in formats in which they are known beforehand.
    pub fn length(&self, format: &Format) -> Option<u64> {
        (format.encoder)(&self.header).length()
    }

    /// The last place at or before byte `offset` where the raster can be taken up, in formats in which that is known beforehand. None within
    /// what stands before the first line.
    pub fn seek(&self, format: &Format, offset: u64) -> Option<Checkpoint> {
        let (offset, Restart { line, tally }) = (format.encoder)(&self.header).seek(offset)?;
        Some(Checkpoint { offset, line, tally })
    }
}

impl Stream {
    /// Appends about 64 KiB to `out` (more where one line is longer; less, or nothing, where so few bytes are much work), and tells whether there is
    /// more. After the end it appends nothing.
    pub fn next_band(&mut self, out: &mut Vec<u8>) -> More {
        self.next_within(PORTION, WORK, out)
    }

    /// The same with other bounds: about so many bytes, or so many edges stepped and lines written. At least a line is swept or written.
    pub fn next_within(&mut self, bytes: usize, work: u64, out: &mut Vec<u8>) -> More {
        let before = out.len();
        let more = self.portion(bytes, work, out);
        self.offset = self.offset.saturating_add((out.len() - before) as u64);
        more
    }

    fn portion(&mut self, bytes: usize, work: u64, out: &mut Vec<u8>) -> More {
        if self.end.is_some() {
            return More::End;
        }
        let before = out.len();
        out.append(&mut self.begun);
        let mut done = 0;
        loop {
            if let Some(rows) = self.rows.as_ref().filter(|_| self.left.1 > 0) {
                let took = self.pump.push(Lines { y: self.left.0, n: self.left.1, runs: rows.runs() }, out);
                self.left = (self.left.0 + took, self.left.1 - took);
                done += u64::from(took);
            } else if let Some(rows) = &mut self.rows {
                if let Some(lines) = rows.next() {
                    self.left = (lines.y, lines.n);
                    done += rows.stepped() as u64;
                } else {
                    self.cost.add(&rows.cost());
                    self.rows = None;
                }
            } else if let Some(band) = self.bands.next() {
                self.rows = Some(self.job.source.rows(band));
            } else {
                let given = (out.len() - before) as u64;
                let checkpoint = self.checkpoint();
                self.end = Some(Checkpoint { offset: checkpoint.offset.saturating_add(given), ..checkpoint });
                self.pump.finish(out);
                return More::End;
            }
            if out.len() - before >= bytes || done >= work {
                return More::More;
            }
        }
    }

    /// Where the raster can be taken up again, between two portions. Its offset is the stream's; before the first portion it is behind what
    /// stands before the first line, and behind the end it is before what was written last.
    pub fn checkpoint(&self) -> Checkpoint {
        self.end.unwrap_or_else(|| {
            let Restart { line, tally } = self.pump.restart();
            Checkpoint { offset: self.offset.saturating_add(self.begun.len() as u64), line, tally }
        })
    }

    /// Bytes of the raster up to here, those before a checkpoint included.
    pub fn offset(&self) -> u64 {
        self.offset
    }

    /// Lines of the raster that were handed to the encoder, those before a checkpoint included.
    pub fn lines(&self) -> u32 {
        self.pump.lines
    }

    /// What the sweep has cost so far, since the checkpoint.
    pub fn cost(&self) -> Cost {
        let mut cost = self.cost;
        self.rows.iter().for_each(|rows| cost.add(&rows.cost()));
        cost
    }

    /// Runs so far, since the checkpoint; those of repeated lines too.
    pub fn runs(&self) -> u64 {
        self.pump.runs
    }
}
