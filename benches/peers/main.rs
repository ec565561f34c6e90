//! Our engine and others on the same shapes, in one run, in turn:
//!
//! ```text
//! cargo bench --bench peers -- [NAME ...] [--runs N]
//! ```
//!
//! It prints tables for docs/performance.md. *edges* is from shapes in memory to sorted edges, *sweep* hands out all runs from them; a boolean
//! of polygons is compared with the two together, since it starts from points in memory too. An *edge-line* is a scanline's centre crossed by an edge,
//! counted from the geometry alone. Ratios are of medians over repetitions that alternate.
//!
//! Every peer is tried first in a process of its own, with 30 s and 4 GB at most, where its picture is compared with ours. One that
//! takes more than 4 s there is not run again.
//!
//! `peers --svg FILE --with PEER --scale S` is a peer as a whole program, which reads an SVG and writes a PBM (`benches/processes.py`).

use std::io::{self, Write};

use anyhow::{Result, bail};
use clap::Parser;

mod floor;
#[allow(dead_code, reason = "other benches use the rest")]
#[path = "../measure/mod.rs"]
mod measure;
mod peer;
mod probe;
mod program;
#[allow(dead_code, reason = "an example writes them to files")]
#[path = "../shapes/mod.rs"]
mod shapes;
mod tables;

/// Times our engine and others on the plane workloads.
#[derive(Parser)]
struct Arguments {
    /// Workloads; all of them if none is named.
    names: Vec<String>,
    /// How often each is timed.
    #[arg(long, default_value_t = 7, value_parser = clap::value_parser!(u32).range(1..), value_name = "N")]
    runs: u32,
    /// Run one peer on one workload and compare its picture with ours.
    #[arg(long, hide = true, value_name = "PEER")]
    probe: Option<String>,
    /// Read a drawing, fill it with the peer of `--with`, write a PBM.
    #[arg(long, value_name = "FILE", requires = "with")]
    svg: Option<std::path::PathBuf>,
    /// The peer that fills; `usvg` only reads.
    #[arg(long, value_name = "PEER")]
    with: Option<String>,
    /// Pixels to a user unit, for `--svg`.
    #[arg(long, default_value_t = 1)]
    scale: u32,
    /// Passed by `cargo bench`.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let mut out = io::stdout().lock();
    if let (Some(svg), Some(with)) = (&arguments.svg, &arguments.with) {
        return program::run(svg, with, arguments.scale, &mut out);
    }
    let workloads = shapes::named(&arguments.names).map_err(anyhow::Error::msg)?;
    if let Some(peer) = &arguments.probe {
        let [(_, make)] = workloads[..] else { bail!("--probe takes one workload") };
        return probe::child(peer, &make(), arguments.scale, &mut out);
    }
    measure::heading(&mut out)?;
    let mut targets = Vec::new();
    tables::runs(&workloads, arguments.runs, &mut targets, &mut out)?;
    tables::pictures(&workloads, arguments.runs, &mut targets, &mut out)?;
    tables::pages(&workloads, arguments.runs, &mut targets, &mut out)?;
    tables::targets(&targets, &mut out)?;
    Ok(out.flush()?)
}
