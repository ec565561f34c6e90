//! Every id of a drawing is an area: where its element is painted, wherever that is. Small drawings, areas worked out by hand.

use runset::error::Error;
use runset::input;
use runset::job::{Job, Options, info};
use runset::scene::{Limits, Scene};

/// Left, top, right, bottom in pixels.
type Rect = [usize; 4];

const WIDTH: usize = 16;
const HEIGHT: usize = 8;

fn document(inside: &str) -> String {
    format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="{WIDTH}" height="{HEIGHT}">{inside}</svg>"#
    )
}

fn read(inside: &str) -> Result<(Scene, Vec<String>), Error> {
    let mut warnings = Vec::new();
    let scene = input::read(document(inside).into_bytes(), &Limits::default(), &mut warnings)?;
    Ok((scene, warnings.into_iter().map(|w| w.what).collect()))
}

/// The picture of an expression, `#` where it holds.
fn picture(scene: &Scene, expr: Option<&str>) -> String {
    let options = Options { expr: expr.map(str::to_owned), ..Options::default() };
    let job = Job::prepare(scene.clone(), &options, &mut Vec::new()).unwrap();
    let mut text = String::new();
    let mut rows = job.rows();
    while let Some(lines) = rows.next() {
        let mut row = vec!['.'; WIDTH];
        for run in lines.runs {
            row[run.start as usize..run.end as usize].fill(if expr.is_some() { '#' } else { char::from_digit(run.ink, 36).unwrap() });
        }
        let row: String = row.into_iter().chain(['\n']).collect();
        (0..lines.n).for_each(|_| text.push_str(&row));
    }
    text
}

/// The picture of a union of rectangles.
fn rects(rects: &[Rect]) -> String {
    let mut text = String::new();
    for y in 0..HEIGHT {
        text.extend((0..WIDTH).map(|x| {
            let within = |r: &Rect| (r[0]..r[2]).contains(&x) && (r[1]..r[3]).contains(&y);
            if rects.iter().any(within) { '#' } else { '.' }
        }));
        text.push('\n');
    }
    text
}

/// Checks the area of every id, in document order, and that there is no warning.
fn check(inside: &str, expected: &[(&str, &[Rect])]) {
    check_warned(inside, expected, &[]);
}

fn check_warned(inside: &str, expected: &[(&str, &[Rect])], warned: &[&str]) {
    let (scene, warnings) = read(inside).unwrap();
    let ids: Vec<&str> = scene.names().iter().map(|n| n.id.as_str()).collect();
    assert_eq!(ids, expected.iter().map(|e| e.0).collect::<Vec<_>>(), "{inside}");
    for (id, area) in expected {
        let found = picture(&scene, Some(&format!("\"{id}\"")));
        assert!(found == rects(area), "{inside}\n{id} is\n{found}expected\n{}", rects(area));
        assert_eq!(scene.is_empty(id), scene.named(id).unwrap().shapes.is_empty());
    }
    assert_eq!(warnings, warned, "{inside}");
}

const SQUARE: &str = r#"<rect id="r" width="2" height="2"/>"#;

#[test]
fn what_a_use_draws_counts_under_all_its_ids() {
    check(
        &format!(
            r##"<defs id="d"><g id="g">{SQUARE}<rect id="s" x="3" width="1" height="1"/></g></defs><use id="u" href="#g" x="8" y="4"/>"##
        ),
        &[
            ("d", &[]),
            ("g", &[[8, 4, 10, 6], [11, 4, 12, 5]]),
            ("r", &[[8, 4, 10, 6]]),
            ("s", &[[11, 4, 12, 5]]),
            ("u", &[[8, 4, 10, 6], [11, 4, 12, 5]]),
        ],
    );
    // Drawn where it stands, and twice more.
    check(
        &format!(
            r##"{SQUARE}<use id="u" href="#r" x="4"/><g id="g" transform="translate(8 2)"><use id="v" xlink:href="#r" transform="scale(2)"/></g>"##
        ),
        &[("r", &[[0, 0, 2, 2], [4, 0, 6, 2], [8, 2, 12, 6]]), ("u", &[[4, 0, 6, 2]]), ("g", &[[8, 2, 12, 6]]), ("v", &[[8, 2, 12, 6]])],
    );
    // A use of a use, and only a part of what stands in defs.
    check(
        &format!(
            r##"<defs><g id="a">{SQUARE}<use id="u" href="#r" x="3"/></g><rect id="never" width="9" height="9"/></defs><use id="v" href="#u" y="2"/><use id="w" href="#a" y="5"/>"##
        ),
        &[
            ("a", &[[0, 5, 2, 7], [3, 5, 5, 7]]),
            ("r", &[[3, 2, 5, 4], [0, 5, 2, 7], [3, 5, 5, 7]]),
            ("u", &[[3, 2, 5, 4], [3, 5, 5, 7]]),
            ("never", &[]),
            ("v", &[[3, 2, 5, 4]]),
            ("w", &[[0, 5, 2, 7], [3, 5, 5, 7]]),
        ],
    );
}

#[test]
fn symbols_and_nested_svgs_have_areas() {
    // The symbol's viewBox is doubled; it is clipped to 4 x 4.
    check(
        &format!(
            r##"<symbol id="s" viewBox="0 0 2 2">{SQUARE}<rect id="t" x="1" width="5" height="1"/></symbol><use id="u" href="#s" x="8" y="1" width="4" height="4"/>"##
        ),
        &[("s", &[[8, 1, 12, 5]]), ("r", &[[8, 1, 12, 5]]), ("t", &[[10, 1, 12, 3]]), ("u", &[[8, 1, 12, 5]])],
    );
    check(
        &format!(
            r#"<svg id="n" x="3" y="2" width="4" height="4" viewBox="1 1 2 2">{SQUARE}<rect id="t" x="2" y="2" width="5" height="5"/></svg>"#
        ),
        &[("n", &[[3, 2, 5, 4], [5, 4, 7, 6]]), ("r", &[[3, 2, 5, 4]]), ("t", &[[5, 4, 7, 6]])],
    );
    check(
        &format!(r##"<svg id="n" x="3" overflow="visible">{SQUARE}</svg><use id="u" href="#n" y="4"/>"##),
        &[("n", &[[3, 0, 5, 2], [3, 4, 5, 6]]), ("r", &[[3, 0, 5, 2], [3, 4, 5, 6]]), ("u", &[[3, 4, 5, 6]])],
    );
}

/// The library looks at the names of attributes where it should look at their namespaces.
#[test]
fn attributes_of_other_namespaces_are_not_svg_s() {
    let spaces = r#"xmlns:s="http://www.w3.org/2000/svg" xmlns:o="urn:other""#;
    check(
        &format!(
            r##"<g {spaces}><style>.k{{display:none}} #a{{display:none}}</style><g id="g" o:id="a" s:id="a" xml:id="a" o:class="k" o:style="display:none" s:display="none" xlink:x="5">
                <rect id="b" o:id="c" s:x="5" s:y="1" xlink:width="9" width="2" height="2"/></g>
            <defs><rect id="d" s:id="a" width="1" height="1"/></defs><use id="u" o:href="#b" xlink:href="#d" x="8"/></g>"##
        ),
        &[("g", &[[0, 0, 2, 2]]), ("b", &[[0, 0, 2, 2]]), ("d", &[[8, 0, 9, 1]]), ("u", &[[8, 0, 9, 1]])],
    );
    // The first element of that id, and not one that only looks so.
    check(
        &format!(
            r##"<g {spaces}><g o:id="r"><use id="u" href="#r" y="4"/></g><defs>{SQUARE}</defs><ellipse id="____" o:id____="1" o:id="r" rx="0"/></g>"##
        ),
        &[("u", &[[0, 4, 2, 6]]), ("r", &[[0, 4, 2, 6]]), ("____", &[])],
    );
}

#[test]
fn a_switch_draws_its_first_child_that_may_be() {
    check(
        &format!(
            r#"<switch id="w"><rect id="no" systemLanguage="xx" width="9" height="9"/>{SQUARE}<rect id="late" width="9" height="9"/></switch>"#
        ),
        &[("w", &[[0, 0, 2, 2]]), ("no", &[]), ("r", &[[0, 0, 2, 2]]), ("late", &[])],
    );
}

#[test]
fn what_cannot_be_seen_paints_nothing() {
    for inside in [
        r#"<rect id="r" width="2" height="2" display="none"/>"#,
        r#"<g style="display:none"><rect id="r" width="2" height="2"/></g>"#,
        r#"<style>.h{display:none}</style><rect id="r" class="h" width="2" height="2"/>"#,
        r#"<rect id="r" width="0" height="2"/>"#,
        r#"<circle id="r" r="0"/>"#,
        r#"<path id="r" d=""/>"#,
        r#"<rect id="r" width="2" height="2" visibility="hidden"/>"#,
        r#"<rect id="r" width="2" height="2" opacity="0"/>"#,
        r#"<rect id="r" width="2" height="2" fill-opacity="0"/>"#,
        r#"<rect id="r" width="2" height="2" fill="none"/>"#,
        r#"<g opacity="0%"><rect id="r" width="2" height="2"/></g>"#,
        r##"<defs><rect id="r" width="2" height="2" style="opacity:0"/></defs><use href="#r"/>"##,
        r##"<style>#r{opacity:0!important}</style><defs><rect id="r" width="2" height="2" style="opacity:1"/></defs><use href="#r"/>"##,
        r#"<clipPath id="r"><rect width="2" height="2"/></clipPath>"#,
        r#"<g transform="scale(0)"><rect id="r" width="2" height="2"/></g>"#,
    ] {
        check(inside, &[("r", &[])]);
    }
    // Hidden, but not what it holds.
    check(
        &format!(r#"<g id="g" visibility="hidden">{SQUARE}<rect id="s" visibility="visible" x="4" width="1" height="1"/></g>"#),
        &[("g", &[[4, 0, 5, 1]]), ("r", &[]), ("s", &[[4, 0, 5, 1]])],
    );
}

#[test]
fn of_equal_ids_the_first_counts() {
    let warned = ["\"r\": this id stands more than once: the first counts"];
    check_warned(
        &format!(
            r##"{SQUARE}<rect id="r" x="4" width="2" height="2"/><use id="u" href="#r" y="4"/><rect id="r" x="7" width="2" height="2"/>"##
        ),
        &[("r", &[[0, 0, 2, 2], [0, 4, 2, 6]]), ("u", &[[0, 4, 2, 6]])],
        &warned,
    );
    // The first is not drawn at all.
    check_warned(
        &format!(r#"<defs>{SQUARE}</defs><g id="g"><rect id="r" x="4" width="2" height="2"/></g>"#),
        &[("r", &[]), ("g", &[[4, 0, 6, 2]])],
        &warned,
    );
    // References lead to the first, and selectors still match all.
    check_warned(
        r##"<style>#c rect{visibility:visible}</style><clipPath id="c"><rect width="2" height="2"/></clipPath><clipPath id="c"><rect x="5" width="2" height="2"/></clipPath>
            <rect id="a" clip-path="url(#c)" width="9" height="9"/><g id="g" visibility="hidden"><g id="c"><rect id="b" x="10" width="1" height="1"/></g></g>"##,
        &[("c", &[]), ("a", &[[0, 0, 2, 2]]), ("g", &[[10, 0, 11, 1]]), ("b", &[[10, 0, 11, 1]])],
        &["\"c\": this id stands more than once: the first counts"],
    );
}

#[test]
fn markers_count_under_the_shape_and_under_their_own_ids() {
    // A line from (2, 4) to (10, 4) paints nothing itself; at its ends are squares of 2 x 2, the second one clipped to 1 x 1.
    check(
        r##"<marker id="m" markerUnits="userSpaceOnUse" markerWidth="2" markerHeight="2"><rect id="q" width="2" height="2"/></marker>
            <marker id="n" markerUnits="userSpaceOnUse" markerWidth="1" markerHeight="1"><g><rect id="o" width="2" height="2"/></g></marker>
            <path id="p" d="M2 4H10" marker-start="url(#m)" marker-end="url(#n)"/>"##,
        &[
            ("m", &[[2, 4, 4, 6]]),
            ("q", &[[2, 4, 4, 6]]),
            ("n", &[[10, 4, 11, 5]]),
            ("o", &[[10, 4, 11, 5]]),
            ("p", &[[2, 4, 4, 6], [10, 4, 11, 5]]),
        ],
    );
    check(
        r##"<style>.m{marker:url(#m)}</style><marker id="m" markerUnits="userSpaceOnUse" markerWidth="1" markerHeight="1"><rect width="1" height="1"/></marker>
            <g id="g" class="m" style="paint-order:markers"><polyline id="p" points="2,2 4,2 4,4"/></g>"##,
        // Of the triangle under the polyline no pixel centre but those right of the diagonal is inside: (3, 2).
        &[
            ("m", &[[2, 2, 3, 3], [4, 2, 5, 3], [4, 4, 5, 5]]),
            ("g", &[[2, 2, 5, 3], [3, 2, 4, 4], [4, 4, 5, 5]]),
            ("p", &[[2, 2, 5, 3], [3, 2, 4, 4], [4, 4, 5, 5]]),
        ],
    );
}

/// Each part of a text is where that text is painted when the rest of it has no paint.
#[test]
fn parts_of_a_text_have_areas() {
    let text = |fills: [&str; 4]| {
        let [a, b, c, d] = fills;
        format!(
            r#"<text id="t" font-size="8" y="7" fill="{a}" stroke-opacity=".999">i<tspan id="u" fill="{b}">l<tspan id="v" fill="{c}" style="fill-opacity:1">x</tspan></tspan><tspan id="w" fill="{d}">o</tspan></text>"#
        )
    };
    let (scene, warnings) = read(&text(["red"; 4])).unwrap();
    assert_eq!(warnings, Vec::<String>::new());
    let only = |fills: [&str; 4]| picture(&read(&text(fills)).unwrap().0, Some("art"));
    assert_eq!(picture(&scene, Some("t")), only(["red"; 4]));
    assert_eq!(picture(&scene, Some("u")), only(["none", "red", "red", "none"]));
    assert_eq!(picture(&scene, Some("v")), only(["none", "none", "red", "none"]));
    assert_eq!(picture(&scene, Some("w")), only(["none", "none", "none", "red"]));
    assert_ne!(picture(&scene, Some("v")), rects(&[]));
    // Under a use, in a clip path, and faint.
    let used = format!(r##"<defs>{}</defs><use id="x" href="#t" opacity=".5"/>"##, text(["red", "red", "red", "none"]));
    let (used, warnings) = read(&used).unwrap();
    assert_eq!(picture(&used, Some("v")), picture(&scene, Some("v")));
    assert_eq!(picture(&used, Some("x")), picture(&used, Some("t")));
    assert_eq!(warnings, ["\"x\": transparency is not drawn yet: painted opaque"]);
    let clip = format!(r##"<clipPath id="c">{}</clipPath><rect id="r" width="16" height="8" clip-path="url(#c)"/>"##, text(["red"; 4]));
    assert_eq!(picture(&read(&clip).unwrap().0, Some("r")), only(["red"; 4]));
}

#[test]
fn a_clip_path_that_is_not_there_cuts_nothing() {
    check_warned(
        r##"<rect id="b" x="5" width="4" height="4" clip-path="url(#none)"/>"##,
        &[("b", &[[5, 0, 9, 4]])],
        &["\"b\": \"#none\" is not in the document"],
    );
}

#[test]
fn clip_paths_cut_what_is_painted() {
    type Case = (&'static str, &'static [(&'static str, &'static [Rect])]);
    let table: &[Case] = &[
        (
            r##"<clipPath id="c"><rect x="1" y="1" width="3" height="9"/></clipPath><g id="g" clip-path="url(#c)"><rect id="a" width="2" height="2"/><rect id="b" x="3" width="5" height="3"/></g>"##,
            &[("c", &[]), ("g", &[[1, 1, 2, 2], [3, 1, 4, 3]]), ("a", &[[1, 1, 2, 2]]), ("b", &[[3, 1, 4, 3]])],
        ),
        // Clips of ancestors, each in its own coordinates, and a transform on the clip path.
        (
            r##"<clipPath id="c"><rect width="4" height="4"/></clipPath><clipPath id="d" transform="translate(1 1)"><rect width="9" height="9"/></clipPath>
                <g clip-path="url(#c)" transform="translate(2 0)"><g id="g" transform="translate(2 1)" clip-path="url(#d)"><rect id="a" width="9" height="9"/></g></g>"##,
            &[("c", &[]), ("d", &[]), ("g", &[[5, 2, 6, 4]]), ("a", &[[5, 2, 6, 4]])],
        ),
        // A clip path on a clip path, and on what a clip path holds.
        (
            r##"<clipPath id="c" clip-path="url(#d)"><rect width="4" height="4"/><rect x="6" width="4" height="4" clip-path="url(#e)"/></clipPath>
                <clipPath id="d"><rect x="1" width="9" height="2"/></clipPath><clipPath id="e"><rect x="7" y="1" width="2" height="9"/></clipPath>
                <rect id="a" width="16" height="8" clip-path="url(#c)"/>"##,
            &[("c", &[]), ("d", &[]), ("e", &[]), ("a", &[[1, 0, 4, 2], [7, 1, 9, 2]])],
        ),
        // clip-rule: a hole in one, none in the other, which fill-rule does not change.
        (
            r##"<clipPath id="c"><path clip-rule="evenodd" d="M0 0H6V6H0zM2 2H4V4H2z"/></clipPath><clipPath id="d"><path fill-rule="evenodd" d="M0 0H6V6H0zM2 2H4V4H2z"/></clipPath>
                <rect id="a" width="16" height="8" clip-path="url(#c)"/><rect id="b" width="16" height="8" clip-path="url(#d)"/>"##,
            &[("c", &[]), ("d", &[]), ("a", &[[0, 0, 6, 2], [0, 4, 6, 6], [0, 0, 2, 6], [4, 0, 6, 6]]), ("b", &[[0, 0, 6, 6]])],
        ),
        // Units of the object's box: the right half of each.
        (
            r##"<clipPath id="c" clipPathUnits="objectBoundingBox"><rect x=".5" width=".5" height="1"/></clipPath>
                <rect id="a" width="4" height="4" clip-path="url(#c)"/><g id="g" clip-path="url(#c)"><rect x="6" width="2" height="2"/><rect id="b" x="9" width="1" height="3"/></g>"##,
            &[("c", &[]), ("a", &[[2, 0, 4, 4]]), ("g", &[[9, 0, 10, 3]]), ("b", &[[9, 0, 10, 3]])],
        ),
        // A use in a clip path, which paints nothing of what it refers to.
        (
            r##"<defs><rect id="q" width="3" height="3"/></defs><clipPath id="c"><use id="u" href="#q" x="1" y="1"/></clipPath><circle id="a" r="99" clip-path="url(#c)"/>"##,
            &[("q", &[]), ("c", &[]), ("u", &[]), ("a", &[[1, 1, 4, 4]])],
        ),
        // One that holds nothing.
        (r##"<clipPath id="c"/><rect id="a" width="4" height="4" clip-path="url(#c)"/>"##, &[("c", &[]), ("a", &[])]),
        // A hidden child of a clip path does not count; its opacity does not matter, nor that of its paint.
        (
            r##"<clipPath id="c"><rect width="4" height="4" opacity="0" fill="none"/><rect width="8" height="8" visibility="hidden"/></clipPath><rect id="a" width="9" height="9" clip-path="url(#c)"/>"##,
            &[("c", &[]), ("a", &[[0, 0, 4, 4]])],
        ),
        // On a use, and in what is used.
        (
            r##"<clipPath id="c"><rect width="3" height="3"/></clipPath><defs><g id="g" clip-path="url(#c)"><rect id="q" x="1" width="9" height="9"/></g></defs><use id="u" href="#g" x="5" y="5" clip-path="url(#c)" transform="translate(0 -4)"/><use id="v" href="#g"/>"##,
            // The x and y of a use move its clip path too.
            &[
                ("c", &[]),
                ("g", &[[1, 0, 3, 3], [6, 1, 8, 4]]),
                ("q", &[[1, 0, 3, 3], [6, 1, 8, 4]]),
                ("u", &[[6, 1, 8, 4]]),
                ("v", &[[1, 0, 3, 3]]),
            ],
        ),
    ];
    for (inside, expected) in table {
        check(inside, expected);
    }
}

#[test]
fn black_and_white_masks_cut_what_is_painted() {
    let all = r#"x="0" y="0" width="16" height="8" maskUnits="userSpaceOnUse""#;
    let masked = r##"<rect id="a" width="16" height="8" mask="url(#m)"/>"##;
    let table: &[(String, &[Rect])] = &[
        // White adds, black takes away, in painting order.
        (
            format!(r#"<mask id="m" {all}><g fill="white"><rect width="6" height="6"/><rect x="2" y="2" width="2" height="2" fill="black"/><rect x="3" y="3" width="5" height="1"/></g></mask>"#),
            &[[0, 0, 6, 2], [0, 4, 6, 6], [0, 0, 2, 6], [4, 0, 6, 6], [3, 3, 8, 4]],
        ),
        // Alpha: any colour lets light pass.
        (format!(r#"<mask id="m" {all} mask-type="alpha"><rect width="3" height="3"/></mask>"#), &[[0, 0, 3, 3]]),
        // Within the mask's rectangle.
        (
            r#"<mask id="m" x="1" y="1" width="4" height="3" maskUnits="userSpaceOnUse"><rect width="16" height="8" fill="white"/></mask>"#.to_owned(),
            &[[1, 1, 5, 4]],
        ),
        // Units of the object's box, of rectangle and content.
        (
            r#"<mask id="m" x="0" y="0" width=".5" height="1" maskContentUnits="objectBoundingBox"><rect y=".5" width="1" height=".5" fill="white"/></mask>"#.to_owned(),
            &[[0, 4, 8, 8]],
        ),
        // A mask on a mask, and a clip path in one.
        (
            format!(
                r##"<mask id="m" {all} mask="url(#n)"><rect width="9" height="4" fill="#fff" clip-path="url(#c)"/></mask><mask {all} id="n"><rect x="2" width="9" height="9" fill="white"/></mask><clipPath id="c"><rect width="5" height="2"/></clipPath>"##
            ),
            &[[2, 0, 5, 2]],
        ),
        // Black alone, and what is too faint to count.
        (format!(r#"<mask id="m" {all}><rect width="9" height="9"/></mask>"#), &[]),
    ];
    for (mask, expected) in table {
        let (scene, warnings) = read(&format!("{mask}{masked}")).unwrap();
        assert_eq!((picture(&scene, Some("a")), warnings), (rects(expected), Vec::new()), "{mask}");
    }
    // Greys are rounded, with a warning.
    let grey = format!(
        r##"<mask id="m" {all}><rect width="2" height="2" fill="#808080"/><rect id="d" x="4" width="2" height="2" fill="#7f7f7f"/><g id="h" opacity=".6"><rect x="8" width="2" height="2" fill="white"/></g><rect id="i" x="12" width="2" height="2" fill="white" fill-opacity=".4"/></mask>{masked}"##
    );
    let (scene, warnings) = read(&grey).unwrap();
    assert_eq!(picture(&scene, Some("a")), rects(&[[0, 0, 2, 2], [8, 0, 10, 2]]));
    let what = "this part of a mask is neither black nor white: rounded to the nearest";
    assert_eq!(
        warnings,
        [
            format!("an element in \"m\": {what}"),
            format!("\"d\": {what}"),
            format!("an element in \"h\": {what}"),
            format!("\"i\": {what}")
        ]
    );
}

#[test]
fn layers_are_cut_as_names_are() {
    let (scene, _) = read(
        r##"<clipPath id="c"><rect x="1" y="1" width="6" height="2"/></clipPath><rect width="2" height="4" fill="red"/>
            <g clip-path="url(#c)"><rect width="3" height="4" fill="red"/><rect x="3" width="2" height="4" fill="blue"/></g><rect x="6" width="2" height="4" fill="blue"/>"##,
    )
    .unwrap();
    let expected = "\
00....11........
0001111.........
0001111.........
00....11........
................
................
................
................
"
    .replace("0001111.", "00011.11");
    assert_eq!(picture(&scene, None), expected);
    assert_eq!(picture(&scene, Some("art")), expected.replace(['0', '1'], "#"));
}

#[test]
fn warnings_name_what_stands_under_a_use() {
    let (_, warnings) = read(
        r##"<defs><g id="s"><rect id="r" width="3" height="3" fill-opacity=".5"/><rect width="3" height="3" fill="url(#l)"/></g><linearGradient id="l"><stop stop-color="red"/><stop offset="1"/></linearGradient></defs><use href="#s"/>"##,
    )
    .unwrap();
    assert_eq!(
        warnings,
        [
            "an element in \"s\": gradients are not drawn yet: filled with the first stop's #ff0000",
            "\"r\": transparency is not drawn yet: painted opaque"
        ]
    );
}

/// Quotes, entities, prefixes, a style sheet, and elements that stand in an entity.
#[test]
fn documents_of_all_kinds_are_tagged() {
    let text = r##"<!DOCTYPE s:svg [<!ENTITY two "2"><!ENTITY part '<s:rect id="e" width="1" height="1"/>'>]>
<s:svg xmlns:s="http://www.w3.org/2000/svg" xmlns:__="urn:own" width="16" height="8"><s:style>s|rect,#a{fill:red}</s:style>
<s:defs><s:g
 id='a'><s:rect id="b" style='fill:#00f; opacity:1' width='&two;' height="&two;"/>&part;</s:g><s:rect id="b"/></s:defs><s:use href="#a"/></s:svg>"##;
    let mut warnings = Vec::new();
    let scene = input::read(text.as_bytes().to_vec(), &Limits::default(), &mut warnings).unwrap();
    for (id, area) in [("a", [0, 0, 2, 2]), ("b", [0, 0, 2, 2])] {
        assert_eq!(picture(&scene, Some(id)), rects(&[area]), "{id}");
    }
    assert_eq!(warnings.len(), 1);
}

/// A clip path that holds the whole page takes no part in the counting.
#[test]
fn a_clip_that_holds_the_page_is_true_everywhere() {
    let clip = |d: &str| {
        format!(r##"<clipPath id="c"><path d="{d}"/></clipPath><g id="g" clip-path="url(#c)"><path id="p" d="M2 2H6V6H2z"/></g>"##)
    };
    let toggles = |d: &str| {
        let (scene, _) = read(&clip(d)).unwrap();
        assert_eq!(picture(&scene, Some("p")), rects(&[[2, 2, 6, 6]]), "{d}");
        let job = Job::prepare(scene, &Options::default(), &mut Vec::new()).unwrap();
        let stats = job.render(runset::encode::by_name("ndjson").unwrap(), 1, &mut Vec::new(), &mut |_| ()).unwrap();
        (stats.edges, stats.toggles)
    };
    let bare = toggles("M0 0H16V8H0z");
    // Both rectangles are counted; of the four upright lines of the square two are crossed, on one line that is counted.
    assert_eq!(bare.0, 8);
    for d in ["M-5-5V99H99V-5z", "M16 8H0V0H16z", "M.4 .4H15.6V7.6H.4z"] {
        assert_eq!(toggles(d), bare, "{d}");
    }
    // These cut, if only beside the square.
    for d in ["M.6 0H16V8H.6z", "M0 0H16V8H1z", "M0 0H16V8H0zM9 0V4H12z", "M0 0H7V8H0z"] {
        assert!(toggles(d).1 > bare.1, "{d}");
    }
}

#[test]
fn info_tells_bounds_edges_and_inks() {
    let (scene, _) = read(
        r##"<clipPath id="c"><rect x="1" y="1" width="3" height="9"/></clipPath>
            <g id="g" clip-path="url(#c)"><rect id="a" width="2" height="2" fill="#123456"/><rect id="b" x="3" width="5" height="3"/></g>
            <g id="h"><use href="#a" x="9.6"/><rect id="d" width="1" height="1" fill="#123456"/></g><g id="e"/>"##,
    )
    .unwrap();
    let found: Vec<_> = info(&scene)
        .unwrap()
        .ids
        .into_iter()
        .map(|e| (e.id, e.kind, e.depth, e.bounds.map(|b| b.map(|x| (x * 10.0).round())), e.edges, e.ink))
        .collect();
    let entry = |id: &str, kind, depth, bounds: Option<[f64; 4]>, edges, ink: Option<&str>| {
        (id.to_owned(), kind, depth, bounds, edges, ink.map(str::to_owned))
    };
    let ink = Some("#123456");
    assert_eq!(
        found,
        [
            entry("c", "clipPath", 0, None, 0, None),
            entry("g", "group", 0, Some([10., 10., 40., 30.]), 8, None),
            entry("a", "rect", 1, Some([10., 0., 116., 20.]), 8, ink),
            entry("b", "rect", 1, Some([30., 10., 40., 30.]), 4, Some("#000000")),
            entry("h", "group", 0, Some([0., 0., 116., 20.]), 8, ink),
            entry("d", "rect", 1, Some([0., 0., 10., 10.]), 4, ink),
            entry("e", "group", 0, None, 0, None),
        ]
    );
}

/// Bombs of references, deep and wide cuts: a scene or one line, soon.
#[test]
fn hostile_references_end_soon() {
    let nested = |n: usize, around: &dyn Fn(usize) -> String, inside: &str| {
        format!("{}{inside}{}", (0..n).map(around).collect::<String>(), "</g>".repeat(n))
    };
    let all = r#"x="0" y="0" width="16" height="8" maskUnits="userSpaceOnUse""#;
    let named = |n: usize| (0..n).map(|i| format!("<rect id='r{i}' width='1' height='1'/>")).collect::<String>();
    let cases = [
        ("ids under a use", format!("<defs><g id='d'>{}</g></defs><use href='#d'/>", named(50_000))),
        ("many uses of ids", format!("<defs><g id='d'>{}</g></defs>{}", named(100), "<use href='#d'/>".repeat(1_000))),
        ("named groups", nested(490, &|i| format!("<g id='g{i}'>"), &"<rect width='1' height='1'/>".repeat(50_000))),
        (
            "groups cut at each level",
            format!(
                "<clipPath id='c'><rect width='9' height='9'/></clipPath>{}",
                nested(
                    240,
                    &|i| format!("<g id='g{i}' clip-path='url(#c)' transform='translate(.1)'>"),
                    &"<rect width='1' height='1'/>".repeat(20_000)
                )
            ),
        ),
        (
            "a mask that goes to and fro",
            format!(
                "<mask id='m' {all}>{}</mask><rect width='16' height='8' mask='url(#m)'/>",
                "<rect width='9' height='9' fill='white'/><rect width='5' height='5'/>".repeat(20_000)
            ),
        ),
        ("one clip path, many places", {
            let path = "L1 1L2 9".repeat(500);
            let groups: String =
                (0..3000).map(|i| format!("<g clip-path='url(#c)' transform='translate({i})'><rect width='1' height='1'/></g>")).collect();
            format!("<clipPath id='c'><path d='M0 0{path}'/></clipPath>{groups}")
        }),
        ("equal ids", format!("<g>{}</g>", "<rect id='a' width='1' height='1'/>".repeat(100_000))),
        ("underscores", format!("<!--{}--><g id='a'/><g id='a'/>", "_ ".repeat(5_000_000))),
        ("a bomb with ids", {
            let level = |i: usize| format!("<g id='l{i}'>{}</g>", format!("<use id='u{i}' href='#l{}'/>", i + 1).repeat(10));
            format!(
                "<defs>{}<g id='l9'><rect id='r' width='1' height='1'/></g></defs><use href='#l0'/>",
                (0..9).map(level).collect::<String>()
            )
        }),
        ("a page of 10^9", "<svg viewBox='0 0 1e9 1e9'><g id='a'><rect id='b' width='1e9' height='1'/></g></svg>".to_owned()),
    ];
    for (name, inside) in cases {
        let start = std::time::Instant::now();
        let result =
            read(&inside).and_then(|(scene, _)| info(&scene).and_then(|_| Job::prepare(scene, &Options::default(), &mut Vec::new())));
        // Each takes less than a second of processor time; the rest is for a busy machine.
        assert!(start.elapsed().as_secs_f64() < 20.0, "{name} took {:?}", start.elapsed());
        if let Err(error) = result {
            assert!(!error.to_string().contains('\n') && !error.what.contains("the SVG library fails"), "{name}: {error}");
        }
    }
}
