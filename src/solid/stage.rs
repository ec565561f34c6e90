//! A body in a view: edges as columns, planes as depths.
//!
//! Corners are projected and rounded to 1/256 px; from there on all is integers. An edge takes its columns from its line, which goes through the outermost of all
//! corners on it, and its scanlines from its own ends: so edges on one line in space never part on the screen.

use std::ops::Range;

use glam::DVec3;

use super::body::{Body, NOTHING};
use super::cut::cut;
use super::view::{Depth, View};
use crate::count::{Node, Program};
use crate::grid::{self, Point, SUB};
use crate::line::Line;
use crate::line::exact::{self, Piece};
use crate::sweep::{self, Edges};

pub use super::body::Plane;

/// What happens where a scanline crosses an edge from left to right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crossing {
    /// The face whose turns grow by `turns`.
    pub left: u32,
    /// The face whose turns shrink by as much, or none ([`u32::MAX`]).
    pub right: u32,
    /// 1 or -1.
    pub turns: i32,
}

/// A face of the stage.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    /// Index into [`Stage::depths`].
    pub plane: u32,
    /// The counter of its part.
    pub leaf: Node,
    /// Its part.
    pub part: u32,
    /// Which face is shown of several that are equally near, and whose parts make the difference: that with the least.
    pub rank: u32,
}

/// A model as it is seen from somewhere, ready to be swept.
#[derive(Clone, Debug)]
pub struct Stage {
    /// The view.
    pub view: View,
    /// Edges of the surfaces.
    pub edges: Edges<Crossing>,
    /// Faces.
    pub faces: Vec<Face>,
    /// Depths of the planes.
    pub depths: Vec<Depth>,
    /// Normals of the planes.
    pub planes: Vec<Plane>,
    /// Counts which parts a point is in, and tells whether it is in the model (output 0).
    pub program: Program,
    /// Greatest distance along the view, for [`View::distance`].
    pub farthest: f64,
}

impl Stage {
    /// `body` in a view, cut by planes that keep what is before them. `leaves` are the counters of parts; other parts are not needed.
    pub fn new(mut body: Body, program: Program, leaves: &[(usize, Node)], view: View, sections: &[Plane]) -> Stage {
        let mut leaf_of = vec![NOTHING; body.ranks.len()];
        leaves.iter().for_each(|&(part, leaf)| leaf_of[part] = leaf);
        sections.iter().copied().chain(view.near()).for_each(|plane| cut(&mut body, plane));
        let farthest = body.points.iter().fold(0.0_f64, |most, p| most.max(view.camera(*p).z.abs()));

        let points: Vec<Point> = body.points.iter().map(|p| grid::snap_point(view.screen(*p))).collect();
        let rows: Vec<u32> = points.iter().map(|p| exact::row(p[1]).clamp(0.0, view.height.into()) as u32).collect();
        let ends = outermost(&body);
        let needed = |face: u32| face != NOTHING && leaf_of[body.faces[face as usize].part as usize] != NOTHING;

        let mut edges = Edges::default();
        let mut pieces = Vec::new();
        let mut inside: Vec<u32> = vec![NOTHING; body.planes.len()];
        for edge in &body.edges {
            for face in [edge.left, edge.right].into_iter().filter(|face| *face != NOTHING) {
                inside[body.faces[face as usize].plane as usize] = edge.from;
            }
            let [from, to] = [edge.from, edge.to].map(|p| rows[p as usize]);
            if from == to || !needed(edge.left) {
                continue;
            }
            let (turns, top, bottom) = if from < to { (1, edge.from, edge.to) } else { (-1, edge.to, edge.from) };
            let across = from.min(to)..from.max(to);
            let [a, b] = ends[edge.line as usize].map(|p| points[p as usize]);
            let [a, b] = if a[1] == b[1] {
                [top, bottom].map(|p| points[p as usize])
            } else if a[1] < b[1] {
                [a, b]
            } else {
                [b, a]
            };
            if a[0].min(b[0]) > f64::from(view.width) {
                continue;
            }
            columns(a, b, across.clone(), view.width, &mut pieces);
            let chain = pieces.drain(..).map(|Piece { last, line }| sweep::Edge { last, line });
            edges.add(across.start, chain, Crossing { left: edge.left, right: edge.right, turns });
        }
        let depth = |(plane, p): (&Plane, &u32)| view.depth(plane, body.points.get(*p as usize).copied().unwrap_or(DVec3::ZERO), farthest);
        let depths = body.planes.iter().zip(&inside).map(depth).collect();
        let faces = body.faces.iter().map(|face| {
            let part = face.part as usize;
            Face { plane: face.plane, leaf: leaf_of[part], part: face.part, rank: body.ranks[part] }
        });
        Stage { view, edges: edges.finish(), faces: faces.collect(), depths, planes: body.planes, program, farthest }
    }
}

/// For every line the two outermost corners on it.
fn outermost(body: &Body) -> Vec<[u32; 2]> {
    let mut ends: Vec<[(f64, u32); 2]> = vec![[(f64::INFINITY, 0), (f64::NEG_INFINITY, 0)]; body.lines.len()];
    for edge in &body.edges {
        let line = &body.lines[edge.line as usize];
        for p in [edge.from, edge.to] {
            let along = line.along.dot(body.points[p as usize] - line.at);
            let [first, last] = &mut ends[edge.line as usize];
            // Points that are equally far along are told by their numbers.
            if (along, p) < *first {
                *first = (along, p);
            }
            if (along, p) > *last {
                *last = (along, p);
            }
        }
    }
    ends.into_iter().map(|ends| ends.map(|end| end.1)).collect()
}

/// Appends the pieces of the line from `top` to `bottom`, in pixels, for `rows`.
fn columns(top: Point, bottom: Point, rows: Range<u32>, width: u32, pieces: &mut Vec<Piece>) {
    if grid::is_near(top) && grid::is_near(bottom) {
        let [p, q] = [top, bottom].map(|point| point.map(grid::steps));
        if p[0].max(q[0]) <= SUB / 2 {
            return pieces.push(Piece { last: rows.end, line: Line::vertical(0) });
        }
        let within = |y: i64| grid::first_centre(y);
        let covered = within(p[1]) <= i64::from(rows.start) && i64::from(rows.end) <= within(q[1]);
        if covered && let Some(line) = Line::through(p, q, rows.start, rows.end - rows.start, width) {
            return pieces.push(Piece { last: rows.end, line });
        }
    }
    exact::pieces(top, bottom, rows, width, pieces);
}
