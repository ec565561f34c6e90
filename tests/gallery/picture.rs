//! Pictures by runset and by resvg without anti-aliasing, and where they differ.

use std::sync::{Arc, LazyLock};

use runset::error::Warning;
use runset::input;
use runset::job::{Job, Options, Size};
use runset::scene::Limits;
use usvg::fontdb::{Database, Source};

/// A picture, row by row; paper is none.
#[derive(PartialEq)]
pub struct Picture {
    pub width: u32,
    pub height: u32,
    pixels: Vec<Option<[u8; 3]>>,
}

impl Picture {
    /// The same in black.
    pub fn area(mut self) -> Picture {
        self.pixels.iter_mut().flatten().for_each(|p| *p = [0; 3]);
        self
    }

    pub fn is_blank(&self) -> bool {
        self.pixels.iter().all(Option::is_none)
    }

    fn at(&self, x: u32, y: u32) -> Option<[u8; 3]> {
        self.pixels[(y * self.width + x) as usize]
    }

    /// Whether a pixel and those around it are not all the same.
    fn outline(&self, x: u32, y: u32) -> bool {
        let near = |c: u32, size: u32| c.saturating_sub(1)..(c + 2).min(size);
        near(y, self.height).any(|v| near(x, self.width).any(|u| !same(self.at(u, v), self.at(x, y))))
    }
}

/// Colours through a mask lose a step or two to rounding of the alpha.
fn same(a: Option<[u8; 3]>, b: Option<[u8; 3]>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 2),
        (None, None) => true,
        _ => false,
    }
}

/// The number of pixels that differ, or the first that differs away from the outlines of both.
pub fn difference(a: &Picture, b: &Picture) -> Result<usize, (u32, u32)> {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let mut different = 0;
    for y in 0..a.height {
        for x in 0..a.width {
            if !same(a.at(x, y), b.at(x, y)) {
                different += 1;
                if !a.outline(x, y) && !b.outline(x, y) {
                    return Err((x, y));
                }
            }
        }
    }
    Ok(different)
}

/// What runset draws: the region of an expression, or the drawing itself.
pub fn ours(document: &[u8], expr: Option<&str>, scale: f64) -> Result<Picture, String> {
    let mut warnings = Vec::new();
    let job = read(document, &mut warnings).and_then(|scene| {
        let options = Options { expr: expr.map(str::to_owned), size: Size::Scale(scale), ..Options::default() };
        Job::prepare(scene, &options, &mut warnings)
    });
    let job = job.map_err(|e| format!("runset refuses it: {e}"))?;
    let (header, mut rows) = (job.header(), job.rows());
    let mut picture = Picture { width: header.width, height: header.height(), pixels: Vec::new() };
    while let Some(lines) = rows.next() {
        let mut row = vec![None; header.width as usize];
        for run in lines.runs {
            row[run.start as usize..run.end as usize].fill(Some(header.inks.colour(run.ink)));
        }
        (0..lines.n).for_each(|_| picture.pixels.extend_from_slice(&row));
    }
    Ok(picture)
}

/// The ids that runset knows.
pub fn names(text: &str) -> Vec<String> {
    read(text.as_bytes(), &mut Vec::new()).map(|scene| scene.names().iter().map(|n| n.id.clone()).collect()).unwrap_or_default()
}

fn read(document: &[u8], warnings: &mut Vec<Warning>) -> runset::error::Result<runset::scene::Scene> {
    input::read(document.to_vec(), &Limits::default(), warnings)
}

/// The family of the built-in font.
const FONT: &str = "Noto Sans";

/// The built-in font, for all families.
static FONTS: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut fonts = Database::new();
    if let Ok(file) = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/src/input/svg/font/NotoSans-Regular.ttf")) {
        fonts.load_font_source(Source::Binary(Arc::new(file)));
    }
    fonts.set_serif_family(FONT);
    fonts.set_sans_serif_family(FONT);
    fonts.set_monospace_family(FONT);
    Arc::new(fonts)
});

/// A document read by the library that draws the other picture.
pub struct Library(usvg::Tree);

impl Library {
    pub fn read(text: &str) -> Result<Library, String> {
        let options = usvg::Options {
            shape_rendering: usvg::ShapeRendering::CrispEdges,
            text_rendering: usvg::TextRendering::OptimizeSpeed,
            font_family: FONT.to_owned(),
            fontdb: FONTS.clone(),
            ..usvg::Options::default()
        };
        usvg::Tree::from_str(text, &options).map(Library).map_err(|e| e.to_string())
    }

    pub fn picture(&self, scale: f64) -> Picture {
        let size = self.0.size();
        let pixels = |length: f32| (f64::from(length) * scale + 0.5).floor().max(1.0) as u32;
        let (width, height) = (pixels(size.width()), pixels(size.height()));
        let mut canvas = tiny_skia::Pixmap::new(width, height).unwrap();
        resvg::render(&self.0, usvg::Transform::from_scale(scale as f32, scale as f32), &mut canvas.as_mut());
        let colour = |p: &tiny_skia::PremultipliedColorU8| {
            let c = p.demultiply();
            (c.alpha() > 0).then(|| [c.red(), c.green(), c.blue()])
        };
        Picture { width, height, pixels: canvas.pixels().iter().map(colour).collect() }
    }
}
