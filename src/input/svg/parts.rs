//! What was painted, as areas that are still to be cut.
//!
//! Neighbours that are cut alike are joined before they are cut, so a clip path costs a gate for each group that it is set on and not for
//! each shape.

use usvg::MaskType;

use crate::run::Rgb;
use crate::scene::{Area, Formula};

/// Where something is filled, and the area that it is cut to.
#[derive(Clone, Copy)]
pub(super) struct Part {
    pub(super) raw: Area,
    pub(super) cut: Option<Area>,
}

/// What was painted so far: into the drawing, a clip path or a mask.
#[derive(Default)]
pub(super) struct Sink {
    /// Everything.
    pub(super) parts: Vec<Part>,
    /// Inks with what they paint, in painting order.
    pub(super) layers: Vec<(Rgb, Vec<Part>)>,
    /// How it lets light through, if it is a mask.
    pub(super) mask: Option<MaskType>,
}

/// Parts as one part. Cut last, if all are cut alike.
pub(super) fn joined(parts: &[Part], formula: &mut Formula) -> Part {
    match parts {
        [one] => *one,
        [first, rest @ ..] if rest.iter().all(|p| p.cut == first.cut) => {
            let raws: Vec<Area> = parts.iter().map(|p| p.raw).collect();
            Part { raw: formula.any(&raws), cut: first.cut }
        }
        _ => {
            let pieces: Vec<Area> = parts.chunk_by(|a, b| a.cut == b.cut).map(|alike| closed(alike, formula)).collect();
            Part { raw: formula.any(&pieces), cut: None }
        }
    }
}

/// Parts as one area.
pub(super) fn closed(parts: &[Part], formula: &mut Formula) -> Area {
    let Part { raw, cut } = joined(parts, formula);
    cut.map_or(raw, |cut| formula.all(&[raw, cut]))
}
