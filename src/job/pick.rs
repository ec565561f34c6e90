//! What is seen at a pixel of a model's picture, and where it stands in the document.

use super::source::Source;
use super::{Job, Kept};
use crate::error::Place;
use crate::mesh::Matrix;
use crate::solid::savings::Savings;
use crate::solid::spans::Spans;

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// The part, counted from 0 in document order.
    pub part: usize,
    /// Whether it is seen from inside: it is taken away there.
    pub inside: bool,
    /// The normal of the surface, in the model's coordinates, towards the eye.
    pub normal: [f64; 3],
    /// The point of the surface at which the pixel is looked at, in the model's coordinates.
    pub point: [f64; 3],
    /// Its distance from the eye along the view.
    pub depth: f64,
}

/// What is known of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeptPart {
    /// What it is, in one word.
    pub kind: &'static str,
    /// Where it begins in the document.
    pub place: Option<Place>,
    /// From its own coordinates to the model's.
    pub matrix: Matrix,
}

impl Job {
    /// What pixel (`x`, `y`) of a model's picture shows: its scanline is drawn. None where that is the background, beside the page, and of plane shapes.
    pub fn pick(&self, x: u32, y: u32) -> Option<Pick> {
        let Source::Solid(stage, _) = &self.source else { return None };
        let view = &stage.view;
        // Of a pixel that is a mean the finer one in its middle.
        let n = view.width / self.header.width;
        let [x, y] = [x, y].map(|at| at.saturating_mul(n).saturating_add(n / 2));
        if x >= view.width || y >= view.height {
            return None;
        }
        let mut spans = Spans::new(stage.clone(), y..y + 1, Savings::default());
        let (_, line) = spans.next()?;
        let span = line.iter().find(|span| (span.start..span.end).contains(&x))?;
        let face = &stage.faces[span.face as usize];
        let depth = view.distance(stage.depths[face.plane as usize].at(x, y), stage.farthest);
        let normal = stage.planes[face.plane as usize].normal;
        let toward = if stage.is_toward(face.plane) { normal } else { -normal };
        Some(Pick {
            part: face.origin.part as usize,
            inside: span.inside,
            normal: toward.to_array(),
            point: view.point(x, y, depth).to_array(),
            depth,
        })
    }
}

impl Kept {
    /// What is known of a part, counted from 0 in document order.
    pub fn part(&self, part: usize) -> Option<KeptPart> {
        let part = self.model.parts.get(part)?;
        Some(KeptPart { kind: part.kind, place: part.place, matrix: part.matrix })
    }
}
