//! The limits of what is taken in: everything that could grow without bound has a name here.

/// Limits, checked once, at the door.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of a document after decompression.
    pub input: u64,
    /// Edges after flattening.
    pub edges: u64,
    /// Shapes, names and operands of expressions together.
    pub nodes: u64,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits { input: 128 << 20, edges: 200_000_000, nodes: 16_000_000 }
    }
}
