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
    parents: Parents,
    /// What was in front of the visible face of the last count, that face's group too: leaf, turns, and whether it is as near as the one before.
    front: Vec<(Node, i32, bool)>,
    /// Which of the group that was, if any was visible.
    seen: Option<usize>,
    /// For every face whether it was one of those in front.
    ahead: Vec<bool>,
    listed: Vec<u32>,
    /// Truths before and after a group, while it is looked at who made the difference.
    truths: [Vec<bool>; 2],
}

impl Count {
    pub(super) fn new(stage: &Stage) -> Count {
        let counters = Counters::new(&stage.program);
        let (parents, ahead) = (Parents::new(stage), vec![false; stage.faces.len()]);
        Count { counters, holds: false, parents, front: Vec::new(), seen: None, ahead, listed: Vec::new(), truths: Default::default() }
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
        let [mut before, mut after] = std::mem::take(&mut self.truths);
        self.counters.truths().clone_into(&mut after);
        self.count(stage, faces, group.clone(), -1);
        self.counters.truths().clone_into(&mut before);
        self.count(stage, faces, group.clone(), 1);
        let root = stage.program.output(0);
        let made = |active: &Active| self.parents.leads(leaf(active), root, |node| before[node as usize] != after[node as usize]);
        let first = list.iter().position(made).unwrap_or(0);
        self.truths = [before, after];
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

/// For every node of the program those that it feeds.
#[derive(Debug)]
struct Parents {
    links: Vec<(Node, Node)>,
}

impl Parents {
    fn new(stage: &Stage) -> Parents {
        let mut links: Vec<(Node, Node)> = stage.program.links().map(|(child, parent, _)| (child, parent)).collect();
        links.sort_unstable();
        Parents { links }
    }

    /// Whether a path of nodes that all flipped leads from one to another.
    fn leads(&self, from: Node, to: Node, flipped: impl Fn(Node) -> bool) -> bool {
        let mut open = vec![from];
        let mut seen = vec![];
        while let Some(node) = open.pop() {
            if !flipped(node) || seen.contains(&node) {
                continue;
            }
            if node == to {
                return true;
            }
            seen.push(node);
            let first = self.links.partition_point(|link| link.0 < node);
            open.extend(self.links[first..].iter().take_while(|link| link.0 == node).map(|link| link.1));
        }
        false
    }
}
