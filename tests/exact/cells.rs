//! A cube of cells, some of them solid, and what a ray meets of them: from cell to cell, exactly.
//!
//! ```text
//!     +--+--+--+      cell i of an axis is from 2 i - n to 2 i + 2 - n, n cells an axis
//!     |##|  |##|
//!   --+--+--+>>|      the ray leaves a cell where it crosses the next plane of one axis, or of
//!     |  |  |##|      several at once; the first solid cell that it enters is seen
//!     +--+--+--+
//! ```

use super::{Fraction, Ray};

/// How far along a ray a solid cell is entered, and through planes of which axes, at which of the `n + 1` planes.
pub struct Entered {
    pub t: Fraction,
    pub planes: Vec<(usize, i128)>,
}

/// The first solid cell that a ray from outside enters.
pub fn enters(n: i128, is_solid: &dyn Fn([i128; 3]) -> bool, ray: &Ray) -> Option<Entered> {
    // Where it crosses plane k of an axis.
    let crosses = |axis: usize, k: i128| Fraction::new((2 * k - n) * ray.over - ray.from[axis], ray.along[axis]);
    let moves = |axis: &usize| ray.along[*axis] != 0;
    let forward = |axis: usize| ray.along[axis] > 0;
    let still = (0..3).filter(|axis| !moves(axis));
    if still.into_iter().any(|axis| ray.from[axis].abs() >= n * ray.over) {
        return None;
    }
    let [first, last] = [false, true].map(|far| {
        let ends = (0..3).filter(moves).map(move |axis| crosses(axis, if forward(axis) == far { n } else { 0 }));
        if far { ends.min() } else { ends.max() }.expect("a ray goes somewhere")
    });
    if first >= last {
        return None;
    }
    // The cell behind the first crossing: an axis that is crossed there is entered, others are within.
    let mut cell = [0, 1, 2].map(|axis| {
        let Fraction(above, below) = first;
        let place = ray.from[axis] * below + above * ray.along[axis] + n * ray.over * below;
        let (k, rest) = (place.div_euclid(2 * ray.over * below), place.rem_euclid(2 * ray.over * below));
        if rest == 0 && ray.along[axis] < 0 { k - 1 } else { k }
    });
    let mut t = first;
    loop {
        if is_solid(cell) {
            let plane = |axis: usize| if forward(axis) { cell[axis] } else { cell[axis] + 1 };
            let planes = (0..3).filter(moves).map(|axis| (axis, plane(axis))).filter(|&(axis, k)| crosses(axis, k) == t);
            return Some(Entered { t, planes: planes.collect() });
        }
        let leaves = |axis: usize| crosses(axis, cell[axis] + i128::from(forward(axis)));
        t = (0..3).filter(moves).map(leaves).min().expect("a ray goes somewhere");
        let next = [0, 1, 2].map(|axis| {
            let step = if forward(axis) { 1 } else { -1 };
            if moves(&axis) && leaves(axis) == t { cell[axis] + step } else { cell[axis] }
        });
        cell = next;
        if cell.iter().any(|k| !(0..n).contains(k)) {
            return None;
        }
    }
}
