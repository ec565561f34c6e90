//! PCLm (`application/PCLm`): a page for printers as a PDF of strips, each of which is printed as it comes. 8 bits of gray or 24 of RGB a pixel, deflated.
//!
//! ```text
//! %PDF-1.7 %PCLm 1.0 | page | where the strips lie | strip, "q /image Do Q" | strip, … | catalog, pages | table of objects
//! ```
//!
//! A strip is 16 lines, those from one multiple of 16 on the page to the next, and one block of deflate of repeated pixels (`deflate.rs`). So its bytes depend on its lines alone. The
//! table at the end has the place of every strip: a writer that takes up a page in the middle begins with its first line again, and leaves out the bytes that were written.
//!
//! A file is one page here.
//!
//! Source: the order of objects is that of qpdf (`QPDFWriter::writePCLm`), which cups-filters print by; ISO 32000-1.

use std::ops::Range;

use super::adler::Adler;
use super::changes::Shown;
use super::deflate::{self, Block};
use super::printed::{RESOLUTION, pixels_of, within};
use super::{Encode, Format, Part, Restart, Strip, pgm, rows};
use crate::error::{Error, Kind, Origin, Result};
use crate::run::{Header, Inks, Lines, Pixels, Run};

/// The format.
pub const FORMAT: Format = Format {
    name: "pclm",
    extensions: &["pclm"],
    media_type: "application/PCLm",
    about: "PCLm for printers, a PDF of strips: 8 bits of gray, or RGB",
    binary: true,
    version: 1,
    pages: false,
    fits,
    encoder: |header| Box::new(Pclm::new(header)),
};

/// Most dots an inch, most pixels a side, and most bytes of pixels: a place in the file has ten digits.
const FINEST: u32 = 32_767;
const LONGEST: u32 = 65_535;
const MOST_BYTES: u64 = 8_000_000_000;

/// Lines of a strip.
const STRIP: u32 = 16;

/// What a file begins with.
const HEADER: &str = "%PDF-1.7\n%PCLm 1.0\n";

/// What stands behind each strip: the strip as an image of its own.
const ALONE: &str = "q /image Do Q";

fn fits(header: &Header) -> Result<()> {
    within(FORMAT.name, header, FINEST, LONGEST)?;
    let bytes = u64::from(header.width) * u64::from(header.height()) * bytes_of(header) as u64;
    if bytes <= MOST_BYTES {
        return Ok(());
    }
    let what = format!("pclm takes at most {MOST_BYTES} bytes of pixels, and the page has {bytes}: ask for a smaller size");
    Err(Error { kind: Kind::Limit, origin: Origin::Parameter, ..Error::parameter(what) })
}

/// Bytes of a pixel.
fn bytes_of(header: &Header) -> usize {
    if pixels_of(header) == Pixels::Rgb { 3 } else { 1 }
}

/// Numbers of the objects that are always there; a strip and what stands behind it follow for each strip, then the catalog and the list of pages.
const PAGE: usize = 1;
const CONTENTS: usize = 2;
const FIRST: usize = 3;

struct Pclm {
    header: Header,
    /// Bytes of a pixel.
    depth: usize,
    painter: Painter,
    /// What stands before the first strip, and where the second object begins in it.
    head: Vec<u8>,
    contents_at: usize,
    shown: Shown,
    /// The line at hand, painted.
    row: Vec<u8>,
    block: Block,
    adler: Adler,
    /// The line that comes next.
    next: u32,
    /// Bytes of each strip that is done, with what stands behind it.
    lengths: Vec<u32>,
    /// Bytes behind the head so far, and how many of them others have written.
    written: u64,
    skip: u64,
    /// The last strip that was one row repeated: the row, its lines, its stream.
    repeated: Option<(Vec<Run>, u32, Vec<u8>)>,
}

/// What makes pixels of inks, which count from 1; 0 is paper.
enum Painter {
    Gray(Box<dyn Fn(u32) -> u8 + Send>),
    Rgb(Inks, rows::Colours),
}

impl Painter {
    fn new(header: &Header) -> Painter {
        let inks = header.inks.clone();
        match (pixels_of(header), &header.inks) {
            (Pixels::Rgb, _) => Painter::Rgb(inks, rows::Colours::new(&header.inks)),
            (_, Inks::Listed(list)) => {
                let lumas: Vec<u8> = (0..=list.len() as u32).map(|pixel| pgm::luma(inks.pixel(pixel))).collect();
                Painter::Gray(Box::new(move |pixel| lumas[pixel as usize]))
            }
            (_, Inks::Shaded { .. }) => Painter::Gray(Box::new(move |pixel| pgm::luma(inks.pixel(pixel)))),
        }
    }

    /// Paints changes over a row.
    fn paint(&self, changes: &[Run], row: &mut [u8]) {
        match self {
            Painter::Gray(luma) => rows::packed(row, 8, changes, luma),
            Painter::Rgb(_, colours) => colours.paint(row, changes),
        }
    }

    /// Pushes the pixels of a line.
    fn push(&self, width: u32, runs: &[Run], block: &mut Block) {
        let mut put = |pixel: u32, n: u32| match self {
            Painter::Gray(luma) => block.push_equal(luma(pixel), n as usize),
            Painter::Rgb(inks, _) => block.push_pixels(inks.pixel(pixel), n as usize),
        };
        let mut at = 0;
        for run in runs {
            put(0, run.start - at);
            put(run.ink + 1, run.end - run.start);
            at = run.end;
        }
        put(0, width - at);
    }
}

impl Pclm {
    fn new(header: &Header) -> Pclm {
        let depth = bytes_of(header);
        let shown = Shown::new(header.width, 8 * depth as u32);
        let (painter, mut row) = (Painter::new(header), vec![0; shown.row_bytes()]);
        painter.paint(&[shown.paper()], &mut row);
        let (head, contents_at) = head(header);
        Pclm {
            header: header.clone(),
            depth,
            painter,
            head,
            contents_at,
            shown,
            row,
            block: if depth == 3 { Block::of_pixels() } else { Block::new() },
            adler: Adler::default(),
            next: header.lines.start,
            lengths: Vec::new(),
            written: 0,
            skip: 0,
            repeated: None,
        }
    }

    /// Writes a strip of `lines` lines that ends at `self.next`, of that stream.
    fn strip(&mut self, lines: u32, stream: &[u8], out: &mut Vec<u8>) {
        let index = ((self.next - 1) / STRIP - self.header.lines.start / STRIP) as usize;
        let (width, space) = (self.header.width, if self.depth == 3 { "RGB" } else { "Gray" });
        let (number, length) = (FIRST + 2 * index, stream.len());
        let before = format!(
            "{number} 0 obj\n<< /Type /XObject /Subtype /Image /Width {width} /Height {lines} /ColorSpace /Device{space} /BitsPerComponent 8 \
             /Filter /FlateDecode /Length {length} >>\nstream\n"
        );
        let behind = format!("\nendstream\nendobj\n{}", alone(index));
        self.lengths.push((before.len() + length + behind.len()) as u32);
        [before.as_bytes(), stream, behind.as_bytes()].iter().for_each(|bytes| self.write(bytes, out));
    }

    /// Writes what others have not written.
    fn write(&mut self, bytes: &[u8], out: &mut Vec<u8>) {
        let known = self.skip.saturating_sub(self.written).min(bytes.len() as u64);
        self.written += bytes.len() as u64;
        out.extend_from_slice(&bytes[known as usize..]);
    }

    /// The lines of the strip that a line is in.
    fn strip_of(&self, line: u32) -> Range<u32> {
        let Range { start, end } = self.header.lines;
        let first = line / STRIP * STRIP;
        first.max(start)..(first + STRIP).min(end)
    }
}

/// The object behind a strip.
fn alone(index: usize) -> String {
    let (number, length) = (FIRST + 1 + 2 * index, ALONE.len());
    format!("{number} 0 obj\n<< /Length {length} >>\nstream\n{ALONE}\nendstream\nendobj\n")
}

/// How many strips a raster is.
fn strips(lines: &Range<u32>) -> usize {
    (lines.end.div_ceil(STRIP) - lines.start / STRIP) as usize
}

/// What stands before the first strip, and where the second object begins in it.
fn head(header: &Header) -> (Vec<u8>, usize) {
    let (width, height, dpi) = (header.width, header.height(), header.dpi.unwrap_or(RESOLUTION));
    let points = |pixels: u32| decimal(f64::from(pixels) * 72.0 / dpi);
    let strips = strips(&header.lines);
    let mut head = format!(
        "{HEADER}{PAGE} 0 obj\n<< /Type /Page /Parent {} 0 R /MediaBox [ 0 0 {} {} ] /Contents [ {CONTENTS} 0 R ] /Resources << /XObject <<",
        FIRST + 2 * strips + 1,
        points(width),
        points(height)
    );
    let (scale, mut contents) = (decimal(72.0 / dpi), String::new());
    contents += &format!("{scale} 0 0 {scale} 0 0 cm\n");
    let mut line = header.lines.start;
    for index in 0..strips {
        let end = (line / STRIP * STRIP + STRIP).min(header.lines.end);
        head += &format!(" /Image{index} {} 0 R", FIRST + 2 * index);
        contents += &format!("q {width} 0 0 {} 0 {} cm /Image{index} Do Q\n", end - line, header.lines.end - end);
        line = end;
    }
    head += " >> >> >>\nendobj\n";
    let contents_at = head.len();
    head += &format!("{CONTENTS} 0 obj\n<< /Length {} >>\nstream\n{contents}\nendstream\nendobj\n", contents.len());
    (head.into_bytes(), contents_at)
}

/// A number with at most ten decimals, as PDF has them.
fn decimal(number: f64) -> String {
    let text = format!("{number:.10}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

impl Encode for Pclm {
    fn line_bytes(&self) -> usize {
        self.row.len() / 1000 + 1
    }

    fn begin(&mut self, out: &mut Vec<u8>) {
        out.extend_from_slice(&self.head);
    }

    fn lines(&mut self, lines: Lines<'_>, out: &mut Vec<u8>) {
        self.shown.show(lines.runs);
        self.painter.paint(self.shown.changes(), &mut self.row);
        let row = Adler::of(&self.row);
        let (mut y, end) = (lines.y, lines.y + lines.n);
        while y < end {
            let strip = self.strip_of(y);
            let n = strip.end.min(end) - y;
            let is_whole = n == strip.len() as u32;
            y += n;
            self.next = y;
            let known = self.repeated.take().filter(|repeated| is_whole && repeated.1 == n && repeated.0 == lines.runs);
            if let Some(repeated) = known {
                self.strip(n, &repeated.2, out);
                self.repeated = Some(repeated);
                continue;
            }
            for _ in 0..n {
                self.painter.push(self.header.width, lines.runs, &mut self.block);
                self.adler.append(row);
            }
            if y == strip.end {
                // Zlib header: deflate with a window of 32 KiB, fast, no dictionary.
                let mut stream = vec![0x78, 0x5e];
                self.block.end(&mut stream);
                stream.extend(deflate::LAST);
                stream.extend(std::mem::take(&mut self.adler).value().to_be_bytes());
                self.strip(strip.len() as u32, &stream, out);
                self.repeated = is_whole.then(|| (lines.runs.to_vec(), n, stream));
            }
        }
    }

    fn end(&mut self, out: &mut Vec<u8>) {
        let strips = strips(&self.header.lines);
        let (catalog, pages) = (FIRST + 2 * strips, FIRST + 2 * strips + 1);
        let behind = self.head.len() as u64 + self.written;
        let texts = [
            format!("{catalog} 0 obj\n<< /Type /Catalog /Pages {pages} 0 R >>\nendobj\n"),
            format!("{pages} 0 obj\n<< /Type /Pages /Count 1 /Kids [ {PAGE} 0 R ] >>\nendobj\n"),
        ];
        let mut places = vec![HEADER.len() as u64, self.contents_at as u64];
        let mut at = self.head.len() as u64;
        for (index, length) in self.lengths.iter().enumerate() {
            places.push(at);
            at += u64::from(*length);
            places.push(at - alone(index).len() as u64);
        }
        places.extend([behind, behind + texts[0].len() as u64]);
        let table = behind + texts.iter().map(|text| text.len() as u64).sum::<u64>();
        let size = pages + 1;
        let mut tail = texts.concat() + &format!("xref\n0 {size}\n0000000000 65535 f \n");
        places.iter().for_each(|place| tail += &format!("{place:010} 00000 n \n"));
        tail += &format!("trailer\n<< /Size {size} /Root {catalog} 0 R >>\nstartxref\n{table}\n%%EOF\n");
        self.write(tail.as_bytes(), out);
    }

    fn strip_lines(&self) -> u32 {
        4 * STRIP
    }

    /// Whole strips, as many as there is room for in a tally: two to a number.
    fn part(&mut self, strip: &Strip, out: &mut Vec<u8>) -> Part {
        let (Range { start, end }, raster) = (strip.lines(), &self.header.lines);
        let first = if start == raster.start { start } else { start.next_multiple_of(STRIP) };
        let end = if end == raster.end { end } else { end / STRIP * STRIP };
        let end = end.min((first / STRIP + 6) * STRIP);
        if first >= end {
            return Part::none(strip);
        }
        self.lengths.clear();
        strip.within(first..end).for_each(|lines| self.lines(lines, out));
        let pair = |i: usize| self.lengths.get(i).map_or(0, |&length| u64::from(length));
        Part { lines: first..end, tally: [0, 2, 4].map(|i| pair(i) | pair(i + 1) << 32) }
    }

    fn join(&mut self, part: &Part, _out: &mut Vec<u8>) {
        let lengths = part.tally.into_iter().flat_map(|pair| [pair as u32, (pair >> 32) as u32]);
        self.lengths.extend(lengths.clone().take(strips(&part.lines)));
        self.written += lengths.map(u64::from).sum::<u64>();
        self.next = part.lines.end;
    }

    fn restart(&self) -> Restart {
        Restart { line: self.header.lines.start, tally: [self.written.max(self.skip), 0, 0] }
    }

    fn resume(&mut self, restart: &Restart) {
        self.skip = restart.tally[0];
    }
}
