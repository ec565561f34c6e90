//! What was drawn under which id: what the walk over a drawing hands to those who name its areas.

use std::ops::Range;

use foldhash::HashMap;

use crate::run::Rgb;
use crate::scene::{Area, Scene};

/// A drawing without the names of its areas.
pub(super) struct Walked<'t> {
    pub(super) scene: Scene,
    /// What was drawn under an id.
    pub(super) drawn: HashMap<&'t str, Drawn>,
    /// The shapes that paint, in painting order, with their inks.
    pub(super) paints: Vec<(u32, Rgb)>,
}

/// All places where an element is drawn.
#[derive(Clone)]
pub(super) struct Drawn {
    pub(super) area: Area,
    /// Which of [`Walked::paints`].
    pub(super) paints: Range<usize>,
    /// More of the same.
    pub(super) more: Vec<(Area, Range<usize>)>,
}

impl Drawn {
    pub(super) fn places(&self) -> impl Iterator<Item = (Area, Range<usize>)> {
        std::iter::once((self.area, self.paints.clone())).chain(self.more.iter().cloned())
    }
}
