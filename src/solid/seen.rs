//! Counting along depth: which of the active faces is seen ("CSG" in ARCHITECTURE.md, sections 3.3.4 and 4.2.3).

use std::ops::Range;

use super::active::{Active, Faces};
use super::savings::Savings;
use super::stage::Stage;
use crate::count::{Counters, Node};

/// What a count has found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Visible {
    /// Which of the active faces is seen, if any is.
    pub(super) seen: Option<usize>,
    /// How many there are up to the last that is as near as that: all, if none is seen.
    pub(super) front: usize,
    /// Whether it was counted, and not known.
    pub(super) counted: bool,
}

/// The counters, and what they found last.
#[derive(Debug)]
pub(super) struct Count {
    counters: Counters,
    holds: bool,
    /// What was in front of the visible face of the last count, that face's group too: leaf, turns, and whether it is as near as the one before.
    front: Vec<(Node, i32, bool)>,
    /// Which of the group that was, if any was visible.
    seen: Option<usize>,
    /// For every face whether it was one of those in front.
    ahead: Vec<bool>,
    listed: Vec<u32>,
    /// While it is looked at which parts made a difference: nodes above their leaves, and what is known of each node.
    above: Vec<Node>,
    marks: Vec<Mark>,
}

/// What is known of a node while it is looked at which parts made a difference.
#[derive(Clone, Copy, Debug, Default)]
struct Mark {
    /// Whether it is above one of their leaves.
    above: bool,
    /// Whether it held with them.
    held: bool,
    /// Whether a path of nodes that flipped leads from it to the root.
    leads: bool,
}

impl Count {
    pub(super) fn new(stage: &Stage) -> Count {
        let counters = Counters::new(&stage.program);
        Count {
            counters,
            holds: false,
            front: Vec::new(),
            seen: None,
            ahead: vec![false; stage.faces.len()],
            listed: Vec::new(),
            above: Vec::new(),
            marks: vec![Mark::default(); stage.program.nodes()],
        }
    }

    /// Whether a face was among those up to the one that was seen last, or as near as that.
    #[inline]
    pub(super) fn is_ahead(&self, face: u32) -> bool {
        self.ahead[face as usize]
    }

    /// Forgets what was found.
    pub(super) fn forget(&mut self) {
        self.seen = None;
    }

    /// Which of the active faces, as they are in order, is seen.
    pub(super) fn visible(&mut self, stage: &Stage, faces: &Faces, savings: Savings) -> Visible {
        let visible = self.look(stage, faces, savings);
        self.listed.drain(..).for_each(|face| self.ahead[face as usize] = false);
        self.listed.extend(faces.list()[..visible.front].iter().map(|active| active.face));
        self.listed.iter().for_each(|face| self.ahead[*face as usize] = true);
        visible
    }

    fn look(&mut self, stage: &Stage, faces: &Faces, savings: Savings) -> Visible {
        if savings.spans && self.is_as_before(stage, faces) {
            return Visible { seen: self.seen, front: self.front.len(), counted: false };
        }
        self.front.clear();
        let all = faces.list().len();
        let (mut i, mut front, mut seen) = (0, all, None);
        while i < all && (seen.is_none() || !savings.early) {
            let end = group_end(faces.list(), i);
            self.count(stage, faces, i..end, 1);
            if self.holds && seen.is_none() {
                seen = Some(self.candidate(stage, faces, i..end));
                front = end;
            }
            i = end;
        }
        self.count(stage, faces, 0..i, -1);
        self.front.extend((0..front).map(|k| entry(stage, faces, k)));
        self.seen = seen;
        Visible { seen, front, counted: true }
    }

    /// Whether what decided last stands here too, and nothing else is as near as the face seen there.
    fn is_as_before(&self, stage: &Stage, faces: &Faces) -> bool {
        let (front, list) = (self.front.len(), faces.list());
        self.seen.is_some()
            && front <= list.len()
            && (0..front).all(|i| entry(stage, faces, i) == self.front[i])
            && (front == list.len() || list[front].near != list[front - 1].near)
    }

    /// Adds the turns of some active faces to the counters, times `sign`.
    fn count(&mut self, stage: &Stage, faces: &Faces, which: Range<usize>, sign: i32) {
        for active in &faces.list()[which] {
            self.counters.add(stage.faces[active.face as usize].leaf, sign * faces.turns(active.face));
        }
        let holds = &mut self.holds;
        self.counters.settle(&stage.program, |_, now| *holds = now);
    }

    /// Which of a group is shown that has just made the model hold: the first whose part made a difference up to the root.
    fn candidate(&mut self, stage: &Stage, faces: &Faces, group: Range<usize>) -> usize {
        let list = &faces.list()[group.clone()];
        let leaf = |active: &Active| stage.faces[active.face as usize].leaf;
        if list.iter().all(|active| leaf(active) == leaf(&list[0])) {
            return group.start;
        }
        for active in list {
            self.above.push(leaf(active));
        }
        let mut i = 0;
        while i < self.above.len() {
            let node = self.above[i];
            i += 1;
            let mark = &mut self.marks[node as usize];
            if !std::mem::replace(&mut mark.above, true) {
                mark.held = self.counters.truths()[node as usize];
                self.above.extend(stage.program.fed(node));
            }
        }
        // Parents before children, each once.
        self.above.sort_unstable_by(|a, b| b.cmp(a));
        self.above.dedup();
        self.count(stage, faces, group.clone(), -1);
        for &node in &self.above {
            let flipped = self.counters.truths()[node as usize] != self.marks[node as usize].held;
            let up = node == stage.program.output(0) || stage.program.fed(node).any(|parent| self.marks[parent as usize].leads);
            self.marks[node as usize].leads = flipped && up;
        }
        self.count(stage, faces, group.clone(), 1);
        let first = list.iter().position(|active| self.marks[leaf(active) as usize].leads).unwrap_or(0);
        self.above.drain(..).for_each(|node| self.marks[node as usize] = Mark::default());
        group.start + first
    }
}

/// Behind the faces that are as near as the one at `start`.
fn group_end(list: &[Active], start: usize) -> usize {
    start + list[start..].iter().take_while(|active| active.near == list[start].near).count()
}

fn entry(stage: &Stage, faces: &Faces, i: usize) -> (Node, i32, bool) {
    let list = faces.list();
    let Active { face, near, .. } = list[i];
    (stage.faces[face as usize].leaf, faces.turns(face), i > 0 && list[i - 1].near == near)
}
