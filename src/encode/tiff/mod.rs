//! TIFF, in strips that do not depend on each other; BigTIFF where the file is longer than 4 GiB.
//!
//! Black alone is 1 bit a pixel; inks that are all grey are 8-bit grey; up to 255 inks are a palette (paper is entry 0) of 4 or 8 bits; more inks, and
//! shaded rasters, are 8-bit RGB.
//!
//! ```text
//! head: II, directory, palette, offsets and lengths of strips | strip | strip | … | strip
//! ```
//!
//! A strip is some 1 MiB of rows, as many as a power of two, and there are at most [`MOST_STRIPS`]. Its bytes depend on its rows alone: a writer can start at any of
//! them, threads write different ones, a strip of equal rows is coded once. The lengths of strips, and with them the form of the file, are known behind the last
//! one; the room for them is the same in both forms (`head.rs`). They are the *table* of [`Encode`], so that a raster is written in two passes or its head afterwards.
//! Without compression all is known from the beginning.
//!
//! Cost: follows the runs and not the pixels, but for what is not compressed, and PackBits of colours.
//!
//! Source: TIFF Revision 6.0 (1992); Adobe Photoshop TIFF Technical Notes (2002) for Deflate; BigTIFF as libtiff 4 has it.

mod codes;
mod g4;
mod head;
mod pixels;
mod strips;

use std::ops::Range;

use self::g4::G4;
use self::head::Head;
use self::pixels::Pixels;
use self::strips::{Coder, Deflate, PackBits};
use super::{Compression, Encode, Format, Part, Restart, Strip, holds_all, rows};
use crate::error::{Error, Result};
use crate::run::{Header, Lines, Run};

/// The format.
pub const FORMAT: Format = Format { compressions: &[&GROUP_4, &PACK_BITS, &DEFLATE, &NONE], ..SUITED };

/// The format in the compression that suits a raster.
const SUITED: Format = Format {
    name: "tiff",
    extensions: &["tiff", "tif"],
    media_type: "image/tiff",
    about: "TIFF, past 4 GiB BigTIFF: 1 bit for black alone, gray, a palette up to 255 inks, else RGB; into a pipe by way of a temporary file",
    binary: true,
    version: 1,
    pages: false,
    fits: holds_all,
    compressions: &[],
    compression: None,
    encoder: |header| writer(header, Packing::suited(header), CLASSIC),
};

const GROUP_4: Format = Format {
    compression: Some(Compression { name: "g4", about: "CCITT group 4 (ITU-T T.6), for 1 bit a pixel"}),
    fits: only_black,
    encoder: |header| writer(header, Packing::G4, CLASSIC),
    ..SUITED
};

const PACK_BITS: Format = Format {
    compression: Some(Compression { name: "packbits", about: "runs of equal bytes, which every reader knows"  }),
    encoder: |header| writer(header, Packing::PackBits, CLASSIC),
    ..SUITED
};

const DEFLATE: Format = Format {
    compression: Some(Compression { name: "deflate", about: "zlib"  }),
    encoder: |header| writer(header, Packing::Deflate, CLASSIC),
    ..SUITED
};

const NONE: Format = Format {
    compression: Some(Compression { name: "none", about: "no compression"  }),
    encoder: |header| writer(header, Packing::None, CLASSIC),
    ..SUITED
};

/// Bytes of rows in a strip, about.
const STRIP_BYTES: usize = 1 << 20;

/// Most strips of a raster: their offsets and lengths stand in the head, and a writer keeps them.
pub const MOST_STRIPS: u32 = 1 << 14;

/// The longest file that is written in the classic form, whose offsets have 32 bits.
pub const CLASSIC: u64 = u32::MAX as u64;

/// How strips are compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Packing {
    /// Not at all.
    None,
    /// CCITT group 4, of black alone; other rasters are then [`Packing::Deflate`].
    G4,
    /// PackBits.
    PackBits,
    /// A zlib stream a strip; of RGB, differences to the pixel before.
    Deflate,
}

impl Packing {
    /// What suits a raster.
    fn suited(header: &Header) -> Packing {
        if Pixels::of(&header.inks) == Pixels::Bilevel { Packing::G4 } else { Packing::Deflate }
    }
}

fn only_black(header: &Header) -> Result<()> {
    let inks = header.inks.listed().len();
    let what = match Pixels::of(&header.inks) {
        Pixels::Bilevel => return Ok(()),
        Pixels::Rgb if inks == 0 => "colours".to_owned(),
        _ if inks == 1 => "an ink that is not black".to_owned(),
        _ => format!("{inks} inks"),
    };
    Err(Error::parameter(format!("compression g4 is for 1 bit a pixel, black alone, and this raster has {what}: take deflate, packbits or none")))
}

/// A writer that compresses so; a file that is longer than `classic` bytes is a BigTIFF.
pub fn writer(header: &Header, packing: Packing, classic: u64) -> Box<dyn Encode> {
    let pixels = Pixels::of(&header.inks);
    let packing = if packing == Packing::G4 { Packing::suited(header) } else { packing };
    let row_bytes = pixels.row_bytes(header.width);
    let most = header.height().div_ceil(MOST_STRIPS).next_power_of_two();
    let rows = rows::lines_of(STRIP_BYTES, row_bytes).max(most);
    let head = Head::new(header, pixels, packing, rows, classic);
    let painter = pixels.painter(&header.inks, header.width);
    let coder: Box<dyn Coder> = match packing {
        Packing::None => {
            let strips = (0..head.strips()).map(|i| u64::from(rows.min(header.height() - i * rows)) * row_bytes as u64);
            let head = head.bytes(&strips.collect::<Vec<_>>());
            return rows::plain(head, header, pixels.depth(), move |runs, row| painter.paint(runs, row));
        }
        Packing::G4 => Box::new(G4::new(header.width)),
        Packing::PackBits => Box::new(PackBits::new(painter)),
        Packing::Deflate => Box::new(Deflate::new(painter)),
    };
    Box::new(Tiff {
        raster: header.lines.clone(),
        rows,
        line_bytes: row_bytes / 32 + 1,
        head,
        coder,
        done: header.lines.start,
        strips: Vec::new(),
        known: false,
        repeated: None,
    })
}

struct Tiff {
    raster: Range<u32>,
    /// Rows of a strip.
    rows: u32,
    line_bytes: usize,
    head: Head,
    coder: Box<dyn Coder>,
    /// The first line of the open strip.
    done: u32,
    /// Bytes of the strips: of those so far, or, if that is known, of all.
    strips: Vec<u64>,
    known: bool,
    /// The last strip that was one row repeated: the row, and its bytes.
    repeated: Option<(Vec<Run>, Vec<u8>)>,
}

impl Tiff {
    /// The number of the strip that begins at a line.
    fn strip_of(&self, line: u32) -> usize {
        (line.saturating_sub(self.raster.start) / self.rows) as usize
    }

    /// Takes note of a strip that ends before `line`.
    fn ended(&mut self, line: u32, bytes: u64) {
        self.done = line;
        if !self.known {
            self.strips.push(bytes);
        }
    }
}

impl Encode for Tiff {
    fn line_bytes(&self) -> usize {
        self.line_bytes
    }

    fn begin(&mut self, out: &mut Vec<u8>) {
        if self.known {
            out.extend(self.head.bytes(&self.strips));
        } else {
            out.resize(out.len() + self.head.length(), 0);
        }
    }

    fn lines(&mut self, lines: Lines<'_>, out: &mut Vec<u8>) {
        let (mut y, end) = (lines.y, lines.y + lines.n);
        while y < end {
            let n = (end - y).min(self.rows - (y - self.raster.start) % self.rows);
            y += n;
            let before = out.len();
            if let Some((_, bytes)) = self.repeated.as_ref().filter(|repeated| n == self.rows && repeated.0 == lines.runs) {
                out.extend_from_slice(bytes);
            } else {
                self.coder.rows(lines.runs, n);
                if !(y - self.raster.start).is_multiple_of(self.rows) && y < self.raster.end {
                    continue;
                }
                self.coder.end(out);
                if n == self.rows {
                    self.repeated = Some((lines.runs.to_vec(), out[before..].to_vec()));
                }
            }
            self.ended(y, (out.len() - before) as u64);
        }
    }

    fn end(&mut self, _out: &mut Vec<u8>) {}

    fn strip_lines(&self) -> u32 {
        self.rows
    }

    fn strips_from(&self) -> u32 {
        self.raster.start
    }

    /// One whole strip.
    fn part(&mut self, strip: &Strip, out: &mut Vec<u8>) -> Part {
        let lines = strip.lines();
        let start = self.raster.start + lines.start.saturating_sub(self.raster.start).next_multiple_of(self.rows);
        let end = start.saturating_add(self.rows).min(self.raster.end);
        if start >= end || end > lines.end {
            return Part::none(strip);
        }
        let before = out.len();
        strip.within(start..end).for_each(|lines| self.lines(lines, out));
        self.strips.clear();
        Part { lines: start..end, tally: [(out.len() - before) as u64, 0, 0] }
    }

    fn join(&mut self, part: &Part, _out: &mut Vec<u8>) {
        self.ended(part.lines.end, part.tally[0]);
    }

    fn length(&self) -> Option<u64> {
        self.known.then(|| self.head.length() as u64 + self.strips.iter().sum::<u64>())
    }

    fn restart(&self) -> Restart {
        Restart { line: self.done, tally: [0; 3] }
    }

    fn resume(&mut self, restart: &Restart) {
        self.done = restart.line;
        if !self.known {
            // The lengths of those before are nowhere written any more.
            self.strips = vec![0; self.strip_of(restart.line)];
        }
    }

    /// The beginning of a strip, or the end.
    fn seek(&self, offset: u64) -> Option<(u64, Restart)> {
        let mut at = self.head.length() as u64;
        if !self.known || offset < at {
            return None;
        }
        let before = self.strips.iter().take_while(|&&bytes| {
            let behind = at + bytes <= offset;
            at += if behind { bytes } else { 0 };
            behind
        });
        let line = self.raster.start + (before.count() as u32).saturating_mul(self.rows).min(self.raster.end - self.raster.start);
        Some((at, Restart { line, tally: [0; 3] }))
    }

    fn table(&self) -> Option<&[u64]> {
        Some(&self.strips)
    }

    fn know(&mut self, table: &[u64]) {
        // What a store hands in may be anything: sums must stay within 64 bits.
        if table.len() == self.head.strips() as usize && table.iter().all(|bytes| *bytes < 1 << 40) {
            (self.strips, self.known) = (table.to_vec(), true);
        }
    }

    fn head_is_known(&self) -> bool {
        self.known
    }
}

#[cfg(test)]
mod tests;
