//! Colours of faces, and scanlines of them.
//!
//! A face has one colour: that of its part, as bright as the angle at which light from the camera's upper left meets it. Where a part that is taken away has left its
//! surface, that is shown in the part's own colour, or in the scheme's colour for cuts if it has none.

use std::ops::Range;
use std::sync::Arc;

use glam::DVec3;

use super::savings::Savings;
use super::spans::{Cost, Span, Spans};
use super::stage::Stage;
use crate::run::{Lines, Rgb, Run};

/// Colours of what has none of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scheme {
    /// Its name, as OpenSCAD has it.
    pub name: &'static str,
    /// Where nothing is.
    pub background: Rgb,
    /// Surfaces.
    pub front: Rgb,
    /// Surfaces that were cut.
    pub back: Rgb,
}

macro_rules! schemes {
    ($($name:literal $background:literal $front:literal $back:literal;)*) => {
        &[$(Scheme { name: $name, background: rgb($background), front: rgb($front), back: rgb($back) }),*]
    };
}

const fn rgb(value: u32) -> Rgb {
    let [_, r, g, b] = value.to_be_bytes();
    [r, g, b]
}

/// OpenSCAD's colour schemes; the first is the default.
pub const SCHEMES: &[Scheme] = schemes! {
    "Cornfield"      0xffffe5 0xf9d72c 0x9dcb51;
    "Metallic"       0xaaaaff 0xddddff 0xdd22dd;
    "Sunset"         0xaa4444 0xffaaaa 0x882233;
    "Starnight"      0x000000 0xffffe0 0x00ffff;
    "BeforeDawn"     0x333333 0xcccccc 0x5563dd;
    "Nature"         0xfafafa 0x16a085 0xdbf4da;
    "DeepOcean"      0x333333 0xeeeeee 0x0babc8;
    "Solarized"      0xfdf6e3 0xb58800 0x882233;
    "Tomorrow"       0xf8f8f8 0x4271ae 0xf5871f;
    "Tomorrow Night" 0x1d1f21 0x81a2be 0xde935f;
    "Monotone"       0xffffe5 0xf9d72c 0xf9d72c;
};

/// How bright a face is that no light meets.
const AMBIENT: f64 = 0.35;

/// Where light comes from, in the camera's coordinates: right, down, forward.
const LIGHT: DVec3 = DVec3::new(-0.4, -0.65, -0.75);

/// The colours of a stage's faces, seen from outside and from inside of their parts.
#[derive(Clone, Debug)]
pub struct Colours(Vec<[u32; 2]>);

impl Colours {
    /// The colours of all faces of a stage whose parts have these, or none of their own.
    pub fn new(stage: &Stage, parts: &[Option<Rgb>], scheme: &Scheme) -> Colours {
        let light = LIGHT.normalize();
        let colours = stage.faces.iter().map(|face| {
            let normal = stage.planes[face.plane as usize].normal;
            let [right, down, forward] = stage.view.axes;
            let normal = DVec3::new(right.dot(normal), down.dot(normal), forward.dot(normal));
            // What is seen of a plane is turned to the eye, whichever side that is.
            let toward = if stage.is_toward(face.plane) { normal } else { -normal };
            let bright = AMBIENT + (1.0 - AMBIENT) * toward.dot(light).max(0.0);
            let own = parts[face.origin.part as usize];
            let mut sides = [own.unwrap_or(scheme.front), own.unwrap_or(scheme.back)];
            if face.origin.turned {
                sides.reverse();
            }
            sides.map(|colour| {
                let [r, g, b] = colour.map(|c| (f64::from(c) * bright).round() as u32);
                r << 16 | g << 8 | b
            })
        });
        Colours(colours.collect())
    }

    /// The colour of what a span shows, as 0xRRGGBB.
    pub fn of(&self, span: &Span) -> u32 {
        self.0[span.face as usize][usize::from(span.inside)]
    }
}

/// The scanlines of a stage in colour, pulled from top to bottom; what shows nothing is paper.
pub struct Rows {
    spans: Spans,
    colours: Arc<Colours>,
    runs: Vec<Run>,
}

impl Rows {
    /// The scanlines `rows`.
    pub fn new(stage: Arc<Stage>, colours: Arc<Colours>, rows: Range<u32>) -> Rows {
        Rows { spans: Spans::new(stage, rows, Savings::default()), colours, runs: Vec::new() }
    }

    /// The next scanline; none behind the last.
    #[expect(clippy::should_implement_trait, reason = "the rows are lent, not given")]
    pub fn next(&mut self) -> Option<Lines<'_>> {
        let (y, spans) = self.spans.next()?;
        self.runs.clear();
        for span in spans {
            let ink = self.colours.of(span);
            match self.runs.last_mut() {
                Some(last) if last.end == span.start && last.ink == ink => last.end = span.end,
                _ => self.runs.push(Run { start: span.start, end: span.end, ink }),
            }
        }
        Some(Lines { y, n: 1, runs: &self.runs })
    }

    /// The runs of the scanline that was given last.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// About how much work the last scanline was, in edges.
    pub fn stepped(&self) -> usize {
        self.spans.active()
    }

    /// What the scanlines have cost so far.
    pub fn cost(&self) -> &Cost {
        self.spans.cost()
    }
}
