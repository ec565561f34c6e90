//! The words of an expression, each with its place.

use super::BUILT_IN;
use crate::error::{Error, Kind, Place, Result};

/// A word of an expression.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Token {
    /// An id written bare: `[A-Za-z_][A-Za-z0-9_.:]*`.
    Bare(String),
    /// An id written in double quotes, without them and without escapes.
    Quoted(String),
    /// A word that begins with a digit.
    Number(String),
    /// Any other single character.
    Sign(char),
    /// Nothing is left.
    End,
}

/// Whether `id` can stand bare, without quotes.
fn is_bare(id: &str) -> bool {
    id.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') && id.chars().all(is_word)
}

/// An id as it is written in an expression, for messages: bare where it can be.
pub(super) fn written(id: &str) -> String {
    if is_bare(id) && !BUILT_IN.contains(&id) { shortened(id) } else { quoted(id) }
}

/// An id in double quotes, for messages.
pub(crate) fn quoted(id: &str) -> String {
    format!("\"{}\"", shortened(id).replace('\\', "\\\\").replace('"', "\\\""))
}

fn shortened(id: &str) -> String {
    const LONGEST: usize = 60;
    let mut short: String = id.chars().take(LONGEST).collect();
    if short.len() < id.len() {
        short.push('…');
    }
    short
}

fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || matches!(c, '_' | '.' | ':')
}

/// Cuts a text into tokens.
pub(super) struct Tokens<'a> {
    chars: std::iter::Peekable<std::str::Chars<'a>>,
    place: Place,
}

impl<'a> Tokens<'a> {
    pub(super) fn new(text: &'a str) -> Tokens<'a> {
        Tokens { chars: text.chars().peekable(), place: Place { line: 1, column: 1 } }
    }

    /// The next token and where it begins.
    pub(super) fn next(&mut self) -> Result<(Token, Place)> {
        while self.chars.next_if(|c| c.is_whitespace()).inspect(|&c| self.step(c)).is_some() {}
        let place = self.place;
        let token = match self.take() {
            None => Token::End,
            Some('"') => Token::Quoted(self.quoted(place)?),
            Some(c) if c.is_ascii_digit() => Token::Number(self.word(c)),
            Some(c) if is_word(c) && !matches!(c, '.' | ':') => Token::Bare(self.word(c)),
            Some(c) => Token::Sign(c),
        };
        Ok((token, place))
    }

    /// Whether the next word is an opening parenthesis; spaces before it are skipped.
    pub(super) fn opens(&mut self) -> bool {
        while self.chars.next_if(|c| c.is_whitespace()).inspect(|&c| self.step(c)).is_some() {}
        self.chars.peek() == Some(&'(')
    }

    fn word(&mut self, first: char) -> String {
        let mut word = String::from(first);
        while let Some(c) = self.chars.next_if(|&c| is_word(c)) {
            self.step(c);
            word.push(c);
        }
        word
    }

    fn quoted(&mut self, open: Place) -> Result<String> {
        let mut id = String::new();
        loop {
            let place = self.place;
            match self.take() {
                Some('"') => return Ok(id),
                Some('\\') => match self.take() {
                    Some(c @ ('"' | '\\')) => id.push(c),
                    _ => return Err(malformed(r#"in quotes a \ stands only before " or \: write it twice"#).at(place)),
                },
                Some(c) => id.push(c),
                None => return Err(malformed("this quote is never closed: add a \" after the id").at(open)),
            }
        }
    }

    fn take(&mut self) -> Option<char> {
        self.chars.next().inspect(|&c| self.step(c))
    }

    fn step(&mut self, c: char) {
        if c == '\n' {
            self.place.line = self.place.line.saturating_add(1);
            self.place.column = 1;
        } else {
            self.place.column = self.place.column.saturating_add(1);
        }
    }
}

/// An error of an expression's text.
pub(super) fn malformed(what: impl Into<String>) -> Error {
    Error::expression(Kind::Malformed, what)
}
