//! Where a document or a line stream comes from: a file, a FIFO, standard input.

use std::fs::{self, File, Metadata};
use std::io::{self, Read};
use std::os::fd::AsFd;
use std::path::{Path, PathBuf};

use runset::input::Fonts;

use super::messages::{Failure, reason};
use super::values::show_bytes;

/// How much of a document is read.
#[derive(clap::Args)]
pub struct Limit {
    /// Largest document in bytes after decompression; k, M and G are powers of 1024
    ///
    /// A larger document is refused without being read to its end.
    #[arg(long, value_name = "BYTES", default_value = "128M", value_parser = super::values::bytes)]
    pub max_input: u64,
}

/// The fonts that text is drawn with.
#[derive(clap::Args)]
pub struct FontOptions {
    /// Font file for text, besides the built-in font; may be given several times
    #[arg(long, value_name = "FILE", value_hint = clap::ValueHint::FilePath)]
    font: Vec<PathBuf>,

    /// Use the system's fonts too; off by default, so that the same input gives the same picture everywhere
    #[arg(long)]
    system_fonts: bool,
}

impl FontOptions {
    /// Reads the fonts, each at most as large as a document may be.
    ///
    /// # Errors
    /// A file that cannot be read, or that is no font.
    pub fn load(&self, limit: &Limit) -> Result<Fonts, Failure> {
        let mut fonts = Fonts::default();
        for path in &self.font {
            let source = Source::find(path)?;
            fonts.add(source.read(limit.max_input)?).map_err(|error| Failure::at(source.name(), error))?;
        }
        if self.system_fonts {
            fonts.add_system();
        }
        Ok(fonts)
    }
}

/// An input that exists and has not been read.
pub struct Source {
    /// None: standard input.
    path: Option<PathBuf>,
    metadata: Metadata,
}

impl Source {
    /// Looks at the input without reading or opening it (opening a FIFO would wait for its writer). `-` is standard input.
    ///
    /// # Errors
    /// The file is not there, or it is a folder.
    pub fn find(path: &Path) -> Result<Source, Failure> {
        let path = (path.as_os_str() != "-").then(|| path.to_owned());
        let metadata = match &path {
            Some(path) => fs::metadata(path),
            None => stdin().and_then(|file| file.metadata()),
        };
        let name = name(path.as_deref());
        match metadata {
            Ok(metadata) if metadata.is_dir() => Err(Failure::at(name, "this is a folder; name a file")),
            Ok(metadata) => Ok(Source { path, metadata }),
            Err(error) => Err(Failure::at(name, format_args!("cannot read: {}", reason(&error)))),
        }
    }

    /// Whether it is standard input.
    pub fn is_standard(&self) -> bool {
        self.path.is_none()
    }

    /// What messages call it.
    pub fn name(&self) -> String {
        name(self.path.as_deref())
    }

    /// The folder that it is in; none for standard input.
    pub fn folder(&self) -> Option<PathBuf> {
        self.path.as_ref().map(|path| path.parent().unwrap_or(path).to_owned())
    }

    /// What the system knows of it.
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// Opens it.
    ///
    /// # Errors
    /// What the system says.
    pub fn open(&self) -> Result<File, Failure> {
        self.path.as_ref().map_or_else(stdin, File::open).map_err(|error| self.unreadable(&error))
    }

    /// Reads all of it, at most `limit` bytes.
    ///
    /// # Errors
    /// What the system says; an input past the limit, of which no more than the limit is read.
    pub fn read(&self, limit: u64) -> Result<Vec<u8>, Failure> {
        let mut bytes = Vec::new();
        if !self.metadata.is_file() || self.metadata.len() <= limit {
            let mut reader = self.open()?.take(limit.saturating_add(1));
            let known = usize::try_from(self.metadata.len()).unwrap_or(usize::MAX);
            bytes.try_reserve_exact(known).map_err(|_| self.unreadable(&io::ErrorKind::OutOfMemory.into()))?;
            reader.read_to_end(&mut bytes).map_err(|error| self.unreadable(&error))?;
            if bytes.len() as u64 <= limit {
                return Ok(bytes);
            }
        }
        Err(Failure::at(self.name(), format_args!("larger than {} bytes; raise the limit with --max-input", show_bytes(limit))))
    }

    fn unreadable(&self, error: &io::Error) -> Failure {
        Failure::at(self.name(), format_args!("cannot read: {}", reason(error)))
    }
}

fn name(path: Option<&Path>) -> String {
    path.map_or_else(|| "<stdin>".to_owned(), |path| path.display().to_string())
}

/// Standard input, unbuffered.
fn stdin() -> io::Result<File> {
    Ok(File::from(io::stdin().as_fd().try_clone_to_owned()?))
}
