//! Formats that write a line once for all equal lines that follow it.
//!
//! ```text
//!   lines     a a a b b b b | b b c          |: a multiple of so many lines of the page, at which groups break
//!   groups    a 3   b 4       b 2  c 1
//! ```
//!
//! Which lines are a group follows from the page alone: not from how the lines came, nor from where a writer began. So a group is open until a line differs or
//! the multiple is reached, and a writer can be left before it.
//!
//! What is written of a group may lean on the line above it. Then a stretch between two multiples is for one writer, which leans on nothing at its
//! beginning, and a writer that takes up a stretch in its middle is given the line above first.

use std::ops::Range;

use super::{Encode, Part, Restart, Strip, rows};
use crate::run::{Header, Lines, Merge, Run};

/// Groups break at multiples of this many lines of the page: as many as PWG raster and Apple raster can count.
pub const GROUP: u32 = 256;

/// Bytes of a strip's blank rows, at most; runs of a strip are bounded by others.
const STRIP_BYTES: usize = 1 << 19;

/// How a format writes groups.
pub trait Code: Send {
    /// Whether a group leans on the line above it, but for those at multiples of [`GROUP`] lines.
    const LEANS: bool;
    /// Writes a group.
    fn group(&mut self, lines: Lines<'_>, out: &mut Vec<u8>);
    /// Takes note of the line above the next group.
    fn above(&mut self, runs: &[Run]);
}

/// A writer of groups.
pub struct Groups<C> {
    raster: Range<u32>,
    head: Vec<u8>,
    tail: Vec<u8>,
    /// Bytes of a row as they are before they are coded.
    row_bytes: usize,
    merge: Merge,
    /// The first line that is in no group yet that was written.
    next: u32,
    /// The line that is only needed because the next one leans on it.
    above: Option<u32>,
    code: C,
}

impl<C: Code + 'static> Groups<C> {
    /// A writer of `head`, groups and `tail`, for a raster of rows that are so many bytes before they are coded.
    pub fn boxed(header: &Header, row_bytes: usize, head: Vec<u8>, tail: Vec<u8>, code: C) -> Box<dyn Encode> {
        let raster = header.lines.clone();
        Box::new(Groups { next: raster.start, raster, head, tail, row_bytes, merge: Merge::new(GROUP), above: None, code })
    }

    fn push(&mut self, lines: Lines<'_>, out: &mut Vec<u8>) {
        let Groups { merge, next, code, .. } = self;
        merge.push(lines, |group| {
            code.group(group, out);
            *next = group.y + group.n;
        });
    }

    /// Writes the group that is still open, if there is one.
    fn flush(&mut self, out: &mut Vec<u8>) {
        self.merge.flush(|group| {
            self.code.group(group, out);
            self.next = group.y + group.n;
        });
    }

    /// Those of a strip's lines that begin and end groups for certain.
    fn whole(strip: &Strip) -> Range<u32> {
        let Range { start, end } = strip.lines();
        if C::LEANS {
            return start.next_multiple_of(GROUP)..end / GROUP * GROUP;
        }
        // The first group may have begun above; whether the last goes on below is seen when it is written.
        let mut groups = strip.within(start..end);
        let first = groups.next().map_or(&[][..], |lines| lines.runs);
        let differs = groups.find(|lines| lines.runs != first).map_or(end, |lines| lines.y);
        start.next_multiple_of(GROUP).min(differs)..end
    }
}

impl<C: Code + 'static> Encode for Groups<C> {
    fn line_bytes(&self) -> usize {
        self.row_bytes / GROUP as usize + 1
    }

    fn begin(&mut self, out: &mut Vec<u8>) {
        out.extend_from_slice(&self.head);
    }

    fn lines(&mut self, lines: Lines<'_>, out: &mut Vec<u8>) {
        let Lines { y, n, runs } = lines;
        if self.above.take_if(|above| *above == y).is_none() {
            return self.push(lines, out);
        }
        self.code.above(runs);
        if n > 1 {
            self.push(Lines { y: y + 1, n: n - 1, runs }, out);
        }
    }

    fn end(&mut self, out: &mut Vec<u8>) {
        self.flush(out);
        out.extend_from_slice(&self.tail);
    }

    fn strip_lines(&self) -> u32 {
        // A blank row is about a 64th of its bytes.
        let lines = rows::lines_of(STRIP_BYTES, self.row_bytes / 64).min(4 * GROUP);
        if C::LEANS { lines.max(GROUP) } else { lines }
    }

    fn part(&mut self, strip: &Strip, out: &mut Vec<u8>) -> Part {
        let Range { start, end } = Self::whole(strip);
        if start >= end {
            return Part::none(strip);
        }
        strip.within(start..end).for_each(|lines| self.push(lines, out));
        if end.is_multiple_of(GROUP) {
            self.flush(out);
            return Part { lines: start..end, tally: [0; 3] };
        }
        Part { lines: start..self.merge.forget(), tally: [0; 3] }
    }

    fn join(&mut self, part: &Part, out: &mut Vec<u8>) {
        self.flush(out);
        self.next = part.lines.end;
    }

    fn restart(&self) -> Restart {
        if C::LEANS && self.next > self.raster.start && !self.next.is_multiple_of(GROUP) {
            return Restart { line: self.next - 1, tally: [1, 0, 0] };
        }
        Restart { line: self.next, tally: [0; 3] }
    }

    fn resume(&mut self, restart: &Restart) {
        let leans = C::LEANS && restart.tally[0] != 0;
        self.above = leans.then_some(restart.line);
        self.next = restart.line.saturating_add(leans.into());
    }
}
