//! What a model is made of, with identity: points, lines and planes that are the same are one.
//!
//! Coplanar faces of different parts have equal depths only if these come from one record, and edges on one line have the same columns only if their line
//! is one ("CSG" in ARCHITECTURE.md, section 3.3.4, step 5, counts equal depths together). So both are found once, when a model is read, within a tolerance, and
//! not by a comparison with a tolerance wherever two depths meet:
//!
//! ```text
//!      +---------+                    points   what is within 1e-9 of the model's size is one
//!      |  A      |                    lines    an edge is on the line of a longer one if its ends are within that of it
//!      |    +----|----+               planes   a face is in the plane of a larger one if its corners are within that of it
//!      +----+----+  B |
//!           +---------+               the two lower sides are one line, the two front faces one plane
//! ```
//!
//! The longest edge and the largest face stand for theirs, and ties go by coordinates: nothing depends on the order of the document. A plane and its
//! reverse are one record.
//!
//! Edges are winged ("CSG", section 4.1): an edge knows the face on each of its sides. In an open mesh, or where more than two faces meet, an edge has one
//! face and nothing on its other side.

use glam::DVec3;

use super::same::{Space, ordered};
use crate::error::{Error, Kind, Result};
use crate::mesh::check::Placed;
use crate::mesh::{Mesh, Model, Origin};
use crate::run::Rgb;

/// How far apart things are that count as one, in terms of the model's size.
pub const SAME: f64 = 1e-9;

/// No face.
pub const NOTHING: u32 = u32::MAX;

/// A line in space.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// A point on it.
    pub at: DVec3,
    /// A unit vector along it.
    pub along: DVec3,
}

/// A plane in space: points with `normal · p = offset`.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    /// A unit vector.
    pub normal: DVec3,
    /// Distance from the origin along it.
    pub offset: f64,
}

/// An edge of the surface of a part.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// Where it begins, as `left` sees it.
    pub from: u32,
    /// Where it ends.
    pub to: u32,
    /// The line that it is on.
    pub line: u32,
    /// The face that has it in this direction.
    pub left: u32,
    /// The face that has it in the other direction, or [`NOTHING`].
    pub right: u32,
}

/// A face.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    /// Its plane.
    pub plane: u32,
    /// Its part: an index into the model's parts.
    pub part: u32,
    /// Whose surface it shows.
    pub origin: Origin,
}

/// A model with identity, in no view yet.
#[derive(Clone, Debug, Default)]
pub struct Body {
    /// Distinct points.
    pub points: Vec<DVec3>,
    /// Distinct lines.
    pub lines: Vec<Line>,
    /// Distinct planes.
    pub planes: Vec<Plane>,
    /// Edges of all parts.
    pub edges: Vec<Edge>,
    /// Faces of all parts, in the order of the parts.
    pub faces: Vec<Face>,
    /// For every part its place in an order that does not depend on that of the document, but for parts that are the same.
    pub ranks: Vec<u32>,
    /// The least and the greatest coordinates.
    pub bounds: Option<(DVec3, DVec3)>,
}

impl Body {
    /// The faces and edges of a model's parts, which are given at their places ([`crate::mesh::check`]). Faces without an area and edges without a
    /// length are left out. At most `pairs` of points, edges and faces are compared with each other.
    ///
    /// # Errors
    /// So many are near each other that it would be more.
    pub fn new(model: &Model, placed: &[Placed], pairs: u64) -> Result<Body> {
        let mut raw = Raw::default();
        for (part, index) in placed.iter().zip(0..) {
            raw.add(&part.mesh, index);
        }
        raw.finish(model, pairs)
    }
}

/// What is gathered from the parts.
#[derive(Default)]
struct Raw {
    points: Vec<DVec3>,
    /// Part, origin and number of rings of every face.
    faces: Vec<(u32, Origin, usize)>,
    /// Where every ring ends in `corners`.
    ends: Vec<usize>,
    /// Corners of all rings of all faces.
    corners: Vec<u32>,
}

impl Raw {
    fn add(&mut self, mesh: &Mesh, part: u32) {
        let before = self.points.len() as u32;
        self.points.extend(mesh.points.iter().map(|&p| DVec3::from_array(p)));
        for face in &mesh.faces {
            for ring in &face.rings {
                self.corners.extend(ring.iter().map(|&corner| before + corner));
                self.ends.push(self.corners.len());
            }
            self.faces.push((part, face.origin.unwrap_or(Origin { turned: false, part }), face.rings.len()));
        }
    }

    fn finish(self, model: &Model, pairs: u64) -> Result<Body> {
        let bounds = self
            .points
            .iter()
            .fold(None, |bounds: Option<(DVec3, DVec3)>, &p| Some(bounds.map_or((p, p), |(least, most)| (least.min(p), most.max(p)))));
        let (least, most) = bounds.unwrap_or_default();
        let space = Space::new(least, most, pairs);
        let (points, point_of) = space.distinct_points(&self.points);
        let flats = self.flats(&points, &point_of, space.same * space.same);
        let (planes, plane_of) = space.distinct_planes(&points, &flats);
        let face = |(flat, plane): (&Flat, u32)| Face { plane, part: flat.part, origin: flat.origin };
        let faces: Vec<Face> = flats.faces.iter().zip(plane_of).map(face).collect();
        let mut edges = winged(points.len(), &flats);
        let lines = space.distinct_lines(&points, &faces, &mut edges);
        let ranks = ranks(model, &points, &flats);
        if space.pairs.get() == 0 {
            let what = format!("its edges and faces are too near to each other, more than {pairs} pairs of them: use a coarser model");
            return Err(Error::input(Kind::Limit, what));
        }
        Ok(Body { points, lines, planes, edges, faces, ranks, bounds })
    }

    /// The faces with an area of more than `least`, as rings of distinct points.
    fn flats(self, points: &[DVec3], point_of: &[u32], least: f64) -> Flats {
        let mut flats = Flats::default();
        let (mut ends, mut start) = (self.ends.iter(), 0);
        for (part, origin, rings) in self.faces {
            let (first_ring, first_corner) = (flats.ends.len(), flats.corners.len());
            let mut area = DVec3::ZERO;
            for &end in ends.by_ref().take(rings) {
                let ring = flats.corners.len();
                for &corner in &self.corners[std::mem::replace(&mut start, end)..end] {
                    let point = point_of[corner as usize];
                    if flats.corners[ring..].last() != Some(&point) {
                        flats.corners.push(point);
                    }
                }
                while flats.corners.len() > ring + 1 && flats.corners[ring] == flats.corners[flats.corners.len() - 1] {
                    flats.corners.pop();
                }
                if flats.corners.len() > ring + 1 {
                    area += vector_area(points, &flats.corners[ring..]);
                    flats.ends.push(flats.corners.len());
                } else {
                    flats.corners.truncate(ring);
                }
            }
            if area.length() > least {
                flats.faces.push(Flat { part, origin, area, corners: flats.corners.len(), rings: flats.ends.len() });
            } else {
                flats.corners.truncate(first_corner);
                flats.ends.truncate(first_ring);
            }
        }
        flats
    }
}

/// Faces while they are looked at.
#[derive(Default)]
pub(super) struct Flats {
    faces: Vec<Flat>,
    /// Where every ring ends in `corners`.
    ends: Vec<usize>,
    /// Corners of all rings of all faces.
    corners: Vec<u32>,
}

/// One of them.
struct Flat {
    part: u32,
    origin: Origin,
    /// Half of the sum of cross products: along the normal, as long as the area.
    area: DVec3,
    /// Where its corners end.
    corners: usize,
    /// Where its rings end.
    rings: usize,
}

impl Flats {
    /// How many faces there are.
    pub(super) fn len(&self) -> usize {
        self.faces.len()
    }

    /// Along the normal of a face, as long as its area.
    pub(super) fn area(&self, face: usize) -> DVec3 {
        self.faces[face].area
    }

    /// The corners of all rings of a face.
    pub(super) fn corners(&self, face: usize) -> &[u32] {
        let start = face.checked_sub(1).map_or(0, |before| self.faces[before].corners);
        &self.corners[start..self.faces[face].corners]
    }

    fn rings(&self, face: usize) -> impl Iterator<Item = &[u32]> {
        let start = face.checked_sub(1).map_or(0, |before| self.faces[before].rings);
        let begin = |ring: usize| ring.checked_sub(1).map_or(0, |before| self.ends[before]);
        (start..self.faces[face].rings).map(move |ring| &self.corners[begin(ring)..self.ends[ring]])
    }
}

/// Half the sum of the cross products of neighbours, as seen from the first corner (Newell's normal).
fn vector_area(points: &[DVec3], ring: &[u32]) -> DVec3 {
    let first = points[ring[0] as usize];
    let from_first = |corner: u32| points[corner as usize] - first;
    ring.windows(2).map(|pair| from_first(pair[0]).cross(from_first(pair[1]))).sum::<DVec3>() / 2.0
}

/// The edges of faces between so many points, two faces at each where they meet in opposite directions.
fn winged(points: usize, flats: &Flats) -> Vec<Edge> {
    let halves = || {
        (0..flats.len()).flat_map(|face| {
            flats.rings(face).flat_map(move |ring| {
                let next = ring.iter().skip(1).chain(ring.first());
                ring.iter().zip(next).map(move |(&from, &to)| (from, to, face as u32))
            })
        })
    };
    // By the lesser of their ends, spread over as many buckets as there are points.
    let mut ends = vec![0_u32; points + 1];
    halves().for_each(|(from, to, _)| ends[from.min(to) as usize + 1] += 1);
    for i in 0..points {
        ends[i + 1] += ends[i];
    }
    let mut spread = vec![(0, false, 0); ends[points] as usize];
    let mut filled = ends.clone();
    for (from, to, face) in halves() {
        let place = &mut filled[from.min(to) as usize];
        spread[*place as usize] = (from.max(to), from > to, face);
        *place += 1;
    }
    let mut edges = Vec::with_capacity(spread.len() / 2 + 1);
    // Of one part in order, so that parts that touch keep their own edges.
    let part = |half: &(u32, bool, u32)| flats.faces[half.2 as usize].part;
    for (least, bucket) in (0..).zip(ends.windows(2)) {
        let halves = &mut spread[bucket[0] as usize..bucket[1] as usize];
        halves.sort_unstable_by_key(|half| (half.0, part(half), half.1, half.2));
        for same in halves.chunk_by(|a, b| (a.0, part(a)) == (b.0, part(b))) {
            let (there, back) = same.split_at(same.partition_point(|half| !half.1));
            let (most, both) = (same[0].0, there.len().min(back.len()));
            edges.extend(there.iter().zip(back).map(|(a, b)| Edge { from: least, to: most, line: 0, left: a.2, right: b.2 }));
            edges.extend(there[both..].iter().map(|a| Edge { from: least, to: most, line: 0, left: a.2, right: NOTHING }));
            edges.extend(back[both..].iter().map(|b| Edge { from: most, to: least, line: 0, left: b.2, right: NOTHING }));
        }
    }
    edges
}

/// Parts in an order of their own: by what they are, then by their place in the document.
fn ranks(model: &Model, points: &[DVec3], flats: &Flats) -> Vec<u32> {
    // Sums of well-mixed numbers of their distinct corners: any order will do that depends on nothing else.
    let mut keys: Vec<(u64, Option<Rgb>, u32)> = model.parts.iter().zip(0..).map(|(part, i)| (0, part.color, i)).collect();
    let mut last = vec![NOTHING; points.len()];
    for (i, face) in flats.faces.iter().enumerate() {
        for &corner in flats.corners(i) {
            if std::mem::replace(&mut last[corner as usize], face.part) != face.part {
                let mixed = points[corner as usize].to_array().iter().fold(0, |seed, &x| mix(seed ^ ordered(x)));
                let key = &mut keys[face.part as usize].0;
                *key = key.wrapping_add(mixed);
            }
        }
    }
    keys.sort_unstable();
    let mut ranks = vec![0; keys.len()];
    keys.iter().zip(0..).for_each(|(key, rank)| ranks[key.2 as usize] = rank);
    ranks
}

/// Spreads a number over all 64 bits (splitmix64).
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}
