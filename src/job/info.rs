//! What a document holds: its names with their bounds and edges.

use crate::edge::Placement;
use crate::error::Result;
use crate::grid::NEAR;
use crate::scene::{Area, Formula, Gate, Limits, Scene};
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
        let (mut bounds, mut edges) = (None, 0);
        let transform = shape.transform.then_place(unplaced.scale, unplaced.offset);
        shape.rings(&transform, &how, |part| {
            edges += part.points.len() as u64;
            part.points.iter().for_each(|&[x, y]| bounds = Some(join(bounds, [x, y, x, y])));
            Ok(())
        })?;
        Ok((bounds, edges))
    };
    let parts: Vec<&[Shape]> = scene.shapes.chunks(scene.shapes.len().div_ceil(PARTS).max(1)).collect();
    let measured = spread(&parts, Limits::default().threads, |part| part.iter().map(measure).collect::<Result<Vec<_>>>());
    let of_shape: Vec<(Bounds, u64)> = measured.into_iter().collect::<Result<Vec<_>>>()?.concat();
    // Edges of all shapes before each.
    let edges_before: Vec<u64> = std::iter::once(0)
        .chain(of_shape.iter().scan(0, |sum, shape| {
            *sum += shape.1;
            Some(*sum)
        }))
        .collect();
    let edges = |shapes: &std::ops::Range<u32>| edges_before[shapes.end as usize] - edges_before[shapes.start as usize];
    let mut extents = Extents { formula: &scene.formula, of_shape: &of_shape, known: vec![None; scene.formula.gates().len()] };
    let ids = scene
        .names()
        .iter()
        .map(|named| {
            let bounds = extents.of(named.area);
            let [r, g, b] = named.ink.unwrap_or_default();
            Entry {
                id: named.id.clone(),
                kind: named.kind,
                depth: named.depth,
                bounds,
                bounds_mm: bounds.map(|b| b.map(|x| x * MM)),
                edges: named.shapes.iter().map(edges).sum(),
                ink: named.ink.map(|_| format!("#{r:02x}{g:02x}{b:02x}")),
            }
        })
        .collect();
    Ok(Info { width: scene.width, height: scene.height, ids })
}

/// Left, top, right, bottom, if there is anything.
type Bounds = Option<[f64; 4]>;

/// Boxes of areas, from those of the shapes.
struct Extents<'s> {
    formula: &'s Formula,
    of_shape: &'s [(Bounds, u64)],
    known: Vec<Option<Bounds>>,
}

impl Extents<'_> {
    /// A box that the area stays within, with an explicit stack.
    fn of(&mut self, area: Area) -> Bounds {
        let mut open = vec![area];
        while let Some(&area) = open.last() {
            let unknown = |a: &Area| self.known[a.index()].is_none();
            let before = open.len();
            if unknown(&area) {
                match &self.formula.gates()[area.index()] {
                    Gate::Shape(_) => {}
                    Gate::AtLeast(_, inputs) | Gate::Odd(inputs) => open.extend(inputs.iter().map(|i| i.area).filter(unknown)),
                }
                if open.len() == before {
                    self.known[area.index()] = Some(self.by_inputs(area));
                }
            }
            if open.len() == before {
                open.pop();
            }
        }
        self.known[area.index()].expect("the stack empties when all are known")
    }

    /// The box of an area whose inputs' are known: within that of each input that it cannot do without, and of all that count for it.
    fn by_inputs(&self, area: Area) -> Bounds {
        const EVERYWHERE: Bounds = Some([f64::NEG_INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::INFINITY]);
        let (least, inputs) = match &self.formula.gates()[area.index()] {
            Gate::Shape(shape) => return self.of_shape[*shape as usize].0,
            Gate::AtLeast(k, inputs) => (i64::from(*k), inputs),
            Gate::Odd(inputs) => (1, inputs),
        };
        let odd = matches!(self.formula.gates()[area.index()], Gate::Odd(_));
        let positive =
            || inputs.iter().filter(|i| odd || i.weight > 0).map(|i| (i64::from(i.weight), self.known[i.area.index()].flatten()));
        if least <= 0 {
            return EVERYWHERE;
        }
        let most: i64 = positive().map(|i| i.0).sum();
        let union = positive().filter_map(|i| i.1).fold(None, |all, one| Some(join(all, one)));
        positive().filter(|i| most - i.0 < least).fold(union, |all, (_, one)| meet(all?, one?))
    }
}

fn meet(a: [f64; 4], b: [f64; 4]) -> Bounds {
    let met = [a[0].max(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].min(b[3])];
    (met[0] <= met[2] && met[1] <= met[3]).then_some(met)
}

fn join(all: Option<[f64; 4]>, [left, top, right, bottom]: [f64; 4]) -> [f64; 4] {
    all.map_or([left, top, right, bottom], |a| [a[0].min(left), a[1].min(top), a[2].max(right), a[3].max(bottom)])
}
