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
use runset::sweep::Sweep;

/// A model in a view, cut by planes.
pub fn stage(model: &Model, view: View, sections: &[Plane]) -> Arc<Stage> {
    stage_with(model, view, sections, Savings::default())
}

/// The same, with some savings switched off.
pub fn stage_with(model: &Model, view: View, sections: &[Plane], savings: Savings) -> Arc<Stage> {
    let (program, leaves) = compile(&model.formula, model.parts.len(), &[model.area], |_| Rule::AtLeast(1));
    Arc::new(Stage::new(&body(model), program, &leaves, view, sections, savings))
}

/// What a model is made of.
pub fn body(model: &Model) -> Body {
    Body::new(model, &all_placed(model, &mut Vec::new()), u64::MAX).expect("any number of pairs")
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

/// A face that a ray goes through: face, how often its outline winds around the pixel, nearness.
pub type Hit = (u32, i32, i128);

/// Every pixel by itself: which faces' outlines wind around its centre, in the order of their nearness.
pub fn rays(stage: &Stage) -> Vec<Vec<Vec<Hit>>> {
    let mut sweep = Sweep::new(0..stage.view.height);
    let mut picture = Vec::new();
    while let Some(scanline) = sweep.next(&stage.edges) {
        for y in scanline.y..scanline.y + scanline.n {
            let crossings: Vec<_> = sweep.columns().iter().zip(sweep.list()).map(|(&x, entry)| (x, sweep.tags()[entry.slot()])).collect();
            let pixels = (0..stage.view.width).map(|x| {
                let mut turns = vec![0; stage.faces.len()];
                for (_, crossing) in crossings.iter().filter(|crossing| crossing.0 <= x) {
                    turns[crossing.left as usize] += crossing.turns;
                    if let Some(right) = turns.get_mut(crossing.right as usize) {
                        *right -= crossing.turns;
                    }
                }
                let near = |face: usize| stage.depths[stage.faces[face].plane as usize].at(x, y);
                let active = turns.iter().enumerate().filter(|(_, turns)| **turns != 0);
                let mut hits: Vec<Hit> = active.map(|(face, &turns)| (face as u32, turns, near(face))).collect();
                hits.sort_by_key(|&(face, _, near)| (std::cmp::Reverse(near), stage.faces[face as usize].rank, face));
                hits
            });
            picture.push(pixels.collect());
        }
    }
    picture
}
