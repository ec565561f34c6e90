//! Models: pictures as the command line's, and what is said when something is wrong.

use std::io::Write as _;

use flate2::Compression;
use flate2::write::GzEncoder;
use runset::encode::FORMATS;

use crate::support::{CSG, Folder, MODEL, STL, SVG, Server, by_command_line, ids, is_model, tetrahedron, wait_until};

#[test]
fn pictures_are_those_of_the_command_line() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    for format in FORMATS {
        let right = by_command_line(MODEL.as_bytes(), &["--imgsize", "200,150", "--format", format.name]);
        let named = server.solid(&format!("?imgsize=200,150&format={}", format.name), CSG, MODEL).ok(200);
        assert!(named.body == right && named.header("content-type") == format.media_type, "{}", format.name);
        let fields = [("content-type", CSG), ("accept", format.media_type)];
        let accepted = server.ask("POST", "/v1/solid?imgsize=200,150", &fields, MODEL.as_bytes()).ok(200);
        assert!(accepted.body == right && accepted.header("content-type") == format.media_type, "{}", format.name);
        let fixed = ["pbm", "pgm", "ppm"].contains(&format.name);
        assert_eq!(named.header("content-length"), if fixed { right.len().to_string() } else { String::new() }, "{}", format.name);
    }
    assert_eq!(server.solid("", CSG, MODEL).ok(200).header("content-type"), "image/png", "without a wish");
    for accept in ["*/*", "image/*", "image/webp, */*;q=0.1"] {
        let fields = [("content-type", CSG), ("accept", accept)];
        assert_eq!(server.ask("POST", "/v1/solid", &fields, MODEL.as_bytes()).ok(200).header("content-type"), "image/png", "{accept}");
    }
    let query = "?imgsize=160,120&camera=4,5,6,60,0,30,50&projection=o&viewall=true&autocenter=true&colorscheme=Tomorrow%20Night\
        &curves=facets&section=1,0,0,2&section=0,0,1,2.5&lines=10..100&format=ppm";
    let options = "--imgsize 160,120 --camera 4,5,6,60,0,30,50 --projection o --viewall --autocenter --curves facets --section 1,0,0,2 \
        --section 0,0,1,2.5 --lines 10..100 --format ppm";
    let options: Vec<&str> = options.split_whitespace().chain(["--colorscheme", "Tomorrow Night"]).collect();
    assert!(server.solid(query, CSG, MODEL).ok(200).body == by_command_line(MODEL.as_bytes(), &options));
    let query = "?imgsize=80,60&antialias=2&smooth=30&edges=20&translucent=2&translucent=1,1-1&glass=true&format=ppm";
    let options =
        ["--imgsize", "80,60", "--antialias", "2", "--smooth", "30", "--edges=20", "--translucent", "2,1", "--glass", "--format", "ppm"];
    assert!(server.solid(query, CSG, MODEL).ok(200).body == by_command_line(MODEL.as_bytes(), &options));
    let no = "?imgsize=90,90&viewall=false&autocenter=false&camera=0,0,0,55,0,25,60&format=ppm";
    let options = ["--imgsize", "90,90", "--camera", "0,0,0,55,0,25,60", "--format", "ppm"];
    assert!(server.solid(no, CSG, MODEL).ok(200).body == by_command_line(MODEL.as_bytes(), &options));

    let stl = tetrahedron();
    assert!(is_model(&stl));
    let right = by_command_line(&stl, &["--imgsize", "99,77", "--format", "ppm"]);
    for kind in [STL, "application/sla", "application/vnd.ms-pki.stl", "text/plain; charset=utf-8"] {
        assert!(server.solid("?imgsize=99,77&format=ppm", kind, &stl).ok(200).body == right, "{kind}");
    }
    let mut zip = GzEncoder::new(Vec::new(), Compression::best());
    zip.write_all(&stl).unwrap();
    assert!(server.solid("?imgsize=99,77&format=ppm", STL, zip.finish().unwrap()).ok(200).body == right, "gzipped");
    assert!(server.metric("runset_renders_total", "kind=\"solid\"") > 10.0);
}

#[test]
fn what_is_wrong_with_a_model_is_told_in_one_form() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--max-pixels", "1000000", "--max-input", "100k", "--max-faces", "100"]);
    for query in [
        "?nothing=1",
        "?expr=a",
        "?width=5",
        "?kind=solid",
        "?imgsize=5",
        "?imgsize=0,5",
        "?imgsize=1,1&imgsize=2,2",
        "?camera=1,2,3",
        "?camera=1,2,3,1,2,3",
        "?camera=1,2,3,4,5,6,nan",
        "?projection=x",
        "?viewall=perhaps",
        "?colorscheme=Pink",
        "?curves=smooth",
        "?section=0,0,0,1",
        "?section=1,0,0,0&section=x",
        "?antialias=0",
        "?antialias=9",
        "?smooth=181",
        "?edges=-1",
        "?translucent=0",
        "?lines=5..5",
        "?format=bmp",
    ] {
        let problem = server.solid(query, CSG, MODEL).problem(400, "malformed");
        let name = query.trim_start_matches('?').split('=').next().unwrap();
        assert!(problem["detail"].as_str().unwrap().contains(name), "{query}: {problem}");
        server.post_job(&format!("{query}&kind=solid"), &[], MODEL).problem(400, "malformed");
    }
    let placed = |document: &str, status, name, place| {
        let problem = server.solid("", CSG, document).problem(status, name);
        assert_eq!((problem["line"].as_u64(), problem["column"].as_u64()), place, "{problem}");
        let job = server.post_job("?kind=solid", &[], document).problem(status, name);
        assert_eq!((&job["detail"], &job["line"]), (&problem["detail"], &problem["line"]));
        problem["detail"].as_str().unwrap().to_owned()
    };
    placed("union() {\n  cube(size = [1, 1, 1]\n}", 400, "malformed", (Some(3), Some(1)));
    placed("union() {\n  cub(size = 1);\n}", 422, "refused", (Some(2), Some(3)));
    let import = placed("union() {\n cube(size = 1);\n import(file = \"/etc/hostname.stl\");\n}", 422, "refused", (Some(3), Some(2)));
    assert!(import.contains("/etc/hostname.stl") && import.contains("not read here"), "{import}");
    let many = placed("sphere(r = 1, $fn = 1000);", 422, "limit", (Some(1), Some(1)));
    assert!(many.contains("100 faces"), "{many}");
    // Thin plates, all of them in a thousandth of the model's size.
    let near: String =
        (0..400).map(|i| format!("multmatrix([[1,0,0,0],[0,1,0,0],[0,0,1,{i}],[0,0,0,1]]) {{ cube(size = [1, 1, 0.5]); }}")).collect();
    let folder = Folder::new();
    let crowded = Server::start(&folder.data(), &["--max-pairs", "1000000"]);
    let problem = crowded.solid("", CSG, format!("cube(size = [1000000, 1, 1]);{near}")).problem(422, "limit");
    assert!(problem["detail"].as_str().unwrap().contains("1000000 pairs"), "{problem}");
    crowded.solid("", CSG, MODEL).ok(200);
    let small = "cube(size = 1);";
    server.solid("?imgsize=1001,1000", CSG, small).problem(422, "limit");
    server.solid(&format!("?{}", "section=1,0,0,5&".repeat(17)), CSG, small).problem(422, "refused");
    server.solid("?lines=3..600", CSG, small).problem(422, "refused");
    server.solid("", CSG, "").problem(400, "malformed");
    server.solid("", CSG, "{}").problem(400, "malformed");
    server.solid("", CSG, " ".repeat(200 << 10)).problem(413, "too-large");
    for kind in ["application/octet-stream", SVG, "application/json", "", "nonsense"] {
        server.solid("", kind, small).problem(415, "unsupported-media-type");
    }
    server.fill("", STL, tetrahedron()).problem(415, "unsupported-media-type");
    let fields = [("content-type", CSG), ("accept", "text/html")];
    server.ask("POST", "/v1/solid", &fields, small.as_bytes()).problem(406, "not-acceptable");
    server.ask("GET", "/v1/solid", &[], b"").problem(405, "method-not-allowed");
    assert_eq!(ids(&server), Vec::<String>::new());
    assert_eq!(server.metric("runset_streams", ""), 0.0);
}

#[test]
fn what_is_put_right_in_a_model_is_a_warning() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let open = "polyhedron(points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], faces = [[0, 1, 2], [1, 0, 3], [2, 1, 3]]);";
    let answer = server.solid("", CSG, open).ok(200);
    assert!(answer.header("runset-warning").starts_with("1:1: "), "{:?}", answer.headers);
    let job = server.get(&server.job("?kind=solid", open)).json();
    assert!(job["warnings"][0].as_str().unwrap().starts_with("1:1: "), "{job}");
    assert!(server.solid("", CSG, "text(\"a\");").ok(200).headers.get_all("runset-warning").iter().count() >= 2, "left out, and empty");
}

#[test]
fn a_job_is_of_one_kind() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let key = [("idempotency-key", "one")];
    let query = "?kind=solid&imgsize=50,40&section=0,0,1,2";
    let first = server.post_job(query, &key, MODEL).ok(201);
    let job = first.json();
    assert_eq!((&job["kind"], &job["format"], &job["width"], &job["height"]), (&"solid".into(), &"png".into(), &50.into(), &40.into()));
    let place = first.header("location").to_owned();
    let right = by_command_line(MODEL.as_bytes(), &["--imgsize", "50,40", "--section", "0,0,1,2"]);
    assert_eq!(server.measured(&place), right.len() as u64);
    assert_eq!(server.post_job(query, &key, MODEL).ok(201).header("location"), place);
    for other in
        ["?kind=solid&imgsize=50,40", "?kind=solid&imgsize=50,40&section=0,0,1,3", "?kind=solid&imgsize=50,40&section=0,0,1,2&format=rls"]
    {
        server.post_job(other, &key, MODEL).problem(422, "key-reused");
    }
    for query in ["", "?kind=fill"] {
        server.post_job(query, &[], MODEL).problem(415, "unsupported-media-type");
    }
    assert!(server.get(&format!("{place}/raster")).ok(200).body == right);
    wait_until("it is done", || server.get(&place).json()["state"] == "done");
    server.kill();
    let server = Server::start(&folder.data(), &[]);
    assert_eq!(server.get(&place).ok(200).json()["kind"], "solid");
    server.measured(&place);
    let part = server.ask("GET", &format!("{place}/raster"), &[("range", "bytes=100-")], b"").ok(206);
    assert!(part.body == right[100..]);
    assert_eq!(server.post_job(query, &key, MODEL).ok(201).header("idempotent-replayed"), "true");
}
