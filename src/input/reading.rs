//! A model as a reader gives it: with the tree of its document.

use crate::error::Place;
use crate::mesh::Model;

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

/// A model with its document's tree.
#[derive(Clone, Debug)]
pub struct Reading {
    /// The model.
    pub model: Model,
    /// The statements that count, in document order. What is marked as background or disabled is not among them.
    pub tree: Vec<Listed>,
}
