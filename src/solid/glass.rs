//! Translucent parts ("CSG" in ARCHITECTURE.md, section 4.4.3).
//!
//! What is seen of the model is counted without what translucent parts add; what they take away is still taken away. In front of it, or of the background, every face of a translucent part
//! is a layer of glass, nearest first, and of those equally near in the order in which one would be shown:
//!
//! ```text
//!     eye   G+    G-    A+        A | G, with G as glass: A is counted alone, and G+ and G- are layers.
//!      o----|-----|-----|--->     A - G, too: nothing holds before A+, and what is cut away is seen as glass.
//! ```
//!
//! A layer has the colour of what was not cut, from whichever side it is seen.
//!
//! Whether a part adds is a matter of where it stands: below an even number of differences or complements. A part that stands in several places may do both, and is taken to be
//! empty only in those where it adds. An operand of a parity counts as one that adds.

use crate::count::{Node, Program, Rule};
use crate::run::Rgb;

/// How much of what is behind a layer its own colour covers.
pub const OPACITY: f64 = 0.3;

/// A colour behind layers of glass, the nearest first: from the farthest on the colour of each covers [`OPACITY`] of what is behind it. In doubles of the sRGB bytes, rounded once.
pub fn behind(back: Rgb, layers: impl DoubleEndedIterator<Item = Rgb>) -> Rgb {
    let covered = |under: [f64; 3], layer: Rgb| std::array::from_fn(|i| under[i] + (f64::from(layer[i]) - under[i]) * OPACITY);
    layers.rev().fold(back.map(f64::from), covered).map(|channel| channel.round() as u8)
}

/// A program whose leaves `glass` are empty wherever they add.
#[must_use]
pub fn without(program: &Program, glass: &[bool]) -> Program {
    const ADDS: usize = 0;
    let (leaves, nodes, root) = (program.leaves(), program.nodes(), program.output(0));
    let mut inputs: Vec<Vec<(Node, i32)>> = vec![Vec::new(); nodes];
    program.links().for_each(|(child, parent, weight)| inputs[parent as usize].push((child, weight)));
    let is_leaf = |node: usize| node < leaves;
    let side = |rule: Rule, side: usize, weight: i32| match rule {
        Rule::AtLeast(_) if weight > 0 => side,
        Rule::AtLeast(_) => 1 - side,
        Rule::NonZero | Rule::Odd => ADDS,
    };
    // On which sides each node is needed: where it adds, where it takes away.
    let mut needed = vec![[false; 2]; nodes];
    needed[root as usize][ADDS] = true;
    for node in (leaves..nodes).rev() {
        for here in 0..2 {
            if !needed[node][here] {
                continue;
            }
            inputs[node].iter().for_each(|&(child, weight)| needed[child as usize][side(program.rule(node as Node), here, weight)] = true);
        }
    }
    let mut built = Program::default();
    (0..leaves).for_each(|leaf| _ = built.leaf(program.rule(leaf as Node)));
    let mut made: Vec<[Option<Node>; 2]> = vec![[None; 2]; nodes];
    for node in 0..nodes {
        let rule = program.rule(node as Node);
        for here in 0..2 {
            if is_leaf(node) {
                made[node][here] = (here != ADDS || !glass[node]).then_some(node as Node);
            } else if needed[node][here] {
                let child = |&(child, weight): &(Node, i32)| Some((made[child as usize][side(rule, here, weight)]?, weight));
                let inputs: Vec<_> = inputs[node].iter().filter_map(child).collect();
                made[node][here] = Some(built.add(rule, inputs));
            }
        }
    }
    let root = made[root as usize][ADDS].unwrap_or_else(|| built.add(Rule::AtLeast(1), []));
    built.finish(&[root])
}
