//! Triangles around a solid that was worked out from parts, and the faces that they are pieces of.

use foldhash::HashMap;

use super::face::normal;
use super::{Face, Mesh, Origin, Point, cross, dot, length, minus};

/// How thick a piece of a surface is at least, its volume over its area, in terms of the greatest coordinate.
pub const THIN: f64 = 1e-11;

/// How large it is at least, as the side of a cube of its volume, in the same terms. Coordinates of an STL are given to 6e-8.
pub const SMALL: f64 = 1e-6;

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
            let [a, b, c] = triangle.corners.map(|i| minus(self.points[i as usize], origin));
            dot(a, cross(b, c)) / 6.0
        };
        self.triangles.iter().map(sixth).sum()
    }

    /// Leaves out pieces that are closed by themselves and thinner than [`THIN`] or smaller than a cube of [`SMALL`]: where faces of turned operands should coincide,
    /// rounding leaves them there.
    pub fn without_slivers(mut self) -> Surface {
        let Some(&origin) = self.points.first() else { return self };
        let farthest = self.points.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
        // Corners that hang together have one first corner.
        let mut first: Vec<u32> = (0..).take(self.points.len()).collect();
        for triangle in &self.triangles {
            let roots = triangle.corners.map(|i| root(&mut first, i));
            let least = roots[0].min(roots[1]).min(roots[2]);
            roots.iter().for_each(|&i| first[i as usize] = least);
        }
        let mut pieces = vec![[0.0; 2]; self.points.len()];
        for triangle in &self.triangles {
            let [a, b, c] = triangle.corners.map(|i| minus(self.points[i as usize], origin));
            let [volume, area] = &mut pieces[root(&mut first, triangle.corners[0]) as usize];
            *volume += dot(a, cross(b, c)) / 6.0;
            *area += length(cross(minus(b, a), minus(c, a))) / 2.0;
        }
        self.triangles.retain(|triangle| {
            let [volume, area] = pieces[root(&mut first, triangle.corners[0]) as usize];
            volume.abs() > (THIN * farthest * area).max((SMALL * farthest).powi(3))
        });
        self
    }

    /// The surface as a mesh: triangles that are pieces of one face are one face, with holes where it has any, and with several outer rings where it was cut to pieces: there
    /// are no more faces than were given. No corner is left out, so neighbours keep their common edges.
    pub fn mesh(self) -> Mesh {
        let Surface { points, triangles } = self;
        let key = |i: usize| (triangles[i].origin, triangles[i].face);
        let mut order: Vec<usize> = (0..triangles.len()).collect();
        order.sort_by_key(|&i| key(i));
        let mut faces = Vec::new();
        for pieces in order.chunk_by(|&a, &b| key(a) == key(b)) {
            let corners: Vec<[u32; 3]> = pieces.iter().map(|&i| triangles[i].corners).collect();
            let rings = joined(&points, &corners);
            if !rings.is_empty() {
                faces.push(Face { rings, origin: Some(key(pieces[0]).0) });
            }
        }
        Mesh { points, faces }
    }
}

/// The first of the corners that hang together with this one.
fn root(first: &mut [u32], mut i: u32) -> u32 {
    while first[i as usize] != i {
        first[i as usize] = first[first[i as usize] as usize];
        i = first[i as usize];
    }
    i
}

/// The outlines of triangles of one face, that around most area first.
fn joined(points: &[Point], triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
    // Edges there and back, in the order of their ends.
    let mut halves: Vec<(u32, u32, bool)> = Vec::with_capacity(3 * triangles.len());
    for &[a, b, c] in triangles {
        halves.extend([(a, b), (b, c), (c, a)].map(|(from, to)| (from.min(to), from.max(to), from > to)));
    }
    halves.sort_unstable();
    let mut outline: Vec<[u32; 2]> = Vec::new();
    for same in halves.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let back = same.iter().filter(|half| half.2).count();
        let there = same.len() - back;
        let (low, high, _) = same[0];
        outline.extend(std::iter::repeat_n([low, high], there.saturating_sub(back)));
        outline.extend(std::iter::repeat_n([high, low], back.saturating_sub(there)));
    }
    let mut rings = rings(&outline);
    let area = |ring: &Vec<u32>| length(normal(points, &Face::new(vec![ring.clone()])).0);
    if rings.len() > 1 {
        let areas: Vec<f64> = rings.iter().map(area).collect();
        let outer = (0..rings.len()).max_by(|&a, &b| areas[a].total_cmp(&areas[b]).then(b.cmp(&a))).expect("more than one");
        rings.swap(0, outer);
    }
    rings
}

/// Edges joined to rings. As many leave every corner as reach it.
fn rings(edges: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut leaving: HashMap<u32, Vec<u32>> = HashMap::default();
    edges.iter().rev().for_each(|[from, to]| leaving.entry(*from).or_default().push(*to));
    let mut rings = Vec::new();
    for [start, _] in edges {
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
