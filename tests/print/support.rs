//! A virtual printer on loopback, a proxy in front of it that cuts, and the program run beside them.

use std::io::{Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

pub const RUNSET: &str = env!("CARGO_BIN_EXE_runset");

/// A triangle on a page of US letter, the medium that is ready in the virtual printer: 816 x 1056 units of 1/96 inch, 5100 x 6600 px at 600 dpi.
pub const LETTER: &str = r#"{ "width": 816, "height": 1056, "shapes": { "a": { "path": "M 0 0 L 816 0 L 0 1056 Z" }, "b": { "path": "M 200 200 L 500 200 L 500 900 Z" } }, "expr": "a - b" }"#;

/// A folder with [`LETTER`] as `page.json`, where the program runs and keeps what it remembers.
pub struct Folder(tempfile::TempDir);

/// What a run has left.
#[derive(Debug)]
pub struct Ran {
    pub status: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Folder {
    pub fn new() -> Folder {
        let folder = Folder(tempfile::tempdir().unwrap());
        std::fs::write(folder.path("page.json"), LETTER).unwrap();
        folder
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The program with arguments split at blanks.
    pub fn runset(&self, args: &str) -> Command {
        let mut command = Command::new(RUNSET);
        for (name, _) in std::env::vars_os().filter(|(name, _)| name.to_string_lossy().starts_with("RUNSET_")) {
            command.env_remove(name);
        }
        command.args(args.split_whitespace()).current_dir(self.0.path()).env("XDG_CONFIG_HOME", self.path("config"));
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    pub fn run(&self, args: &str) -> Ran {
        ran(self.runset(args).spawn().unwrap())
    }

    /// What `runset fill` makes.
    pub fn fill(&self, args: &str) -> Vec<u8> {
        let output = self.runset(&format!("fill {args}")).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    }
}

/// Waits for a run to end.
pub fn ran(child: Child) -> Ran {
    let output = child.wait_with_output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let ran = Ran { status: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) };
    assert!(!ran.stderr.contains("panicked"), "{ran:?}");
    ran
}

impl Ran {
    /// It was printed.
    #[track_caller]
    pub fn printed(&self) {
        assert_eq!(self.status, Some(0), "{self:?}");
        assert!(self.stderr.trim_end().lines().last().unwrap().contains("is printed"), "{self:?}");
    }

    /// It was not, and the last line says these things.
    #[track_caller]
    pub fn failed(&self, status: i32, says: &[&str]) {
        assert_eq!(self.status, Some(status), "{self:?}");
        assert!(self.stderr.lines().all(|line| !line.ends_with(" is printed") && !line.contains(" is printed, ")), "{self:?}");
        let last = self.stderr.trim_end().lines().last().unwrap_or_default();
        says.iter().for_each(|what| assert!(last.contains(what), "{what:?} in {self:?}"));
    }
}

/// A process that is killed when this is dropped.
struct Killed(Child);

impl Drop for Killed {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A virtual printer.
pub struct Printer {
    pub port: u16,
    folder: tempfile::TempDir,
    _printer: Killed,
    _bus: Killed,
}

impl Printer {
    /// Starts one that takes these media types; `command` is a shell script that looks at a document, whose status is the job's.
    pub fn start(formats: &str, command: &str) -> Option<Printer> {
        if !["ippeveprinter", "ipptool", "dbus-daemon"].into_iter().all(|program| have(program, "printing on a virtual printer")) {
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        // It wants a system bus, although it does not speak on it: it gets one of its own.
        let socket = folder.path().join("bus");
        let address = format!("unix:path={}", socket.display());
        let mut bus = Command::new("dbus-daemon");
        bus.args(["--session", "--nofork", "--nopidfile", "--address", &address]).stdout(Stdio::null()).stderr(Stdio::null());
        let bus = Killed(bus.spawn().unwrap());
        wait_until("the bus is there", || socket.exists());

        let script = folder.path().join("command");
        std::fs::write(&script, format!("#!/bin/sh\n{command}\n")).unwrap();
        std::fs::set_permissions(&script, PermissionsExt::from_mode(0o755)).unwrap();
        std::fs::create_dir(folder.path().join("spool")).unwrap();
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let log = std::fs::File::create(folder.path().join("log")).unwrap();
        let mut printer = Command::new("ippeveprinter");
        printer.args(["-n", "localhost", "-r", "off", "-k", "-v", "-f", formats, "-p", &port.to_string(), "-c"]).arg(&script);
        printer.arg("-d").arg(folder.path().join("spool")).arg("virtual").env("DBUS_SYSTEM_BUS_ADDRESS", &address);
        printer.stdin(Stdio::null()).stdout(Stdio::null()).stderr(log);
        let printer = Killed(printer.spawn().unwrap());
        let log = folder.path().join("log");
        wait_until("the printer listens", || {
            TcpStream::connect(("127.0.0.1", port)).is_ok() || {
                assert!(Path::new(&format!("/proc/{}", printer.0.id())).exists(), "{}", std::fs::read_to_string(&log).unwrap());
                false
            }
        });
        Some(Printer { port, folder, _printer: printer, _bus: bus })
    }

    pub fn uri(&self) -> String {
        format!("ipp://127.0.0.1:{}/ipp/print", self.port)
    }

    /// The documents that it has kept, by their names.
    pub fn documents(&self) -> Vec<Vec<u8>> {
        let entries = std::fs::read_dir(self.folder.path().join("spool")).unwrap();
        let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
        // What the command writes.
        paths.retain(|path| path.extension().is_none_or(|extension| extension != "prn"));
        paths.sort();
        paths.iter().map(|path| std::fs::read(path).unwrap()).collect()
    }

    /// What `ipptool` says of all jobs: number and state, oldest first.
    pub fn jobs(&self) -> Vec<(i32, String)> {
        let test = self.folder.path().join("jobs.test");
        let text = "{ OPERATION Get-Jobs GROUP operation-attributes-tag ATTR charset attributes-charset utf-8 ATTR language attributes-natural-language en
            ATTR uri printer-uri $uri ATTR keyword which-jobs all ATTR keyword requested-attributes job-id,job-state STATUS successful-ok }";
        std::fs::write(&test, text).unwrap();
        let output = Command::new("ipptool").args(["-tv", &self.uri()]).arg(&test).output().unwrap();
        let said = String::from_utf8(output.stdout).unwrap();
        let said = said.split("RECEIVED").nth(1).unwrap_or_default();
        let of = |name: &str| {
            said.lines().filter_map(|line| line.trim().strip_prefix(name)?.split(" = ").nth(1)).map(str::to_owned).collect::<Vec<_>>()
        };
        let mut jobs: Vec<_> = of("job-id ").iter().map(|id| id.parse().unwrap()).zip(of("job-state ")).collect();
        jobs.sort();
        jobs
    }

    /// Waits until the last job has ended, and gives the states of all.
    pub fn ended(&self) -> Vec<String> {
        let mut states = Vec::new();
        wait_until("all jobs have ended", || {
            states = self.jobs().into_iter().map(|(_, state)| state).collect();
            states.iter().all(|state| ["completed", "canceled", "aborted"].contains(&state.as_str()))
        });
        states
    }
}

/// What a proxy does.
#[derive(Default)]
pub struct Rules {
    /// Cuts a connection after so many bytes to the printer; 0: never.
    pub cut: AtomicU64,
    /// Closes connections as they come.
    pub gone: AtomicBool,
    /// Refuses documents without a length.
    pub no_chunks: AtomicBool,
    /// Milliseconds to wait at every part that it passes on.
    pub slow: AtomicU64,
    /// Keeps back what the printer answers to more than a MiB.
    pub mute: AtomicBool,
}

/// A proxy in front of a printer.
pub struct Proxy {
    pub port: u16,
    pub rules: Arc<Rules>,
}

impl Proxy {
    pub fn start(printer: u16, rules: Rules) -> Proxy {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        let rules = Arc::new(rules);
        let shared = rules.clone();
        thread::spawn(move || {
            for client in listener.incoming() {
                let rules = shared.clone();
                thread::spawn(move || pass(client.unwrap(), printer, &rules));
            }
        });
        Proxy { port, rules }
    }

    pub fn uri(&self) -> String {
        format!("ipp://127.0.0.1:{}/ipp/print", self.port)
    }
}

fn pass(mut client: TcpStream, printer: u16, rules: &Arc<Rules>) {
    if rules.gone.load(Ordering::Relaxed) {
        return;
    }
    let mut upstream = TcpStream::connect(("127.0.0.1", printer)).unwrap();
    let passed = Arc::new(AtomicU64::new(0));
    let back = {
        let (mut from, mut to) = (upstream.try_clone().unwrap(), client.try_clone().unwrap());
        let (passed, rules) = (passed.clone(), rules.clone());
        thread::spawn(move || {
            let mut part = [0; 4096];
            while let Ok(n @ 1..) = from.read(&mut part) {
                let mute = rules.mute.load(Ordering::Relaxed) && passed.load(Ordering::Relaxed) > 1 << 20;
                if mute || to.write_all(&part[..n]).is_err() {
                    break;
                }
            }
            let _ = to.shutdown(Shutdown::Both);
        })
    };
    let mut part = [0; 16384];
    while let Ok(n @ 1..) = client.read(&mut part) {
        let first = passed.fetch_add(n as u64, Ordering::Relaxed) == 0;
        let chunked = || String::from_utf8_lossy(&part[..n]).to_ascii_lowercase().contains("transfer-encoding: chunked");
        if first && rules.no_chunks.load(Ordering::Relaxed) && chunked() {
            let _ = client.write_all(b"HTTP/1.1 411 Length Required\r\nContent-Length: 0\r\nConnection: close\r\n\r\n");
            // What is still coming is read, so that the answer is not lost with a reset.
            let _ = client.set_read_timeout(Some(Duration::from_millis(300)));
            while let Ok(1..) = client.read(&mut part) {}
            break;
        }
        thread::sleep(Duration::from_millis(rules.slow.load(Ordering::Relaxed)));
        let cut = rules.cut.load(Ordering::Relaxed);
        if upstream.write_all(&part[..n]).is_err() || cut > 0 && passed.load(Ordering::Relaxed) > cut {
            break;
        }
    }
    let _ = upstream.shutdown(Shutdown::Both);
    let _ = client.shutdown(Shutdown::Both);
    let _ = back.join();
}

/// A server that reads a request and answers with these bytes, `times` over; then it closes.
pub fn answering(answer: Vec<u8>, times: usize) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let addr = listener.local_addr().unwrap();
    thread::spawn(move || {
        for client in listener.incoming() {
            let (mut client, answer) = (client.unwrap(), answer.clone());
            thread::spawn(move || {
                let mut part = [0; 4096];
                let _ = client.read(&mut part);
                for _ in 0..times {
                    if client.write_all(&answer).is_err() {
                        break;
                    }
                }
            });
        }
    });
    addr
}

#[track_caller]
pub fn wait_until(what: &str, mut holds: impl FnMut() -> bool) {
    let start = Instant::now();
    while !holds() {
        assert!(start.elapsed() < Duration::from_secs(60), "waited in vain until {what}");
        thread::sleep(Duration::from_millis(20));
    }
}

/// Whether a program is there. If not, says what is skipped; that is a failure where everything must be there.
pub fn have(program: &str, what: &str) -> bool {
    let paths = std::env::var_os("PATH").unwrap_or_default();
    let places = std::env::split_paths(&paths).chain([PathBuf::from("/usr/sbin")]);
    let there = places.into_iter().any(|folder| folder.join(program).is_file());
    if !there {
        assert!(std::env::var("CI").as_deref() != Ok("true"), "must not be skipped here: {what}: {program} is not installed");
        eprintln!("skipped: {what}: {program} is not installed");
    }
    there
}
