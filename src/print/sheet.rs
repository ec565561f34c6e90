//! Where a drawing lies on a sheet (print-scaling of PWG 5100.16), and what of it is printed.
//!
//! ```text
//!   none                 fit                  fill
//!   +-----------+        +-----------+        +-----------+
//!   |  .-----.  |        | :       : |        |#         #|      # cut off
//!   |  |     |  |        | :drawing: |        |# drawing #|      : at the edge of what the printer reaches
//!   |  '-----'  |        | :       : |        |#         #|
//!   +-----------+        +-----------+        +-----------+
//! ```

use super::media::{Chosen, INCH};
use crate::edge::Placement;
use crate::error::{Result, Warning};
use crate::grid::Point;
use crate::job::{Options, Size};
use crate::run::{BLACK, Pixels};
use crate::scene::{Expression, Limits, Picture, Scene};
use crate::shape::{Path, Shape};

/// User units to an inch, as in CSS.
const UNITS: f64 = 96.0;

/// Millimetres within which a drawing counts as no larger than the sheet, in hundredths.
const SLACK: f64 = 100.0;

/// How a drawing is brought to the size of a sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scaling {
    /// As it is, if it is no larger than the sheet, else as `fit`, or as `fill` on a sheet without margins.
    #[default]
    Auto,
    /// As large as the printer reaches, aspect kept.
    Fit,
    /// As large as the sheet, aspect kept; what is over is cut off.
    Fill,
    /// As large as it is, in the middle.
    None,
}

impl Scaling {
    /// All of them.
    pub const ALL: [Scaling; 4] = [Scaling::Auto, Scaling::Fit, Scaling::Fill, Scaling::None];

    /// Its keyword.
    pub fn name(self) -> &'static str {
        match self {
            Scaling::Auto => "auto",
            Scaling::Fit => "fit",
            Scaling::Fill => "fill",
            Scaling::None => "none",
        }
    }
}

/// A sheet of pixels and a drawing's place on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// Dots an inch.
    pub dpi: u32,
    /// From user units of the drawing, turned if it is, to pixels.
    pub placement: Placement,
    /// Whether the drawing is turned by a quarter, clockwise.
    pub turned: bool,
    /// How it was brought to size; not `Auto`.
    pub scaling: Scaling,
    /// What pixels are to be, where the format leaves a choice.
    pub pixels: Option<Pixels>,
    /// Whether the printer cuts off some of it at the margins of the sheet.
    pub cut: bool,
}

/// The size of a drawing in hundredths of a millimetre.
pub fn size(scene: &Scene) -> [f64; 2] {
    [scene.width, scene.height].map(|units| units / UNITS * INCH)
}

/// The least that shows all inks of a drawing; an expression over it is black.
pub fn pixels(scene: &Scene, expr: Option<&str>) -> Pixels {
    let Picture::Layers(layers) = &scene.picture else { return Pixels::Black };
    match expr {
        None if layers.iter().any(|layer| layer.ink != [layer.ink[0]; 3]) => Pixels::Rgb,
        None if layers.iter().any(|layer| layer.ink != BLACK) => Pixels::Gray,
        _ => Pixels::Black,
    }
}

/// Lays a drawing of that size, in hundredths of a millimetre, on a medium.
pub fn lay(drawing: [f64; 2], medium: &Chosen, dpi: u32, scaling: Scaling, turned: bool) -> Sheet {
    let dots = f64::from(dpi) / INCH;
    let pixels = |length: f64| (length * dots * (1.0 + 8.0 * f64::EPSILON) + 0.5).floor().max(1.0);
    let sheet = medium.size.map(f64::from);
    let [width, height] = sheet.map(pixels);
    let [w, h] = if turned { [drawing[1], drawing[0]] } else { drawing };
    let scaling = match scaling {
        Scaling::Auto if w <= sheet[0] + SLACK && h <= sheet[1] + SLACK => Scaling::None,
        Scaling::Auto if medium.margins == [0; 4] => Scaling::Fill,
        Scaling::Auto => Scaling::Fit,
        scaling => scaling,
    };
    let [top, right, bottom, left] = medium.margins.map(f64::from);
    // What is aimed at: a corner and a size, in hundredths of a millimetre.
    let (corner, room) = match scaling {
        Scaling::Fit => ([left, top], [(sheet[0] - left - right).max(1.0), (sheet[1] - top - bottom).max(1.0)]),
        _ => ([0.0; 2], sheet),
    };
    let factor = match scaling {
        Scaling::Fit => (room[0] / w).min(room[1] / h),
        Scaling::Fill => (room[0] / w).max(room[1] / h),
        _ => 1.0,
    };
    let scale = factor * f64::from(dpi) / UNITS;
    let at = |i: usize, size: f64, whole: f64| {
        let start = corner[i] + (room[i] - size * factor) / 2.0;
        // As large as the sheet, to the pixel: it lies at the corner, as on a page of its own.
        let same = scaling != Scaling::Fit && pixels(size * factor) == whole;
        if same { 0.0 } else { start * dots }
    };
    let offset = [at(0, w, width), at(1, h, height)];
    let (x, y) = (offset[0] / dots, offset[1] / dots);
    let over = |a: f64, b: f64| a < b - 1.0;
    let cut = over(x, left) || over(y, top) || over(sheet[0] - right, x + w * factor) || over(sheet[1] - bottom, y + h * factor);
    Sheet { width: width as u32, height: height as u32, dpi, placement: Placement { scale, offset }, turned, scaling, pixels: None, cut }
}

/// What is to be drawn on a sheet: the document's own picture or an expression over it, within the drawing's page and `bleed` hundredths of a millimetre around it.
///
/// # Errors
/// An expression that does not parse or names what is not there.
pub fn compose(
    scene: &mut Scene,
    expr: Option<&str>,
    bleed: f64,
    sheet: &Sheet,
    limits: &Limits,
    warnings: &mut Vec<Warning>,
) -> Result<Options> {
    if let Some(text) = expr {
        let expression = Expression::parse(text, limits)?;
        scene.picture = Picture::Region(scene.resolve(&expression, warnings)?);
    }
    let bleed = bleed / INCH * UNITS;
    let mut page = Path::default();
    let [right, bottom]: Point = [scene.width + bleed, scene.height + bleed];
    page.ring(&[[-bleed, -bleed], [right, -bleed], [right, bottom], [-bleed, bottom]]);
    let page = scene.add_shape(Shape::new("page", page));
    scene.picture = match std::mem::replace(&mut scene.picture, Picture::Layers(Vec::new())) {
        Picture::Region(area) => Picture::Region(scene.formula.all(&[area, page])),
        Picture::Layers(mut layers) => {
            layers.iter_mut().for_each(|layer| layer.area = scene.formula.all(&[layer.area, page]));
            Picture::Layers(layers)
        }
    };
    if sheet.turned {
        let height = scene.height;
        scene.shapes.iter_mut().for_each(|shape| shape.transform = shape.transform.then_turn(height));
        (scene.width, scene.height) = (scene.height, scene.width);
    }
    let Sheet { width, height, dpi, placement, pixels, .. } = *sheet;
    Ok(Options {
        size: Size::Placed { width, height, placement },
        dpi: Some(f64::from(dpi)),
        pixels,
        limits: *limits,
        ..Options::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encode::by_name;
    use crate::job::Job;

    fn medium(size: [i32; 2], margin: i32) -> Chosen {
        Chosen { name: None, size, margins: [margin; 4], named: false }
    }

    #[test]
    fn places_by_hand() {
        // An inch is 2540; 100 dots an inch.
        let lay = |w: f64, h: f64, margin: i32, scaling| {
            let sheet = lay([w * INCH, h * INCH], &medium([2540 * 4, 2540 * 6], margin), 100, scaling, false);
            assert_eq!((sheet.width, sheet.height), (400, 600));
            let [x, y] = sheet.placement.offset.map(|x| (x * 1e6).round() / 1e6);
            (sheet.scaling, sheet.placement.scale * UNITS / 100.0, [x, y], sheet.cut)
        };
        assert_eq!(lay(2.0, 2.0, 254, Scaling::None), (Scaling::None, 1.0, [100.0, 200.0], false));
        assert_eq!(lay(4.0, 6.0, 254, Scaling::Auto), (Scaling::None, 1.0, [0.0, 0.0], true));
        assert_eq!(lay(8.0, 8.0, 254, Scaling::Auto).0, Scaling::Fit);
        assert_eq!(lay(8.0, 8.0, 0, Scaling::Auto).0, Scaling::Fill);
        // 3.8 inches of width: half as large would be 4.
        assert_eq!(lay(7.6, 7.6, 254, Scaling::Fit), (Scaling::Fit, 0.5, [10.0, 110.0], false));
        assert_eq!(lay(2.0, 2.0, 254, Scaling::Fill), (Scaling::Fill, 3.0, [-100.0, 0.0], true));
    }

    fn scene(text: &str) -> Scene {
        crate::input::read(text.as_bytes().to_vec(), &Limits::default(), &mut Vec::new()).unwrap()
    }

    fn picture(scene: Scene, options: &Options) -> String {
        let job = Job::prepare(scene, options, &mut Vec::new()).unwrap();
        let mut pbm = Vec::new();
        job.render(by_name("pgm").unwrap(), 1, &mut pbm, &mut |_| {}).unwrap();
        let (width, height) = (job.header().width as usize, job.header().height() as usize);
        let pixels = &pbm[pbm.len() - width * height..];
        pixels.chunks(width).map(|row| row.iter().map(|&v| if v == 0 { '#' } else { '.' }).collect::<String>() + "\n").collect()
    }

    /// A triangle in the corner of a page of 6 x 4 units that reaches over its left edge, and a bar below the page.
    const TEXT: &str =
        r#"{ "width": 6, "height": 4, "expr": "a", "shapes": { "a": { "path": "M -2 0 L 5 0 L -2 3 Z M 0 5 L 6 5 L 6 6 L 0 6 Z" } } }"#;

    fn sheet(width: u32, height: u32, offset: Point, turned: bool) -> Sheet {
        let placement = Placement { scale: 1.0, offset };
        Sheet { width, height, dpi: 96, placement, turned, scaling: Scaling::None, pixels: None, cut: false }
    }

    #[test]
    fn what_is_outside_of_the_drawing_is_not_printed_but_its_bleed() {
        let drawn = |expr: Option<&str>, bleed: f64, turned: bool| {
            let mut scene = scene(TEXT);
            let sheet = if turned { sheet(6, 8, [1.0, 1.0], true) } else { sheet(8, 8, [1.0, 1.0], false) };
            let options = compose(&mut scene, expr, bleed, &sheet, &Limits::default(), &mut Vec::new()).unwrap();
            picture(scene, &options)
        };
        assert_eq!(drawn(None, 0.0, false), "........\n.####...\n.#......\n........\n........\n........\n........\n........\n");
        // A unit of bleed: the corner's left, and no bar, which is two units away.
        assert_eq!(drawn(None, INCH / 96.0, false), "........\n#####...\n##......\n........\n........\n........\n........\n........\n");
        assert_eq!(drawn(Some("!a"), 0.0, false), "........\n.....##.\n..#####.\n.######.\n.######.\n........\n........\n........\n");
        // A quarter, clockwise: the top is at the right. The centre that lies on the slanted side was on a right boundary, and is on a left one now.
        assert_eq!(drawn(None, 0.0, true), "......\n...##.\n...##.\n....#.\n....#.\n......\n......\n......\n");
    }

    #[test]
    fn a_sheet_of_the_drawings_own_size_is_the_page_of_a_fill() {
        // A4 in CSS pixels, as drawing programs write it.
        let text =
            r#"{ "width": 793.7007874, "height": 1122.519685, "expr": "a", "shapes": { "a": { "path": "M 0 0 L 793.7 0 L 10 1122 Z" } } }"#;
        for (dpi, pixels) in [(72, [595, 842]), (300, [2480, 3508]), (600, [4961, 7016])] {
            let mut own = scene(text);
            let sheet = lay(size(&own), &medium([21000, 29700], 0), dpi, Scaling::None, false);
            assert_eq!([sheet.width, sheet.height], pixels);
            let options = compose(&mut own, None, 0.0, &sheet, &Limits::default(), &mut Vec::new()).unwrap();
            let filled = Options { size: Size::Dpi(f64::from(dpi)), ..Options::default() };
            let bytes = |scene, options| {
                let mut bytes = Vec::new();
                Job::prepare(scene, options, &mut Vec::new()).unwrap().render(by_name("png").unwrap(), 1, &mut bytes, &mut |_| {}).unwrap();
                bytes
            };
            assert!(bytes(own, &options) == bytes(scene(text), &filled), "{dpi}");
        }
    }
}
