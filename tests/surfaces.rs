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
use models::{Random, cube, moved, part, prism, random_model, random_view, regular, shifted, tree, view};
use runset::error::{Kind, Warning};
use runset::input::{ModelOptions, Reading, Rendered, read_tree};
use runset::job::{Job, Kept, SolidOptions, evaluate, stl};
use runset::mesh::boolean::surface;
use runset::mesh::check::closed;
use runset::mesh::surface::Surface;
use runset::mesh::{IDENTITY, Mesh, Model, Origin, Part};
use runset::scene::{Area, Formula, Gate, Limits};
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
        // Complements within bounds.
        let parts: Vec<Area> = (0..parts.len() as u32).map(|i| formula.shape(i)).collect();
        let outside = formula.not(area);
        let many = formula.at_least(1 + random.below(parts.len() as u64) as i32, &parts);
        let few = formula.not(many);
        area = match random.below(4) {
            0 => formula.all(&[outside, parts[0]]),
            1 => formula.without(parts[0], &[outside, parts[1]]),
            2 => formula.odd(&[outside, few, parts[0]]),
            _ => {
                let some = formula.at_least(2, &[outside, few, parts[0]]);
                formula.all(&[some, parts[1]])
            }
        };
    }
    (Model { parts, formula, area }, boxes)
}

#[test]
fn volumes_of_boxes_are_sums_of_cells() {
    let mut random = Random(11);
    let (mut empty, mut most) = (0, 0.0_f64);
    for case in 0..400 * effort() {
        let (model, boxes) = random_boxes(&mut random);
        let inside = |x: u64, y: u64, z: u64| {
            holds(&model.formula, model.area, &|i| [x, y, z].iter().zip(boxes[i as usize]).all(|(x, [low, high])| (low..high).contains(x)))
        };
        let cells = (0..SIDE.pow(3)).filter(|i| inside(i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE)).count();
        let turn = DQuat::from_euler(glam::EulerRot::XYZ, random.unit() * 6.0, random.unit() * 6.0, random.unit() * 6.0);
        // Turned, faces that should coincide are askew by rounding: slivers between them as thin as that are left or not.
        for (model, tolerance) in [(&model, 1e-12), (&moved(&model, turn, DVec3::new(1.0, -20.0, 3.0)), 1e-7)] {
            let off = (worked_out(model).volume() - cells as f64).abs();
            assert!(off <= tolerance, "{case}: {off} of {cells}");
            most = most.max(off);
        }
        empty += u64::from(cells == 0);
    }
    println!("off by {most:e} at most");
    assert!(empty > 0);
}

fn two(a: Mesh, b: Part, how: impl Fn(&mut Formula, Area, Area) -> Area) -> Model {
    let mut formula = Formula::default();
    let [first, second] = [0, 1].map(|i| formula.shape(i));
    let area = how(&mut formula, first, second);
    Model { parts: vec![part(a, IDENTITY), b], formula, area }
}

/// The area of a regular polygon.
fn polygon(n: u32, radius: f64) -> f64 {
    f64::from(n) / 2.0 * radius * radius * (2.0 * PI / f64::from(n)).sin()
}

#[test]
fn volumes_are_those_of_formulas() {
    let close = |solid: &Surface, volume: f64| assert!((solid.volume() / volume - 1.0).abs() < 1e-12, "{} and {volume}", solid.volume());
    let unit = || cube([-1.0; 3], [1.0; 3]);
    close(&worked_out(&two(unit(), part(regular(48, 0.5, 3.0), IDENTITY), |f, a, b| f.without(a, &[b]))), 8.0 - 2.0 * polygon(48, 0.5));
    close(&worked_out(&two(unit(), part(regular(48, 0.5, 3.0), IDENTITY), |f, a, b| f.any(&[a, b]))), 8.0 + polygon(48, 0.5));
    let half = || part(unit(), shifted(1.0, 0.0, 0.0));
    close(&worked_out(&two(unit(), half(), |f, a, b| f.any(&[a, b]))), 12.0);
    close(&worked_out(&two(unit(), half(), |f, a, b| f.all(&[a, b]))), 4.0);
    close(&worked_out(&two(unit(), half(), |f, a, b| f.without(a, &[b]))), 4.0);
    close(&worked_out(&two(unit(), half(), |f, a, b| f.odd(&[a, b]))), 8.0);
    close(&worked_out(&solids::solid("menger/2").unwrap().model), 27.0 * (20.0_f64 / 27.0).powi(2));
    // As benches/solids makes it: 14 by 3.5 by 0.5, with a hundred holes.
    let step = 14.0 / 20.0;
    close(&worked_out(&solids::solid("plate/100").unwrap().model), 14.0 * 3.5 * 0.5 - 100.0 * 0.5 * polygon(32, 0.38 * step));
}

#[test]
fn a_surface_is_the_same_each_time() {
    for name in ["engine", "fig316/3"] {
        let model = solids::solid(name).unwrap().model;
        assert_eq!(worked_out(&model), worked_out(&model), "{name}");
    }
}

#[test]
fn parts_that_meet_themselves_count_where_they_wind_around_something() {
    // Two cubes as one mesh: they overlap, and the second is turned inside out in the other case.
    let mut both = cube([0.0; 3], [2.0; 3]);
    let second = cube([1.0; 3], [3.0; 3]);
    both.faces.extend(second.faces.iter().map(|face| runset::mesh::Face::new(vec![face.rings[0].iter().map(|i| i + 8).collect()])));
    both.points.extend(second.points);
    let alone = |mesh: &Mesh| {
        let mut formula = Formula::default();
        let area = formula.shape(0);
        worked_out(&Model { parts: vec![part(mesh.clone(), IDENTITY)], formula, area }).volume()
    };
    assert!((alone(&both) - 15.0).abs() < 1e-12);
    both.faces[6..].iter_mut().for_each(|face| face.rings[0].reverse());
    both.points[8..].iter_mut().for_each(|p| *p = p.map(|x| (x - 1.0) * 0.5 + 1.0));
    assert!((alone(&both) - 7.0).abs() < 1e-12, "the corner that is wound around once and once back");
}

#[test]
fn what_cannot_be_worked_out_says_why() {
    let error = |model: &Model| surface(model, model.area, &mut Vec::new()).unwrap_err();
    let unbounded = two(cube([0.0; 3], [1.0; 3]), part(cube([2.0; 3], [3.0; 3]), IDENTITY), |f, a, b| {
        let not = f.not(a);
        f.any(&[not, b])
    });
    assert_eq!(error(&unbounded).kind, Kind::Refused);
    let mut formula = Formula::default();
    let area = formula.shape(0);
    let n = 1_000_001;
    let many = Model { parts: vec![part(regular(n, 1.0, 1.0), IDENTITY)], formula, area };
    let error = error(&many);
    assert!(error.kind == Kind::Limit && error.what.contains("2000000 triangles"), "{error}");
}

#[test]
fn broken_parts_are_closed_and_said_so() {
    let mut open = cube([0.0; 3], [1.0; 3]);
    open.faces.remove(2);
    let model = two(open, part(cube([0.5; 3], [2.0; 3]), IDENTITY), |f, a, b| f.any(&[a, b]));
    let mut warnings: Vec<Warning> = Vec::new();
    let solid = surface(&model, model.area, &mut warnings).unwrap();
    assert!((solid.volume() - (1.0 + 27.0 / 8.0 - 1.0 / 8.0)).abs() < 1e-12);
    assert_eq!(warnings.len(), 1);
    // Flat parts, and faces that are named twice, there and back.
    let flat = two(prism(&[vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]], 0.0, 0.0), part(cube([0.0; 3], [1.0; 3]), IDENTITY), |f, a, b| {
        f.any(&[a, b])
    });
    assert!((surface(&flat, flat.area, &mut Vec::new()).unwrap().volume() - 1.0).abs() < 1e-12);
}

/// What pixels show: the normal towards the eye, the distance, whose surface.
type Pixel = Option<(DVec3, f64, Origin)>;

fn pixels(stage: &Arc<Stage>) -> Vec<Vec<Pixel>> {
    let mut spans = Spans::new(stage.clone(), 0..stage.view.height, Savings::default());
    let mut rows = Vec::new();
    while let Some((y, line)) = spans.next() {
        let mut row = vec![None; stage.view.width as usize];
        for span in line {
            let face = &stage.faces[span.face as usize];
            let normal = stage.planes[face.plane as usize].normal;
            let toward = if stage.is_toward(face.plane) { normal } else { -normal };
            let origin = Origin { turned: face.origin.turned != span.inside, ..face.origin };
            for x in span.start..span.end {
                let near = stage.depths[face.plane as usize].at(x, y);
                row[x as usize] = Some((toward, stage.view.distance(near, stage.farthest), origin));
            }
        }
        rows.push(row);
    }
    rows
}

/// Two pixels show the same surface.
fn alike(a: &Pixel, b: &Pixel) -> bool {
    match (a, b) {
        (None, None) => true,
        (Some((n, d, _)), Some((m, e, _))) => n.dot(*m) > 1.0 - 1e-6 && (d - e).abs() < 1e-6 * d.max(1.0),
        _ => false,
    }
}

/// Pixels that are not alike, those within a pixel of an outline left aside: there the neighbours of the first picture differ in normal or in whether they show anything, or
/// are farther away by more than the plane of the pixel leads to expect. Those whose origins differ are counted as well.
fn different(first: &[Vec<Pixel>], second: &[Vec<Pixel>]) -> (usize, usize) {
    let normal = |p: &Pixel| p.map(|p| p.0);
    let (mut wrong, mut origins) = (0, 0);
    for y in 1..first.len() - 1 {
        for x in 1..first[0].len() - 1 {
            let here = &first[y][x];
            let around = (y - 1..=y + 1).flat_map(|j| (x - 1..=x + 1).map(move |i| (i, j)));
            let inner = around.clone().all(|(i, j)| match (normal(here), normal(&first[j][i])) {
                (None, None) => true,
                (Some(a), Some(b)) => a.dot(b) > 1.0 - 1e-6 && first[j][i].unwrap().2 == here.unwrap().2,
                _ => false,
            });
            // Of one surface distances grow evenly.
            let even = inner
                && here.is_none_or(|(_, d, _)| {
                    let of = |i: usize, j: usize| first[j][i].unwrap().1;
                    [(1, 0), (0, 1)].iter().all(|&(i, j)| (of(x - i, y - j) + of(x + i, y + j) - 2.0 * d).abs() < 1e-2 * d)
                });
            if even {
                wrong += usize::from(!alike(here, &second[y][x]));
                origins += usize::from(here.map(|p| p.2) != second[y][x].map(|p| p.2));
            }
        }
    }
    (wrong, origins)
}

fn whole(model: &Model) -> Model {
    let place = runset::error::Place { line: 1, column: 1 };
    let mut reading = Reading { model: model.clone(), tree: Vec::new(), rendered: vec![Rendered { area: model.area, place }] };
    evaluate(&mut reading, &mut Vec::new()).unwrap();
    reading.model
}

#[test]
fn random_models_look_the_same_worked_out() {
    let mut random = Random(5);
    let mut seen = 0;
    for case in 0..150 * effort() {
        let model = random_model(&mut random, 8);
        let again = whole(&model);
        let view = random_view(&mut random, 48);
        let [first, second] = [&model, &again].map(|model| pixels(&stage(model, view, &[])));
        let (wrong, _) = different(&first, &second);
        assert_eq!(wrong, 0, "{case}");
        seen += first.iter().flatten().flatten().count();
    }
    assert!(seen > 1000, "{seen}");
}

#[test]
fn workloads_look_the_same_worked_out_and_have_their_colours() {
    for name in ["menger/2", "plate/100", "engine", "fig316/3", "fig414/2", "blowup/10"] {
        let solids::Solid { model, camera: [eye, target], .. } = solids::solid(name).unwrap();
        let again = whole(&model);
        let view = view(300, 300, DVec3::from_array(eye), DVec3::from_array(target), Projection::Perspective { focal: 500.0, near: 0.05 });
        let [first, second] = [&model, &again].map(|model| pixels(&stage(model, view, &[])));
        let kept = [&model, &again].map(|model| Kept::new(model, &Limits::default(), &mut Vec::new()).unwrap());
        println!("{name}: {} parts with {} faces become {} with {}", kept[0].parts(), kept[0].faces(), kept[1].parts(), kept[1].faces());
        assert_eq!(different(&first, &second), (0, 0), "{name}");
        assert_eq!(kept[1].parts(), 1);
        assert!(kept[1].faces() <= kept[0].faces(), "{name}");
    }
}

const NESTED: &str = "
difference() {
    render(convexity = 2) {
        difference() {
            color([1, 0, 0, 1]) cube(size = [4, 4, 4], center = true);
            render() { union() { color([0, 1, 0, 1]) cube(size = [2, 2, 9], center = true); cube(size = [9, 1, 1], center = true); } }
        }
    }
    color([0, 0, 1, 1]) multmatrix([[1, 0, 0, 2], [0, 1, 0, -2], [0, 0, 1, 2], [0, 0, 0, 1]]) cube(size = [2, 2, 2], center = true);
}";

#[test]
fn render_is_worked_out_from_the_inside_to_the_outside() {
    let mut reading = read_tree(NESTED.as_bytes(), &ModelOptions::default(), &mut Vec::new()).unwrap();
    assert_eq!(reading.rendered.iter().map(|r| r.place.line).collect::<Vec<_>>(), [6, 3]);
    let before = reading.model.clone();
    evaluate(&mut reading, &mut Vec::new()).unwrap();
    // The blue cube and the outer node have surfaces; what the outer took up is gone.
    let left: Vec<_> = reading.model.parts.iter().filter(|p| !p.mesh.faces.is_empty()).map(|p| p.kind).collect();
    assert_eq!(left, ["cube", "render"]);
    let setup = Setup { camera: Some(Camera::Vector([9.0, -14.0, 8.0, 0.0, 0.0, 0.0])), width: 200, height: 200, ..Setup::default() };
    let sections = [vec![], vec![runset::solid::body::Plane { normal: DVec3::Z, offset: 0.9 }]];
    for sections in sections {
        let [first, second] = [&before, &reading.model].map(|model| {
            let kept = Kept::new(model, &Limits::default(), &mut Vec::new()).unwrap();
            let job = Job::solid(&kept, &SolidOptions { setup, sections: sections.clone(), ..SolidOptions::default() }).unwrap();
            let mut bytes = Vec::new();
            let ppm = runset::encode::by_name("ppm").unwrap();
            job.render(ppm, 1, &mut bytes, &mut |_| {}).unwrap();
            bytes
        });
        let other = first.chunks(3).zip(second.chunks(3)).filter(|(a, b)| a != b).count();
        assert!(first.len() == second.len() && other < 40, "{other}");
    }
    // By hand: 64 - (16 + 4 - 2) - what the corner takes, 1 of it where the hole is not: the hole ends at 1.
    assert!((worked_out(&before).volume() - (64.0 - 18.0 - 1.0)).abs() < 1e-12);
}

#[test]
fn an_empty_model_has_no_stl() {
    let model = two(cube([0.0; 3], [1.0; 3]), part(cube([0.0; 3], [1.0; 3]), IDENTITY), |f, a, b| f.without(a, &[b]));
    assert!(stl(&model, &mut Vec::new()).unwrap_err().what.contains("empty"));
    // So small that 32 bits hold none of it.
    let tiny = two(cube([0.0; 3], [1e-60; 3]), part(cube([0.0; 3], [1e-60; 3]), IDENTITY), |f, a, b| f.any(&[a, b]));
    assert!(stl(&tiny, &mut Vec::new()).unwrap_err().what.contains("empty"));
}

#[test]
fn any_triangles_make_a_closed_surface_or_an_error() {
    let mut random = Random(77);
    let (mut made, mut refused) = (0, 0);
    for case in 0..300 * effort() {
        let n = 3 + random.below(6);
        let snapped = random.below(2) == 0;
        let number = |random: &mut Random| if snapped { random.below(3) as f64 } else { random.unit() * 3.0 };
        let points: Vec<[f64; 3]> = (0..n).map(|_| [0; 3].map(|_| number(&mut random))).collect();
        let faces = (0..1 + random.below(12)).map(|_| runset::mesh::Face::new(vec![[0; 3].map(|_| random.below(n) as u32).to_vec()]));
        let mesh = Mesh { points, faces: faces.collect() };
        let model = two(mesh, part(cube([0.5; 3], [2.0; 3]), IDENTITY), |f, a, b| {
            let either = f.odd(&[a, b]);
            f.any(&[either, a])
        });
        match surface(&model, model.area, &mut Vec::new()) {
            Ok(solid) => {
                made += 1;
                let checked = closed(&part(triangles(&solid), IDENTITY));
                assert_eq!((checked.open_edges, checked.inside_out), (0, false), "{case}");
            }
            Err(error) => {
                refused += 1;
                assert_eq!(error.kind, Kind::Refused, "{case}: {error}");
            }
        }
    }
    println!("{made} made, {refused} refused");
    assert!(made > refused);
}
