//! A model as a reader gives it: with the tree of its document.

use crate::error::Place;
use crate::mesh::Model;
use crate::scene::Area;

/// A statement of a model's document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Listed {
    /// Its module: `union`, `cube`.
    pub kind: &'static str,
    /// Where it begins.
    pub place: Option<Place>,
    /// How many statements it stands in.
    pub depth: u32,
    /// Which part of the model it is, if it is one.
    pub part: Option<u32>,
}

/// A part of a model that its document wants worked out to a surface: OpenSCAD's `render`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rendered {
    /// What it fills: an area of the model's formula.
    pub area: Area,
    /// Where the statement begins.
    pub place: Place,
}

/// A model with its document's tree.
#[derive(Clone, Debug)]
pub struct Reading {
    /// The model.
    pub model: Model,
    /// The statements that count, in document order. What is marked as background or disabled is not among them.
    pub tree: Vec<Listed>,
    /// What is to be worked out, inner statements before outer ones. Only who wants it does so: the picture is the same.
    pub rendered: Vec<Rendered>,
}
