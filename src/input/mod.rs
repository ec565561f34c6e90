//! Readers of documents and of line streams. One file or folder a format; only the job calls them.

mod arc;
mod csg;
mod file;
mod fonts;
pub mod lines;
mod model;
mod path_data;
mod reading;
mod scan;
mod scene;
mod stl;
mod svg;

pub use fonts::Fonts;
pub use model::{ModelOptions, is_model, read_model, read_tree};
pub use reading::{Listed, Reading, Rendered};

use std::io::Read;

use crate::error::{Error, Kind, Result, Warning};
use crate::scene::{Limits, Scene};
use crate::shape::{Shape, Transform};

/// Reads a document with the built-in font alone: [`read_with`].
///
/// # Errors
/// Those of [`read_with`].
pub fn read(bytes: Vec<u8>, limits: &Limits, warnings: &mut Vec<Warning>) -> Result<Scene> {
    read_with(bytes, limits, &Fonts::default(), warnings)
}

/// Reads a document, whose kind is told by its first bytes: a JSON scene, an SVG, or either of them gzipped. Text is drawn with `fonts`.
///
/// # Errors
/// The document is not what it should be, or past a limit. `warnings` receives what is drawn but not supported.
pub fn read_with(bytes: Vec<u8>, limits: &Limits, fonts: &Fonts, warnings: &mut Vec<Warning>) -> Result<Scene> {
    let mut bytes = if bytes.starts_with(GZIP) { gunzip(&bytes, limits)? } else { bytes };
    if bytes.len() as u64 > limits.input {
        return Err(too_large(limits));
    }
    if bytes.starts_with(b"\xef\xbb\xbf") {
        bytes.drain(..3);
    }
    match bytes.trim_ascii_start() {
        [b'{', ..] => scene::read(&bytes, limits, warnings),
        // "<" with a zero byte beside it is UTF-16 without its mark.
        [0xfe, 0xff, ..] | [0xff, 0xfe, ..] | [b'<', 0, ..] | [0, b'<', ..] => {
            Err(Error::input(Kind::Malformed, "the document is UTF-16: save it as UTF-8"))
        }
        [b'<', ..] => svg::read(bytes, limits, fonts, warnings),
        start if start.starts_with(&lines::RLS) => {
            Err(Error::input(Kind::Malformed, "this is a line stream, not a drawing: read it with runset convert"))
        }
        start => {
            let found = if start.is_empty() { "the input is empty" } else { "neither a drawing nor a scene" };
            Err(Error::input(Kind::Malformed, format!("{found}: expected an SVG, which begins with <, or a JSON scene, with {{")))
        }
    }
}

/// How gzipped data begin.
const GZIP: &[u8] = b"\x1f\x8b";

fn gunzip(bytes: &[u8], limits: &Limits) -> Result<Vec<u8>> {
    let mut text = Vec::new();
    let mut within = flate2::bufread::MultiGzDecoder::new(bytes).take(limits.input.saturating_add(1));
    match within.read_to_end(&mut text) {
        _ if text.len() as u64 > limits.input => Err(too_large(limits)),
        Ok(_) => Ok(text),
        Err(e) => Err(Error::input(Kind::Malformed, format!("broken gzip data ({e}): is the file complete?"))),
    }
}

fn too_large(limits: &Limits) -> Error {
    let what = format!("the document is larger than {} bytes after decompression: raise --max-input", limits.input);
    Error::input(Kind::Limit, what)
}

/// Whether the shape's transform keeps all its points in the range of 64-bit numbers.
fn finite(shape: &Shape) -> bool {
    let [x, y] = shape.path.points().iter().fold([0.0_f64; 2], |[x, y], p| [x.max(p[0].abs()), y.max(p[1].abs())]);
    let row = |a: f64, b: f64, c: f64| (a.abs() * x + b.abs() * y + c.abs()).is_finite();
    match shape.transform {
        Transform::Affine([a, b, c, d, e, f]) => row(a, c, e) && row(b, d, f),
        Transform::Projective(m) => m.chunks(3).all(|r| row(r[0], r[1], r[2])),
    }
}
