//! Drawings that mean harm: each ends in bounded CPU time, with the line or the warning that the table gives.
//!
//! One test, so that the time of the process is that of a case. `RUNSET_EFFORT=10` adds those of 100 MB.

#![allow(clippy::unwrap_used)] // all of this is tests

use std::io::Write;
use std::net::TcpListener;

use runset::input;
use runset::job::{Job, Options, Size};
use runset::scene::Limits;

/// CPU seconds of this process, all threads.
fn cpu() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
    let fields: Vec<&str> = stat.rsplit_once(')').unwrap().1.split_whitespace().collect();
    // Fields 14 and 15 of proc(5), in ticks of 1/100 s, counted here from the third.
    (fields[11].parse::<f64>().unwrap() + fields[12].parse::<f64>().unwrap()) / 100.0
}

fn svg(inside: &str) -> Vec<u8> {
    let head = r#"<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="100" height="100">"#;
    format!("{head}{inside}</svg>").into_bytes()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// Reads, prepares and draws, 200 pixels wide: the error's line or the warnings', and the CPU time.
fn draw(document: Vec<u8>) -> (Result<Vec<String>, String>, f64) {
    let start = cpu();
    let mut warnings = Vec::new();
    let options = Options { size: Size::Pixels { width: Some(200), height: None }, ..Options::default() };
    let job = input::read(document, &Limits::default(), &mut warnings).and_then(|scene| Job::prepare(scene, &options, &mut warnings));
    let end = job.map(|job| {
        let mut rows = job.rows();
        while rows.next().is_some() {}
    });
    let end = end.map(|()| warnings.into_iter().map(|w| w.what).collect()).map_err(|e| e.to_string());
    (end, cpu() - start)
}

/// A hostile drawing.
struct Case {
    name: &'static str,
    document: Vec<u8>,
    /// What must be in the error's line, or in a warning if it begins with `~`; empty if it is just drawn. Alternatives with `|` between them.
    says: &'static str,
    /// CPU seconds that it may take.
    seconds: f64,
}

fn case(name: &'static str, document: Vec<u8>, says: &'static str) -> Case {
    Case { name, document, says, seconds: 2.0 }
}

impl Case {
    fn within(self, seconds: f64) -> Case {
        Case { seconds, ..self }
    }
}

fn judge(case: Case) -> Result<(), String> {
    let Case { name, document, says, seconds } = case;
    let megabytes = document.len() as f64 / 1e6;
    let (end, took) = draw(document);
    let short = |line: &String| line.chars().take(150).collect::<String>();
    match &end {
        Ok(warnings) => {
            println!("{name}: {took:.2} s for {megabytes:.1} MB, drawn, {} warnings {:?}", warnings.len(), warnings.first().map(short))
        }
        Err(line) => println!("{name}: {took:.2} s for {megabytes:.1} MB, {}", short(line)),
    }
    let ok = says.split('|').any(|says| match (&end, says.strip_prefix('~')) {
        (Ok(warnings), Some(what)) => warnings.iter().any(|w| w.contains(what)),
        (Ok(_), None) => says.is_empty(),
        (Err(line), None) => !says.is_empty() && line.contains(says),
        (Err(_), Some(_)) => false,
    });
    let lines = match &end {
        Ok(warnings) => warnings.iter().collect(),
        Err(line) => vec![line],
    };
    if lines.iter().any(|l| l.contains('\n') || l.chars().count() > 800) {
        return Err(format!("{name}: a message of several lines, or of more than one can read"));
    }
    if !ok {
        return Err(format!("{name}: expected {says:?}, found {:?}", end.map(|w| w.iter().take(3).map(short).collect::<Vec<_>>())));
    }
    if took > seconds { Err(format!("{name}: {took:.2} s of CPU time, not {seconds} s")) } else { Ok(()) }
}

#[test]
fn hostile_drawings_end_in_time_with_one_clear_line() {
    let effort: u32 = std::env::var("RUNSET_EFFORT").ok().and_then(|e| e.parse().ok()).unwrap_or(1);
    let failures: Vec<String> = cases(effort).into_iter().filter_map(|case| judge(case()).err()).collect();
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

/// Documents are made one after the other: together they do not fit.
fn cases(effort: u32) -> Vec<Box<dyn Fn() -> Case>> {
    fn laughs(levels: usize) -> String {
        let entities: String = (0..levels).map(|i| format!("<!ENTITY l{} '{}'>", i + 1, format!("&l{i};").repeat(10))).collect();
        format!(
            "<!DOCTYPE svg [<!ENTITY l0 'lol'>{entities}]><svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'>&l{levels};</svg>"
        )
    }
    fn doubling(levels: usize, leaf: &str) -> Vec<u8> {
        let groups = (0..levels).map(|i| format!("<g id='g{i}'><use href='#g{0}'/><use href='#g{0}' x='1'/></g>", i + 1));
        svg(&format!("<defs>{}<g id='g{levels}'>{leaf}</g></defs><use href='#g0'/>", groups.collect::<String>()))
    }
    fn path(bytes: usize, attributes: &str, before: &str) -> Vec<u8> {
        svg(&format!("{before}<path id='p' {attributes} d='M0 0{}'/>", "L9.5 1L3 99".repeat(bytes / 11)))
    }
    const RECT: &str = "<rect width='5' height='5'/>";
    let mut cases: Vec<Box<dyn Fn() -> Case>> = vec![
        // Entities.
        Box::new(|| case("a billion laughs", laughs(9).into_bytes(), "entities that expand to more than")),
        Box::new(|| case("a thousand laughs", laughs(3).into_bytes(), "|entity reference loop")),
        Box::new(|| {
            let text = format!("<!DOCTYPE svg [<!ENTITY a '{}'>]><svg>{}</svg>", "x".repeat(1_000_000), "&a;".repeat(300_000));
            case("quadratic entities", text.into_bytes(), "entities that expand to more than")
        }),
        Box::new(|| {
            let text = format!(
                "<!DOCTYPE svg [<!ENTITY r \"{RECT}\">]><svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'>{}</svg>",
                "&r;".repeat(50_000)
            );
            case("elements by entity", text.into_bytes(), "")
        }),
        Box::new(|| {
            case(
                "an entity from a file",
                b"<!DOCTYPE svg [<!ENTITY e SYSTEM 'file:///etc/passwd'>]><svg>&e;</svg>".to_vec(),
                "unknown entity",
            )
        }),
        // use
        Box::new(|| case("use of itself", svg("<use id='u' href='#u'/>"), "is drawn within itself")),
        Box::new(|| {
            case(
                "use in a ring",
                svg("<g id='a'><use href='#b'/></g><g id='b'><use href='#c'/></g><g id='c'><use href='#a'/></g>"),
                "is drawn within itself",
            )
        }),
        Box::new(|| case("use of an ancestor", svg("<g id='a'><g><use href='#a'/></g></g>"), "is drawn within itself")),
        Box::new(|| {
            case(
                "use in a ring through symbols",
                svg("<symbol id='s'><use href='#t'/></symbol><symbol id='t'><use href='#s'/></symbol><use href='#s'/>"),
                "is drawn within itself",
            )
        }),
        Box::new(|| {
            case(
                "use in a ring that nothing draws",
                svg("<defs><g id='a'><use href='#b'/></g><g id='b'><use href='#a'/></g></defs>"),
                "is drawn within itself",
            )
        }),
        Box::new(|| case("use doubling 60 times", doubling(60, RECT), "when all references are written out")),
        Box::new(|| case("use doubling 22 times", doubling(22, RECT), "more than")),
        Box::new(|| case("use doubling 14 times", doubling(14, RECT), "")),
        Box::new(|| {
            let uses = (0..300).map(|i| format!("<g id='g{i}'><use href='#g{}'/></g>", i + 1)).collect::<String>();
            case("use in a long chain", svg(&uses), "deep")
        }),
        Box::new(|| {
            case(
                "use of many shapes many times",
                svg(&format!("<g id='g'>{}</g>{}", RECT.repeat(5000), "<use href='#g'/>".repeat(5000))),
                "more than",
            )
        }),
        Box::new(|| {
            case(
                "use of a long path many times",
                svg(&format!("<path id='p' d='M0 0{}'/>{}", "L9.5 1L3 99".repeat(50_000), "<use href='#p'/>".repeat(20_000))),
                "more than",
            )
        }),
        // Nesting.
        Box::new(|| case("a million nested groups", svg(&("<g>".repeat(1_000_000) + &"</g>".repeat(1_000_000))), "nested more than")),
        Box::new(|| case("a million open groups", svg(&"<g>".repeat(1_000_000)), "nested more than|too early|not well-formed")),
        Box::new(|| {
            case(
                "groups as deep as allowed",
                svg(&format!("{}{RECT}{}", "<g id='a' opacity='.5' transform='scale(.999)'>".repeat(450), "</g>".repeat(450))),
                "~this id stands more than once",
            )
        }),
        Box::new(|| {
            case(
                "nested svgs",
                svg(&format!("{}{RECT}{}", "<svg width='50' height='50' viewBox='0 0 9 9'>".repeat(400), "</svg>".repeat(400))),
                "",
            )
        }),
        Box::new(|| {
            case(
                "nested tspans",
                svg(&format!("<text>{}x{}</text>", "<tspan>".repeat(100_000), "</tspan>".repeat(100_000))),
                "nested more than",
            )
        }),
        // Sizes.
        Box::new(|| {
            case(
                "a view box of 10^9",
                b"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 1e9 1e9'><circle cx='5e8' cy='5e8' r='5e8'/></svg>".to_vec(),
                "",
            )
        }),
        Box::new(|| {
            case(
                "a view box of 10^9 by 1",
                b"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 1 1e9'><rect width='1' height='1e9'/></svg>".to_vec(),
                "the page would be",
            )
        }),
        Box::new(|| case("no size", b"<svg xmlns='http://www.w3.org/2000/svg' width='0' height='9'/>".to_vec(), "the svg has no size")),
        Box::new(|| case("10^300", svg("<rect width='1e300' height='5'/>"), "a number of more than 18 digits")),
        Box::new(|| case("huge arcs", svg("<path d='M0 0A1e15 1e15 0 1 1 9 9'/><circle cx='5' cy='5' r='1e17'/>"), "")),
        // Much of one thing.
        Box::new(|| case("10 MB of path data", path(10_000_000, "", ""), "")),
        Box::new(|| case("10 MB of a stroked path", path(10_000_000, "fill='none' stroke='red'", ""), "").within(6.0)),
        Box::new(|| case("a path of a million subpaths", svg(&format!("<path d='{}'/>", "M1 1h9v9z".repeat(1_000_000))), "")),
        Box::new(|| case("300,000 shapes", svg(&RECT.repeat(300_000)), "")),
        Box::new(|| {
            case(
                "300,000 ids that are the same",
                svg(&"<rect id='a' width='5' height='5'/>".repeat(300_000)),
                "~this id stands more than once",
            )
        }),
        Box::new(|| {
            case("an id of 5 MB", svg(&format!("<rect id='{}' width='5' height='5' filter='url(#none)'/>", "é".repeat(2_500_000))), "")
        }),
        Box::new(|| {
            case(
                "half a million attributes",
                format!("<svg {}/>", (0..500_000).map(|i| format!("a{i}='' ")).collect::<String>()).into_bytes(),
                "attributes",
            )
        }),
        Box::new(|| {
            case("a list of a million transforms", svg(&format!("<g transform='{}'>{RECT}</g>", "rotate(1)".repeat(1_000_000))), "")
        }),
        // Strokes.
        Box::new(|| case("a trillion dashes", svg("<path id='p' d='M0 0H1e6' stroke='red' stroke-dasharray='1e-6'/>"), "|dash")),
        Box::new(|| case("a million dashes", svg("<path id='p' d='M0 0H1e5' stroke='red' stroke-dasharray='.05'/>"), "")),
        Box::new(|| {
            case(
                "a list of a million dashes",
                svg(&format!("<path d='M0 0H100' stroke='red' stroke-dasharray='{}'/>", "1 2 ".repeat(500_000))),
                "",
            )
        }),
        Box::new(|| {
            case(
                "a stroke of 10^17",
                svg("<path d='M0 0L9 9' stroke='red' stroke-width='1e17' stroke-linejoin='round' stroke-linecap='round'/>"),
                "",
            )
        }),
        Box::new(|| {
            case(
                "a miter of 10^17",
                svg("<path d='M0 0L50 .00001 0 0L9 5' fill='none' stroke='red' stroke-miterlimit='1e17' stroke-width='9'/>"),
                "",
            )
        }),
        Box::new(|| {
            case(
                "round joins under a huge scale",
                svg("<g transform='scale(1e12)'><path d='M0 0L9 9 0 5' stroke='red' stroke-width='5' stroke-linejoin='round'/></g>"),
                "",
            )
        }),
        // Clips and masks.
        Box::new(|| {
            let clips = (0..400).map(|i| format!("<clipPath id='c{i}' clip-path='url(#c{})'>{RECT}</clipPath>", i + 1)).collect::<String>();
            case("a chain of clips", svg(&format!("{clips}<rect width='9' height='9' clip-path='url(#c0)'/>")), "")
        }),
        Box::new(|| {
            case(
                "a ring of clips",
                svg(
                    "<clipPath id='a' clip-path='url(#b)'/><clipPath id='b' clip-path='url(#a)'/><rect clip-path='url(#a)' width='9' height='9'/>",
                ),
                "is drawn within itself",
            )
        }),
        Box::new(|| {
            let clip = format!("<clipPath id='c'>{}</clipPath>", RECT.repeat(2000));
            case(
                "a large clip on many shapes",
                svg(&format!("{clip}{}", "<rect width='9' height='9' clip-path='url(#c)'/>".repeat(2000))),
                "|more than",
            )
        }),
        Box::new(|| {
            let masks = (0..60).map(|i| format!("<mask id='m{i}'><rect width='9' height='9' fill='#fff' mask='url(#m{0})'/><rect width='9' height='9' mask='url(#m{0})'/></mask>", i + 1));
            case(
                "doubling masks",
                svg(&format!("{}<rect width='9' height='9' mask='url(#m0)'/>", masks.collect::<String>())),
                "when all references are written out",
            )
        }),
        Box::new(|| {
            case(
                "clips on nested groups",
                svg(&format!(
                    "<clipPath id='c'><circle r='50'/></clipPath>{}{}{}",
                    "<g clip-path='url(#c)'>".repeat(200),
                    RECT.repeat(2000),
                    "</g>".repeat(200)
                )),
                "",
            )
        }),
        // Markers.
        Box::new(|| {
            case(
                "a marker on 10 MB of path",
                path(10_000_000, "marker-mid='url(#m)'", "<marker id='m'><path d='M0 0h1v1z'/></marker>"),
                "|more than",
            )
        }),
        Box::new(|| {
            let markers =
                (0..100).map(|i| format!("<marker id='m{i}'><path d='M0 0L1 1L2 2L3 3L4 4' marker-mid='url(#m{})'/></marker>", i + 1));
            case(
                "multiplying markers",
                svg(&format!("{}<path d='M0 0L1 1L2 2' marker-mid='url(#m0)'/>", markers.collect::<String>())),
                "when all references are written out",
            )
        }),
        // Text.
        Box::new(|| case("a text of 100 KB", svg(&format!("<text y='50'>{}</text>", "long words ".repeat(10_000))), "")),
        Box::new(|| case("a text of 10 MB", svg(&format!("<text y='50'>{}</text>", "long words ".repeat(1_000_000))), "|text")),
        Box::new(|| case("many tspans", svg(&format!("<text y='50'>{}</text>", "<tspan dx='1'>a</tspan>".repeat(10_000))), "")),
        Box::new(|| case("positions without end", svg(&format!("<text x='{}'>ab</text>", "1 ".repeat(1_000_000))), "")),
        Box::new(|| case("letters of 10^9", svg("<text font-size='1e9' letter-spacing='1e9' y='50'>big</text>"), "")),
        Box::new(|| {
            case(
                "a text along 1 MB of path",
                svg(&format!(
                    "<path id='p' d='M0 0{}'/><text><textPath href='#p'>{}</textPath></text>",
                    "L9.5 1L3 99".repeat(90_000),
                    "along ".repeat(500)
                )),
                "",
            )
        }),
        // Style sheets.
        Box::new(|| {
            case(
                "descendant selectors",
                svg(&format!("<style>{}z{{fill:red}}</style>{}{}", "g ".repeat(20), "<g>".repeat(400), "</g>".repeat(400))),
                "style sheets too large",
            )
        }),
        Box::new(|| {
            case(
                "rules by elements",
                svg(&format!(
                    "<style>{}</style>{}",
                    (0..20_000).map(|i| format!(".a{i}{{fill:red}}")).collect::<String>(),
                    RECT.repeat(100_000)
                )),
                "style sheets too large",
            )
        }),
        Box::new(|| {
            case(
                "selectors by declarations",
                svg(&format!("<style>{}b{{{}}}</style>", "a,".repeat(300_000), "c:d;".repeat(300_000))),
                "style sheets too large",
            )
        }),
        // Compressed.
        Box::new(|| case("a gigabyte in a gzip", gzip(&vec![b' '; 1 << 30]), "larger than 134217728 bytes after decompression")),
        Box::new(|| case("a gzip in a gzip", gzip(&gzip(&svg(RECT))), "the input is neither")),
        Box::new(|| case("a gzip cut short", gzip(&svg(&RECT.repeat(1000)))[..60].to_vec(), "broken gzip data")),
    ];
    if effort >= 10 {
        cases.push(Box::new(|| case("100 MB of path data", path(100_000_000, "", ""), "").within(20.0)));
        cases.push(Box::new(|| case("100 MB of a stroked path", path(100_000_000, "fill='none' stroke='red'", ""), "").within(60.0)));
        cases.push(Box::new(|| case("3 million shapes", svg(&RECT.repeat(2_900_000)), "more than").within(20.0)));
    }
    cases
}

/// What is outside is named in a warning and never asked for: nobody knocks, not even at a door that is open.
#[test]
fn nothing_outside_is_asked_for() {
    let door = TcpListener::bind("127.0.0.1:0").unwrap();
    door.set_nonblocking(true).unwrap();
    let outside = format!("http://{}/outside.svg", door.local_addr().unwrap());
    let folder = env!("CARGO_TARGET_TMPDIR");
    let file = format!("{folder}/outside.svg");
    std::fs::write(&file, svg("<rect id='r' width='99' height='99'/>")).unwrap();
    let mut silent = Vec::new();
    for address in [outside.as_str(), &file, &format!("file://{file}"), "outside.svg"] {
        for (id, inside) in [
            ("i", format!("<image id='i' width='9' height='9' href='{address}'/>")),
            ("i", format!("<image id='i' width='9' height='9' xlink:href='{address}'/>")),
            ("u", format!("<use id='u' href='{address}#r'/>")),
            (
                "f",
                format!("<filter id='f'><feImage id='f' href='{address}'/></filter><rect id='r' width='9' height='9' filter='url(#f)'/>"),
            ),
            ("p", format!("<pattern id='p' href='{address}#r' width='5' height='5'/><rect id='r' width='9' height='9' fill='url(#p)'/>")),
            ("s", format!("<style id='s'>@import url({address});</style>")),
            ("c", format!("<rect id='c' width='9' height='9' clip-path='url({address}#c)'/>")),
            ("m", format!("<rect id='m' width='9' height='9' style='mask:url({address}#m)'/>")),
            ("q", format!("<rect id='q' width='9' height='9' fill='url({address}#g)'/>")),
        ] {
            let (end, _) = draw(svg(&inside));
            let warnings = end.unwrap();
            let told = |w: &String| w.contains(&format!("\"{id}\"")) && w.contains("outside the document");
            if !warnings.iter().any(told) {
                silent.push(format!("{inside}: {warnings:?}"));
            }
        }
    }
    assert!(silent.is_empty(), "\n{}", silent.join("\n"));
    assert_eq!(door.accept().unwrap_err().kind(), std::io::ErrorKind::WouldBlock);
}
