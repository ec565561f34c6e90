//! How long each part of a walk takes, for the experiments ("CSG" in ARCHITECTURE.md, section 4.4.2).

use std::time::{Duration, Instant};

/// A part of the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The active edges of the next scanline.
    Edges,
    /// The list of active faces, and its order.
    Faces,
    /// Crossings and coherence of spans.
    Spans,
    /// One-dimensional set operations.
    Count,
}

impl Part {
    /// All of them.
    pub const ALL: [Part; 4] = [Part::Edges, Part::Faces, Part::Spans, Part::Count];
}

/// Stops what is between two laps for the part that it belongs to, once started.
#[derive(Clone, Copy, Debug, Default)]
pub struct Timers {
    last: Option<Instant>,
    times: [Duration; Part::ALL.len()],
    laps: [u32; Part::ALL.len()],
}

impl Timers {
    pub(super) fn start(&mut self) {
        self.last = Some(Instant::now());
    }

    /// What was done since the last lap was of this part.
    #[inline]
    pub(super) fn lap(&mut self, part: Part) {
        if let Some(last) = &mut self.last {
            let now = Instant::now();
            self.times[part as usize] += now - std::mem::replace(last, now);
            self.laps[part as usize] += 1;
        }
    }

    /// How long a part has taken, without the clock itself, of which a look takes so long.
    pub fn of(&self, part: Part, look: Duration) -> Duration {
        self.times[part as usize].saturating_sub(look * self.laps[part as usize])
    }

    /// How long a look at the clock takes.
    pub fn look() -> Duration {
        const LAPS: u32 = 10_000;
        let mut timers = Timers::default();
        timers.start();
        (0..LAPS).for_each(|_| timers.lap(Part::Edges));
        timers.times[Part::Edges as usize] / LAPS
    }
}
