//! A sheet for a large printer, A0: 5,000 opaque shapes in black, closed outlines of eight curves each, all over the page.

use std::f64::consts::TAU;
use std::io::{self, Write};

use super::pdf;
use super::shapes::numpy::Rng;

/// The page in tenths of a millimetre, the unit of all coordinates.
const SIZE: [f64; 2] = [8410.0, 11890.0];

const SHAPES: usize = 5000;
const CURVES: usize = 8;

/// The outlines, each a start and curves of two control points and an end.
fn outlines() -> impl Iterator<Item = Vec<[f64; 2]>> {
    let mut rng = Rng::new(5000);
    (0..SHAPES).map(move |_| {
        let centre = SIZE.map(|side| side * rng.random());
        let radius = rng.uniform(20.0, 120.0);
        let points: Vec<[f64; 2]> = (0..CURVES)
            .map(|i| {
                let (angle, r) = (TAU * i as f64 / CURVES as f64, radius * rng.uniform(0.6, 1.0));
                [centre[0] + r * angle.cos(), centre[1] + r * angle.sin()]
            })
            .collect();
        let at = |i: usize| points[i % CURVES];
        // A smooth outline through the points: a sixth of the way between the neighbours of each is its handle.
        let handle = |i: usize, sign: f64| {
            let (before, point, behind) = (at(i + CURVES - 1), at(i), at(i + 1));
            [0, 1].map(|axis| point[axis] + sign * (behind[axis] - before[axis]) / 6.0)
        };
        std::iter::once(at(0)).chain((0..CURVES).flat_map(|i| [handle(i, 1.0), handle(i + 1, -1.0), at(i + 1)])).collect()
    })
}

/// Writes the sheet as SVG.
///
/// # Errors
/// Those of `out`.
pub fn write_svg(out: &mut impl Write) -> io::Result<()> {
    writeln!(out, r#"<svg xmlns="http://www.w3.org/2000/svg" width="841mm" height="1189mm" viewBox="0 0 {} {}">"#, SIZE[0], SIZE[1])?;
    for (number, outline) in outlines().enumerate() {
        write!(out, r#"<path id="shape{number}" d=""#)?;
        for (i, [x, y]) in outline.into_iter().enumerate() {
            let verb = ["M", "C", " "][i.min(1) + usize::from(i > 1 && i % 3 != 1)];
            write!(out, "{verb}{x:.3} {y:.3}")?;
        }
        writeln!(out, r#"Z"/>"#)?;
    }
    writeln!(out, "</svg>")
}

/// Writes the sheet as a PDF of one page.
///
/// # Errors
/// Those of `out`.
pub fn write_pdf(out: &mut impl Write) -> io::Result<()> {
    /// Points to a tenth of a millimetre.
    const POINTS: f64 = 72.0 / 254.0;
    let [width, height] = SIZE.map(|side| side * POINTS);
    let mut drawing = Vec::new();
    writeln!(drawing, "{POINTS:.9} 0 0 -{POINTS:.9} 0 {height:.6} cm 0 g")?;
    for outline in outlines() {
        for (i, [x, y]) in outline.into_iter().enumerate() {
            let verb = if i == 0 {
                " m\n"
            } else if i % 3 == 0 {
                " c\n"
            } else {
                " "
            };
            write!(drawing, "{x:.3} {y:.3}{verb}")?;
        }
        writeln!(drawing, "f")?;
    }
    pdf::page([width, height], &drawing, out)
}
