//! A mesh while it is made: equal corners are one, faces lose the points that they name twice.

use foldhash::HashMap;

use super::{Face, Mesh, Point};

/// Adds corners and faces.
#[derive(Default)]
pub struct Builder {
    mesh: Mesh,
    known: HashMap<[u64; 3], u32>,
}

impl Builder {
    /// Room for as many corners and faces.
    pub fn with_capacity(points: usize, faces: usize) -> Builder {
        let mut builder = Builder::default();
        builder.mesh.points.reserve(points);
        builder.mesh.faces.reserve(faces);
        builder.known.reserve(points);
        builder
    }

    /// The index of a corner, which is new if no other has the same coordinates bit for bit (0 and -0 are the same).
    pub fn point(&mut self, point: Point) -> u32 {
        let point = point.map(|x| x + 0.0);
        *self.known.entry(point.map(f64::to_bits)).or_insert_with(|| {
            self.mesh.points.push(point);
            u32::try_from(self.mesh.points.len() - 1).expect("corners are limited at the door")
        })
    }

    /// Adds a face, counterclockwise as seen from outside, its holes clockwise. What is left with less than three corners is dropped.
    pub fn face(&mut self, rings: impl IntoIterator<Item = Vec<u32>>) {
        let mut rings = rings.into_iter().map(clean);
        let Some(outer) = rings.next().filter(|ring| ring.len() > 2) else { return };
        let rings = std::iter::once(outer).chain(rings.filter(|ring| ring.len() > 2)).collect();
        self.mesh.faces.push(Face::new(rings));
    }

    /// The mesh.
    pub fn finish(self) -> Mesh {
        self.mesh
    }
}

/// Takes out points that follow themselves, and ways that go forth and straight back: `a b b c` and `a b c b`.
fn clean(ring: Vec<u32>) -> Vec<u32> {
    let n = ring.len();
    let untouched = (0..n).all(|i| ring[i] != ring[(i + 1) % n] && ring[i] != ring[(i + 2) % n]);
    if n > 2 && untouched {
        return ring;
    }
    let mut kept: Vec<u32> = Vec::with_capacity(n);
    for point in ring {
        if kept.last() == Some(&point) {
            continue;
        }
        if kept.len() > 1 && kept[kept.len() - 2] == point {
            kept.pop();
        } else {
            kept.push(point);
        }
    }
    // The same across the ends.
    let (mut from, mut to) = (0, kept.len());
    while to - from > 2 {
        if kept[from] == kept[to - 1] {
            to -= 1;
        } else if kept[from] == kept[to - 2] {
            to -= 2;
        } else if kept[from + 1] == kept[to - 1] {
            from += 1;
            to -= 1;
        } else {
            break;
        }
    }
    kept[from..to].to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_lose_what_they_name_twice() {
        for (ring, left) in [
            (vec![1, 2, 3], vec![1, 2, 3]),
            (vec![1, 1, 2, 3, 3, 1], vec![1, 2, 3]),
            (vec![1, 2, 3, 4, 3, 2, 5], vec![1, 2, 5]),
            (vec![4, 1, 2, 3, 4, 5], vec![4, 1, 2, 3]),
            (vec![9, 1, 2, 3, 1], vec![1, 2, 3]),
            (vec![1, 2, 1, 2], vec![1]),
            (vec![], vec![]),
        ] {
            let cleaned = clean(ring.clone());
            assert!(cleaned == left || (cleaned.len() < 3 && left.len() < 3), "{ring:?}: {cleaned:?}");
        }
    }

    #[test]
    fn equal_corners_are_one() {
        let mut builder = Builder::default();
        assert_eq!(builder.point([0.0, 1.0, 2.0]), builder.point([-0.0, 1.0, 2.0]));
        assert_ne!(builder.point([0.0, 1.0, 2.0]), builder.point([1e-300, 1.0, 2.0]));
    }
}
