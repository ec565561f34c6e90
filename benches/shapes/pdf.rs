//! The workloads as PDF, for programs that read nothing else: `a` in black, `b` in white over it, a point to a pixel.

use std::io::{self, Write};

use super::shapes::{SIDE, Shapes, pixels};

/// Writes a PDF of one page.
///
/// # Errors
/// Those of `out`.
pub fn write(shapes: &Shapes, out: &mut impl Write) -> io::Result<()> {
    let mut drawing = Vec::new();
    // PDF's y points up.
    writeln!(drawing, "1 0 0 -1 0 {SIDE} cm")?;
    let fill = if shapes.rule == "evenodd" { "f*" } else { "f" };
    for (grey, rings) in [0, 1].iter().zip(&shapes.layers) {
        writeln!(drawing, "{grey} g")?;
        for ring in rings {
            for (i, [x, y]) in ring.iter().map(|&vertex| pixels(vertex)).enumerate() {
                writeln!(drawing, "{x} {y} {}", if i == 0 { 'm' } else { 'l' })?;
            }
            writeln!(drawing, "h")?;
        }
        writeln!(drawing, "{fill}")?;
    }
    page([SIDE.into(); 2], &drawing, out)
}

/// Writes a PDF of one page, so many points wide and high.
///
/// # Errors
/// Those of `out`.
pub fn page([width, height]: [f64; 2], drawing: &[u8], out: &mut impl Write) -> io::Result<()> {
    let mut file = b"%PDF-1.4\n".to_vec();
    let page = format!("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {width} {height}] /Contents 4 0 R /Resources << >> >>");
    let mut places = Vec::new();
    for (number, object) in (1..).zip(["<< /Type /Catalog /Pages 2 0 R >>", "<< /Type /Pages /Kids [3 0 R] /Count 1 >>", &page]) {
        places.push(file.len());
        writeln!(file, "{number} 0 obj\n{object}\nendobj")?;
    }
    places.push(file.len());
    writeln!(file, "4 0 obj\n<< /Length {} >>\nstream", drawing.len())?;
    file.extend_from_slice(drawing);
    writeln!(file, "\nendstream\nendobj")?;
    let table = file.len();
    writeln!(file, "xref\n0 {}\n0000000000 65535 f ", places.len() + 1)?;
    places.iter().try_for_each(|place| writeln!(file, "{place:010} 00000 n "))?;
    writeln!(file, "trailer\n<< /Size {} /Root 1 0 R >>\nstartxref\n{table}\n%%EOF", places.len() + 1)?;
    out.write_all(&file)
}
