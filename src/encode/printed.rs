//! What formats for printers have in common: what pixels are, and a resolution in whole dots an inch.

use crate::error::{Error, Kind, Origin, Result};
use crate::run::{BLACK, Header, Inks, Pixels, Rgb};

/// Dots an inch where nobody said: a user unit is 1/96 inch.
pub const RESOLUTION: f64 = 96.0;

/// Dots an inch of a raster, rounded.
pub fn resolution(header: &Header) -> u32 {
    header.dpi.unwrap_or(RESOLUTION).round() as u32
}

/// Refuses a raster whose resolution, width or height a format has no room for; `longest` is for both sides, in pixels.
///
/// # Errors
/// What is out of range, and what to ask for.
pub fn within(format: &str, header: &Header, finest: u32, longest: u32) -> Result<()> {
    let dpi = header.dpi.unwrap_or(RESOLUTION);
    let what = if !(1.0..=f64::from(finest)).contains(&dpi.round()) {
        format!("{format} takes 1 to {finest} dots an inch, and {dpi} were asked for: ask for another resolution")
    } else if header.width > longest || header.height() > longest {
        format!(
            "{format} takes at most {longest} px a side, and the page is {} x {}: ask for a smaller size",
            header.width,
            header.height()
        )
    } else {
        return Ok(());
    };
    Err(Error { kind: Kind::Limit, origin: Origin::Parameter, ..Error::parameter(what) })
}

/// What a raster's pixels are: what was asked for, or the least that shows all its inks.
pub fn pixels_of(header: &Header) -> Pixels {
    let is_gray = |&[r, g, b]: &Rgb| r == g && g == b;
    header.sheet.pixels.unwrap_or_else(|| match &header.inks {
        Inks::Listed(inks) if inks.iter().all(|ink| *ink == BLACK) => Pixels::Black,
        Inks::Listed(inks) if inks.iter().all(is_gray) => Pixels::Gray,
        _ => Pixels::Rgb,
    })
}

/// Bits of such a pixel.
pub fn bits_of(pixels: Pixels) -> u32 {
    match pixels {
        Pixels::Black => 1,
        Pixels::Gray => 8,
        Pixels::Rgb => 24,
    }
}
