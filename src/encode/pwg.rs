//! PWG raster (`image/pwg-raster`): what printers without a driver take. Pages of repeats and literals, 1 bit of black, 8 of gray or 24 of sRGB a pixel.
//!
//! ```text
//! RaS2 | header of 1796 bytes | lines - 1, row | lines - 1, row | … | header | …
//! ```
//!
//! Black alone is 1 bit a pixel, inks that are gray 8 bits, others sRGB, unless [`Sheet::pixels`](crate::run::Sheet::pixels) says otherwise. Equal lines are a group
//! (`groups.rs`), a row is made of its runs (`literals.rs`), and what did not change since the one before is copied (`coded.rs`).
//!
//! Source: PWG 5102.4-2012, PWG Raster Format; PWG 5101.1-2013, Media Standardized Names.

use super::coded::Coded;
use super::groups::Groups;
use super::printed::{bits_of, pixels_of, resolution, within};
use super::{Encode, Format, media};
use crate::error::Result;
use crate::run::{Header, Pixels};

/// The format.
pub const FORMAT: Format = Format {
    name: "pwg",
    extensions: &["pwg"],
    media_type: "image/pwg-raster",
    about: "PWG raster for printers: 1 bit for black alone, 8 for gray, else sRGB",
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
    let pixels = pixels_of(header);
    let mut head = Vec::new();
    if header.sheet.is_first() {
        head.extend_from_slice(b"RaS2");
    }
    head.extend_from_slice(&page(header, pixels));
    Groups::boxed(header, row_bytes(header, pixels), head, Vec::new(), Coded::new(header, pixels))
}

fn row_bytes(header: &Header, pixels: Pixels) -> usize {
    (header.width as usize * bits_of(pixels) as usize).div_ceil(8)
}

/// Bytes of a page's header.
const PAGE: usize = 1796;

/// The header of a page: what is not put into it is 0, which leaves it to the printer.
fn page(header: &Header, pixels: Pixels) -> [u8; PAGE] {
    let (width, height, dpi) = (header.width, header.height(), resolution(header).max(1));
    let mut page = [0; PAGE];
    let mut text = |at: usize, text: &str| page[at..at + text.len()].copy_from_slice(text.as_bytes());
    text(0, "PwgRaster");
    text(1732, &media::name(width, height, dpi));
    let mut put = |at: usize, number: u32| page[at..at + 4].copy_from_slice(&number.to_be_bytes());
    let both = |put: &mut dyn FnMut(usize, u32), at, [x, y]: [u32; 2]| {
        put(at, x);
        put(at + 4, y);
    };
    both(&mut put, 276, [dpi; 2]);
    put(340, 1); // copies
    both(&mut put, 352, [width, height].map(|pixels| points(pixels, dpi)));
    both(&mut put, 372, [width, height]);
    let (space, colours, bits) = match pixels {
        Pixels::Black => (3, 1, 1),
        Pixels::Gray => (18, 1, 8),
        Pixels::Rgb => (19, 3, 8),
    };
    both(&mut put, 384, [bits, bits * colours]);
    put(392, row_bytes(header, pixels) as u32);
    put(400, space);
    put(420, colours);
    put(452, header.sheet.of);
    both(&mut put, 456, [1, 1]); // neither mirrored nor turned, across and along the way of the paper
    both(&mut put, 472, [width, height]); // the box of the image, whose left and top are 0
    put(480, 0xff_ffff); // the primary other than black: white
    page
}

/// A side in points of 1/72 inch, rounded, at least 1.
fn points(pixels: u32, dpi: u32) -> u32 {
    (f64::from(pixels) * 72.0 / f64::from(dpi)).round().max(1.0) as u32
}
