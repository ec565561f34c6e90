//! A raster written by threads, which share the sweeping and the encoding; the caller's thread is one of them, and writes.
//!
//! ```text
//!   bands --sweep--> strips of runs --part--> bytes --in order--> write
//!          any thread               any thread       the caller's thread, before all else
//! ```

use std::io::Write;
use std::ops::Range;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use super::pump::PORTION;
use super::queue::{Member, Queue, Ready, Sweep, Work};
use super::source::Cost;
use super::{Job, SolidStats, Stats, write};
use crate::encode::{Encode, Format};
use crate::error::{Error, Result};

impl Job {
    /// Writes the whole raster with `threads` threads. `progress` is called with the number of lines written so far, now and then. The bytes
    /// do not depend on `threads`.
    ///
    /// # Errors
    /// Before the first byte, what [`Format::check`] says; what the writer says, [`crate::error::Kind::Closed`] if its reader went away.
    pub fn render(&self, format: &Format, threads: usize, out: &mut dyn Write, progress: &mut dyn FnMut(u32)) -> Result<Stats> {
        format.check(&self.header)?;
        let swept = Instant::now();
        let bands: Vec<Range<u32>> = self.bands().collect();
        let threads = threads.max(1);
        let queue = Queue::new(bands.len(), threads.min(bands.len()));
        let shared = Shared { job: self, bands, queue, first_line: OnceLock::new() };
        let mut joiner = Joiner::new((format.encoder)(&self.header), out, progress);

        std::thread::scope(|scope| -> Result<()> {
            let _member = Member(&shared.queue);
            for _ in 1..threads.min(shared.bands.len()) {
                scope.spawn(|| {
                    let _member = Member(&shared.queue);
                    let mut encoder = (format.encoder)(&self.header);
                    while shared.work(shared.queue.next(false), &mut *encoder).is_some() {}
                });
            }
            let mut encoder = (format.encoder)(&self.header);
            loop {
                match shared.queue.next(true) {
                    Work::Write(ready) => shared.queue.written(joiner.take(ready)?),
                    Work::Band(cost) => joiner.cost.add(&cost),
                    work => match shared.work(work, &mut *encoder) {
                        Some(()) => {}
                        None => return Ok(()),
                    },
                }
            }
        })?;
        joiner.finish()?;

        let Joiner { lines, runs, cost, .. } = joiner;
        let Cost { rows, spans } = cost;
        Ok(Stats {
            width: self.header.width,
            height: self.header.height(),
            edges: self.edges,
            lines,
            lines_counted: rows.counted,
            lines_unordered: rows.unordered,
            lines_repeated: rows.repeated,
            toggles: rows.toggles,
            toggles_known: rows.known,
            runs,
            peak_active: rows.peak_active.max(spans.peak_active),
            prepare_seconds: self.prepare_seconds,
            seconds: swept.elapsed().as_secs_f64(),
            first_line_seconds: shared.first_line.get().map_or(0.0, Duration::as_secs_f64),
            threads,
            solid: self.solid.map(|solid| SolidStats {
                spans: spans.spans,
                depth_tests: spans.counts,
                crossings: spans.crossings,
                ..solid
            }),
        })
    }
}

/// What the threads share.
struct Shared<'j> {
    job: &'j Job,
    bands: Vec<Range<u32>>,
    queue: Queue,
    /// From the start of the work to the first line being ready.
    first_line: OnceLock<Duration>,
}

impl Shared<'_> {
    /// Does what any thread can do, with an encoder of its own; `None` at the end.
    fn work(&self, work: Work, encoder: &mut dyn Encode) -> Option<()> {
        match work {
            Work::Sweep(band, sweep) => {
                let sweep = sweep.unwrap_or_else(|| Sweep::new(self.job.source.rows(self.bands[band].clone())));
                self.queue.sweep(band, sweep, encoder.strip_lines());
                self.first_line.get_or_init(|| self.job.started.elapsed());
            }
            Work::Encode(band, place, mut ready) => {
                ready.part = encoder.part(&ready.strip, &mut ready.bytes);
                self.queue.encoded(band, place, ready);
            }
            Work::Write(_) | Work::Band(_) => debug_assert!(false, "only the writer is asked to write"),
            Work::End => return None,
        }
        Some(())
    }
}

/// Puts parts and the lines between them together, and writes them.
struct Joiner<'o> {
    encoder: Box<dyn Encode>,
    out: &'o mut dyn Write,
    progress: &'o mut dyn FnMut(u32),
    /// Bytes to be written before any part.
    pending: Vec<u8>,
    lines: u32,
    runs: u64,
    cost: Cost,
}

impl<'o> Joiner<'o> {
    fn new(mut encoder: Box<dyn Encode>, out: &'o mut dyn Write, progress: &'o mut dyn FnMut(u32)) -> Joiner<'o> {
        let mut pending = Vec::new();
        encoder.begin(&mut pending);
        Joiner { encoder, out, progress, pending, lines: 0, runs: 0, cost: Cost::default() }
    }

    /// Takes the next strip.
    fn take(&mut self, ready: Ready) -> Result<Ready> {
        let Ready { strip, part, bytes } = &ready;
        let all = strip.lines();
        self.lines += all.end - all.start;
        self.runs += strip.within(all.clone()).map(|lines| u64::from(lines.n) * lines.runs.len() as u64).sum::<u64>();
        strip.within(all.start..part.lines.start).for_each(|lines| self.encoder.lines(lines, &mut self.pending));
        if !part.lines.is_empty() {
            self.encoder.join(part, &mut self.pending);
            if bytes.len() < PORTION {
                self.pending.extend_from_slice(bytes);
            } else {
                self.flush()?;
                self.out.write_all(bytes).map_err(|error| Error::output(&error))?;
                (self.progress)(self.lines);
            }
        }
        strip.within(part.lines.end..all.end).for_each(|lines| self.encoder.lines(lines, &mut self.pending));
        if self.pending.len() >= PORTION {
            self.flush()?;
            (self.progress)(self.lines);
        }
        Ok(ready)
    }

    fn flush(&mut self) -> Result<()> {
        if self.pending.is_empty() { Ok(()) } else { write(self.out, &mut self.pending) }
    }

    fn finish(&mut self) -> Result<()> {
        self.encoder.end(&mut self.pending);
        self.flush()?;
        self.out.flush().map_err(|error| Error::output(&error))?;
        (self.progress)(self.lines);
        Ok(())
    }
}
