//! The pen: straight pieces to rectangles, turns to wedges, ends to caps, gathered into rings.

use super::super::flatten::{Window, affine, beside};
use super::super::{Cap, Join, Stroke};
use crate::error::Result;
use crate::grid::Point;

/// Points of one side after which a ring is ended and another begun, to keep memory small.
const STRETCH: usize = 4096;

/// Most steps of an arc; those that cannot reach the page are taken together.
const STEPS: f64 = 1e15;

/// Steps of an arc that are not looked at one by one.
const FEW: u64 = 32;

/// A unit vector.
pub(super) type Heading = [f64; 2];

/// Draws pieces and what joins and ends them.
pub(super) struct Pen<R> {
    /// Half the width.
    radius: f64,
    join: Join,
    pub(super) cap: Cap,
    miter_limit: f64,
    /// What is shorter is nothing.
    pub(super) least: f64,
    /// Largest angle between points of an arc.
    step: f64,
    /// What is seen, in user units.
    window: Window,
    matrix: [f64; 6],
    /// Whereto the pen last went; none while it is up.
    pub(super) heading: Option<Heading>,
    /// How far it went there.
    length: f64,
    /// The right side in the direction of travel (the left one where y points down).
    forward: Vec<Point>,
    backward: Vec<Point>,
    points: Vec<Point>,
    ring: R,
}

impl<R: FnMut(&[Point]) -> Result<()>> Pen<R> {
    /// A pen that is up, for a stroke in user units with this `tolerance`, of which the `window` is seen.
    pub(super) fn new(stroke: &Stroke, tolerance: f64, window: Window, matrix: &[f64; 6], ring: R) -> Pen<R> {
        let radius = stroke.width / 2.0;
        Pen {
            radius,
            join: stroke.join,
            cap: stroke.cap,
            miter_limit: stroke.miter_limit,
            least: tolerance * 1e-3,
            step: 4.0 * (tolerance / radius / 2.0).sqrt().min(0.5).asin(),
            window,
            matrix: *matrix,
            heading: None,
            length: 0.0,
            forward: Vec::new(),
            backward: Vec::new(),
            points: Vec::new(),
            ring,
        }
    }

    /// A straight piece; the pen is lowered if it is up, with a cap unless the piece is the `first` of its subpath.
    pub(super) fn draw(&mut self, from: Point, to: Point, heading: Heading, smooth: bool, first: bool) -> Result<()> {
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let mut begin = Some(from);
        if self.heading.is_some() {
            if self.turn(from, heading, length, smooth)? {
                begin = None;
            }
        } else if !first {
            self.cap_apart(from, heading.map(|x| -x))?;
        }
        let normal = self.normal(heading);
        for p in begin.into_iter().chain([to]) {
            push(&mut self.forward, offset(p, normal, -1.0));
            push(&mut self.backward, offset(p, normal, 1.0));
        }
        (self.heading, self.length) = (Some(heading), length);
        if self.forward.len().max(self.backward.len()) > STRETCH {
            self.emit()?;
            self.forward.push(offset(to, normal, -1.0));
            self.backward.push(offset(to, normal, 1.0));
        }
        Ok(())
    }

    /// The turn at `p` towards a piece of some length. True if the piece begins at the bisector, where both sides have their points already.
    fn turn(&mut self, p: Point, heading: Heading, length: f64, smooth: bool) -> Result<bool> {
        let Some(last) = self.heading.filter(|&last| !self.is_slight(last, heading)) else { return Ok(false) };
        let (sine, cosine) = sine_and_cosine(last, heading);
        let angle = sine.atan2(cosine);
        let left = angle > 0.0;
        let outer = [last, heading].map(|h| self.normal(h).map(|v| if left { -v } else { v }));
        let miter = [0, 1].map(|i| (outer[0][i] + outer[1][i]) / (1.0 + cosine));
        let round = smooth || self.join == Join::Round;
        // 32-bit noise does not decide at the limit.
        let mitered = matches!(self.join, Join::Miter | Join::MiterClip) && 2.0 <= self.miter_limit.powi(2) * (1.0 + cosine) * (1.0 + 1e-5);

        let short = cosine > 0.0 && self.radius * sine.abs() <= 0.5 * length.min(self.length);
        let (out, inner) = if left { (&mut self.forward, &mut self.backward) } else { (&mut self.backward, &mut self.forward) };
        if short && out.len().min(inner.len()) > 1 && if round { angle.abs() <= self.step } else { mitered } {
            out.pop();
            inner.pop();
            out.push(offset(p, miter, 1.0));
            inner.push(offset(p, miter, -1.0));
            return Ok(true);
        }
        inner.push(p);
        if round {
            arc(out, p, outer[0], angle, self.step, &self.window);
        } else if mitered {
            out.push(offset(p, miter, 1.0));
        } else if self.join == Join::MiterClip {
            let [c, s] = [(1.0 + cosine) / 2.0, (1.0 - cosine) / 2.0].map(|square| square.max(0.0).sqrt());
            let far = self.radius * (self.miter_limit - c) / s;
            if far > 0.0 {
                out.push(offset(offset(p, outer[0], 1.0), last, far));
                out.push(offset(offset(p, outer[1], 1.0), heading, -far));
            }
        }
        if smooth {
            let [from, to] = if left { outer } else { [outer[1], outer[0]] };
            let mut sector = vec![p, offset(p, from, -1.0)];
            arc(&mut sector, p, from.map(|v| -v), angle.abs(), self.step, &self.window);
            sector.push(offset(p, to, -1.0));
            self.apart(&sector)?;
        }
        Ok(false)
    }

    /// Ends a line with a cap.
    pub(super) fn end(&mut self, p: Point) -> Result<()> {
        if let Some(heading) = self.heading {
            let cap = self.cap(p, heading);
            self.forward.extend(cap);
        }
        self.lift()
    }

    /// Ends a line where that is not seen, or where its end is its beginning.
    pub(super) fn lift(&mut self) -> Result<()> {
        self.heading = None;
        self.emit()
    }

    /// The points of a cap between the corners of the piece that it ends.
    fn cap(&self, p: Point, heading: Heading) -> Vec<Point> {
        let normal = self.normal(heading);
        let mut points = Vec::new();
        match self.cap {
            Cap::Butt => {}
            Cap::Square => {
                let front = offset(p, heading, self.radius);
                points.extend([offset(front, normal, -1.0), offset(front, normal, 1.0)]);
            }
            Cap::Round => arc(&mut points, p, normal.map(|v| -v), std::f64::consts::PI, self.step, &self.window),
        }
        points
    }

    /// A cap as a ring of its own.
    pub(super) fn cap_apart(&mut self, p: Point, heading: Heading) -> Result<()> {
        if self.cap == Cap::Butt {
            return Ok(());
        }
        let normal = self.normal(heading);
        let mut ring = self.cap(p, heading);
        ring.extend([offset(p, normal, 1.0), offset(p, normal, -1.0)]);
        self.apart(&ring)
    }

    /// Hands over what both sides enclose.
    fn emit(&mut self) -> Result<()> {
        if self.forward.is_empty() {
            return Ok(());
        }
        let mut sides = std::mem::take(&mut self.forward);
        sides.extend(self.backward.drain(..).rev());
        let result = self.apart(&sides);
        sides.clear();
        self.forward = sides;
        result
    }

    fn apart(&mut self, ring: &[Point]) -> Result<()> {
        self.points.clear();
        self.points.extend(ring.iter().map(|&p| affine(&self.matrix, p)));
        (self.ring)(&self.points)
    }

    /// From the path to the backward side.
    fn normal(&self, [x, y]: Heading) -> [f64; 2] {
        [-y * self.radius, x * self.radius]
    }

    /// Whether a turn moves nothing.
    pub(super) fn is_slight(&self, from: Heading, to: Heading) -> bool {
        let (sine, cosine) = sine_and_cosine(from, to);
        cosine > 0.0 && sine.abs() * self.radius <= self.least
    }
}

/// Appends the points of an arc around `p` between its ends, which are `from` away and that turned by `angle`. What lies on one side of the
/// window becomes its chord.
fn arc(points: &mut Vec<Point>, p: Point, from: [f64; 2], angle: f64, step: f64, window: &Window) {
    let steps = (angle.abs() / step).ceil().clamp(1.0, STEPS) as u64;
    let turned = |k: u64| {
        let (sine, cosine) = (angle * (k as f64 / steps as f64)).sin_cos();
        [from[0] * cosine - from[1] * sine, from[0] * sine + from[1] * cosine]
    };
    let mut stack = vec![(0, steps)];
    while let Some((start, end)) = stack.pop() {
        let part = angle * ((end - start) as f64 / steps as f64);
        if end - start <= FEW
            || (part.abs() < 1.5 && {
                let [a, b] = [turned(start), turned(end)];
                let tip = [a[0] + b[0], a[1] + b[1]].map(|v| v / (1.0 + part.cos()));
                beside(&[a, b, tip].map(|v| offset(p, v, 1.0)), window)
            })
        {
            let first = if end - start <= FEW { start + 1 } else { end };
            points.extend((first..=end).filter(|&k| k < steps).map(|k| offset(p, turned(k), 1.0)));
        } else {
            let middle = start + (end - start) / 2;
            stack.extend([(middle, end), (start, middle)]);
        }
    }
}

fn push(points: &mut Vec<Point>, p: Point) {
    if points.last() != Some(&p) {
        points.push(p);
    }
}

fn offset(p: Point, by: [f64; 2], times: f64) -> Point {
    [p[0] + by[0] * times, p[1] + by[1] * times]
}

fn sine_and_cosine(a: Heading, b: Heading) -> (f64, f64) {
    (a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1])
}
