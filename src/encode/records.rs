//! What the line streams share: lines are gathered into records, and counted and summed up for the end record.

use super::{Encode, Part, Restart, Strip};
use crate::checksum::Checksum;
use crate::run::{Header, Lines, Merge, RECORD_LINES, Told};

/// A line stream; the functions say how its parts are spelled.
pub struct Records {
    header: Header,
    spelling: Spelling,
    merge: Merge,
    sum: Checksum,
}

/// How the parts of a line stream are spelled.
#[derive(Clone, Copy)]
pub struct Spelling {
    /// The header.
    pub begin: fn(&Header, &mut Vec<u8>),
    /// A record, of which each run tells so much of its ink.
    pub record: fn(Lines<'_>, Told, &mut Vec<u8>),
    /// The end record.
    pub end: fn(&Checksum, &mut Vec<u8>),
}

impl Records {
    /// A writer for one raster.
    pub fn boxed(header: &Header, spelling: Spelling) -> Box<dyn Encode> {
        Box::new(Records { header: header.clone(), spelling, merge: Merge::new(RECORD_LINES), sum: Checksum::new(header) })
    }

    /// Writes the record that is still open, if there is one.
    fn flush(&mut self, out: &mut Vec<u8>) {
        let told = self.header.inks.told();
        self.merge.flush(|record| {
            self.sum.add(record);
            (self.spelling.record)(record, told, out);
        });
    }
}

impl Encode for Records {
    fn line_bytes(&self) -> usize {
        0
    }

    fn begin(&mut self, out: &mut Vec<u8>) {
        (self.spelling.begin)(&self.header, out);
    }

    fn lines(&mut self, lines: Lines<'_>, out: &mut Vec<u8>) {
        let told = self.header.inks.told();
        self.merge.push(lines, |record| {
            self.sum.add(record);
            (self.spelling.record)(record, told, out);
        });
    }

    fn end(&mut self, out: &mut Vec<u8>) {
        self.flush(out);
        (self.spelling.end)(&self.sum, out);
    }

    fn strip_lines(&self) -> u32 {
        RECORD_LINES / 4
    }

    /// The first record may have begun above and the last may go on below: both are left out.
    fn part(&mut self, strip: &Strip, out: &mut Vec<u8>) -> Part {
        let all = strip.lines();
        let mut groups = strip.within(all.clone());
        let first = groups.next().map_or(&[][..], |lines| lines.runs);
        let Some(start) = groups.find(|lines| lines.runs != first).map(|lines| lines.y) else { return Part::none(strip) };
        self.sum.restart();
        strip.within(start..all.end).for_each(|lines| self.lines(lines, out));
        let end = self.merge.forget();
        Part { lines: start..end, tally: self.sum.tally() }
    }

    fn join(&mut self, part: &Part, out: &mut Vec<u8>) {
        self.flush(out);
        self.sum.append(part.tally);
    }

    /// The first line of the open record, as only records that were written are in the sum.
    fn restart(&self) -> Restart {
        let lines = self.sum.lines();
        Restart { line: self.header.lines.start + lines, tally: [self.sum.crc32().into(), lines.into(), self.sum.runs()] }
    }

    fn resume(&mut self, restart: &Restart) {
        let [crc32, _, runs] = restart.tally;
        let lines = u64::from(restart.line.saturating_sub(self.header.lines.start));
        // A line has no more runs than pixels, whatever a tally says.
        let runs = runs.min(lines * u64::from(self.header.width));
        self.sum.restart();
        self.sum.append([(!(crc32 as u32)).into(), lines, runs]);
    }
}
