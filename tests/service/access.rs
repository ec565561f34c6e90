//! Who may ask, and from where.

use std::process::Stdio;

use crate::support::{Folder, JSON, RUNSET, SCENE, Server, command, exchange, header};

const TOKEN: &str = "correct-horse";

#[test]
fn a_token_that_is_asked_for() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--token", TOKEN]);
    let with = |value: &str| server.ask("GET", "/v1/jobs", &[("authorization", value)], b"");
    let none = server.get("/v1/jobs");
    none.problem(401, "unauthorized");
    assert!(none.header("www-authenticate").starts_with("Bearer"));
    for wrong in ["Bearer", "Bearer ", "Bearer wrong", "Basic correct-horse", &format!("Bearer {TOKEN}x"), TOKEN] {
        with(wrong).problem(401, "unauthorized");
    }
    for (method, path) in
        [("POST", "/v1/fill"), ("POST", "/v1/jobs"), ("DELETE", "/v1/jobs/x"), ("GET", "/v1/nothing"), ("PUT", "/v1/fill")]
    {
        server.ask(method, path, &[("content-type", JSON)], SCENE.as_bytes()).problem(401, "unauthorized");
    }
    with(&format!("Bearer {TOKEN}")).ok(200);
    with(&format!("bearer {TOKEN}")).ok(200);
    for open in ["/healthz", "/readyz", "/metrics", "/openapi.json"] {
        server.get(open).ok(200);
    }
    assert!(!server.said().contains(TOKEN), "it stays out of the log");
}

#[test]
fn others_are_served_only_with_a_token() {
    let folder = Folder::new();
    let refused = |options: &[&str], what: &str| {
        let output = command(&folder.data(), options).stderr(Stdio::piped()).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), said.lines().count()), (Some(2), 1), "{said}");
        assert!(said.contains(what), "{said}");
    };
    // The last address given counts nothing: each may be given once.
    for addr in ["0.0.0.0:0", "[::]:0"] {
        let output = std::process::Command::new(RUNSET)
            .args(["serve", "--addr", addr, "--data"])
            .arg(folder.data())
            .env_remove("RUNSET_TOKEN")
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(
            (output.status.code(), said.lines().count(), said.contains("give a token in RUNSET_TOKEN")),
            (Some(2), 1, true),
            "{said}"
        );
    }
    assert!(!folder.data().exists(), "nothing is made before the arguments are right");
    refused(&["--token", "short"], "8 to 1024");
    refused(&["--allow-origin", "*"], "give a scheme");
    // With one it starts, and takes any name for its own.
    let mut started = std::process::Command::new(RUNSET);
    started.args(["serve", "--addr", "0.0.0.0:0", "--data"]).arg(folder.data()).env("RUNSET_TOKEN", TOKEN);
    let server = Server::run(started, &folder.data());
    let request = |token: &str| {
        format!("GET /v1/jobs HTTP/1.1\r\nHost: plotter.example:80\r\nAuthorization: Bearer {token}\r\nConnection: close\r\n\r\n")
    };
    assert!(exchange(&server, request(TOKEN).as_bytes()).starts_with("HTTP/1.1 200 "));
    assert!(exchange(&server, request("another-token").as_bytes()).starts_with("HTTP/1.1 401 "));
}

#[test]
fn on_loopback_only_this_machine_is_answered() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let status = |host: &str, more: &str| {
        let answer = exchange(&server, format!("GET /v1/jobs HTTP/1.1\r\n{host}{more}Connection: close\r\n\r\n").as_bytes());
        answer.split(' ').nth(1).unwrap_or_default().to_owned()
    };
    for host in ["localhost", "LOCALHOST:1234", "127.0.0.1:8080", "127.1.2.3", "[::1]:80"] {
        assert_eq!(status(&format!("Host: {host}\r\n"), ""), "200", "{host}");
    }
    for host in ["example.org", "localhost.example.org", "127.0.0.1.example.org", "10.0.0.1", "[::2]", ""] {
        assert_eq!(status(&format!("Host: {host}\r\n"), ""), "403", "{host}");
    }
    assert_eq!(status("", ""), "403", "no host");
    let local = "Host: localhost\r\n";
    for (origin, expected) in
        [("http://localhost:3000", "200"), ("http://127.0.0.1", "200"), ("https://example.org", "403"), ("null", "403")]
    {
        assert_eq!(status(local, &format!("Origin: {origin}\r\n")), expected, "{origin}");
    }
    let problem = server.ask("GET", "/healthz", &[("origin", "https://example.org")], b"");
    problem.problem(403, "forbidden");
}

#[test]
fn pages_of_named_origins() {
    let folder = Folder::new();
    let (ours, theirs) = ("https://plots.example", "https://example.org");
    let server = Server::start(&folder.data(), &["--allow-origin", ours]);
    let preflight = |origin: &str| {
        let fields =
            [("origin", origin), ("access-control-request-method", "POST"), ("access-control-request-headers", "content-type,range")];
        server.ask("OPTIONS", "/v1/fill", &fields, b"")
    };
    let answer = preflight(ours).ok(200);
    assert_eq!(answer.header("access-control-allow-origin"), ours);
    for (name, value) in [
        ("access-control-allow-methods", "POST"),
        ("access-control-allow-headers", "range"),
        ("access-control-allow-headers", "idempotency-key"),
    ] {
        assert!(answer.header(name).to_ascii_lowercase().contains(&value.to_ascii_lowercase()), "{name}: {:?}", answer.header(name));
    }
    assert_eq!(preflight(theirs).header("access-control-allow-origin"), "");
    let filled = server.ask("POST", "/v1/fill", &[("origin", ours), ("content-type", JSON)], SCENE.as_bytes()).ok(200);
    assert_eq!(filled.header("access-control-allow-origin"), ours);
    assert!(filled.header("access-control-expose-headers").contains("etag"));
    server.ask("POST", "/v1/fill", &[("origin", theirs), ("content-type", JSON)], SCENE.as_bytes()).problem(403, "forbidden");

    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let answer = server.open("OPTIONS", "/v1/fill", &[("origin", "http://localhost:1"), ("access-control-request-method", "POST")], b"");
    assert_eq!(
        (answer.status().as_u16(), header(answer.headers(), "access-control-allow-origin")),
        (405, ""),
        "off where no origin is named"
    );
}
