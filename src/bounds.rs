//! Boxes: what shapes and solids stay within, and what a combination of them stays within.
//!
//! Boxes along the axes, of least and greatest coordinates: pixels, units of a model, or distances along a view.

use crate::count::Rule;

/// The least and the greatest coordinates, if there is anything.
pub type Bounds<const N: usize> = Option<[[f64; N]; 2]>;

/// The box of everything.
pub const fn everywhere<const N: usize>() -> Bounds<N> {
    Some([[f64::NEG_INFINITY; N], [f64::INFINITY; N]])
}

/// What is in both.
pub fn meet<const N: usize>(a: Bounds<N>, b: Bounds<N>) -> Bounds<N> {
    let (a, b) = (a?, b?);
    let low: [f64; N] = std::array::from_fn(|i| a[0][i].max(b[0][i]));
    let high: [f64; N] = std::array::from_fn(|i| a[1][i].min(b[1][i]));
    (0..N).all(|i| low[i] <= high[i]).then_some([low, high])
}

/// The least box around both.
pub fn join<const N: usize>(a: Bounds<N>, b: Bounds<N>) -> Bounds<N> {
    let (Some(a), Some(b)) = (a, b) else { return a.or(b) };
    Some([std::array::from_fn(|i| a[0][i].min(b[0][i])), std::array::from_fn(|i| a[1][i].max(b[1][i]))])
}

/// A box around all that a node covers which counts its inputs by that rule, from their weights and boxes: within those that it cannot do without, and
/// around all that count for it.
pub fn covered<const N: usize>(rule: Rule, inputs: impl Iterator<Item = (i32, Bounds<N>)> + Clone) -> Bounds<N> {
    let all = |inputs: &mut dyn Iterator<Item = (i32, Bounds<N>)>| inputs.fold(None, |all, input| join(all, input.1));
    match rule {
        Rule::Odd | Rule::NonZero => all(&mut inputs.clone()),
        Rule::AtLeast(least) if least <= 0 => everywhere(),
        Rule::AtLeast(least) => {
            let gains = inputs.filter(|input| input.0 > 0);
            let most: i64 = gains.clone().map(|input| i64::from(input.0)).sum();
            let needed = gains.clone().filter(|input| most - i64::from(input.0) < i64::from(least));
            needed.fold(all(&mut gains.clone()), |within, input| meet(within, input.1))
        }
    }
}
