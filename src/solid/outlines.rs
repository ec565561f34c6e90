//! Feature edges: lines where neighbouring pixels show what does not go on from one to the other.
//!
//! A pixel is compared with the one at its left and the one above it. There is an *outline* between two pixels if one of them shows nothing, if they show different parts, if the planes of their
//! faces, turned to the eye, meet at more than an angle, or if depth jumps:
//!
//! ```text
//!      near |  p      q          p(to) - p(from) is what one plane says of the step to the other pixel, q(to) - q(from) the other plane.
//!           |   \    /           Along a surface that bends one way between them the step q(to) - p(from) is none outside of those two. It is a jump if it
//!           +---from--to--       is outside by more than both their sizes together: what bends twice within a pixel is none.
//! ```
//!
//! The pixel below or right of an outline is dark, and so are those that follow it away from the outline, as many as the line is wide. Nearness is an integer, so there is nothing
//! to be rounded, and the page's sides are no outlines.

use std::collections::VecDeque;
use std::ops::Range;

use super::beside::beside;
use super::spans::Span;
use super::stage::{Face, Stage};

/// The ink of outlines.
pub const INK: u32 = 0;

/// The dark pixels of scanlines that follow each other.
#[derive(Debug)]
pub struct Outlines {
    /// Of the angle: planes whose cosine is less meet at more.
    cosine: f64,
    wide: u32,
    /// What the scanline above shows, if there is one.
    above: Option<Vec<Span>>,
    /// The outlines above the last `wide` scanlines, the lowest last.
    levels: VecDeque<Vec<Range<u32>>>,
    dark: Vec<Range<u32>>,
}

impl Outlines {
    /// Outlines at edges of more than `angle` degrees, so many pixels wide.
    pub fn new(angle: f64, wide: u32) -> Outlines {
        Outlines { cosine: angle.to_radians().cos(), wide, above: None, levels: VecDeque::new(), dark: Vec::new() }
    }

    /// The dark pixels of a scanline, in order and apart from each other. They are known once as many scanlines above it were given as the line is wide, or all that there are.
    pub fn next(&mut self, stage: &Stage, row: u32, spans: &[Span]) -> &[Range<u32>] {
        let mut level = if self.levels.len() == self.wide as usize { self.levels.pop_front().unwrap_or_default() } else { Vec::new() };
        level.clear();
        if let Some(above) = &self.above {
            beside(above, spans, |columns, above, here| {
                self.between(stage, row, columns, above.map(|span| span.face), here.map(|span| span.face), &mut level);
            });
        }
        self.levels.push_back(level);

        self.dark.clear();
        let width = stage.view.width;
        let mut before: Option<&Span> = None;
        let side = |x: u32, left: Option<&Span>, here: Option<&Span>, dark: &mut Vec<Range<u32>>| {
            let step = |face: u32| (face, [x - 1, x].map(|x| near(stage, face, x, row)));
            if differs(stage, self.cosine, left.map(|span| span.face), here.map(|span| span.face), |faces| jumps(faces.map(step))) {
                dark.push(x..x.saturating_add(self.wide).min(width));
            }
        };
        for span in spans {
            let left = before.filter(|before| before.end == span.start);
            if let Some(before) = before.filter(|_| left.is_none()) {
                side(before.end, Some(before), None, &mut self.dark);
            }
            if span.start > 0 {
                side(span.start, left, Some(span), &mut self.dark);
            }
            before = Some(span);
        }
        if let Some(before) = before.filter(|before| before.end < width) {
            side(before.end, Some(before), None, &mut self.dark);
        }
        self.dark.extend(self.levels.iter().flatten().cloned());
        self.dark.sort_unstable_by_key(|range| range.start);
        self.dark.dedup_by(|next, last| {
            let meets = next.start <= last.end;
            if meets {
                last.end = last.end.max(next.end);
            }
            meets
        });

        let above = self.above.get_or_insert_default();
        above.clear();
        above.extend_from_slice(spans);
        &self.dark
    }

    /// Notes the columns at which there is an outline between two scanlines, where each of them shows one thing.
    fn between(&self, stage: &Stage, row: u32, columns: Range<u32>, above: Option<u32>, here: Option<u32>, level: &mut Vec<Range<u32>>) {
        let mut apart = true;
        let jump = |faces: [u32; 2]| {
            apart = false;
            for x in columns.clone() {
                if jumps(faces.map(|face| (face, [row - 1, row].map(|y| near(stage, face, x, y))))) {
                    level.push(x..x + 1);
                }
            }
            false
        };
        if differs(stage, self.cosine, above, here, jump) && apart {
            level.push(columns);
        }
    }
}

fn near(stage: &Stage, face: u32, column: u32, row: u32) -> i128 {
    stage.depths[stage.faces[face as usize].plane as usize].at(column, row)
}

/// Whether there is an outline between pixels that show these faces; `jump` is asked where that is a matter of depth.
fn differs(stage: &Stage, cosine: f64, one: Option<u32>, other: Option<u32>, jump: impl FnOnce([u32; 2]) -> bool) -> bool {
    let (one, other) = match (one, other) {
        (None, None) => return false,
        (Some(one), Some(other)) => (one, other),
        _ => return true,
    };
    let [Face { plane: p, origin, .. }, Face { plane: q, origin: also, .. }] = [one, other].map(|face| stage.faces[face as usize]);
    if origin.part != also.part {
        return true;
    }
    if p == q {
        return false;
    }
    let toward =
        |plane: u32| if stage.is_toward(plane) { stage.planes[plane as usize].normal } else { -stage.planes[plane as usize].normal };
    toward(p).dot(toward(q)) < cosine || jump([one, other])
}

/// Whether depth jumps between two pixels, the first of which shows the first face; of both faces how near they are at both pixels.
fn jumps([(_, p), (_, q)]: [(u32, [i128; 2]); 2]) -> bool {
    let (one, other, step) = (p[1] - p[0], q[1] - q[0], q[1] - p[0]);
    let room = one.abs() + other.abs();
    step < one.min(other) - room || step > one.max(other) + room
}
