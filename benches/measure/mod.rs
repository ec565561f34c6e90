//! What the benchmarks share: timing, our own engine on a workload, and the heading that says where and when.
//!
//! Times are processor time of the thread, in seconds: everything measured runs in one thread, and other programs on the machine
//! do not count.

use std::io::{self, Write};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use cpu_time::ThreadTime;
use runset::encode;
use runset::job::{Job, More, Options, Size};
use runset::scene::{Limits, Scene};

/// Times of one thing, sorted once they are all there.
#[derive(Clone, Debug, Default)]
pub struct Times(Vec<f64>);

impl Times {
    /// Runs `work` and keeps how long it took.
    pub fn time<R>(&mut self, work: impl FnOnce() -> R) -> R {
        let began = ThreadTime::now();
        let result = work();
        self.0.push(began.elapsed().as_secs_f64());
        result
    }

    /// Keeps a time that was taken elsewhere.
    pub fn push(&mut self, seconds: f64) {
        self.0.push(seconds);
    }

    /// The middle one of an odd number, the higher of the two in the middle otherwise; not a number if there are none.
    pub fn median(&self) -> f64 {
        let mut sorted = self.0.clone();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
    }

    /// The least; infinite if there are none.
    pub fn least(&self) -> f64 {
        self.0.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// All of them added.
    pub fn sum(&self) -> f64 {
        self.0.iter().sum()
    }
}

/// Milliseconds to three digits or two decimals.
pub fn ms(seconds: f64) -> String {
    let ms = seconds * 1e3;
    if ms.is_nan() {
        "-".to_owned()
    } else if ms < 100.0 {
        format!("{ms:.2}")
    } else {
        format!("{ms:.0}")
    }
}

/// A ratio to two digits.
pub fn ratio(ratio: f64) -> String {
    if ratio.is_nan() {
        "-".to_owned()
    } else if ratio < 10.0 {
        format!("{ratio:.1}")
    } else {
        format!("{ratio:.0}")
    }
}

/// Our engine on one scene: edges from shapes in memory, runs, packed bits.
#[derive(Debug)]
pub struct Ours {
    scene: Scene,
    options: Options,
    /// From shapes in memory to sorted edges.
    pub edges: Times,
    /// All runs, from edges.
    pub sweep: Times,
    /// Edges and sweep of one repetition together.
    pub whole: Times,
    /// A PBM that goes nowhere, from edges, the sweep included.
    pub packed: Times,
    /// Edges and packed bits of one repetition together.
    pub picture: Times,
    /// Runs swept the last time.
    pub runs: u64,
}

impl Ours {
    /// A scene at `scale` pixels to a unit.
    pub fn new(scene: Scene, scale: f64) -> Ours {
        // One thread: what others do is not seen by this one's clock.
        let limits = Limits { threads: 1, ..Limits::default() };
        let options = Options { size: Size::Scale(scale), limits, ..Options::default() };
        let times = Times::default;
        Ours { scene, options, edges: times(), sweep: times(), whole: times(), packed: times(), picture: times(), runs: 0 }
    }

    /// The edges.
    ///
    /// # Errors
    /// A scene that cannot be drawn.
    pub fn job(&self) -> Result<Job> {
        Ok(Job::prepare(self.scene.clone(), &self.options, &mut Vec::new())?)
    }

    /// Edges and runs once more.
    ///
    /// # Errors
    /// A scene that cannot be drawn.
    pub fn runs(&mut self) -> Result<Job> {
        let scene = self.scene.clone();
        let job = self.edges.time(|| Job::prepare(scene, &self.options, &mut Vec::new()))?;
        self.runs = self.sweep.time(|| {
            let mut rows = job.rows();
            let mut runs = 0;
            while let Some(lines) = rows.next() {
                runs += lines.runs.len() as u64 * u64::from(lines.n);
            }
            runs
        });
        let last = |times: &Times| *times.0.last().expect("one was just pushed");
        self.whole.push(last(&self.edges) + last(&self.sweep));
        Ok(job)
    }

    /// Edges, runs, and packed bits once more.
    ///
    /// # Errors
    /// A scene that cannot be drawn, or no lines at all.
    pub fn pictures(&mut self) -> Result<()> {
        let job = self.runs()?;
        let bytes = self.packed.time(|| packed(&job, |portion| io::sink().write_all(portion)))?;
        ensure!(bytes > 0, "nothing was written");
        let last = |times: &Times| *times.0.last().expect("one was just pushed");
        self.picture.push(last(&self.edges) + last(&self.packed));
        Ok(())
    }
}

/// Hands a job's PBM to `out` portion by portion, in this thread, and says how many bytes that were.
///
/// # Errors
/// Those of `out`.
pub fn packed(job: &Job, mut out: impl FnMut(&[u8]) -> io::Result<()>) -> Result<u64> {
    let mut stream = job.stream(encode::by_name("pbm").context("there is no format pbm")?);
    let (mut bytes, mut written) = (Vec::new(), 0);
    loop {
        let more = stream.next_band(&mut bytes);
        out(&bytes)?;
        written += bytes.len() as u64;
        bytes.clear();
        if more == More::End {
            return Ok(written);
        }
    }
}

/// The rows of a job's PBM without its head: one bit a pixel, the leftmost high, rows padded to bytes.
///
/// # Errors
/// None that a job which was prepared would have.
pub fn raster(job: &Job) -> Result<Vec<u8>> {
    let header = job.header();
    let size = (header.width as usize).div_ceil(8) * header.height() as usize;
    let mut pbm = Vec::with_capacity(size + 32);
    packed(job, |portion| pbm.write_all(portion))?;
    ensure!(pbm.len() > size, "a PBM of {} bytes is too short for {size} bytes of rows", pbm.len());
    Ok(pbm.split_off(pbm.len() - size))
}

/// Writes what a table of figures needs above it: the day, the commit, the machine, the compiler.
///
/// # Errors
/// Those of `out`.
pub fn heading(out: &mut impl Write) -> io::Result<()> {
    let said = |program: &str, arguments: &[&str]| {
        let output = Command::new(program).args(arguments).output().ok().filter(|output| output.status.success());
        output.map_or("unknown".to_owned(), |output| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let cpu =
        info.lines().find_map(|line| line.strip_prefix("model name")).map_or("unknown", |rest| rest.trim_start_matches([' ', '\t', ':']));
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZeroUsize::get);
    let date = said("date", &["-u", "+%-d %B %Y"]);
    let commit = said("git", &["describe", "--always", "--dirty"]);
    let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let load = load.split(' ').next().unwrap_or("unknown");
    writeln!(out, "{date}, commit {commit}, {}; {cpu}, {cores} cores, load {load}\n", said("rustc", &["--version"]))
}
