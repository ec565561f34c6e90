//! The gallery of `tests/svg`: every file against resvg, in area and in colour, and every id against a document in which only that element
//! is painted.
//!
//! A file is a test. Those that `waiting.txt` lists are expected to fail and are told with the reason; one that passes must leave the list.
//! A file may say `<!-- not flat: why -->`: its colours are not compared. The worst file is printed at the end.

#![allow(clippy::unwrap_used)] // all of this is tests

mod only;
mod picture;

use std::collections::HashMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use libtest_mimic::{Arguments, Failed, Trial};
use usvg::roxmltree::Document;

use self::picture::{Picture, difference};

/// Scales at which the areas are compared; with the last the others are, too.
const SCALES: [f64; 3] = [1.0, 2.7, 8.0];

/// The file that differed most so far: pixels that differ, their share of the page, and where.
type Worst = Arc<Mutex<(usize, String)>>;

fn main() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/svg");
    let mut files: Vec<PathBuf> = fs::read_dir(&folder).expect("the folder is there").map(|e| e.expect("readable").path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "svg" || e == "svgz"));
    files.sort();
    assert!(files.len() >= 120, "{} files", files.len());
    let mut waiting = waiting(&folder);
    let worst = Worst::default();
    let trials = files.into_iter().map(|file| {
        let name = file.file_stem().expect("a file").to_string_lossy().into_owned();
        let (why, worst) = (waiting.remove(&name), worst.clone());
        Trial::test(name.clone(), move || judge(&name, &check(&name, &file, &worst), why.as_deref()))
    });
    let trials = trials.collect();
    assert!(waiting.is_empty(), "waiting.txt names files that are not there: {waiting:?}");
    let conclusion = libtest_mimic::run(&Arguments::from_args(), trials);
    println!("the worst: {}", worst.lock().unwrap().1);
    conclusion.exit();
}

/// The files that are expected to fail, with what they wait for.
fn waiting(folder: &Path) -> HashMap<String, String> {
    let text = fs::read_to_string(folder.join("waiting.txt")).unwrap_or_default();
    let lines = text.lines().filter(|l| !l.is_empty() && !l.starts_with('#'));
    lines.map(|l| l.split_once(": ").expect("a line is `file: what it waits for`")).map(|(f, w)| (f.to_owned(), w.to_owned())).collect()
}

fn judge(name: &str, failures: &[String], waits_for: Option<&str>) -> Result<(), Failed> {
    match (failures, waits_for) {
        ([], None) => Ok(()),
        ([], Some(why)) => Err(format!("{name} passes, although it waits for {why}: take it off tests/svg/waiting.txt").into()),
        (_, None) => Err(failures.join("\n").into()),
        (_, Some(why)) => {
            println!("{name} waits for {why}: {}", failures.join("; "));
            Ok(())
        }
    }
}

/// Everything that is wrong with a file.
fn check(name: &str, file: &Path, worst: &Worst) -> Vec<String> {
    let bytes = fs::read(file).unwrap();
    let text = plain(&bytes);
    let mut failures = Vec::new();
    let compare = |ours: &Picture, theirs: &Picture, what: &str, failures: &mut Vec<String>| match difference(ours, theirs) {
        Ok(pixels) => {
            let mut worst = worst.lock().unwrap();
            if pixels > worst.0 {
                let (w, h) = (ours.width, ours.height);
                *worst = (pixels, format!("{name}, {what}: {pixels} of {} pixels differ, all at outlines", w as usize * h as usize));
            }
        }
        Err((x, y)) => failures.push(format!("{what}: pixel {x}, {y} differs from resvg's away from any outline")),
    };
    let scale = SCALES[SCALES.len() - 1];
    let library = match picture::Library::read(&text) {
        Ok(tree) => tree,
        Err(error) => return vec![format!("resvg refuses it: {error}")],
    };
    let foreign = library.picture(scale);
    if foreign.is_blank() {
        failures.push("resvg paints nothing".to_owned());
    }
    for s in SCALES {
        match picture::ours(&bytes, Some("art"), s) {
            Ok(ours) => compare(&ours, &library.picture(s).area(), &format!("art at {s}"), &mut failures),
            Err(e) => return vec![e],
        }
    }
    if !text.contains("<!-- not flat: ") {
        match picture::ours(&bytes, None, scale) {
            Ok(ours) => compare(&ours, &foreign, "colours", &mut failures),
            Err(e) => failures.push(e),
        }
    }
    ids(&text, scale, &compare, &mut failures);
    failures
}

/// Compares two pictures of what the text names and notes what differs.
type Compare<'a> = &'a dyn Fn(&Picture, &Picture, &str, &mut Vec<String>);

/// Compares every id with what remains of the document when nothing else is painted.
fn ids(text: &str, scale: f64, compare: Compare<'_>, failures: &mut Vec<String>) {
    let xml = Document::parse_with_options(text, only::options()).unwrap();
    let expected = only::ids(&xml);
    let found = picture::names(text);
    if found != expected {
        failures.push(format!("its ids are {found:?}, not {expected:?}"));
    }
    for id in expected {
        let alone = only::painted(&xml, &id);
        let quoted = format!("\"{}\"", id.replace('\\', "\\\\").replace('"', "\\\""));
        let foreign = match picture::Library::read(&alone) {
            Ok(library) => library.picture(scale).area(),
            Err(e) => {
                failures.push(format!("id {id}: resvg refuses what remains: {e}"));
                continue;
            }
        };
        match (picture::ours(text.as_bytes(), Some(&quoted), scale), picture::ours(alone.as_bytes(), Some("art"), scale)) {
            (Ok(ours), Ok(art)) => {
                if ours != art {
                    failures.push(format!("id {id}: it is not the picture of the element painted alone"));
                }
                compare(&ours, &foreign, &format!("id {id}"), failures);
            }
            (Err(e), _) | (_, Err(e)) => failures.push(format!("id {id}: {e}")),
        }
    }
}

/// The text of a document, decompressed.
fn plain(bytes: &[u8]) -> String {
    let mut text = String::new();
    if bytes.starts_with(b"\x1f\x8b") {
        flate2::read::GzDecoder::new(bytes).read_to_string(&mut text).unwrap();
    } else {
        text.push_str(std::str::from_utf8(bytes).unwrap());
    }
    text
}
