//! A service that is killed at any moment loses nothing that it has accepted.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::support::{Folder, MODEL, RUNSET, Rng, Server, art, by_command_line, effort, ids, triangle};

/// Documents with what is asked of them.
fn works() -> Vec<(Vec<u8>, &'static str, Vec<&'static str>)> {
    vec![
        (art("poster.svg"), "?width=600&format=png", vec!["--width", "600", "--format", "png"]),
        (art("poster.svg"), "?width=300&format=ndjson", vec!["--width", "300", "--format", "ndjson"]),
        (MODEL.into(), "?kind=solid&imgsize=300,200", vec!["--imgsize", "300,200"]),
        (triangle(3000, 4000).into_bytes(), "?format=rls", vec!["--format", "rls"]),
        (triangle(9000, 4000).into_bytes(), "?format=pbm", vec!["--format", "pbm"]),
    ]
}

#[test]
fn killed_at_any_moment() {
    let folder = Folder::new();
    let works = works();
    let right: Vec<_> = works.iter().map(|(document, _, options)| by_command_line(document, options)).collect();
    let mut rng = Rng(9);
    let accepted: Mutex<Vec<(String, usize)>> = Mutex::default();
    for round in 0..effort(10) {
        let server = Server::start(&folder.data(), &[]);
        let known = accepted.lock().unwrap().clone();
        let there = ids(&server);
        for (job, _) in &known {
            assert!(there.iter().any(|id| job.ends_with(id)), "round {round}: {job} is lost");
        }
        // A document a job; what was sent but not answered may be there or not.
        assert_eq!(folder.documents(), there, "round {round}");
        for _ in 0..3 {
            let Some((job, work)) = (!known.is_empty()).then(|| &known[rng.below(known.len() as u64) as usize]) else { break };
            assert!(server.get(&format!("{job}/raster")).ok(200).body == right[*work], "round {round}: {job}");
        }
        // Some make jobs, some read; then the service is gone.
        let (stop, life) = (AtomicBool::new(false), Duration::from_millis(rng.below(400)));
        std::thread::scope(|scope| {
            for client in 0..4_u64 {
                let (server, stop, accepted, works) = (&server, &stop, &accepted, &works);
                let mut rng = Rng(round * 10 + client);
                scope.spawn(move || {
                    while !stop.load(Ordering::Relaxed) {
                        let work = rng.below(works.len() as u64) as usize;
                        let (document, query, _) = &works[work];
                        if client < 2 {
                            // An error: the service has gone.
                            let Ok(job) = post(server, query, document) else { break };
                            accepted.lock().unwrap().push((job, work));
                        } else {
                            let jobs = accepted.lock().unwrap().clone();
                            let Some((job, _)) = (!jobs.is_empty()).then(|| &jobs[rng.below(jobs.len() as u64) as usize]) else { continue };
                            let _ = ureq::get(server.url(&format!("{job}/raster"))).call().map(|r| r.into_body().read_to_vec());
                        }
                    }
                });
            }
            std::thread::sleep(life);
            server.signal("KILL");
            stop.store(true, Ordering::Relaxed);
        });
        server.kill();
    }
    let server = Server::start(&folder.data(), &[]);
    let accepted = accepted.into_inner().unwrap();
    assert!(accepted.len() as u64 > effort(10), "{RUNSET} accepted {} jobs", accepted.len());
    assert_eq!(folder.documents(), ids(&server));
    for (job, work) in &accepted {
        assert!(server.get(&format!("{job}/raster")).ok(200).body == right[*work], "{job}");
        assert_eq!(server.get(job).json()["state"], "done");
    }
}

fn post(server: &Server, query: &str, document: &[u8]) -> Result<String, ureq::Error> {
    let kind = if document.starts_with(b"{") { "application/json" } else { "image/svg+xml" };
    let answer = ureq::post(server.url(&format!("/v1/jobs{query}"))).content_type(kind).send(document)?;
    assert_eq!(answer.status(), 201);
    Ok(answer.headers()["location"].to_str().unwrap().to_owned())
}
