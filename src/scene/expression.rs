//! Expressions over names: text to operators, operators to gates. (Skeleton.)

use super::{Area, Scene};
use crate::error::{Result, Warning};

/// A parsed expression, not yet bound to a scene: operands and operators in postfix order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Expression {}

impl Expression {
    /// Parses the text of an expression.
    ///
    /// # Errors
    /// What does not belong, with its place.
    pub fn parse(_text: &str) -> Result<Expression> {
        Ok(Expression {})
    }
}

pub(super) fn resolve(scene: &mut Scene, _expression: &Expression, _warnings: &mut Vec<Warning>) -> Result<Area> {
    Ok(scene.art)
}

/// The names nearest to `id`, best first, at most three.
pub fn nearest<'a>(_id: &str, _known: impl Iterator<Item = &'a str>) -> Vec<String> {
    Vec::new()
}
