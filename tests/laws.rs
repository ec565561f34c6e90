//! The laws: the picture is, pixel by pixel, the expression of the shapes' own fills, however it is made.
//!
//! Every scene goes in as a document and comes out as rows; the oracle says what each pixel has to be.

mod oracle;

use std::ops::Range;

use oracle::random::Rng;
use oracle::{Expr, Function, Operator, Oracle, Scene};
use runset::encode::{self, Format};
use runset::input;
use runset::job::{Job, More, Options, Stats};
use runset::scene::Limits;

/// How often the random laws are tried: `RUNSET_EFFORT` times as much as by default.
fn effort(n: u64) -> u64 {
    n * std::env::var("RUNSET_EFFORT").map_or(1, |effort| effort.parse().expect("a number"))
}

fn job(scene: &Scene, options: &Options) -> Job {
    let mut warnings = Vec::new();
    let document = input::read(scene.json().into_bytes(), &Limits::default(), &mut warnings).expect("the scene is read");
    Job::prepare(document, options, &mut warnings).expect("the scene is prepared")
}

type Row = Vec<Range<u32>>;

/// Every line of the page from the rows of one sweep.
fn rows(job: &Job) -> Vec<Row> {
    let mut rows = job.rows();
    let mut all = Vec::new();
    while let Some(lines) = rows.next() {
        assert!(lines.check(job.header().width, 1), "{lines:?}");
        assert_eq!(lines.y as usize, all.len() + job.header().lines.start as usize);
        let row: Row = lines.runs.iter().map(|run| run.start..run.end).collect();
        all.extend(std::iter::repeat_n(row, lines.n as usize));
    }
    assert_eq!(all.len(), job.header().height() as usize);
    all
}

fn compare(scene: &Scene, what: &str) -> Job {
    let job = job(scene, &Options::default());
    let oracle = Oracle::new(scene);
    for (y, row) in rows(&job).into_iter().enumerate() {
        assert_eq!(row, oracle.row(y as u32), "{what}, line {y}, expression {}", scene.expr);
    }
    job
}

fn rendered(job: &Job, format: &Format, threads: usize) -> (Vec<u8>, Stats) {
    let mut bytes = Vec::new();
    let stats = job.render(format, threads, &mut bytes, &mut |_| ()).unwrap();
    (bytes, stats)
}

#[test]
fn random_scenes_equal_the_brute_force() {
    for seed in 0..effort(400) {
        compare(&oracle::random::scene(seed), &format!("seed {seed}"));
    }
}

#[test]
fn edges_beside_pixel_centres() {
    for (seed, first_column) in [(1, 0), (2, 1_000_000)] {
        let near = oracle::near::scene(seed, 70_000, first_column);
        let job = job(&near.scene, &Options::default());
        let rows = rows(&job);
        let oracle = Oracle::new(&near.scene);
        for (y, row) in rows.iter().enumerate() {
            assert_eq!(*row, oracle.row(y as u32), "line {y}");
        }
        assert!(near.touches.len() >= 20);
    }
}

#[test]
fn bands_threads_streams_and_slices_are_one_picture() {
    let ndjson = encode::by_name("ndjson").unwrap();
    for seed in 1000..1000 + effort(30) {
        let mut scene = oracle::random::scene(seed);
        scene.height += 200;
        let whole = job(&scene, &Options::default());
        let all = rows(&whole);
        let (bytes, stats) = rendered(&whole, ndjson, 1);
        for threads in [2, 3, 7] {
            let (other, other_stats) = rendered(&whole, ndjson, threads);
            assert_eq!(bytes, other, "seed {seed}, {threads} threads");
            let cost = |s: &Stats| (s.lines_counted, s.lines_repeated, s.toggles, s.runs, s.peak_active);
            assert_eq!(cost(&stats), cost(&other_stats));
        }
        let mut stream = whole.stream(ndjson);
        let mut pulled = Vec::new();
        while stream.next_band(&mut pulled) == More::More {}
        assert_eq!(bytes, pulled, "seed {seed}: a pulled stream");
        assert_eq!(stream.next_band(&mut pulled), More::End);
        assert_eq!(bytes.len(), pulled.len(), "nothing behind the end");

        let mut rng = Rng::new(seed);
        let start = rng.below(u64::from(scene.height)) as u32;
        let end = start + 1 + rng.below(u64::from(scene.height - start)) as u32;
        let slice = job(&scene, &Options { lines: Some(start..end), ..Options::default() });
        assert_eq!(rows(&slice), all[start as usize..end as usize], "seed {seed}, lines {start}..{end}");
    }
}

#[test]
fn complement_and_de_morgan() {
    let not = |a: Expr| Expr::Not(Box::new(a));
    for seed in 2000..2000 + effort(40) {
        let mut scene = oracle::random::scene(seed);
        let shapes = scene.shapes.len() as u64;
        let mut picture = |expr: Expr| {
            scene.expr = expr;
            rows(&job(&scene, &Options::default()))
        };
        let mut rng = Rng::new(seed);
        let (a, b) = (oracle::random::expr(&mut rng, shapes, 3), oracle::random::expr(&mut rng, shapes, 3));
        let binary = |operator, a: &Expr, b: &Expr| Expr::Binary(operator, Box::new(a.clone()), Box::new(b.clone()));
        let either = picture(not(binary(Operator::Or, &a, &b)));
        assert_eq!(either, picture(binary(Operator::And, &not(a.clone()), &not(b.clone()))));
        assert_eq!(picture(binary(Operator::Minus, &a, &b)), picture(binary(Operator::And, &a, &not(b.clone()))));
        let full = picture(Expr::Call(Function::Any, vec![a.clone(), not(a.clone())]));
        assert!(full.iter().all(|row| row.len() == 1 && row[0].start == 0));
        assert!(picture(binary(Operator::And, &a, &not(a.clone()))).iter().all(Vec::is_empty));
    }
}

/// A drawing cut in two along a random polyline: the parts share it, so nothing lies in both and nothing is lost.
#[test]
fn shapes_that_share_an_edge_neither_overlap_nor_leave_a_gap() {
    for seed in 0..effort(100) {
        let mut rng = Rng::new(seed);
        let (width, height) = (60.0, 50.0);
        let mut cut = vec![(rng.uniform(5.0, 55.0), 0.0)];
        for _ in 0..12 {
            let point = (rng.uniform(1.0, 59.0), rng.uniform(1.0, 49.0));
            cut.push(if rng.one_in(2) { (point.0.floor() + 0.5, point.1.floor() + 0.5) } else { point });
        }
        cut.push((rng.uniform(5.0, 55.0), height));
        let side = |x: f64| {
            let mut ring = cut.clone();
            ring.extend([(x, height), (x, 0.0)]);
            oracle::Shape { rings: vec![ring], rule: oracle::Rule::EvenOdd }
        };
        let shapes = vec![side(0.0), side(width)];
        let mut scene = Scene { width: 60, height: 50, shapes, expr: Expr::Page };
        let mut picture = |operator| {
            scene.expr = Expr::Binary(operator, Box::new(Expr::Shape(0)), Box::new(Expr::Shape(1)));
            rows(&job(&scene, &Options::default()))
        };
        assert!(picture(Operator::And).iter().all(Vec::is_empty), "seed {seed}: overlap");
        assert!(picture(Operator::Or).iter().all(|row| row.len() == 1 && row[0] == (0..60)), "seed {seed}: gap");
    }
}

#[test]
fn translation_by_whole_pixels_moves_the_picture() {
    for seed in 3000..3000 + effort(60) {
        let mut rng = Rng::new(seed);
        let (dx, dy) = (rng.between(-9, 9), rng.between(-9, 9));
        let mut scene = oracle::random::scene(seed);
        // Beyond 2^40 px a double cannot be moved by a pixel.
        scene.shapes.iter_mut().for_each(|shape| {
            let near = |p: &(f64, f64)| p.0.abs() < 1e9 && p.1.abs() < 1e9;
            shape.rings.retain(|ring| ring.iter().all(near));
            let points = shape.rings.iter_mut().flatten();
            points.for_each(|p| *p = ((p.0 * 256.0).round() / 256.0, (p.1 * 256.0).round() / 256.0));
        });
        let before = rows(&job(&scene, &Options::default()));
        let points = scene.shapes.iter_mut().flat_map(|shape| shape.rings.iter_mut().flatten());
        points.for_each(|p| *p = (p.0 + dx as f64, p.1 + dy as f64));
        let after = rows(&job(&scene, &Options::default()));
        let holds = |rows: &[Row], x: i64, y: i64| rows[y as usize].iter().any(|run| run.contains(&(x as u32)));
        let (width, height) = (i64::from(scene.width), i64::from(scene.height));
        for y in 0.max(-dy)..height.min(height - dy) {
            for x in 0.max(-dx)..width.min(width - dx) {
                assert_eq!(holds(&before, x, y), holds(&after, x + dx, y + dy), "seed {seed}: {x} {y} by {dx} {dy}");
            }
        }
    }
}
