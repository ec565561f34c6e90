//! fill, convert and info: what goes in, what comes out, what is said.

use crate::support::{Folder, PBM, SCENE, feed, have, ran};

#[test]
fn the_format_follows_the_name_or_the_option() {
    let folder = Folder::new();
    folder.run("fill scene.json -o out.PBM").done();
    assert_eq!(folder.get("out.PBM"), PBM);
    folder.run("fill scene.json -o out.png --format pbm").done();
    assert_eq!(folder.get("out.png"), PBM);
    for out in ["", "-o plain", "-o .pbm"] {
        let ran = folder.run(&format!("fill scene.json {out}"));
        let name = out.strip_prefix("-o ");
        let bytes = name.map_or_else(|| ran.done().to_vec(), |name| folder.get(name));
        assert!(bytes.starts_with(b"{\"runset\":1,\"width\":16,\"height\":10,"), "{out}");
    }
}

#[test]
fn an_expression_replaces_the_scenes_own() {
    let folder = Folder::new();
    let mut command = folder.runset("fill - --format pbm --lines 1..2 --expr");
    command.arg("a & b");
    assert_eq!(feed(command, SCENE.as_bytes()).done(), b"P4\n16 1\n\x07\x80");
    // Twice as large: columns 10 to 17 of 32.
    let mut command = folder.runset("fill scene.json --format pbm --lines 2..3 --scale 2 --expr");
    command.arg("a & b");
    assert_eq!(ran(command.output().unwrap()).done(), b"P4\n32 1\n\x00\x3f\xc0\x00");
}

#[test]
fn sizes_of_the_page() {
    let folder = Folder::new();
    for (options, size) in [
        ("", "16 10"),
        ("--scale 0.5", "8 5"),
        ("--dpi 192", "32 20"),
        ("--width 64", "64 40"),
        ("--height 64", "102 64"),
        ("--width 64 --height 64", "64 64"),
    ] {
        let out = folder.run(&format!("fill scene.json --format pbm {options}")).done().to_vec();
        assert!(out.starts_with(format!("P4\n{size}\n").as_bytes()), "{options}");
    }
}

#[test]
fn what_is_wrong_with_the_input_is_status_1_with_its_place() {
    let folder = Folder::new();
    let starts = |args: &str, start: &str| {
        let ran = folder.run(args);
        assert_eq!((ran.status, ran.stderr.lines().count()), (Some(1), 1), "{args}: {}", ran.stderr);
        assert!(ran.stderr.starts_with(start), "{args}: {}", ran.stderr);
        assert!(ran.stdout.is_empty());
    };
    folder.put("bad.json", SCENE.replace("\"rings\": [[[5", "\"rinks\": [[[5"));
    folder.put("huge.json", SCENE.replace("16", "1048577"));
    folder.put("name\n.json", "{");
    starts("fill bad.json", "bad.json:2:");
    starts("fill scene.json --expr a-c", "--expr:1:3: unknown name \"c\"");
    starts("fill scene.json --expr a--b", "--expr:1:3: ");
    starts("fill huge.json", "huge.json: the page would be 1048577 x 10 px");
    starts("info bad.json", "bad.json:2:");
    starts(
        "convert scene.json",
        "scene.json:1:3: not a line stream, whose header's first key is \"runset\"; a scene is drawn by runset fill",
    );
    folder.put("art.svg", "<svg/>");
    starts("convert art.svg", "art.svg: not a line stream; an SVG is drawn by runset fill");
    folder.put("pretty.json", "{\n  \"width\": 9 }");
    starts("convert pretty.json", "pretty.json:1:2: not a line stream");
    folder.run("fill scene.json -o page.rls").done();
    starts("fill page.rls", "page.rls: this is a line stream, not a drawing: read it with runset convert");
    folder.run("fill missing.json").refused(1, "missing.json: cannot read: No such file or directory");
    folder.run("fill .").refused(1, ".: this is a folder; name a file");
    let mut command = folder.command(crate::support::RUNSET);
    let ran = ran(command.args(["fill", "name\n.json"]).output().unwrap());
    assert_eq!((ran.status, ran.stderr.lines().count()), (Some(1), 1), "{}", ran.stderr);
}

#[test]
fn a_large_input_is_refused_without_being_read() {
    let folder = Folder::new();
    let file = std::fs::File::create(folder.path("large.json")).unwrap();
    file.set_len(1 << 40).unwrap();
    let line = |name: &str, limit: &str| format!("{name}: larger than {limit} bytes; raise the limit with --max-input");
    folder.run("fill large.json").refused(1, &line("large.json", "128M"));
    folder.run("info large.json --max-input 3k").refused(1, &line("large.json", "3k"));
    // A pipe that never ends.
    let ran = ran(folder.shell("yes | $R fill - --max-input 100000").output().unwrap());
    ran.refused(1, &line("<stdin>", "100000"));
    assert_eq!(folder.run(&format!("fill scene.json --format pbm --max-input {}", SCENE.len())).done(), PBM);
    folder.run(&format!("fill scene.json --max-input {}", SCENE.len() - 1)).refused(1, &line("scene.json", &(SCENE.len() - 1).to_string()));
}

#[test]
fn warnings_are_lines_and_with_strict_an_error() {
    let folder = Folder::new();
    let ran = folder.run("fill scene.json --format pbm --expr atleast(3,a,b) --stats");
    let lines: Vec<_> = ran.stderr.lines().collect();
    assert_eq!((ran.status, lines.len()), (Some(0), 2), "{}", ran.stderr);
    assert!(lines[0].starts_with("--expr:1:1: warning: ") || lines[0].starts_with("--expr: warning: "), "{}", ran.stderr);
    assert!(serde_json::from_str::<serde_json::Value>(lines[1]).unwrap().is_object());
    assert_eq!(ran.stdout.len(), PBM.len());

    folder.put("out.pbm", "old");
    let ran = folder.run("fill scene.json -o out.pbm --expr atleast(3,a,b) --strict --stats");
    assert_eq!((ran.status, ran.stderr.lines().count()), (Some(1), 1), "{}", ran.stderr);
    assert!(ran.stderr.ends_with(" (refused by --strict)\n"), "{}", ran.stderr);
    assert_eq!(folder.get("out.pbm"), b"old");

    // A refused input prints its one line alone.
    let ran = folder.run("fill scene.json --expr atleast(3,a,b)-c");
    assert_eq!((ran.status, ran.stderr.lines().count()), (Some(1), 1), "{}", ran.stderr);
}

#[test]
fn stats_are_the_last_line_and_one_object() {
    let folder = Folder::new();
    let ran = folder.run("fill scene.json --format pbm --stats --progress always --threads 2");
    assert_eq!((ran.status, ran.stdout.as_slice()), (Some(0), PBM));
    let last = ran.stderr.lines().last().unwrap();
    let stats: serde_json::Map<String, serde_json::Value> = serde_json::from_str(last).unwrap();
    let mut keys = [
        "width",
        "height",
        "edges",
        "lines",
        "lines_counted",
        "lines_unordered",
        "lines_repeated",
        "toggles",
        "toggles_known",
        "runs",
        "peak_active",
        "prepare_seconds",
        "seconds",
        "first_line_seconds",
        "threads",
    ];
    keys.sort_unstable();
    let mut found: Vec<_> = stats.keys().map(String::as_str).collect();
    found.sort_unstable();
    assert_eq!(found, keys);
    // Eight lines of one run; two squares of four edges.
    for (key, value) in [("width", 16), ("height", 10), ("lines", 10), ("runs", 8), ("edges", 8), ("threads", 2)] {
        assert_eq!(stats[key], value, "{key}");
    }
}

#[test]
fn progress_is_for_terminals_unless_asked_for() {
    let folder = Folder::new();
    folder.run("fill scene.json -o out.pbm").done();
    folder.run("fill scene.json -o out.pbm --progress never").done();
    let ran = folder.run("fill scene.json -o out.pbm --progress always");
    assert_eq!((ran.status, ran.stderr.as_str()), (Some(0), "10 of 10 lines (100 %)\n"));
    if have("script", "progress on a terminal") {
        let mut command = folder.command("script");
        command.args(["-qec", &format!("{} fill scene.json -o out.pbm", crate::support::RUNSET), "/dev/null"]).env("TERM", "xterm");
        let ran = crate::support::ran(command.output().unwrap());
        assert!(String::from_utf8_lossy(&ran.stdout).contains("10 of 10 lines"), "{:?}", ran.stdout);
    }
    assert_eq!(folder.get("out.pbm"), PBM);
}

#[test]
fn fonts_are_read_and_refused_by_name() {
    let folder = Folder::new();
    assert_eq!(folder.run("fill scene.json --format pbm --system-fonts").done(), PBM);
    folder.put("a.ttf", "not a font");
    for (font, line) in [
        ("a.ttf", "a.ttf: no font that can be read: give a TrueType or OpenType file\n"),
        ("b.ttf", "b.ttf: cannot read: no such file or directory\n"),
    ] {
        let ran = folder.run(&format!("fill scene.json --format pbm --font {font}"));
        assert_eq!((ran.status, ran.stdout.as_slice(), ran.stderr.to_lowercase()), (Some(1), &b""[..], line.to_lowercase()));
    }
}

#[test]
fn a_line_stream_becomes_any_format() {
    let folder = Folder::new();
    for format in ["ndjson", "rls"] {
        folder.run(&format!("fill scene.json -o lines.{format}")).done();
        assert_eq!(folder.run(&format!("convert lines.{format} --format pbm")).done(), PBM);
        let stream = folder.get(&format!("lines.{format}"));
        folder.put("out.pbm", "old");
        let cut = feed(folder.runset("convert - -o out.pbm"), &stream[..stream.len() - 3]);
        assert_eq!((cut.status, cut.stderr.lines().count()), (Some(1), 1), "{}", cut.stderr);
        assert!(cut.stderr.starts_with("<stdin>"), "{}", cut.stderr);
        assert_eq!(folder.get("out.pbm"), b"old");
    }
}

#[test]
fn info_is_a_table_or_an_object() {
    let folder = Folder::new();
    let table = "16.00 x 10.00 user units (4.23 x 2.65 mm)\n\n\
                 id  kind   left   top  right  bottom           mm  edges  ink\n\
                 a   shape  1.00  1.00   9.00    9.00  2.12 x 2.12      4  -\n\
                 b   shape  5.00  1.00  13.00    9.00  2.12 x 2.12      4  -\n";
    assert_eq!(String::from_utf8_lossy(folder.run("info scene.json").done()), table);
    let ran = feed(folder.runset("info - --json"), SCENE.as_bytes());
    let object: serde_json::Value = serde_json::from_slice(ran.done()).unwrap();
    let entry = |id: &str, bounds: [f64; 4]| {
        let mm = bounds.map(|x| x * (25.4 / 96.0));
        serde_json::json!({"id": id, "kind": "shape", "depth": 0, "bounds": bounds, "bounds_mm": mm, "edges": 4, "ink": null})
    };
    let ids = [entry("a", [1.0, 1.0, 9.0, 9.0]), entry("b", [5.0, 1.0, 13.0, 9.0])];
    assert_eq!(object, serde_json::json!({"width": 16.0, "height": 10.0, "ids": ids}));
}

#[test]
fn info_shows_the_tree_of_a_model() {
    let folder = Folder::new();
    folder.put("part.csg", "difference() {\n\tcolor([1, 0, 0, 1]) {\n\t\tcube(size = [4, 2, 1], center = true);\n\t}\n\tcylinder($fn = 8, h = 9, r1 = 1, r2 = 1);\n}\n");
    let table = "2 primitives, 16 faces from -2.00 -1.00 -0.50 to 2.00 1.00 0.50\n\n\
                 statement   line  faces      x      y      z                size  color\n\
                 difference     1      -      -      -      -                   -  -\n  \
                   color        2      -      -      -      -                   -  -\n    \
                     cube       3      6  -2.00  -1.00  -0.50  4.00 x 2.00 x 1.00  #ff0000\n  \
                   cylinder     5     10  -1.00  -1.00   0.00  2.00 x 2.00 x 9.00  -\n";
    assert_eq!(String::from_utf8_lossy(folder.run("info part.csg").done()), table);
    let object: serde_json::Value = serde_json::from_slice(folder.run("info part.csg --json").done()).unwrap();
    assert_eq!(
        (&object["primitives"], &object["faces"], &object["bounds"]),
        (&2.into(), &16.into(), &serde_json::json!([[-2.0, -1.0, -0.5], [2.0, 1.0, 0.5]]))
    );
    let cube = serde_json::json!({"kind": "cube", "line": 3, "column": 3, "depth": 2, "primitive": 1, "faces": 6,
        "bounds": [[-2.0, -1.0, -0.5], [2.0, 1.0, 0.5]], "color": "#ff0000"});
    assert_eq!(object["tree"][2], cube);
    folder.put("bad.csg", "union() {\n  cube(1;\n}\n");
    folder.run("info bad.csg").refused(1, "bad.csg:2:9: unexpected ;; expected , or )");
    folder.put("text.csg", "cube(1);\ntext(text = \"a\");\n");
    let ran = folder.run("info text.csg");
    assert_eq!(
        (ran.status, ran.stderr.as_str()),
        (Some(0), "text.csg:2:1: warning: text is not supported: it and what it holds are left out, as if empty\n")
    );
}

#[test]
fn openscad_evaluates_programs() {
    let folder = Folder::new();
    folder.put("a.scad", "for (i = [0 : 2]) translate([2 * i, 0, 0]) cube(1);");
    let mut without = folder.runset("info a.scad");
    without.env("PATH", folder.path("."));
    ran(without.output().unwrap())
        .refused(1, "a.scad: a .scad needs openscad, which is not on the PATH: install it, or give a .csg (openscad -o model.csg)");
    if have("openscad", "programs") {
        let object: serde_json::Value = serde_json::from_slice(folder.run("info a.scad --json").done()).unwrap();
        assert_eq!(object["bounds"], serde_json::json!([[0.0, 0.0, 0.0], [5.0, 1.0, 1.0]]));
        folder.put("b.scad", "cube(1);\nassert(false);\n");
        folder.run("info b.scad").refused(1, "b.scad: openscad: Assertion 'false' failed in file b.scad, line 2");
        folder.put("c.scad", "cube(1;\n");
        folder.run("info c.scad").refused(1, "c.scad: openscad: Parser error: syntax error in file c.scad, line 1");
    }
}
