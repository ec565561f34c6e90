//! What formats for printers have in common: what pixels are, a resolution in whole dots an inch, and rows as repeats and literals.

use super::groups::Code;
use super::literals::{Literals, Pwg, bits, pixels};
use super::pgm;
use crate::error::{Error, Kind, Origin, Result};
use crate::run::{BLACK, Header, Inks, Lines, Pixels, Rgb, Run, WHITE};

/// Dots an inch where nobody said: a user unit is 1/96 inch.
pub const RESOLUTION: f64 = 96.0;

/// The byte that says that the rest of a row is white.
const REST: u8 = 128;

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

/// The colours of paper and of the inks, of which one is a pixel of `N` bytes.
enum Units<const N: usize> {
    Listed(Vec<[u8; N]>),
    Shaded(Inks, fn(Rgb) -> [u8; N]),
}

impl<const N: usize> Units<N> {
    fn new(inks: &Inks, unit: fn(Rgb) -> [u8; N]) -> Units<N> {
        match inks {
            Inks::Listed(list) => Units::Listed((0..=list.len() as u32).map(|pixel| unit(inks.pixel(pixel))).collect()),
            Inks::Shaded { .. } => Units::Shaded(inks.clone(), unit),
        }
    }

    fn push(&self, row: &mut Literals<'_, N, Pwg>, width: u32, runs: &[Run]) {
        match self {
            Units::Listed(units) => pixels(row, width, runs, units[0], |ink| units[ink as usize + 1]),
            Units::Shaded(inks, unit) => pixels(row, width, runs, unit(inks.paper()), |ink| unit(inks.colour(ink))),
        }
    }

    /// Writes a row; with `blank`, white at its end is one byte.
    fn row(&self, width: u32, runs: &[Run], blank: bool, out: &mut Vec<u8>) {
        let mut row = Literals::<_, Pwg>::new(out);
        self.push(&mut row, width, runs);
        if blank { row.end_blank([0xff; N], &[REST]) } else { row.end() }
    }
}

/// Groups as PWG raster and Apple raster have them: a byte, the lines but one, and the line.
pub struct Coded {
    width: u32,
    units: Coding,
    blank: bool,
}

enum Coding {
    Black,
    Gray(Units<1>),
    Rgb(Units<3>),
}

impl Coded {
    /// Of rasters of such pixels; with `blank`, white at the end of a line is one byte.
    pub fn new(header: &Header, pixels: Pixels, blank: bool) -> Coded {
        debug_assert!(WHITE == [0xff; 3] && !(blank && pixels == Pixels::Black), "white is the largest value");
        let units = match pixels {
            Pixels::Black => Coding::Black,
            Pixels::Gray => Coding::Gray(Units::new(&header.inks, |colour| [pgm::luma(colour)])),
            Pixels::Rgb => Coding::Rgb(Units::new(&header.inks, |colour| colour)),
        };
        Coded { width: header.width, units, blank }
    }
}

impl Code for Coded {
    const LEANS: bool = false;

    fn group(&mut self, lines: Lines<'_>, out: &mut Vec<u8>) {
        out.push((lines.n - 1) as u8);
        match &self.units {
            Coding::Black => {
                let mut row = Literals::<_, Pwg>::new(out);
                bits(&mut row, self.width, lines.runs);
                row.end();
            }
            Coding::Gray(units) => units.row(self.width, lines.runs, self.blank, out),
            Coding::Rgb(units) => units.row(self.width, lines.runs, self.blank, out),
        }
    }

    fn above(&mut self, _runs: &[Run]) {}
}
