//! Formulas to counting programs: only what the outputs need, children before parents.

use super::{Area, Formula, Gate};
use crate::count::{Node, Program, Rule};
use crate::shape::{FillRule, Shape};

/// The program whose output i is `outputs[i]`, and the shapes it needs with their leaves, in document order. Leaves of shapes that are
/// `everywhere` hold from the start, and wait for no crossing.
pub fn compile(
    formula: &Formula,
    shapes: &[Shape],
    outputs: &[Area],
    everywhere: impl Fn(&Shape) -> bool,
) -> (Program, Vec<(usize, Node)>) {
    const UNSEEN: Node = Node::MAX;
    let mut node_of = vec![UNSEEN; formula.gates().len()];
    let mut leaf_of = vec![UNSEEN; shapes.len()];
    let mut program = Program::default();

    // Depth first without recursion: an area stays on the stack until its inputs have nodes.
    let mut stack: Vec<Area> = outputs.iter().rev().copied().collect();
    let mut opened = vec![false; formula.gates().len()];
    while let Some(&area) = stack.last() {
        let i = area.index();
        if node_of[i] != UNSEEN {
            stack.pop();
            continue;
        }
        let (rule, inputs) = match &formula.gates()[i] {
            Gate::Shape(shape) => {
                let leaf = &mut leaf_of[*shape as usize];
                if *leaf == UNSEEN {
                    let shape = &shapes[*shape as usize];
                    let rule = match shape.rule {
                        _ if everywhere(shape) => Rule::AtLeast(0),
                        FillRule::NonZero => Rule::NonZero,
                        FillRule::EvenOdd => Rule::Odd,
                    };
                    *leaf = program.add(rule, []);
                }
                node_of[i] = *leaf;
                continue;
            }
            Gate::AtLeast(k, inputs) => (Rule::AtLeast(*k), inputs),
            Gate::Odd(inputs) => (Rule::Odd, inputs),
        };
        if !opened[i] {
            opened[i] = true;
            stack.extend(inputs.iter().rev().map(|input| input.area).filter(|area| node_of[area.index()] == UNSEEN));
        } else {
            node_of[i] = program.add(rule, inputs.iter().map(|input| (node_of[input.area.index()], input.weight)));
            stack.pop();
        }
    }
    let nodes: Vec<Node> = outputs.iter().map(|area| node_of[area.index()]).collect();
    let leaves = leaf_of.into_iter().enumerate().filter(|&(_, leaf)| leaf != UNSEEN).collect();
    (program.finish(&nodes), leaves)
}
