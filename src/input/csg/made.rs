//! What statements make, and how operands become one.

use super::super::reading::Rendered;
use super::modules::Kind as Module;
use super::{Reader, Surroundings, tangled};
use crate::error::{Place, Result};
use crate::mesh::outline::{Outline, Tangled};
use crate::mesh::{Matrix, Mesh, Point, determinant, hull, moved, section};
use crate::scene::{Area, Formula};
use std::sync::Arc;

/// A matrix is flat whose rows span less than this part of what rows of their length could.
pub(super) const FLAT: f64 = 1e-13;

pub(super) fn is_flat(m: &Matrix) -> bool {
    let lengths: f64 = m.iter().map(|[a, b, c, _]| a.hypot(*b).hypot(*c)).product();
    determinant(m).abs() <= FLAT * lengths
}

/// What a solid is needed for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// To be a part of the model.
    Model,
    /// For nothing: only outlines are wanted here.
    Outline,
    /// For what it covers of the plane z = 0.
    Section,
    /// For what it covers of the plane as seen from above.
    Shadow,
    /// For the hull of its corners.
    Hull,
}

/// What a statement made.
pub(super) enum Made {
    /// Neither flat nor solid: an empty group.
    Nothing,
    /// An area of the plane.
    Flat(Outline),
    /// A part of space.
    Solid(Solid),
}

/// A part of space, as it is needed.
pub(super) enum Solid {
    /// A formula over the model's parts.
    Gate(Gate),
    /// Its section or its shadow.
    Outline(Outline),
    /// Corners of what it is the hull of, or part of it.
    Points(Vec<Point>),
    /// It is not needed.
    Unwanted,
}

/// A gate that can still take operands.
pub(super) enum Gate {
    Any(Vec<Area>),
    All(Vec<Area>),
    Without(Area, Vec<Area>),
}

impl Gate {
    pub(super) fn area(self, formula: &mut Formula) -> Area {
        match self {
            Gate::Any(areas) if areas.len() == 1 => areas[0],
            Gate::Any(areas) => formula.any(&areas),
            Gate::All(areas) => formula.all(&areas),
            Gate::Without(area, others) => formula.without(area, &others),
        }
    }

    /// Adds the operands of `other`, the shorter list to the longer: chains stay linear, near enough.
    fn join(into: &mut Vec<Area>, mut other: Vec<Area>) {
        if into.len() < other.len() {
            std::mem::swap(into, &mut other);
        }
        into.append(&mut other);
    }

    /// Its operands, if it is a union or can be one.
    fn any(self, formula: &mut Formula) -> Vec<Area> {
        match self {
            Gate::Any(areas) => areas,
            other => vec![other.area(formula)],
        }
    }
}

impl Purpose {
    pub(super) fn nothing(self) -> Solid {
        match self {
            Purpose::Model => Solid::Gate(Gate::Any(Vec::new())),
            Purpose::Outline => Solid::Unwanted,
            Purpose::Section | Purpose::Shadow => Solid::Outline(Outline::default()),
            Purpose::Hull => Solid::Points(Vec::new()),
        }
    }

    /// A mesh at its place, as it is needed outside the model.
    pub(super) fn take(self, mesh: &Mesh, matrix: &Matrix) -> Solid {
        match self {
            Purpose::Model | Purpose::Outline => Solid::Unwanted,
            Purpose::Section => Solid::Outline(section::section(mesh, matrix)),
            Purpose::Shadow => Solid::Outline(section::shadow(mesh, matrix)),
            Purpose::Hull => Solid::Points(mesh.points.iter().map(|p| moved(matrix, *p)).collect()),
        }
    }
}

impl Reader<'_, '_> {
    /// The operands combined, flat or solid as the first of them is.
    pub(super) fn combined(&mut self, operands: Vec<Made>, kind: Module, purpose: Purpose, place: Place) -> Result<Made> {
        match operands.iter().find(|made| !matches!(made, Made::Nothing)) {
            None => Ok(Made::Nothing),
            Some(Made::Flat(_)) => Ok(self.flat(operands, kind, place)?.map_or(Made::Nothing, Made::Flat)),
            Some(_) => Ok(self.solids(operands, kind, purpose, place)?.map_or(Made::Nothing, Made::Solid)),
        }
    }

    /// The flat operands combined; solid ones are ignored. None if there are none.
    pub(super) fn flat(&mut self, operands: Vec<Made>, kind: Module, place: Place) -> Result<Option<Outline>> {
        let mut flat = Vec::with_capacity(operands.len());
        let mut mixed = false;
        let mut any = false;
        for made in operands {
            match made {
                Made::Nothing => flat.push(None),
                Made::Flat(outline) => {
                    any = true;
                    flat.push(Some(outline));
                }
                Made::Solid(_) => mixed = true,
            }
        }
        if mixed {
            self.warn(place, "solids among outlines: the solids are ignored".to_owned());
        }
        if !any {
            return Ok(None);
        }
        self.areas(flat, kind, place).map(Some)
    }

    /// Outlines combined; an operand that is missing is empty.
    fn areas(&mut self, operands: Vec<Option<Outline>>, kind: Module, place: Place) -> Result<Outline> {
        let mut operands = operands.into_iter().map(Option::unwrap_or_default);
        match kind {
            Module::Difference => {
                let first = operands.next().unwrap_or_default();
                let others = Outline::union(operands);
                if first.is_empty() || others.is_empty() {
                    return Ok(first);
                }
                self.work(&first, place)?;
                self.work(&others, place)?;
                first.without(&others).map_err(|Tangled| tangled(place))
            }
            Module::Intersection => {
                let mut shared = operands.next().unwrap_or_default();
                for other in operands {
                    if !shared.is_empty() && !other.is_empty() {
                        self.work(&shared, place)?;
                        self.work(&other, place)?;
                    }
                    shared = shared.within(&other).map_err(|Tangled| tangled(place))?;
                }
                Ok(shared)
            }
            _ => Ok(Outline::union(operands)),
        }
    }

    /// The solid operands combined; flat ones are ignored. None if there are none.
    pub(super) fn solids(&mut self, operands: Vec<Made>, kind: Module, purpose: Purpose, place: Place) -> Result<Option<Solid>> {
        let mut solids = Vec::with_capacity(operands.len());
        let (mut mixed, mut any) = (false, false);
        for made in operands {
            match made {
                Made::Nothing => solids.push(None),
                Made::Flat(_) => mixed = true,
                Made::Solid(solid) => {
                    any = true;
                    solids.push(Some(solid));
                }
            }
        }
        if mixed {
            self.warn(place, "outlines among solids: the outlines are ignored; extrude them".to_owned());
        }
        if !any {
            return Ok(None);
        }
        let boolean = solids.len() > 1 && matches!(kind, Module::Difference | Module::Intersection);
        Ok(Some(match purpose {
            Purpose::Model => Solid::Gate(self.gate(solids, kind)),
            Purpose::Outline => Solid::Unwanted,
            Purpose::Shadow | Purpose::Hull if boolean => {
                let within = if purpose == Purpose::Hull { "hull" } else { "projection without cut" };
                self.warn(
                    place,
                    format!("a difference or intersection of solids within {within} is not supported: it is left out, as if empty"),
                );
                purpose.nothing()
            }
            Purpose::Section | Purpose::Shadow => {
                let outline = |solid| if let Some(Solid::Outline(outline)) = solid { Some(outline) } else { None };
                Solid::Outline(self.areas(solids.into_iter().map(outline).collect(), kind, place)?)
            }
            Purpose::Hull => {
                let points = |solid| if let Some(Solid::Points(points)) = solid { points } else { Vec::new() };
                let mut all: Vec<Point> = Vec::new();
                for mut points in solids.into_iter().map(points) {
                    if all.len() < points.len() {
                        std::mem::swap(&mut all, &mut points);
                    }
                    all.append(&mut points);
                }
                Solid::Points(all)
            }
        }))
    }

    fn gate(&mut self, operands: Vec<Option<Solid>>, kind: Module) -> Gate {
        let gate = |solid| if let Some(Solid::Gate(gate)) = solid { gate } else { Gate::Any(Vec::new()) };
        let mut operands = operands.into_iter().map(gate);
        let Some(first) = operands.next() else { return Gate::Any(Vec::new()) };
        match kind {
            Module::Difference => {
                let mut others = Vec::new();
                for operand in operands {
                    Gate::join(&mut others, operand.any(&mut self.formula));
                }
                match first {
                    Gate::Any(areas) if areas.is_empty() => Gate::Any(areas),
                    first if others.is_empty() => first,
                    Gate::Without(area, mut without) => {
                        Gate::join(&mut without, others);
                        Gate::Without(area, without)
                    }
                    first => Gate::Without(first.area(&mut self.formula), others),
                }
            }
            Module::Intersection => {
                let mut all = match first {
                    Gate::All(areas) => areas,
                    only if operands.len() == 0 => return only,
                    other => vec![other.area(&mut self.formula)],
                };
                for operand in operands {
                    match operand {
                        Gate::All(areas) => Gate::join(&mut all, areas),
                        other => all.push(other.area(&mut self.formula)),
                    }
                }
                Gate::All(all)
            }
            _ => {
                if operands.len() == 0 {
                    return first;
                }
                let mut any = first.any(&mut self.formula);
                for operand in operands {
                    Gate::join(&mut any, operand.any(&mut self.formula));
                }
                Gate::Any(any)
            }
        }
    }

    /// `render`: an area of its own, which no operator takes apart.
    pub(super) fn rendered(&mut self, gate: Gate, place: Place) -> Gate {
        if matches!(&gate, Gate::Any(areas) if areas.is_empty()) {
            return gate;
        }
        let area = gate.area(&mut self.formula);
        self.rendered.push(Rendered { area, place });
        Gate::Any(vec![area])
    }

    /// `hull`: of outlines in the plane, of corners in space.
    pub(super) fn hull(&mut self, operands: Vec<Made>, own: Surroundings, place: Place) -> Result<Made> {
        match self.combined(operands, Module::Union, Purpose::Hull, place)? {
            Made::Flat(outline) => {
                self.work(&outline, place)?;
                let hull = hull::plane(&outline);
                Ok(Made::Flat(self.moved(hull, &own, place)?))
            }
            Made::Solid(Solid::Points(points)) => {
                let mesh = hull::solid(&points);
                if mesh.faces.is_empty() && !points.is_empty() {
                    self.warn(place, "the hull is flat: it is left out, as if empty".to_owned());
                }
                self.part(Arc::new(mesh), "hull", own, place)
            }
            _ => Ok(Made::Nothing),
        }
    }
}
