//! The whole pipeline in one place: bytes to scene, scene to rows, rows to bytes.
//!
//! ```text
//! bytes --input--> Scene --Job::prepare--> edges + program --Rows--> lines --encode--> bytes
//!                                          (once, shared)   a band a thread, or pulled by a Stream
//! ```
//!
//! A [`Job`] is a prepared picture. [`Job::render`] writes it with any number of threads, [`Job::stream`] is the same as something to
//! be pulled; both give the same bytes.

mod convert;
mod evaluate;
mod explain;
mod extents;
mod gather;
mod info;
mod kept;
mod model;
mod moves;
mod pick;
mod pump;
mod queue;
mod render;
mod sheets;
mod size;
mod solid;
mod source;
mod stream;
mod view;

pub use convert::convert;
pub use evaluate::{evaluate, stl};
pub use explain::{Explanation, How, Line, Step, Vertex, explain};
pub use info::{Entry, Info, info};
pub use kept::Kept;
pub use model::{ModelEntry, ModelInfo, model_info};
pub use moves::{MAX_MOVES, Move, movement};
pub use pick::{KeptPart, Pick};
pub use sheets::render_sheets;
pub use size::{Size, lines};
pub use solid::{Aov, MAX_SECTIONS, SolidOptions};
use source::Source;
pub use source::{Cost, Rows};
pub use stream::{Checkpoint, More, Stream};
pub use view::{angle, camera, image_size, parts, section};

use std::io::Write;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use crate::count::{Node, Program, Rule};
use crate::edge::Builder;
use crate::error::{Error, Kind, Result, Warning};
pub use crate::region::Counting;
use crate::region::Picture;
use crate::run::{BLACK, Header, Inks, MAX_INKS, Pixels, Rgb, Sheet};
use crate::scene::{self, Area, Expression, Layer, Limits, Scene};
use crate::shape::{FillRule, Shape};

/// The default flattening tolerance, in pixels.
pub const TOLERANCE: f64 = 0.1;

/// The tolerances that are taken, in pixels.
pub const TOLERANCES: std::ops::RangeInclusive<f64> = 0.001..=16.0;

/// What is asked of a document.
#[derive(Clone, Debug)]
pub struct Options {
    /// An expression instead of the document's own picture.
    pub expr: Option<String>,
    /// Size of the page.
    pub size: Size,
    /// Resolution that the raster tells, in dots an inch; without it, that of [`Size::Dpi`].
    pub dpi: Option<f64>,
    /// What pixels are to be, in formats that leave a choice.
    pub pixels: Option<Pixels>,
    /// Only these scanlines.
    pub lines: Option<Range<u32>>,
    /// Curve flattening, in pixels, one of [`TOLERANCES`].
    pub tolerance: f64,
    /// How crossings are counted; the raster does not depend on it.
    pub counting: Counting,
    /// Limits.
    pub limits: Limits,
    /// When the work began: [`Stats`] count from here.
    pub started: Instant,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            expr: None,
            size: Size::Scale(1.0),
            dpi: None,
            pixels: None,
            lines: None,
            tolerance: TOLERANCE,
            counting: Counting::Measured,
            limits: Limits::default(),
            started: Instant::now(),
        }
    }
}

/// What a run cost: the object of `--stats`. Times in seconds.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Stats {
    /// Width of the page in pixels.
    pub width: u32,
    /// Height of what was drawn in pixels.
    pub height: u32,
    /// Edges after flattening, before any is dropped.
    pub edges: u64,
    /// Scanlines drawn.
    pub lines: u32,
    /// Scanlines on which the counting ran.
    pub lines_counted: u64,
    /// Those of them on which it ran by columns, without order.
    pub lines_unordered: u64,
    /// Scanlines that repeat the one above without any work.
    pub lines_repeated: u64,
    /// Crossings counted.
    pub toggles: u64,
    /// Crossings that were not, on scanlines of which another part was.
    pub toggles_known: u64,
    /// Runs, those of repeated lines too.
    pub runs: u64,
    /// Largest number of edges that a scanline crosses.
    pub peak_active: u64,
    /// From the start to the last edge sorted.
    pub prepare_seconds: f64,
    /// Wall time after that.
    pub seconds: f64,
    /// From the start to the first line being ready.
    pub first_line_seconds: f64,
    /// Threads asked for.
    pub threads: usize,
    /// Of a model.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub solid: Option<SolidStats>,
}

/// What the picture of a model cost besides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct SolidStats {
    /// Faces of all parts.
    pub faces: u64,
    /// Parts.
    pub primitives: u64,
    /// Spans between edges or crossings of faces.
    pub spans: u64,
    /// Counts along depth: one-dimensional set operations.
    pub depth_tests: u64,
    /// Spans that ended where faces cross.
    pub crossings: u64,
}

/// A picture ready to be swept, from any line, by any number of threads.
#[derive(Clone, Debug)]
pub struct Job {
    source: Source,
    header: Header,
    band: u32,
    edges: u64,
    started: Instant,
    prepare_seconds: f64,
    /// Faces and parts of a model.
    solid: Option<SolidStats>,
}

impl Job {
    /// Flattens and sorts what the picture needs. `warnings` receives what is worth saying.
    ///
    /// # Errors
    /// An expression that does not parse or names what is not there; a size or a range of lines out of bounds; coordinates past what a
    /// double holds; a limit.
    pub fn prepare(mut scene: Scene, options: &Options, warnings: &mut Vec<Warning>) -> Result<Job> {
        if !TOLERANCES.contains(&options.tolerance) {
            let what = format!("the tolerance is {} px: give one from {} to {}", options.tolerance, TOLERANCES.start(), TOLERANCES.end());
            return Err(Error::parameter(what));
        }
        let layers = layers(&mut scene, options, warnings)?;
        Job::of(scene, &layers, options)
    }

    /// A picture of those layers.
    fn of(scene: Scene, layers: &[Layer], options: &Options) -> Result<Job> {
        let page = options.size.page(scene.width, scene.height)?;
        let lines = slice(options.lines.as_ref(), page.height)?;

        let outputs: Vec<_> = layers.iter().map(|layer| layer.area).collect();
        let builder = || Builder::new(page.width, page.height, page.placement, options.tolerance, options.limits.edges);
        let page_alone = builder();
        let (program, leaves) = program(&scene, &outputs, &page_alone);
        let (inks, ink_of_layer) = distinct_inks(layers);
        if inks.len() > MAX_INKS {
            return Err(Error::input(Kind::Limit, format!("{} different inks, at most {MAX_INKS} are possible: use fewer", inks.len())));
        }
        let builder = gather::edges(&scene.shapes, &leaves, options.limits.threads, builder)?;
        drop(scene);
        let outlines = builder.finish();
        let dpi = options.dpi.or(if let Size::Dpi(dpi) = options.size { Some(dpi) } else { None });
        Ok(Job {
            edges: outlines.seen,
            source: Source::Plane(Arc::new(Picture::new(page.width, outlines, program, ink_of_layer, options.counting))),
            header: Header {
                width: page.width,
                lines,
                inks: Inks::Listed(inks),
                dpi,
                sheet: Sheet { pixels: options.pixels, ..Sheet::default() },
            },
            band: band_height(page.height),
            started: options.started,
            prepare_seconds: options.started.elapsed().as_secs_f64(),
            solid: None,
        })
    }

    /// The raster's header.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// About how many bytes it holds.
    pub fn weight(&self) -> u64 {
        /// Of an edge in the sweep's lists.
        const EDGE: u64 = 64;
        let Source::Solid(stage, paint) = &self.source else { return EDGE * self.edges };
        let of_faces = size_of_val(&stage.faces[..]) + size_of_val(&stage.depths[..]) + size_of_val(&stage.planes[..]);
        EDGE * self.edges + (of_faces + paint.weight()) as u64
    }

    /// The lines as runs, pulled from top to bottom. Lines that follow each other may be equal.
    pub fn rows(&self) -> Rows {
        self.source.rows(self.header.lines.clone())
    }

    /// The bands: they cut the page at the same lines whatever part of it is drawn, by however many threads.
    fn bands(&self) -> impl Iterator<Item = Range<u32>> + Clone + use<> {
        self.bands_from(self.header.lines.start)
    }

    /// What is left of the bands from a line of the raster on.
    fn bands_from(&self, line: u32) -> impl Iterator<Item = Range<u32>> + Clone + use<> {
        let (lines, band) = (line..self.header.lines.end, self.band);
        (lines.start / band..lines.end.div_ceil(band)).map(move |i| (i * band).max(lines.start)..((i + 1) * band).min(lines.end))
    }
}

/// What is to be painted: the expression that is asked for, or the document's own picture.
fn layers(scene: &mut Scene, options: &Options, warnings: &mut Vec<Warning>) -> Result<Vec<Layer>> {
    Ok(match &options.expr {
        Some(text) => {
            let expression = Expression::parse(text, &options.limits)?;
            vec![Layer { area: scene.resolve(&expression, warnings)?, ink: BLACK }]
        }
        None => match &scene.picture {
            scene::Picture::Region(area) => vec![Layer { area: *area, ink: BLACK }],
            scene::Picture::Layers(layers) => layers.clone(),
        },
    })
}

/// The counting program of areas on a page, and the shapes that it needs with their leaves.
fn program(scene: &Scene, outputs: &[Area], page: &Builder) -> (Program, Vec<(usize, Node)>) {
    // What covers the page holds from the start, and waits for no crossing.
    let rule = |shape: usize| match &scene.shapes[shape] {
        shape if page.holds_page(shape) => Rule::AtLeast(0),
        Shape { rule: FillRule::NonZero, .. } => Rule::NonZero,
        Shape { rule: FillRule::EvenOdd, .. } => Rule::Odd,
    };
    scene::compile(&scene.formula, scene.shapes.len(), outputs, rule)
}

/// The scanlines of a page that are asked for.
fn slice(lines: Option<&Range<u32>>, height: u32) -> Result<Range<u32>> {
    let Range { start, end } = lines.cloned().unwrap_or(0..height);
    if start >= end || end > height {
        return Err(Error::parameter(format!("lines {start}..{end} are not on the page: it has {height} lines, 0..{height}")));
    }
    Ok(start..end)
}

/// About 64 bands a page, a power of two of lines each, so that the number of bands follows the page's shape and not its resolution.
fn band_height(height: u32) -> u32 {
    (height / 64).next_power_of_two().clamp(64, 4096)
}

/// The distinct inks in the order of first use, and each layer's index among them.
fn distinct_inks(layers: &[Layer]) -> (Vec<Rgb>, Vec<u32>) {
    let mut inks = Vec::new();
    let mut index = std::collections::HashMap::new();
    let of_layer = layers
        .iter()
        .map(|layer| {
            *index.entry(layer.ink).or_insert_with(|| {
                inks.push(layer.ink);
                inks.len() as u32 - 1
            })
        })
        .collect();
    (inks, of_layer)
}

/// Writes what was gathered, and empties it.
fn write(out: &mut dyn Write, bytes: &mut Vec<u8>) -> Result<()> {
    out.write_all(bytes).map_err(|error| Error::output(&error))?;
    bytes.clear();
    Ok(())
}
