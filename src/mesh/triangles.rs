//! Faces cut into triangles.

use earcut::Earcut;

use super::face::{edges, normal};
use super::{Face, Point};

/// The triangles of a face: those of `earcut` in the plane that the face is nearest to. Where these do not have the face's edges, because it meets itself, every ring
/// is a fan from its first corner, which always closes.
pub fn triangles(points: &[Point], face: &Face) -> Vec<[u32; 3]> {
    if let [ring] = &face.rings[..]
        && let &[a, b, c] = &ring[..]
    {
        return vec![[a, b, c]];
    }
    let corners: Vec<u32> = face.rings.iter().flatten().copied().collect();
    let (normal, _) = normal(points, face);
    // The two axes that lose least.
    let axis = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).expect("three");
    let [mut u, mut v] = [(axis + 1) % 3, (axis + 2) % 3];
    if normal[axis] < 0.0 {
        std::mem::swap(&mut u, &mut v);
    }
    let flat = corners.iter().map(|&i| points[i as usize]).map(|p| [p[u], p[v]]);
    let holes: Vec<usize> = face
        .rings
        .iter()
        .scan(0, |end, ring| {
            *end += ring.len();
            Some(*end)
        })
        .collect();
    let mut found: Vec<usize> = Vec::new();
    Earcut::new().earcut(flat, &holes[..holes.len() - 1], &mut found);
    let mut cut: Vec<[u32; 3]> = found.chunks_exact(3).map(|t| [corners[t[0]], corners[t[1]], corners[t[2]]]).collect();
    // Earcut does not say which way round its triangles are.
    for turned in [false, true] {
        if turned {
            cut.iter_mut().for_each(|t| t.reverse());
        }
        if same_edges(&cut, face) {
            return cut;
        }
    }
    fans(face)
}

/// The triangles between the first corner of each ring and its sides. Together they have the face's edges, whatever its shape.
pub fn fans(face: &Face) -> Vec<[u32; 3]> {
    let fan = |ring: &Vec<u32>| ring.windows(2).skip(1).map(|w| [ring[0], w[0], w[1]]).collect::<Vec<_>>();
    face.rings.iter().flat_map(fan).collect()
}

/// Whether the edges that triangles do not share are those of the face.
fn same_edges(triangles: &[[u32; 3]], face: &Face) -> bool {
    let inner = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut sums: Vec<([u32; 2], i32)> = inner
        .map(|e| (e, 1))
        .chain(edges(face).map(|e| (e, -1)))
        .map(|([a, b], n)| if a < b { ([a, b], n) } else { ([b, a], -n) })
        .collect();
    sums.sort_unstable();
    sums.chunk_by(|a, b| a.0 == b.0).all(|group| group.iter().map(|s| s.1).sum::<i32>() == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(points: &[Point], triangles: &[[u32; 3]]) -> Point {
        let faces = triangles.iter().map(|t| normal(points, &Face::new(vec![t.to_vec()])).0);
        faces.fold([0.0; 3], |s, n| [0, 1, 2].map(|i| s[i] + n[i]))
    }

    #[test]
    fn holes_stay_open() {
        let ring = |low: f64, high: f64| [[low, low, 5.0], [high, low, 5.0], [high, high, 5.0], [low, high, 5.0]];
        let points: Vec<Point> = ring(0.0, 4.0).into_iter().chain(ring(1.0, 2.0)).collect();
        for turned in [false, true] {
            let mut face = Face::new(vec![vec![0, 1, 2, 3], vec![7, 6, 5, 4]]);
            if turned {
                face.rings.iter_mut().for_each(|r| r.reverse());
            }
            let cut = triangles(&points, &face);
            assert_eq!(cut.len(), 8);
            assert_eq!(area(&points, &cut), [0.0, 0.0, if turned { -30.0 } else { 30.0 }]);
            assert!(same_edges(&cut, &face));
        }
    }

    #[test]
    fn what_meets_itself_is_a_fan() {
        let points = vec![[0.0, 0.0, 0.0], [2.0, 2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let face = Face::new(vec![vec![0, 1, 2, 3]]);
        assert!(same_edges(&triangles(&points, &face), &face));
    }
}
