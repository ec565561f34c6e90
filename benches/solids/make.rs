//! Shapes, places and trees that the workloads are made of, and how they become a model and a `.csg`.

use std::f64::consts::PI;
use std::fmt::Write;
use std::sync::Arc;

use runset::mesh::{Face, IDENTITY, Matrix, Mesh, Model, Part, Point, product};
use runset::scene::{Area, Formula};

use super::Solid;

const PALETTE: [[f64; 3]; 9] = [
    [0.85, 0.33, 0.25],
    [0.25, 0.55, 0.85],
    [0.35, 0.75, 0.35],
    [0.9, 0.75, 0.25],
    [0.6, 0.4, 0.8],
    [0.3, 0.75, 0.75],
    [0.9, 0.5, 0.7],
    [0.6, 0.6, 0.3],
    [0.5, 0.5, 0.55],
];

/// Operators over parts.
pub enum Tree {
    /// The part of that index.
    Part(usize),
    /// An operator's name and its operands.
    Op(&'static str, Vec<Tree>),
}

pub fn union(operands: Vec<Tree>) -> Tree {
    one_or("union", operands)
}

pub fn intersection(operands: Vec<Tree>) -> Tree {
    one_or("intersection", operands)
}

pub fn difference(first: Tree, others: Vec<Tree>) -> Tree {
    Tree::Op("difference", std::iter::once(first).chain(others).collect())
}

fn one_or(op: &'static str, mut operands: Vec<Tree>) -> Tree {
    if operands.len() == 1 { operands.remove(0) } else { Tree::Op(op, operands) }
}

/// Gathers parts.
#[derive(Default)]
pub struct Scene {
    parts: Vec<(Arc<Mesh>, Matrix, [f64; 3])>,
}

impl Scene {
    /// Adds a part in the next colour.
    pub fn part(&mut self, mesh: &Arc<Mesh>, matrix: Matrix) -> Tree {
        self.colored(mesh, matrix, self.parts.len() % PALETTE.len())
    }

    /// Adds a part in a colour of the palette.
    pub fn colored(&mut self, mesh: &Arc<Mesh>, matrix: Matrix, color: usize) -> Tree {
        self.parts.push((Arc::clone(mesh), matrix, PALETTE[color]));
        Tree::Part(self.parts.len() - 1)
    }

    /// The workload.
    pub fn done(self, tree: &Tree, eye: Point) -> Solid {
        let part = |(mesh, matrix, color): &(Arc<Mesh>, Matrix, [f64; 3])| {
            let color = Some(color.map(|x| (x * 255.0).round() as u8));
            Part { mesh: Arc::clone(mesh), matrix: *matrix, color, kind: "polyhedron", place: None }
        };
        let mut formula = Formula::default();
        let area = area(&mut formula, tree);
        let mut csg = String::new();
        self.write(&mut csg, tree, 0);
        Solid { model: Model { parts: self.parts.iter().map(part).collect(), formula, area }, csg, camera: [eye, [0.0; 3]] }
    }

    fn write(&self, csg: &mut String, tree: &Tree, depth: usize) {
        let tabs = "\t".repeat(depth);
        match tree {
            Tree::Op(op, operands) => {
                let _ = writeln!(csg, "{tabs}{op}() {{");
                operands.iter().for_each(|operand| self.write(csg, operand, depth + 1));
                let _ = writeln!(csg, "{tabs}}}");
            }
            Tree::Part(i) => {
                let (mesh, m, [r, g, b]) = &self.parts[*i];
                // OpenSCAD's faces are clockwise as seen from outside.
                let faces: Vec<Vec<u32>> = mesh.faces.iter().map(|face| face.rings[0].iter().rev().copied().collect()).collect();
                let _ = writeln!(csg, "{tabs}color([{r:?}, {g:?}, {b:?}, 1]) {{");
                let _ = writeln!(csg, "{tabs}\tmultmatrix([{:?}, {:?}, {:?}, [0, 0, 0, 1]]) {{", m[0], m[1], m[2]);
                let _ = writeln!(csg, "{tabs}\t\tpolyhedron(points = {:?}, faces = {faces:?}, convexity = 1);", mesh.points);
                let _ = writeln!(csg, "{tabs}\t}}\n{tabs}}}");
            }
        }
    }
}

fn area(formula: &mut Formula, tree: &Tree) -> Area {
    match tree {
        Tree::Part(i) => formula.shape(*i as u32),
        Tree::Op(op, operands) => {
            let areas: Vec<Area> = operands.iter().map(|operand| area(formula, operand)).collect();
            match *op {
                "difference" => formula.without(areas[0], &areas[1..]),
                "intersection" => formula.all(&areas),
                _ => formula.any(&areas),
            }
        }
    }
}

pub fn moved(x: f64, y: f64, z: f64) -> Matrix {
    [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]]
}

pub fn scaled(x: f64, y: f64, z: f64) -> Matrix {
    [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0]]
}

/// Around an axis, 0 for x.
pub fn turned(axis: usize, degrees: f64) -> Matrix {
    let (mut s, mut c) = degrees.to_radians().sin_cos();
    if degrees % 90.0 == 0.0 {
        (s, c) = (s.round(), c.round());
    }
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut m = IDENTITY;
    (m[u][u], m[u][v], m[v][u], m[v][v]) = (c, -s, s, c);
    m
}

/// The last first.
pub fn all<const N: usize>(matrices: [Matrix; N]) -> Matrix {
    matrices.into_iter().fold(IDENTITY, |m, next| product(&m, &next))
}

/// A mesh of faces without holes.
pub fn mesh(points: Vec<Point>, faces: Vec<Vec<u32>>) -> Arc<Mesh> {
    Arc::new(Mesh { points, faces: faces.into_iter().map(|ring| Face::new(vec![ring])).collect() })
}

/// A prism of n sides around z, from -height / 2 to height / 2; `phase` is the first corner's angle in sides.
pub fn prism(n: u32, radius: f64, height: f64, phase: f64) -> Arc<Mesh> {
    let corner = |i: u32| {
        let angle = 2.0 * PI * (f64::from(i) + phase) / f64::from(n);
        [radius * angle.cos(), radius * angle.sin()]
    };
    let level = |z: f64| (0..n).map(corner).map(move |[x, y]| [x, y, z]);
    let points = level(-height / 2.0).chain(level(height / 2.0)).collect();
    let mut faces: Vec<Vec<u32>> = (0..n).map(|i| vec![i, (i + 1) % n, n + (i + 1) % n, n + i]).collect();
    faces.extend([(0..n).rev().collect(), (n..2 * n).collect::<Vec<_>>()]);
    mesh(points, faces)
}

/// A box between two corners, of 6 faces or of 12 triangles.
pub fn cuboid(low: Point, high: Point, triangles: bool) -> Arc<Mesh> {
    let points = (0..8_usize).map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { low[axis] } else { high[axis] })).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves = |q: &[u32; 4]| [vec![q[0], q[1], q[2]], vec![q[0], q[2], q[3]]];
    mesh(points, if triangles { quads.iter().flat_map(halves).collect() } else { quads.map(|q| q.to_vec()).to_vec() })
}

/// A box around 0 that reaches as far as that.
pub fn block(x: f64, y: f64, z: f64) -> Arc<Mesh> {
    cuboid([-x, -y, -z], [x, y, z], false)
}

/// A sphere of meridians and parallels, poles included: `around * bands` faces, or `2 around (bands - 1)` triangles.
pub fn sphere(radius: f64, around: u32, bands: u32, triangles: bool) -> Arc<Mesh> {
    let mut points = vec![[0.0, 0.0, -radius]];
    for band in 1..bands {
        let (sine, cosine) = (PI * f64::from(band) / f64::from(bands)).sin_cos();
        let (z, wide) = (-radius * cosine, radius * sine);
        points.extend((0..around).map(|i| 2.0 * PI * f64::from(i) / f64::from(around)).map(|a| [wide * a.cos(), wide * a.sin(), z]));
    }
    points.push([0.0, 0.0, radius]);
    let top = points.len() as u32 - 1;
    let at = |band: u32, i: u32| 1 + (band - 1) * around + i % around;
    let mut faces: Vec<Vec<u32>> = (0..around).map(|i| vec![0, at(1, i + 1), at(1, i)]).collect();
    for band in 1..bands - 1 {
        for i in 0..around {
            let [a, b, c, d] = [at(band, i), at(band, i + 1), at(band + 1, i + 1), at(band + 1, i)];
            if triangles {
                faces.extend([vec![a, b, c], vec![a, c, d]]);
            } else {
                faces.push(vec![a, b, c, d]);
            }
        }
    }
    faces.extend((0..around).map(|i| vec![at(bands - 1, i), at(bands - 1, i + 1), top]));
    mesh(points, faces)
}
