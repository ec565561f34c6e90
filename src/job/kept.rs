//! A model that was read and identified, to be seen from anywhere: [`Job::solid`](super::Job::solid) makes a view of it and reads nothing again.

use std::sync::Arc;

use super::extents::Extents;
use super::model::bounds;
use crate::count::{Node, Program, Rule};
use crate::error::{Result, Warning};
use crate::mesh::Model;
use crate::mesh::check::all_placed;
use crate::run::Rgb;
use crate::scene::{self, Limits};
use crate::solid::body::{Body, Edge, Face, Line, Plane};
use crate::solid::camera::Setup;
use crate::solid::view::View;

/// A model with identity and its counting program, in no view yet.
#[derive(Clone, Debug)]
pub struct Kept {
    /// As it was read, for when its parts are moved.
    pub(super) model: Arc<Model>,
    pub(super) body: Body,
    pub(super) program: Program,
    /// The counters of the parts that are needed.
    pub(super) leaves: Vec<(usize, Node)>,
    /// Colours of the parts, of those that have one.
    pub(super) colours: Vec<Option<Rgb>>,
    /// How many parts have a surface.
    parts: u64,
    bounds: Option<[[f64; 3]; 2]>,
    /// See [`Limits::pairs`].
    pub(super) pairs: u64,
}

impl Kept {
    /// Closes and turns the parts and finds which of their points, lines and planes are the same. `warnings` receives what is wrong with the meshes.
    ///
    /// # Errors
    /// A limit: too many of them are near each other.
    pub fn new(model: &Model, limits: &Limits, warnings: &mut Vec<Warning>) -> Result<Kept> {
        let (program, leaves) = scene::compile(&model.formula, model.parts.len(), &[model.area], |_| Rule::AtLeast(1));
        let placed = all_placed(model, warnings);
        let of_parts: Vec<_> = placed.iter().map(bounds).collect();
        let body = Body::new(model, &placed, limits.pairs)?;
        if body.faces.is_empty() {
            warnings.push(Warning::input("the model is empty"));
        }
        Ok(Kept {
            model: Arc::new(model.clone()),
            body,
            program,
            leaves,
            parts: model.parts.iter().filter(|part| !part.mesh.faces.is_empty()).count() as u64,
            colours: model.parts.iter().map(|part| part.color).collect(),
            bounds: Extents::new(&model.formula, &of_parts).of(model.area),
            pairs: limits.pairs,
        })
    }

    /// How many parts it has, without those that are empty.
    pub fn parts(&self) -> u64 {
        self.parts
    }

    /// Faces of all parts.
    pub fn faces(&self) -> u64 {
        self.body.faces.len() as u64
    }

    /// Least and greatest x, y, z of a box that it stays within; none if it is empty.
    pub fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        self.bounds
    }

    /// A view of it.
    pub(super) fn view(&self, setup: &Setup) -> View {
        let bounds = self.bounds.filter(|bounds| bounds.as_flattened().iter().all(|x| x.is_finite()));
        setup.view(bounds.map(|[least, most]| (least.into(), most.into())))
    }

    /// About how many bytes it holds.
    pub fn weight(&self) -> u64 {
        /// Of a part: counters with their links, colour, rank, matrix and place.
        const PART: usize = 256;
        /// Of a face of a mesh: its list of rings, a ring, and some corners.
        const FACE: usize = 96;
        let Body { points, lines, planes, edges, faces, .. } = &self.body;
        let geometry = size_of_val(&points[..])
            + lines.len() * size_of::<Line>()
            + planes.len() * size_of::<Plane>()
            + edges.len() * size_of::<Edge>()
            + faces.len() * size_of::<Face>();
        let meshes: usize = self.model.parts.iter().map(|part| size_of_val(&part.mesh.points[..]) + part.mesh.faces.len() * FACE).sum();
        (geometry + meshes + self.colours.len() * PART) as u64
    }
}
