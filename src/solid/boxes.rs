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

use crate::bounds::{Bounds, covered, everywhere, join, meet};
use crate::count::{Node, Program};

/// The live boxes of a program's leaves, by node, from their own; `root` is the node that is shown.
pub(super) fn live<const N: usize>(program: &Program, leaves: impl Fn(Node) -> Bounds<N>, root: Node) -> Vec<Bounds<N>> {
    let nodes = program.nodes();
    let mut inputs: Vec<Vec<(Node, i32)>> = vec![Vec::new(); nodes];
    program.links().for_each(|(child, parent, weight)| inputs[parent as usize].push((child, weight)));
    let mut boxes: Vec<Bounds<N>> = Vec::with_capacity(nodes);
    for node in 0..nodes {
        let inputs = inputs[node].iter().map(|&(child, weight)| (weight, boxes[child as usize]));
        boxes.push(if node < program.leaves() { leaves(node as Node) } else { covered(program.rule(node as Node), inputs) });
    }
    let mut live = vec![None; nodes];
    live[root as usize] = everywhere();
    for node in (0..nodes).rev() {
        let here = meet(live[node], boxes[node]);
        inputs[node].iter().for_each(|&(child, _)| live[child as usize] = join(live[child as usize], here));
    }
    live.truncate(program.leaves());
    live.into_iter().zip(boxes).map(|(live, own)| meet(live, own)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::count::Rule;

    #[test]
    fn boxes_are_those_of_what_can_be_covered() {
        let own = [Some([[0.0], [4.0]]), Some([[3.0], [7.0]]), Some([[6.0], [9.0]])];
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
            let expected = expected.map(|range: Option<[f64; 2]>| range.map(|range| range.map(|end| [end])));
            assert_eq!(live, expected, "{rule:?} {weights:?}");
        }
    }
}
