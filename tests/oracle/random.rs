//! Random scenes that are hard to fill: coordinates that coincide, rings that cross themselves, collapse, lie far away.

use super::{Expr, Function, Operator, Point, Rule, Scene, Shape};

/// SplitMix64 (Steele, Lea, Flood 2014): a counter, hashed.
pub struct Rng(u64);

impl Rng {
    pub fn new(seed: u64) -> Rng {
        Rng(seed)
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// In `0..n`.
    pub fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    /// In `low..=high`.
    pub fn between(&mut self, low: i64, high: i64) -> i64 {
        low + self.below((high - low) as u64 + 1) as i64
    }

    /// True once in `n`.
    pub fn one_in(&mut self, n: u64) -> bool {
        self.below(n) == 0
    }

    /// In `low..high`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.below(items.len() as u64) as usize]
    }
}

/// A scene of at most 40 shapes on a page of at most 96 x 96.
pub fn scene(seed: u64) -> Scene {
    let mut rng = Rng::new(seed);
    let mut side = || if rng.one_in(4) { rng.pick(&[1, 2, 17, 64, 65]) } else { rng.between(3, 96) as u32 };
    let (width, height) = (side(), side());
    let most = rng.pick(&[2, 4, 8, 16, 40]);
    let mut made: Vec<Vec<Point>> = Vec::new();
    let mut shapes = Vec::new();
    for _ in 0..rng.between(1, most) {
        let mut pen = Pen { step: 0.0, offset: 0.0, size: [width, height].map(f64::from) };
        (pen.step, pen.offset) = rng.pick(&LATTICES);
        let rings: Vec<_> = (0..rng.pick(&[1, 1, 1, 2, 3, 5])).flat_map(|_| pen.rings(&mut rng, &made)).collect();
        made.extend(rings.iter().take(8).cloned());
        shapes.push(Shape { rings, rule: rng.pick(&[Rule::NonZero, Rule::EvenOdd]) });
    }
    // An odd number of all shapes hides no boundary.
    let all = (0..shapes.len()).map(Expr::Shape).collect();
    let expr = if rng.one_in(3) { Expr::Call(Function::Odd, all) } else { expr(&mut rng, shapes.len() as u64, 5) };
    Scene { width, height, shapes, expr }
}

/// Step and offset of the coordinates of a shape: pixel corners, pixel centres, both, the grid, halfway between the grid's
/// points, finer, and (0) anywhere.
const LATTICES: [(f64, f64); 8] =
    [(1.0, 0.0), (1.0, 0.5), (0.5, 0.0), (4.0, 0.5), (1.0 / 256.0, 0.0), (1.0 / 256.0, 1.0 / 512.0), (1.0 / 1024.0, 0.0), (0.0, 0.0)];

/// Draws rings with their vertices on a lattice.
struct Pen {
    step: f64,
    offset: f64,
    size: [f64; 2],
}

impl Pen {
    /// One ring, or very many small ones.
    fn rings(&self, rng: &mut Rng, made: &[Vec<Point>]) -> Vec<Vec<Point>> {
        let ring = match rng.below(14) {
            0..3 => self.tangle(rng),
            3 => self.rectangle(rng),
            4 => self.staircase(rng),
            5 => self.star(rng),
            6 => self.hairline(rng),
            7 => self.collapsed(rng),
            8 => self.laps(rng),
            9 if rng.one_in(2) => self.through(rng),
            9 => self.far(rng),
            10 => self.comb(rng),
            11 | 12 => self.neighbour(rng, made),
            _ if rng.one_in(4) => return self.specks(rng),
            _ => (0..4).map(|_| self.point(rng)).collect(),
        };
        vec![ring]
    }

    /// Far out there is no lattice: all doubles are whole numbers there.
    fn on_lattice(&self, v: f64) -> f64 {
        if self.step == 0.0 || v.abs() > 1e16 { v } else { (v / self.step).floor() * self.step + self.offset }
    }

    /// On the page or somewhat beside it.
    fn point(&self, rng: &mut Rng) -> Point {
        let [x, y] = self.size.map(|side| self.on_lattice(rng.uniform(-0.25 * side - 1.0, 1.25 * side + 1.0)));
        (x, y)
    }

    fn shifted(&self, rng: &mut Rng, p: Point, by: f64) -> Point {
        (self.on_lattice(p.0 + rng.uniform(-by, by)), self.on_lattice(p.1 + rng.uniform(-by, by)))
    }

    fn tangle(&self, rng: &mut Rng) -> Vec<Point> {
        (0..rng.between(3, 14)).map(|_| self.point(rng)).collect()
    }

    fn rectangle(&self, rng: &mut Rng) -> Vec<Point> {
        let (a, b) = (self.point(rng), self.point(rng));
        vec![a, (b.0, a.1), b, (a.0, b.1)]
    }

    /// Level and upright edges only; crosses itself.
    fn staircase(&self, rng: &mut Rng) -> Vec<Point> {
        let corners: Vec<Point> = (0..rng.between(2, 9)).map(|_| self.point(rng)).collect();
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).flat_map(|(&a, &b)| [a, (b.0, a.1)]).collect()
    }

    fn star(&self, rng: &mut Rng) -> Vec<Point> {
        let (centre, radius) = (self.point(rng), rng.uniform(0.5, self.size[0].max(self.size[1])));
        let (points, leap) = (rng.between(3, 13), rng.between(1, 6));
        let angle = |i: i64| (i * leap) as f64 * std::f64::consts::TAU / points as f64;
        (0..points).map(|i| (centre.0 + radius * angle(i).cos(), centre.1 + radius * angle(i).sin())).collect()
    }

    /// As thin as the grid or up to a pixel, in any direction.
    fn hairline(&self, rng: &mut Rng) -> Vec<Point> {
        let (a, b) = (self.point(rng), self.point(rng));
        let mut thin = || rng.pick(&[0.0, 1.0, 3.0, 128.0, 255.0, 256.0]) / 256.0;
        let (dx, dy) = (thin(), thin());
        vec![a, b, (b.0 + dx, b.1 + dy), (a.0 + dx, a.1 + dy)]
    }

    /// No area at all: too few points, one point many times, there and back, all on a level or an upright.
    fn collapsed(&self, rng: &mut Rng) -> Vec<Point> {
        let (a, b, c) = (self.point(rng), self.point(rng), self.point(rng));
        match rng.below(6) {
            0 => vec![a],
            1 => vec![a, b],
            2 => vec![a; 5],
            3 => vec![a, b, a, c, a],
            4 => vec![a, (b.0, a.1), (c.0, a.1)],
            _ => vec![a, (a.0, b.1), (a.0, c.1)],
        }
    }

    /// A tangle run through more than once, with points repeated on the way, perhaps there and back.
    fn laps(&self, rng: &mut Rng) -> Vec<Point> {
        let once: Vec<Point> = self.tangle(rng).iter().flat_map(|&p| vec![p; rng.pick(&[1, 1, 2, 3])]).collect();
        let mut ring: Vec<Point> = once.iter().copied().cycle().take(once.len() * rng.pick(&[1, 2, 3])).collect();
        if rng.one_in(4) {
            ring.extend(once.iter().rev());
        }
        ring
    }

    /// Some coordinates lie beyond any page.
    fn far(&self, rng: &mut Rng) -> Vec<Point> {
        let mut ring = self.tangle(rng);
        for _ in 0..rng.between(1, 4) {
            let power = f64::from(rng.between(20, 45) as u32).exp2();
            let (x, y) = self.point(rng);
            let mut flung = |v: f64| match rng.below(8) {
                0..3 => v,
                3 | 4 => power * rng.pick(&[-1.0, 1.0]) + v,
                5 => power * rng.uniform(-2.0, 2.0),
                6 => rng.pick(&[-1e12, 1e12]),
                _ => rng.pick(&[-1.7e308, -1e300, 1e300, 1.7e308, -1e30, 1e30, 1e18]),
            };
            ring.push((flung(x), flung(y)));
        }
        let start = rng.below(ring.len() as u64) as usize;
        ring.rotate_left(start);
        ring
    }

    /// A side between far points that goes through a pixel's centre, or all but.
    fn through(&self, rng: &mut Rng) -> Vec<Point> {
        let [x, y] = self.size.map(|side| rng.below(side as u64) as f64 + 0.5);
        let (dx, dy) = (rng.between(-9, 9) as f64, rng.between(-9, 9) as f64);
        let mut end = |sign: f64| {
            let reach = sign * f64::from(rng.between(0, 40) as u32).exp2();
            (x + reach * dx + rng.pick(&[0.0, 0.0, 1.0, -1.0]) / 256.0, y + reach * dy)
        };
        vec![end(-1.0), end(1.0), self.point(rng)]
    }

    /// Teeth about a pixel wide.
    fn comb(&self, rng: &mut Rng) -> Vec<Point> {
        let (start, tip) = (self.point(rng), self.point(rng));
        let pitch = rng.pick(&[1.0, 0.5, 1.0 + 1.0 / 256.0, 0.25, 2.0]);
        let teeth = rng.between(2, 40);
        let x = |i: i64| start.0 + pitch * i as f64;
        let mut ring: Vec<Point> = (0..teeth).map(|i| (x(i), if i % 2 == 0 { start.1 } else { tip.1 })).collect();
        ring.push((x(teeth), start.1));
        if rng.one_in(2) {
            ring.iter_mut().for_each(|p| *p = (p.1, p.0));
        }
        ring
    }

    /// Shares what it can with a ring made before: all of it, run either way, shifted, or one edge.
    fn neighbour(&self, rng: &mut Rng, made: &[Vec<Point>]) -> Vec<Point> {
        let Some(old) = made.get(rng.below(made.len().max(1) as u64) as usize) else {
            return self.rectangle(rng);
        };
        let mut ring = old.clone();
        match rng.below(5) {
            0 => {}
            1 => ring.reverse(),
            2 => {
                let (dx, dy) = (rng.pick(&[0.0, 0.5, 1.0, 1.0 / 256.0]), rng.pick(&[0.0, 0.5, -1.0]));
                ring.iter_mut().for_each(|p| *p = (p.0 + dx, p.1 + dy));
            }
            3 => {
                let at = rng.below(old.len() as u64) as usize;
                ring = vec![old[(at + 1) % old.len()], old[at], self.point(rng)];
            }
            _ => {
                let at = rng.below(old.len() as u64) as usize;
                ring[at] = self.shifted(rng, old[at], 2.0);
            }
        }
        ring
    }

    /// Thousands of triangles about as large as a pixel or much smaller.
    fn specks(&self, rng: &mut Rng) -> Vec<Vec<Point>> {
        let by = rng.pick(&[0.01, 0.1, 0.6, 1.5]);
        let speck = |rng: &mut Rng| {
            let p = self.point(rng);
            (0..3).map(|_| self.shifted(rng, p, by)).collect()
        };
        (0..rng.between(1000, 3000)).map(|_| speck(rng)).collect()
    }
}

/// An expression over so many shapes, at most `depth` operators deep.
pub fn expr(rng: &mut Rng, shapes: u64, depth: u32) -> Expr {
    if depth == 0 || rng.one_in(6) {
        return match rng.below(24) {
            0 => Expr::Page,
            1 => Expr::Art,
            _ => Expr::Shape(rng.below(shapes) as usize),
        };
    }
    match rng.below(9) {
        0 => Expr::Not(Box::new(expr(rng, shapes, depth - 1))),
        1..7 => {
            let operator = rng.pick(&[Operator::Minus, Operator::And, Operator::Xor, Operator::Or, Operator::Or, Operator::Minus]);
            let (a, b) = (expr(rng, shapes, depth - 1), expr(rng, shapes, depth - 1));
            Expr::Binary(operator, Box::new(a), Box::new(b))
        }
        _ => {
            let operands = rng.pick(&[1, 2, 3, 3, 5, 9, 60]);
            let k = if rng.one_in(12) { operands + 1 } else { rng.between(1, operands) };
            let function = rng.pick(&[Function::All, Function::Any, Function::Odd, Function::AtLeast(k as usize)]);
            // A long list is of plain shapes, mostly, lest it becomes a forest.
            let depth = if operands > 3 { 0 } else { depth - 1 };
            Expr::Call(function, (0..operands).map(|_| expr(rng, shapes, depth)).collect())
        }
    }
}
