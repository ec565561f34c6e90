//! The other engines, each given the same outlines in the form it likes best, and asked for `a - b`.
//!
//! | name | what is timed |
//! |---|---|
//! | i_overlay | integer coordinates, its default solver, contours into a buffer that is kept |
//! | i_overlay + tiny-skia | that, the contours made a path, the path filled into a mask without anti-aliasing |
//! | tiny-skia masks | a mask of `a`, one of `b`, both without anti-aliasing, and their difference |
//! | zeno masks | the same with zeno, whose masks are anti-aliased: half covered counts as inside |
//!
//! A mask is one byte a pixel; no peer is charged with packing it to bits. Outlines in a peer's own form, masks and scratch memory are made once
//! and kept from one repetition to the next.

use i_overlay::core::fill_rule::FillRule as OverlayFill;
use i_overlay::core::overlay::{Overlay as Solver, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;
use i_overlay::i_shape::flat::buffer::FlatContoursBuffer;
use runset::scene::{Picture, Scene};
use runset::shape::{FillRule, Path, Shape};
use tiny_skia::{Mask, PathBuilder, Transform};
use zeno::{Command, Fill, Scratch};

use super::shapes::SIDE;

/// Names of the peers, for the command line.
pub const NAMES: [&str; 4] = ["i_overlay", "i_overlay+tiny-skia", "tiny-skia", "zeno"];

/// Outlines to be filled as `a - b` on a square page.
pub struct Input {
    /// Even-odd or else non-zero.
    pub evenodd: bool,
    /// The rings of `a` and `b` in user units, on the grid of 1/512.
    pub layers: [Vec<Vec<[f32; 2]>>; 2],
    /// Pixels to a user unit.
    pub scale: u32,
}

/// A peer with its input.
pub trait Peer {
    /// Does the work once.
    fn run(&mut self);
    /// What came of it: a byte a pixel, 128 and more inside.
    fn mask(&self) -> Option<&[u8]> {
        None
    }
    /// What came of it as a scene, if it is polygons.
    fn scene(&self) -> Option<Scene> {
        None
    }
}

/// The peer of that name.
pub fn by_name(name: &str, input: &Input) -> Option<Box<dyn Peer>> {
    match name {
        "i_overlay" => Some(Box::new(Boolean::new(input))),
        "i_overlay+tiny-skia" => Some(Box::new(Filled { boolean: Boolean::new(input), mask: mask(input) })),
        "tiny-skia" => Some(Box::new(Skia::new(input))),
        "zeno" => Some(Box::new(Zeno::new(input))),
        _ => None,
    }
}

impl Input {
    fn side(&self) -> u32 {
        SIDE * self.scale
    }

    fn scaled(&self, layer: usize) -> impl Iterator<Item = impl Iterator<Item = [f32; 2]>> {
        let scale = self.scale as f32;
        self.layers[layer].iter().map(move |ring| ring.iter().map(move |&[x, y]| [x * scale, y * scale]))
    }
}

/// Grid steps of the workloads to a user unit.
const STEPS: f32 = 512.0;

struct Boolean {
    layers: [FlatContoursBuffer<i32>; 2],
    rule: OverlayFill,
    scale: u32,
    solver: Solver<i32>,
    contours: FlatContoursBuffer<i32>,
}

impl Boolean {
    fn new(input: &Input) -> Boolean {
        let layers = [0, 1].map(|layer| {
            let mut buffer = FlatContoursBuffer::default();
            for ring in &input.layers[layer] {
                buffer.add_contour(&ring.iter().map(|&[x, y]| IntPoint::new((x * STEPS) as i32, (y * STEPS) as i32)).collect::<Vec<_>>());
            }
            buffer
        });
        let rule = if input.evenodd { OverlayFill::EvenOdd } else { OverlayFill::NonZero };
        let solver = Solver::new(layers.iter().map(|layer| layer.points.len()).sum());
        Boolean { layers, rule, scale: input.scale, solver, contours: FlatContoursBuffer::default() }
    }

    /// The contours in user units.
    fn rings(&self) -> impl Iterator<Item = impl Iterator<Item = [f64; 2]>> {
        let step = 1.0 / f64::from(STEPS);
        let point = move |p: &IntPoint<i32>| [f64::from(p.x) * step, f64::from(p.y) * step];
        self.contours.ranges.iter().map(move |range| self.contours.points[range.clone()].iter().map(point))
    }
}

impl Peer for Boolean {
    fn run(&mut self) {
        self.solver.clear();
        self.solver.add_source(&self.layers[0], ShapeType::Subject);
        self.solver.add_source(&self.layers[1], ShapeType::Clip);
        self.solver.overlay_into(OverlayRule::Difference, self.rule, &mut self.contours);
    }

    fn scene(&self) -> Option<Scene> {
        let mut scene = Scene::new(f64::from(SIDE), f64::from(SIDE));
        let mut path = Path::default();
        for ring in self.rings() {
            path.ring(&ring.collect::<Vec<_>>());
        }
        let area = scene.add_shape(Shape { rule: FillRule::NonZero, ..Shape::new("contours", path) });
        scene.picture = Picture::Region(area);
        Some(scene)
    }
}

struct Filled {
    boolean: Boolean,
    mask: Mask,
}

impl Peer for Filled {
    fn run(&mut self) {
        self.boolean.run();
        let scale = f64::from(self.boolean.scale);
        let contours = self.boolean.rings().map(|ring| ring.map(|[x, y]| [(x * scale) as f32, (y * scale) as f32]));
        self.mask.clear();
        if let Some(path) = skia_path(contours) {
            self.mask.fill_path(&path, tiny_skia::FillRule::Winding, false, Transform::identity());
        }
    }

    fn mask(&self) -> Option<&[u8]> {
        Some(self.mask.data())
    }
}

fn mask(input: &Input) -> Mask {
    Mask::new(input.side(), input.side()).expect("a mask of the page")
}

fn skia_path(rings: impl Iterator<Item = impl Iterator<Item = [f32; 2]>>) -> Option<tiny_skia::Path> {
    let mut builder = PathBuilder::new();
    for ring in rings {
        for (i, [x, y]) in ring.enumerate() {
            if i == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
        }
        builder.close();
    }
    builder.finish()
}

struct Skia {
    paths: [tiny_skia::Path; 2],
    rule: tiny_skia::FillRule,
    masks: [Mask; 2],
}

impl Skia {
    fn new(input: &Input) -> Skia {
        let rule = if input.evenodd { tiny_skia::FillRule::EvenOdd } else { tiny_skia::FillRule::Winding };
        Skia { paths: [0, 1].map(|layer| skia_path(input.scaled(layer)).expect("a path")), rule, masks: [mask(input), mask(input)] }
    }
}

impl Peer for Skia {
    fn run(&mut self) {
        for (mask, path) in self.masks.iter_mut().zip(&self.paths) {
            mask.clear();
            mask.fill_path(path, self.rule, false, Transform::identity());
        }
        let [a, b] = &mut self.masks;
        subtract(a.data_mut(), b.data());
    }

    fn mask(&self) -> Option<&[u8]> {
        Some(self.masks[0].data())
    }
}

struct Zeno {
    paths: [Vec<Command>; 2],
    fill: Fill,
    side: u32,
    masks: [Vec<u8>; 2],
    scratch: Scratch,
}

impl Zeno {
    fn new(input: &Input) -> Zeno {
        let side = input.side();
        let paths = [0, 1].map(|layer| {
            let mut commands = Vec::new();
            for ring in input.scaled(layer) {
                commands.extend(ring.enumerate().map(|(i, p)| if i == 0 { Command::MoveTo(p.into()) } else { Command::LineTo(p.into()) }));
                commands.push(Command::Close);
            }
            commands
        });
        let fill = if input.evenodd { Fill::EvenOdd } else { Fill::NonZero };
        Zeno { paths, fill, side, masks: [(); 2].map(|()| vec![0; side as usize * side as usize]), scratch: Scratch::new() }
    }
}

impl Peer for Zeno {
    fn run(&mut self) {
        for (mask, path) in self.masks.iter_mut().zip(&self.paths) {
            mask.fill(0);
            let mut mask_of_path = zeno::Mask::with_scratch(path, &mut self.scratch);
            mask_of_path.style(self.fill).size(self.side, self.side).render_into(mask, None);
        }
        let [a, b] = &mut self.masks;
        subtract(a, b);
    }

    fn mask(&self) -> Option<&[u8]> {
        Some(&self.masks[0])
    }
}

/// Takes the coverage `b` out of `a`.
fn subtract(a: &mut [u8], b: &[u8]) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a = (*a).min(255 - b));
}

/// A mask as rows of bits, 128 and more black, rows padded to bytes.
pub fn bits(mask: &[u8], side: usize) -> Vec<u8> {
    let byte = |eight: &[u8]| eight.iter().enumerate().fold(0, |byte, (i, &v)| byte | (v & 0x80) >> i);
    mask.chunks(side).flat_map(|row| row.chunks(8).map(byte)).collect()
}
