//! What the user is told: one line a message, with the place where there is one.
//!
//! ```text
//! drawing.svg:12:7: what is wrong, and what to do         an error
//! drawing.svg:12:7: warning: what is not as drawn         a warning
//! --expr:1:9: ...          out.png: ...          <stdin>: ...
//! runset: wrong usage, and what to do (see runset fill --help)
//! ```

use std::fmt::Display;
use std::io::{self, Write};
use std::process::ExitCode;

use clap::error::ErrorKind;
use runset::error::{Error, Kind, Origin, Place, Warning};

/// Why a run ends early.
pub enum Failure {
    /// The arguments are wrong: status 2.
    Usage(String),
    /// The work failed: status 1.
    Failed(String),
    /// The help that a bare `runset` prints: status 2.
    Help(String),
    /// Nothing is wrong: help was asked for, or the reader of the output has had enough.
    Ended,
}

/// The names that messages use for the two ends of a run.
#[derive(Clone, Copy)]
pub struct Ends<'a> {
    /// The input.
    pub input: &'a str,
    /// The output.
    pub output: &'a str,
}

impl Failure {
    /// A failure that concerns `name`: a file, `<stdin>`, `<stdout>`.
    pub fn at(name: impl Display, what: impl Display) -> Failure {
        Failure::Failed(format!("{name}: {what}"))
    }

    /// A failed operation of the system on `name`.
    pub fn io(name: impl Display, error: &io::Error) -> Failure {
        if error.kind() == io::ErrorKind::BrokenPipe { Failure::Ended } else { Failure::at(name, reason(error)) }
    }

    /// Prints the message and gives the exit status.
    pub fn report(self) -> ExitCode {
        let (status, line) = match self {
            Failure::Ended => return ExitCode::SUCCESS,
            Failure::Failed(line) => (1, line),
            Failure::Usage(what) => (2, format!("runset: {what} (see {})", help_command())),
            Failure::Help(text) => {
                // Nobody is left to tell if standard error fails.
                let _ = io::stderr().write_all(text.as_bytes());
                return ExitCode::from(2);
            }
        };
        tell(&line);
        ExitCode::from(status)
    }
}

impl Ends<'_> {
    /// The failure that an error of the library is.
    pub fn failure(&self, error: &Error) -> Failure {
        match (error.kind, error.origin) {
            (Kind::Closed, _) => Failure::Ended,
            (_, Origin::Parameter) => Failure::Usage(error.what.clone()),
            (_, origin) => Failure::Failed(self.line(origin, error.place, "", &without_number(&error.what))),
        }
    }

    /// Prints the warnings; with `strict` the first of them is an error instead, and the line that is printed.
    ///
    /// # Errors
    /// The first warning, if `strict`.
    pub fn warn(&self, warnings: &[Warning], strict: bool) -> Result<(), Failure> {
        if let Some((first, others)) = warnings.split_first().filter(|_| strict) {
            let more = if others.is_empty() { String::new() } else { format!(", the first of {} warnings", warnings.len()) };
            let what = format!("{} (refused by --strict{more})", first.what);
            return Err(Failure::Failed(self.line(first.origin, first.place, "", &what)));
        }
        for warning in warnings {
            tell(&self.line(warning.origin, warning.place, "warning: ", &warning.what));
        }
        Ok(())
    }

    fn line(&self, origin: Origin, place: Option<Place>, label: &str, what: &str) -> String {
        let name = match origin {
            Origin::Input => self.input,
            Origin::Expression => "--expr",
            Origin::Parameter => "runset",
            Origin::Output => self.output,
        };
        match place {
            Some(Place { line, column }) => format!("{name}:{line}:{column}: {label}{what}"),
            None => format!("{name}: {label}{what}"),
        }
    }
}

/// What clap has to say: help and version go to standard output, anything else is wrong usage in one line.
pub fn usage(error: &clap::Error) -> Failure {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => match error.print() {
            Ok(()) => Failure::Ended,
            Err(error) => Failure::io("<stdout>", &error),
        },
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => Failure::Help(error.render().to_string()),
        _ => Failure::Usage(usage_line(&error.render().to_string())),
    }
}

/// clap's paragraphs as one line: what is wrong, and its tips.
///
/// ```text
/// error: unexpected argument '--lins' found
///
///   tip: a similar argument exists: '--lines'        ->  unexpected argument '--lins' found; a similar argument exists: '--lines'
///
/// Usage: ...
/// ```
fn usage_line(text: &str) -> String {
    let mut paragraphs = text.split("\n\n").map(|p| p.lines().map(str::trim).collect::<Vec<_>>().join(" "));
    let what = paragraphs.next().unwrap_or_default();
    let what = what.strip_prefix("error: ").unwrap_or(&what).to_owned();
    paragraphs.filter_map(|p| p.strip_prefix("tip: ").map(str::to_owned)).fold(what, |line, tip| line + "; " + &tip)
}

/// The command that shows the help of the subcommand that was called.
fn help_command() -> String {
    use clap::CommandFactory;
    let called = std::env::args_os().nth(1).unwrap_or_default();
    match super::Cli::command().find_subcommand(&called) {
        Some(command) => format!("runset {} --help", command.get_name()),
        None => "runset --help".to_owned(),
    }
}

/// An error of the system without its number, and without the temporary file's name that may be wrapped around it.
pub fn reason(error: &io::Error) -> String {
    let cause = std::error::Error::source(error).map(ToString::to_string);
    without_number(&cause.unwrap_or_else(|| error.to_string()))
}

/// Text up to ` (os error N)`; behind it some libraries repeat the path.
fn without_number(what: &str) -> String {
    let numbered = |rest: &str| rest.split_once(')').is_some_and(|(number, _)| number.parse::<u32>().is_ok());
    match what.split_once(" (os error ") {
        Some((reason, rest)) if numbered(rest) => reason.to_owned(),
        _ => what.to_owned(),
    }
}

/// Prints one line on standard error; control characters in file names do not break it.
pub fn tell(line: &str) {
    let line: String = line.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    // Nobody is left to tell if standard error fails.
    let _ = writeln!(io::stderr(), "{line}");
}

/// Writes text to standard output.
///
/// # Errors
/// What the system says; [`Failure::Ended`] if the reader went away.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(|error| Failure::io("<stdout>", &error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn claps_paragraphs_become_one_line() {
        let text = "error: invalid value 'x' for '--format <F>'\n  [possible values: a, b]\n\n  tip: try 'a'\n\nUsage: runset\n\nFor more";
        assert_eq!(usage_line(text), "invalid value 'x' for '--format <F>' [possible values: a, b]; try 'a'");
    }

    #[test]
    fn the_number_of_a_system_error_is_left_out() {
        assert_eq!(reason(&io::Error::from_raw_os_error(28)), "No space left on device");
        assert_eq!(without_number("Permission denied (os error 13) at path \"/tmp\""), "Permission denied");
        assert_eq!(without_number("a (os error of mine), b"), "a (os error of mine), b");
    }
}
