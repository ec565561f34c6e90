//! The solid workloads: the experiments of the dissertation's chapters 3 and 4 ("CSG" in ARCHITECTURE.md), and larger ones. Each is a model, and the
//! `.csg` that describes it.
//!
//! | name | what | parts |
//! |---|---|---|
//! | fig313/N/diff, union | two prisms of N sides that cross | 2 |
//! | fig316/1 to 3 | a tetrahedron, a sphere and a cube, 772 faces in all: A+B+C, A+(B-C), (A-C)+(B-C) | 3 |
//! | fig47/N/K | a ring of eight prisms of N sides, the first K without the one in the middle; K = 0: all nine | 9 |
//! | fig414/1 to 4 | a box and four prisms, longer from case to case, within an ellipsoid | 6 |
//! | fig46/half, zero, skew | a cube minus the same cube moved by half, by nothing, by half and both turned | 2 |
//! | menger/D | a cube minus square holes along three axes | 28, 220, 1756 at D = 2, 3, 4 |
//! | plate/N | a plate minus N prisms of 32 sides | N + 1 |
//! | engine | a block of four cylinders: nested unions, differences, an intersection | 63 |
//! | blowup/N | a box minus N intersections: 2^N products | 2 N + 1 |
//! | bigmesh/N | a sphere of about N triangles minus another | 2 |
//!
//! Proportions are a reading of the text, which gives counts alone.

mod make;

use std::f64::consts::PI;

use make::{Scene, Tree, all, block, cuboid, difference, intersection, mesh, moved, prism, scaled, sphere, turned, union};
use runset::mesh::{IDENTITY, Model, Point};

/// A workload.
pub struct Solid {
    /// The model.
    pub model: Model,
    /// The same as OpenSCAD's `.csg`.
    pub csg: String,
    /// Where it is looked at from, and the point looked at.
    pub camera: [Point; 2],
}

/// Names of the workloads that are quickly made.
pub fn names() -> Vec<String> {
    let mut names = Vec::new();
    for n in [3, 4, 6, 10, 20, 32, 50, 75, 100] {
        names.extend(["diff", "union"].map(|op| format!("fig313/{n}/{op}")));
    }
    names.extend((1..=3).map(|data| format!("fig316/{data}")));
    for n in [10, 20, 32, 50, 75, 100] {
        let cut: &[u32] = if n == 32 { &[0, 1, 2, 3, 4, 5, 6, 7, 8] } else { &[0, 4, 8] };
        names.extend(cut.iter().map(|k| format!("fig47/{n}/{k}")));
    }
    names.extend((1..=4).map(|case| format!("fig414/{case}")));
    names.extend(["half", "zero", "skew"].map(|shift| format!("fig46/{shift}")));
    names.extend((1..=3).map(|depth| format!("menger/{depth}")));
    names.extend([100, 1000].map(|holes| format!("plate/{holes}")));
    names.push("engine".to_owned());
    names.extend([4, 8, 10, 12, 20, 50, 200].map(|n| format!("blowup/{n}")));
    names
}

/// The workload of that name, also one that [`names`] leaves out for its size: `fig313/10000/diff`, `menger/4`, `bigmesh/1000000`.
pub fn solid(name: &str) -> Option<Solid> {
    let words: Vec<&str> = name.split('/').collect();
    let whole = |i: usize| words.get(i)?.parse::<u32>().ok();
    Some(match *words.first()? {
        "fig313" => crossing(whole(1)?, *words.get(2)? == "diff"),
        "fig316" => three(whole(1)?),
        "fig47" => ring(whole(1)?, whole(2)? as usize),
        "fig414" => within_ellipsoid(whole(1)? as usize),
        "fig46" => coplanar(words.get(1)?),
        "menger" => menger(whole(1)?),
        "plate" => plate(whole(1)?),
        "engine" => engine(),
        "blowup" => blowup(whole(1)?),
        "bigmesh" => big_mesh(whole(1)?),
        _ => return None,
    })
}

fn crossing(n: u32, without: bool) -> Solid {
    let mut scene = Scene::default();
    let a = scene.part(&prism(n, 1.0, 3.0, 0.0), IDENTITY);
    let b = scene.part(&prism(n, 0.7, 4.0, 0.5), turned(1, 90.0));
    let tree = if without { difference(a, vec![b]) } else { union(vec![a, b]) };
    scene.done(&tree, [5.0, -9.0, 5.0])
}

fn three(data: u32) -> Solid {
    let mut scene = Scene::default();
    let points = vec![[1.15, 1.15, 1.15], [1.15, -1.15, -1.15], [-1.15, 1.15, -1.15], [-1.15, -1.15, 1.15]];
    let tetrahedron = mesh(points, vec![vec![0, 1, 2], vec![0, 3, 1], vec![0, 2, 3], vec![1, 3, 2]]);
    let a = scene.part(&tetrahedron, all([moved(-0.55, -0.2, 0.0), turned(2, 20.0)]));
    let b = scene.part(&sphere(1.1, 36, 21, false), moved(0.55, 0.1, 0.1));
    let cube = cuboid([-0.8; 3], [0.8; 3], true);
    let c = scene.part(&cube, all([moved(0.15, -0.75, 0.55), turned(2, 30.0), turned(0, 15.0)]));
    let tree = match data {
        1 => union(vec![a, b, c]),
        2 => union(vec![a, difference(b, vec![c])]),
        _ => union(vec![difference(a, vec![Tree::Part(2)]), difference(b, vec![c])]),
    };
    scene.done(&tree, [6.0, -10.0, 6.0])
}

fn ring(n: u32, cut: usize) -> Solid {
    let mut scene = Scene::default();
    let around = prism(n, 0.55, 2.0, 0.0);
    let angle = |i: u32| PI * f64::from(i) / 4.0;
    let mut ring: Vec<Tree> = (0..8).map(|i| scene.part(&around, moved(1.35 * angle(i).cos(), 1.35 * angle(i).sin(), 0.0))).collect();
    scene.part(&prism(n, 1.1, 2.6, 0.5), IDENTITY);
    let rest = ring.split_off(cut);
    let mut operands: Vec<Tree> = ring.into_iter().map(|prism| difference(prism, vec![Tree::Part(8)])).collect();
    operands.extend(rest);
    if cut == 0 {
        operands.push(Tree::Part(8));
    }
    scene.done(&union(operands), [4.5, -9.0, 8.0])
}

fn within_ellipsoid(case: usize) -> Solid {
    let length = [1.2, 1.8, 2.4, 3.0][case.clamp(1, 4) - 1];
    let mut scene = Scene::default();
    let mut operands = vec![scene.part(&block(1.0, 0.8, 0.6), IDENTITY)];
    let pin = prism(32, 0.28, length, 0.0);
    for [y, z] in [[-0.4, -0.3], [0.4, -0.3], [-0.4, 0.3], [0.4, 0.3]] {
        operands.push(scene.part(&pin, all([moved((length - 1.2) / 2.0, y, z), turned(1, 90.0)])));
    }
    let ellipsoid = scene.part(&sphere(1.0, 32, 16, false), scaled(1.35, 1.0, 0.8));
    scene.done(&intersection(vec![union(operands), ellipsoid]), [5.0, -9.0, 5.0])
}

fn coplanar(shift: &str) -> Solid {
    let mut scene = Scene::default();
    let place = if shift == "skew" { all([turned(2, 37.1), turned(0, 11.3), turned(1, 23.7)]) } else { IDENTITY };
    let cube = block(1.0, 1.0, 1.0);
    let a = scene.part(&cube, place);
    let b = scene.part(&cube, all([place, moved(if shift == "zero" { 0.0 } else { 1.0 }, 0.0, 0.0)]));
    scene.done(&difference(a, vec![b]), [5.0, -9.0, 5.0])
}

fn menger(depth: u32) -> Solid {
    let mut scene = Scene::default();
    let cube = scene.colored(&block(1.5, 1.5, 1.5), IDENTITY, 1);
    // Squares yet to be parted, the next one last.
    let (mut open, mut holes) = (vec![(-1.5, -1.5, 3.0, depth)], Vec::new());
    while let Some((x, y, side, depth)) = open.pop() {
        if depth == 0 {
            continue;
        }
        let third = side / 3.0;
        holes.push((x + third, y + third, third));
        for i in (0..9_u32).rev().filter(|i| *i != 4) {
            open.push((x + f64::from(i / 3) * third, y + f64::from(i % 3) * third, third, depth - 1));
        }
    }
    let unit = cuboid([0.0; 3], [1.0; 3], false);
    let mut others = Vec::new();
    for (x, y, side) in holes {
        for axis in [IDENTITY, turned(0, 90.0), turned(1, 90.0)] {
            others.push(scene.colored(&unit, all([axis, moved(x, y, -1.6), scaled(side, side, 3.2)]), 3));
        }
    }
    scene.done(&difference(cube, others), [4.2, -7.0, 4.4])
}

fn plate(holes: u32) -> Solid {
    let [nx, ny] = if holes > 100 { [50, 20] } else { [20, 5] };
    let (width, height) = (14.0, 14.0 * f64::from(ny) / f64::from(nx));
    let step = width / f64::from(nx);
    let mut scene = Scene::default();
    let plate = scene.colored(&block(width / 2.0, height / 2.0, 0.25), IDENTITY, 1);
    let hole = prism(32, 0.38 * step, 0.8, 0.0);
    let mut others = Vec::new();
    for i in 0..nx {
        for j in 0..ny {
            let [x, y] = [-width / 2.0 + (f64::from(i) + 0.5) * step, -height / 2.0 + (f64::from(j) + 0.5) * step];
            others.push(scene.colored(&hole, moved(x, y, 0.0), 3));
        }
    }
    scene.done(&difference(plate, others), [10.0, -34.0, 30.0])
}

fn engine() -> Solid {
    let mut scene = Scene::default();
    let cylinders = [-6.6, -2.2, 2.2, 6.6];
    let ribs = [-8.8, -4.4, 0.0, 4.4, 8.8];
    let lying = |x: f64, y: f64, z: f64| all([moved(x, y, z), turned(0, 90.0)]);
    let mut body = vec![
        scene.colored(&block(9.0, 3.0, 3.0), IDENTITY, 8),
        scene.colored(&cuboid([-9.6, -3.6, 2.0], [9.6, 3.6, 3.0], false), IDENTITY, 8),
    ];
    body.extend(cylinders.map(|x| scene.colored(&prism(48, 1.9, 3.2, 0.0), moved(x, 0.0, -2.9), 8)));
    body.extend(ribs.map(|x| scene.colored(&cuboid([-0.35, -3.5, -3.8], [0.35, 3.5, 0.0], false), moved(x, 0.0, 0.0), 8)));
    let mut cuts: Vec<Tree> = cylinders.map(|x| scene.colored(&prism(64, 1.7, 8.0, 0.0), moved(x, 0.0, 1.2), 0)).into();
    cuts.push(scene.colored(&prism(48, 1.0, 30.0, 0.0), all([moved(0.0, 0.0, -3.2), turned(1, 90.0)]), 1));
    for x in ribs {
        cuts.extend([-3.0, 3.0].map(|y| scene.colored(&prism(24, 0.28, 3.0, 0.0), moved(x, y, 3.0), 3)));
    }
    for x in cylinders {
        let outer = scene.colored(&prism(64, 2.15, 2.6, 0.0), moved(x, 0.0, 2.2), 2);
        let inner = scene.colored(&prism(64, 1.9, 3.2, 0.0), moved(x, 0.0, 2.2), 8);
        cuts.push(difference(outer, vec![inner]));
    }
    let oil = [-8.0, -6.6, -5.0, -3.6, -2.2, -0.8, 0.8, 2.2, 3.6, 5.0, 6.6, 8.0];
    cuts.extend(oil.map(|x| scene.colored(&prism(16, 0.18, 9.0, 0.0), lying(x, 0.0, -1.2), 4)));
    let ports = [-7.4, -5.8, -3.0, -1.4, 1.4, 3.0, 5.8, 7.4];
    cuts.extend(ports.map(|x| scene.colored(&prism(32, 0.55, 4.0, 0.0), lying(x, -2.9, 0.8), 5)));
    let mut whole = Vec::new();
    for x in [-5.5, 5.5] {
        for side in [-1.0, 1.0] {
            let place = lying(x, side * 3.6, -2.2);
            let outer = scene.colored(&prism(32, 0.9, 1.0, 0.0), place, 6);
            whole.push(difference(outer, vec![scene.colored(&prism(24, 0.45, 3.0, 0.0), place, 6)]));
        }
    }
    let trim = scene.colored(&block(10.0, 4.2, 4.2), turned(0, 4.0), 8);
    whole.insert(0, difference(union(body), cuts));
    scene.done(&intersection(vec![union(whole), trim]), [30.0, -42.0, 30.0])
}

fn blowup(n: u32) -> Solid {
    let mut scene = Scene::default();
    let plate = scene.colored(&block(10.0, 10.0, 3.0), IDENTITY, 1);
    let columns = f64::from(n).sqrt().ceil() as u32;
    let step = 18.0 / f64::from(columns);
    let (pin, ball) = (prism(16, 0.42 * step, 8.0, 0.0), sphere(0.55 * step, 16, 8, false));
    let mut others = Vec::new();
    for i in 0..n {
        let [x, y] = [i % columns, i / columns].map(|k| -9.0 + (f64::from(k) + 0.5) * step);
        let both = vec![scene.colored(&ball, moved(x, y, 3.0), 0), scene.colored(&pin, moved(x, y, 0.0), 3)];
        others.push(intersection(both));
    }
    scene.done(&difference(plate, others), [45.0, -60.0, 55.0])
}

fn big_mesh(triangles: u32) -> Solid {
    let around = f64::from(triangles).sqrt() as u32;
    let bands = around / 2 + 1;
    let mut scene = Scene::default();
    let a = scene.part(&sphere(1.2, around, bands, true), IDENTITY);
    let b = scene.part(&sphere(0.9, around, bands, true), all([moved(0.7, -0.7, 0.7), turned(0, 30.0), turned(1, 20.0)]));
    scene.done(&difference(a, vec![b]), [4.0, -7.0, 4.0])
}
