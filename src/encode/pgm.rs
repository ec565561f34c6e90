//! Portable graymap, binary (P5): a byte a pixel, the luma of the ink or of paper.
//!
//! Source: pgm(5) of netpbm; Recommendation ITU-R BT.709 for the weights.

use super::{Encode, Format, holds_all, rows};
use crate::run::{Header, Inks, Rgb};

/// The format.
pub const FORMAT: Format = Format {
    name: "pgm",
    extensions: &["pgm"],
    media_type: "image/x-portable-graymap",
    about: "portable graymap (P5), 8 bits a pixel: luma of the inks and of paper",
    binary: true,
    version: 1,
    pages: false,
    fits: holds_all,
    encoder,
};

fn encoder(header: &Header) -> Box<dyn Encode> {
    let head = format!("P5\n{} {}\n255\n", header.width, header.height());
    let inks = header.inks.clone();
    match &header.inks {
        Inks::Listed(list) => {
            let lumas: Vec<u8> = (0..=list.len() as u32).map(|pixel| luma(inks.pixel(pixel))).collect();
            rows::plain(head, header, 8, move |runs, row| rows::packed(row, 8, runs, |pixel| lumas[pixel as usize]))
        }
        Inks::Shaded { .. } => rows::plain(head, header, 8, move |runs, row| rows::packed(row, 8, runs, |pixel| luma(inks.pixel(pixel)))),
    }
}

/// Luma of Rec. 709, taken on the 8-bit values and rounded.
pub fn luma([r, g, b]: Rgb) -> u8 {
    ((2126 * u32::from(r) + 7152 * u32::from(g) + 722 * u32::from(b) + 5000) / 10_000) as u8
}
