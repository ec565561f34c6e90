//! How scanlines came about: which were counted, and on one of them every crossing with what it did to the counters.
//!
//! The engine keeps none of this while it sweeps. For the lines that are asked about the sweep runs again from the beginning of their band, so that what
//! it tells of them is what it did ([`How`]); and the one line whose crossings are wanted is walked once more over the scene's own formula, every count
//! noted ("CSG" in ARCHITECTURE.md, section 2.2.3, figures 2.10 to 2.12):
//!
//! ```text
//!   a - b     column     2     5     9
//!             crossed    a+    b+    a-  b-
//!             a - b   0  1     0     0            at least 1: the run [2,5)
//! ```
//!
//! Cost: the sweep of the bands that the lines are in, and for the one line its crossings times what flips.

use std::collections::{BTreeSet, HashMap};

use super::{Job, Options, layers};
use crate::count::Rule;
use crate::edge::{Builder, Side};
use crate::error::{Error, Kind, Result, Warning};
use crate::region::Rows;
use crate::run::Lines;
use crate::scene::{self, Gate, Layer, Scene};
use crate::sweep::Sweep;

/// Most lines that are told of at once.
const MOST_LINES: u32 = 8192;

/// Most edges stepped for that.
const MOST_STEPS: u64 = 1 << 30;

/// Most crossings, and changes of counts, on the line that is walked.
const MOST_CHANGES: usize = 1 << 17;

/// So many nodes are told although nothing changes in them: the expression's own operands.
const OPERANDS: usize = 64;

/// Nodes with so few inputs are told with all of them.
const FEW: usize = 4;

/// How the engine came to the runs of a scanline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
#[serde(rename_all = "lowercase")]
pub enum How {
    /// Crossings were counted, in order or around what had changed.
    Counted,
    /// Counted without order, column by column.
    Unordered,
    /// No edge entered, left or passed another: the boundaries of the line above, in new columns.
    Carried,
    /// Nothing moved at all: the line above again.
    Repeated,
}

/// What is told of scanlines.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
pub struct Explanation {
    /// Width of the page in pixels.
    pub width: u32,
    /// The inks, as `#rrggbb`.
    pub inks: Vec<String>,
    /// Lines that follow each other and came about alike: the first, how many, and how.
    pub lines: Vec<(u32, u32, How)>,
    /// The line, if one was asked for.
    pub line: Option<Line>,
}

/// A scanline, walked from left to right.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "serve", schema(as = ExplainedLine))]
pub struct Line {
    /// Which.
    pub y: u32,
    /// The line that was counted last: this one, or one above.
    pub since: u32,
    /// The nodes of the expression that have a part in this line, inputs before what they feed.
    pub nodes: Vec<Vertex>,
    /// The columns in which edges are crossed.
    pub steps: Vec<Step>,
    /// The runs: first column, column behind the last, ink.
    pub runs: Vec<[u32; 3]>,
}

/// A node of the expression: a count and a rule.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "serve", schema(as = ExplainedNode))]
pub struct Vertex {
    /// The id in the document, or the shape's description there.
    pub name: Option<String>,
    /// When it holds: `nonzero`, `odd`, `everywhere`, or `atleast` with `k`.
    pub rule: &'static str,
    /// Its count must be at least this.
    pub k: Option<i32>,
    /// What feeds it, of the nodes told here: which, and its weight.
    pub inputs: Vec<(usize, i32)>,
    /// How many feed it in all.
    pub operands: usize,
    /// Its count at the left side.
    pub start: i32,
    /// The ink that it paints, if it is a layer of the picture.
    pub ink: Option<u32>,
}

/// A column in which edges are crossed, all of them before any node is looked at.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "serve", schema(as = ExplainedStep))]
pub struct Step {
    /// The first pixel behind the crossings.
    pub column: u32,
    /// The edges: which node's, and what it adds there.
    pub crossed: Vec<(usize, i32)>,
    /// Counts that are others now: which node's, and the count.
    pub counts: Vec<(usize, i32)>,
}

/// How the lines of `options` came about; if it is one line, it is walked.
///
/// # Errors
/// Those of [`Job::prepare`]; more lines, work or crossings than can be told.
pub fn explain(mut scene: Scene, options: &Options, warnings: &mut Vec<Warning>) -> Result<Explanation> {
    let layers = layers(&mut scene, options, warnings)?;
    let job = Job::of(scene.clone(), &layers, options)?;
    let header = job.header();
    if header.height() > MOST_LINES {
        let what = format!("{} lines are asked about: at most {MOST_LINES} are told of at once, so name some with lines", header.height());
        return Err(Error::input(Kind::Limit, what));
    }
    let mut told = Explanation {
        width: header.width,
        inks: header.inks.iter().map(|[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}")).collect(),
        lines: Vec::new(),
        line: None,
    };
    let (mut since, mut runs) = (0, Vec::new());
    let mut steps = 0;
    for band in job.bands() {
        // From the band's first line on, as when the page is drawn.
        let mut rows = Rows::new(job.picture.clone(), band.start / job.band * job.band..band.end);
        let mut before = *rows.cost();
        while let Some(Lines { y, n, runs: at_hand }) = rows.next() {
            if y < band.end && band.start < y + n {
                runs = at_hand.iter().map(|run| [run.start, run.end, run.ink]).collect();
            }
            let cost = *rows.cost();
            let how = match () {
                () if cost.unordered > before.unordered => How::Unordered,
                () if cost.counted > before.counted => How::Counted,
                () => How::Carried,
            };
            since = if how == How::Carried { since } else { y };
            before = cost;
            for (lines, how) in [(y..y + 1, how), (y + 1..y + n, How::Repeated)] {
                told.add(lines.start.max(band.start)..lines.end.min(band.end), how);
            }
            steps += rows.stepped() as u64;
            if steps > MOST_STEPS {
                return Err(Error::input(Kind::Limit, "the lines have too many crossings to be told of: name fewer with lines"));
            }
        }
    }
    if header.height() == 1 {
        let mut walk = Walk::new(&scene, &layers, options)?;
        let (nodes, steps) = walk.line(&job, header.lines.start)?;
        told.line = Some(Line { y: header.lines.start, since, nodes, steps, runs });
    }
    Ok(told)
}

impl Explanation {
    fn add(&mut self, lines: std::ops::Range<u32>, how: How) {
        match self.lines.last_mut() {
            _ if lines.is_empty() => {}
            Some((_, n, last)) if *last == how => *n += lines.len() as u32,
            _ => self.lines.push((lines.start, lines.len() as u32, how)),
        }
    }
}

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

/// The formula as it is walked: plainly, each flip told to all that it feeds.
struct Walk<'s> {
    scene: &'s Scene,
    nodes: Vec<Node>,
    /// By layer, its node and its ink.
    layers: Vec<(usize, u32)>,
    /// By leaf of the counting program.
    leaves: Vec<usize>,
}

impl<'s> Walk<'s> {
    fn new(scene: &'s Scene, layers: &[Layer], options: &Options) -> Result<Walk<'s>> {
        let outputs: Vec<_> = layers.iter().map(|layer| layer.area).collect();
        let page = options.size.page(scene.width, scene.height)?;
        let page_alone = Builder::new(page.width, page.height, page.placement, options.tolerance, options.limits.edges);
        let (program, leaf_of) = scene::compile(&scene.formula, &scene.shapes, &outputs, |shape| page_alone.holds_page(shape));
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
        let (_, ink_of_layer) = super::distinct_inks(layers);
        Ok(Walk {
            scene,
            layers: outputs.iter().map(|area| node_of[area.index()].expect("it was reached")).zip(ink_of_layer).collect(),
            leaves: leaf_of.iter().map(|(shape, _)| of_shape[shape]).collect(),
            nodes,
        })
    }

    /// Walks a line. Gives the nodes that are told, and the steps, which name them by their places.
    fn line(&mut self, job: &Job, y: u32) -> Result<(Vec<Vertex>, Vec<Step>)> {
        let mut sweep: Sweep<Side> = Sweep::new(y..y + 1);
        sweep.next(&job.picture.outlines().edges);
        let start: Vec<i32> = self.nodes.iter().map(|node| node.count).collect();
        let mut crossings = sweep.columns().iter().zip(sweep.list()).filter(|(column, _)| **column < job.header().width).peekable();
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
                ink: self.layers.iter().find(|layer| layer.0 == node).map(|layer| layer.1),
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
