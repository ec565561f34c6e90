//! The program as a service on a port of its own, and clients for it: ureq for what is ordinary, bare sockets for what is not.

use std::io::{self, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use socket2::{Domain, Socket, Type};
use ureq::http::{HeaderMap, Request, Response};

/// The program that cargo built for the tests.
pub const RUNSET: &str = env!("CARGO_BIN_EXE_runset");

/// The program that is served: where it is timed, the release that `RUNSET_RELEASE` names, if it does.
fn served() -> PathBuf {
    std::env::var_os("RUNSET_RELEASE").filter(|_| crate::TIMED).map_or_else(|| RUNSET.into(), PathBuf::from)
}

pub const SVG: &str = "image/svg+xml";
pub const JSON: &str = "application/json";
pub const CSG: &str = "text/plain";
pub const STL: &str = "model/stl";

/// Two squares of 8 x 8, the second half over the first, on a page of 16 x 10.
pub const SCENE: &str = r#"{ "width": 16, "height": 10,
  "shapes": { "a": { "rings": [[[1, 1], [9, 1], [9, 9], [1, 9]]] }, "b": { "rings": [[[5, 1], [13, 1], [13, 9], [5, 9]]] } },
  "expr": "a - b" }"#;

/// A block with a round hole, half of a ball and a bar in colour, at angles at which no two lines are the same.
pub const MODEL: &str = "union() {
  difference() {
    cube(size = [10, 8, 6], center = true);
    multmatrix([[1, 0, 0, 1], [0, 0.8, -0.6, 0], [0, 0.6, 0.8, 0], [0, 0, 0, 1]]) { cylinder(h = 20, r = 2, $fn = 24, center = true); }
    multmatrix([[1, 0, 0, 5], [0, 1, 0, 4], [0, 0, 1, 3], [0, 0, 0, 1]]) { sphere(r = 3, $fn = 20); }
  }
  color([1, 0, 0.5]) { multmatrix([[0.8, -0.6, 0, -4], [0.6, 0.8, 0, -2], [0, 0, 1, 2], [0, 0, 0, 1]]) { cube(size = [12, 1, 1.5]); } }
}
";

/// Whether a document is a model's.
pub fn is_model(document: &[u8]) -> bool {
    !matches!(document.trim_ascii_start().first(), Some(b'{' | b'<'))
}

/// A tetrahedron as a binary STL.
pub fn tetrahedron() -> Vec<u8> {
    let corners = [[0.0_f32, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
    let mut stl = vec![b' '; 80];
    stl.extend(4_u32.to_le_bytes());
    for facet in [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] {
        stl.extend([0_u8; 12]);
        facet.iter().for_each(|&i: &usize| corners[i].iter().for_each(|x| stl.extend(x.to_le_bytes())));
        stl.extend([0_u8; 2]);
    }
    stl
}

/// How often the random laws are tried: `RUNSET_EFFORT` times as much as by default.
pub fn effort(n: u64) -> u64 {
    n * std::env::var("RUNSET_EFFORT").map_or(1, |effort| effort.parse().expect("a number"))
}

/// A triangle on a page, whose lines all differ.
pub fn triangle(width: u32, height: u32) -> String {
    format!(
        r#"{{ "width": {width}, "height": {height}, "expr": "a", "shapes": {{ "a": {{ "path": "M 0 0 L {width} 0 L 0 {height} Z" }} }} }}"#
    )
}

/// A page with nothing on it.
pub fn empty(width: u32, height: u32) -> String {
    format!(r#"{{ "width": {width}, "height": {height}, "expr": "a", "shapes": {{ "a": {{ "rings": [] }} }} }}"#)
}

/// A drawing from `examples/art`.
pub fn art(name: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/art").join(name)).unwrap()
}

/// SplitMix64 (Steele, Lea, Flood 2014): a counter, hashed.
pub struct Rng(pub u64);

impl Rng {
    /// In `0..n`.
    pub fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ z >> 31) % n
    }
}

/// The service, which is killed when this is dropped.
pub struct Server {
    pub addr: SocketAddr,
    child: Child,
    agent: ureq::Agent,
    log: PathBuf,
}

/// An answer, read to its end.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub headers: HeaderMap,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn header(&self, name: &str) -> &str {
        header(&self.headers, name)
    }

    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }

    /// It is a problem (RFC 9457) of that status and name, with all fields.
    #[track_caller]
    pub fn problem(&self, status: u16, name: &str) -> Value {
        let text = String::from_utf8_lossy(&self.body).into_owned();
        assert_eq!((self.status, self.header("content-type")), (status, "application/problem+json"), "{text}");
        let problem = self.json();
        assert_eq!((&problem["type"], &problem["status"]), (&format!("urn:runset:problem:{name}").into(), &status.into()), "{text}");
        for field in ["title", "detail"] {
            assert!(problem[field].as_str().is_some_and(|text| !text.is_empty() && text.lines().count() == 1), "{field}: {text}");
        }
        assert_ne!(self.header("x-request-id"), "", "{text}");
        problem
    }

    /// It is all right.
    #[track_caller]
    pub fn ok(self, status: u16) -> Answer {
        assert_eq!(self.status, status, "{}", String::from_utf8_lossy(&self.body[..self.body.len().min(500)]));
        self
    }
}

pub fn header<'h>(headers: &'h HeaderMap, name: &str) -> &'h str {
    headers.get(name).map_or("", |value| value.to_str().unwrap())
}

/// The command that starts a service on any port, with its jobs in `data`.
pub fn command(data: &Path, options: &[&str]) -> Command {
    let mut command = Command::new(served());
    for (name, _) in std::env::vars_os().filter(|(name, _)| name.to_string_lossy().starts_with("RUNSET_")) {
        command.env_remove(name);
    }
    command.args(["serve", "--addr", "127.0.0.1:0", "--data"]).arg(data).args(options).stdin(Stdio::null()).stdout(Stdio::null());
    command
}

impl Server {
    /// Starts one with its jobs in a folder.
    #[track_caller]
    pub fn start(data: &Path, options: &[&str]) -> Server {
        Server::run(command(data, options), data)
    }

    /// Starts one by a command that leads to it; its log is kept beside its jobs.
    #[track_caller]
    pub fn run(mut command: Command, data: &Path) -> Server {
        let log = data.with_extension("log");
        let agent = ureq::Agent::config_builder()
            .http_status_as_error(false)
            .allow_non_standard_methods(true)
            .max_idle_connections(0)
            .max_response_header_size(1 << 20)
            .timeout_global(Some(Duration::from_secs(100)))
            .proxy(None)
            .build();
        let child = command.stderr(std::fs::File::create(&log).unwrap()).spawn().unwrap();
        // From here on it is killed, whatever happens.
        let mut server = Server { addr: ([0; 4], 0).into(), child, agent: agent.into(), log };
        wait_until("the service listens", || {
            let said = server.said();
            let addr = said.lines().find_map(|line| line.strip_prefix("runset: listening on http://")?.split(',').next()?.parse().ok());
            assert!(addr.is_some() || server.ended().is_none(), "it has ended: {said}");
            addr.inspect(|addr| server.addr = *addr).is_some()
        });
        server
    }

    pub fn url(&self, path: &str) -> String {
        format!("http://{}{path}", self.addr)
    }

    /// Sends a request and gives the answer from its head on.
    #[track_caller]
    pub fn open(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Response<ureq::Body> {
        let mut request = Request::builder().method(method).uri(self.url(path));
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        let sent = if body.is_empty() && method != "POST" {
            self.agent.run(request.body(()).unwrap())
        } else {
            self.agent.run(request.body(body).unwrap())
        };
        sent.unwrap_or_else(|error| panic!("{method} {path}: {error}\n{}", self.said()))
    }

    /// Sends a request and reads the answer; an answer that breaks is an error.
    #[track_caller]
    pub fn try_ask(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &[u8]) -> io::Result<Answer> {
        let (parts, body) = self.open(method, path, headers, body).into_parts();
        let mut bytes = Vec::new();
        body.into_reader().read_to_end(&mut bytes)?;
        Ok(Answer { status: parts.status.as_u16(), headers: parts.headers, body: bytes })
    }

    #[track_caller]
    pub fn ask(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Answer {
        self.try_ask(method, path, headers, body).unwrap_or_else(|error| panic!("{method} {path}: {error}"))
    }

    #[track_caller]
    pub fn get(&self, path: &str) -> Answer {
        self.ask("GET", path, &[], b"")
    }

    #[track_caller]
    pub fn fill(&self, query: &str, kind: &str, document: impl AsRef<[u8]>) -> Answer {
        self.ask("POST", &format!("/v1/fill{query}"), &[("content-type", kind)], document.as_ref())
    }

    #[track_caller]
    pub fn solid(&self, query: &str, kind: &str, document: impl AsRef<[u8]>) -> Answer {
        self.ask("POST", &format!("/v1/solid{query}"), &[("content-type", kind)], document.as_ref())
    }

    #[track_caller]
    pub fn post_job(&self, query: &str, headers: &[(&str, &str)], document: impl AsRef<[u8]>) -> Answer {
        let kind = match document.as_ref() {
            [b'{', ..] => JSON,
            document if is_model(document) => CSG,
            _ => SVG,
        };
        self.ask("POST", &format!("/v1/jobs{query}"), &[headers, &[("content-type", kind)]].concat(), document.as_ref())
    }

    /// Makes a job and gives its address.
    #[track_caller]
    pub fn job(&self, query: &str, document: impl AsRef<[u8]>) -> String {
        self.post_job(query, &[], document).ok(201).header("location").to_owned()
    }

    /// Waits until a job's raster has been measured, and gives its length.
    #[track_caller]
    pub fn measured(&self, job: &str) -> u64 {
        let mut bytes = None;
        wait_until("the raster is measured", || {
            bytes = self.get(job).ok(200).json()["bytes"].as_u64();
            bytes.is_some()
        });
        bytes.unwrap()
    }

    /// The sum of all values of a metric whose labels hold `label`.
    #[track_caller]
    pub fn metric(&self, name: &str, label: &str) -> f64 {
        let text = String::from_utf8(self.get("/metrics").ok(200).body).unwrap();
        let of = |line: &str| {
            let (labelled, value) = line.rsplit_once(' ')?;
            let (own, labels) = labelled.split_once('{').unwrap_or((labelled, ""));
            (own == name && labels.contains(label)).then(|| value.parse::<f64>().unwrap())
        };
        text.lines().filter_map(of).sum()
    }

    /// A number of `/proc/PID/status`: `VmHWM` and `VmRSS` in KiB, `Threads`.
    pub fn status(&self, field: &str) -> u64 {
        let text = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let value = text.lines().find_map(|line| line.strip_prefix(field)?.strip_prefix(':'));
        value.unwrap().trim().trim_end_matches(" kB").parse().unwrap()
    }

    /// What it has told and logged.
    pub fn said(&self) -> String {
        std::fs::read_to_string(&self.log).unwrap_or_default()
    }

    /// A connection with room for so many bytes that were not read yet, as far as the system agrees.
    pub fn connect(&self, room: usize) -> TcpStream {
        let socket = Socket::new(Domain::IPV4, Type::STREAM, None).unwrap();
        socket.set_recv_buffer_size(room).unwrap();
        socket.connect(&self.addr.into()).unwrap();
        let stream = TcpStream::from(socket);
        stream.set_read_timeout(Some(Duration::from_secs(100))).unwrap();
        stream.set_write_timeout(Some(Duration::from_secs(100))).unwrap();
        stream
    }

    /// Sends a request without a body and reads nothing.
    pub fn asked(&self, room: usize, path: &str) -> TcpStream {
        let mut stream = self.connect(room);
        write!(stream, "GET {path} HTTP/1.1\r\nHost: {}\r\n\r\n", self.addr).unwrap();
        stream
    }

    pub fn signal(&self, signal: &str) {
        assert!(Command::new("kill").args(["-s", signal, &self.child.id().to_string()]).status().unwrap().success());
    }

    /// Whether it has ended, and how.
    pub fn ended(&mut self) -> Option<ExitStatus> {
        self.child.try_wait().unwrap()
    }

    /// Ends it at once, as a fault of the machine does.
    pub fn kill(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        let said = self.said();
        if std::thread::panicking() {
            eprintln!("what the service said:\n{}", said.lines().rev().take(30).collect::<Vec<_>>().join("\n"));
        } else {
            assert!(!said.contains("panicked at"), "{said}");
        }
    }
}

/// Sends bytes on a connection of their own, and gives what comes back until that ends; a connection that is reset has ended.
pub fn exchange(server: &Server, request: &[u8]) -> String {
    let mut stream = server.connect(1 << 16);
    let _ = stream.write_all(request);
    ending(stream)
}

/// What comes until the connection ends.
pub fn ending(mut stream: TcpStream) -> String {
    let mut all = Vec::new();
    let mut part = [0; 4096];
    while let Ok(n @ 1..) = stream.read(&mut part) {
        all.extend_from_slice(&part[..n]);
    }
    String::from_utf8_lossy(&all).into_owned()
}

/// Waits until something holds, for at most half a minute.
#[track_caller]
pub fn wait_until(what: &str, holds: impl FnMut() -> bool) {
    wait_within(Duration::from_secs(30), what, holds);
}

/// Waits until something holds, and gives how long that took.
#[track_caller]
pub fn wait_within(time: Duration, what: &str, mut holds: impl FnMut() -> bool) -> Duration {
    let start = Instant::now();
    while !holds() {
        assert!(start.elapsed() < time, "waited in vain until {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
    start.elapsed()
}

/// What the command line makes of the same document, a drawing or a model.
pub fn by_command_line(document: &[u8], options: &[&str]) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("in");
    std::fs::write(&path, document).unwrap();
    let output = Command::new(RUNSET).arg(if is_model(document) { "solid" } else { "fill" }).arg(&path).args(options).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

/// A folder of its own for a service's jobs, inside one that goes when it is dropped.
pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn new() -> Folder {
        Folder(tempfile::tempdir().unwrap())
    }

    pub fn data(&self) -> PathBuf {
        self.0.path().join("data")
    }

    pub fn file(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The names of the documents, sorted.
    pub fn documents(&self) -> Vec<String> {
        let names = std::fs::read_dir(self.data().join("documents")).unwrap().map(|entry| entry.unwrap().file_name());
        let mut names: Vec<_> = names.map(|name| name.into_string().unwrap()).collect();
        names.sort();
        names
    }
}

/// The ids of all jobs, sorted.
pub fn ids(server: &Server) -> Vec<String> {
    let (mut ids, mut after) = (Vec::new(), String::new());
    loop {
        let page = server.get(&format!("/v1/jobs?limit=1000{after}")).ok(200).json();
        ids.extend(page["jobs"].as_array().unwrap().iter().map(|job| job["id"].as_str().unwrap().to_owned()));
        let Some(next) = page["next"].as_str() else { break };
        after = format!("&after={next}");
    }
    ids.sort();
    ids
}

/// Whether a program is there. If not, says what is skipped; that is a failure where everything must be there.
pub fn have(program: &str, what: &str) -> bool {
    tool(program).is_file() || skip(&format!("{what}: {program} is not installed"))
}

/// Where a program is: among those that the test command installs in a folder of its own, or on the path.
pub fn tool(program: &str) -> PathBuf {
    let own = std::env::var_os("RUNSET_TOOLS").map(PathBuf::from);
    let paths = std::env::var_os("PATH").unwrap_or_default();
    own.into_iter().chain(std::env::split_paths(&paths)).map(|folder| folder.join(program)).find(|path| path.is_file()).unwrap_or_default()
}

/// Says what is skipped; under `CI=true` that is a failure.
pub fn skip(what: &str) -> bool {
    assert!(std::env::var("CI").as_deref() != Ok("true"), "must not be skipped here: {what}");
    eprintln!("skipped: {what}");
    false
}
