//! Imports point down only: every `use crate::` and every `crate::` path of a file names a floor below its own, or its own folder.

use std::fs;
use std::path::{Path, PathBuf};

/// From the top down, as ARCHITECTURE.md draws them. Modules of one floor do not import each other, except those after `|`, which stand
/// in the order of their use.
const FLOORS: &[&[&str]] = &[
    &["main", "cli"],
    &["service"],
    &["print"],
    &["job"],
    &["region", "solid", "input", "encode"],
    &["edge", "mesh"],
    &["scene"],
    &["sweep", "shape"],
    &["grid", "line", "count", "bits", "bounds", "run", "checksum", "error", "spread"],
];

/// Pairs on the ground floor that may import each other in this direction.
const WITHIN_GROUND: &[(&str, &str)] = &[("line", "grid"), ("count", "bits"), ("bounds", "count"), ("checksum", "run")];

fn floor(module: &str) -> usize {
    FLOORS.iter().position(|floor| floor.contains(&module)).unwrap_or_else(|| panic!("src/{module} stands on no floor: add it to FLOORS"))
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found
}

/// The modules that a source text names behind `crate::` or, in the binary, behind `runset::`.
fn imports(text: &str) -> Vec<String> {
    let code = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
    let mut found = Vec::new();
    for prefix in ["crate::", "runset::"] {
        for (at, _) in code.match_indices(prefix) {
            let rest = &code[at + prefix.len()..];
            let group = rest.strip_prefix('{').map(|inner| &inner[..inner.find('}').unwrap_or(inner.len())]);
            let names: Vec<&str> = group.map_or_else(|| vec![rest], |group| group.split(',').map(str::trim).collect());
            let word = |s: &str| s.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
            found.extend(names.into_iter().map(word));
        }
    }
    found
}

#[test]
fn imports_point_down() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut seen = 0;
    let mut wrong = Vec::new();
    for file in files(&src) {
        let inside = file.strip_prefix(&src).unwrap();
        let module = inside.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs");
        if module == "lib" {
            continue;
        }
        for import in imports(&fs::read_to_string(&file).unwrap()) {
            seen += 1;
            let down = floor(&import) > floor(module);
            let known = WITHIN_GROUND.contains(&(module, &import));
            let own = import == module || (module == "main" && import == "cli");
            if !(down || own || known) {
                wrong.push(format!("{} imports {import}", inside.display()));
            }
        }
    }
    assert!(seen > 30, "the test reads imports: {seen}");
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn encode_sees_only_runs() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/encode");
    for file in files(&folder) {
        for import in imports(&fs::read_to_string(&file).unwrap()) {
            assert!(["run", "checksum", "encode", "error", "grid"].contains(&import.as_str()), "{} imports {import}", file.display());
        }
    }
}
