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

use std::cell::Cell;
use std::collections::HashMap;

use foldhash::fast::FixedState;
use glam::DVec3;

use crate::error::{Error, Kind, Result};
use crate::mesh::check::Placed;
use crate::mesh::{Mesh, Model};
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
    /// Part and ring ends of every face.
    faces: Vec<(u32, Vec<usize>)>,
    /// Corners of all rings of all faces.
    corners: Vec<u32>,
}

impl Raw {
    fn add(&mut self, mesh: &Mesh, part: u32) {
        let before = self.points.len() as u32;
        self.points.extend(mesh.points.iter().map(|&p| DVec3::from_array(p)));
        for face in &mesh.faces {
            let mut ends = Vec::with_capacity(face.rings.len());
            for ring in &face.rings {
                self.corners.extend(ring.iter().map(|&corner| before + corner));
                ends.push(self.corners.len());
            }
            self.faces.push((part, ends));
        }
    }

    fn finish(self, model: &Model, pairs: u64) -> Result<Body> {
        let Raw { points, faces, mut corners } = self;
        let bounds = points
            .iter()
            .fold(None, |bounds: Option<(DVec3, DVec3)>, &p| Some(bounds.map_or((p, p), |(least, most)| (least.min(p), most.max(p)))));
        let (least, most) = bounds.unwrap_or_default();
        let size = (most - least).length().max(f64::MIN_POSITIVE);
        let space = Space { middle: (least + most) / 2.0, size, same: SAME * size, pairs: pairs.into() };

        let (points, point_of) = space.distinct_points(&points);
        corners.iter_mut().for_each(|corner| *corner = point_of[*corner as usize]);

        // Faces as rings of distinct corners, with their areas.
        let mut flat: Vec<Flat> = Vec::with_capacity(faces.len());
        let mut start = 0;
        for (part, ends) in faces {
            let rings: Vec<Vec<u32>> = ends
                .iter()
                .map(|&end| {
                    let mut ring = corners[std::mem::replace(&mut start, end)..end].to_vec();
                    ring.dedup();
                    while ring.len() > 1 && ring.first() == ring.last() {
                        ring.pop();
                    }
                    ring
                })
                .filter(|ring| ring.len() > 1)
                .collect();
            let area = rings.iter().map(|ring| vector_area(&points, ring)).sum::<DVec3>();
            if area.length() > space.same * space.same {
                flat.push(Flat { part, rings, area });
            }
        }
        let (planes, plane_of) = space.distinct_planes(&points, &flat);
        let faces: Vec<Face> = flat.iter().zip(plane_of).map(|(face, plane)| Face { plane, part: face.part }).collect();
        let mut edges = winged(&flat);
        let lines = space.distinct_lines(&points, &mut edges);
        let ranks = ranks(model, &points, &flat);
        if space.pairs.get() == 0 {
            let what = format!("its edges and faces are too near to each other, more than {pairs} pairs of them: use a coarser model");
            return Err(Error::input(Kind::Limit, what));
        }
        Ok(Body { points, lines, planes, edges, faces, ranks, bounds })
    }
}

/// A face while it is looked at.
struct Flat {
    part: u32,
    rings: Vec<Vec<u32>>,
    /// Half of the sum of cross products: along the normal, as long as the area.
    area: DVec3,
}

impl Flat {
    fn corners(&self) -> impl Iterator<Item = u32> {
        self.rings.iter().flatten().copied()
    }
}

/// Half the sum of the cross products of neighbours, as seen from the first corner (Newell's normal).
fn vector_area(points: &[DVec3], ring: &[u32]) -> DVec3 {
    let first = points[ring[0] as usize];
    let from_first = |corner: u32| points[corner as usize] - first;
    ring.windows(2).map(|pair| from_first(pair[0]).cross(from_first(pair[1]))).sum::<DVec3>() / 2.0
}

/// The edges of faces, two faces at each where they meet in opposite directions.
fn winged(faces: &[Flat]) -> Vec<Edge> {
    let mut halves: Vec<(u32, u32, bool, u32)> = Vec::new();
    for (face, index) in faces.iter().zip(0..) {
        for ring in &face.rings {
            let next = ring.iter().skip(1).chain(ring.first());
            halves.extend(ring.iter().zip(next).map(|(&from, &to)| (from.min(to), from.max(to), from > to, index)));
        }
    }
    // Of one part in order, so that parts that touch keep their own edges.
    let part = |half: &(u32, u32, bool, u32)| faces[half.3 as usize].part;
    halves.sort_unstable_by_key(|half| (half.0, half.1, part(half), half.2, half.3));
    let mut edges = Vec::with_capacity(halves.len() / 2 + 1);
    for same in halves.chunk_by(|a, b| (a.0, a.1, part(a)) == (b.0, b.1, part(b))) {
        let (there, back) = same.split_at(same.partition_point(|half| !half.2));
        let both = there.len().min(back.len());
        edges.extend(there.iter().zip(back).map(|(a, b)| Edge { from: a.0, to: a.1, line: 0, left: a.3, right: b.3 }));
        edges.extend(there[both..].iter().map(|a| Edge { from: a.0, to: a.1, line: 0, left: a.3, right: NOTHING }));
        edges.extend(back[both..].iter().map(|b| Edge { from: b.1, to: b.0, line: 0, left: b.3, right: NOTHING }));
    }
    edges
}

/// Corners of a part in an order of their own.
type Corners = Vec<[u64; 3]>;

/// Parts in an order of their own: by what they are, then by their place in the document.
fn ranks(model: &Model, points: &[DVec3], faces: &[Flat]) -> Vec<u32> {
    let parts = model.parts.iter().zip(0..);
    let mut keys: Vec<(Corners, Option<Rgb>, u32)> = parts.map(|(part, i)| (Corners::new(), part.color, i)).collect();
    for face in faces {
        keys[face.part as usize].0.extend(face.corners().map(|c| points[c as usize].to_array().map(ordered)));
    }
    keys.iter_mut().for_each(|key| {
        key.0.sort_unstable();
        key.0.dedup();
    });
    keys.sort_unstable();
    let mut ranks = vec![0; keys.len()];
    keys.iter().zip(0..).for_each(|(key, rank)| ranks[key.2 as usize] = rank);
    ranks
}

/// A number whose order is that of the double.
fn ordered(x: f64) -> u64 {
    let bits = (x + 0.0).to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

/// Where a model is, and what counts as the same there.
struct Space {
    middle: DVec3,
    size: f64,
    same: f64,
    /// Pairs that may still be compared. At 0 nothing is found any more, and what was found is of no use.
    pairs: Cell<u64>,
}

impl Space {
    /// Points that are not the same, and which each is.
    fn distinct_points(&self, points: &[DVec3]) -> (Vec<DVec3>, Vec<u32>) {
        let cell = 64.0 * self.same;
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        let key = |i: u32| points[i as usize].to_array().map(ordered);
        order.sort_unstable_by_key(|&i| key(i));
        let mut cells = Cells::new(points.len(), &self.pairs);
        let (mut distinct, mut of): (Vec<DVec3>, _) = (Vec::new(), vec![0; points.len()]);
        for i in order {
            let p = points[i as usize];
            let at = ((p - self.middle) / cell).to_array();
            let found = cells.find(at, self.same / cell, |other: u32| (distinct[other as usize] - p).length() <= self.same);
            of[i as usize] = found.unwrap_or_else(|| {
                distinct.push(p);
                cells.add(at, distinct.len() as u32 - 1)
            });
        }
        (distinct, of)
    }

    /// Planes that are not the same, and which each face is in.
    fn distinct_planes(&self, points: &[DVec3], faces: &[Flat]) -> (Vec<Plane>, Vec<u32>) {
        let planes: Vec<Plane> = faces
            .iter()
            .map(|face| {
                let normal = face.area.normalize();
                let normal = if is_turned(normal) { -normal } else { normal };
                let (mut sum, mut count) = (DVec3::ZERO, 0.0);
                face.corners().for_each(|c| (sum, count) = (sum + points[c as usize] - self.middle, count + 1.0));
                Plane { normal, offset: normal.dot(sum / count) }
            })
            .collect();
        let mut order: Vec<u32> = (0..faces.len() as u32).collect();
        order.sort_by_cached_key(|&i| {
            let (plane, area) = (&planes[i as usize], faces[i as usize].area.length());
            (std::cmp::Reverse(ordered(area)), plane.normal.to_array().map(ordered), ordered(plane.offset))
        });
        let mut cells = Cells::new(faces.len(), &self.pairs);
        let (mut distinct, mut of): (Vec<Plane>, _) = (Vec::new(), vec![0; faces.len()]);
        for i in order {
            let (face, plane) = (&faces[i as usize], planes[i as usize]);
            let [x, y, z] = plane.normal.to_array();
            let at = [x, y, z, plane.offset / self.size].map(|x| x * COARSE);
            let same = |other: u32| {
                let other: &Plane = &distinct[other as usize];
                face.corners().all(|c| (other.normal.dot(points[c as usize] - self.middle) - other.offset).abs() <= self.same)
            };
            of[i as usize] = cells.find(at, NEAR, same).unwrap_or_else(|| {
                distinct.push(plane);
                cells.add(at, distinct.len() as u32 - 1)
            });
        }
        distinct.iter_mut().for_each(|plane| plane.offset += plane.normal.dot(self.middle));
        (distinct, of)
    }

    /// Lines that are not the same; every edge is told its own.
    fn distinct_lines(&self, points: &[DVec3], edges: &mut [Edge]) -> Vec<Line> {
        let line = |edge: &Edge| {
            let [from, to] = [edge.from, edge.to].map(|p| points[p as usize] - self.middle);
            let along = (to - from).normalize();
            let along = if is_turned(along) { -along } else { along };
            Line { at: from - along * along.dot(from), along }
        };
        let ends = |edge: &Edge| [edge.from, edge.to].map(|p| points[p as usize] - self.middle);
        let mut order: Vec<u32> = (0..edges.len() as u32).collect();
        order.sort_by_cached_key(|&i| {
            let edge = &edges[i as usize];
            let [from, to] = ends(edge).map(|p| p.to_array().map(ordered));
            (std::cmp::Reverse(ordered(points[edge.from as usize].distance(points[edge.to as usize]))), from.min(to), from.max(to))
        });
        let mut cells = Cells::new(edges.len(), &self.pairs);
        let mut distinct: Vec<Line> = Vec::new();
        for i in order {
            let edge = &mut edges[i as usize];
            let (own, ends) = (line(edge), ends(edge));
            let ([u, v, w], [x, y, z]) = (own.along.to_array(), (own.at / self.size).to_array());
            let at = [u, v, w, x, y, z].map(|x| x * COARSE);
            let same = |other: u32| {
                let other: &Line = &distinct[other as usize];
                ends.iter().all(|&end| (end - other.at).cross(other.along).length() <= self.same)
            };
            edge.line = cells.find(at, NEAR, same).unwrap_or_else(|| {
                distinct.push(own);
                cells.add(at, distinct.len() as u32 - 1)
            });
        }
        distinct.iter_mut().for_each(|line| line.at += self.middle);
        distinct
    }
}

/// Cells to a unit in which lines and planes are looked for, and how near to a border its other side is looked at too.
const COARSE: f64 = 256.0;
const NEAR: f64 = 1.0 / 64.0;

/// Whether a direction is the reverse of the one that stands for both: its largest component, the first of those that are about as large, is negative.
fn is_turned(direction: DVec3) -> bool {
    let components = direction.to_array();
    let most = components.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    components.iter().find(|x| x.abs() > most - 1e-6).is_some_and(|x| *x < 0.0)
}

/// Items by the cell of a grid that they are in.
struct Cells<'s, const N: usize> {
    /// See [`Space::pairs`].
    pairs: &'s Cell<u64>,
    /// The last item of a cell.
    last: HashMap<[i32; N], u32, FixedState>,
    /// For every item the one before it in its cell.
    before: Vec<u32>,
}

impl<'s, const N: usize> Cells<'s, N> {
    fn new(items: usize, pairs: &'s Cell<u64>) -> Cells<'s, N> {
        Cells { pairs, last: HashMap::with_capacity_and_hasher(items.min(1 << 16), FixedState::default()), before: Vec::new() }
    }

    /// Adds item `item`, the next number, at a place in units of cells.
    fn add(&mut self, at: [f64; N], item: u32) -> u32 {
        debug_assert_eq!(item as usize, self.before.len());
        let before = self.last.insert(at.map(|x| x.floor() as i32), item);
        self.before.push(before.unwrap_or(NOTHING));
        item
    }

    /// The first item that is the same as one at that place, among those of its cell and of others nearer than `near`.
    fn find(&self, at: [f64; N], near: f64, same: impl Fn(u32) -> bool) -> Option<u32> {
        let cell = at.map(|x| x.floor() as i32);
        // Cells to look at in each direction: this one, and one beside it if that is near.
        let beside = at.map(|x| {
            let within = x - x.floor();
            if within < near {
                -1
            } else if within > 1.0 - near {
                1
            } else {
                0
            }
        });
        let mut found = None;
        for choice in 0..1_u32 << N {
            let mut other = cell;
            let valid = (0..N).all(|i| {
                choice >> i & 1 == 0 || {
                    other[i] = other[i].wrapping_add(beside[i]);
                    beside[i] != 0
                }
            });
            if !valid {
                continue;
            }
            let mut item = self.last.get(&other).copied().unwrap_or(NOTHING);
            while item != NOTHING && self.pairs.get() > 0 {
                self.pairs.update(|pairs| pairs - 1);
                if found.is_none_or(|found| item < found) && same(item) {
                    found = Some(item);
                }
                item = self.before[item as usize];
            }
        }
        found
    }
}
