//! Text: outlines where the font's own measures say, and what is said when a font or a character is missing.

use runset::error::{Error, Kind};
use runset::input::Fonts;
use runset::job::info;
use runset::scene::{Limits, Scene};

const FONT: &[u8] = include_bytes!("../src/input/svg/font/NotoSans-Regular.ttf");

fn read_with(inside: &str, fonts: &Fonts) -> (Scene, Vec<String>) {
    let text = format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="500" height="100">{inside}</svg>"#);
    let mut warnings = Vec::new();
    let scene = runset::input::read_with(text.into_bytes(), &Limits::default(), fonts, &mut warnings).unwrap();
    (scene, warnings.into_iter().map(|w| w.what).collect())
}

fn warnings(inside: &str) -> Vec<String> {
    read_with(inside, &Fonts::default()).1
}

/// Left, top, right, bottom of what the id `t` paints.
fn bounds(inside: &str) -> [f64; 4] {
    let (scene, _) = read_with(inside, &Fonts::default());
    let info = info(&scene).unwrap();
    info.ids.iter().find(|entry| entry.id == "t").unwrap().bounds.unwrap()
}

fn near(found: [f64; 4], expected: [f64; 4]) {
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.02), "{found:?}, expected {expected:?}");
}

/// A number of the font's table `tag`, two bytes at `at`.
fn measure(tag: &[u8; 4], at: usize) -> f64 {
    let word = |at: usize| u16::from_be_bytes([FONT[at], FONT[at + 1]]);
    let record = (0..usize::from(word(4))).map(|i| 12 + 16 * i).find(|&r| FONT[r..r + 4] == tag[..]).unwrap();
    let table = usize::from(word(record + 8)) << 16 | usize::from(word(record + 10));
    f64::from(word(table + at))
}

#[test]
fn glyphs_are_as_large_as_the_font_says() {
    // Units an em, and the height of capital letters.
    let (em, capital) = (measure(b"head", 18), measure(b"OS/2", 88));
    assert_eq!((em, capital), (1000.0, 714.0));
    for (text, size) in [("H", 100.0), ("IH", 50.0)] {
        let [left, top, right, bottom] = bounds(&format!(r#"<text id="t" x="10" y="90" font-size="{size}">{text}</text>"#));
        assert!((top - (90.0 - size * capital / em)).abs() < 0.01 && (bottom - 90.0).abs() < 0.01, "{top} {bottom}");
        assert!(left > 10.0 && right > left && right < 110.0);
    }
    let scripts = ["Grüße, ÆØÅ ąćęłńśźż", "Ελληνικά", "Кириллица", "€ £ ½ – …"];
    for script in scripts {
        assert_eq!(warnings(&format!(r#"<text y="50">{script}</text>"#)), [""; 0], "{script}");
    }
}

#[test]
fn text_is_placed_as_svg_says() {
    let plain = bounds(r#"<text id="t" x="10" y="90" font-size="50">HH</text>"#);
    let moved = |dx: f64, dy: f64, wider: f64| [plain[0] + dx, plain[1] + dy, plain[2] + dx + wider, plain[3] + dy];
    let width = plain[2] - plain[0];
    near(bounds(r#"<text id="t" x="10" y="90" font-size="50" letter-spacing="20">HH</text>"#), moved(0.0, 0.0, 20.0));
    near(bounds(r#"<text id="t" x="10" y="90" dx="0 5" font-size="50">HH</text>"#), moved(0.0, 0.0, 5.0));
    near(bounds(r#"<g transform="translate(3 -4)"><text id="t" x="10" y="90" font-size="50">HH</text></g>"#), moved(3.0, -4.0, 0.0));
    near(bounds(r#"<text id="t" font-size="50"><tspan x="10" y="90">H</tspan>H</text>"#), plain);
    near(
        bounds(r##"<path id="p" d="M10 90H400" fill="none"/><text id="t" font-size="50"><textPath href="#p">HH</textPath></text>"##)
            .map(f64::round),
        plain.map(f64::round),
    );
    // A quarter turn around the origin of each character.
    let turned = bounds(r#"<text id="t" x="100" y="50" rotate="90" font-size="50">H</text>"#);
    let upright = bounds(r#"<text id="t" x="100" y="50" font-size="50">H</text>"#);
    near(turned, [100.0 - (upright[3] - 50.0), 50.0 + upright[0] - 100.0, 100.0 + 50.0 - upright[1], 50.0 + upright[2] - 100.0]);
    let end = bounds(r#"<text id="t" x="300" y="90" text-anchor="end" font-size="50">HH</text>"#);
    assert!((end[2] - end[0] - width).abs() < 0.02 && end[2] < 300.0 && end[2] > 290.0, "{end:?}");
    // A stroke with miters reaches half its width further on all sides of an H.
    near(
        bounds(r#"<text id="t" x="10" y="90" font-size="50" stroke="red" stroke-width="4">HH</text>"#),
        [plain[0] - 2.0, plain[1] - 2.0, plain[2] + 2.0, plain[3] + 2.0],
    );
}

#[test]
fn what_stands_in_is_said() {
    let table: &[(&str, &[&str])] = &[
        (r#"<text id="t" y="9">x</text>"#, &[]),
        (r#"<text id="t" y="9" font-family="serif">x</text>"#, &[]),
        (r#"<text id="t" y="9" font-family="'Noto Sans', Arial">x</text>"#, &[]),
        (
            r#"<text id="t" y="9" style="font-family:Foo Bar, sans-serif">x</text>"#,
            &["\"t\": the font \"Foo Bar\" is not there: \"Noto Sans\" stands in (add it with --font)"],
        ),
        (
            r#"<g id="g"><text y="9">x<tspan font-family="Foo">y</tspan><tspan font-family="Foo">z</tspan></text></g>"#,
            &["an element in \"g\": the font \"Foo\" is not there: \"Noto Sans\" stands in (add it with --font)"],
        ),
        (
            r#"<text id="t" y="9" font-weight="bold">x</text>"#,
            &["\"t\": \"Noto Sans\" has no bold here: drawn without (add it with --font)"],
        ),
        (
            r#"<text id="t" y="9" font-weight="600" font-style="italic">x</text>"#,
            &["\"t\": \"Noto Sans\" has no bold italic here: drawn without (add it with --font)"],
        ),
        (
            r#"<text id="t" y="9">a漢b漢</text>"#,
            &["\"t\": no font has \"漢\" (U+6F22): the font's sign for a missing character is drawn (add one with --font)"],
        ),
        (r#"<text id="t" y="9" display="none" font-family="Foo">漢</text>"#, &[]),
        (r#"<defs><text id="t" y="9" font-family="Foo">漢</text></defs>"#, &[]),
    ];
    for (inside, expected) in table {
        assert_eq!(warnings(inside), *expected, "{inside}");
    }
}

#[test]
fn fonts_are_added() {
    // The built-in font under another name.
    let name = |text: &str| text.encode_utf16().flat_map(u16::to_be_bytes).collect::<Vec<u8>>();
    let (old, new) = (name("Noto Sans"), name("Xoto Sans"));
    let mut file = FONT.to_vec();
    let mut at = 0;
    while let Some(i) = file[at..].windows(old.len()).position(|w| w == old) {
        file[at + i..at + i + new.len()].copy_from_slice(&new);
        at += i + new.len();
    }
    let inside = r#"<text id="t" y="9" font-family="Xoto Sans">x</text>"#;
    assert_eq!(warnings(inside).len(), 1);
    let mut fonts = Fonts::default();
    fonts.add(file).unwrap();
    assert_eq!(read_with(inside, &fonts).1, [""; 0]);
    for file in [&b""[..], b"not a font", &FONT[..100]] {
        let error: Error = Fonts::default().add(file.to_vec()).unwrap_err();
        assert_eq!((error.kind, error.what.as_str()), (Kind::Malformed, "no font that can be read: give a TrueType or OpenType file"));
    }
}

/// Hostile text: bounded time, no panic.
#[test]
fn long_text_takes_bounded_time() {
    let started = std::time::Instant::now();
    for inside in [
        format!(r#"<text y="9">{}</text>"#, "abc ".repeat(8_000)),
        format!(r#"<text y="9">{}</text>"#, "<tspan>a</tspan>".repeat(1_000)),
        format!(r#"<text y="9">a{}</text>"#, "\u{301}".repeat(5_000)),
        format!(r#"<text y="9">{}</text>"#, "\u{202e}א1".repeat(2_000)),
        r#"<text y="9" font-size="1e30">a</text><text y="9" font-size="-1">a</text><text y="1e17" textLength="1e17">ab</text>"#.to_owned(),
    ] {
        read_with(&inside, &Fonts::default());
    }
    assert!(started.elapsed().as_secs() < 60, "{:?}", started.elapsed());
    for (inside, spans) in [("a".repeat(200_000), 0), ("<tspan>a</tspan>".repeat(10_000), 1)] {
        let text = format!("<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'>\n<text id='t'>{inside}</text></svg>");
        let error = runset::input::read(text.into_bytes(), &Limits::default(), &mut Vec::new()).unwrap_err();
        assert_eq!(error.to_string(), "2:1: \"t\": text too long to lay out: split it into several text elements", "{spans}");
        assert_eq!(error.kind, Kind::Limit);
    }
}
