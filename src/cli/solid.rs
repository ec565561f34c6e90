//! `runset solid`: a CSG model, shown directly.

use std::ops::{Range, RangeInclusive};
use std::path::PathBuf;
use std::time::Instant;

use runset::error::Warning;
use runset::input::{ModelOptions, Reading, read_tree};
use runset::job::{self, Aov, Job, Kept, SolidOptions};
use runset::solid::camera::{Camera, Setup};
use runset::solid::look::{Look, MAX_ANTIALIAS};
use runset::solid::shade::{SCHEMES, Scheme};
use runset::solid::stage::Plane;

use super::input::Source;
use super::messages::{Ends, Failure};
use super::output::{Output, Target};
use super::progress::Progress;
use super::work::Work;
use super::{scad, surface, values};

const EXAMPLES: &str = "\
Examples:
  runset solid part.csg -o part.png
      all of the model, from the default camera
  runset solid part.csg --camera 30,-40,25,0,0,0 --imgsize 2048,2048 -o part.png
      from an eye to a point, as OpenSCAD's options have it
  runset solid part.csg --section 0,0,1,5 -o inside.png
      without what is above z = 5; --section 0,-1,0,0 takes away what is before the plane y = 0
  runset solid part.csg --smooth 30 --edges --antialias 4 -o part.png
      curved surfaces without facets, lines along sharp edges, soft outlines
  runset solid part.csg --translucent 2 -o part.png
      the second primitive as glass; --glass shows all that is cut away
  runset solid part.csg --camera 0,0,0,55,0,0,99 --camera 0,0,0,55,0,90,99 -o view-%d.png
      view-1.png and view-2.png, of a model that is read once
  runset solid part.scad --aov depth=part.pfm --aov primitive=part.pgm -o part.ppm
      with depths and parts as numbers; a .scad needs openscad on the path
  runset solid part.csg -o part.stl
      its surface, worked out
  runset solid part.csg --format rls | runset convert - -o part.png
      through a line stream";

/// Show a CSG model or a mesh, directly, without computing its surface first
///
/// Reads OpenSCAD's .csg (what openscad -o model.csg writes), STL (binary or text), or a .scad where openscad is installed. Faces that
/// coincide are seen as what they bound: no combs, no ghosts, however deep the tree is. Options of the camera are OpenSCAD's.
#[derive(clap::Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Solid {
    /// Model to read; - is standard input
    #[arg(value_name = "INPUT", value_hint = clap::ValueHint::FilePath)]
    pub(super) input: PathBuf,

    #[command(flatten)]
    pub(super) output: Target,

    /// Size of the page in pixels
    #[arg(long, value_name = "W,H", default_value = "512,512", value_parser = job::image_size)]
    imgsize: (u32, u32),

    /// Where the model is seen from: translate_x,y,z,rotate_x,y,z,distance or eye_x,y,z,center_x,y,z; may be given several times, with OUT as in view-%03d.png [default: from
    /// where all is seen]
    ///
    /// The model is read once for all cameras. %d or %03d in the names of outputs is the number of the camera, from 1.
    #[arg(long, value_name = "NUMBERS", value_parser = job::camera, allow_hyphen_values = true)]
    camera: Vec<Camera>,

    /// o: orthographic, p: perspective
    #[arg(long, value_name = "o|p", default_value = "p")]
    projection: Projection,

    /// Go so far away that all is seen
    #[arg(long)]
    viewall: bool,

    /// Look at the middle of the model
    #[arg(long)]
    autocenter: bool,

    /// Colours of what has none of its own
    #[arg(long, value_name = "NAME", default_value = SCHEMES[0].name, value_parser = scheme())]
    colorscheme: &'static Scheme,

    /// Cut the model by a plane: what is at A x + B y + C z <= D stays, the side that (A, B, C) points to is taken away; may be given several times
    #[arg(long, value_name = "A,B,C,D", value_parser = job::section, allow_hyphen_values = true)]
    section: Vec<Plane>,

    /// Smooth the outlines: every pixel is the mean of N x N finer ones, 1 to 8
    ///
    /// The mean is that of the bytes of the colours, paper among them, rounded to the nearest. Lines take N x N times as long. Numbers (--aov) stay those of the
    /// page's own pixels.
    #[arg(long, value_name = "N", default_value_t = 1, alias = "supersample", value_parser = values::whole(1..=MAX_ANTIALIAS))]
    antialias: u32,

    /// Shade faces as one curved surface where they meet at less than ANGLE degrees, such as 30
    ///
    /// Outlines, depths and normals (--aov) stay those of the faces.
    #[arg(long, value_name = "ANGLE", value_parser = job::angle)]
    smooth: Option<f64>,

    /// Draw the edges of what is seen: where a part or a surface ends, and where faces meet at more than ANGLE degrees [default: 30]
    #[arg(long, value_name = "ANGLE", num_args = 0..=1, require_equals = true, default_missing_value = "30", value_parser = job::angle)]
    edges: Option<f64>,

    /// Show a primitive as glass, by its number as in --aov primitive: 3, 2-5 or 1,4; may be given several times
    ///
    /// What is seen behind it is the model without what it adds; what it takes away is taken away.
    #[arg(long, value_name = "ID", alias = "transparent", value_delimiter = ',', value_parser = job::parts)]
    translucent: Vec<RangeInclusive<u32>>,

    /// Show all that is cut away as glass
    #[arg(long)]
    glass: bool,

    /// Only scanlines Y0 to Y1 - 1, counted from 0: what the whole picture holds there
    #[arg(long, value_name = "Y0..Y1", value_parser = job::lines)]
    lines: Option<Range<u32>>,

    /// Resolution to write into the output, in dots an inch; the size in pixels is that of --imgsize
    #[arg(long, value_name = "D", value_parser = values::positive, allow_negative_numbers = true)]
    dpi: Option<f64>,

    /// How curved surfaces are drawn: facets, as OpenSCAD has them
    #[arg(long, value_name = "HOW", default_value = "facets")]
    curves: Curves,

    /// Also write what pixels show as numbers: primitive=F.pgm (16 bits), depth=F.pfm, normal=F.pfm; may be given several times
    #[arg(long, value_name = "WHAT=FILE", value_parser = aov)]
    aov: Vec<(Aov, PathBuf)>,

    /// Work out what render() holds to meshes first, and show these
    ///
    /// The picture is the same but for single pixels at outlines.
    #[arg(long)]
    evaluate: bool,

    #[command(flatten)]
    pub(super) work: Work,
}

impl Solid {
    /// An option that only a picture can have, if one was given.
    pub(super) fn of_a_view(&self) -> Option<&'static str> {
        let given = [
            (!self.camera.is_empty(), "--camera"),
            (self.viewall, "--viewall"),
            (self.autocenter, "--autocenter"),
            (!self.section.is_empty(), "--section"),
            (self.lines.is_some(), "--lines"),
            (self.dpi.is_some(), "--dpi"),
            (!self.aov.is_empty(), "--aov"),
        ];
        given.into_iter().find_map(|(given, name)| given.then_some(name))
    }

    /// The model that the input holds.
    pub(super) fn read(&self, source: &Source, ends: &Ends<'_>, warnings: &mut Vec<Warning>) -> Result<Reading, Failure> {
        let limits = self.work.limits();
        let bytes = if scad::is_program(&self.input) { scad::tree(&self.input, limits.input)? } else { source.read(limits.input)? };
        let options = ModelOptions { limits, folder: source.folder() };
        read_tree(&bytes, &options, warnings).map_err(|error| ends.failure(&error))
    }
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Projection {
    #[value(name = "p", alias = "perspective")]
    Perspective,
    #[value(name = "o", alias = "ortho", alias = "orthogonal", alias = "orthographic")]
    Orthographic,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Curves {
    Facets,
}

fn scheme() -> impl clap::builder::TypedValueParser<Value = &'static Scheme> {
    use clap::builder::{PossibleValuesParser, TypedValueParser};
    let find = |name: String| SCHEMES.iter().find(|scheme| scheme.name == name).expect("one of the names listed");
    PossibleValuesParser::new(SCHEMES.iter().map(|scheme| scheme.name)).map(find)
}

fn aov(text: &str) -> Result<(Aov, PathBuf), String> {
    let wrong = || "give primitive=F.pgm, depth=F.pfm or normal=F.pfm".to_owned();
    let (what, path) = text.split_once('=').filter(|(_, path)| !path.is_empty()).ok_or_else(wrong)?;
    let what = match what {
        "primitive" => Aov::Primitive,
        "depth" => Aov::Depth,
        "normal" => Aov::Normal,
        _ => return Err(wrong()),
    };
    Ok((what, PathBuf::from(path)))
}

/// Runs the subcommand. `started` is when the process began.
///
/// # Errors
/// Whatever keeps the picture from being complete.
pub fn run(args: &Solid, started: Instant) -> Result<(), Failure> {
    let source = Source::find(&args.input)?;
    if args.output.is_surface() {
        return surface::run(args, &source);
    }
    let format = args.output.format_or("png")?;
    let (input_name, sources) = (source.name(), std::slice::from_ref(&source));
    let (width, height) = args.imgsize;
    let options = |camera: Option<Camera>, started| {
        let orthographic = args.projection == Projection::Orthographic;
        let setup = Setup { camera, orthographic, view_all: args.viewall, autocenter: args.autocenter, width, height };
        let Solid { antialias, smooth, edges, glass, .. } = *args;
        let look = Look { antialias, smooth, edges, glass, translucent: args.translucent.clone() };
        let (sections, lines) = (args.section.clone(), args.lines.clone());
        SolidOptions { setup, scheme: *args.colorscheme, sections, look, lines, dpi: args.dpi, pixels: None, started }
    };
    // Without a camera there is one view, from where all is seen.
    let cameras: Vec<Option<Camera>> = if args.camera.is_empty() { vec![None] } else { args.camera.iter().copied().map(Some).collect() };
    let outputs = |number: usize| {
        let numbered = |target: &Target| match target.numbered(number) {
            None if cameras.len() > 1 => Err(Failure::Usage(format!(
                "{} cameras, and {} is one output: put %d or %03d into its name, for the number of the camera",
                cameras.len(),
                target.name()
            ))),
            numbered => Ok(numbered.unwrap_or_else(|| target.clone())),
        };
        let picture = Output::create(&numbered(&args.output)?, sources, format)?;
        let aov = |(aov, path): &(Aov, PathBuf)| Ok((*aov, Output::create(&numbered(&Target::named(path))?, sources, format)?));
        Ok((picture, args.aov.iter().map(aov).collect::<Result<Vec<_>, Failure>>()?))
    };
    let mut first = Some(outputs(1)?);
    let of_input = Ends { input: &input_name, output: "" };
    let header = options(cameras[0], started).header().map_err(|error| of_input.failure(&error))?;
    format.check(&header).map_err(|error| of_input.failure(&error))?;

    let mut warnings = Vec::new();
    let mut reading = args.read(&source, &of_input, &mut warnings)?;
    if args.evaluate {
        job::evaluate(&mut reading, &mut warnings).map_err(|error| of_input.failure(&error))?;
    }
    let kept = Kept::new(&reading.model, &args.work.limits(), &mut warnings).map_err(|error| of_input.failure(&error))?;
    drop(reading);
    of_input.warn(&warnings, args.work.strict)?;

    for (camera, number) in cameras.iter().zip(1..) {
        let began = if number == 1 { started } else { Instant::now() };
        let (mut output, mut numbers) = match first.take() {
            Some(first) => first,
            None => outputs(number)?,
        };
        let name = output.name().to_owned();
        let ends = Ends { output: &name, ..of_input };
        let asked = options(*camera, began);
        let job = Job::solid(&kept, &asked).map_err(|error| ends.failure(&error))?;
        let mut progress = Progress::new(&args.work.watch, Some(header.height()), output.is_terminal());
        let stats = job
            .render(format, args.work.limits().threads, &mut output, &mut |done| progress.set(done))
            .map_err(|error| ends.failure(&error))?;
        drop(progress);
        let of_numbers = if numbers.is_empty() || asked.look.antialias == 1 { None } else { Some(Job::solid(&kept, &asked.of_numbers())) };
        let job = of_numbers.transpose().map_err(|error| ends.failure(&error))?.unwrap_or(job);
        for (aov, out) in &mut numbers {
            let name = out.name().to_owned();
            job.aov(*aov, out).map_err(|error| Ends { output: &name, ..ends }.failure(&error))?;
        }
        output.finish()?;
        numbers.into_iter().try_for_each(|(_, out)| out.finish())?;
        args.work.tell(&stats);
    }
    Ok(())
}
