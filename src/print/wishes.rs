//! What is wanted of a printer.

use super::failure::{Failure, Why};
use super::sheet::Scaling;
use crate::encode::{Format, by_name};

/// What is wanted of a printer.
#[derive(Clone, Debug)]
pub struct Wishes {
    /// This format.
    pub format: Option<&'static Format>,
    /// This resolution, in dots an inch.
    pub dpi: Option<u32>,
    /// This medium, by its name, a part of it (`a4`), or its size (`914x1200mm`).
    pub media: Option<String>,
    /// How the drawing is brought to the sheet's size.
    pub scaling: Scaling,
    /// Whether the drawing may be turned by a quarter where that lets it fit.
    pub turn: bool,
    /// How often.
    pub copies: u32,
    /// Draft, normal or high.
    pub quality: Option<Quality>,
}

impl Default for Wishes {
    fn default() -> Wishes {
        Wishes { format: None, dpi: None, media: None, scaling: Scaling::Auto, turn: true, copies: 1, quality: None }
    }
}

/// How well it is printed (print-quality).
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Quality {
    /// Fast.
    Draft,
    /// As usual.
    Normal,
    /// Slow.
    High,
}

impl Quality {
    /// All of them.
    pub const ALL: [Quality; 3] = [Quality::Draft, Quality::Normal, Quality::High];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Quality::Draft => "draft",
            Quality::Normal => "normal",
            Quality::High => "high",
        }
    }
}

/// The format of that name, if it is one that is printed.
///
/// # Errors
/// No format has that name.
pub fn named(name: &str) -> Result<&'static Format, Failure> {
    by_name(name).ok_or_else(|| Failure::new(Why::Wish, format!("no format is called {name:?}: see runset formats")))
}
