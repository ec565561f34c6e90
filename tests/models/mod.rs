//! Models for tests: meshes, random trees of them, views.
#![allow(dead_code, reason = "each test uses some of it")]

pub mod drawn;
pub mod jobs;

use std::sync::Arc;

use glam::{DQuat, DVec3};
use runset::mesh::{Face, Matrix, Mesh, Model, Part};
use runset::scene::{Area, Formula};
use runset::solid::view::{Projection, View};

/// A small linear congruential generator: tests only need variety.
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }

    pub fn unit(&mut self) -> f64 {
        self.below(1 << 30) as f64 / f64::from(1 << 30)
    }

    pub fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len() as u64) as usize]
    }
}

/// A right prism over rings in the plane z = 0, the outer one counterclockwise and holes clockwise, from z0 to z1.
pub fn prism(rings: &[Vec<[f64; 2]>], z0: f64, z1: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let (mut bottom, mut top) = (Face::default(), Face::default());
    for ring in rings {
        let (n, first) = (ring.len() as u32, mesh.points.len() as u32);
        mesh.points.extend(ring.iter().map(|p| [p[0], p[1], z0]));
        mesh.points.extend(ring.iter().map(|p| [p[0], p[1], z1]));
        for i in 0..n {
            let (a, b) = (first + i, first + (i + 1) % n);
            mesh.faces.push(Face::new(vec![vec![a, b, b + n, a + n]]));
        }
        bottom.rings.push((0..n).rev().map(|i| first + i).collect());
        top.rings.push((0..n).map(|i| first + n + i).collect());
    }
    mesh.faces.extend([bottom, top]);
    mesh
}

pub fn cube(least: [f64; 3], most: [f64; 3]) -> Mesh {
    prism(&[vec![[least[0], least[1]], [most[0], least[1]], [most[0], most[1]], [least[0], most[1]]]], least[2], most[2])
}

pub fn regular(n: u32, radius: f64, h: f64) -> Mesh {
    let corner = |i: u32| {
        let turn = std::f64::consts::TAU * f64::from(i) / f64::from(n);
        [radius * turn.cos(), radius * turn.sin()]
    };
    prism(&[(0..n).map(corner).collect()], -h / 2.0, h / 2.0)
}

/// Not convex: an L.
pub fn ell() -> Mesh {
    prism(&[vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]], 0.0, 1.0)
}

/// With a hole through it.
pub fn frame() -> Mesh {
    let outer = vec![[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let hole = vec![[-0.5, -0.5], [-0.5, 0.5], [0.5, 0.5], [0.5, -0.5]];
    prism(&[outer, hole], 0.0, 0.5)
}

pub fn tetrahedron() -> Mesh {
    let points = vec![[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let faces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    Mesh { points, faces: faces.iter().map(|ring| Face::new(vec![ring.to_vec()])).collect() }
}

/// A turn and a shift as a matrix.
pub fn matrix(turn: DQuat, scale: DVec3, shift: DVec3) -> Matrix {
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| turn * axis);
    let (x, y, z) = (x * scale.x, y * scale.y, z * scale.z);
    [0, 1, 2].map(|i| [x[i], y[i], z[i], shift[i]])
}

pub fn shifted(x: f64, y: f64, z: f64) -> Matrix {
    matrix(DQuat::IDENTITY, DVec3::ONE, DVec3::new(x, y, z))
}

pub fn part(mesh: Mesh, matrix: Matrix) -> Part {
    Part { mesh: Arc::new(mesh), matrix, color: None, kind: "polyhedron", place: None }
}

/// Turns and shifts all parts.
pub fn moved(model: &Model, turn: DQuat, shift: DVec3) -> Model {
    let mut model = model.clone();
    for part in &mut model.parts {
        let m = part.matrix;
        let columns = [0, 1, 2].map(|j| turn * DVec3::new(m[0][j], m[1][j], m[2][j]));
        let at = turn * DVec3::new(m[0][3], m[1][3], m[2][3]) + shift;
        part.matrix = [0, 1, 2].map(|i| [columns[0][i], columns[1][i], columns[2][i], at[i]]);
    }
    model
}

/// A random tree over parts, some of them named several times.
pub fn tree(random: &mut Random, formula: &mut Formula, parts: u32) -> Area {
    let mut areas: Vec<Area> = (0..parts).map(|part| formula.shape(part)).collect();
    if random.below(3) == 0 {
        areas.push(formula.shape(random.below(parts.into()) as u32));
    }
    while areas.len() > 1 {
        let n = (2 + random.below(3) as usize).min(areas.len());
        let mut inputs: Vec<Area> = (0..n).map(|_| areas.swap_remove(random.below(areas.len() as u64) as usize)).collect();
        if random.below(8) == 0 && areas.len() > 1 {
            // Two parents.
            areas.push(inputs[0]);
        }
        areas.push(match random.below(8) {
            0 | 1 => formula.any(&inputs),
            2 => formula.all(&inputs),
            3 => formula.odd(&inputs),
            4 => formula.at_least(2, &inputs),
            _ => {
                let first = inputs.remove(0);
                formula.without(first, &inputs)
            }
        });
    }
    areas[0]
}

/// A random model of up to `most` parts, many of which touch, are coplanar or the same.
pub fn random_model(random: &mut Random, most: u64) -> Model {
    let snapped = random.below(3) > 0;
    let parts: Vec<Part> = (0..1 + random.below(most))
        .map(|_| {
            let mesh = match random.below(8) {
                0 => ell(),
                1 => frame(),
                2 => tetrahedron(),
                3 => regular(3 + random.below(6) as u32, 1.0, 2.0),
                _ => cube([-1.0; 3], [1.0; 3]),
            };
            let grid = |random: &mut Random| (random.below(7) as f64 - 3.0) / 2.0;
            let shift = DVec3::new(grid(random), grid(random), grid(random));
            let scale = DVec3::new(random.pick(&[0.5, 1.0, 1.0]), random.pick(&[0.5, 1.0, 1.5]), random.pick(&[0.5, 1.0, 1.0]));
            let scale = if random.below(6) == 0 { DVec3::new(-scale.x, scale.y, scale.z) } else { scale };
            let turn = if snapped {
                let axis = random.pick(&[DVec3::X, DVec3::Y, DVec3::Z]);
                DQuat::from_axis_angle(axis, std::f64::consts::FRAC_PI_2 * random.below(4) as f64)
            } else {
                DQuat::from_euler(glam::EulerRot::XYZ, random.unit() * 6.0, random.unit() * 6.0, random.unit() * 6.0)
            };
            part(mesh, matrix(turn, scale, shift))
        })
        .collect();
    let mut formula = Formula::default();
    let area = tree(random, &mut formula, parts.len() as u32);
    let model = Model { parts, formula, area };
    if random.below(2) == 0 {
        return model;
    }
    moved(&model, DQuat::from_euler(glam::EulerRot::XYZ, random.unit() * 6.0, random.unit() * 6.0, random.unit() * 6.0), DVec3::ZERO)
}

/// From `eye` to `target`; up is z where that is possible.
pub fn view(width: u32, height: u32, eye: DVec3, target: DVec3, projection: Projection) -> View {
    let forward = (target - eye).normalize();
    let up = if forward.z.abs() > 0.999 { DVec3::Y } else { DVec3::Z };
    let right = forward.cross(up).normalize();
    View { width, height, eye, axes: [right, forward.cross(right), forward], projection }
}

pub fn random_view(random: &mut Random, size: u32) -> View {
    let eye = match random.below(6) {
        0 => DVec3::new(0.0, -9.0, 0.0),
        1 => DVec3::new(0.0, 0.0, 9.0),
        // In the middle of things.
        2 => DVec3::new(random.unit(), random.unit(), random.unit()),
        _ => DVec3::new(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5).normalize_or(DVec3::X) * 8.0,
    };
    let (width, height) = (size + random.below(5) as u32, size + random.below(7) as u32);
    let projection = if random.below(3) == 0 {
        Projection::Orthographic { scale: f64::from(size) / 6.0 }
    } else {
        Projection::Perspective { focal: f64::from(size) * (0.5 + random.unit()), near: 0.05 }
    };
    view(width, height, eye, DVec3::new(random.unit() * 0.2, 0.0, 0.0), projection)
}
