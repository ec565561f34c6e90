//! Models drawn into pixels.

use std::sync::Arc;

use runset::count::Rule;
use runset::mesh::Model;
use runset::mesh::check::all_placed;
use runset::scene::compile;
use runset::solid::body::{Body, Plane};
use runset::solid::savings::Savings;
use runset::solid::spans::Spans;
use runset::solid::stage::Stage;
use runset::solid::view::View;

/// A model in a view, cut by planes.
pub fn stage(model: &Model, view: View, sections: &[Plane]) -> Arc<Stage> {
    stage_with(model, view, sections, Savings::default())
}

/// The same, with some savings switched off.
pub fn stage_with(model: &Model, view: View, sections: &[Plane], savings: Savings) -> Arc<Stage> {
    let (program, leaves) = compile(&model.formula, model.parts.len(), &[model.area], |_| Rule::AtLeast(1));
    Arc::new(Stage::new(
        &Body::new(model, &all_placed(model, &mut Vec::new()), u64::MAX).expect("any number of pairs"),
        program,
        &leaves,
        view,
        sections,
        savings,
    ))
}

/// What a pixel shows: part, face, nearness.
pub type Seen = Option<(u32, u32, i128)>;

/// The pixels of some scanlines.
pub fn drawn(stage: &Arc<Stage>, rows: std::ops::Range<u32>, savings: Savings) -> Vec<Vec<Seen>> {
    let mut spans = Spans::new(stage.clone(), rows, savings);
    let mut picture = Vec::new();
    while let Some((y, line)) = spans.next() {
        let mut pixels = vec![None; stage.view.width as usize];
        let mut last = 0;
        for span in line {
            assert!(last <= span.start && span.start < span.end && span.end <= stage.view.width);
            last = span.end;
            for x in span.start..span.end {
                let face = &stage.faces[span.face as usize];
                pixels[x as usize] = Some((face.origin.part, span.face, stage.depths[face.plane as usize].at(x, y)));
            }
        }
        picture.push(pixels);
    }
    picture
}
