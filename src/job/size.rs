//! How large the page becomes, and where the drawing lies on it.

use std::ops::Range;

use crate::edge::Placement;
use crate::error::{Error, Kind, Origin, Result};
use crate::grid::{MAX_HEIGHT, MAX_WIDTH};

/// User units to an inch, as in CSS.
pub const UNITS_PER_INCH: f64 = 96.0;

/// How large the page becomes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Size {
    /// Pixels to a user unit.
    Scale(f64),
    /// Dots an inch; a user unit is 1/96 inch.
    Dpi(f64),
    /// Pixels. One alone keeps the aspect; with both the drawing is fitted inside and centred.
    Pixels {
        /// Width in pixels.
        width: Option<u32>,
        /// Height in pixels.
        height: Option<u32>,
    },
    /// A sheet with the drawing at a place of it.
    Placed {
        /// Width of the sheet in pixels.
        width: u32,
        /// Height of the sheet in pixels.
        height: u32,
        /// From user units to pixels.
        placement: Placement,
    },
}

/// A page and where the drawing lies on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Page {
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// From user units to pixels.
    pub placement: Placement,
}

impl Size {
    /// The page for a drawing of `width` x `height` user units.
    ///
    /// # Errors
    /// A size that is not positive, or larger than a page may be.
    pub fn page(&self, width: f64, height: f64) -> Result<Page> {
        let scaled = |scale: f64| {
            let [width, height] = [width * scale, height * scale].map(|size| whole(size).max(1.0));
            fits(width, height)?;
            Ok(Page { width: width as u32, height: height as u32, placement: Placement { scale, offset: [0.0; 2] } })
        };
        let page = match *self {
            Size::Scale(scale) => scaled(positive(scale, "scale")?)?,
            Size::Dpi(dpi) => scaled(positive(dpi, "dpi")? / UNITS_PER_INCH)?,
            Size::Pixels { width: None, height: None } => scaled(1.0)?,
            Size::Pixels { width: Some(w), height: None } => Page { width: w, ..scaled(f64::from(w) / width)? },
            Size::Pixels { width: None, height: Some(h) } => Page { height: h, ..scaled(f64::from(h) / height)? },
            Size::Pixels { width: Some(w), height: Some(h) } => {
                let scale = (f64::from(w) / width).min(f64::from(h) / height);
                let offset = [(f64::from(w) - width * scale) / 2.0, (f64::from(h) - height * scale) / 2.0];
                Page { width: w, height: h, placement: Placement { scale, offset } }
            }
            Size::Placed { width, height, placement } => Page { width, height, placement },
        };
        if page.width == 0 || page.height == 0 {
            return Err(Error::parameter("a page has at least one pixel: give a larger width or height"));
        }
        fits(page.width.into(), page.height.into())?;
        Ok(page)
    }
}

/// A size in whole pixels, half a pixel rounded up: 36.83 mm at 50 dpi are 72.5 px, although the doubles on the way there are not exact.
fn whole(size: f64) -> f64 {
    const ROUNDING: f64 = 8.0 * f64::EPSILON;
    (size * (1.0 + ROUNDING) + 0.5).floor()
}

/// Whether a page may be that large, in pixels.
fn fits(width: f64, height: f64) -> Result<()> {
    if !width.is_finite() || !height.is_finite() {
        return Err(Error::parameter("the page's size is not finite: ask for a smaller size"));
    }
    if width <= f64::from(MAX_WIDTH) && height <= f64::from(MAX_HEIGHT) {
        return Ok(());
    }
    let [width, height] = [width, height].map(|x| if x < 1e12 { format!("{x}") } else { format!("{x:.1e}") });
    let what = format!("the page would be {width} x {height} px: at most {MAX_WIDTH} x {MAX_HEIGHT}, so ask for a smaller size");
    Err(Error { kind: Kind::Limit, origin: Origin::Parameter, ..Error::parameter(what) })
}

fn positive(value: f64, what: &str) -> Result<f64> {
    if value.is_finite() && value > 0.0 { Ok(value) } else { Err(Error::parameter(format!("{what} is {value}: give a number above 0"))) }
}

/// Scanlines `Y0..Y1`, half-open and not empty, as people write them.
///
/// # Errors
/// What is wrong, and what to give.
pub fn lines(text: &str) -> std::result::Result<Range<u32>, String> {
    let range = text.split_once("..").and_then(|(from, to)| Some(from.parse().ok()?..to.parse().ok()?));
    let range = range.ok_or("give two line numbers, the first counted from 0 and the one behind the last, such as 0..100")?;
    match range.start < range.end && range.end <= MAX_HEIGHT {
        true => Ok(range),
        false => Err(format!("the second number must be above the first and at most {MAX_HEIGHT}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages() {
        let page = |size: Size, w, h| size.page(w, h).map(|p| (p.width, p.height));
        assert_eq!(page(Size::Scale(1.0), 10.5, 10.49), Ok((11, 10)));
        assert_eq!(page(Size::Scale(0.001), 10.0, 10.0), Ok((1, 1)));
        // A0 at 2400 dpi: 841 mm and 1189 mm.
        assert_eq!(page(Size::Dpi(2400.0), 841.0 / 25.4 * 96.0, 1189.0 / 25.4 * 96.0), Ok((79_465, 112_346)));
        assert_eq!(page(Size::Pixels { width: Some(100), height: None }, 10.0, 5.0), Ok((100, 50)));
        assert_eq!(page(Size::Pixels { width: None, height: Some(100) }, 10.0, 5.0), Ok((200, 100)));
        let fitted = Size::Pixels { width: Some(100), height: Some(100) }.page(10.0, 5.0).unwrap();
        assert_eq!((fitted.width, fitted.height, fitted.placement), (100, 100, Placement { scale: 10.0, offset: [0.0, 25.0] }));
        assert_eq!(page(Size::Scale(1.0), 1_048_576.0, 8_388_608.0), Ok((1_048_576, 8_388_608)));
        assert_eq!(page(Size::Scale(1.0), 1_048_577.0, 1.0).unwrap_err().kind, Kind::Limit);
        assert!(page(Size::Scale(1e9), 10.0, 10.0).unwrap_err().what.starts_with("the page would be 10000000000 x 10000000000 px: "));
        assert!(page(Size::Scale(1e307), 1.0, 1e-307).unwrap_err().what.starts_with("the page would be 1.0e307 x 1 px: "));
        assert_eq!(page(Size::Scale(1e300), 1e300, 1.0).unwrap_err().kind, Kind::Refused);
        assert!(page(Size::Scale(f64::NAN), 1.0, 1.0).is_err() && page(Size::Dpi(-1.0), 1.0, 1.0).is_err());
    }

    #[test]
    fn ranges_of_lines_are_half_open_and_hold_a_line() {
        assert_eq!(lines("0..1"), Ok(0..1));
        assert_eq!(lines("7..8388608"), Ok(7..8_388_608));
        for text in ["", "5", "5..", "..5", "5..5", "6..5", "0..8388609", "-1..5", "0...5", "0..=5", "0..99999999999"] {
            assert!(lines(text).is_err(), "{text}");
        }
    }
}
