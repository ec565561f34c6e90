//! The laws of solids: what is shown equals a brute force over every pixel, which is too simple to be wrong.

mod models;

use std::sync::Arc;

use glam::{DQuat, DVec3, EulerRot};
use models::{Random, cube, moved, part, random_model, random_view, shifted, view};
use runset::count::{Program, Rule};
use runset::mesh::Model;
use runset::mesh::check::all_placed;
use runset::scene::{Area, Formula, Gate, compile};
use runset::solid::body::{Body, Plane};
use runset::solid::spans::{Savings, Spans};
use runset::solid::stage::Stage;
use runset::solid::view::{Projection, View};
use runset::sweep::Sweep;

fn effort() -> u64 {
    std::env::var("RUNSET_EFFORT").ok().and_then(|n| n.parse().ok()).unwrap_or(1)
}

fn stage(model: &Model, view: View, sections: &[Plane]) -> Arc<Stage> {
    let (program, leaves) = compile(&model.formula, model.parts.len(), &[model.area], |_| Rule::AtLeast(1));
    let _: &Program = &program;
    Arc::new(Stage::new(&Body::new(model, &all_placed(model, &mut Vec::new()), u64::MAX).unwrap(), program, &leaves, view, sections))
}

/// What a pixel shows: part, face, nearness.
type Seen = Option<(u32, u32, i128)>;

fn drawn(stage: &Arc<Stage>, rows: std::ops::Range<u32>, savings: Savings) -> Vec<Vec<Seen>> {
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
                pixels[x as usize] = Some((face.part, span.face, stage.depths[face.plane as usize].at(x, y)));
            }
        }
        picture.push(pixels);
    }
    picture
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
                let near = |face: u32| stage.depths[stage.faces[face as usize].plane as usize].at(x, y);
                let mut active: Vec<u32> = (0..turns.len() as u32).filter(|face| turns[*face as usize] != 0).collect();
                active.sort_by_key(|&face| (std::cmp::Reverse(near(face)), face));
                let mut sums = vec![0; model.parts.len()];
                let mut before = truths(&model.formula, &sums);
                for group in active.chunk_by(|a, b| near(*a) == near(*b)) {
                    group.iter().for_each(|&face| sums[stage.faces[face as usize].part as usize] += turns[face as usize]);
                    let after = truths(&model.formula, &sums);
                    if after[model.area.index()] {
                        let part = |face: &&u32| stage.faces[**face as usize].part;
                        let candidates = group.iter().filter(|face| made_it(model, part(face), &before, &after));
                        let face = candidates.min_by_key(|face| (stage.faces[**face as usize].rank, **face)).expect("something made it");
                        return Some((part(&face), *face, near(*face)));
                    }
                    before = after;
                }
                None
            });
            picture.push(pixels.collect());
        }
    }
    picture
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
        let stage = stage(&model, view, &sections);
        let expected = brute(&model, &stage);
        for savings in [(true, true), (false, true), (true, false), (false, false)] {
            let savings = Savings { spans: savings.0, hidden: savings.1 };
            let got = drawn(&stage, 0..stage.view.height, savings);
            assert_eq!(got.len(), expected.len());
            for (y, (got, expected)) in got.iter().zip(&expected).enumerate() {
                assert_eq!(got, expected, "round {round}, line {y}, {savings:?}");
            }
        }
        let half = stage.view.height / 2;
        let below = drawn(&stage, half..stage.view.height, Savings::default());
        assert_eq!(below[..], expected[half as usize..], "a band");
        pixels += expected.iter().flatten().count();
        shown += expected.iter().flatten().flatten().count();
    }
    assert!(shown * 20 > pixels, "{shown} of {pixels} pixels show something");
}

/// What the rays of a view meet of unions and differences of boxes, from their coordinates alone: `list` is boxes with +1 or -1, the difference of the
/// union of the first and the union of the second. Gives the index of the box whose side is seen.
fn meets(boxes: &[([f64; 3], [f64; 3], bool)], eye: DVec3, direction: DVec3) -> Option<(f64, Vec<usize>)> {
    let spans: Vec<(f64, f64)> = boxes
        .iter()
        .map(|(least, most, _)| {
            let mut span = (f64::NEG_INFINITY, f64::INFINITY);
            for i in 0..3 {
                let (a, b) = ((least[i] - eye[i]) / direction[i], (most[i] - eye[i]) / direction[i]);
                let (a, b) =
                    if direction[i] == 0.0 && (eye[i] < least[i] || eye[i] > most[i]) { (1.0, -1.0) } else { (a.min(b), a.max(b)) };
                span = (span.0.max(a), span.1.min(b));
            }
            span
        })
        .collect();
    let mut events: Vec<f64> = spans.iter().filter(|s| s.0 < s.1).flat_map(|s| [s.0, s.1]).filter(|t| *t > 0.0).collect();
    events.sort_by(f64::total_cmp);
    events.dedup();
    // Just behind each event: halfway to the next.
    for (i, &t) in events.iter().enumerate() {
        let behind = events.get(i + 1).map_or(t + 1.0, |next| (t + next) / 2.0);
        let within = |i: usize| spans[i].0 < behind && behind < spans[i].1;
        let inside = (0..boxes.len()).any(|i| boxes[i].2 && within(i)) && !(0..boxes.len()).any(|i| !boxes[i].2 && within(i));
        if inside {
            return Some((t, (0..boxes.len()).filter(|&i| spans[i].0 == t || spans[i].1 == t).collect()));
        }
    }
    None
}

fn boxes_model(boxes: &[([f64; 3], [f64; 3], bool)]) -> Model {
    let parts = boxes.iter().map(|b| part(cube(b.0, b.1), shifted(0.0, 0.0, 0.0))).collect();
    let mut formula = Formula::default();
    let all: Vec<Area> = (0..boxes.len() as u32).map(|i| formula.shape(i)).collect();
    let of = |wanted: bool| all.iter().zip(boxes).filter(|(_, b)| b.2 == wanted).map(|(area, _)| *area).collect::<Vec<_>>();
    let (whole, holes) = (of(true), of(false));
    let whole = formula.any(&whole);
    let area = formula.without(whole, &holes);
    Model { parts, formula, area }
}

/// Compares a turned model of boxes with the rays turned back into its own coordinates; gives how many pixels show what no ray near their centre meets.
fn wrong_pixels(boxes: &[([f64; 3], [f64; 3], bool)], turn: DQuat, view: View) -> (usize, usize) {
    let stage = stage(&moved(&boxes_model(boxes), turn, DVec3::ZERO), view, &[]);
    let back = turn.inverse();
    let ray = |x: f64, y: f64| {
        let [right, down, forward] = view.axes;
        let (x, y) = (x - f64::from(view.width) / 2.0, y - f64::from(view.height) / 2.0);
        match view.projection {
            Projection::Perspective { focal, .. } => (back * view.eye, back * (forward + right * (x / focal) + down * (y / focal))),
            Projection::Orthographic { scale } => (back * (view.eye + right * (x / scale) + down * (y / scale)), back * forward),
        }
    };
    let (mut wrong, mut shown) = (0, 0);
    for (y, line) in drawn(&stage, 0..view.height, Savings::default()).iter().enumerate() {
        for (x, seen) in line.iter().enumerate() {
            shown += usize::from(seen.is_some());
            let fits = |dx: f64, dy: f64| {
                let (eye, direction) = ray(x as f64 + 0.5 + dx, y as f64 + 0.5 + dy);
                match (seen, meets(boxes, eye, direction)) {
                    (None, None) => true,
                    (Some((part, _, near)), Some((t, parts))) => {
                        let z = stage.view.distance(*near, stage.farthest);
                        parts.contains(&(*part as usize)) && (z - t).abs() < 1e-2 * t
                    }
                    _ => false,
                }
            };
            // A hair, and twice what rounding can do.
            const NEAR: f64 = 1e-5;
            let around = [
                (0.0, 0.0),
                (NEAR, NEAR),
                (-NEAR, NEAR),
                (NEAR, -NEAR),
                (-NEAR, -NEAR),
                (NEAR, 0.0),
                (-NEAR, 0.0),
                (0.0, NEAR),
                (0.0, -NEAR),
            ];
            let fits = around.iter().any(|&(dx, dy)| fits(dx, dy));
            if !fits {
                let (eye, direction) = ray(x as f64 + 0.5, y as f64 + 0.5);
                eprintln!("pixel {x} {y}: {seen:?}, the ray meets {:?}", meets(boxes, eye, direction));
            }
            wrong += usize::from(!fits);
        }
    }
    (wrong, shown)
}

#[test]
fn coplanar_boxes_show_what_the_rays_meet() {
    let unit = ([-1.0; 3], [1.0; 3]);
    let half = ([0.0, -1.0, -1.0], [2.0, 1.0, 1.0]);
    let beside = ([1.0, -1.0, -1.0], [3.0, 1.0, 1.0]);
    let scenes: [&[_]; 5] = [
        &[(unit.0, unit.1, true), (half.0, half.1, false)],
        &[(unit.0, unit.1, true), (half.0, half.1, true)],
        &[(unit.0, unit.1, true), (beside.0, beside.1, true)],
        &[(unit.0, unit.1, true), (beside.0, beside.1, true), ([-0.5, -1.0, -0.5], [2.5, 1.0, 0.5], false)],
        &[(unit.0, unit.1, true), (beside.0, beside.1, true), (half.0, half.1, false), ([-1.0, 0.0, 0.0], [3.0, 1.0, 1.0], true)],
    ];
    let mut random = Random(7);
    for i in 0..6 * effort() {
        let turn = match i {
            0 => DQuat::IDENTITY,
            _ => DQuat::from_euler(EulerRot::XYZ, random.unit() * 6.0, random.unit() * 6.0, random.unit() * 6.0),
        };
        for boxes in scenes {
            let size = if i % 6 == 5 { 2048 } else { 512 };
            let perspective = Projection::Perspective { focal: f64::from(size) * 2.0, near: 1.0 };
            let orthographic = Projection::Orthographic { scale: f64::from(size) / 6.0 };
            for projection in [perspective, orthographic] {
                let view = view(size, size, DVec3::new(5.0, -9.0, 5.0), DVec3::new(1.0, 0.0, 0.0), projection);
                let (wrong, shown) = wrong_pixels(boxes, turn, view);
                assert!(shown > 1000, "{shown}");
                assert_eq!(wrong, 0, "turn {i}, {} boxes, {projection:?}", boxes.len());
            }
        }
    }
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
