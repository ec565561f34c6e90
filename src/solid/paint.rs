//! What is made once of a stage and its look, for all scanlines.

use std::sync::Arc;

use super::body::Body;
use super::look::Look;
use super::shade::{Colours, Scheme, light};
use super::smooth::Smooth;
use super::stage::Stage;
use crate::run::Rgb;

/// How a stage is painted.
#[derive(Clone, Debug)]
pub struct Paint {
    pub(super) colours: Colours,
    pub(super) paper: Rgb,
    pub(super) antialias: u32,
    pub(super) smooth: Option<Arc<Smooth>>,
    /// The least angle of feature edges, in degrees.
    pub(super) edges: Option<f64>,
    /// For every leaf of the program whether the faces of its part are glass; none if the list is empty.
    pub(super) glass: Arc<[bool]>,
}

impl Paint {
    /// Of a stage of `body`, whose parts have these colours, or none of their own. The stage's page is [`Look::antialias`] times as large as the picture, and
    /// if there is glass, by the leaves of its program, it counts without what is named ([`super::glass::without`]).
    pub fn new(stage: &Stage, body: &Body, parts: &[Option<Rgb>], scheme: &Scheme, look: &Look, glass: Arc<[bool]>) -> Paint {
        let smooth = |angle| Arc::new(Smooth::new(body, angle, stage.view, light(&stage.view)));
        Paint {
            colours: Colours::new(stage, parts, scheme),
            paper: scheme.background,
            antialias: look.antialias.max(1),
            smooth: look.smooth.map(smooth),
            edges: look.edges,
            glass,
        }
    }

    /// About how many bytes it holds.
    pub fn weight(&self) -> usize {
        self.colours.weight() + self.glass.len() + self.smooth.as_ref().map_or(0, |smooth| smooth.weight())
    }
}
