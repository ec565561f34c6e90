//! Scenes as the text of a JSON scene, so that a test can go in through the front door.

use super::{Expr, Function, Operator, Rule, Scene};

impl Scene {
    /// The JSON scene. Numbers are written so that they read back as the same doubles.
    pub fn json(&self) -> String {
        let shapes = self.shapes.iter().enumerate().map(|(index, shape)| {
            let point = |&(x, y): &(f64, f64)| format!("[{x:?},{y:?}]");
            let ring = |ring: &Vec<(f64, f64)>| format!("[{}]", list(ring.iter().map(point)));
            let rule = if shape.rule == Rule::EvenOdd { "evenodd" } else { "nonzero" };
            let rings = list(shape.rings.iter().map(ring));
            format!("{}:{{\"rings\":[{rings}],\"rule\":\"{rule}\"}}", quoted(&name(index)))
        });
        let (width, height, expr) = (self.width, self.height, quoted(&self.expr.to_string()));
        format!("{{\"width\":{width},\"height\":{height},\"shapes\":{{{}}},\"expr\":{expr}}}", list(shapes))
    }
}

/// The id of a shape: some are plain words, some are not.
pub fn name(index: usize) -> String {
    match index % 5 {
        3 => format!("layer-{index}"),
        4 => format!("形 \"{index}\\"),
        _ => format!("s{index}"),
    }
}

/// As the expression's text, with no more parentheses than it needs.
impl std::fmt::Display for Expr {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Expr::Page => write!(f, "page"),
            Expr::Art => write!(f, "art"),
            Expr::Shape(index) => match name(*index) {
                name if name.starts_with('s') => write!(f, "{name}"),
                name => write!(f, "\"{}\"", name.replace('\\', "\\\\").replace('"', "\\\"")),
            },
            Expr::Not(a) => write!(f, "!{}", a.within(a.binds() < self.binds())),
            Expr::Binary(operator, a, b) => {
                let sign = match operator {
                    Operator::Minus => '-',
                    Operator::And => '&',
                    Operator::Xor => '^',
                    Operator::Or => '|',
                };
                write!(f, "{} {sign} {}", a.within(a.binds() < self.binds()), b.within(b.binds() <= self.binds()))
            }
            Expr::Call(function, operands) => {
                let operands = list(operands.iter().map(Expr::to_string));
                match function {
                    Function::All => write!(f, "all({operands})"),
                    Function::Any => write!(f, "any({operands})"),
                    Function::Odd => write!(f, "odd({operands})"),
                    Function::AtLeast(k) => write!(f, "atleast({k},{operands})"),
                }
            }
        }
    }
}

impl Expr {
    /// How tightly its operator binds.
    fn binds(&self) -> u32 {
        match self {
            Expr::Binary(Operator::Or, ..) => 1,
            Expr::Binary(Operator::Xor, ..) => 2,
            Expr::Binary(Operator::And, ..) => 3,
            Expr::Binary(Operator::Minus, ..) => 4,
            Expr::Not(_) => 5,
            _ => 6,
        }
    }

    fn within(&self, parentheses: bool) -> String {
        if parentheses { format!("({self})") } else { self.to_string() }
    }
}

fn list(items: impl Iterator<Item = String>) -> String {
    items.collect::<Vec<_>>().join(",")
}

fn quoted(text: &str) -> String {
    serde_json::to_string(text).expect("a string")
}
