//! A part at its place, made fit for the engine: closed, the right way out, its faces plane.
//!
//! What is wrong is put right in one stated way, so that the picture of a broken mesh is always the same:
//!
//! * **Open edges**, those that are not used equally often in both directions, are joined to rings, and every ring is closed by a fan of triangles from
//!   its first corner. A cube that lacks a face is a cube again.
//! * **Inside out**: a surface around a negative volume is turned.
//! * **Faces that are not plane**, with a corner farther than 1e-9 of the part's size from the plane of the face, are cut into triangles.
//! * **Faces without area** are left out in the end. Their edges lie on those of their neighbours, so nothing opens but in the list of edges.

use foldhash::HashMap;

use super::face::{edges, normal};
use super::triangles::{fans, triangles};
use super::{Face, Mesh, Model, Part, Point};
use crate::error::Warning;

/// How far a corner may be from the plane of its face, in sizes of the part.
const PLANE: f64 = 1e-9;

/// Corners of a face that is not plane, beyond which it is cut into fans: where a face meets itself, better triangles take time with the square of them.
const CORNERS: usize = 10_000;

/// Faces are without area whose height is less than this part of their outline.
const THIN: f64 = 1e-13;

/// A part's surface in the model's coordinates, and what was wrong with it.
#[derive(Clone, Debug, Default)]
pub struct Placed {
    /// The surface: every edge is used equally often in both directions, but for faces without area that were left out.
    pub mesh: Mesh,
    /// Edges that were used more often in one direction than in the other.
    pub open_edges: u64,
    /// It was turned.
    pub inside_out: bool,
    /// Faces that were cut because they are not plane.
    pub cut: u64,
    /// Of these, those that were cut into fans for their number of corners.
    pub fans: u64,
}

/// The part at its place, put right.
pub fn placed(part: &Part) -> Placed {
    let mut placed = closed(part);
    let Mesh { points, faces } = &mut placed.mesh;
    faces.retain(|face| !thin(points, face));
    placed
}

/// The part at its place, put right but for faces without area, which are still there: every edge is used equally often in both directions.
pub fn closed(part: &Part) -> Placed {
    let points: Vec<Point> = part.mesh.points.iter().map(|p| super::moved(&part.matrix, *p)).collect();
    let mut faces = part.mesh.faces.clone();
    if super::determinant(&part.matrix) < 0.0 {
        faces.iter_mut().for_each(turn);
    }
    let (caps, open_edges) = caps(&points, &faces);
    faces.extend(caps);
    let [low, high] = bounds(&points);
    let inside_out = volume(&points, &faces, low) < 0.0;
    if inside_out {
        faces.iter_mut().for_each(turn);
    }
    let size = super::length(super::minus(high, low));
    let (mut cut, mut large) = (0, 0);
    let mut kept = Vec::with_capacity(faces.len());
    for face in faces {
        if plane(&points, &face, size * PLANE) {
            kept.push(face);
        } else {
            cut += 1;
            let is_large = face.rings.iter().map(Vec::len).sum::<usize>() > CORNERS;
            large += u64::from(is_large);
            let triangles = if is_large { fans(&face) } else { triangles(&points, &face) };
            kept.extend(triangles.into_iter().map(|t| Face { rings: vec![t.to_vec()], origin: face.origin }));
        }
    }
    kept.retain(|face| !thin(&points, face));
    Placed { mesh: Mesh { points, faces: kept }, open_edges, inside_out, cut, fans: large }
}

/// All parts of a model, in order; `warnings` receives what was wrong with which.
pub fn all_placed(model: &Model, warnings: &mut Vec<Warning>) -> Vec<Placed> {
    let placed: Vec<Placed> = model.parts.iter().map(placed).collect();
    model.parts.iter().zip(&placed).for_each(|(part, placed)| placed.tell(part, warnings));
    placed
}

impl Placed {
    /// Says what was wrong with the part.
    pub(super) fn tell(&self, part: &Part, warnings: &mut Vec<Warning>) {
        let mut warn = |what: String| warnings.push(Warning { place: part.place, ..Warning::input(what) });
        match self.open_edges {
            0 => {}
            1 => warn(format!("1 open edge in this {}: the surface is closed there by triangles", part.kind)),
            open => warn(format!("{open} open edges in this {}: the surface is closed there by triangles", part.kind)),
        }
        if self.inside_out {
            warn(format!("this {} is inside out: it is turned; OpenSCAD wants faces clockwise as seen from outside", part.kind));
        }
        if self.fans > 0 {
            warn(format!(
                "a face of this {} is not plane and has more than {CORNERS} corners: it is cut from its first corner; give it as triangles",
                part.kind
            ));
        }
    }
}

/// Turns a face over.
fn turn(face: &mut Face) {
    face.rings.iter_mut().for_each(|ring| ring.reverse());
}

/// The triangles that close a surface, and the number of edges that are open.
fn caps(points: &[Point], faces: &[Face]) -> (Vec<Face>, u64) {
    let missing = unpaired(points.len(), faces);
    let open = missing.len() as u64;
    // Rings of missing edges, each from its first corner on.
    let mut out: HashMap<u32, Vec<usize>> = HashMap::default();
    for (i, edge) in missing.iter().enumerate().rev() {
        out.entry(edge[0]).or_default().push(i);
    }
    let mut used = vec![false; missing.len()];
    let mut caps = Vec::new();
    for first in 0..missing.len() {
        let mut next = first;
        let start = missing[first][0];
        while !used[next] {
            used[next] = true;
            let [from, to] = missing[next];
            if from != start && to != start {
                caps.push(Face::new(vec![vec![start, from, to]]));
            }
            if to == start {
                break;
            }
            let leaving = out.get_mut(&to).expect("as many missing edges leave a corner as reach it");
            next = loop {
                match leaving.pop() {
                    Some(edge) if used[edge] => {}
                    Some(edge) => break edge,
                    None => break next,
                }
            };
        }
    }
    (caps, open)
}

/// The edges that would have to be added so that all are used equally often in both directions, in the order of their ends.
fn unpaired(points: usize, faces: &[Face]) -> Vec<[u32; 2]> {
    // Sorted by the smaller end by counting, then by the other end: there are few at each corner.
    let mut starts = vec![0_u32; points + 2];
    for edge in faces.iter().flat_map(edges) {
        starts[edge[0].min(edge[1]) as usize + 2] += 1;
    }
    for i in 2..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut ends = vec![(0_u32, 0_i32); starts[points + 1] as usize];
    for [a, b] in faces.iter().flat_map(edges) {
        let slot = &mut starts[a.min(b) as usize + 1];
        ends[*slot as usize] = (a.max(b), if a < b { 1 } else { -1 });
        *slot += 1;
    }
    let mut missing = Vec::new();
    for corner in 0..points {
        let around = &mut ends[starts[corner] as usize..starts[corner + 1] as usize];
        around.sort_unstable();
        for group in around.chunk_by(|a, b| a.0 == b.0) {
            let [low, high] = [u32::try_from(corner).expect("corners are limited at the door"), group[0].0];
            let sum: i32 = group.iter().map(|end| end.1).sum();
            let edge = if sum > 0 { [high, low] } else { [low, high] };
            missing.extend(std::iter::repeat_n(edge, if low == high { 0 } else { sum.unsigned_abs() as usize }));
        }
    }
    missing.sort_unstable();
    missing
}

/// The least and the greatest coordinates; zeros if there are no points.
pub(super) fn bounds(points: &[Point]) -> [Point; 2] {
    let Some(&first) = points.first() else { return [[0.0; 3]; 2] };
    points.iter().fold([first; 2], |[low, high], p| [[0, 1, 2].map(|i| low[i].min(p[i])), [0, 1, 2].map(|i| high[i].max(p[i]))])
}

/// Six times the volume inside, as seen from `origin`.
fn volume(points: &[Point], faces: &[Face], origin: Point) -> f64 {
    let from = |i: u32| super::minus(points[i as usize], origin);
    let fan = |ring: &Vec<u32>| -> f64 {
        let spans = ring.windows(2).skip(1).map(|w| super::dot(from(ring[0]), super::cross(from(w[0]), from(w[1]))));
        spans.sum()
    };
    faces.iter().flat_map(|face| &face.rings).map(fan).sum()
}

fn plane(points: &[Point], face: &Face, tolerance: f64) -> bool {
    if face.rings.len() == 1 && face.rings[0].len() == 3 {
        return true;
    }
    let (normal, _) = normal(points, face);
    let length = super::length(normal);
    if length == 0.0 {
        return false;
    }
    let corners = || face.rings.iter().flatten().map(|&i| points[i as usize]);
    let count = corners().count() as f64;
    let middle = corners().fold([0.0; 3], |sum, p| [0, 1, 2].map(|i| sum[i] + p[i] / count));
    corners().all(|p| super::dot(super::minus(p, middle), normal).abs() <= tolerance * length)
}

fn thin(points: &[Point], face: &Face) -> bool {
    let (normal, around) = normal(points, face);
    super::length(normal) <= THIN * around * around
}

#[cfg(test)]
mod tests {
    use super::super::primitive::{cuboid, sphere};
    use super::super::{IDENTITY, Matrix};
    use super::*;
    use std::sync::Arc;

    fn part(mesh: Mesh, matrix: Matrix) -> Part {
        Part { mesh: Arc::new(mesh), matrix, color: None, kind: "polyhedron", place: None }
    }

    fn cube() -> Mesh {
        cuboid([0.0; 3], [1.0; 3])
    }

    fn six_volumes(placed: &Placed) -> f64 {
        volume(&placed.mesh.points, &placed.mesh.faces, [0.0; 3])
    }

    #[test]
    fn what_is_right_stays() {
        let placed = placed(&part(cube(), IDENTITY));
        assert_eq!((placed.open_edges, placed.inside_out, placed.cut, &placed.mesh), (0, false, 0, &cube()));
        assert_eq!(six_volumes(&placed), 6.0);
    }

    #[test]
    fn mirrored_parts_are_right_side_out() {
        let placed = placed(&part(cube(), [[-2.0, 0.0, 0.0, 5.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]));
        assert_eq!((placed.inside_out, six_volumes(&placed)), (false, 12.0));
    }

    #[test]
    fn a_cube_without_a_face_is_a_cube() {
        for missing in 0..6 {
            let mut mesh = cube();
            mesh.faces.remove(missing);
            let placed = placed(&part(mesh, IDENTITY));
            assert_eq!((placed.open_edges, placed.mesh.faces.len(), six_volumes(&placed)), (4, 7, 6.0));
            assert!(unpaired(8, &placed.mesh.faces).is_empty());
        }
    }

    #[test]
    fn surfaces_inside_out_are_turned() {
        let mut mesh = sphere(3.0, 9);
        mesh.faces.iter_mut().for_each(turn);
        let placed = placed(&part(mesh, IDENTITY));
        assert!(placed.inside_out && six_volumes(&placed) > 0.0);
    }

    #[test]
    fn faces_that_are_not_plane_are_cut() {
        let mut mesh = cube();
        mesh.points[7][2] += 1e-3;
        let placed = placed(&part(mesh, IDENTITY));
        // Three faces meet in the corner, but two of them stay plane.
        assert_eq!((placed.cut, placed.mesh.faces.len(), placed.open_edges), (1, 7, 0));
        assert!(unpaired(8, &placed.mesh.faces).is_empty());
    }

    #[test]
    fn any_faces_are_closed() {
        // Every choice of faces of an octahedron and of its inside, some of them twice.
        let points = vec![[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
        let all = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        for choice in 0..4_u32.pow(8) {
            if choice % 7 != 0 {
                continue;
            }
            let faces = (0..8).flat_map(|i| std::iter::repeat_n(all[i as usize], (choice >> (2 * i) & 3) as usize));
            let mesh = Mesh { points: points.clone(), faces: faces.map(|f| Face::new(vec![f.to_vec()])).collect() };
            let (caps, _) = caps(&mesh.points, &mesh.faces);
            let closed: Vec<Face> = mesh.faces.into_iter().chain(caps).collect();
            assert!(unpaired(6, &closed).is_empty(), "{choice}");
        }
    }
}
