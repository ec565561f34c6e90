//! Pictures of models against the true ones, which `tests/exact` finds in integers from the geometry, not from the engine's edges.

#![allow(clippy::unwrap_used)] // all of this is tests

mod exact;
mod models;
#[path = "../benches/solids/mod.rs"]
#[allow(dead_code)] // benches use the rest
mod solids;

use exact::cells::{Entered, enters};
use exact::{Camera, Convex, Hit, Ray, Turn, first};
use glam::DVec3;
use models::drawn::{Seen, drawn, stage};
use models::{Random, cube, part};
use runset::mesh::{Mesh, Model};
use runset::scene::{Area, Formula};
use runset::solid::savings::Savings;
use runset::solid::stage::Stage;

fn effort() -> u64 {
    std::env::var("RUNSET_EFFORT").ok().and_then(|n| n.parse().ok()).unwrap_or(1)
}

/// A tree over parts.
#[derive(Clone, Debug)]
enum Tree {
    Part(usize),
    Any(Vec<Tree>),
    All(Vec<Tree>),
    /// The first without the others.
    Without(Vec<Tree>),
}

impl Tree {
    /// Straight from the definition.
    fn holds(&self, inside: &[bool]) -> bool {
        match self {
            Tree::Part(i) => inside[*i],
            Tree::Any(all) => all.iter().any(|tree| tree.holds(inside)),
            Tree::All(all) => all.iter().all(|tree| tree.holds(inside)),
            Tree::Without(all) => all[0].holds(inside) && !all[1..].iter().any(|tree| tree.holds(inside)),
        }
    }

    fn area(&self, formula: &mut Formula) -> Area {
        let mut areas = |all: &[Tree]| all.iter().map(|tree| tree.area(formula)).collect::<Vec<_>>();
        match self {
            Tree::Part(i) => formula.shape(*i as u32),
            Tree::Any(all) => {
                let areas = areas(all);
                formula.any(&areas)
            }
            Tree::All(all) => {
                let areas = areas(all);
                formula.all(&areas)
            }
            Tree::Without(all) => {
                let areas = areas(all);
                formula.without(areas[0], &areas[1..])
            }
        }
    }

    /// A tree that names each of the parts once.
    fn random(random: &mut Random, parts: usize) -> Tree {
        let mut trees: Vec<Tree> = (0..parts).map(Tree::Part).collect();
        while trees.len() > 1 {
            let n = (2 + random.below(2) as usize).min(trees.len());
            let inputs = (0..n).map(|_| trees.swap_remove(random.below(trees.len() as u64) as usize)).collect();
            trees.push([Tree::Any, Tree::Any, Tree::Without, Tree::Without, Tree::All][random.below(5) as usize](inputs));
        }
        trees.remove(0)
    }
}

/// What was compared.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    pixels: u64,
    shown: u64,
    /// Pixels with an outline through their centres, which show what is right of it or below.
    ruled: u64,
    /// Others that show what a ray within 2^-17 px of their centre meets, but not the one through it.
    beside: u64,
    wrong: u64,
}

impl Tally {
    fn add(&mut self, other: Tally) {
        self.pixels += other.pixels;
        self.shown += other.shown;
        self.ruled += other.ruled;
        self.beside += other.beside;
    }
}

/// What the engine is held against: whether what it shows in a pixel is what a ray meets.
trait Truth {
    fn fits(&self, stage: &Stage, x: u32, y: u32, seen: Seen, ray: &Ray) -> bool;
}

/// Parts and their tree, turned.
struct Scene<'a> {
    parts: &'a [Convex],
    tree: &'a Tree,
    turn: Turn,
}

impl Truth for Scene<'_> {
    fn fits(&self, stage: &Stage, _: u32, _: u32, seen: Seen, ray: &Ray) -> bool {
        match (seen, first(self.parts, &|inside| self.tree.holds(inside), ray)) {
            (None, None) => true,
            (Some((part, face, near)), Some(Hit { t, faces })) => {
                let normal = stage.planes[stage.faces[face as usize].plane as usize].normal;
                let same = |&(i, face): &(usize, usize)| {
                    i == part as usize && 1.0 - self.parts[i].normal(&self.turn, face).dot(normal).abs() < 1e-9
                };
                let z = t.value() * ray.unit;
                faces.iter().any(same) && (stage.view.distance(near, stage.farthest) - z).abs() < 1e-2 * z
            }
            _ => false,
        }
    }
}

fn compare(truth: &dyn Truth, model: &Model, turn: &Turn, camera: &Camera) -> Tally {
    let stage = stage(model, camera.view(), &[]);
    let mut tally = Tally::default();
    for (y, line) in (0..).zip(drawn(&stage, 0..camera.size[1], Savings::default())) {
        for (x, seen) in (0..).zip(line) {
            let fits = |beside| truth.fits(&stage, x, y, seen, &camera.ray(turn, [x, y], beside));
            tally.pixels += 1;
            tally.shown += u64::from(seen.is_some());
            if fits([0, 0]) {
                continue;
            }
            let around = (0..9).map(|i| [2 * (i % 3 - 1), 2 * (i / 3 - 1)]);
            if fits([2, 1]) {
                tally.ruled += 1;
            } else if around.into_iter().any(fits) {
                tally.beside += 1;
            } else {
                tally.wrong += 1;
                eprintln!("pixel {x} {y}: {seen:?}");
            }
        }
    }
    tally
}

/// The engine's model of turned parts.
fn model(parts: &[Convex], tree: &Tree, turn: &Turn) -> Model {
    let parts = parts.iter().map(|convex| part(convex.turned(turn), runset::mesh::IDENTITY)).collect();
    let mut formula = Formula::default();
    let area = tree.area(&mut formula);
    Model { parts, formula, area }
}

fn cuboid(least: [i32; 3], most: [i32; 3]) -> Convex {
    Convex::new(cube(least.map(f64::from), most.map(f64::from)))
}

fn tetrahedron(size: f64, shift: [f64; 3]) -> Convex {
    let Mesh { points, faces } = models::tetrahedron();
    let points = points.into_iter().map(|p| [0, 1, 2].map(|i| p[i] * size + shift[i])).collect();
    Convex::new(Mesh { points, faces })
}

/// Parts that touch and coincide; units are half of what the boxes were drawn with.
fn scenes() -> Vec<(&'static str, Vec<Convex>, Tree)> {
    use Tree::{Any, Part, Without};
    let unit = cuboid([-2; 3], [2; 3]);
    let half = cuboid([0, -2, -2], [4, 2, 2]);
    let beside = cuboid([2, -2, -2], [6, 2, 2]);
    let rod = cuboid([-1, -2, -1], [5, 2, 1]);
    let both = || Any(vec![Part(0), Part(1)]);
    vec![
        ("without itself", vec![unit.clone(), unit.clone()], Without(vec![Part(0), Part(1)])),
        ("half without", vec![unit.clone(), half.clone()], Without(vec![Part(0), Part(1)])),
        ("half with", vec![unit.clone(), half.clone()], both()),
        ("side by side", vec![unit.clone(), beside.clone()], both()),
        ("side by side, without a rod", vec![unit.clone(), beside.clone(), rod], Without(vec![both(), Part(2)])),
        (
            "filled again",
            vec![unit.clone(), beside, half, cuboid([-2, 0, 0], [6, 2, 2])],
            Any(vec![Without(vec![both(), Part(2)]), Part(3)]),
        ),
        ("a tetrahedron of its corners", vec![unit, tetrahedron(2.0, [0.0; 3])], Without(vec![Part(0), Part(1)])),
    ]
}

fn random_turn(random: &mut Random) -> Turn {
    Turn::new([0; 4].map(|_| i128::from(random.below(1 << 15)) - (1 << 14)))
}

/// In both projections; 16 units are about as high as the page.
fn cameras(size: u32) -> [Camera; 2] {
    let camera = Camera { size: [size; 2], eye: [1, -27, 1], pixels: i128::from(size) / 16, perspective: false };
    [camera, Camera { pixels: i128::from(size) * 3 / 2, perspective: true, ..camera }]
}

#[test]
fn boxes_that_coincide_are_shown_as_they_are() {
    let mut random = Random(7);
    let mut turned = Tally::default();
    for i in 0..6 * effort() {
        let turn = if i == 0 { Turn::new([1, 0, 0, 0]) } else { random_turn(&mut random) };
        let size = if i % 12 == 5 { 2048 } else { 512 };
        // The large ones only where there is time for them.
        let size = if effort() < 10 { size / 2 } else { size };
        for (name, parts, tree) in scenes() {
            for camera in cameras(size) {
                let scene = Scene { parts: &parts, tree: &tree, turn };
                let tally = compare(&scene, &model(&parts, &tree, &turn), &turn, &camera);
                assert_eq!(tally.wrong, 0, "{name}, turn {i}, {camera:?}");
                assert_eq!(tally.shown > 1000, name != "without itself", "{name}, turn {i}, {camera:?}");
                if i > 0 {
                    turned.add(tally);
                } else {
                    // Whole outlines may lie on centres.
                    assert_eq!(tally.beside, 0, "{name}: {tally:?}");
                }
            }
        }
    }
    println!("turned: {turned:?}");
    assert!(turned.ruled + turned.beside <= 4 + turned.shown / 1_000_000, "{turned:?}");
}

/// Boxes and tetrahedra on a grid of few lines, so that most touch or coincide with some.
#[test]
fn random_trees_are_shown_as_they_are() {
    let mut random = Random(23);
    let mut all = Tally::default();
    for round in 0..30 * effort() {
        let parts: Vec<Convex> = (0..2 + random.below(7))
            .map(|_| {
                let mut low = || [0; 3].map(|_: i32| random.below(4) as i32 * 2 - 4);
                let (a, b) = (low(), low());
                if random.below(4) == 0 {
                    return tetrahedron(f64::from(1 + random.below(3) as i32), a.map(f64::from));
                }
                cuboid([0, 1, 2].map(|i| a[i].min(b[i])), [0, 1, 2].map(|i| a[i].max(b[i]) + if a[i] == b[i] { 2 } else { 0 }))
            })
            .collect();
        let tree = Tree::random(&mut random, parts.len());
        let turn = random_turn(&mut random);
        let camera = cameras(192)[round as usize % 2];
        let tally = compare(&Scene { parts: &parts, tree: &tree, turn }, &model(&parts, &tree, &turn), &turn, &camera);
        assert_eq!(tally.wrong, 0, "round {round}: {tree:?}");
        all.add(tally);
    }
    println!("{all:?}");
    assert!(all.shown * 20 > all.pixels && all.ruled + all.beside <= 4, "{all:?}");
}

/// Menger's sponge of 27 cells an axis: a cell is not there where two of its three coordinates have a 1 at the same place, written to base 3.
struct Sponge {
    turn: Turn,
}

fn is_solid(cell: [i128; 3]) -> bool {
    [1, 3, 9].iter().all(|place| cell.iter().filter(|k| *k / place % 3 == 1).count() < 2)
}

impl Truth for Sponge {
    fn fits(&self, stage: &Stage, _: u32, _: u32, seen: Seen, ray: &Ray) -> bool {
        match (seen, enters(27, &is_solid, ray)) {
            (None, None) => true,
            (Some((part, face, near)), Some(Entered { t, planes })) => {
                let normal = stage.planes[stage.faces[face as usize].plane as usize].normal;
                // Only the cube, which is the first part, has outer sides; the others are holes.
                let same = |&(axis, k): &(usize, i128)| {
                    let of_axis = DVec3::from(self.turn.rounded([0, 1, 2].map(|i| i128::from(i == axis))));
                    1.0 - of_axis.dot(normal).abs() < 1e-9 && (part == 0) == (k == 0 || k == 27)
                };
                let z = t.value() * ray.unit;
                planes.iter().any(same) && (stage.view.distance(near, stage.farthest) - z).abs() < 1e-2 * z
            }
            _ => false,
        }
    }
}

/// 220 parts, whose thirds are no doubles: nearly all faces coincide with others but for rounding.
#[test]
fn a_sponge_has_no_speckle() {
    let solid = solids::solid("menger/3").unwrap();
    let mut random = Random(5);
    let views = [
        // Along an axis: cells are 16 px wide, their sides between pixels or right through centres.
        (Turn::new([1, 0, 0, 0]), Camera { size: [512; 2], eye: [0, -100, 0], pixels: 8, perspective: false }),
        (Turn::new([1, 0, 0, 0]), Camera { size: [513; 2], eye: [0, -100, 0], pixels: 8, perspective: false }),
        (Turn::new([1, 0, 0, 0]), Camera { size: [512; 2], eye: [0, -100, 0], pixels: 500, perspective: true }),
        (Turn::new([1, 0, 0, 0]), Camera { size: [512; 2], eye: [3, -60, 2], pixels: 300, perspective: true }),
        (random_turn(&mut random), Camera { size: [512; 2], eye: [1, -120, 2], pixels: 700, perspective: true }),
        (random_turn(&mut random), Camera { size: [512; 2], eye: [1, -120, 2], pixels: 6, perspective: false }),
    ];
    let more = (6..6 * effort()).map(|i| {
        let pixels = if i % 2 == 0 { 700 } else { 6 };
        (random_turn(&mut random), Camera { size: [512; 2], eye: [1, -120, 2], pixels, perspective: i % 2 == 0 })
    });
    for (i, (turn, camera)) in views.into_iter().chain(more.collect::<Vec<_>>()).enumerate() {
        // Cells are 2 wide here, 1/9 there.
        let mut model = solid.model.clone();
        for part in &mut model.parts {
            let m = part.matrix;
            let row = |i: usize, j: usize| (0..3).map(|k| turn.m[i][k] as f64 / turn.n as f64 * 18.0 * m[k][j]).sum::<f64>();
            part.matrix = [0, 1, 2].map(|i| [0, 1, 2, 3].map(|j| row(i, j)));
        }
        let tally = compare(&Sponge { turn }, &model, &turn, &camera);
        println!("{camera:?}: {tally:?}");
        assert_eq!(tally.wrong, 0, "view {i}");
        assert!(tally.shown * 4 > tally.pixels && tally.beside + if i < 4 { 0 } else { tally.ruled } <= 2, "view {i}: {tally:?}");
    }
}

/// The truth is not blind: a part that is a 64th of a unit away is seen to be.
#[test]
fn what_is_moved_is_noticed() {
    let turn = random_turn(&mut Random(3));
    let (_, parts, tree) = scenes().swap_remove(3);
    for camera in cameras(256) {
        let mut model = model(&parts, &tree, &turn);
        model.parts[1].matrix[0][3] += 1.0 / 64.0;
        let scene = Scene { parts: &parts, tree: &tree, turn };
        let stage = stage(&model, camera.view(), &[]);
        let lines = drawn(&stage, 0..256, Savings::default());
        let wrong = (0..256)
            .flat_map(|y| (0..256).map(move |x| [x, y]))
            .filter(|&[x, y]| !scene.fits(&stage, x, y, lines[y as usize][x as usize], &camera.ray(&turn, [x, y], [0, 0])));
        assert!(wrong.count() > 0, "{camera:?}");
    }
}
