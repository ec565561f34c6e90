//! The laws: the picture is, pixel by pixel, the expression of the shapes' own fills, however it is made.
//!
//! Every scene goes in as a document and comes out as rows; the oracle says what each pixel has to be.

mod oracle;

use std::ops::Range;

use oracle::random::Rng;
use oracle::{Expr, Function, Operator, Oracle, Scene};
use runset::encode::{self, Format};
use runset::input;
use runset::job::{Counting, Job, More, Options, Stats};
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
        assert!(lines.check(job.header()), "{lines:?}");
        assert_eq!(lines.y as usize, all.len() + job.header().lines.start as usize);
        let row: Row = lines.runs.iter().map(|run| run.start..run.end).collect();
        all.extend(std::iter::repeat_n(row, lines.n as usize));
    }
    assert_eq!(all.len(), job.header().height() as usize);
    all
}

/// Compares every line with the oracle's, however crossings are counted.
fn compare(scene: &Scene, what: &str) -> Job {
    let oracle = Oracle::new(scene);
    let expected: Vec<Row> = (0..scene.height).map(|y| oracle.row(y)).collect();
    for counting in [Counting::Measured, Counting::Ordered, Counting::Unordered] {
        let job = job(scene, &Options { counting, ..Options::default() });
        for (y, row) in rows(&job).into_iter().enumerate() {
            assert_eq!(row, expected[y], "{what}, {counting:?}, line {y}, expression {}", scene.expr);
        }
    }
    job(scene, &Options::default())
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
        compare(&near.scene, "edges beside pixel centres");
        assert!(near.touches.len() >= 20);
    }
}

/// A few shapes of many long edges, on a page so high; below `calm` all that is left are upright edges.
fn tangle(rng: &mut Rng, height: u32, calm: f64) -> Scene {
    let width = rng.pick(&[64, 200, 257]);
    let shapes = (0..1 + rng.below(4))
        .map(|_| {
            let tall = |rng: &mut Rng| rng.uniform(-20.0, calm);
            let mut ring: Vec<(f64, f64)> = (0..300).map(|_| (rng.uniform(-30.0, f64::from(width) + 30.0), tall(rng))).collect();
            for _ in 0..20 {
                let x = rng.uniform(0.0, f64::from(width));
                ring.extend([(x, calm), (x, f64::from(height) + 5.0), (x + 3.25, f64::from(height) + 5.0), (x + 3.25, calm)]);
            }
            oracle::Shape { rings: vec![ring], rule: if rng.one_in(2) { oracle::Rule::EvenOdd } else { oracle::Rule::NonZero } }
        })
        .collect::<Vec<_>>();
    let expr = oracle::random::expr(rng, shapes.len() as u64, 3);
    Scene { width, height, shapes, expr }
}

#[test]
fn tangles_are_counted_without_order_and_come_to_rest() {
    let mut unordered = 0;
    for seed in 0..effort(12) {
        let mut rng = Rng::new(seed);
        let scene = tangle(&mut rng, 160, 100.0);
        let job = compare(&scene, &format!("tangle {seed}"));
        let (_, stats) = rendered(&job, encode::by_name("pbm").unwrap(), 1);
        unordered += stats.lines_unordered;
        // Below the tangle everything is upright: a line or two a band for the events there, and for finding that it is over.
        assert!(stats.lines_counted <= 100 + 3 + 2 * 3, "{stats:?}");
        let (_, ordered) = rendered(
            &self::job(&scene, &Options { counting: Counting::Ordered, ..Options::default() }),
            encode::by_name("pbm").unwrap(),
            1,
        );
        assert_eq!(ordered.lines_unordered, 0);
    }
    assert!(unordered > 100, "{unordered} lines");
}

/// The topmost layer is seen, whichever way it is counted.
#[test]
fn layers_of_tangles_show_the_topmost() {
    for seed in 0..effort(12) {
        let mut rng = Rng::new(seed + 500);
        let mut scene = tangle(&mut rng, 60, 55.0);
        let layers: Vec<(Expr, u32)> =
            (0..1 + rng.below(6)).map(|_| (oracle::random::expr(&mut rng, scene.shapes.len() as u64, 2), rng.below(4) as u32)).collect();
        let inks = ["#102030", "#e4007f", "#00a0e9", "#fff100"];
        let texts: Vec<String> =
            layers.iter().map(|(e, ink)| format!("{{\"expr\":{:?},\"ink\":\"{}\"}}", e.to_string(), inks[*ink as usize])).collect();
        scene.expr = Expr::Page;
        let text = scene.json().replace("\"expr\":\"page\"", &format!("\"layers\":[{}]", texts.join(",")));
        // What each layer holds, by the oracle.
        let held: Vec<Vec<Row>> = layers
            .iter()
            .map(|(expr, _)| {
                let scene = Scene { expr: expr.clone(), ..scene.clone() };
                let oracle = Oracle::new(&scene);
                (0..scene.height).map(|y| oracle.row(y)).collect()
            })
            .collect();
        for counting in [Counting::Measured, Counting::Ordered, Counting::Unordered] {
            let mut warnings = Vec::new();
            let document = input::read(text.clone().into_bytes(), &Limits::default(), &mut warnings).unwrap();
            let job = Job::prepare(document, &Options { counting, ..Options::default() }, &mut warnings).unwrap();
            let mut rows = job.rows();
            while let Some(lines) = rows.next() {
                assert!(lines.check(job.header()), "{lines:?}");
                for (y, x) in (lines.y..lines.y + lines.n).flat_map(|y| (0..scene.width).map(move |x| (y, x))) {
                    let seen = lines.runs.iter().find(|run| (run.start..run.end).contains(&x)).map(|run| job.header().inks.colour(run.ink));
                    let top = (0..layers.len()).rev().find(|&i| held[i][y as usize].iter().any(|run| run.contains(&x)));
                    let ink = top.map(|i| {
                        let text = inks[layers[i].1 as usize];
                        [1, 3, 5].map(|at| u8::from_str_radix(&text[at..at + 2], 16).unwrap())
                    });
                    assert_eq!(seen, ink, "seed {seed}, {counting:?}, pixel {x}, {y}");
                }
            }
        }
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
