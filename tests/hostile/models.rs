//! Models that mean harm: `runset solid` ends within time and memory, with a picture or one line.

use super::{MANY, Right, Share, check, check_within, random};
use Right::{Drawn, Either, Refused, Warned};

fn cases<const N: usize>(cases: [(&str, String, Right); N]) -> Vec<(String, Vec<u8>, Right)> {
    cases.into_iter().map(|(name, text, right)| (name.to_owned(), text.into_bytes(), right)).collect()
}

/// `n` times what is open, then what is within, then as often what closes it.
fn nested(open: &str, inner: &str, n: usize) -> String {
    [open.repeat(n), inner.to_owned(), "}".repeat(n)].concat()
}

fn matrix(rows: &str, inner: &str) -> String {
    format!("multmatrix([{rows}, [0, 0, 0, 1]]) {{ {inner} }}")
}

fn scaled(by: &str) -> String {
    matrix(&format!("[{by}, 0, 0, 0], [0, {by}, 0, 0], [0, 0, {by}, 0]"), "cube();")
}

fn listed<T>(items: impl Iterator<Item = T>, write: impl Fn(T) -> String) -> String {
    items.map(write).collect::<Vec<_>>().join(",")
}

const FLAT: Right = Warned("make it flat");

const DEEP: usize = 1_000_000;

#[test]
fn trees_that_are_wrong_or_deep() {
    check(
        "solid",
        cases([
            ("never closed", "union() { cube(1);".into(), Refused("1:9: this { is never closed")),
            ("closed too often", "cube(1); }".into(), Refused("closes nothing")),
            ("an unknown module", "cube(1); fooo(2);".into(), Refused("1:10: unknown module \"fooo\"")),
            ("a list never closed", format!("cube({}", "[".repeat(DEEP)), Refused("expected")),
            ("a million deep", nested("union(){", "cube();", DEEP), Refused("more than 100000 deep")),
            ("a million deep, never closed", "difference(){".repeat(DEEP), Refused("more than 100000 deep")),
            ("unions, as deep as they can be", nested("union(){", "cube();", 99_000), Drawn),
            ("colours, as deep as they can be", nested("color(\"red\"){", "cube();", 99_000), Drawn),
            ("empty differences, deep", nested("difference(){", "group();", 99_000), Warned("the model is empty")),
            ("hulls of hulls", nested("hull(){", "cube();", 20_000), Drawn),
            ("hulls of hulls and more", nested("hull(){sphere();", "cube();", 1_000), Drawn),
            (
                "projections of extrusions",
                nested("linear_extrude(height=1){projection(cut=false){", "cube();}", 500) + &"}".repeat(499),
                Either(&Drawn, &Refused("")),
            ),
            ("nothing, often", "group();".repeat(MANY), Warned("the model is empty")),
            ("cubes that coincide", format!("union(){{{}}}", "cube(9);".repeat(500)), Drawn),
            ("cubes without each other", nested("difference(){cube(9);", "cube(3);", 500), Drawn),
        ]),
    );
}

#[test]
fn numbers_that_are_none_or_huge() {
    let flat = FLAT;
    check(
        "solid",
        cases([
            ("NaN in a matrix", scaled("nan"), Refused("the matrix must be of finite numbers")),
            ("infinity in a matrix", scaled("1e999"), Refused("the matrix must be of finite numbers")),
            ("a singular matrix", scaled("0"), flat),
            ("rows that are the same", matrix("[1, 1, 1, 0], [1, 1, 1, 0], [1, 1, 1, 0]", "cube();"), flat),
            ("a matrix of large numbers", scaled("1e200"), Refused("coordinates past 1e30")),
            (
                "matrices that overflow",
                matrix("[1e200, 0, 0, 0], [0, 1e200, 0, 0], [0, 0, 1e200, 0]", &scaled("1e200")),
                Either(&Refused("1:"), &FLAT),
            ),
            ("matrices that vanish", matrix("[1e-200, 0, 0, 0], [0, 1e-200, 0, 0], [0, 0, 1e-200, 0]", &scaled("1e-200")), flat),
            ("a cube of nothing", "cube(0);".into(), Warned("the model is empty")),
            ("a cube of next to nothing", "cube(5e-324);".into(), Warned("the model is empty")),
            ("long and thin", "cube([1e20, 1, 1e-20]);".into(), Warned("the model is empty")),
            ("far apart", "cube(); multmatrix([[1, 0, 0, 1e29], [0, 1, 0, 0], [0, 0, 1, 0]]) { cube(); }".into(), Drawn),
            ("a size past 1e30", "cube(1e31);".into(), Refused("coordinates past 1e30")),
            ("sides", "sphere($fn = 1e300, r = 1);".into(), Refused("more than 100000 sides")),
            ("sides of nothing", "cylinder($fn = -5, $fa = 0, $fs = 0, r = 1, h = 1);".into(), Either(&Drawn, &Refused("1:1:"))),
            ("faces", "sphere($fn = 50000, r = 1);".into(), Refused("more than 4000000 faces")),
            ("cubes", "cube();".repeat(DEEP), Refused("more than 4000000 faces")),
            ("slices", "linear_extrude(height = 1, twist = 1e9) { square(1); }".into(), Refused("more than 100000 slices")),
            ("an index", "polyhedron(points = [[0, 0, 0]], faces = [[0, 1e18, 0]]);".into(), Refused("1:")),
            ("an index below 0", "polyhedron(points = [[0, 0, 0]], faces = [[0, -1, 0]]);".into(), Refused("there is no point -1")),
        ]),
    );
}

/// What is large itself: for each byte of it 1 us and 150 bytes.
const LARGE: Share = Share { bytes: 150, nanoseconds: 1000 };

#[test]
fn faces_of_many_corners() {
    let mut random = random();
    let point = |p: [u64; 3]| format!("[{},{},{}]", p[0], p[1], p[2]);
    // A comb: teeth up, and back along its foot.
    let n = 2 * MANY as u64;
    let comb: Vec<[u64; 2]> = (0..n).map(|i| [i / 2 * 2 + i % 2, i % 2 * 1000 + 1]).chain([[n, 0], [0, 0]]).collect();
    let side = |i: u64| {
        let (k, next) = (n + 2, (i + 1) % (n + 2));
        format!("[{},{},{},{}]", next, i, k + i, k + next)
    };
    let level = |z: u64| listed(comb.iter(), |p| point([p[0], p[1], z]));
    let ends = [listed(0..n + 2, |i| i.to_string()), listed((n + 2..2 * n + 4).rev(), |i| i.to_string())];
    let prism = format!("polyhedron(points=[{},{}],faces=[[{}],[{}],{}]);", level(0), level(1), ends[0], ends[1], listed(0..n + 2, side));
    let outline = format!("linear_extrude(height=1){{polygon(points=[{}]);}}", listed(comb.iter(), |p| format!("[{},{}]", p[0], p[1])));
    let mut ring = |n: usize, size: u64, high: u64| {
        let points: Vec<[u64; 3]> = (0..n).map(|_| [random(size), random(size), random(high)]).collect();
        format!("polyhedron(points=[{}],faces=[[{}]]);", listed(points.iter(), |p| point(*p)), listed(0..n, |i| i.to_string()))
    };
    let corners =
        |ring: String| format!("polyhedron(points=[[0,0,0],[1,0,0],[0,1,0],[0,0,1]],faces=[[{ring}],[0,1,2],[0,2,3],[0,3,1],[1,3,2]]);");
    check_within(
        LARGE,
        "solid",
        cases([
            ("a concave face", prism, Drawn),
            ("a concave outline", outline, Drawn),
            ("a ring that meets itself", ring(9_000, 9, 1), Drawn),
            ("a ring that meets itself and is not plane", ring(500, 99, 3), Drawn),
            ("the same corners again and again", corners("0,1,".repeat(MANY) + "0"), Drawn),
            ("no area", corners("0,0,0],[1,1],[2],[],[0,1,0".to_owned()), Drawn),
            (
                "outlines that cross",
                "linear_extrude(height=1){polygon(points=[".to_owned()
                    + &listed(0..3000_u64, |i| format!("[{},{}]", i * 7919 % 10_007, i * 104_729 % 10_009))
                    + "]);}",
                Refused("cross too often"),
            ),
        ]),
    );
    // Read, and its surface put right; its million triangles that cross are not drawn.
    check_within(
        LARGE,
        "info",
        cases([("a long ring that meets itself and is not plane", ring(MANY, 99, 3), Warned("cut from its first corner"))]),
    );
}

#[test]
fn faces_that_coincide() {
    let faces =
        |n: usize, faces: &str| format!("polyhedron(points=[[0,0,0],[1,0,0],[0,1,0],[0,0,1]],faces=[{}]);", vec![faces; n].join(","));
    check_within(
        LARGE,
        "solid",
        cases([
            ("both sides of a triangle", faces(50_000, "[0,1,2],[2,1,0]"), Drawn),
            ("a triangle", faces(500, "[0,1,2]"), Warned("open edges")),
        ]),
    );
    check_within(LARGE, "info", cases([("a million triangles", faces(1_000_000, "[0,1,2]"), Warned("open edges"))]));
}

/// A binary STL of triangles.
fn stl(head: &[u8], count: u32, triangles: &[[f32; 9]]) -> Vec<u8> {
    let mut bytes = head.to_vec();
    bytes.resize(80, 0);
    bytes.extend(count.to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        bytes.extend(triangle.iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn meshes_that_are_wrong() {
    let corner = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0_f32]];
    let triangle = |[a, b, c]: [usize; 3]| {
        let mut numbers = [0.0; 9];
        [a, b, c].iter().enumerate().for_each(|(i, k)| numbers[3 * i..3 * i + 3].copy_from_slice(&corner[*k]));
        numbers
    };
    let tetrahedron = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(triangle);
    let whole = stl(b"x", 4, &tetrahedron);
    let with = |number: f32| {
        let mut triangles = tetrahedron;
        triangles[2][4] = number;
        stl(b"x", 4, &triangles)
    };
    let text = |lines: &str| format!("solid a\n{lines}").into_bytes();
    let facet = "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    let mut cases: Vec<(String, Vec<u8>, Right)> = vec![
        ("whole".into(), whole.clone(), Drawn),
        ("named solid".into(), stl(b"solid but binary", 4, &tetrahedron), Drawn),
        ("more triangles than bytes".into(), stl(b"x", u32::MAX, &tetrahedron), Refused("")),
        ("fewer triangles than bytes".into(), stl(b"x", 1, &tetrahedron), Refused("")),
        ("no triangles".into(), stl(b"x", 0, &[]), Either(&Warned("the model is empty"), &Refused(""))),
        ("infinity".into(), with(f32::INFINITY), Refused("triangle 3")),
        ("NaN".into(), with(f32::NAN), Refused("triangle 3")),
        ("past 1e30".into(), with(3e38), Refused("triangle 3")),
        ("an open text".into(), text(&(facet.to_owned() + "endsolid a\n")), Drawn),
        ("a text that ends early".into(), text(&facet.repeat(2)), Refused("complete?")),
        ("a text of many facets that ends early".into(), text(&facet.repeat(MANY)), Refused("complete?")),
        ("a text of words".into(), text(&"facet ".repeat(MANY)), Refused("")),
        ("a text, then a tree".into(), text("cube(1);"), Refused("")),
        ("a tree, then a text".into(), b"cube(1); solid a\nfacet normal 0 0 0".to_vec(), Refused("expected ( after solid")),
        ("a drawing".into(), b"<svg xmlns='http://www.w3.org/2000/svg'/>".to_vec(), Refused("a drawing, not a model")),
        ("nothing".into(), Vec::new(), Refused("the input is empty")),
    ];
    cases.extend((1..whole.len()).step_by(23).map(|n| (format!("{n} bytes of a mesh"), whole[..n].to_vec(), Refused(""))));
    check("solid", cases);
}
