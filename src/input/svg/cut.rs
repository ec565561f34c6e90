//! Clip paths and masks as areas that groups are cut to.
//!
//! A clip path is the union of what it holds, and of its own clip path; the latter cuts it. A mask that is black and white is painted as
//! everything is, last on top: white adds and black takes away, within the mask's rectangle and its own mask. What is cut by several of them
//! is cut by the area where all hold; one such area serves all groups that are cut alike.
//!
//! `usvg` shares a clip path among the groups that refer to it, in the coordinates of the group. So an area belongs to a clip path
//! together with a transform.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use usvg::{ClipPath, Group, Mask, MaskType};

use super::parts::{Sink, closed};
use crate::run::Rgb;
use crate::scene::{Area, Formula};

/// What cuts a group.
#[derive(Clone, Copy)]
pub(super) enum Cutter<'t> {
    Clip(&'t ClipPath),
    Mask(&'t Mask),
}

/// A clip path or mask, by its address, in certain coordinates, given by their bits.
pub(super) type Key = (usize, [u64; 6]);

impl<'t> Cutter<'t> {
    pub(super) fn key(self, transform: [f64; 6]) -> Key {
        let address = match self {
            Cutter::Clip(clip) => std::ptr::from_ref(clip).addr(),
            Cutter::Mask(mask) => std::ptr::from_ref(mask).addr(),
        };
        (address, transform.map(f64::to_bits))
    }

    /// What cuts it in turn.
    fn own(self) -> Option<Cutter<'t>> {
        match self {
            Cutter::Clip(clip) => clip.clip_path().map(Cutter::Clip),
            Cutter::Mask(mask) => mask.mask().map(Cutter::Mask),
        }
    }

    /// What cuts a group.
    fn of(group: &'t Group) -> impl Iterator<Item = Cutter<'t>> {
        group.clip_path().map(Cutter::Clip).into_iter().chain(group.mask().map(Cutter::Mask))
    }
}

/// The areas of the clip paths and masks walked so far.
#[derive(Default)]
pub(super) struct Cuts {
    areas: HashMap<Key, Area>,
    /// Areas in pairs, and where both hold.
    both: HashMap<[Area; 2], Area>,
}

impl Cuts {
    /// A clip path or mask whose area is wanted first, before that of a group under its full transform.
    pub(super) fn missing<'t>(&self, group: &'t Group, transform: [f64; 6]) -> Option<Cutter<'t>> {
        let missing = |cutter: &Cutter<'_>| !self.areas.contains_key(&cutter.key(transform));
        let first = Cutter::of(group).find(missing)?;
        std::iter::successors(Some(first), |cutter| cutter.own().filter(missing)).last()
    }

    /// The area that a group under its full transform is cut to, with those around it.
    pub(super) fn of(&mut self, group: &Group, transform: [f64; 6], outer: Option<Area>, formula: &mut Formula) -> Option<Area> {
        Cutter::of(group).fold(outer, |outer, cutter| {
            let own = self.areas[&cutter.key(transform)];
            let Some(outer) = outer.filter(|&outer| outer != own) else { return Some(own) };
            Some(*self.both.entry([outer, own]).or_insert_with(|| formula.all(&[outer, own])))
        })
    }

    /// Takes in what a clip path or mask has painted; a mask also its rectangle.
    pub(super) fn add(&mut self, cutter: Cutter<'_>, key: Key, sink: Sink, frame: Option<Area>, formula: &mut Formula) {
        let own = match cutter {
            Cutter::Clip(_) => closed(&sink.parts, formula),
            Cutter::Mask(mask) => light(sink, mask.kind(), formula),
        };
        let outer = cutter.own().map(|outer| self.areas[&outer.key(key.1.map(f64::from_bits))]);
        let all: Vec<Area> = [Some(own), frame, outer].into_iter().flatten().collect();
        let area = if let [one] = all[..] { one } else { formula.all(&all) };
        if let Entry::Vacant(entry) = self.areas.entry(key) {
            entry.insert(area);
        }
    }
}

/// Where light passes.
fn light(sink: Sink, kind: MaskType, formula: &mut Formula) -> Area {
    let mut passes = Vec::new();
    for (ink, parts) in sink.layers {
        let area = closed(&parts, formula);
        if kind == MaskType::Alpha || 2.0 * luminance(ink) >= 1.0 {
            passes.push(area);
        } else if !passes.is_empty() {
            let before = if let [one] = passes[..] { one } else { formula.any(&passes) };
            passes = vec![formula.without(before, &[area])];
        }
    }
    formula.any(&passes)
}

/// How light an ink is, from 0 to 1, as masks have it.
fn luminance([r, g, b]: Rgb) -> f64 {
    (0.2125 * f64::from(r) + 0.7154 * f64::from(g) + 0.0721 * f64::from(b)) / 255.0
}
