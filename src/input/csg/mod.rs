//! OpenSCAD's `.csg`: what `openscad -o model.csg` writes, a tree of primitives and operators without variables.
//!
//! The statements are [parsed](tree) into a flat list and walked once in document order, with the open operators on a stack. On the way
//! down matrices and colours are gathered; on the way up operands become one: gates of a formula in space, booleans of outlines in the plane. What stands
//! under `projection` or `hull` is not kept as parts: it becomes an outline or points at once ([`Purpose`]).
//!
//! `docs/csg.md` says what is read, and where it differs from OpenSCAD.

mod leaves;
mod made;
mod modules;
mod tree;
mod values;
mod words;

use foldhash::HashMap;
use std::path::Path;
use std::sync::Arc;

use self::made::{Made, Purpose, Solid};
use self::modules::{Kind as Module, MODULES};
use self::tree::{Statement, Tree};
use self::values::Arguments;
use super::reading::{Listed, Reading, Rendered};
use crate::error::{Error, Kind, Place, Places, Result, Warning};
use crate::mesh::outline::{Outline, Tangled};
use crate::mesh::{FARTHEST, IDENTITY, Matrix, Mesh, Model, Part, extrude, product};
use crate::run::Rgb;
use crate::scene::{Formula, Limits};

/// Corners of outlines that booleans take, all of them together.
const OUTLINE_WORK: u64 = 5_000_000;

/// Reads a `.csg`. Files that it names are looked for in `folder`; without one they are refused.
///
/// # Errors
/// With its place: what the parser refuses, wrong arguments, more than the limits allow.
pub(super) fn read(text: &[u8], limits: &Limits, folder: Option<&Path>, warnings: &mut Vec<Warning>) -> Result<Reading> {
    let tree = tree::parse(text, limits)?;
    let reader = Reader {
        tree: &tree,
        limits,
        folder,
        places: Places::new(text),
        warnings,
        parts: Vec::new(),
        formula: Formula::default(),
        meshes: HashMap::default(),
        faces: 0,
        outline_work: 0,
        listed: Vec::new(),
        rendered: Vec::new(),
    };
    reader.model()
}

struct Reader<'d, 't> {
    tree: &'d Tree<'t>,
    limits: &'d Limits,
    folder: Option<&'d Path>,
    places: Places<'t>,
    warnings: &'d mut Vec<Warning>,
    parts: Vec<Part>,
    formula: Formula,
    /// Meshes by the text that describes them.
    meshes: HashMap<&'t [u8], Arc<Mesh>>,
    /// Of all parts.
    faces: u64,
    /// See [`OUTLINE_WORK`].
    outline_work: u64,
    listed: Vec<Listed>,
    rendered: Vec<Rendered>,
}

/// What a statement's surroundings say of it.
#[derive(Clone, Copy)]
struct Surroundings {
    matrix: Matrix,
    /// The outermost colour.
    color: Option<Rgb>,
    purpose: Purpose,
}

/// An operator whose operands are being read.
struct Open {
    statement: Statement,
    kind: Module,
    place: Place,
    /// Those of the operator.
    own: Surroundings,
    /// Those of its operands.
    inner: Surroundings,
    operands: Vec<Made>,
}

impl<'d, 't> Reader<'d, 't> {
    fn model(mut self) -> Result<Reading> {
        let statements = &self.tree.statements;
        let all = Statement {
            text: [0; 2],
            module: 0,
            arguments: [0; 2],
            marks: tree::Marks::default(),
            end: u32::try_from(statements.len()).unwrap_or(u32::MAX),
        };
        let (first, root) = match self.root() {
            Some(root) => (root, Statement { end: statements[root].end, ..all }),
            None => (0, all),
        };
        let around = Surroundings { matrix: IDENTITY, color: None, purpose: Purpose::Model };
        let place = Place { line: 1, column: 1 };
        let mut open = vec![Open { statement: root, kind: Module::Union, place, own: around, inner: around, operands: Vec::new() }];
        let mut i = first;
        let made = loop {
            let top = open.last_mut().expect("the document is closed last");
            if i >= top.statement.end as usize {
                let done = open.pop().expect("it was there");
                let made = self.close(done)?;
                match open.last_mut() {
                    Some(parent) => parent.operands.push(made),
                    None => break made,
                }
                continue;
            }
            let statement = &statements[i];
            if statement.marks.out {
                i = statement.end as usize;
                continue;
            }
            let depth = open.len() as u32 - 1;
            let inner = open.last().expect("the document is closed last").inner;
            match self.begin(statement, inner, depth)? {
                Begun::Leaf(made) => {
                    i = statement.end as usize;
                    open.last_mut().expect("the document is closed last").operands.push(made);
                }
                Begun::Open(operator) => {
                    i += 1;
                    open.push(*operator);
                }
            }
        };
        let area = match made {
            Made::Solid(Solid::Gate(gate)) => gate.area(&mut self.formula),
            Made::Flat(outline) => {
                if !outline.is_empty() {
                    self.warnings.push(Warning::input("the model is flat: nothing solid is in it; extrude it"));
                }
                self.formula.any(&[])
            }
            _ => self.formula.any(&[]),
        };
        Ok(Reading { model: Model { parts: self.parts, formula: self.formula, area }, tree: self.listed, rendered: self.rendered })
    }

    /// The statement that is marked as the only one, if there is one.
    fn root(&mut self) -> Option<usize> {
        let mut marked = Vec::new();
        let mut i = 0;
        while let Some(statement) = self.tree.statements.get(i) {
            if statement.marks.out {
                i = statement.end as usize;
                continue;
            }
            if statement.marks.root {
                marked.push(i);
            }
            i += 1;
        }
        if let Some(&second) = marked.get(1) {
            let place = Place::of_byte(self.tree.text, self.tree.statements[second].text[0] as usize);
            self.warnings.push(Warning { place: Some(place), ..Warning::input("a second ! is ignored: only the first counts") });
        }
        marked.first().copied()
    }

    fn begin(&mut self, statement: &Statement, around: Surroundings, depth: u32) -> Result<Begun> {
        let place = self.places.of_byte(statement.text[0] as usize);
        let module = &MODULES[statement.module as usize];
        let arguments = Arguments::of(self.tree, statement);
        self.listed.push(Listed { kind: module.name, place: Some(place), depth, part: None });
        if module.kind == Module::Unsupported {
            let what = format!("{} is not supported: it and what it holds are left out, as if empty", module.name);
            self.warn(place, what);
            return Ok(Begun::Leaf(Made::Nothing));
        }
        arguments.check(&mut self.places, self.warnings);
        let mut inner = around;
        match module.kind {
            Module::Union | Module::Render | Module::Difference | Module::Intersection => {}
            Module::Matrix => inner.matrix = product(&around.matrix, &leaves::matrix(&arguments)?),
            Module::Color => inner.color = around.color.or(leaves::color(&arguments, place, self.warnings)?),
            Module::Hull => inner = Surroundings { matrix: IDENTITY, color: None, purpose: Purpose::Hull },
            Module::LinearExtrude | Module::RotateExtrude => {
                inner = Surroundings { matrix: IDENTITY, color: None, purpose: Purpose::Outline }
            }
            Module::Projection => {
                let purpose = if arguments.truth("cut")? { Purpose::Section } else { Purpose::Shadow };
                inner = Surroundings { matrix: IDENTITY, color: None, purpose };
            }
            Module::Square | Module::Circle | Module::Polygon => {
                let outline = self.outline(module.kind, &arguments, place)?;
                return Ok(Begun::Leaf(Made::Flat(self.moved(outline, &around, place)?)));
            }
            Module::Cube | Module::Sphere | Module::Cylinder | Module::Polyhedron | Module::Import => {
                return Ok(Begun::Leaf(self.solid(statement, module.kind, &arguments, around, place)?));
            }
            Module::Unsupported => unreachable!("left out above"),
        }
        Ok(Begun::Open(Box::new(Open { statement: *statement, kind: module.kind, place, own: around, inner, operands: Vec::new() })))
    }

    /// An outline at its place.
    fn moved(&self, outline: Outline, around: &Surroundings, place: Place) -> Result<Outline> {
        let [[a, b, _, x], [c, d, _, y], _] = around.matrix;
        let flat = (a * d - b * c).abs() <= made::FLAT * a.hypot(b) * c.hypot(d);
        let moved = if flat { Outline::default() } else { outline.moved(&[[a, b, x], [c, d, y]]) };
        if moved.farthest() < FARTHEST { Ok(moved) } else { Err(too_far(place)) }
    }

    /// A cube, sphere, cylinder, polyhedron or imported mesh.
    fn solid(
        &mut self,
        statement: &Statement,
        kind: Module,
        arguments: &Arguments<'d, 't>,
        around: Surroundings,
        place: Place,
    ) -> Result<Made> {
        let text = &self.tree.text[statement.text[0] as usize..statement.text[1] as usize];
        let mesh = match self.meshes.get(text) {
            Some(mesh) => Arc::clone(mesh),
            None => {
                let Some(mesh) = self.mesh(kind, arguments, place)? else { return Ok(Made::Nothing) };
                let mesh = Arc::new(mesh);
                self.meshes.insert(text, Arc::clone(&mesh));
                mesh
            }
        };
        self.part(mesh, MODULES[statement.module as usize].name, around, place)
    }

    /// A mesh where it stands: a part of the model, or what it is needed for.
    fn part(&mut self, mesh: Arc<Mesh>, kind: &'static str, around: Surroundings, place: Place) -> Result<Made> {
        self.spend(mesh.faces.len(), place)?;
        if mesh.faces.is_empty() {
            return Ok(Made::Solid(around.purpose.nothing()));
        }
        let size = mesh.points.iter().flatten().fold(1.0_f64, |most, x| most.max(x.abs()));
        let reach = around.matrix.iter().map(|[a, b, c, d]| (a.abs() + b.abs() + c.abs()) * size + d.abs()).fold(0.0, f64::max);
        if reach.is_nan() || reach >= FARTHEST {
            return Err(too_far(place));
        }
        if made::is_flat(&around.matrix) {
            self.warn(place, format!("the matrices around this {kind} make it flat: it is left out, as if empty"));
            return Ok(Made::Solid(around.purpose.nothing()));
        }
        if around.purpose != Purpose::Model {
            return Ok(Made::Solid(around.purpose.take(&mesh, &around.matrix)));
        }
        let index = u32::try_from(self.parts.len()).expect("statements are limited at the door");
        self.parts.push(Part { mesh, matrix: around.matrix, color: around.color, kind, place: Some(place) });
        if let Some(listed) = self.listed.iter_mut().rev().find(|l| l.place == Some(place)) {
            listed.part = Some(index);
        }
        Ok(Made::Solid(Solid::Gate(made::Gate::Any(vec![self.formula.shape(index)]))))
    }

    /// Counts faces of a part.
    fn spend(&mut self, faces: usize, place: Place) -> Result<()> {
        self.would_spend(faces as f64, place)?;
        self.faces += faces as u64;
        Ok(())
    }

    /// Whether so many faces more are within the limit; they may be more than anything can hold.
    fn would_spend(&self, faces: f64, place: Place) -> Result<()> {
        if faces > (self.limits.faces - self.faces) as f64 {
            let what = format!("more than {} faces: use a smaller $fn or a coarser mesh", self.limits.faces);
            return Err(Error::input(Kind::Limit, what).at(place));
        }
        Ok(())
    }

    /// A number of sides or slices as a whole number within the limit.
    fn fragments(&self, fragments: f64, what: &str, place: Place) -> Result<u32> {
        if fragments > f64::from(self.limits.fragments) {
            let what = format!("more than {} {what}: use a smaller $fn, or larger $fa and $fs", self.limits.fragments);
            return Err(Error::input(Kind::Limit, what).at(place));
        }
        Ok(fragments as u32)
    }

    /// Counts corners that a boolean of outlines takes.
    fn work(&mut self, outline: &Outline, place: Place) -> Result<()> {
        self.outline_work += outline.corners() as u64;
        if self.outline_work > OUTLINE_WORK {
            let what = format!("booleans of outlines with more than {OUTLINE_WORK} corners in all: simplify the outlines");
            return Err(Error::input(Kind::Limit, what).at(place));
        }
        Ok(())
    }

    fn warn(&mut self, place: Place, what: String) {
        self.warnings.push(Warning { place: Some(place), ..Warning::input(what) });
    }

    /// What an operator makes of its operands.
    fn close(&mut self, open: Open) -> Result<Made> {
        let Open { statement, kind, place, own, inner, operands } = open;
        let arguments = Arguments::of(self.tree, &statement);
        match kind {
            Module::LinearExtrude | Module::RotateExtrude => {
                let Some(outline) = self.flat(operands, Module::Union, place)? else { return Ok(Made::Nothing) };
                self.work(&outline, place)?;
                let shapes = outline.shapes().map_err(|Tangled| tangled(place))?;
                let mesh = if kind == Module::LinearExtrude {
                    self.extrusion(&arguments, &shapes, place)?
                } else {
                    self.turned(&arguments, &shapes, place)?
                };
                self.part(Arc::new(mesh), MODULES[statement.module as usize].name, own, place)
            }
            Module::Projection => Ok(match self.solids(operands, Module::Union, inner.purpose, place)? {
                Some(Solid::Outline(outline)) => Made::Flat(self.moved(outline, &own, place)?),
                _ => Made::Nothing,
            }),
            Module::Hull => self.hull(operands, own, place),
            Module::Render => Ok(match self.combined(operands, kind, inner.purpose, place)? {
                Made::Solid(Solid::Gate(gate)) => Made::Solid(Solid::Gate(self.rendered(gate, place))),
                made => made,
            }),
            _ => self.combined(operands, kind, inner.purpose, place),
        }
    }

    /// `linear_extrude`.
    fn extrusion(&mut self, arguments: &Arguments<'d, 't>, shapes: &crate::mesh::outline::Shapes, place: Place) -> Result<Mesh> {
        let extrusion = leaves::extrusion(arguments)?;
        if extrusion.z[1] <= extrusion.z[0] {
            return Ok(Mesh::default());
        }
        let slices = self.fragments(extrusion.slices(shapes), "slices", place)?;
        let corners: usize = shapes.iter().flatten().map(Vec::len).sum();
        self.would_spend(2.0 * corners as f64 * f64::from(slices), place)?;
        Ok(extrusion.solid(shapes, slices))
    }

    /// `rotate_extrude`.
    fn turned(&mut self, arguments: &Arguments<'d, 't>, shapes: &crate::mesh::outline::Shapes, place: Place) -> Result<Mesh> {
        let angle = arguments.number("angle", 360.0)?;
        let angle = if angle > 360.0 || angle <= -360.0 { 360.0 } else { angle };
        if angle == 0.0 {
            return Ok(Mesh::default());
        }
        let [low, high] = extrude::reach(shapes);
        if low < 0.0 && high > 0.0 {
            self.warn(place, format!("the outline reaches from x = {low} to x = {high}, across the axis: it is left out, as if empty"));
            return Ok(Mesh::default());
        }
        let sides = self.fragments(extrude::sides_of_turn(shapes, angle, &arguments.fineness()?), "sides", place)?;
        let corners: usize = shapes.iter().flatten().map(Vec::len).sum();
        self.would_spend(corners as f64 * f64::from(sides), place)?;
        Ok(extrude::turned(shapes, angle, sides))
    }
}

enum Begun {
    Leaf(Made),
    Open(Box<Open>),
}

fn too_far(place: Place) -> Error {
    Error::input(Kind::Refused, format!("coordinates past {FARTHEST:e}: scale the model down")).at(place)
}

fn tangled(place: Place) -> Error {
    let what = "the sides of this outline cross too often (1,000,000 crossings or 100,000,000 pairs to look at): simplify it";
    Error::input(Kind::Limit, what).at(place)
}
