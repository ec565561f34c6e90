//! What a model holds: its tree with primitives, faces and bounds.

use super::extents::Extents;
use crate::bounds::{Bounds, join};
use crate::error::Warning;
use crate::input::Reading;
use crate::mesh::check::{Placed, all_placed};

/// What `runset info` tells of a statement of a model.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ModelEntry {
    /// The module: `difference`, `cube`.
    pub kind: &'static str,
    /// Line in the document, from 1; none in an STL.
    pub line: Option<u32>,
    /// Column in characters, from 1.
    pub column: Option<u32>,
    /// How many statements it stands in.
    pub depth: u32,
    /// Which primitive it is, from 1 in document order, if it is one.
    pub primitive: Option<u32>,
    /// Faces of the primitive.
    pub faces: Option<u64>,
    /// Least and greatest x, y, z of the primitive.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Its colour as `#rrggbb`, if it has one.
    pub color: Option<String>,
}

/// What `runset info` tells of a model.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ModelInfo {
    /// Primitives that are parts of the model.
    pub primitives: u64,
    /// Their faces.
    pub faces: u64,
    /// A box that the model stays within; none if it is empty.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// The statements, in document order.
    pub tree: Vec<ModelEntry>,
}

/// The tree of a model with faces, bounds and colours. `warnings` receives what is wrong with the meshes.
pub fn model_info(reading: &Reading, warnings: &mut Vec<Warning>) -> ModelInfo {
    let model = &reading.model;
    let placed = all_placed(model, warnings);
    let bounds: Vec<Bounds<3>> = placed.iter().map(bounds).collect();
    let faces = |part: usize| placed[part].mesh.faces.len() as u64;
    let entry = |listed: &crate::input::Listed| {
        let part = listed.part.map(|part| part as usize);
        ModelEntry {
            kind: listed.kind,
            line: listed.place.map(|place| place.line),
            column: listed.place.map(|place| place.column),
            depth: listed.depth,
            primitive: listed.part.map(|part| part + 1),
            faces: part.map(faces),
            bounds: part.and_then(|part| bounds[part]),
            color: part.and_then(|part| model.parts[part].color).map(|[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}")),
        }
    };
    ModelInfo {
        primitives: model.parts.len() as u64,
        faces: (0..placed.len()).map(faces).sum(),
        bounds: Extents::new(&model.formula, &bounds).of(model.area),
        tree: reading.tree.iter().map(entry).collect(),
    }
}

/// The box of a part.
pub(super) fn bounds(placed: &Placed) -> Bounds<3> {
    let used = placed.mesh.faces.iter().flat_map(|face| &face.rings).flatten();
    used.fold(None, |all, &i| join(all, Some([placed.mesh.points[i as usize]; 2])))
}
