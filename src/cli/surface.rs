//! `runset solid -o model.stl`: the surface of a model, worked out.

use runset::job;
use runset::mesh::stl;

use super::input::Source;
use super::messages::{Ends, Failure};
use super::output::Output;
use super::solid::Solid;

/// Runs the subcommand for an STL.
///
/// # Errors
/// Whatever keeps the surface from being complete; a model without one; options that only a picture can have.
pub fn run(args: &Solid, source: &Source) -> Result<(), Failure> {
    if let Some(option) = args.of_a_view() {
        return Err(Failure::Usage(format!(
            "{option} is for pictures, and an STL is the whole model: leave it out, or name a picture with -o"
        )));
    }
    let mut output = Output::surface(&args.output, source)?;
    let (input, name) = (source.name(), output.name().to_owned());
    let ends = Ends { input: &input, output: &name };
    let mut warnings = Vec::new();
    let reading = args.read(source, &ends, &mut warnings)?;
    let facets = job::stl(&reading.model, &mut warnings).map_err(|error| ends.failure(&error))?;
    ends.warn(&warnings, args.work.strict)?;
    stl::write(&facets, &mut output).map_err(|error| Failure::io(&name, &error))?;
    output.finish()
}
