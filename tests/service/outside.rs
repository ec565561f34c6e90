//! Clients and readers of the description that are not ours: curl, wget, schemathesis, openapi-spec-validator.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::support::{Folder, RUNSET, SCENE, Server, art, effort, have, tool, triangle, wait_until};

/// A download that stops with the service, and goes on with the next: `begin` and `resume` are the client's arguments before the address.
fn goes_on(client: &str, begin: &[&str], resume: &[&str]) {
    if !have(client, "a download that goes on") {
        return;
    }
    let folder = Folder::new();
    let (to, document) = (folder.file("out"), folder.file("in"));
    // 500 MB at full effort.
    let height = 6250 * effort(1).min(10) as u32;
    let length = 8000 * u64::from(height);
    std::fs::write(&document, triangle(64_000, height)).unwrap();
    let server = Server::start(&folder.data(), &[]);
    let job = server.job("?format=pbm", triangle(64_000, height));
    let run = |server: &Server, arguments: &[&str]| {
        let mut command = Command::new(tool(client));
        command.args(arguments).arg(&to).arg(server.url(&format!("{job}/raster"))).stdout(Stdio::null()).stderr(Stdio::null());
        command.spawn().unwrap()
    };
    let mut broken = run(&server, begin);
    wait_until("half of it has come", || std::fs::metadata(&to).is_ok_and(|file| file.len() > length / 3));
    server.kill();
    assert!(!broken.wait().unwrap().success(), "a download that is cut has failed");
    let had = std::fs::metadata(&to).unwrap().len();
    assert!(had < length, "the whole has come before the service ended");
    let server = Server::start(&folder.data(), &[]);
    assert!(run(&server, resume).wait().unwrap().success(), "{}", server.said());
    let sent = server.metric("runset_bytes_total", "");
    assert!(sent < (length - had) as f64 + 1e5, "{sent} bytes sent for the rest of {length} behind {had}");
    let same = Command::new("bash")
        .args(["-c", "\"$0\" fill \"$1\" --format pbm --progress never | cmp - \"$2\"", RUNSET])
        .args([&document, &to])
        .output();
    assert!(same.unwrap().status.success(), "it is not the command line's raster");
}

#[test]
fn curl_goes_on() {
    let slow = format!("{}M", 20 * effort(1).min(10));
    goes_on("curl", &["-sS", "--noproxy", "*", "--limit-rate", &slow, "-o"], &["-sS", "--noproxy", "*", "-C", "-", "-o"]);
}

#[test]
fn wget_goes_on() {
    let slow = format!("--limit-rate={}M", 20 * effort(1).min(10));
    goes_on("wget", &["--no-proxy", "--tries=1", &slow, "-O"], &["--no-proxy", "--tries=1", "-c", "-O"]);
}

#[test]
fn the_description_is_valid() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let described = server.get("/openapi.json").ok(200);
    let api = described.json();
    assert!(api["openapi"].as_str().unwrap().starts_with("3.1."));
    for path in [
        "/v1/fill",
        "/v1/solid",
        "/v1/jobs",
        "/v1/jobs/{id}",
        "/v1/jobs/{id}/raster",
        "/v1/jobs/{id}/events",
        "/v1/jobs/{id}/print",
        "/v1/printers",
        "/healthz",
        "/readyz",
        "/metrics",
    ] {
        assert!(api["paths"][path].is_object(), "{path}");
    }
    if have("openapi-spec-validator", "the description read by others") {
        std::fs::write(folder.file("openapi.json"), &described.body).unwrap();
        let output = Command::new(tool("openapi-spec-validator")).arg(folder.file("openapi.json")).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    }
}

#[test]
fn the_description_holds() {
    if !have("schemathesis", "the description held against the service") {
        return;
    }
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--max-pixels", "1000000"]);
    for (query, document) in [("?format=png&width=50", art("poster.svg")), ("", SCENE.into())] {
        let job = server.job(query, document);
        // The events of what is done come to an end.
        server.get(&format!("{job}/raster")).ok(200);
    }
    // A query can be too long to be looked at.
    let refusals = "[checks.negative_data_rejection]\nexpected-statuses = [\"4xx\", \"5xx\"]\n";
    std::fs::write(folder.file("schemathesis.toml"), refusals).unwrap();
    let examples = (20 * effort(1)).to_string();
    let checks = "not_a_server_error,status_code_conformance,content_type_conformance,response_schema_conformance,response_headers_conformance,negative_data_rejection";
    let output = Command::new(tool("schemathesis"))
        .args(["run", &server.url("/openapi.json"), "--checks", checks, "--max-examples", &examples, "--seed", "7", "--workers", "1"])
        .current_dir(Path::new(&folder.file("")))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    assert_eq!(server.metric("runset_requests_total", "status=\"500\""), 0.0);
    server.get("/readyz").ok(200);
}
