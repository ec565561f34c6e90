//! Parts that move: what changes of the picture, and what does not.

#[path = "../benches/solids/mod.rs"]
#[allow(dead_code, reason = "some of the workloads")]
mod solids;

mod models;

use std::ops::Range;

use models::jobs::{colored_model, random_setup};
use models::{Random, part, shifted};
use runset::encode::by_name;
use runset::job::{Job, Kept, Move, SolidOptions};
use runset::mesh::Model;
use runset::scene::Limits;
use runset::solid::camera::{Camera, Setup};
use runset::solid::stage::Plane;

fn effort() -> u64 {
    std::env::var("RUNSET_EFFORT").ok().and_then(|n| n.parse().ok()).unwrap_or(1)
}

fn kept(model: &Model) -> Kept {
    Kept::new(model, &Limits::default(), &mut Vec::new()).expect("a small model")
}

fn moved(kept: &Kept, moves: &[Move]) -> Kept {
    kept.moved(moves, &Limits::default()).expect("parts that there are")
}

/// The bytes of the lines, without a header.
fn pixels(kept: &Kept, options: &SolidOptions, lines: Option<Range<u32>>) -> Vec<u8> {
    let options = SolidOptions { lines, ..options.clone() };
    let mut bytes = Vec::new();
    let job = Job::solid(kept, &options).expect("a page and a camera");
    job.render(by_name("ppm").expect("a format"), 1, &mut bytes, &mut |_| ()).expect("a vector takes all");
    let size = 3 * job.header().width as usize * job.header().height() as usize;
    bytes.split_off(bytes.len() - size)
}

/// The old picture with the new lines over it.
fn patched(old: &Kept, new: &Kept, options: &SolidOptions) -> (Vec<u8>, u32) {
    let mut picture = pixels(old, options, None);
    let stride = 3 * options.setup.width as usize;
    let lines = new.changed(old, options).expect("a page and a camera");
    assert!(lines.windows(2).all(|pair| pair[0].end < pair[1].start), "{lines:?}");
    for range in &lines {
        let bytes = pixels(new, options, Some(range.clone()));
        picture[range.start as usize * stride..range.end as usize * stride].copy_from_slice(&bytes);
    }
    (picture, lines.iter().map(|range| range.end - range.start).sum())
}

#[test]
fn a_partial_redraw_is_the_full_picture() {
    let mut random = Random(71);
    let (mut drawn, mut all, mut partial) = (0, 0, 0);
    for round in 0..250 * effort() {
        let most = random.pick(&[2, 6, 20]);
        let mut model = colored_model(&mut random, most);
        // Far corners that stay, so that the model's size often does.
        if random.below(2) == 0 {
            let mut areas = vec![model.area];
            for corner in [[-9.0; 3], [9.0; 3]] {
                areas.push(model.formula.shape(model.parts.len() as u32));
                model.parts.push(part(models::cube([-0.5; 3], [0.5; 3]), shifted(corner[0], corner[1], corner[2])));
            }
            model.area = model.formula.any(&areas);
        }
        let setup = random_setup(&mut random, 70, 90);
        let sections = if random.below(3) == 0 {
            // Among them planes in which faces lie.
            vec![Plane { normal: -glam::DVec3::Z, offset: random.pick(&[0.0, -0.5, 1.0, -0.3]) }]
        } else {
            Vec::new()
        };
        let options = SolidOptions { setup, sections, ..SolidOptions::default() };
        let mut places = [kept(&model), kept(&model)];
        let mut movement = || {
            // By halves, so that faces come to lie in those of others; by little; or by any way.
            let by = match random.below(4) {
                0 | 1 => [0; 3].map(|_| (random.below(5) as f64 - 2.0) / 2.0),
                2 => [0; 3].map(|_| (random.unit() - 0.5) * 1e-9),
                _ => [0; 3].map(|_| random.unit() - 0.5),
            };
            Move { part: random.below(model.parts.len() as u64) as usize, by }
        };
        let moves: Vec<Vec<Move>> = (0..2).map(|step| (0..step + 1).map(|_| movement()).collect()).collect();
        for (step, moves) in moves.iter().enumerate() {
            let base = kept(&model);
            places[1 - step] = moved(&base, moves);
            let [new, old] = [&places[1 - step], &places[step]];
            let full = pixels(new, &options, None);
            let (patched, lines) = patched(old, new, &options);
            assert!(patched == full, "round {round}: {moves:?}");
            drawn += u64::from(lines);
            all += u64::from(setup.height);
            partial += u64::from(lines < setup.height);
        }
    }
    println!("{drawn} of {all} lines drawn again, {partial} partly");
    assert!(partial * 3 > 250 * effort(), "few were partial: {partial}");
}

/// Moving a part is the same as having it elsewhere.
#[test]
fn a_model_that_was_moved_is_that_model() {
    let mut random = Random(73);
    for round in 0..40 * effort() {
        let model = colored_model(&mut random, 6);
        let options = SolidOptions { setup: random_setup(&mut random, 60, 60), ..SolidOptions::default() };
        let which = random.below(model.parts.len() as u64) as usize;
        let by = [0; 3].map(|_| (random.below(9) as f64 - 4.0) / 4.0);
        let mut other = model.clone();
        (0..3).for_each(|i| other.parts[which].matrix[i][3] += by[i]);
        let there = moved(&kept(&model), &[Move { part: which, by }]);
        assert!(pixels(&there, &options, None) == pixels(&kept(&other), &options, None), "round {round}");
        assert!(there.changed(&kept(&other), &options).unwrap().is_empty(), "round {round}");
    }
}

#[test]
fn a_small_part_of_a_large_model_moves_few_lines() {
    // (workload, the part that moves, lines of 512 at most)
    for (name, which, most) in [("plate/1000", 500, 40), ("menger/3", 200, 240)] {
        let solid = solids::solid(name).expect("a workload");
        let camera = Some(Camera::Vector([solid.camera[0], solid.camera[1]].concat().try_into().expect("six numbers")));
        for orthographic in [false, true] {
            let options = SolidOptions { setup: Setup { camera, orthographic, ..Setup::default() }, ..SolidOptions::default() };
            let base = kept(&solid.model);
            let began = std::time::Instant::now();
            let there = moved(&base, &[Move { part: which, by: [0.05, 0.03, 0.0] }]);
            let identified = began.elapsed();
            let lines = there.changed(&base, &options).unwrap();
            let compared = began.elapsed() - identified;
            let (patched, drawn) = patched(&base, &there, &options);
            let began = std::time::Instant::now();
            for range in &lines {
                pixels(&there, &options, Some(range.clone()));
            }
            let part = began.elapsed();
            assert!(patched == pixels(&there, &options, None), "{name}");
            let whole = began.elapsed() - part;
            println!(
                "{name}, orthographic {orthographic}: {drawn} lines in {part:.1?} of {whole:.1?}; identified in {identified:.1?}, compared in {compared:.1?}"
            );
            assert!(patched != pixels(&base, &options, None), "{name}: something is seen of it");
            assert!(drawn <= most, "{name}: {drawn} lines");
        }
    }
}

#[test]
fn wrong_moves_are_refused() {
    let base = kept(&colored_model(&mut Random(5), 3));
    let limits = Limits::default();
    let refused = |moves: &[Move]| base.moved(moves, &limits).map(|_| ()).unwrap_err().to_string();
    assert!(refused(&[Move { part: 77, by: [0.0; 3] }]).contains("primitive 78"));
    assert!(refused(&[Move { part: 0, by: [f64::MAX, 0.0, 0.0] }]).contains("too far"));
    assert!(refused(&[Move { part: 0, by: [f64::NAN, 0.0, 0.0] }]).contains("too far"));
    assert!(refused(&[Move { part: 0, by: [0.0; 3] }; 65]).contains("at most 64"));
}
