//! What can go wrong, and where: one error type that every floor shares.
//!
//! An error has a kind (which decides the exit status and, over HTTP, the status code), an origin
//! (the document, the expression of the command line, the output), a place in it where there is one,
//! and one line of text that says what is wrong and what to do. A warning has the same form.

use std::fmt;

use memchr::{memchr_iter, memrchr};

/// A place in a text: line and column, both from 1, columns counted in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

impl Place {
    /// The place of byte `offset` in `text`; past the end it is the place behind the last character.
    /// Bytes that are not UTF-8 count as one character each.
    pub fn of_byte(text: &[u8], offset: usize) -> Place {
        let before = &text[..offset.min(text.len())];
        let start = memrchr(b'\n', before).map_or(0, |i| i + 1);
        let line = memchr_iter(b'\n', before).count() + 1;
        let column = String::from_utf8_lossy(&before[start..]).chars().count() + 1;
        Place { line: u32::try_from(line).unwrap_or(u32::MAX), column: u32::try_from(column).unwrap_or(u32::MAX) }
    }
}

/// Places in a text; asked for from its start to its end, all of them cost one pass.
pub struct Places<'t> {
    text: &'t [u8],
    byte: usize,
    /// The place of `byte`.
    place: Place,
}

impl<'t> Places<'t> {
    /// Places in `text`.
    pub fn new(text: &'t [u8]) -> Places<'t> {
        Places { text, byte: 0, place: Place { line: 1, column: 1 } }
    }

    /// The text.
    pub fn text(&self) -> &'t [u8] {
        self.text
    }

    /// What [`Place::of_byte`] says, for the start of a character.
    pub fn of_byte(&mut self, offset: usize) -> Place {
        if offset < self.byte {
            *self = Places::new(self.text);
        }
        let step = Place::of_byte(&self.text[self.byte..], offset - self.byte);
        let column = if step.line == 1 { self.place.column.saturating_add(step.column - 1) } else { step.column };
        self.place = Place { line: self.place.line.saturating_add(step.line - 1), column };
        self.byte = offset.min(self.text.len());
        self.place
    }
}

/// What an error or a warning speaks of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The document that was read.
    Input,
    /// The expression given beside the document (`--expr`).
    Expression,
    /// A parameter given beside the document (a size, a range of lines).
    Parameter,
    /// Where the result goes.
    Output,
}

/// How an error is to be taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The text is not what it should be.
    Malformed,
    /// Understood, but refused: unknown names, circular references, things that must not be.
    Refused,
    /// Past a limit that has a name.
    Limit,
    /// Reading or writing failed.
    Io,
    /// The reader of the output went away: a normal end.
    Closed,
}

/// An error: one line of text with its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    /// How it is to be taken.
    pub kind: Kind,
    /// What it speaks of.
    pub origin: Origin,
    /// Where in the origin.
    pub place: Option<Place>,
    /// What is wrong and what to do, in one line without the place.
    pub what: String,
}

/// A result with the crate's own error.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// An error of the input document.
    pub fn input(kind: Kind, what: impl Into<String>) -> Error {
        Error { kind, origin: Origin::Input, place: None, what: one_line(&what.into()) }
    }

    /// An error of the expression given beside the document.
    pub fn expression(kind: Kind, what: impl Into<String>) -> Error {
        Error { origin: Origin::Expression, ..Error::input(kind, what) }
    }

    /// An error of a parameter given beside the document.
    pub fn parameter(what: impl Into<String>) -> Error {
        Error { origin: Origin::Parameter, ..Error::input(Kind::Refused, what) }
    }

    /// A failure of the output.
    pub fn output(error: &std::io::Error) -> Error {
        let kind = if error.kind() == std::io::ErrorKind::BrokenPipe { Kind::Closed } else { Kind::Io };
        Error { origin: Origin::Output, ..Error::input(kind, error.to_string()) }
    }

    /// The same error at a place.
    #[must_use]
    pub fn at(self, place: Place) -> Error {
        Error { place: Some(place), ..self }
    }

    /// The same error at byte `offset` of `text`.
    #[must_use]
    pub fn at_byte(self, text: &[u8], offset: usize) -> Error {
        self.at(Place::of_byte(text, offset))
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = self.place {
            write!(f, "{}:{}: ", place.line, place.column)?;
        }
        f.write_str(&self.what)
    }
}

impl std::error::Error for Error {}

/// Something the user should know although the work goes on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// What it speaks of.
    pub origin: Origin,
    /// Where in the origin.
    pub place: Option<Place>,
    /// What it is about, in one line, with the element's id where there is one.
    pub what: String,
    /// Whether the document asks for something outside it, which was not read. A service refuses that.
    pub outside: bool,
}

impl Warning {
    /// A warning about the input document.
    pub fn input(what: impl Into<String>) -> Warning {
        Warning { origin: Origin::Input, place: None, what: one_line(&what.into()), outside: false }
    }
}

/// Control characters become spaces, and a very long text is cut: a message is one line whatever the input held.
fn one_line(text: &str) -> String {
    const LONGEST: usize = 600;
    let mut line: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).take(LONGEST).collect();
    if line.len() < text.len() && text.chars().count() > LONGEST {
        line.push('…');
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_characters_from_one() {
        let text = "añb\ncd".as_bytes();
        assert_eq!(Place::of_byte(text, 0), Place { line: 1, column: 1 });
        assert_eq!(Place::of_byte(text, 3), Place { line: 1, column: 3 });
        assert_eq!(Place::of_byte(text, 6), Place { line: 2, column: 2 });
        assert_eq!(Place::of_byte(text, 99), Place { line: 2, column: 3 });
        let mut places = Places::new(text);
        for offset in [1, 3, 3, 4, 6, 99, 99, 0, 5] {
            assert_eq!(places.of_byte(offset), Place::of_byte(text, offset), "{offset}");
        }
    }

    #[test]
    fn a_message_is_one_line() {
        assert_eq!(Error::input(Kind::Malformed, "a\nb").what, "a b");
        assert_eq!(Error::input(Kind::Malformed, "x".repeat(5000)).what.chars().count(), 601);
    }
}
