//! Input that means harm: within two seconds and 256 MiB the right picture, or one clear line and exit 1 or 2. What is large itself gets more, by its
//! size: see [`Share`].
//!
//! `RUNSET_RELEASE` names the binary to measure; without it the one that cargo built for the tests is taken, and given ten times as long.

#![allow(clippy::unwrap_used)] // all of this is tests

mod models;
mod svg;

use std::fs;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use flate2::Compression;
use flate2::write::GzEncoder;

/// Largest resident set of a run, in KiB.
const MEMORY: u64 = 256 << 10;

/// Processor time of a run.
const TIME: Duration = Duration::from_secs(2);

/// What a run may take for every byte of its input, where that is more.
#[derive(Clone, Copy)]
struct Share {
    /// Resident bytes.
    bytes: u64,
    /// Nanoseconds of processor time.
    nanoseconds: u64,
}

/// "100,000 deep or with 100,000 operands".
const MANY: usize = 100_000;

/// What is right.
#[derive(Clone, Copy)]
enum Right {
    /// The area of this expression over the squares of [`scene`].
    Area(&'static str),
    /// This text somewhere in the stream.
    Holds(&'static str),
    /// Anything; it ends well.
    Drawn,
    /// It ends well, with a warning that has this in it.
    Warned(&'static str),
    /// Either of them will do.
    Either(&'static Right, &'static Right),
    /// One line that begins with the input's name and has this in it, exit status 1.
    Refused(&'static str),
}
use Right::{Area, Drawn, Either, Holds, Refused, Warned};

/// The program, and how much slower it may be than a release.
fn binary() -> (PathBuf, u32) {
    match std::env::var_os("RUNSET_RELEASE") {
        Some(release) => (release.into(), 1),
        None => (env!("CARGO_BIN_EXE_runset").into(), 10),
    }
}

/// Runs the program on every input, one after the other, and names all that go wrong.
#[track_caller]
fn check(command: &str, cases: Vec<(String, Vec<u8>, Right)>) {
    check_within(Share { bytes: 0, nanoseconds: 0 }, command, cases);
}

#[track_caller]
fn check_within(share: Share, command: &str, cases: Vec<(String, Vec<u8>, Right)>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("in");
    let mut wrong = Vec::new();
    for (name, input, right) in cases {
        fs::write(&path, input).unwrap();
        wrong.extend(fault(share, command, &path, &right).map(|fault| format!("{name}: {fault}")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What is wrong with a run on `input`.
fn fault(share: Share, command: &str, input: &std::path::Path, right: &Right) -> Option<String> {
    let (program, slower) = binary();
    let bytes = fs::metadata(input).unwrap().len();
    let time = slower * TIME.max(Duration::from_nanos(share.nanoseconds * bytes));
    let memory = MEMORY.max(share.bytes * bytes / 1024);
    let [out, err] = ["out", "err"].map(|name| input.with_file_name(name));
    let [to, told] = [&out, &err].map(|path| Stdio::from(fs::File::create(path).unwrap()));
    let began = Instant::now();
    let mut child = Command::new(program)
        .arg(command)
        .arg(input)
        .args(match command {
            "info" => &[][..],
            // What is read back is text.
            "solid" => &["--progress", "never", "--format", "ndjson"],
            _ => &["--progress", "never"],
        })
        .stdin(Stdio::null())
        .stdout(to)
        .stderr(told)
        .spawn()
        .unwrap();
    let file = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    let status = loop {
        // A high-water mark: what is missed after the last look is missed, not what was before it.
        let text = fs::read_to_string(&file).unwrap_or_default();
        let mark = text.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB")?.parse().ok());
        peak = peak.max(mark.unwrap_or(0));
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        // Processor time, so that a busy machine is not held against the program; a program that only waits is caught by the clock.
        let spent = processor_time(child.id());
        if spent > time || began.elapsed() > 20 * time {
            child.kill().unwrap();
            child.wait().unwrap();
            return Some(format!("still running after {spent:?} of processor time, {:?} in all", began.elapsed()));
        }
        std::thread::sleep(Duration::from_millis(1));
    };
    if peak > memory {
        return Some(format!("{peak} KiB, of {memory}"));
    }
    let (out, err) = (fs::read_to_string(&out).unwrap(), fs::read_to_string(&err).unwrap());
    told_wrong(right, status, &out, &err)
}

/// What is wrong with how a run ended and what it said.
fn told_wrong(right: &Right, status: ExitStatus, out: &str, err: &str) -> Option<String> {
    let begin: String = err.chars().take(300).collect();
    match right {
        Either(one, other) => told_wrong(one, status, out, err).and_then(|_| told_wrong(other, status, out, err)),
        Refused(what) => {
            let line = err.lines().count() == 1 && err.contains("/in:") && err.contains(what);
            (status.code() != Some(1) || !line || !out.is_empty()).then(|| format!("{status}, wanted {what:?}: {begin}"))
        }
        _ if status.code() != Some(0) => Some(format!("{status}: {begin}")),
        Drawn => None,
        Warned(what) => (!err.lines().any(|line| line.contains(what))).then(|| format!("no warning {what:?}: {begin}")),
        Area(expr) => (out != picture(expr)).then(|| format!("not the picture of {expr}: {begin}")),
        Holds(text) => (!out.contains(text)).then(|| format!("nowhere {text}: {begin}")),
    }
}

/// What a process has spent in user and in kernel mode: fields 14 and 15 of its `stat`, in hundredths of a second.
fn processor_time(process: u32) -> Duration {
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    let behind_the_name = stat.rsplit(") ").next().unwrap_or_default();
    let ticks: u64 = behind_the_name.split(' ').skip(11).take(2).filter_map(|field| field.parse::<u64>().ok()).sum();
    Duration::from_millis(ticks * 10)
}

/// The stream of an expression that is small enough to be trusted.
fn picture(expr: &str) -> String {
    let mut child = Command::new(binary().0).args(["fill", "-"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(&scene(expr)).unwrap();
    String::from_utf8(child.wait_with_output().unwrap().stdout).unwrap()
}

/// Three squares of which every two overlap, and their expression.
fn scene(expr: &str) -> Vec<u8> {
    let square = |x, y| format!("{{\"rings\":[[[{x},{y}],[{0},{y}],[{0},{1}],[{x},{1}]]]}}", x + 8, y + 8);
    let shapes = format!("{{\"a\":{},\"b\":{},\"c\":{}}}", square(1, 1), square(5, 1), square(3, 3));
    format!("{{\"width\":16,\"height\":16,\"shapes\":{shapes},\"expr\":\"{expr}\"}}").into_bytes()
}

/// A scene of one shape `a`, or of what else stands in `shapes`.
fn shapes(width: u32, height: u32, shapes: &str, drawn: &str) -> Vec<u8> {
    format!("{{\"width\":{width},\"height\":{height},\"shapes\":{{{shapes}}},{drawn}}}").into_bytes()
}

fn svg(content: &str) -> Vec<u8> {
    format!("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"16\" height=\"16\">{content}</svg>").into_bytes()
}

/// Numbers below `n`, always the same.
fn random() -> impl FnMut(u64) -> u64 {
    let mut seed = 7u64;
    move |n| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) % n
    }
}

#[test]
fn expressions_deep_and_wide() {
    let deep = |open: &str, inner: &str, close: &str| [open.repeat(MANY), inner.to_owned(), close.repeat(MANY)].concat();
    let wide = |sign: &str| vec!["a"; MANY].join(sign);
    let mixed: String =
        ["a-(", "b&(", "c^(", "!(", "odd(a,b,", "atleast(1,", "all(c,", "any("].iter().cycle().take(MANY).copied().collect();
    let mut cases = vec![
        ("parentheses".to_owned(), deep("(", "a", ")"), Area("a")),
        ("signs, even".to_owned(), deep("!", "a", ""), Area("a")),
        ("signs, odd".to_owned(), deep("!", "!a", ""), Area("!a")),
        ("all in all".to_owned(), deep("all(b,", "a", ")"), Area("a & b")),
        ("any in any".to_owned(), deep("any(b,", "a", ")"), Area("a | b")),
        ("odd in odd".to_owned(), deep("odd(b,", "a", ")"), Area("a")),
        ("atleast in atleast".to_owned(), deep("atleast(2,b,c,", "a", ")"), Area("atleast(2, a, b, c)")),
        ("to the right, -".to_owned(), deep("a-(", "b", ")"), Area("a & b")),
        ("to the right, &!".to_owned(), deep("a&!(", "b", ")"), Area("a & b")),
        ("to the right, & and -".to_owned(), deep("a-(b&(", "c", "))"), Area("a - (b & (a - (b & c)))")),
        ("to the left, -".to_owned(), deep("(", "b", "-a)"), Area("b - a")),
        ("all kinds, never closed".to_owned(), mixed.clone(), Refused("expected a shape, found the end")),
        ("all kinds".to_owned(), mixed + "a" + &")".repeat(MANY), Holds("\"end\":true")),
        ("half of them".to_owned(), format!("atleast({},{})", MANY, wide(",")), Area("a")),
        ("more than all of them".to_owned(), format!("atleast({},a)", "9".repeat(MANY)), Area("a - a")),
    ];
    for (sign, right) in [("&", Area("a")), ("|", Area("a")), ("-", Area("a - a")), ("^", Area("a - a"))] {
        cases.push((format!("a {sign} a"), wide(sign), right));
    }
    check("fill", cases.into_iter().map(|(name, expr, right)| (name, scene(&expr), right)).collect());
}

#[test]
fn many_of_everything() {
    let mut random = random();
    let square = |x: u64, y: u64| format!("[[{x},{y}],[{0},{y}],[{0},{1}],[{x},{1}]]", x + 3, y + 3);
    let mut named = |n: usize| -> String {
        let shape = |i| format!("\"s{i}\":{{\"rings\":[{}]}}", square(random(1000), random(1000)));
        (0..n).map(shape).collect::<Vec<_>>().join(",")
    };
    let layers = |n: usize, expr: &dyn Fn(usize) -> String| {
        let layer = |i| format!("{{\"expr\":\"{}\",\"ink\":\"#{i:06x}\"}}", expr(i));
        format!("\"layers\":[{}]", (0..n).map(layer).collect::<Vec<_>>().join(","))
    };
    let one = "\"a\":{\"rings\":[[[0,0],[9,0],[0,9]]]}";
    let rings = |ring: &dyn Fn(usize) -> String, n| format!("\"a\":{{\"rings\":[{}]}}", (0..n).map(ring).collect::<Vec<_>>().join(","));
    let column = |i: usize| format!("[[10,0],[60,0],[60,{0}],[10,{0}]]", 1000.0 - i as f64 / 50.0);
    let tiny = |i: usize| square((i * 7919 % 1000) as u64, (i * 104_729 % 1009) as u64);
    let cases = vec![
        ("shapes", shapes(1000, 1000, &named(MANY), "\"expr\":\"art\""), Holds("\"end\":true")),
        ("shapes, each a layer", shapes(1000, 1000, &named(60_000), &layers(60_000, &|i| format!("s{i}"))), Holds("\"end\":true")),
        ("layers, deep", shapes(9, 9, one, &layers(1000, &|_| "a-(".repeat(500) + "a" + &")".repeat(500))), Holds("\"end\":true")),
        ("inks, as many as there can be", shapes(9, 9, one, &layers(65_535, &|_| "a".to_owned())), Holds("\"end\":true")),
        ("inks, one more", shapes(9, 9, one, &layers(65_536, &|_| "a".to_owned())), Refused("65536 different inks")),
        ("rings", shapes(1000, 1000, &rings(&tiny, MANY), "\"expr\":\"a\""), Holds("\"end\":true")),
        (
            "edges in a column",
            shapes(100, 1000, &rings(&column, 50_000), "\"expr\":\"a\""),
            Holds("{\"y\":0,\"n\":1000,\"runs\":[[10,60]]}"),
        ),
        ("pixels", shapes(1 << 20, 1 << 23, one, "\"expr\":\"page\""), Holds("\"lines\":8388608,\"runs\":8388608")),
        ("lines of nothing", shapes(1, 1 << 23, one, "\"expr\":\"page - page\""), Holds("\"lines\":8388608,\"runs\":0")),
    ];
    check("fill", cases.into_iter().map(|(name, input, right)| (name.to_owned(), input, right)).collect());
}

#[test]
fn numbers_out_of_range() {
    let mut cases = Vec::new();
    for number in ["NaN", "Infinity", "-Infinity", "1e309", "nan", "0x1", "1_0", "01", "-", "1e", "null", "true", "\\\"1\\\"", "[]"] {
        let ring = format!("\"a\":{{\"rings\":[[[0,0],[{number},0],[5,5]]]}}");
        cases.push((number.to_owned(), shapes(9, 9, &ring, "\"expr\":\"a\""), Refused("shape \"a\"")));
    }
    // Squares that are a, however they come there; 6 or 9 numbers of a transform.
    let square = |x0: &str, x1: &str| format!("\"rings\":[[[{x0},{x0}],[{x1},{x0}],[{x1},{x1}],[{x0},{x1}]]]");
    let transformed = |m: &str, outline: &str| {
        let text = String::from_utf8(scene("x")).unwrap();
        text.replace("\"shapes\":{", &format!("\"shapes\":{{\"x\":{{{outline},\"transform\":[{m}]}},")).into_bytes()
    };
    for size in ["1e300", "1e-300", "-1e200", "1e-320", "-1e-160"] {
        let m = format!("{size},0,0, 0,{size},0, 0,0,{size}");
        cases.push((format!("homography of {size}"), transformed(&m, &square("1", "9")), Area("a")));
    }
    for (m, from, to, right) in [
        ("1,0,0, 0,1e-200,0, 0,0,1e-200", "-1e3", "1e3", Area("page")),
        ("1,0,0, 0,1,0, 1e-300,1e-300,1", "1", "9", Area("a")),
        ("1e300,0,0,1e300,0,0", "1e-300", "9e-300", Area("a")),
        ("1e-300,0,0,1e-300,0,0", "1e300", "9e300", Area("a")),
        ("1e-300,0,0, 0,1e-300,0, 0,0,1", "1e300", "9e300", Area("a")),
        ("1,0,0,1,0,0", "-1e308", "1.7976931348623157e308", Area("page")),
        ("1e308,0,0,1e308,0,0", "-9", "9", Refused("out of the range of 64-bit numbers")),
        ("1,2,3, 4,5,6, 7,8,9", "1", "9", Refused("singular")),
        ("0,0,0, 0,0,0, 0,0,0", "1", "9", Refused("singular")),
        ("0,0,0,0,0,0", "1", "9", Area("page - page")),
        ("1,0,0, 0,1,0, 1e300,1e300,1", "-1e6", "1e6", Refused("reaches beyond")),
    ] {
        cases.push((format!("{from} to {to} by {m}"), transformed(m, &square(from, to)), right));
    }
    for size in ["1e6", "1e17", "1e300"] {
        let path =
            format!("\"path\":\"M 1 1 C {size} {size} -{size} {size} 1 1 {}Z\"", format!("C {size} {size} {size} 0 1 1 ").repeat(100));
        cases.push((format!("curves of {size}"), transformed("1,0,0,1,0,0", &path), Holds("\"end\":true")));
        cases.push((format!("curves of {size} by a homography"), transformed("1,0,0, 0,1,0, 0.1,0,1", &path), Holds("\"end\":true")));
    }
    check("fill", cases);
}

#[test]
fn bytes_that_are_no_document() {
    let mut random = random();
    let whole = scene("a - b");
    let cut = (1..whole.len()).step_by(5).map(|n| (format!("{n} bytes of a scene"), whole[..n].to_vec(), Refused("ends too early")));
    let mut noise = |n: u64| (0..n).map(|_| random(256) as u8).collect::<Vec<u8>>();
    let bytes: Vec<_> = [1, 7, 100, 100_000, 1 << 20].map(|n| (format!("{n} random bytes"), noise(n))).into();
    for (command, right) in [("fill", "expected an SVG"), ("convert", "not a line stream")] {
        check(command, bytes.iter().map(|(name, bytes)| (name.clone(), bytes.clone(), Refused(right))).collect());
    }
    let inside = |at: usize| [&whole[..at], &noise(100), &whole[at..]].concat();
    let within: Vec<_> = (1..whole.len()).step_by(9).map(inside).collect();
    let within = within.into_iter().enumerate().map(|(i, bytes)| (format!("random bytes within, {i}"), bytes, Refused("")));
    let others = [("brackets", "{\"width\":".to_owned() + &"[".repeat(1 << 20)), ("keys", "{\"a\":".repeat(1 << 20))];
    let others = others.map(|(name, text)| (name.to_owned(), text.into_bytes(), Refused("1:")));
    let ids = r#"\"a\\\"b\\\\c\" ^ \"漢字 🎨\" ^ \"\" ^ \"page\""#;
    let named = r#""a\"b\\c":{"rings":[]},"漢字 🎨":{"path":"M1 1h3v3z"},"":{"rings":[]},"page":{"rings":[]}"#;
    let ids = [("ids".to_owned(), shapes(9, 9, named, &format!("\"expr\":\"{ids}\"")), Holds("\"end\":true"))];
    let keys = [("a long key".to_owned(), shapes(9, 9, "", &format!("\"{}\":1", "k".repeat(1 << 20))), Refused("unknown key"))];
    check("fill", cut.chain(within).chain(others).chain(ids).chain(keys).collect());
}

#[test]
fn drawings_that_grow() {
    let rect = "<rect id=\"a\" x=\"1\" y=\"1\" width=\"8\" height=\"8\"/>";
    let nested = |n: usize| "<g>".repeat(n) + rect + &"</g>".repeat(n);
    let tens = |n: usize, what: &dyn Fn(usize) -> String| (1..=n).map(|i| what(i).repeat(10)).collect::<Vec<_>>();
    let entities: String = tens(9, &|i| format!("&e{};", i - 1)).iter().zip(1..).map(|(v, i)| format!("<!ENTITY e{i} \"{v}\">")).collect();
    let uses: String =
        tens(9, &|i| format!("<use href=\"#g{}\"/>", i - 1)).iter().zip(1..).map(|(v, i)| format!("<g id=\"g{i}\">{v}</g>")).collect();
    let style = |css: &str| svg(&format!("<style>{css}</style>{}", rect.repeat(100)));
    let own = |css: String| svg(&format!("<rect style=\"{css}\" width=\"8\" height=\"8\"/>"));
    let attributes = |n: usize| svg(&format!("<g {}/>", (0..n).map(|i| format!("a{i}='' ")).collect::<String>()).repeat(500));
    let mut zip = GzEncoder::new(Vec::new(), Compression::best());
    zip.write_all(&svg(&" ".repeat(200 << 20))).unwrap();
    let bomb = ["<!DOCTYPE svg [<!ENTITY e0 \"0123456789\">", &entities, "]>"].concat().into_bytes();
    let classes: String = (0..20_000).map(|i| format!(".c{i}{{fill:#{i:06x}}}")).collect();
    let sheets = "style sheets too large";
    let cases = vec![
        ("groups, as deep as they can be", svg(&nested(490)), Area("a")),
        ("groups, a million", svg(&nested(1_000_000)), Refused("nested more than 500 deep")),
        ("entities", [bomb, svg("&e9;")].concat(), Refused("entities that expand")),
        ("use", svg(&format!("<defs><g id=\"g0\">{rect}</g>{uses}</defs><use href=\"#g9\"/>")), Refused("all references")),
        ("use of itself", svg("<g id=\"a\"><use href=\"#b\"/></g><g id=\"b\"><use href=\"#a\"/></g>"), Refused("within itself")),
        ("gzip", zip.finish().unwrap(), Refused("after decompression")),
        ("rules in one line", style(&classes), Refused(sheets)),
        ("rules that are none", style(&"a{;}".repeat(MANY)), Refused(sheets)),
        ("at-rules that are none", style(&"@".repeat(MANY)), Refused(sheets)),
        ("a rule of many declarations", style(&format!("a{{{}}}", "b:c;".repeat(MANY))), Refused(sheets)),
        ("a value of many numbers", style(&format!("a{{b:{}}}", "1 ".repeat(MANY))), Refused(sheets)),
        ("a style attribute", own("fill:red;".repeat(MANY)), Refused(sheets)),
        (
            "classes",
            svg(&format!("<style>{}</style>{}", ".a{}.b{x:y}\n".repeat(2000), format!("<g class='{}'/>", "x ".repeat(50_000)).repeat(50))),
            Refused(sheets),
        ),
        ("a style sheet as people write it", style(&classes[..40_000].replace('}', "}\n")), Area("a")),
        ("attributes of an element", attributes(4000), Refused("more than 512 attributes")),
        ("attributes", attributes(500), Holds("\"end\":true")),
        ("stops", svg(&format!("<linearGradient id=\"g\">{}</linearGradient>", "<stop/>".repeat(MANY))), Refused("stops")),
        ("nothing", svg(""), Holds("\"inks\":[]")),
    ];
    check("fill", cases.into_iter().map(|(name, input, right)| (name.to_owned(), input, right)).collect());
}
