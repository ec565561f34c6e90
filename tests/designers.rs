//! Files as designers' programs write them, by the ten thousands of paths: no id is lost, and everything lands where it should.
//!
//! The generators know from their own 64-bit arithmetic where each path lies.

#![allow(clippy::unwrap_used)] // all of this is tests

use std::collections::HashMap;
use std::fmt::Write;
use std::time::{Duration, Instant};

use runset::input;
use runset::job::{Entry, info};
use runset::scene::{Limits, Picture};

const PATHS: usize = 50_000;

/// Reading one of the files may take so long, on a slow and busy machine.
const TIME: Duration = Duration::from_secs(20);

type Matrix = [f64; 6];

/// The map that applies `inner` first.
fn product([a, b, c, d, e, f]: Matrix, [g, h, i, j, k, l]: Matrix) -> Matrix {
    [a * g + c * h, b * g + d * h, a * i + c * j, b * i + d * j, a * k + c * l + e, b * k + d * l + f]
}

/// A file, and what must be found in it: for every id that paints, its bounds where they are known.
#[derive(Default)]
struct File {
    text: String,
    ids: Vec<(String, Option<[f64; 4]>)>,
    /// Ids that paint nothing.
    silent: Vec<String>,
    inks: usize,
}

impl File {
    /// The bounds of an axis-parallel rectangle after a transform.
    fn place(&mut self, id: String, [x, y, w, h]: [f64; 4], [a, b, c, d, e, f]: Matrix) {
        let corners = [[x, y], [x + w, y], [x, y + h], [x + w, y + h]].map(|[x, y]| [a * x + c * y + e, b * x + d * y + f]);
        let bound = |k: usize, f: fn(f64, f64) -> f64| corners.iter().map(|p| p[k]).reduce(f).unwrap();
        self.ids.push((id, Some([bound(0, f64::min), bound(1, f64::min), bound(0, f64::max), bound(1, f64::max)])));
    }
}

/// Layers within layers, ten deep, each with a transform; labels and settings of the program on every element; styles in `style`.
fn inkscape() -> File {
    let mut file = File { inks: 7, ..File::default() };
    file.text.push_str(
        r##"<?xml version="1.0" encoding="UTF-8" standalone="no"?>
<!-- Created with Inkscape (http://www.inkscape.org/) -->
<svg width="420mm" height="297mm" viewBox="0 0 420 297" version="1.1" id="svg5" inkscape:version="1.3 (0e150ed6c4, 2023-07-21)" sodipodi:docname="plan.svg"
   xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" xmlns:sodipodi="http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd"
   xmlns="http://www.w3.org/2000/svg" xmlns:svg="http://www.w3.org/2000/svg">
<sodipodi:namedview id="namedview7" pagecolor="#ffffff" inkscape:document-units="mm"><inkscape:grid id="grid9" type="xygrid"/></sodipodi:namedview>
<defs id="defs2"><inkscape:path-effect effect="skeletal" id="path-effect1"/></defs>
"##,
    );
    file.silent.push("defs2".into());
    file.ids.push(("svg5".into(), None));
    // A millimetre is 96/25.4 user units.
    let page = 96.0 / 25.4;
    let inks = ["#1b9e77", "#d95f02", "#7570b3", "#e7298a", "#66a61e", "#e6ab02", "#a6761d"];
    let per_layer = PATHS / 50;
    for top in 0..5 {
        let mut whole = [page, 0.0, 0.0, page, 0.0, 0.0];
        for depth in 0..10 {
            let id = format!("layer{top}-{depth}");
            let (s, t) = (1.0 + 0.01 * f64::from(depth), 0.25 * f64::from(top));
            let (transform, matrix): (String, Matrix) = match depth % 3 {
                0 => (format!("translate({t},{})", t / 2.0), [1.0, 0.0, 0.0, 1.0, t, t / 2.0]),
                1 => (format!("matrix({s},0,0,{s},{t},-0.5)"), [s, 0.0, 0.0, s, t, -0.5]),
                _ => {
                    let angle = 0.5_f64;
                    let (sin, cos) = angle.to_radians().sin_cos();
                    (format!("rotate({angle})"), [cos, sin, -sin, cos, 0.0, 0.0])
                }
            };
            whole = product(whole, matrix);
            writeln!(
                file.text,
                r#"<g inkscape:groupmode="layer" id="{id}" inkscape:label="Ebene {top}.{depth}" style="display:inline" transform="{transform}">"#
            )
            .unwrap();
            file.ids.push((id, None));
            for i in 0..per_layer {
                let id = format!("path{top}{depth}-{i}");
                let (x, y) = ((i % 40 * 9) as f64 + 0.125 * f64::from(depth), (i / 40 * 9) as f64 + 0.5);
                let (w, h) = (1.0 + (i % 5) as f64, 1.5);
                writeln!(
                    file.text,
                    r#"<path style="fill:{};fill-opacity:1;stroke:none;stroke-width:0.264583px;-inkscape-stroke:none" d="m {x},{y} h {w} v {h} h -{w} z" id="{id}" inkscape:connector-curvature="0" sodipodi:nodetypes="ccccc" />"#,
                    inks[(i / 100) % inks.len()]
                )
                .unwrap();
                file.place(id, [x, y, w, h], whole);
            }
        }
        file.text.push_str(&"</g>\n".repeat(10));
    }
    file.text.push_str("</svg>\n");
    file
}

/// Entities for namespaces, a `switch` around everything, classes instead of attributes, clip paths through `use`, escaped ids.
fn illustrator() -> File {
    let mut file = File { inks: 9, ..File::default() };
    file.text.push_str(
        r#"<?xml version="1.0" encoding="utf-8"?>
<!-- Generator: Adobe Illustrator 16.0.0, SVG Export Plug-In . SVG Version: 6.00 Build 0)  -->
<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd" [
	<!ENTITY ns_extend "http://ns.adobe.com/Extensibility/1.0/">
	<!ENTITY ns_ai "http://ns.adobe.com/AdobeIllustrator/10.0/">
]>
<svg version="1.1" id="Layer_1" xmlns:x="&ns_extend;" xmlns:i="&ns_ai;" xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"
	 x="0px" y="0px" width="841.89px" height="595.28px" viewBox="0 0 841.89 595.28" enable-background="new 0 0 841.89 595.28" xml:space="preserve">
<style type="text/css">
"#,
    );
    for k in 0..9 {
        writeln!(file.text, "\t.st{k}{{fill:#{:02X}4{k}{k}0;}}", 20 * k + 16).unwrap();
    }
    file.text.push_str("\t.clip{clip-path:url(#SVGID_2_);}\n</style>\n<switch id=\"switch\">\n<foreignObject requiredExtensions=\"&ns_ai;\" x=\"0\" y=\"0\" width=\"1\" height=\"1\"></foreignObject>\n<g i:extraneous=\"self\" id=\"all\">\n");
    file.ids.extend([("Layer_1".into(), None), ("switch".into(), None), ("all".into(), None)]);
    let per_layer = PATHS / 20;
    for layer in 0..20 {
        let id = format!("Layer_x0020_{layer}");
        let clipped = if layer == 7 { " class=\"clip\"" } else { "" };
        writeln!(file.text, r##"<g id="{id}" i:layer="yes" i:dimmedPercent="50" i:rgbTrio="#4F008000FFFF"{clipped}>"##).unwrap();
        file.ids.push((id, None));
        if layer == 7 {
            file.text.push_str("<defs><rect id=\"SVGID_1_\" x=\"0\" y=\"0\" width=\"841.89\" height=\"595.28\"/></defs><clipPath id=\"SVGID_2_\"><use xlink:href=\"#SVGID_1_\"  overflow=\"visible\"/></clipPath>\n");
            file.silent.extend(["SVGID_1_".into(), "SVGID_2_".into()]);
        }
        for i in 0..per_layer {
            let id = format!("XMLID_{layer}_{i}_");
            let (x, y) = ((i % 80 * 10) as f64 + 0.25 * f64::from(layer), (i / 80 * 18) as f64 + 0.75);
            let (w, h) = (4.0 + (i % 3) as f64, 3.5);
            writeln!(
                file.text,
                "\t<path id=\"{id}\" class=\"st{}\" d=\"M{},{}H{x}v-{h}h{w}V{}z\"/>",
                (i / 50 + layer as usize) % 9,
                x + w,
                y + h,
                y + h
            )
            .unwrap();
            file.place(id, [x, y, w, h], [1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
        }
        file.text.push_str("</g>\n");
    }
    file.text.push_str("</g>\n</switch>\n</svg>\n");
    file
}

fn nothing_is_lost(name: &str, file: File) {
    let File { text, ids, silent, inks } = file;
    let (length, start, mut warnings) = (text.len(), Instant::now(), Vec::new());
    let scene = input::read(text.into_bytes(), &Limits::default(), &mut warnings).unwrap();
    let took = start.elapsed();
    println!("{name}: {} ids in {} KiB read in {took:?}", ids.len(), length >> 10);
    assert!(took < TIME, "{took:?}");
    let warnings: Vec<_> = warnings.iter().map(|w| &w.what).take(5).collect();
    assert!(warnings.is_empty(), "{warnings:?}");

    let info = info(&scene).unwrap();
    let entries: HashMap<&str, &Entry> = info.ids.iter().map(|e| (e.id.as_str(), e)).collect();
    assert_eq!(entries.len(), ids.len() + silent.len());
    for (id, expected) in &ids {
        assert!(!scene.is_empty(id), "{id} paints");
        let entry = entries[id.as_str()];
        let bounds = entry.bounds.unwrap_or_else(|| panic!("{id} has bounds"));
        let off = expected.map_or(0.0, |e| bounds.iter().zip(e).fold(0.0, |far: f64, (b, e)| far.max((b - e).abs())));
        // Coordinates and matrices are 32-bit: about 2^-24 of a page of 1600 units, ten times over.
        assert!(off < 2e-3, "{id}: {bounds:?}, not {expected:?}");
    }
    assert!(silent.iter().all(|id| entries[id.as_str()].bounds.is_none() && scene.is_empty(id)));
    let Picture::Layers(layers) = &scene.picture else { panic!("layers") };
    let used: std::collections::HashSet<_> = layers.iter().map(|l| l.ink).collect();
    assert_eq!(used.len(), inks);
}

#[test]
fn inkscape_s_layers_ten_deep() {
    nothing_is_lost("Inkscape", inkscape());
}

#[test]
fn illustrator_s_switch_and_classes() {
    nothing_is_lost("Illustrator", illustrator());
}
