//! Convex hulls, in the plane and in space.
//!
//! In space: points are added to a tetrahedron one after the other; every face knows the points outside it (conflict lists, Clarkson and
//! Shor 1989), and the faces that a point sees are replaced by the cone from it over their edge. Which side a point is on is decided exactly
//! (`robust`, after Shewchuk 1997), so that points of one plane, of which models are full, do no harm. Expected cost n log n.

use foldhash::{HashMap, HashSet};
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::build::Builder;
use super::outline::Outline;
use super::{Mesh, Point};

/// The hull of an outline's corners; empty if they lie on a line.
pub fn plane(outline: &Outline) -> Outline {
    let mut points: Vec<[f64; 2]> = outline.contours().iter().flatten().copied().collect();
    points.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    let coord = |p: [f64; 2]| Coord { x: p[0], y: p[1] };
    let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && orient2d(coord(a), coord(b), coord(p)) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut ring = half(&mut points.iter().copied());
    ring.extend(half(&mut points.iter().rev().copied()));
    if ring.len() > 2 { Outline::simple(ring) } else { Outline::default() }
}

/// Positive where `d` lies on the side from which `a`, `b`, `c` are counterclockwise.
fn above([a, b, c]: [Point; 3], d: Point) -> f64 {
    let coord = |p: Point| Coord3D { x: p[0], y: p[1], z: p[2] };
    -orient3d(coord(a), coord(b), coord(c), coord(d))
}

/// A face of the hull that grows.
struct Facet {
    corners: [u32; 3],
    /// Points that see it and no face before it.
    outside: Vec<u32>,
}

/// The hull of points in space, in triangles; empty if they lie in a plane.
pub fn solid(points: &[Point]) -> Mesh {
    let points = distinct(points);
    let Some(first) = tetrahedron(&points) else { return Mesh::default() };
    let at = |i: u32| points[i as usize];
    let sees = |corners: [u32; 3], p: u32| above(corners.map(at), at(p)) > 0.0;
    let [a, b, c, d] = first;
    let mut facets: Vec<Option<Facet>> = Vec::new();
    // The face on the other side of a directed edge's reverse.
    let mut on: HashMap<[u32; 2], usize> = HashMap::default();
    let add = |facets: &mut Vec<Option<Facet>>, on: &mut HashMap<[u32; 2], usize>, corners: [u32; 3], candidates: &mut Vec<u32>| {
        let [p, q, r] = corners;
        on.extend([[p, q], [q, r], [r, p]].map(|edge| (edge, facets.len())));
        let (outside, left) = candidates.drain(..).partition(|&i| sees(corners, i));
        *candidates = left;
        facets.push(Some(Facet { corners, outside }));
    };
    let mut rest: Vec<u32> = (0..points.len() as u32).filter(|i| !first.contains(i)).collect();
    for corners in [[a, b, c], [a, d, b], [b, d, c], [c, d, a]] {
        add(&mut facets, &mut on, corners, &mut rest);
    }
    let mut next = 0;
    while next < facets.len() {
        let Some(&point) = facets[next].as_ref().and_then(|facet| facet.outside.first()) else {
            next += 1;
            continue;
        };
        // What the point sees, from this face on, and the edge of that.
        let mut seen = vec![next];
        let mut known: HashSet<usize> = HashSet::default();
        known.insert(next);
        let mut rim = Vec::new();
        let mut i = 0;
        while let Some(&facet) = seen.get(i) {
            i += 1;
            let [p, q, r] = facets[facet].as_ref().expect("only faces of the hull are reached").corners;
            for edge in [[p, q], [q, r], [r, p]] {
                let other = on[&[edge[1], edge[0]]];
                if known.contains(&other) {
                    continue;
                }
                if sees(facets[other].as_ref().expect("only faces of the hull are reached").corners, point) {
                    known.insert(other);
                    seen.push(other);
                } else {
                    rim.push(edge);
                }
            }
        }
        let mut orphans: Vec<u32> = Vec::new();
        for facet in seen {
            let gone = facets[facet].take().expect("only faces of the hull are reached");
            let [p, q, r] = gone.corners;
            for edge in [[p, q], [q, r], [r, p]] {
                if on.get(&edge) == Some(&facet) {
                    on.remove(&edge);
                }
            }
            orphans.extend(gone.outside.into_iter().filter(|&i| i != point));
        }
        for [p, q] in rim {
            add(&mut facets, &mut on, [p, q, point], &mut orphans);
        }
    }
    let mut mesh = Builder::default();
    for facet in facets.into_iter().flatten() {
        let ring = facet.corners.map(|i| mesh.point(at(i))).to_vec();
        mesh.face([ring]);
    }
    mesh.finish()
}

/// The points without repetition, in an order that does not depend on where they came from: shuffled, so that the expected cost holds.
fn distinct(points: &[Point]) -> Vec<Point> {
    let mut points: Vec<Point> = points.iter().map(|p| p.map(|x| x + 0.0)).collect();
    let order = |a: &Point, b: &Point| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]));
    points.sort_unstable_by(order);
    points.dedup();
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    for i in (1..points.len()).rev() {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        points.swap(i, ((state >> 33) % (i as u64 + 1)) as usize);
    }
    points
}

/// Four points that do not lie in a plane, the first three counterclockwise as seen from outside.
fn tetrahedron(points: &[Point]) -> Option<[u32; 4]> {
    let &first = points.first()?;
    let (second, &far) = points.iter().enumerate().skip(1).max_by(|a, b| distance(first, *a.1).total_cmp(&distance(first, *b.1)))?;
    let off = |p: &Point| super::length(super::cross(super::minus(far, first), super::minus(*p, first)));
    let (third, &corner) = points.iter().enumerate().max_by(|a, b| off(a.1).total_cmp(&off(b.1)))?;
    if off(&corner) == 0.0 {
        return None;
    }
    let height = |p: &Point| above([first, far, corner], *p);
    let (fourth, top) = points.iter().enumerate().max_by(|a, b| height(a.1).abs().total_cmp(&height(b.1).abs()))?;
    let [second, third, fourth] = [second, third, fourth].map(|i| i as u32);
    match height(top) {
        h if h < 0.0 => Some([0, second, third, fourth]),
        h if h > 0.0 => Some([0, third, second, fourth]),
        _ => None,
    }
}

fn distance(a: Point, b: Point) -> f64 {
    super::length(super::minus(a, b))
}

#[cfg(test)]
mod tests {
    use super::super::check::placed;
    use super::super::primitive::{cuboid, sphere};
    use super::super::{IDENTITY, Part};
    use super::*;

    fn check(points: &[Point]) -> Mesh {
        let mesh = solid(points);
        for face in &mesh.faces {
            let corners = [0, 1, 2].map(|i| mesh.points[face.rings[0][i] as usize]);
            assert!(points.iter().all(|p| above(corners, *p) <= 0.0), "{corners:?}");
        }
        let part = Part { mesh: mesh.clone().into(), matrix: IDENTITY, color: None, kind: "hull", place: None };
        let placed = placed(&part);
        assert!(placed.open_edges == 0 && !placed.inside_out);
        mesh
    }

    #[test]
    fn hulls_hold_all_points() {
        let mesh = check(&cuboid([0.0; 3], [1.0; 3]).points);
        assert_eq!([mesh.points.len(), mesh.faces.len()], [8, 12]);
        check(&sphere(1.0, 40).points);
        // A grid: most points lie in the planes of others.
        let grid: Vec<Point> = (0..343).map(|i| [f64::from(i % 7), f64::from(i / 7 % 7), f64::from(i / 49) / 10.0]).collect();
        assert!(check(&grid).points.len() >= 8);
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f64 / 1e6
        };
        for n in 4..60 {
            check(&(0..n).map(|_| [random(), random().floor(), random()]).collect::<Vec<_>>());
        }
    }

    #[test]
    fn flat_points_have_none() {
        for points in [vec![], vec![[1.0; 3]; 9], (0..9).map(|i| [f64::from(i), f64::from(i * i), 0.0]).collect()] {
            assert!(solid(&points).faces.is_empty());
        }
    }
}
