//! The laws of solids: what is shown equals a brute force over every pixel, which is too simple to be wrong.

mod models;

use glam::DVec3;
use models::drawn::{Hit, Seen, drawn, rays, stage, stage_with};
use models::{Random, random_model, random_view};
use runset::mesh::Model;
use runset::mesh::check::all_placed;
use runset::scene::{Area, Formula, Gate};
use runset::solid::body::Plane;
use runset::solid::savings::Savings;
use runset::solid::stage::Stage;

fn effort() -> u64 {
    std::env::var("RUNSET_EFFORT").ok().and_then(|n| n.parse().ok()).unwrap_or(1)
}

/// Truth of all areas, from the sums of the leaves, straight from the definition of the gates.
fn truths(formula: &Formula, sums: &[i32]) -> Vec<bool> {
    let mut truth: Vec<Option<bool>> = vec![None; formula.gates().len()];
    fn of(area: Area, formula: &Formula, sums: &[i32], truth: &mut Vec<Option<bool>>) -> bool {
        if let Some(known) = truth[area.index()] {
            return known;
        }
        let mut sum = |inputs: &[runset::scene::Input]| {
            inputs.iter().map(|input| if of(input.area, formula, sums, truth) { input.weight } else { 0 }).sum::<i32>()
        };
        let holds = match &formula.gates()[area.index()] {
            Gate::Shape(part) => sums[*part as usize] >= 1,
            Gate::AtLeast(k, inputs) => sum(inputs) >= *k,
            Gate::Odd(inputs) => sum(inputs) % 2 != 0,
        };
        truth[area.index()] = Some(holds);
        holds
    }
    formula.gates().iter().enumerate().for_each(|(i, _)| _ = of(area_at(formula, i), formula, sums, &mut truth));
    truth.into_iter().map(|t| t.expect("all were looked at")).collect()
}

/// The area of that index.
fn area_at(formula: &Formula, index: usize) -> Area {
    let mut copy = Formula::default();
    (0..=index).map(|_| copy.everywhere()).last().filter(|_| index < formula.gates().len()).expect("an index of a gate")
}

/// Whether a path of areas whose truth changed leads from a leaf of `part` up to the root.
fn made_it(model: &Model, part: u32, before: &[bool], after: &[bool]) -> bool {
    let gates = model.formula.gates();
    let changed = |i: usize| before[i] != after[i];
    let mut reached: Vec<bool> =
        gates.iter().enumerate().map(|(i, gate)| matches!(gate, Gate::Shape(p) if *p == part) && changed(i)).collect();
    loop {
        let known = reached.clone();
        for (i, gate) in gates.iter().enumerate() {
            if let Gate::AtLeast(_, inputs) | Gate::Odd(inputs) = gate {
                reached[i] |= changed(i) && inputs.iter().any(|input| reached[input.area.index()]);
            }
        }
        if reached == known {
            return reached[model.area.index()];
        }
    }
}

/// Every pixel by itself: which faces' outlines wind around its centre, in the order of their nearness; counted from the eye on until the model holds.
fn brute(model: &Model, stage: &Stage) -> Vec<Vec<Seen>> {
    let pixel = |hits: Vec<Hit>| {
        let mut sums = vec![0; model.parts.len()];
        let mut before = truths(&model.formula, &sums);
        for group in hits.chunk_by(|a, b| a.2 == b.2) {
            group.iter().for_each(|&(face, turns, _)| sums[stage.faces[face as usize].origin.part as usize] += turns);
            let after = truths(&model.formula, &sums);
            if after[model.area.index()] {
                let part = |hit: &Hit| stage.faces[hit.0 as usize].origin.part;
                // In the order of ranks and faces.
                let &(face, _, near) = group.iter().find(|hit| made_it(model, part(hit), &before, &after)).expect("something made it");
                return Some((stage.faces[face as usize].origin.part, face, near));
            }
            before = after;
        }
        None
    };
    rays(stage).into_iter().map(|line| line.into_iter().map(pixel).collect()).collect()
}

#[test]
fn the_picture_is_that_of_every_pixel_by_itself() {
    let mut random = Random(1);
    let (mut pixels, mut shown) = (0, 0);
    for round in 0..150 * effort() {
        let most = if round % 10 == 0 { 30 } else { 6 };
        let model = random_model(&mut random, most);
        let view = random_view(&mut random, 30);
        let sections = if random.below(4) == 0 {
            vec![Plane { normal: DVec3::new(random.unit() - 0.5, random.unit() - 0.5, 0.3).normalize(), offset: 0.1 }]
        } else {
            Vec::new()
        };
        let [all, clipped] = [0, !0].map(|bits| stage_with(&model, view, &sections, Savings::from_bits(bits)));
        let expected = brute(&model, &all);
        for bits in 0..32 {
            let savings = Savings::from_bits(bits);
            let got = drawn(if savings.boxes { &clipped } else { &all }, 0..view.height, savings);
            assert_eq!(got.len(), expected.len());
            for (y, (got, expected)) in got.iter().zip(&expected).enumerate() {
                assert_eq!(got, expected, "round {round}, line {y}, {savings:?}");
            }
        }
        let half = view.height / 2;
        let below = drawn(&clipped, half..view.height, Savings::default());
        assert_eq!(below[..], expected[half as usize..], "a band");
        pixels += expected.iter().flatten().count();
        shown += expected.iter().flatten().flatten().count();
    }
    assert!(shown * 20 > pixels, "{shown} of {pixels} pixels show something");
}

#[test]
fn a_model_without_itself_is_empty() {
    let mut random = Random(3);
    for _ in 0..60 * effort() {
        let mut model = random_model(&mut random, 5);
        model.area = model.formula.without(model.area, &[model.area]);
        // And parts that are the same, but others.
        let n = model.parts.len() as u32;
        model.parts.extend(model.parts.clone());
        let mut formula = Formula::default();
        let (all, again): (Vec<Area>, Vec<Area>) =
            ((0..n).map(|i| formula.shape(i)).collect(), (n..2 * n).map(|i| formula.shape(i)).collect());
        let (a, b) = (formula.any(&all), formula.any(&again));
        let area = formula.without(a, &[b]);
        let view = random_view(&mut random, 60);
        let twice = Model { parts: model.parts.clone(), formula, area };
        for model in [model, twice] {
            let stage = stage(&model, view, &[]);
            assert!(drawn(&stage, 0..view.height, Savings::default()).iter().flatten().all(Option::is_none));
        }
    }
}

#[test]
fn the_order_of_a_union_is_free() {
    let mut random = Random(11);
    for round in 0..60 * effort() {
        let model = random_model(&mut random, 8);
        let n = model.parts.len() as u32;
        // The same parts in another order; those that are the same but for their place in the document may stand for each other.
        let mut order: Vec<u32> = (0..n).collect();
        for i in (1..n as usize).rev() {
            order.swap(i, random.below(i as u64 + 1) as usize);
        }
        let view = random_view(&mut random, 40);
        let union = |parts: Vec<runset::mesh::Part>| {
            let mut formula = Formula::default();
            let all: Vec<Area> = (0..n).map(|i| formula.shape(i)).collect();
            let area = formula.any(&all);
            Model { parts, formula, area }
        };
        let one = stage(&union(model.parts.clone()), view, &[]);
        let other = stage(&union(order.iter().map(|&i| model.parts[i as usize].clone()).collect()), view, &[]);
        let shape = |part: &u32| format!("{:?}", all_placed(&model, &mut Vec::new())[*part as usize].mesh);
        let shapes: Vec<String> = (0..n).map(|part| shape(&part)).collect();
        let (one, other) = (drawn(&one, 0..view.height, Savings::default()), drawn(&other, 0..view.height, Savings::default()));
        for (a, b) in one.iter().flatten().zip(other.iter().flatten()) {
            let a = a.map(|(part, _, near)| (&shapes[part as usize], near));
            let b = b.map(|(part, _, near)| (&shapes[order[part as usize] as usize], near));
            assert_eq!(a, b, "round {round}");
        }
    }
}
