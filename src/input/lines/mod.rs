//! Reader of line streams: ndjson (header, records, end record) and rls (`docs/rls.md`), told by the first byte.
//!
//! One record is held at a time, whatever the stream's length. A stream is taken at its word only where the word has been
//! checked: width, lines and inks are within their limits, runs are sorted, apart and within the width (so there are never more
//! than pixels), records cover every line once, and the end record agrees with what went by, pixels included. What is handed
//! out before the end record is therefore well formed, but only the end record tells that it is all.
//!
//! A record need not be maximal nor end at a multiple of [`crate::run::RECORD_LINES`]: what it means is plain, and the writers
//! gather lines anew.

mod ndjson;
mod rls;

pub(super) use rls::MAGIC as RLS;

use std::io::BufRead;
use std::ops::Range;

use crate::checksum::Checksum;
use crate::error::{Error, Kind, Result};
use crate::grid::{MAX_HEIGHT, MAX_WIDTH};
use crate::run::{Header, Hex, Inks, Lines, Rgb, Run, Sheet};

/// A result whose message still lacks its place.
type Checked<T = ()> = std::result::Result<T, String>;

/// A line stream that is being read.
pub struct LineReader<'i> {
    source: Source<'i>,
    raster: Raster,
    /// How the stream ended.
    end: Option<Result<()>>,
}

enum Source<'i> {
    Ndjson(ndjson::Reader<'i>),
    Rls(rls::Reader<'i>),
}

impl<'i> LineReader<'i> {
    /// Reads the header of a line stream.
    ///
    /// # Errors
    /// What follows is no line stream, its header is malformed or past a limit, or reading fails. The place is line and column in
    /// ndjson; for rls the message names the byte, counted from 0.
    pub fn open(input: &'i mut dyn BufRead) -> Result<LineReader<'i>> {
        let (source, raster) = match next_bytes(input, |bytes| bytes.first().copied())? {
            Some(b'{') => {
                let mut reader = ndjson::Reader::new(input);
                let raster = reader.header()?;
                (Source::Ndjson(reader), raster)
            }
            Some(byte) if byte == rls::MAGIC[0] => {
                let mut reader = rls::Reader::new(input);
                let raster = reader.header()?;
                (Source::Rls(reader), raster)
            }
            Some(b'<') => return Err(malformed("not a line stream; an SVG is drawn by runset fill")),
            Some(_) => return Err(malformed("not a line stream: neither ndjson nor rls begins like this")),
            None => return Err(malformed("the input is empty; a line stream, ndjson or rls, was expected")),
        };
        Ok(LineReader { source, raster, end: None })
    }

    /// What the stream says of the raster. Its resolution is not known.
    pub fn header(&self) -> &Header {
        &self.raster.header
    }

    /// The next lines, from top to bottom; `None` once the end record has been read and found true, and nothing follows it.
    ///
    /// # Errors
    /// The stream is malformed, ends early or does not agree with its end record, or reading fails; places are as for
    /// [`LineReader::open`]. After an error there is nothing but this error to be had.
    pub fn next_lines(&mut self) -> Result<Option<Lines<'_>>> {
        if let Some(end) = &self.end {
            return end.clone().map(|()| None);
        }
        let more = match &mut self.source {
            Source::Ndjson(reader) => reader.record(&mut self.raster),
            Source::Rls(reader) => reader.record(&mut self.raster),
        };
        if let Ok(true) = more {
            return Ok(Some(self.raster.lines()));
        }
        self.end.insert(more.map(|_| ())).clone().map(|()| None)
    }
}

/// What both formats check: the raster as far as it has been read. Messages come without a place.
struct Raster {
    header: Header,
    /// The line after the last record.
    y: u32,
    /// Lines and runs of the last record.
    n: u32,
    runs: Vec<Run>,
    sum: Checksum,
}

impl Raster {
    fn new(width: u32, lines: Range<u32>, inks: Inks) -> Raster {
        let header = Header { width, lines, inks, dpi: None, sheet: Sheet::default() };
        Raster { sum: Checksum::new(&header), y: header.lines.start, n: 0, runs: Vec::new(), header }
    }

    /// Begins a record of `n` lines.
    fn begin(&mut self, n: u64) -> Checked {
        let Header { lines, .. } = &self.header;
        if n == 0 {
            return Err("a record of no lines".into());
        }
        if n > u64::from(lines.end - self.y) {
            return Err(format!("the record of {n} lines from line {} passes the end at line {}", self.y, lines.end));
        }
        self.n = n as u32;
        self.runs.clear();
        Ok(())
    }

    /// Adds a run to the record.
    fn run(&mut self, start: u64, end: u64, ink: u64) -> Checked {
        let Header { width, inks, .. } = &self.header;
        if start >= end {
            return Err(format!("the run from {start} to {end} is empty"));
        }
        if end > u64::from(*width) {
            return Err(format!("the run from {start} to {end} leaves the width of {width}"));
        }
        if ink >= inks.end().into() {
            return Err(format!("ink {ink} of {}; they count from 0", inks.end()));
        }
        let run = Run { start: start as u32, end: end as u32, ink: ink as u32 };
        match self.runs.last() {
            Some(last) if run.start < last.end => {
                Err(format!("the run from {start} overlaps or precedes the one before it, which ends at {}", last.end))
            }
            Some(last) if run.start == last.end && run.ink == last.ink => {
                Err(format!("the run from {start} touches the one before it, in the same ink; they are one run"))
            }
            _ => {
                self.runs.push(run);
                Ok(())
            }
        }
    }

    /// Closes the record.
    fn record(&mut self) {
        let lines = Lines { y: self.y, n: self.n, runs: &self.runs };
        debug_assert!(lines.check(&self.header));
        self.sum.add(lines);
        self.y += self.n;
    }

    /// The record that was closed.
    fn lines(&self) -> Lines<'_> {
        Lines { y: self.y - self.n, n: self.n, runs: &self.runs }
    }

    /// Compares an end record with what went by.
    fn end(&self, lines: u64, runs: u64, crc32: u32) -> Checked {
        let (read, counted, sum) = (self.sum.lines(), self.sum.runs(), self.sum.crc32());
        if self.y < self.header.lines.end {
            return Err(format!("the end record comes before line {}; lines are missing", self.y));
        }
        if lines != u64::from(read) {
            return Err(format!("the end record counts {lines} lines where there were {read}; the stream is damaged"));
        }
        if runs != counted {
            return Err(format!("the end record counts {runs} runs where there were {counted}; the stream is damaged"));
        }
        if crc32 != sum {
            return Err(format!("the checksum is {sum:08x} and should be {crc32:08x}; the stream is damaged"));
        }
        Ok(())
    }
}

fn check_width(width: u64) -> Checked<u32> {
    let possible = (1..=u64::from(MAX_WIDTH)).contains(&width);
    if possible { Ok(width as u32) } else { Err(format!("the width is {width}; 1 to {MAX_WIDTH} is possible")) }
}

fn check_lines(from: u64, to: u64) -> Checked<Range<u32>> {
    let possible = from < to && to <= u64::from(MAX_HEIGHT);
    if possible {
        Ok(from as u32..to as u32)
    } else {
        Err(format!("the lines are {from} to {to}; at least one, up to {MAX_HEIGHT}, is possible"))
    }
}

fn check_inks(inks: &[Rgb]) -> Checked {
    let mut sorted = inks.to_vec();
    sorted.sort_unstable();
    match sorted.windows(2).find(|w| w[0] == w[1]) {
        Some(&[ink, _]) => Err(format!("the ink {} is there twice; inks are distinct", Hex::of(ink))),
        _ => Ok(()),
    }
}

/// Takes from the bytes that come next, of which there are none at the end of the input only.
fn next_bytes<T>(input: &mut dyn BufRead, mut take: impl FnMut(&[u8]) -> T) -> Result<T> {
    loop {
        match input.fill_buf() {
            Ok(bytes) => return Ok(take(bytes)),
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
            Err(error) => return Err(failed(&error)),
        }
    }
}

fn failed(error: &std::io::Error) -> Error {
    Error::input(Kind::Io, error.to_string())
}

fn malformed(what: impl Into<String>) -> Error {
    Error::input(Kind::Malformed, what)
}
