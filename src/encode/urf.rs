//! Apple raster (`image/urf`), for AirPrint: pages of repeats and literals as in PWG raster, 8 bits of gray or 24 of sRGB a pixel.
//!
//! ```text
//! UNIRAST 0 | pages | header of 32 bytes | lines - 1, row | lines - 1, row | … | header | …
//! ```
//!
//! White at the end of a line is one byte, 128. A bit a pixel is not known here: black alone is gray.
//!
//! Source: what libcups 2.4 reads and writes (`cups/raster-stream.c`); there is no public specification.

use super::coded::Ending;
use super::groups::Groups;
use super::printed::{bits_of, pixels_of, resolution, within};
use super::{Encode, Format};
use crate::error::Result;
use crate::run::{Header, Pixels};

/// The format.
pub const FORMAT: Format = Format {
    name: "urf",
    extensions: &["urf"],
    media_type: "image/urf",
    about: "Apple raster for AirPrint printers: 8 bits of gray, or sRGB",
    binary: true,
    version: 1,
    pages: true,
    fits,
    encoder,
};

/// Most dots an inch.
const FINEST: u32 = i32::MAX as u32;

fn fits(header: &Header) -> Result<()> {
    within(FORMAT.name, header, FINEST, u32::MAX)
}

fn encoder(header: &Header) -> Box<dyn Encode> {
    let pixels = if pixels_of(header) == Pixels::Rgb { Pixels::Rgb } else { Pixels::Gray };
    let bits = bits_of(pixels);
    let mut head = Vec::new();
    if header.sheet.is_first() {
        head.extend_from_slice(b"UNIRAST\0");
        head.extend_from_slice(&header.sheet.of.to_be_bytes());
    }
    // Bits of a pixel, sGray or sRGB, one side of the paper; the rest is left to the printer.
    head.extend_from_slice(&[bits as u8, u8::from(pixels == Pixels::Rgb), 1, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    for number in [header.width, header.height(), resolution(header).max(1), 0, 0] {
        head.extend_from_slice(&number.to_be_bytes());
    }
    let row_bytes = header.width as usize * bits as usize / 8;
    Groups::boxed(header, row_bytes, head, Vec::new(), Ending::new(header, pixels))
}
