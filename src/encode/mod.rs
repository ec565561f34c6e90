//! Writers of rasters, band by band. One file a format; a format sees runs and nothing else.
//!
//! To add a format: write `src/encode/NAME.rs` with a `pub const FORMAT: Format` and add its name to the list
//! at [`formats!`] below. Everything else (command line, extensions, help) follows from that constant.

use crate::run::{Header, Lines};

/// What the program knows about a format.
#[derive(Clone, Copy, Debug)]
pub struct Format {
    /// Its name on the command line.
    pub name: &'static str,
    /// File name extensions that choose it, without the dot, lower case.
    pub extensions: &'static [&'static str],
    /// Media type (RFC 6838).
    pub media_type: &'static str,
    /// One line for people.
    pub about: &'static str,
    /// Whether its bytes are unfit for a terminal.
    pub binary: bool,
    /// Makes a writer for one raster.
    pub encoder: fn(&Header) -> Box<dyn Encode>,
}

/// A writer of one raster: `begin`, then `lines` from top to bottom covering every line once, then `end`.
/// Bytes are appended to `out`, which the caller empties as it likes; they do not depend on how the lines were
/// grouped, except that a format with `line_bytes() == None` takes whole records as [`crate::run::Merge`] makes them.
pub trait Encode: Send {
    /// About how many bytes one line takes before compression, where lines are written one by one. The caller then splits
    /// repeated lines so that `out` stays small. `None`: equal lines are one record, whatever their number.
    fn line_bytes(&self) -> Option<usize>;
    /// Writes what stands before the first line.
    fn begin(&mut self, out: &mut Vec<u8>);
    /// Writes `lines.n` equal lines.
    fn lines(&mut self, lines: Lines<'_>, out: &mut Vec<u8>);
    /// Writes what stands behind the last line.
    fn end(&mut self, out: &mut Vec<u8>);
}

macro_rules! formats {
    ($($name:ident)*) => {
        $(pub mod $name;)*
        /// All formats, in the order of the help text.
        pub const FORMATS: &[Format] = &[$($name::FORMAT),*];
    };
}

formats! { ndjson }

/// The format of that name.
pub fn by_name(name: &str) -> Option<&'static Format> {
    FORMATS.iter().find(|f| f.name == name)
}

/// The format that an extension (without the dot, any case) chooses.
pub fn by_extension(extension: &str) -> Option<&'static Format> {
    FORMATS.iter().find(|f| f.extensions.iter().any(|e| e.eq_ignore_ascii_case(extension)))
}
