//! Where a raster goes, and the promise that a file under the output's name is complete.
//!
//! A regular file is written under another name in the same folder and renamed when it is complete; links are followed, the file that
//! they lead to is replaced and keeps its mode. Anything else (a pipe, a FIFO, a device, `/dev/stdout`) is written directly.
//! All that can be known to go wrong is found before the input is read.

use std::fs::{self, File, Metadata, OpenOptions, Permissions};
use std::io::{self, IsTerminal, Write};
use std::os::fd::AsFd;
use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt};
use std::path::{Path, PathBuf};

use runset::encode::{FORMATS, Format, by_extension};
use runset::job::Out;
use runset::mesh::stl;
use tempfile::TempPath;

use super::input::Source;
use super::messages::{Failure, reason};
use super::signals;
use super::values::{self, Content};

/// What the user says about the output.
#[derive(Clone, clap::Args)]
pub struct Target {
    /// File to write; - is standard output [default: -]
    ///
    /// A regular file appears under this name when it is complete, and not before. Devices and FIFOs are written directly. The head of a compressed TIFF tells how long
    /// its strips are: into a pipe, a device or a FIFO it goes by way of a temporary file without a name, in the folder that TMPDIR names (else /tmp).
    #[arg(short = 'o', long = "output", value_name = "OUT", value_hint = clap::ValueHint::FilePath)]
    path: Option<PathBuf>,

    /// Format of the output [default: from OUT's extension, else ndjson; png for solid]
    #[arg(long, value_name = "FORMAT", value_parser = values::format())]
    format: Option<Content>,

    /// Compression, in a format that has several [default: what suits the picture; of a TIFF g4 for black alone, else deflate]
    #[arg(long, value_name = "HOW", value_parser = values::compression())]
    compression: Option<String>,
}

impl Target {
    /// A file of that name.
    pub fn named(path: &Path) -> Target {
        Target { path: Some(path.to_owned()), format: None, compression: None }
    }

    /// The one of that number of several outputs: its name has the number in the place of `%d` or, with zeros in front, of `%03d`. None if the name has no such place.
    pub fn numbered(&self, number: usize) -> Option<Target> {
        let text = self.path()?.to_str()?;
        let (before, digits, behind) = text.match_indices('%').find_map(|(at, _)| {
            let rest = &text[at + 1..];
            let end = rest.find(|c: char| !c.is_ascii_digit())?;
            let behind = rest[end..].strip_prefix('d')?;
            // Nine digits are enough; a width without a zero in front would mean blanks.
            (end == 0 || end == 2 && rest.starts_with('0')).then(|| (&text[..at], &rest[..end], behind))
        })?;
        let width = digits.parse().unwrap_or(0);
        Some(Target { path: Some(format!("{before}{number:0width$}{behind}").into()), ..self.clone() })
    }

    /// What messages call it.
    pub fn name(&self) -> String {
        self.path().map_or_else(|| "<stdout>".to_owned(), |path| path.display().to_string())
    }

    /// The format that was asked for, or that the extension of the output's name says.
    ///
    /// # Errors
    /// No format of rasters has that name or extension.
    pub fn format(&self) -> Result<&'static Format, Failure> {
        self.format_or("ndjson")
    }

    /// The same with another format for an output whose name says none.
    ///
    /// # Errors
    /// No format of rasters has that name or extension, or it does not have the compression that was asked for.
    pub fn format_or(&self, default: &str) -> Result<&'static Format, Failure> {
        if self.is_surface() {
            return Err(Failure::Usage(format!("{} is for surfaces of models: runset solid writes it", stl::NAME)));
        }
        self.raster(default)?.compressed(self.compression.as_deref()).map_err(|what| Failure::Usage(format!("--compression: {what}")))
    }

    fn raster(&self, default: &str) -> Result<&'static Format, Failure> {
        if let Some(Content::Raster(format)) = self.format {
            return Ok(format);
        }
        match self.path().and_then(Path::extension) {
            Some(extension) => extension.to_str().and_then(by_extension).ok_or_else(|| {
                let known: Vec<_> = FORMATS.iter().flat_map(|f| f.extensions).map(|e| format!(".{e}")).collect();
                let extension = extension.display();
                Failure::Usage(format!("no format has the extension .{extension}; use one of {} or --format", known.join(", ")))
            }),
            None => Ok(by_extension(default).expect("the default format exists")),
        }
    }

    /// Whether a surface is asked for, by the format or by the extension of the output's name.
    pub fn is_surface(&self) -> bool {
        let extension = || self.path().and_then(Path::extension).is_some_and(|e| e.eq_ignore_ascii_case(stl::EXTENSION));
        matches!(self.format, Some(Content::Surface)) || self.format.is_none() && extension()
    }

    /// Whether a compression is asked for.
    pub fn is_compressed(&self) -> bool {
        self.compression.is_some()
    }

    /// The file, unless it is standard output.
    fn path(&self) -> Option<&Path> {
        self.path.as_deref().filter(|path| path.as_os_str() != "-")
    }
}

/// Names of standard output behind which no link is followed: opening what they lead to would start again at its beginning.
const STDOUT: [&str; 3] = ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"];

/// An output that is open.
pub struct Output {
    name: String,
    file: File,
    /// A regular file's temporary name, and the name that it gets.
    unfinished: Option<(TempPath, PathBuf)>,
}

impl Output {
    /// Opens the output of a run that reads `sources`.
    ///
    /// # Errors
    /// The output is one of the inputs, or a terminal that a binary format would spoil; its folder is missing or not writable.
    pub fn create(target: &Target, sources: &[Source], format: &Format) -> Result<Output, Failure> {
        Output::holding(target, sources, format.name, format.binary)
    }

    /// The same for an STL.
    ///
    /// # Errors
    /// Those of [`Output::create`].
    pub fn surface(target: &Target, source: &Source) -> Result<Output, Failure> {
        Output::holding(target, std::slice::from_ref(source), stl::NAME, true)
    }

    fn holding(target: &Target, sources: &[Source], format: &str, binary: bool) -> Result<Output, Failure> {
        let output = match target.path() {
            Some(path) => Output::named(path, sources)?,
            None => Output::standard(sources)?,
        };
        if binary && output.is_terminal() {
            let what = format!("{format} is a binary format and {} is a terminal; name a file with -o", output.name);
            return Err(Failure::Usage(what));
        }
        widen(&output.file);
        Ok(output)
    }

    fn standard(sources: &[Source]) -> Result<Output, Failure> {
        let name = "<stdout>".to_owned();
        let file = io::stdout().as_fd().try_clone_to_owned().map(File::from).map_err(|error| unwritable(&name, &error))?;
        let metadata = file.metadata().map_err(|error| unwritable(&name, &error))?;
        refuse_same(&name, &metadata, sources)?;
        Ok(Output { name, file, unfinished: None })
    }

    fn named(path: &Path, sources: &[Source]) -> Result<Output, Failure> {
        let name = path.display().to_string();
        if [&b"/"[..], b"/."].iter().any(|end| path.as_os_str().as_encoded_bytes().ends_with(end)) {
            return Err(is_folder(&name));
        }
        let path = resolve(path)?;
        if STDOUT.iter().any(|stdout| path == Path::new(stdout)) {
            return Output::standard(sources);
        }
        let old = match fs::metadata(&path) {
            Ok(metadata) => Some(metadata),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(unwritable(&name, &error)),
        };
        if let Some(old) = &old {
            refuse_same(&name, old, sources)?;
            if old.is_dir() {
                return Err(is_folder(&name));
            }
            // Asks for the right to write, and changes nothing.
            let direct = !old.is_file() || is_descriptor(&path);
            let opened = OpenOptions::new().write(true).truncate(direct).open(&path).map_err(|error| unwritable(&name, &error))?;
            if direct {
                return Ok(Output { name, file: opened, unfinished: None });
            }
        }
        let (file, temporary) = beside(&path, old.as_ref()).map_err(|error| {
            let folder = folder(&path);
            let what = match error.kind() {
                io::ErrorKind::NotFound => format!("the folder {} does not exist; make it first", folder.display()),
                _ => format!("cannot write in the folder {}: {}", folder.display(), reason(&error)),
            };
            Failure::at(&name, what)
        })?;
        Ok(Output { name, file, unfinished: Some((temporary, path)) })
    }

    /// What messages call it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where a raster is to be written.
    pub fn out(&mut self) -> Out<'_> {
        if self.unfinished.is_some() { Out::File(&mut self.file) } else { Out::Stream(&mut self.file) }
    }

    /// Whether what is written appears on a terminal.
    pub fn is_terminal(&self) -> bool {
        self.file.is_terminal()
    }

    /// Gives a complete file its name.
    ///
    /// # Errors
    /// What the system says; then nothing has changed under that name.
    pub fn finish(self) -> Result<(), Failure> {
        if let Some((temporary, path)) = self.unfinished {
            let mut unfinished = signals::unfinished();
            unfinished.retain(|file| *file != *temporary);
            temporary.persist(path).map_err(|error| unwritable(&self.name, &error.error))?;
        }
        Ok(())
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Lets a pipe hold half a MiB, about what encoders hand over at once, so that writer and reader change places seldom. A pipe that holds more, or that
/// the system does not let grow, stays as it is.
#[cfg(target_os = "linux")]
fn widen(file: &File) {
    use rustix::pipe::{fcntl_getpipe_size, fcntl_setpipe_size};
    const BYTES: usize = 1 << 19;
    if fcntl_getpipe_size(file).is_ok_and(|bytes| bytes < BYTES) {
        let _ = fcntl_setpipe_size(file, BYTES);
    }
}

#[cfg(not(target_os = "linux"))]
fn widen(_: &File) {}

/// Follows the links of a path's last part, also to a file that does not exist yet; stops at what names an open file of this process.
fn resolve(path: &Path) -> Result<PathBuf, Failure> {
    /// As many as Linux follows.
    const LINKS: usize = 40;
    let mut at = path.to_owned();
    for _ in 0..LINKS {
        match fs::read_link(&at) {
            Ok(next) if !is_descriptor(&at) => at = folder(&at).join(next),
            _ => return Ok(at),
        }
    }
    Err(Failure::at(path.display(), "too many symbolic links, or a circle of them"))
}

/// Whether a path names an open file, which is written where it stands.
fn is_descriptor(path: &Path) -> bool {
    path.starts_with("/proc") || path.starts_with("/dev/fd")
}

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder.as_os_str().is_empty() => Path::new("."),
        Some(folder) => folder,
        None => path,
    }
}

/// A new file in the folder of `path`, known to the signals: with the mode of the old one, else with the mode of any new file.
fn beside(path: &Path, old: Option<&Metadata>) -> io::Result<(File, TempPath)> {
    signals::watch()?;
    let mode = old.map_or(0o666, |old| old.mode() & 0o777);
    let mut unfinished = signals::unfinished();
    let mut builder = tempfile::Builder::new();
    builder.prefix(".runset-").suffix(".part").permissions(Permissions::from_mode(mode));
    let (file, temporary) = builder.tempfile_in(folder(path))?.into_parts();
    unfinished.push(temporary.to_path_buf());
    if old.is_some() {
        // The umask has no say in the mode of a file that was there; some file systems know only one mode.
        let _ = file.set_permissions(Permissions::from_mode(mode));
    }
    Ok((file, temporary))
}

/// Refuses an output that is an input. Terminals, `/dev/null` and sockets can be both.
fn refuse_same(name: &str, output: &Metadata, sources: &[Source]) -> Result<(), Failure> {
    let kind = output.file_type();
    let is_output = |source: &Source| (output.dev(), output.ino()) == (source.metadata().dev(), source.metadata().ino());
    let same = !kind.is_char_device() && !kind.is_socket() && sources.iter().any(is_output);
    if same { Err(Failure::at(name, "this is the input too; name another output")) } else { Ok(()) }
}

fn is_folder(name: &str) -> Failure {
    Failure::at(name, "this is a folder; name a file")
}

fn unwritable(name: &str, error: &io::Error) -> Failure {
    Failure::at(name, format_args!("cannot write: {}", reason(error)))
}
