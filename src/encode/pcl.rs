//! PCL 5 raster (`application/vnd.hp-PCL`): what laser printers and plotters (HP-RTL) take. A bit a pixel, 1 where anything is painted.
//!
//! ```text
//! ESC E | ESC *t600R … ESC *r6000t4000s1A | ESC *b2m9W row | ESC *b3m4W row | ESC *b3m0W again | ESC *b120Y white | … | ESC *rC FF | ESC E
//! ```
//!
//! A row is written in the shorter of two ways: mode 2, repeats and literals as TIFF's PackBits has them, without the white at its end; or mode 3, the bytes that differ from
//! the row above. A row that is as the one above is empty in mode 3; white rows are a move. Every 256th row of the page leans on nothing.
//!
//! The image begins at the corner of what the printer takes for its page: laser printers leave a margin. They know 75, 100, 150, 200, 300, 600 and mostly 1200 dots an inch;
//! plotters take other resolutions too. There is no colour.
//!
//! Source: HP, PCL 5 Printer Language Technical Reference Manual (5961-0509), chapter 15; what Ghostscript's `ljet4` and netpbm's `pbmtolj` write.

use std::ops::Range;

use super::changes::Shown;
use super::groups::{Code, GROUP, Groups};
use super::literals::{Literals, PackBits, bits};
use super::printed::{resolution, within};
use super::{Encode, Format, media, rows};
use crate::error::Result;
use crate::run::{Header, Lines, Run};

/// The format.
pub const FORMAT: Format = Format {
    name: "pcl",
    extensions: &["pcl", "rtl"],
    media_type: "application/vnd.hp-PCL",
    about: "PCL 5 raster for printers and plotters, 1 bit a pixel: 1 where anything is painted",
    binary: true,
    version: 1,
    pages: true,
    fits,
    encoder,
};

/// Most dots an inch, and most pixels a side: numbers of 16 bits.
const FINEST: u32 = 32_767;
const LONGEST: u32 = 65_535;

/// Names of sizes of paper that have a number.
const PAPERS: [(&str, u32); 14] = [
    ("na_executive_7.25x10.5in", 1),
    ("na_letter_8.5x11in", 2),
    ("na_legal_8.5x14in", 3),
    ("na_ledger_11x17in", 6),
    ("iso_a5_148x210mm", 25),
    ("iso_a4_210x297mm", 26),
    ("iso_a3_297x420mm", 27),
    ("jis_b5_182x257mm", 45),
    ("jis_b4_257x364mm", 46),
    ("jpn_hagaki_100x148mm", 71),
    ("na_monarch_3.875x7.5in", 80),
    ("na_number-10_4.125x9.5in", 81),
    ("iso_dl_110x220mm", 90),
    ("iso_c5_162x229mm", 91),
];

fn fits(header: &Header) -> Result<()> {
    within(FORMAT.name, header, FINEST, LONGEST)
}

fn encoder(header: &Header) -> Box<dyn Encode> {
    let (width, height, dpi) = (header.width, header.height(), resolution(header).max(1));
    let name = media::name(width, height, dpi);
    let paper = PAPERS.iter().find(|paper| paper.0 == name).map(|paper| format!("\x1b&l{}A", paper.1)).unwrap_or_default();
    let reset = |wanted: bool| if wanted { "\x1bE" } else { "" };
    // Upright, without a margin at the top nor one left at the bottom; the image as the page stands, from its corner on.
    let head = format!("{}{paper}\x1b&l0o0e0L\x1b*p0x0Y\x1b*t{dpi}R\x1b*r0f{height}t{width}s1A", reset(header.sheet.is_first()));
    let tail = format!("\x1b*rC\x0c{}", reset(header.sheet.is_last()));
    let shown = Shown::new(width, 1);
    let row = vec![0; shown.row_bytes()];
    let rows = Rows { width, above: row.clone(), row, shown, stretches: Vec::new(), packed: Vec::new(), delta: Vec::new() };
    Groups::boxed(header, rows.row.len(), head.into_bytes(), tail.into_bytes(), rows)
}

/// Rows in mode 2 and 3.
struct Rows {
    width: u32,
    shown: Shown,
    /// The line at hand, painted, and the one above it. When no line is at hand both are the same.
    row: Vec<u8>,
    above: Vec<u8>,
    /// The bytes where they may differ.
    stretches: Vec<Range<usize>>,
    /// The row in mode 2, and in mode 3.
    packed: Vec<u8>,
    delta: Vec<u8>,
}

impl Rows {
    /// Paints a line over the one above it.
    fn paint(&mut self, runs: &[Run]) {
        self.shown.show(runs);
        rows::packed(&mut self.row, 1, self.shown.changes(), |ink| u8::from(ink > 0));
        self.shown.stretches(&mut self.stretches);
    }

    /// Makes the painted line the one above.
    fn advance(&mut self) {
        for stretch in &self.stretches {
            self.above[stretch.clone()].copy_from_slice(&self.row[stretch.clone()]);
        }
    }

    /// The row in mode 3.
    fn differences(&mut self) {
        self.delta.clear();
        // Behind the last byte that was replaced.
        let mut at = 0;
        for stretch in &self.stretches {
            let mut from = stretch.start;
            let differs = |i: &usize| self.row[*i] != self.above[*i];
            while let Some(start) = (from..stretch.end).find(differs) {
                let end = (start..stretch.end).find(|i| !differs(i)).unwrap_or(stretch.end);
                for (piece, start) in self.row[start..end].chunks(8).zip((start..).step_by(8)) {
                    replace(start - at, piece, &mut self.delta);
                    at = start + piece.len();
                }
                from = end;
            }
        }
    }
}

/// Writes that behind so many bytes, others follow, 8 at most: 3 bits, how many but one, and 5 bits of the distance, which goes on in further bytes if they are all set.
fn replace(distance: usize, bytes: &[u8], out: &mut Vec<u8>) {
    out.push(((bytes.len() - 1) << 5 | distance.min(31)) as u8);
    if let Some(rest) = distance.checked_sub(31) {
        out.resize(out.len() + rest / 255, 255);
        out.push((rest % 255) as u8);
    }
    out.extend_from_slice(bytes);
}

impl Code for Rows {
    const LEANS: bool = true;

    fn group(&mut self, lines: Lines<'_>, out: &mut Vec<u8>) {
        self.paint(lines.runs);
        if lines.runs.is_empty() {
            command(out, b"", lines.n, b'Y');
        } else {
            self.packed.clear();
            let mut row = Literals::<1, PackBits>::new(&mut self.packed);
            bits(&mut row, 0..self.width, lines.runs);
            row.end_blank([0], &[]);
            let alone = lines.y.is_multiple_of(GROUP);
            if !alone {
                self.differences();
            }
            let (mode, bytes) = if !alone && self.delta.len() < self.packed.len() { (b"3m", &self.delta) } else { (b"2m", &self.packed) };
            command(out, mode, bytes.len() as u32, b'W');
            out.extend_from_slice(bytes);
            if lines.n > 1 {
                command(out, b"3m", 0, b'W');
                (2..lines.n).for_each(|_| command(out, b"", 0, b'W'));
            }
        }
        self.advance();
    }

    fn above(&mut self, runs: &[Run]) {
        self.paint(runs);
        self.advance();
    }
}

/// Writes a command of raster data.
fn command(out: &mut Vec<u8>, before: &[u8], number: u32, letter: u8) {
    out.extend_from_slice(b"\x1b*b");
    out.extend_from_slice(before);
    out.extend_from_slice(itoa::Buffer::new().format(number).as_bytes());
    out.push(letter);
}
