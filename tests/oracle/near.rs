//! Edges that pass as close to pixel centres as edges can: constructed, since random ones never do.
//!
//! Let an edge go down by `dy` and across by `dx`, in 1/256 px, and let `dy = k q`, `dx = k p` with `p` and `q` coprime. At the
//! depth `Y` below its upper end it is `(Y p - X q) / q` away from the point `X` to the right of that end. The numerator can be any
//! integer `gap`, so the closest it comes to a point of the grid without hitting it is `1 / q` of a grid step, and it does so where
//!
//! ```text
//!     Y = gap / p  (mod q),      X = (Y p - gap) / q
//! ```
//!
//! The edge is then laid so that this point is a pixel's centre: it passes `gap / q` of 1/256 px to the right of it. With an
//! edge 70,000 scanlines tall and k = 1, that is 2^-32 px.

use super::random::Rng;
use super::{Expr, Function, Point, Rule, Scene, Shape};

/// Edges in a scene, each the slanted side of a shape of its own.
const EDGES: usize = 24;

/// How many columns of the page the edges are in.
const COLUMNS: i64 = 200;

/// A scene of edges that pass close to pixel centres, and where they do.
pub struct Near {
    /// The exclusive or of all shapes: each edge is a boundary of it.
    pub scene: Scene,
    pub touches: Vec<Touch>,
}

/// Where an edge passes a pixel's centre.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    /// The shape that the edge belongs to.
    pub shape: usize,
    /// The pixel.
    pub column: u32,
    pub line: u32,
    /// How far right of the centre the edge passes, in `1 / q` of 1/256 px.
    pub gap: i128,
    pub q: i128,
    /// Whether the shape lies to the left of the edge.
    pub left: bool,
}

/// A page of `lines` scanlines, with edges as tall in the 200 columns from `first_column` on.
pub fn scene(seed: u64, lines: u32, first_column: u32) -> Near {
    let mut rng = Rng::new(seed);
    let width = first_column + COLUMNS as u32;
    let (shapes, touches): (Vec<_>, Vec<_>) = (0..EDGES).map(|shape| edge(&mut rng, shape, lines, first_column)).unzip();
    let expr = Expr::Call(Function::Odd, (0..EDGES).map(Expr::Shape).collect());
    Near { scene: Scene { width, height: lines, shapes, expr }, touches }
}

fn edge(rng: &mut Rng, shape: usize, lines: u32, first_column: u32) -> (Shape, Touch) {
    let k = rng.pick(&[1, 1, 1, 2, 3, 256, 1000]);
    let q = (256 * i128::from(lines) + i128::from(rng.between(-999, 999))) / k;
    let across = i128::from(256 * rng.pick(&[1, 3, COLUMNS, COLUMNS, 50_000])) / k;
    let mut p = match rng.below(4) {
        0 => 1,                                          // as good as upright
        1 => q / i128::from(rng.between(50, 5000)) + 1,  // as good as a simple slope
        _ => 1 + i128::from(rng.next()) % across.max(1), // any slope
    };
    while gcd(p, q) != 1 {
        p += 1;
    }
    let gap = i128::from(rng.between(-1, 1));
    let y = (gap * inverse(p, q)).rem_euclid(q) + q * i128::from(rng.below(k as u64));
    let x = (y * p - gap) / q;

    // The upper end is laid at the upper end of the page, or a few scanlines off it, and the edge is mirrored half of the time.
    let line = (y / 256 + i128::from(rng.between(-3, 3))).clamp(0, i128::from(lines) - 1);
    let column = i128::from(first_column) + i128::from(rng.between(0, COLUMNS - 1));
    let (sign, centre) = (rng.pick(&[1, -1]), |pixel: i128| 256 * pixel + 128);
    let top = (centre(column) - sign * x, centre(line) - y);
    let bottom = (top.0 + sign * k * p, top.1 + k * q);

    let left = rng.one_in(2);
    let side = if left { -300 } else { 256 * (i128::from(first_column) + 5000) };
    let mut ring: Vec<Point> = [top, bottom, (side, bottom.1), (side, top.1)].map(|(x, y)| (x as f64 / 256.0, y as f64 / 256.0)).to_vec();
    ring.rotate_left(rng.below(4) as usize);
    if rng.one_in(2) {
        ring.reverse();
    }
    let touch = Touch { shape, column: column as u32, line: line as u32, gap: sign * gap, q, left };
    (Shape { rings: vec![ring], rule: rng.pick(&[Rule::NonZero, Rule::EvenOdd]) }, touch)
}

fn gcd(a: i128, b: i128) -> i128 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// The number whose product with `a` is 1 modulo `m`, coprime to `a` (Euclid, extended).
fn inverse(a: i128, m: i128) -> i128 {
    let (mut r, mut s) = ((m, a.rem_euclid(m)), (0, 1));
    while r.1 != 0 {
        let quotient = r.0 / r.1;
        r = (r.1, r.0 - quotient * r.1);
        s = (s.1, s.0 - quotient * s.1);
    }
    s.0.rem_euclid(m)
}
