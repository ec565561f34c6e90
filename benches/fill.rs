//! How long a fill takes, workload by workload:
//!
//! ```text
//! cargo bench --bench fill -- [NAME ...] [--scale 1,4,16] [--runs N] [--list]
//! ```
//!
//! *prepare* is from shapes in memory to sorted edges, *sweep* hands out all runs, *packed* makes a PBM of them that goes nowhere:
//! median and, in brackets, least milliseconds of processor time of N runs after one to warm up, in one thread. *lines counted*,
//! *runs* and *peak active* are those of `--stats`.

use std::io::{self, Write};

use anyhow::{Context, Result};
use clap::Parser;
use runset::encode::{self, Format};
use runset::scene::Scene;

use measure::Ours;

#[allow(dead_code, reason = "other benches use the rest")]
mod measure;
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
        let scene = make().scene();
        for &scale in &arguments.scale {
            line(name, &scene, scale, arguments.runs, pbm, &mut out)?;
        }
    }
    Ok(())
}

/// Times one workload at one scale and writes its line of the table.
fn line(name: &str, scene: &Scene, scale: f64, runs: u32, pbm: &Format, out: &mut impl Write) -> Result<()> {
    let mut ours = Ours::new(scene.clone(), scale);
    let stats = ours.job()?.render(pbm, 1, &mut io::sink(), &mut |_| ())?;
    for _ in 0..runs {
        ours.pictures()?;
        anyhow::ensure!(ours.runs == stats.runs, "{name}: {} runs were swept and {} written", ours.runs, stats.runs);
    }
    let [edges, sweep, packed] =
        [&ours.edges, &ours.sweep, &ours.packed].map(|times| format!("{} ({})", measure::ms(times.median()), measure::ms(times.least())));
    let (width, count, counted, active) = (stats.width, stats.edges, stats.lines_counted, stats.peak_active);
    writeln!(out, "{name:9} {width:6} {count:8} {edges:>17} {sweep:>17} {packed:>17} {counted:13} {:11} {active:11}", stats.runs)?;
    Ok(())
}
