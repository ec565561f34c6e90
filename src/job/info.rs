//! What a document holds: its names with their bounds and edges.

use crate::edge::Placement;
use crate::error::Result;
use crate::grid::NEAR;
use crate::scene::Scene;
use crate::shape::Shape;
use crate::shape::flatten::Flattening;

/// What `runset info` tells of a named area.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Entry {
    /// The id.
    pub id: String,
    /// One word for people.
    pub kind: &'static str,
    /// Depth in the tree of names.
    pub depth: u32,
    /// Left, top, right, bottom in user units; none if it paints nothing.
    pub bounds: Option<[f64; 4]>,
    /// Edges at scale 1.
    pub edges: u64,
}

/// What `runset info` tells of a document.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Info {
    /// Width of the page in user units.
    pub width: f64,
    /// Height of the page in user units.
    pub height: f64,
    /// The named areas, in document order.
    pub ids: Vec<Entry>,
}

/// Bounds and edge counts of all named areas.
///
/// # Errors
/// A stroke with too many dashes.
pub fn info(scene: &Scene) -> Result<Info> {
    let how = Flattening { tolerance: super::TOLERANCE, window: [-NEAR, -NEAR, NEAR, NEAR] };
    let unplaced = Placement { scale: 1.0, offset: [0.0; 2] };
    let measure = |shape: &Shape| {
        let (mut bounds, mut edges) = (None, 0);
        let transform = shape.transform.then_place(unplaced.scale, unplaced.offset);
        shape.rings(&transform, &how, |ring| {
            edges += ring.len() as u64;
            ring.iter().for_each(|&[x, y]| bounds = Some(join(bounds, [x, y, x, y])));
            Ok(())
        })?;
        Ok((bounds, edges))
    };
    let of_shape: Vec<(Option<[f64; 4]>, u64)> = scene.shapes.iter().map(measure).collect::<Result<_>>()?;
    let ids = scene
        .names()
        .iter()
        .map(|named| {
            let shapes = &of_shape[named.shapes.start as usize..named.shapes.end as usize];
            let bounds = shapes.iter().filter_map(|shape| shape.0).fold(None, |all, one| Some(join(all, one)));
            let edges = shapes.iter().map(|shape| shape.1).sum();
            Entry { id: named.id.clone(), kind: named.kind, depth: named.depth, bounds, edges }
        })
        .collect();
    Ok(Info { width: scene.width, height: scene.height, ids })
}

fn join(all: Option<[f64; 4]>, [left, top, right, bottom]: [f64; 4]) -> [f64; 4] {
    all.map_or([left, top, right, bottom], |a| [a[0].min(left), a[1].min(top), a[2].max(right), a[3].max(bottom)])
}
