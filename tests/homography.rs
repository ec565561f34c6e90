//! Shapes under a homography, against the definition: a pixel belongs to a shape if the point that the homography takes there does.
//!
//! Vertices are rounded to 1/256 px behind the homography, so pixels whose centre lies within a hundredth of a pixel of an outline are not
//! compared; everything else is, polygons that pass through infinity too.

mod oracle;

use oracle::random::Rng;
use runset::job::{Job, Options};
use runset::scene::{Picture, Scene};
use runset::shape::{FillRule, Path, Shape, Transform};

type Matrix = [f64; 9];
const SIZE: u32 = 60;

fn inverse([a, b, c, d, e, f, g, h, i]: Matrix) -> Matrix {
    let determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
    let adjoint = [
        e * i - f * h,
        c * h - b * i,
        b * f - c * e,
        f * g - d * i,
        a * i - c * g,
        c * d - a * f,
        d * h - e * g,
        b * g - a * h,
        a * e - b * d,
    ];
    adjoint.map(|v| v / determinant)
}

fn apply([a, b, c, d, e, f, g, h, i]: Matrix, [x, y]: [f64; 2]) -> [f64; 2] {
    let w = g * x + h * y + i;
    [(a * x + b * y + c) / w, (d * x + e * y + f) / w]
}

/// Winding number of a ring around a point, by the crossings of a ray to the right.
fn winding(ring: &[[f64; 2]], [x, y]: [f64; 2]) -> i32 {
    let ends = ring.iter().zip(ring.iter().cycle().skip(1));
    ends.map(|(p, q)| {
        let across = (p[1] <= y) != (q[1] <= y) && p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0]) > x;
        if !across {
            0
        } else if p[1] < q[1] {
            1
        } else {
            -1
        }
    })
    .sum()
}

fn picture(path: Path, rule: FillRule, matrix: Matrix) -> Vec<Vec<bool>> {
    let mut scene = Scene::new(f64::from(SIZE), f64::from(SIZE));
    let area = scene.add_shape(Shape { rule, transform: Transform::Projective(matrix), ..Shape::new("s", path) });
    scene.picture = Picture::Region(area);
    let job = Job::prepare(scene, &Options::default(), &mut Vec::new()).unwrap();
    let mut rows = job.rows();
    let mut all = Vec::new();
    while let Some(lines) = rows.next() {
        let mut row = vec![false; SIZE as usize];
        lines.runs.iter().for_each(|run| row[run.start as usize..run.end as usize].fill(true));
        all.extend(std::iter::repeat_n(row, lines.n as usize));
    }
    all
}

/// Compares a picture with the definition; gives how many pixels were compared, and how many of them were inside.
fn compare(seed: u64, picture: &[Vec<bool>], ring: &[[f64; 2]], rule: FillRule, back: Matrix, margin: f64) -> (u32, u32) {
    let inside = |p: [f64; 2]| match rule {
        FillRule::NonZero => winding(ring, apply(back, p)) != 0,
        FillRule::EvenOdd => winding(ring, apply(back, p)) % 2 != 0,
    };
    let (mut compared, mut held) = (0, 0);
    for y in 0..SIZE {
        for x in 0..SIZE {
            let centre = [f64::from(x) + 0.5, f64::from(y) + 0.5];
            let truth = inside(centre);
            let around = (0..16)
                .map(|k| f64::from(k) / 16.0 * std::f64::consts::TAU)
                .map(|t| [centre[0] + margin * t.cos(), centre[1] + margin * t.sin()]);
            if around.into_iter().all(|p| inside(p) == truth) {
                assert_eq!(picture[y as usize][x as usize], truth, "seed {seed}, pixel {x} {y}");
                compared += 1;
                held += u32::from(truth);
            }
        }
    }
    (compared, held)
}

/// A homography with a horizon that often crosses the page.
fn homography(rng: &mut Rng) -> Matrix {
    let mut small = |r: f64| rng.uniform(-r, r);
    [1.0 + small(0.5), small(0.5), small(20.0), small(0.5), 1.0 + small(0.5), small(20.0), small(0.03), small(0.03), 1.0]
}

#[test]
fn polygons_through_infinity() {
    let (mut compared, mut through) = (0, 0);
    for seed in 0..300 {
        let mut rng = Rng::new(seed);
        let matrix = homography(&mut rng);
        let ring: Vec<[f64; 2]> = (0..rng.between(3, 9)).map(|_| [rng.uniform(-60.0, 120.0), rng.uniform(-60.0, 120.0)]).collect();
        let rule = if rng.one_in(2) { FillRule::NonZero } else { FillRule::EvenOdd };
        let mut path = Path::default();
        path.ring(&ring);
        let weights: Vec<f64> = ring.iter().map(|p| matrix[6] * p[0] + matrix[7] * p[1] + matrix[8]).collect();
        through += u32::from(weights.iter().any(|w| *w > 0.0) && weights.iter().any(|w| *w < 0.0));
        compared += compare(seed, &picture(path, rule, matrix), &ring, rule, inverse(matrix), 0.02).0;
    }
    assert!(compared > 300 * 3000 && through > 100, "{compared} {through}");
}

#[test]
fn curves_through_infinity() {
    let mut held = 0;
    for seed in 0..40 {
        let mut rng = Rng::new(seed);
        let matrix = homography(&mut rng);
        let (centre, r) = ([rng.uniform(0.0, 60.0), rng.uniform(0.0, 60.0)], rng.uniform(10.0, 60.0));
        let mut path = Path::default();
        path.circle(centre, r);
        // The same four cubic curves, 150 chords each.
        let k = r * 0.552_284_749_830_793_4;
        let arc = |t: f64| {
            let u = 1.0 - t;
            let mix = |a: f64, b: f64, c: f64, d: f64| u * u * u * a + 3.0 * u * u * t * b + 3.0 * u * t * t * c + t * t * t * d;
            [mix(r, r, k, 0.0), mix(0.0, k, r, r)]
        };
        let ring: Vec<[f64; 2]> = (0..600)
            .map(|i| {
                let [x, y] = arc(f64::from(i % 150) / 150.0);
                let [x, y] = [[x, y], [-y, x], [-x, -y], [y, -x]][i as usize / 150];
                [centre[0] + x, centre[1] + y]
            })
            .collect();
        held += compare(seed, &picture(path, FillRule::NonZero, matrix), &ring, FillRule::NonZero, inverse(matrix), 0.12).1;
    }
    assert!(held > 12_000, "{held}");
}

#[test]
fn an_affine_homography_is_the_affine_map() {
    for seed in 0..40 {
        let mut rng = Rng::new(seed);
        let mut path = Path::default();
        path.ring(&std::array::from_fn::<_, 7, _>(|_| [rng.uniform(-20.0, 80.0), rng.uniform(-20.0, 80.0)]));
        let [a, b, c, d, e, f] = std::array::from_fn(|_| rng.uniform(-1.5, 1.5));
        let affine = [a, c, 30.0 * e, b, d, 30.0 * f, 0.0, 0.0, 1.0];
        let mut scene = Scene::new(f64::from(SIZE), f64::from(SIZE));
        let straight =
            scene.add_shape(Shape { transform: Transform::Affine([a, b, c, d, 30.0 * e, 30.0 * f]), ..Shape::new("a", path.clone()) });
        let bent = scene.add_shape(Shape { transform: Transform::Projective(affine), ..Shape::new("b", path) });
        scene.picture = Picture::Region(scene.formula.odd(&[straight, bent]));
        let job = Job::prepare(scene, &Options::default(), &mut Vec::new()).unwrap();
        let mut rows = job.rows();
        while let Some(lines) = rows.next() {
            assert!(lines.runs.is_empty(), "seed {seed}: {lines:?}");
        }
    }
}
