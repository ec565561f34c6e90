//! Where a raster goes, also where its head depends on lines behind it.
//!
//! ```text
//!   the head is known        out
//!   a file                   out, and the head written over the zeros that stand for it
//!   a pipe                   a temporary file, its head written over; then out
//! ```

use std::fs::File;
use std::io::{self, Read, Seek, Write};

use crate::encode::{self, Encode, Format};
use crate::error::{Error, Result};
use crate::run::Header;

/// What can be written over.
pub trait Rewind: Write + Seek {}

impl<T: Write + Seek> Rewind for T {}

/// Where a raster is to go.
pub enum Out<'o> {
    /// What was written stays. A raster whose head depends on lines behind it goes into an unnamed temporary file first, in the folder of [`std::env::temp_dir`].
    Stream(&'o mut dyn Write),
    /// A file that is empty, or where the raster is all that is behind the first byte.
    File(&'o mut dyn Rewind),
}

/// A place for the bytes of one raster.
pub enum Outlet<'o> {
    Direct(&'o mut dyn Write),
    Patched(&'o mut dyn Rewind),
    Spooled(File, &'o mut dyn Write),
}

impl<'o> Outlet<'o> {
    /// A place for what `encoder` will write.
    ///
    /// # Errors
    /// There can be no temporary file.
    pub fn new(out: Out<'o>, encoder: &dyn Encode) -> Result<Outlet<'o>> {
        Ok(match out {
            Out::Stream(out) if encoder.head_is_known() => Outlet::Direct(out),
            Out::Stream(out) => Outlet::Spooled(tempfile::tempfile().map_err(|error| Error::output(&of_spool(&error)))?, out),
            Out::File(file) if encoder.head_is_known() => Outlet::Direct(file),
            Out::File(file) => Outlet::Patched(file),
        })
    }

    /// Behind the last byte, puts the head where it belongs, and hands everything on.
    ///
    /// # Errors
    /// What the writer says.
    pub fn finish(&mut self, format: &Format, header: &Header, encoder: &dyn Encode) -> Result<()> {
        let head = || encode::head(format, header, encoder.table().unwrap_or_default());
        let finished = match self {
            Outlet::Direct(out) => out.flush(),
            Outlet::Patched(file) => file.rewind().and_then(|()| file.write_all(&head())).and_then(|()| file.flush()),
            Outlet::Spooled(spool, out) => {
                let written = spool.rewind().and_then(|()| spool.write_all(&head())).and_then(|()| spool.rewind());
                written.map_err(|error| of_spool(&error)).and_then(|()| copy(spool, *out))
            }
        };
        finished.map_err(|error| Error::output(&error))
    }
}

/// Copies a temporary file from where it stands to its end.
fn copy(spool: &mut File, out: &mut dyn Write) -> io::Result<()> {
    /// Bytes at a time.
    const CHUNK: usize = 1 << 18;
    let mut chunk = vec![0; CHUNK];
    loop {
        match spool.read(&mut chunk).map_err(|error| of_spool(&error))? {
            0 => return out.flush(),
            n => out.write_all(&chunk[..n])?,
        }
    }
}

/// What is wrong with the temporary file.
fn of_spool(error: &io::Error) -> io::Error {
    let folder = std::env::temp_dir();
    io::Error::new(error.kind(), format!("the temporary file in {} (TMPDIR names another folder): {error}", folder.display()))
}

impl Write for Outlet<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Outlet::Direct(out) => out.write(bytes),
            Outlet::Patched(file) => file.write(bytes),
            Outlet::Spooled(spool, _) => spool.write(bytes).map_err(|error| of_spool(&error)),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
