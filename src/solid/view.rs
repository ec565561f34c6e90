//! Where a model is seen from, and what becomes of points and planes there.
//!
//! ```text
//!            y (down)                       a point in the camera's coordinates: x right, y down, z forward
//!           /                               on the screen, in pixels from its top left corner:
//!     eye  o------> z (forward)               perspective    centre + focal (x / z, y / z)
//!           \                                 orthographic   centre + scale (x, y)
//!            x (right)
//! ```
//!
//! Depth is kept as *nearness*, which is greater for what is nearer and linear over the pixels of a plane: the inverse of z in perspective, -z else. It is a
//! fixed-point number of 128 bits, 2^64 at the near plane, so that sums of it are exact: a plane's nearness at pixel (i, j) is `a i + b j + c`, the same
//! whichever way it was reached, and where two planes cross is a division of integers.

// Depths in doubles would have to be computed in one and the same form everywhere, and the order of two of them between pixels at which it is known would
// still be open where rounding is as large as their difference.

use glam::DVec3;

use super::body::{Line, Plane};

/// A point on the screen, in pixels.
pub type Point = [f64; 2];

/// Where in a pixel it is looked at what it shows, in pixels from its top left corner: at its centre, but for a hair to the right and down.
///
/// A centre that lies on the left or the upper boundary of a face is inside, on the right or the lower outside; so are points a hair off it, and they are far enough off for
/// rounding in doubles, some 2^-30 px, not to matter where edges go right through centres, as in views along the axes. The two differ, for edges along diagonals.
pub const SAMPLE: Point = [0.5 + HAIR, 0.5 + 0.381_966 * HAIR];

const HAIR: f64 = 1.0 / (1 << 18) as f64;

/// How space is shown on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// From the eye.
    Perspective {
        /// Pixels to a unit of x / z.
        focal: f64,
        /// What is nearer than this along the view is not shown; above 0.
        near: f64,
    },
    /// From infinitely far away.
    Orthographic {
        /// Pixels to a unit.
        scale: f64,
    },
}

/// A view of a model on a page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Width of the page in pixels.
    pub width: u32,
    /// Height of the page in pixels.
    pub height: u32,
    /// Where the camera is.
    pub eye: DVec3,
    /// Unit vectors to the right, down and forward; orthogonal.
    pub axes: [DVec3; 3],
    /// How space is shown.
    pub projection: Projection,
}

/// Nearness at the near plane.
const UNIT: f64 = (1_u128 << 64) as f64;

/// Coefficients past this belong to planes that are seen edge-on.
const STEEPEST: f64 = (1_u128 << 100) as f64;

/// The nearness of a plane over the pixels: `a i + b j + c` at pixel (i, j).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Depth {
    /// For each column.
    pub a: i128,
    /// For each scanline.
    pub b: i128,
    /// At pixel (0, 0).
    pub c: i128,
}

impl Depth {
    /// Nearness at a pixel.
    #[inline]
    pub fn at(&self, column: u32, row: u32) -> i128 {
        self.a * i128::from(column) + self.row(row)
    }

    /// Nearness at the first pixel of a scanline.
    #[inline]
    pub fn row(&self, row: u32) -> i128 {
        self.b * i128::from(row) + self.c
    }
}

impl View {
    /// A point in the camera's coordinates.
    pub fn camera(&self, p: DVec3) -> DVec3 {
        self.turned(p - self.eye)
    }

    fn turned(&self, direction: DVec3) -> DVec3 {
        let [right, down, forward] = self.axes;
        DVec3::new(right.dot(direction), down.dot(direction), forward.dot(direction))
    }

    /// The plane in front of which nothing is shown: normal forward.
    pub fn near(&self) -> Option<Plane> {
        let Projection::Perspective { near, .. } = self.projection else { return None };
        let normal = self.axes[2];
        Some(Plane { normal, offset: normal.dot(self.eye) + near })
    }

    /// A point on the screen, in pixels. In perspective it must not be nearer than the near plane.
    pub fn screen(&self, p: DVec3) -> Point {
        let [x, y, _] = self.place(p);
        [x, y]
    }

    /// A point on the screen, in pixels, and its distance along the view.
    pub fn place(&self, p: DVec3) -> [f64; 3] {
        let c = self.camera(p);
        let scale = match self.projection {
            Projection::Perspective { focal, near } => focal / c.z.max(near),
            Projection::Orthographic { scale } => scale,
        };
        [f64::from(self.width) / 2.0 + scale * c.x, f64::from(self.height) / 2.0 + scale * c.y, c.z]
    }

    /// Where pixel (i, j) is looked at, in pixels from the centre of the page.
    pub(super) fn sample(&self, i: u32, j: u32) -> Point {
        [f64::from(i) + SAMPLE[0] - f64::from(self.width) / 2.0, f64::from(j) + SAMPLE[1] - f64::from(self.height) / 2.0]
    }

    /// The point at which pixel (i, j) is looked at, so far along the view.
    pub fn point(&self, i: u32, j: u32, z: f64) -> DVec3 {
        let scale = match self.projection {
            Projection::Perspective { focal, .. } => z / focal,
            Projection::Orthographic { scale } => 1.0 / scale,
        };
        let [x, y] = self.sample(i, j);
        let [right, down, forward] = self.axes;
        self.eye + right * (x * scale) + down * (y * scale) + forward * z
    }

    /// Where a line in space passes the points at which the pixels of scanline 0 are looked at, in pixels right of that of pixel 0, and how much further right it
    /// passes those of the next. Neither is finite where it is level on the screen.
    pub fn passes(&self, line: &Line) -> (f64, f64) {
        let (at, along) = (self.camera(line.at), self.turned(line.along));
        let [x, y] = self.sample(0, 0);
        match self.projection {
            // On the screen a line is where the plane through it and the eye is.
            Projection::Perspective { focal, .. } => {
                let normal = at.cross(along);
                let slope = -normal.y / normal.x;
                (slope * y - normal.z / normal.x * focal - x, slope)
            }
            Projection::Orthographic { scale } => {
                let slope = along.x / along.y;
                ((at.x - at.y * slope) * scale + slope * y - x, slope)
            }
        }
    }

    /// What nearness is a unit of, where z is at most `farthest` in size.
    fn unit(&self, farthest: f64) -> f64 {
        match self.projection {
            Projection::Perspective { near, .. } => UNIT * near,
            Projection::Orthographic { .. } => UNIT / farthest.max(f64::MIN_POSITIVE),
        }
    }

    /// Nearness of a plane; `p` is a point of a face in it. Seen edge-on, the face is as near as that point.
    pub fn depth(&self, plane: &Plane, p: DVec3, farthest: f64) -> Depth {
        let normal = self.turned(plane.normal);
        let offset = plane.offset - plane.normal.dot(self.eye);
        let unit = self.unit(farthest);
        // Per unit of x and y in front of the camera, and at its axis.
        let (pixels, [u, v, w]) = match self.projection {
            Projection::Perspective { focal, .. } => (focal, [normal.x, normal.y, normal.z].map(|n| n / offset)),
            Projection::Orthographic { scale } => (scale, [normal.x / normal.z, normal.y / normal.z, -offset / normal.z]),
        };
        let (a, b) = (u / pixels * unit, v / pixels * unit);
        let [x, y] = self.sample(0, 0);
        let c = w * unit + a * x + b * y;
        let fits = |x: f64| x.is_finite() && x.abs() < STEEPEST;
        if fits(a) && fits(b) && fits(c) {
            return Depth { a: a.round() as i128, b: b.round() as i128, c: c.round() as i128 };
        }
        Depth { a: 0, b: 0, c: self.nearness(self.camera(p).z, farthest) }
    }

    /// Nearness of what is so far along the view.
    pub fn nearness(&self, z: f64, farthest: f64) -> i128 {
        let unit = self.unit(farthest);
        let near = match self.projection {
            Projection::Perspective { near, .. } => unit / z.max(near),
            Projection::Orthographic { .. } => -z * unit,
        };
        near.round() as i128
    }

    /// Distance along the view of what is so near.
    pub fn distance(&self, nearness: i128, farthest: f64) -> f64 {
        let unit = self.unit(farthest);
        match self.projection {
            Projection::Perspective { .. } => unit / nearness as f64,
            Projection::Orthographic { .. } => -(nearness as f64) / unit,
        }
    }
}
