//! The command line: arguments in, one subcommand run, an exit status out.
//!
//! Every subcommand is a file with its arguments and a `run`. What goes wrong comes back as a [`messages::Failure`], which
//! becomes one line on standard error and the exit status: 0 done, 1 failed (input, expression, reading, writing), 2 wrong
//! usage (arguments that are wrong in themselves, or out of bounds for this input). An expression is input, wherever it stands.

mod convert;
mod fill;
mod info;
mod input;
mod messages;
mod output;
#[cfg(feature = "print")]
mod print;
#[cfg(feature = "print")]
mod printers;
mod progress;
mod reference;
mod scad;
#[cfg(feature = "serve")]
mod serve;
mod signals;
mod solid;
mod surface;
mod table;
mod tree;
mod values;
mod work;

use std::process::ExitCode;
use std::time::Instant;

use clap::{CommandFactory, Parser, Subcommand};

const EXAMPLES: &str = "\
Examples:
  runset info poster.svg
  runset fill poster.svg --expr 'art & frame - logo' --dpi 600 -o mask.png
  runset fill scene.json --scale 4 | runset convert - -o picture.pbm

Exit status:
  0  done, also when the reader of a pipe has had enough
  1  failed: the input, an expression in it or on the command line, reading or writing
  2  wrong usage";

/// Shapes and boolean expressions in, exact raster lines out.
///
/// Takes an SVG drawing or a JSON scene, selects an area of it by an expression over the ids, and writes the pixels whose
/// centres lie in that area: exact, line by line, in memory that does not grow with the page.
#[derive(Parser)]
#[command(name = "runset", version, max_term_width = 100, arg_required_else_help = true, after_long_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Fill(fill::Fill),
    Convert(convert::Convert),
    Solid(solid::Solid),
    #[cfg(feature = "print")]
    Print(print::Print),
    #[cfg(feature = "print")]
    Printers(printers::Printers),
    #[cfg(feature = "serve")]
    Serve(serve::Serve),
    Info(info::Inspect),
    Formats(reference::Formats),
    Completions(reference::Completions),
    Man(reference::Man),
}

/// Runs the program. `started` is when the process began.
pub fn run(started: Instant) -> ExitCode {
    let result = Cli::try_parse().map_err(|error| messages::usage(&error)).and_then(|cli| match cli.command {
        Command::Fill(args) => fill::run(&args, started),
        Command::Solid(args) => solid::run(&args, started),
        Command::Convert(args) => convert::run(&args),
        #[cfg(feature = "print")]
        Command::Print(args) => print::run(&args, started),
        #[cfg(feature = "print")]
        Command::Printers(args) => printers::run(&args),
        #[cfg(feature = "serve")]
        Command::Serve(args) => serve::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Formats(_) => reference::formats(),
        Command::Completions(args) => reference::completions(&args, Cli::command()),
        Command::Man(args) => reference::man(&args, Cli::command()),
    });
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_do_not_contradict_each_other() {
        Cli::command().debug_assert();
    }
}
