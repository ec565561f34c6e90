//! A raster written by threads: each sweeps bands, and the caller's thread puts them in order and encodes.
//!
//! ```text
//!   thread 0   band 0 . . band 2 . .      each band arrives in batches through a bounded queue,
//!   thread 1   band 1 . . band 3 . .      so a thread that is ahead waits and memory stays small
//!   caller     band 0, band 1, band 2, ... -> encoder -> write
//! ```

use std::io::Write;
use std::ops::Range;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::Instant;

use super::pump::{PORTION, Pump};
use super::{Job, Stats, write};
use crate::encode::Format;
use crate::error::{Error, Result};
use crate::region::{Cost, Rows};
use crate::run::{Lines, Run};

/// Runs of a batch before it is sent on.
const BATCH_RUNS: usize = 16 << 10;

/// Rows of a batch before it is sent on.
const BATCH_ROWS: usize = 1 << 10;

/// Batches that may wait in a thread's queue.
const QUEUE: usize = 4;

/// Rows on their way from a sweeping thread to the encoder.
#[derive(Default)]
struct Batch {
    /// First line, number of lines, and where its runs end.
    rows: Vec<(u32, u32, usize)>,
    runs: Vec<Run>,
    /// Set on the last batch of a band: what the band has cost.
    cost: Option<Cost>,
}

impl Job {
    /// Writes the whole raster with `threads` threads. `progress` is called with the number of lines written so far, now and then. The bytes
    /// do not depend on `threads`.
    ///
    /// # Errors
    /// What the writer says; [`crate::error::Kind::Closed`] if its reader went away.
    pub fn render(&self, format: &Format, threads: usize, out: &mut dyn Write, progress: &mut dyn FnMut(u32)) -> Result<Stats> {
        let swept = Instant::now();
        let bands: Vec<Range<u32>> = self.bands().collect();
        let threads = threads.max(1);
        let mut bytes = Vec::with_capacity(2 * PORTION);
        let mut pump = Pump::new(format, &self.header, &mut bytes);
        let mut cost = Cost::default();
        let mut first_line = None;

        std::thread::scope(|scope| -> Result<()> {
            let queues: Vec<Receiver<Batch>> = (0..threads.min(bands.len()))
                .map(|thread| {
                    let (sender, receiver) = sync_channel(QUEUE);
                    let mine = bands.iter().skip(thread).step_by(threads);
                    scope.spawn(move || mine.map(|band| self.sweep(band, &sender)).take_while(|sent| *sent).count());
                    receiver
                })
                .collect();
            for band in 0..bands.len() {
                loop {
                    let batch = queues[band % threads].recv().expect("a sweeping thread sends the end of each of its bands");
                    first_line.get_or_insert_with(|| self.started.elapsed());
                    let mut start = 0;
                    for &(mut y, mut n, end) in &batch.rows {
                        while n > 0 {
                            let took = pump.push(Lines { y, n, runs: &batch.runs[start..end] }, &mut bytes);
                            (y, n) = (y + took, n - took);
                            if bytes.len() >= PORTION {
                                write(out, &mut bytes)?;
                                progress(pump.lines);
                            }
                        }
                        start = end;
                    }
                    if let Some(band_cost) = batch.cost {
                        cost.add(&band_cost);
                        break;
                    }
                }
            }
            Ok(())
        })?;
        pump.finish(&mut bytes);
        write(out, &mut bytes)?;
        out.flush().map_err(|error| Error::output(&error))?;
        progress(pump.lines);

        Ok(Stats {
            width: self.header.width,
            height: self.header.height(),
            edges: self.edges,
            lines: pump.lines,
            lines_counted: cost.counted,
            lines_repeated: cost.repeated,
            toggles: cost.toggles,
            runs: pump.runs,
            peak_active: cost.peak_active,
            prepare_seconds: self.prepare_seconds,
            seconds: swept.elapsed().as_secs_f64(),
            first_line_seconds: first_line.unwrap_or_default().as_secs_f64(),
            threads,
        })
    }

    /// Sweeps a band into a queue; false if nobody reads it any more.
    fn sweep(&self, band: &Range<u32>, queue: &SyncSender<Batch>) -> bool {
        let mut rows = Rows::new(self.picture.clone(), band.clone());
        let mut batch = Batch::default();
        while let Some(lines) = rows.next() {
            batch.runs.extend_from_slice(lines.runs);
            batch.rows.push((lines.y, lines.n, batch.runs.len()));
            let full = batch.runs.len() >= BATCH_RUNS || batch.rows.len() >= BATCH_ROWS;
            if full && queue.send(std::mem::take(&mut batch)).is_err() {
                return false;
            }
        }
        batch.cost = Some(*rows.cost());
        queue.send(batch).is_ok()
    }
}
