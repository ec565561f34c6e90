//! The solid workloads are the same whether they are made in memory or read from their `.csg`; their meshes are closed and right side out.

#![allow(clippy::unwrap_used)] // all of this is tests

#[path = "../benches/solids/mod.rs"]
#[allow(dead_code)] // benches use the rest
mod solids;

use runset::input::{ModelOptions, read_model};
use runset::mesh::check::{Placed, all_placed};
use runset::mesh::{Model, Point};
use runset::scene::{Area, Formula, Gate};

/// Parts in the order of the tree's leaves, one for each time that a part is named.
fn leaves(model: &Model, placed: &[Placed]) -> Vec<(Vec<Point>, usize, Option<[u8; 3]>)> {
    let mut indices = Vec::new();
    gather(&model.formula, model.area, &mut indices);
    let leaf = |i: u32| {
        let mesh = &placed[i as usize].mesh;
        (mesh.points.clone(), mesh.faces.len(), model.parts[i as usize].color)
    };
    indices.into_iter().map(leaf).collect()
}

fn gather(formula: &Formula, area: Area, indices: &mut Vec<u32>) {
    match &formula.gates()[area.index()] {
        Gate::Shape(i) => indices.push(*i),
        Gate::AtLeast(_, inputs) | Gate::Odd(inputs) => inputs.iter().for_each(|i| gather(formula, i.area, indices)),
    }
}

fn checked(model: &Model, name: &str) -> Vec<Placed> {
    let mut warnings = Vec::new();
    let placed = all_placed(model, &mut warnings);
    assert!(warnings.is_empty(), "{name}: {warnings:?}");
    placed
}

#[test]
fn models_are_what_their_csg_says() {
    for name in solids::names().into_iter().chain(["bigmesh/10000".to_owned()]) {
        let solid = solids::solid(&name).unwrap();
        let mut warnings = Vec::new();
        let read = read_model(solid.csg.as_bytes(), &ModelOptions::default(), &mut warnings).unwrap();
        assert!(warnings.is_empty(), "{name}: {warnings:?}");
        let [mut made, mut read] = [&solid.model, &read].map(|model| leaves(model, &checked(model, &name)));
        for (points, ..) in made.iter_mut().chain(&mut read) {
            points.sort_by(|a, b| a.partial_cmp(b).unwrap());
        }
        // Unions of unions are one list, in another order.
        made.sort_by(|a, b| a.partial_cmp(b).unwrap());
        read.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert!(made == read, "{name}");
    }
}

#[test]
fn parts_are_as_many_as_the_table_says() {
    for (name, parts) in [
        ("fig313/3/diff", 2),
        ("fig316/1", 3),
        ("fig47/10/4", 9),
        ("fig414/1", 6),
        ("menger/2", 28),
        ("menger/3", 220),
        ("plate/100", 101),
        ("engine", 63),
        ("blowup/200", 401),
    ] {
        assert_eq!(solids::solid(name).unwrap().model.parts.len(), parts, "{name}");
    }
    let three = solids::solid("fig316/1").unwrap().model;
    assert_eq!(three.parts.iter().map(|p| p.mesh.faces.len()).sum::<usize>(), 772);
}
