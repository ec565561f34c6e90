//! Models as jobs: what must not change their line streams by a byte.

mod models;

use models::jobs::{colored_model, job, random_setup};
use models::{Random, cube, part, shifted};
use runset::encode::by_name;
use runset::job::Job;
use runset::mesh::Model;
use runset::scene::{Area, Formula};

fn effort() -> u64 {
    std::env::var("RUNSET_EFFORT").ok().and_then(|n| n.parse().ok()).unwrap_or(1)
}

fn stream(job: &Job) -> Vec<u8> {
    let mut bytes = Vec::new();
    job.render(by_name("rls").expect("a format"), 2, &mut bytes, &mut |_| ()).expect("a vector takes all");
    bytes
}

#[test]
fn parts_outside_of_the_view_change_nothing() {
    let mut random = Random(41);
    for round in 0..60 * effort() {
        let model = colored_model(&mut random, 6);
        let setup = random_setup(&mut random, 90, 80);
        // Behind the eye, or far to its side; joined, or taken away.
        let place = [[60.0, -60.0, 40.0], [-90.0, -70.0, 0.0], [80.0, 90.0, 5.0]][random.below(3) as usize];
        let mut more = model.clone();
        let place = place.map(|x| x + random.unit());
        more.parts.push(part(cube([-1.0, -1.5, -0.5], [2.0, 1.0, 1.0]), shifted(place[0], place[1], place[2])));
        let outside = more.formula.shape(model.parts.len() as u32);
        more.area =
            if random.below(2) == 0 { more.formula.any(&[more.area, outside]) } else { more.formula.without(more.area, &[outside]) };
        assert!(stream(&job(&model, setup)) == stream(&job(&more, setup)), "round {round}");
    }
}

/// Parts may coincide with others, but no two of a model are the same.
#[test]
fn operands_of_a_union_in_any_order() {
    let mut random = Random(43);
    for round in 0..60 * effort() {
        let mut model = colored_model(&mut random, 8);
        let mut distinct: Vec<runset::mesh::Part> = Vec::new();
        for part in model.parts.drain(..) {
            let same = |other: &runset::mesh::Part| other.matrix == part.matrix;
            if !distinct.iter().any(same) {
                distinct.push(part);
            }
        }
        let setup = random_setup(&mut random, 90, 80);
        let union = |parts: &[runset::mesh::Part]| {
            let mut formula = Formula::default();
            let all: Vec<Area> = (0..parts.len() as u32).map(|i| formula.shape(i)).collect();
            let area = formula.any(&all);
            Model { parts: parts.to_vec(), formula, area }
        };
        let one = stream(&job(&union(&distinct), setup));
        for i in (1..distinct.len()).rev() {
            distinct.swap(i, random.below(i as u64 + 1) as usize);
        }
        assert!(one == stream(&job(&union(&distinct), setup)), "round {round}");
    }
}
