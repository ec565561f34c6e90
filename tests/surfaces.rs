//! Areas of models worked out to surfaces: their volumes against sums over cells and against formulas, their pictures against those of the trees that they come from.

#![allow(clippy::unwrap_used)] // all of this is tests

mod models;
#[path = "../benches/solids/mod.rs"]
#[allow(dead_code)] // benches use the rest
mod solids;

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DQuat, DVec3};
use models::drawn::stage;
use models::{Random, cube, matrix, moved, part, prism, random_model, random_view, regular, shifted, tree, view};
use runset::error::{Kind, Warning};
use runset::input::{ModelOptions, Reading, Rendered, read_tree};
use runset::job::{Job, Kept, SolidOptions, evaluate, stl};
use runset::mesh::boolean::surface;
use runset::mesh::check::closed;
use runset::mesh::surface::Surface;
use runset::mesh::{IDENTITY, Mesh, Model, Origin, Part};
use runset::scene::{Area, Formula, Gate};
use runset::solid::camera::{Camera, Setup};
use runset::solid::savings::Savings;
use runset::solid::spans::Spans;
use runset::solid::stage::Stage;
use runset::solid::view::Projection;

fn effort() -> u64 {
    std::env::var("RUNSET_EFFORT").ok().and_then(|effort| effort.parse().ok()).unwrap_or(1)
}

fn worked_out(model: &Model) -> Surface {
    let mut warnings = Vec::new();
    let solid = surface(model, model.area, &mut warnings).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    // Closed and right side out, in triangles and in faces.
    for mesh in [triangles(&solid), solid.clone().mesh()] {
        let checked = closed(&part(mesh, IDENTITY));
        assert_eq!((checked.open_edges, checked.inside_out), (0, false));
    }
    solid
}

fn triangles(solid: &Surface) -> Mesh {
    let face = |t: &runset::mesh::surface::Triangle| runset::mesh::Face::new(vec![t.corners.to_vec()]);
    Mesh { points: solid.points.clone(), faces: solid.triangles.iter().map(face).collect() }
}

/// Whether a gate holds, given which shapes hold.
fn holds(formula: &Formula, area: Area, shape: &dyn Fn(u32) -> bool) -> bool {
    let sum = |inputs: &[runset::scene::Input]| -> i32 {
        inputs.iter().map(|input| if holds(formula, input.area, shape) { input.weight } else { 0 }).sum()
    };
    match &formula.gates()[area.index()] {
        Gate::Shape(i) => shape(*i),
        Gate::AtLeast(k, inputs) => sum(inputs) >= *k,
        Gate::Odd(inputs) => sum(inputs) % 2 != 0,
    }
}

/// Boxes between whole numbers below `SIDE`: most of their faces coincide or touch.
const SIDE: u64 = 5;

fn random_boxes(random: &mut Random) -> (Model, Vec<[[u64; 2]; 3]>) {
    let boxes: Vec<[[u64; 2]; 3]> = (0..2 + random.below(7))
        .map(|_| {
            [0; 3].map(|_| {
                let low = random.below(SIDE);
                [low, low + 1 + random.below(SIDE - low)]
            })
        })
        .collect();
    let corner = |b: &[[u64; 2]; 3], end: usize| b.map(|ends| ends[end] as f64);
    let parts: Vec<Part> = boxes.iter().map(|b| part(cube(corner(b, 0), corner(b, 1)), IDENTITY)).collect();
    let mut formula = Formula::default();
    let mut area = tree(random, &mut formula, parts.len() as u32);
    if random.below(3) == 0 {
        // Complements within a box.
        let parts: Vec<Area> = (0..parts.len() as u32).map(|i| formula.shape(i)).collect();
        let outside = formula.not(area);
        let k = 1 + random.below(parts.len() as u64) as i32;
        let most = formula.at_least(k, &parts);
        area = if random.below(2) == 0 { formula.all(&[outside, parts[0]]) } else { formula.odd(&[outside, formula_not(&mut formula.clone(), most)]) };
        let _ = most;
    }
    (Model { parts, formula, area }, boxes)
}
