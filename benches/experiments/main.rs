//! The experiments of the dissertation's chapters 3 and 4 ("CSG" in ARCHITECTURE.md), again: same shapes, same axes.
//!
//! ```text
//! cargo bench --bench experiments -- [--runs N] [--out docs]
//! ```
//!
//! Writes `experiments.md` and its plots. Times are medians of processor time of N runs in one thread, of finding what is visible alone: no reading, no transforms,
//! no colours, no output, as there. Times of parts of the work are shares of it: they are taken with a clock that is looked at some millions of times a second, whose own time
//! is taken off.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;
use std::sync::Arc;

use anyhow::{Context, Result};
use clap::Parser;
use runset::count::Rule;
use runset::mesh::check::all_placed;
use runset::scene::compile;
use runset::solid::body::Body;
use runset::solid::camera::{Camera, Setup};
use runset::solid::savings::Savings;
use runset::solid::spans::{Cost, Spans};
use runset::solid::stage::Stage;
use runset::solid::timers::{Part, Timers};

use measure::{Times, ms};
use plot::{Chart, bars};

#[allow(dead_code, reason = "other benches use the rest")]
#[path = "../measure/mod.rs"]
mod measure;
mod plot;
#[allow(dead_code, reason = "tests use the rest")]
#[path = "../solids/mod.rs"]
mod solids;

/// Runs the experiments of the dissertation again.
#[derive(Parser)]
struct Arguments {
    /// How often each is timed.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..), value_name = "N")]
    runs: u32,
    /// The folder for experiments.md and its plots.
    #[arg(long, default_value = "docs", value_name = "DIR")]
    out: PathBuf,
    /// Passed by `cargo bench`.
    #[arg(long, hide = true)]
    bench: bool,
}

/// One shape, at one size, with some savings.
struct Measured {
    /// Seconds to find all that is visible.
    seconds: f64,
    /// Seconds of the parts of the work, in the order of [`Part::ALL`].
    parts: [f64; 4],
    cost: Cost,
}

/// Ways to save, from none to all.
const WAYS: [(&str, u32); 6] = [
    ("nothing saved", 0b00010),
    ("(b) spans alike", 0b00110),
    ("(c) and hidden crossings ignored", 0b01110),
    ("and scanlines alike", 0b11110),
    ("and boxes of products", 0b11111),
    ("(c), to the last depth", 0b01100),
];

fn savings(way: usize) -> Savings {
    Savings::from_bits(WAYS[way].1)
}

/// The way that the paper goes: spans alike, hidden crossings ignored, early end.
const PAPER: usize = 2;
/// All that is saved.
const ALL: usize = 4;
/// As the paper, without early end.
const TO_THE_LAST: usize = 5;

fn stage(name: &str, size: u32, savings: Savings) -> Result<Arc<Stage>> {
    let solid = solids::solid(name).with_context(|| format!("there is no workload {name}"))?;
    let [eye, target] = solid.camera;
    let camera = Camera::Vector([eye[0], eye[1], eye[2], target[0], target[1], target[2]]);
    let setup = Setup { camera: Some(camera), width: size, height: size, ..Setup::default() };
    let model = &solid.model;
    let (program, leaves) = compile(&model.formula, model.parts.len(), &[model.area], |_| Rule::AtLeast(1));
    let body = Body::new(model, &all_placed(model, &mut Vec::new()), u64::MAX)?;
    let view = setup.view(body.bounds);
    Ok(Arc::new(Stage::new(&body, program, &leaves, view, &[], savings)))
}

fn walked(stage: &Arc<Stage>, savings: Savings, timed: bool) -> Spans {
    let mut spans = Spans::new(stage.clone(), 0..stage.view.height, savings);
    if timed {
        spans.time();
    }
    while let Some(line) = spans.next() {
        std::hint::black_box(line);
    }
    spans
}

fn measured(name: &str, size: u32, way: usize, runs: u32) -> Result<Measured> {
    let savings = savings(way);
    let stage = stage(name, size, savings)?;
    let cost = *walked(&stage, savings, false).cost();
    let mut times = Times::default();
    (0..runs).for_each(|_| _ = times.time(|| walked(&stage, savings, false)));
    let look = Timers::look();
    let mut shares: [Times; 4] = Default::default();
    for _ in 0..runs {
        let spans = walked(&stage, savings, true);
        shares.iter_mut().zip(Part::ALL).for_each(|(times, part)| times.push(spans.timers().of(part, look).as_secs_f64()));
    }
    let shares = shares.each_ref().map(Times::median);
    let all: f64 = shares.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let seconds = times.median();
    Ok(Measured { seconds, parts: shares.map(|share| share / all * seconds), cost })
}

/// Seconds in milliseconds.
const MS: f64 = 1e3;

/// Faces of all parts.
fn faces(name: &str) -> Result<f64> {
    let solid = solids::solid(name).with_context(|| format!("there is no workload {name}"))?;
    Ok(solid.model.parts.iter().map(|part| part.mesh.faces.len()).sum::<usize>() as f64)
}

const SIDES: [u32; 9] = [3, 4, 6, 10, 20, 32, 50, 75, 100];
const RING_SIDES: [u32; 6] = [10, 20, 32, 50, 75, 100];
const SCANLINES: [u32; 6] = [128, 256, 512, 1024, 2048, 4096];

/// The page being written.
struct Page {
    text: String,
    folder: PathBuf,
    runs: u32,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    // Benches run in the folder of the crate.
    let folder = arguments.out.join("experiments");
    fs::create_dir_all(&folder)?;
    let mut heading = Vec::new();
    measure::heading(&mut heading)?;
    let mut page = Page { text: include_str!("head.md").to_owned(), folder, runs: arguments.runs };
    page.text.push_str(&String::from_utf8(heading)?);
    page.splits()?;
    page.faces()?;
    page.scanlines()?;
    page.ring()?;
    page.operations()?;
    page.savings()?;
    fs::write(arguments.out.join("experiments.md"), page.text)?;
    Ok(())
}

impl Page {
    fn path(&self, file: &str) -> PathBuf {
        self.folder.join(file)
    }

    fn section(&mut self, title: &str, text: &str) -> Result<()> {
        Ok(writeln!(self.text, "## {title}\n\n{text}\n")?)
    }

    /// A chart and the table of its points, a row for each place on the first axis.
    fn chart(&mut self, file: &str, axes: [&str; 2], logarithmic: bool, curves: &[(String, Vec<[f64; 2]>)]) -> Result<()> {
        Chart { axes, logarithmic, curves }.draw(&self.path(file))?;
        writeln!(self.text, "![{}](experiments/{file})\n", axes[1])?;
        writeln!(self.text, "| {} |{}", axes[0], curves.iter().fold(String::new(), |text, curve| text + " " + &curve.0 + " |"))?;
        writeln!(self.text, "|{}", "---:|".repeat(curves.len() + 1))?;
        for i in 0..curves[0].1.len() {
            let row = curves.iter().fold(String::new(), |text, curve| text + &format!(" {} |", ms(curve.1[i][1] / MS)));
            writeln!(self.text, "| {} |{row}", curves[0].1[i][0])?;
        }
        Ok(writeln!(self.text)?)
    }

    /// 3.12: where spans are split.
    fn splits(&mut self) -> Result<()> {
        const SIZE: u32 = 384;
        let mut told = Vec::new();
        for (file, way) in [("3_12_a.svg", 1), ("3_12_b.svg", 2)] {
            let savings = savings(way);
            let stage = stage("fig316/3", SIZE, savings)?;
            let mut spans = Spans::new(stage.clone(), 0..SIZE, savings);
            let mut svg =
                format!("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {SIZE} {SIZE}\" width=\"{SIZE}\" height=\"{SIZE}\">\n");
            svg.push_str("<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n");
            let mut points = String::new();
            let mut count = 0;
            while let Some((y, line)) = spans.next() {
                for span in line {
                    let light = 150 + (span.face * 37) % 80;
                    let (x, width) = (span.start, span.end - span.start);
                    writeln!(svg, "<path d=\"M{x} {y}h{width}v1h-{width}z\" fill=\"rgb({light},{light},{light})\"/>")?;
                }
                for x in spans.splits() {
                    count += 1;
                    writeln!(points, "<circle cx=\"{x}\" cy=\"{y}\" r=\".9\" fill=\"#c00\"/>")?;
                }
            }
            fs::write(self.path(file), svg + &points + "</svg>\n")?;
            told.push(count);
        }
        let text = format!(
            "Where two faces cross, a span is split (red). On the left at all crossings, {} of them, on the right only at those that are not behind the visible \
             face, {}. The paper shows the same two pictures, without numbers: (a) with the splits behind the visible face, (b) without them.\n\n\
             ![all crossings](experiments/3_12_a.svg) ![those that matter](experiments/3_12_b.svg)",
            told[0], told[1]
        );
        self.section("Figure 3.12: where spans are split", &text)
    }

    /// 3.14: two prisms of so many sides.
    fn faces(&mut self) -> Result<()> {
        let text = "Two prisms that cross, of 3 to 100 sides each, 512 x 512 pixels; case 1 is their difference, case 2 their union. The paper finds time that grows about \
                    linearly with the faces, and a difference that costs little more than the union, and less where it takes visible faces away.";
        self.section("Figure 3.14: faces and time of two polyhedra", text)?;
        let mut curves = Vec::new();
        for (name, op) in [("case 1: difference", "diff"), ("case 2: union", "union")] {
            let mut points = Vec::new();
            for n in SIDES {
                let workload = format!("fig313/{n}/{op}");
                points.push([faces(&workload)?, measured(&workload, 512, ALL, self.runs)?.seconds * MS]);
            }
            curves.push((name.to_owned(), points));
        }
        self.chart("3_14.svg", ["faces", "ms"], false, &curves)
    }

    /// 3.15: scanlines.
    fn scanlines(&mut self) -> Result<()> {
        let text = "A tetrahedron A, a sphere B and a cube C of 772 faces in all: data-1 is A | B | C, data-2 A | (B - C), data-3 (A - C) | (B - C); 128² to 4096² pixels. The paper finds \
                    time in proportion to the scanlines and not to the pixels.";
        self.section("Figure 3.15: scanlines and time", text)?;
        let mut curves = Vec::new();
        for data in 1..=3 {
            let mut points = Vec::new();
            for size in SCANLINES {
                points.push([size.into(), measured(&format!("fig316/{data}"), size, ALL, self.runs)?.seconds * MS]);
            }
            curves.push((format!("data-{data}"), points));
        }
        self.chart("3_15.svg", ["scanlines", "ms"], true, &curves)?;
        self.linear(&curves)
    }

    /// How far from linear times over scanlines are, from first to last.
    fn linear(&mut self, curves: &[(String, Vec<[f64; 2]>)]) -> Result<()> {
        let told: Vec<String> = curves
            .iter()
            .filter_map(|(name, points)| {
                let ([x0, t0], [x1, t1]) = (points.first()?, points.last()?);
                Some(format!("{name} {:.2}", (t1 / t0) / (x1 / x0)))
            })
            .collect();
        Ok(writeln!(self.text, "Time from first to last, over what is linear in the scanlines: {}.\n", told.join(", "))?)
    }

    /// 4.8 to 4.11: the ring of prisms.
    fn ring(&mut self) -> Result<()> {
        let both = |page: &mut Page,
                    names: [&str; 2],
                    titles: [&str; 2],
                    texts: [&str; 2],
                    axis: &str,
                    logarithmic: bool,
                    places: &[u32],
                    at: &dyn Fn(u32, u32) -> (String, u32)|
         -> Result<()> {
            let (mut all, mut counts) = (Vec::new(), Vec::new());
            for segments in [0, 4, 8] {
                let (mut seconds, mut counting) = (Vec::new(), Vec::new());
                for &place in places {
                    let (workload, size) = at(place, segments);
                    let measured = measured(&workload, size, PAPER, page.runs)?;
                    seconds.push([place.into(), measured.seconds * MS]);
                    counting.push([place.into(), measured.parts[Part::Count as usize] * MS]);
                }
                all.push((format!("{segments} segments"), seconds));
                counts.push((format!("{segments} segments"), counting));
            }
            for (((name, title), text), curves) in names.into_iter().zip(titles).zip(texts).zip([&all, &counts]) {
                page.section(title, text)?;
                page.chart(name, [axis, "ms"], logarithmic, curves)?;
                if logarithmic {
                    page.linear(curves)?;
                }
            }
            Ok(())
        };
        both(
            self,
            ["4_8.svg", "4_9.svg"],
            ["Figure 4.8: sides and time", "Figure 4.9: sides and time of set operations"],
            [
                "Nine prisms of 10 to 100 sides (figure 4.7), of which the one in the middle is taken away from 0, 4 or 8 of the others; 512 x 512 pixels, with the savings of the paper. The paper finds time that is linear in \
                 the faces, and segments that add the same whatever their number.",
                "Of that, the one-dimensional set operations. The paper finds that they depend on the segments, and not on the faces.",
            ],
            "sides",
            false,
            &RING_SIDES,
            &|sides, segments| (format!("fig47/{sides}/{segments}"), 512),
        )?;
        both(
            self,
            ["4_10.svg", "4_11.svg"],
            ["Figure 4.10: scanlines and time", "Figure 4.11: scanlines and time of set operations"],
            [
                "The same with 32 sides, 128² to 4096² pixels. The paper finds time in proportion to the scanlines.",
                "Of that, the set operations, again in proportion to the scanlines in the paper.",
            ],
            "scanlines",
            true,
            &SCANLINES,
            &|size, segments| (format!("fig47/32/{segments}"), size),
        )
    }

    /// 4.12: time of one set operation.
    fn operations(&mut self) -> Result<()> {
        let text = "Mean time of one set operation on the ring of 32 sides at 512², with 0 to 8 segments: ended as soon as the model holds, and carried on to the last depth. \
                    The paper finds time that grows with the segments, and 48 % less with the early end at 8 of them. Here counters are nested and not listed by segment, so a count costs what \
                    flips.";
        self.section("Figure 4.12: time of one set operation", text)?;
        let mut curves = Vec::new();
        for (name, way) in [("early end", PAPER), ("to the last depth", TO_THE_LAST)] {
            let mut points = Vec::new();
            for segments in 0..=8_u32 {
                let measured = measured(&format!("fig47/32/{segments}"), 512, way, self.runs)?;
                points.push([segments.into(), measured.parts[Part::Count as usize] / measured.cost.counts as f64 * 1e9]);
            }
            curves.push((name.to_owned(), points));
        }
        Chart { axes: ["segments", "ns"], logarithmic: false, curves: &curves }.draw(&self.path("4_12.svg"))?;
        writeln!(
            self.text,
            "![ns](experiments/4_12.svg)\n\n| segments | early end, ns | to the last depth, ns | saved |\n|---:|---:|---:|---:|"
        )?;
        for (early, last) in curves[0].1.iter().zip(&curves[1].1) {
            writeln!(self.text, "| {} | {:.0} | {:.0} | {:.0} % |", early[0], early[1], last[1], (1.0 - early[1] / last[1]) * 100.0)?;
        }
        Ok(writeln!(self.text)?)
    }

    /// 4.13 and 4.15: what is saved.
    fn savings(&mut self) -> Result<()> {
        self.section(
            "Figure 4.13: what is saved on the ring of prisms",
            "The ring of 32 sides at 512², parts of the work one upon the other. The paper's (a) saves nothing, (b) takes what is seen from the span before, (c) ignores crossings behind \
             the visible face too; it finds (b) very effective, and (c) slower here, as looking costs more than it saves. The rows after (c) are of this program alone.",
        )?;
        self.table("4_13.svg", &[0, 4, 8].map(|k| (format!("{k} segments"), format!("fig47/32/{k}"))))?;
        self.section(
            "Figure 4.15: what is saved where crossings are hidden",
            "A box and four prisms within an ellipsoid (figure 4.14), the prisms longer from case to case, so that more crossings are hidden; 512². The paper finds that here (c) pays.",
        )?;
        self.table("4_15.svg", &[1, 2, 3, 4].map(|case| (format!("case {case}"), format!("fig414/{case}"))))
    }

    fn table(&mut self, file: &str, workloads: &[(String, String)]) -> Result<()> {
        const NAMES: [&str; 4] = ["edges", "active faces", "spans", "set operations"];
        let mut all = Vec::new();
        writeln!(
            self.text,
            "![ms](experiments/{file})\n\n| | | ms | set operations | spans | active faces | edges | counts | crossings |"
        )?;
        writeln!(self.text, "|---|---|---:|---:|---:|---:|---:|---:|---:|")?;
        for (title, workload) in workloads {
            for (way, (name, _)) in WAYS.iter().enumerate() {
                let Measured { seconds, parts, cost } = measured(workload, 512, way, self.runs)?;
                let [edges, faces, spans, count] = parts.map(ms);
                let (total, counts, crossings) = (ms(seconds), cost.counts, cost.crossings);
                writeln!(self.text, "| {title} | {name} | {total} | {count} | {spans} | {faces} | {edges} | {counts} | {crossings} |")?;
                all.push((format!("{title}, {}", short(name)), parts.map(|part| part * MS).to_vec()));
            }
        }
        writeln!(self.text)?;
        bars(&self.path(file), "ms", &NAMES, &all)
    }
}

/// A name that fits beside a bar.
fn short(name: &str) -> &str {
    name.split_once(") ").filter(|(start, _)| start.starts_with('(')).map_or(name, |_| &name[..3])
}
