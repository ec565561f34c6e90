//! How a model looks, besides its colours.

use std::ops::RangeInclusive;

/// What is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Finer pixels along a side of a pixel, whose mean it is: 1 to [`MAX_ANTIALIAS`]. The stage has a page so many times larger.
    pub antialias: u32,
    /// Faces of a part are shaded as one surface where they meet at less than this, in degrees: above 0, at most 180. Without it all are flat.
    pub smooth: Option<f64>,
    /// Lines where a surface ends, or its faces meet at more than this, in degrees: 0 to 180. They are as wide as a pixel.
    pub edges: Option<f64>,
    /// Parts that are glass, by their numbers, counted from 1. At most [`MAX_TRANSLUCENT`] ranges.
    pub translucent: Vec<RangeInclusive<u32>>,
    /// What is cut away is glass.
    pub glass: bool,
}

impl Default for Look {
    fn default() -> Look {
        Look { antialias: 1, smooth: None, edges: None, translucent: Vec::new(), glass: false }
    }
}

impl Look {
    /// For each of so many parts whether it is named as glass.
    pub fn named(&self, parts: usize) -> Vec<bool> {
        let mut named = vec![false; parts];
        for range in &self.translucent {
            let (start, end) = (range.start().saturating_sub(1) as usize, (*range.end() as usize).min(parts));
            named[start.min(end)..end].fill(true);
        }
        named
    }
}

/// Most finer pixels along a side of a pixel.
pub const MAX_ANTIALIAS: u32 = 8;

/// Most ranges of parts that are glass.
pub const MAX_TRANSLUCENT: usize = 1000;
