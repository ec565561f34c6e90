//! Small workloads whose instructions `run` counts under callgrind, against `counts.txt`:
//!
//! | name | what |
//! |---|---|
//! | coast | two outlines of 1,000 edges, a - b, to runs, 8192 pixels a side |
//! | tangle | two stars of 1,000 edges that cross 10^5 times, a - b, to runs, 1024 a side |
//! | pbm, rls | 300 polygons in six inks, one over the other, to that format, 2048 a side |
//! | ring, plate | nine prisms of 32 sides, eight of them without the ninth; a plate with 100 holes: from meshes to runs, 512 a side |
//!
//! What is counted is [`counted`] and all below it: from shapes or meshes in memory to runs or bytes, in one thread. The workloads
//! are named on the command line.

use std::error::Error;

use runset::encode::{self, Format};
use runset::job::{Job, Kept, More, Options, Size, SolidOptions};
use runset::mesh::Model;
use runset::scene::{Layer, Limits, Picture, Scene};
use runset::shape::{Path, Shape};
use runset::solid::camera::{Camera, Setup};

#[allow(dead_code, reason = "other benches use the rest")]
#[path = "../../benches/shapes/mod.rs"]
mod shapes;
#[allow(dead_code, reason = "other benches use the rest")]
#[path = "../../benches/solids/mod.rs"]
mod solids;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// The workloads.
const NAMES: [&str; 6] = ["coast", "tangle", "pbm", "rls", "ring", "plate"];

/// What is drawn.
enum Drawn {
    Plane(Scene, f64),
    Solid(Model, Camera),
}

fn main() -> Result<()> {
    for name in std::env::args().skip(1) {
        let (drawn, format) = match name.as_str() {
            "coast" => (Drawn::Plane(plane("coast1e3")?, 2.0), None),
            "tangle" => (Drawn::Plane(plane("spiky1e3")?, 0.25), None),
            "pbm" | "rls" => (Drawn::Plane(layers()?, 0.5), encode::by_name(&name)),
            "ring" => (solid("fig47/32/8")?, None),
            "plate" => (solid("plate/100")?, None),
            _ => return Err(format!("no workload \"{name}\"; there are {}", NAMES.join(", ")).into()),
        };
        let mut made = 0;
        let mut drawn = Some(drawn);
        counted(&mut || made = drawn.take().map_or(Ok(0), |drawn| make(drawn, format)).unwrap_or(0));
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
fn make(drawn: Drawn, format: Option<&Format>) -> Result<usize> {
    // One thread: what others do is not seen by this one's clock.
    let limits = Limits { threads: 1, ..Limits::default() };
    let job = match drawn {
        Drawn::Plane(scene, scale) => {
            Job::prepare(scene, &Options { size: Size::Scale(scale), limits, ..Options::default() }, &mut Vec::new())?
        }
        Drawn::Solid(model, camera) => {
            let setup = Setup { camera: Some(camera), ..Setup::default() };
            Job::solid(&Kept::new(&model, &limits, &mut Vec::new())?, &SolidOptions { setup, ..SolidOptions::default() })?
        }
    };
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

/// A solid workload, as it is seen everywhere.
fn solid(name: &str) -> Result<Drawn> {
    let solid = solids::solid(name).ok_or("no such workload")?;
    let [eye, target] = solid.camera;
    Ok(Drawn::Solid(solid.model, Camera::Vector([eye[0], eye[1], eye[2], target[0], target[1], target[2]])))
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
