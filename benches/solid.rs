//! How long a view of a model takes, workload by workload:
//!
//! ```text
//! cargo bench --bench solid -- [NAME ...] [--size 512,2048] [--runs N] [--list]
//! ```
//!
//! *body* is from meshes in memory to points, lines and planes with identity, *stage* from there to sorted edges in a view, *spans* hands out all that is
//! seen: median milliseconds of processor time of N runs after one to warm up, in one thread; *all* is their sum, and *another view* that of the last two. The last
//! columns are counts of the walk: spans looked at and taken from the scanline above, counts along depth, crossings, and the largest number of active edges.

use std::io::{self, Write};
use std::sync::Arc;

use anyhow::{Context, Result};
use clap::Parser;
use runset::count::Rule;
use runset::mesh::Model;
use runset::mesh::check::all_placed;
use runset::scene::compile;
use runset::solid::body::Body;
use runset::solid::camera::{Camera, Setup};
use runset::solid::savings::Savings;
use runset::solid::spans::{Cost, Spans};
use runset::solid::stage::Stage;

use measure::{Times, ms};

#[allow(dead_code, reason = "other benches use the rest")]
mod measure;
#[allow(dead_code, reason = "tests use the rest")]
mod solids;

/// The workloads of the table in docs/performance.md.
const TABLE: &[&str] = &[
    "fig313/32/diff",
    "fig316/3",
    "fig47/32/8",
    "engine",
    "plate/1000",
    "menger/3",
    "menger/4",
    "fig47/10000/8",
    "blowup/50",
    "bigmesh/1000000",
];

/// Times views of the solid workloads.
#[derive(Parser)]
struct Arguments {
    /// Workloads; those of the table in docs/performance.md if none is named.
    names: Vec<String>,
    /// Pixels a side.
    #[arg(long, value_delimiter = ',', default_value = "512,2048", value_name = "N,...")]
    size: Vec<u32>,
    /// How often each is timed.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..), value_name = "N")]
    runs: u32,
    /// What is not to be saved: boxes, early, spans, hidden, lines.
    #[arg(long, value_delimiter = ',', value_name = "WHAT,...")]
    without: Vec<String>,
    /// List the workloads and stop.
    #[arg(long)]
    list: bool,
    /// Passed by `cargo bench`.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let mut out = io::stdout().lock();
    if arguments.list {
        return Ok(solids::names().iter().try_for_each(|name| writeln!(out, "{name}"))?);
    }
    let on = |name: &str| !arguments.without.iter().any(|other| other == name);
    let savings = Savings { boxes: on("boxes"), early: on("early"), spans: on("spans"), hidden: on("hidden"), lines: on("lines") };
    measure::heading(&mut out)?;
    writeln!(out, "| workload | page | faces | body | stage | spans | all | another view | spans | kept | counts | crossings | active |")?;
    writeln!(out, "|---|{}", "---:|".repeat(12))?;
    let names = if arguments.names.is_empty() { TABLE.iter().map(|&name| name.to_owned()).collect() } else { arguments.names };
    for name in names {
        let solid = solids::solid(&name).with_context(|| format!("there is no workload {name}; --list shows those there are"))?;
        for &size in &arguments.size {
            let [eye, target] = solid.camera;
            let camera = Camera::Vector([eye[0], eye[1], eye[2], target[0], target[1], target[2]]);
            let setup = Setup { camera: Some(camera), width: size, height: size, ..Setup::default() };
            line(&name, &solid.model, &setup, savings, arguments.runs, &mut out)?;
        }
    }
    Ok(())
}

/// Times one workload in one view and writes its line of the table.
fn line(name: &str, model: &Model, setup: &Setup, savings: Savings, runs: u32, out: &mut impl Write) -> Result<()> {
    let placed = all_placed(model, &mut Vec::new());
    let (program, leaves) = compile(&model.formula, model.parts.len(), &[model.area], |_| Rule::AtLeast(1));
    let mut times: [Times; 3] = Default::default();
    let (mut cost, mut faces) = (Cost::default(), 0);
    for run in 0..=runs {
        let mut warming: [Times; 3] = Default::default();
        let [bodies, stages, walks] = if run == 0 { &mut warming } else { &mut times };
        let body = bodies.time(|| Body::new(model, &placed, u64::MAX))?;
        let (view, program) = (setup.view(body.bounds), program.clone());
        let stage = Arc::new(stages.time(|| Stage::new(&body, program, &leaves, view, &[], savings)));
        faces = stage.faces.len();
        cost = walks.time(|| {
            let mut spans = Spans::new(stage, 0..setup.height, savings);
            while let Some(line) = spans.next() {
                std::hint::black_box(line);
            }
            *spans.cost()
        });
    }
    let [body, stage, spans] = times.each_ref().map(Times::median);
    let Cost { spans: looked, kept, counts, crossings, peak_active } = cost;
    let size = setup.width;
    let [body, stage, spans, all, view] = [body, stage, spans, body + stage + spans, stage + spans].map(ms);
    writeln!(
        out,
        "| {name} | {size} | {faces} | {body} | {stage} | {spans} | {all} | {view} | {looked} | {kept} | {counts} | {crossings} | {peak_active} |"
    )?;
    Ok(())
}
