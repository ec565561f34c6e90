//! What a job draws, plane shapes or a model in a view, behind one face: lines of runs, pulled from any line on.

use std::ops::Range;
use std::sync::Arc;

use crate::region::{self, Picture};
use crate::run::{Lines, Run};
use crate::solid::paint::Paint;
use crate::solid::stage::Stage;
use crate::solid::{rows, spans};

/// What is drawn, shared by all who draw it.
#[derive(Clone, Debug)]
pub enum Source {
    /// Plane shapes.
    Plane(Arc<Picture>),
    /// A model in a view, and how it is painted.
    Solid(Arc<Stage>, Arc<Paint>),
}

/// Its lines, pulled from top to bottom. Lines that follow each other may be equal.
pub enum Rows {
    /// Of plane shapes.
    Plane(Box<region::Rows>),
    /// Of a model.
    Solid(Box<rows::Rows>),
}

/// What lines have cost: of plane shapes, of models.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Counting along scanlines.
    pub rows: region::Cost,
    /// Counting along depth.
    pub spans: spans::Cost,
}

impl Cost {
    /// Adds what others have cost.
    pub fn add(&mut self, other: &Cost) {
        self.rows.add(&other.rows);
        self.spans.add(&other.spans);
    }
}

impl Source {
    /// Its lines.
    pub fn rows(&self, lines: Range<u32>) -> Rows {
        match self {
            Source::Plane(picture) => Rows::Plane(Box::new(region::Rows::new(picture.clone(), lines))),
            Source::Solid(stage, paint) => Rows::Solid(Box::new(rows::Rows::new(stage.clone(), paint.clone(), lines))),
        }
    }
}

impl Rows {
    /// The next line or lines; `None` behind the last.
    #[expect(clippy::should_implement_trait, reason = "the rows are lent, not given")]
    pub fn next(&mut self) -> Option<Lines<'_>> {
        match self {
            Rows::Plane(rows) => rows.next(),
            Rows::Solid(rows) => rows.next(),
        }
    }

    /// The runs of the line that was given last.
    pub fn runs(&self) -> &[Run] {
        match self {
            Rows::Plane(rows) => rows.runs(),
            Rows::Solid(rows) => rows.runs(),
        }
    }

    /// What the lines have cost so far.
    pub fn cost(&self) -> Cost {
        match self {
            Rows::Plane(rows) => Cost { rows: *rows.cost(), ..Cost::default() },
            Rows::Solid(rows) => Cost { spans: *rows.cost(), ..Cost::default() },
        }
    }

    /// About how many edges were stepped to the line that was given last.
    pub fn stepped(&self) -> usize {
        match self {
            Rows::Plane(rows) => rows.stepped(),
            Rows::Solid(rows) => rows.stepped(),
        }
    }
}
