//! PNG, in segments that do not depend on each other.
//!
//! Black alone is 1-bit greyscale; up to 255 inks are a palette (paper is entry 0) at the smallest depth that holds it; more inks, and
//! shaded rasters, are 8-bit RGB.
//!
//! ```text
//! IHDR pHYs PLTE | IDAT 78 5e | IDAT rows 0..k | IDAT rows k..2k | … | IDAT rows to the end, empty last block, Adler-32 | IEND
//! ```
//!
//! `k` rows, some 256 KiB, are a segment: those from one multiple of `k` on the page to the next. Its first row is not filtered (type
//! 0), all others are differences to the row above (type 2, Up). It is one block of deflate that refers to nothing before it
//! (`deflate.rs`) and one chunk. So the bytes of a segment depend on its rows alone: a writer can start at any of them, threads
//! write different ones, a segment of equal rows is compressed once, and the checksum is combined from those of the segments.
//!
//! Cost: of most rows what changes is painted, filtered and compressed (`changes.rs`), whatever their width; of the first of a segment all. A
//! symbol for each 258 bytes of a repeat; a copy of the compressed bytes for a segment that repeats.
//!
//! Source: PNG Specification (Third Edition), RFC 1950.

// Drawings are coherent from row to row, and Up turns that into zeros at the speed of memory.

use std::ops::Range;

use super::adler::Adler;
use super::changes::Shown;
use super::deflate::{self, Block};
use super::{Encode, Format, Part, Restart, Strip, holds_all, rows};
use crate::run::{BLACK, Header, Lines, Rgb, Run};

/// The format.
pub const FORMAT: Format = Format {
    name: "png",
    extensions: &["png"],
    media_type: "image/png",
    about: "PNG: 1 bit for black alone, a palette up to 255 inks, else RGB",
    binary: true,
    version: 1,
    pages: false,
    fits: holds_all,
    encoder: |header| Box::new(Png::new(header)),
};

/// Rows of a segment: about 256 KiB of them, but 16, if that is at most 1 MiB, so that few are not filtered.
fn segment_rows(row_bytes: usize) -> u32 {
    rows::lines_of(1 << 18, row_bytes).max(rows::lines_of(1 << 20, row_bytes).min(16))
}

/// What the pixels of a row are.
#[derive(Clone, Copy, PartialEq)]
enum Colour {
    Grey,
    Palette { depth: u32 },
    Rgb,
}

struct Png {
    header: Header,
    colour: Colour,
    /// For RGB.
    colours: rows::Colours,
    segment_rows: u32,
    /// Whether the segment has begun.
    open: bool,
    /// The line at hand, painted.
    row: Vec<u8>,
    shown: Shown,
    /// The row above. When no line is at hand both are the same.
    above: Vec<u8>,
    /// The bytes where they may differ.
    stretches: Vec<Range<usize>>,
    /// What a filter made of some bytes.
    filtered: Vec<u8>,
    idat: Idat,
    /// Where the segment began, or will.
    restart: Restart,
    /// The last segment that was one row repeated: the row, its chunks, its checksum.
    repeated: Option<(Vec<Run>, Vec<u8>, Adler)>,
}

impl Png {
    fn new(header: &Header) -> Png {
        let (colour, depth) = match header.inks.end() {
            0..=255 if header.inks.listed().iter().all(|&ink| ink == BLACK) => (Colour::Grey, 1),
            1 => (Colour::Palette { depth: 1 }, 1),
            2..=3 => (Colour::Palette { depth: 2 }, 2),
            4..=15 => (Colour::Palette { depth: 4 }, 4),
            16..=255 => (Colour::Palette { depth: 8 }, 8),
            _ => (Colour::Rgb, 24),
        };
        let shown = Shown::new(header.width, depth);
        let row_bytes = shown.row_bytes();
        let colours = rows::Colours::new(&header.inks);
        let mut paper = vec![if let Colour::Palette { .. } = colour { 0 } else { 255 }; row_bytes];
        if colour == Colour::Rgb {
            colours.paint(&mut paper, &[shown.paper()]);
        }
        Png {
            header: header.clone(),
            colour,
            colours,
            segment_rows: segment_rows(row_bytes),
            open: false,
            row: paper.clone(),
            shown,
            above: paper,
            stretches: Vec::new(),
            filtered: Vec::new(),
            idat: Idat::new(),
            restart: Restart { line: header.lines.start, tally: [0; 3] },
            repeated: None,
        }
    }

    /// Paints a line over the one above it.
    fn paint(&mut self, runs: &[Run]) {
        self.shown.show(runs);
        let changes = self.shown.changes();
        match self.colour {
            Colour::Grey => rows::packed(&mut self.row, 1, changes, |ink| u8::from(ink == 0)),
            Colour::Palette { depth } => rows::packed(&mut self.row, depth, changes, |ink| ink as u8),
            Colour::Rgb => self.colours.paint(&mut self.row, changes),
        }
        self.shown.stretches(&mut self.stretches);
    }

    /// Puts `n` rows equal to `self.row` into the open segment, which has room for them, and ends it if they are its last.
    fn rows(&mut self, n: u32, last: bool, out: &mut Vec<u8>) {
        if self.open {
            self.idat.equal(2, 1);
            let mut at = 0;
            for stretch in &self.stretches {
                self.idat.equal(0, stretch.start - at);
                self.filtered.clear();
                let (row, above) = (&self.row[stretch.clone()], &self.above[stretch.clone()]);
                self.filtered.extend(row.iter().zip(above).map(|(row, above)| row.wrapping_sub(*above)));
                self.idat.bytes(&self.filtered);
                at = stretch.end;
            }
            self.idat.equal(0, self.row.len() - at);
        } else {
            self.idat.equal(0, 1);
            self.idat.bytes(&self.row);
        }
        for _ in 1..n {
            self.idat.equal(2, 1);
            self.idat.equal(0, self.row.len());
        }
        self.open = !last;
        if last {
            self.idat.end_segment(out);
        }
    }
}

impl Encode for Png {
    fn line_bytes(&self) -> usize {
        // Zeros are deflated to about a thousandth, and each row has a filter type.
        self.row.len() / 1000 + 2
    }

    fn begin(&mut self, out: &mut Vec<u8>) {
        let Header { width, inks, dpi, .. } = &self.header;
        let (depth, colour) = match self.colour {
            Colour::Grey => (1, 0),
            Colour::Palette { depth } => (depth as u8, 3),
            Colour::Rgb => (8, 2),
        };
        out.extend_from_slice(b"\x89PNG\r\n\x1a\n");
        let [width, height] = [*width, self.header.height()].map(u32::to_be_bytes);
        chunk(out, b"IHDR", |out| out.extend([&width[..], &height, &[depth, colour, 0, 0, 0]].concat()));
        if let Some(per_metre) = dpi.map(|dpi| (dpi / 0.0254).round()).filter(|p| (1.0..=f64::from(i32::MAX)).contains(p)) {
            let per_metre = (per_metre as u32).to_be_bytes();
            chunk(out, b"pHYs", |out| out.extend([&per_metre[..], &per_metre, &[1]].concat()));
        }
        if let Colour::Palette { .. } = self.colour {
            let palette: Vec<Rgb> = [inks.paper()].iter().chain(inks.listed()).copied().collect();
            chunk(out, b"PLTE", |out| out.extend(palette.as_flattened()));
        }
        // Zlib header: deflate with a window of 32 KiB, fast, no dictionary.
        chunk(out, b"IDAT", |out| out.extend([0x78, 0x5e]));
    }

    fn lines(&mut self, lines: Lines<'_>, out: &mut Vec<u8>) {
        self.paint(lines.runs);
        let (mut y, end) = (lines.y, lines.y + lines.n);
        while y < end {
            let n = (end - y).min(self.segment_rows - y % self.segment_rows);
            y += n;
            let last = y.is_multiple_of(self.segment_rows);
            if n < self.segment_rows {
                self.rows(n, last, out);
            } else if let Some((_, chunks, adler)) = self.repeated.as_ref().filter(|repeated| repeated.0 == self.shown.runs()) {
                out.extend_from_slice(chunks);
                self.idat.adler.append(*adler);
            } else {
                let (start, adler) = (out.len(), std::mem::take(&mut self.idat.adler));
                self.rows(n, last, out);
                let segment = std::mem::replace(&mut self.idat.adler, adler);
                self.idat.adler.append(segment);
                self.repeated = Some((self.shown.runs().to_vec(), out[start..].to_vec(), segment));
            }
            if last {
                self.restart = Restart { line: y, tally: self.idat.adler.tally() };
            }
        }
        for stretch in &self.stretches {
            self.above[stretch.clone()].copy_from_slice(&self.row[stretch.clone()]);
        }
    }

    fn end(&mut self, out: &mut Vec<u8>) {
        self.idat.end(self.open, out);
        chunk(out, b"IEND", |_| ());
    }

    fn strip_lines(&self) -> u32 {
        self.segment_rows
    }

    /// Whole segments, but for the first and the last of the raster.
    fn part(&mut self, strip: &Strip, out: &mut Vec<u8>) -> Part {
        let Range { start, end } = strip.lines();
        let (start, end) = (start.next_multiple_of(self.segment_rows), end / self.segment_rows * self.segment_rows);
        if start >= end {
            return Part::none(strip);
        }
        self.idat.adler = Adler::default();
        strip.within(start..end).for_each(|lines| self.lines(lines, out));
        Part { lines: start..end, tally: self.idat.adler.tally() }
    }

    fn join(&mut self, part: &Part, _out: &mut Vec<u8>) {
        self.idat.adler.append(Adler::new(part.tally));
        self.restart = Restart { line: part.lines.end, tally: self.idat.adler.tally() };
    }

    fn restart(&self) -> Restart {
        self.restart
    }

    fn resume(&mut self, restart: &Restart) {
        self.idat.adler = Adler::new(restart.tally);
        self.restart = *restart;
    }
}

/// The compressed stream: a chunk a segment.
struct Idat {
    block: Block,
    /// Of all rows so far.
    adler: Adler,
}

impl Idat {
    fn new() -> Idat {
        Idat { block: Block::new(), adler: Adler::default() }
    }

    /// Takes filtered bytes.
    fn bytes(&mut self, filtered: &[u8]) {
        self.block.push(filtered);
        self.adler.append(Adler::of(filtered));
    }

    /// Takes `n` equal ones.
    fn equal(&mut self, byte: u8, n: usize) {
        self.block.push_equal(byte, n);
        self.adler.append(Adler::equal(byte, n as u64));
    }

    fn end_segment(&mut self, out: &mut Vec<u8>) {
        chunk(out, b"IDAT", |out| self.block.end(out));
    }

    /// Ends the stream, and before it the last segment if that is still open.
    fn end(&mut self, open: bool, out: &mut Vec<u8>) {
        chunk(out, b"IDAT", |out| {
            if open {
                self.block.end(out);
            }
            out.extend(deflate::LAST);
            out.extend(self.adler.value().to_be_bytes());
        });
    }
}

/// Appends a chunk of what `data` appends.
fn chunk(out: &mut Vec<u8>, kind: &[u8; 4], data: impl FnOnce(&mut Vec<u8>)) {
    let start = out.len();
    out.extend_from_slice(&[0; 4]);
    out.extend_from_slice(kind);
    data(out);
    let length = (out.len() - start - 8) as u32;
    out[start..start + 4].copy_from_slice(&length.to_be_bytes());
    let crc = crc32fast::hash(&out[start + 4..]);
    out.extend_from_slice(&crc.to_be_bytes());
}
