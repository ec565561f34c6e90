//! What the rays of a view meet, exactly: in integers, from the coordinates of convex parts before they were turned.
//!
//! A part is the points on the inner side of its faces' planes, whose corners are whole numbers. The turn is a quaternion of whole numbers, so that its matrix is
//! one of whole numbers, `m`, over one, `n`: a rational turn, and for the purpose as good as any angle. The engine is given the corners' nearest doubles behind the
//! turn. Here the ray is turned back instead: every point of it is `(from + t along) / over`, and it passes the plane `normal p = offset` where
//!
//! ```text
//!     t = (offset over - normal from) / (normal along)
//! ```
//!
//! a fraction of integers, of which any two are compared by multiplication. Nothing is rounded. 128 bits suffice for quaternions below 2^15, coordinates below 2^6 and
//! pages below 2^12; builds with overflow checks say if they do not.

pub mod cells;

use std::cmp::Ordering;

use glam::DVec3;
use runset::mesh::Mesh;
use runset::solid::view::{Projection, View};

type Vector = [i128; 3];

fn dot(a: Vector, b: Vector) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn plus(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|i| a[i] + b[i])
}

fn times(a: i128, b: Vector) -> Vector {
    b.map(|x| a * x)
}

/// A turn in space: a matrix of whole numbers over a whole number.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// Rows.
    pub m: [Vector; 3],
    /// What they are to be divided by.
    pub n: i128,
}

impl Turn {
    /// Of a quaternion, which need not be of length 1.
    pub fn new([w, x, y, z]: [i128; 4]) -> Turn {
        let m = [
            [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ];
        let turn = Turn { m, n: w * w + x * x + y * y + z * z };
        // Orthogonal, exactly.
        (0..9).for_each(|i| assert_eq!(dot(m[i / 3], m[i % 3]), if i / 3 == i % 3 { turn.n * turn.n } else { 0 }));
        turn
    }

    /// A point behind the turn, as the nearest doubles.
    pub fn rounded(&self, p: Vector) -> [f64; 3] {
        self.m.map(|row| dot(row, p) as f64 / self.n as f64)
    }

    /// Before the turn, times `n`.
    pub fn back(&self, p: Vector) -> Vector {
        [0, 1, 2].map(|j| dot([0, 1, 2].map(|i| self.m[i][j]), p))
    }
}

/// A fraction with a denominator above 0.
#[derive(Clone, Copy, Debug)]
pub struct Fraction(i128, i128);

impl Fraction {
    pub fn new(above: i128, below: i128) -> Fraction {
        if below < 0 { Fraction(-above, -below) } else { Fraction(above, below) }
    }

    pub fn value(self) -> f64 {
        self.0 as f64 / self.1 as f64
    }
}

impl PartialEq for Fraction {
    fn eq(&self, other: &Fraction) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Fraction {}

impl PartialOrd for Fraction {
    fn partial_cmp(&self, other: &Fraction) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Fraction {
    fn cmp(&self, other: &Fraction) -> Ordering {
        (self.0 * other.1).cmp(&(other.0 * self.1))
    }
}

/// A ray before the turn: its points are `(from + t along) / over`.
pub struct Ray {
    pub from: Vector,
    pub along: Vector,
    pub over: i128,
    /// Distance along the view for a unit of t.
    pub unit: f64,
}

/// Parts of a pixel that rays are told apart by.
pub const PARTS: i128 = 1 << 18;

/// Looks along y, with x to the right and z up, at what is turned.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Width and height.
    pub size: [u32; 2],
    /// Where the eye is.
    pub eye: Vector,
    /// Pixels to a unit: of x / y from the eye, or of x.
    pub pixels: i128,
    pub perspective: bool,
}

impl Camera {
    /// The same for the engine.
    pub fn view(&self) -> View {
        let pixels = self.pixels as f64;
        let projection = if self.perspective {
            Projection::Perspective { focal: pixels, near: 0.5 }
        } else {
            Projection::Orthographic { scale: pixels }
        };
        let [width, height] = self.size;
        View { width, height, eye: DVec3::from(self.eye.map(|x| x as f64)), axes: [DVec3::X, DVec3::NEG_Z, DVec3::Y], projection }
    }

    /// The ray through a pixel's centre, or so many parts of a pixel right of it and below.
    pub fn ray(&self, turn: &Turn, [x, y]: [u32; 2], beside: [i128; 2]) -> Ray {
        let from_middle = |at: u32, size: u32, beside| (2 * i128::from(at) + 1 - i128::from(size)) * (PARTS / 2) + beside;
        let [x, y] = [from_middle(x, self.size[0], beside[0]), from_middle(y, self.size[1], beside[1])];
        let scale = self.pixels * PARTS;
        if self.perspective {
            Ray { from: turn.back(self.eye), along: turn.back([x, scale, -y]), over: turn.n, unit: scale as f64 }
        } else {
            let from = plus(times(scale, self.eye), [x, 0, -y]);
            Ray { from: turn.back(from), along: turn.back([0, 1, 0]), over: turn.n * scale, unit: 1.0 / scale as f64 }
        }
    }
}

/// A convex part.
#[derive(Clone, Debug)]
pub struct Convex {
    /// Normals, pointing out, and offsets.
    planes: Vec<(Vector, i128)>,
    /// Its surface, before the turn.
    pub mesh: Mesh,
}

impl Convex {
    /// Of a mesh whose corners are whole numbers.
    pub fn new(mesh: Mesh) -> Convex {
        let point = |i: u32| {
            let p = mesh.points[i as usize];
            assert!(p.iter().all(|x| x.fract() == 0.0));
            p.map(|x| x as i128)
        };
        let plane = |ring: &[u32]| {
            let [a, b, c] = [0, 1, 2].map(|i| point(ring[i]));
            let normal = cross(plus(b, times(-1, a)), plus(c, times(-1, a)));
            (normal, dot(normal, a))
        };
        let planes: Vec<(Vector, i128)> = mesh.faces.iter().map(|face| plane(&face.rings[0])).collect();
        for (face, (normal, offset)) in mesh.faces.iter().zip(&planes) {
            assert!(face.rings[0].iter().all(|&i| dot(*normal, point(i)) == *offset), "a plane face");
            assert!((0..mesh.points.len() as u32).all(|i| dot(*normal, point(i)) <= *offset), "a convex part");
        }
        Convex { planes, mesh }
    }

    /// Its surface behind a turn.
    pub fn turned(&self, turn: &Turn) -> Mesh {
        let points = self.mesh.points.iter().map(|p| turn.rounded(p.map(|x| x as i128))).collect();
        Mesh { points, faces: self.mesh.faces.clone() }
    }

    /// The normal of a face behind a turn.
    pub fn normal(&self, turn: &Turn, face: usize) -> DVec3 {
        DVec3::from(turn.rounded(self.planes[face].0)).normalize()
    }

    /// Where a ray is in it.
    fn within(&self, ray: &Ray) -> Option<[Fraction; 2]> {
        let (mut enters, mut leaves): (Option<Fraction>, Option<Fraction>) = (None, None);
        for &(normal, offset) in &self.planes {
            let (above, below) = (offset * ray.over - dot(normal, ray.from), dot(normal, ray.along));
            match below.signum() {
                0 if above <= 0 => return None,
                0 => {}
                -1 => enters = enters.max(Some(Fraction::new(above, below))),
                _ => {
                    let t = Fraction::new(above, below);
                    leaves = Some(leaves.map_or(t, |least| least.min(t)));
                }
            }
            if let (Some(enters), Some(leaves)) = (enters, leaves)
                && enters >= leaves
            {
                return None;
            }
        }
        Some([enters?, leaves?])
    }

    /// Faces whose planes a ray meets at `t`.
    fn at(&self, ray: &Ray, t: Fraction) -> impl Iterator<Item = usize> {
        let meets = move |(normal, offset): &(Vector, i128)| {
            let (above, below) = (offset * ray.over - dot(*normal, ray.from), dot(*normal, ray.along));
            below != 0 && Fraction::new(above, below) == t
        };
        self.planes.iter().enumerate().filter(move |(_, plane)| meets(plane)).map(|(i, _)| i)
    }
}

/// What is seen: how far along the ray, and all parts and faces that are there.
pub struct Hit {
    pub t: Fraction,
    pub faces: Vec<(usize, usize)>,
}

/// The first point of a ray behind which `holds` is true of the parts that it is in.
pub fn first(parts: &[Convex], holds: &dyn Fn(&[bool]) -> bool, ray: &Ray) -> Option<Hit> {
    let spans: Vec<Option<[Fraction; 2]>> = parts.iter().map(|part| part.within(ray)).collect();
    let mut events: Vec<Fraction> = spans.iter().flatten().flatten().copied().collect();
    events.sort_unstable();
    events.dedup();
    let mut inside = vec![false; parts.len()];
    let t = events.into_iter().find(|t| {
        inside.iter_mut().zip(&spans).for_each(|(inside, span)| *inside = span.is_some_and(|[enters, leaves]| enters <= *t && *t < leaves));
        holds(&inside)
    })?;
    let bounded = |i: &usize| spans[*i].is_some_and(|span| span.contains(&t));
    let faces = (0..parts.len()).filter(bounded).flat_map(|i| parts[i].at(ray, t).map(move |face| (i, face)));
    Some(Hit { t, faces: faces.collect() })
}
