//! Section 2.2.1: clipping to a convex window by Sutherland and Hodgman's way, one side after the other.

/// A point in pixels.
pub type Point = [f64; 2];

/// The part of a closed polygon inside a convex window whose corners go around so that the inside is right of each side (with y down:
/// clockwise as seen). What lies between separate parts comes out as edges along the window, twice.
pub fn clip(polygon: &[Point], window: &[Point]) -> Vec<Point> {
    let mut points = polygon.to_vec();
    let mut kept = Vec::with_capacity(points.len());
    for (side, &from) in window.iter().enumerate() {
        let to = window[(side + 1) % window.len()];
        // Positive inside.
        let depth = |p: Point| (to[0] - from[0]) * (p[1] - from[1]) - (to[1] - from[1]) * (p[0] - from[0]);
        let Some(mut before) = points.last().map(|&p| (p, depth(p))) else { break };
        kept.clear();
        for &point in &points {
            let now = depth(point);
            if (now >= 0.0) != (before.1 >= 0.0) {
                let share = before.1 / (before.1 - now);
                kept.push([0, 1].map(|axis| before.0[axis] + share * (point[axis] - before.0[axis])));
            }
            if now >= 0.0 {
                kept.push(point);
            }
            before = (point, now);
        }
        std::mem::swap(&mut points, &mut kept);
    }
    points
}

/// A regular window of so many sides about a centre, with its first corner half a side right of the top.
pub fn regular(sides: u32, centre: Point, radius: f64) -> Vec<Point> {
    let corner = |i: u32| {
        let angle = std::f64::consts::TAU * (f64::from(i) + 0.5) / f64::from(sides) - std::f64::consts::FRAC_PI_2;
        [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()]
    };
    (0..sides).map(corner).collect()
}
