//! Cameras as OpenSCAD's options describe them.
//!
//! The seven numbers are a point that is looked at, turns about x, y and z in degrees, and a distance; the six are the eye and the point that it looks at. The
//! vertical field of view is 22.5 degrees, also for the orthographic view, whose page is as high as that of the perspective one at the point looked at. What is nearer than a
//! tenth of the distance is not shown in perspective.

use glam::{DMat3, DVec3};

use super::view::{Projection, View};

/// The vertical field of view, in degrees.
const FIELD: f64 = 22.5;

/// What is nearer than this part of the distance is not shown.
const NEAR: f64 = 0.1;

/// Distance to an empty model.
const DISTANCE: f64 = 140.0;

/// Where a camera is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Camera {
    /// Turned about a point: translate, rotate (degrees), distance.
    Gimbal([f64; 7]),
    /// From an eye to a point.
    Vector([f64; 6]),
}

/// The camera that is used unless another is named; it is moved so that all is seen.
pub const DEFAULT: Camera = Camera::Gimbal([0.0, 0.0, 0.0, 55.0, 0.0, 25.0, DISTANCE]);

/// All that makes a view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// The camera; without one [`DEFAULT`], with `view_all` and `autocenter`.
    pub camera: Option<Camera>,
    /// Without perspective.
    pub orthographic: bool,
    /// Go so far away that all is seen.
    pub view_all: bool,
    /// Look at the middle of the model.
    pub autocenter: bool,
    /// Width of the page in pixels.
    pub width: u32,
    /// Height of the page in pixels.
    pub height: u32,
}

impl Default for Setup {
    fn default() -> Setup {
        Setup { camera: None, orthographic: false, view_all: false, autocenter: false, width: 512, height: 512 }
    }
}

impl Setup {
    /// The view of a model with these least and greatest coordinates. A camera whose numbers are not finite, or whose distance is not above 0, sees nothing sensible: they
    /// are to be refused before.
    pub fn view(&self, bounds: Option<(DVec3, DVec3)>) -> View {
        let alone = self.camera.is_none();
        let (mut target, mut distance, [right, down, forward]) = match self.camera.unwrap_or(DEFAULT) {
            Camera::Gimbal([x, y, z, turn_x, turn_y, turn_z, distance]) => {
                // The camera of no turn looks down along z, with x to the right and y up.
                let turn = DMat3::from_rotation_z(turn_z.to_radians())
                    * DMat3::from_rotation_y(turn_y.to_radians())
                    * DMat3::from_rotation_x(turn_x.to_radians());
                (DVec3::new(x, y, z), distance, [turn * DVec3::X, turn * DVec3::NEG_Y, turn * DVec3::NEG_Z])
            }
            Camera::Vector([ex, ey, ez, x, y, z]) => {
                let (eye, target) = (DVec3::new(ex, ey, ez), DVec3::new(x, y, z));
                let forward = (target - eye).normalize_or(DVec3::NEG_Z);
                // Straight down x is to the right, straight up to the left, as OpenSCAD has it.
                let right = forward.cross(DVec3::Z).try_normalize().unwrap_or(DVec3::X * -forward.z);
                (target, (target - eye).length(), [right, forward.cross(right), forward])
            }
        };
        let half = (FIELD / 2.0).to_radians();
        if self.autocenter || alone {
            target = bounds.map_or(DVec3::ZERO, |(least, most)| (least + most) / 2.0);
        }
        if self.view_all || alone {
            distance = bounds.map_or(DISTANCE, |(least, most)| {
                let radius = ((least + most) / 2.0 - target).length() + (most - least).length() / 2.0;
                radius.max(f64::MIN_POSITIVE) / half.sin()
            });
        }
        let focal = f64::from(self.height) / 2.0 / half.tan();
        let projection = if self.orthographic {
            Projection::Orthographic { scale: focal / distance }
        } else {
            Projection::Perspective { focal, near: NEAR * distance }
        };
        View { width: self.width, height: self.height, eye: target - forward * distance, axes: [right, down, forward], projection }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_kinds_of_camera_describe_the_same_view() {
        // Looking along +y from 10 units away; then from above, turned.
        let front = Camera::Gimbal([1.0, 2.0, 3.0, 90.0, 0.0, 0.0, 10.0]);
        let same = Camera::Vector([1.0, -8.0, 3.0, 1.0, 2.0, 3.0]);
        let turned = Camera::Gimbal([0.0, 0.0, 0.0, 60.0, 0.0, 30.0, 4.0]);
        let (sin, cos) = (30.0_f64.to_radians().sin(), 30.0_f64.to_radians().cos());
        let out = 4.0 * 60.0_f64.to_radians().sin();
        let too = Camera::Vector([out * sin, -out * cos, 2.0, 0.0, 0.0, 0.0]);
        for (a, b) in [(front, same), (turned, too)] {
            let [a, b] = [a, b].map(|camera| Setup { camera: Some(camera), ..Setup::default() }.view(None));
            assert!((a.eye - b.eye).length() < 1e-12, "{a:?} {b:?}");
            assert!(a.axes.iter().zip(b.axes).all(|(a, b)| (a - b).length() < 1e-12), "{a:?} {b:?}");
        }
    }

    #[test]
    fn everything_is_seen_from_far_enough_away() {
        let bounds = (DVec3::new(-3.0, 5.0, 1.0), DVec3::new(9.0, 7.0, 2.0));
        for orthographic in [false, true] {
            let view = Setup { orthographic, ..Setup::default() }.view(Some(bounds));
            let mut most = 0.0_f64;
            for i in 0..8 {
                let corner = |k: usize, j: i32| if i >> j & 1 == 1 { bounds.1[k] } else { bounds.0[k] };
                let [x, y] = view.screen(DVec3::new(corner(0, 0), corner(1, 1), corner(2, 2)));
                assert!((0.0..512.0).contains(&x) && (0.0..512.0).contains(&y), "{x} {y}");
                most = most.max((x - 256.0).abs()).max((y - 256.0).abs());
            }
            assert!(most > 150.0, "and from no farther: {most}");
        }
    }
}
