//! A raster that was left anywhere and is taken up again is the raster that nobody left.

mod models;
mod oracle;

use oracle::random::Rng;
use oracle::{Expr, Scene};
use runset::encode::{Encode, FORMATS, Format, Restart, Strip, by_name};
use runset::input;
use runset::job::{Checkpoint, Job, More, Options, Stream};
use runset::run::{Header, Inks, Lines, Run, Sheet};
use runset::scene::Limits;

/// How often the random laws are tried: `RUNSET_EFFORT` times as much as by default.
fn effort(n: u64) -> u64 {
    n * std::env::var("RUNSET_EFFORT").map_or(1, |effort| effort.parse().expect("a number"))
}

const INKS: [u32; 4] = [1, 3, 20, 300];

/// Groups of equal lines.
type Groups = Vec<(u32, Vec<Run>)>;

/// A random raster: paper, few runs, many runs; groups of a line or of thousands, neighbours often equal.
fn raster(rng: &mut Rng) -> (Header, Groups) {
    let width = 1 + rng.below(200) as u32;
    let inks = if rng.one_in(4) {
        Inks::Shaded { paper: rng.pick(&[[255; 3], [255, 255, 229], [0; 3]]) }
    } else {
        let n = rng.pick(&INKS);
        Inks::Listed((0..n).map(|i| if n == 1 { [0; 3] } else { [i as u8, (i >> 8) as u8, 77] }).collect())
    };
    let start = rng.pick(&[0, 1, 4000, 8191, 12_288]);
    let mut groups: Groups = Vec::new();
    for _ in 0..1 + rng.below(24) {
        let n = if rng.one_in(6) { 1 + rng.below(9000) } else { 1 + rng.below(6) } as u32;
        let again = groups.last().filter(|_| rng.one_in(3)).map(|last| last.1.clone());
        let runs = again.unwrap_or_else(|| {
            let (mut runs, mut x, gap) = (Vec::new(), 0, rng.pick(&[1, 4, 90]));
            loop {
                let start = x + rng.below(gap + 1) as u32 + u32::from(x > 0);
                let end = start + 1 + rng.below(2 * gap) as u32;
                if end > width {
                    break runs;
                }
                runs.push(Run { start, end, ink: rng.below(inks.end().into()) as u32 });
                x = end;
            }
        });
        groups.push((n, runs));
    }
    let height: u32 = groups.iter().map(|group| group.0).sum();
    (Header { width, lines: start..start + height, inks, dpi: None, sheet: Sheet::default() }, groups)
}

/// Hands the lines from `from` on to `take`, in groups that are cut anew.
fn lines_from(header: &Header, groups: &Groups, from: u32, rng: &mut Rng, mut take: impl FnMut(Lines<'_>)) {
    let mut y = header.lines.start;
    for (n, runs) in groups {
        let end = y + n;
        y = y.max(from);
        while y < end {
            let n = if rng.one_in(2) { end - y } else { 1 + rng.below(u64::from(end - y)) as u32 };
            take(Lines { y, n, runs });
            y += n;
        }
        y = end;
    }
}

/// What a new writer makes from there on.
fn rest(format: &Format, header: &Header, groups: &Groups, restart: &Restart, rng: &mut Rng) -> Vec<u8> {
    let (mut encoder, mut out) = ((format.encoder)(header), Vec::new());
    encoder.resume(restart);
    assert_eq!(encoder.restart(), *restart, "{}: a place does not change by being taken up", format.name);
    lines_from(header, groups, restart.line, rng, |lines| encoder.lines(lines, &mut out));
    encoder.end(&mut out);
    out
}

/// Compares what is made from those places on with what stands there.
fn compare(format: &Format, header: &Header, groups: &Groups, whole: &[u8], places: &[(usize, Restart)], rng: &mut Rng, seed: u64) {
    for (at, restart) in places {
        let got = rest(format, header, groups, restart, rng);
        assert!(got == whole[*at..], "seed {seed}, {}, {header:?}, byte {at}: {restart:?}", format.name);
    }
}

#[test]
fn a_writer_goes_on_behind_any_lines() {
    for seed in 0..effort(60) {
        let mut rng = Rng::new(seed);
        let (header, groups) = raster(&mut rng);
        for format in FORMATS {
            let (mut encoder, mut whole, mut places) = ((format.encoder)(&header), Vec::new(), Vec::new());
            encoder.begin(&mut whole);
            let first = Restart { line: header.lines.start, tally: [0; 3] };
            assert_eq!(encoder.restart(), first, "{}", format.name);
            places.push((whole.len(), first));
            lines_from(&header, &groups, 0, &mut Rng::new(seed + 1), |lines| {
                encoder.lines(lines, &mut whole);
                places.push((whole.len(), encoder.restart()));
            });
            encoder.end(&mut whole);
            compare(format, &header, &groups, &whole, &places, &mut rng, seed);
            assert!(encoder.length().is_none_or(|length| length == whole.len() as u64), "{}", format.name);
        }
    }
}

#[test]
fn a_writer_goes_on_behind_any_part() {
    for seed in 100..100 + effort(60) {
        let mut rng = Rng::new(seed);
        let (header, groups) = raster(&mut rng);
        for format in FORMATS {
            let whole = rest_of_all(format, &header, &groups, &mut rng);
            let new = || (format.encoder)(&header);
            let (mut encoder, mut helper, mut out, mut places): (Box<dyn Encode>, Box<dyn Encode>, _, _) =
                (new(), new(), Vec::new(), Vec::new());
            encoder.begin(&mut out);
            let mut strips = vec![Strip::default()];
            lines_from(&header, &groups, 0, &mut Rng::new(seed + 1), |lines| {
                strips.last_mut().expect("one at least").push(lines);
                if rng.one_in(5) {
                    strips.push(Strip::default());
                }
            });
            for strip in &strips {
                let (all, mut bytes) = (strip.lines(), Vec::new());
                let part = helper.part(strip, &mut bytes);
                strip.within(all.start..part.lines.start).for_each(|lines| encoder.lines(lines, &mut out));
                if !part.lines.is_empty() {
                    encoder.join(&part, &mut out);
                    out.extend(&bytes);
                    places.push((out.len(), encoder.restart()));
                }
                strip.within(part.lines.end..all.end).for_each(|lines| encoder.lines(lines, &mut out));
                places.push((out.len(), encoder.restart()));
            }
            encoder.end(&mut out);
            assert!(out == whole, "seed {seed}, {}", format.name);
            compare(format, &header, &groups, &whole, &places, &mut rng, seed);
        }
    }
}

/// The whole raster, by a writer that nobody interrupts.
fn rest_of_all(format: &Format, header: &Header, groups: &Groups, rng: &mut Rng) -> Vec<u8> {
    let (mut encoder, mut out) = ((format.encoder)(header), Vec::new());
    encoder.begin(&mut out);
    lines_from(header, groups, 0, rng, |lines| encoder.lines(lines, &mut out));
    encoder.end(&mut out);
    out
}

/// A random scene, in one ink or painted in layers of `inks` inks.
fn job(scene: &Scene, inks: u32, options: &Options) -> Job {
    let mut json: serde_json::Value = serde_json::from_str(&scene.json()).expect("JSON");
    if inks > 1 {
        let object = json.as_object_mut().expect("a scene");
        object.remove("expr");
        let ids: Vec<String> = object["shapes"].as_object().expect("shapes").keys().cloned().collect();
        let quoted = |id: &str| format!("\"{}\"", id.replace('\\', "\\\\").replace('"', "\\\""));
        let layers: Vec<_> = (0..inks)
            .map(|i| serde_json::json!({"expr": quoted(&ids[i as usize % ids.len()]), "ink": format!("#{:06x}", i * 7919)}))
            .collect();
        object.insert("layers".into(), layers.into());
    }
    let mut warnings = Vec::new();
    let document = input::read(json.to_string().into_bytes(), &Limits::default(), &mut warnings).expect("the scene is read");
    Job::prepare(document, options, &mut warnings).expect("the scene is prepared")
}

/// A scene, or now and then a model.
fn any_job(rng: &mut Rng, seed: u64) -> Job {
    if seed % 4 != 3 {
        return scene_job(rng, seed);
    }
    let height = if rng.one_in(3) { 4097 + rng.below(3000) as u32 } else { 1 + rng.below(600) as u32 };
    models::jobs::random_job(&mut models::Random(seed), 1 + rng.below(300) as u32, height)
}

/// A scene on a page of some lines or of more than a record or a segment has, or a slice of one.
fn scene_job(rng: &mut Rng, seed: u64) -> Job {
    let mut scene = oracle::random::scene(seed);
    let height = if rng.one_in(3) { 4097 + rng.below(9000) as u32 } else { 1 + rng.below(600) as u32 };
    // All over the page, and within what a double holds.
    let (wider, taller) = (1.0 + rng.below(3) as f64, f64::from(height) / f64::from(scene.height));
    scene.shapes.iter_mut().for_each(|shape| {
        shape.rings.retain(|ring| ring.iter().all(|p| p.0.abs() < 1e300 && p.1.abs() < 1e300));
        shape.rings.iter_mut().flatten().for_each(|p| *p = (p.0 * wider, p.1 * taller));
    });
    (scene.width, scene.height) = ((scene.width * wider as u32).min(200), height);
    let long = vec![(1.0, -3.0), (f64::from(scene.width), 9.0), (2.0, f64::from(scene.height) + 5.0)];
    scene.shapes[0].rings.push(long);
    if rng.one_in(2) {
        scene.expr = Expr::Shape(0);
    }
    let inks = INKS[seed as usize % 4];
    let lines = rng.one_in(2).then(|| {
        let start = rng.below(u64::from(height)) as u32;
        start..start + 1 + rng.below(u64::from(height - start)) as u32
    });
    job(&scene, inks, &Options { lines, ..Options::default() })
}

fn rendered(job: &Job, format: &Format) -> Vec<u8> {
    let mut bytes = Vec::new();
    job.render(format, 2, &mut bytes, &mut |_| ()).expect("a vector takes all");
    bytes
}

/// Small portions, of no certain size.
fn portion(stream: &mut Stream, rng: &mut Rng, out: &mut Vec<u8>) -> More {
    let (bytes, work) = if rng.one_in(2) { (1 + rng.below(3000), 1 + rng.below(9000)) } else { (usize::MAX as u64, 1 + rng.below(3000)) };
    stream.next_within(bytes as usize, work, out)
}

fn pulled(mut stream: Stream, rng: &mut Rng) -> Vec<u8> {
    let mut out = Vec::new();
    while portion(&mut stream, rng, &mut out) == More::More {}
    out
}

#[test]
fn a_stream_goes_on_from_any_checkpoint() {
    let mut places = 0;
    for seed in 7000..7000 + effort(30) {
        let mut rng = Rng::new(seed);
        let job = any_job(&mut rng, seed);
        for format in FORMATS {
            let whole = rendered(&job, format);
            let (mut stream, mut out) = (job.stream(format), Vec::new());
            let mut checkpoints = vec![stream.checkpoint()];
            loop {
                let more = portion(&mut stream, &mut rng, &mut out);
                assert_eq!(stream.offset(), out.len() as u64);
                let checkpoint = stream.checkpoint();
                checkpoints.push(checkpoint);
                if more == More::End {
                    break;
                }
                assert_eq!(checkpoint.offset, stream.offset(), "seed {seed}, {}", format.name);
                let swept = job.header().lines.start + stream.lines();
                assert!(checkpoint.line <= swept && swept <= job.header().lines.end);
            }
            assert!(out == whole, "seed {seed}, {}", format.name);
            assert_eq!(stream.next_band(&mut out), More::End);
            assert_eq!((out.len(), stream.checkpoint()), (whole.len(), checkpoints[checkpoints.len() - 1]));
            checkpoints.dedup();
            // All of them, if they are few.
            let step = checkpoints.len().div_ceil(40);
            for from in checkpoints.iter().skip(rng.below(step as u64) as usize).step_by(step).chain(checkpoints.last()) {
                let resumed = job.stream_from(format, from).expect("a checkpoint");
                assert_eq!((resumed.offset(), resumed.checkpoint()), (from.offset, *from));
                let got = pulled(resumed, &mut rng);
                assert!(got == whole[from.offset as usize..], "seed {seed}, {}, {from:?}", format.name);
                places += 1;
            }
        }
    }
    assert!(places > 1500, "{places} places");
}

/// Every portion comes from a stream of its own, which goes on where the one before was left.
#[test]
fn a_raster_of_many_streams() {
    for seed in 7500..7500 + effort(20) {
        let mut rng = Rng::new(seed);
        let job = any_job(&mut rng, seed);
        for format in FORMATS {
            let (mut out, mut at, mut hops) = (Vec::new(), None, 0);
            loop {
                let mut stream = at.map_or_else(|| job.stream(format), |at| job.stream_from(format, &at).expect("a checkpoint"));
                let before = out.len();
                let more = loop {
                    let more = portion(&mut stream, &mut rng, &mut out);
                    if more == More::End || out.len() > before {
                        break more;
                    }
                };
                if more == More::End {
                    break;
                }
                at = Some(stream.checkpoint());
                hops += 1;
                assert!(hops < 100_000);
            }
            assert!(out == rendered(&job, format), "seed {seed}, {}, {hops} streams", format.name);
        }
    }
}

/// A stream costs what the same raster costs a thread, and knows it.
#[test]
fn a_stream_counts_as_a_thread_does() {
    for seed in 8000..8000 + effort(20) {
        let mut rng = Rng::new(seed);
        let job = any_job(&mut rng, seed);
        for format in FORMATS {
            let (mut bytes, mut stream) = (Vec::new(), job.stream(format));
            let stats = job.render(format, 1, &mut bytes, &mut |_| ()).expect("a vector takes all");
            assert_eq!(job.length(format).unwrap_or(bytes.len() as u64), bytes.len() as u64);
            while portion(&mut stream, &mut rng, &mut bytes) == More::More {}
            let cost = stream.cost();
            assert_eq!((stream.lines(), stream.runs()), (stats.lines, stats.runs));
            assert_eq!(
                (cost.rows.counted, cost.rows.repeated, cost.rows.unordered, cost.rows.toggles, cost.rows.known),
                (stats.lines_counted, stats.lines_repeated, stats.lines_unordered, stats.toggles, stats.toggles_known)
            );
            assert_eq!(cost.rows.peak_active.max(cost.spans.peak_active), stats.peak_active);
            if let Some(solid) = stats.solid {
                assert_eq!((cost.spans.spans, cost.spans.counts, cost.spans.crossings), (solid.spans, solid.depth_tests, solid.crossings));
            }
        }
    }
}

#[test]
fn formats_of_a_fixed_length_are_entered_at_any_byte() {
    for seed in 9000..9000 + effort(30) {
        let mut rng = Rng::new(seed);
        let job = any_job(&mut rng, seed);
        let header = job.header();
        let width = u64::from(header.width);
        for format in FORMATS {
            let row = match format.name {
                "pbm" => width.div_ceil(8),
                "pgm" => width,
                "ppm" => 3 * width,
                _ => {
                    assert_eq!((job.length(format), job.seek(format, 1000)), (None, None), "{}", format.name);
                    continue;
                }
            };
            let whole = rendered(&job, format);
            let length = whole.len() as u64;
            let height = u64::from(header.height());
            let head = length - height * row;
            assert_eq!(job.length(format), Some(length));
            let around = |at: u64| [at.saturating_sub(1), at, at + 1];
            let mut offsets: Vec<u64> = (0..20).map(|_| rng.below(length)).chain([0, u64::MAX]).collect();
            offsets.extend([0, head, head + row, head + rng.below(height) * row, length - row, length].into_iter().flat_map(around));
            for offset in offsets {
                let Some(from) = job.seek(format, offset) else {
                    assert!(offset < head);
                    continue;
                };
                let line = offset.checked_sub(head).expect("in the rows") / row;
                let line = line.min(height);
                let expected = Checkpoint { offset: head + line * row, line: header.lines.start + line as u32, tally: [0; 3] };
                assert_eq!(from, expected, "seed {seed}, {}, byte {offset}", format.name);
                let got = pulled(job.stream_from(format, &from).expect("a place"), &mut rng);
                assert!(got == whole[from.offset as usize..], "seed {seed}, {}, {from:?}", format.name);
            }
        }
    }
}

/// Whatever a store hands in is refused or drawn, without a panic.
#[test]
fn places_that_are_none() {
    for seed in 9500..9500 + effort(20) {
        let mut rng = Rng::new(seed);
        let job = any_job(&mut rng, seed);
        let lines = job.header().lines.clone();
        for format in FORMATS {
            for line in [0, lines.start.wrapping_sub(1), lines.end + 1, u32::MAX] {
                let from = Checkpoint { offset: 100, line, tally: [0; 3] };
                assert!(lines.contains(&line) || job.stream_from(format, &from).is_err(), "{}, {from:?}", format.name);
            }
            for _ in 0..8 {
                let mut any = || [rng.next(), u64::MAX, rng.below(3000)][rng.below(3) as usize];
                let (offset, tally) = (any(), [any(), any(), any()]);
                let line = lines.start + rng.below(u64::from(lines.end - lines.start) + 1) as u32;
                if let Ok(stream) = job.stream_from(format, &Checkpoint { offset, line, tally }) {
                    assert!(job.length(format).is_none(), "{}: it does not begin a line", format.name);
                    pulled(stream, &mut rng);
                }
            }
        }
        let pbm = by_name("pbm").expect("a format");
        let Err(error) = job.stream_from(pbm, &Checkpoint { offset: 0, line: u32::MAX, tally: [0; 3] }) else { panic!("a place") };
        assert!(error.to_string().contains(": begin at its first byte"), "{error}");
    }
}

/// A drawing of which nothing is seen: its edges are stepped, and no bytes come.
#[test]
fn a_silent_drawing_is_left_now_and_then() {
    let comb = |x: f64| (0..200).map(|i| (x + f64::from(i) * 9.0 + f64::from(i % 2) * 700.0, f64::from(i % 2) * 40_000.0)).collect();
    let shape = |x| oracle::Shape { rings: vec![comb(x)], rule: oracle::Rule::EvenOdd };
    let minus = Expr::Binary(oracle::Operator::Minus, Box::new(Expr::Shape(0)), Box::new(Expr::Shape(1)));
    let scene = Scene { width: 2600, height: 40_000, shapes: vec![shape(0.0), shape(0.0)], expr: minus };
    let job = job(&scene, 1, &Options::default());
    for name in ["ndjson", "rls", "png"] {
        let format = by_name(name).expect("a format");
        let (mut stream, mut silent, mut most) = (job.stream(format), 0, 0);
        loop {
            let (mut out, before) = (Vec::new(), stream.lines());
            let more = stream.next_band(&mut out);
            most = most.max(stream.lines() - before);
            silent += u32::from(out.is_empty());
            if more == More::End {
                break;
            }
        }
        assert_eq!(stream.lines(), 40_000);
        // About 400 edges on every line.
        assert!((600..=720).contains(&most) && (name == "png" || silent >= 40), "{name}: {most} lines, {silent} silent portions");
    }
}

#[test]
fn a_stream_may_go_to_any_thread() {
    fn any_thread<T: Send + 'static>() {}
    any_thread::<Stream>();
}
