//! Cubes, spheres and cylinders with the corners that OpenSCAD gives them.
//!
//! A sphere is rings at half steps of latitude, without poles: its first and last ring are faces. Faces that OpenSCAD cuts into
//! triangles of one plane stay whole here.

use super::build::Builder;
use super::turn::sin_cos;
use super::{Mesh, Point};

/// A box between two opposite corners.
pub fn cuboid(low: Point, high: Point) -> Mesh {
    let mut mesh = Builder::with_capacity(8, 6);
    let corner = |mesh: &mut Builder, i: usize| mesh.point([0, 1, 2].map(|axis| if i >> axis & 1 == 0 { low[axis] } else { high[axis] }));
    for face in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        let ring = face.map(|i| corner(&mut mesh, i)).to_vec();
        mesh.face([ring]);
    }
    mesh.finish()
}

/// A sphere of `sides` sides around its axis, which is z: (sides + 1) / 2 rings.
pub fn sphere(radius: f64, sides: u32) -> Mesh {
    let rings = sides.div_ceil(2);
    let circles = (0..rings).map(|i| {
        let [sine, cosine] = sin_cos(180.0 * (f64::from(i) + 0.5) / f64::from(rings));
        [radius * sine, radius * cosine]
    });
    stack(circles.rev(), sides)
}

/// A cylinder or a cone around z, with radius `radii[0]` at `z[0]`, below, and `radii[1]` at `z[1]`, above; one of them may be 0.
pub fn cylinder(radii: [f64; 2], z: [f64; 2], sides: u32) -> Mesh {
    stack([[radii[0], z[0]], [radii[1], z[1]]].into_iter(), sides)
}

/// Faces of [`sphere`] and of [`cylinder`], which has two rings.
pub fn faces_of_stack(rings: u64, sides: u64) -> u64 {
    (rings - 1).saturating_mul(sides).saturating_add(2)
}

/// Circles `[radius, z]` above each other, closed below and above.
fn stack(circles: impl ExactSizeIterator<Item = [f64; 2]>, sides: u32) -> Mesh {
    let count = circles.len();
    let n = sides as usize;
    let directions: Vec<[f64; 2]> = (0..sides).map(|i| sin_cos(360.0 * f64::from(i) / f64::from(sides))).collect();
    let mut mesh = Builder::with_capacity(count * n, count * n);
    let mut below: Option<Vec<u32>> = None;
    for [radius, z] in circles {
        let ring: Vec<u32> = directions.iter().map(|[sine, cosine]| mesh.point([radius * cosine, radius * sine, z])).collect();
        match &below {
            None => mesh.face([ring.iter().rev().copied().collect()]),
            Some(below) => (0..n).for_each(|i| mesh.face([vec![below[i], below[(i + 1) % n], ring[(i + 1) % n], ring[i]]])),
        }
        below = Some(ring);
    }
    mesh.face(below);
    mesh.finish()
}
