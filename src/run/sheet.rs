//! Pages of a file that holds several.

/// What a raster is in a file for printing. By default it is the only page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sheet {
    /// Number of the page, from 0. The first page is written with what stands before all pages, the last with what stands behind them.
    pub number: u32,
    /// Pages of the file.
    pub of: u32,
    /// What pixels are to be, in formats that leave a choice; without it, the least that shows all inks.
    pub pixels: Option<Pixels>,
}

impl Default for Sheet {
    fn default() -> Sheet {
        Sheet { number: 0, of: 1, pixels: None }
    }
}

impl Sheet {
    /// Whether no page is before it.
    pub fn is_first(&self) -> bool {
        self.number == 0
    }

    /// Whether no page is behind it.
    pub fn is_last(&self) -> bool {
        self.number.saturating_add(1) >= self.of
    }
}

/// What the pixels of a page are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pixels {
    /// A bit, set where anything is painted.
    Black,
    /// A byte, the luma.
    Gray,
    /// Three bytes, red, green, blue.
    Rgb,
}
