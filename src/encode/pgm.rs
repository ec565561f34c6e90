//! Portable graymap, binary (P5): a byte a pixel, the luma of the ink on white.
//!
//! Source: pgm(5) of netpbm; Recommendation ITU-R BT.709 for the weights.

use super::{Encode, Format, rows};
use crate::run::{Header, Rgb, WHITE};

/// The format.
pub const FORMAT: Format = Format {
    name: "pgm",
    extensions: &["pgm"],
    media_type: "image/x-portable-graymap",
    about: "portable graymap (P5), 8 bits a pixel: luma of the inks on white",
    binary: true,
    version: 1,
    encoder,
};

fn encoder(header: &Header) -> Box<dyn Encode> {
    let head = format!("P5\n{} {}\n255\n", header.width, header.height());
    let lumas: Vec<u8> = [WHITE].iter().chain(&header.inks).map(luma).collect();
    rows::plain(head, header, 8, 255, move |runs, row| rows::packed(row, 8, runs, |ink| lumas[ink as usize]))
}

/// Luma of Rec. 709, taken on the 8-bit values and rounded.
fn luma(&[r, g, b]: &Rgb) -> u8 {
    ((2126 * u32::from(r) + 7152 * u32::from(g) + 722 * u32::from(b) + 5000) / 10_000) as u8
}
