//! The limits of what is taken in: everything that could grow without bound has a name here.

use std::num::NonZeroUsize;
use std::thread::available_parallelism;

/// Limits, checked once, at the door.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of a document after decompression.
    pub input: u64,
    /// Edges after flattening.
    pub edges: u64,
    /// Shapes, names and operands of expressions together.
    pub nodes: u64,
    /// Faces of a model, each part's own.
    pub faces: u64,
    /// Points, edges and faces of a model that are compared in pairs, to tell which are the same.
    pub pairs: u64,
    /// Sides of a circle of a model, slices of an extrusion.
    pub fragments: u32,
    /// Statements of a model inside each other.
    pub depth: u32,
    /// Threads at work at once; results do not depend on them.
    pub threads: usize,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits {
            input: 128 << 20,
            edges: 200_000_000,
            nodes: 16_000_000,
            faces: 4_000_000,
            pairs: 1 << 40,
            fragments: 100_000,
            depth: 100_000,
            threads: available_parallelism().map_or(1, NonZeroUsize::get),
        }
    }
}
