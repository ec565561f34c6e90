//! Where pictures of two models from one view can differ, if most parts are the same in both.
//!
//! A scanline shows what its active edges and the depths of their faces say. So two pictures have the same scanline wherever all edges on it are those of parts that are
//! *alike*: their corners, lines and planes, cut as the view cuts them, and the depths of their planes are the same to the bit, in the same order. What is looked at are the
//! records and not what was moved: a part that stays is not alike if a moved one gave it its plane, or took it away.
//!
//! ```text
//!        ____                         the part that moves, and where it was: these lines
//!       |old |____      <--
//!       |____|new |     <--
//!   ____     |____|     <--
//!  |    |                             all others are alike: lines below are as they were
//!  |____|
//! ```
//!
//! To where they matter (`boxes`) parts are clipped in other places in the two, but that never shows. Where the view itself differs, or an order of parts by which one of several equal faces is
//! shown, all lines may.

use std::ops::Range;

use super::body::{Body, NOTHING, Plane};
use super::stage::Shown;
use super::view::{Depth, View};

/// So many lines around an outline belong to it: more than rounding takes, and enough for what is drawn around it.
const AROUND: f64 = 2.0;

/// The scanlines on which the pictures of two bodies can differ, ascending, none next to another. Both have the same parts but for their surfaces; `needed` are those that are drawn.
pub fn lines(old: &Body, new: &Body, views: [&View; 2], sections: &[Plane], needed: &[usize]) -> Vec<Range<u32>> {
    let all = std::iter::once(0..views[1].height).collect();
    if views[0] != views[1] || old.ranks.len() != new.ranks.len() {
        return all;
    }
    let [old, new] = [old, new].map(|body| Parts::new(Shown::new(body, views[0], sections)));
    let (alike, others): (Vec<usize>, Vec<usize>) = needed.iter().partition(|part| old.part(**part).eq(new.part(**part)));
    let mut ranks: Vec<(u32, u32)> = alike.iter().map(|part| (old.shown.body.ranks[*part], new.shown.body.ranks[*part])).collect();
    ranks.sort_unstable();
    if !ranks.is_sorted_by_key(|ranks| ranks.1) {
        return all;
    }
    let height = views[0].height;
    let mut ranges: Vec<Range<u32>> = others.iter().flat_map(|part| [&old, &new].map(|parts| parts.rows(*part, views[0]))).collect();
    ranges.retain(|range| range.start < range.end.min(height));
    ranges.sort_unstable_by_key(|range| range.start);
    let mut merged: Vec<Range<u32>> = Vec::new();
    for range in ranges {
        match merged.last_mut() {
            Some(last) if range.start <= last.end => last.end = last.end.max(range.end),
            _ => merged.push(range),
        }
    }
    merged
}

/// A body in a view, its edges and faces by part.
struct Parts<'b> {
    shown: Shown<'b>,
    /// Ends of the parts in `edges` and in `faces`.
    ends: [Vec<usize>; 2],
    edges: Vec<u32>,
    faces: Vec<u32>,
    /// For every face which one it is of its part.
    within: Vec<u32>,
}

/// What is compared of a part.
#[derive(PartialEq)]
enum Record {
    /// A face: bits of its plane, its depth.
    Face([u64; 4], Depth),
    /// An edge: bits of its ends and of its line, its faces.
    Edge([u64; 12], [u32; 2]),
}

impl<'b> Parts<'b> {
    fn new(shown: Shown<'b>) -> Parts<'b> {
        let Body { edges, faces, ranks, .. } = &*shown.body;
        let of_edge: Vec<u32> = edges.iter().map(|edge| faces[edge.left as usize].part).collect();
        let of_face: Vec<u32> = faces.iter().map(|face| face.part).collect();
        let mut count = vec![0; ranks.len()];
        let next = |part: &u32| {
            count[*part as usize] += 1;
            count[*part as usize] - 1
        };
        let within = of_face.iter().map(next).collect();
        let [(edges, edge_ends), (faces, face_ends)] = [of_edge, of_face].map(|of| by_part(&of, ranks.len()));
        Parts { shown, ends: [edge_ends, face_ends], edges, faces, within }
    }

    fn items<'p>(&self, items: &'p [u32], ends: &[usize], part: usize) -> &'p [u32] {
        &items[ends[part]..ends[part + 1]]
    }

    /// All that is known of a part, in its order.
    fn part(&self, part: usize) -> impl Iterator<Item = Record> {
        let Shown { body, depths, .. } = &self.shown;
        let faces = self.items(&self.faces, &self.ends[1], part).iter().map(|face| {
            let plane = body.faces[*face as usize].plane as usize;
            let Plane { normal, offset } = body.planes[plane];
            Record::Face([normal.x, normal.y, normal.z, offset].map(f64::to_bits), depths[plane])
        });
        let edges = self.items(&self.edges, &self.ends[0], part).iter().map(|edge| {
            let edge = &body.edges[*edge as usize];
            let line = &body.lines[edge.line as usize];
            let all = [body.points[edge.from as usize], body.points[edge.to as usize], line.at, line.along];
            let mut bits = [0; 12];
            bits.iter_mut().zip(all.iter().flat_map(|v| v.to_array())).for_each(|(bits, x)| *bits = x.to_bits());
            let face = |face: u32| if face == NOTHING { NOTHING } else { self.within[face as usize] };
            Record::Edge(bits, [face(edge.left), face(edge.right)])
        });
        faces.chain(edges)
    }

    /// The scanlines that its outline touches, or none.
    fn rows(&self, part: usize, view: &View) -> Range<u32> {
        let body = &self.shown.body;
        let edges = self.items(&self.edges, &self.ends[0], part).iter().map(|edge| &body.edges[*edge as usize]);
        let heights = edges.flat_map(|edge| [edge.from, edge.to]).map(|p| view.screen(body.points[p as usize])[1]);
        let (least, most) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), y| (least.min(y), most.max(y)));
        let line = |y: f64| y.clamp(0.0, view.height.into()) as u32;
        line((least - AROUND).floor())..line((most + AROUND).ceil())
    }
}

/// Indices by the part of each, those of one part in order, and where each part begins.
fn by_part(of: &[u32], parts: usize) -> (Vec<u32>, Vec<usize>) {
    let mut ends = vec![0; parts + 1];
    of.iter().for_each(|part| ends[*part as usize + 1] += 1);
    for i in 0..parts {
        ends[i + 1] += ends[i];
    }
    let (mut next, mut items) = (ends.clone(), vec![0; of.len()]);
    for (part, i) in of.iter().zip(0..) {
        items[next[*part as usize]] = i;
        next[*part as usize] += 1;
    }
    (items, ends)
}
