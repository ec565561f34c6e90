//! Scanlines of a stage, as spans that show one face each.
//!
//! The active edges are walked from left to right ("CSG" in ARCHITECTURE.md, sections 3.2 and 4.2.1). Crossing one changes the *turns* of its two faces: how often their
//! outlines have been passed, downwards less upwards. A face is active where its turns are not 0; they are 1 where it is seen from outside and -1
//! from inside, and where rounding turned a sliver over they are what the rounded outline says, so that the turns of a closed part always add up to 0.
//!
//! Between two columns the active faces are kept in the order of their depth, and counted from the eye on (section 3.3.4): the turns of a face are added to the
//! counter of its part, all of one depth together, and the first depth at which the model holds is what is seen.
//!
//! ```text
//!     eye   B+ A+     B-      A-           A - B:   B+ counts -1, A+ 1: 0;  B- gives it back: 1, seen from inside B
//!      o----|--|------|-------|--->
//! ```
//!
//! A span ends where that may change: at the next column of an edge, where two faces before the visible one cross or begin or cease to be equally near, or where one
//! behind it comes as near ([`Depth`] is linear in the column, so the first such pixel is a division; section 4.2.2 looks for the nearest crossing too). What
//! crosses behind the visible face is of no concern (section 4.3.2). If the parts and turns in front are those of the span before, so is what is seen
//! (section 4.3.1, with the conditions that were missing there): nothing is counted.

use std::ops::Range;
use std::sync::Arc;

use super::stage::{Crossing, Face, Stage};
use super::view::Depth;
use crate::count::{Counters, Node};
use crate::sweep::{Scanline, Sweep};

/// Pixels of a scanline that show one face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// First column.
    pub start: u32,
    /// Column behind the last.
    pub end: u32,
    /// The face: an index into [`Stage::faces`].
    pub face: u32,
    /// Whether it is seen from inside of its part: that part is taken away there.
    pub inside: bool,
}

/// What is saved by knowing more than one scanline or span, each of which can be switched off: the spans do not depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Savings {
    /// What is seen is taken from the span before where what is in front has not changed (4.3.1).
    pub spans: bool,
    /// Crossings behind the visible face end no span (4.3.2).
    pub hidden: bool,
}

impl Default for Savings {
    fn default() -> Savings {
        Savings { spans: true, hidden: true }
    }
}

/// What a walk has cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Spans between columns of edges or crossings.
    pub spans: u64,
    /// Counts along depth.
    pub counts: u64,
    /// Spans that ended at a crossing of faces.
    pub crossings: u64,
    /// Largest number of active edges.
    pub peak_active: u64,
}

/// The scanlines of a stage, pulled from top to bottom.
pub struct Spans {
    stage: Arc<Stage>,
    savings: Savings,
    sweep: Sweep<Crossing>,
    /// The edges of the scanline at hand by column: those of the sweep.
    repeat: Option<Scanline>,
    /// How often the outline of each face has been passed.
    turns: Vec<i32>,
    /// Whether a face is in `active`.
    listed: Vec<bool>,
    /// Active faces with their nearness where they were looked at last, the nearest first.
    active: Vec<Active>,
    touched: Vec<u32>,
    counters: Counters,
    holds: bool,
    /// Parents of every node.
    parents: Parents,
    /// What was in front of the visible face of the span before, that face's group too: leaf, turns, and whether it is as near as the one before.
    front: Vec<(Node, i32, bool)>,
    /// Which of the group that was, if any was visible.
    seen: Option<usize>,
    spans: Vec<Span>,
    cost: Cost,
}

#[derive(Clone, Copy, Debug)]
struct Active {
    face: u32,
    plane: u32,
    rank: u32,
    near: i128,
}

impl Spans {
    /// The scanlines `rows` of a stage.
    pub fn new(stage: Arc<Stage>, rows: Range<u32>, savings: Savings) -> Spans {
        let counters = Counters::new(&stage.program);
        Spans {
            savings,
            sweep: Sweep::new(rows),
            repeat: None,
            turns: vec![0; stage.faces.len()],
            listed: vec![false; stage.faces.len()],
            active: Vec::new(),
            touched: Vec::new(),
            holds: false,
            parents: Parents::new(&stage),
            counters,
            front: Vec::new(),
            seen: None,
            spans: Vec::new(),
            cost: Cost::default(),
            stage,
        }
    }

    /// The next scanline and what it shows; none behind the last.
    #[expect(clippy::should_implement_trait, reason = "the spans are lent, not given")]
    pub fn next(&mut self) -> Option<(u32, &[Span])> {
        let Scanline { y, n, .. } = match self.repeat.take() {
            Some(again) => again,
            None => self.sweep.next(&self.stage.edges)?,
        };
        if n > 1 {
            self.repeat = Some(Scanline { y: y + 1, n: n - 1, changed: false });
        }
        self.scanline(y);
        Some((y, &self.spans))
    }

    /// What the scanlines have cost so far.
    pub fn cost(&self) -> &Cost {
        &self.cost
    }

    fn scanline(&mut self, y: u32) {
        let stage = self.stage.clone();
        self.spans.clear();
        self.active.clear();
        self.seen = None;
        let edges = self.sweep.list().len();
        self.cost.peak_active = self.cost.peak_active.max(edges as u64);
        let mut i = 0;
        while i < edges {
            let column = self.sweep.columns()[i];
            if column >= stage.view.width {
                break;
            }
            while i < edges && self.sweep.columns()[i] == column {
                let Crossing { left, right, turns } = self.sweep.tags()[self.sweep.list()[i].slot()];
                self.turn(left, turns);
                self.turn(right, -turns);
                i += 1;
            }
            self.list(&stage);
            let end = self.sweep.columns().get(i).map_or(stage.view.width, |&next| next.min(stage.view.width));
            if !self.active.is_empty() {
                self.fill(&stage, y, column..end);
            }
        }
        for active in self.active.drain(..) {
            (self.turns[active.face as usize], self.listed[active.face as usize]) = (0, false);
        }
    }

    fn turn(&mut self, face: u32, turns: i32) {
        if let Some(all) = self.turns.get_mut(face as usize) {
            *all += turns;
            self.touched.push(face);
        }
    }

    /// Lists the faces that became active, at the end, and drops those that are not any more.
    fn list(&mut self, stage: &Stage) {
        let mut gone = false;
        for face in self.touched.drain(..) {
            let (is, was) = (self.turns[face as usize] != 0, &mut self.listed[face as usize]);
            if is && !*was {
                let Face { plane, rank, .. } = stage.faces[face as usize];
                self.active.push(Active { face, plane, rank, near: 0 });
            }
            gone |= !is && *was;
            *was |= is;
        }
        if gone {
            let (turns, listed) = (&self.turns, &mut self.listed);
            self.active.retain(|active| {
                let stays = turns[active.face as usize] != 0;
                listed[active.face as usize] = stays;
                stays
            });
        }
    }

    /// Shows what is seen on columns between which no edge is crossed.
    fn fill(&mut self, stage: &Stage, y: u32, columns: Range<u32>) {
        let mut start = columns.start;
        while start < columns.end {
            self.order(stage, start, y);
            let (seen, front) = self.visible(stage);
            let end = self.until(stage, start..columns.end, front, seen.is_some());
            self.cost.spans += 1;
            self.cost.crossings += u64::from(end < columns.end);
            if let Some(seen) = seen {
                let face = self.active[seen].face;
                let inside = self.turns[face as usize] < 0;
                match self.spans.last_mut() {
                    Some(last) if (last.face, last.inside) == (face, inside) && last.end == start => last.end = end,
                    _ => self.spans.push(Span { start, end, face, inside }),
                }
            }
            start = end;
        }
    }

    /// Brings the active faces into their order at a pixel: the nearest first, and among those equally near by rank, then by number.
    fn order(&mut self, stage: &Stage, column: u32, row: u32) {
        let key = |a: &Active| (std::cmp::Reverse(a.near), a.rank, a.face);
        for i in 0..self.active.len() {
            let mut moving = self.active[i];
            moving.near = stage.depths[moving.plane as usize].at(column, row);
            let mut to = i;
            while to > 0 && key(&self.active[to - 1]) > key(&moving) {
                self.active[to] = self.active[to - 1];
                to -= 1;
            }
            self.active[to] = moving;
        }
    }

    /// Which of the active faces is seen, and how many there are up to the last that is as near: all, if none is.
    fn visible(&mut self, stage: &Stage) -> (Option<usize>, usize) {
        if self.savings.spans && self.is_as_before(stage) {
            return (self.seen, self.front.len());
        }
        self.cost.counts += 1;
        self.front.clear();
        let (mut i, mut seen) = (0, None);
        while i < self.active.len() && seen.is_none() {
            let group = self.group(i);
            self.count(stage, group.clone(), 1);
            if self.holds {
                seen = Some(self.candidate(stage, group.clone()));
            }
            i = group.end;
        }
        let front = i;
        self.count(stage, 0..front, -1);
        for k in 0..front {
            let entry = self.entry(stage, k);
            self.front.push(entry);
        }
        self.seen = seen;
        (seen, front)
    }

    /// The faces that are as near as the one at `start`, from there on.
    fn group(&self, start: usize) -> Range<usize> {
        let near = self.active[start].near;
        start..start + self.active[start..].iter().take_while(|active| active.near == near).count()
    }

    fn entry(&self, stage: &Stage, i: usize) -> (Node, i32, bool) {
        let Active { face, near, .. } = self.active[i];
        (stage.faces[face as usize].leaf, self.turns[face as usize], i > 0 && self.active[i - 1].near == near)
    }

    /// Whether what decided on the span before stands here too, and nothing else is as near as the face seen there.
    fn is_as_before(&self, stage: &Stage) -> bool {
        let Some(_) = self.seen else { return false };
        let front = self.front.len();
        front <= self.active.len()
            && (0..front).all(|i| self.entry(stage, i) == self.front[i])
            && (front == self.active.len() || self.active[front].near != self.active[front - 1].near)
    }

    /// Adds the turns of some active faces to the counters, times `sign`.
    fn count(&mut self, stage: &Stage, faces: Range<usize>, sign: i32) {
        for active in &self.active[faces] {
            let face = active.face as usize;
            self.counters.add(stage.faces[face].leaf, sign * self.turns[face]);
        }
        let holds = &mut self.holds;
        self.counters.settle(&stage.program, |_, now| *holds = now);
    }

    /// Which of a group is shown that has just made the model hold: the first whose part made a difference up to the root.
    fn candidate(&mut self, stage: &Stage, group: Range<usize>) -> usize {
        let leaf = |active: &Active| stage.faces[active.face as usize].leaf;
        let first = leaf(&self.active[group.start]);
        if self.active[group.clone()].iter().all(|active| leaf(active) == first) {
            return group.start;
        }
        let after = self.counters.truths().to_vec();
        self.count(stage, group.clone(), -1);
        let before = self.counters.truths().to_vec();
        self.count(stage, group.clone(), 1);
        let root = stage.program.output(0);
        let made = |active: &Active| self.parents.leads(leaf(active), root, |node| before[node as usize] != after[node as usize]);
        group.start + self.active[group].iter().position(made).unwrap_or(0)
    }

    /// The first column in the range, behind its first, at which the order that decided on what is seen may be another; its end if there is none.
    fn until(&mut self, stage: &Stage, columns: Range<u32>, front: usize, seen: bool) -> u32 {
        let mut end = columns.end;
        let mut bound = |first: &Active, second: &Active| {
            let [a, b] = [first, second].map(|active| &stage.depths[active.plane as usize]);
            end = end.min(parts(a, b, first.near - second.near, columns.start..end));
        };
        let pairs = if seen && self.savings.hidden { front } else { self.active.len() };
        self.active[..pairs].windows(2).for_each(|pair| bound(&pair[0], &pair[1]));
        if pairs < self.active.len() {
            let last = self.active[pairs - 1];
            self.active[pairs..].iter().for_each(|behind| bound(&last, behind));
        }
        end
    }
}

/// The first column of a range, behind its first, at which `ahead` is not before `behind` as it is at the first, where it is so much nearer (0: equally
/// near); the range's end if there is none.
#[inline]
fn parts(ahead: &Depth, behind: &Depth, by: i128, columns: Range<u32>) -> u32 {
    let slope = ahead.a - behind.a;
    if by == 0 {
        return if slope == 0 { columns.end } else { columns.start + 1 };
    }
    let last = i128::from(columns.end - columns.start - 1);
    if slope >= 0 || by + slope * last > 0 {
        return columns.end;
    }
    // The first n with by + slope n <= 0.
    let n = (by - slope - 1) / -slope;
    columns.start + n as u32
}

/// For every node of the program those that it feeds.
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
