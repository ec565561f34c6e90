//! The flat colour of a paint, or what stands for it.

use super::notes::{Element, Notes};
use crate::run::{Hex, Rgb};

/// What stands for a pattern.
const PATTERN: Rgb = [0x80; 3];

/// The ink of a paint; a note where one stands in.
pub(super) fn of(paint: &usvg::Paint, element: Element<'_>, notes: &mut Notes) -> Rgb {
    let gradient = match paint {
        usvg::Paint::Color(c) => return [c.red, c.green, c.blue],
        usvg::Paint::Pattern(_) => {
            notes.add(element, "patterns are not drawn yet: filled with #808080");
            return PATTERN;
        }
        usvg::Paint::LinearGradient(g) => g.stops(),
        usvg::Paint::RadialGradient(g) => g.stops(),
    };
    let ink = gradient.first().map_or(PATTERN, |s| [s.color().red, s.color().green, s.color().blue]);
    notes.add(element, format!("gradients are not drawn yet: filled with the first stop's {}", Hex::of(ink)));
    ink
}
