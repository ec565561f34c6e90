//! OpenSCAD's `.csg` and STL: every construct, what counts and what is left out, errors with their place, and input that means harm.

#![allow(clippy::unwrap_used)] // all of this is tests

mod clock;

use std::time::Duration;

use runset::error::{Result, Warning};
use runset::input::{ModelOptions, Reading, read_tree};
use runset::mesh::check::{Placed, all_placed};
use runset::mesh::{Model, Point};
use runset::scene::{Area, Gate, Limits};

fn read_with(text: &[u8], options: &ModelOptions) -> (Result<Reading>, Vec<Warning>) {
    let mut warnings = Vec::new();
    (read_tree(text, options, &mut warnings), warnings)
}

fn lines(warnings: &[Warning]) -> Vec<String> {
    let line = |w: &Warning| format!("{}: {}", w.place.map_or_else(String::new, |p| format!("{}:{}", p.line, p.column)), w.what);
    warnings.iter().map(line).collect()
}

/// Reads without a warning.
fn read(text: &str) -> Model {
    let (reading, warnings) = read_with(text.as_bytes(), &ModelOptions::default());
    assert!(warnings.is_empty(), "{text}: {:?}", lines(&warnings));
    reading.unwrap_or_else(|e| panic!("{text}: {e}")).model
}

/// The warnings, as `line:column: what`.
fn warned(text: &str) -> (Model, Vec<String>) {
    let (reading, warnings) = read_with(text.as_bytes(), &ModelOptions::default());
    (reading.unwrap_or_else(|e| panic!("{text}: {e}")).model, lines(&warnings))
}

fn placed(model: &Model) -> Vec<Placed> {
    let mut warnings = Vec::new();
    let placed = all_placed(model, &mut warnings);
    assert!(warnings.is_empty(), "{:?}", lines(&warnings));
    placed
}

/// How often a surface runs around a point, by the solid angles of its faces (van Oosterom and Strackee): faces are cut into fans.
fn inside(placed: &Placed, point: Point) -> bool {
    let minus = |p: Point| [0, 1, 2].map(|i| p[i] - point[i]);
    let dot = |a: Point, b: Point| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross = |a: Point, b: Point| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let mut sum = 0.0;
    for ring in placed.mesh.faces.iter().flat_map(|f| &f.rings) {
        for i in 1..ring.len() - 1 {
            let [a, b, c] = [ring[0], ring[i], ring[i + 1]].map(|i| minus(placed.mesh.points[i as usize]));
            let [x, y, z] = [a, b, c].map(|v| dot(v, v).sqrt());
            sum += f64::atan2(dot(a, cross(b, c)), x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y);
        }
    }
    (sum / (2.0 * std::f64::consts::PI)).round() >= 1.0
}

/// Whether the model fills a point.
fn fills(model: &Model, placed: &[Placed], point: Point) -> bool {
    holds(model, model.area, &placed.iter().map(|p| inside(p, point)).collect::<Vec<_>>())
}

fn holds(model: &Model, area: Area, parts: &[bool]) -> bool {
    match &model.formula.gates()[area.index()] {
        Gate::Shape(i) => parts[*i as usize],
        Gate::AtLeast(k, inputs) => inputs.iter().filter(|i| holds(model, i.area, parts)).map(|i| i.weight).sum::<i32>() >= *k,
        Gate::Odd(inputs) => inputs.iter().filter(|i| holds(model, i.area, parts)).count() % 2 == 1,
    }
}

/// The places 0.5, 1.5, … of the x axis (y and z are 0.4) that the model fills, as a picture.
fn row(text: &str) -> String {
    let model = read(text);
    picture(&model)
}

fn picture(model: &Model) -> String {
    let placed = placed(model);
    (0..10).map(|x| if fills(model, &placed, [f64::from(x) + 0.5, 0.4, 0.4]) { '#' } else { '.' }).collect()
}

fn at(x: i32, what: &str) -> String {
    format!("multmatrix([[1, 0, 0, {x}], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) {{ {what} }}")
}

/// A bar from one place of the axis to another.
fn bar(from: i32, to: i32) -> String {
    at(from, &format!("cube(size = [{}, 1, 1], center = false);", to - from))
}

#[test]
fn operators_are_openscads() {
    let [a, b, c] = [bar(0, 5), bar(3, 8), bar(4, 6)];
    for (text, expected) in [
        (format!("{a} {c}"), "######...."),
        (format!("union() {{ {a} {b} }}"), "########.."),
        (format!("group() {{ {a} group() {{ {b} }} }}"), "########.."),
        (format!("render(convexity = 2) {{ {a} }}"), "#####....."),
        (format!("difference() {{ {a} {b} }}"), "###......."),
        (format!("difference() {{ {b} {a} {c} }}"), "......##.."),
        (format!("difference() {{ difference() {{ {b} {a} }} {c} }}"), "......##.."),
        (format!("difference() {{ {b} difference() {{ {a} {c} }} }}"), "....####.."),
        (format!("intersection() {{ {a} {b} }}"), "...##....."),
        (format!("intersection() {{ {a} {b} {c} }}"), "....#....."),
        (format!("intersection() {{ union() {{ {a} {b} }} {c} }}"), "....##...."),
        (format!("difference() {{ union() {{ {a} {b} }} union() {{ {c} }} }}"), "####..##.."),
        (String::new() + ";;", ".........."),
    ] {
        assert_eq!(row(&text), expected, "{text}");
    }
}

#[test]
fn empty_operands_count_as_in_openscad() {
    // What OpenSCAD 2021.01 exports of these.
    let [a, b] = [bar(0, 5), bar(3, 8)];
    for (text, expected) in [
        (format!("difference() {{ group(); {a} }}"), ".........."),
        (format!("difference() {{ group() {{ group(); }} {a} }}"), ".........."),
        (format!("difference() {{ cube(size = [0, 1, 1]); {a} }} {b}"), "...#####.."),
        (format!("difference() {{ {a} group(); }}"), "#####....."),
        (format!("difference() {{ difference() {{ {a} {a} }} {b} }}"), ".........."),
        (format!("intersection() {{ {a} group(); }}"), ".........."),
        (format!("intersection() {{ {a} cube(size = [0, 0, 0]); }}"), ".........."),
        (format!("union() {{ group(); {a} }}"), "#####....."),
        (format!("difference() {{ %{a} {b} }}"), "...#####.."),
        (format!("difference() {{ *{a} {b} }}"), "...#####.."),
        (format!("difference() {{ {a} %{b} }}"), "#####....."),
        (format!("difference() {{ #{b} {a} }}"), ".....###.."),
        (format!("{a} multmatrix([[1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) {{ !{} }}", bar(8, 9)), "........#."),
        (format!("intersection() {{ {a} linear_extrude(height = 1) {{ square(size = 0); }} }}"), ".........."),
    ] {
        assert_eq!(row(&text), expected, "{text}");
    }
}

#[test]
fn matrices_and_colours() {
    let model = read(
        "color([1, 0.5, 0, 0.3]) { color(\"blue\") { cube(); } } color(\"RebeccaPurple\") sphere(r = 2); cube(2); color([-1, -1, -1, 1]) { cube(3); }",
    );
    let colors: Vec<_> = model.parts.iter().map(|p| p.color).collect();
    assert_eq!(colors, [Some([255, 128, 0]), Some([0x66, 0x33, 0x99]), None, None], "the outermost colour counts");
    let nested = read(
        "multmatrix([[0, -1, 0, 5], [1, 0, 0, 0], [0, 0, 1, 0]]) { multmatrix([[1, 0, 0, 1], [0, 2, 0, 0], [0, 0, 3, 0], [0, 0, 0, 1]]) { cube(); } }",
    );
    assert_eq!(nested.parts[0].matrix, [[0.0, -2.0, 0.0, 5.0], [1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 3.0, 0.0]]);
    let shared = read("cube(1); cube(1); sphere(1);");
    assert!(std::sync::Arc::ptr_eq(&shared.parts[0].mesh, &shared.parts[1].mesh), "equal primitives share their mesh");
    let kinds: Vec<_> = shared.parts.iter().map(|p| (p.kind, p.place.unwrap().column)).collect();
    assert_eq!(kinds, [("cube", 1), ("cube", 10), ("sphere", 19)]);
}

#[test]
fn outlines_are_combined_before_they_are_extruded() {
    let extrude = |outline: &str| {
        format!("linear_extrude(height = 1, center = false, convexity = 1, scale = [1, 1], $fn = 0, $fa = 12, $fs = 2) {{ {outline} }}")
    };
    let square = |from: i32, to: i32| at(from, &format!("square(size = [{}, 1], center = false);", to - from));
    let [a, b] = [square(0, 5), square(3, 8)];
    for (outline, expected) in [
        (format!("{a} {b}"), "########.."),
        (format!("difference() {{ {a} {b} }}"), "###......."),
        (format!("intersection() {{ {a} {b} }}"), "...##....."),
        (format!("difference() {{ group(); {b} }}"), ".........."),
        ("polygon(points = [[0, 0], [8, 0], [8, 1], [0, 1], [2, 0.1], [4, 0.1], [4, 0.9], [2, 0.9]], paths = [[0, 1, 2, 3], [4, 5, 6, 7]], convexity = 1);".to_owned(), "##..####.."),
        ("polygon(points = [[0, 0], [3, 0], [3, 1], [0, 1]], paths = undef, convexity = 1);".to_owned(), "###......."),
        (format!("hull() {{ {} {} }}", square(0, 1), square(6, 7)), "#######..."),
        (format!("projection(cut = true) {{ {} }}", bar(2, 4)), "..##......"),
        (format!("projection(cut = false) {{ {} {} }}", bar(2, 4), bar(3, 7)), "..#####..."),
        (format!("projection(cut = true) {{ difference() {{ {} {} }} }}", bar(2, 7), bar(3, 5)), "..#..##..."),
    ] {
        assert_eq!(row(&extrude(&outline)), expected, "{outline}");
    }
    assert_eq!(row(&format!("hull() {{ {} {} }}", bar(0, 1), bar(6, 7))), "#######...");
    assert_eq!(
        row(
            "rotate_extrude(angle = 360, convexity = 2, $fn = 40) { multmatrix([[1, 0, 0, 3], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) { square(size = [2, 1], center = false); } }"
        ),
        "...##....."
    );
    assert_eq!(row("rotate_extrude(angle = 90, $fn = 40) { square(size = [4, 1], center = false); }"), "####......");
}

#[test]
fn arguments_may_stand_without_their_names() {
    for (text, expected) in [
        ("cube(3);", "###......."),
        ("cube([4, 1, 1], false);", "####......"),
        ("cube(size = 4, center = true);", "##........"),
        ("cylinder(1, 3, 3);", "###......."),
        ("cylinder(h = 1, d = 4, $fn = 60);", "##........"),
        ("sphere(d = 6, $fn = 60);", "###......."),
        ("cube(/* a comment */ 3); // and another", "###......."),
        ("union() cube(3);", "###......."),
        ("union() { cube(size = 3,); };", "###......."),
        ("\u{feff}cube(3.0e0);", "###......."),
    ] {
        assert_eq!(row(text), expected, "{text}");
    }
}

#[test]
fn what_is_left_out_is_named() {
    let stays = "..###.....";
    let bar = bar(2, 5);
    for (text, what) in [
        (
            "\n minkowski(convexity = 0) { cube(); sphere(); }",
            "2:2: minkowski is not supported: it and what it holds are left out, as if empty",
        ),
        ("text(text = \"a\\\"b\", size = 10);", "1:1: text is not supported: it and what it holds are left out, as if empty"),
        ("surface(file = \"x\");", "1:1: surface is not supported: it and what it holds are left out, as if empty"),
        ("resize(newsize = [1,2,3]) { cube(); }", "1:1: resize is not supported: it and what it holds are left out, as if empty"),
        ("cube(sise = 9, size = 0);", "1:6: \"sise\" is no parameter here: it is ignored"),
        ("union() { cube(size = 0); square(); }", "1:1: outlines among solids: the outlines are ignored; extrude them"),
        ("linear_extrude(height = 0) { square(); cube(); }", "1:1: solids among outlines: the solids are ignored"),
        (
            "multmatrix([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1]]) cube();",
            "1:70: the matrices around this cube make it flat: it is left out, as if empty",
        ),
        (
            "rotate_extrude() { square(size = 2, center = true); }",
            "1:1: the outline reaches from x = -1 to x = 1, across the axis: it is left out, as if empty",
        ),
        ("color(\"blau\") { cube(0); }", "1:1: the colour \"blau\" is unknown: it is ignored"),
        (
            "import(file = \"a.stl\", timestamp = 0);",
            "1:1: import of \"a.stl\": files beside the model are not read here; it is left out, as if empty",
        ),
        (
            "hull() { difference() { cube(); sphere(); } }",
            "1:10: a difference or intersection of solids within hull is not supported: it is left out, as if empty",
        ),
    ] {
        let (model, warnings) = warned(&format!("{text} {bar}"));
        assert_eq!(warnings, [what], "{text}");
        assert_eq!(picture(&model), stays, "{text}");
    }
    let (_, warnings) = warned("square(3);");
    assert_eq!(warnings, [": the model is flat: nothing solid is in it; extrude it"]);
    let (model, warnings) = warned("!cube(1); !cube(9);");
    assert_eq!((model.parts.len(), &warnings[..]), (1, &["1:12: a second ! is ignored: only the first counts".to_owned()][..]));
}

#[test]
fn errors_say_where() {
    for (text, error) in [
        ("cube(", "1:6: the document ends here; expected a number, a list, a text, true, false or undef"),
        ("cube(1)", "1:8: the document ends here; expected ; or {"),
        ("union() {\n  cube(1);\n", "1:9: this { is never closed: add a }"),
        ("cube(1);\n}", "2:1: this } closes nothing"),
        ("cube(size = [1, 2, 3);", "1:21: unexpected ); expected , or ]"),
        ("cube(size = [1, 2 3]);", "1:19: unexpected 3; expected , or ]"),
        ("cube(1));", "1:8: unexpected ); expected a statement, as in cube(size = 1);"),
        ("cube 1;", "1:6: unexpected 1; expected ( after cube"),
        ("qube(1);", "1:1: unknown module \"qube\"; did you mean cube?"),
        ("\n\n  frobnicate();", "3:3: unknown module \"frobnicate\""),
        ("translate([1, 2, 3]) cube();", "1:1: translate belongs to OpenSCAD programs, a .csg has none: run openscad -o model.csg"),
        ("module a() { cube(); }", "1:1: this is an OpenSCAD program, not a .csg: run openscad -o model.csg"),
        ("$fn = 3;", "1:1: variables are OpenSCAD's, a .csg has none: run openscad -o model.csg"),
        ("cube(x);", "1:6: the variable \"x\" has no value: a .csg has none"),
        ("cube([1:3]);", "1:8: ranges belong to OpenSCAD programs, a .csg has none: run openscad -o model.csg"),
        ("cube(1.2.3);", "1:6: this is not a number"),
        ("cube(\"a", "1:6: this quote is never closed: add a \" after the text"),
        ("cube(1); /* a", "1:10: this comment is never closed: add */"),
        ("cube(nan);", "1:6: size must be a finite number or a list of 3 of them"),
        ("cube(size = [1, inf, 2]);", "1:13: size must be a finite number or a list of 3 of them"),
        ("sphere(r = 1e999);", "1:12: r must be a finite number"),
        ("cube(center = 1);", "1:15: center must be true or false"),
        (
            "multmatrix([[1, 0, 0, 0], [0, nan, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) { cube(); }",
            "1:31: the matrix must be of finite numbers",
        ),
        (
            "multmatrix([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 1]]) { cube(); }",
            "1:55: the last row of the matrix must be [0, 0, 0, 1]: there is no perspective in a model",
        ),
        ("multmatrix(3) { cube(); }", "1:12: the matrix must be a list of four rows"),
        ("multmatrix([[1, 0, 0, 0, 0]]) { cube(); }", "1:26: the matrix must be four rows of four numbers"),
        ("color([1, 0]) { cube(); }", "1:7: the colour must be a name or a list of three or four numbers"),
        ("polyhedron(points = [[0, 0, 0]], faces = [[0, 1, 0]]);", "1:47: there is no point 1: there are 1, counted from 0"),
        ("polyhedron(points = [[0, 0, 0]], faces = [[0, -1, 0]]);", "1:47: there is no point -1: there are 1, counted from 0"),
        ("polyhedron(points = [[0, 0]], faces = []);", "1:22: a point must be 3 finite numbers"),
        ("polyhedron(points = [], faces = [1]);", "1:34: this must be a list of indices"),
        (
            "linear_extrude(height = 1) { polygon(points = [[0, 0], [1, 0]], paths = [[0, 2]]); }",
            "1:78: there is no point 2: there are 2, counted from 0",
        ),
        ("sphere($fn = 1000000000, r = 1);", "1:1: more than 100000 sides: use a smaller $fn, or larger $fa and $fs"),
        ("sphere($fn = 100000, r = 1);", "1:1: more than 4000000 faces: use a smaller $fn or a coarser mesh"),
        (
            "linear_extrude(height = 1, twist = 360, slices = 1000000000) { square(); }",
            "1:1: more than 100000 slices: use a smaller $fn, or larger $fa and $fs",
        ),
        (
            "linear_extrude(height = 1, twist = 1e300) { square(); }",
            "1:1: more than 100000 slices: use a smaller $fn, or larger $fa and $fs",
        ),
        ("cube(1e31);", "1:1: coordinates past 1e30: scale the model down"),
        ("import();", "1:1: import names no file: add file = \"…\""),
        ("cubé(1);", "1:4: unexpected character that is not ASCII; expected ( after cub"),
        ("", "the input is empty: expected an OpenSCAD .csg or an STL"),
        ("<svg/>", "this is a drawing, not a model: expected an OpenSCAD .csg or an STL"),
    ] {
        let (reading, _) = read_with(text.as_bytes(), &ModelOptions::default());
        assert_eq!(reading.err().map(|e| e.to_string()).as_deref(), Some(error), "{text}");
    }
}

#[test]
fn limits_have_names() {
    let small = |limits: Limits| ModelOptions { limits, folder: None };
    let limits = Limits::default();
    for (limits, error) in [
        (Limits { nodes: 3, ..limits }, "1:33: more than 3 statements: split the model"),
        (Limits { depth: 1, ..limits }, "1:11: statements nested more than 1 deep: flatten the model"),
        (Limits { faces: 17, ..limits }, "1:43: more than 17 faces: use a smaller $fn or a coarser mesh"),
        (Limits { input: 9, ..limits }, "the model is larger than 9 bytes: raise --max-input"),
    ] {
        let (reading, _) = read_with(b"union() { union() { cube(1); }  cube(2);  cube(3); }", &small(limits));
        assert!(reading.as_ref().err().is_some_and(|e| e.to_string() == error), "{:?}", reading.err());
    }
}

#[test]
fn imports_come_from_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let options = ModelOptions { limits: Limits::default(), folder: Some(folder.path().to_owned()) };
    let stl = "solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 9 0\nvertex 9 0 0\nendloop\nendfacet\n\
               facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 9 0 0\nvertex 0 0 9\nendloop\nendfacet\n\
               facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 9\nvertex 0 9 0\nendloop\nendfacet\n\
               facet normal 0 0 0\nouter loop\nvertex 9 0 0\nvertex 0 9 0\nvertex 0 0 9\nendloop\nendfacet\nendsolid a\n";
    std::fs::write(folder.path().join("a.stl"), stl).unwrap();
    std::fs::write(folder.path().join("bad.stl"), "solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 x\n").unwrap();
    let text =
        "intersection() { cube(4); import(file = \"a.stl\", layer = \"\", origin = [0, 0], scale = 1, convexity = 1, timestamp = 1); }";
    let (reading, warnings) = read_with(text.as_bytes(), &options);
    assert!(warnings.is_empty(), "{:?}", lines(&warnings));
    let model = reading.unwrap().model;
    assert_eq!((picture(&model).as_str(), model.parts[1].mesh.points.len()), ("####......", 4));
    for (text, error) in [
        ("import(file = \"b.stl\");", "1:1: import of \"b.stl\": No such file or directory (os error 2)"),
        ("\nimport(file = \"bad.stl\");", "2:1: import of \"bad.stl\": 4:12: expected a finite number"),
        ("import(file = \"/dev/zero.stl/../../dev/zero\");", ""),
    ] {
        let (reading, warnings) = read_with(text.as_bytes(), &options);
        match reading {
            Err(e) => assert_eq!(e.to_string(), error),
            Ok(_) => assert!(error.is_empty() && warnings.len() == 1),
        }
    }
    let (reading, _) = read_with(stl.as_bytes(), &options);
    let model = reading.unwrap().model;
    assert_eq!(picture(&model), "########..");
}

#[test]
fn stl_in_binary() {
    let triangles = [
        [[0, 0, 0], [0, 9, 0], [9, 0, 0]],
        [[0, 0, 0], [9, 0, 0], [0, 0, 9]],
        [[0, 0, 0], [0, 0, 9], [0, 9, 0]],
        [[9, 0, 0], [0, 9, 0], [0, 0, 9]],
    ];
    // It may begin with "solid" all the same.
    let mut bytes = b"solid of some program".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(4_u32.to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        bytes.extend(triangle.iter().flatten().flat_map(|x| (*x as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    let (reading, _) = read_with(&bytes, &ModelOptions::default());
    let model = reading.unwrap().model;
    assert_eq!((picture(&model).as_str(), model.parts[0].kind), ("########..", "mesh"));
    for (end, error) in [
        (0, "the input is empty: expected an OpenSCAD .csg or an STL"),
        (10, "not an STL: it is too short"),
        (100, "not an STL: no facet follows its name, and 100 bytes are not those of 4 triangles; is the file complete?"),
        (283, "not an STL: no facet follows its name, and 283 bytes are not those of 4 triangles; is the file complete?"),
    ] {
        let (reading, _) = read_with(&bytes[..end], &ModelOptions::default());
        assert_eq!(reading.unwrap_err().to_string(), error);
    }
    let nan = bytes.len() - 10;
    bytes[nan..nan + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    let (reading, _) = read_with(&bytes, &ModelOptions::default());
    assert_eq!(reading.unwrap_err().to_string(), "triangle 4 has a coordinate that is not a number or past 1e30");
}

#[test]
fn open_and_inside_out_meshes_are_told() {
    let cube =
        |faces: &str| format!("polyhedron(points = [[0,0,0],[4,0,0],[4,1,0],[0,1,0],[0,0,1],[4,0,1],[4,1,1],[0,1,1]], faces = [{faces}]);");
    let [bottom, front, top, right, back, left] = ["[0,1,2,3]", "[4,5,1,0]", "[7,6,5,4]", "[5,6,2,1]", "[6,7,3,2]", "[7,4,0,3]"];
    for (faces, wrong) in [
        (vec![bottom, front, top, right, back, left], vec![]),
        (vec![bottom, front, top, right, back], vec!["1:1: 4 open edges in this polyhedron: the surface is closed there by triangles"]),
        (
            vec!["[3,2,1,0]", "[0,1,5,4]", "[4,5,6,7]", "[1,2,6,5]", "[2,3,7,6]", "[3,0,4,7]"],
            vec!["1:1: this polyhedron is inside out: it is turned; OpenSCAD wants faces clockwise as seen from outside"],
        ),
    ] {
        let model = read(&cube(&faces.join(",")));
        let mut warnings = Vec::new();
        let placed = all_placed(&model, &mut warnings);
        assert_eq!(lines(&warnings), wrong);
        let row: String = (0..6).map(|x| if fills(&model, &placed, [f64::from(x) + 0.5, 0.4, 0.4]) { '#' } else { '.' }).collect();
        assert_eq!(row, "####..", "{faces:?}");
    }
    // Faces without area, and corners named twice.
    let model = read(&cube(&format!("{bottom},{front},{top},{right},{back},{left},[0,0,1],[0,1,0],[2,2,2],[]")));
    assert_eq!(placed(&model)[0].mesh.faces.len(), 6);
}

/// Within so much processor time.
fn within(seconds: f64, name: &str, text: &[u8], check: impl Fn(Result<Reading>)) {
    let began = clock::cpu();
    let (reading, _) = read_with(text, &ModelOptions::default());
    let spent = clock::cpu() - began;
    check(reading);
    assert!(spent < Duration::from_secs_f64(seconds), "{name}: {spent:?}");
}

#[test]
fn hostile_input_is_bounded() {
    const DEEP: usize = 1_000_000;
    let refused = |what: &'static str| {
        move |reading: Result<Reading>| assert!(reading.as_ref().err().is_some_and(|e| e.what.contains(what)), "{:?}", reading.err())
    };
    let read = |reading: Result<Reading>| drop(reading.unwrap());
    within(5.0, "deep", "union(){".repeat(DEEP).as_bytes(), refused("deep"));
    within(5.0, "deep without braces", ("union()".repeat(DEEP) + "cube();").as_bytes(), refused("deep"));
    within(5.0, "deep lists", ("cube(".to_owned() + &"[".repeat(DEEP)).as_bytes(), refused("expected"));
    within(
        5.0,
        "deep lists, closed",
        ("cube(".to_owned() + &"[".repeat(DEEP) + &"]".repeat(DEEP) + ");").as_bytes(),
        refused("size must be"),
    );
    within(5.0, "closing", "}".repeat(DEEP).as_bytes(), refused("closes nothing"));
    let nested = |open: &str, inner: &str, n: usize| (open.repeat(n) + inner + &"}".repeat(n)).into_bytes();
    let alternating = "difference(){cube(9);union(){cube(1);".repeat(40_000) + "cube(3);" + &"}".repeat(80_000);
    within(5.0, "alternating", alternating.as_bytes(), read);
    within(5.0, "differences", &nested("difference(){cube(9);", "cube(3);", 90_000), read);
    within(5.0, "many", "cube();".repeat(300_000).as_bytes(), read);
    within(5.0, "comments", "/**/ //\n".repeat(DEEP).as_bytes(), read);
    let mut garbage = vec![0_u8; 100_000_000];
    let mut state = 1_u64;
    garbage.iter_mut().for_each(|b| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        *b = (state >> 56) as u8;
    });
    within(10.0, "garbage", &garbage, |reading| assert!(reading.is_err()));
    let spaces = [b"cube(".to_vec(), vec![b' '; 100_000_000]].concat();
    within(10.0, "spaces", &spaces, refused("ends here"));
    let outlines = "linear_extrude(height=1){".to_owned()
        + &"difference(){circle(r=9,$fn=20000);circle(r=8,$fn=20000);".repeat(3000)
        + &"}".repeat(3001);
    within(30.0, "outlines", outlines.as_bytes(), refused("booleans of outlines"));
}

#[test]
fn the_tree_is_told() {
    let (reading, _) =
        read_with(b"difference() {\n\tcube(1);\n\t%sphere(1);\n\tlinear_extrude(height = 1) { circle(1); }\n}\n", &ModelOptions::default());
    let reading = reading.unwrap();
    let tree: Vec<_> = reading.tree.iter().map(|l| (l.kind, l.place.unwrap().line, l.depth, l.part)).collect();
    assert_eq!(tree, [("difference", 1, 0, None), ("cube", 2, 1, Some(0)), ("linear_extrude", 4, 1, Some(1)), ("circle", 4, 2, None)]);
    assert_eq!(reading.model.parts.len(), 2);
}
