//! What a document says: shapes, names for areas built from them, and the picture they make.
//!
//! Readers of documents build a [`Scene`]; the job turns the part of it that a picture needs into edges and a counting
//! program. A scene holds no pixels and knows no resolution: its unit is the user unit, one pixel at scale 1.

mod compile;
mod expression;
mod formula;
mod limits;
mod nearest;
mod resolve;
mod token;

pub use compile::compile;
pub use expression::Expression;
pub use formula::{Area, Formula, Gate, Input};
pub use limits::Limits;
pub(crate) use token::quoted;

use foldhash::HashMap;

use crate::error::{Result, Warning};
use crate::run::Rgb;
use crate::shape::Shape;

/// Names that are built in; in double quotes they are ids like any other.
pub const BUILT_IN: [&str; 2] = ["page", "art"];

/// An area that has a name.
#[derive(Clone, Debug)]
pub struct Named {
    /// The id as written in the document.
    pub id: String,
    /// What it is, in one word for people: `path`, `rect`, `group`, `shape`.
    pub kind: &'static str,
    /// The area.
    pub area: Area,
    /// The shapes that it is made of directly or through its children, for edge counts; what it is cut to is not among them.
    pub shapes: Vec<std::ops::Range<u32>>,
    /// The ink that paints it; none if there is none, or several.
    pub ink: Option<Rgb>,
    /// How deep it stands in the tree of names, from 0.
    pub depth: u32,
}

/// An area painted with an ink.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layer {
    /// Where.
    pub area: Area,
    /// With what.
    pub ink: Rgb,
}

/// What is drawn when no expression is given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Picture {
    /// One region, black on white.
    Region(Area),
    /// Layers in painting order, the last on top.
    Layers(Vec<Layer>),
}

/// A document, read.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Width of the page in user units, positive.
    pub width: f64,
    /// Height of the page in user units, positive.
    pub height: f64,
    /// The shapes, in document order. [`Formula`] refers to them by index.
    pub shapes: Vec<Shape>,
    /// Areas over the shapes.
    pub formula: Formula,
    /// Everything painted: the built-in name `art`.
    pub art: Area,
    /// What is drawn when no expression is given.
    pub picture: Picture,
    names: Vec<Named>,
    index: HashMap<String, u32>,
}

impl Scene {
    /// An empty scene with a page of `width` x `height` user units.
    pub fn new(width: f64, height: f64) -> Scene {
        let mut formula = Formula::default();
        let nothing = formula.any(&[]);
        Scene {
            width,
            height,
            shapes: Vec::new(),
            formula,
            art: nothing,
            picture: Picture::Region(nothing),
            names: Vec::new(),
            index: HashMap::default(),
        }
    }

    /// Adds a shape and gives its area.
    pub fn add_shape(&mut self, shape: Shape) -> Area {
        let index = u32::try_from(self.shapes.len()).expect("a scene holds less than 2^32 shapes: limited at the door");
        self.shapes.push(shape);
        self.formula.shape(index)
    }

    /// Gives an area a name. False, and nothing changes, if the name is taken.
    pub fn add_name(&mut self, named: Named) -> bool {
        if self.index.contains_key(&named.id) {
            return false;
        }
        self.index.insert(named.id.clone(), u32::try_from(self.names.len()).expect("as many names as shapes"));
        self.names.push(named);
        true
    }

    /// The area of that id, if the document has it. Built-in names are not looked at.
    pub fn named(&self, id: &str) -> Option<&Named> {
        self.position(id).map(|i| &self.names[i])
    }

    /// Where that id stands among [`Scene::names`].
    pub(crate) fn position(&self, id: &str) -> Option<usize> {
        self.index.get(id).map(|&i| i as usize)
    }

    /// All named areas, in document order.
    pub fn names(&self) -> &[Named] {
        &self.names
    }

    /// Whether the area of that id paints nothing: no shape, or only shapes without an outline.
    pub fn is_empty(&self, id: &str) -> bool {
        let shapes = self.named(id).into_iter().flat_map(|n| n.shapes.iter().cloned().flatten());
        shapes.into_iter().all(|i| self.shapes[i as usize].path.verbs().is_empty())
    }

    /// The area that an expression describes; new gates are added to the formula.
    ///
    /// # Errors
    /// An unknown name, with its place and the nearest known names. `warnings` receives what else is worth saying.
    pub fn resolve(&mut self, expression: &Expression, warnings: &mut Vec<Warning>) -> Result<Area> {
        resolve::resolve(self, expression, warnings)
    }
}
