//! What can be said of a face by itself.

use super::{Face, Point, cross, length, minus};

/// The directed edges of a face.
pub(super) fn edges(face: &Face) -> impl Iterator<Item = [u32; 2]> {
    face.rings.iter().flat_map(|ring| (0..ring.len()).map(move |i| [ring[i], ring[(i + 1) % ring.len()]]))
}

/// Twice the area of a face, as a vector along its normal (Newell), and the length of its outline.
pub(super) fn normal(points: &[Point], face: &Face) -> (Point, f64) {
    let Some(&origin) = face.rings.first().and_then(|ring| ring.first()) else { return ([0.0; 3], 0.0) };
    let origin = points[origin as usize];
    let (mut sum, mut around) = ([0.0; 3], 0.0);
    for [a, b] in edges(face) {
        let [p, q] = [a, b].map(|i| minus(points[i as usize], origin));
        let area = cross(p, q);
        sum = [0, 1, 2].map(|i| sum[i] + area[i]);
        around += length(minus(q, p));
    }
    (sum, around)
}
