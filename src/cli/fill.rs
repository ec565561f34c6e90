//! `runset fill`: a drawing, or an expression over its shapes, to a raster.

use std::ops::Range;
use std::path::PathBuf;
use std::time::Instant;

use runset::encode::Format;
use runset::error::{Error, Kind, Origin};
use runset::grid::{MAX_HEIGHT, MAX_WIDTH};
use runset::input::Fonts;
use runset::job::{Job, Options, Size, Stats, TOLERANCE};

use super::input::{FontOptions, Source};
use super::messages::{Ends, Failure};
use super::output::{Output, Target};
use super::progress::Progress;
use super::values;
use super::work::Work;

const EXAMPLES: &str = "\
Expressions, operators from the tightest to the loosest:
  !a             outside a
  a - b          in a, not in b
  a & b          in both
  a ^ b          in one of the two
  a | b          in either
  all(a, b, ...)  any(a, b, ...)  odd(a, b, ...)  atleast(2, a, b, ...)
  page           the whole page
  art            everything that is painted
  \"layer-1\"      an id that is not a plain word, in double quotes

Examples:
  runset fill poster.svg --expr 'art & frame - logo' --dpi 600 -o mask.png
      what is painted inside the frame, without the logo, at 600 dots an inch
  runset fill board.json --scale 4 --lines 0..4096 -o top.pbm
      the first 4096 scanlines of a scene, four times as large
  runset fill front.svg back.svg --dpi 600 -o pages.pwg
      two pages for a printer
  xz -dc map.svg.xz | runset fill - --width 20000 | runset convert - -o map.png
      from standard input, 20000 pixels wide, through a line stream";

/// Fill a drawing, or an expression over its shapes, and write the raster
///
/// Reads an SVG drawing (plain or gzipped) or a JSON scene; several become the pages of one file, in formats that hold pages. Every pixel whose centre lies in a shape belongs to it; an expression is
/// evaluated pixel by pixel. Without --expr an SVG is painted in its own colours, a scene by its own
/// expression or layers.
#[derive(clap::Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Fill {
    /// Drawing or scene to read; - is standard input; several are pages
    #[arg(value_name = "INPUT", value_hint = clap::ValueHint::FilePath, required = true)]
    inputs: Vec<PathBuf>,

    /// Area to fill, over the ids of the input, instead of the input's own picture
    #[arg(long, value_name = "E")]
    expr: Option<String>,

    #[command(flatten)]
    output: Target,

    #[command(flatten)]
    size: SizeOptions,

    /// Only scanlines Y0 to Y1 - 1, counted from 0: what the whole picture holds there
    #[arg(long, value_name = "Y0..Y1", value_parser = runset::job::lines)]
    lines: Option<Range<u32>>,

    /// Farthest that a flattened curve may be from the true one, in pixels, 0.001 to 16
    #[arg(long, value_name = "PX", default_value_t = TOLERANCE, value_parser = values::tolerance, allow_negative_numbers = true)]
    tolerance: f64,

    #[command(flatten)]
    fonts: FontOptions,

    #[command(flatten)]
    work: Work,
}

#[derive(clap::Args)]
struct SizeOptions {
    /// Size in dots an inch; a user unit is 1/96 inch
    #[arg(long, value_name = "D", value_parser = values::positive, allow_negative_numbers = true)]
    dpi: Option<f64>,

    /// Size in pixels to a user unit [default: 1]
    #[arg(long, value_name = "S", value_parser = values::positive, allow_negative_numbers = true, conflicts_with = "dpi")]
    scale: Option<f64>,

    /// Width of the page in pixels; alone it keeps the aspect, with --height the drawing is fitted inside and centred
    #[arg(long, value_name = "W", value_parser = values::whole(1..=MAX_WIDTH),
        allow_negative_numbers = true, conflicts_with_all = ["dpi", "scale"])]
    width: Option<u32>,

    /// Height of the page in pixels; alone it keeps the aspect
    #[arg(long, value_name = "H", value_parser = values::whole(1..=MAX_HEIGHT),
        allow_negative_numbers = true, conflicts_with_all = ["dpi", "scale"])]
    height: Option<u32>,
}

impl SizeOptions {
    fn size(&self) -> Size {
        match *self {
            SizeOptions { dpi: Some(dpi), .. } => Size::Dpi(dpi),
            SizeOptions { width: None, height: None, scale, .. } => Size::Scale(scale.unwrap_or(1.0)),
            SizeOptions { width, height, .. } => Size::Pixels { width, height },
        }
    }

    /// A page that is too large without any option is the input's fault.
    fn blame(&self, error: Error) -> Error {
        let asked = self.dpi.is_some() || self.scale.is_some() || self.width.is_some() || self.height.is_some();
        if error.kind == Kind::Limit && error.origin == Origin::Parameter && !asked {
            Error { origin: Origin::Input, ..error }
        } else {
            error
        }
    }
}

/// Runs the subcommand. `started` is when the process began.
///
/// # Errors
/// Whatever keeps the raster from being complete.
pub fn run(args: &Fill, started: Instant) -> Result<(), Failure> {
    let format = args.output.format()?;
    let sources = args.inputs.iter().map(|input| Source::find(input)).collect::<Result<Vec<_>, _>>()?;
    let pages = pages(&sources, format)?;
    let mut output = Output::create(&args.output, &sources, format)?;
    let fonts = args.fonts.load(&args.work.limit)?;
    let mut costs = Vec::new();
    // A page is read when those before it are written.
    for (source, number) in sources.iter().zip(0..) {
        let started = if number == 0 { started } else { Instant::now() };
        costs.push(args.page(source, (number, pages), &fonts, format, &mut output, started)?);
    }
    output.finish()?;
    costs.iter().for_each(|stats| args.work.tell(stats));
    Ok(())
}

/// How many pages the inputs are, if a file of that format holds them.
fn pages(sources: &[Source], format: &Format) -> Result<u32, Failure> {
    let pages = u32::try_from(sources.len()).map_err(|_| Failure::Usage("too many inputs: name fewer".to_owned()))?;
    format.check_pages(pages).map_err(|error| Failure::Usage(error.what))?;
    if sources.iter().filter(|source| source.is_standard()).count() > 1 {
        return Err(Failure::Usage("standard input is named twice, and can be read once".to_owned()));
    }
    Ok(pages)
}

impl Fill {
    /// Writes the page of that number, from 0, out of so many.
    fn page(
        &self,
        source: &Source,
        (number, of): (u32, u32),
        fonts: &Fonts,
        format: &Format,
        output: &mut Output,
        started: Instant,
    ) -> Result<Stats, Failure> {
        let (input_name, output_name) = (source.name(), output.name().to_owned());
        let ends = Ends { input: &input_name, output: &output_name };
        let options = Options {
            expr: self.expr.clone(),
            size: self.size.size(),
            lines: self.lines.clone(),
            tolerance: self.tolerance,
            limits: self.work.limits(),
            started,
            ..Options::default()
        };
        let bytes = source.read(options.limits.input)?;
        let mut warnings = Vec::new();
        let scene = runset::input::read_with(bytes, &options.limits, fonts, &mut warnings).map_err(|error| ends.failure(&error))?;
        let job = Job::prepare(scene, &options, &mut warnings).map_err(|error| ends.failure(&self.size.blame(error)))?;
        let job = job.as_sheet(number, of);
        format.check(job.header()).map_err(|error| ends.failure(&error))?;
        ends.warn(&warnings, self.work.strict)?;

        let mut progress = Progress::new(&self.work.watch, Some(job.header().height()), output.is_terminal());
        job.render(format, options.limits.threads, output, &mut |done| progress.set(done)).map_err(|error| ends.failure(&error))
    }
}
