//! Long outlines are read by other means than short ones: the gallery's files with path data made long by spaces are what they were.

#![allow(clippy::unwrap_used)] // all of this is tests

use std::fs;
use std::path::Path;

use runset::encode;
use runset::job::{Info, Job, More, Options, Size, info};
use runset::scene::{Limits, Scene};

/// What is seen of a document: its ids, its warnings without their places, its picture, and each id's area.
fn seen(text: &str, threads: usize) -> Result<(Info, Vec<String>, Vec<Vec<u8>>), String> {
    let options = Options { size: Size::Scale(2.7), limits: Limits { threads, ..Limits::default() }, ..Options::default() };
    let mut warnings = Vec::new();
    let scene = runset::input::read(text.as_bytes().to_vec(), &options.limits, &mut warnings).map_err(|e| e.what)?;
    let info = info(&scene).unwrap();
    let quoted = |id: &str| format!("\"{}\"", id.replace('\\', "\\\\").replace('"', "\\\""));
    let areas: Vec<_> = info.ids.iter().map(|entry| raster(scene.clone(), Some(quoted(&entry.id)), &options)).collect();
    let pictures = std::iter::once(raster(scene, None, &options)).chain(areas).collect();
    Ok((info, warnings.into_iter().map(|w| w.what).collect(), pictures))
}

fn raster(scene: Scene, expr: Option<String>, options: &Options) -> Vec<u8> {
    let job = Job::prepare(scene, &Options { expr, ..options.clone() }, &mut Vec::new()).unwrap();
    let (mut stream, mut bytes) = (job.stream(encode::by_name("ndjson").unwrap()), Vec::new());
    while stream.next_band(&mut bytes) == More::More {}
    bytes
}

#[test]
fn outlines_made_long_by_spaces_are_what_they_were() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/svg");
    let (mut files, mut paths) = (0, 0);
    for entry in fs::read_dir(folder).unwrap() {
        let file = entry.unwrap().path();
        let Some(text) = fs::read_to_string(&file).ok().filter(|_| file.extension().is_some_and(|e| e == "svg")) else { continue };
        let some = text.matches(" d=\"").count() + text.matches(" d='").count();
        if some == 0 {
            continue;
        }
        // Enough for threads; with markers, which keep outlines as they are, length counts against a limit.
        let spaces = " ".repeat(if text.contains("<marker") { 2_000 } else { 150_000 });
        let long = text.replace(" d=\"", &format!(" d=\"{spaces}")).replace(" d='", &format!(" d='{spaces}"));
        let short = seen(&text, 1);
        for threads in [1, 3] {
            let long = seen(&long, threads);
            let name = file.display();
            match (&short, &long) {
                (Ok(short), Ok(long)) => {
                    assert_eq!(short.0, long.0, "{name}");
                    assert_eq!(short.1, long.1, "{name}");
                    assert!(short.2 == long.2, "{name}");
                }
                (short, long) => assert_eq!(short.as_ref().err(), long.as_ref().err(), "{name}"),
            }
        }
        (files, paths) = (files + 1, paths + some);
    }
    assert!(files > 70 && paths > 140, "{files} files, {paths} paths");
}
