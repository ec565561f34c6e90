//! Models of solids: what `runset solid` draws.

use std::io::Write;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use super::source::Source;
use super::{Job, Kept, SolidStats, band_height, slice, write};
use crate::count::{Node, Program};
use crate::error::{Error, Kind, Result};
use crate::grid::{MAX_HEIGHT, MAX_WIDTH};
use crate::run::{Header, Inks, Pixels, Sheet};
use crate::solid::body::Plane;
use crate::solid::camera::{Camera, Setup};
use crate::solid::glass;
use crate::solid::look::{Look, MAX_ANTIALIAS, MAX_TRANSLUCENT};
use crate::solid::paint::Paint;
use crate::solid::savings::Savings;
use crate::solid::shade::{SCHEMES, Scheme};
use crate::solid::spans::Spans;
use crate::solid::stage::Stage;

/// What is asked of a model.
#[derive(Clone, Debug)]
pub struct SolidOptions {
    /// Where it is seen from, and how large the page is.
    pub setup: Setup,
    /// Colours of what has none of its own.
    pub scheme: Scheme,
    /// Planes that cut it: what is before them, in the direction of their normals, stays. At most [`MAX_SECTIONS`].
    pub sections: Vec<Plane>,
    /// How it looks.
    pub look: Look,
    /// Only these scanlines.
    pub lines: Option<Range<u32>>,
    /// Resolution that the raster tells, in dots an inch.
    pub dpi: Option<f64>,
    /// What pixels are to be, in formats that leave a choice.
    pub pixels: Option<Pixels>,
    /// When the work began.
    pub started: Instant,
}

impl Default for SolidOptions {
    fn default() -> SolidOptions {
        SolidOptions {
            setup: Setup::default(),
            scheme: SCHEMES[0],
            sections: Vec::new(),
            look: Look::default(),
            lines: None,
            dpi: None,
            pixels: None,
            started: Instant::now(),
        }
    }
}

impl SolidOptions {
    /// The header of the raster.
    ///
    /// # Errors
    /// Those of [`Job::solid`].
    pub fn header(&self) -> Result<Header> {
        let Setup { width, height, .. } = self.setup;
        if !(1..=MAX_WIDTH).contains(&width) || !(1..=MAX_HEIGHT).contains(&height) {
            let what = format!("the page would be {width} x {height} px: give 1 to {MAX_WIDTH} x 1 to {MAX_HEIGHT}");
            return Err(Error::parameter(what));
        }
        check(&self.setup)?;
        self.finer()?;
        check_look(&self.look)?;
        if self.sections.len() > MAX_SECTIONS {
            return Err(Error::parameter(format!("{} sections: give at most {MAX_SECTIONS}", self.sections.len())));
        }
        let lines = slice(self.lines.as_ref(), height)?;
        let sheet = Sheet { pixels: self.pixels, ..Sheet::default() };
        Ok(Header { width, lines, inks: Inks::Shaded { paper: self.scheme.background }, dpi: self.dpi, sheet })
    }

    /// Those of the numbers of the same view ([`Job::aov`]), which stand for pixels as they are and not for means.
    #[must_use]
    pub fn of_numbers(&self) -> SolidOptions {
        SolidOptions { look: Look { antialias: 1, smooth: None, edges: None, ..self.look.clone() }, ..self.clone() }
    }

    /// The page of the stage: that of finer pixels.
    fn finer(&self) -> Result<Setup> {
        let (n, Setup { width, height, .. }) = (self.look.antialias, self.setup);
        if !(1..=MAX_ANTIALIAS).contains(&n) {
            return Err(Error::parameter(format!("antialias is {n}: give a whole number from 1 to {MAX_ANTIALIAS}")));
        }
        let [across, down] = [width, height].map(|side| side.saturating_mul(n));
        if across > MAX_WIDTH || down > MAX_HEIGHT {
            let what = format!(
                "antialias {n} takes a page of {across} x {down} px, and at most {MAX_WIDTH} x {MAX_HEIGHT} are possible: give a smaller one"
            );
            return Err(Error::parameter(what));
        }
        Ok(Setup { width: across, height: down, ..self.setup })
    }
}

/// What a pixel shows, as a number of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// The part, counted from 1 in document order; 0 is the background. PGM, 16 bits.
    Primitive,
    /// Distance along the view; infinite where nothing is. PFM, little endian.
    Depth,
    /// The normal of the surface, in the model's coordinates, towards the eye; 0 where nothing is. PFM, little endian.
    Normal,
}

/// Most planes that cut a model: each goes over all that is left of it.
pub const MAX_SECTIONS: usize = 16;

impl Job {
    /// A model in a view.
    ///
    /// # Errors
    /// A page or a range of lines out of bounds; a camera that sees nothing; more than [`MAX_SECTIONS`]; a limit: a scanline meets too many edges.
    pub fn solid(model: &Kept, options: &SolidOptions) -> Result<Job> {
        let header = options.header()?;
        let Kept { body, program, leaves, colours, pairs, .. } = model;
        let (view, look) = (model.view(&options.finer()?), &options.look);
        let (program, glass) = glass_of(program, leaves, look, colours.len())?;
        let savings = Savings { boxes: glass.is_empty(), ..Savings::default() };
        let stage = Stage::new(body, program, leaves, view, &options.sections, savings);
        // A scanline compares the faces at an edge with each other, so at worst all with all.
        let most = stage.edges.peak();
        if u64::from(most).pow(2) / 4 > *pairs {
            return Err(Error::input(Kind::Limit, format!("a scanline meets {most} edges: use a coarser model, or a part of it")));
        }
        let paint = Paint::new(&stage, body, colours, &options.scheme, look, glass);
        Ok(Job {
            edges: stage.edges.len() as u64,
            source: Source::Solid(Arc::new(stage), Arc::new(paint)),
            band: band_height(options.setup.height),
            header,
            started: options.started,
            prepare_seconds: options.started.elapsed().as_secs_f64(),
            solid: Some(SolidStats { faces: model.faces(), primitives: model.parts(), ..SolidStats::default() }),
        })
    }

    /// Writes what pixels show as numbers. Nothing is written for plane shapes.
    ///
    /// # Errors
    /// What the writer says; a picture of means, which has no such numbers: those of the view are a job of [`SolidOptions::of_numbers`].
    pub fn aov(&self, aov: Aov, out: &mut dyn Write) -> Result<()> {
        let Source::Solid(stage, _) = &self.source else { return Ok(()) };
        let [width, height] = [self.header.width, self.header.height()];
        if stage.view.width != width {
            return Err(Error::parameter("pixels that are means have no depth, part or normal: ask for them without antialias"));
        }
        let head = match aov {
            Aov::Primitive => format!("P5\n{width} {height}\n65535\n"),
            Aov::Depth => format!("Pf\n{width} {height}\n-1.0\n"),
            Aov::Normal => format!("PF\n{width} {height}\n-1.0\n"),
        };
        let mut bytes = head.into_bytes();
        let mut bands: Vec<_> = self.bands().collect();
        if aov != Aov::Primitive {
            // The bottom row comes first.
            bands.reverse();
        }
        for band in bands {
            let mut spans = Spans::new(stage.clone(), band, Savings::default());
            let mut rows = Vec::new();
            while let Some((y, line)) = spans.next() {
                let mut row = vec![0_u8; width as usize * aov.pixel().len()];
                row.chunks_exact_mut(aov.pixel().len()).for_each(|pixel| pixel.copy_from_slice(aov.pixel()));
                for span in line {
                    let face = &stage.faces[span.face as usize];
                    for x in span.start..span.end {
                        let pixel = &mut row[x as usize * aov.pixel().len()..][..aov.pixel().len()];
                        match aov {
                            Aov::Primitive => pixel.copy_from_slice(&((face.origin.part + 1).min(65_535) as u16).to_be_bytes()),
                            Aov::Depth => {
                                let near = stage.depths[face.plane as usize].at(x, y);
                                pixel.copy_from_slice(&(stage.view.distance(near, stage.farthest) as f32).to_le_bytes());
                            }
                            Aov::Normal => {
                                let normal = stage.planes[face.plane as usize].normal;
                                let toward = if stage.is_toward(face.plane) { normal } else { -normal };
                                pixel.copy_from_slice(toward.to_array().map(|x| (x as f32).to_le_bytes()).as_flattened());
                            }
                        }
                    }
                }
                rows.push(row);
            }
            if aov != Aov::Primitive {
                rows.reverse();
            }
            rows.iter().for_each(|row| bytes.extend_from_slice(row));
            write(out, &mut bytes)?;
        }
        out.flush().map_err(|error| Error::output(&error))
    }
}

impl Aov {
    /// A pixel of the background.
    fn pixel(self) -> &'static [u8] {
        match self {
            Aov::Primitive => &[0; 2],
            // Infinity as a 32-bit float.
            Aov::Depth => &[0, 0, 0x80, 0x7f],
            Aov::Normal => &[0; 12],
        }
    }
}

/// Whether a look is one.
fn check_look(look: &Look) -> Result<()> {
    if look.smooth.is_some_and(|angle| !(angle > 0.0 && angle <= 180.0)) {
        return Err(Error::parameter("the angle of smooth shading is out of range: give one above 0, and at most 180 degrees"));
    }
    if look.edges.is_some_and(|angle| !(0.0..=180.0).contains(&angle)) {
        return Err(Error::parameter("the angle of edges is out of range: give one from 0 to 180 degrees"));
    }
    if look.translucent.len() > MAX_TRANSLUCENT {
        return Err(Error::parameter(format!("{} ranges of translucent parts: give at most {MAX_TRANSLUCENT}", look.translucent.len())));
    }
    Ok(())
}

/// The program of what is opaque in a model of so many parts, and which of its leaves are glass; none if there is no glass.
fn glass_of(program: &Program, leaves: &[(usize, Node)], look: &Look, parts: usize) -> Result<(Program, Arc<[bool]>)> {
    let numbers = look.translucent.iter().flat_map(|range| [*range.start(), *range.end()]);
    if let Some(wrong) = { numbers }.find(|&number| number == 0 || number as usize > parts) {
        let what = format!(
            "there is no translucent part {wrong}: give numbers from 1 to {parts}, in the order in which runset info lists primitives"
        );
        return Err(Error::parameter(what));
    }
    let (named, mut glass) = (look.named(parts), vec![false; program.leaves()]);
    leaves.iter().for_each(|&(part, leaf)| glass[leaf as usize] = named[part]);
    let opaque = if look.translucent.is_empty() { program.clone() } else { glass::without(program, &glass) };
    if look.glass {
        glass.fill(true);
    }
    Ok((opaque, if glass.contains(&true) { glass.into() } else { Arc::default() }))
}

/// Whether a camera sees anything.
fn check(setup: &Setup) -> Result<()> {
    let finite = |numbers: &[f64]| numbers.iter().all(|x| x.is_finite());
    match setup.camera {
        Some(Camera::Gimbal(numbers)) if !finite(&numbers) || numbers[6] <= 0.0 => {
            Err(Error::parameter("the camera's seven numbers must be finite, and the last, its distance, above 0"))
        }
        Some(Camera::Vector(numbers)) if !finite(&numbers) || numbers[..3] == numbers[3..] => {
            Err(Error::parameter("the camera's six numbers must be finite, and its eye another point than the one it looks at"))
        }
        _ => Ok(()),
    }
}
