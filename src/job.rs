//! The whole pipeline in one place: bytes to scene, scene to rows, rows to bytes. (Skeleton: signatures only.)

use std::io::Write;
use std::ops::Range;

use crate::encode::Format;
use crate::error::{Result, Warning};
use crate::run::Header;
use crate::scene::{Limits, Scene};

/// How large the page becomes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Size {
    /// Pixels to a user unit.
    Scale(f64),
    /// Dots an inch; a user unit is 1/96 inch.
    Dpi(f64),
    /// Pixels. One alone keeps the aspect; with both the drawing is fitted inside and centred.
    Pixels {
        /// Width in pixels.
        width: Option<u32>,
        /// Height in pixels.
        height: Option<u32>,
    },
}

/// What is asked of a document.
#[derive(Clone, Debug)]
pub struct Options {
    /// An expression instead of the document's own picture.
    pub expr: Option<String>,
    /// Size of the page.
    pub size: Size,
    /// Only these scanlines.
    pub lines: Option<Range<u32>>,
    /// Curve flattening, in pixels, 0.001 to 16.
    pub tolerance: f64,
    /// Limits.
    pub limits: Limits,
}

/// What a run cost (contract: `--stats`). Times in seconds.
#[derive(Clone, Debug, Default, serde::Serialize)]
#[allow(missing_docs)]
pub struct Stats {
    pub width: u32,
    pub height: u32,
    pub edges: u64,
    pub lines: u32,
    pub lines_counted: u64,
    pub lines_repeated: u64,
    pub toggles: u64,
    pub runs: u64,
    pub peak_active: u64,
    pub prepare_seconds: f64,
    pub seconds: f64,
    pub first_line_seconds: f64,
    pub threads: usize,
}

/// A picture ready to be swept, from any line, by any number of threads.
pub struct Job {}

impl Job {
    /// Flattens and sorts what the picture needs.
    ///
    /// # Errors
    /// An expression that does not parse or names what is not there; a size out of bounds; a limit.
    pub fn prepare(_scene: Scene, _options: &Options, _warnings: &mut Vec<Warning>) -> Result<Job> {
        unimplemented!()
    }

    /// The raster's header.
    pub fn header(&self) -> &Header {
        unimplemented!()
    }

    /// Writes the whole raster with `threads` threads (at least 1). `progress` is called with the number of lines done so far, now and then.
    ///
    /// # Errors
    /// What the writer says; [`crate::error::Kind::Closed`] if its reader went away.
    pub fn render(&self, _format: &Format, _threads: usize, _out: &mut dyn Write, _progress: &mut dyn FnMut(u32)) -> Result<Stats> {
        unimplemented!()
    }
}

/// Reads a line stream (ndjson or rls, told by its first bytes) and writes it in another format.
///
/// # Errors
/// A broken stream, with its place; what the writer says.
pub fn convert(
    _input: &mut dyn std::io::BufRead,
    _format: &Format,
    _out: &mut dyn Write,
    _progress: &mut dyn FnMut(u32),
) -> Result<Header> {
    unimplemented!()
}

/// What `runset info` tells of a named area.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Entry {
    /// The id.
    pub id: String,
    /// One word for people.
    pub kind: &'static str,
    /// Depth in the tree of names.
    pub depth: u32,
    /// Left, top, right, bottom in user units; none if it paints nothing.
    pub bounds: Option<[f64; 4]>,
    /// Edges at scale 1.
    pub edges: u64,
}

/// What `runset info` tells of a document.
#[derive(Clone, Debug, serde::Serialize)]
#[allow(missing_docs)]
pub struct Info {
    pub width: f64,
    pub height: f64,
    pub ids: Vec<Entry>,
}

/// Bounds and edge counts of all named areas.
///
/// # Errors
/// A limit.
pub fn info(_scene: &Scene, _limits: &Limits) -> Result<Info> {
    unimplemented!()
}
