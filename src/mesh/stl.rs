//! Binary STL: 80 bytes of anything, the number of triangles in 4 bytes, then 50 bytes each: a normal, three corners, two bytes; numbers are little-endian, 32 bits
//! wide.

use std::io::{self, Write};

use super::surface::Surface;
use super::{cross, length, minus};

/// Its name on the command line.
pub const NAME: &str = "stl";

/// File name extension that chooses it.
pub const EXTENSION: &str = "stl";

/// Media type.
pub const MEDIA_TYPE: &str = "model/stl";

/// One line for people.
pub const ABOUT: &str = "Surface of a model as triangles, binary STL; solid alone writes it";

/// Bytes that are written at once, about.
const PORTION: usize = 1 << 16;

/// What stands in front; it must not begin with `solid`, which is how texts begin.
const HEADER: &[u8; 80] = b"binary STL of runset; triangles are counterclockwise as seen from outside       ";

/// The corners of a triangle, rounded to 32 bits.
pub type Facet = [[f32; 3]; 3];

/// The triangles of a surface. Those of which two corners are one when rounded are left out: their other edges lie on each other, so the surface stays closed.
pub fn facets(surface: &Surface) -> Vec<Facet> {
    let corners = surface.triangles.iter().map(|triangle| triangle.corners.map(|i| surface.points[i as usize].map(|x| x as f32 + 0.0)));
    corners.filter(|[a, b, c]| a != b && b != c && c != a).collect()
}

/// Writes them, at most 2^32 - 1.
///
/// # Errors
/// What the writer says.
pub fn write(facets: &[Facet], out: &mut dyn Write) -> io::Result<()> {
    let mut bytes = HEADER.to_vec();
    bytes.extend(u32::try_from(facets.len()).map_err(io::Error::other)?.to_le_bytes());
    for facet in facets {
        let [a, b, c] = facet.map(|p| p.map(f64::from));
        let normal = cross(minus(b, a), minus(c, a));
        let long = length(normal);
        let unit = normal.map(|x| if long > 0.0 { (x / long) as f32 } else { 0.0 });
        bytes.extend(std::iter::once(&unit).chain(facet).flatten().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
        if bytes.len() >= PORTION {
            out.write_all(&bytes)?;
            bytes.clear();
        }
    }
    out.write_all(&bytes)?;
    out.flush()
}
