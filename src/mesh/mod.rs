//! Polyhedra, and what they are combined to: the leaves and the tree of a CSG model.
//!
//! A [`Mesh`] is a closed surface: faces of any number of corners, plane, with holes or without, counterclockwise as seen from outside. A
//! [`Part`] is a mesh at its place, with a colour; a [`Model`] is parts and a [`Formula`] over them, the same as that of plane shapes. A
//! part may stand at several places of the formula.

pub mod boolean;
pub mod build;
pub mod check;
pub mod extrude;
mod face;
pub mod hull;
pub mod outline;
pub mod primitive;
pub mod section;
pub mod stl;
pub mod surface;
pub mod triangles;
pub mod turn;

use std::sync::Arc;

use crate::error::Place;
use crate::run::Rgb;
use crate::scene::{Area, Formula};

/// A point in space, in the model's units (millimetres for most).
pub type Point = [f64; 3];

/// Coordinates are refused from here on: their products would leave the range of 64 bits.
pub const FARTHEST: f64 = 1e30;

/// A surface of plane faces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The corners.
    pub points: Vec<Point>,
    /// The faces.
    pub faces: Vec<Face>,
}

/// A plane face: rings of indices into [`Mesh::points`], the outer one counterclockwise as seen from outside, holes clockwise. The first and the last
/// of a ring are neighbours.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Face {
    /// The outer ring and the holes. A face of a mesh that was worked out may be in several pieces, with an outer ring each.
    pub rings: Vec<Vec<u32>>,
    /// Whose surface it lies on, if that is not the part that has it: in a mesh that was worked out from several parts.
    pub origin: Option<Origin>,
}

impl Face {
    /// A face of its own part.
    pub fn new(rings: Vec<Vec<u32>>) -> Face {
        Face { rings, origin: None }
    }
}

/// Whose surface a face lies on, and which side of it is outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Origin {
    /// It looks into that part, which was taken away there.
    pub turned: bool,
    /// Index into [`Model::parts`].
    pub part: u32,
}

/// The first three rows of a 4 x 4 matrix, row by row: from a mesh's own coordinates to the model's.
pub type Matrix = [[f64; 4]; 3];

/// The matrix that changes nothing.
pub const IDENTITY: Matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// A mesh at its place in a model.
#[derive(Clone, Debug)]
pub struct Part {
    /// The surface.
    pub mesh: Arc<Mesh>,
    /// Its place.
    pub matrix: Matrix,
    /// Its colour, if it was given one.
    pub color: Option<Rgb>,
    /// What it is, in one word: `cube`, `polyhedron`.
    pub kind: &'static str,
    /// Where it begins in the document.
    pub place: Option<Place>,
}

/// A model: which points of space it fills, as a formula over its parts.
#[derive(Clone, Debug)]
pub struct Model {
    /// The parts, in document order.
    pub parts: Vec<Part>,
    /// The formula; its shapes are indices into `parts`.
    pub formula: Formula,
    /// The whole.
    pub area: Area,
}

/// A point at its place.
pub fn moved(matrix: &Matrix, [x, y, z]: Point) -> Point {
    matrix.map(|[a, b, c, d]| a * x + b * y + c * z + d)
}

/// First `inner`, then `outer`.
pub fn product(outer: &Matrix, inner: &Matrix) -> Matrix {
    outer.map(|[a, b, c, d]| {
        let column = |k: usize| a * inner[0][k] + b * inner[1][k] + c * inner[2][k];
        [column(0), column(1), column(2), column(3) + d]
    })
}

/// By what factor a matrix changes volumes; negative if it mirrors.
pub fn determinant(m: &Matrix) -> f64 {
    let row = |i: usize| [m[i][0], m[i][1], m[i][2]];
    dot(row(0), cross(row(1), row(2)))
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn length(a: Point) -> f64 {
    a[0].hypot(a[1]).hypot(a[2])
}
