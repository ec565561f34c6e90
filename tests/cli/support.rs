//! A folder to work in, and the program run in it.

use std::ffi::OsStr;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Two squares of 8 x 8, the second half over the first, on a page of 16 x 10.
pub const SCENE: &str = r#"{ "width": 16, "height": 10,
  "shapes": { "a": { "rings": [[[1, 1], [9, 1], [9, 9], [1, 9]]] }, "b": { "rings": [[[5, 1], [13, 1], [13, 9], [5, 9]]] } },
  "expr": "a - b" }"#;

/// `a - b` of [`SCENE`] as a plain text bitmap would show it, and as its raw bytes: columns 1 to 4 of lines 1 to 8.
pub const PBM: &[u8] = b"P4\n16 10\n\0\0\x78\0\x78\0\x78\0\x78\0\x78\0\x78\0\x78\0\x78\0\0\0";

/// A page so long that drawing it takes seconds; its lines differ from one to the next.
pub const LONG: &str = r#"{ "width": 4096, "height": 8388608,
  "shapes": { "a": { "path": "M 0 0 L 4096 0 L 0 8388608 Z" } }, "expr": "a" }"#;

/// A folder that holds [`SCENE`] as `scene.json` and goes when it is dropped.
pub struct Folder(tempfile::TempDir);

/// What a run has left.
pub struct Ran {
    pub status: Option<i32>,
    pub stdout: Vec<u8>,
    pub stderr: String,
}

impl Folder {
    pub fn new() -> Folder {
        let folder = Folder(tempfile::tempdir().unwrap());
        folder.put("scene.json", SCENE);
        folder
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn put(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).unwrap();
    }

    pub fn get(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    /// The names in the folder, sorted.
    pub fn names(&self) -> Vec<String> {
        let names = fs::read_dir(self.0.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<_> = names.collect();
        names.sort();
        names
    }

    /// A command that runs in the folder with nothing on its standard input.
    pub fn command(&self, program: impl AsRef<OsStr>) -> Command {
        let mut command = Command::new(program);
        command.current_dir(self.0.path()).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// The program, with arguments split at blanks.
    pub fn runset(&self, args: &str) -> Command {
        let mut command = self.command(RUNSET);
        command.args(args.split_whitespace());
        command
    }

    /// A shell's command line in which `$R` is the program.
    pub fn shell(&self, line: &str) -> Command {
        let mut command = self.command("bash");
        command.args(["-c", line]).env("R", RUNSET);
        command
    }

    /// Runs the program to its end.
    pub fn run(&self, args: &str) -> Ran {
        ran(self.runset(args).output().unwrap())
    }
}

/// The program.
pub const RUNSET: &str = env!("CARGO_BIN_EXE_runset");

pub fn ran(output: Output) -> Ran {
    Ran { status: output.status.code(), stdout: output.stdout, stderr: String::from_utf8(output.stderr).unwrap() }
}

/// Runs a command to its end with `input` on its standard input.
pub fn feed(mut command: Command, input: &[u8]) -> Ran {
    let mut child = command.stdin(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(input).unwrap();
    ran(child.wait_with_output().unwrap())
}

impl Ran {
    /// The run has failed with that status and that line alone.
    #[track_caller]
    pub fn refused(&self, status: i32, line: &str) {
        assert_eq!((self.stderr.as_str(), self.status), (format!("{line}\n").as_str(), Some(status)));
        assert_eq!(self.stdout, b"");
    }

    /// The run is done and had nothing to say.
    #[track_caller]
    pub fn done(&self) -> &[u8] {
        assert_eq!((self.stderr.as_str(), self.status), ("", Some(0)));
        &self.stdout
    }
}

/// Waits until something holds, for at most half a minute.
#[track_caller]
pub fn wait_until(what: &str, mut holds: impl FnMut() -> bool) {
    let start = Instant::now();
    while !holds() {
        assert!(start.elapsed() < Duration::from_secs(30), "waited in vain until {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Sends a signal (`INT`, `TERM`, ...).
pub fn kill(child: &Child, signal: &str) {
    assert!(Command::new("kill").args(["-s", signal, &child.id().to_string()]).status().unwrap().success());
}

/// Whether a program is there. If not, says what is skipped; that is a failure where everything must be there.
pub fn have(program: &str, what: &str) -> bool {
    let paths = std::env::var_os("PATH").unwrap_or_default();
    let there = std::env::split_paths(&paths).any(|folder| Path::new(&folder).join(program).is_file());
    there || skip(&format!("{what}: {program} is not installed"))
}

/// Says what is skipped; under `CI=true` that is a failure.
pub fn skip(what: &str) -> bool {
    assert!(std::env::var("CI").as_deref() != Ok("true"), "must not be skipped here: {what}");
    eprintln!("skipped: {what}");
    false
}
