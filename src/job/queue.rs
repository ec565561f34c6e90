//! What is under way between bands and the output: strips of runs, swept by any thread, encoded by any thread, taken in order.
//!
//! ```text
//!   band 0   [bytes] [bytes] [runs]  <- swept on by one thread     front: what the output waits for
//!   band 1   [runs] [runs] [runs]    <- swept by another           ahead: runs only, few bytes each
//! ```
//!
//! Whoever is free asks [`Queue::next`] for what the output needs soonest: the next strip to be taken, if it is ready; else a strip to
//! encode near the front; else a band to sweep on. Runs are small, so whole bands can be ahead; bytes are large, so they are made only
//! shortly before they are taken. Both are bounded, and what is at the front is always let through: nobody waits for room that
//! only he could make.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use super::source::{Cost, Rows};
use crate::encode::{Part, Strip};
use crate::run::Lines;

/// Runs that may be stored before sweeping waits: 9 MiB of them.
const STORED_RUNS: usize = 3 << 18;

/// Strips that may be stored before sweeping waits.
const STRIPS: usize = 1 << 10;

/// Most strips whose bytes are kept, however many threads there are.
const WINDOW: usize = 32;

/// Runs of a strip, about.
const STRIP_RUNS: usize = 1 << 16;

/// A sweep that stopped between two strips.
pub struct Sweep {
    rows: Rows,
    /// Lines of the row at hand that are in no strip yet: the first, and how many.
    left: (u32, u32),
}

impl Sweep {
    /// A sweep about to begin.
    pub fn new(rows: Rows) -> Box<Sweep> {
        Box::new(Sweep { rows, left: (0, 0) })
    }

    /// Fills `strip` up to a multiple of `lines` lines behind `from`, or with about [`STRIP_RUNS`] runs; false behind the last line.
    fn fill(&mut self, strip: &mut Strip, from: u32, lines: u32) -> bool {
        loop {
            if self.left.1 == 0 {
                let Some(row) = self.rows.next() else { return false };
                self.left = (row.y, row.n);
            }
            let (y, left) = self.left;
            let n = left.min(lines - (y - from) % lines);
            strip.push(Lines { y, n, runs: self.rows.runs() });
            self.left = (y + n, left - n);
            if (y + n - from).is_multiple_of(lines) || strip.stored_runs() >= STRIP_RUNS {
                return true;
            }
        }
    }
}

/// A strip and what was made of it.
#[derive(Default)]
pub struct Ready {
    /// The lines.
    pub strip: Strip,
    /// Which of them are `bytes`.
    pub part: Part,
    /// Encoded lines.
    pub bytes: Vec<u8>,
}

enum Cell {
    Swept(Strip),
    /// Somebody encodes it.
    Taken,
    Encoded(Ready),
}

struct Band {
    /// Absent while somebody sweeps it on, and behind its end.
    sweep: Option<Box<Sweep>>,
    /// What it has cost, behind its end.
    cost: Option<Cost>,
    /// Strips that were taken already.
    gone: usize,
    cells: VecDeque<Cell>,
}

/// What is to be done.
pub enum Work {
    /// Sweep the band of that number on; it begins if there is no sweep.
    Sweep(usize, Option<Box<Sweep>>),
    /// Encode a strip: its band, its place in the band.
    Encode(usize, usize, Ready),
    /// Write the next strip.
    Write(Ready),
    /// A band has been written.
    Band(Cost),
    /// Nothing, any more.
    End,
}

#[derive(Default)]
struct State {
    open: VecDeque<Band>,
    /// Number of the first open band.
    first: usize,
    stored_runs: usize,
    strips: usize,
    /// Strips that are encoded.
    encoded: usize,
    /// Threads that wait, without the writer.
    helpers_wait: bool,
    writer_waits: bool,
    ended: bool,
    spare_strips: Vec<Strip>,
    spare_bytes: Vec<Vec<u8>>,
}

/// See the top of the file.
pub struct Queue {
    state: Mutex<State>,
    /// For the writer, who can do whatever is to be done: work never stops for want of news to the others.
    to_writer: Condvar,
    /// For the others.
    to_helpers: Condvar,
    bands: usize,
    threads: usize,
    /// How many strips from the front on may be encoded.
    window: usize,
}

impl Queue {
    /// A queue of that many bands, for that many threads.
    pub fn new(bands: usize, threads: usize) -> Queue {
        let [to_writer, to_helpers] = [Condvar::new(), Condvar::new()];
        Queue { state: Mutex::default(), to_writer, to_helpers, bands, threads, window: (threads + 2).min(WINDOW) }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is to be done next; waits for it. One thread, the `writer`, writes.
    pub fn next(&self, writer: bool) -> Work {
        let mut state = self.state();
        loop {
            if state.ended {
                return Work::End;
            }
            if let Some(work) = writer.then(|| self.to_write(&mut state)).flatten() {
                return work;
            }
            if let Some(work) = self.to_encode(&mut state).or_else(|| self.to_sweep(&mut state)) {
                return work;
            }
            let news = if writer { &self.to_writer } else { &self.to_helpers };
            *(if writer { &mut state.writer_waits } else { &mut state.helpers_wait }) = true;
            state = news.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn to_write(&self, state: &mut State) -> Option<Work> {
        if state.first == self.bands {
            return Some(Work::End);
        }
        let front = state.open.front_mut()?;
        if let Some(Cell::Encoded(ready)) = front.cells.front_mut() {
            let ready = std::mem::take(ready);
            front.cells.pop_front();
            front.gone += 1;
            state.strips -= 1;
            state.encoded -= 1;
            state.stored_runs -= ready.strip.stored_runs();
            // Waking for each strip would cost more than encoding it.
            if state.encoded <= self.window / 2 {
                self.tell_helpers(state);
            }
            return Some(Work::Write(ready));
        }
        let cost = front.cost.filter(|_| front.cells.is_empty())?;
        state.open.pop_front();
        state.first += 1;
        self.tell_helpers(state);
        Some(Work::Band(cost))
    }

    /// The first strip that waits, among those near the front: from there on without a gap.
    fn to_encode(&self, state: &mut State) -> Option<Work> {
        let mut window = self.window;
        for (number, band) in (state.first..).zip(&mut state.open) {
            for (i, cell) in band.cells.iter_mut().enumerate().take(window) {
                if let Cell::Swept(strip) = cell {
                    let (strip, bytes) = (std::mem::take(strip), state.spare_bytes.pop().unwrap_or_default());
                    *cell = Cell::Taken;
                    let ready = Ready { strip, part: Part::default(), bytes };
                    return Some(Work::Encode(number, band.gone + i, ready));
                }
            }
            window = window.saturating_sub(band.cells.len());
            if band.cost.is_none() {
                break;
            }
        }
        None
    }

    /// The first band that nobody sweeps.
    fn to_sweep(&self, state: &mut State) -> Option<Work> {
        let room = state.stored_runs < STORED_RUNS && state.strips < STRIPS;
        for (i, band) in state.open.iter_mut().enumerate() {
            let starved = i == 0 && band.cells.is_empty();
            if (room || starved) && band.sweep.is_some() {
                return Some(Work::Sweep(state.first + i, band.sweep.take()));
            }
        }
        let next = state.first + state.open.len();
        let begin = next < self.bands && (room || state.open.is_empty()) && state.open.len() <= self.threads;
        begin.then(|| {
            state.open.push_back(Band { sweep: None, cost: None, gone: 0, cells: VecDeque::new() });
            Work::Sweep(next, None)
        })
    }

    /// Sweeps a band on by a strip, cut at multiples of `lines` lines behind line `from`, which is none of the later ones.
    pub fn sweep(&self, band: usize, mut sweep: Box<Sweep>, from: u32, lines: u32) {
        let mut strip = self.state().spare_strips.pop().unwrap_or_default();
        let more = sweep.fill(&mut strip, from, lines);
        let mut state = self.state();
        state.stored_runs += strip.stored_runs();
        let place = band - state.first;
        let filled = !strip.lines().is_empty();
        state.strips += usize::from(filled);
        let band = &mut state.open[place];
        if filled {
            band.cells.push_back(Cell::Swept(strip));
        }
        if more {
            band.sweep = Some(sweep);
        } else {
            band.cost = Some(sweep.rows.cost());
        }
        self.tell_writer(&mut state, place);
        self.tell_helpers(&mut state);
    }

    /// Gives back a strip that was encoded.
    pub fn encoded(&self, band: usize, place: usize, ready: Ready) {
        let mut state = self.state();
        let number = band - state.first;
        let band = &mut state.open[number];
        let place = place - band.gone;
        band.cells[place] = Cell::Encoded(ready);
        state.encoded += 1;
        self.tell_writer(&mut state, number + place);
    }

    /// Gives back a strip that was written, whose memory is used again.
    pub fn written(&self, Ready { mut strip, mut bytes, .. }: Ready) {
        strip.clear();
        bytes.clear();
        let mut state = self.state();
        if state.spare_bytes.len() < self.window {
            state.spare_strips.push(strip);
            state.spare_bytes.push(bytes);
        }
    }

    /// Wakes the writer for what is that far from the front.
    fn tell_writer(&self, state: &mut State, distance: usize) {
        if distance == 0 && std::mem::take(&mut state.writer_waits) {
            self.to_writer.notify_one();
        }
    }

    fn tell_helpers(&self, state: &mut State) {
        if std::mem::take(&mut state.helpers_wait) {
            self.to_helpers.notify_all();
        }
    }
}

/// While it is held, a thread takes part; once any of them lets it go, in whatever way, the others end too.
pub struct Member<'q>(pub &'q Queue);

impl Drop for Member<'_> {
    fn drop(&mut self) {
        self.0.state().ended = true;
        self.0.to_writer.notify_one();
        self.0.to_helpers.notify_all();
    }
}
