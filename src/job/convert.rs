//! A line stream in, any format out. (Skeleton.)

use std::io::{BufRead, Write};

use crate::encode::Format;
use crate::error::Result;
use crate::run::Header;

/// Reads a line stream (ndjson or rls, told by its first bytes) and writes it in another format.
///
/// # Errors
/// A broken stream, with its place; what the writer says.
pub fn convert(_input: &mut dyn BufRead, _format: &Format, _out: &mut dyn Write, _progress: &mut dyn FnMut(u32)) -> Result<Header> {
    unimplemented!()
}
