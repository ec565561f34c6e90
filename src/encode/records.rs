//! What the line streams share: lines are gathered into records, and counted and summed up for the end record.

use super::Encode;
use crate::checksum::Checksum;
use crate::run::{Header, Lines, Merge};

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
    /// A record; the flag tells whether there are several inks, so that runs name theirs.
    pub record: fn(Lines<'_>, bool, &mut Vec<u8>),
    /// The end record.
    pub end: fn(&Checksum, &mut Vec<u8>),
}

impl Records {
    /// A writer for one raster.
    pub fn boxed(header: &Header, spelling: Spelling) -> Box<dyn Encode> {
        Box::new(Records { header: header.clone(), spelling, merge: Merge::default(), sum: Checksum::new(header) })
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
        let several = self.header.inks.len() > 1;
        self.merge.push(lines, |record| {
            self.sum.add(record);
            (self.spelling.record)(record, several, out);
        });
    }

    fn end(&mut self, out: &mut Vec<u8>) {
        let several = self.header.inks.len() > 1;
        self.merge.flush(|record| {
            self.sum.add(record);
            (self.spelling.record)(record, several, out);
        });
        (self.spelling.end)(&self.sum, out);
    }
}
