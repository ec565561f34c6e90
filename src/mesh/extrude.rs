//! Outlines moved through space: straight up, or around the axis.
//!
//! Corners, slices and the diagonals of sides that are not plane are OpenSCAD's (`GeometryEvaluator.cc` of 2021.01). Plane sides stay whole.

use super::Mesh;
use super::build::Builder;
use super::outline::Shapes;
use super::turn::{Fineness, sin_cos};

/// How `linear_extrude` moves an outline.
#[derive(Clone, Copy, Debug)]
pub struct Extrusion {
    /// From the bottom to the top.
    pub z: [f64; 2],
    /// Degrees, clockwise as seen from above, that the top is turned by.
    pub twist: Option<f64>,
    /// Slices; without them `fineness` decides.
    pub slices: Option<f64>,
    /// Factors in x and y at the top, not negative.
    pub scale: [f64; 2],
    /// How finely it is cut.
    pub fineness: Fineness,
}

impl Extrusion {
    /// Slices for these shapes; they may be more than anything can hold.
    pub fn slices(&self, shapes: &Shapes) -> f64 {
        let farthest = |of: &dyn Fn(&[f64; 2]) -> f64| shapes.iter().flatten().flatten().map(of).fold(0.0, f64::max);
        let height = self.z[1] - self.z[0];
        let [x, y] = self.scale;
        match (self.slices, self.twist) {
            (Some(slices), _) => slices.max(1.0).floor(),
            (None, Some(twist)) => {
                let radius = farthest(&|p| p[0].hypot(p[1]));
                self.fineness.of_helix(radius, height, twist, if x == y { x } else { 1.0 })
            }
            (None, None) if x == y => 1.0,
            (None, None) => self.fineness.of_slope(farthest(&|p| (p[0] - p[0] * x).hypot(p[1] - p[1] * y)), height),
        }
    }

    /// The solid between the shapes at the bottom and at the top.
    pub fn solid(&self, shapes: &Shapes, slices: u32) -> Mesh {
        let twist = self.twist.unwrap_or(0.0);
        let share = |part: u32, whole: f64| whole * f64::from(part) / f64::from(slices);
        let level = |mesh: &mut Builder, part: u32, contour: &[[f64; 2]]| -> Level {
            let [sine, cosine] = sin_cos(-share(part, twist));
            let scale = self.scale.map(|s| 1.0 - share(part, 1.0 - s));
            let turned = contour.iter().map(|[x, y]| [scale[0] * (cosine * x - sine * y), scale[1] * (sine * x + cosine * y)]);
            let points: Vec<[f64; 2]> = turned.collect();
            let z = if part == slices { self.z[1] } else { self.z[0] + share(part, self.z[1] - self.z[0]) };
            let ids = points.iter().map(|&[x, y]| mesh.point([x, y, z])).collect();
            Level { points, ids }
        };
        let plane = twist == 0.0 && self.scale[0] == self.scale[1];
        let mut mesh = Builder::default();
        for shape in shapes {
            let mut ends = [Vec::new(), Vec::new()];
            for (i, contour) in shape.iter().enumerate() {
                let bottom = level(&mut mesh, 0, contour);
                let mut below = bottom.clone();
                for part in 1..=slices {
                    let above = level(&mut mesh, part, contour);
                    let to_a_line = part == slices && self.scale.contains(&0.0);
                    sides(&mut mesh, [&below, &above], (!plane).then_some(Diagonals { flip: (i > 0) != (twist <= 0.0), to_a_line }));
                    below = above;
                }
                ends[0].push(bottom.ids.into_iter().rev().collect());
                ends[1].push(below.ids);
            }
            for end in ends {
                mesh.face(end);
            }
        }
        mesh.finish()
    }
}

/// A contour at a height.
#[derive(Clone)]
struct Level {
    points: Vec<[f64; 2]>,
    ids: Vec<u32>,
}

/// How sides that are not plane are cut in two.
struct Diagonals {
    /// What decides between diagonals of equal length.
    flip: bool,
    /// The upper contour has no area: the longer diagonal is taken.
    to_a_line: bool,
}

fn sides(mesh: &mut Builder, [below, above]: [&Level; 2], diagonals: Option<Diagonals>) {
    let n = below.ids.len();
    for i in 0..n {
        let j = (i + 1) % n;
        let [a, b, c, d] = [below.ids[i], below.ids[j], above.ids[j], above.ids[i]];
        match &diagonals {
            None => mesh.face([vec![a, b, c, d]]),
            Some(how) => {
                let length = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
                let [ac, bd] = [length(below.points[i], above.points[j]), length(below.points[j], above.points[i])];
                let differ = 2.0 * (ac - bd).abs() * 1e5 > ac + bd;
                let shorter = if differ { ac < bd } else { !how.flip };
                if shorter != how.to_a_line {
                    mesh.face([vec![a, c, d]]);
                    mesh.face([vec![a, b, c]]);
                } else {
                    mesh.face([vec![a, b, d]]);
                    mesh.face([vec![d, b, c]]);
                }
            }
        }
    }
}

/// The least and the greatest x of some shapes, with 0 among them.
pub fn reach(shapes: &Shapes) -> [f64; 2] {
    shapes.iter().flatten().flatten().fold([0.0, 0.0], |[low, high], p| [low.min(p[0]), high.max(p[0])])
}

/// The sides of `rotate_extrude` by `angle` degrees; they may be more than anything can hold.
pub fn sides_of_turn(shapes: &Shapes, angle: f64, fineness: &Fineness) -> f64 {
    let [low, high] = reach(shapes);
    (fineness.of_circle(high - low) * angle.abs() / 360.0).floor().max(1.0)
}

/// Shapes turned around z by `angle` degrees, counterclockwise as seen from above, from x on; y becomes z. All lie on one side of the y axis. A whole turn begins at -x.
pub fn turned(shapes: &Shapes, angle: f64, sides: u32) -> Mesh {
    let whole = angle == 360.0;
    let flip = whole ^ (reach(shapes)[0] < 0.0) ^ (angle < 0.0);
    let last = if whole { sides - 1 } else { sides };
    let mut mesh = Builder::default();
    for shape in shapes {
        let mut ends = [Vec::new(), Vec::new()];
        for contour in shape {
            let ring = |mesh: &mut Builder, part: u32| -> Vec<u32> {
                let step = f64::from(part) * if whole { 360.0 } else { angle } / f64::from(sides);
                let [sine, cosine] = sin_cos(if whole { step - 90.0 } else { 90.0 - step });
                contour.iter().map(|[x, y]| mesh.point([x * sine, x * cosine, *y])).collect()
            };
            let first = ring(&mut mesh, 0);
            let mut before = first.clone();
            for part in 1..=sides {
                let after = if part <= last { ring(&mut mesh, part) } else { first.clone() };
                let n = contour.len();
                for i in 0..n {
                    let j = (i + 1) % n;
                    let mut side = vec![before[j], before[i], after[i], after[j]];
                    if flip {
                        side.reverse();
                    }
                    mesh.face([side]);
                }
                before = after;
            }
            if !whole {
                let [mut start, mut end] = [first, before];
                if flip {
                    start.reverse()
                } else {
                    end.reverse()
                }
                ends[0].push(start);
                ends[1].push(end);
            }
        }
        for end in ends {
            mesh.face(end);
        }
    }
    mesh.finish()
}
