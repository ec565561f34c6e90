//! What a solid covers of a plane: of z = 0, and as seen from above.

use foldhash::HashMap;

use super::check::placed;
use super::face::{edges, normal};
use super::outline::{Contour, Outline};
use super::{Matrix, Mesh, Part, Point};

/// A mesh at its place, closed.
fn closed(mesh: &Mesh, matrix: &Matrix) -> Mesh {
    let part = Part { mesh: mesh.clone().into(), matrix: *matrix, color: None, kind: "", place: None };
    placed(&part).mesh
}

/// What the solid covers of the plane z = 0. It is closed: a face that lies in the plane belongs to it, on whichever side the solid is.
pub fn section(mesh: &Mesh, matrix: &Matrix) -> Outline {
    let mesh = closed(mesh, matrix);
    // Just below the plane and just above it: a corner in the plane counts once as above, once as below.
    let sides = [|z: f64| z >= 0.0, |z: f64| z > 0.0];
    Outline::union(sides.map(|above| Outline::around(loops(&mesh, above))))
}

/// The rings in which the surface passes from below to above, what is solid on their left.
fn loops(Mesh { points, faces }: &Mesh, above: impl Fn(f64) -> bool) -> Vec<Contour> {
    let up = |i: u32| above(points[i as usize][2]);
    let pass = |[a, b]: [u32; 2]| {
        if up(b) { crossing(points[a as usize], points[b as usize]) } else { crossing(points[b as usize], points[a as usize]) }
    };
    // A face leads from edges on which it goes down to edges on which it goes up, along the line that it shares with the plane.
    let mut ways: Vec<([u32; 2], [u32; 2])> = Vec::new();
    for face in faces {
        let (normal, _) = normal(points, face);
        let along = |edge: &[u32; 2]| {
            let [x, y] = pass(*edge);
            normal[0] * y - normal[1] * x
        };
        let [mut downs, mut rises] =
            [true, false].map(|down| edges(face).filter(|e| up(e[0]) == down && up(e[1]) != down).collect::<Vec<_>>());
        if downs.len() > 1 {
            for list in [&mut downs, &mut rises] {
                list.sort_by(|a, b| along(a).total_cmp(&along(b)));
            }
        }
        ways.extend(downs.into_iter().zip(rises));
    }
    let mut from: HashMap<[u32; 2], Vec<usize>> = HashMap::default();
    for (i, (down, _)) in ways.iter().enumerate() {
        from.entry(*down).or_default().push(i);
    }
    let mut used = vec![false; ways.len()];
    let mut loops = Vec::new();
    for first in 0..ways.len() {
        let mut contour = Contour::new();
        let mut next = Some(first);
        while let Some(i) = next.filter(|&i| !used[i]) {
            used[i] = true;
            let (_, [low, high]) = ways[i];
            contour.push(pass([low, high]));
            let others = from.get_mut(&[high, low]);
            next = others.and_then(|others| std::iter::from_fn(|| others.pop()).find(|&i| !used[i] || i == first));
        }
        if contour.len() > 2 {
            loops.push(contour);
        }
    }
    loops
}

/// Where a line from below to above passes z = 0.
fn crossing(low: Point, high: Point) -> [f64; 2] {
    if high[2] == 0.0 {
        return [high[0], high[1]];
    }
    let t = -low[2] / (high[2] - low[2]);
    [0, 1].map(|i| low[i] + t * (high[i] - low[i]))
}

/// What the solid covers as seen along z: its faces that look up, together.
pub fn shadow(mesh: &Mesh, matrix: &Matrix) -> Outline {
    let Mesh { points, faces } = closed(mesh, matrix);
    let up = faces.iter().filter(|face| normal(&points, face).0[2] > 0.0);
    let flat = |ring: &Vec<u32>| ring.iter().map(|&i| [points[i as usize][0], points[i as usize][1]]).collect();
    Outline::around(up.flat_map(|face| &face.rings).map(flat).collect())
}

#[cfg(test)]
mod tests {
    use super::super::IDENTITY;
    use super::super::primitive::{cuboid, cylinder};
    use super::*;

    fn area(outline: Outline) -> f64 {
        let of =
            |c: &Contour| (0..c.len()).map(|i| (c[i], c[(i + 1) % c.len()])).map(|(p, q)| p[0] * q[1] - q[0] * p[1]).sum::<f64>() / 2.0;
        outline.shapes().unwrap().iter().flatten().map(of).sum()
    }

    #[test]
    fn sections_are_closed() {
        for (low, high, covered) in [(-1.0, 1.0, 6.0), (0.0, 1.0, 6.0), (-1.0, 0.0, 6.0), (0.5, 1.0, 0.0)] {
            assert_eq!(area(section(&cuboid([0.0, 0.0, low], [2.0, 3.0, high]), &IDENTITY)), covered, "{low}");
        }
        // A cone, half way up: a quarter of its foot.
        let cone = cylinder([2.0, 0.0], [-1.0, 1.0], 4);
        assert!((area(section(&cone, &IDENTITY)) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn shadows_are_what_is_seen_from_above() {
        let turned = [[1.0, 0.0, 0.0, 0.0], [0.0, 0.6, -0.8, 0.0], [0.0, 0.8, 0.6, 0.0]];
        assert!((area(shadow(&cuboid([0.0; 3], [1.0; 3]), &turned)) - 1.4).abs() < 1e-12);
    }
}
