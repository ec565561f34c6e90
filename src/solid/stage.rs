//! A body in a view: edges as columns, planes as depths.
//!
//! An edge takes its columns from its line, and the scanlines that it meets from its ends, so edges on one line in space never part on the screen. A line is
//! a position on scanline 0 and a step, in units of 2^-43 px, and columns are what these integers say; depths are integers too. So all that is decided behind this
//! floor is exact, and the doubles in front of it are off by some 2^-30 px: much less than the hair by which pixels are looked at beside their centres.

// Corners rounded to 1/256 px, as those of plane shapes are, would move edges by up to 1/512 px against the depths of the faces that meet there: a face beside
// the edge could then be nearer than the one that hides it, in single pixels along edges that lie in a face of another part.

use std::borrow::Cow;
use std::ops::Range;

use glam::DVec3;

use super::body::{Body, NOTHING};
use super::boxes::live;
use super::cut::cut;
use super::savings::Savings;
use super::view::{Depth, Projection, SAMPLE, View};
use crate::bounds::{Bounds, join};
use crate::count::{Node, Program};
use crate::line::{FRACTION, Line};
use crate::mesh::Origin;
use crate::sweep::{Edge, Edges};

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
    /// Whose surface it shows.
    pub origin: Origin,
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
    pub fn new(body: &Body, program: Program, leaves: &[(usize, Node)], view: View, sections: &[Plane], savings: Savings) -> Stage {
        let mut leaf_of = vec![NOTHING; body.ranks.len()];
        leaves.iter().for_each(|&(part, leaf)| leaf_of[part] = leaf);
        let Shown { body, depths, farthest } = Shown::new(body, &view, sections);

        let screen: Vec<[f64; 3]> = body.points.iter().map(|p| view.place(*p)).collect();
        let rows: Vec<u32> = screen.iter().map(|p| row(p[1], view.height)).collect();
        let clips = clips(&body, &screen, &program, leaves, &view, savings);

        let mut edges = Edges::default();
        let mut pieces = Vec::new();
        for edge in &body.edges {
            let Clip { columns, rows: alive } = &clips[body.faces[edge.left as usize].part as usize];
            let [from, to] = [edge.from, edge.to].map(|p| rows[p as usize].clamp(alive.start, alive.end));
            if from == to || columns.is_empty() {
                continue;
            }
            let turns = if from < to { 1 } else { -1 };
            let across = from.min(to)..from.max(to);
            let first = across.start;
            Sloping::new(view.passes(&body.lines[edge.line as usize])).edges(across, columns, &mut pieces);
            if pieces.iter().any(|piece| !piece.line.is_vertical() || piece.line.column() < view.width) {
                edges.add(first, pieces.drain(..), Crossing { left: edge.left, right: edge.right, turns });
            }
            pieces.clear();
        }
        let faces = body.faces.iter().map(|face| {
            let part = face.part as usize;
            Face { plane: face.plane, leaf: leaf_of[part], origin: face.origin, rank: body.ranks[part] }
        });
        Stage { view, edges: edges.finish(), faces: faces.collect(), depths, planes: body.planes.clone(), program, farthest }
    }

    /// Whether the normal of a plane points to the eye.
    pub fn is_toward(&self, plane: u32) -> bool {
        let Plane { normal, offset } = self.planes[plane as usize];
        match self.view.projection {
            Projection::Perspective { .. } => normal.dot(self.view.eye) > offset,
            Projection::Orthographic { .. } => normal.dot(self.view.axes[2]) < 0.0,
        }
    }
}

/// A body as a view shows it: cut, with the depths of its planes.
pub(super) struct Shown<'b> {
    /// What is left of it.
    pub(super) body: Cow<'b, Body>,
    /// Depths of its planes.
    pub(super) depths: Vec<Depth>,
    /// Greatest distance along the view.
    pub(super) farthest: f64,
}

impl Shown<'_> {
    pub(super) fn new<'b>(body: &'b Body, view: &View, sections: &[Plane]) -> Shown<'b> {
        let mut body = Cow::Borrowed(body);
        sections.iter().copied().chain(view.near()).for_each(|plane| cut(&mut body, plane));
        let farthest = body.points.iter().fold(0.0_f64, |most, p| most.max(view.camera(*p).z.abs()));
        let mut inside: Vec<u32> = vec![NOTHING; body.planes.len()];
        for edge in &body.edges {
            for face in [edge.left, edge.right].into_iter().filter(|face| *face != NOTHING) {
                inside[body.faces[face as usize].plane as usize] = edge.from;
            }
        }
        let depth = |(plane, p): (&Plane, &u32)| view.depth(plane, body.points.get(*p as usize).copied().unwrap_or(DVec3::ZERO), farthest);
        let depths = body.planes.iter().zip(&inside).map(depth).collect();
        Shown { body, depths, farthest }
    }
}

/// The columns and rows of the page on which a part is needed.
struct Clip {
    columns: Range<u32>,
    rows: Range<u32>,
}

/// By how many pixels boxes are larger on each side, and by how much of the distance: much more than rounding takes.
const AROUND: f64 = 1.0;
const AROUND_DISTANCE: f64 = 1e-6;

/// Where the parts are needed: all of the page for those in the tree, or only where they matter.
fn clips(body: &Body, screen: &[[f64; 3]], program: &Program, leaves: &[(usize, Node)], view: &View, savings: Savings) -> Vec<Clip> {
    let mut clips: Vec<Clip> = body.ranks.iter().map(|_| Clip { columns: 0..0, rows: 0..0 }).collect();
    let page = [view.width, view.height];
    if !savings.boxes {
        leaves.iter().for_each(|&(part, _)| clips[part] = Clip { columns: 0..page[0], rows: 0..page[1] });
        return clips;
    }
    let mut own: Vec<Bounds<3>> = vec![None; body.ranks.len()];
    for edge in &body.edges {
        let bounds = &mut own[body.faces[edge.left as usize].part as usize];
        *bounds = [edge.from, edge.to].iter().fold(*bounds, |bounds, &p| join(bounds, Some([screen[p as usize]; 2])));
    }
    for [least, most] in own.iter_mut().flatten() {
        for i in 0..3 {
            let room = if i < 2 { AROUND } else { AROUND_DISTANCE * least[i].abs().max(most[i].abs()) };
            (least[i], most[i]) = (least[i] - room, most[i] + room);
        }
    }
    let mut part_of = vec![0; program.leaves()];
    leaves.iter().for_each(|&(part, leaf)| part_of[leaf as usize] = part);
    let live = live(program, |leaf| own[part_of[leaf as usize]], program.output(0));
    for &(part, leaf) in leaves {
        let (Some(live), Some(own)) = (live[leaf as usize], own[part]) else { continue };
        // A side at which nothing is cut off is that of the page.
        let range = |i: usize| {
            let start = if live[0][i] > own[0][i] { live[0][i].clamp(0.0, page[i].into()) as u32 } else { 0 };
            let end = if live[1][i] < own[1][i] { live[1][i].ceil().clamp(0.0, page[i].into()) as u32 } else { page[i] };
            start..end
        };
        clips[part] = Clip { columns: range(0), rows: range(1) };
    }
    clips
}

/// The first scanline that is looked at below a height, in pixels.
fn row(height: f64, rows: u32) -> u32 {
    (height - SAMPLE[1]).ceil().clamp(0.0, rows.into()) as u32
}

/// A line on the screen, in units of 2^-43 px: where it passes scanline 0, right of where pixel 0 is looked at, and its step from one scanline to the next.
#[derive(Clone, Copy)]
struct Sloping {
    at: i128,
    step: i128,
}

impl Sloping {
    fn new((at, slope): (f64, f64)) -> Sloping {
        // Level lines pass no scanline but by rounding, and then anywhere. What is far beyond any page stays there.
        let fixed = |x: f64| (x.clamp(-1e18, 1e18) * ONE).round() as i128;
        Sloping { at: fixed(at), step: fixed(slope) }
    }

    /// Its column on a scanline: that of the first pixel that is looked at on it or right of it.
    fn at(self, row: u32) -> i128 {
        // As in [`Line`]: what is right of a pixel belongs to the next.
        self.at + self.step * i128::from(row) + (1 << FRACTION) - 1
    }

    /// Appends the edges that it makes on `rows`, with columns not outside of `columns`: what is left of them is at their start, what is right at their end.
    fn edges(self, rows: Range<u32>, columns: &Range<u32>, edges: &mut Vec<Edge>) {
        let (least, most) = (i128::from(columns.start), i128::from(columns.end));
        let side = |row: u32| (self.at(row) >> FRACTION).clamp(least, most);
        let mut start = rows.start;
        while start < rows.end {
            let here = side(start);
            let outside = |side: i128| side == least || side == most;
            // It leaves a side once: find where.
            let (mut same, mut past) = (start, rows.end);
            while past - same > 1 {
                let middle = same + (past - same) / 2;
                let alike = if outside(here) { side(middle) == here } else { !outside(side(middle)) };
                if alike { same = middle } else { past = middle }
            }
            let line = if outside(here) { Line::vertical(here as u32) } else { Line::of_parts(self.at(start) as u64, self.step as u64) };
            edges.push(Edge { last: past, line });
            start = past;
        }
    }
}

const ONE: f64 = (1_u64 << FRACTION) as f64;
