//! Requests that mean harm are answered soon, in bounded memory, and the service goes on.

use std::fmt::Write as _;
use std::io::Write;
use std::time::{Duration, Instant};

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::support::{Folder, JSON, SCENE, SVG, Server, ending, exchange};
use crate::{alone, slower};

/// Largest resident set, in KiB.
const MEMORY: u64 = 256 << 10;

const MANY: usize = 100_000;

fn svg(head: &str, content: &str) -> Vec<u8> {
    format!("{head}<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"16\" height=\"16\">{content}</svg>").into_bytes()
}

fn scene(expr: &str, size: &str) -> Vec<u8> {
    SCENE.replace("a - b", expr).replace("\"width\": 16", &format!("\"width\": {size}")).into_bytes()
}

/// The status of an answer.
fn status(answer: &str) -> u16 {
    answer.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0)
}

#[test]
fn documents_that_mean_harm() {
    let _alone = alone();
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--log", "warn"]);
    let (mut entities, mut uses) = ("<!DOCTYPE svg [<!ENTITY e0 \"0123456789\">".to_owned(), String::new());
    for i in 1..10 {
        let _ = write!(entities, "<!ENTITY e{i} \"{}\">", format!("&e{};", i - 1).repeat(10));
        let _ = write!(uses, "<g id=\"g{i}\">{}</g>", format!("<use href=\"#g{}\"/>", i - 1).repeat(10));
    }
    let rect = "<rect id=\"g0\" width=\"8\" height=\"8\"/>";
    let mut zip = GzEncoder::new(Vec::new(), Compression::best());
    zip.write_all(&svg("", &" ".repeat(200 << 20))).unwrap();
    let zip = zip.finish().unwrap();
    assert!(zip.len() < (200 << 20) / 900, "1000 to 1");
    let deep = |open: &str, close: &str| format!("{}a{}", open.repeat(MANY), close.repeat(MANY));
    // Documents that are right although they are deep are drawn.
    let cases: Vec<(&str, &str, Vec<u8>, &[u16])> = vec![
        ("entities", SVG, svg(&(entities + "]>"), "&e9;"), &[400, 422]),
        ("use", SVG, svg("", &format!("<defs>{rect}{uses}</defs><use href=\"#g9\"/>")), &[422]),
        ("use of itself", SVG, svg("", "<g id=\"a\"><use href=\"#b\"/></g><g id=\"b\"><use href=\"#a\"/></g>"), &[422]),
        ("groups", SVG, svg("", &("<g>".repeat(MANY) + &"</g>".repeat(MANY))), &[400, 422]),
        ("gzip", SVG, zip, &[413, 422]),
        ("a page of 10^9", JSON, scene("a", "1000000000"), &[400, 422]),
        ("a page of 10^300", JSON, scene("a", "1e300"), &[400, 422]),
        ("an SVG of 10^9", SVG, br#"<svg xmlns="http://www.w3.org/2000/svg" width="1e9" height="1e9"/>"#.to_vec(), &[422]),
        ("parentheses", JSON, scene(&deep("(", ")"), "16"), &[200]),
        ("parentheses that do not close", JSON, scene(&deep("(", ""), "16"), &[400]),
        ("calls", JSON, scene(&deep("any(b,", ")"), "16"), &[200]),
        ("brackets", JSON, format!("{{\"width\":{}", "[".repeat(MANY)).into_bytes(), &[400]),
        ("keys", JSON, "{\"a\":".repeat(MANY).into_bytes(), &[400]),
        ("a scale", "?scale=1e9", scene("a", "16"), &[422]),
        ("a slice", "?lines=4294967295..4294967296", scene("a", "16"), &[400, 422]),
        ("signs in the query", "deep", scene("a", "16"), &[200]),
        ("an expression past its length", "long", scene("a", "16"), &[414, 422, 431]),
    ];
    let mut wrong = Vec::new();
    for (name, kind, document, allowed) in &cases {
        let (query, kind) = match *kind {
            "deep" => (format!("?expr={}a", "!".repeat(60_000)), JSON),
            "long" => (format!("?expr={}a", "!".repeat(100_000)), JSON),
            query if query.starts_with('?') => (query.to_owned(), JSON),
            kind => (String::new(), kind),
        };
        // The machine is shared: the best of three counts.
        let took = (0..3).map(|_| {
            let began = Instant::now();
            let head = format!("POST /v1/fill{query} HTTP/1.1\r\nHost: localhost\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n", document.len());
            let answer = exchange(&server, &[head.as_bytes(), document].concat());
            if !allowed.contains(&status(&answer)) {
                wrong.push(format!("{name}: {}", answer.chars().take(300).collect::<String>()));
            }
            began.elapsed()
        });
        let took = took.min().unwrap();
        eprintln!("{name}: {took:?}, {} KiB at most", server.status("VmHWM"));
        if took > slower() * Duration::from_millis(250) {
            wrong.push(format!("{name}: {took:?}"));
        }
    }
    let peak = server.status("VmHWM");
    assert!(wrong.is_empty() && peak < MEMORY, "{peak} KiB\n{}", wrong.join("\n"));
    assert_eq!(server.metric("runset_requests_total", "status=\"500\""), 0.0);
    server.fill("", JSON, SCENE).ok(200);
}

#[test]
fn requests_that_mean_harm() {
    let _alone = alone();
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--head-timeout", "1", "--body-timeout", "1", "--idle-timeout", "2", "--max-input", "4M"]);
    let post = format!("POST /v1/fill HTTP/1.1\r\nHost: localhost\r\nContent-Type: {JSON}\r\n");
    let timed = |name: &str, from: f64, to: f64, ask: &dyn Fn() -> String| {
        let began = Instant::now();
        let answer = ask();
        let took = began.elapsed();
        eprintln!("{name}: {} after {took:?}", status(&answer));
        assert!(took >= Duration::from_secs_f64(from) && took < slower() * Duration::from_secs_f64(to), "{name}: {took:?}");
        status(&answer)
    };
    let soon = |name: &str, request: String, allowed: &[u16]| {
        let status = timed(name, 0.0, 0.25, &|| exchange(&server, request.as_bytes()));
        assert!(allowed.contains(&status), "{name}: {status}");
    };
    let get = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n";
    soon("many headers", format!("{get}{}\r\n", (0..5000).map(|i| format!("x-{i}: 1\r\n")).collect::<String>()), &[431]);
    soon("a large header", format!("{get}x: {}\r\n\r\n", "x".repeat(1 << 20)), &[431]);
    soon("a long address", format!("GET /{} HTTP/1.1\r\nHost: localhost\r\n\r\n", "x".repeat(1 << 20)), &[414, 431]);
    soon("no HTTP", "\x16\x03\x01\x02\0\x01\0\x01\r\n\r\n".to_owned(), &[400]);
    soon("two lengths", format!("{post}Content-Length: 5\r\nContent-Length: 6\r\n\r\n{{}}"), &[400]);
    soon("chunks that are none", format!("{post}Transfer-Encoding: chunked\r\n\r\nnonsense\r\n"), &[400]);
    soon("a length past all", format!("{post}Content-Length: 99999999999999\r\n\r\n"), &[413]);
    soon("a length past all numbers", format!("{post}Content-Length: 99999999999999999999999\r\n\r\n"), &[400, 413]);
    soon("more than the length", format!("{post}Content-Length: 2\r\n\r\n{{}}{}", "}".repeat(1 << 16)), &[400]);

    // A head that comes too slowly, one that does not come, and an idle connection.
    let drip = |request: &str| {
        let mut stream = server.connect(1 << 16);
        for byte in request.bytes() {
            if stream.write_all(&[byte]).is_err() {
                break;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        ending(stream)
    };
    timed("a slow head", 0.9, 2.5, &|| drip(&format!("{get}x: {}", "x".repeat(200))));
    timed("no head", 0.9, 2.0, &|| ending(server.connect(1 << 16)));
    let status = timed("an idle connection", 1.9, 3.5, &|| exchange(&server, format!("{get}\r\n").as_bytes()));
    assert_eq!(status, 200);
    // Bodies that stop: at once, half way, in chunks.
    for (name, body) in [
        ("Content-Length: 100\r\n\r\n", ""),
        ("Content-Length: 100\r\n\r\n", "{ \"width\""),
        ("Transfer-Encoding: chunked\r\n\r\n", "5\r\n{ \"wi\r\n"),
    ] {
        let status = timed("a body that stops", 0.9, 2.5, &|| exchange(&server, format!("{post}{name}{body}").as_bytes()));
        assert_eq!(status, 408, "{name}");
    }
    // A body without end, from a client that listens only when it cannot send any more.
    let endless = || {
        let mut stream = server.connect(1 << 16);
        stream.write_all(format!("{post}Transfer-Encoding: chunked\r\n\r\n").as_bytes()).unwrap();
        let chunk = [&b"10000\r\n"[..], &[b' '; 1 << 16], b"\r\n"].concat();
        let mut sent = 0;
        while sent < (1 << 30) && stream.write_all(&chunk).is_ok() {
            sent += 1 << 16;
        }
        assert!(sent < 1 << 28, "it takes everything");
        ending(stream)
    };
    timed("a body without end", 0.0, 5.0, &endless);
    let long = || {
        let mut stream = server.connect(1 << 16);
        let body = " ".repeat(6 << 20);
        stream.write_all(format!("{post}Content-Length: {}\r\nConnection: close\r\n\r\n", body.len()).as_bytes()).unwrap();
        let _ = stream.write_all(body.as_bytes());
        ending(stream)
    };
    for _ in 0..5 {
        assert_eq!(timed("a body that is too long", 0.0, 2.0, &long), 413, "who sends before it listens gets the answer");
    }
    let peak = server.status("VmHWM");
    assert!(peak < MEMORY, "{peak} KiB");
    server.fill("", JSON, SCENE).ok(200);
    assert_eq!(server.metric("runset_connections_ended_total", "head"), 2.0);
}
