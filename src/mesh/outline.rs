//! Areas of the plane between straight sides, and what is made of them: what extrusions begin with.
//!
//! Booleans are `i_overlay`'s, on whole numbers 2^51 times as fine as the largest coordinate. A corner that was there before keeps its
//! coordinates to the last bit, so that what shared a side shares it afterwards.

use foldhash::HashMap;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;

/// A closed line through corners.
pub type Contour = Vec<[f64; 2]>;

/// Areas that do not overlap: each is an outer contour, counterclockwise, and its holes, clockwise.
pub type Shapes = Vec<Vec<Contour>>;

/// Pairs of sides looked at before an outline counts as tangled.
const PAIRS: u64 = 100_000_000;

/// Crossings of sides before an outline counts as tangled.
const CROSSINGS: u64 = 1_000_000;

/// More sides of an outline meet each other than are worked out: 1,000,000 crossings, or 100,000,000 pairs one above the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tangled;

/// An area: where the contours run around more often counterclockwise than clockwise, or less often. Every contour that was put in runs around its area once.
#[derive(Clone, Debug, Default)]
pub struct Outline {
    contours: Vec<Contour>,
    /// There is one contour, and it does not meet itself.
    simple: bool,
}

impl Outline {
    /// A contour that is convex, or at least does not meet itself; it is taken as counterclockwise.
    pub fn simple(contour: Contour) -> Outline {
        Outline { contours: vec![contour], simple: true }
    }

    /// What lies inside an odd number of the contours.
    ///
    /// # Errors
    /// Too many crossings.
    pub fn odd(self) -> Result<Outline, Tangled> {
        overlay(&self.contours, &[], OverlayRule::Subject, FillRule::EvenOdd).map(Outline::of_shapes)
    }

    /// What contours run around, those counterclockwise once, those clockwise as holes.
    pub fn around(contours: Vec<Contour>) -> Outline {
        Outline { contours, simple: false }
    }

    fn of_shapes(shapes: Shapes) -> Outline {
        let contours: Vec<Contour> = shapes.into_iter().flatten().collect();
        Outline { simple: contours.len() == 1, contours }
    }

    /// The contours.
    pub fn contours(&self) -> &[Contour] {
        &self.contours
    }

    /// The largest coordinate; not a number if one is none.
    pub fn farthest(&self) -> f64 {
        self.contours.iter().flatten().flatten().fold(0.0, |most: f64, x| if x.abs() <= most { most } else { x.abs() })
    }

    /// The number of corners.
    pub fn corners(&self) -> usize {
        self.contours.iter().map(Vec::len).sum()
    }

    /// Whether there is no contour.
    pub fn is_empty(&self) -> bool {
        self.contours.is_empty()
    }

    /// Moved by `[[xx, xy, x0], [yx, yy, y0]]`.
    #[must_use]
    pub fn moved(mut self, m: &[[f64; 3]; 2]) -> Outline {
        let mirrored = m[0][0] * m[1][1] - m[0][1] * m[1][0] < 0.0;
        for contour in &mut self.contours {
            for p in &mut *contour {
                *p = m.map(|[a, b, c]| a * p[0] + b * p[1] + c);
            }
            if mirrored {
                contour.reverse();
            }
        }
        self
    }

    /// All of them together. Nothing is worked out yet.
    pub fn union(outlines: impl IntoIterator<Item = Outline>) -> Outline {
        let mut all = Outline::default();
        for mut outline in outlines {
            if all.is_empty() {
                all = outline;
            } else if !outline.is_empty() {
                // The shorter list is moved: chains of unions stay linear, near enough.
                if all.contours.len() < outline.contours.len() {
                    std::mem::swap(&mut all.contours, &mut outline.contours);
                }
                all.contours.append(&mut outline.contours);
                all.simple = false;
            }
        }
        all
    }

    /// This area without `others`.
    ///
    /// # Errors
    /// Too many crossings.
    pub fn without(self, others: &Outline) -> Result<Outline, Tangled> {
        if self.is_empty() || others.is_empty() {
            return Ok(self);
        }
        overlay(&self.contours, &others.contours, OverlayRule::Difference, FillRule::NonZero).map(Outline::of_shapes)
    }

    /// What this and `other` share.
    ///
    /// # Errors
    /// Too many crossings.
    pub fn within(self, other: &Outline) -> Result<Outline, Tangled> {
        if self.is_empty() || other.is_empty() {
            return Ok(Outline::default());
        }
        overlay(&self.contours, &other.contours, OverlayRule::Intersect, FillRule::NonZero).map(Outline::of_shapes)
    }

    /// The area as shapes that do not overlap.
    ///
    /// # Errors
    /// Too many crossings.
    pub fn shapes(self) -> Result<Shapes, Tangled> {
        if self.simple {
            return Ok(vec![self.contours]);
        }
        overlay(&self.contours, &[], OverlayRule::Subject, FillRule::NonZero)
    }
}

fn overlay(subject: &[Contour], clip: &[Contour], rule: OverlayRule, fill: FillRule) -> Result<Shapes, Tangled> {
    let largest = subject.iter().chain(clip).flatten().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return Ok(Vec::new());
    }
    // A power of two: whole numbers below 2^52 come back as they were.
    let exponent = 51 - largest.log2().ceil().clamp(-900.0, 900.0) as i32;
    let scale = f64::powi(2.0, exponent);
    let mut known: HashMap<[i64; 2], [f64; 2]> = HashMap::default();
    let mut whole = |contour: &Contour| -> Vec<IntPoint<i64>> {
        let point = |&p: &[f64; 2]| {
            let [x, y] = p.map(|x| (x * scale).round() as i64);
            known.entry([x, y]).or_insert(p);
            IntPoint::new(x, y)
        };
        contour.iter().map(point).collect()
    };
    let [subject, clip]: [Vec<Vec<IntPoint<i64>>>; 2] = [subject, clip].map(|all| all.iter().map(&mut whole).collect());
    if tangled(subject.iter().chain(&clip)) {
        return Err(Tangled);
    }
    let mut solver = Overlay::<i64>::new(subject.iter().chain(&clip).map(Vec::len).sum());
    solver.add_source(&subject, ShapeType::Subject);
    solver.add_source(&clip, ShapeType::Clip);
    let back = |p: IntPoint<i64>| *known.get(&[p.x, p.y]).unwrap_or(&[p.x as f64 / scale, p.y as f64 / scale]);
    let shapes = solver.overlay(rule, fill);
    Ok(shapes.into_iter().map(|shape| shape.into_iter().map(|contour| contour.into_iter().map(back).collect()).collect()).collect())
}

/// Whether sides cross more often than is worked out. The work of finding out is limited as well.
fn tangled<'a>(contours: impl Iterator<Item = &'a Vec<IntPoint<i64>>>) -> bool {
    type Side = [[i64; 2]; 2];
    let mut sides: Vec<Side> = Vec::new();
    for contour in contours {
        let next = contour.iter().cycle().skip(1);
        sides.extend(contour.iter().zip(next).map(|(p, q)| {
            let [p, q] = [[p.x, p.y], [q.x, q.y]];
            [p.min(q), p.max(q)]
        }));
    }
    sides.sort_unstable();
    let (mut pairs, mut crossings) = (0_u64, 0_u64);
    for (i, a) in sides.iter().enumerate() {
        for b in sides[i + 1..].iter().take_while(|b| b[0][0] <= a[1][0]) {
            pairs += 1;
            let [low, high] = [a[0][1].min(a[1][1]), a[0][1].max(a[1][1])];
            let apart = b[0][1].max(b[1][1]) < low || b[0][1].min(b[1][1]) > high;
            if !apart && side_of(a, b[0]) * side_of(a, b[1]) < 0 && side_of(b, a[0]) * side_of(b, a[1]) < 0 {
                crossings += 1;
            }
        }
        if pairs > PAIRS || crossings > CROSSINGS {
            return true;
        }
    }
    false
}

/// On which side of a line through two points a third is: -1, 0 or 1.
fn side_of([p, q]: &[[i64; 2]; 2], r: [i64; 2]) -> i32 {
    let [a, b, c, d] = [q[0] - p[0], q[1] - p[1], r[0] - p[0], r[1] - p[1]].map(i128::from);
    (a * d - b * c).signum() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64, side: f64) -> Outline {
        Outline::simple(vec![[x, y], [x + side, y], [x + side, y + side], [x, y + side]])
    }

    fn area(shapes: &Shapes) -> f64 {
        let of =
            |c: &Contour| (0..c.len()).map(|i| (c[i], c[(i + 1) % c.len()])).map(|(p, q)| p[0] * q[1] - q[0] * p[1]).sum::<f64>() / 2.0;
        shapes.iter().flatten().map(of).sum()
    }

    #[test]
    fn booleans_of_squares() {
        let (a, b) = (square(0.1, 0.3, 2.0), square(1.1, 1.3, 2.0));
        let near = |x: f64, y: f64| assert!((x - y).abs() < 1e-12, "{x} {y}");
        near(area(&Outline::union([a.clone(), b.clone()]).shapes().unwrap()), 7.0);
        near(area(&a.clone().within(&b).unwrap().shapes().unwrap()), 1.0);
        let cut = a.without(&b).unwrap().shapes().unwrap();
        near(area(&cut), 3.0);
        assert!(cut[0][0].contains(&[0.1, 0.3]) && cut[0][0].contains(&[2.1, 0.3]), "corners keep their coordinates: {cut:?}");
        let hole = square(0.0, 0.0, 3.0).without(&square(1.0, 1.0, 1.0)).unwrap().shapes().unwrap();
        assert_eq!([hole.len(), hole[0].len()], [1, 2]);
        near(area(&hole), 8.0);
    }

    #[test]
    fn what_is_mirrored_stays_counterclockwise() {
        let moved = square(1.0, 1.0, 2.0).moved(&[[-1.0, 0.0, 0.0], [0.0, 2.0, 0.0]]).shapes().unwrap();
        assert_eq!(area(&moved), 8.0);
    }

    #[test]
    fn tangles_are_refused() {
        let points = (0..4000).map(|i| [f64::from(i % 2) * 1e4 + f64::from(i * 7 % 13), f64::from(i * 2741 % 4001)]).collect::<Vec<_>>();
        assert_eq!(Outline::around(vec![points]).odd().err(), Some(Tangled));
    }
}
