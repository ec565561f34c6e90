//! A detailed map on a sheet of A0: 1,500 areas of 400 vertices each with rough outlines, one over the other, in 24 inks.

use std::f64::consts::TAU;
use std::io::{self, Write};

use super::shapes::numpy::Rng;

/// Areas across and down.
const AREAS: [u32; 2] = [30, 50];

/// Vertices of an area.
const VERTICES: usize = 400;

/// Writes the map as SVG; its user unit is a tenth of a millimetre.
///
/// # Errors
/// Those of `out`.
pub fn write_svg(out: &mut impl Write) -> io::Result<()> {
    let mut rng = Rng::new(600_000);
    let size = [8410.0, 11890.0];
    writeln!(out, r#"<svg xmlns="http://www.w3.org/2000/svg" width="841mm" height="1189mm" viewBox="0 0 {} {}">"#, size[0], size[1])?;
    for area in 0..AREAS[0] * AREAS[1] {
        let cell = [area % AREAS[0], area / AREAS[0]];
        let centre = [0, 1].map(|axis| size[axis] * (f64::from(cell[axis]) + rng.random()) / f64::from(AREAS[axis]));
        let (radius, jag) = (rng.uniform(120.0, 220.0), rng.uniforms(-1.0, 1.0, VERTICES));
        let waves: Vec<(f64, f64)> = (2..20).map(|_| (rng.uniform(0.0, TAU), rng.uniform(0.3, 1.0))).collect();
        let ink = rng.integers(0, 24);
        write!(out, r##"<path id="area{area}" fill="#{:02x}{:02x}60" d=""##, 60 + ink % 6 * 30, 60 + ink / 6 * 50)?;
        for (i, jag) in jag.iter().enumerate() {
            let angle = TAU * i as f64 / VERTICES as f64;
            let wave: f64 = (2..).map(f64::from).zip(&waves).map(|(k, (phase, height))| (k * angle + phase).cos() * height / k).sum();
            let r = radius * (1.0 + 0.2 * wave) + jag * 2.0;
            write!(out, "{}{:.2} {:.2}", if i == 0 { 'M' } else { 'L' }, centre[0] + r * angle.cos(), centre[1] + r * angle.sin())?;
        }
        writeln!(out, r#"Z"/>"#)?;
    }
    writeln!(out, "</svg>")
}
