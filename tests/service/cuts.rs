//! Rasters that are cut anywhere and taken up again are those that nobody cut.

use std::io::Read;

use runset::encode::variants;

use crate::support::{Folder, MODEL, Rng, SCENE, Server, art, by_command_line, effort, header, is_model, triangle};

/// A drawing: its name, the document, options and their values.
type Drawing = (&'static str, Vec<u8>, &'static [(&'static str, &'static str)]);

/// A job, and the bytes that its raster has to have.
struct Target {
    job: String,
    tag: String,
    name: String,
    bytes: Vec<u8>,
}

/// Jobs in all formats of several drawings, one ink and many, and of a model, their rasters compared with the command line's.
fn targets(server: &Server) -> Vec<Target> {
    let poster = art("poster.svg");
    let drawings: [Drawing; 6] = [
        ("small", SCENE.into(), &[]),
        ("inks", poster.clone(), &[("width", "900")]),
        ("plate", poster, &[("width", "1500"), ("expr", "art & frame - logo")]),
        ("slice", art("scene.json"), &[("scale", "3"), ("lines", "100..700")]),
        ("triangle", triangle(300, 9000).into_bytes(), &[]),
        ("model", MODEL.into(), &[("imgsize", "600,500"), ("section", "1,0,0,3"), ("lines", "20..480")]),
    ];
    let mut all = Vec::new();
    for (name, document, options) in &drawings {
        for format in variants() {
            let compression = format.compression_name().map(|name| ("compression", name));
            if ["inks", "slice", "model"].contains(name) && format.compression_name() == Some("g4") {
                continue;
            }
            let options: Vec<_> = [*options, &[("format", format.name)]].concat().into_iter().chain(compression).collect();
            let kind = if is_model(document) { "&kind=solid" } else { "" };
            let query: Vec<_> =
                options.iter().map(|(key, value)| format!("{key}={}", value.replace('&', "%26").replace(' ', "%20"))).collect();
            let job = server.job(&format!("?{}{kind}", query.join("&")), document) + "/raster";
            let raster = server.get(&job).ok(200);
            let line: Vec<_> = options.iter().flat_map(|(key, value)| [format!("--{key}"), (*value).to_owned()]).collect();
            let bytes = by_command_line(document, &line.iter().map(String::as_str).collect::<Vec<_>>());
            assert!(raster.body == bytes, "{name}.{}: not the command line's raster", format.name);
            assert_eq!(raster.header("content-type"), format.media_type);
            let name = format!("{name}.{}{compression:?}", format.name);
            all.push(Target { job, tag: raster.header("etag").to_owned(), name, bytes });
        }
    }
    all
}

/// At most `most` bytes of an answer; then the reader goes.
fn some(server: &Server, target: &Target, range: Option<&str>, if_range: Option<&str>, status: u16, most: u64) -> Vec<u8> {
    let fields: Vec<_> = range.map(|range| ("range", range)).into_iter().chain(if_range.map(|tag| ("if-range", tag))).collect();
    let response = server.open("GET", &target.job, &fields, b"");
    assert_eq!(response.status(), status, "{} {fields:?}", target.name);
    assert_eq!(header(response.headers(), "etag"), target.tag, "{}", target.name);
    if status == 206 {
        let part = header(response.headers(), "content-range").to_owned();
        assert!(
            part.starts_with(&range.unwrap().replace('=', " ")) && part.ends_with(&format!("/{}", target.bytes.len())),
            "{part} for {range:?}"
        );
    }
    let mut bytes = Vec::new();
    response.into_body().into_reader().take(most).read_to_end(&mut bytes).unwrap();
    bytes
}

/// Reads a raster in pieces, cut and taken up in several ways, and gives it.
fn pieces(server: &Server, target: &Target, rng: &mut Rng) -> Vec<u8> {
    let length = target.bytes.len() as u64;
    let mut joined = some(server, target, None, None, 200, rng.below(length));
    while (joined.len() as u64) < length {
        let at = joined.len() as u64;
        let left = length - at;
        let further = match rng.below(4) {
            0 => some(server, target, Some(&format!("bytes={at}-")), None, 206, 1 + rng.below(left)),
            1 => some(server, target, Some(&format!("bytes={at}-")), Some(&target.tag), 206, u64::MAX),
            // A part that is cut itself.
            2 => {
                let last = at + rng.below(left);
                some(server, target, Some(&format!("bytes={at}-{last}")), None, 206, 1 + rng.below(last - at + 1))
            }
            // Another raster's tag: the whole from its beginning.
            _ => {
                let whole = some(server, target, Some(&format!("bytes={at}-")), Some("\"another\""), 200, at + 1 + rng.below(left));
                assert!(whole[..at as usize] == joined, "{}", target.name);
                whole[at as usize..].to_vec()
            }
        };
        joined.extend(further);
    }
    joined
}

#[test]
fn cut_rasters_go_on() {
    let folder = Folder::new();
    let mut server = Server::start(&folder.data(), &[]);
    let targets = targets(&server);
    let mut rng = Rng(5);
    let cuts = effort(50);
    for cut in 0..cuts {
        if cut == cuts / 2 {
            // From here on with what a restart has kept.
            server.kill();
            server = Server::start(&folder.data(), &[]);
            targets
                .iter()
                .for_each(|target| assert_eq!(server.measured(target.job.trim_end_matches("/raster")), target.bytes.len() as u64));
        }
        let target = &targets[(cut * 7) as usize % targets.len()];
        assert!(pieces(&server, target, &mut rng) == target.bytes, "cut {cut}, {}", target.name);
    }
    assert_eq!(server.metric("runset_ends_total", "failed"), 0.0);
}

#[test]
fn ranges_and_conditions() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let whole = by_command_line(&art("poster.svg"), &["--width", "700", "--format", "png"]);
    let job = server.job("?width=700&format=png", art("poster.svg"));
    let n = server.measured(&job);
    assert_eq!(n, whole.len() as u64);
    let raster = format!("{job}/raster");
    let get = |fields: &[(&str, &str)]| server.ask("GET", &raster, fields, b"");
    let head = server.ask("HEAD", &raster, &[], b"").ok(200);
    assert_eq!((head.header("content-length"), head.header("accept-ranges"), head.body.len()), (n.to_string().as_str(), "bytes", 0));
    let tag = head.header("etag").to_owned();
    assert!(tag.starts_with('"') && tag.ends_with('"'), "strong: {tag}");

    for (range, from, to) in [
        ("bytes=0-0", 0, 1),
        ("bytes=100-", 100, n),
        ("bytes=-500", n - 500, n),
        ("bytes=7-99999999999", 7, n),
        ("bytes=-99999999999", 0, n),
    ] {
        let answer = get(&[("range", range)]).ok(206);
        assert_eq!(answer.header("content-range"), format!("bytes {from}-{}/{n}", to - 1), "{range}");
        assert_eq!(answer.header("content-length"), (to - from).to_string(), "{range}");
        assert!(answer.body == whole[from as usize..to as usize], "{range}");
    }
    for range in [format!("bytes={n}-"), "bytes=99999999999-".to_owned(), "bytes=-0".to_owned()] {
        let answer = get(&[("range", &range)]);
        answer.problem(416, "range");
        assert_eq!(answer.header("content-range"), format!("bytes */{n}"));
    }
    // What is no range of bytes is as none, and so are several.
    for range in ["bytes=9-3", "lines=0-5", "bytes=", "bytes=a-b", "bytes=0-1,5-9", "bytes=0-1, 3-4"] {
        assert!(get(&[("range", range)]).ok(200).body == whole, "{range}");
    }
    for if_range in ["\"another\"", "W/\"weak\"", "Wed, 21 Oct 2015 07:28:00 GMT", &format!("W/{tag}")] {
        assert!(get(&[("range", "bytes=5-"), ("if-range", if_range)]).ok(200).body == whole, "{if_range}");
    }
    assert!(get(&[("range", "bytes=5-"), ("if-range", &tag)]).ok(206).body == whole[5..]);
    for method in ["GET", "HEAD"] {
        let unchanged = server.ask(method, &raster, &[("if-none-match", &tag)], b"").ok(304);
        assert_eq!((unchanged.header("etag"), unchanged.body.len()), (tag.as_str(), 0));
        assert_eq!((unchanged.header("content-length"), unchanged.header("transfer-encoding")), ("", ""), "{method}");
        assert_eq!(server.ask(method, &raster, &[("if-match", "\"another\"")], b"").status, 412);
        server.ask(method, &raster, &[("if-match", &tag)], b"").ok(200);
        server.ask(method, &raster, &[("if-none-match", "\"another\"")], b"").ok(200);
    }
    get(&[("if-match", "\"another\"")]).problem(412, "changed");
}

#[test]
fn a_part_of_what_is_not_measured_yet_waits() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--max-bands", "1"]);
    // Seconds of work.
    let job = server.job("?format=png", triangle(8192, 2_000_000));
    let answer = server.ask("GET", &format!("{job}/raster"), &[("range", "bytes=100-")], b"");
    answer.problem(503, "measuring");
    assert!(answer.header("retry-after").parse::<u32>().is_ok());
    assert_eq!(server.ask("HEAD", &format!("{job}/raster"), &[], b"").ok(200).header("content-length"), "");
    // Where the format fixes the length, that is known from the beginning.
    let job = server.job("?format=pbm", triangle(8192, 2_000_000));
    let answer = server.ask("GET", &format!("{job}/raster"), &[("range", "bytes=2000000000-2000000099")], b"").ok(206);
    assert_eq!((answer.body.len(), answer.header("content-range")), (100, "bytes 2000000000-2000000099/2048000016"));
}
