//! Expressions against a naive evaluator; their error lines; hostile sizes.

mod clock;

use proptest::prelude::*;
use runset::error::{Error, Warning};
use runset::scene::{Area, Expression, Gate, Limits, Named, Scene};
use runset::shape::{Path, Shape};

/// A scene with a triangle for every id, and one empty shape `empty`.
fn scene(ids: &[&str]) -> Scene {
    let mut scene = Scene::new(10.0, 10.0);
    let mut areas = Vec::new();
    for (i, &id) in ids.iter().chain(&["empty"]).enumerate() {
        let mut path = Path::default();
        if id != "empty" {
            path.ring(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
        }
        let shape = Shape::new(id, path);
        let area = scene.add_shape(shape);
        areas.push(area);
        let i = i as u32;
        assert!(scene.add_name(Named { id: id.to_owned(), kind: "shape", area, shapes: i..i + 1, depth: 0 }));
    }
    scene.art = scene.formula.any(&areas);
    scene
}

fn resolve(scene: &mut Scene, text: &str) -> Result<(Area, Vec<Warning>), Error> {
    let mut warnings = Vec::new();
    let expression = Expression::parse(text, &Limits::default())?;
    scene.resolve(&expression, &mut warnings).map(|area| (area, warnings))
}

/// The truth of every gate where bit i of `held` says whether shape i holds. Gates are in an order in which inputs come first.
fn truths(scene: &Scene, held: u32) -> Vec<bool> {
    let mut truth: Vec<bool> = Vec::new();
    for gate in scene.formula.gates() {
        let sum = |inputs: &[runset::scene::Input]| -> i64 {
            inputs.iter().map(|i| i64::from(i.weight) * i64::from(truth[i.area.index()])).sum()
        };
        let holds = match gate {
            Gate::Shape(i) => held >> i & 1 == 1,
            Gate::AtLeast(k, inputs) => sum(inputs) >= i64::from(*k),
            Gate::Odd(inputs) => sum(inputs).rem_euclid(2) == 1,
        };
        truth.push(holds);
    }
    truth
}

/// The oracle: recursive descent straight to a truth, one function a precedence, as the README lists them.
struct Naive<'a> {
    rest: &'a str,
    names: &'a [&'a str],
    held: u32,
}

impl Naive<'_> {
    fn eat(&mut self, word: &str) -> bool {
        self.rest = self.rest.trim_start();
        let found = self.rest.strip_prefix(word);
        self.rest = found.unwrap_or(self.rest);
        found.is_some()
    }
    fn or(&mut self) -> bool {
        let mut a = self.xor();
        while self.eat("|") {
            a |= self.xor();
        }
        a
    }
    fn xor(&mut self) -> bool {
        let mut a = self.and();
        while self.eat("^") {
            a ^= self.and();
        }
        a
    }
    fn and(&mut self) -> bool {
        let mut a = self.difference();
        while self.eat("&") {
            a &= self.difference();
        }
        a
    }
    fn difference(&mut self) -> bool {
        let mut a = self.not();
        while self.eat("-") {
            a &= !self.not();
        }
        a
    }
    fn not(&mut self) -> bool {
        if self.eat("!") { !self.not() } else { self.primary() }
    }
    fn primary(&mut self) -> bool {
        if self.eat("(") {
            let a = self.or();
            assert!(self.eat(")"));
            return a;
        }
        self.rest = self.rest.trim_start();
        let end = self.rest.find(|c: char| !c.is_alphanumeric()).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        if self.eat("(") {
            let k: usize = if word == "atleast" {
                let end = self.rest.find(',').unwrap();
                let (k, rest) = self.rest.split_at(end);
                self.rest = &rest[1..];
                k.trim().parse().unwrap()
            } else {
                0
            };
            let mut held = vec![self.or()];
            while self.eat(",") {
                held.push(self.or());
            }
            assert!(self.eat(")"));
            let count = held.iter().filter(|&&h| h).count();
            return match word {
                "all" => count == held.len(),
                "any" => count > 0,
                "odd" => count % 2 == 1,
                _ => count >= k,
            };
        }
        match word {
            "page" => true,
            "art" => self.held != 0,
            _ => self.held >> self.names.iter().position(|n| *n == word).unwrap() & 1 == 1,
        }
    }
}

const NAMES: [&str; 5] = ["a", "b", "c", "d", "all"];

fn expressions() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        8 => proptest::sample::select(&NAMES[..]).prop_map(str::to_owned),
        1 => Just("page".to_owned()),
        1 => Just("art".to_owned()),
    ];
    leaf.prop_recursive(6, 40, 5, |inner| {
        prop_oneof![
            (inner.clone(), proptest::sample::select(&["-", "&", "^", "|", " - ", "\n| "][..]), inner.clone())
                .prop_map(|(a, op, b)| format!("{a}{op}{b}")),
            inner.clone().prop_map(|a| format!("!{a}")),
            inner.clone().prop_map(|a| format!("({a})")),
            (proptest::sample::select(&["all", "any ", "odd"][..]), prop::collection::vec(inner.clone(), 1..4))
                .prop_map(|(f, args)| format!("{f}({})", args.join(", "))),
            (1..5u32, prop::collection::vec(inner, 1..5)).prop_map(|(k, args)| format!("atleast({k}, {})", args.join(","))),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2000) })]

    /// The gates say what the naive evaluator says, on every assignment.
    #[test]
    fn gates_are_the_expression(text in expressions()) {
        let mut scene = scene(&NAMES);
        let (area, _) = resolve(&mut scene, &text).map_err(|e| TestCaseError::fail(format!("{text}: {e}")))?;
        for held in 0..1u32 << NAMES.len() {
            let mut naive = Naive { rest: &text, names: &NAMES, held };
            let expected = naive.or();
            prop_assert!(naive.rest.trim().is_empty());
            prop_assert_eq!(truths(&scene, held)[area.index()], expected, "{} where {:05b} hold", text, held);
        }
    }

    /// Whatever the text, a result or one line with a place inside it.
    #[test]
    fn any_text_is_parsed_or_refused(text in "[a-c!&|^(),\"\\\\ \n0-2é-]{0,40}|\\PC{0,30}") {
        if let Err(e) = Expression::parse(&text, &Limits::default()) {
            let place = e.place.unwrap();
            let line = text.split('\n').nth(place.line as usize - 1).unwrap();
            prop_assert!(place.column as usize <= line.chars().count() + 1, "{}", e);
            prop_assert!(!e.to_string().contains('\n'));
        }
    }
}

/// `(gates made, inputs of the last)`: the shape of what an expression becomes.
fn shape(text: &str) -> (usize, Vec<(u32, i32)>) {
    let mut scene = scene(&["a", "b", "c", "d"]);
    let before = scene.formula.gates().len();
    let (area, _) = resolve(&mut scene, text).unwrap();
    let inputs = match &scene.formula.gates()[area.index()] {
        Gate::Shape(i) => vec![(*i, 0)],
        Gate::AtLeast(_, inputs) | Gate::Odd(inputs) => inputs.iter().map(|i| (i.area.index() as u32, i.weight)).collect(),
    };
    (scene.formula.gates().len() - before, inputs)
}

#[test]
fn chains_are_one_gate() {
    for text in ["a|b|c|d", "a|(b|(c|d))", "(a|b)|(c|d)", "any(a, any(b, c), d)", "a&b&(c&d)", "all(a,b&c,d)", "a^(b^c)^d", "odd(a^b, c^d)"]
    {
        let (gates, inputs) = shape(text);
        assert_eq!((gates, inputs.len()), (1, 4), "{text}");
        assert!(inputs.iter().all(|i| i.1 == 1), "{text}");
    }
    let weights = |text| shape(text).1.iter().map(|i| i.1).collect::<Vec<_>>();
    assert_eq!(weights("a - b - c"), [1, -1, -1]);
    assert_eq!(shape("(a | b) - c").0, 2);
    assert_eq!(shape("a - (b - c)").0, 2);
    assert_eq!(shape("!!a").0, 0);
    assert_eq!(shape("!!!a").0, 1);
    assert_eq!(shape("!!(a|b) | c").0, 1);
    assert_eq!(shape("!(a|b) | c").0, 3);
    assert_eq!(shape("a|a").1.len(), 2);
}

#[test]
fn names_are_found_however_they_are_written() {
    let ids = ["layer-1", "logo \"2\"", "back\\slash", "übung", "板 木", "page", "art", "any", "x.y:z", "_", "", "line\nbreak"];
    let mut scene = scene(&ids);
    let texts = [
        r#""layer-1""#,
        r#""logo \"2\"""#,
        r#""back\\slash""#,
        r#""übung""#,
        r#""板 木""#,
        r#""page""#,
        r#""art""#,
        "any",
        "x.y:z",
        "_",
        r#""""#,
        "\"line\nbreak\"",
    ];
    for (i, text) in texts.iter().enumerate() {
        let (area, _) = resolve(&mut scene, text).unwrap();
        assert_eq!(scene.formula.gates()[area.index()], Gate::Shape(i as u32), "{text}");
    }
    let (area, _) = resolve(&mut scene, "page").unwrap();
    assert_eq!(scene.formula.gates()[area.index()], Gate::AtLeast(0, Vec::new()));
    assert_eq!(resolve(&mut scene, "art").unwrap().0, scene.art);
    assert_eq!(resolve(&mut scene, "any | any(any)").unwrap().1, []);
}

#[test]
fn errors_are_one_line_with_their_place() {
    let table = [
        ("", "1:1: the expression is empty: write the name of a shape, or page, or art"),
        (" \n ", "2:2: the expression is empty: write the name of a shape, or page, or art"),
        ("a |", "1:4: expected a shape, found the end: add one, or remove the sign before it"),
        ("a && b", "1:4: expected a shape, found '&': add one, or remove the sign before it"),
        ("| a", "1:1: expected a shape, found '|': add one, or remove the sign before it"),
        ("a b", "1:3: expected an operator, - & ^ or |, found b: write one between the two shapes"),
        ("a and b", "1:3: expected an operator, - & ^ or |, found and: an intersection is a & b"),
        ("a + b", "1:3: expected an operator, - & ^ or |, found '+': a union is a | b"),
        ("a !b", "1:3: expected an operator, - & ^ or |, found '!': write one between the two shapes"),
        ("c(a)", "1:2: expected an operator, - & ^ or |, found '(': only all, any, odd and atleast are functions"),
        ("a \"b\"", "1:3: expected an operator, - & ^ or |, found \"b\": write one between the two shapes"),
        ("a-1", "1:3: expected a shape, found 1: an id with a digit in front or a - inside is written in double quotes"),
        ("'a'", "1:1: expected a shape, found ''': ids are quoted with \""),
        ("a |\n  #b", "2:3: expected a shape, found '#': an id with such characters is written in double quotes"),
        ("\"é\" | ü", "1:7: expected a shape, found 'ü': an id with such characters is written in double quotes"),
        ("~a", "1:1: expected a shape, found '~': the complement is !a"),
        ("()", "1:2: expected a shape, found ')': name at least one shape in the parentheses"),
        ("all()", "1:5: expected a shape, found ')': name at least one shape in the parentheses"),
        ("all(a,)", "1:7: expected a shape, found ')': add one, or remove the sign before it"),
        ("a)", "1:2: this \")\" closes nothing: remove it, or add a \"(\" before it"),
        ("a | (b & (c)", "1:5: this \"(\" is never closed: add a \")\""),
        ("all (a, b", "1:5: this \"(\" is never closed: add a \")\""),
        ("a | \"b", "1:5: this quote is never closed: add a \" after the id"),
        (r#""a\n""#, r#"1:3: in quotes a \ stands only before " or \: write it twice"#),
        ("a, b", "1:2: a comma stands only between the arguments of all, any, odd and atleast: write an operator, - & ^ or |"),
        ("all((a, b))", "1:7: a comma stands only between the arguments of all, any, odd and atleast: write an operator, - & ^ or |"),
        ("atleast(a, b)", "1:9: expected a whole number of at least 1, found a: write atleast(2, a, b, c)"),
        ("atleast(0, b)", "1:9: expected a whole number of at least 1, found 0: write atleast(2, a, b, c)"),
        ("atleast(-1, b)", "1:9: expected a whole number of at least 1, found '-': write atleast(2, a, b, c)"),
        ("atleast(1.5, b)", "1:9: expected a whole number of at least 1, found 1.5: write atleast(2, a, b, c)"),
        ("atleast()", "1:9: expected a whole number of at least 1, found ')': write atleast(2, a, b, c)"),
        ("atleast(2)", "1:10: expected a comma and shapes after the number, found ')'"),
        ("atleast(2,)", "1:11: expected a shape, found ')': name at least one shape in the parentheses"),
        ("a | lago", "1:5: unknown name \"lago\": did you mean logo, page or a?"),
        ("\"a\\\"\" & b", "1:1: unknown name \"a\\\"\": did you mean a, b or c?"),
        ("\"page\"", "1:1: unknown name \"page\": did you mean page, a or logo?"),
        ("Übung", "1:1: expected a shape, found 'Ü': an id with such characters is written in double quotes"),
    ];
    let mut scene = scene(&["a", "b", "c", "logo", "logo-2"]);
    for (text, line) in table {
        assert_eq!(resolve(&mut scene, text).expect_err(text).to_string(), line, "{text}");
    }
}

#[test]
fn warnings_have_their_place() {
    let mut scene = scene(&["a", "b"]);
    let (area, warnings) = resolve(&mut scene, "a | atleast(99999999999999999999, a, b) | empty | empty").unwrap();
    let lines: Vec<_> = warnings.iter().map(|w| (w.place.unwrap().column, w.what.as_str())).collect();
    assert_eq!(
        lines,
        [(5, "atleast asks for more than the 2 given here: it holds nowhere"), (43, "empty paints nothing: it counts as an empty shape")]
    );
    for held in 0..4 {
        assert_eq!(truths(&scene, held)[area.index()], held & 1 == 1);
    }
}

#[test]
fn operands_are_limited() {
    let limits = Limits { nodes: 5, ..Limits::default() };
    assert!(Expression::parse("a|b|c", &limits).is_ok());
    let error = Expression::parse("a|b|!c", &limits).unwrap_err();
    assert_eq!(error.kind, runset::error::Kind::Limit);
    assert_eq!(error.to_string(), "1:7: the expression has more than 5 operands and operators: draw it in several runs");
}

#[test]
fn depth_and_length_cost_no_more_than_memory() {
    const N: usize = 100_000;
    let nested = |open: &str, close: &str| format!("{}a{}", open.repeat(N), close.repeat(N));
    let texts = [
        nested("(", ")"),
        nested("!", ""),
        nested("a-(", ")"),
        nested("a|(", ")"),
        nested("(", "|b)"),
        nested("a|(b&(", "))"),
        nested("all(", ")"),
        nested("atleast(2,a,b,", ")"),
        nested("any(b&", ")"),
        nested("(a-b)|(", ")"),
        nested("a|", ""),
        nested("a-", ""),
        nested("a^!", ""),
        format!("atleast(50000{})", ",a".repeat(N)),
        format!("odd({}a)", "a^b,".repeat(N)),
        format!("{}a", "(a|b)&".repeat(N)),
    ];
    for text in texts {
        let mut scene = scene(&["a", "b"]);
        let start = clock::cpu();
        resolve(&mut scene, &text).unwrap();
        assert!((clock::cpu() - start).as_secs_f64() < 1.0, "{}… took {:?}", &text[..20], clock::cpu() - start);
        for broken in [&text[..text.len() - 1], &text[..N], &text[N..]] {
            let _ = resolve(&mut scene, broken);
        }
    }
}

#[test]
fn one_huge_name_and_many_names() {
    let ids: Vec<String> = (0..50_000).map(|i| format!("shape{i}")).collect();
    let mut scene = scene(&ids.iter().map(String::as_str).collect::<Vec<_>>());
    let start = clock::cpu();
    let text = format!("shape49999 & \"{}\"", "\\\"ü".repeat(2 << 20));
    let line = resolve(&mut scene, &text).unwrap_err().to_string();
    assert!(line.starts_with("1:14: unknown name \"\\\"ü\\\"ü"), "{line}");
    assert!(line.contains("…\": did you mean "), "{line}");
    assert!((clock::cpu() - start).as_secs_f64() < 1.0, "{:?}", clock::cpu() - start);
}
