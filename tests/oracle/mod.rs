//! A second opinion on every fill: each pixel by its definition, too simple to be wrong, too slow for anything but tests.
//!
//! Vertices go to the nearest 1/256 px, ties away from zero; from there on all numbers are integers, as long as they need to be.
//! An edge counts on a scanline when the line of pixel centres meets it, its upper end included and its lower end not; it
//! counts for the pixels whose centre lies to its right or on it. A centre `(x, y)` and an edge from `(x0, y0)` down by `dy` and
//! across by `dx` are compared without dividing:
//!
//! ```text
//!     x0 + (y - y0) dx / dy <= x        (y - y0) dx <= (x - x0) dy
//! ```
//!
//! The sum of +1 for the edges that run down and -1 for those that run up is the winding number; the fill rule makes a truth of
//! it, and the expression, evaluated as it is written, the pixel.
//!
//! [`random`] makes scenes that are hard in many ways, [`near`] edges that pass as close to pixel centres as edges can. Nothing
//! here uses the engine.

#![allow(dead_code, unused_imports, reason = "each test that includes this uses a part of it")]

pub mod near;
pub mod random;
pub mod text;

use std::ops::Range;

use num_bigint::BigInt;

/// A point in pixels, finite.
pub type Point = (f64, f64);

/// Which windings are inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    NonZero,
    EvenOdd,
}

/// Closed polygons, filled together.
#[derive(Clone, Debug)]
pub struct Shape {
    pub rings: Vec<Vec<Point>>,
    pub rule: Rule,
}

/// An operator between two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    Minus,
    And,
    Xor,
    Or,
}

/// An operator over a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    All,
    Any,
    Odd,
    AtLeast(usize),
}

/// An expression over the shapes of a scene, by index.
#[derive(Clone, Debug)]
pub enum Expr {
    Page,
    Art,
    Shape(usize),
    Not(Box<Expr>),
    Binary(Operator, Box<Expr>, Box<Expr>),
    Call(Function, Vec<Expr>),
}

/// A page in pixels, shapes, and what to fill.
#[derive(Clone, Debug)]
pub struct Scene {
    pub width: u32,
    pub height: u32,
    pub shapes: Vec<Shape>,
    pub expr: Expr,
}

/// A scene's edges in exact numbers.
pub struct Oracle<'a> {
    scene: &'a Scene,
    edges: Vec<Edge>,
}

struct Edge {
    shape: usize,
    winding: i32,
    line: Line,
}

/// Upper end and extent, `[x0, y0, dx, dy]` with `dy` > 0, in 1/256 px.
enum Line {
    Near([i128; 4]),
    Far([BigInt; 4]),
}

impl Scene {
    /// The runs of scanlines 0 up to the height.
    pub fn rows(&self) -> Vec<Vec<Range<u32>>> {
        let oracle = Oracle::new(self);
        (0..self.height).map(|y| oracle.row(y)).collect()
    }

    /// The picture as text, a line a scanline: `#` inside, `.` outside.
    pub fn ascii(&self) -> String {
        ascii(&self.rows(), self.width)
    }
}

/// Runs as text, a line a scanline: `#` inside, `.` outside.
pub fn ascii(rows: &[Vec<Range<u32>>], width: u32) -> String {
    let pixel = |row: &Vec<Range<u32>>, x| if row.iter().any(|run| run.contains(&x)) { '#' } else { '.' };
    rows.iter().map(|row| (0..width).map(|x| pixel(row, x)).chain(['\n']).collect::<String>()).collect()
}

impl<'a> Oracle<'a> {
    pub fn new(scene: &'a Scene) -> Oracle<'a> {
        let mut edges = Vec::new();
        for (shape, Shape { rings, .. }) in scene.shapes.iter().enumerate() {
            for ring in rings {
                let ends = ring.iter().zip(ring.iter().cycle().skip(1));
                edges.extend(ends.filter_map(|(&from, &to)| Edge::new(shape, from, to)));
            }
        }
        Oracle { scene, edges }
    }

    /// Whether pixel `(x, y)` belongs to the scene's expression.
    pub fn pixel(&self, x: u32, y: u32) -> bool {
        self.holds(&self.active(y), x, y)
    }

    /// The runs of scanline `y`. From one pixel to the next nothing changes unless an edge begins to count, so only pixels at
    /// which one does are looked at.
    pub fn row(&self, y: u32) -> Vec<Range<u32>> {
        let active = self.active(y);
        let mut changes: Vec<u32> = active.iter().map(|edge| self.first_column(&edge.line, y)).chain([0]).collect();
        changes.sort_unstable();
        changes.dedup();
        changes.retain(|&x| x < self.scene.width);

        let mut runs: Vec<Range<u32>> = Vec::new();
        for (i, &x) in changes.iter().enumerate() {
            if self.holds(&active, x, y) {
                let end = changes.get(i + 1).copied().unwrap_or(self.scene.width);
                match runs.last_mut() {
                    Some(run) if run.end == x => run.end = end,
                    _ => runs.push(x..end),
                }
            }
        }
        runs
    }

    fn active(&self, y: u32) -> Vec<&Edge> {
        self.edges.iter().filter(|edge| edge.line.meets(y)).collect()
    }

    /// The first pixel that the edge counts for, at most the width. The predicate is false, then true.
    fn first_column(&self, line: &Line, y: u32) -> u32 {
        let (mut low, mut high) = (0, self.scene.width);
        while low < high {
            let middle = (low + high) / 2;
            if line.counts_for(middle, y) { high = middle } else { low = middle + 1 }
        }
        low
    }

    fn holds(&self, active: &[&Edge], x: u32, y: u32) -> bool {
        let mut windings = vec![0; self.scene.shapes.len()];
        for edge in active.iter().filter(|edge| edge.line.counts_for(x, y)) {
            windings[edge.shape] += edge.winding;
        }
        let inside = windings.iter().zip(&self.scene.shapes).map(|(winding, shape)| match shape.rule {
            Rule::NonZero => *winding != 0,
            Rule::EvenOdd => winding % 2 != 0,
        });
        self.scene.expr.holds(&inside.collect::<Vec<bool>>())
    }
}

impl Expr {
    /// The expression's truth where the shapes' truths are these.
    pub fn holds(&self, shapes: &[bool]) -> bool {
        match self {
            Expr::Page => true,
            Expr::Art => shapes.contains(&true),
            Expr::Shape(index) => shapes[*index],
            Expr::Not(a) => !a.holds(shapes),
            Expr::Binary(operator, a, b) => {
                let (a, b) = (a.holds(shapes), b.holds(shapes));
                match operator {
                    Operator::Minus => a && !b,
                    Operator::And => a && b,
                    Operator::Xor => a != b,
                    Operator::Or => a || b,
                }
            }
            Expr::Call(function, operands) => {
                let count = operands.iter().filter(|operand| operand.holds(shapes)).count();
                match *function {
                    Function::All => count == operands.len(),
                    Function::Any => count > 0,
                    Function::Odd => count % 2 == 1,
                    Function::AtLeast(k) => count >= k,
                }
            }
        }
    }
}

impl Edge {
    /// None for an edge that is level after rounding.
    fn new(shape: usize, from: Point, to: Point) -> Option<Edge> {
        let [from, to] = [from, to].map(|(x, y)| (exact(x), exact(y)));
        let (top, bottom, winding) = if from.1 < to.1 { (from, to, 1) } else { (to, from, -1) };
        if top.1 == bottom.1 {
            return None;
        }
        let line = [top.0.clone(), top.1.clone(), bottom.0 - top.0, bottom.1 - top.1];
        let near: Vec<i128> = line.iter().flat_map(i128::try_from).filter(|v| v.abs() < 1 << 60).collect();
        let line = near.try_into().map_or(Line::Far(line), Line::Near);
        Some(Edge { shape, winding, line })
    }
}

impl Line {
    /// Whether it meets the line of the pixel centres of scanline `y`.
    fn meets(&self, y: u32) -> bool {
        let y = centre(y);
        match self {
            Line::Near([_, y0, _, dy]) => *y0 <= y && y < y0 + dy,
            Line::Far([_, y0, _, dy]) => *y0 <= y.into() && BigInt::from(y) < y0 + dy,
        }
    }

    /// Whether the centre of pixel `(x, y)` lies to the right of it or on it.
    fn counts_for(&self, x: u32, y: u32) -> bool {
        let (x, y) = (centre(x), centre(y));
        match self {
            Line::Near([x0, y0, dx, dy]) => (y - y0) * dx <= (x - x0) * dy,
            Line::Far([x0, y0, dx, dy]) => (y - y0) * dx <= (x - x0) * dy,
        }
    }
}

/// A pixel's centre in 1/256 px.
fn centre(pixel: u32) -> i128 {
    256 * i128::from(pixel) + 128
}

/// Pixels to the nearest 1/256 px, ties away from zero. A double of 2^52 or more is whole, and is printed digit by digit.
fn exact(pixels: f64) -> BigInt {
    if pixels.abs() < (1u64 << 52) as f64 {
        BigInt::from((pixels * 256.0).round() as i128)
    } else {
        format!("{pixels:.0}").parse::<BigInt>().expect("finite") * 256
    }
}
