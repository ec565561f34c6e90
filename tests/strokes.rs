//! Strokes against their definition. With round joins and caps a point is inside if it is at most half a width from the path; without caps a
//! smooth curve covers what its normals cover; corners, caps and dashes are compared with polygons worked out by hand.
//!
//! A pixel is not compared if its centre is closer to the outline than the tolerance and the rounding of vertices allow.

mod raster;

use std::time::{Duration, Instant};

use raster::Rng;
use runset::error::{Error, Kind, Warning};
use runset::job::{Job, Options, info};
use runset::scene::{Limits, Picture, Scene};
use runset::shape::{Cap, Join, Path, Shape, Stroke, Transform};
use svgtypes::{SimplePathSegment as Segment, SimplifyingPathParser};

type Point = [f64; 2];
const SIZE: u32 = 100;
const TOLERANCE: f64 = 0.1;
/// Tolerance, rounding to 1/256 px, and what the models themselves leave out.
const MARGIN: f64 = TOLERANCE + 0.01;

fn path(d: &str) -> Path {
    let mut path = Path::default();
    for segment in SimplifyingPathParser::from(d) {
        match segment.unwrap() {
            Segment::MoveTo { x, y } => path.move_to([x, y]),
            Segment::LineTo { x, y } => path.line_to([x, y]),
            Segment::Quadratic { x1, y1, x, y } => path.quad_to([x1, y1], [x, y]),
            Segment::CurveTo { x1, y1, x2, y2, x, y } => path.cubic_to([x1, y1], [x2, y2], [x, y]),
            Segment::ClosePath => path.close(),
        }
    }
    path
}

fn job(path: Path, stroke: Stroke, transform: [f64; 6]) -> Result<Job, Error> {
    let mut scene = Scene::new(f64::from(SIZE), f64::from(SIZE));
    let area = scene.add_shape(Shape { stroke: Some(stroke), transform: Transform::Affine(transform), ..Shape::new("s", path) });
    scene.picture = Picture::Region(area);
    Job::prepare(scene, &Options { tolerance: TOLERANCE, ..Options::default() }, &mut Vec::new())
}

fn rows(job: &Job) -> Vec<Vec<bool>> {
    let mut rows = job.rows();
    let mut all = Vec::new();
    while let Some(lines) = rows.next() {
        let mut row = vec![false; job.header().width as usize];
        lines.runs.iter().for_each(|run| row[run.start as usize..run.end as usize].fill(true));
        all.extend(std::iter::repeat_n(row, lines.n as usize));
    }
    all
}

const STAND: [f64; 6] = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];

fn picture(d: &str, stroke: &Stroke) -> Vec<Vec<bool>> {
    rows(&job(path(d), stroke.clone(), STAND).unwrap())
}

/// One pixel of so many.
fn some(every: usize) -> impl Iterator<Item = (usize, usize, Point)> {
    centres().filter(move |(x, y, _)| (x + 3 * y) % every == 0)
}

fn centres() -> impl Iterator<Item = (usize, usize, Point)> {
    (0..SIZE as usize).flat_map(|y| (0..SIZE as usize).map(move |x| (x, y, [x as f64 + 0.5, y as f64 + 0.5])))
}

fn at(points: &[Point], t: f64) -> Point {
    let mut points = points.to_vec();
    while points.len() > 1 {
        points = points.windows(2).map(|w| [0, 1].map(|i| w[0][i] * (1.0 - t) + w[1][i] * t)).collect();
    }
    points[0]
}

fn distance(p: Point, a: Point, b: Point) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let t = (((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy).max(1e-300)).clamp(0.0, 1.0);
    (p[0] - a[0] - t * dx).hypot(p[1] - a[1] - t * dy)
}

fn random(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * f64::from(rng.below(1 << 20)) / f64::from(1 << 20)
}

/// A random path with all that makes strokes hard, and its points, close together.
fn random_path(rng: &mut Rng) -> (Path, Vec<Vec<Point>>) {
    let (mut path, mut lines) = (Path::default(), Vec::new());
    for _ in 0..1 + rng.below(2) {
        let (centre, spread) = ([random(rng, 20., 80.), random(rng, 20., 80.)], [3.0, 15.0, 40.0][rng.below(3) as usize]);
        let mut at_end = centre;
        let some = |rng: &mut Rng, last: Point| match rng.below(8) {
            0 => last,
            1 => [last[0] + random(rng, -0.01, 0.01), last[1]],
            2 => [last[0], centre[1] + random(rng, -spread, spread)],
            _ => [centre[0] + random(rng, -spread, spread), centre[1] + random(rng, -spread, spread)],
        };
        path.move_to(at_end);
        let start = at_end;
        let mut line = vec![start];
        for _ in 0..1 + rng.below(4) {
            let mut control = vec![at_end];
            let degree = 1 + rng.below(3);
            for _ in 0..degree {
                control.push(some(rng, at_end));
            }
            if degree == 3 && rng.below(8) == 0 {
                control[3] = control[0];
            }
            match degree {
                1 => path.line_to(control[1]),
                2 => path.quad_to(control[1], control[2]),
                _ => path.cubic_to(control[1], control[2], control[3]),
            }
            line.extend((1..=150).map(|k| at(&control, f64::from(k) / 150.0)));
            at_end = control[degree as usize];
        }
        if rng.below(3) == 0 {
            path.close();
            line.push(start);
        }
        lines.push(line);
    }
    (path, lines)
}

#[test]
fn round_strokes_are_what_is_near_the_path() {
    let rng = &mut Rng(1);
    let (mut compared, mut inside, mut pictures) = (0_u32, 0_u32, 0);
    for n in 0..120 {
        let (path, lines) = random_path(rng);
        let width = [random(rng, 0.5, 4.0), random(rng, 4.0, 30.0), random(rng, 30.0, 80.0)][n % 3];
        let turn = random(rng, 0.0, 6.3);
        let (sine, cosine) = turn.sin_cos();
        let [along, across] = if n % 2 == 0 { [1.0, 1.0] } else { [random(rng, 0.6, 2.0), random(rng, 0.6, 2.0)] };
        let flip = if n % 5 == 0 { -1.0 } else { 1.0 };
        // Stretched along a turned axis, around the middle of the page.
        let [a, b, c, d] = [
            along * cosine * cosine + across * sine * sine,
            (along - across) * sine * cosine * flip,
            (along - across) * sine * cosine,
            (along * sine * sine + across * cosine * cosine) * flip,
        ];
        let transform = [a, b, c, d, 50.0 - a * 50.0 - c * 50.0, 50.0 - b * 50.0 - d * 50.0];
        let stroke = Stroke { join: Join::Round, cap: Cap::Round, ..Stroke::new(width) };
        let found = rows(&job(path.clone(), stroke, transform).unwrap());
        let determinant = a * d - b * c;
        let slack = MARGIN / along.min(across);
        pictures += 1;
        for (x, y, p) in some(5) {
            let [u, v] = [p[0] - transform[4], p[1] - transform[5]];
            let p = [(d * u - c * v) / determinant, (a * v - b * u) / determinant];
            let far = lines.iter().flat_map(|line| line.windows(2)).map(|w| distance(p, w[0], w[1])).fold(f64::MAX, f64::min);
            if (far - width / 2.0).abs() > slack {
                compared += 1;
                inside += u32::from(found[y][x]);
                assert_eq!(found[y][x], far < width / 2.0, "{n}: pixel {x} {y} is {far} away, width {width}, {transform:?}, {path:?}");
            }
        }
    }
    assert!(compared > 90 * pictures * 20 && inside > compared / 20 && inside < compared * 19 / 20, "{inside} of {compared}");
}

/// Without caps, a point belongs to a smooth curve if it lies on a normal of it, at most half a width away.
#[test]
fn butt_strokes_are_what_the_normals_cover() {
    let rng = &mut Rng(2);
    let (mut compared, mut inside) = (0_u32, 0_u32);
    for n in 0..30 {
        let spread = [6.0, 20.0, 45.0][n % 3];
        let control: Vec<Point> = (0..4).map(|_| [50.0 + random(rng, -spread, spread), 50.0 + random(rng, -spread, spread)]).collect();
        let width = [random(rng, 1.0, 10.0), random(rng, 10.0, 60.0)][n % 2];
        let points: Vec<Point> = (0..=600).map(|k| at(&control, f64::from(k) / 600.0)).collect();
        let derivative: Vec<Point> = control.windows(2).map(|w| [0, 1].map(|i| 3.0 * (w[1][i] - w[0][i]))).collect();
        let tangents: Vec<Point> = (0..=600).map(|k| at(&derivative, f64::from(k) / 600.0)).collect();
        let along = |p: Point, k: usize| (p[0] - points[k][0]) * tangents[k][0] + (p[1] - points[k][1]) * tangents[k][1];
        let covered = |p: Point| {
            let mut last = along(p, 0);
            (1..points.len()).any(|k| {
                let next = along(p, k);
                let crossed = (last <= 0.0) != (next <= 0.0) && distance(p, points[k - 1], points[k]) <= width / 2.0;
                last = next;
                crossed
            })
        };
        let mut path = Path::default();
        path.move_to(control[0]);
        path.cubic_to(control[1], control[2], control[3]);
        let found = rows(&job(path, Stroke::new(width), STAND).unwrap());
        for (x, y, p) in some(7) {
            let holds = covered(p);
            // The margin is double: at the ends both the sides and the normals are approximated.
            let mut around = (0..8).map(|k| (f64::from(k) * std::f64::consts::FRAC_PI_4).sin_cos());
            if around.all(|(dy, dx)| covered([p[0] + 2.0 * MARGIN * dx, p[1] + 2.0 * MARGIN * dy]) == holds) {
                compared += 1;
                inside += u32::from(holds);
                assert_eq!(found[y][x], holds, "{n}: pixel {x} {y}, width {width}, {control:?}");
            }
        }
    }
    assert!(compared > 30_000 && inside > compared / 20, "{inside} of {compared}");
}

/// Winding number of a ring around a point, by the crossings of a ray to the right.
fn winding(ring: &[Point], [x, y]: Point) -> i32 {
    let ends = ring.iter().zip(ring.iter().cycle().skip(1));
    let across = |p: &Point, q: &Point| (p[1] <= y) != (q[1] <= y) && p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0]) > x;
    ends.filter(|(p, q)| across(p, q)).map(|(p, q)| if p[1] < q[1] { 1 } else { -1 }).sum()
}

/// Compares a stroke with the union of polygons; pixels whose centre is on an edge are left out.
fn compare(d: &str, stroke: &Stroke, polygons: &[&[Point]]) {
    let found = picture(d, stroke);
    let mut inside = 0;
    for (x, y, p) in centres() {
        let edge = |ring: &[Point]| ring.iter().zip(ring.iter().cycle().skip(1)).any(|(a, b)| distance(p, *a, *b) < 0.01);
        let holds = polygons.iter().any(|ring| winding(ring, p) != 0);
        inside += u32::from(holds);
        if !polygons.iter().any(|ring| edge(ring)) {
            assert_eq!(found[y][x], holds, "{d} {stroke:?}: pixel {x} {y}");
        }
    }
    assert!(inside > 0 || polygons.is_empty());
}

fn rectangle(left: f64, top: f64, right: f64, bottom: f64) -> [Point; 4] {
    [[left, top], [right, top], [right, bottom], [left, bottom]]
}

#[test]
fn joins_are_those_worked_out_by_hand() {
    let corner = "M10 50H50V10";
    let of = |join, miter_limit| Stroke { join, miter_limit, ..Stroke::new(10.0) };
    let arms: [Point; 4] = [[10., 55.], [10., 45.], [45., 45.], [45., 10.]];
    let with = |outer: &[Point]| [&arms[..], &[[55., 10.]], outer].concat();
    // The miter of a right angle is the root of 2 in widths.
    compare(corner, &of(Join::Miter, 1.5), &[&with(&[[55., 55.]])]);
    compare(corner, &of(Join::Miter, 1.41), &[&with(&[[55., 50.], [50., 55.]])]);
    compare(corner, &of(Join::Bevel, 4.0), &[&with(&[[55., 50.], [50., 55.]])]);
    // Cut off 5 from the corner: 5 (1 - cos 45) / sin 45 behind the bevel's corners.
    compare(corner, &of(Join::MiterClip, 1.0), &[&with(&[[55., 52.071], [52.071, 55.]])]);
    compare(corner, &of(Join::MiterClip, 1.5), &[&with(&[[55., 55.]])]);
    // The same corner, turned the other way, in a closed square: outside 20 to 70, inside 30 to 60.
    let square =
        [rectangle(20., 20., 70., 30.), rectangle(20., 60., 70., 70.), rectangle(20., 20., 30., 70.), rectangle(60., 20., 70., 70.)];
    let square: Vec<&[Point]> = square.iter().map(|r| &r[..]).collect();
    compare("M25 25H65V65H25Z", &of(Join::Miter, 4.0), &square);
    compare("M25 25V65H65V25Z", &of(Join::Miter, 4.0), &square);
    compare("M25 25V65H65V25L25 25Z", &of(Join::Miter, 4.0), &square);
    // A hexagon's miter is 1 / sin 60 of a width: exactly at the limit it stays.
    let sharp = "M10 50L50 50L30 15.358984";
    let tip = 50.0 + 5.0 / 30_f64.to_radians().tan();
    let inner = 50.0 - 5.0 / 30_f64.to_radians().tan();
    let (dx, dy) = (5.0 * 30_f64.to_radians().cos(), 5.0 * 30_f64.to_radians().sin());
    let ring = [[10., 45.], [inner, 45.], [30. - dx, 15.358_984 + dy], [30. + dx, 15.358_984 - dy], [tip, 55.], [10., 55.]];
    compare(sharp, &of(Join::Miter, 2.0), &[&ring]);
    let bevel =
        [[10., 45.], [inner, 45.], [30. - dx, 15.358_984 + dy], [30. + dx, 15.358_984 - dy], [50. + dx, 50. - dy], [50., 55.], [10., 55.]];
    compare(sharp, &of(Join::Miter, 1.99), &[&bevel]);
    // There and back: a miter has no end, so it is a bevel, and that is nothing.
    compare("M20 50H60H30", &of(Join::Miter, 1e9), &[&rectangle(20., 45., 60., 55.)]);
    compare("M20 50H60H30", &of(Join::MiterClip, 2.0), &[&rectangle(20., 45., 70., 55.)]);
}

#[test]
fn caps_and_dots_are_those_worked_out_by_hand() {
    let of = |cap| Stroke { cap, ..Stroke::new(10.0) };
    compare("M20 50H60", &of(Cap::Butt), &[&rectangle(20., 45., 60., 55.)]);
    compare("M20 50H60", &of(Cap::Square), &[&rectangle(15., 45., 65., 55.)]);
    // Perpendicular to the true tangent, although the curve bends away at once.
    compare("M50 50C50 30 50 30 50 20", &of(Cap::Butt), &[&rectangle(45., 20., 55., 50.)]);
    // Subpaths without length are dots, unless the cap is butt; what is only moved to is nothing.
    for dot in ["M20 30L20 30", "M20 30Z", "M20 30C20 30 20 30 20 30", "M20 30H20V30Z", "M5 5M20 30H20"] {
        compare(dot, &of(Cap::Square), &[&rectangle(15., 25., 25., 35.)]);
        compare(dot, &of(Cap::Butt), &[]);
        let disc = picture(dot, &of(Cap::Round));
        for (x, y, p) in centres() {
            let far = (p[0] - 20.0).hypot(p[1] - 30.0);
            assert!((far - 5.0).abs() < MARGIN || disc[y][x] == (far < 5.0), "{dot}: {x} {y}");
        }
    }
    compare("M20 30", &of(Cap::Square), &[]);
    for width in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        compare("M20 50H60", &Stroke { cap: Cap::Round, ..Stroke::new(width) }, &[]);
    }
}

#[test]
fn dashes_are_those_worked_out_by_hand() {
    let of = |dashes: &[f64], dash_offset| Stroke { dashes: dashes.to_vec(), dash_offset, ..Stroke::new(10.0) };
    let bars = |bars: &[(f64, f64)]| bars.iter().map(|&(from, to)| rectangle(from, 45., to, 55.)).collect::<Vec<_>>();
    for (dashes, offset, expected) in [
        (&[20., 10.][..], 5.0, &[(10., 25.), (35., 55.), (65., 85.)][..]),
        (&[20., 10.], -5.0, &[(15., 35.), (45., 65.), (75., 90.)]),
        (&[20., 10.], 3e9 + 5.0, &[(10., 25.), (35., 55.), (65., 85.)]),
        (&[30.], 0.0, &[(10., 40.), (70., 90.)]),
        (&[10., 5., 20.], 0.0, &[(10., 20.), (25., 45.), (55., 60.), (80., 90.)]),
        (&[0.0, 0.0], 0.0, &[(10., 90.)]),
        (&[5.0, -1.0], 0.0, &[(10., 90.)]),
        (&[500.0, 1.0], 0.0, &[(10., 90.)]),
    ] {
        let bars = bars(expected);
        let bars: Vec<&[Point]> = bars.iter().map(|r| &r[..]).collect();
        compare("M10 50H90", &of(dashes, offset), &bars);
        // The same line in several pieces.
        compare("M10 50H33L60 50C70 50 80 50 90 50", &of(dashes, offset), &bars);
    }
    // Dots: dashes without length have caps.
    let dots = [rectangle(15., 45., 25., 55.), rectangle(35., 45., 45., 55.), rectangle(55., 45., 65., 55.)];
    let dots: Vec<&[Point]> = dots.iter().map(|r| &r[..]).collect();
    compare("M20 50H75", &Stroke { cap: Cap::Square, ..of(&[0.0, 20.0], 0.0) }, &dots);
    compare("M20 50H75", &of(&[0.0, 20.0], 0.0), &[]);
    // A dash around a corner is joined there; on a closed subpath the last dash goes on into the first.
    let corner = [[30., 45.], [65., 45.], [65., 70.], [55., 70.], [55., 55.], [30., 55.]];
    compare("M20 50H60V80", &of(&[50.0, 1000.0], -10.0), &[&corner]);
    let joined = [[20., 35.], [20., 20.], [35., 20.], [35., 30.], [30., 30.], [30., 35.]];
    compare("M25 25H65V65H25Z", &of(&[20.0, 140.0], 10.0), &[&joined]);
    let cut = [rectangle(25., 20., 35., 30.), rectangle(20., 25., 30., 35.)];
    compare("M25 25H65V65H25V25", &of(&[20.0, 140.0], 10.0), &[&cut[0], &cut[1]]);
}

/// Dashes on a circle lie where the arc length says, also after many turns.
#[test]
fn dashes_on_curves_follow_the_arc_length() {
    let turns = 40.0;
    // A circle of radius 40 in so many arcs, turn after turn, as one subpath.
    let arcs = 720;
    let step = std::f64::consts::TAU * turns / f64::from(arcs);
    let on = |angle: f64| [50.0 + 40.0 * angle.cos(), 50.0 + 40.0 * angle.sin()];
    let k = 40.0 * 4.0 / 3.0 * (step / 4.0).tan();
    let mut path = Path::default();
    path.move_to(on(0.0));
    for i in 0..arcs {
        let [a, b] = [f64::from(i) * step, f64::from(i + 1) * step];
        let [p, q] = [on(a), on(b)];
        path.cubic_to([p[0] - k * a.sin(), p[1] + k * a.cos()], [q[0] + k * b.sin(), q[1] - k * b.cos()], q);
    }
    // The period divides the circle, so that all turns coincide.
    let period = std::f64::consts::TAU * 40.0 / 24.0;
    let found = rows(&job(path, Stroke { dashes: vec![period / 2.0, period / 2.0], ..Stroke::new(12.0) }, STAND).unwrap());
    let mut compared = 0;
    for (x, y, [px, py]) in centres() {
        let (far, angle) = ((px - 50.0).hypot(py - 50.0), (py - 50.0).atan2(px - 50.0).rem_euclid(std::f64::consts::TAU));
        let phase = (angle * 40.0 / period).fract();
        let near = [0.0, 0.5, 1.0].iter().any(|edge| (phase - edge).abs() * period * far / 40.0 < 2.0 * MARGIN);
        if !near && ((far - 40.0).abs() - 6.0).abs() > MARGIN {
            compared += 1;
            assert_eq!(found[y][x], (far - 40.0).abs() < 6.0 && phase < 0.5, "{x} {y}");
        }
    }
    assert!(compared > 8000, "{compared}");
}

#[test]
fn far_geometry_costs_what_is_seen_of_it() {
    let started = Instant::now();
    let solid = Stroke::new(10.0);
    let dashed = |a: f64, b: f64| Stroke { dashes: vec![a, b], ..solid.clone() };
    // A line of two million kilometres, and where its dashes lie after half of them: 10^9 is 10 more than a multiple of 30.
    compare("M-1e9 50H1e9", &solid, &[&rectangle(-9., 45., 200., 55.)]);
    compare(
        "M-1e9 50H1e9",
        &dashed(20.0, 10.0),
        &[&rectangle(-9., 45., 10., 55.), &rectangle(20., 45., 40., 55.), &rectangle(50., 45., 70., 55.), &rectangle(80., 45., 100., 55.)],
    );
    for d in ["M-1e30 -1e30L1e30 1e30", "M0 0C1e20 0 1e20 1e20 0 1e20", "M1e300 0L-1e300 1Z", "M-1e9 0Q50 1e9 1e9 0", "M1e9 1e9h1v1z"] {
        for width in [1e-30, 1.0, 1e6, 1e30] {
            for style in [solid.clone(), dashed(3.0, 2.0), dashed(1e-3, 1e20)] {
                for (join, cap) in [(Join::Miter, Cap::Butt), (Join::Round, Cap::Round), (Join::MiterClip, Cap::Square)] {
                    let stroke = Stroke { width, join, cap, miter_limit: 1e6, ..style.clone() };
                    let now = Instant::now();
                    if let Ok(job) = job(path(d), stroke.clone(), STAND) {
                        rows(&job);
                    }
                    assert!(now.elapsed() < Duration::from_secs(5), "{d} {stroke:?}");
                }
            }
        }
    }
    for transform in [[0.0; 6], [1e-300, 0.0, 0.0, 1e-300, 50.0, 50.0], [1e200, 0.0, 0.0, 1e-200, 0.0, 0.0], [1.0, 2.0, 2.0, 4.0, 0.0, 0.0]]
    {
        let ran = job(path("M0 0L50 50C1 2 3 4 5 6Z"), Stroke { join: Join::Round, cap: Cap::Round, ..dashed(1.0, 1.0) }, transform);
        if let Ok(job) = ran {
            rows(&job);
        }
    }
    assert!(started.elapsed() < Duration::from_secs(60), "{:?}", started.elapsed());
}

#[test]
fn too_many_dashes_are_refused_by_name() {
    let error = job(path("M0 0L1e6 1"), Stroke { dashes: vec![1e-9], ..Stroke::new(1.0) }, STAND).unwrap_err();
    assert_eq!((error.kind, error.what.as_str()), (Kind::Limit, "\"s\": more than 10000000 dashes and gaps: use longer ones"));
    // So many off the page cost nothing.
    assert!(job(path("M0 -1e9L1e15 -1e9"), Stroke { dashes: vec![1e-9], ..Stroke::new(1.0) }, STAND).is_ok());
}

/// A thin smooth line costs about two edges for every piece of its curves, a thick one on a long way not many more.
#[test]
fn outlines_are_not_much_longer_than_the_path() {
    let edges = |stroke: Stroke| {
        let mut scene = Scene::new(100.0, 100.0);
        let mut circle = Path::default();
        circle.circle([50.0, 50.0], 40.0);
        let area = scene.add_shape(Shape { stroke: Some(stroke), ..Shape::new("s", circle) });
        scene.add_name(runset::scene::Named { id: "s".to_owned(), kind: "path", area, shapes: 0..1, depth: 0 });
        info(&scene).unwrap().ids[0].edges
    };
    let (thin, thick) = (edges(Stroke::new(1.0)), edges(Stroke::new(20.0)));
    assert!(thin < 170 && thick < 170, "{thin} {thick}");
}

fn read(inside: &str) -> (Scene, Vec<Warning>) {
    let text = format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="100" height="100">{inside}</svg>"#);
    let mut warnings = Vec::new();
    (runset::input::read(text.into_bytes(), &Limits::default(), &mut warnings).unwrap(), warnings)
}

fn drawn(inside: &str, expr: &str) -> Vec<Vec<bool>> {
    let options = Options { expr: Some(expr.to_owned()), ..Options::default() };
    rows(&Job::prepare(read(inside).0, &options, &mut Vec::new()).unwrap())
}

fn filled(rectangles: &[[usize; 4]]) -> Vec<Vec<bool>> {
    let inside = |x: usize, y: usize| rectangles.iter().any(|r| (r[0]..r[2]).contains(&x) && (r[1]..r[3]).contains(&y));
    (0..100).map(|y| (0..100).map(|x| inside(x, y)).collect()).collect()
}

#[test]
fn an_element_is_its_fill_and_its_stroke() {
    let rect = |style: &str| format!(r#"<rect id="a" x="30" y="40" width="20" height="20" {style}/>"#);
    for (inside, expected) in [
        (rect(r#"stroke="red" stroke-width="10""#), &[[25, 35, 55, 65]][..]),
        (rect(r#"fill="none" stroke="red" stroke-width="10""#), &[[25, 35, 55, 45], [25, 55, 55, 65], [25, 35, 35, 65], [45, 35, 55, 65]]),
        (rect(r#"stroke="red" stroke-width="10" stroke-opacity="0""#), &[[30, 40, 50, 60]]),
        (rect(r#"stroke="red" stroke-width="0""#), &[[30, 40, 50, 60]]),
        (rect(r#"stroke="red" stroke-width="-3""#), &[[30, 40, 50, 60]]),
        (rect(r#"style="stroke:red;stroke-width:10%""#), &[[25, 35, 55, 65]]),
        // Uneven scale: twice as thick from left to right.
        (r#"<path id="a" transform="scale(2 1)" d="M20 20V60" stroke="red" stroke-width="5"/>"#.to_owned(), &[[35, 20, 45, 60]]),
        (r#"<g id="a" stroke="red" stroke-width="4"><line x1="10" y1="20" x2="30" y2="20"/><path d="M50 20v10"/></g>"#.to_owned(), &[
            [10, 18, 30, 22],
            [48, 20, 52, 30],
        ]),
        (r#"<line id="a" x1="10" y1="20" x2="90" y2="20" stroke="red" stroke-width="4" stroke-dasharray="20,10" stroke-dashoffset="10"/>"#.to_owned(), &[
            [10, 18, 20, 22],
            [30, 18, 50, 22],
            [60, 18, 80, 22],
        ]),
        // A dot, through the SVG library.
        (r#"<path id="a" d="M20 30h0" stroke="red" stroke-width="10" stroke-linecap="square"/>"#.to_owned(), &[[15, 25, 25, 35]]),
        (r##"<marker id="m" overflow="visible"><path d="M-5 -5H5V5H-5Z"/></marker><path d="M20 20H50" marker-end="url(#m)"/>"##.to_owned(), &[
            [45, 15, 55, 25],
        ]),
    ] {
        let expr = if inside.contains("marker") { "art" } else { "a" };
        assert!(drawn(&inside, expr) == filled(expected), "{inside}");
        assert!(read(&inside).1.iter().all(|w| w.what.contains("markers")), "{inside}");
    }
}

#[test]
fn stroke_and_fill_are_painted_in_their_order() {
    for (order, expected) in
        [("normal", [[0, 0, 255], [255, 0, 0]]), ("stroke", [[255, 0, 0], [0, 0, 255]]), ("markers stroke", [[255, 0, 0], [0, 0, 255]])]
    {
        let scene = read(&format!(r#"<circle id="a" r="9" fill="blue" stroke="red" paint-order="{order}"/>"#)).0;
        let Picture::Layers(layers) = &scene.picture else { panic!("layers") };
        assert_eq!(layers.iter().map(|l| l.ink).collect::<Vec<_>>(), expected, "{order}");
        assert_eq!(scene.named("a").unwrap().shapes, 0..2);
    }
}

#[test]
fn what_strokes_cannot_do_is_said() {
    for (style, what) in [
        (r#"stroke-linejoin="arcs""#, "joins of the kind arcs are not drawn: mitered instead"),
        (r#"style="stroke-linejoin: arcs""#, "joins of the kind arcs are not drawn: mitered instead"),
        (r#"vector-effect="non-scaling-stroke""#, "strokes that do not scale are not drawn: scaled instead"),
        (r#"style="vector-effect:non-scaling-stroke""#, "strokes that do not scale are not drawn: scaled instead"),
    ] {
        let warnings = read(&format!(r#"<path id="a" d="M10 10L50 50" stroke="red" {style}/>"#)).1;
        assert_eq!(warnings.iter().map(|w| w.what.clone()).collect::<Vec<_>>(), [format!("\"a\": {what}")]);
    }
}
