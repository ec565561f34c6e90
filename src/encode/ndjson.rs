//! Line records as JSON texts, one a line. (Skeleton.)
use super::{Encode, Format};
use crate::run::{Header, Lines};

/// The format.
pub const FORMAT: Format = Format {
    name: "ndjson",
    extensions: &["ndjson"],
    media_type: "application/x-ndjson",
    about: "runs as JSON, a record a line",
    binary: false,
    encoder: |header| Box::new(Ndjson { _header: header.clone() }),
};

struct Ndjson {
    _header: Header,
}

impl Encode for Ndjson {
    fn line_bytes(&self) -> Option<usize> {
        None
    }
    fn begin(&mut self, _out: &mut Vec<u8>) {}
    fn lines(&mut self, _lines: Lines<'_>, _out: &mut Vec<u8>) {}
    fn end(&mut self, _out: &mut Vec<u8>) {}
}
