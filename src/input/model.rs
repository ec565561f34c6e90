//! Models of solids: which reader a document needs, and what is told of its tree.

use std::path::PathBuf;

use super::reading::{Listed, Reading};
use super::{GZIP, csg, gunzip, stl};
use crate::error::{Error, Kind, Result, Warning};
use crate::mesh::{IDENTITY, Model, Part};
use crate::scene::{Formula, Limits};

/// How a model is read.
#[derive(Clone, Debug, Default)]
pub struct ModelOptions {
    /// Limits.
    pub limits: Limits,
    /// Where files are that the document imports; without it, imports are left out with a warning that says [`Warning::outside`].
    pub folder: Option<PathBuf>,
}

/// Whether a document is a model's, by how it begins: an STL, a statement of a `.csg`, as in `cube(`, or a comment.
pub fn is_model(bytes: &[u8]) -> bool {
    let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let statement = || {
        let marks = start.iter().take_while(|b| b"!#%*".contains(b)).count();
        let name = start[marks..].iter().take_while(|b| b.is_ascii_alphanumeric() || **b == b'_').count();
        name > 0 && start[marks + name..].trim_ascii_start().starts_with(b"(")
    };
    stl::is_binary(bytes) || stl::begins(bytes) || start.starts_with(b"//") || start.starts_with(b"/*") || statement()
}

/// Reads a model: [`read_tree`] without the tree.
///
/// # Errors
/// Those of [`read_tree`].
pub fn read_model(bytes: &[u8], options: &ModelOptions, warnings: &mut Vec<Warning>) -> Result<Model> {
    read_tree(bytes, options, warnings).map(|reading| reading.model)
}

/// Reads a model, whose kind is told by its bytes: an STL, binary or text, which is one part, or an OpenSCAD `.csg`; either of them may be gzipped.
///
/// # Errors
/// With its place where there is one: the document is not what it should be, or past a limit. `warnings` receives what is left out or ignored.
pub fn read_tree(bytes: &[u8], options: &ModelOptions, warnings: &mut Vec<Warning>) -> Result<Reading> {
    let limits = &options.limits;
    let unpacked = if bytes.starts_with(GZIP) && !stl::is_binary(bytes) { Some(gunzip(bytes, limits)?) } else { None };
    let bytes = unpacked.as_deref().unwrap_or(bytes);
    if bytes.len() as u64 > limits.input {
        return Err(Error::input(Kind::Limit, format!("the model is larger than {} bytes: raise --max-input", limits.input)));
    }
    if stl::is_binary(bytes) || stl::begins(bytes) {
        let mesh = stl::read(bytes, limits)?;
        let mut formula = Formula::default();
        let area = formula.shape(0);
        let place = None;
        let part = Part { mesh: mesh.into(), matrix: IDENTITY, color: None, kind: "mesh", place };
        let tree = vec![Listed { kind: "mesh", place, depth: 0, part: Some(0) }];
        return Ok(Reading { model: Model { parts: vec![part], formula, area }, tree, rendered: Vec::new() });
    }
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    match text.trim_ascii_start() {
        [] => Err(Error::input(Kind::Malformed, "the input is empty: expected an OpenSCAD .csg or an STL")),
        [b'{' | b'<', ..] => Err(Error::input(Kind::Malformed, "this is a drawing, not a model: expected an OpenSCAD .csg or an STL")),
        _ => csg::read(text, limits, options.folder.as_deref(), warnings),
    }
}
