//! The plane workloads: what the benchmarks measure, made anew each time, the same everywhere.
//!
//! Each is two layers, `a` and `b`, on a page of 4096 x 4096, to be filled as `a - b`; scale 4 makes it 16,384 a side, scale 16
//! 65,536. Every coordinate is an odd multiple of 1/512 px at scale 1, so that no vertex lies on a pixel centre at these scales.
//!
//! | name | what | vertices |
//! |---|---|---|
//! | coastN | two rough outlines of N short edges, few crossings | 2 N |
//! | spikyN | two stars whose radius is drawn anew for every vertex: about N^2 crossings | 2 N |
//! | selfN | two outlines of five laps that cross each other | 2 N |
//! | kway1000 | a union of 1,000 polygons minus a union of 1,000 | 99,754 |
//! | manh1e5 | 50,000 rectangles, wires and pads, minus 50,000 | 400,000 |
//!
//! The first three fill even-odd, the others non-zero. The recipes are those of a numpy script, draw for draw, and all
//! 3,105,754 vertices agree with what numpy 2.4 makes of it (none differs). A sine whose last bit differs on another platform could move a
//! vertex by a step of the grid, by estimate once in 10^9.

pub mod numpy;

use std::f64::consts::PI;
use std::io::{self, Write};

use numpy::Rng;
use runset::scene::{Picture, Scene};
use runset::shape::{FillRule, Path, Shape};

/// Side of the page in pixels at scale 1.
pub const SIDE: u32 = 4096;

/// Grid steps to the side: 512 to a pixel.
const GRID: i32 = 1 << 21;

/// A closed polygon; coordinates in 1/512 px at scale 1, odd.
pub type Ring = Vec<[i32; 2]>;

/// Two layers of rings with their fill rule.
#[derive(Clone, Debug)]
pub struct Shapes {
    /// `evenodd` or `nonzero`.
    pub rule: &'static str,
    /// The rings of `a` and of `b`.
    pub layers: [Vec<Ring>; 2],
}

/// A workload's name and recipe.
pub type Workload = (&'static str, fn() -> Shapes);

/// All workloads.
pub const WORKLOADS: [Workload; 9] = [
    ("coast1e3", || pair(coast, 1_000, 5)),
    ("coast1e5", || pair(coast, 100_000, 5)),
    ("coast1e6", || pair(coast, 1_000_000, 5)),
    ("spiky1e3", || pair(spiky, 1_000, 5)),
    ("spiky1e5", || pair(spiky, 100_000, 5)),
    ("self1e3", || pair(laps, 1_000, 4)),
    ("self1e5", || pair(laps, 100_000, 4)),
    ("kway1000", || polygons(1_000)),
    ("manh1e5", || rectangles(100_000)),
];

/// The workloads of these names, in their order, or all if there are none.
///
/// # Errors
/// An unknown name, with the known ones.
pub fn named(names: &[String]) -> Result<Vec<Workload>, String> {
    let find = |name: &String| {
        let found = WORKLOADS.iter().find(|workload| workload.0 == name).copied();
        found.ok_or_else(|| format!("no workload \"{name}\"; there are {}", WORKLOADS.map(|workload| workload.0).join(", ")))
    };
    if names.is_empty() { Ok(WORKLOADS.to_vec()) } else { names.iter().map(find).collect() }
}

impl Shapes {
    /// Number of vertices.
    pub fn vertices(&self) -> usize {
        self.layers.iter().flatten().map(Vec::len).sum()
    }

    /// Writes a JSON scene.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_json(&self, out: &mut impl Write) -> io::Result<()> {
        write!(out, r#"{{"width": {SIDE}, "height": {SIDE}, "expr": "a - b", "shapes": {{"#)?;
        for (id, rings) in ["\"a\"", ", \"b\""].iter().zip(&self.layers) {
            write!(out, r#"{id}: {{"path": ""#)?;
            write_path(rings, out)?;
            write!(out, r#"", "rule": "{}"}}"#, self.rule)?;
        }
        write!(out, "}}}}")
    }

    /// Writes an SVG, `b` in white over `a` in black.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_svg(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, r#"<svg xmlns="http://www.w3.org/2000/svg" width="{SIDE}" height="{SIDE}" viewBox="0 0 {SIDE} {SIDE}">"#)?;
        for ((id, fill), rings) in [("a", "black"), ("b", "white")].iter().zip(&self.layers) {
            write!(out, r#"<path id="{id}" fill-rule="{}" fill="{fill}" d=""#, self.rule)?;
            write_path(rings, out)?;
            writeln!(out, r#""/>"#)?;
        }
        writeln!(out, "</svg>")
    }

    /// The scene of `a - b`.
    pub fn scene(&self) -> Scene {
        let rule = if self.rule == "evenodd" { FillRule::EvenOdd } else { FillRule::NonZero };
        let mut scene = Scene::new(f64::from(SIDE), f64::from(SIDE));
        let [a, b] = [("a", &self.layers[0]), ("b", &self.layers[1])].map(|(id, rings)| {
            let mut path = Path::default();
            for ring in rings {
                path.ring(&ring.iter().map(|&p| pixels(p)).collect::<Vec<_>>());
            }
            scene.add_shape(Shape { rule, ..Shape::new(id, path) })
        });
        scene.picture = Picture::Region(scene.formula.without(a, &[b]));
        scene
    }

    /// Number of pairs of an edge and a scanline whose centre it crosses, at a whole number of pixels to a unit: the work of a sweep.
    pub fn edge_lines(&self, scale: u32) -> u64 {
        // Scanline j of the page is centred at (2 j + 1) 256 grid steps of the scaled shape.
        let above = |y: i32| (i64::from(y) * i64::from(scale) + 256).div_euclid(512);
        let ring = |ring: &Ring| {
            let next = ring.iter().cycle().skip(1);
            ring.iter().zip(next).map(|(p, q)| above(p[1]).abs_diff(above(q[1]))).sum::<u64>()
        };
        self.layers.iter().flatten().map(ring).sum()
    }
}

/// A vertex in pixels at scale 1.
pub fn pixels(vertex: [i32; 2]) -> [f64; 2] {
    vertex.map(|v| f64::from(v) * f64::from(SIDE) / f64::from(GRID))
}

/// Path data in pixels. A multiple of 1/512 below 4096 has at most 13 decimal digits and is written exactly.
fn write_path(rings: &[Ring], out: &mut impl Write) -> io::Result<()> {
    for ring in rings {
        for (i, [x, y]) in ring.iter().map(|&vertex| pixels(vertex)).enumerate() {
            write!(out, "{}{x} {y}", if i == 0 { 'M' } else { 'L' })?;
        }
        write!(out, "Z")?;
    }
    Ok(())
}

/// A point of the unit square to the nearest odd grid numbers.
fn snap(point: [f64; 2]) -> [i32; 2] {
    point.map(|v| ((v.clamp(0.0, 1.0 - 1e-9) * f64::from(GRID / 2)).floor() as i32 * 2 + 1).clamp(1, GRID - 1))
}

/// A vertex in polar coordinates about a centre, `angle` in radians.
fn polar([x, y]: [f64; 2], angle: f64, radius: f64) -> [i32; 2] {
    snap([x + radius * angle.cos(), y + radius * angle.sin()])
}

/// An outline about the given centre, of so many vertices.
type Outline = fn(&mut Rng, [f64; 2], usize) -> Ring;

fn pair(outline: Outline, n: usize, salt: usize) -> Shapes {
    let mut rng = Rng::new((n + salt) as u32);
    Shapes { rule: "evenodd", layers: [[0.47, 0.5], [0.53, 0.52]].map(|centre| vec![outline(&mut rng, centre, n)]) }
}

/// A rough outline, jagged by about the length of an edge, so that it hardly crosses itself.
fn coast(rng: &mut Rng, centre: [f64; 2], n: usize) -> Ring {
    let angles = turn(2.0 * PI, n);
    let waves = waves(rng, &angles, 60);
    let jag = rng.uniforms(-1.0, 1.0, n);
    let radius = |i: usize| 0.33 * (1.0 + 0.16 * waves[i]) + jag[i] * 4.0 / n as f64;
    (0..n).map(|i| polar(centre, angles[i], radius(i))).collect()
}

/// A star whose radius is drawn anew for every vertex.
fn spiky(rng: &mut Rng, centre: [f64; 2], n: usize) -> Ring {
    turn(2.0 * PI, n).iter().map(|&angle| polar(centre, angle, 0.36 * (1.0 - 0.5 * rng.random()))).collect()
}

/// Five rough laps that cross each other.
fn laps(rng: &mut Rng, centre: [f64; 2], n: usize) -> Ring {
    let angles = turn(10.0 * PI, n);
    let once: Vec<f64> = angles.iter().map(|angle| angle * 0.2).collect();
    let waves = waves(rng, &once, 90);
    let jag = rng.uniforms(-1.0, 1.0, n);
    let radius = |i: usize| 0.30 * (1.0 + 0.3 * (once[i] * 13.0).cos()) * (1.0 + 0.12 * waves[i]) + jag[i] * 8.0 / n as f64;
    (0..n).map(|i| polar(centre, angles[i], radius(i))).collect()
}

/// `n` equal steps over an angle in radians.
fn turn(whole: f64, n: usize) -> Vec<f64> {
    (0..n).map(|i| whole * i as f64 / n as f64).collect()
}

/// A turn to the eight digits that numpy's script has.
#[expect(clippy::approx_constant, reason = "more digits would move vertices")]
const TURN: f64 = 6.2831853;

/// Waves of 2 up to `count` periods to the turn, their heights falling off as 1/k, about 1 high together.
fn waves(rng: &mut Rng, angles: &[f64], count: u32) -> Vec<f64> {
    let mut sum = vec![0.0; angles.len()];
    for k in (2..count).map(f64::from) {
        let (phase, height) = (rng.uniform(0.0, TURN), rng.uniform(0.3, 1.0));
        for (sum, angle) in sum.iter_mut().zip(angles) {
            *sum += (k * angle + phase).cos() * height / k;
        }
    }
    sum
}

fn polygons(n: u32) -> Shapes {
    let mut rng = Rng::new(n);
    let mut polygon = || {
        let corners = rng.integers(40, 61) as usize;
        let mut angles = rng.randoms(corners);
        angles.sort_by(f64::total_cmp);
        let radius = rng.uniform(0.01, 0.05);
        let radii: Vec<f64> = rng.randoms(corners).iter().map(|random| radius * (1.0 - 0.5 * random)).collect();
        let centre = [rng.uniform(0.06, 0.94), rng.uniform(0.06, 0.94)];
        angles.iter().zip(radii).map(|(angle, radius)| polar(centre, angle * 2.0 * PI, radius)).collect()
    };
    Shapes { rule: "nonzero", layers: [(); 2].map(|()| (0..n).map(|_| polygon()).collect()) }
}

/// Half thin wires, half pads, 1/4096 to 8/4096 of the side wide, lying and standing.
fn rectangles(n: usize) -> Shapes {
    let mut rng = Rng::new(n as u32);
    let n = n / 2;
    let mut layer = || {
        let (x, y) = (rng.randoms(n), rng.randoms(n));
        let width = rng.uniforms(0.5, 4.0, n);
        let length = rng.uniforms(4.0, 60.0, n);
        let lies = rng.randoms(n);
        let rectangle = |i: usize| {
            let long = if i % 2 == 1 { width[i] } else { length[i] } / 4096.0;
            let short = width[i] / 4096.0;
            let (w, h) = if lies[i] < 0.5 { (long, short) } else { (short, long) };
            let (x, y) = (x[i], y[i]);
            [[x, y], [x + w, y], [x + w, y + h], [x, y + h]].map(snap).to_vec()
        };
        (0..n).map(rectangle).collect()
    };
    Shapes { rule: "nonzero", layers: [layer(), layer()] }
}
