//! OpenSCAD programs: `openscad` evaluates them, and writes the tree that is read here.

use std::io::{self, Read};
use std::path::Path;
use std::process::{Command, Stdio};

use super::messages::{Failure, reason};
use super::values::show_bytes;

/// Whether a file is an OpenSCAD program, by its name.
pub fn is_program(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("scad"))
}

/// The tree of an OpenSCAD program as a `.csg`, at most `limit` bytes: what `openscad -o - --export-format csg` writes. Files that the
/// program names are looked for beside it, and named so in the tree.
///
/// # Errors
/// `openscad` is not there, or what it says first of what is wrong.
pub fn tree(path: &Path, limit: u64) -> Result<Vec<u8>, Failure> {
    let name = path.display();
    let fails = |what: String| Failure::at(name.to_string(), what);
    let io = |error: &io::Error| fails(format!("cannot run openscad: {}", reason(error)));
    let full = path.canonicalize().map_err(|error| fails(format!("cannot read: {}", reason(&error))))?;
    let mut command = Command::new("openscad");
    command.args(["-o", "-", "--export-format", "csg"]).arg(&full).current_dir(full.parent().unwrap_or(&full));
    let mut child =
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => {
                fails("a .scad needs openscad, which is not on the PATH: install it, or give a .csg (openscad -o model.csg)".to_owned())
            }
            _ => io(&error),
        })?;
    let (Some(out), Some(err)) = (child.stdout.take(), child.stderr.take()) else { return Err(fails("cannot run openscad".to_owned())) };
    // What it says is read beside what it writes, so that neither pipe fills up.
    let said = std::thread::spawn(move || {
        let (mut text, mut rest) = (Vec::new(), err);
        rest.by_ref().take(1 << 20).read_to_end(&mut text).and_then(|_| io::copy(&mut rest, &mut io::sink())).map(|_| text)
    });
    let mut tree = Vec::new();
    let read = out.take(limit.saturating_add(1)).read_to_end(&mut tree);
    let too_long = tree.len() as u64 > limit;
    if too_long {
        // It is not read to its end; that it could not write is no error of the program's.
        let _ = child.kill();
    }
    let status = child.wait().map_err(|error| io(&error))?;
    let said = said.join().ok().and_then(Result::ok).unwrap_or_default();
    read.map_err(|error| io(&error))?;
    if too_long {
        return Err(fails(format!("its tree is larger than {} bytes; raise the limit with --max-input", show_bytes(limit))));
    }
    let said = String::from_utf8_lossy(&said);
    // A failed assertion leaves the status at 0.
    let error = said.lines().find(|line| line.starts_with("ERROR:"));
    match error {
        Some(line) => Err(fails(format!("openscad: {}", line.trim_start_matches("ERROR:").trim()))),
        None if !status.success() => Err(fails(format!("openscad fails: {}", said.lines().next().unwrap_or("it says nothing")))),
        None => Ok(tree),
    }
}
