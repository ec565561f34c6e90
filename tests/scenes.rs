//! JSON scenes: what they become, and the line that refuses what they must not be.

mod clock;

use runset::error::{Error, Kind, Origin, Place, Warning};
use runset::scene::{Area, Gate, Limits, Picture, Scene};
use runset::shape::{FillRule, Transform, Verb};

fn read(text: impl AsRef<[u8]>) -> Result<(Scene, Vec<Warning>), Error> {
    let mut warnings = Vec::new();
    runset::input::read(text.as_ref().to_vec(), &Limits::default(), &mut warnings).map(|scene| (scene, warnings))
}

/// A scene with these shapes and this rest.
fn with(shapes: &str, rest: &str) -> String {
    format!(r##"{{"width":10,"height":10,"shapes":{{{shapes}}},{rest}}}"##)
}

const TRIANGLE: &str = r#""rings":[[[0,0],[4,0],[0,4]]]"#;

fn gate(scene: &Scene, area: Area) -> &Gate {
    &scene.formula.gates()[area.index()]
}

#[test]
fn everything_that_a_scene_can_say() {
    let text = r##" {
      "height": 2e1, "layers": [ {"ink": "#E4007f", "expr": "a & \"b \\\"é\\\"\""}, {"expr": "page", "ink": "#000000"} ],
      "shapes": {
        "a": { "rings": [[[0, 0], [4.5, 0], [0, -4e0]], [], [[1, 1]], [[1, 1], [2, 2]], [[5, 5], [6, 5], [6, 6], [5, 6]]], "rule": "evenodd" },
        "b \"é\"": { "transform": [1, 2, 3, 4, 5, 6], "path": "M 0 0 L 1 0 1 1 Z" },
        "c": { "path": "", "rule": "nonzero", "transform": [1, 0, 0, 0, 1, 0, 0.001, 0, 1] } },
      "width": 30 }
    "##;
    let (scene, warnings) = read(text).unwrap();
    assert_eq!((scene.width, scene.height, warnings.len()), (30.0, 20.0, 0));
    let ids: Vec<_> = scene.names().iter().map(|n| (n.id.as_str(), n.kind, n.depth, n.shapes.clone())).collect();
    assert_eq!(ids, [("a", "shape", 0, 0..1), ("b \"é\"", "shape", 0, 1..2), ("c", "shape", 0, 2..3)]);

    let a = &scene.shapes[0];
    assert_eq!((a.name.as_str(), a.rule, a.transform), ("a", FillRule::EvenOdd, Transform::IDENTITY));
    let (m, l, z) = (Verb::Move, Verb::Line, Verb::Close);
    assert_eq!(a.path.verbs(), [m, l, l, z, m, l, l, l, z]);
    assert_eq!(a.path.points(), [[0., 0.], [4.5, 0.], [0., -4.], [5., 5.], [6., 5.], [6., 6.], [5., 6.]]);
    assert_eq!(scene.shapes[1].transform, Transform::Affine([1., 2., 3., 4., 5., 6.]));
    assert_eq!(scene.shapes[1].path.verbs(), [m, l, l, z]);
    assert_eq!(scene.shapes[2].transform, Transform::Projective([1., 0., 0., 0., 1., 0., 0.001, 0., 1.]));
    assert_eq!(scene.shapes[2].path.verbs(), []);

    let Picture::Layers(layers) = &scene.picture else { panic!("layers") };
    assert_eq!(layers.iter().map(|l| l.ink).collect::<Vec<_>>(), [[0xe4, 0, 0x7f], [0, 0, 0]]);
    assert!(matches!(gate(&scene, layers[0].area), Gate::AtLeast(2, i) if i.len() == 2));
    assert_eq!(*gate(&scene, layers[1].area), Gate::AtLeast(0, vec![]));
    assert!(matches!(gate(&scene, scene.art), Gate::AtLeast(1, i) if i.len() == 3));
}

#[test]
fn coordinates_are_the_nearest_doubles() {
    let numbers =
        ["0.1", "123456789.123456789", "2.2250738585072014e-308", "9007199254740993", "-5e-324", "8.5e22", "1e308", "18446744073709551616"];
    for x in numbers {
        let (scene, _) = read(with(&format!(r#""a":{{"rings":[[[{x},0],[1,1],[2,{x}]]]}}"#), r#""expr":"a""#)).unwrap();
        let (path, _) = read(with(&format!(r#""a":{{"path":"M{x} 0L1 1L2 {x}Z"}}"#), r#""expr":"a""#)).unwrap();
        assert_eq!(scene.shapes[0].path.points()[0][0].to_bits(), x.parse::<f64>().unwrap().to_bits(), "{x}");
        assert_eq!(scene.shapes[0].path, path.shapes[0].path, "{x}");
    }
}

/// A text without its mark `¦`, and the place of the character that stood behind it.
fn unmark(marked: &str) -> (String, Place) {
    let (before, after) = marked.split_once('¦').unwrap();
    let line = before.split('\n').count() as u32;
    let column = before.split('\n').next_back().unwrap().chars().count() as u32 + 1;
    (format!("{before}{after}"), Place { line, column })
}

#[test]
fn refused_with_place_name_and_advice() {
    let table: &[(&str, &str)] = &[
        // the document
        ("{¦}", "the scene has no shapes: add it"),
        (r#"{"width":5,"shapes":{},"expr":"page"¦}"#, "the scene has no height: add it"),
        (r#"{"width":5,"height":5,"shapes":{}¦}"#, "the scene has neither expr nor layers: add one"),
        (r#"{"width":5,"height":5,"shapes":{},"expr":"art","¦layers":[]}"#, "a second expr or layers: a scene has exactly one of them"),
        (r#"{"width":5,"¦width":5}"#, "a second width: give it once"),
        ("{\"width\":5,\n\"¦colour\":5}", r#"unknown key "colour": a scene has width, height, shapes, and expr or layers"#),
        (r#"{"¦width":0}"#, "width is 0: give a positive number of pixels"),
        (r#"{"¦height":-3.5}"#, "height is -3.5: give a positive number of pixels"),
        (r#"{"width":"5¦"}"#, r#"invalid type: string "5", expected a number"#),
        (r#"{"width":nul¦l}"#, "invalid type: null, expected a number"),
        (r#"{"width":1e99¦9}"#, "number out of range"),
        (r#"{"width":¦NaN}"#, "expected value"),
        (r#"{"width":5¦"#, "the scene ends too early: is the file complete?"),
        (r#"{"width" ¦5}"#, "expected `:`"),
        (r#"{"shapes"¦:[]}"#, "invalid type: sequence, expected an object of shapes"),
        (r#"{"width":1,"height":1,"shapes":{},"expr":"page"} ¦x"#, "something follows the scene: remove it"),
        (r#"{"¦runset":1,"width":5}"#, "this is a line stream, not a scene: read it with runset convert"),
        (r#"{"expr":¦5}"#, "invalid type: integer `5`, expected a string"),
        // shapes
        (r#"{"shapes":{"a":{¦}}}"#, r#"shape "a": no outline: give rings or path"#),
        (r#"{"shapes":{"a":{"rings":[],"¦path":""}}}"#, r#"shape "a": a second outline: give rings or path, and once"#),
        (r#"{"shapes":{"a":{"path":"","¦path":""}}}"#, r#"shape "a": a second outline: give rings or path, and once"#),
        (
            "{\"shapes\":{\"é\":{\"path\":\"\",\n \"¦é\":1}}}",
            r#"shape "é": unknown key "é": a shape has rings or path, rule and transform"#,
        ),
        (r#"{"shapes":{"a":{"path":"","rule":"¦odd"}}}"#, r#"shape "a": unknown rule "odd": write nonzero or evenodd"#),
        (r#"{"shapes":{"a":{"path":""},"¦a":{"path":""}}}"#, r#"shape "a": a second shape of that name: rename one"#),
        (r#"{"shapes":{"a":¦5}}"#, r#"shape "a": invalid type: integer `5`, expected a shape: an object with rings or path"#),
        (
            r#"{"shapes":{"a":{"rings":¦5}}}"#,
            r#"shape "a": invalid type: integer `5`, expected an array of rings, each an array of points [x, y]"#,
        ),
        (r#"{"shapes":{"a":{"rings":[¦5]}}}"#, r#"shape "a": invalid type: integer `5`, expected a ring: an array of points [x, y]"#),
        (r#"{"shapes":{"a":{"rings":[[¦5]]}}}"#, r#"shape "a": invalid type: integer `5`, expected a point [x, y]"#),
        (r#"{"shapes":{"a":{"rings":[[[5¦]]]}}}"#, r#"shape "a": a point has two numbers: [x, y]"#),
        (r#"{"shapes":{"a":{"rings":[[[5,6,7¦]]]}}}"#, r#"shape "a": a point has two numbers: [x, y]"#),
        (r#"{"shapes":{"a":{"rings":[[[5,"6¦"]]]}}}"#, r#"shape "a": invalid type: string "6", expected a number"#),
        (r#"{"shapes":{"a":{"rings":[[[5,1e99¦9]]]}}}"#, r#"shape "a": number out of range"#),
        (r#"{"shapes":{"a":{"rings":[[[5,6]¦"#, r#"shape "a": the scene ends too early: is the file complete?"#),
        // paths
        (r#"{"shapes":{"a":{"path":"M 0 0 L 1 ¦x"}}}"#, r#"shape "a": path, character 11: expected a finite number"#),
        (r#"{"shapes":{"a":{"path":"M 0 0\nL 1 x"¦}}}"#, r#"shape "a": path, character 11: expected a finite number"#),
        ("{\"shapes\":\n{\"a\":{\"path\":\"¦L 0\"}}}", r#"shape "a": path, character 1: path data begin with M"#),
        (
            r#"{"shapes":{"a":{"path":"¦M0 0l1e308 0l1e308 0"}}}"#,
            r#"shape "a": path: segment 3 leaves the range of 64-bit numbers: use smaller coordinates"#,
        ),
        // transforms
        (r#"{"shapes":{"a":{"path":"","transform":[1,2,3¦]}}}"#, r#"shape "a": a transform has six or nine numbers, here are 3"#),
        (
            r#"{"shapes":{"a":{"path":"","transform":[1,2,3,4,5,6,7,8,9,10¦]}}}"#,
            r#"shape "a": a transform has six or nine numbers, here are more"#,
        ),
        (
            r#"{"shapes":{"a":{"path":"","transform":[0.1,0.2,0.3,0.4,0.5,0.6,0.7,0.8,0.9¦]}}}"#,
            r#"shape "a": the transform is singular: it maps the plane onto a line"#,
        ),
        (
            r#"{"shapes":{"a":{"path":"","transform":[0,0,0,0,0,0,0,0,0¦]}}}"#,
            r#"shape "a": the transform is singular: it maps the plane onto a line"#,
        ),
        (
            r#"{"shapes":{"a":{"path":"M1e300 0L1 1","transform":[1e10,0,0,1,0,0]}¦}}"#,
            r#"shape "a": its transform takes it out of the range of 64-bit numbers: use smaller ones"#,
        ),
        (
            r#"{"shapes":{"a":{"transform":[1,0,0,0,1,0,1e300,0,1],"rings":[[[1e300,0],[0,0],[0,1]]]}¦}}"#,
            r#"shape "a": its transform takes it out of the range of 64-bit numbers: use smaller ones"#,
        ),
        // layers
        (r#"{"layers"¦:{}}"#, "invalid type: map, expected an array of layers"),
        (r#"{"layers":[{"expr":"a"¦}]}"#, "layers[0]: the layer has no ink: add it"),
        (r##"{"layers":[{"ink":"#000000"¦}]}"##, "layers[0]: the layer has no expr: add it"),
        (r##"{"layers":[{"ink":"#000000","expr":"a"},{"ink":"¦red"}]}"##, r#"layers[1]: the ink "red" is not a colour: write #rrggbb"#),
        (r#"{"layers":[{"ink":"¦#+00000"}]}"#, r##"layers[0]: the ink "#+00000" is not a colour: write #rrggbb"##),
        (r#"{"layers":[{"¦paint":1}]}"#, r#"layers[0]: unknown key "paint": a layer has expr and ink"#),
        (r#"{"layers":[{"expr":"","¦expr":""}]}"#, "layers[0]: a second expr: give it once"),
    ];
    for (marked, what) in table {
        let (text, place) = unmark(marked);
        let error = read(&text).expect_err(marked);
        assert_eq!((error.place, error.what.as_str()), (Some(place), *what), "{marked}");
    }
}

#[test]
fn expressions_are_refused_by_their_key_and_column() {
    let shapes = format!(r#""a":{{{TRIANGLE}}}"#);
    let table = [
        (r#""expr":"a - ¦b""#, "expr, column 5: unknown name \"b\": did you mean a, art or page?"),
        (r#""expr":"a -¦""#, "expr, column 4: expected a shape, found the end: add one, or remove the sign before it"),
        (
            "\"layers\":[{\"ink\":\"#000000\",\"expr\":\"a\"},\n{\"expr\":\"¦é\",\"ink\":\"#123456\"}]",
            "layers[1].expr, column 1: expected a shape, found 'é': an id with such characters is written in double quotes",
        ),
    ];
    for (rest, what) in table {
        let (text, place) = unmark(&with(&shapes, rest));
        let error = read(text).expect_err(rest);
        assert_eq!((error.place, error.what.as_str()), (Some(place), what), "{rest}");
        assert_eq!(error.origin, Origin::Input);
    }
    let escaped = read(with(&shapes, r#""expr":"a -\nb""#)).unwrap_err();
    assert_eq!(escaped.to_string(), "expr, line 2, column 1: unknown name \"b\": did you mean a, art or page?");
}

#[test]
fn warnings_name_the_key() {
    let shapes = format!(r#""a":{{{TRIANGLE}}},"e":{{"path":"M 1 1"}},"r":{{"rings":[[[1,1],[2,2]]]}}"#);
    let rest = r##""layers":[{"expr":"a","ink":"#000000"},{"expr":"e | atleast(9, a) | r","ink":"#000000"}]"##;
    let document = with(&shapes, rest);
    let warnings = read(&document).unwrap().1;
    let place = |text: &str| Some(Place::of_byte(document.as_bytes(), document.find(text).unwrap()));
    let places: Vec<_> = warnings.iter().map(|w| w.place).collect();
    assert_eq!(places, [place("e | atleast"), place("atleast(9"), place("r\",\"ink\"")]);
    let lines: Vec<_> = warnings.into_iter().map(|w| w.what).collect();
    assert_eq!(
        lines,
        [
            "layers[1].expr, column 1: e paints nothing: it counts as an empty shape",
            "layers[1].expr, column 5: atleast asks for more than the 1 given here: it holds nowhere",
            "layers[1].expr, column 21: r paints nothing: it counts as an empty shape",
        ]
    );
}

#[test]
fn singular_affine_maps_are_allowed() {
    let shapes = format!(r#""a":{{{TRIANGLE},"transform":[0,0,0,0,1,1]}}"#);
    assert!(read(with(&shapes, r#""expr":"a""#)).is_ok());
}

#[test]
fn a_homography_with_far_apart_scales_is_not_singular() {
    for m in ["1,0,1e6,0,1,1e6,0,0,1", "1e-9,0,0,0,1e9,0,0,0,1", "1,0,0,0,1,0,1e-9,1e-9,1"] {
        assert!(read(with(&format!(r#""a":{{"path":"","transform":[{m}]}}"#), r#""expr":"a""#)).is_ok(), "{m}");
    }
}

#[test]
fn documents_of_another_kind() {
    let table: &[(&[u8], &str)] = &[
        (b"", "the input is empty: expected an SVG, which begins with <, or a JSON scene, with {"),
        (b"\xef\xbb\xbf \r\n\t ", "the input is empty: expected an SVG, which begins with <, or a JSON scene, with {"),
        (b"hello", "neither a drawing nor a scene: expected an SVG, which begins with <, or a JSON scene, with {"),
        (b"[1]", "neither a drawing nor a scene: expected an SVG, which begins with <, or a JSON scene, with {"),
        (b"%PDF-1.7", "neither a drawing nor a scene: expected an SVG, which begins with <, or a JSON scene, with {"),
        (b"\xff\xfe<\0s\0", "the document is UTF-16: save it as UTF-8"),
        (b"<\0s\0", "the document is UTF-16: save it as UTF-8"),
        (b"\xfe\xff\0<", "the document is UTF-16: save it as UTF-8"),
        (b"\x1f\x8b\x08", "broken gzip data (unexpected end of file): is the file complete?"),
    ];
    for (bytes, line) in table {
        assert_eq!(&read(bytes).expect_err(line).to_string(), line);
    }
    let scene = with("", r#""expr":"page""#);
    assert!(read([b"\xef\xbb\xbf \n", scene.as_bytes()].concat()).is_ok());
    assert!(read(gzip(scene.as_bytes())).is_ok());
    // Places do not count the mark.
    assert_eq!(read(b"\xef\xbb\xbf{}").unwrap_err().to_string(), "1:2: the scene has no shapes: add it");
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    std::io::Write::write_all(&mut encoder, bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn past_the_limits() {
    let tight = |text: &[u8], limits: Limits| {
        let error = runset::input::read(text.to_vec(), &limits, &mut Vec::new()).unwrap_err();
        assert_eq!(error.kind, Kind::Limit);
        error.to_string()
    };
    let limits = Limits::default();
    let scene = with(&format!(r#""a":{{{TRIANGLE}}},"b":{{"path":"M0 0L1 1L2 2Z"}}"#), r#""expr":"a|b""#);
    let small = Limits { input: 50, ..limits };
    assert_eq!(tight(scene.as_bytes(), small), "the document is larger than 50 bytes after decompression: raise --max-input");
    assert_eq!(tight(&gzip(scene.as_bytes()), small), "the document is larger than 50 bytes after decompression: raise --max-input");
    let triangle = format!(r#""a":{{{TRIANGLE}}}"#);
    let cases = [
        (
            r#""a":{"rings":[[[0,0],[4,0],[0,4]¦]]}"#,
            r#""expr":"a""#,
            3,
            99,
            "shape \"a\": more than 3 edges: raise the limit or split the drawing",
        ),
        (
            &*format!(r#"{triangle},"b":{{"path":"¦M0 0L1 1L2 2Z"}}"#),
            r#""expr":"a|b""#,
            6,
            99,
            "shape \"b\": path: more than 2 lines and curves: raise the limit or split the drawing",
        ),
        (
            &*format!(r#"{triangle},"b¦":{{"path":"M0 0L1 1L2 2Z"}}"#),
            r#""expr":"a|b""#,
            99,
            3,
            "shape \"b\": more than 3 shapes, names and layers: split the drawing",
        ),
        (
            "",
            r#""expr":"page|page|¦page""#,
            99,
            3,
            "expr, column 11: the expression has more than 3 operands and operators: draw it in several runs",
        ),
    ];
    for (shapes, rest, edges, nodes, what) in cases {
        let (text, place) = unmark(&with(shapes, rest));
        let error = runset::input::read(text.into_bytes(), &Limits { edges, nodes, ..limits }, &mut Vec::new()).unwrap_err();
        assert_eq!((error.kind, error.place, error.what.as_str()), (Kind::Limit, Some(place), what));
    }
}

#[test]
fn a_bomb_stops_at_the_limit() {
    let bomb = gzip(&vec![b' '; 300 << 20]);
    let start = clock::cpu();
    assert_eq!(read(bomb).unwrap_err().kind, Kind::Limit);
    assert!((clock::cpu() - start).as_secs_f64() < 2.0, "{:?}", clock::cpu() - start);
}

/// Truncations, flipped bytes and hostile shapes: a scene or one line, quickly.
#[test]
fn broken_documents_are_refused_quickly() {
    let scene = with(
        &format!(r#""a":{{{TRIANGLE},"transform":[1,0,0,1,0,0]}},"b\u00e9\"":{{"path":"M0 0A1 1 0 0 1 5 5Z","rule":"evenodd"}}"#),
        r##""layers":[{"expr":"a-\"bé\\\"\"","ink":"#00ff00"}]"##,
    );
    let whole = scene.as_bytes();
    assert!(read(whole).is_ok(), "{:?}", read(whole).err());
    let one_line = |bytes: &[u8]| {
        if let Err(e) = read(bytes) {
            assert!(!e.to_string().contains('\n') && !e.what.is_empty());
        }
    };
    for end in 0..whole.len() {
        assert!(read(&whole[..end]).is_err());
    }
    let mut state = 1_u32;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        state
    };
    for _ in 0..20_000 {
        let mut bytes = whole.to_vec();
        for _ in 0..1 + random() % 3 {
            let at = random() as usize % bytes.len();
            bytes[at] = if random() % 2 == 0 { random() as u8 } else { whole[random() as usize % whole.len()] };
        }
        one_line(&bytes);
    }
    for _ in 0..2000 {
        let bytes: Vec<u8> = std::iter::once(b'{').chain((0..random() % 64).map(|_| random() as u8)).collect();
        one_line(&bytes);
    }
}

#[test]
fn hostile_scenes_end_within_two_seconds() {
    const N: usize = 100_000;
    let deep = |open: &str| open.repeat(N);
    let cases = [
        deep("["),
        deep("{\"a\":"),
        format!(r#"{{"shapes":{}"#, deep("{\"a\":")),
        format!(r#"{{"shapes":{{"a":{{"rings":{}"#, deep("[")),
        format!(r#"{{"layers":{}"#, deep("[")),
        with("", &format!(r#""expr":"{}art{}""#, "(".repeat(N), ")".repeat(N))),
        with("", &format!(r#""expr":"{}page""#, "art^".repeat(N))),
        with(&format!(r#""{}":{{"path":""}}"#, "é\\\"".repeat(2_000_000)), r#""expr":"x""#),
        with("", &format!(r##""layers":[{}{{"expr":"x","ink":"#000000"}}]"##, r##"{"expr":"page","ink":"#000000"},"##.repeat(N))),
        with(&(0..N).map(|i| format!(r#""s{i}":{{"path":"M0 0"}},"#)).collect::<String>(), ""),
        with(&format!(r#""a":{{"path":"M0 0{}"}}"#, "a1 1 0 1 1 1 1".repeat(N)), r#""expr":"b""#),
    ];
    for text in cases {
        let start = clock::cpu();
        let result = read(&text);
        assert!((clock::cpu() - start).as_secs_f64() < 2.0, "{}… took {:?}", &text[..40], clock::cpu() - start);
        if let Err(e) = result {
            assert!(e.to_string().chars().count() < 800);
        }
    }
}
