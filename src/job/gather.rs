//! The edges of shapes, built by several threads where that pays.

use crate::count::Node;
use crate::edge::Builder;
use crate::error::Result;
use crate::shape::Shape;
use crate::spread::joined;

/// Points of outlines for which another thread pays.
const SHARE: usize = 1 << 14;

/// The edges of those shapes, each counted for its leaf. They do not depend on the number of threads.
///
/// # Errors
/// Those of [`Builder::add`].
pub(super) fn edges(shapes: &[Shape], leaves: &[(usize, Node)], threads: usize, new: impl Fn() -> Builder + Sync) -> Result<Builder> {
    let build = |leaves: &[(usize, Node)]| {
        let mut builder = new();
        for &(shape, leaf) in leaves {
            let shape = &shapes[shape];
            if builder.holds_page(shape) { builder.skip_rectangle() } else { builder.add(shape, leaf)? }
        }
        Ok(builder)
    };
    let groups = groups(shapes, leaves);
    if threads > 1 && groups.len() > 1 {
        let join = |whole: &mut Builder, built: Result<Builder>| built.is_ok_and(|built| whole.append(built));
        if let Some(whole) = joined(&groups, threads, |group| build(group), new(), join) {
            return Ok(whole);
        }
    }
    // One after the other, which also finds the first error.
    build(leaves)
}

/// Shapes that follow each other, together with a share of points.
fn groups<'l>(shapes: &[Shape], leaves: &'l [(usize, Node)]) -> Vec<&'l [(usize, Node)]> {
    let (mut groups, mut first, mut points) = (Vec::new(), 0, 0);
    for (i, &(shape, _)) in leaves.iter().enumerate() {
        points += shapes[shape].path.points().len();
        if points >= SHARE {
            groups.push(&leaves[first..=i]);
            (first, points) = (i + 1, 0);
        }
    }
    groups.push(&leaves[first..]);
    groups
}

#[cfg(test)]
mod tests {
    use crate::encode;
    use crate::job::{Job, More, Options};
    use crate::scene::{Limits, Picture, Scene};
    use crate::shape::{Path, Shape};

    /// Overlapping polygons, a few of them with far more points than the others; `odd` is out of a double's range under its transform.
    fn scene(odd: Option<usize>) -> Scene {
        let mut state = 1_u64;
        let mut random = |n: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % n) as f64
        };
        let mut scene = Scene::new(200.0, 300.0);
        for i in 0..150 {
            let points = if i % 31 == 5 { 30_000 } else { 400 };
            let (x, y) = (random(220), random(320));
            let points: Vec<_> = (0..points).map(|_| [x + random(9000) / 150.0, y + random(9000) / 150.0]).collect();
            let mut path = Path::default();
            path.ring(if odd == Some(i) { &[[f64::MAX; 2], [-f64::MAX, 0.0], [0.0, f64::MAX]] } else { &points });
            scene.add_shape(Shape::new(format!("shape{i}"), path));
        }
        let areas: Vec<_> = (0..150).map(|i| scene.formula.shape(i)).collect();
        scene.picture = Picture::Region(scene.formula.any(&areas));
        scene
    }

    fn options(threads: usize, edges: u64) -> Options {
        Options { limits: Limits { threads, edges, ..Limits::default() }, size: crate::job::Size::Scale(2.0), ..Options::default() }
    }

    #[test]
    fn edges_do_not_depend_on_threads() {
        let seen = |threads| {
            let job = Job::prepare(scene(None), &options(threads, 1_000_000), &mut Vec::new()).unwrap();
            let (mut stream, mut bytes) = (job.stream(encode::by_name("ndjson").unwrap()), Vec::new());
            while stream.next_band(&mut bytes) == More::More {}
            (job.edges, bytes)
        };
        let alone = seen(1);
        // No two points of a polygon that follow each other are equal, but for some.
        assert!((200_000..=145 * 400 + 5 * 30_000).contains(&alone.0), "{}", alone.0);
        for threads in [2, 3, 8] {
            assert!(seen(threads) == alone, "{threads} threads");
        }
    }

    #[test]
    fn the_first_error_is_told() {
        for (odd, limit) in [(Some(77), 1_000_000), (None, 100_000), (None, 12_345), (Some(3), 100_000), (Some(140), 100_000)] {
            let error = |threads| Job::prepare(scene(odd), &options(threads, limit), &mut Vec::new()).unwrap_err();
            assert_eq!(error(1), error(4), "{odd:?}, {limit}");
        }
    }
}
