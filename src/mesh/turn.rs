//! Sides of circles, and sines and cosines of degrees: as OpenSCAD has them, so that a model has the corners that it has there.

/// Radii below this are points.
const FINE: f64 = 1.0 / 1_048_576.0;

/// Smallest `$fa` and `$fs`.
const LEAST: f64 = 0.01;

/// How finely curves are cut into straight sides: OpenSCAD's `$fn`, `$fa` and `$fs`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// Sides of a circle, if positive.
    pub sides: f64,
    /// Least angle of a side in degrees.
    pub angle: f64,
    /// Least length of a side.
    pub size: f64,
}

impl Default for Fineness {
    fn default() -> Fineness {
        Fineness { sides: 0.0, angle: 12.0, size: 2.0 }
    }
}

impl Fineness {
    /// Sides of a whole circle; they may be more than anything can hold.
    pub fn of_circle(&self, radius: f64) -> f64 {
        if radius < FINE || !self.sides.is_finite() {
            return 3.0;
        }
        if self.sides > 0.0 {
            return self.sides.max(3.0).floor();
        }
        (360.0 / self.angle()).min(radius * std::f64::consts::TAU / self.size()).max(5.0).ceil()
    }

    /// Slices of an extrusion that turns by `twist` degrees on its way up and grows by the factor `scale`; corners are within `radius` of the axis.
    pub(super) fn of_helix(&self, radius: f64, height: f64, twist: f64, scale: f64) -> f64 {
        let twist = twist.abs();
        let least = (twist / 120.0).ceil().max(1.0);
        if radius < FINE || !self.sides.is_finite() {
            return least;
        }
        if self.sides > 0.0 {
            return (twist / 360.0 * self.sides).ceil().max(least);
        }
        let turn = twist.to_radians();
        let length = if scale == 1.0 { turn * radius.hypot(height / turn) } else { spiral(radius, turn, scale).hypot(height) };
        (twist / self.angle()).ceil().min((length / self.size()).ceil()).max(least)
    }

    /// Slices of an extrusion whose corners move sideways by at most `shift`, not all of them by the same factor.
    pub(super) fn of_slope(&self, shift: f64, height: f64) -> f64 {
        if shift < FINE || !self.sides.is_finite() {
            return 1.0;
        }
        if self.sides > 0.0 { self.sides.floor().max(1.0) } else { (shift.hypot(height) / self.size()).ceil().max(1.0) }
    }

    fn angle(&self) -> f64 {
        self.angle.max(LEAST)
    }

    fn size(&self) -> f64 {
        self.size.max(LEAST)
    }
}

/// Length of the part of an Archimedean spiral that a point at `radius` moves along while it turns by `turn` radians and its distance grows by `scale`.
fn spiral(radius: f64, turn: f64, scale: f64) -> f64 {
    let end = if scale > 1.0 { turn * scale / (scale - 1.0) } else { turn / (1.0 - scale) };
    let length = |angle: f64| 0.5 * radius / end * (angle * (1.0 + angle * angle).sqrt() + angle.asinh());
    length(end) - length(end - turn)
}

/// Sine and cosine of an angle in degrees; those of multiples of 30 and 45 are the nearest numbers, so that what is symmetrical stays so.
pub fn sin_cos(degrees: f64) -> [f64; 2] {
    [sine(degrees), sine_of_positive((degrees.abs() % 360.0) + 90.0)]
}

fn sine(degrees: f64) -> f64 {
    let sine = sine_of_positive(degrees.abs() % 360.0);
    if degrees < 0.0 { -sine } else { sine }
}

/// Of an angle from 0 to less than 450.
fn sine_of_positive(degrees: f64) -> f64 {
    let within = if degrees >= 360.0 { degrees - 360.0 } else { degrees };
    let (half, sign) = if within >= 180.0 { (within - 180.0, -1.0) } else { (within, 1.0) };
    let quarter = if half > 90.0 { 180.0 - half } else { half };
    let sine = if quarter == 30.0 {
        0.5
    } else if quarter == 45.0 {
        std::f64::consts::FRAC_1_SQRT_2
    } else if quarter == 60.0 {
        0.75_f64.sqrt()
    } else if quarter > 45.0 {
        (90.0 - quarter).to_radians().cos()
    } else {
        quarter.to_radians().sin()
    };
    sign * sine
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circles_have_as_many_sides_as_in_openscad() {
        let auto = Fineness::default();
        for (radius, sides) in [(0.1, 5.0), (1.0, 5.0), (2.0, 7.0), (5.0, 16.0), (10.0, 30.0), (1e9, 30.0), (1e-7, 3.0)] {
            assert_eq!(auto.of_circle(radius), sides, "{radius}");
        }
        for (sides, expected) in [(1.0, 3.0), (3.0, 3.0), (7.9, 7.0), (100.0, 100.0), (f64::INFINITY, 3.0), (f64::NAN, 3.0)] {
            assert_eq!(Fineness { sides, ..auto }.of_circle(1.0), expected, "{sides}");
        }
    }

    #[test]
    fn sines_are_symmetrical_and_near() {
        for degrees in -1000..1000 {
            let angle = f64::from(degrees) / 2.0;
            let [sine, cosine] = sin_cos(angle);
            assert!((sine - angle.to_radians().sin()).abs() < 1e-15 * 10.0 && (cosine - angle.to_radians().cos()).abs() < 1e-14, "{angle}");
            assert_eq!(sin_cos(-angle), [-sine, cosine]);
            assert_eq!(sine.abs(), sin_cos(180.0 - angle)[0].abs(), "{angle}");
        }
        assert_eq!(sin_cos(-90.0), [-1.0, 0.0]);
    }
}
