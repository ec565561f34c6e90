//! A peer on its own: in a process with limits, once, its picture compared with ours.

use std::io::{Read, Write};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result};

use super::measure::{self, Ours, Times};
use super::peer::{self, Input, Peer};
use super::shapes::{self, SIDE, Shapes};

/// A peer that takes longer counts as not finishing.
pub const SECONDS: f64 = 30.0;

const TOO_LONG: &str = "takes more than 30 s";

/// What making the shapes and comparing pictures may take besides.
const BESIDES: f64 = 30.0;

/// Address space of a peer, in KiB: a peer that wants more counts as not finishing.
const MEMORY: u32 = 4 << 20;

/// What a peer did when it was tried.
#[derive(Clone, Copy, Debug)]
pub struct Probed {
    /// How long it took, in seconds.
    pub seconds: f64,
    /// Pixels that differ from ours.
    pub differ: u64,
}

impl Shapes {
    /// The shapes as a peer takes them.
    pub fn input(&self, scale: u32) -> Input {
        let pixels = |&vertex: &[i32; 2]| shapes::pixels(vertex).map(|v| v as f32);
        let layers = [0, 1].map(|layer: usize| self.layers[layer].iter().map(|ring| ring.iter().map(pixels).collect()).collect());
        Input { evenodd: self.rule == "evenodd", layers, scale }
    }
}

/// Tries a peer in a process of its own; an error that says at which limit it stopped, if it did.
pub fn probe(peer: &str, workload: &str, scale: u32) -> Result<Result<Probed, &'static str>> {
    let program = std::env::current_exe()?;
    let mut child = Command::new("sh")
        .args(["-c", &format!("ulimit -v {MEMORY}; exec \"$0\" \"$@\"")])
        .arg(program)
        .args([workload, "--probe", peer, "--scale", &scale.to_string()])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()?;
    let began = Instant::now();
    while child.try_wait()?.is_none() {
        if began.elapsed().as_secs_f64() > SECONDS + BESIDES {
            child.kill()?;
            child.wait()?;
            return Ok(Err(TOO_LONG));
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    if !child.wait()?.success() {
        return Ok(Err("stops at 4 GB"));
    }
    let mut said = String::new();
    child.stdout.take().context("it was piped")?.read_to_string(&mut said)?;
    let (seconds, differ) = said.trim().split_once(' ').context("a probe says two numbers")?;
    let probed = Probed { seconds: seconds.parse()?, differ: differ.parse()? };
    Ok(if probed.seconds <= SECONDS { Ok(probed) } else { Err(TOO_LONG) })
}

/// What the process of a probe does.
pub fn child(name: &str, shapes: &Shapes, scale: u32, out: &mut impl Write) -> Result<()> {
    let mut peer = peer::by_name(name, &shapes.input(scale)).with_context(|| format!("no peer \"{name}\""))?;
    let mut times = Times::default();
    times.time(|| peer.run());
    let theirs = picture(&*peer, scale)?;
    drop(peer);
    let ours = measure::raster(&Ours::new(shapes.scene(), f64::from(scale)).job()?)?;
    let differ = ours.iter().zip(&theirs).map(|(a, b)| u64::from((a ^ b).count_ones())).sum::<u64>();
    writeln!(out, "{} {differ}", times.median())?;
    Ok(())
}

/// A peer's picture as rows of bits. Polygons are filled by our engine, so that what differs is the polygons.
fn picture(peer: &dyn Peer, scale: u32) -> Result<Vec<u8>> {
    match (peer.mask(), peer.scene()) {
        (Some(mask), _) => Ok(peer::bits(mask, (SIDE * scale) as usize)),
        (None, Some(scene)) => measure::raster(&Ours::new(scene, f64::from(scale)).job()?),
        (None, None) => Ok(Vec::new()),
    }
}
