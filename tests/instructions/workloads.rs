//! Small workloads whose instructions `run` counts under callgrind, against `counts.txt`:
//!
//! | name | what |
//! |---|---|
//! | coast | two outlines of 1,000 edges, a - b, to runs, 8192 pixels a side |
//! | tangle | two stars of 1,000 edges that cross 10^5 times, a - b, to runs, 1024 a side |
//! | pbm, rls | 300 polygons in six inks, one over the other, to that format, 2048 a side |
//!
//! What is counted is [`counted`] and all below it: from shapes in memory to runs or bytes, in one thread. The workloads
//! are named on the command line.

use std::error::Error;

use runset::encode::{self, Format};
use runset::job::{Job, More, Options, Size};
use runset::scene::{Layer, Limits, Picture, Scene};
use runset::shape::{Path, Shape};

#[allow(dead_code, reason = "other benches use the rest")]
#[path = "../../benches/shapes/mod.rs"]
mod shapes;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// The workloads.
const NAMES: [&str; 4] = ["coast", "tangle", "pbm", "rls"];

fn main() -> Result<()> {
    for name in std::env::args().skip(1) {
        let (scene, scale, format) = match name.as_str() {
            "coast" => (plane("coast1e3")?, 2.0, None),
            "tangle" => (plane("spiky1e3")?, 0.25, None),
            "pbm" | "rls" => (layers()?, 0.5, encode::by_name(&name)),
            _ => return Err(format!("no workload \"{name}\"; there are {}", NAMES.join(", ")).into()),
        };
        // One thread: what others do is not seen by this one's clock.
        let limits = Limits { threads: 1, ..Limits::default() };
        let options = Options { size: Size::Scale(scale), limits, ..Options::default() };
        let mut made = 0;
        let mut scene = Some(scene);
        counted(&mut || made = scene.take().map_or(Ok(0), |scene| make(scene, &options, format)).unwrap_or(0));
        if made == 0 {
            return Err(format!("{name}: nothing came out").into());
        }
    }
    Ok(())
}

/// The function whose instructions are counted.
#[inline(never)]
fn counted(work: &mut dyn FnMut()) {
    work();
}

/// Bytes in the format, or else runs.
fn make(scene: Scene, options: &Options, format: Option<&Format>) -> Result<usize> {
    let job = Job::prepare(scene, options, &mut Vec::new())?;
    let mut made = 0;
    if let Some(format) = format {
        let mut stream = job.stream(format);
        let mut bytes = Vec::new();
        while stream.next_band(&mut bytes) == More::More {
            made += bytes.len();
            bytes.clear();
        }
    } else {
        let mut rows = job.rows();
        while let Some(lines) = rows.next() {
            made += lines.runs.len();
        }
    }
    Ok(made)
}

/// A plane workload, as it is filled everywhere.
fn plane(name: &str) -> Result<Scene> {
    Ok(shapes(name)?.scene())
}

fn shapes(name: &str) -> Result<shapes::Shapes> {
    Ok(shapes::named(&[name.to_owned()])?[0].1())
}

/// Polygons in turn in six inks.
fn layers() -> Result<Scene> {
    let polygons = shapes("kway1000")?;
    let side = f64::from(shapes::SIDE);
    let mut scene = Scene::new(side, side);
    let mut layers = Vec::new();
    for (i, ring) in polygons.layers[0].iter().take(300).enumerate() {
        let mut path = Path::default();
        // Drawn together about the middle of the page, so that they overlap.
        path.ring(&ring.iter().map(|&p| shapes::pixels(p).map(|v| side / 2.0 + (v - side / 2.0) * 0.6)).collect::<Vec<_>>());
        let area = scene.add_shape(Shape::new(format!("{i}"), path));
        layers.push(Layer { area, ink: [40 * (i % 6) as u8, 90, 200] });
    }
    scene.picture = Picture::Layers(layers);
    Ok(scene)
}
