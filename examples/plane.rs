//! Writes the benchmarks' workloads as files, each as a JSON scene, as an SVG and as a PDF:
//!
//! ```text
//! cargo run --release --example plane -- OUTDIR [NAME ...]
//! ```
//!
//! Without names it writes all of them, some 270 MB; `map` is a drawing in many inks and an SVG only, `sheet` and `sheet-curves`
//! are SVGs and PDFs.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::{Context, Result};

#[path = "../benches/shapes/map.rs"]
mod map;
#[path = "../benches/shapes/pdf.rs"]
mod pdf;
#[allow(dead_code, reason = "the benches fill them")]
#[path = "../benches/shapes/mod.rs"]
mod shapes;
#[path = "../benches/shapes/sheet.rs"]
mod sheet;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().context("usage: plane OUTDIR [NAME ...]")?;
    let (others, names): (Vec<String>, Vec<String>) = arguments.partition(|name| ["map", "sheet", "sheet-curves"].contains(&&**name));
    let all = names.is_empty() && others.is_empty();
    let workloads = if names.is_empty() && !all { Vec::new() } else { shapes::named(&names).map_err(anyhow::Error::msg)? };
    let folder = Path::new(&folder);
    fs::create_dir_all(folder).with_context(|| format!("{}", folder.display()))?;
    for (name, make) in workloads {
        let shapes = make();
        write(&folder.join(format!("{name}.json")), |out| shapes.write_json(out))?;
        write(&folder.join(format!("{name}.svg")), |out| shapes.write_svg(out))?;
        write(&folder.join(format!("{name}.pdf")), |out| pdf::write(&shapes, out))?;
        eprintln!("{name}: {} vertices", shapes.vertices());
    }
    let wanted = |name: &str| all || others.iter().any(|other| other == name);
    if wanted("map") {
        write(&folder.join("map.svg"), map::write_svg)?;
    }
    for (name, curved) in [("sheet", false), ("sheet-curves", true)] {
        if wanted(name) {
            write(&folder.join(format!("{name}.svg")), |out| sheet::write_svg(curved, out))?;
            write(&folder.join(format!("{name}.pdf")), |out| sheet::write_pdf(curved, out))?;
        }
    }
    Ok(())
}

fn write(path: &Path, body: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>) -> Result<()> {
    let written = File::create(path).map(BufWriter::new).and_then(|mut out| {
        body(&mut out)?;
        out.flush()
    });
    written.with_context(|| format!("{}", path.display()))
}
