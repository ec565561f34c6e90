//! Formats, lengths, and what is said when something is wrong.

use std::io::Write as _;

use flate2::Compression;
use flate2::write::GzEncoder;
use runset::encode::FORMATS;

use crate::support::{Folder, JSON, SCENE, SVG, Server, art, by_command_line, empty, exchange, triangle};

#[test]
fn every_format_by_its_name_and_by_its_type() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    for format in FORMATS {
        let right = by_command_line(&art("poster.svg"), &["--width", "800", "--format", format.name]);
        let named = server.fill(&format!("?width=800&format={}", format.name), SVG, art("poster.svg")).ok(200);
        assert!(named.body == right && named.header("content-type") == format.media_type, "{}", format.name);
        let fields = [("content-type", SVG), ("accept", format.media_type)];
        let accepted = server.ask("POST", "/v1/fill?width=800", &fields, &art("poster.svg")).ok(200);
        assert!(accepted.body == right && accepted.header("content-type") == format.media_type, "{}", format.name);
        let length = named.header("content-length");
        let fixed = ["pbm", "pgm", "ppm"].contains(&format.name);
        assert_eq!(length, if fixed { right.len().to_string() } else { String::new() }, "{}", format.name);
    }
    let plain = server.fill("", JSON, SCENE).ok(200);
    assert_eq!(plain.header("content-type"), "application/x-ndjson", "without a wish");
    // Names, sizes and slices as on the command line.
    let query = "?expr=art%20%26%20frame%20-%20logo&dpi=40&lines=10..400&format=pbm&tolerance=0.5";
    let options = ["--expr", "art & frame - logo", "--dpi", "40", "--lines", "10..400", "--format", "pbm", "--tolerance", "0.5"];
    assert!(server.fill(query, SVG, art("poster.svg")).ok(200).body == by_command_line(&art("poster.svg"), &options));
    let mut zip = GzEncoder::new(Vec::new(), Compression::best());
    zip.write_all(&art("poster.svg")).unwrap();
    let zipped = zip.finish().unwrap();
    for fields in [vec![("content-type", SVG)], vec![("content-type", SVG), ("content-encoding", "gzip")]] {
        assert!(server.ask("POST", "/v1/fill?width=800&format=pbm", &fields, &zipped).ok(200).body.starts_with(b"P4\n800 "));
    }
}

#[test]
fn what_is_wrong_is_told_in_one_form() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--max-pixels", "1000000", "--max-input", "100k"]);
    let fill = |query: &str, document: &str| server.fill(query, if document.starts_with('{') { JSON } else { SVG }, document);
    for query in [
        "?nothing=1",
        "?width=x",
        "?width=1&width=2",
        "?dpi=1&scale=2",
        "?format=bmp",
        "?lines=5",
        "?lines=5..5",
        "?tolerance=0",
        "?kind=fill",
        "?scale=nan",
        "?dpi=-1",
    ] {
        let problem = fill(query, SCENE).problem(400, "malformed");
        let name = query.trim_start_matches('?').split('=').next().unwrap();
        assert!(problem["detail"].as_str().unwrap().contains(name), "{query}: {problem}");
    }
    for query in ["?nothing=1", "?kind=none"] {
        server.post_job(query, &[], SCENE).problem(400, "malformed");
    }
    for query in ["?limit=0", "?limit=1001", "?limit=x", "?nothing=1"] {
        server.get(&format!("/v1/jobs{query}")).problem(400, "malformed");
    }
    // Places in the document and in the expression.
    let problem =
        fill("", "{ \"width\": 8,\n \"height\": 8, \"expr\": \"a\", \"shapes\": { \"a\": { \"rings\": 5 } } }").problem(400, "malformed");
    assert_eq!(problem["line"], 2, "{problem}");
    assert!(problem["column"].as_u64().is_some());
    let problem = fill("?expr=a%20-%20c", SCENE);
    let problem =
        problem.problem(if problem.status == 422 { 422 } else { 400 }, if problem.status == 422 { "refused" } else { "malformed" });
    assert_eq!((&problem["line"], &problem["column"]), (&1.into(), &5.into()), "{problem}");
    fill("?expr=a%20-", SCENE).problem(400, "malformed");
    let svg = |content: &str| {
        format!("<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' width='9' height='9'>{content}</svg>")
    };
    fill("", &svg("<image href='file:///etc/passwd' width='9' height='9'/>")).problem(422, "refused");
    fill("", &svg("<image xlink:href='https://example.org/a.png' width='9' height='9'/>")).problem(422, "refused");
    fill("", &svg("<g id='a'><use href='#b'/></g><g id='b'><use href='#a'/></g>")).problem(422, "refused");
    fill("", &empty(1001, 1000)).problem(422, "limit");
    fill("?format=pwg&dpi=0.3", &empty(9, 9)).problem(422, "limit");
    server.post_job("?format=pwg&dpi=0.3", &[], empty(9, 9)).problem(422, "limit");
    fill("", "").problem(400, "malformed");
    fill("", &" ".repeat(200 << 10)).problem(413, "too-large");
    for kind in ["text/plain", "image/png", "nonsense", "", "application/json2"] {
        server.fill("", kind, SCENE).problem(415, "unsupported-media-type");
    }
    server.fill("", "application/json; charset=utf-8", SCENE).ok(200);
    server
        .ask("POST", "/v1/fill", &[("content-type", JSON), ("content-encoding", "br")], SCENE.as_bytes())
        .problem(415, "unsupported-media-type");
    server.ask("POST", "/v1/fill", &[], SCENE.as_bytes()).problem(415, "unsupported-media-type");
    let refused = server.ask("POST", "/v1/fill", &[("content-type", JSON), ("accept", "text/html, image/webp")], SCENE.as_bytes());
    let detail = refused.problem(406, "not-acceptable")["detail"].as_str().unwrap().to_owned();
    assert!(FORMATS.iter().all(|format| detail.contains(format.media_type)), "{detail}");
    for path in ["/nothing", "/v1", "/v1/jobs/", "/v1/jobs/x/nothing"] {
        server.get(path).problem(404, "not-found");
    }
    for path in ["/v1/jobs/none", "/v1/jobs/none/raster", "/v1/jobs/none/events", "/v1/jobs/%00%ff"] {
        server.get(path).problem(404, "no-job");
    }
    server.ask("DELETE", "/v1/jobs/none", &[], b"").problem(404, "no-job");
    for (method, path) in
        [("GET", "/v1/fill"), ("PUT", "/v1/jobs"), ("POST", "/healthz"), ("PATCH", "/v1/jobs/x"), ("DELETE", "/v1/jobs/x/raster")]
    {
        let answer = server.ask(method, path, &[], b"");
        answer.problem(405, "method-not-allowed");
        assert_ne!(answer.header("allow"), "", "{method} {path}");
    }
    assert_eq!(server.metric("runset_streams", ""), 0.0);
}

#[test]
fn requests_have_names() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--log-format", "json"]);
    let named = server.ask("GET", "/healthz", &[("x-request-id", "mine-1")], b"").ok(200);
    assert_eq!(named.header("x-request-id"), "mine-1");
    let [one, other] = [(); 2].map(|()| server.get("/healthz").header("x-request-id").to_owned());
    assert!(one.len() >= 16 && one != other, "{one} {other}");
    // What cannot stand in a log is replaced.
    for bad in [" ", "a b", &"x".repeat(129)] {
        assert_ne!(server.ask("GET", "/healthz", &[("x-request-id", bad)], b"").header("x-request-id"), bad);
    }
    let said = server.said();
    let line = said.lines().find(|line| line.contains("mine-1")).expect("a line in the log");
    let line: serde_json::Value = serde_json::from_str(line).unwrap();
    assert_eq!(
        (&line["method"], &line["path"], &line["status"], &line["whole"]),
        (&"GET".into(), &"/healthz".into(), &200.into(), &true.into()),
        "{line}"
    );
}

#[test]
fn warnings_are_told() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'><g id='é' filter='url(#f)'><rect width='5' height='5'/></g><filter id='f'><feFlood/></filter></svg>";
    let answer = server.fill("", SVG, svg).ok(200);
    assert!(answer.header("runset-warning").contains("filter"), "{:?}", answer.headers);
    let job = server.get(&server.job("", svg)).json();
    assert!(job["warnings"][0].as_str().unwrap().contains("filter"), "{job}");
}

#[test]
fn lengths_and_heads() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    for format in FORMATS {
        let job = server.job(&format!("?format={}", format.name), triangle(500, 700));
        let length = server.measured(&job);
        let raster = format!("{job}/raster");
        let head = server.ask("HEAD", &raster, &[], b"").ok(200);
        let whole = server.get(&raster).ok(200);
        assert_eq!(whole.body.len() as u64, length, "{}", format.name);
        for name in ["content-length", "content-type", "etag", "accept-ranges", "content-disposition"] {
            assert!(head.header(name) == whole.header(name) && !head.header(name).is_empty(), "{}: {name}", format.name);
        }
        assert_eq!(head.header("content-length"), length.to_string());
    }
    for path in ["/healthz", "/v1/jobs", "/openapi.json", "/metrics"] {
        assert_eq!(server.ask("HEAD", path, &[], b"").ok(200).body.len(), 0);
    }
    // Several requests on one connection, sent before the first is answered.
    let one = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";
    let answers = exchange(&server, format!("{one}{one}GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n").as_bytes());
    assert_eq!(answers.matches("HTTP/1.1 200 OK").count(), 3, "{answers}");
}
