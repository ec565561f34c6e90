//! The words of a `.csg`, each with the byte where it begins.

use winnow::Parser;
use winnow::combinator::{alt, opt, preceded, repeat};
use winnow::error::{EmptyError, ErrMode};
use winnow::stream::{LocatingSlice, Location};
use winnow::token::{any, one_of, take_till, take_until, take_while};

use crate::error::{Error, Kind, Result};

type Text<'t> = LocatingSlice<&'t [u8]>;
type Found<T> = winnow::Result<T, ErrMode<EmptyError>>;

/// A word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Word<'t> {
    /// A name, `$` before it or not.
    Name(&'t str),
    /// A number.
    Number(f64),
    /// What stands between double quotes, with its backslashes.
    Text(&'t [u8]),
    /// One of `( ) [ ] { } , ; = : # % ! * -`, or what does not belong.
    Sign(u8),
    /// Nothing is left.
    End,
}

/// Cuts a document into words.
pub(super) struct Words<'t> {
    text: &'t [u8],
    rest: Text<'t>,
    /// The next word and where it begins.
    next: (Word<'t>, usize),
}

impl<'t> Words<'t> {
    pub(super) fn new(text: &'t [u8]) -> Result<Words<'t>> {
        let mut words = Words { text, rest: LocatingSlice::new(text), next: (Word::End, 0) };
        words.take()?;
        Ok(words)
    }

    /// The next word and the byte where it begins, without taking it.
    pub(super) fn peek(&self) -> (Word<'t>, usize) {
        self.next
    }

    /// Takes the next word.
    pub(super) fn take(&mut self) -> Result<(Word<'t>, usize)> {
        let taken = self.next;
        let fails = |what: &str, at: usize| Error::input(Kind::Malformed, what).at_byte(self.text, at);
        let _: Found<()> = blank.parse_next(&mut self.rest);
        let at = self.rest.current_token_start();
        if self.rest.starts_with(b"/*") {
            return Err(fails("this comment is never closed: add */", at));
        }
        let word: Found<Word<'t>> = alt((name, number, text, any.map(Word::Sign))).parse_next(&mut self.rest);
        self.next = match word {
            Ok(Word::Sign(b'"')) => return Err(fails("this quote is never closed: add a \" after the text", at)),
            Ok(Word::Number(x)) if x.is_nan() => return Err(fails("this is not a number", at)),
            Ok(word) => (word, at),
            Err(_) => (Word::End, self.text.len()),
        };
        Ok(taken)
    }

    /// Takes the next word if it is this sign.
    pub(super) fn sign(&mut self, sign: u8) -> Result<bool> {
        let found = self.next.0 == Word::Sign(sign);
        if found {
            self.take()?;
        }
        Ok(found)
    }
}

/// Spaces and comments.
fn blank(text: &mut Text<'_>) -> Found<()> {
    let space = take_while(1.., (b' ', b'\t', b'\r', b'\n')).void();
    let line = preceded(&b"//"[..], take_till(0.., b'\n')).void();
    let block = (&b"/*"[..], take_until(0.., &b"*/"[..]), &b"*/"[..]).void();
    repeat(0.., alt((space, line, block))).parse_next(text)
}

fn name<'t>(text: &mut Text<'t>) -> Found<Word<'t>> {
    let letter = |c: u8| c.is_ascii_alphabetic() || c == b'_';
    let name = (opt(b'$'), one_of(letter), take_while(0.., |c: u8| letter(c) || c.is_ascii_digit())).take();
    name.map(|name: &[u8]| Word::Name(std::str::from_utf8(name).expect("ASCII letters"))).parse_next(text)
}

/// A number; what begins like one and is none is NaN. Past the range of 64 bits it is infinite.
fn number<'t>(text: &mut Text<'t>) -> Found<Word<'t>> {
    let digits = |least: usize| take_while(least.., |c: u8| c.is_ascii_digit());
    let mantissa = alt(((digits(1), opt((b'.', digits(0)))).void(), (b'.', digits(1)).void()));
    let exponent = (one_of((b'e', b'E')), opt(one_of((b'+', b'-'))), digits(1));
    // What sticks to it belongs to no number.
    let stuck = take_while(0.., |c: u8| c.is_ascii_alphanumeric() || c == b'_' || c == b'.');
    let number = (opt(b'-'), mantissa, opt(exponent), stuck).take();
    number
        .map(|number: &[u8]| Word::Number(std::str::from_utf8(number).ok().and_then(|n| n.parse().ok()).unwrap_or(f64::NAN)))
        .parse_next(text)
}

fn text<'t>(text: &mut Text<'t>) -> Found<Word<'t>> {
    let part = alt((take_while(1.., |c: u8| c != b'"' && c != b'\\').void(), (b'\\', any).void()));
    let inside = repeat::<_, _, (), _, _>(0.., part).take();
    (b'"', inside, b'"').map(|(_, inside, _): (u8, &[u8], u8)| Word::Text(inside)).parse_next(text)
}
