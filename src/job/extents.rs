//! Boxes that areas stay within, in the plane and in space, from those of their shapes.

use crate::bounds::{Bounds, covered};
use crate::count::Rule;
use crate::scene::{Area, Formula, Gate};

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

    /// The box of an area whose inputs' are known.
    fn by_inputs(&self, area: Area) -> Bounds<N> {
        let (rule, inputs) = match &self.formula.gates()[area.index()] {
            Gate::Shape(shape) => return self.of_shape[*shape as usize],
            Gate::AtLeast(k, inputs) => (Rule::AtLeast(*k), inputs),
            Gate::Odd(inputs) => (Rule::Odd, inputs),
        };
        covered(rule, inputs.iter().map(|input| (input.weight, self.known[input.area.index()].flatten())))
    }
}
