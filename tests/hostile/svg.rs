//! Drawings that mean harm.

use std::net::TcpListener;

use super::*;

const RECT: &str = "<rect width='5' height='5'/>";

const TOO_MANY: Right = Refused("all references are written out");

/// A path of that many bytes, two vertices in eleven.
fn path(bytes: usize, attributes: &str, before: &str) -> Vec<u8> {
    svg(&format!("{before}<path {attributes} d='M0 0{}'/>", "L9.5 1L3 99".repeat(bytes / 11)))
}

/// `n` elements, each made from its number and the next one's.
fn chain(n: usize, link: impl Fn(usize, usize) -> String) -> String {
    (0..n).map(|i| link(i, i + 1)).collect()
}

fn check_all<const N: usize>(cases: [(&str, Vec<u8>, Right); N]) {
    check("fill", cases.into_iter().map(|(name, input, right)| (name.to_owned(), input, right)).collect());
}

#[test]
fn entities_and_use() {
    let doubling = |levels: usize| {
        let groups = chain(levels, |i, j| format!("<g id='g{i}'><use href='#g{j}'/><use href='#g{j}' x='1'/></g>"));
        svg(&format!("<defs>{groups}<g id='g{levels}'>{RECT}</g></defs><use href='#g0'/>"))
    };
    let entity = |value: &str, content: &str| [format!("<!DOCTYPE svg [<!ENTITY a \"{value}\">]>").into_bytes(), svg(content)].concat();
    let shape = RECT.replace("<rect", "<rect xmlns='http://www.w3.org/2000/svg'");
    let long = format!("<path id='p' d='M0 0{}'/>{}", "L9.5 1L3 99".repeat(50_000), "<use href='#p'/>".repeat(20_000));
    check_all([
        ("quadratic entities", entity(&"x".repeat(1_000_000), &"&a;".repeat(300_000)), Refused("entities that expand")),
        ("elements by entity", entity(&shape, &"&a;".repeat(50_000)), Drawn),
        ("an entity that is itself", entity("&a;", "&a;"), Refused("entity reference loop")),
        (
            "an entity from a file",
            b"<!DOCTYPE svg [<!ENTITY e SYSTEM 'file:///etc/passwd'>]><svg>&e;</svg>".to_vec(),
            Refused("unknown entity"),
        ),
        ("use of itself", svg("<use id='u' href='#u'/>"), Refused("within itself")),
        ("use of an ancestor", svg("<g id='a'><g><use href='#a'/></g></g>"), Refused("within itself")),
        (
            "a ring of symbols",
            svg("<symbol id='s'><use href='#t'/></symbol><symbol id='t'><use href='#s'/></symbol>"),
            Refused("within itself"),
        ),
        ("use doubling 60 times", doubling(60), TOO_MANY),
        ("use doubling 22 times", doubling(22), TOO_MANY),
        ("use doubling 14 times", doubling(14), Drawn),
        ("a long chain of use", svg(&chain(300, |i, j| format!("<g id='g{i}'><use href='#g{j}'/></g>"))), Refused("deep")),
        ("many shapes, many times", svg(&format!("<g id='g'>{}</g>{}", RECT.repeat(5000), "<use href='#g'/>".repeat(5000))), TOO_MANY),
        ("a long path, many times", svg(&long), TOO_MANY),
    ]);
}

#[test]
fn nesting_and_sizes() {
    let sized =
        |attributes: &str, content: &str| format!("<svg xmlns='http://www.w3.org/2000/svg' {attributes}>{content}</svg>").into_bytes();
    let deep = |n: usize, open: &str, name: &str| svg(&format!("{}{RECT}{}", open.repeat(n), format!("</{name}>").repeat(n)));
    check_all([
        ("a million open groups", "<svg>".repeat(1_000_000).into_bytes(), Refused("")),
        ("a million nested groups", deep(1_000_000, "<g>", "g"), Refused("nested more than")),
        ("nested svgs", deep(400, "<svg width='50' height='50' viewBox='0 0 9 9'>", "svg"), Drawn),
        ("nested opacity", deep(450, "<g opacity='.5' transform='scale(.999)'>", "g"), Warned("transparency")),
        (
            "nested tspans",
            svg(&format!("<text>{}x{}</text>", "<tspan>".repeat(100_000), "</tspan>".repeat(100_000))),
            Refused("nested more than"),
        ),
        ("a view box of 10^9", sized("viewBox='0 0 1e9 1e9'", "<circle r='5e8'/>"), Refused("the page would be")),
        ("a page of 10^9", sized("width='1e9' height='1e9'", "<circle r='5e8'/>"), Refused("the page would be")),
        ("a view box of 10^9 on a small page", sized("width='99' height='99' viewBox='0 0 1e9 1e9'", "<circle r='5e8'/>"), Drawn),
        ("a view box of 10^-9", sized("width='99' height='99' viewBox='0 0 1e-9 1e-9'", "<circle r='5e-10'/>"), Drawn),
        ("no size", sized("width='0' height='9'", ""), Refused("has no size")),
        ("10^300", svg("<rect width='1e300' height='5'/>"), Refused("more than 18 digits")),
        ("huge arcs", svg("<path d='M0 0A1e15 1e15 0 1 1 9 9'/><circle r='1e17'/>"), Drawn),
        ("a million transforms", svg(&format!("<g transform='{}'>{RECT}</g>", "rotate(1)".repeat(1_000_000))), Drawn),
    ]);
}

#[test]
fn much_of_one_thing() {
    check_all([
        ("5 MB of path data", path(5_000_000, "", ""), Drawn),
        ("half a million subpaths", svg(&format!("<path d='{}'/>", "M1 1h9v9z".repeat(500_000))), Drawn),
        ("150,000 shapes", svg(&RECT.repeat(150_000)), Drawn),
        ("100,000 equal ids", svg(&"<rect id='a' width='5' height='5'/>".repeat(100_000)), Warned("this id stands more than once")),
        ("an id of 5 MB", svg(&format!("<rect id='{}' width='5' height='5'/>", "é".repeat(2_500_000))), Drawn),
        ("a marker on much of a path", path(500_000, "marker-mid='url(#m)'", "<marker id='m'><path d='M0 0h1v1z'/></marker>"), Drawn),
        (
            "multiplying markers on rectangles",
            svg(&format!(
                "{}<rect width='9' height='9' marker-mid='url(#m0)'/>",
                chain(100, |i, j| format!("<marker id='m{i}'><rect width='9' height='9' marker-mid='url(#m{j})'/></marker>"))
            )),
            TOO_MANY,
        ),
        (
            "multiplying markers",
            svg(&format!(
                "{}<path d='M0 0L1 1L2 2' marker-mid='url(#m0)'/>",
                chain(100, |i, j| format!("<marker id='m{i}'><path d='M0 0L1 1L2 2L3 3L4 4' marker-mid='url(#m{j})'/></marker>"))
            )),
            TOO_MANY,
        ),
    ]);
}

#[test]
fn strokes() {
    let dashed = |length: &str, dashes: &str| svg(&format!("<path d='M0 0H{length}' stroke='red' stroke-dasharray='{dashes}'/>"));
    let stroked = |attributes: &str| svg(&format!("<path d='M0 0L9 9 9.00001 0L9 5' fill='none' stroke='red' {attributes}/>"));
    check_all([
        ("3 MB of a stroke", path(3_000_000, "fill='none' stroke='red'", ""), Drawn),
        ("a trillion dashes", dashed("1e6", "1e-6"), Either(&Drawn, &Refused("dashes"))),
        ("ten million dashes on the page", dashed("16", "8e-7"), Either(&Drawn, &Refused("dashes"))),
        ("a million dashes", dashed("16", "8e-6"), Drawn),
        ("a list of a million dashes", dashed("100", &"1 2 ".repeat(500_000)), Drawn),
        ("a width of 10^17", stroked("stroke-width='1e17' stroke-linejoin='round' stroke-linecap='round'"), Drawn),
        ("a width of 10^-17", stroked("stroke-width='1e-17' stroke-linejoin='round' stroke-linecap='round'"), Drawn),
        ("a miter of 10^17", stroked("stroke-width='9' stroke-miterlimit='1e17'"), Drawn),
        ("round joins, enlarged", stroked("transform='scale(1e12)' stroke-width='5' stroke-linejoin='round'"), Drawn),
        ("flat", stroked("transform='scale(1e12 1e-12)' stroke-width='5' stroke-linejoin='round'"), Drawn),
    ]);
}

#[test]
fn clips_and_masks() {
    let clips = chain(400, |i, j| format!("<clipPath id='c{i}' clip-path='url(#c{j})'>{RECT}</clipPath>"));
    let masks = chain(60, |i, j| {
        let rect = format!("<rect width='9' height='9' fill='#fff' mask='url(#m{j})'/>");
        format!("<mask id='m{i}'>{rect}{rect}</mask>")
    });
    let clip = |content: &str| format!("<clipPath id='c'>{content}</clipPath>");
    let clipped = "<rect width='9' height='9' clip-path='url(#c)'/>";
    let ring = "<clipPath id='c' clip-path='url(#d)'/><clipPath id='d' clip-path='url(#c)'/>";
    let nested = ["<g clip-path='url(#c)'>".repeat(200), RECT.repeat(2000), "</g>".repeat(200)].concat();
    check_all([
        ("a chain of clips", svg(&format!("{clips}{}", clipped.replace("#c", "#c0"))), Drawn),
        ("a ring of clips", svg(&format!("{ring}{clipped}")), Refused("within itself")),
        ("a large clip on many shapes", svg(&(clip(&RECT.repeat(1000)) + &clipped.repeat(1000))), Either(&Drawn, &TOO_MANY)),
        ("doubling masks", svg(&format!("{masks}<rect width='9' height='9' mask='url(#m0)'/>")), TOO_MANY),
        ("clips on nested groups", svg(&(clip("<circle r='50'/>") + &nested)), Drawn),
    ]);
}

#[test]
fn texts() {
    let along = format!("<path id='p' d='M0 0{}'/>", "L9.5 1L3 99".repeat(9000));
    check_all([
        ("20 KB", svg(&format!("<text y='9'>{}</text>", "long words ".repeat(2000))), Drawn),
        ("3 MB", svg(&format!("<text y='9'>{}</text>", "long words ".repeat(300_000))), Refused("split it into several text elements")),
        ("many tspans", svg(&format!("<text y='9'>{}</text>", "<tspan dx='1'>a</tspan>".repeat(5000))), Either(&Drawn, &Refused("text"))),
        ("positions without end", svg(&format!("<text x='{}'>ab</text>", "1 ".repeat(1_000_000))), Drawn),
        ("letters of 10^9", svg("<text font-size='1e9' letter-spacing='1e9' y='9'>big</text>"), Drawn),
        ("along a long path", svg(&format!("{along}<text><textPath href='#p'>{}</textPath></text>", "along ".repeat(200))), Drawn),
    ]);
}

#[test]
fn compressed() {
    let gzip = |bytes: &[u8]| {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    };
    // A hundred members, each of as many spaces.
    let bomb = gzip(&vec![b' '; 100 << 20]).repeat(100);
    let shapes = gzip(&svg(&RECT.repeat(4_000_000)));
    check_all([
        ("10 GB of spaces", bomb, Refused("after decompression")),
        ("110 MB of shapes", shapes, Refused("more than 3000000 tags")),
        ("a gzip in a gzip", gzip(&gzip(&svg(RECT))), Refused("expected an SVG")),
        ("a gzip cut short", gzip(&svg(&RECT.repeat(1000)))[..60].to_vec(), Refused("broken gzip data")),
    ]);
}

/// What is large itself. A vertex takes five bytes of the path and fifty as an edge; what the XML and the SVG library make of a rectangle of seventy
/// bytes is most of what it takes.
#[test]
fn a_hundred_megabytes() {
    let points = "L9.50,1.25 3.75,99.00 ".repeat(100);
    let map: String = (0..45_000).map(|i| format!("<path id='p{i}' d='M{} 0{points}Z'/>", i % 16)).collect();
    let rect =
        |i: usize| format!("<rect id='r{i}' x='{}' y='{}' width='3' height='2' fill='#{:06x}'/>\n", i * 7 % 997, i * 11 % 991, i % 4096);
    let inputs = [
        ("100 MB of path data", path(100_000_000, "id='p'", ""), [7, 21], 80),
        ("100 MB of a map", svg(&map), [4, 15], 60),
        ("900,000 rectangles", svg(&(0..900_000).map(rect).collect::<String>()), [24, 24], 200),
    ];
    for (name, input, bytes, nanoseconds) in inputs {
        for (command, bytes) in ["info", "fill"].into_iter().zip(bytes) {
            check_within(Share { bytes, nanoseconds }, command, vec![(name.to_owned(), input.clone(), Drawn)]);
        }
    }
}

/// What is outside is named in a warning and never asked for: nobody knocks, not even at a door that is open.
#[test]
fn nothing_outside_is_asked_for() {
    let door = TcpListener::bind("127.0.0.1:0").unwrap();
    door.set_nonblocking(true).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("outside.svg");
    fs::write(&file, svg("<rect id='r' width='16' height='16'/>")).unwrap();
    let file = file.to_str().unwrap();
    let addresses = [format!("http://{}/outside.svg", door.local_addr().unwrap()), file.to_owned(), format!("file://{file}")];
    let warned = Warned("is outside the document and not read");
    let mut cases = Vec::new();
    for address in addresses {
        let inside = [
            format!("<image id='i' width='9' height='9' href='{address}'/>"),
            format!("<use id='u' href='{address}#r'/>"),
            format!("<filter id='f'><feImage id='g' href='{address}'/></filter><rect width='9' height='9' filter='url(#f)'/>"),
            format!(
                "<linearGradient id='l' xlink:href='{address}#r' xmlns:xlink='http://www.w3.org/1999/xlink'/><rect width='9' height='9' fill='url(#l)'/>"
            ),
            format!("<pattern id='p' href='{address}#r'/><rect width='9' height='9' fill='url(#p)'/>"),
            format!("<text y='9'><textPath href='{address}#r'>text</textPath></text>"),
            format!("<style>@import '{address}';</style>"),
            format!("<style>@font-face {{ font-family: f; src: url({address}) }}</style><text y='9' font-family='f'>text</text>"),
            format!("<style>rect {{ fill: url({address}#r) }}</style><rect width='9' height='9'/>"),
        ];
        let properties = ["fill", "stroke", "clip-path", "mask", "filter", "marker-start", "marker-mid", "marker-end"];
        let attributes = properties.map(|p| format!("<path d='M0 0H9V9' {p}='url({address}#r)'/>"));
        let styles = properties.map(|p| format!("<path d='M0 0H9V9' style='{p}:url(&quot;{address}#r&quot;)'/>"));
        for inside in inside.into_iter().chain(attributes).chain(styles) {
            cases.push((inside.clone(), svg(&inside), warned));
        }
    }
    check("fill", cases);
    assert_eq!(door.accept().unwrap_err().kind(), std::io::ErrorKind::WouldBlock);
}
