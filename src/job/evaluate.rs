//! Models worked out: to a surface that is written, or in part, to meshes that are primitives again.
//!
//! The paper's hybrid of CSG and boundary model ("CSG" in ARCHITECTURE.md, section 4.5): what the engine shows are polyhedra, and what comes of a set operation is one
//! too. So a node of the tree that is seen from many sides, or that many others are cut with, can be worked out once.

use std::sync::Arc;

use crate::error::{Error, Kind, Result, Warning};
use crate::input::{Reading, Rendered};
use crate::mesh::boolean::surface;
use crate::mesh::{IDENTITY, Mesh, Model, Part, stl};
use crate::scene::Gate;

/// Puts meshes in the place of what a document wants worked out ([`Reading::rendered`]). The picture is the same but within a pixel of outlines, and where faces of several parts
/// coincide, which of them is shown; a face keeps the colour and the number of the part that it is a piece of. `warnings` receives what is wrong with the parts that are taken up.
///
/// # Errors
/// With its place: a node that cannot be worked out, or is past a limit of [`crate::mesh::boolean`].
pub fn evaluate(reading: &mut Reading, warnings: &mut Vec<Warning>) -> Result<()> {
    let Reading { model, rendered, .. } = reading;
    for &Rendered { area, place } in rendered.iter() {
        if matches!(model.formula.gates()[area.index()], Gate::Shape(_)) {
            continue;
        }
        let solid = surface(model, area, warnings).map_err(|error| if error.place.is_some() { error } else { error.at(place) })?;
        let index = u32::try_from(model.parts.len()).expect("statements are limited at the door");
        model.parts.push(Part { mesh: Arc::new(solid.mesh()), matrix: IDENTITY, color: None, kind: "render", place: Some(place) });
        model.formula.becomes(area, index);
    }
    // What is in none but those keeps its number and its colour.
    let uses = model.formula.uses(model.area);
    let mut needed = vec![false; model.parts.len()];
    for (gate, uses) in model.formula.gates().iter().zip(uses) {
        if let (Gate::Shape(part), 1..) = (gate, uses) {
            needed[*part as usize] = true;
        }
    }
    let empty = Arc::new(Mesh::default());
    model.parts.iter_mut().zip(needed).filter(|(_, needed)| !needed).for_each(|(part, _)| part.mesh = Arc::clone(&empty));
    Ok(())
}

/// The surface of a model, as an STL has it. `warnings` receives what is wrong with its parts.
///
/// # Errors
/// There is none, or it is past a limit of [`crate::mesh::boolean`].
pub fn stl(model: &Model, warnings: &mut Vec<Warning>) -> Result<Vec<stl::Facet>> {
    let facets = stl::facets(&surface(model, model.area, warnings)?);
    if facets.is_empty() {
        return Err(Error::input(Kind::Refused, "the model is empty: there is no surface to write"));
    }
    Ok(facets)
}
