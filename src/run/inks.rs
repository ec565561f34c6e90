//! What the runs of a raster show: inks of a list, or any colours.

use super::{Rgb, WHITE};

/// Most inks of a list: a pixel of a checksum is two bytes at most, and 0 is paper.
pub const MAX_INKS: usize = 65_535;

/// What [`super::Run::ink`] says, and what paper is. Paper has no runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Inks {
    /// An index into these colours, at most [`MAX_INKS`], which are distinct and in the order of first use. Paper is white. One region is one ink,
    /// black.
    Listed(Vec<Rgb>),
    /// A colour, `0xRRGGBB`, as [`ink_of`] makes it. Where a run shows the colour of paper it is painted nevertheless.
    Shaded {
        /// The colour of what is not painted.
        paper: Rgb,
    },
}

/// What a run of a line stream tells of its ink.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Told {
    /// Nothing: there is one ink at most.
    Nothing,
    /// Its index.
    Index,
    /// Its colour.
    Colour,
}

impl Inks {
    /// The list; empty if there is none.
    pub fn listed(&self) -> &[Rgb] {
        match self {
            Inks::Listed(list) => list,
            Inks::Shaded { .. } => &[],
        }
    }

    /// What shows where there is no run.
    pub fn paper(&self) -> Rgb {
        match self {
            Inks::Listed(_) => WHITE,
            Inks::Shaded { paper } => *paper,
        }
    }

    /// Every [`super::Run::ink`] is below this.
    pub fn end(&self) -> u32 {
        match self {
            Inks::Listed(list) => list.len() as u32,
            Inks::Shaded { .. } => 1 << 24,
        }
    }

    /// The colour of an ink, which is below [`Inks::end`].
    pub fn colour(&self, ink: u32) -> Rgb {
        match self {
            Inks::Listed(list) => list[ink as usize],
            Inks::Shaded { .. } => colour_of(ink),
        }
    }

    /// The colour of a pixel: 0 is paper, the inks count from 1.
    pub fn pixel(&self, pixel: u32) -> Rgb {
        pixel.checked_sub(1).map_or(self.paper(), |ink| self.colour(ink))
    }

    /// What the runs of a line stream tell of their inks.
    pub fn told(&self) -> Told {
        match self {
            Inks::Listed(list) if list.len() > 1 => Told::Index,
            Inks::Listed(_) => Told::Nothing,
            Inks::Shaded { .. } => Told::Colour,
        }
    }
}

/// The ink of a run that shows a colour, in a raster that is [`Inks::Shaded`].
pub fn ink_of([r, g, b]: Rgb) -> u32 {
    u32::from_be_bytes([0, r, g, b])
}

/// The colour of that ink.
pub fn colour_of(ink: u32) -> Rgb {
    let [_, colour @ ..] = ink.to_be_bytes();
    colour
}
