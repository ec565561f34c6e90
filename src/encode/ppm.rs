//! Portable pixmap, binary (P6): three bytes a pixel, the colours of inks and of paper.
//!
//! Source: ppm(5) of netpbm.

use super::{Encode, Format, holds_all, rows};
use crate::run::Header;

/// The format.
pub const FORMAT: Format = Format {
    name: "ppm",
    extensions: &["ppm"],
    media_type: "image/x-portable-pixmap",
    about: "portable pixmap (P6), 24 bits a pixel: the inks on paper",
    binary: true,
    version: 1,
    pages: false,
    fits: holds_all,
    encoder,
};

fn encoder(header: &Header) -> Box<dyn Encode> {
    let head = format!("P6\n{} {}\n255\n", header.width, header.height());
    let colours = rows::Colours::new(&header.inks);
    rows::plain(head, header, 24, move |runs, row| colours.paint(row, runs))
}
