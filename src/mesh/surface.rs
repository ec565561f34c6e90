//! Triangles around a solid that was worked out from parts, and the faces that they are pieces of.

use foldhash::HashMap;

use super::face::normal;
use super::{Face, Mesh, Origin, Point, dot, length};

/// A triangle, counterclockwise as seen from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triangle {
    /// Indices into [`Surface::points`].
    pub corners: [u32; 3],
    /// Whose surface it is a piece of.
    pub origin: Origin,
    /// Which of the faces that were given it is a piece of.
    pub face: u32,
}

/// A closed surface: every edge is used equally often in both directions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// The corners.
    pub points: Vec<Point>,
    /// The triangles.
    pub triangles: Vec<Triangle>,
}

impl Surface {
    /// The volume within.
    pub fn volume(&self) -> f64 {
        // From a corner, so that what is far from the origin loses no digits.
        let Some(&origin) = self.points.first() else { return 0.0 };
        let sixth = |triangle: &Triangle| {
            let [a, b, c] = triangle.corners.map(|i| super::minus(self.points[i as usize], origin));
            dot(a, super::cross(b, c)) / 6.0
        };
        self.triangles.iter().map(sixth).sum()
    }

    /// The surface as a mesh: triangles that are pieces of one face and share an edge are one face, with holes where it has any. No corner is left out, so neighbours keep
    /// their common edges.
    pub fn mesh(self) -> Mesh {
        let Surface { points, triangles } = self;
        let key = |i: usize| (triangles[i].origin, triangles[i].face);
        let mut order: Vec<usize> = (0..triangles.len()).collect();
        order.sort_by_key(|&i| key(i));
        let mut faces = Vec::new();
        for pieces in order.chunk_by(|&a, &b| key(a) == key(b)) {
            let corners: Vec<[u32; 3]> = pieces.iter().map(|&i| triangles[i].corners).collect();
            faces.extend(joined(&points, &corners).into_iter().map(|rings| Face { rings, origin: Some(key(pieces[0]).0) }));
        }
        Mesh { points, faces }
    }
}

/// The outlines of triangles of one face, those of what hangs together by edges as one: the outer ring first.
fn joined(points: &[Point], triangles: &[[u32; 3]]) -> Vec<Vec<Vec<u32>>> {
    // Edges there and back, in the order of their ends.
    let mut halves: Vec<(u32, u32, bool, usize)> = Vec::with_capacity(3 * triangles.len());
    for (i, &[a, b, c]) in triangles.iter().enumerate() {
        halves.extend([(a, b), (b, c), (c, a)].map(|(from, to)| (from.min(to), from.max(to), from > to, i)));
    }
    halves.sort_unstable();
    let mut group: Vec<usize> = (0..triangles.len()).collect();
    let mut outline: Vec<([u32; 2], usize)> = Vec::new();
    for same in halves.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let (there, back) = same.split_at(same.partition_point(|half| !half.2));
        for (a, b) in there.iter().zip(back) {
            let [a, b] = [a.3, b.3].map(|i| root(&mut group, i));
            group[a.max(b)] = a.min(b);
        }
        let both = there.len().min(back.len());
        outline.extend(there[both..].iter().map(|half| ([half.0, half.1], half.3)));
        outline.extend(back[both..].iter().map(|half| ([half.1, half.0], half.3)));
    }
    outline.iter_mut().for_each(|(_, triangle)| *triangle = root(&mut group, *triangle));
    outline.sort_unstable_by_key(|&(edge, group)| (group, edge));
    outline.chunk_by(|a, b| a.1 == b.1).map(|edges| outer_first(points, rings(edges))).collect()
}

/// The first of the triangles that hang together with this one.
fn root(group: &mut [usize], mut i: usize) -> usize {
    while group[i] != i {
        group[i] = group[group[i]];
        i = group[i];
    }
    i
}

/// Edges joined to rings. As many leave every corner as reach it.
fn rings(edges: &[([u32; 2], usize)]) -> Vec<Vec<u32>> {
    let mut leaving: HashMap<u32, Vec<u32>> = HashMap::default();
    edges.iter().rev().for_each(|([from, to], _)| leaving.entry(*from).or_default().push(*to));
    let mut rings = Vec::new();
    for ([start, _], _) in edges {
        let mut ring = Vec::new();
        let mut at = *start;
        while let Some(next) = leaving.get_mut(&at).and_then(Vec::pop) {
            ring.push(at);
            at = next;
            if at == *start {
                break;
            }
        }
        if !ring.is_empty() {
            rings.push(ring);
        }
    }
    rings
}

/// The ring around most area first.
fn outer_first(points: &[Point], mut rings: Vec<Vec<u32>>) -> Vec<Vec<u32>> {
    let area = |ring: &Vec<u32>| length(normal(points, &Face::new(vec![ring.clone()])).0);
    if rings.len() > 1 {
        let areas: Vec<f64> = rings.iter().map(area).collect();
        let outer = (0..rings.len()).max_by(|&a, &b| areas[a].total_cmp(&areas[b]).then(b.cmp(&a))).expect("more than one");
        rings.swap(0, outer);
    }
    rings
}
