//! STL, binary and text: triangles without more. Corners with the same coordinates, bit for bit, are one.
//!
//! Binary: 80 bytes of anything, the number of triangles in 4 bytes, then 50 bytes each: a normal, three corners, two bytes of anything; numbers
//! are little-endian. Text: `solid NAME`, `facet normal X Y Z`, `outer loop`, three times `vertex X Y Z`, `endloop`, `endfacet`, `endsolid`. Normals are
//! not read: the order of the corners says which side is outside.

use memchr::memchr;

use crate::error::{Error, Kind, Result};
use crate::mesh::build::Builder;
use crate::mesh::{FARTHEST, Mesh, Point};
use crate::scene::Limits;

const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// Whether the bytes are a binary STL: their number is that of the triangles that they promise. Some begin with `solid` all the same.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    count(bytes).is_some_and(|n| bytes.len() as u64 == HEADER as u64 + TRIANGLE as u64 * u64::from(n))
}

/// Whether the bytes begin as a text STL does, and nothing else that is read.
pub(super) fn begins(bytes: &[u8]) -> bool {
    name(bytes).is_some()
}

/// What follows the word `solid`.
fn name(bytes: &[u8]) -> Option<&[u8]> {
    bytes.trim_ascii_start().strip_prefix(b"solid").filter(|rest| rest.first().is_none_or(u8::is_ascii_whitespace))
}

/// Whether a facet or the end follows the name: a binary STL may begin with `solid` too.
fn is_text(bytes: &[u8]) -> bool {
    name(bytes).is_some_and(|rest| {
        let line = memchr(b'\n', rest).unwrap_or(rest.len());
        let next = rest[line..].trim_ascii_start();
        next.starts_with(b"facet") || next.starts_with(b"endsolid")
    })
}

fn count(bytes: &[u8]) -> Option<u32> {
    bytes.get(80..HEADER).map(|n| u32::from_le_bytes([n[0], n[1], n[2], n[3]]))
}

/// Reads an STL.
///
/// # Errors
/// With its line and column in a text, with the number of the triangle in binary data: what is not as it should be, more faces than the limit.
pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Mesh> {
    if is_binary(bytes) {
        binary(bytes, limits)
    } else if is_text(bytes) {
        Text { text: bytes, at: 0 }.mesh(limits)
    } else {
        let what = match count(bytes) {
            Some(n) => {
                format!(
                    "not an STL: no facet follows its name, and {} bytes are not those of {n} triangles; is the file complete?",
                    bytes.len()
                )
            }
            None => "not an STL: it is too short".to_owned(),
        };
        Err(Error::input(Kind::Malformed, what))
    }
}

fn too_many(limits: &Limits) -> Error {
    Error::input(Kind::Limit, format!("more than {} faces: use a coarser mesh", limits.faces))
}

fn binary(bytes: &[u8], limits: &Limits) -> Result<Mesh> {
    let triangles = bytes[HEADER..].chunks_exact(TRIANGLE);
    if triangles.len() as u64 > limits.faces {
        return Err(too_many(limits));
    }
    let mut mesh = Builder::with_capacity(triangles.len() / 2, triangles.len());
    for (i, triangle) in triangles.enumerate() {
        let number = |k: usize| f64::from(f32::from_le_bytes([triangle[k], triangle[k + 1], triangle[k + 2], triangle[k + 3]]));
        let corners: [Point; 3] = [12, 24, 36].map(|k| [number(k), number(k + 4), number(k + 8)]);
        if corners.iter().flatten().any(|x| x.is_nan() || x.abs() >= FARTHEST) {
            let what = format!("triangle {} has a coordinate that is not a number or past {FARTHEST:e}", i + 1);
            return Err(Error::input(Kind::Malformed, what));
        }
        let ring = corners.map(|p| mesh.point(p)).to_vec();
        mesh.face([ring]);
    }
    Ok(mesh.finish())
}

struct Text<'t> {
    text: &'t [u8],
    at: usize,
}

impl<'t> Text<'t> {
    fn mesh(mut self, limits: &Limits) -> Result<Mesh> {
        let mut mesh = Builder::default();
        let mut faces = 0;
        self.expect("solid")?;
        loop {
            // The name of the solid may be any words up to the end of its line.
            self.at += memchr(b'\n', &self.text[self.at..]).unwrap_or(self.text.len() - self.at);
            let ended = loop {
                let (word, at) = self.word();
                match word {
                    b"facet" => {}
                    b"endsolid" | b"" => break word,
                    _ => return Err(self.unexpected("facet or endsolid", at)),
                }
                faces += 1;
                if faces > limits.faces {
                    return Err(too_many(limits));
                }
                self.expect("normal")?;
                for _ in 0..3 {
                    self.word();
                }
                self.expect("outer")?;
                self.expect("loop")?;
                let mut ring = Vec::with_capacity(3);
                for _ in 0..3 {
                    self.expect("vertex")?;
                    let point = [self.number()?, self.number()?, self.number()?];
                    ring.push(mesh.point(point));
                }
                self.expect("endloop")?;
                self.expect("endfacet")?;
                mesh.face([ring]);
            };
            if ended.is_empty() {
                return Err(self.unexpected("endsolid: is the file complete?", self.text.len()));
            }
            // Several solids in one file are one mesh.
            self.at += memchr(b'\n', &self.text[self.at..]).unwrap_or(self.text.len() - self.at);
            match self.word() {
                (b"", _) => return Ok(mesh.finish()),
                (b"solid", _) => {}
                (_, at) => return Err(self.unexpected("the end or another solid", at)),
            }
        }
    }

    /// The next word and where it begins; empty at the end.
    fn word(&mut self) -> (&'t [u8], usize) {
        let rest = &self.text[self.at..];
        let start = rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
        let length = rest[start..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - start);
        let at = self.at + start;
        self.at = at + length;
        (&rest[start..start + length], at)
    }

    fn expect(&mut self, wanted: &str) -> Result<()> {
        let (word, at) = self.word();
        if word == wanted.as_bytes() { Ok(()) } else { Err(self.unexpected(wanted, at)) }
    }

    fn number(&mut self) -> Result<f64> {
        let (word, at) = self.word();
        let number = std::str::from_utf8(word).ok().and_then(|w| w.parse::<f64>().ok());
        number.filter(|x| x.abs() < FARTHEST).ok_or_else(|| self.unexpected("a finite number", at))
    }

    fn unexpected(&self, wanted: &str, at: usize) -> Error {
        Error::input(Kind::Malformed, format!("expected {wanted}")).at_byte(self.text, at)
    }
}
