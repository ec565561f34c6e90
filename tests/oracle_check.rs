//! The oracle itself: pictures drawn by hand, number theory, and a foreign rasterizer.

mod oracle;

use oracle::random::{self, Rng};
use oracle::{Expr, Function, Operator, Oracle, Point, Rule, Scene, Shape, near};

#[test]
fn a_centre_on_a_left_or_top_boundary_is_inside() {
    let square = rectangle(0.5, 0.5, 2.5, 2.5);
    assert_picture(3, &[&[square]], Rule::NonZero, &["##.", "##.", "..."]);

    // Centres lie on both legs: the left one is inside, the right one outside.
    let triangle = vec![(6.0, 0.0), (12.0, 6.0), (0.0, 6.0)];
    let picture = [".....#......", "....###.....", "...#####....", "..#######...", ".#########..", "###########."];
    assert_picture(12, &[&[triangle]], Rule::NonZero, &picture);

    let diamond = vec![(2.5, 0.5), (4.5, 2.5), (2.5, 4.5), (0.5, 2.5)];
    assert_picture(5, &[&[diamond]], Rule::NonZero, &[".....", ".##..", "####.", ".##..", "....."]);
}

#[test]
fn rings_that_cross_count_by_their_rule() {
    let up = vec![(6.0, 0.0), (12.0, 6.0), (0.0, 6.0)];
    let down = vec![(0.0, 3.0), (12.0, 3.0), (6.0, 9.0)];
    let star = [
        ".....#......",
        "....###.....",
        "...#####....",
        "##.......##.",
        "............",
        "##.......##.",
        "...#####....",
        "....###.....",
        ".....#......",
    ];
    assert_picture(12, &[&[up, down]], Rule::EvenOdd, &star);

    let bow = vec![(0.0, 0.0), (6.0, 6.0), (6.0, 0.0), (0.0, 6.0)];
    let picture = [".....#", "#...##", "##.###", "##.###", "#...##", ".....#"];
    assert_picture(6, &[std::slice::from_ref(&bow)], Rule::EvenOdd, &picture);
    assert_picture(6, &[&[bow]], Rule::NonZero, &picture);
}

#[test]
fn windings_add_up() {
    let (outer, inner) = (rectangle(0.0, 0.0, 4.0, 4.0), rectangle(1.0, 1.0, 3.0, 3.0));
    let backwards = inner.iter().rev().copied().collect();
    let hole = ["####", "#..#", "#..#", "####"];
    assert_picture(4, &[&[outer.clone(), inner.clone()]], Rule::NonZero, &["####"; 4]);
    assert_picture(4, &[&[outer.clone(), inner]], Rule::EvenOdd, &hole);
    assert_picture(4, &[&[outer, backwards]], Rule::NonZero, &hole);

    // One ring that goes round twice.
    let twice: Vec<Point> = rectangle(1.0, 0.0, 3.0, 2.0).repeat(2);
    assert_picture(4, &[std::slice::from_ref(&twice)], Rule::NonZero, &[".##.", ".##."]);
    assert_picture(4, &[&[twice]], Rule::EvenOdd, &["....", "...."]);
}

#[test]
fn vertices_are_rounded_ties_away_from_zero() {
    // The left side at 1/2 px and a little less or more than half a step of 1/256 px to its right.
    for (x, picture) in [(0.5 + 0.99 / 512.0, "#"), (0.5 + 1.0 / 512.0, ".")] {
        assert_picture(1, &[&[rectangle(x, 0.0, 1.0, 1.0)]], Rule::NonZero, &[picture]);
    }
    // Down to 257/256 px, an edge is at the centre half way if it began at -1/256 px, and right of it if it began at 0.
    let from = |x: f64| vec![(x, 0.0), (1.0 + 1.0 / 256.0, 1.0), (2.0, 1.0), (2.0, 0.0)];
    assert_picture(1, &[&[from(-1.0 / 512.0)]], Rule::NonZero, &["#"]);
    assert_picture(1, &[&[from(-0.99 / 512.0)]], Rule::NonZero, &["."]);
}

#[test]
fn geometry_may_end_anywhere() {
    // Below the diagonal, which passes through all centres, that are then outside.
    for far in [4.0, 1e6, 2f64.powi(40), 1e12, 1e18, 1e300, f64::MAX] {
        let triangle = vec![(0.0, 0.0), (far, far), (0.0, far)];
        assert_picture(4, &[&[triangle]], Rule::NonZero, &["....", "#...", "##..", "###."]);
        let other = vec![(0.0, 0.0), (far, far), (far, 0.0)];
        assert_picture(4, &[&[other]], Rule::NonZero, &["####", ".###", "..##", "...#"]);
        let cover = rectangle(-far, -far, far, far);
        assert_picture(4, &[&[cover]], Rule::NonZero, &["####"; 4]);
    }
    // From (-2^60, 0) to (2^60, 2): at a height of 1/2 it is at -2^59, at 1 1/2 at 2^59.
    let far = 2f64.powi(60);
    assert_picture(3, &[&[vec![(-far, 0.0), (far, 2.0), (-far, 2.0)]]], Rule::NonZero, &["...", "###"]);
}

#[test]
fn degenerate_rings_are_empty() {
    let (a, b, c) = ((1.0, 1.0), (3.0, 3.0), (3.0, 1.0));
    let rings = [vec![], vec![a], vec![a, b], vec![a; 4], vec![a, b, a, c, a], vec![a, c, (0.0, 1.0)]];
    assert_picture(4, &[&rings], Rule::NonZero, &["...."; 4]);
    assert_picture(4, &[&rings], Rule::EvenOdd, &["...."; 4]);
}

#[test]
fn halves_that_share_an_edge_neither_overlap_nor_leave_a_gap() {
    let (a, b) = ((0.0, 1.7), (9.0, 4.3));
    let scene = scene(9, 6, &[&[vec![a, b, (9.0, 0.0), (0.0, 0.0)]], &[vec![a, b, (9.0, 6.0), (0.0, 6.0)]]], Rule::NonZero);
    let with = |operator| Scene { expr: binary(operator, Expr::Shape(0), Expr::Shape(1)), ..scene.clone() };
    assert_eq!(with(Operator::And).ascii(), ".........\n".repeat(6));
    assert_eq!(with(Operator::Or).ascii(), "#########\n".repeat(6));
    // At 2.5 the edge is at 9 * 0.8 / 2.6 = 2.77, at 3.5 at 6.23.
    let upper = ["#########", "#########", "...######", "......###", ".........", "........."];
    assert_eq!(with(Operator::Minus).ascii().lines().collect::<Vec<_>>(), upper);
}

#[test]
fn operators_have_their_truth_tables() {
    // Columns 0..8: a holds in 4..8, b in 2..4 and 6..8, c in the odd ones.
    let [a, b, c] = [0, 1, 2].map(Expr::Shape);
    let table = |expr: &Expr| -> String {
        let bit = |column: usize, bit: usize| column >> bit & 1 == 1;
        (0..8).map(|column| if expr.holds(&[bit(column, 2), bit(column, 1), bit(column, 0)]) { '#' } else { '.' }).collect()
    };
    let call = |function| Expr::Call(function, vec![a.clone(), b.clone(), c.clone()]);
    assert_eq!(table(&a), "....####");
    assert_eq!(table(&Expr::Page), "########");
    assert_eq!(table(&Expr::Art), ".#######");
    assert_eq!(table(&Expr::Not(Box::new(c.clone()))), "#.#.#.#.");
    assert_eq!(table(&binary(Operator::Minus, a.clone(), b.clone())), "....##..");
    assert_eq!(table(&binary(Operator::And, a.clone(), b.clone())), "......##");
    assert_eq!(table(&binary(Operator::Xor, a.clone(), b.clone())), "..####..");
    assert_eq!(table(&binary(Operator::Or, a.clone(), b.clone())), "..######");
    assert_eq!(table(&call(Function::All)), ".......#");
    assert_eq!(table(&call(Function::Any)), ".#######");
    assert_eq!(table(&call(Function::Odd)), ".##.#..#");
    assert_eq!(table(&call(Function::AtLeast(2))), "...#.###");
    assert_eq!(table(&call(Function::AtLeast(4))), "........");
}

#[test]
fn expressions_are_written_with_the_parentheses_they_need() {
    use Operator::{And, Minus, Or, Xor};
    let [a, b, c] = [0, 1, 2].map(Expr::Shape);
    let not = |a: Expr| Expr::Not(Box::new(a));
    for (expr, text) in [
        (binary(Minus, binary(Minus, a.clone(), b.clone()), c.clone()), "s0 - s1 - s2"),
        (binary(Minus, a.clone(), binary(Minus, b.clone(), c.clone())), "s0 - (s1 - s2)"),
        (binary(Or, a.clone(), binary(Xor, b.clone(), binary(And, c.clone(), Expr::Page))), "s0 | s1 ^ s2 & page"),
        (binary(And, binary(Or, a.clone(), b.clone()), c.clone()), "(s0 | s1) & s2"),
        (binary(Minus, not(a.clone()), not(binary(And, b.clone(), c.clone()))), "!s0 - !(s1 & s2)"),
        (not(not(a.clone())), "!!s0"),
        (Expr::Call(Function::AtLeast(2), vec![binary(Or, a.clone(), b.clone()), Expr::Shape(3)]), r#"atleast(2,s0 | s1,"layer-3")"#),
        (Expr::Shape(4), r#""形 \"4\\""#),
    ] {
        assert_eq!(expr.to_string(), text);
    }
}

#[test]
fn runs_are_the_pixels() {
    for seed in 0..60 {
        let scene = random::scene(seed);
        let (oracle, rows) = (Oracle::new(&scene), scene.rows());
        for (y, row) in (0..).zip(&rows) {
            assert!(row.windows(2).all(|pair| pair[0].end < pair[1].start) && row.iter().all(|run| run.start < run.end));
            for x in 0..scene.width {
                assert_eq!(row.iter().any(|run| run.contains(&x)), oracle.pixel(x, y), "seed {seed}, pixel {x}, {y}");
            }
        }
    }
}

#[test]
fn random_scenes_are_pictures_and_read_back() {
    let mut mixed = 0;
    for seed in 0..200 {
        let scene = random::scene(seed);
        let picture = scene.ascii();
        mixed += usize::from(picture.contains('#') && picture.contains('.'));

        let read: serde_json::Value = serde_json::from_str(&scene.json()).unwrap();
        assert_eq!(read["expr"], scene.expr.to_string());
        for (index, shape) in scene.shapes.iter().enumerate() {
            let rings: Vec<Vec<Point>> = serde_json::from_value(read["shapes"][oracle::text::name(index)]["rings"].clone()).unwrap();
            assert_eq!(rings, shape.rings, "seed {seed}, shape {index}");
        }
    }
    assert!(mixed > 140, "only {mixed} of 200 scenes show anything");
}

#[test]
fn constructed_edges_pass_beside_centres() {
    let (mut on, mut beside) = (0, 0);
    for (seed, (lines, first_column)) in (0..).zip([(70_000, 0), (70_000, 1_000_000), (8_388_608, 0), (300, 40)]) {
        let near = near::scene(seed, lines, first_column);
        for touch in near.touches {
            let alone = Scene { expr: Expr::Shape(touch.shape), ..near.scene.clone() };
            let oracle = Oracle::new(&alone);
            // The edge counts for the centre if it does not pass to its right, and never for the pixel before.
            let counts = touch.gap <= 0;
            assert_eq!(oracle.pixel(touch.column, touch.line), counts != touch.left, "{touch:?}");
            if touch.column > 0 {
                assert_eq!(oracle.pixel(touch.column - 1, touch.line), touch.left, "{touch:?}");
            }
            assert_eq!(oracle.pixel(touch.column + 1, touch.line), !touch.left, "{touch:?}");
            on += usize::from(touch.gap == 0);
            beside += usize::from(touch.gap != 0 && touch.q > 256);
        }
    }
    assert!(on > 10 && beside > 40, "{on} on a centre, {beside} within 1/65536 px of one");
}

#[test]
fn a_foreign_rasterizer_differs_only_along_outlines() {
    let mut compared = 0;
    for seed in 0..200 {
        let mut rng = Rng::new(seed);
        let size = 64;
        let mut coordinate = || rng.between(-16 * 256, 80 * 256) as f64 / 256.0;
        let ring: Vec<Point> = (0..9).map(|_| (coordinate(), coordinate())).collect();
        let rule = rng.pick(&[Rule::NonZero, Rule::EvenOdd]);
        let theirs = tiny_skia_fill(&ring, rule, size);
        let scene = scene(size, size, &[std::slice::from_ref(&ring)], rule);
        let ours = Oracle::new(&scene);
        for (x, y) in (0..size).flat_map(|y| (0..size).map(move |x| (x, y))) {
            let (a, b) = (ours.pixel(x, y), theirs[(y * size + x) as usize]);
            let centre = (f64::from(x) + 0.5, f64::from(y) + 0.5);
            let beside = (0..ring.len()).any(|i| distance(centre, ring[i], ring[(i + 1) % ring.len()]) <= 1.0);
            assert!(a == b || beside, "seed {seed}, pixel {x}, {y}");
            compared += usize::from(!beside);
        }
    }
    assert!(compared > 200_000, "{compared} pixels lie off the outlines");
}

fn tiny_skia_fill(ring: &[Point], rule: Rule, size: u32) -> Vec<bool> {
    let mut path = tiny_skia::PathBuilder::new();
    path.move_to(ring[0].0 as f32, ring[0].1 as f32);
    ring[1..].iter().for_each(|p| path.line_to(p.0 as f32, p.1 as f32));
    path.close();
    let rule = if rule == Rule::EvenOdd { tiny_skia::FillRule::EvenOdd } else { tiny_skia::FillRule::Winding };
    let paint = tiny_skia::Paint { anti_alias: false, ..tiny_skia::Paint::default() };
    let mut pixmap = tiny_skia::Pixmap::new(size, size).expect("a small page");
    pixmap.fill_path(&path.finish().expect("more than a point"), &paint, rule, tiny_skia::Transform::identity(), None);
    pixmap.pixels().iter().map(|pixel| pixel.alpha() > 0).collect()
}

/// From a point to a segment.
fn distance(p: Point, a: Point, b: Point) -> f64 {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let t = ((p.0 - a.0) * dx + (p.1 - a.1) * dy) / (dx * dx + dy * dy).max(f64::MIN_POSITIVE);
    let t = t.clamp(0.0, 1.0);
    (p.0 - a.0 - t * dx).hypot(p.1 - a.1 - t * dy)
}

fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Vec<Point> {
    vec![(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
}

fn binary(operator: Operator, a: Expr, b: Expr) -> Expr {
    Expr::Binary(operator, Box::new(a), Box::new(b))
}

/// The union of shapes that are given as rings.
fn scene(width: u32, height: u32, shapes: &[&[Vec<Point>]], rule: Rule) -> Scene {
    let shapes = shapes.iter().map(|rings| Shape { rings: rings.to_vec(), rule }).collect();
    Scene { width, height, shapes, expr: Expr::Art }
}

fn assert_picture(width: u32, shapes: &[&[Vec<Point>]], rule: Rule, picture: &[&str]) {
    let scene = scene(width, picture.len() as u32, shapes, rule);
    assert_eq!(scene.ascii().lines().collect::<Vec<_>>(), picture);
}
