//! The faces that a pixel's ray goes through, in the order of their depth ("CSG" in ARCHITECTURE.md, section 4.2.1).
//!
//! Passing an edge changes how often the outlines of its two faces have been passed; a face whose outline winds around the pixel is active. That is noted at each edge,
//! and what is active is listed and put in order only where it is asked for.

use super::stage::{Crossing, Face, Stage};

/// An active face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Active {
    /// Index into the faces of the stage.
    pub(super) face: u32,
    pub(super) plane: u32,
    rank: u32,
    /// Nearness where it was looked at last.
    pub(super) near: i128,
}

impl Active {
    /// What comes first stands first: the nearest, and of those equally near that of the least rank, then of the least number.
    #[inline]
    fn key(&self) -> (std::cmp::Reverse<i128>, u32, u32) {
        (std::cmp::Reverse(self.near), self.rank, self.face)
    }
}

/// The active faces of a walk along scanlines.
#[derive(Debug)]
pub(super) struct Faces {
    /// How often the outline of each face has been passed.
    turns: Vec<i32>,
    /// Whether a face is in the list.
    listed: Vec<bool>,
    /// Faces whose turns changed since the list was made.
    touched: Vec<u32>,
    list: Vec<Active>,
}

impl Faces {
    pub(super) fn new(faces: usize) -> Faces {
        Faces { turns: vec![0; faces], listed: vec![false; faces], touched: Vec::new(), list: Vec::new() }
    }

    /// How often the outline of a face has been passed: above 0 where it is seen from outside of its part.
    #[inline]
    pub(super) fn turns(&self, face: u32) -> i32 {
        self.turns[face as usize]
    }

    /// Passes an edge.
    #[inline]
    pub(super) fn pass(&mut self, edge: Crossing) {
        self.turn(edge.left, edge.turns);
        self.turn(edge.right, -edge.turns);
    }

    #[inline]
    fn turn(&mut self, face: u32, turns: i32) {
        if let Some(all) = self.turns.get_mut(face as usize) {
            *all += turns;
            self.touched.push(face);
        }
    }

    /// Faces whose turns changed since they were listed, but for so many that were told before.
    #[inline]
    pub(super) fn news(&self, told: usize) -> &[u32] {
        &self.touched[told..]
    }

    /// Whether a face was active when they were listed last.
    #[inline]
    pub(super) fn is_listed(&self, face: u32) -> bool {
        self.listed[face as usize]
    }

    /// The active faces, in the order in which they were put last, those that came since behind them.
    pub(super) fn listed(&mut self, stage: &Stage) -> &[Active] {
        let mut gone = false;
        for face in self.touched.drain(..) {
            let (is, was) = (self.turns[face as usize] != 0, &mut self.listed[face as usize]);
            if is && !*was {
                let Face { plane, rank, .. } = stage.faces[face as usize];
                self.list.push(Active { face, plane, rank, near: 0 });
            }
            gone |= !is && *was;
            *was |= is;
        }
        if gone {
            let (turns, listed) = (&self.turns, &mut self.listed);
            self.list.retain(|active| {
                let stays = turns[active.face as usize] != 0;
                listed[active.face as usize] = stays;
                stays
            });
        }
        &self.list
    }

    /// The active faces as they were listed last.
    #[inline]
    pub(super) fn list(&self) -> &[Active] {
        &self.list
    }

    /// Puts those that are listed in their order at a pixel: by insertion where little is out of place, else by sorting.
    pub(super) fn order(&mut self, stage: &Stage, column: u32, row: u32) {
        let list = &mut self.list[..];
        let mut budget = 8 * list.len() + 64;
        for i in 0..list.len() {
            let mut moving = list[i];
            moving.near = stage.depths[moving.plane as usize].at(column, row);
            let mut to = i;
            while to > 0 && list[to - 1].key() > moving.key() {
                list[to] = list[to - 1];
                to -= 1;
            }
            list[to] = moving;
            match budget.checked_sub(i - to) {
                Some(left) => budget = left,
                None => {
                    list[i + 1..].iter_mut().for_each(|active| active.near = stage.depths[active.plane as usize].at(column, row));
                    list.sort_unstable_by_key(Active::key);
                    return;
                }
            }
        }
    }

    /// Forgets all, at the end of a scanline.
    pub(super) fn clear(&mut self) {
        for face in self.touched.drain(..) {
            self.turns[face as usize] = 0;
        }
        for active in self.list.drain(..) {
            (self.turns[active.face as usize], self.listed[active.face as usize]) = (0, false);
        }
    }
}
