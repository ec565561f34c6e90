//! Elliptical arcs as cubic curves (SVG 2, implementation notes B.2.4: from end points to centre).
//!
//! The ellipse is mapped to the unit circle, where half the chord is `(u, v)`; the chord alone gives the angle swept. An arc is cut
//! into pieces of at most 11.25 degrees, each one cubic that stays within 2e-9 of the radius.

use std::f64::consts::{PI, TAU};

use crate::grid::Point;

/// The largest piece, in radians.
const PIECE: f64 = PI / 16.0;

/// An elliptical arc as path data give it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arc {
    pub(super) from: Point,
    pub(super) to: Point,
    /// Radii; signs do not matter, and radii too small for the chord are scaled up.
    pub(super) radii: [f64; 2],
    /// Turn of the first axis from the x axis, in degrees.
    pub(super) rotation: f64,
    pub(super) large: bool,
    pub(super) sweep: bool,
}

impl Arc {
    /// Calls `cubic` with the control points and the end of every piece. Nothing is called if the ends are equal;
    /// an arc without a radius, or with ends too near for its radius, is a straight line, as one cubic.
    pub(super) fn cubics(self, mut cubic: impl FnMut(Point, Point, Point)) {
        let Arc { from, to, .. } = self;
        let [mut rx, mut ry] = self.radii.map(f64::abs);
        if from == to {
            return;
        }
        if rx == 0.0 || ry == 0.0 {
            return cubic(from, to, to);
        }
        let (sin, cos) = self.rotation.rem_euclid(360.0).to_radians().sin_cos();
        let half = [(from[0] - to[0]) / 2.0, (from[1] - to[1]) / 2.0];
        let mut u = (cos * half[0] + sin * half[1]) / rx;
        let mut v = (cos * half[1] - sin * half[0]) / ry;
        let chord = u.hypot(v);
        if chord == 0.0 {
            return cubic(from, to, to);
        }
        if chord > 1.0 {
            (rx, ry, u, v) = (rx * chord, ry * chord, u / chord, v / chord);
        }
        let chord = chord.min(1.0);
        let side = if self.large == self.sweep { -1.0 } else { 1.0 };
        let height = side * ((1.0 - chord) * (1.0 + chord)).sqrt() / chord;
        let small = 2.0 * chord.asin();
        let swept = if self.large { TAU - small } else { small } * if self.sweep { 1.0 } else { -1.0 };
        let begin = (v + height * u).atan2(u - height * v);

        // From here on relative to the middle of the chord: a flat arc of a huge ellipse loses nothing.
        let middle = [from[0] / 2.0 + to[0] / 2.0, from[1] / 2.0 + to[1] / 2.0];
        let place = |[x, y]: Point| [middle[0] + cos * rx * x - sin * ry * y, middle[1] + sin * rx * x + cos * ry * y];
        let along = |angle: f64, [x, y]: Point, length: f64| {
            let (sin, cos) = (begin + angle).sin_cos();
            [x - length * sin, y + length * cos]
        };
        let pieces = (swept.abs() / PIECE).ceil().max(1.0);
        let step = swept / pieces;
        let arm = 4.0 / 3.0 * (step / 4.0).tan();
        let mut start = [u, v];
        for i in 1..=pieces as u32 {
            let angle = step * f64::from(i);
            let end = along(angle / 2.0, [u, v], 2.0 * (angle / 2.0).sin());
            let controls = (place(along(angle - step, start, arm)), place(along(angle, end, -arm)));
            cubic(controls.0, controls.1, if f64::from(i) == pieces { to } else { place(end) });
            start = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on(p0: Point, [c, d, p]: [Point; 3], t: f64) -> Point {
        let s = 1.0 - t;
        std::array::from_fn(|k| s * s * s * p0[k] + 3.0 * s * s * t * c[k] + 3.0 * s * t * t * d[k] + t * t * t * p[k])
    }

    fn pieces(arc: Arc) -> Vec<[Point; 3]> {
        let mut pieces = Vec::new();
        arc.cubics(|c, d, p| pieces.push([c, d, p]));
        pieces
    }

    /// All four arcs between two points of an ellipse that is known beforehand lie on that ellipse, turn the right way and meet the ends.
    #[test]
    fn arcs_lie_on_their_ellipse() {
        for (rx, ry, degrees, t0, t1) in
            [(1.0, 1.0, 0.0, 0.0, 1.5), (300.0, 20.0, 33.0, 1.0, 2.0), (5.0, 5e4, 200.0, -2.0, -1.9), (7.0, 3.0, -70.0, 0.1, 3.2)]
        {
            let (sin, cos) = f64::to_radians(degrees).sin_cos();
            let at = |t: f64| [10.0 + cos * rx * t.cos() - sin * ry * t.sin(), -4.0 + sin * rx * t.cos() + cos * ry * t.sin()];
            // Back to the unit circle, with the known centre.
            let unit = |p: Point| {
                let (x, y) = (p[0] - 10.0, p[1] + 4.0);
                [(cos * x + sin * y) / rx, (cos * y - sin * x) / ry]
            };
            for (from, to) in [(at(t0), at(t1)), (at(t1), at(t0))] {
                for sweep in [false, true] {
                    // Of the two arcs on this very ellipse, the one that turns as asked.
                    let forward = (from == at(t0)) == sweep;
                    let angle = if forward { t1 - t0 } else { TAU - (t1 - t0) };
                    let arc = Arc { from, to, radii: [rx, -ry], rotation: degrees, large: angle > PI, sweep };
                    let pieces = pieces(arc);
                    assert!(pieces.len() >= (angle / PIECE) as usize && pieces.len() <= 32);
                    let (mut start, mut turned) = (from, 0.0);
                    for piece in pieces {
                        for k in 0..=20 {
                            let [x, y] = unit(on(start, piece, f64::from(k) / 20.0));
                            assert!((x.hypot(y) - 1.0).abs() < 1e-8, "{x} {y}");
                        }
                        let ([x0, y0], [x1, y1]) = (unit(start), unit(piece[2]));
                        turned += (x0 * y1 - y0 * x1).atan2(x0 * x1 + y0 * y1);
                        start = piece[2];
                    }
                    assert_eq!(start, to);
                    assert!((turned.abs() - angle).abs() < 1e-6 && (turned > 0.0) == sweep, "{turned} {angle}");
                }
            }
        }
    }

    #[test]
    fn radii_that_are_too_small_grow_to_the_chord() {
        let arc = Arc { from: [0.0, 0.0], to: [10.0, 0.0], radii: [1.0, 1.0], rotation: 0.0, large: false, sweep: true };
        let pieces = pieces(arc);
        assert_eq!(pieces.len(), 16);
        let top = pieces[7][2];
        assert!((top[0] - 5.0).abs() < 1e-12 && (top[1] + 5.0).abs() < 1e-12, "{top:?}");
    }

    #[test]
    fn flat_arcs_of_huge_circles_keep_their_sagitta() {
        for r in [1e3, 1e9, 1e15] {
            let arc = Arc { from: [0.0, 0.0], to: [10.0, 0.0], radii: [r, r], rotation: 0.0, large: false, sweep: false };
            let [piece] = pieces(arc)[..] else { panic!() };
            let [x, y] = on([0.0, 0.0], piece, 0.5);
            // chord^2 / 8r, to first order
            let sagitta = 12.5 / r;
            assert!((x - 5.0).abs() < 1e-12 && (y - sagitta).abs() < 1e-4 * sagitta + 1e-14, "{r}: {x} {y}");
        }
    }

    #[test]
    fn degenerate_arcs() {
        let arc = Arc { from: [1.0, 2.0], to: [1.0, 2.0], radii: [5.0, 5.0], rotation: 0.0, large: true, sweep: true };
        assert!(pieces(arc).is_empty());
        let line = Arc { to: [3.0, 4.0], radii: [0.0, 5.0], ..arc };
        assert_eq!(pieces(line), [[[1.0, 2.0], [3.0, 4.0], [3.0, 4.0]]]);
        // Ends so near that the large arc is the whole circle.
        let whole = Arc { to: [1.0, 2.0 + 1e-15], ..arc };
        let left = pieces(whole).iter().map(|p| p[2][0]).fold(f64::INFINITY, f64::min);
        let right = pieces(whole).iter().map(|p| p[2][0]).fold(f64::NEG_INFINITY, f64::max);
        assert!((right - left - 10.0).abs() < 1e-6, "{left} {right}");
    }
}
