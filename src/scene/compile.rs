//! Formulas to counting programs: only what the outputs need, children before parents.

use super::{Area, Formula, Gate};
use crate::count::{Node, Program, Rule};

/// The program whose output i is `outputs[i]`, and those of the `shapes` shapes that it needs, with their leaves, in document order. `rule` tells
/// when a shape holds, by the crossings that are counted.
pub fn compile(formula: &Formula, shapes: usize, outputs: &[Area], rule: impl Fn(usize) -> Rule) -> (Program, Vec<(usize, Node)>) {
    const UNSEEN: Node = Node::MAX;
    let mut program = Program::default();

    // Leaves first, in the order of the document.
    let mut leaf_of = vec![UNSEEN; shapes];
    let mut reached = vec![false; formula.gates().len()];
    let mut open = outputs.to_vec();
    while let Some(area) = open.pop() {
        if !std::mem::replace(&mut reached[area.index()], true)
            && let Gate::AtLeast(_, inputs) | Gate::Odd(inputs) = &formula.gates()[area.index()]
        {
            open.extend(inputs.iter().map(|input| input.area));
        }
    }
    let mut node_of = vec![UNSEEN; formula.gates().len()];
    let mut needed: Vec<(u32, usize)> = Vec::new();
    for (i, gate) in formula.gates().iter().enumerate().filter(|&(i, _)| reached[i]) {
        if let Gate::Shape(shape) = gate {
            needed.push((*shape, i));
        }
    }
    needed.sort_unstable();
    for (index, i) in needed {
        let leaf = &mut leaf_of[index as usize];
        if *leaf == UNSEEN {
            *leaf = program.leaf(rule(index as usize));
        }
        node_of[i] = *leaf;
    }

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
            Gate::Shape(_) => unreachable!("all shapes that are reached have leaves"),
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
