//! Reader of rls, the binary line stream; `docs/rls.md` is its specification.

use std::io::BufRead;

use super::{Raster, check_inks, check_lines, check_width, malformed, next_bytes};
use crate::error::{Error, Result};
use crate::run::{Inks, MAX_INKS, Told, ink_of};

/// What every stream begins with.
pub const MAGIC: [u8; 8] = *b"\x89RLS\r\n\x1a\n";

/// The version that is read.
const VERSION: u64 = 1;

/// The kinds of streams: runs show inks of a list, or carry their colours.
const LISTED: u64 = 0;
const SHADED: u64 = 1;

/// Bytes held at a time, at most.
const PIECE: usize = 1 << 16;

/// A stream, of which a piece is held.
pub struct Reader<'i> {
    input: &'i mut dyn BufRead,
    piece: Vec<u8>,
    /// The next byte of the piece.
    at: usize,
    /// Where in the stream the piece begins.
    offset: u64,
}

impl<'i> Reader<'i> {
    pub fn new(input: &'i mut dyn BufRead) -> Reader<'i> {
        Reader { input, piece: Vec::new(), at: 0, offset: 0 }
    }

    /// Reads what stands before the first record.
    pub fn header(&mut self) -> Result<Raster> {
        if self.bytes()? != MAGIC {
            return Err(place(0, "not an rls stream, or one that was treated as text on its way: its first eight bytes are wrong"));
        }
        let at = self.place();
        let version = self.number()?;
        if version != VERSION {
            return Err(place(at, format!("version {version}; this program reads version {VERSION}")));
        }
        let at = self.place();
        let kind = self.number()?;
        if kind != LISTED && kind != SHADED {
            let what =
                format!("a stream of kind {kind}; this program reads kind {LISTED}, runs of inks, and kind {SHADED}, runs of colours");
            return Err(place(at, what));
        }
        let at = self.place();
        let width = check_width(self.number()?).map_err(|what| place(at, what))?;
        let at = self.place();
        let lines = check_lines(self.number()?, self.number()?).map_err(|what| place(at, what))?;
        if kind == SHADED {
            return Ok(Raster::new(width, lines, Inks::Shaded { paper: self.bytes()? }));
        }
        let at = self.place();
        let count = self.number()?;
        if count > MAX_INKS as u64 {
            return Err(place(at, format!("{count} inks; at most {MAX_INKS} are possible")));
        }
        let inks = (0..count).map(|_| self.bytes()).collect::<Result<Vec<_>>>()?;
        check_inks(&inks).map_err(|what| place(at, what))?;
        Ok(Raster::new(width, lines, Inks::Listed(inks)))
    }

    /// Reads a record, or the end record and the end: `false`.
    pub fn record(&mut self, raster: &mut Raster) -> Result<bool> {
        let at = self.place();
        let n = self.number()?;
        if n == 0 {
            return self.end(raster, at);
        }
        raster.begin(n).map_err(|what| place(at, what))?;
        let told = raster.header.inks.told();
        let count_at = self.place();
        let count = self.number()?;
        if count > u64::from(raster.header.width) {
            return Err(place(count_at, format!("{count} runs on a line of {} pixels", raster.header.width)));
        }
        let mut end = 0u64;
        for _ in 0..count {
            let at = self.place();
            let start = end.saturating_add(self.number()?);
            end = start.saturating_add(self.number()?);
            let ink = match told {
                Told::Nothing => 0,
                Told::Index => self.number()?,
                Told::Colour => ink_of(self.bytes()?).into(),
            };
            raster.run(start, end, ink).map_err(|what| place(at, what))?;
        }
        raster.record();
        Ok(true)
    }

    fn end(&mut self, raster: &Raster, at: u64) -> Result<bool> {
        let (lines, runs) = (self.number()?, self.number()?);
        let crc32 = u32::from_be_bytes(self.bytes()?);
        raster.end(lines, runs, crc32).map_err(|what| place(at, what))?;
        if self.refill()? {
            return Err(place(self.place(), "something follows the end record; a stream ends with it"));
        }
        Ok(false)
    }

    /// Where in the stream the next byte is.
    fn place(&self) -> u64 {
        self.offset + self.at as u64
    }

    /// Makes sure that there is a next byte; `false` at the end of the input.
    fn refill(&mut self) -> Result<bool> {
        if self.at == self.piece.len() {
            self.offset += self.piece.len() as u64;
            self.at = 0;
            self.piece.clear();
            next_bytes(self.input, |bytes| self.piece.extend_from_slice(&bytes[..bytes.len().min(PIECE)]))?;
            self.input.consume(self.piece.len());
        }
        Ok(!self.piece.is_empty())
    }

    fn byte(&mut self) -> Result<u8> {
        if !self.refill()? {
            return Err(place(self.place(), "the stream ends here, without its end record: it is not complete"));
        }
        self.at += 1;
        Ok(self.piece[self.at - 1])
    }

    fn bytes<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut bytes = [0; N];
        for byte in &mut bytes {
            *byte = self.byte()?;
        }
        Ok(bytes)
    }

    /// A LEB128 number in its shortest form.
    fn number(&mut self) -> Result<u64> {
        let at = self.place();
        let (mut number, mut shift) = (0u64, 0);
        loop {
            let byte = self.byte()?;
            let bits = u64::from(byte & 0x7f);
            if shift > 63 || bits << shift >> shift != bits {
                return Err(place(at, "a number past 64 bits"));
            }
            number |= bits << shift;
            if byte & 0x80 == 0 {
                return if byte == 0 && shift > 0 { Err(place(at, "a number with a needless last byte")) } else { Ok(number) };
            }
            shift += 7;
        }
    }
}

/// An error at a byte of the stream.
fn place(at: u64, what: impl AsRef<str>) -> Error {
    malformed(format!("byte {at}: {}", what.as_ref()))
}
