//! The comparisons of the dissertation that the engine follows ("CSG" in ARCHITECTURE.md), chapter 2, on the axes of its own figures: edges of a
//! polygon (as in 3.14 and 4.8), scanlines from 128 to 4096 (as in 3.15 and 4.10), number of operands:
//!
//! ```text
//! cargo bench --bench paper -- [--runs N]
//! ```
//!
//! 2.2.1 clips to a convex window by Sutherland and Hodgman's way before filling, 2.2.2 fills masks and combines them, 2.2.3 counts while it
//! fills. 2.3 says that counting costs very little over the plain fill of the same edges. Every way fills with our own sweep; times
//! are medians of processor time in ms from polygons in memory to runs, or to a mask of one bit a pixel, and the numbers of
//! pixels are checked against each other.

use std::io::{self, Write};

use anyhow::{Result, ensure};
use clap::Parser;
use runset::job::{Job, Options};
use runset::scene::{Area, Formula, Picture, Scene};
use runset::shape::{FillRule, Path, Shape};

mod mask;
#[allow(dead_code, reason = "other benches use the rest")]
#[path = "../measure/mod.rs"]
mod measure;
#[allow(dead_code, reason = "other benches use the rest")]
#[path = "../shapes/numpy.rs"]
mod numpy;
mod window;

use mask::{Bitmap, RunLength};
use measure::{Times, ms, ratio};
use window::Point;

/// Times a boolean by counting beside the other ways that the dissertation names.
#[derive(Parser)]
struct Arguments {
    /// How often each is timed.
    #[arg(long, default_value_t = 9, value_parser = clap::value_parser!(u32).range(1..), value_name = "N")]
    runs: u32,
    /// Passed by `cargo bench`.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> Result<()> {
    let runs = Arguments::parse().runs;
    let mut out = io::stdout().lock();
    measure::heading(&mut out)?;
    windows(runs, &mut out)?;
    masks(runs, &mut out)?;
    plain(runs, &mut out)?;
    Ok(out.flush()?)
}

/// A rough star of so many edges about a centre, in pixels, jagged by a few lengths of an edge at most, so that it hardly crosses itself.
fn star(seed: u32, edges: u32, centre: Point, radius: f64) -> Vec<Point> {
    let mut rng = numpy::Rng::new(seed);
    let jag = (12.0 / f64::from(edges)).min(0.3);
    let corner = |i: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(edges)).sin_cos();
        let r = radius * (1.0 - jag * rng.random());
        [centre[0] + r * cos, centre[1] + r * sin]
    };
    (0..edges).map(corner).collect()
}

/// `count` stars that all overlap in the middle of a page.
fn stars(count: u32, edges: u32, side: u32) -> Vec<Vec<Point>> {
    let side = f64::from(side);
    let place = |i: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(count)).sin_cos();
        star(100 + i, edges, [side * (0.5 + 0.12 * cos), side * (0.5 + 0.12 * sin)], side * 0.35)
    };
    (0..count).map(place).collect()
}

/// A scene of polygons, each a shape, combined.
fn scene(side: u32, polygons: &[Vec<Point>], combine: impl FnOnce(&mut Formula, &[Area]) -> Area) -> Scene {
    let mut scene = Scene::new(f64::from(side), f64::from(side));
    let areas: Vec<Area> = polygons
        .iter()
        .map(|polygon| {
            let mut path = Path::default();
            path.ring(polygon);
            scene.add_shape(Shape { rule: FillRule::EvenOdd, ..Shape::new("", path) })
        })
        .collect();
    scene.picture = Picture::Region(combine(&mut scene.formula, &areas));
    scene
}

/// All polygons as one shape: no boolean.
fn one(side: u32, polygons: &[Vec<Point>]) -> Scene {
    let mut scene = Scene::new(f64::from(side), f64::from(side));
    let mut path = Path::default();
    polygons.iter().for_each(|polygon| path.ring(polygon));
    let area = scene.add_shape(Shape { rule: FillRule::EvenOdd, ..Shape::new("", path) });
    scene.picture = Picture::Region(area);
    scene
}

fn prepare(scene: Scene) -> Result<Job> {
    Ok(Job::prepare(scene, &Options::default(), &mut Vec::new())?)
}

/// Edges and runs; the number of pixels, and of scanlines on which was counted.
fn fill(scene: Scene) -> Result<(u64, u64)> {
    let job = prepare(scene)?;
    let mut rows = job.rows();
    let mut pixels = 0;
    while let Some(lines) = rows.next() {
        pixels += lines.runs.iter().map(|run| u64::from(run.end - run.start)).sum::<u64>() * u64::from(lines.n);
    }
    Ok((pixels, rows.cost().rows.counted))
}

fn all(formula: &mut Formula, areas: &[Area]) -> Area {
    formula.all(areas)
}

/// 2.2.1: a star of m edges and a window of n sides about a point near its left, so large that about half of the outline is inside, or so small that
/// next to nothing is.
fn windows(runs: u32, out: &mut impl Write) -> Result<()> {
    const SIDE: u32 = 1024;
    writeln!(out, "2.2.1, a polygon and a convex window, {SIDE} scanlines, ms:\n")?;
    writeln!(
        out,
        "| edges of the polygon | sides of the window | vertices left | clip and fill | of that the clip | count while filling | times | plain fill of both |"
    )?;
    writeln!(out, "|--:|--:|--:|--:|--:|--:|--:|--:|")?;
    let edges = [(10, 4, 0.7), (100, 4, 0.7), (1_000, 4, 0.7), (10_000, 4, 0.7), (100_000, 4, 0.7), (10_000, 4, 0.2)];
    let sides = [(10_000, 16, 0.7), (10_000, 64, 0.7), (10_000, 256, 0.7), (10_000, 1024, 0.7)];
    for (edges, sides, size) in edges.into_iter().chain(sides) {
        let middle = f64::from(SIDE) / 2.0;
        let polygon = star(7, edges, [middle, middle], middle * 0.9);
        let window = window::regular(sides, [middle * 0.45, middle], middle * size);
        let left = window::clip(&polygon, &window).len();
        let both = [polygon.clone(), window.clone()];
        let (mut clipped, mut clip, mut counted, mut plain) = (Times::default(), Times::default(), Times::default(), Times::default());
        for _ in 0..runs {
            let a = clipped.time(|| {
                let rest = clip.time(|| window::clip(&polygon, &window));
                fill(one(SIDE, &[rest]))
            })?;
            let b = counted.time(|| fill(scene(SIDE, &both, all)))?;
            plain.time(|| fill(one(SIDE, &both)))?;
            // The clip's corners are rounded to the grid, the whole edges are not.
            ensure!(a.0.abs_diff(b.0) * 1000 < b.0, "{edges} edges, {sides} sides: {} and {} pixels", a.0, b.0);
        }
        let times = ratio(clipped.median() / counted.median());
        let [clipped, clip, counted, plain] = [&clipped, &clip, &counted, &plain].map(|times| ms(times.median()));
        writeln!(out, "| {edges} | {sides} | {left} | {clipped} | {clip} | {counted} | {times} | {plain} |")?;
    }
    Ok(writeln!(out)?)
}

/// 2.2.2: k stars of m edges, the common part, by masks.
fn masks(runs: u32, out: &mut impl Write) -> Result<()> {
    writeln!(out, "2.2.2, the common part of overlapping polygons, ms (times counting):\n")?;
    writeln!(out, "| polygons | edges of each | scanlines | count, to runs | run-length masks | count, to a bitmap | bitmap masks |")?;
    writeln!(out, "|--:|--:|--:|--:|--:|--:|--:|")?;
    let edges = [(2, 10, 1024), (2, 100, 1024), (2, 1_000, 1024), (2, 10_000, 1024)];
    let polygons = [(4, 100, 1024), (16, 100, 1024), (64, 100, 1024)];
    let scanlines = [(8, 32, 128), (8, 32, 256), (8, 32, 512), (8, 32, 1024), (8, 32, 2048), (8, 32, 4096), (8, 32, 16384)];
    for (count, edges, side) in edges.into_iter().chain(polygons).chain(scanlines) {
        let polygons = stars(count, edges, side);
        let (mut counted, mut lengths, mut bitmap, mut bitmaps) = (Times::default(), Times::default(), Times::default(), Times::default());
        let mut page = [Bitmap::new(side), Bitmap::new(side)];
        let mut images = [(); 3].map(|()| RunLength::default());
        for _ in 0..runs {
            let pixels = counted.time(|| fill(scene(side, &polygons, all)))?.0;
            lengths.time(|| -> Result<()> {
                let [whole, next, made] = &mut images;
                for (i, polygon) in polygons.iter().enumerate() {
                    let job = prepare(one(side, std::slice::from_ref(polygon)))?;
                    if i == 0 {
                        whole.fill(&job);
                    } else {
                        next.fill(&job);
                        made.combine(whole, next, |a, b| a && b);
                        std::mem::swap(whole, made);
                    }
                }
                Ok(())
            })?;
            let [whole, next] = &mut page;
            bitmap.time(|| -> Result<()> {
                whole.fill(&prepare(scene(side, &polygons, all))?);
                Ok(())
            })?;
            ensure!(whole.pixels() == pixels && images[0].pixels() == pixels, "{count} polygons: masks differ from counting");
            bitmaps.time(|| -> Result<()> {
                for (i, polygon) in polygons.iter().enumerate() {
                    let job = prepare(one(side, std::slice::from_ref(polygon)))?;
                    if i == 0 {
                        whole.fill(&job);
                    } else {
                        next.fill(&job);
                        whole.combine(next, |a, b| a & b);
                    }
                }
                Ok(())
            })?;
            ensure!(whole.pixels() == pixels, "{count} polygons: bitmaps differ from counting");
        }
        let [of_lengths, of_bitmaps] = [(&lengths, &counted), (&bitmaps, &bitmap)].map(|(mask, ours)| ratio(mask.median() / ours.median()));
        let [counted, lengths, bitmap, bitmaps] = [&counted, &lengths, &bitmap, &bitmaps].map(|times| ms(times.median()));
        writeln!(out, "| {count} | {edges} | {side} | {counted} | {lengths} ({of_lengths}) | {bitmap} | {bitmaps} ({of_bitmaps}) |")?;
    }
    Ok(writeln!(out)?)
}

/// 2.3: booleans beside the plain fill of the same edges.
fn plain(runs: u32, out: &mut impl Write) -> Result<()> {
    type Combine = fn(&mut Formula, &[Area]) -> Area;
    const WAYS: [Combine; 4] = [
        |formula, areas| formula.all(areas),
        |formula, areas| formula.any(areas),
        |formula, areas| formula.without(areas[0], &areas[1..]),
        |formula, areas| formula.at_least(2, areas),
    ];
    writeln!(out, "2.3, booleans beside the plain even-odd fill of the same edges, ms (times the plain fill):\n")?;
    writeln!(
        out,
        "| polygons | edges of each | scanlines | plain | all | any | first without the others | at least 2 | lines counted, plain and all |"
    )?;
    writeln!(out, "|--:|--:|--:|--:|--:|--:|--:|--:|--:|")?;
    let edges = [(2, 10, 1024), (2, 100, 1024), (2, 1_000, 1024), (2, 10_000, 1024)];
    let polygons = [(8, 100, 1024), (64, 100, 1024)];
    let scanlines = [(8, 32, 128), (8, 32, 512), (8, 32, 2048), (8, 32, 4096), (8, 32, 16384)];
    for (count, edges, side) in edges.into_iter().chain(polygons).chain(scanlines) {
        let polygons = stars(count, edges, side);
        let (mut plain, mut ways) = (Times::default(), WAYS.map(|_| Times::default()));
        let mut counted = [0; 2];
        for _ in 0..runs {
            counted[0] = plain.time(|| fill(one(side, &polygons)))?.1;
            for (i, (times, combine)) in ways.iter_mut().zip(WAYS).enumerate() {
                let lines = times.time(|| fill(scene(side, &polygons, combine)))?.1;
                if i == 0 {
                    counted[1] = lines;
                }
            }
        }
        write!(out, "| {count} | {edges} | {side} | {} |", ms(plain.median()))?;
        for times in &ways {
            write!(out, " {} ({:.2}) |", ms(times.median()), times.median() / plain.median())?;
        }
        writeln!(out, " {}, {} |", counted[0], counted[1])?;
    }
    Ok(())
}
