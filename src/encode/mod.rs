//! Writers of rasters, band by band. One file a format; a format sees runs and nothing else.
//!
//! To add a format: write `src/encode/NAME.rs` with a `pub const FORMAT: Format` and add its name to the list
//! at `formats!` below. Everything else (command line, extensions, help) follows from that constant.

pub use part::{Part, Strip};

use crate::error::{Error, Result};
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
    /// Raised when the bytes for the same picture change: a stream is not taken up again with another version's bytes.
    pub version: u32,
    /// Whether a file holds several pages ([`Header::sheet`]).
    pub pages: bool,
    /// Whether it can hold a raster: its size, its resolution. A refusal says what to ask for.
    pub fits: fn(&Header) -> Result<()>,
    /// Makes a writer for one raster.
    pub encoder: fn(&Header) -> Box<dyn Encode>,
}

impl Format {
    /// Checks before the first byte that it can hold a raster.
    ///
    /// # Errors
    /// Those of [`Format::check_pages`] and [`Format::fits`].
    pub fn check(&self, header: &Header) -> Result<()> {
        self.check_pages(header.sheet.of)?;
        (self.fits)(header)
    }

    /// Checks that a file of it holds so many pages.
    ///
    /// # Errors
    /// Several where it holds one.
    pub fn check_pages(&self, pages: u32) -> Result<()> {
        if self.pages || pages == 1 {
            return Ok(());
        }
        let others: Vec<_> = FORMATS.iter().filter(|format| format.pages).map(|format| format.name).collect();
        let what = format!(
            "a file of {} is one page, and {pages} are asked for: ask for one, or for a format of {}",
            self.name,
            others.join(", ")
        );
        Err(Error::parameter(what))
    }
}

/// Of a format that holds all rasters that there can be.
fn holds_all(_: &Header) -> Result<()> {
    Ok(())
}

/// Where a writer can go on: what another writer of the same raster needs, so that its bytes follow those written so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Restart {
    /// The line on the page from which it needs the lines; the one behind the raster's last if it needs none.
    pub line: u32,
    /// What is known of the lines before: sums that only the format understands, all 0 before the first line.
    pub tally: [u64; 3],
}

/// A writer of one raster: `begin`, then `lines` from top to bottom covering every line once, then `end`.
///
/// Bytes are appended to `out`, which the caller empties as it likes. They depend on the picture and its header alone: not on
/// how equal lines were grouped, nor on when `out` was emptied, nor on which lines were written by `part`.
///
/// Threads share the work: each has a writer of its own for [`Encode::part`]; the raster's own writer takes what they made, in order, by
/// [`Encode::join`], and by [`Encode::lines`] the lines that no part holds.
///
/// A raster can be taken up again: a new writer that is given [`Encode::resume`] in place of `begin` needs the lines from
/// [`Restart::line`] on, and writes the bytes behind those that were written when [`Encode::restart`] was asked.
///
/// ```text
///   lines     | - - - - - - = = =      written: the bytes of - ; kept: = , an open record or segment
///   restart                 ^          the first line of it, and the tally of those before
/// ```
pub trait Encode: Send {
    /// About how many bytes each further of some equal lines adds to `out`. The caller splits a large [`Lines::n`] by it, so
    /// that `out` stays small; 0: there is nothing to split, whatever their number.
    fn line_bytes(&self) -> usize;
    /// Writes what stands before the first line.
    fn begin(&mut self, out: &mut Vec<u8>);
    /// Writes `lines.n` equal lines.
    fn lines(&mut self, lines: Lines<'_>, out: &mut Vec<u8>);
    /// Writes what stands behind the last line.
    fn end(&mut self, out: &mut Vec<u8>);
    /// At multiples of how many lines of the page it is best to cut strips for `part`. A strip is about that long at most.
    fn strip_lines(&self) -> u32;
    /// Writes those lines of `strip` that need nothing from above them and leave nothing to those below, and says which. To be called
    /// on a writer that is asked for nothing else.
    fn part(&mut self, strip: &Strip, out: &mut Vec<u8>) -> Part;
    /// Takes note that the bytes of `part` follow, which is not empty, and writes what has to stand before them.
    fn join(&mut self, part: &Part, out: &mut Vec<u8>);
    /// Bytes of the whole raster, where its header alone fixes them.
    fn length(&self) -> Option<u64> {
        None
    }
    /// Where another writer can go on. All bytes that were written up to now are before that place: behind `begin` it is the raster's
    /// first line. Not to be asked behind `end`.
    fn restart(&self) -> Restart;
    /// Takes up a raster in place of `begin`, in a writer that is new. Sums that no writer gave make wrong bytes.
    fn resume(&mut self, restart: &Restart);
    /// The last place at or before byte `offset` of the raster where a writer can go on, as its own offset and what it needs, in formats
    /// of which [`Encode::length`] is known. None within what stands before the first line.
    fn seek(&self, _offset: u64) -> Option<(u64, Restart)> {
        None
    }
}

mod adler;
mod changes;
mod coded;
mod deflate;
mod groups;
mod literals;
mod media;
mod part;
mod printed;
mod records;
mod rows;

macro_rules! formats {
    ($($name:ident)*) => {
        $(pub mod $name;)*
        /// All formats, in the order of the help text.
        pub const FORMATS: &[Format] = &[$($name::FORMAT),*];
    };
}

formats! { pbm pgm ppm png pwg urf pcl pclm ndjson rls }

/// The format of that name.
pub fn by_name(name: &str) -> Option<&'static Format> {
    FORMATS.iter().find(|f| f.name == name)
}

/// The format that an extension (without the dot, any case) chooses.
pub fn by_extension(extension: &str) -> Option<&'static Format> {
    FORMATS.iter().find(|f| f.extensions.iter().any(|e| e.eq_ignore_ascii_case(extension)))
}
