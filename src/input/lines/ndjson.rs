//! Reader of ndjson, the line stream as JSON texts.
//!
//! A record is one line, with the keys in the order in which they are written and no others; blanks between its tokens are
//! allowed. It is read in one pass, without a tree.

use std::io::{BufRead, Read};

use super::{Raster, check_inks, check_lines, check_width, failed, malformed};
use crate::error::{Error, Place, Result};
use crate::run::{Hex, Inks, MAX_INKS, Rgb, Told, ink_of};

/// Longest header, in bytes: a colour and its quotes, a comma and some blanks for every ink.
const MAX_HEADER_BYTES: u64 = 1024 + 16 * MAX_INKS as u64;

/// Longest record, in bytes: for every pixel a run with its brackets and commas (at most 28 bytes) and some blanks.
fn max_record_bytes(width: u32) -> u64 {
    1024 + 32 * u64::from(width)
}

/// A stream, of which a line is held.
pub struct Reader<'i> {
    input: &'i mut dyn BufRead,
    line: Vec<u8>,
    /// Number of the line, from 1.
    number: u32,
}

/// What is wrong, at which byte of the line.
type Fault = (usize, String);

type Parsed<T = ()> = std::result::Result<T, Fault>;

impl<'i> Reader<'i> {
    pub fn new(input: &'i mut dyn BufRead) -> Reader<'i> {
        Reader { input, line: Vec::new(), number: 0 }
    }

    /// Reads the header record.
    pub fn header(&mut self) -> Result<Raster> {
        self.next_line(MAX_HEADER_BYTES)?;
        header(&mut Cursor { text: &self.line, at: 0 }).map_err(|fault| self.error(fault))
    }

    /// Reads a record, or the end record and the end: `false`.
    pub fn record(&mut self, raster: &mut Raster) -> Result<bool> {
        self.next_line(max_record_bytes(raster.header.width))?;
        let more = record(&mut Cursor { text: &self.line, at: 0 }, raster).map_err(|fault| self.error(fault))?;
        if !more {
            self.line.clear();
            self.number += 1;
            if self.read(1)? > 0 {
                return Err(self.error((0, "something follows the end record; a stream ends with it".into())));
            }
        }
        Ok(more)
    }

    /// Reads a line of at most `limit` bytes, and takes its newline off.
    fn next_line(&mut self, limit: u64) -> Result<()> {
        self.line.clear();
        self.number += 1;
        let read = self.read(limit)?;
        if self.line.pop_if(|byte| *byte == b'\n').is_some() {
            return Ok(());
        }
        let what = match read {
            0 => "the stream ends here, without its end record: it is not complete".into(),
            _ if read == limit => format!("a line of more than {limit} bytes; no record of this raster is as long"),
            _ => "the stream ends within this line: it is not complete".into(),
        };
        Err(self.error((self.line.len(), what)))
    }

    /// Reads to the end of the line, `limit` bytes at most; the number of bytes read.
    fn read(&mut self, limit: u64) -> Result<u64> {
        let read = (&mut *self.input).take(limit).read_until(b'\n', &mut self.line);
        read.map(|n| n as u64).map_err(|error| failed(&error))
    }

    fn error(&self, (at, what): Fault) -> Error {
        malformed(what).at(Place { line: self.number, ..Place::of_byte(&self.line, at) })
    }
}

fn header(line: &mut Cursor<'_>) -> Parsed<Raster> {
    line.token(b'{')?;
    let (at, key) = line.text().unwrap_or_else(|(at, _)| (at, b""));
    if key != b"runset" {
        return Err((at, "not a line stream, whose header's first key is \"runset\"; a scene is drawn by runset fill".into()));
    }
    line.token(b':')?;
    let (at, version) = line.number()?;
    if version != 1 {
        return Err((at, format!("version {version}; this program reads version 1")));
    }
    let (at, width) = line.member("width")?;
    let width = check_width(width).map_err(|what| (at, what))?;
    let (height_at, height) = line.member("height")?;
    let (at, from) = line.member("from")?;
    let (_, to) = line.member("to")?;
    let lines = check_lines(from, to).map_err(|what| (at, what))?;
    if height != to - from {
        return Err((height_at, format!("the height is {height}, and there are {} lines from {from} to {to}", to - from)));
    }
    let at = line.key("inks")?;
    let inks = if line.peek() == Some(b'"') { shaded(line)? } else { listed(line, at)? };
    line.finish()?;
    Ok(Raster::new(width, lines, inks))
}

/// Reads a list of inks, whose key is at byte `at`.
fn listed(line: &mut Cursor<'_>, at: usize) -> Parsed<Inks> {
    let mut inks = Vec::new();
    line.list(|line| {
        inks.push(line.colour()?);
        if inks.len() > MAX_INKS { Err((line.at, format!("more than {MAX_INKS} inks"))) } else { Ok(()) }
    })?;
    check_inks(&inks).map_err(|what| (at, what))?;
    Ok(Inks::Listed(inks))
}

/// Reads `"rgb"`, which stands in place of a list where runs tell their colours, and the colour of paper.
fn shaded(line: &mut Cursor<'_>) -> Parsed<Inks> {
    let (at, word) = line.text()?;
    if word != b"rgb" {
        return Err((at, "inks are a list of colours, or \"rgb\"".into()));
    }
    line.key("paper")?;
    Ok(Inks::Shaded { paper: line.colour()? })
}

/// Reads a record into `raster`, or an end record: `false`.
fn record(line: &mut Cursor<'_>, raster: &mut Raster) -> Parsed<bool> {
    line.token(b'{')?;
    let (at, key) = line.text()?;
    match key {
        b"y" => line.token(b':')?,
        b"end" => return end(line, raster, at).map(|()| false),
        _ => return Err((at, "the first key of a record is \"y\", of the end record \"end\"".into())),
    }
    let (at, y) = line.number()?;
    if y != u64::from(raster.y) {
        return Err((at, format!("line {y} where line {} was to come; every line is there once, from top to bottom", raster.y)));
    }
    let (at, n) = line.member("n")?;
    raster.begin(n).map_err(|what| (at, what))?;
    let told = raster.header.inks.told();
    line.key("runs")?;
    line.list(|line| {
        line.token(b'[')?;
        let (at, start) = line.number()?;
        line.token(b',')?;
        let (_, end) = line.number()?;
        let ink = match told {
            Told::Nothing => 0,
            Told::Index => line.token(b',').and_then(|()| line.number())?.1,
            Told::Colour => line.token(b',').and_then(|()| line.colour()).map(ink_of)?.into(),
        };
        line.token(b']')?;
        raster.run(start, end, ink).map_err(|what| (at, what))
    })?;
    line.finish()?;
    raster.record();
    Ok(true)
}

/// Reads the rest of an end record, whose first key is at byte `at`.
fn end(line: &mut Cursor<'_>, raster: &Raster, at: usize) -> Parsed {
    line.token(b':')?;
    line.word("true")?;
    let (_, lines) = line.member("lines")?;
    let (_, runs) = line.member("runs")?;
    line.key("crc32")?;
    let crc32 = line.crc32()?;
    line.finish()?;
    raster.end(lines, runs, crc32).map_err(|what| (at, what))
}

/// A line of JSON, token by token. Blanks before a token are skipped.
struct Cursor<'a> {
    text: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    fn peek(&mut self) -> Option<u8> {
        while let Some(b' ' | b'\t' | b'\r') = self.text.get(self.at) {
            self.at += 1;
        }
        self.text.get(self.at).copied()
    }

    fn token(&mut self, byte: u8) -> Parsed {
        if self.peek() != Some(byte) {
            return Err((self.at, format!("expected `{}`", byte as char)));
        }
        self.at += 1;
        Ok(())
    }

    fn word(&mut self, word: &str) -> Parsed {
        self.peek();
        if !self.text[self.at..].starts_with(word.as_bytes()) {
            return Err((self.at, format!("expected `{word}`")));
        }
        self.at += word.len();
        Ok(())
    }

    /// A string, without its quotes; escapes are not needed, and are not read.
    fn text(&mut self) -> Parsed<(usize, &'a [u8])> {
        self.token(b'"')?;
        let start = self.at;
        let rest = &self.text[start..];
        let len = rest.iter().position(|byte| *byte == b'"').ok_or_else(|| (start, "a string that does not end".to_string()))?;
        self.at += len + 1;
        Ok((start - 1, &rest[..len]))
    }

    /// A whole number, and where it stands.
    fn number(&mut self) -> Parsed<(usize, u64)> {
        let (first, start) = (self.peek(), self.at);
        let mut number = 0u64;
        while let Some(digit @ b'0'..=b'9') = self.text.get(self.at) {
            let next = number.checked_mul(10).and_then(|n| n.checked_add(u64::from(digit - b'0')));
            number = next.ok_or_else(|| (start, "a number past 64 bits".to_string()))?;
            self.at += 1;
        }
        match self.at - start {
            0 => Err((start, "expected a whole number".into())),
            2.. if first == Some(b'0') => Err((start, "a number with a leading zero".into())),
            _ => Ok((start, number)),
        }
    }

    /// A comma, the key and a colon; where the key stands.
    fn key(&mut self, name: &str) -> Parsed<usize> {
        let at = self.at;
        let unexpected = |at| (at, format!("expected `,\"{name}\":`; keys have one order and all are there"));
        self.token(b',').map_err(|_| unexpected(at))?;
        let (at, key) = self.text().map_err(|_| unexpected(at))?;
        if key != name.as_bytes() {
            return Err(unexpected(at));
        }
        self.token(b':')?;
        Ok(at)
    }

    /// The same with a number behind it; the number and where it stands.
    fn member(&mut self, name: &str) -> Parsed<(usize, u64)> {
        self.key(name)?;
        self.number()
    }

    /// A list of what `item` reads.
    fn list(&mut self, mut item: impl FnMut(&mut Self) -> Parsed) -> Parsed {
        self.token(b'[')?;
        if self.peek() != Some(b']') {
            item(self)?;
            while self.peek() == Some(b',') {
                self.at += 1;
                item(self)?;
            }
        }
        self.token(b']')
    }

    fn colour(&mut self) -> Parsed<Rgb> {
        let (at, text) = self.text()?;
        let colour = Hex::parse(text).filter(|colour| Hex::of(*colour).as_bytes() == text);
        colour.ok_or_else(|| (at, "expected a colour, \"#rrggbb\" in lower case".to_string()))
    }

    fn crc32(&mut self) -> Parsed<u32> {
        let (at, text) = self.text()?;
        hex(text).ok_or_else(|| (at, "expected eight hexadecimal digits in lower case".to_string()))
    }

    /// The end of the record and of the line.
    fn finish(&mut self) -> Parsed {
        self.token(b'}')?;
        match self.peek() {
            None => Ok(()),
            Some(_) => Err((self.at, "something follows the record on its line".into())),
        }
    }
}

/// The number of eight hexadecimal digits in lower case.
fn hex(digits: &[u8]) -> Option<u32> {
    let value = |byte: &u8| (*byte as char).to_digit(16).filter(|_| !byte.is_ascii_uppercase());
    (digits.len() == 8).then(|| digits.iter().try_fold(0, |sum, byte| Some(sum << 4 | value(byte)?)))?
}
