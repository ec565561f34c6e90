//! An area of a model worked out to a surface: the points of space that its formula fills, as triangles around them.
//!
//! Two meshes are combined by `manifold-rust`, which gives closed surfaces whatever touches or coincides; here the formula becomes pairs of meshes. A `Region` is
//! what lies within a surface, or all that lies outside of it, so complements cost nothing, and every gate is intersections of regions:
//!
//! ```text
//!   a | b      what is not outside of both          a & !b      the mesh a - b
//!   !a & !b    outside of the mesh a | b            odd(a, b)   (a - b) | (b - a); outside, if one of them is
//! ```
//!
//! With its inputs of negative weight complemented, a gate is an intersection if all inputs have to hold, a union if any is enough, else a table of the regions
//! where at least 1, 2, 3, ... inputs hold. Many operands are combined in pairs and pairs of pairs: a mesh is copied as often as the logarithm of their number.
//!
//! What a part fills is what the engine counts: the points that its surface winds around at least once. Parts that meet themselves are made simple first,
//! in rational numbers, which is slow; all that follows is in doubles, symbolically perturbed, as in Manifold (Julian Smith, "Towards Robust Inexact
//! Geometric Computation", Cambridge 2009). Doubles alone go wrong where many faces of turned operands should coincide and are askew by rounding, so every step is held against
//! another, and what does not add up is done again in rational numbers.

use manifold_rust::manifold::Manifold;
use manifold_rust::types::{BooleanEngine, MeshGL64, OpType, WindingRule};

use super::check::{Placed, closed};
use super::surface::{Surface, THIN, Triangle};
use super::triangles::triangles;
use super::{Mesh, Model, Origin, cross, dot, length, minus};
use crate::error::{Error, Kind, Result, Warning};
use crate::scene::{Area, Gate, Input};

/// Most triangles of a mesh, one that is given or one that is worked out.
pub const MOST_TRIANGLES: usize = 2_000_000;

/// Most triangles that all booleans of an area take, those of every step, with `STEP` more for each.
pub const MOST_WORK: u64 = 100_000_000;

/// What a step takes that has no triangles.
const STEP: u64 = 20;

/// Fewer triangles with an area enclose nothing.
const LEAST: usize = 4;

/// What lies within a surface, or outside of it.
#[derive(Clone)]
struct Region {
    solid: Manifold,
    outside: bool,
}

/// The surface of an area of a model. `warnings` receives what is wrong with the parts that it needs.
///
/// # Errors
/// The area has no bounds, or is past [`MOST_TRIANGLES`] or [`MOST_WORK`].
pub fn surface(model: &Model, area: Area, warnings: &mut Vec<Warning>) -> Result<Surface> {
    let mut work = Work::new(model, area);
    let root = work.region(area, warnings)?;
    if root.outside {
        let what = "this has no bounds, so it has no surface: take it from a solid or intersect it with one";
        return Err(Error::input(Kind::Refused, what));
    }
    Ok(work.read(&root.solid))
}

struct Work<'m> {
    model: &'m Model,
    /// Regions of gates that are still needed.
    regions: Vec<Option<Region>>,
    /// How often each gate is still needed; 0 from the start: not at all.
    uses: Vec<u32>,
    /// For every part that is needed, whose surface its faces are.
    origins: Vec<Vec<Origin>>,
    spent: u64,
}

impl<'m> Work<'m> {
    fn new(model: &'m Model, area: Area) -> Work<'m> {
        let gates = model.formula.gates().len();
        Work { model, regions: vec![None; gates], uses: model.formula.uses(area), origins: vec![Vec::new(); model.parts.len()], spent: 0 }
    }

    /// The region of an area, with an explicit stack.
    fn region(&mut self, area: Area, warnings: &mut Vec<Warning>) -> Result<Region> {
        let model = self.model;
        let mut open = vec![area];
        while let Some(&area) = open.last() {
            let before = open.len();
            if self.regions[area.index()].is_none() {
                let region = match &model.formula.gates()[area.index()] {
                    Gate::Shape(part) => self.part(*part, warnings)?,
                    Gate::AtLeast(_, inputs) | Gate::Odd(inputs) if inputs.iter().any(|i| self.regions[i.area.index()].is_none()) => {
                        open.extend(inputs.iter().rev().map(|input| input.area).filter(|area| self.regions[area.index()].is_none()));
                        continue;
                    }
                    Gate::AtLeast(k, inputs) => self.at_least(i64::from(*k), inputs)?,
                    Gate::Odd(inputs) => {
                        let odd = |work: &mut Work<'_>, a: Region, b: Region| {
                            let [c, d] = [(&a, &b), (&b, &a)].map(|(a, b)| work.combine(&a.solid, &b.solid, OpType::Subtract));
                            Ok(Region { solid: work.combine(&c?, &d?, OpType::Add)?, outside: a.outside != b.outside })
                        };
                        // An input counts as often as its weight says; all but its parity is nothing.
                        let inputs: Vec<Input> = inputs.iter().filter(|input| input.weight % 2 != 0).copied().collect();
                        let regions = self.take(&inputs);
                        self.fold(regions, odd)?.unwrap_or_else(nothing)
                    }
                };
                self.regions[area.index()] = Some(region);
            }
            if open.len() == before {
                open.pop();
            }
        }
        Ok(self.taken(area))
    }

    /// A region that is there, for one of those who need it.
    fn taken(&mut self, area: Area) -> Region {
        let i = area.index();
        self.uses[i] -= 1;
        let region = if self.uses[i] == 0 { self.regions[i].take() } else { self.regions[i].clone() };
        region.expect("inputs are worked out before the gates that use them")
    }

    fn take(&mut self, inputs: &[Input]) -> Vec<Region> {
        inputs.iter().map(|input| self.taken(input.area)).collect()
    }

    /// Where a weighted sum is at least `k`.
    fn at_least(&mut self, k: i64, inputs: &[Input]) -> Result<Region> {
        let mut regions = self.take(inputs);
        let weights: Vec<u64> = inputs.iter().map(|input| u64::from(input.weight.unsigned_abs())).collect();
        // What is taken away where it holds is added where it does not.
        let mut k = k;
        for (region, input) in regions.iter_mut().zip(inputs).filter(|(_, input)| input.weight < 0) {
            region.outside = !region.outside;
            k -= i64::from(input.weight);
        }
        let Some(k) = u64::try_from(k).ok().filter(|k| *k > 0) else { return Ok(complement(nothing())) };
        let (all, least): (u64, u64) = (weights.iter().sum(), weights.iter().copied().min().unwrap_or(0));
        if k > all {
            return Ok(nothing());
        }
        if k > all - least {
            return self.all(regions);
        }
        if k <= least {
            return self.any(regions);
        }
        // Where at least j of the inputs so far hold, for all j up to k.
        let room = usize::try_from(k).ok().filter(|k| *k as u64 <= MOST_WORK / STEP).ok_or_else(too_much)?;
        let mut reached = vec![nothing(); room + 1];
        reached[0] = complement(nothing());
        for (region, weight) in regions.into_iter().zip(weights) {
            for j in (1..=room).rev() {
                let without = usize::try_from(weight).map_or(0, |weight| j.saturating_sub(weight));
                let both = self.all(vec![reached[without].clone(), region.clone()])?;
                let before = std::mem::replace(&mut reached[j], nothing());
                reached[j] = self.any(vec![before, both])?;
            }
        }
        Ok(reached.pop().expect("k is above 0"))
    }

    /// Where all hold: what is within all meshes, without what is within any that has to be outside.
    fn all(&mut self, regions: Vec<Region>) -> Result<Region> {
        let (outer, inner): (Vec<Region>, Vec<Region>) = regions.into_iter().partition(|region| region.outside);
        let step = |op| {
            move |work: &mut Work<'_>, a: Region, b: Region| Ok(Region { solid: work.combine(&a.solid, &b.solid, op)?, outside: a.outside })
        };
        let inner = self.fold(inner, step(OpType::Intersect))?;
        let outer = self.fold(outer, step(OpType::Add))?;
        match (inner, outer) {
            (Some(inner), Some(outer)) => Ok(Region { solid: self.combine(&inner.solid, &outer.solid, OpType::Subtract)?, outside: false }),
            (inner, outer) => Ok(inner.or(outer).unwrap_or_else(|| complement(nothing()))),
        }
    }

    /// Where any holds.
    fn any(&mut self, regions: Vec<Region>) -> Result<Region> {
        self.all(regions.into_iter().map(complement).collect()).map(complement)
    }

    /// Pairs, pairs of pairs and so on; none of none.
    fn fold(&mut self, mut regions: Vec<Region>, step: impl Fn(&mut Work<'_>, Region, Region) -> Result<Region>) -> Result<Option<Region>> {
        while regions.len() > 1 {
            let mut pairs = Vec::with_capacity(regions.len().div_ceil(2));
            let mut rest = regions.into_iter();
            while let Some(first) = rest.next() {
                pairs.push(match rest.next() {
                    Some(second) => step(self, first, second)?,
                    None => first,
                });
            }
            regions = pairs;
        }
        Ok(regions.pop())
    }

    /// One step, within the limits.
    fn combine(&mut self, a: &Manifold, b: &Manifold, op: OpType) -> Result<Manifold> {
        self.spent += (a.num_tri() + b.num_tri()) as u64 + STEP;
        if self.spent > MOST_WORK {
            return Err(too_much());
        }
        let solid = match (op, a.is_empty(), b.is_empty()) {
            (OpType::Intersect, true, _) | (OpType::Subtract, _, true) | (OpType::Add, _, true) => a.clone(),
            (OpType::Intersect, _, true) | (OpType::Add, true, _) => b.clone(),
            (OpType::Subtract, true, _) => a.clone(),
            _ => checked(a, b, op),
        };
        sound(solid)
    }

    /// A part of the model: closed, turned, without what it winds around less than once.
    fn part(&mut self, index: u32, warnings: &mut Vec<Warning>) -> Result<Region> {
        let part = &self.model.parts[index as usize];
        let place = |error: Error| part.place.map_or(error.clone(), |place| error.at(place));
        let placed = closed(part);
        placed.tell(part, warnings);
        let Placed { mesh: Mesh { points, faces }, .. } = placed;
        self.origins[index as usize] = faces.iter().map(|face| face.origin.unwrap_or(Origin { turned: false, part: index })).collect();
        let mut mesh = MeshGL64 { num_prop: 3, vert_properties: points.concat(), run_original_id: vec![index], ..MeshGL64::default() };
        let mut wide = 0;
        for (face, i) in faces.iter().zip(0_u64..) {
            for corners in triangles(&points, face) {
                let [a, b, c] = corners.map(|i| points[i as usize]);
                wide += usize::from(cross(minus(b, a), minus(c, a)) != [0.0; 3]);
                mesh.tri_verts.extend(corners.map(u64::from));
                mesh.face_id.push(i);
            }
        }
        if mesh.face_id.len() > MOST_TRIANGLES {
            return Err(place(too_many()));
        }
        let mut solid = if wide < LEAST { Manifold::empty() } else { Manifold::from_mesh_gl64_robust(&mesh) };
        if !solid.is_empty() && solid.has_self_intersections() {
            solid = solid.rebuild_solid(WindingRule::Positive);
        }
        Ok(Region { solid: sound(solid).map_err(place)?, outside: false })
    }

    /// The triangles of a mesh, and where they come from.
    fn read(&self, solid: &Manifold) -> Surface {
        let mesh = solid.get_mesh_gl64(-1);
        let mut surface =
            Surface { points: mesh.vert_properties.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect(), ..Surface::default() };
        for (run, ends) in mesh.run_index.windows(2).enumerate() {
            let (of_part, backside) = (&self.origins[mesh.run_original_id[run] as usize], mesh.run_flags[run] & 1 != 0);
            for triangle in ends[0] as usize / 3..ends[1] as usize / 3 {
                let corners = [0, 1, 2].map(|i| mesh.tri_verts[3 * triangle + i] as u32);
                let face = mesh.face_id[triangle] as u32;
                let Origin { turned, part } = of_part[face as usize];
                surface.triangles.push(Triangle { corners, origin: Origin { turned: turned != backside, part }, face });
            }
        }
        surface.without_slivers()
    }
}

/// Two meshes combined in doubles, or in rational numbers where the doubles are wrong. Each result is held against the one that has the other pieces of the two surfaces, so that
/// no piece can be wrong in both:
///
/// ```text
/// |a or b| + |a and b| = |a| + |b|        |a - b| - |b - a| = |a| - |b|
/// ```
fn checked(a: &Manifold, b: &Manifold, op: OpType) -> Manifold {
    let quick = |a: &Manifold, b: &Manifold, op| a.boolean_with_engine(b, op, BooleanEngine::Exact);
    let (solid, other, sign) = match op {
        OpType::Add => (quick(a, b, op), quick(a, b, OpType::Intersect), 1.0),
        OpType::Subtract => (quick(a, b, op), quick(b, a, op), -1.0),
        OpType::Intersect => (quick(a, b, op), quick(a, b, OpType::Add), 1.0),
    };
    let [of_a, of_b, of_solid, of_other] = [a, b, &solid, &other].map(Measure::of);
    let off = of_solid.volume + sign * of_other.volume - of_a.volume - sign * of_b.volume;
    if off.abs() <= of_a.rounding() + of_b.rounding() { solid } else { a.boolean_with_engine(b, op, BooleanEngine::Robust) }
}

/// What a mesh measures.
struct Measure {
    volume: f64,
    area: f64,
    farthest: f64,
}

impl Measure {
    fn of(solid: &Manifold) -> Measure {
        let mesh = solid.as_impl();
        let point = |i: usize| {
            let p = mesh.vert_pos[i];
            [p.x, p.y, p.z]
        };
        let mut measure = Measure { volume: 0.0, area: 0.0, farthest: 0.0 };
        for corners in mesh.halfedge.chunks_exact(3) {
            // From a corner of the mesh: what is far from the origin would lose digits.
            let origin = point(mesh.halfedge[0].start_vert as usize);
            let [a, b, c] = [0, 1, 2].map(|i| minus(point(corners[i].start_vert as usize), origin));
            measure.volume += dot(a, cross(b, c)) / 6.0;
            measure.area += length(cross(minus(b, a), minus(c, a))) / 2.0;
        }
        measure.farthest = mesh.vert_pos.iter().fold(0.0, |most, p| most.max(p.x.abs()).max(p.y.abs()).max(p.z.abs()));
        measure
    }

    /// How much its volume may be off by rounding alone.
    fn rounding(&self) -> f64 {
        1e-10 * self.volume.abs() + THIN * self.farthest * self.area
    }
}

fn nothing() -> Region {
    Region { solid: Manifold::empty(), outside: false }
}

fn complement(region: Region) -> Region {
    Region { outside: !region.outside, ..region }
}

/// A mesh that the library has made.
fn sound(solid: Manifold) -> Result<Manifold> {
    use manifold_rust::types::Error as Status;
    match solid.status() {
        Status::ResultTooLarge => Err(too_many()),
        _ if solid.num_tri() > MOST_TRIANGLES => Err(too_many()),
        Status::NoError => Ok(solid),
        status => Err(Error::input(Kind::Refused, format!("its surface cannot be worked out ({status}): repair the mesh"))),
    }
}

fn too_many() -> Error {
    Error::input(Kind::Limit, format!("a surface of more than {MOST_TRIANGLES} triangles: use a smaller $fn or coarser meshes"))
}

fn too_much() -> Error {
    Error::input(Kind::Limit, format!("booleans of more than {MOST_WORK} triangles in all: use a smaller $fn or coarser meshes"))
}
