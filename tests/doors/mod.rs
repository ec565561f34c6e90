//! The doors: one function for each reader of foreign bytes, for the fuzz targets and for the replay of their corpora.
//!
//! A door takes any bytes. It panics where what is behind it does not keep its promises: errors are one line, places lie within the
//! text, and what was let in is whole and finite.

use std::io::BufRead;

use runset::error::{Error, Result, Warning};
use runset::input::lines::LineReader;
use runset::input::{ModelOptions, read_tree};
use runset::job::{Job, Kept, SolidOptions};
use runset::mesh::check::all_placed;
use runset::scene::{Area, Expression, Gate, Limits, Named, Picture, Scene};
use runset::shape::{Path, Shape, Transform};
use runset::solid::camera::Setup;

/// What takes bytes from outside.
type Door = fn(&[u8]);

/// All doors by name; a folder of `fuzz/corpus` and a target of `fuzz/fuzz_targets` belong to each.
#[allow(dead_code)] // the fuzz targets take one each
pub const DOORS: [(&str, Door); 5] = [("csg", csg), ("expression", expression), ("scene", scene), ("stream", stream), ("svg", svg)];

/// A model: an OpenSCAD tree or an STL. What was let in is put in its place, and what is small is drawn.
pub fn csg(bytes: &[u8]) {
    let mut warnings = Vec::new();
    let options = ModelOptions { limits: limits(), folder: None };
    let reading = read_tree(bytes, &options, &mut warnings);
    let Some(reading) = told(reading, &warnings, bytes) else { return };
    let model = &reading.model;
    let placed = all_placed(model, &mut warnings);
    told(Ok(()), &warnings, bytes);
    for placed in &placed {
        let mesh = &placed.mesh;
        assert!(mesh.points.iter().flatten().all(|x| x.is_finite()));
        for ring in mesh.faces.iter().flat_map(|face| &face.rings) {
            assert!(ring.len() > 2 && ring.iter().all(|&i| (i as usize) < mesh.points.len()));
        }
    }
    assert!(reading.tree.iter().filter_map(|l| l.part).all(|part| (part as usize) < model.parts.len()));
    let gates = model.formula.gates();
    for gate in gates {
        match gate {
            Gate::Shape(i) => assert!((*i as usize) < model.parts.len()),
            Gate::AtLeast(_, inputs) | Gate::Odd(inputs) => assert!(inputs.iter().all(|i| i.area.index() < gates.len())),
        }
    }
    if placed.iter().map(|placed| placed.mesh.faces.len()).sum::<usize>() > 200 {
        return;
    }
    let kept = Kept::new(model, &Limits::default(), &mut Vec::new()).expect("a small model");
    for orthographic in [false, true] {
        let setup = Setup { orthographic, width: 24, height: 20, ..Setup::default() };
        let job = Job::solid(&kept, &SolidOptions { setup, ..SolidOptions::default() }).expect("a page and a camera");
        let (mut rows, mut y) = (job.rows(), 0);
        while let Some(lines) = rows.next() {
            assert!(lines.check(job.header()) && lines.y == y);
            y += lines.n;
        }
        assert_eq!(y, 20);
    }
}

/// An expression, over a scene with the names `a`, `b` and `c-d`.
pub fn expression(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let mut scene = Scene::new(9.0, 9.0);
    for (i, id) in (0..).zip(["a", "b", "c-d"]) {
        let shape = Shape::new(id, Path::default());
        let area = scene.add_shape(shape);
        scene.add_name(Named { id: id.to_owned(), kind: "shape", area, shapes: std::iter::once(i..i + 1).collect(), ink: None, depth: 0 });
    }
    let mut warnings = Vec::new();
    let area = Expression::parse(text, &limits()).and_then(|e| scene.resolve(&e, &mut warnings));
    if let Some(area) = told(area, &warnings, bytes) {
        whole(&scene, area);
    }
}

/// A JSON scene.
pub fn scene(bytes: &[u8]) {
    document(bytes);
}

/// An SVG.
pub fn svg(bytes: &[u8]) {
    document(bytes);
}

/// A line stream.
pub fn stream(bytes: &[u8]) {
    let mut input: &mut dyn BufRead = &mut &*bytes;
    let Some(mut reader) = told(LineReader::open(&mut input), &[], bytes) else { return };
    let header = reader.header().clone();
    let mut y = header.lines.start;
    while let Some(Some(lines)) = told(reader.next_lines(), &[], bytes) {
        assert!(lines.check(&header) && lines.y == y);
        y += lines.n;
    }
}

fn document(bytes: &[u8]) {
    let mut warnings = Vec::new();
    let scene = runset::input::read(bytes.to_vec(), &limits(), &mut warnings);
    let Some(scene) = told(scene, &warnings, bytes) else { return };
    assert!(scene.width > 0.0 && scene.width.is_finite() && scene.height > 0.0 && scene.height.is_finite());
    for shape in &scene.shapes {
        let numbers = match shape.transform {
            Transform::Affine(m) => m.to_vec(),
            Transform::Projective(m) => m.to_vec(),
        };
        assert!(shape.path.points().iter().flatten().chain(&numbers).all(|x| x.is_finite()), "{}", shape.name);
    }
    for name in scene.names() {
        assert!(name.shapes.iter().all(|r| r.start < r.end && r.end as usize <= scene.shapes.len()));
        whole(&scene, name.area);
    }
    whole(&scene, scene.art);
    match &scene.picture {
        Picture::Region(area) => whole(&scene, *area),
        Picture::Layers(layers) => layers.iter().for_each(|l| whole(&scene, l.area)),
    }
}

/// Small limits, so that a small input can pass them.
fn limits() -> Limits {
    Limits { input: 1 << 20, edges: 10_000, nodes: 1000, faces: 10_000, fragments: 1000, depth: 100, ..Limits::default() }
}

fn told<T>(result: Result<T>, warnings: &[Warning], bytes: &[u8]) -> Option<T> {
    let one_line = |text: &str| assert!(!text.is_empty() && !text.contains(char::is_control), "{text:?}");
    warnings.iter().for_each(|w| one_line(&w.what));
    let error: Error = match result {
        Ok(value) => return Some(value),
        Err(error) => error,
    };
    one_line(&error.what);
    assert!(!error.what.starts_with("the SVG library fails"), "{error}");
    if let Some(place) = error.place {
        // What was compressed has other lines.
        let lines = bytes.iter().filter(|&&b| b == b'\n').count() + 1;
        assert!(place.line >= 1 && place.column >= 1 && (place.line as usize <= lines || bytes.starts_with(b"\x1f\x8b")), "{error}");
    }
    None
}

/// An area is a gate of the scene, and so are its inputs.
fn whole(scene: &Scene, area: Area) {
    match &scene.formula.gates()[area.index()] {
        Gate::Shape(i) => assert!((*i as usize) < scene.shapes.len()),
        Gate::AtLeast(_, inputs) | Gate::Odd(inputs) => inputs.iter().for_each(|i| assert!(i.area.index() < scene.formula.gates().len())),
    }
}
