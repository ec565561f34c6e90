//! Writes the benchmarks' workloads as files, each as a JSON scene and as an SVG:
//!
//! ```text
//! cargo run --release --example plane -- OUTDIR [NAME ...]
//! ```
//!
//! Without names it writes all of them, some 180 MB.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::{Context, Result};

#[allow(dead_code, reason = "the benches fill them")]
#[path = "../benches/shapes/mod.rs"]
mod shapes;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().context("usage: plane OUTDIR [NAME ...]")?;
    let names: Vec<String> = arguments.collect();
    let workloads = shapes::named(&names).map_err(anyhow::Error::msg)?;
    let folder = Path::new(&folder);
    fs::create_dir_all(folder).with_context(|| format!("{}", folder.display()))?;
    for (name, make) in workloads {
        let shapes = make();
        write(&folder.join(format!("{name}.json")), |out| shapes.write_json(out))?;
        write(&folder.join(format!("{name}.svg")), |out| shapes.write_svg(out))?;
        eprintln!("{name}: {} vertices", shapes.vertices());
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
