//! Lines on which most edges cross many others: counted by columns, without order.
//!
//! Where long edges tangle, keeping them in order costs more than all else, and every scanline has to be counted anyway. Here nothing is ordered: an edge
//! changes one number, that of its column in the row of its shape; from left to right these add up to the windings of the shape, 64 pixels at a time they
//! become its truth, and the expression is evaluated on such words. (Compare "CSG" in ARCHITECTURE.md, section 2.2.2, mask images: here a mask is one line.)
//!
//! ```text
//!   edges of a      c=1  c=4  c=4  c=6               even-odd: a bit for each column is flipped
//!   flips           0 1 0 0 0 0 1 0
//!   inside          0 1 1 1 1 1 0 0                  the exclusive or of all flips up to here
//! ```
//!
//! Cost of a scanline: a step and a change for every edge; then for every 64 columns some operations for each shape and each input of a gate, and for each column
//! one more for each shape that is filled by the nonzero rule.

use crate::count::{Program, Rule};
use crate::edge::Side;
use crate::line;
use crate::run::Run;

use super::{PAPER, Picture};

/// Most shapes, layers and inputs of gates for which this pays.
const LEAVES: usize = 16;
const LAYERS: usize = 16;
const INPUTS: usize = 64;

/// Bits of a gate's sum, two's complement.
const PLANES: usize = 8;

/// How the row of a leaf is kept.
#[derive(Clone, Copy, Debug)]
enum Row {
    /// Bits that are flipped, from this word on.
    Flips(usize),
    /// Windings that are added, from this number on.
    Windings(usize),
    /// The leaf has no edges.
    None,
}

/// A gate with what feeds it.
#[derive(Clone, Debug)]
struct Gate {
    node: usize,
    rule: Rule,
    inputs: Vec<(u32, i32)>,
}

/// The rows of shapes on one scanline, and how they make the picture.
#[derive(Clone, Debug)]
pub(super) struct Tangle {
    width: u32,
    /// Words of a row.
    words: usize,
    /// By node.
    rows: Vec<Row>,
    leaves: Vec<(usize, Rule)>,
    flips: Vec<u64>,
    windings: Vec<i32>,
    gates: Vec<Gate>,
    /// By layer: its node.
    layers: Vec<usize>,
    /// By node: 64 pixels.
    truth: Vec<u64>,
}

impl Tangle {
    /// What is needed for a picture; none if it has too many shapes, layers or gates.
    pub(super) fn new(picture: &Picture) -> Option<Tangle> {
        let Picture { program, outlines, .. } = picture;
        let gates: Vec<Gate> = gates(program);
        let inputs: usize = gates.iter().map(|gate| gate.inputs.len()).sum();
        let small = |gate: &Gate| {
            let k = if let Rule::AtLeast(k) = gate.rule { k } else { 0 };
            gate.inputs.iter().map(|input| input.1.unsigned_abs()).sum::<u32>() + k.unsigned_abs() < 1 << (PLANES - 1)
        };
        let layers: Vec<usize> = (0..program.outputs()).map(|i| program.output(i) as usize).collect();
        if outlines.leaves > LEAVES || layers.len() > LAYERS || inputs > INPUTS || !gates.iter().all(small) {
            return None;
        }
        let words = picture.width as usize / 64 + 1;
        let mut rows = vec![Row::None; program.nodes()];
        let mut leaves = Vec::new();
        let (mut flips, mut windings) = (0, 0);
        for node in (0..program.nodes()).filter(|&node| gates.iter().all(|gate| gate.node != node)) {
            let rule = program.rule(node as u32);
            leaves.push((node, rule));
            rows[node] = match rule {
                Rule::Odd => {
                    flips += words;
                    Row::Flips(flips - words)
                }
                Rule::NonZero => {
                    windings += words * 64;
                    Row::Windings(windings - words * 64)
                }
                Rule::AtLeast(_) => Row::None,
            };
        }
        Some(Tangle {
            width: picture.width,
            words,
            rows,
            leaves,
            flips: vec![0; flips],
            windings: vec![0; windings],
            gates,
            layers,
            truth: vec![0; program.nodes()],
        })
    }

    /// About what a scanline with so many edges costs, in the units of [`super::STEP`].
    pub(super) fn cost(&self, edges: usize) -> usize {
        let inputs: usize = self.gates.iter().map(|gate| gate.inputs.len()).sum();
        let rows = 8 * self.flips.len() + 60 * self.windings.len() / 64;
        4 * edges + rows + self.words * (6 + 6 * inputs)
    }

    /// The runs of a scanline, from the positions and tags of its edges.
    pub(super) fn runs(&mut self, picture: &Picture, positions: &[u64], sides: &[Side], runs: &mut Vec<Run>) {
        for (&at, side) in positions.iter().zip(sides) {
            let column = line::column(at) as usize;
            match self.rows[side.leaf as usize] {
                Row::Flips(start) => self.flips[start + column / 64] ^= 1 << (column % 64),
                Row::Windings(start) => self.windings[start + column] += side.winding,
                Row::None => {}
            }
        }
        runs.clear();
        let mut inside = vec![Inside::default(); self.leaves.len()];
        // The visible layers' bits left of the word, the last in the highest bit.
        let mut left = vec![0; self.layers.len()];
        let (mut ink, mut start) = (PAPER, 0);
        for word in 0..self.words {
            for (&(node, rule), inside) in self.leaves.iter().zip(&mut inside) {
                self.truth[node] = match self.rows[node] {
                    Row::Flips(row) => inside.flipped(std::mem::take(&mut self.flips[row + word])),
                    Row::Windings(row) => inside.wound(&mut self.windings[row + word * 64..][..64]),
                    Row::None => {
                        if rule.holds(0) {
                            u64::MAX
                        } else {
                            0
                        }
                    }
                };
            }
            for gate in &self.gates {
                self.truth[gate.node] = gate.truth(&self.truth);
            }
            // Where any layer begins or ends.
            let mut changes = u64::from(word == 0);
            for (left, &node) in left.iter_mut().zip(&self.layers) {
                let truth = self.truth[node];
                changes |= truth ^ (truth << 1 | *left);
                *left = truth >> 63;
            }
            while changes != 0 {
                let bit = changes.trailing_zeros();
                changes &= changes - 1;
                let column = word as u32 * 64 + bit;
                if column >= self.width {
                    break;
                }
                let top = self.layers.iter().rposition(|&node| self.truth[node] >> bit & 1 == 1);
                let now = top.map_or(PAPER, |layer| picture.inks[layer]);
                if now != ink {
                    if ink != PAPER {
                        runs.push(Run { start, end: column, ink });
                    }
                    (ink, start) = (now, column);
                }
            }
        }
        if ink != PAPER {
            runs.push(Run { start, end: self.width, ink });
        }
    }
}

/// Where a leaf stands at the left of a word.
#[derive(Clone, Copy, Debug, Default)]
struct Inside {
    /// All ones if the parity is odd.
    parity: u64,
    winding: i32,
}

impl Inside {
    /// The parity at 64 columns, from their flips.
    fn flipped(&mut self, flips: u64) -> u64 {
        let sum = [1, 2, 4, 8, 16, 32].iter().fold(flips, |sum, shift| sum ^ sum << shift) ^ self.parity;
        self.parity = (sum >> 63).wrapping_neg();
        sum
    }

    /// Where the winding is not 0 in 64 columns, from what is added at each, which is taken.
    fn wound(&mut self, windings: &mut [i32]) -> u64 {
        let mut truth = 0;
        for (bit, winding) in windings.iter_mut().enumerate() {
            self.winding += std::mem::take(winding);
            truth |= u64::from(self.winding != 0) << bit;
        }
        truth
    }
}

impl Gate {
    /// Where the gate holds at 64 columns: its sum is kept in binary, one word for each digit.
    fn truth(&self, truth: &[u64]) -> u64 {
        let k = if let Rule::AtLeast(k) = self.rule { k } else { 0 };
        let mut planes: [u64; PLANES] = std::array::from_fn(|plane| ((-k >> plane & 1) as u64).wrapping_neg());
        for &(input, weight) in &self.inputs {
            for _ in 0..weight.unsigned_abs() {
                let mut carry = truth[input as usize];
                for plane in &mut planes {
                    let digit = *plane;
                    *plane ^= carry;
                    carry &= if weight > 0 { digit } else { !digit };
                }
            }
        }
        match self.rule {
            Rule::AtLeast(_) => !planes[PLANES - 1],
            Rule::NonZero => planes.iter().fold(0, |any, plane| any | plane),
            Rule::Odd => planes[0],
        }
    }
}

/// The nodes that are fed by others, children before parents.
fn gates(program: &Program) -> Vec<Gate> {
    let mut gates: Vec<Gate> = Vec::new();
    let mut links: Vec<(u32, u32, i32)> = program.links().collect();
    links.sort_unstable_by_key(|&(child, parent, _)| (parent, child));
    for parent in links.chunk_by(|a, b| a.1 == b.1) {
        let inputs = parent.iter().map(|&(child, _, weight)| (child, weight)).collect();
        gates.push(Gate { node: parent[0].1 as usize, rule: program.rule(parent[0].1), inputs });
    }
    gates
}
