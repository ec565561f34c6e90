//! What is told of a scanline is what the pixels say: the counts, played from left to right, hold where brute force says so, for the expression
//! and for every shape in it; and the lines that are told as counted are as many as the statistics have.

mod oracle;

use std::ops::Range;

use oracle::random::Rng;
use oracle::{Expr, Oracle, Scene};
use runset::encode;
use runset::input;
use runset::job::{Explanation, How, Job, Line, Options, Size, Vertex, explain};
use runset::scene::Limits;

fn effort(n: u64) -> u64 {
    n * std::env::var("RUNSET_EFFORT").map_or(1, |effort| effort.parse().expect("a number"))
}

fn read(document: &str) -> runset::scene::Scene {
    input::read(document.as_bytes().to_vec(), &Limits::default(), &mut Vec::new()).expect("the scene is read")
}

fn told(document: &str, options: &Options) -> Explanation {
    explain(read(document), options, &mut Vec::new()).expect("the scene is explained")
}

/// Whether a node holds with that count: what the rules are called, taken at their word.
fn holds(node: &Vertex, count: i32) -> bool {
    match (node.rule, node.k) {
        ("nonzero", None) => count != 0,
        ("odd", None) => count % 2 != 0,
        ("everywhere", None) => true,
        ("atleast", Some(k)) => count >= k,
        other => panic!("{other:?}"),
    }
}

/// Where a node holds on a line, and what its count is, pixel by pixel.
fn played(line: &Line, node: usize, width: u32) -> Vec<(i32, bool)> {
    let vertex = &line.nodes[node];
    let mut count = vertex.start;
    let mut steps = line.steps.iter().peekable();
    let pixel = |x| {
        while let Some(step) = steps.next_if(|step| step.column <= x) {
            count = step.counts.iter().find(|change| change.0 == node).map_or(count, |change| change.1);
        }
        (count, holds(vertex, count))
    };
    (0..width).map(pixel).collect()
}

fn pixels(runs: &[Range<u32>], width: u32) -> Vec<bool> {
    (0..width).map(|x| runs.iter().any(|run| run.contains(&x))).collect()
}

fn check(scene: &Scene, y: u32) {
    let explained = told(&scene.json(), &Options { lines: Some(y..y + 1), ..Options::default() });
    let line = explained.line.expect("one line was asked about");
    let expected = Oracle::new(scene).row(y);
    let runs: Vec<Range<u32>> = line.runs.iter().map(|&[start, end, _]| start..end).collect();
    assert_eq!(runs, expected, "runs of line {y}");
    let truths = |node| played(&line, node, scene.width).into_iter().map(|pixel| pixel.1).collect::<Vec<_>>();
    let root = line.nodes.iter().position(|node| node.ink.is_some()).expect("the picture is told");
    assert_eq!(truths(root), pixels(&expected, scene.width), "the picture on line {y}");
    for (i, node) in line.nodes.iter().enumerate() {
        let shape = (0..scene.shapes.len()).find(|&shape| node.name.as_deref() == Some(&oracle::text::name(shape)));
        if let Some(shape) = shape {
            let alone = Scene { expr: Expr::Shape(shape), shapes: scene.shapes.clone(), ..*scene };
            assert_eq!(truths(i), pixels(&Oracle::new(&alone).row(y), scene.width), "shape {shape} on line {y}");
        }
        // A sum of truths, where all of them are told.
        if node.inputs.len() == node.operands && node.operands > 0 {
            let counts: Vec<i32> = played(&line, i, scene.width).into_iter().map(|pixel| pixel.0).collect();
            let mut sums = vec![0; scene.width as usize];
            for &(input, weight) in &node.inputs {
                sums.iter_mut().zip(truths(input)).for_each(|(sum, holds)| *sum += weight * i32::from(holds));
            }
            assert_eq!(counts, sums, "node {i} on line {y}");
        }
    }
}

#[test]
fn counts_hold_where_pixels_are() {
    for seed in 0..effort(150) {
        let scene = oracle::random::scene(seed);
        let mut rng = Rng::new(seed);
        for _ in 0..4 {
            check(&scene, rng.below(scene.height.into()) as u32);
        }
    }
}

#[test]
fn as_many_lines_are_told_as_the_statistics_count() {
    let mut tried = 0;
    for seed in 0..effort(60) {
        let document = oracle::random::scene(seed).json();
        let options = Options { size: Size::Scale([1.0, 7.3, 40.0][seed as usize % 3]), ..Options::default() };
        // Scaled up, some scenes reach beyond what can be drawn.
        let Ok(job) = Job::prepare(read(&document), &options, &mut Vec::new()) else { continue };
        let explained = told(&document, &options);
        tried += 1;
        let stats = job.render(encode::by_name("rls").unwrap(), 2, &mut Vec::new(), &mut |_| ()).unwrap();
        let lines = |kinds: &[How]| explained.lines.iter().filter(|l| kinds.contains(&l.2)).map(|l| u64::from(l.1)).sum::<u64>();
        assert_eq!(lines(&[How::Counted, How::Unordered]), stats.lines_counted, "seed {seed}");
        assert_eq!(lines(&[How::Repeated]), stats.lines_repeated, "seed {seed}");
        // Without a gap, and the same for a part of the page.
        let ends: Vec<u32> = explained.lines.iter().map(|l| l.0 + l.1).collect();
        assert!(explained.lines.iter().skip(1).map(|l| l.0).eq(ends[..ends.len() - 1].iter().copied()));
        assert_eq!(ends.last(), Some(&stats.lines));
        let (from, to) = (stats.lines / 3, stats.lines / 3 + 1 + stats.lines / 2);
        let part = told(&document, &Options { lines: Some(from..to.min(stats.lines)), ..options });
        let each =
            |explained: &Explanation| explained.lines.iter().flat_map(|&(y, n, how)| (y..y + n).map(move |y| (y, how))).collect::<Vec<_>>();
        let whole: Vec<_> = each(&explained).into_iter().filter(|line| (from..to).contains(&line.0)).collect();
        assert_eq!(each(&part), whole, "seed {seed}");
    }
    assert!(tried > effort(40), "{tried} scenes");
}

#[test]
fn the_figures_of_the_paper() {
    // Figures 2.10 to 2.12 have two overlapping shapes: f1 in columns 4..10, f2 in 7..14.
    let document = |expr: &str| {
        format!(
            r#"{{"width":16,"height":2,"expr":"{expr}","shapes":{{
                "f1":{{"rings":[[[4,0],[10,0],[10,2],[4,2]]]}},"f2":{{"rings":[[[7,0],[14,0],[14,2],[7,2]]]}}}}}}"#
        )
    };
    let counts = |expr: &str| {
        let line = told(&document(expr), &Options { lines: Some(1..2), ..Options::default() }).line.unwrap();
        assert_eq!(line.since, 0, "nothing moves: line 1 is line 0 again");
        let root = line.nodes.iter().position(|node| node.ink.is_some()).unwrap();
        (played(&line, root, 16).into_iter().map(|pixel| pixel.0.to_string()).collect::<String>(), line.nodes[root].k, line.runs)
    };
    assert_eq!(counts("f1 & f2"), ("0000111222111100".to_owned(), Some(2), vec![[7, 10, 0]]));
    assert_eq!(counts("f1 | f2"), ("0000111222111100".to_owned(), Some(1), vec![[4, 14, 0]]));
    assert_eq!(counts("f1 - f2").2, vec![[4, 7, 0]]);
}

#[test]
fn too_many_lines_are_refused() {
    let document = r#"{"width":4,"height":100000,"expr":"a","shapes":{"a":{"rings":[[[0,0],[2,0],[2,9]]]}}}"#;
    let error = explain(read(document), &Options::default(), &mut Vec::new()).unwrap_err();
    assert!(error.what.contains("8192"), "{}", error.what);
    assert!(explain(read(document), &Options { lines: Some(90_000..90_001), ..Options::default() }, &mut Vec::new()).is_ok());
}
