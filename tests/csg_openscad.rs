//! Primitives and extrusions have the corners that OpenSCAD gives them: every model is exported by `openscad` as STL and compared with what is
//! read here. Without `openscad` nothing is compared, and that is said.

#![allow(clippy::unwrap_used)] // all of this is tests

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use runset::input::{ModelOptions, read_model};
use runset::mesh::check::all_placed;

/// Points of the first set that have no point of the other within the tolerance.
fn alone(a: &[[f64; 3]], b: &[[f64; 3]], tolerance: f64) -> Vec<[f64; 3]> {
    let mut sorted = b.to_vec();
    sorted.sort_by(|p, q| p[0].total_cmp(&q[0]));
    let near = |p: &[f64; 3]| {
        let from = sorted.partition_point(|q| q[0] < p[0] - tolerance);
        sorted[from..].iter().take_while(|q| q[0] <= p[0] + tolerance).any(|q| (0..3).all(|i| (p[i] - q[i]).abs() <= tolerance))
    };
    a.iter().filter(|p| !near(p)).copied().collect()
}

fn exported(folder: &Path, name: &str, text: &str) -> Option<Vec<[f64; 3]>> {
    let [csg, stl] = ["csg", "stl"].map(|e| folder.join(format!("{name}.{e}")));
    std::fs::write(&csg, text).unwrap();
    let ran = Command::new("openscad").arg("-o").arg(&stl).arg(&csg).output().unwrap();
    assert!(ran.status.success(), "{text}: {}", String::from_utf8_lossy(&ran.stderr));
    let text = std::fs::read_to_string(&stl).ok()?;
    let numbers = |line: &str| {
        let numbers: Vec<f64> = line.trim().strip_prefix("vertex")?.split_whitespace().map(|w| w.parse().unwrap()).collect();
        Some([numbers[0], numbers[1], numbers[2]])
    };
    Some(text.lines().filter_map(numbers).collect())
}

/// All corners of a model that is one part, or several that do not meet.
fn read(text: &str) -> Vec<[f64; 3]> {
    let mut warnings = Vec::new();
    let model = read_model(text.as_bytes(), &ModelOptions::default(), &mut warnings).unwrap();
    let placed = all_placed(&model, &mut warnings);
    assert!(warnings.is_empty(), "{text}: {warnings:?}");
    let used = placed.iter().flat_map(|p| p.mesh.faces.iter().flat_map(|f| f.rings.iter().flatten()).map(|&i| p.mesh.points[i as usize]));
    used.collect()
}

/// Trees that touch, coincide and go through each other: their surfaces have the volumes of those that OpenSCAD works out.
#[test]
fn volumes_of_surfaces() {
    if Command::new("openscad").arg("--version").output().is_err() {
        assert!(std::env::var_os("CI").is_none_or(|ci| ci != "true"), "openscad is missing");
        println!("skipped: openscad is not installed");
        return;
    }
    let at = |x: &str, y: &str, z: &str, what: &str| {
        format!("multmatrix([[1, 0, 0, {x}], [0, 1, 0, {y}], [0, 0, 1, {z}], [0, 0, 0, 1]]) {{ {what} }}")
    };
    let cube = "cube(size = [2, 2, 2], center = true);";
    let ball = "sphere($fn = 20, r = 1.2);";
    let pin = "cylinder($fn = 17, h = 5, r1 = 0.5, r2 = 0.7, center = true);";
    let ring = format!("rotate_extrude(angle = 360, convexity = 2, $fn = 24) {{ {} }}", at("2", "0", "0", "circle($fn = 9, r = 0.5);"));
    let twisted = "linear_extrude(height = 3, twist = 90, scale = [1, 1], $fn = 20) { square(size = [2, 1], center = true); }";
    let models = [
        format!("difference() {{ {cube} {pin} {ball} }}"),
        format!("union() {{ {cube} {} {} }}", at("1", "0", "0", cube), at("0", "1", "1", cube)),
        format!("difference() {{ {cube} {} }}", at("1", "0", "0", cube)),
        format!("intersection() {{ {cube} {ball} {} }}", at("0.3", "0", "0.2", pin)),
        format!(
            "difference() {{ union() {{ {ring} {cube} }} {} intersection() {{ {ball} {} }} }}",
            at("2", "0", "0", pin),
            at("0.5", "0.5", "0.5", cube)
        ),
        format!("difference() {{ {twisted} {} render() {{ difference() {{ {ball} {pin} }} }} }}", at("0", "0", "2", ball)),
        format!("union() {{ hull() {{ {cube} {} }} difference() {{ {ring} {cube} }} }}", at("0", "3", "0", ball)),
    ];
    let folder = tempfile::tempdir().unwrap();
    let volume = |corners: &[[f64; 3]]| -> f64 {
        let sixth = |t: &[[f64; 3]]| {
            let [a, b, c] = [t[0], t[1], t[2]];
            a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        corners.chunks_exact(3).map(|t| sixth(t) / 6.0).sum()
    };
    for (i, text) in models.iter().enumerate() {
        let theirs = volume(&exported(folder.path(), &format!("volume{i}"), text).unwrap());
        let mut warnings = Vec::new();
        let model = read_model(text.as_bytes(), &ModelOptions::default(), &mut warnings).unwrap();
        let facets = runset::job::stl(&model, &mut warnings).unwrap();
        assert!(warnings.is_empty(), "{text}: {warnings:?}");
        let ours = volume(&facets.iter().flatten().map(|p| p.map(f64::from)).collect::<Vec<_>>());
        // OpenSCAD writes six digits.
        assert!((ours / theirs - 1.0).abs() < 1e-4, "{text}: {ours}, and {theirs}");
    }
}

fn distinct(points: &[[f64; 3]], step: f64) -> usize {
    points.iter().map(|p| p.map(|x| (x / step).round() as i64)).collect::<BTreeSet<_>>().len()
}

fn compare(models: &[String]) {
    if Command::new("openscad").arg("--version").output().is_err() {
        assert!(std::env::var_os("CI").is_none_or(|ci| ci != "true"), "openscad is missing");
        println!("skipped: openscad is not installed");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut wrong = Vec::new();
    for (i, text) in models.iter().enumerate() {
        let theirs = exported(folder.path(), &i.to_string(), text).unwrap();
        let ours = read(text);
        let size = theirs.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
        // OpenSCAD writes six digits.
        let tolerance = size * 2e-5;
        let (missing, more) = (alone(&theirs, &ours, tolerance), alone(&ours, &theirs, tolerance));
        let counts = [&theirs, &ours].map(|points| distinct(points, size * 1e-4));
        if !missing.is_empty() || !more.is_empty() || theirs.is_empty() || counts[0].abs_diff(counts[1]) * 50 > counts[0] {
            wrong.push(format!(
                "{text}: missing {} ({:?}), more {} ({:?}), {counts:?}",
                missing.len(),
                missing.first(),
                more.len(),
                more.first()
            ));
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), models.len(), wrong.join("\n"));
    println!("{} models compared", models.len());
}

const FINENESS: [&str; 7] =
    ["$fn = 0, $fa = 12, $fs = 2", "$fn = 3", "$fn = 4", "$fn = 7", "$fn = 30", "$fa = 5, $fs = 0.3", "$fn = 100.9"];

#[test]
fn primitives() {
    let mut models = vec!["cube(size = [1, 2, 3], center = false);".to_owned(), "cube(size = [0.1, 2, 300], center = true);".to_owned()];
    for fineness in FINENESS {
        for r in ["0.2", "1", "4", "33.3"] {
            models.push(format!("sphere({fineness}, r = {r});"));
            models.push(format!("cylinder({fineness}, h = 5, r1 = {r}, r2 = {r}, center = false);"));
            models.push(format!("cylinder({fineness}, h = 5, r1 = {r}, r2 = 0, center = true);"));
            models.push(format!("cylinder({fineness}, h = 5, r1 = 0, r2 = {r}, center = true);"));
            models.push(format!("cylinder({fineness}, h = 5, r1 = 3, r2 = {r}, center = true);"));
        }
    }
    models.push("multmatrix([[0, -2, 0, 1], [1, 0, 0.5, 2], [0, 0, 1, 3], [0, 0, 0, 1]]) { sphere($fn = 9, r = 3); }".to_owned());
    models.push(
        "polyhedron(points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], faces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]);"
            .to_owned(),
    );
    compare(&models);
}

const OUTLINES: [&str; 8] = [
    "square(size = [2, 3], center = false);",
    "square(size = [2, 3], center = true);",
    "circle($fn = 11, r = 2);",
    "multmatrix([[1, 0, 0, 3], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) { circle($fn = 0, $fa = 12, $fs = 2, r = 2); }",
    "multmatrix([[-1, 0, 0, 5], [0, 2, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) { polygon(points = [[0, 0], [4, 0], [4, 4], [1, 1]], paths = undef, convexity = 1); }",
    "polygon(points = [[1, 0], [9, 0], [9, 9], [1, 9], [2, 2], [5, 2], [5, 5], [2, 5]], paths = [[0, 1, 2, 3], [4, 5, 6, 7]], convexity = 1);",
    "difference() { square(size = [6, 6], center = false); multmatrix([[1, 0, 0, 6], [0, 1, 0, 6], [0, 0, 1, 0], [0, 0, 0, 1]]) { circle($fn = 20, r = 4); } }",
    "intersection() { circle($fn = 12, r = 3); square(size = [3, 3], center = false); }",
];

#[test]
fn extrusions() {
    let mut models = Vec::new();
    for outline in OUTLINES {
        for how in [
            "center = false, scale = [1, 1], $fn = 0, $fa = 12, $fs = 2",
            "center = true, scale = [2, 2], $fn = 0, $fa = 12, $fs = 2",
            "center = true, scale = [0.5, 2], $fn = 0, $fa = 12, $fs = 2",
            "center = false, scale = [0.5, 2], $fn = 7",
            "scale = [0, 0], $fn = 0, $fa = 12, $fs = 2",
            "twist = 90, scale = [1, 1], $fn = 0, $fa = 12, $fs = 2",
            "twist = -200, scale = [1, 1], $fn = 0, $fa = 12, $fs = 2",
            "twist = 90, scale = [1, 1], $fn = 50",
            "twist = 90, scale = [2, 2], $fa = 3, $fs = 0.5",
            "twist = 60, scale = [0.5, 0.5], $fa = 3, $fs = 0.5",
            "twist = 60, scale = [0.5, 0.7], $fa = 3, $fs = 0.5",
            "twist = 60, scale = [1, 1], slices = 3",
            "scale = [1, 0.4], slices = 5",
        ] {
            models.push(format!("linear_extrude(height = 7, convexity = 1, {how}) {{ {outline} }}"));
        }
    }
    compare(&models);
}

#[test]
fn turned_outlines() {
    let mut models = Vec::new();
    let square = "square(size = [2, 3], center = false);";
    let ring = "multmatrix([[1, 0, 0, 4], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) { circle($fn = 9, r = 1.5); }";
    let left = "multmatrix([[1, 0, 0, -4], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) { circle($fn = 9, r = 1.5); }";
    let hole = OUTLINES[5];
    for outline in [square, ring, left, hole] {
        for angle in ["360", "90", "-120", "200", "1", "359", "720"] {
            for fineness in ["$fn = 0, $fa = 12, $fs = 2", "$fn = 5", "$fn = 32"] {
                models.push(format!("rotate_extrude(angle = {angle}, convexity = 2, {fineness}) {{ {outline} }}"));
            }
        }
    }
    compare(&models);
}

#[test]
fn hulls_and_projections() {
    let models = [
        "hull() { cube(size = [1, 2, 3], center = false); multmatrix([[1, 0, 0, 4], [0, 1, 0, 0], [0, 0, 1, 5], [0, 0, 0, 1]]) { sphere($fn = 8, r = 1); } }",
        "linear_extrude(height = 2) { hull() { circle($fn = 8, r = 1); multmatrix([[1, 0, 0, 4], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) { square(size = [2, 3], center = true); } } }",
        "linear_extrude(height = 2) { projection(cut = true, convexity = 0) { sphere($fn = 8, r = 3); } }",
        "linear_extrude(height = 2) { projection(cut = true, convexity = 0) { difference() { cube(size = [9, 9, 9], center = true); sphere($fn = 9, r = 3); } } }",
        "linear_extrude(height = 2) { projection(cut = true, convexity = 0) { cube(size = [1, 2, 3], center = false); } }",
        "linear_extrude(height = 2) { projection(cut = false, convexity = 0) { multmatrix([[1, 0, 0, 0], [0, 0.8, -0.6, 0], [0, 0.6, 0.8, 0], [0, 0, 0, 1]]) { cube(size = [1, 2, 3], center = false); } } }",
    ];
    compare(&models.map(str::to_owned));
}
