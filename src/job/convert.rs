//! A line stream in, any format out, a record at a time.

use std::io::{BufRead, Write};

use super::pump::{PORTION, Pump};
use super::write;
use crate::encode::Format;
use crate::error::Result;
use crate::input::lines::LineReader;
use crate::run::{Header, Lines};

/// Reads a line stream (ndjson or rls, told by its first bytes) and writes it in another format, with a resolution in dots an inch if there is one.
/// `progress` is called with the number of lines written so far, now and then. Gives the raster's header.
///
/// # Errors
/// Before the first byte, what [`Format::check`] says. A broken stream, with its place: what was written until then is not a whole raster. What the writer says.
pub fn convert(
    input: &mut dyn BufRead,
    format: &Format,
    dpi: Option<f64>,
    out: &mut dyn Write,
    progress: &mut dyn FnMut(u32),
) -> Result<Header> {
    let mut reader = LineReader::open(input)?;
    let header = Header { dpi, ..reader.header().clone() };
    format.check(&header)?;
    let mut bytes = Vec::with_capacity(2 * PORTION);
    let mut pump = Pump::new(format, &header, &mut bytes);
    while let Some(Lines { mut y, mut n, runs }) = reader.next_lines()? {
        while n > 0 {
            let took = pump.push(Lines { y, n, runs }, &mut bytes);
            (y, n) = (y + took, n - took);
            if bytes.len() >= PORTION {
                write(out, &mut bytes)?;
                progress(pump.lines);
            }
        }
    }
    pump.finish(&mut bytes);
    write(out, &mut bytes)?;
    out.flush().map_err(|error| crate::error::Error::output(&error))?;
    progress(pump.lines);
    Ok(header)
}
