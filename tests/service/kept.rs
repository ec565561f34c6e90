//! The list of jobs, and which of them go when there are too many.

use std::time::Duration;

use crate::support::{Folder, SCENE, Server, ids, triangle, wait_until};

#[test]
fn the_list_has_pages() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &[]);
    let made: Vec<String> = (0..25).map(|_| server.job("", SCENE)).collect();
    for limit in [1, 7, 25, 1000] {
        let (mut all, mut after, mut pages) = (Vec::new(), String::new(), 0);
        loop {
            let page = server.get(&format!("/v1/jobs?limit={limit}{after}")).ok(200).json();
            let jobs = page["jobs"].as_array().unwrap();
            assert!(jobs.len() <= limit);
            all.extend(jobs.iter().map(|job| format!("/v1/jobs/{}", job["id"].as_str().unwrap())));
            pages += 1;
            let Some(next) = page["next"].as_str() else { break };
            after = format!("&after={next}");
        }
        assert_eq!((&all, pages), (&made, 25_usize.div_ceil(limit)), "oldest first");
    }
    let page = server.get("/v1/jobs?after=zzz").ok(200).json();
    assert_eq!(page, serde_json::json!({ "jobs": [], "next": null }));
    let job = server.get(&made[0]).json();
    for (field, value) in [("kind", "fill"), ("state", "ready"), ("format", "ndjson")] {
        assert_eq!(job[field], value);
    }
    assert_eq!((&job["width"], &job["height"], &job["lines"], &job["lines_delivered"]), (&16.into(), &10.into(), &10.into(), &0.into()));
}

#[test]
fn what_is_done_goes_first() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--max-jobs", "3"]);
    let id = |job: &String| job.rsplit('/').next().unwrap().to_owned();
    let made: Vec<String> = (0..3).map(|_| server.job("", SCENE)).collect();
    server.post_job("", &[], SCENE).problem(507, "store-full");
    assert_eq!(ids(&server), made.iter().map(id).collect::<Vec<_>>(), "none that is not done goes");
    assert_eq!(folder.documents(), ids(&server));
    server.get(&format!("{}/raster", made[1])).ok(200);
    let further = server.job("", SCENE);
    assert_eq!(ids(&server), [&made[0], &made[2], &further].map(id));
    server.get(&made[1]).problem(404, "no-job");
    server.ask("DELETE", &made[0], &[], b"").ok(204);
    server.job("", SCENE);
    server.post_job("", &[], SCENE).problem(507, "store-full");
    assert_eq!(folder.documents(), ids(&server));
    // One that is being read stays, done or not.
    drop(server);
    let server = Server::start(&folder.data(), &["--max-jobs", "4"]);
    let large = server.job("?format=pbm", triangle(20_000, 20_000));
    server.get(&format!("{large}/raster")).ok(200);
    let mut reader = server.open("GET", &format!("{large}/raster"), &[], b"").into_body().into_reader();
    server.post_job("", &[], SCENE).problem(507, "store-full");
    std::io::copy(&mut reader, &mut std::io::sink()).unwrap();
    drop(reader);
    wait_until("its reader has gone", || server.post_job("", &[], SCENE).status == 201);
    server.get(&large).problem(404, "no-job");
}

#[test]
fn documents_have_room() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--max-store", "2k"]);
    let large = format!("{SCENE}{}", " ".repeat(900));
    let done = server.job("", &large);
    let larger = large + &" ".repeat(900);
    server.post_job("", &[], &larger).problem(507, "store-full");
    server.get(&format!("{done}/raster")).ok(200);
    let kept = server.job("", &larger);
    server.get(&done).problem(404, "no-job");
    server.post_job("", &[], larger + &" ".repeat(900)).problem(507, "store-full");
    assert_eq!(ids(&server), [kept.rsplit('/').next().unwrap()], "what is larger than the store moves nothing that is not done");
    assert_eq!(folder.documents(), ids(&server));
}

#[test]
fn what_nobody_uses_is_forgotten() {
    let folder = Folder::new();
    let server = Server::start(&folder.data(), &["--keep", "1"]);
    let old = server.job("", SCENE);
    std::thread::sleep(Duration::from_millis(1100));
    let new = server.job("", SCENE);
    server.get(&old).problem(404, "no-job");
    server.get(&new).ok(200);
    assert_eq!(folder.documents(), ids(&server));
}
