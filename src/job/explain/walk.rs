//! The one scanline whose crossings are wanted: the scene's own formula, counted plainly, each flip told to all that it feeds.

use std::collections::{BTreeSet, HashMap};

use super::super::{Options, distinct_inks, program};
use super::{Step, Vertex};
use crate::count::Rule;
use crate::edge::{Builder, Side};
use crate::error::{Error, Kind, Result};
use crate::region::Picture;
use crate::scene::{Gate, Layer, Scene};
use crate::sweep::Sweep;

/// Most crossings, and changes of counts, on the line that is walked.
const MOST_CHANGES: usize = 1 << 17;

/// So many nodes are told although nothing changes in them: the expression's own operands.
const OPERANDS: usize = 64;

/// Nodes with so few inputs are told with all of them.
const FEW: usize = 4;

/// A gate that the picture needs.
struct Node {
    /// Index of its area.
    area: usize,
    rule: Rule,
    /// (node, weight), inputs before what they feed.
    inputs: Vec<(usize, i32)>,
    feeds: Vec<(usize, i32)>,
    count: i32,
}

/// The formula as it is walked.
pub(super) struct Walk<'s> {
    scene: &'s Scene,
    nodes: Vec<Node>,
    /// By layer, its node and its ink.
    layers: Vec<(usize, u32)>,
    /// By leaf of the counting program.
    leaves: Vec<usize>,
}

impl<'s> Walk<'s> {
    pub(super) fn new(scene: &'s Scene, layers: &[Layer], options: &Options) -> Result<Walk<'s>> {
        let outputs: Vec<_> = layers.iter().map(|layer| layer.area).collect();
        let page = options.size.page(scene.width, scene.height)?;
        let page_alone = Builder::new(page.width, page.height, page.placement, options.tolerance, options.limits.edges);
        let (program, leaf_of) = program(scene, &outputs, &page_alone);
        let rule_of: HashMap<usize, Rule> = leaf_of.iter().map(|&(shape, leaf)| (shape, program.rule(leaf))).collect();
        let gates = scene.formula.gates();
        // Inputs first, without recursion. A shape that several gates stand for is one node.
        let (mut node_of, mut of_shape) = (vec![None; gates.len()], HashMap::new());
        let mut nodes: Vec<Node> = Vec::new();
        let mut open: Vec<_> = outputs.iter().rev().copied().collect();
        while let Some(&area) = open.last() {
            let i = area.index();
            let before = open.len();
            let (rule, inputs) = match &gates[i] {
                Gate::Shape(shape) => (rule_of[&(*shape as usize)], &[][..]),
                Gate::AtLeast(k, inputs) => (Rule::AtLeast(*k), &inputs[..]),
                Gate::Odd(inputs) => (Rule::Odd, &inputs[..]),
            };
            if node_of[i].is_none() {
                open.extend(inputs.iter().rev().map(|input| input.area).filter(|area| node_of[area.index()].is_none()));
            }
            if open.len() > before {
                continue;
            }
            open.pop();
            if node_of[i].is_some() {
                continue;
            }
            let new = nodes.len();
            let node = if let Gate::Shape(shape) = gates[i] { *of_shape.entry(shape as usize).or_insert(new) } else { new };
            node_of[i] = Some(node);
            if node == new {
                let inputs: Vec<_> =
                    inputs.iter().map(|input| (node_of[input.area.index()].expect("inputs first"), input.weight)).collect();
                let count = inputs.iter().filter(|&&(input, _)| nodes[input].holds()).map(|input| input.1).sum();
                inputs.iter().for_each(|&(input, weight)| nodes[input].feeds.push((new, weight)));
                nodes.push(Node { area: i, rule, inputs, feeds: Vec::new(), count });
            }
        }
        let (_, ink_of_layer) = distinct_inks(layers);
        Ok(Walk {
            scene,
            layers: outputs.iter().map(|area| node_of[area.index()].expect("it was reached")).zip(ink_of_layer).collect(),
            leaves: leaf_of.iter().map(|(shape, _)| of_shape[shape]).collect(),
            nodes,
        })
    }

    /// Walks a line. Gives the nodes that are told, and the steps, which name them by their places.
    pub(super) fn line(&mut self, picture: &Picture, width: u32, y: u32) -> Result<(Vec<Vertex>, Vec<Step>)> {
        let mut sweep: Sweep<Side> = Sweep::new(y..y + 1);
        sweep.next(&picture.outlines().edges);
        let start: Vec<i32> = self.nodes.iter().map(|node| node.count).collect();
        let mut crossings = sweep.columns().iter().zip(sweep.list()).filter(|(column, _)| **column < width).peekable();
        let (mut steps, mut changes) = (Vec::new(), 0);
        while let Some(&(&column, _)) = crossings.peek() {
            let mut crossed = Vec::new();
            while let Some((_, entry)) = crossings.next_if(|other| *other.0 == column) {
                let Side { leaf, winding } = sweep.tags()[entry.slot()];
                crossed.push((self.leaves[leaf as usize], winding));
            }
            let counts = self.cross(&crossed);
            changes += crossed.len() + counts.len();
            if changes > MOST_CHANGES {
                let what = format!("line {y} has more than {MOST_CHANGES} crossings and changes: it cannot be told");
                return Err(Error::input(Kind::Limit, what));
            }
            steps.push(Step { column, crossed, counts });
        }
        let told = self.told(&steps);
        let place: HashMap<usize, usize> = told.iter().enumerate().map(|(place, &node)| (node, place)).collect();
        let rename = |pairs: &mut Vec<(usize, i32)>| pairs.iter_mut().for_each(|pair| pair.0 = place[&pair.0]);
        for step in &mut steps {
            rename(&mut step.crossed);
            rename(&mut step.counts);
        }
        let mut names: HashMap<usize, &str> =
            self.scene.names().iter().rev().map(|named| (named.area.index(), named.id.as_str())).collect();
        names.entry(self.scene.art.index()).or_insert("art");
        let inks: HashMap<usize, u32> = self.layers.iter().copied().collect();
        let vertex = |&node: &usize| {
            let Node { area, rule, inputs, .. } = &self.nodes[node];
            let shape =
                if let Gate::Shape(shape) = self.scene.formula.gates()[*area] { Some(&self.scene.shapes[shape as usize]) } else { None };
            let name = names.get(area).copied().or(shape.map(|shape| shape.name.as_str()));
            let (rule, k) = match *rule {
                Rule::NonZero => ("nonzero", None),
                Rule::Odd => ("odd", None),
                Rule::AtLeast(_) if shape.is_some() => ("everywhere", None),
                Rule::AtLeast(k) => ("atleast", Some(k)),
            };
            Vertex {
                name: name.map(str::to_owned),
                rule,
                k,
                inputs: inputs.iter().filter_map(|&(input, weight)| Some((*place.get(&input)?, weight))).collect(),
                operands: inputs.len(),
                start: start[node],
                ink: inks.get(&node).copied(),
            }
        };
        Ok((told.iter().map(vertex).collect(), steps))
    }

    /// The nodes that something happens to, and the first layers with their operands.
    fn told(&self, steps: &[Step]) -> Vec<usize> {
        let mut told: BTreeSet<usize> = steps.iter().flat_map(|step| step.crossed.iter().chain(&step.counts)).map(|pair| pair.0).collect();
        for &(layer, _) in self.layers.iter().take(OPERANDS) {
            told.insert(layer);
            told.extend(self.nodes[layer].inputs.iter().take(OPERANDS).map(|input| input.0));
        }
        // What a short formula is made of, so that it can be written down. Inputs have lower numbers.
        for node in (0..self.nodes.len()).rev() {
            let inputs = &self.nodes[node].inputs;
            if inputs.len() <= FEW && told.contains(&node) {
                told.extend(inputs.iter().map(|input| input.0));
            }
        }
        told.into_iter().collect()
    }

    /// Crosses the edges of a column, and gives the counts that are others then.
    fn cross(&mut self, crossed: &[(usize, i32)]) -> Vec<(usize, i32)> {
        // (node, count and truth before), lowest first: what is settled is fed by nothing that is not.
        let mut open = BTreeSet::new();
        let mut before: HashMap<usize, (i32, bool)> = HashMap::new();
        let mut counts = Vec::new();
        let add = |nodes: &mut [Node], before: &mut HashMap<usize, (i32, bool)>, node: usize, weight: i32| {
            before.entry(node).or_insert((nodes[node].count, nodes[node].holds()));
            nodes[node].count += weight;
        };
        for &(node, winding) in crossed {
            add(&mut self.nodes, &mut before, node, winding);
            open.insert(node);
        }
        while let Some(node) = open.pop_first() {
            let (count, held) = before[&node];
            let now = &self.nodes[node];
            if now.count != count {
                counts.push((node, now.count));
            }
            if now.holds() != held {
                let sign = if now.holds() { 1 } else { -1 };
                for i in 0..now.feeds.len() {
                    let (parent, weight) = self.nodes[node].feeds[i];
                    add(&mut self.nodes, &mut before, parent, sign * weight);
                    open.insert(parent);
                }
            }
        }
        counts
    }
}

impl Node {
    fn holds(&self) -> bool {
        self.rule.holds(self.count)
    }
}
