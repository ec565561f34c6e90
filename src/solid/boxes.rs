//! Where parts matter: the boxes of products ("CSG" in ARCHITECTURE.md, section 3.4.1), on any tree.
//!
//! What an intersection covers lies in each of its operands, so what an operand has outside of the others is of no use. From the leaves up, every node gets a box that holds all
//! that it can cover; from the root down, every leaf the part of its own in which it can matter:
//!
//! ```text
//!      up      a & b   the boxes of both        a - b   that of a          a | b, a ^ b   the hull
//!      down    live(child) = live(parent) and box(parent); for several parents their hull
//! ```
//!
//! Boxes are ranges of the screen, which are the paper's slopes, and of the distance. A leaf may be anything outside of its live box, and is taken to be empty there: its
//! edges are clipped to the live columns and rows as all are to those of the page, and a part that is nowhere alive has none.

// What is alive of a part is not clipped in depth, although the paper does: a cut there needs a cap, which is a face more to pass; what lies behind the
// visible face is not counted anyway, and what lies in front is few.

use crate::count::{Node, Program, Rule};

/// Ranges of columns and rows, in pixels, and of distance along the view. Empty if a range is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent(pub(super) [[f64; 2]; 3]);

impl Extent {
    pub(super) const EMPTY: Extent = Extent([[f64::INFINITY, f64::NEG_INFINITY]; 3]);
    pub(super) const ALL: Extent = Extent([[f64::NEG_INFINITY, f64::INFINITY]; 3]);

    pub(super) fn is_empty(&self) -> bool {
        self.0.iter().any(|range| range[0] > range[1])
    }

    /// What is in both.
    pub(super) fn and(self, other: Extent) -> Extent {
        Extent([0, 1, 2].map(|i| [self.0[i][0].max(other.0[i][0]), self.0[i][1].min(other.0[i][1])]))
    }

    /// The least box around both.
    pub(super) fn hull(self, other: Extent) -> Extent {
        match (self.is_empty(), other.is_empty()) {
            (true, _) => other,
            (_, true) => self,
            _ => Extent([0, 1, 2].map(|i| [self.0[i][0].min(other.0[i][0]), self.0[i][1].max(other.0[i][1])])),
        }
    }
}

/// The live boxes of a program's leaves, by node, from their own; `root` is the node that is shown.
pub(super) fn live(program: &Program, leaves: impl Fn(Node) -> Extent, root: Node) -> Vec<Extent> {
    let nodes = program.nodes();
    let mut inputs: Vec<Vec<(Node, i32)>> = vec![Vec::new(); nodes];
    program.links().for_each(|(child, parent, weight)| inputs[parent as usize].push((child, weight)));
    let mut boxes: Vec<Extent> = Vec::with_capacity(nodes);
    for node in 0..nodes {
        let extent =
            if node < program.leaves() { leaves(node as Node) } else { covered(program.rule(node as Node), &inputs[node], &boxes) };
        boxes.push(extent);
    }
    let mut live = vec![Extent::EMPTY; nodes];
    live[root as usize] = Extent::ALL;
    for node in (0..nodes).rev() {
        let here = live[node].and(boxes[node]);
        inputs[node].iter().for_each(|&(child, _)| live[child as usize] = live[child as usize].hull(here));
    }
    live.truncate(program.leaves());
    live.iter().zip(boxes).map(|(live, own)| live.and(own)).collect()
}

/// A box that holds all that a node covers, from those of what feeds it.
fn covered(rule: Rule, inputs: &[(Node, i32)], boxes: &[Extent]) -> Extent {
    let of = |node: Node| boxes[node as usize];
    let hull = |extents: &mut dyn Iterator<Item = Extent>| extents.fold(Extent::EMPTY, Extent::hull);
    match rule {
        Rule::Odd | Rule::NonZero => hull(&mut inputs.iter().map(|&(node, _)| of(node))),
        Rule::AtLeast(least) if least <= 0 => Extent::ALL,
        Rule::AtLeast(least) => {
            let gains = || inputs.iter().filter(|input| input.1 > 0);
            let most: i64 = gains().map(|input| i64::from(input.1)).sum();
            // Without those that are needed it does not hold, nor without all.
            let needed = gains().filter(|input| most - i64::from(input.1) < i64::from(least)).map(|input| of(input.0));
            needed.fold(hull(&mut gains().map(|input| of(input.0))), Extent::and)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_those_of_what_can_be_covered() {
        let extent = |from: f64, to: f64| Extent([[from, to], [0.0, 1.0], [0.0, 1.0]]);
        let own = [extent(0.0, 4.0), extent(3.0, 7.0), extent(6.0, 9.0)];
        // Rule, weights of three leaves, what is live of each.
        let cases = [
            (Rule::AtLeast(3), [1, 1, 1], [None; 3]),
            (Rule::AtLeast(2), [1, 1, 0], [Some([3.0, 4.0]), Some([3.0, 4.0]), None]),
            (Rule::AtLeast(1), [1, -1, -1], [Some([0.0, 4.0]), Some([3.0, 4.0]), None]),
            (Rule::AtLeast(1), [1, 1, 1], [Some([0.0, 4.0]), Some([3.0, 7.0]), Some([6.0, 9.0])]),
            (Rule::Odd, [1, 0, 1], [Some([0.0, 4.0]), None, Some([6.0, 9.0])]),
            (Rule::AtLeast(0), [-1, 0, 0], [Some([0.0, 4.0]), None, None]),
        ];
        for (rule, weights, expected) in cases {
            let mut program = Program::default();
            let leaves: Vec<Node> = (0..3).map(|_| program.leaf(Rule::AtLeast(1))).collect();
            let root = program.add(rule, leaves.iter().copied().zip(weights).filter(|input| input.1 != 0));
            let live = live(&program.finish(&[root]), |leaf| own[leaf as usize], root);
            let got: Vec<_> = live.iter().map(|extent| (!extent.is_empty()).then_some(extent.0[0])).collect();
            assert_eq!(got, expected, "{rule:?} {weights:?}");
        }
    }
}
