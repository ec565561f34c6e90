//! The arguments of a statement, by name.

use super::modules::MODULES;
use super::tree::{Argument, Item, Statement, Tree};
use crate::error::{Error, Kind, Places, Result, Warning};
use crate::mesh::turn::Fineness;

/// A value in the document.
#[derive(Clone, Copy)]
pub(super) struct Value<'d> {
    /// The value's item, and those behind it that belong to it.
    items: &'d [Item],
    text: &'d [u8],
}

impl<'d> Value<'d> {
    fn first(tree: &'d Tree<'_>, index: usize) -> Value<'d> {
        Value { items: &tree.items[index..index + size(&tree.items[index])], text: tree.text }
    }

    /// The byte where it begins.
    pub(super) fn at(&self) -> usize {
        self.items[0].at()
    }

    pub(super) fn number(&self) -> Option<f64> {
        if let Item::Number(_, x) = self.items[0] { Some(x) } else { None }
    }

    fn truth(&self) -> Option<bool> {
        if let Item::Bool(_, truth) = self.items[0] { Some(truth) } else { None }
    }

    /// A text, without its backslashes.
    pub(super) fn words(&self) -> Option<String> {
        let Item::Text(at, length) = self.items[0] else { return None };
        let inside = &self.text[at as usize..(at + length) as usize];
        let mut plain = Vec::with_capacity(inside.len());
        let mut bytes = inside.iter();
        while let Some(&byte) = bytes.next() {
            plain.push(match byte {
                b'\\' => match bytes.next() {
                    Some(b'n') => b'\n',
                    Some(b't') => b'\t',
                    Some(b'r') => b'\r',
                    Some(&other) => other,
                    None => break,
                },
                _ => byte,
            });
        }
        Some(String::from_utf8_lossy(&plain).into_owned())
    }

    /// The values of a list.
    pub(super) fn list(&self) -> Option<impl Iterator<Item = Value<'d>> + use<'d>> {
        let Item::List(..) = self.items[0] else { return None };
        let (mut rest, text) = (&self.items[1..], self.text);
        Some(std::iter::from_fn(move || {
            let (items, others) = rest.split_at_checked(size(rest.first()?))?;
            rest = others;
            Some(Value { items, text })
        }))
    }

    /// A list of exactly so many numbers, all finite.
    pub(super) fn numbers<const N: usize>(&self) -> Option<[f64; N]> {
        let mut numbers = [0.0; N];
        let mut values = self.list()?;
        for number in &mut numbers {
            *number = values.next()?.number().filter(|x| x.is_finite())?;
        }
        values.next().is_none().then_some(numbers)
    }
}

fn size(item: &Item) -> usize {
    if let Item::List(_, count) = item { 1 + *count as usize } else { 1 }
}

/// The arguments of one statement.
pub(super) struct Arguments<'d, 't> {
    tree: &'d Tree<'t>,
    arguments: &'d [Argument],
    parameters: &'static [&'static str],
}

impl<'d, 't> Arguments<'d, 't> {
    pub(super) fn of(tree: &'d Tree<'t>, statement: &Statement) -> Arguments<'d, 't> {
        let [from, to] = statement.arguments.map(|i| i as usize);
        Arguments { tree, arguments: &tree.arguments[from..to], parameters: MODULES[statement.module as usize].parameters }
    }

    /// The value of a parameter, unless it is `undef`. The last counts.
    pub(super) fn get(&self, parameter: &str) -> Option<Value<'d>> {
        let position = self.parameters.iter().position(|p| *p == parameter);
        let mut bare = 0;
        let mut found = None;
        for argument in self.arguments {
            let name = self.name(argument);
            let here = if name.is_empty() {
                bare += 1;
                position == Some(bare - 1)
            } else {
                name == parameter.as_bytes()
            };
            if here {
                found = Some(Value::first(self.tree, argument.value as usize));
            }
        }
        found.filter(|value| !matches!(value.items[0], Item::Undefined(_)))
    }

    fn name(&self, argument: &Argument) -> &'d [u8] {
        &self.tree.text[argument.name[0] as usize..argument.name[1] as usize]
    }

    /// Warns of arguments that no parameter takes.
    pub(super) fn check(&self, places: &mut Places<'_>, warnings: &mut Vec<Warning>) {
        for argument in self.arguments {
            let name = self.name(argument);
            if !name.is_empty() && !name.starts_with(b"$") && !self.parameters.iter().any(|p| p.as_bytes() == name) {
                let place = places.of_byte(argument.name[0] as usize);
                let name = String::from_utf8_lossy(name);
                warnings.push(Warning {
                    place: Some(place),
                    ..Warning::input(format!("{} is no parameter here: it is ignored", crate::scene::quoted(&name)))
                });
            }
        }
    }

    /// A number, or `otherwise` if it is not given.
    ///
    /// # Errors
    /// It is no number, or not a finite one.
    pub(super) fn number(&self, parameter: &str, otherwise: f64) -> Result<f64> {
        Ok(self.number_if(parameter)?.unwrap_or(otherwise))
    }

    /// A number, if it is given.
    ///
    /// # Errors
    /// It is no number, or not a finite one.
    pub(super) fn number_if(&self, parameter: &str) -> Result<Option<f64>> {
        let Some(value) = self.get(parameter) else { return Ok(None) };
        match value.number() {
            Some(x) if x.is_finite() => Ok(Some(x)),
            _ => Err(self.wrong(&value, format!("{parameter} must be a finite number"))),
        }
    }

    /// A truth, false if it is not given.
    ///
    /// # Errors
    /// It is neither true nor false.
    pub(super) fn truth(&self, parameter: &str) -> Result<bool> {
        let Some(value) = self.get(parameter) else { return Ok(false) };
        value.truth().ok_or_else(|| self.wrong(&value, format!("{parameter} must be true or false")))
    }

    /// A number for all of `N` coordinates, or a list of them.
    ///
    /// # Errors
    /// It is neither.
    pub(super) fn vector<const N: usize>(&self, parameter: &str, otherwise: f64) -> Result<[f64; N]> {
        let Some(value) = self.get(parameter) else { return Ok([otherwise; N]) };
        let single = value.number().filter(|x| x.is_finite()).map(|x| [x; N]);
        single
            .or_else(|| value.numbers())
            .ok_or_else(|| self.wrong(&value, format!("{parameter} must be a finite number or a list of {N} of them")))
    }

    /// A radius, which may be given as a diameter.
    ///
    /// # Errors
    /// It is no finite number.
    pub(super) fn radius(&self, radius: &str, diameter: &str) -> Result<Option<f64>> {
        match self.number_if(diameter)? {
            Some(diameter) => Ok(Some(diameter / 2.0)),
            None => self.number_if(radius),
        }
    }

    /// `$fn`, `$fa` and `$fs`.
    ///
    /// # Errors
    /// One of them is no finite number.
    pub(super) fn fineness(&self) -> Result<Fineness> {
        Ok(Fineness { sides: self.number("$fn", 0.0)?, angle: self.number("$fa", 12.0)?, size: self.number("$fs", 2.0)? })
    }

    /// An error at a value.
    pub(super) fn wrong(&self, value: &Value<'_>, what: impl Into<String>) -> Error {
        Error::input(Kind::Malformed, what).at_byte(self.tree.text, value.at())
    }
}
