//! Requests that are sent again under their key.

use crate::support::{Folder, SCENE, Server, empty, ids};

#[test]
fn a_key_names_one_job() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let key = [("idempotency-key", "order 66")];
    let first = server.post_job("?format=pbm", &key, SCENE).ok(201);
    assert_eq!(first.header("idempotent-replayed"), "");
    let again = server.post_job("?format=pbm", &key, SCENE).ok(201);
    assert_eq!((again.header("location"), again.header("idempotent-replayed")), (first.header("location"), "true"));
    for (query, document) in [("?format=png", SCENE), ("?format=pbm&scale=2", SCENE), ("?format=pbm", &empty(5, 5))] {
        server.post_job(query, &key, document).problem(422, "key-reused");
    }
    for bad in ["", "\u{e9}", &"k".repeat(256)] {
        server.post_job("", &[("idempotency-key", bad)], SCENE).problem(400, "malformed");
    }
    server.kill();
    let server = Server::start(&folder.data(), &[]);
    let again = server.post_job("?format=pbm", &key, SCENE).ok(201);
    assert_eq!((again.header("location"), again.header("idempotent-replayed")), (first.header("location"), "true"));
    server.post_job("?format=png", &key, SCENE).problem(422, "key-reused");
    assert_eq!((ids(&server).len(), folder.documents()), (1, ids(&server)));
    // A job that is deleted frees its key.
    server.ask("DELETE", first.header("location"), &[], b"").ok(204);
    assert_ne!(server.post_job("?format=png", &key, SCENE).ok(201).header("location"), first.header("location"));
}

#[test]
fn twenty_at_once_make_one_job() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let places: Vec<String> = std::thread::scope(|scope| {
        let ask = || server.post_job("", &[("idempotency-key", "one")], SCENE).ok(201).header("location").to_owned();
        let all: Vec<_> = (0..20).map(|_| scope.spawn(ask)).collect();
        all.into_iter().map(|one| one.join().unwrap()).collect()
    });
    assert!(places.iter().all(|place| *place == places[0]), "{places:?}");
    assert_eq!((ids(&server).len(), folder.documents()), (1, ids(&server)));
}

#[test]
fn a_key_is_looked_up_before_room_is_made() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--max-jobs", "1"]);
    let key = [("idempotency-key", "one")];
    let first = server.post_job("", &key, SCENE).ok(201);
    let again = server.post_job("", &key, SCENE).ok(201);
    assert_eq!(again.header("location"), first.header("location"), "while it is not done, and the store is full");
    server.get(&format!("{}/raster", first.header("location"))).ok(200);
    let again = server.post_job("", &key, SCENE).ok(201);
    assert_eq!(again.header("location"), first.header("location"), "when it is done, and the first to be forgotten");
}
