//! Primitives that are moved in views of a kept model, lines that a move has changed, and what a pixel shows.

use serde_json::{Value, json};

use crate::support::{CSG, Folder, MODEL, STL, Server, by_command_line, tetrahedron};

/// Keeps a model, and gives its address.
fn keep(server: &Server, kind: &str, document: impl AsRef<[u8]>) -> String {
    let answer = server.ask("PUT", "/v1/models", &[("content-type", kind)], document.as_ref());
    answer.header("location").to_owned()
}

/// The model of the tests with its ball moved, written into the document.
fn edited(by: [f64; 3]) -> String {
    let [x, y, z] = by;
    let moved = format!("multmatrix([[1, 0, 0, {x}], [0, 1, 0, {y}], [0, 0, 1, {z}], [0, 0, 0, 1]]) {{ sphere(r = 3, $fn = 20); }}");
    MODEL.replace("sphere(r = 3, $fn = 20);", &moved)
}

/// The pixels of a portable pixmap of that width.
fn pixels(ppm: &[u8], width: usize) -> Vec<&[u8]> {
    let head = ppm.iter().enumerate().filter(|(_, byte)| byte.is_ascii_whitespace()).nth(3).unwrap().0;
    ppm[head + 1..].chunks(3 * width).collect()
}

const VIEW: &str = "imgsize=120,90&camera=0,0,0,60,0,30,60";
const OPTIONS: [&str; 4] = ["--imgsize", "120,90", "--camera", "0,0,0,60,0,30,60"];

#[test]
fn a_move_is_the_picture_of_the_edited_document() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let place = keep(&server, CSG, MODEL);
    for by in [[-1.0, 0.5, 0.0], [0.25, -2.0, 1.5], [0.0, 0.0, -3.0]] {
        let [x, y, z] = by;
        let half = by.map(|x| x / 2.0);
        for format in ["ppm", "rls"] {
            let expected = by_command_line(edited(by).as_bytes(), &[&OPTIONS[..], &["--format", format]].concat());
            let moved = server.get(&format!("{place}/view?{VIEW}&format={format}&move=3,{x},{y},{z}")).ok(200);
            assert!(moved.body == expected, "{by:?} {format}");
            let [x, y, z] = half;
            let twice = format!("{place}/view?{VIEW}&format={format}&move=3,{x},{y},{z}&move=3,{x},{y},{z}");
            let twice = server.get(&twice).ok(200);
            assert!(twice.body == expected, "{by:?} {format}, in two steps");
            assert_ne!(twice.header("etag"), moved.header("etag"));
        }
    }
    // What is kept stays as it is.
    let still = server.get(&format!("{place}/view?{VIEW}&format=ppm")).ok(200);
    assert!(still.body == by_command_line(MODEL.as_bytes(), &[&OPTIONS[..], &["--format", "ppm"]].concat()));
}

#[test]
fn changed_lines_over_the_picture_before_are_the_picture() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let place = keep(&server, CSG, MODEL);
    let steps = [None, Some("3,0.25,0,0"), Some("3,-0.5,0.5,0"), Some("3,-0.5,0.5,0"), Some("2,0,0,0.5"), None];
    let query = |name: &str, step: Option<&str>| step.map_or(String::new(), |step| format!("&{name}={step}"));
    let picture = |format: &str, moves: &str| server.get(&format!("{place}/view?{VIEW}&format={format}{moves}")).ok(200);
    let mut few = 0;
    for pair in steps.windows(2) {
        let moved = query("move", pair[1]);
        let asked = format!("{moved}&from={}", pair[0].unwrap_or_default());
        let head: Value = serde_json::from_slice(picture("ndjson", &asked).body.split(|byte| *byte == b'\n').next().unwrap()).unwrap();
        let [from, to] = ["from", "to"].map(|name| head[name].as_u64().unwrap() as usize);
        let (old, patch, new) = (picture("ppm", &query("move", pair[0])), picture("ppm", &asked), picture("ppm", &moved));
        let mut patched = pixels(&old.body, 120);
        patched.splice(from..to, pixels(&patch.body, 120));
        assert!(patched == pixels(&new.body, 120), "{pair:?}: {from}..{to}");
        few += usize::from(to - from < 60);
        if pair[0] == pair[1] {
            assert_eq!((from, to), (0, 1), "nothing has changed");
        }
    }
    assert!(few >= 3, "{few} of five are parts");
    let head = server.ask("HEAD", &format!("{place}/view?{VIEW}&format=ppm&move=3,1,0,0&from="), &[], b"").ok(200);
    assert!(!head.headers.contains_key("content-length"), "{:?}", head.headers);
}

/// Part and depth of every pixel, as the command line writes them.
fn numbers(document: &str) -> (Vec<u16>, Vec<f32>) {
    let folder = tempfile::tempdir().unwrap();
    let [parts, depths] = ["parts.pgm", "depths.pfm"].map(|name| folder.path().join(name));
    let aov = |name: &str, path: &std::path::Path| format!("{name}={}", path.display());
    let (first, second) = (aov("primitive", &parts), aov("depth", &depths));
    by_command_line(document.as_bytes(), &[&OPTIONS[..], &["--aov", &first, "--aov", &second, "--format", "ppm"]].concat());
    let [parts, depths] = [parts, depths].map(|path| std::fs::read(path).unwrap());
    let (parts, depths) = (&parts[parts.len() - 2 * 120 * 90..], &depths[depths.len() - 4 * 120 * 90..]);
    let parts = parts.as_chunks::<2>().0.iter().map(|bytes| u16::from_be_bytes(*bytes)).collect();
    let depths: Vec<f32> = depths.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    // The last line comes first.
    (parts, depths.chunks(120).rev().flatten().copied().collect())
}

#[test]
fn a_pixel_tells_its_primitive() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let place = keep(&server, CSG, MODEL);
    let kinds = ["cube", "cylinder", "sphere", "cube"];
    for (moves, document) in [("", MODEL.to_owned()), ("&move=3,-1,0.5,0", edited([-1.0, 0.5, 0.0]))] {
        let (parts, depths) = numbers(&document);
        let (mut seen, mut of) = (0, [0; 4]);
        for (x, y) in (0..90).step_by(7).flat_map(|y| (0..120).step_by(5).map(move |x| (x, y))) {
            let pick = server.get(&format!("{place}/pick?x={x}&y={y}&{VIEW}{moves}")).ok(200).json();
            let (part, depth) = (parts[120 * y + x], depths[120 * y + x]);
            if part == 0 {
                assert_eq!(pick, Value::Null);
                continue;
            }
            assert_eq!(pick["primitive"], json!(part), "{x} {y} {pick}");
            let kind = kinds[usize::from(part) - 1];
            assert_eq!(pick["kind"], kind);
            // The text at its place is the statement.
            let [line, column] = ["line", "column"].map(|name| pick[name].as_u64().unwrap() as usize);
            assert!(MODEL.lines().nth(line - 1).unwrap()[column - 1..].starts_with(kind), "{pick}");
            assert!((pick["depth"].as_f64().unwrap() as f32 - depth).abs() < 1e-4, "{pick} {depth}");
            assert_eq!(pick["inside"], json!(part == 2 || part == 3), "{pick}");
            seen += 1;
            of[usize::from(part) - 1] += 1;
        }
        assert!(seen > 30 && of.iter().filter(|n| **n > 0).count() >= 3, "{of:?}");
    }
}

/// A cube of 10 from above, 50 away from its upper side: all by hand.
#[test]
fn a_point_of_a_cube() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let place =
        keep(&server, CSG, "\n  multmatrix([[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) {\n cube(size = [5, 10, 10]); }");
    for projection in ["p", "o"] {
        let asked = format!("imgsize=100,100&projection={projection}&camera=5,5,10,0,0,0,50");
        let pick = server.get(&format!("{place}/pick?x=60&y=30&{asked}")).ok(200).json();
        let [line, column] = [&pick["line"], &pick["column"]];
        assert_eq!((&pick["primitive"], &pick["kind"], line, column), (&json!(1), &json!("cube"), &json!(3), &json!(2)), "{pick}");
        assert_eq!((&pick["normal"], &pick["inside"]), (&json!([0.0, 0.0, 1.0]), &json!(false)));
        assert_eq!(pick["matrix"], json!([[2.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]));
        // 50 pixels are half the field of view: tan 11.25 degrees of the distance.
        let pixel = 50.0 * 11.25_f64.to_radians().tan() / 50.0;
        let point = [5.0 + 10.5 * pixel, 5.0 + 19.5 * pixel, 10.0];
        for (i, expected) in point.into_iter().enumerate() {
            assert!((pick["point"][i].as_f64().unwrap() - expected).abs() < 1e-3 * pixel + 1e-9, "{pick} {point:?}");
        }
        assert!((pick["depth"].as_f64().unwrap() - 50.0).abs() < 1e-9, "{pick}");
        assert_eq!(server.get(&format!("{place}/pick?x=0&y=0&{asked}")).ok(200).body, b"null");
    }
}

#[test]
fn what_is_wrong_with_moves_is_told_in_one_form() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let place = keep(&server, STL, tetrahedron());
    let pick = server.get(&format!("{place}/pick?x=256&y=256&camera=0.8,0.8,0.8,55,0,25,60")).ok(200).json();
    assert_eq!((&pick["primitive"], &pick["line"], &pick["kind"]), (&json!(1), &Value::Null, &json!("mesh")), "{pick}");
    let view = |query: &str| server.get(&format!("{place}/view?{query}"));
    for query in
        ["move=", "move=1", "move=0,1,1,1", "move=1,x,0,0", "from=x", "from=&from=", "from=&lines=0..5", &"move=1,0,0,0&".repeat(65)]
    {
        view(query).problem(400, "malformed");
    }
    assert!(view("move=2,0,0,0").problem(422, "refused")["detail"].as_str().unwrap().contains("1 to 1"));
    view("move=1,1e31,0,0").problem(422, "limit");
    view("from=2,0,0,0").problem(422, "refused");
    for query in ["", "x=1", "x=1&y=1&x=1", "x=-1&y=0", "x=512&y=0", "x=0&y=0&from=", "x=0&y=0&format=bmp", "x=0&y=0&camera=1"] {
        server.get(&format!("{place}/pick?{query}")).problem(400, "malformed");
    }
    server.get("/v1/models/none/pick?x=0&y=0").problem(404, "no-model");
    for path in ["/v1/solid?move=1,0,0,0", "/v1/solid?from="] {
        server.ask("POST", path, &[("content-type", CSG)], b"cube();").problem(400, "malformed");
    }
}

#[test]
fn a_model_is_dragged_by_many_at_once() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let place = keep(&server, CSG, MODEL);
    let step = |n: u32| f64::from(n) / 8.0;
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for n in 1..20 {
                    let (x, before) = (step(n), step(n - 1));
                    server.get(&format!("{place}/view?{VIEW}&format=rls&move=3,{x},0,0&from=3,{before},0,0")).ok(200);
                }
            });
        }
    });
    assert_eq!(server.get("/v1/models").ok(200).json()["models"].as_array().unwrap().len(), 1, "what moves is no model of its own");
}
