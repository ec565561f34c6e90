//! Boxes that areas stay within, in the plane and in space, from those of their shapes.

use crate::scene::{Area, Formula, Gate};

/// The least and the greatest coordinates, if there is anything.
pub(super) type Bounds<const N: usize> = Option<[[f64; N]; 2]>;

/// Boxes of areas, from those of the shapes.
pub(super) struct Extents<'s, const N: usize> {
    formula: &'s Formula,
    of_shape: &'s [Bounds<N>],
    known: Vec<Option<Bounds<N>>>,
}

impl<'s, const N: usize> Extents<'s, N> {
    pub(super) fn new(formula: &'s Formula, of_shape: &'s [Bounds<N>]) -> Extents<'s, N> {
        Extents { formula, of_shape, known: vec![None; formula.gates().len()] }
    }

    /// A box that the area stays within, with an explicit stack.
    pub(super) fn of(&mut self, area: Area) -> Bounds<N> {
        let mut open = vec![area];
        while let Some(&area) = open.last() {
            let unknown = |a: &Area| self.known[a.index()].is_none();
            let before = open.len();
            if unknown(&area) {
                match &self.formula.gates()[area.index()] {
                    Gate::Shape(_) => {}
                    Gate::AtLeast(_, inputs) | Gate::Odd(inputs) => open.extend(inputs.iter().map(|i| i.area).filter(unknown)),
                }
                if open.len() == before {
                    self.known[area.index()] = Some(self.by_inputs(area));
                }
            }
            if open.len() == before {
                open.pop();
            }
        }
        self.known[area.index()].expect("the stack empties when all are known")
    }

    /// The box of an area whose inputs' are known: within that of each input that it cannot do without, and of all that count for it.
    fn by_inputs(&self, area: Area) -> Bounds<N> {
        let everywhere = Some([[f64::NEG_INFINITY; N], [f64::INFINITY; N]]);
        let (least, inputs) = match &self.formula.gates()[area.index()] {
            Gate::Shape(shape) => return self.of_shape[*shape as usize],
            Gate::AtLeast(k, inputs) => (i64::from(*k), inputs),
            Gate::Odd(inputs) => (1, inputs),
        };
        let odd = matches!(self.formula.gates()[area.index()], Gate::Odd(_));
        let positive =
            || inputs.iter().filter(|i| odd || i.weight > 0).map(|i| (i64::from(i.weight), self.known[i.area.index()].flatten()));
        if least <= 0 {
            return everywhere;
        }
        let most: i64 = positive().map(|i| i.0).sum();
        let union = positive().filter_map(|i| i.1).fold(None, |all, one| Some(join(all, one)));
        positive().filter(|i| most - i.0 < least).fold(union, |all, (_, one)| meet(all?, one?))
    }
}

fn meet<const N: usize>(a: [[f64; N]; 2], b: [[f64; N]; 2]) -> Bounds<N> {
    let low: [f64; N] = std::array::from_fn(|i| a[0][i].max(b[0][i]));
    let high: [f64; N] = std::array::from_fn(|i| a[1][i].min(b[1][i]));
    (0..N).all(|i| low[i] <= high[i]).then_some([low, high])
}

/// The box around two boxes.
pub(super) fn join<const N: usize>(all: Bounds<N>, one: [[f64; N]; 2]) -> [[f64; N]; 2] {
    all.map_or(one, |a| [std::array::from_fn(|i| a[0][i].min(one[0][i])), std::array::from_fn(|i| a[1][i].max(one[1][i]))])
}
