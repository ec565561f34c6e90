//! Portable bitmap, binary (P4): one bit a pixel, 1 where anything is painted. Fixed size: a row is `ceil(width / 8)` bytes.
//!
//! Source: pbm(5) of netpbm.

use super::{Encode, Format, holds_all, rows};
use crate::run::Header;

/// The format.
pub const FORMAT: Format = Format {
    name: "pbm",
    extensions: &["pbm"],
    media_type: "image/x-portable-bitmap",
    about: "portable bitmap (P4), 1 bit a pixel: 1 where anything is painted",
    binary: true,
    version: 1,
    pages: false,
    fits: holds_all,
    encoder,
};

fn encoder(header: &Header) -> Box<dyn Encode> {
    let head = format!("P4\n{} {}\n", header.width, header.height());
    rows::plain(head, header, 1, |runs, row| rows::packed(row, 1, runs, |ink| u8::from(ink > 0)))
}
