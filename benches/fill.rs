//! How long a fill takes, workload by workload:
//!
//! ```text
//! cargo bench --bench fill -- [NAME ...] [--scale 1,4,16] [--runs N] [--list]
//! ```
//!
//! *prepare* is from shapes in memory to sorted edges, *sweep* hands out all runs, *packed* makes a PBM of them that goes nowhere:
//! median and, in brackets, least milliseconds of N runs after one to warm up. Everything runs in one thread, so that wall time is
//! the work done. *lines counted*, *runs* and *peak active* are those of `--stats`.

use std::io::{self, Write};
use std::time::Instant;

use anyhow::{Context, Result};
use clap::Parser;
use runset::encode::{self, Format};
use runset::job::{Job, More, Options, Size};
use runset::scene::{Picture, Scene};
use runset::shape::{FillRule, Path, Shape};

#[allow(dead_code, reason = "an example writes them to files")]
mod shapes;

/// Times fills of the plane workloads.
#[derive(Parser)]
struct Arguments {
    /// Workloads; all of them if none is named.
    names: Vec<String>,
    /// Pixels to a user unit: the page is 4096 times as many pixels a side.
    #[arg(long, value_delimiter = ',', default_value = "1", value_name = "S,...")]
    scale: Vec<f64>,
    /// How often each is timed.
    #[arg(long, default_value_t = 7, value_parser = clap::value_parser!(u32).range(1..), value_name = "N")]
    runs: u32,
    /// List the workloads and stop.
    #[arg(long)]
    list: bool,
    /// Passed by `cargo bench`.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let workloads = shapes::named(&arguments.names).map_err(anyhow::Error::msg)?;
    let pbm = encode::by_name("pbm").context("there is no format pbm")?;
    let mut out = io::stdout().lock();
    if arguments.list {
        return Ok(workloads.iter().try_for_each(|(name, _)| writeln!(out, "{name}"))?);
    }
    writeln!(
        out,
        "{:9} {:>6} {:>8} {:>17} {:>17} {:>17} {:>13} {:>11} {:>11}",
        "workload", "page", "edges", "prepare ms", "sweep ms", "packed ms", "lines counted", "runs", "peak active"
    )?;
    for (name, make) in workloads {
        let scene = scene(&make());
        for &scale in &arguments.scale {
            measure(name, &scene, scale, arguments.runs, pbm, &mut out)?;
        }
    }
    Ok(())
}

/// Times one workload at one scale and writes its line of the table.
fn measure(name: &str, scene: &Scene, scale: f64, runs: u32, pbm: &Format, out: &mut impl Write) -> Result<()> {
    let options = Options { size: Size::Scale(scale), ..Options::default() };
    let job = Job::prepare(scene.clone(), &options, &mut Vec::new())?;
    let stats = job.render(pbm, 1, &mut io::sink(), &mut |_| ())?;
    let (mut prepare, mut sweep, mut packed) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..runs {
        let scene = scene.clone();
        let began = Instant::now();
        let job = Job::prepare(scene, &options, &mut Vec::new())?;
        prepare.push(began.elapsed());

        let began = Instant::now();
        let mut rows = job.rows();
        let mut swept = 0;
        while let Some(lines) = rows.next() {
            swept += lines.runs.len() as u64 * u64::from(lines.n);
        }
        sweep.push(began.elapsed());
        anyhow::ensure!(swept == stats.runs, "{name}: {swept} runs were swept and {} written", stats.runs);

        let began = Instant::now();
        let mut stream = job.stream(pbm);
        let mut bytes = Vec::new();
        while stream.next_band(&mut bytes) == More::More {
            io::sink().write_all(&bytes)?;
            bytes.clear();
        }
        packed.push(began.elapsed());
    }
    let [prepare, sweep, packed] = [prepare, sweep, packed].map(|mut times| {
        times.sort_unstable();
        let ms = |i: usize| times[i].as_secs_f64() * 1e3;
        format!("{:.2} ({:.2})", ms(times.len() / 2), ms(0))
    });
    let (width, edges, counted, active) = (stats.width, stats.edges, stats.lines_counted, stats.peak_active);
    writeln!(out, "{name:9} {width:6} {edges:8} {prepare:>17} {sweep:>17} {packed:>17} {counted:13} {:11} {active:11}", stats.runs)?;
    Ok(())
}

/// The workload as a scene.
fn scene(shapes: &shapes::Shapes) -> Scene {
    let side = f64::from(shapes::SIDE);
    let rule = if shapes.rule == "evenodd" { FillRule::EvenOdd } else { FillRule::NonZero };
    let mut scene = Scene::new(side, side);
    let [a, b] = ["a", "b"].map(|id| {
        let mut path = Path::default();
        for ring in &shapes.layers[usize::from(id == "b")] {
            path.ring(&ring.iter().map(|&p| shapes::pixels(p)).collect::<Vec<_>>());
        }
        scene.add_shape(Shape { rule, ..Shape::new(id, path) })
    });
    scene.picture = Picture::Region(scene.formula.without(a, &[b]));
    scene
}
