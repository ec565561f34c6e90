//! Sheets for a large printer, A0: 5,000 opaque shapes in black all over the page, closed outlines of 24 straight edges or of eight curves each.

use std::f64::consts::TAU;
use std::io::{self, Write};

use super::pdf;
use super::shapes::numpy::Rng;

/// The page in tenths of a millimetre, the unit of all coordinates.
const SIZE: [f64; 2] = [8410.0, 11890.0];

const SHAPES: usize = 5000;

/// The outlines: a start, and straight edges' ends; or a start, and curves' two control points and end.
fn outlines(curved: bool) -> impl Iterator<Item = Vec<[f64; 2]>> {
    let corners = if curved { 8 } else { 24 };
    let mut rng = Rng::new(5000);
    (0..SHAPES).map(move |_| {
        let centre = SIZE.map(|side| side * rng.random());
        let radius = rng.uniform(20.0, 120.0);
        let points: Vec<[f64; 2]> = (0..corners)
            .map(|i| {
                let (angle, r) = (TAU * i as f64 / corners as f64, radius * rng.uniform(0.6, 1.0));
                [centre[0] + r * angle.cos(), centre[1] + r * angle.sin()]
            })
            .collect();
        let at = |i: usize| points[i % corners];
        // A smooth outline through the points: a sixth of the way between the neighbours of each is its handle.
        let handle = |i: usize, sign: f64| {
            let (before, point, behind) = (at(i + corners - 1), at(i), at(i + 1));
            [0, 1].map(|axis| point[axis] + sign * (behind[axis] - before[axis]) / 6.0)
        };
        let curve = |i: usize| if curved { vec![handle(i, 1.0), handle(i + 1, -1.0), at(i + 1)] } else { vec![at(i + 1)] };
        std::iter::once(at(0)).chain((0..corners).flat_map(curve)).collect()
    })
}

/// Writes a sheet as SVG.
///
/// # Errors
/// Those of `out`.
pub fn write_svg(curved: bool, out: &mut impl Write) -> io::Result<()> {
    let [width, height] = SIZE;
    writeln!(out, r#"<svg xmlns="http://www.w3.org/2000/svg" width="841mm" height="1189mm" viewBox="0 0 {width} {height}">"#)?;
    for (number, outline) in outlines(curved).enumerate() {
        write!(out, r#"<path id="shape{number}" d="M"#)?;
        for (i, [x, y]) in outline.into_iter().enumerate() {
            let verb = match i {
                1 if curved => "C",
                1 => "L",
                _ => " ",
            };
            write!(out, "{verb}{x:.3} {y:.3}")?;
        }
        writeln!(out, r#"Z"/>"#)?;
    }
    writeln!(out, "</svg>")
}

/// Writes a sheet as a PDF of one page.
///
/// # Errors
/// Those of `out`.
pub fn write_pdf(curved: bool, out: &mut impl Write) -> io::Result<()> {
    /// Points to a tenth of a millimetre.
    const POINTS: f64 = 72.0 / 254.0;
    let [width, height] = SIZE.map(|side| side * POINTS);
    let mut drawing = Vec::new();
    writeln!(drawing, "{POINTS:.9} 0 0 -{POINTS:.9} 0 {height:.6} cm 0 g")?;
    for outline in outlines(curved) {
        for (i, [x, y]) in outline.into_iter().enumerate() {
            let verb = match i {
                0 => "m",
                _ if !curved => "l",
                _ if i.is_multiple_of(3) => "c",
                _ => "",
            };
            writeln!(drawing, "{x:.3} {y:.3} {verb}")?;
        }
        writeln!(drawing, "f")?;
    }
    pdf::page([width, height], &drawing, out)
}
