//! A body cut by a plane: what lies behind it is taken away, and where a part was cut open a face closes it.
//!
//! ```text
//!        +-------+                +---+
//!        |       |   behind       |   |
//!        |   +---|---|-----  -->  |   |  the cap, in the plane of the cut
//!        |       |                |   |
//!        +-------+                +---+
//! ```
//!
//! Counting along depth starts outside of all parts, so a part that the near plane cuts must be closed there ("CSG" in ARCHITECTURE.md, section 3.4.1); sections are
//! the same with another plane.
//!
//! In each face the boundary leaves through the plane as often as it comes back. All edges that close it there lie on one line, that of the face's plane and the
//! cut's, so it does not matter which end is joined with which: where such edges run back over each other they have the same columns, and cancel.

use std::borrow::Cow;
use std::collections::HashMap;

use foldhash::fast::FixedState;

use super::body::{Body, Edge, Face, Line, NOTHING, Plane, SAME};

/// Cuts `body` by a plane: keeps what is at or before it in the direction of its normal. Where nothing is behind the plane nothing is copied.
pub fn cut(body: &mut Cow<'_, Body>, plane: Plane) {
    let height: Vec<f64> = body.points.iter().map(|p| plane.normal.dot(*p) - plane.offset).collect();
    if height.iter().all(|height| *height >= 0.0) {
        return;
    }
    let inside = |p: u32| height[p as usize] >= 0.0;
    let Body { points, lines, planes, edges, faces, bounds, .. } = body.to_mut();
    // A face that lies in the plane of the cut and its cap are equally near.
    let (least, most) = bounds.unwrap_or_default();
    let same = |known: &Plane| {
        let turned = known.normal.dot(plane.normal).signum();
        (known.normal - plane.normal * turned).length() <= SAME
            && (known.offset - plane.offset * turned).abs() <= SAME * (most - least).length()
    };
    let record = planes.iter().position(same).unwrap_or_else(|| {
        planes.push(plane);
        planes.len() - 1
    }) as u32;

    // Points where a line goes through the plane: one for each line.
    let mut through: HashMap<u32, u32, FixedState> = HashMap::default();
    // Where the boundary of a face leaves, and where it comes back.
    let mut open: HashMap<u32, [Vec<u32>; 2], FixedState> = HashMap::default();
    edges.retain_mut(|edge| {
        let [from, to] = [edge.from, edge.to].map(inside);
        if from == to {
            return from;
        }
        let crossing = *through.entry(edge.line).or_insert_with(|| {
            let Line { at, along } = lines[edge.line as usize];
            let [a, b] = [edge.from, edge.to].map(|p| points[p as usize]);
            let slope = plane.normal.dot(along);
            let crossing = at + along * ((plane.offset - plane.normal.dot(at)) / slope);
            // A line that is almost in the plane meets it where its edge does.
            let near = crossing.is_finite() && (crossing - a).dot(b - a) >= 0.0 && (crossing - b).dot(a - b) >= 0.0;
            let [ha, hb] = [edge.from, edge.to].map(|p| height[p as usize]);
            points.push(if near { crossing } else { a + (b - a) * (ha / (ha - hb)) });
            points.len() as u32 - 1
        });
        // `left` has the edge from its beginning to its end, `right` the other way.
        for (face, leaves) in [(edge.left, from), (edge.right, !from)] {
            if face != NOTHING {
                open.entry(face).or_default()[usize::from(!leaves)].push(crossing);
            }
        }
        if from {
            edge.to = crossing;
        } else {
            edge.from = crossing;
        }
        true
    });

    let mut open: Vec<_> = open.into_iter().collect();
    open.sort_unstable_by_key(|face| face.0);
    let mut line_of: HashMap<u32, u32, FixedState> = HashMap::default();
    let mut cap_of: HashMap<u32, u32, FixedState> = HashMap::default();
    for (face, [leaves, returns]) in open {
        let Face { plane: own, part, origin } = faces[face as usize];
        let cap = *cap_of.entry(part).or_insert_with(|| {
            faces.push(Face { plane: record, part, origin });
            faces.len() as u32 - 1
        });
        // Of a part that was worked out from others it shows the first that is cut there.
        let shown = &mut faces[cap as usize].origin;
        *shown = origin.min(*shown);
        for (from, to) in leaves.into_iter().zip(returns).filter(|(from, to)| from != to) {
            let line = *line_of.entry(own).or_insert_with(|| {
                let along = planes[own as usize].normal.cross(plane.normal);
                let apart = points[to as usize] - points[from as usize];
                let along = along.try_normalize().or_else(|| apart.try_normalize()).unwrap_or(glam::DVec3::X);
                lines.push(Line { at: points[from as usize], along });
                lines.len() as u32 - 1
            });
            edges.push(Edge { from, to, line, left: face, right: cap });
        }
    }
}
