//! A peer as a whole program: an SVG read by usvg, `a - b` filled, a PBM written.

use std::fs;
use std::io::Write;
use std::path::Path;

use anyhow::{Context, Result, bail};
use usvg::tiny_skia_path::PathSegment;

use super::peer::{self, Input};
use super::shapes::SIDE;

/// Reads the drawing and writes `a - b` as the peer of that name fills it; `usvg` reads and writes nothing.
pub fn run(file: &Path, with: &str, scale: u32, out: &mut impl Write) -> Result<()> {
    let text = fs::read(file).with_context(|| format!("{}", file.display()))?;
    let tree = usvg::Tree::from_data(&text, &usvg::Options::default())?;
    drop(text);
    if with == "usvg" {
        return Ok(());
    }
    let mut evenodd = false;
    let mut layers = [Vec::new(), Vec::new()];
    for (rings, id) in layers.iter_mut().zip(["a", "b"]) {
        let Some(usvg::Node::Path(path)) = tree.node_by_id(id) else { bail!("no path \"{id}\"") };
        evenodd = path.fill().is_some_and(|fill| fill.rule() == usvg::FillRule::EvenOdd);
        for segment in path.data().segments() {
            match segment {
                PathSegment::MoveTo(p) => rings.push(vec![[p.x, p.y]]),
                PathSegment::LineTo(p) => rings.last_mut().context("a path begins with a move")?.push([p.x, p.y]),
                PathSegment::Close => {}
                _ => bail!("the workloads have straight edges"),
            }
        }
    }
    drop(tree);
    let mut peer = peer::by_name(with, &Input { evenodd, layers, scale }).with_context(|| format!("no peer \"{with}\""))?;
    peer.run();
    let side = SIDE * scale;
    write!(out, "P4\n{side} {side}\n")?;
    out.write_all(&peer::bits(peer.mask().with_context(|| format!("\"{with}\" makes no picture"))?, side as usize))?;
    Ok(out.flush()?)
}
