//! Binding an expression to a scene: operators become gates of the scene's [`Formula`](super::Formula).
//!
//! The postfix steps run over a stack of values. A value that is a chain of one operator stays open, a list of operands, until
//! something else than that operator takes it; only then does it become a gate. So `a | b | … | z` is one gate, and so is
//! `x | (y | z)`: the shorter list is appended to the longer, which costs n log n operand moves at worst.

use super::expression::{Expression, Join, Name, Step};
use super::nearest::nearest;
use super::token::{quoted, written};
use super::{Area, Formula, Scene};
use crate::error::{Error, Kind, Origin, Place, Result, Warning};

/// An area that may still grow.
struct Value {
    body: Body,
    negated: bool,
}

enum Body {
    Area(Area),
    Chain(Join, Vec<Area>),
}

pub(super) fn resolve(scene: &mut Scene, expression: &Expression, warnings: &mut Vec<Warning>) -> Result<Area> {
    let mut stack: Vec<Value> = Vec::new();
    let mut warned = std::collections::HashSet::new();
    for &step in expression.steps() {
        let value = match step {
            Step::Page => Value::from(scene.formula.everywhere()),
            Step::Art => Value::from(scene.art),
            Step::Name(name) => {
                let id = expression.id(name);
                let area = lookup(scene, id, name)?;
                if scene.is_empty(id) && warned.insert(id) {
                    warnings.push(warning(name.at, format!("{} paints nothing: it counts as an empty shape", written(id))));
                }
                Value::from(area)
            }
            Step::Not => {
                let value = stack.pop().expect("an operand stands before its operator");
                Value { negated: !value.negated, ..value }
            }
            Step::Join(join, n) => {
                let operands = stack.split_off(stack.len() - n as usize);
                let joined = operands.into_iter().reduce(|a, b| joined(join, a, b, &mut scene.formula));
                joined.expect("a join has operands")
            }
            Step::AtLeast { k, n, at } => {
                let operands = stack.split_off(stack.len() - n as usize);
                let areas: Vec<Area> = operands.into_iter().map(|v| v.close(&mut scene.formula)).collect();
                Value::from(if k > n {
                    warnings.push(warning(at, format!("atleast asks for more than the {n} given here: it holds nowhere")));
                    scene.formula.any(&[])
                } else {
                    scene.formula.at_least(i32::try_from(k).expect("at most as many as operands"), &areas)
                })
            }
        };
        stack.push(value);
    }
    Ok(stack.pop().expect("an expression has a value").close(&mut scene.formula))
}

impl From<Area> for Value {
    fn from(area: Area) -> Value {
        Value { body: Body::Area(area), negated: false }
    }
}

impl Value {
    /// The value as a gate that no longer grows.
    fn close(self, formula: &mut Formula) -> Area {
        let area = match self.body {
            Body::Area(area) => area,
            Body::Chain(Join::Difference, list) => formula.without(list[0], &list[1..]),
            Body::Chain(Join::All, list) => formula.all(&list),
            Body::Chain(Join::Odd, list) => formula.odd(&list),
            Body::Chain(Join::Any, list) => formula.any(&list),
        };
        if self.negated { formula.not(area) } else { area }
    }

    /// The operands of a chain of `join`; anything else is a single operand.
    fn operands(self, join: Join, formula: &mut Formula) -> Vec<Area> {
        match self {
            Value { body: Body::Chain(own, list), negated: false } if own == join => list,
            other => vec![other.close(formula)],
        }
    }
}

fn joined(join: Join, a: Value, b: Value, formula: &mut Formula) -> Value {
    let mut list = a.operands(join, formula);
    if join == Join::Difference {
        list.push(b.close(formula));
    } else {
        let mut other = b.operands(join, formula);
        if other.len() > list.len() {
            std::mem::swap(&mut list, &mut other);
        }
        list.append(&mut other);
    }
    Value { body: Body::Chain(join, list), negated: false }
}

fn lookup(scene: &Scene, id: &str, name: Name) -> Result<Area> {
    if let Some(named) = scene.named(id) {
        return Ok(named.area);
    }
    let near = nearest(id, scene.names().iter().map(|n| n.id.as_str()));
    let (last, others) = near.split_last().expect("the built-in names are always known");
    let what = format!("unknown name {}: did you mean {} or {last}?", quoted(id), others.join(", "));
    Err(Error::expression(Kind::Refused, what).at(name.at))
}

fn warning(at: Place, what: String) -> Warning {
    Warning { origin: Origin::Expression, place: Some(at), ..Warning::input(what) }
}
