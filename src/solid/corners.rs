//! Smooth surfaces: a normal for every corner of every face, and triangles over which it is interpolated.
//!
//! Faces of a part's surface that share an edge are *joined* there if the angle between their normals is below a limit. The normal at a corner of a face is the mean over the faces around
//! it that are joined to it, one to the next; each counts as much as its angle there, so that it does not matter how a plane is cut into faces:
//!
//! ```text
//!        \  |  /                around a corner, from above: three faces that are joined
//!         \a|b/                 (a, b, c), and two whose edges to their neighbours are sharp (=):
//!     ==== \|/ ----             the corner has one normal in a, b and c and one in each of d, e
//!        d  *   c
//!          / =
//!         = e =
//! ```
//!
//! Two faces that are joined have the same normals at both ends of their edge, so what is interpolated along it is the same in both. Faces
//! whose normals are all their plane's stay flat. This is of the body as it was read: a plane that cuts it changes no normal, and caps are flat.
//!
//! H. Gouraud, "Continuous shading of curved surfaces" (1971), and B. T. Phong, "Illumination for computer generated pictures" (1975), for the interpolation of normals;
//! G. Thürmer and C. Wüthrich, "Computing vertex normals from polygonal facets" (1998), for the weights.

use glam::DVec3;

use super::body::{Body, NOTHING};
use crate::mesh::Face;
use crate::mesh::triangles::triangles;

/// A triangle of a face: its corners as points of the body, and a normal for each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    pub(super) points: [u32; 3],
    pub(super) normals: [u32; 3],
}

/// The faces that are not flat.
#[derive(Clone, Debug)]
pub(super) struct Corners {
    /// Where the triangles of each face begin; one more at the end. A flat face has none.
    first: Vec<u32>,
    triangles: Vec<Triangle>,
    /// Unit vectors that point out of the part.
    normals: Vec<DVec3>,
}

/// Normals that are so far apart count as one.
const ALIKE: f64 = 1e-9;

impl Corners {
    /// Of a body whose faces are joined where their normals are less than `angle` degrees apart.
    pub(super) fn new(body: &Body, angle: f64) -> Corners {
        let halves = Halves::new(body);
        let least = angle.to_radians().cos();
        let mut groups = Groups((0..halves.from.len() as u32).collect());
        for &[there, back] in &halves.pairs {
            let faces = [there, back].map(|half| halves.face[half as usize] as usize);
            let [one, other] = faces.map(|face| halves.normals[face]);
            let [origin, also] = faces.map(|face| body.faces[face].origin);
            if one.dot(other) > least && origin == also {
                groups.join(there, halves.next[back as usize]);
                groups.join(halves.next[there as usize], back);
            }
        }
        let mut sums = vec![DVec3::ZERO; halves.from.len()];
        for (half, weight) in (0..).zip(halves.angles(body)) {
            let group = groups.of(half);
            groups.0[half as usize] = group;
            sums[group as usize] += weight * halves.normals[halves.face[half as usize] as usize];
        }
        sums.iter_mut().for_each(|sum| *sum = sum.normalize_or_zero());

        let mut corners = Corners { first: vec![0], triangles: Vec::new(), normals: Vec::new() };
        let mut number = vec![NOTHING; sums.len()];
        for (face, of_face) in halves.first.windows(2).enumerate() {
            let (range, own) = (of_face[0]..of_face[1], halves.normals[face]);
            let bent = |&half: &u32| {
                let normal = sums[groups.0[half as usize] as usize];
                normal != DVec3::ZERO && (normal - own).length() > ALIKE
            };
            if range.clone().any(|half| bent(&half)) {
                // Every corner is a point of its own, so that one that is passed twice has both its normals.
                let points: Vec<_> = range.clone().map(|half| body.points[halves.from[half as usize] as usize].to_array()).collect();
                for triangle in triangles(&points, &halves.outline(range.clone())) {
                    let halves_of = triangle.map(|corner| range.start + corner);
                    let normals = halves_of.map(|half| {
                        let group = groups.0[half as usize] as usize;
                        if number[group] == NOTHING {
                            number[group] = corners.normals.len() as u32;
                            corners.normals.push(if sums[group] == DVec3::ZERO { own } else { sums[group] });
                        }
                        number[group]
                    });
                    corners.triangles.push(Triangle { points: halves_of.map(|half| halves.from[half as usize]), normals });
                }
            }
            corners.first.push(corners.triangles.len() as u32);
        }
        corners
    }

    /// The triangles of a face; none if it is flat, or the cap of a cut.
    pub(super) fn of(&self, face: u32) -> &[Triangle] {
        match self.first.get(face as usize..face as usize + 2) {
            Some(&[start, end]) => &self.triangles[start as usize..end as usize],
            _ => &[],
        }
    }

    pub(super) fn normal(&self, index: u32) -> DVec3 {
        self.normals[index as usize]
    }

    /// About how many bytes it holds.
    pub(super) fn weight(&self) -> usize {
        size_of_val(&self.first[..]) + size_of_val(&self.triangles[..]) + size_of_val(&self.normals[..])
    }
}

/// The directed edges of all faces, face after face. A half is also the corner that it begins at.
struct Halves {
    /// Where those of each face begin; one more at the end.
    first: Vec<u32>,
    from: Vec<u32>,
    face: Vec<u32>,
    /// The half that goes on where this one ends, in the same face.
    next: Vec<u32>,
    /// The two halves of every edge that has two faces.
    pairs: Vec<[u32; 2]>,
    /// For every face its plane's normal, out of the part.
    normals: Vec<DVec3>,
}

impl Halves {
    fn new(body: &Body) -> Halves {
        let faces = body.faces.len();
        let mut first = vec![0_u32; faces + 1];
        let sides = |edge: &super::body::Edge| [(edge.left, edge.from, edge.to), (edge.right, edge.to, edge.from)];
        for (face, ..) in body.edges.iter().flat_map(sides).filter(|side| side.0 != NOTHING) {
            first[face as usize + 1] += 1;
        }
        for i in 0..faces {
            first[i + 1] += first[i];
        }
        let mut filled = first.clone();
        let count = first[faces] as usize;
        let (mut from, mut to, mut face, mut pairs) = (vec![0; count], vec![0; count], vec![0; count], Vec::new());
        for edge in &body.edges {
            let halves = sides(edge).map(|(of, start, end)| {
                let half = *filled.get(of as usize)?;
                filled[of as usize] += 1;
                (from[half as usize], to[half as usize], face[half as usize]) = (start, end, of);
                Some(half)
            });
            if let [Some(there), Some(back)] = halves {
                pairs.push([there, back]);
            }
        }
        let next = next(&first, &from, &to);
        let mut halves = Halves { first, from, face, next, pairs, normals: Vec::new() };
        halves.normals = (0..faces).map(|face| halves.normal(body, face)).collect();
        halves
    }

    fn normal(&self, body: &Body, face: usize) -> DVec3 {
        let range = self.first[face] as usize..self.first[face + 1] as usize;
        let normal = body.planes[body.faces[face].plane as usize].normal;
        let Some(&origin) = self.from.get(range.start) else { return normal };
        let at = |p: u32| body.points[p as usize] - body.points[origin as usize];
        let area: DVec3 = range.map(|half| at(self.from[half]).cross(at(self.from[self.next[half] as usize]))).sum();
        if area.dot(normal) < 0.0 { -normal } else { normal }
    }

    /// For every half the angle of its face at the corner where it begins, in radians.
    fn angles(&self, body: &Body) -> Vec<f64> {
        let mut angles = vec![0.0; self.from.len()];
        for half in 0..self.from.len() {
            let corner = self.next[half] as usize;
            let [before, at, behind] = [half, corner, self.next[corner] as usize].map(|half| body.points[self.from[half] as usize]);
            let (out, back) = (behind - at, before - at);
            let angle = self.normals[self.face[half] as usize].dot(out.cross(back)).atan2(out.dot(back));
            angles[corner] = if angle < 0.0 { angle + std::f64::consts::TAU } else { angle };
        }
        angles
    }

    /// The rings of a face whose halves these are, by their places among them.
    fn outline(&self, range: std::ops::Range<u32>) -> Face {
        let mut seen = vec![false; range.len()];
        let mut face = Face::default();
        for start in range.clone() {
            let (mut ring, mut half) = (Vec::new(), start);
            while !std::mem::replace(&mut seen[(half - range.start) as usize], true) {
                ring.push(half - range.start);
                half = self.next[half as usize];
            }
            if !ring.is_empty() {
                face.rings.push(ring);
            }
        }
        face
    }
}

/// For every half the one of its face that begins where it ends. Where several do, each is taken once.
fn next(first: &[u32], from: &[u32], to: &[u32]) -> Vec<u32> {
    let mut next = vec![0; from.len()];
    let (mut begins, mut ends) = (Vec::new(), Vec::new());
    for of_face in first.windows(2) {
        let range = of_face[0]..of_face[1];
        // A ring closes, so as many begin at a point as end there.
        begins.clear();
        begins.extend(range.clone().map(|half| (from[half as usize], half)));
        begins.sort_unstable();
        ends.clear();
        ends.extend(range.map(|half| (to[half as usize], half)));
        ends.sort_unstable();
        begins.iter().zip(&ends).for_each(|(begin, end)| next[end.1 as usize] = begin.1);
    }
    next
}

/// Sets of corners that share a normal, each named by its least (union and find, with paths halved).
struct Groups(Vec<u32>);

impl Groups {
    fn of(&mut self, mut corner: u32) -> u32 {
        while self.0[corner as usize] != corner {
            let up = self.0[self.0[corner as usize] as usize];
            self.0[corner as usize] = up;
            corner = up;
        }
        corner
    }

    fn join(&mut self, one: u32, other: u32) {
        let [one, other] = [self.of(one), self.of(other)];
        self.0[one.max(other) as usize] = one.min(other);
    }
}
