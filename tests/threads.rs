//! Random scenes are the same bytes in every format, however many threads write them, pulled or in slices.

mod models;
mod oracle;
mod raster;

use oracle::random::Rng;
use oracle::{Expr, Scene};
use runset::encode::{Format, variants};
use runset::error::Kind;
use runset::input;
use runset::job::{Job, More, Options};
use runset::run::{Header, Lines, Run};
use runset::scene::Limits;

/// How often the random laws are tried: `RUNSET_EFFORT` times as much as by default.
fn effort(n: u64) -> u64 {
    n * std::env::var("RUNSET_EFFORT").map_or(1, |effort| effort.parse().expect("a number"))
}

/// A random scene, in one ink or painted in layers of `inks` inks.
fn job(scene: &Scene, inks: u32, options: &Options) -> Job {
    let mut json: serde_json::Value = serde_json::from_str(&scene.json()).expect("JSON");
    if inks > 1 {
        let object = json.as_object_mut().expect("a scene");
        object.remove("expr");
        let ids: Vec<String> = object["shapes"].as_object().expect("shapes").keys().cloned().collect();
        let layers: Vec<_> = (0..inks)
            .map(|i| serde_json::json!({"expr": quoted(&ids[i as usize % ids.len()]), "ink": format!("#{:06x}", i * 7919)}))
            .collect();
        object.insert("layers".into(), layers.into());
    }
    let mut warnings = Vec::new();
    let document = input::read(json.to_string().into_bytes(), &Limits::default(), &mut warnings).expect("the scene is read");
    Job::prepare(document, options, &mut warnings).expect("the scene is prepared")
}

/// An id as an expression names it.
fn quoted(id: &str) -> String {
    format!("\"{}\"", id.replace('\\', "\\\\").replace('"', "\\\""))
}

fn rendered(job: &Job, format: &Format, threads: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut done = Vec::new();
    let stats = job.render(format, threads, &mut bytes, &mut |lines| done.push(lines)).expect("a vector takes all");
    assert_eq!((stats.lines, stats.threads), (job.header().height(), threads));
    assert!(done.is_sorted() && done.last() == Some(&stats.lines), "progress");
    bytes
}

/// The formats that can hold a raster, in every compression.
fn able(job: &Job) -> impl Iterator<Item = &'static Format> + use<'_> {
    variants().filter(move |format| format.check(job.header()).is_ok())
}

/// One writer, line by line: what all others must have written.
fn plainly(header: &Header, lines: &[Vec<Run>], format: &Format) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = (format.encoder)(header);
    encoder.begin(&mut bytes);
    for (y, runs) in header.lines.clone().zip(lines) {
        encoder.lines(Lines { y, n: 1, runs }, &mut bytes);
    }
    encoder.end(&mut bytes);
    raster::complete(format, header, &*encoder, &mut bytes);
    bytes
}

#[test]
fn every_format_is_the_same_with_any_threads_and_slices() {
    for seed in 5000..5000 + effort(12) {
        let mut rng = Rng::new(seed);
        let mut scene = oracle::random::scene(seed);
        scene.height += 500;
        // Within what a double holds, nine times as large.
        scene.shapes.iter_mut().for_each(|shape| shape.rings.retain(|ring| ring.iter().all(|p| p.0.abs() < 1e300 && p.1.abs() < 1e300)));
        // One shape from top to bottom, so that no band is all paper.
        let long = vec![(1.0, -3.0), (f64::from(scene.width), 9.0), (2.0, f64::from(scene.height) + 5.0)];
        scene.shapes[0].rings.push(long);
        if seed % 2 == 0 {
            scene.expr = Expr::Shape(0);
        }
        let inks = [1, 3, 300][seed as usize % 3];
        let scale = [1.0, 9.0][seed as usize / 3 % 2];
        let options = Options { size: runset::job::Size::Scale(scale), ..Options::default() };
        let whole = job(&scene, inks, &options);
        let mut lines: Vec<Vec<Run>> = Vec::new();
        let mut rows = whole.rows();
        while let Some(row) = rows.next() {
            lines.resize(lines.len() + row.n as usize, row.runs.to_vec());
        }
        let height = whole.header().height();
        let start = rng.below(u64::from(height)) as u32;
        let end = start + 1 + rng.below(u64::from(height - start)) as u32;
        let slice = job(&scene, inks, &Options { lines: Some(start..end), ..options.clone() });
        for (job, lines) in [(&whole, &lines[..]), (&slice, &lines[start as usize..end as usize])] {
            for format in able(job) {
                let expected = plainly(job.header(), lines, format);
                for threads in [1, 2, 3, 8] {
                    assert!(rendered(job, format, threads) == expected, "seed {seed}, {}, {threads} threads", raster::name(format));
                }
                let (mut stream, mut pulled) = (job.stream(format), Vec::new());
                while stream.next_band(&mut pulled) == More::More {}
                assert!(pulled == expected, "seed {seed}, {}, pulled", raster::name(format));
            }
        }
    }
}

#[test]
fn models_are_the_same_with_any_threads() {
    for seed in 5500..5500 + effort(8) {
        let mut random = models::Random(seed);
        let (width, height) = (40 + random.below(200) as u32, 1 + random.below(900) as u32);
        let job = models::jobs::random_job(&mut random, width, height);
        let mut lines: Vec<Vec<Run>> = Vec::new();
        let mut rows = job.rows();
        while let Some(row) = rows.next() {
            lines.resize(lines.len() + row.n as usize, row.runs.to_vec());
        }
        for format in able(&job) {
            let expected = plainly(job.header(), &lines, format);
            for threads in [1, 2, 3, 8] {
                assert!(rendered(&job, format, threads) == expected, "seed {seed}, {}, {threads} threads", raster::name(format));
            }
            let (mut stream, mut pulled) = (job.stream(format), Vec::new());
            while stream.next_band(&mut pulled) == More::More {}
            assert!(pulled == expected, "seed {seed}, {}, pulled", raster::name(format));
        }
    }
}

/// A pipe whose reader goes away after some bytes.
struct Closing(usize);

impl std::io::Write for Closing {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let n = bytes.len().min(self.0);
        self.0 -= n;
        if n > 0 { Ok(n) } else { Err(std::io::ErrorKind::BrokenPipe.into()) }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_reader_that_goes_away_ends_all_threads() {
    let mut scene = oracle::random::scene(4);
    scene.height = 20_000;
    let job = job(&scene, 1, &Options::default());
    for format in able(&job) {
        for threads in [1, 2, 8] {
            for room in [0, 10] {
                let error = job.render(format, threads, &mut Closing(room), &mut |_| ()).expect_err("it does not fit");
                assert_eq!(error.kind, Kind::Closed, "{}", raster::name(format));
            }
        }
    }
}
