//! A boolean expression as counters: what a walk along a scanline updates at every edge it crosses.
//!
//! Every node is one integer and one rule. Crossing an edge adds to a leaf; a node whose truth flips adds its weight to its parents,
//! and the news stops where nothing flips. "CSG" in ARCHITECTURE.md, section 2.2.3, has one counter C for one AND, OR or difference; nested, it
//! serves any expression without expanding it:
//!
//! ```text
//!   (a | b) - c       leaf a --1--> [ >= 1 ] --1--> [ >= 1 ] = the picture
//!                     leaf b --1-->            +
//!                     leaf c -----------(-1)--/
//! ```
//!
//! All crossings in one column are added before [`Counters::settle`] is called once, so a tie never shows a state that no pixel has.
//! Cost: a step or two a crossing on usual expressions; at worst the number of nodes whose truth flips times their parents.
//!
//! A node that feeds many others, such as a clip path over thousands of layers, would visit them all whenever it flips, although most have
//! nothing that it could cut. So it does not count in their sums: each of them reads it, and waits for its news only while that would decide.
//! The idea is that of watched literals in solvers of clauses.
//!
//! Nodes stand children before parents, so settling the lowest unsettled node first visits each at most once a column.

use crate::bits::BitSet;

/// When a node holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Its count is at least this.
    AtLeast(i32),
    /// Its count is not 0.
    NonZero,
    /// Its count is odd.
    Odd,
}

impl Rule {
    /// Whether a node with that count holds.
    pub fn holds(self, count: i32) -> bool {
        match self {
            Rule::AtLeast(k) => count >= k,
            Rule::NonZero => count != 0,
            Rule::Odd => count & 1 != 0,
        }
    }
}

/// Index of a node.
pub type Node = u32;

/// The nodes and how they feed each other; shared by all who count with it.
#[derive(Clone, Debug, Default)]
pub struct Program {
    rules: Vec<Rule>,
    leaves: usize,
    /// (child, parent, weight) while it is built; sorted by child, with `first`, once it is finished.
    links: Vec<(Node, Node, i32)>,
    first: Vec<u32>,
    outputs: Vec<Node>,
    output_of: Vec<u32>,
    /// Nodes that read an input instead of being told of it, sorted by that input.
    readers: Vec<Reader>,
    /// For every node which of the readers it is.
    reader_of: Vec<u32>,
    /// For every node which of the inputs that are read it is.
    read_of: Vec<u32>,
    /// For every input that is read the first of its readers; one more at the end.
    first_reader: Vec<u32>,
}

/// A node that reads an input.
#[derive(Clone, Copy, Debug)]
struct Reader {
    node: Node,
    input: Node,
    weight: i32,
    /// Which of the inputs that are read.
    read: u32,
}

const NO_OUTPUT: u32 = u32::MAX;
const NONE: u32 = u32::MAX;

/// A node that feeds more than so many is read by them.
const MANY: u32 = 16;

impl Program {
    /// Adds a leaf. All leaves stand before all other nodes.
    pub fn leaf(&mut self, rule: Rule) -> Node {
        assert_eq!(self.leaves, self.rules.len(), "leaves first");
        self.leaves += 1;
        self.add(rule, [])
    }

    /// Adds a node fed by `inputs` (child and weight), all of which must have been added before.
    /// A child named several times counts with the sum of its weights.
    pub fn add(&mut self, rule: Rule, inputs: impl IntoIterator<Item = (Node, i32)>) -> Node {
        let node = Node::try_from(self.rules.len()).expect("nodes are limited at the door");
        self.rules.push(rule);
        self.links.extend(inputs.into_iter().map(|(child, weight)| (child, node, weight)));
        node
    }

    /// Ends the building: `outputs[i]` is the node whose truth is output `i`. A node may be several outputs.
    #[must_use]
    pub fn finish(mut self, outputs: &[Node]) -> Program {
        self.output_of = vec![NO_OUTPUT; self.rules.len()];
        for (i, &node) in outputs.iter().enumerate() {
            // An output that is taken already gets a node of its own that repeats it.
            let node = if self.output_of[node as usize] == NO_OUTPUT { node } else { self.add(Rule::AtLeast(1), [(node, 1)]) };
            self.output_of.resize(self.rules.len(), NO_OUTPUT);
            self.output_of[node as usize] = u32::try_from(i).expect("fewer outputs than nodes");
            self.outputs.push(node);
        }
        self.links.sort_unstable_by_key(|&(child, parent, _)| (child, parent));
        self.links.dedup_by(|next, kept| {
            let same = (next.0, next.1) == (kept.0, kept.1);
            if same {
                kept.2 += next.2;
            }
            same
        });
        self.let_read();
        self.first = vec![0; self.rules.len() + 1];
        for &(child, ..) in &self.links {
            self.first[child as usize + 1] += 1;
        }
        for i in 0..self.rules.len() {
            self.first[i + 1] += self.first[i];
        }
        debug_assert!(self.check());
        self
    }

    /// Turns links of nodes that feed many into readers, at most one for each parent.
    fn let_read(&mut self) {
        let nodes = self.rules.len();
        let mut fed = vec![0_u32; nodes];
        self.links.iter().for_each(|link| fed[link.0 as usize] += 1);
        (self.reader_of, self.read_of) = (vec![NONE; nodes], vec![NONE; nodes]);
        let Program { rules, links, readers, reader_of, read_of, first_reader, .. } = self;
        links.retain(|&(input, node, weight)| {
            let told = fed[input as usize] <= MANY || reader_of[node as usize] != NONE || !matches!(rules[node as usize], Rule::AtLeast(_));
            if !told {
                if read_of[input as usize] == NONE {
                    read_of[input as usize] = first_reader.len() as u32;
                    first_reader.push(readers.len() as u32);
                }
                reader_of[node as usize] = readers.len() as u32;
                readers.push(Reader { node, input, weight, read: read_of[input as usize] });
            }
            told
        });
        first_reader.push(readers.len() as u32);
    }

    /// Whether every child stands before its parents.
    pub fn check(&self) -> bool {
        let ordered = self.links.iter().all(|&(child, parent, _)| child < parent) && self.readers.iter().all(|r| r.input < r.node);
        ordered && self.first.len() == self.rules.len() + 1
    }

    /// Number of leaves: the nodes that were added before the first that is fed.
    pub fn leaves(&self) -> usize {
        self.leaves
    }

    /// Number of nodes, leaves among them.
    pub fn nodes(&self) -> usize {
        self.rules.len()
    }

    /// The rule of a node.
    pub fn rule(&self, node: Node) -> Rule {
        self.rules[node as usize]
    }

    /// What feeds what: (child, parent, weight), each pair once.
    pub fn links(&self) -> impl Iterator<Item = (Node, Node, i32)> {
        self.links.iter().copied().chain(self.readers.iter().map(|r| (r.input, r.node, r.weight)))
    }

    /// The node whose truth is output `i`.
    pub fn output(&self, i: usize) -> Node {
        self.outputs[i]
    }

    /// Number of outputs.
    pub fn outputs(&self) -> usize {
        self.outputs.len()
    }

    /// The nodes that a node feeds.
    pub fn fed(&self, node: Node) -> impl Iterator<Item = Node> {
        let told = self.parents(node as usize).iter().map(|link| link.1);
        let read = self.read_of[node as usize];
        let readers =
            if read == NONE { 0..0 } else { self.first_reader[read as usize] as usize..self.first_reader[read as usize + 1] as usize };
        told.chain(self.readers[readers].iter().map(|reader| reader.node))
    }

    fn parents(&self, node: usize) -> &[(Node, Node, i32)] {
        &self.links[self.first[node] as usize..self.first[node + 1] as usize]
    }
}

/// The counters of one walk.
#[derive(Clone, Debug)]
pub struct Counters {
    counts: Vec<i32>,
    holds: Vec<bool>,
    unsettled: BitSet,
    /// For every input that is read those of its readers whose truth it decides.
    waiting: Vec<BitSet>,
}

impl Counters {
    /// Counters before the first crossing, everything settled: what holds where no shape does (complements) holds already.
    pub fn new(program: &Program) -> Counters {
        let nodes = program.rules.len();
        let waiting = program.first_reader.windows(2).map(|w| BitSet::new((w[1] - w[0]) as usize)).collect();
        let mut counters = Counters { counts: vec![0; nodes], holds: vec![false; nodes], unsettled: BitSet::new(nodes), waiting };
        (0..nodes).for_each(|node| counters.unsettled.insert(node));
        counters.settle(program, |_, _| ());
        counters
    }

    /// Counts a crossing: `weight` is added to a leaf. Gives its count.
    #[inline]
    pub fn add(&mut self, leaf: Node, weight: i32) -> i32 {
        self.unsettled.insert(leaf as usize);
        let count = &mut self.counts[leaf as usize];
        *count += weight;
        *count
    }

    /// Gives a leaf the count that it has somewhere else on the scanline.
    #[inline]
    pub fn set(&mut self, leaf: Node, count: i32) {
        if self.counts[leaf as usize] != count {
            self.counts[leaf as usize] = count;
            self.unsettled.insert(leaf as usize);
        }
    }

    /// [`Counters::add`] and [`Counters::settle`] for a crossing that is alone in its column: while every node that flips has one parent there is
    /// nothing to be put in order.
    #[inline]
    pub fn cross(&mut self, program: &Program, leaf: Node, weight: i32, mut flip: impl FnMut(u32, bool)) -> i32 {
        let (mut node, mut weight) = (leaf as usize, weight);
        let count = self.counts[node] + weight;
        loop {
            self.counts[node] += weight;
            let holds = self.truth(program, node);
            if holds == self.holds[node] {
                return count;
            }
            self.holds[node] = holds;
            if program.output_of[node] != NO_OUTPUT {
                flip(program.output_of[node], holds);
            }
            match program.parents(node) {
                [] if program.read_of[node] == NONE => return count,
                &[(_, parent, gain)] if program.read_of[node] == NONE => {
                    node = parent as usize;
                    weight = if holds { gain } else { -gain };
                }
                _ => {
                    self.tell(program, node, holds);
                    self.settle(program, flip);
                    return count;
                }
            }
        }
    }

    /// Which nodes hold, as settled.
    pub fn truths(&self) -> &[bool] {
        &self.holds
    }

    /// Carries all that was added up to the outputs; `flip(output, holds)` is called for every output whose truth changed.
    #[inline]
    pub fn settle(&mut self, program: &Program, mut flip: impl FnMut(u32, bool)) {
        while let Some(node) = self.unsettled.first() {
            self.unsettled.remove(node);
            let holds = self.truth(program, node);
            if holds == self.holds[node] {
                continue;
            }
            self.holds[node] = holds;
            self.tell(program, node, holds);
            if program.output_of[node] != NO_OUTPUT {
                flip(program.output_of[node], holds);
            }
        }
    }

    /// Whether a node holds by what it counts and reads.
    #[inline]
    fn truth(&mut self, program: &Program, node: usize) -> bool {
        let (rule, count) = (program.rules[node], self.counts[node]);
        let reader = program.reader_of[node];
        if reader == NONE {
            return rule.holds(count);
        }
        let Reader { input, weight, read, .. } = program.readers[reader as usize];
        let (with, without) = (rule.holds(count + weight), rule.holds(count));
        let place = (reader - program.first_reader[read as usize]) as usize;
        let waiting = &mut self.waiting[read as usize];
        waiting.set(place, with != without);
        if self.holds[input as usize] { with } else { without }
    }

    /// Tells those that a node feeds of its new truth, and those that read it and wait.
    #[inline]
    fn tell(&mut self, program: &Program, node: usize, holds: bool) {
        for &(_, parent, weight) in program.parents(node) {
            self.counts[parent as usize] += if holds { weight } else { -weight };
            self.unsettled.insert(parent as usize);
        }
        let read = program.read_of[node];
        if read != NONE {
            // They wait again once they are settled.
            let first = program.first_reader[read as usize];
            while let Some(place) = self.waiting[read as usize].first() {
                self.waiting[read as usize].remove(place);
                self.unsettled.insert(program.readers[first as usize + place].node as usize);
            }
        }
    }

    /// Whether output `i` holds.
    pub fn output(&self, program: &Program, i: usize) -> bool {
        self.holds[program.outputs[i] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth of `node` by walking the expression, for winding numbers of the leaves: too simple to be wrong.
    fn naive(rules: &[Rule], inputs: &[Vec<(Node, i32)>], windings: &[i32], node: usize) -> bool {
        let sum = if inputs[node].is_empty() {
            windings.get(node).copied().unwrap_or(0)
        } else {
            inputs[node].iter().map(|&(child, weight)| if naive(rules, inputs, windings, child as usize) { weight } else { 0 }).sum()
        };
        rules[node].holds(sum)
    }

    #[test]
    fn counting_is_evaluating() {
        let mut seed = 1u64;
        let mut random = |n: u64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) % n
        };
        for round in 0..400 {
            let leaves = 1 + random(8) as usize;
            let gates = if round % 4 == 0 { 40 + random(40) as usize } else { random(12) as usize };
            let (mut rules, mut inputs) = (Vec::new(), Vec::new());
            let mut program = Program::default();
            for node in 0..leaves + gates {
                let rule = match random(3) {
                    0 => Rule::Odd,
                    1 if node < leaves => Rule::NonZero,
                    _ => Rule::AtLeast(random(4) as i32 - 1),
                };
                let rule = if node < leaves && matches!(rule, Rule::AtLeast(_)) { Rule::NonZero } else { rule };
                let few = random(2) == 0;
                let fed: Vec<(Node, i32)> = if node < leaves {
                    Vec::new()
                } else {
                    (0..1 + random(5))
                        .map(|_| (random(if few { leaves as u64 } else { node as u64 }) as Node, if random(3) == 0 { -1 } else { 1 }))
                        .collect()
                };
                if node < leaves {
                    program.leaf(rule)
                } else {
                    program.add(rule, fed.iter().copied())
                };
                rules.push(rule);
                inputs.push(fed);
            }
            let outputs: Vec<Node> = (0..1 + random(3)).map(|_| random((leaves + gates) as u64) as Node).collect();
            let program = program.finish(&outputs);
            let mut counters = Counters::new(&program);
            let mut windings = vec![0; leaves];
            let mut told: Vec<bool> = (0..outputs.len()).map(|i| counters.output(&program, i)).collect();
            for step in 0..100 {
                let mut told_of = |i: u32, holds| {
                    assert_ne!(told[i as usize], holds, "a flip is told once");
                    told[i as usize] = holds;
                };
                let together = 1 + random(3);
                for _ in 0..together {
                    let (leaf, weight) = (random(leaves as u64) as usize, [1, -1, 2][random(3) as usize]);
                    windings[leaf] += weight;
                    if together == 1 {
                        assert_eq!(counters.cross(&program, leaf as Node, weight, &mut told_of), windings[leaf]);
                    } else {
                        assert_eq!(counters.add(leaf as Node, weight), windings[leaf]);
                    }
                }
                if step == 99 {
                    (0..leaves).for_each(|leaf| counters.set(leaf as Node, 0));
                    windings.fill(0);
                }
                counters.settle(&program, told_of);
                for (i, &node) in outputs.iter().enumerate() {
                    assert_eq!(told[i], naive(&rules, &inputs, &windings, node as usize));
                }
            }
        }
    }
}
