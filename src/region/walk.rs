//! The walk along the active list that counts shapes in and out, and finds where the visible ink changes.
//!
//! Edges in one column, a group, are counted together, then the topmost layer that holds is looked up; where its ink changes, a run ends or begins
//! ("CSG" in ARCHITECTURE.md, section 2.2.3, step 3, and 3.2 for layers: the paper's list of active polygons by priority is a bit set of layers here).
//!
//! ```text
//!   columns    2     5     5     9            the walk of  a - b
//!   edges      a+    a-    b+    b-
//!   ink     .  |  #  |     .     |  .         boundaries: edge 0 -> ink 0, edge 1 -> paper
//! ```
//!
//! Where something changes on every scanline, most of the list is as it was all the same. The new list is compared with the one that was counted last; a
//! stretch that is equal has the boundaries that it had, as long as it begins with the same windings:
//!
//! ```text
//!   last     a1  b1  c1  c2  b2  d1  d2  a2
//!   now      a1  b1  b2  e1  e2  d1  d2  a2            c ended, e entered
//!           |same   |counted       |same   |
//! ```
//!
//! Counting begins at the first group that differs, and ends where the windings passed in one list and in the other are the same again, shape by shape. That is the
//! paper's skipped counting (2.2.3), for parts of a scanline. Behind a stretch that is skipped the windings are those that were put down when it was counted
//! (`state`).

use crate::edge::Side;
use crate::sweep::{Entry, Sweep};

use super::Picture;
use super::state::State;

/// A place where the visible ink changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Boundary {
    /// Index into the active list of the first of the edges in its column.
    pub(super) edge: u32,
    /// The ink from there on, or [`super::PAPER`].
    pub(super) ink: u32,
}

/// What is known of the line that was counted last.
#[derive(Clone, Debug)]
pub(super) struct Walk {
    state: State,
    list: Vec<Entry>,
    /// The ink at the left side of every scanline.
    left: u32,
    boundaries: Vec<Boundary>,
    /// The boundaries before the last count.
    before: Vec<Boundary>,
    difference: Difference,
}

impl Walk {
    pub(super) fn new(picture: &Picture) -> Walk {
        let difference = Difference(vec![0; picture.program.leaves()]);
        let left = picture.start.ink(&picture.inks);
        Walk { state: picture.start.clone(), list: Vec::new(), left, boundaries: Vec::new(), before: Vec::new(), difference }
    }

    /// The ink at the left side, and where it changes on the line that was counted last.
    pub(super) fn boundaries(&self) -> (u32, &[Boundary]) {
        (self.left, &self.boundaries)
    }

    /// About what a crossing costs where the whole list is counted, in the units of [`super::STEP`].
    pub(super) fn crossing(&self) -> usize {
        if let State::Table(_) = self.state { 3 } else { 8 }
    }

    /// Counts the whole list, so that if it is to be `known` [`Walk::changes`] can go on from it. Gives the number of crossings counted.
    pub(super) fn whole(&mut self, picture: &Picture, sweep: &Sweep<Side>, known: bool) -> usize {
        let new = sweep.list();
        self.boundaries.clear();
        self.state.resize(sweep.tags().len());
        let mut line = Line::new(picture, sweep.tags(), new, &mut self.state, &mut self.boundaries);
        let mut i = 0;
        while i < new.len() {
            i = line.group(i, known);
        }
        self.finish(picture, sweep);
        sweep.list().len()
    }

    /// Counts what differs from the line that was counted last, which is known. Gives the number of crossings counted.
    pub(super) fn changes(&mut self, picture: &Picture, sweep: &Sweep<Side>) -> usize {
        let (new, old, sides) = (sweep.list(), &self.list, sweep.tags());
        let tied = |list: &[Entry], i: usize| list.get(i).is_some_and(|entry| entry.is_tied());
        std::mem::swap(&mut self.boundaries, &mut self.before);
        self.boundaries.clear();
        self.state.resize(sides.len());
        let mut line = Line::new(picture, sides, new, &mut self.state, &mut self.boundaries);
        let difference = &mut self.difference;
        let mut counted = 0;
        let mut kept = 0;
        let (mut i, mut j) = (0, 0);
        loop {
            // What is equal, up to the group that what differs belongs to.
            let mut same = equal(&new[i..], &old[j..]);
            if same > 0 && (tied(new, i + same) || tied(old, j + same)) {
                same -= 1;
                while new[i + same].is_tied() {
                    same -= 1;
                }
            }
            kept += self.before[kept..].iter().take_while(|boundary| (boundary.edge as usize) < j).count();
            let known = in_front(&self.before[kept..], (j + same) as u32);
            line.keep(&self.before[kept..kept + known], i as u32, j as u32);
            kept += known;
            line.skip(i..i + same);
            (i, j) = (i + same, j + same);
            if i == new.len() && j == old.len() {
                break;
            }
            // What differs, until the windings are the same again.
            let start = i;
            let mut unequal = 0;
            while i < new.len() && (unequal != 0 || i == start || !old.get(j).is_some_and(|entry| entry.is_same(new[i]))) {
                let end = line.group(i, true);
                for entry in &new[i..end] {
                    unequal += difference.pass(sides[entry.slot()], 1);
                    // What stands in its place in the other list, and what stood before that and has ended.
                    let mut places = usize::from(!entry.has_entered());
                    while let Some(entry) = old.get(j).filter(|entry| places > 0 || sweep.has_ended(entry.slot())) {
                        unequal += difference.pass(sides[entry.slot()], -1);
                        places -= usize::from(places > 0 && !sweep.has_ended(entry.slot()));
                        j += 1;
                    }
                }
                i = end;
            }
            counted += i - start;
            if i == new.len() {
                if unequal != 0 || j < old.len() {
                    difference.clear(sides, new, old);
                }
                break;
            }
        }
        self.finish(picture, sweep);
        counted
    }

    /// Takes the counters back to the left side, and keeps the list.
    fn finish(&mut self, picture: &Picture, sweep: &Sweep<Side>) {
        if picture.outlines.open {
            self.state.rewind(sweep.tags(), sweep.list());
        }
        self.state.settle(&picture.program);
        self.list.clear();
        self.list.extend_from_slice(sweep.list());
    }
}

/// A line that is being counted.
struct Line<'a> {
    picture: &'a Picture,
    sides: &'a [Side],
    list: &'a [Entry],
    state: &'a mut State,
    boundaries: &'a mut Vec<Boundary>,
    /// What is visible here.
    ink: u32,
}

impl<'a> Line<'a> {
    /// A line at its left side, where the state is at rest.
    fn new(
        picture: &'a Picture,
        sides: &'a [Side],
        list: &'a [Entry],
        state: &'a mut State,
        boundaries: &'a mut Vec<Boundary>,
    ) -> Line<'a> {
        let ink = state.ink(&picture.inks);
        Line { picture, sides, list, state, boundaries, ink }
    }

    fn boundary(&mut self, edge: usize, ink: u32) {
        self.ink = ink;
        self.boundaries.push(Boundary { edge: edge as u32, ink });
    }

    /// Takes over boundaries of a stretch that stands at `i` in the list, and stood at `j`.
    fn keep(&mut self, boundaries: &[Boundary], i: u32, j: u32) {
        let moved = |boundary: &Boundary| Boundary { edge: boundary.edge.wrapping_add(i.wrapping_sub(j)), ..*boundary };
        self.boundaries.extend(boundaries.iter().map(moved));
        self.ink = boundaries.last().map_or(self.ink, |last| last.ink);
    }

    /// Goes to the end of a stretch whose boundaries are known.
    fn skip(&mut self, edges: std::ops::Range<usize>) {
        self.state.skip(self.picture, self.sides, &self.list[edges]);
        debug_assert_eq!(self.ink, self.state.ink(&self.picture.inks), "the boundaries that were known are right");
    }

    /// Counts the group that begins at an index, and gives the index behind it.
    #[inline(always)]
    fn group(&mut self, edge: usize, known: bool) -> usize {
        let (next, ink) = self.state.group(self.picture, self.sides, self.list, edge, known);
        if ink != self.ink {
            self.boundary(edge, ink);
        }
        next
    }
}

/// How many boundaries stand in front of an edge: few of many, as a rule, so they are passed in blocks.
#[inline]
fn in_front(boundaries: &[Boundary], edge: u32) -> usize {
    const BLOCK: usize = 8;
    let start = BLOCK * boundaries.as_chunks::<BLOCK>().0.iter().take_while(|block| block[BLOCK - 1].edge < edge).count();
    start + boundaries[start..].iter().take_while(|boundary| boundary.edge < edge).count()
}

/// How long two lists are equal.
#[inline]
fn equal(a: &[Entry], b: &[Entry]) -> usize {
    const BLOCK: usize = 16;
    let (a_blocks, b_blocks) = (a.as_chunks::<BLOCK>().0, b.as_chunks::<BLOCK>().0);
    for (block, (a, b)) in a_blocks.iter().zip(b_blocks).enumerate() {
        let differ = (0..BLOCK).fold(0, |bits, i| bits | u32::from(!a[i].is_same(b[i])) << i);
        if differ != 0 {
            return block * BLOCK + differ.trailing_zeros() as usize;
        }
    }
    let start = a_blocks.len().min(b_blocks.len()) * BLOCK;
    start + a[start..].iter().zip(&b[start..]).take_while(|(a, b)| a.is_same(**b)).count()
}

/// By leaf: windings passed in one list less those passed in the other.
#[derive(Clone, Debug)]
struct Difference(Vec<i32>);

impl Difference {
    /// Passes an edge. Gives by how many more leaves the windings differ.
    #[inline]
    fn pass(&mut self, side: Side, sign: i32) -> isize {
        let winding = &mut self.0[side.leaf as usize];
        let differed = *winding != 0;
        *winding += sign * side.winding;
        isize::from(*winding != 0) - isize::from(differed)
    }

    /// All 0 again, after lists that do not come back to 0 at their ends.
    fn clear(&mut self, sides: &[Side], new: &[Entry], old: &[Entry]) {
        new.iter().chain(old).for_each(|entry| self.0[sides[entry.slot()].leaf as usize] = 0);
    }
}
