//! Models that are kept, and seen from anywhere.

use std::collections::HashSet;

use serde_json::json;
use sha2::{Digest as _, Sha256};

use crate::support::{CSG, Folder, JSON, MODEL, STL, Server, by_command_line, tetrahedron};

/// Sends a model to be kept.
fn put(server: &Server, kind: &str, document: impl AsRef<[u8]>) -> crate::support::Answer {
    server.ask("PUT", "/v1/models", &[("content-type", kind)], document.as_ref())
}

#[test]
fn a_model_is_read_once_and_seen_from_anywhere() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let made = put(&server, CSG, MODEL).ok(201);
    let model = made.json();
    let digest: String = Sha256::digest(MODEL).iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!((&model["id"], &model["parts"], &model["warnings"]), (&json!(digest), &json!(4), &json!([])));
    // Six sides and four, a cylinder of 24 and 2 sides, and a ball of 10 rings of 20 with 2 lids.
    assert_eq!(model["faces"], json!(6 + 6 + 26 + 9 * 20 + 2));
    let place = made.header("location").to_owned();
    assert_eq!(place, format!("/v1/models/{digest}"));
    let again = put(&server, CSG, MODEL).ok(200);
    assert_eq!((again.header("location"), again.json()), (&*place, model.clone()));
    assert_eq!(server.get(&place).ok(200).json(), model);
    assert_eq!(server.get("/v1/models").ok(200).json(), json!({ "models": [model] }));

    let mut tags = HashSet::new();
    for camera in ["", "0,0,0,55,0,25,60", "0,0,0,55,0,26,60", "9,8,7,0,0,0"] {
        for format in ["png", "ppm", "rls", "ndjson", "tiff"].iter().filter(|name| runset::encode::by_name(name).is_some()) {
            let mut options = vec!["--imgsize", "90,70", "--section", "1,0,0,3", "--lines", "5..60", "--format", format];
            let mut query = format!("?imgsize=90,70&section=1,0,0,3&lines=5..60&format={format}");
            if !camera.is_empty() {
                options.extend(["--camera", camera]);
                query += &format!("&camera={camera}");
            }
            let path = format!("{place}/view{query}");
            let view = server.get(&path).ok(200);
            assert!(view.body == by_command_line(MODEL.as_bytes(), &options), "{query}");
            let tag = view.header("etag").to_owned();
            assert!(tag.starts_with('"') && tags.insert(tag.clone()), "{query}: {tag}");
            let head = server.ask("HEAD", &path, &[], b"").ok(200);
            for name in ["etag", "content-type", "content-length"] {
                assert_eq!(head.header(name), view.header(name), "{query}: {name}");
            }
            for method in ["GET", "HEAD"] {
                let known = server.ask(method, &path, &[("if-none-match", &tag)], b"").ok(304);
                assert_eq!((known.header("etag"), known.body.len()), (&*tag, 0));
                server.ask(method, &path, &[("if-none-match", "\"another\"")], b"").ok(200);
            }
            server.ask("GET", &path, &[("if-match", "\"another\"")], b"").problem(412, "changed");
        }
    }
    // The same tags after a restart, whose service knows no model.
    let one = format!("{place}/view?imgsize=90,70&section=1,0,0,3&lines=5..60&format=png");
    server.kill();
    let server = Server::start(&folder.data(), &[]);
    let gone = server.get(&one).problem(404, "no-model");
    assert!(gone["detail"].as_str().unwrap().contains("PUT it again"), "{gone}");
    put(&server, CSG, MODEL).ok(201);
    assert!(tags.contains(server.get(&one).ok(200).header("etag")));

    assert_eq!(server.get(&format!("{place}/view")).ok(200).header("content-type"), "image/png");
    let accepted = server.ask("GET", &format!("{place}/view"), &[("accept", "application/x-ndjson")], b"").ok(200);
    assert_eq!(accepted.header("content-type"), "application/x-ndjson");
    server.ask("DELETE", &place, &[], b"").ok(204);
    server.ask("DELETE", &place, &[], b"").problem(404, "no-model");
    for path in [
        place.clone(),
        format!("{place}/view"),
        "/v1/models/none".to_owned(),
        "/v1/models/%ff/view".to_owned(),
        place.to_uppercase().replace("/V1/MODELS", "/v1/models"),
    ] {
        server.get(&path).problem(404, "no-model");
    }
    assert_eq!(server.get("/v1/models").ok(200).json(), json!({ "models": [] }));
    put(&server, CSG, MODEL).ok(201);
}

#[test]
fn what_is_wrong_with_a_kept_model_is_told_in_one_form() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--max-pixels", "1000000"]);
    let place = put(&server, STL, tetrahedron()).ok(201).header("location").to_owned();
    let bounds = server.get(&place).ok(200).json()["bounds"].clone();
    assert_eq!(bounds, json!([[0.0, 0.0, 0.0], [4.0, 4.0, 4.0]]));
    for query in ["?camera=1", "?section=0,0,0,1", "?nothing=1", "?kind=solid", "?format=bmp", "?lines=x"] {
        for method in ["GET", "HEAD"] {
            let answer = server.ask(method, &format!("{place}/view{query}"), &[], b"");
            assert_eq!(answer.status, 400, "{method} {query}");
        }
        server.get(&format!("{place}/view{query}")).problem(400, "malformed");
    }
    for method in ["GET", "HEAD"] {
        assert_eq!(server.ask(method, &format!("{place}/view?imgsize=1001,1000"), &[], b"").status, 422);
        assert_eq!(server.ask(method, &format!("{place}/view?lines=5..600"), &[], b"").status, 422);
        assert_eq!(server.ask(method, &format!("{place}/view"), &[("accept", "text/html")], b"").status, 406);
    }
    let problem = put(&server, CSG, "union() {\n  cube(size = [1, 1\n}").problem(400, "malformed");
    assert_eq!(problem["line"], 3, "{problem}");
    put(&server, CSG, "import(file = \"a.stl\");").problem(422, "refused");
    put(&server, JSON, "{}").problem(415, "unsupported-media-type");
    put(&server, CSG, "").problem(400, "malformed");
    server.ask("PUT", "/v1/models?imgsize=5,5", &[("content-type", CSG)], b"cube();").problem(400, "malformed");
    server.get("/v1/models?all").problem(400, "malformed");
    server.ask("POST", "/v1/models", &[("content-type", CSG)], b"cube();").problem(405, "method-not-allowed");
    assert_eq!(server.get("/v1/models").ok(200).json()["models"].as_array().unwrap().len(), 1);
    let warned = put(&server, CSG, "text(\"a\");").ok(201);
    assert!(warned.json()["warnings"][0].as_str().unwrap().contains("text"));
    let view = server.get(&format!("{}/view", warned.header("location"))).ok(200);
    assert!(view.header("runset-warning").contains("text"), "{:?}", view.headers);
}

#[test]
fn what_was_asked_for_longest_ago_makes_room() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--max-models", "200k"]);
    // 64 KiB each, about.
    let model = |n: u32| format!("cube(size = {n});");
    let id = |n: u32| put(&server, CSG, model(n)).ok(201).header("location").to_owned();
    let places = [id(1), id(2), id(3)];
    server.get(&format!("{}/view?imgsize=9,9", places[0])).ok(200);
    let fourth = id(4);
    server.get(&format!("{}/view", places[1])).problem(404, "no-model");
    let kept: Vec<String> = server.get("/v1/models").ok(200).json()["models"]
        .as_array()
        .unwrap()
        .iter()
        .map(|model| format!("/v1/models/{}", model["id"].as_str().unwrap()))
        .collect();
    assert_eq!(kept, [&fourth, &places[0], &places[2]].map(String::clone));
    let large = put(&server, CSG, "sphere(r = 1, $fn = 200);").problem(422, "limit");
    assert!(large["detail"].as_str().unwrap().contains("--max-models"), "{large}");
    assert_eq!(server.get("/v1/models").ok(200).json()["models"].as_array().unwrap().len(), 3, "what does not fit moves nothing");
    assert!(server.metric("runset_models_bytes", "") > 190_000.0);
}

#[test]
fn twenty_at_once_keep_one_model() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let answers: Vec<_> = std::thread::scope(|scope| {
        let all: Vec<_> = (0..20).map(|_| scope.spawn(|| put(&server, CSG, MODEL))).collect();
        all.into_iter().map(|one| one.join().unwrap()).collect()
    });
    assert_eq!(answers.iter().filter(|answer| answer.status == 201).count(), 1);
    assert!(answers.iter().all(|answer| [200, 201].contains(&answer.status) && answer.body == answers[0].body));
}
