//! `runset convert`: a line stream to any format, line by line.

use std::io::BufReader;
use std::path::PathBuf;

use super::input::Source;
use super::messages::{Ends, Failure};
use super::output::{Output, Target};
use super::progress::{Progress, Watch};
use super::values;

const EXAMPLES: &str = "\
Examples:
  runset convert page.rls -o page.png
  runset fill poster.svg --dpi 1200 --format rls | tee poster.rls | runset convert - -o poster.pbm
  runset convert page.ndjson --format pgm | pamscale 0.1 > preview.pgm
  runset convert page.rls --dpi 600 -o page.pwg";

/// Write a line stream (ndjson, rls) in another format
///
/// The stream is read line by line; a stream without its end record, with a wrong checksum, or with missing or overlapping lines is
/// refused with the place.
#[derive(clap::Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Convert {
    /// Line stream to read, told by its first bytes; - is standard input
    #[arg(value_name = "IN", value_hint = clap::ValueHint::FilePath)]
    input: PathBuf,

    #[command(flatten)]
    output: Target,

    /// Resolution to write into the output, in dots an inch; a line stream has none
    #[arg(long, value_name = "D", value_parser = values::positive, allow_negative_numbers = true)]
    dpi: Option<f64>,

    #[command(flatten)]
    watch: Watch,
}

/// Runs the subcommand.
///
/// # Errors
/// Whatever keeps the raster from being complete.
pub fn run(args: &Convert) -> Result<(), Failure> {
    /// Bytes read at a time.
    const CHUNK: usize = 1 << 16;
    let format = args.output.format()?;
    let source = Source::find(&args.input)?;
    let mut output = Output::create(&args.output, std::slice::from_ref(&source), format)?;
    let (input_name, output_name) = (source.name(), output.name().to_owned());
    let ends = Ends { input: &input_name, output: &output_name };

    let mut input = BufReader::with_capacity(CHUNK, source.open()?);
    let mut progress = Progress::new(&args.watch, None, output.is_terminal());
    runset::job::convert(&mut input, format, args.dpi, &mut output, &mut |done| progress.set(done))
        .map_err(|error| ends.failure(&error))?;
    drop(progress);
    output.finish()
}
