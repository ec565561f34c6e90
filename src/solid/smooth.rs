//! Smooth shading of a stage: how bright a face is at a pixel, from normals that are interpolated over its triangles.
//!
//! With a point of the screen as (x, y, 1) and corners as homogeneous points h of it, the pixel's ray meets a triangle's plane in the sum of `E h` over its corners, where E
//! is linear over the screen and not below 0 inside: for the corner opposite to an edge, that edge's line. The same sum of the corners' normals has the direction of
//! the normal there, in perspective too: what would have to be divided by is above 0, and the length does not matter. So a triangle's normal along a scanline is
//! a vector and a step ("Niizeki" in ARCHITECTURE.md, for homogeneous points; corners may be behind the eye).
//!
//! What a pixel gets depends on nothing but the face and the pixel. A ray that rounding takes between two triangles gets the one at its left.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use foldhash::fast::FixedState;
use glam::DVec3;

use super::body::Body;
use super::corners::Corners;
use super::view::{Projection, View};

/// Smooth faces of a stage.
#[derive(Clone, Debug)]
pub struct Smooth {
    corners: Arc<Corners>,
    /// The body's points on the screen, from its centre: homogeneous, in pixels.
    points: Vec<DVec3>,
    view: View,
    /// Where light comes from.
    light: DVec3,
}

impl Smooth {
    /// Of a body whose faces are joined where their normals are less than `angle` degrees apart, in light from a direction in the model's coordinates.
    pub fn new(body: &Body, angle: f64, view: View, light: DVec3) -> Smooth {
        let place = |p: &DVec3| {
            let c = view.camera(*p);
            match view.projection {
                Projection::Perspective { focal, .. } => DVec3::new(c.x, c.y, c.z / focal),
                Projection::Orthographic { scale } => DVec3::new(c.x * scale, c.y * scale, 1.0),
            }
        };
        Smooth { corners: Arc::new(Corners::new(body, angle)), points: body.points.iter().map(place).collect(), view, light }
    }

    /// Whether a face has one normal.
    #[inline]
    pub fn is_flat(&self, face: u32) -> bool {
        self.corners.of(face).is_empty()
    }

    /// About how many bytes it holds.
    pub fn weight(&self) -> usize {
        self.corners.weight() + size_of_val(&self.points[..])
    }

    /// Appends what a face has on a scanline, from left to right.
    fn pieces(&self, face: u32, row: u32, pieces: &mut Vec<Piece>) {
        let first = pieces.len();
        let [x, y] = self.view.sample(0, row);
        // By how much each is met, and the piece.
        let mut best: Option<(f64, Piece)> = None;
        for triangle in self.corners.of(face) {
            let [a, b, c] = triangle.points.map(|p| self.points[p as usize]);
            let turned = a.dot(b.cross(c)).signum();
            let mut piece = Piece { from: f64::NEG_INFINITY, at: DVec3::ZERO, step: DVec3::ZERO };
            let mut to = f64::INFINITY;
            for (edge, normal) in [b.cross(c), c.cross(a), a.cross(b)].into_iter().zip(triangle.normals) {
                let (step, at) = (turned * edge.x, turned * (edge.x * x + edge.y * y + edge.z));
                let side = -at / step;
                if step > 0.0 {
                    piece.from = piece.from.max(side);
                } else if step < 0.0 {
                    to = to.min(side);
                } else if at < 0.0 {
                    to = f64::NEG_INFINITY;
                }
                let normal = self.corners.normal(normal);
                piece.at += at * normal;
                piece.step += step * normal;
            }
            let wide = to - piece.from;
            if wide >= 0.0 {
                pieces.push(piece);
            } else if best.is_none_or(|best| wide > best.0) {
                best = Some((wide, piece));
            }
        }
        if pieces.len() == first {
            pieces.extend(best.map(|best| best.1));
        }
        pieces[first..].sort_by(|a, b| a.from.total_cmp(&b.from));
    }
}

/// A triangle on a scanline: from a column on, the direction of its normal.
#[derive(Clone, Copy, Debug)]
struct Piece {
    from: f64,
    at: DVec3,
    step: DVec3,
}

/// The smooth faces of one scanline.
#[derive(Debug)]
pub struct Shading {
    smooth: Arc<Smooth>,
    row: u32,
    pieces: Vec<Piece>,
    of_face: HashMap<u32, Range<usize>, FixedState>,
}

impl Shading {
    /// Begins without a scanline.
    pub fn new(smooth: Arc<Smooth>) -> Shading {
        Shading { smooth, row: u32::MAX, pieces: Vec::new(), of_face: HashMap::default() }
    }

    /// Whether a face has one normal.
    #[inline]
    pub fn is_flat(&self, face: u32) -> bool {
        self.smooth.is_flat(face)
    }

    /// The cosine of the angle at which light meets a face, whose outside or inside is seen, at every pixel of some columns; none where the normal has no direction.
    pub fn along(&mut self, face: u32, inside: bool, row: u32, columns: Range<u32>, mut take: impl FnMut(u32, Option<f64>)) {
        if row != self.row {
            self.row = row;
            self.pieces.clear();
            self.of_face.clear();
        }
        let pieces = self.of_face.entry(face).or_insert_with(|| {
            let first = self.pieces.len();
            self.smooth.pieces(face, row, &mut self.pieces);
            first..self.pieces.len()
        });
        let pieces = &self.pieces[pieces.clone()];
        let light = if inside { -self.smooth.light } else { self.smooth.light };
        let mut behind = pieces.partition_point(|piece| piece.from <= f64::from(columns.start));
        for column in columns {
            let x = f64::from(column);
            while pieces.get(behind).is_some_and(|piece| piece.from <= x) {
                behind += 1;
            }
            let cosine = pieces.get(behind.saturating_sub(1)).and_then(|piece| {
                let normal = piece.at + piece.step * x;
                let cosine = normal.dot(light) / normal.length();
                cosine.is_finite().then_some(cosine)
            });
            take(column, cosine);
        }
    }
}
