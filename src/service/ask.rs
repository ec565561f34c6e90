//! What is asked of a document, checked, and how a drawing is made of both.

use std::io;
use std::time::Instant;

use super::config::Config;
use super::problem::Problem;
use crate::error::{Error, Kind, Warning};
use crate::input::{self, ModelOptions};
use crate::job::{Job, Kept, Options, SolidOptions};
use crate::scene::Scene;

/// Where a drawing's document comes from, read when it is needed.
pub type Source = Box<dyn FnOnce() -> io::Result<Vec<u8>> + Send>;

/// Makes a drawing: what is swept, and what is worth saying about it.
pub type Make = Box<dyn FnOnce(&Config) -> Result<(Job, Vec<Warning>), Problem> + Send>;

/// What is asked of a document.
#[derive(Clone, Debug)]
pub enum Ask {
    /// Plane shapes.
    Fill(Options),
    /// A model in a view.
    Solid(SolidOptions),
}

impl Ask {
    /// How its drawing is made of a document.
    pub fn of(self, source: Source) -> Make {
        Box::new(move |config| {
            // What a document takes to be fetched does not count as its preparation.
            let bytes = fetch(source)?;
            match self {
                Ask::Fill(options) => {
                    let (scene, mut warnings) = scene(config, bytes)?;
                    let options = Options { limits: config.limits, started: Instant::now(), ..options };
                    Ok((Job::prepare(scene, &options, &mut warnings)?, warnings))
                }
                Ask::Solid(options) => {
                    let started = Instant::now();
                    let (kept, warnings) = model(config, &bytes)?;
                    drop(bytes);
                    Ok((Job::solid(&kept, &SolidOptions { started, ..options })?, warnings))
                }
            }
        })
    }
}

fn fetch(source: Source) -> Result<Vec<u8>, Problem> {
    source().map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => Problem::internal(format!("a document cannot be read: {error}")),
        _ => {
            tracing::error!("a document cannot be read: {error}");
            Problem::busy("store", "the document cannot be read at the moment: try again later", 5)
        }
    })
}

/// Reads a drawing that must be whole in itself.
///
/// # Errors
/// What is wrong with it, or refused.
pub fn scene(config: &Config, bytes: Vec<u8>) -> Result<(Scene, Vec<Warning>), Problem> {
    let mut warnings = Vec::new();
    let scene = input::read_with(bytes, &config.limits, &config.fonts, &mut warnings)?;
    whole(&warnings)?;
    Ok((scene, warnings))
}

/// Reads a model that must be whole in itself.
///
/// # Errors
/// What is wrong with it, or refused.
pub fn model(config: &Config, bytes: &[u8]) -> Result<(Kept, Vec<Warning>), Problem> {
    let mut warnings = Vec::new();
    let model = input::read_model(bytes, &ModelOptions { limits: config.limits, folder: None }, &mut warnings)?;
    whole(&warnings)?;
    Ok((Kept::new(&model, &config.limits, &mut warnings)?, warnings))
}

/// Refuses a document that takes something from outside.
fn whole(warnings: &[Warning]) -> Result<(), Problem> {
    let Some(warning) = warnings.iter().find(|warning| warning.outside) else { return Ok(()) };
    let what = format!("{}: make the document whole in itself", warning.what);
    Err(Error { place: warning.place, ..Error::input(Kind::Refused, what) }.into())
}
