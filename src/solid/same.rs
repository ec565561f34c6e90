//! What is the same: points, planes and lines within a tolerance, found once.
//!
//! What may be the same is in one cell of a grid or in neighbours: points by their coordinates, planes and lines by two numbers that hardly differ for those that are the
//! same and otherwise hardly agree. Most have nothing near them, and are told so first. Lines are looked for among the edges of faces of one plane, as only there it matters whether they are one. The largest stands
//! for the others, and ties go by coordinates, so that nothing depends on the order in which they are given.

use std::cell::Cell;

use glam::DVec3;

use super::body::{Edge, Face, Flats, Line, NOTHING, Plane, SAME};
use super::near::{Cells, Place, crowded};

/// Where a model is, and what counts as the same there.
pub(super) struct Space {
    middle: DVec3,
    size: f64,
    /// How far apart things are that count as one.
    pub(super) same: f64,
    /// Pairs that may still be compared. At 0 nothing is found any more, and what was found is of no use.
    pub(super) pairs: Cell<u64>,
}

/// A number whose order is that of the double.
pub(super) fn ordered(x: f64) -> u64 {
    let bits = (x + 0.0).to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

impl Space {
    /// The space between the least and the greatest coordinates, where so many pairs may be compared.
    pub(super) fn new(least: DVec3, most: DVec3, pairs: u64) -> Space {
        let size = (most - least).length().max(f64::MIN_POSITIVE);
        // On a coarse grid: where a part of the model moves a little, what is recorded of the others from here stays as it is, to the bit.
        let step = (size.log2().floor() - 3.0).exp2();
        let middle = (least + most) / 2.0;
        let coarse = (middle / step).round() * step;
        Space { middle: if coarse.is_finite() { coarse } else { middle }, size, same: SAME * size, pairs: pairs.into() }
    }

    /// Whether another pair may be compared.
    fn may_compare(&self) -> bool {
        self.pairs.update(|pairs| pairs.saturating_sub(1));
        self.pairs.get() > 0
    }

    /// Points that are not the same, and which each is.
    pub(super) fn distinct_points(&self, points: &[DVec3]) -> (Vec<DVec3>, Vec<u32>) {
        let cell = 64.0 * self.same;
        let order = sorted(0..points.len(), |i| ordered(points[i].x), |i| points[i].to_array().map(ordered));
        let mut cells = Cells::new(points.len(), 0);
        let (mut distinct, mut of): (Vec<DVec3>, _) = (Vec::new(), vec![0; points.len()]);
        for i in order.into_iter().map(|i| i as usize) {
            let p = points[i];
            let place = Place { at: ((p - self.middle) / cell).to_array(), near: self.same / cell };
            let found = cells.find(&place, || self.may_compare(), |other| (distinct[other as usize] - p).length() <= self.same);
            of[i] = found.unwrap_or_else(|| {
                distinct.push(p);
                cells.add(&place)
            });
        }
        (distinct, of)
    }

    /// Planes that are not the same, and which each face is in.
    pub(super) fn distinct_planes(&self, points: &[DVec3], faces: &Flats) -> (Vec<Plane>, Vec<u32>) {
        let (planes, places): (Vec<Plane>, Vec<Place<2>>) = (0..faces.len())
            .map(|i| {
                let (area, corners) = (faces.area(i), faces.corners(i));
                let (length, corner) = (area.length(), |c: &u32| points[*c as usize] - self.middle);
                let normal = area.normalize();
                let normal = if is_turned(normal) { -normal } else { normal };
                let first = corner(&corners[0]);
                let sums = corners.iter().map(corner).map(|p| (p, p.distance_squared(first)));
                let (sum, across) = sums.fold((DVec3::ZERO, 0.0_f64), |(sum, most), (p, apart)| (sum + p, most.max(apart)));
                let offset = normal.dot(sum / corners.len() as f64);
                let place = Place { at: self.numbers(normal, normal * offset), near: self.reach(length / across.sqrt()) };
                (Plane { normal, offset }, place)
            })
            .unzip();
        let crowded = crowded(&places);
        let (mut distinct, mut of): (Vec<Plane>, _) = (Vec::with_capacity(planes.len()), vec![0; planes.len()]);
        for i in (0..planes.len()).filter(|i| !crowded[*i]) {
            of[i] = distinct.len() as u32;
            distinct.push(planes[i]);
        }
        let order = sorted(
            (0..planes.len()).filter(|i| crowded[*i]),
            |i| !ordered(faces.area(i).length_squared()),
            |i| (planes[i].normal.to_array().map(ordered), ordered(planes[i].offset)),
        );
        let mut cells = Cells::new(order.len(), distinct.len() as u32);
        for i in order.into_iter().map(|i| i as usize) {
            let same = |other: u32| {
                let other: &Plane = &distinct[other as usize];
                let apart = |c: &u32| other.normal.dot(points[*c as usize] - self.middle) - other.offset;
                faces.corners(i).iter().all(|c| apart(c).abs() <= self.same)
            };
            of[i] = cells.find(&places[i], || self.may_compare(), same).unwrap_or_else(|| {
                distinct.push(planes[i]);
                cells.add(&places[i])
            });
        }
        distinct.iter_mut().for_each(|plane| plane.offset += plane.normal.dot(self.middle));
        (distinct, of)
    }

    /// Lines that are not the same; every edge is told its own.
    pub(super) fn distinct_lines(&self, points: &[DVec3], faces: &[Face], edges: &mut [Edge]) -> Vec<Line> {
        let mut lines = Lines { points, edges, same: self.same, like: (0..edges.len() as u32).collect() };
        let mut of_plane: Vec<(u32, u32)> = Vec::new();
        let mut faces_of = vec![0_u32; faces.iter().fold(0, |most, face| most.max(face.plane as usize + 1))];
        faces.iter().for_each(|face| faces_of[face.plane as usize] += 1);
        for (edge, i) in edges.iter().zip(0..) {
            let plane = |face: u32| faces.get(face as usize).map(|face| face.plane);
            let (left, right) = (plane(edge.left), plane(edge.right));
            // Between two faces of one plane nothing is to be seen of an edge.
            if left != right {
                of_plane.extend([left, right].into_iter().flatten().filter(|plane| faces_of[*plane as usize] > 1).map(|plane| (plane, i)));
            }
        }
        of_plane.sort_unstable();
        let mut group = Vec::new();
        for same in of_plane.chunk_by(|a, b| a.0 == b.0) {
            group.clear();
            group.extend(same.iter().map(|entry| entry.1));
            lines.group(&group, self);
        }
        let like = lines.like;
        let root = |mut i: u32| {
            while like[i as usize] != i {
                i = like[i as usize];
            }
            i
        };
        let mut distinct = Vec::new();
        let mut line_of = vec![NOTHING; edges.len()];
        for i in 0..edges.len() {
            let root = root(i as u32) as usize;
            if line_of[root] == NOTHING {
                line_of[root] = distinct.len() as u32;
                distinct.push(self.line(points, &edges[root]));
            }
            edges[i].line = line_of[root];
        }
        distinct
    }

    /// Two numbers, in units of cells, of a line or a plane with that direction, or its reverse, and that point next to the middle: they are about the same for
    /// those that are.
    fn numbers(&self, direction: DVec3, foot: DVec3) -> [f64; 2] {
        let [u, v, w] = MIXED.map(|mixed| direction.dot(mixed));
        let [x, y, _] = MIXED.map(|mixed| foot.dot(mixed) / self.size);
        [u * v + y, u * w + x].map(|number| number / (2.0 * FARTHEST))
    }

    /// How far apart these numbers can be, in units of cells, of what is the same as something of that size: by as much as that can be turned and shifted.
    fn reach(&self, size: f64) -> f64 {
        (8.0 * SAME * (1.0 + 2.0 * self.size / size)).min(FARTHEST) / (2.0 * FARTHEST)
    }

    /// The line through an edge's ends.
    fn line(&self, points: &[DVec3], edge: &Edge) -> Line {
        let [from, to] = [edge.from, edge.to].map(|p| points[p as usize] - self.middle);
        let along = (to - from).normalize();
        let along = if is_turned(along) { -along } else { along };
        Line { at: from - along * along.dot(from) + self.middle, along }
    }
}

/// Indices by a key, and such as have the same by another that takes longer.
fn sorted<K: Ord>(indices: impl Iterator<Item = usize>, key: impl Fn(usize) -> u64, then: impl Fn(usize) -> K) -> Vec<u32> {
    let mut order: Vec<(u64, u32)> = indices.map(|i| (key(i), i as u32)).collect();
    order.sort_unstable();
    for same in order.chunk_by_mut(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
        same.sort_by_cached_key(|entry| then(entry.1 as usize));
    }
    order.into_iter().map(|entry| entry.1).collect()
}

/// Edges, and which of them are on one line.
struct Lines<'b> {
    points: &'b [DVec3],
    edges: &'b [Edge],
    same: f64,
    /// For every edge a longer one, or as long as it, on the same line; itself if none is known.
    like: Vec<u32>,
}

/// So many edges are compared each with each other.
const FEW: usize = 12;

impl Lines<'_> {
    fn ends(&self, edge: u32) -> [DVec3; 2] {
        let Edge { from, to, .. } = self.edges[edge as usize];
        [from, to].map(|p| self.points[p as usize])
    }

    fn length_squared(&self, edge: u32) -> f64 {
        let [from, to] = self.ends(edge);
        (to - from).length_squared()
    }

    /// What stands for others comes first.
    fn key(&self, edge: u32) -> (u64, [u64; 3], [u64; 3], u32) {
        let [from, to] = self.ends(edge).map(|p| p.to_array().map(ordered));
        (!ordered(self.length_squared(edge)), from.min(to), from.max(to), edge)
    }

    /// Whether both ends of an edge are on the line of a longer one.
    fn is_on(&self, edge: u32, longer: u32) -> bool {
        let [from, to] = self.ends(longer);
        let along = to - from;
        let bound = self.same * self.same * along.length_squared();
        self.ends(edge).iter().all(|&end| (end - from).cross(along).length_squared() <= bound)
    }

    /// Finds which edges of a plane are on one line.
    fn group(&mut self, group: &[u32], space: &Space) {
        if group.len() <= FEW {
            for (k, &a) in group.iter().enumerate() {
                for &b in &group[k + 1..] {
                    let (longer, edge) = if self.length_squared(a) >= self.length_squared(b) { (a, b) } else { (b, a) };
                    if self.is_on(edge, longer) {
                        self.join(edge, longer);
                    }
                }
            }
            return;
        }
        let places: Vec<Place<2>> = group
            .iter()
            .map(|&edge| {
                let line = space.line(self.points, &self.edges[edge as usize]);
                let length = self.length_squared(edge).sqrt();
                Place { at: space.numbers(line.along, line.at - space.middle), near: space.reach(length) }
            })
            .collect();
        let crowded = crowded(&places);
        let order = sorted((0..group.len()).filter(|k| crowded[*k]), |k| !ordered(self.length_squared(group[k])), |k| self.key(group[k]));
        let mut cells = Cells::new(order.len(), 0);
        let mut distinct = Vec::new();
        for (edge, place) in order.into_iter().map(|k| (group[k as usize], &places[k as usize])) {
            let near = |other: &[f64; 2]| place.at.iter().zip(other).all(|(a, b)| (a - b).abs() <= place.near);
            let same = |other: u32| {
                let (longer, there) = &distinct[other as usize];
                near(there) && self.is_on(edge, *longer)
            };
            match cells.find(place, || space.may_compare(), same) {
                Some(other) => {
                    let longer = distinct[other as usize].0;
                    self.join(edge, longer);
                }
                None => {
                    distinct.push((edge, place.at));
                    cells.add(place);
                }
            }
        }
    }

    fn root(&self, mut edge: u32) -> u32 {
        while self.like[edge as usize] != edge {
            edge = self.like[edge as usize];
        }
        edge
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            let (first, second) = if self.key(a) < self.key(b) { (a, b) } else { (b, a) };
            self.like[second as usize] = first;
        }
    }
}

/// Directions that no model has a reason to have.
const MIXED: [DVec3; 3] = [
    DVec3::new(0.653_281_482, 0.270_598_050, 0.707_203_117),
    DVec3::new(-0.411_514_346, 0.838_670_568, 0.356_822_090),
    DVec3::new(0.314_159_265, -0.577_215_664, 0.753_700_214),
];

/// The numbers of lines and planes that are the same differ by less.
const FARTHEST: f64 = 1e-4;

/// Whether a direction is the reverse of the one that stands for both: its largest component, the first of those that are about as large, is negative.
fn is_turned(direction: DVec3) -> bool {
    let components = direction.to_array();
    let most = components.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    components.iter().find(|x| x.abs() > most - 1e-6).is_some_and(|x| *x < 0.0)
}
