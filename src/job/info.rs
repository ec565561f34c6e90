//! What a document holds: its names with their bounds and edges.

use super::extents::Extents;
use crate::bounds::{Bounds, join};
use crate::edge::Placement;
use crate::error::Result;
use crate::grid::NEAR;
use crate::run::Hex;
use crate::scene::{Limits, Scene};
use crate::shape::Shape;
use crate::shape::flatten::Flattening;
use crate::spread::spread;

/// A user unit, 1/96 inch, in millimetres.
const MM: f64 = 25.4 / 96.0;

/// Into so many parts the shapes are cut, to be measured by several threads.
const PARTS: usize = 64;

/// What `runset info` tells of a named area.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
pub struct Entry {
    /// The id.
    pub id: String,
    /// One word for people.
    pub kind: &'static str,
    /// Depth in the tree of names.
    pub depth: u32,
    /// Left, top, right, bottom in user units; none if it paints nothing.
    pub bounds: Option<[f64; 4]>,
    /// The same in millimetres.
    pub bounds_mm: Option<[f64; 4]>,
    /// Edges at scale 1, without those of what it is cut to.
    pub edges: u64,
    /// The ink that paints it, as `#rrggbb`; none if there is none, or several.
    pub ink: Option<String>,
}

/// What `runset info` tells of a document.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
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
        let (mut bounds, mut edges): (Bounds<2>, u64) = (None, 0);
        let transform = shape.transform.then_place(unplaced.scale, unplaced.offset);
        shape.rings(&transform, &how, |part| {
            edges += part.xs.len() as u64;
            part.points().for_each(|[x, y]| bounds = join(bounds, Some([[x, y]; 2])));
            Ok(())
        })?;
        Ok((bounds, edges))
    };
    let parts: Vec<&[Shape]> = scene.shapes.chunks(scene.shapes.len().div_ceil(PARTS).max(1)).collect();
    let measured = spread(&parts, Limits::default().threads, |part| part.iter().map(measure).collect::<Result<Vec<_>>>());
    let of_shape: Vec<(Bounds<2>, u64)> = measured.into_iter().collect::<Result<Vec<_>>>()?.concat();
    // Edges of all shapes before each.
    let edges_before: Vec<u64> = std::iter::once(0)
        .chain(of_shape.iter().scan(0, |sum, shape| {
            *sum += shape.1;
            Some(*sum)
        }))
        .collect();
    let edges = |shapes: &std::ops::Range<u32>| edges_before[shapes.end as usize] - edges_before[shapes.start as usize];
    let bounds_of_shape: Vec<Bounds<2>> = of_shape.iter().map(|shape| shape.0).collect();
    let mut extents = Extents::new(&scene.formula, &bounds_of_shape);
    let ids = scene
        .names()
        .iter()
        .map(|named| {
            let bounds = extents.of(named.area).map(|[[left, top], [right, bottom]]| [left, top, right, bottom]);
            Entry {
                id: named.id.clone(),
                kind: named.kind,
                depth: named.depth,
                bounds,
                bounds_mm: bounds.map(|b| b.map(|x| x * MM)),
                edges: named.shapes.iter().map(edges).sum(),
                ink: named.ink.map(|ink| Hex::of(ink).to_string()),
            }
        })
        .collect();
    Ok(Info { width: scene.width, height: scene.height, ids })
}
