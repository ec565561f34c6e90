//! How much longer a raster takes than its bytes alone:
//!
//! ```text
//! cargo bench --bench encode -- [NAME ...] [--format pbm,png] [--scale 16] [--threads N] [--runs N]
//! ```
//!
//! *sweep* hands out all runs, in one thread. *copied* writes the raster to something that copies every byte and keeps none; *piped* to a
//! pipe that a thread empties. Their floors write as many bytes out of a prepared buffer of 64 KiB to the same, in the same run: what no
//! encoder can do without. Medians of N runs after one to warm up, wall time in milliseconds, and how many times its floor each is.

use std::io::{self, Read, Write};
use std::time::Instant;

use anyhow::{Context, Result};
use clap::Parser;
use runset::encode::{self, Format};
use runset::input;
use runset::job::{Job, Options, Size};
use runset::scene::Limits;

#[allow(dead_code, reason = "another benchmark lists them all")]
mod shapes;

/// Times encoders on the plane workloads.
#[derive(Parser)]
struct Arguments {
    /// Workloads.
    #[arg(default_value = "coast1e3")]
    names: Vec<String>,
    /// Formats.
    #[arg(long, value_delimiter = ',', default_value = "pbm,pgm,ppm,png,tiff,ndjson,rls", value_name = "F,...")]
    format: Vec<String>,
    /// Pixels to a user unit: the page is 4096 times as many pixels a side.
    #[arg(long, default_value_t = 16.0, value_name = "S")]
    scale: f64,
    /// Threads that render.
    #[arg(long, default_value_t = 1, value_name = "N")]
    threads: usize,
    /// How often each is timed.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..), value_name = "N")]
    runs: u32,
    /// Passed by `cargo bench`.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let workloads = shapes::named(&arguments.names).map_err(anyhow::Error::msg)?;
    let mut out = io::stdout().lock();
    writeln!(
        out,
        "{:9} {:>6} {:7} {:>9} {:>9} | {:>9} {:>9} {:>6} | {:>9} {:>9} {:>6}",
        "workload", "page", "format", "MB", "sweep", "copied", "floor", "times", "piped", "floor", "times"
    )?;
    for (name, make) in workloads {
        let mut json = Vec::new();
        make().write_json(&mut json)?;
        let scene = input::read(json, &Limits::default(), &mut Vec::new())?;
        let options = Options { size: Size::Scale(arguments.scale), ..Options::default() };
        let job = Job::prepare(scene, &options, &mut Vec::new())?;
        for format in &arguments.format {
            let format = encode::by_name(format).with_context(|| format!("no format {format}"))?;
            let row = measure(&job, format, &arguments)?;
            writeln!(out, "{name:9} {:6} {:7} {row}", job.header().width, format.name)?;
        }
    }
    Ok(())
}

/// Times one format and gives its part of the table.
fn measure(job: &Job, format: &Format, arguments: &Arguments) -> Result<String> {
    let render = |out: &mut dyn Write| job.render(format, arguments.threads, out, &mut |_| ()).map(|_| ());
    let mut size = Copied::new();
    render(&mut size)?;
    let size = size.bytes;
    let mut times = [(); 5].map(|()| Vec::new());
    for run in 0..=arguments.runs {
        let timed = [
            time(|| sweep(job)),
            time(|| Ok(render(&mut Copied::new())?)),
            time(|| floor(size, &mut Copied::new())),
            piped(|out| Ok(render(out)?))?,
            piped(|out| floor(size, out))?,
        ];
        for (times, timed) in times.iter_mut().zip(timed).filter(|_| run > 0) {
            times.push(timed);
        }
    }
    let [sweep, copied, copy_floor, piped, pipe_floor] = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    });
    Ok(format!(
        "{:9.1} {sweep:9.2} | {copied:9.2} {copy_floor:9.2} {:6.2} | {piped:9.2} {pipe_floor:9.2} {:6.2}",
        size as f64 / 1e6,
        copied / copy_floor,
        piped / pipe_floor
    ))
}

fn sweep(job: &Job) -> Result<()> {
    let (mut rows, mut runs) = (job.rows(), 0);
    while let Some(lines) = rows.next() {
        runs += lines.runs.len();
    }
    std::hint::black_box(runs);
    Ok(())
}

/// Bytes of the buffers on both sides.
const BUFFER: usize = 64 << 10;

/// Writes so many bytes out of one buffer.
fn floor(bytes: u64, out: &mut dyn Write) -> Result<()> {
    let buffer = vec![0x55; BUFFER];
    let mut left = bytes;
    while left > 0 {
        let part = left.min(BUFFER as u64);
        out.write_all(&buffer[..part as usize])?;
        left -= part;
    }
    Ok(())
}

/// Copies what is written into one buffer, again and again.
struct Copied {
    buffer: Vec<u8>,
    bytes: u64,
}

impl Copied {
    fn new() -> Copied {
        Copied { buffer: vec![0; BUFFER], bytes: 0 }
    }
}

impl Write for Copied {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for part in bytes.chunks(BUFFER) {
            self.buffer[..part.len()].copy_from_slice(part);
            std::hint::black_box(&mut self.buffer);
        }
        self.bytes += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Milliseconds.
fn time(work: impl FnOnce() -> Result<()>) -> f64 {
    let began = Instant::now();
    work().expect("memory takes all");
    began.elapsed().as_secs_f64() * 1e3
}

/// Milliseconds until the last byte has gone through a pipe.
fn piped(work: impl FnOnce(&mut dyn Write) -> Result<()>) -> Result<f64> {
    let (mut reader, mut writer) = io::pipe()?;
    std::thread::scope(|scope| {
        let reading = scope.spawn(move || {
            let mut buffer = vec![0; BUFFER];
            while reader.read(&mut buffer)? > 0 {}
            io::Result::Ok(())
        });
        let began = Instant::now();
        let worked = work(&mut writer);
        drop(writer);
        reading.join().expect("reading does not panic")?;
        worked?;
        Ok(began.elapsed().as_secs_f64() * 1e3)
    })
}
