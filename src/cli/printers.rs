//! `runset printers`: printers of the network or of a host, and the one that is remembered.

use std::fs;
use std::io;
use std::path::PathBuf;
use std::time::Duration;

use runset::encode::FORMATS;
use runset::print::find::{self, Found};
use runset::print::{self, Address, Client, Limits, Printer, PrinterStatus};

use super::messages::{Failure, print as say, reason, tell};
use super::table::table;
use super::values::seconds;

const EXAMPLES: &str = "\
Examples:
  runset printers
      what the network tells of within two seconds
  runset printers --probe 192.168.1.20
      what this host has, where the network tells of nothing";

/// List printers: those that the network tells of, or those of a host
///
/// Each with its address, for runset print --to, the formats of runset that it takes, and its resolutions. The printer that is remembered is marked with a star.
/// The status is 1 if none is found.
#[derive(clap::Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Printers {
    /// Ask this host, or this address, instead of listening; may be given several times
    #[arg(long, value_name = "HOST", value_parser = |host: &str| find::probes(host).map(|_| host.to_owned()))]
    probe: Vec<String>,

    /// Listen for so many seconds
    #[arg(long, value_name = "S", default_value = "2", value_parser = seconds, conflicts_with = "probe")]
    time: Duration,

    /// Forget the printer that is remembered, and list nothing
    #[arg(long, conflicts_with_all = ["probe", "time"])]
    forget: bool,
}

/// Where the printer is remembered (XDG Base Directory Specification).
fn file() -> Option<PathBuf> {
    let absolute = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let folder = absolute("XDG_CONFIG_HOME").or_else(|| absolute("HOME").map(|home| home.join(".config")));
    folder.map(|folder| folder.join("runset/printer"))
}

/// The printer that is remembered.
///
/// # Errors
/// The file cannot be read, or holds no address.
pub fn known() -> Result<Option<Address>, Failure> {
    let Some(file) = file() else { return Ok(None) };
    match fs::read_to_string(&file) {
        Ok(text) => match Address::parse(text.trim()) {
            Ok(address) => Ok(Some(address)),
            Err(what) => Err(Failure::at(file.display(), what)),
        },
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(Failure::at(file.display(), format_args!("cannot read: {}", reason(&error)))),
    }
}

/// Remembers a printer.
///
/// # Errors
/// There is no folder for it; the file cannot be written.
pub fn remember(address: &Address) -> Result<(), Failure> {
    let Some(file) = file() else {
        return Err(Failure::Failed("there is no home folder in which a printer could be remembered".to_owned()));
    };
    let folder = file.parent().unwrap_or(&file).to_owned();
    let written = fs::create_dir_all(&folder).and_then(|()| {
        // Whole or not at all.
        let mut new = tempfile::NamedTempFile::new_in(&folder)?;
        io::Write::write_all(&mut new, format!("{address}\n").as_bytes())?;
        new.persist(&file).map(drop).map_err(|error| error.error)
    });
    written.map_err(|error| Failure::at(file.display(), format_args!("cannot write: {}", reason(&error))))
}

/// Runs the subcommand.
///
/// # Errors
/// Nothing is found; the network cannot be listened to.
pub fn run(args: &Printers) -> Result<(), Failure> {
    if args.forget {
        return match file().map(fs::remove_file) {
            Some(Err(error)) if error.kind() != io::ErrorKind::NotFound => Err(Failure::at("runset", reason(&error))),
            _ => Ok(()),
        };
    }
    // An address that cannot be read is no reason to list nothing.
    let known = known().unwrap_or_default();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(|error| Failure::at("runset", error))?;
    let mut rows = Vec::new();
    if args.probe.is_empty() {
        let found = find::find(args.time).map_err(|what| Failure::at("runset", what))?;
        for Found { name, address, formats, .. } in found {
            let asked = runtime.block_on(ask(&address));
            rows.push(match asked {
                Ok(printer) => row(&address, &printer),
                Err(failure) => [address.to_string(), name, known_formats(&formats), String::new(), failure.what],
            });
        }
        if let Some(known) = known.as_ref().filter(|known| rows.iter().all(|row| row[0] != known.to_string())) {
            rows.push(match runtime.block_on(ask(known)) {
                Ok(printer) => row(known, &printer),
                Err(_) => [known.to_string(), String::new(), String::new(), String::new(), "remembered; it does not answer".to_owned()],
            });
        }
    }
    for host in &args.probe {
        let mut last = None;
        let mut found = false;
        for address in find::probes(host).unwrap_or_default() {
            match runtime.block_on(ask(&address)) {
                Ok(printer) => {
                    rows.push(row(&address, &printer));
                    found = true;
                    break;
                }
                Err(failure) => last = last.or(Some(failure)),
            }
        }
        if let Some(failure) = last.filter(|_| !found) {
            tell(&failure.what);
        }
    }
    if rows.is_empty() {
        let what = match args.probe.is_empty() {
            true => format!("the network tells of no printer within {} s: ask one by its host with --probe", args.time.as_secs_f32()),
            false => "no printer was found".to_owned(),
        };
        return Err(Failure::at("runset", what));
    }
    if let Some(known) = known {
        rows.iter_mut().filter(|row| row[0] == known.to_string()).for_each(|row| row[0].push_str(" *"));
    }
    let heading = ["address", "name", "formats", "dpi", "state"].map(str::to_owned);
    let rows: Vec<_> = std::iter::once(heading).chain(rows).collect();
    say(&table(rows.len(), [false; 5], |i, cells| cells.clone_from(&rows[i])))
}

/// Asks a printer once.
async fn ask(address: &Address) -> Result<Printer, print::Failure> {
    let limits = Limits { wait: Duration::ZERO, connect: Duration::from_secs(3), answer: Duration::from_secs(5), ..Limits::default() };
    print::ask(&Client::new(address.clone(), limits), |_| {}).await
}

fn known_formats(formats: &[String]) -> String {
    let takes = |media_type: &str| formats.iter().any(|own| own.eq_ignore_ascii_case(media_type));
    FORMATS.iter().filter(|format| takes(format.media_type)).map(|format| format.name).collect::<Vec<_>>().join(" ")
}

fn row(address: &Address, printer: &Printer) -> [String; 5] {
    let mut dpi: Vec<u32> = FORMATS
        .iter()
        .filter(|format| printer.formats.iter().any(|own| own.eq_ignore_ascii_case(format.media_type)))
        .flat_map(|format| printer.resolutions_of(&format.media_type.to_ascii_lowercase()))
        .filter(|[across, along]| across == along)
        .map(|[dpi, _]| dpi)
        .collect();
    dpi.sort_unstable();
    dpi.dedup();
    let state = match printer.status {
        PrinterStatus::Idle => "idle",
        PrinterStatus::Printing => "printing",
        PrinterStatus::Stopped => "stopped",
        PrinterStatus::Untold => "",
    };
    let state = std::iter::once(state.to_owned())
        .chain((!printer.reasons.is_empty()).then(|| printer.reasons.join(" ")))
        .collect::<Vec<_>>()
        .join(": ");
    [
        address.to_string(),
        printer.name.clone(),
        known_formats(&printer.formats),
        dpi.iter().map(u32::to_string).collect::<Vec<_>>().join(" "),
        state,
    ]
}
