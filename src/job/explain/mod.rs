//! How scanlines came about: which were counted, and on one of them every crossing with what it did to the counters.
//!
//! The engine keeps none of this while it sweeps. For the lines that are asked about the sweep runs again from the beginning of their band, so that what
//! it tells of them is what it did ([`How`]); and the one line whose crossings are wanted is walked once more over the scene's own formula, every count
//! noted ("CSG" in ARCHITECTURE.md, section 2.2.3, figures 2.10 to 2.12):
//!
//! ```text
//!   a - b     column     2     5     9
//!             crossed    a+    b+    a-  b-
//!             a - b   0  1     0     0            at least 1: the run [2,5)
//! ```
//!
//! Cost: the sweep of the bands that the lines are in, and for the one line its crossings times what flips.

mod walk;

use self::walk::Walk;
use super::source::Source;
use super::{Job, Options, layers};
use crate::error::{Error, Kind, Result, Warning};
use crate::region::Rows;
use crate::run::{Hex, Lines};
use crate::scene::Scene;

/// Most lines that are told of at once.
const MOST_LINES: u32 = 8192;

/// Most edges stepped for that.
const MOST_STEPS: u64 = 1 << 30;

/// How the engine came to the runs of a scanline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
#[serde(rename_all = "lowercase")]
pub enum How {
    /// Crossings were counted, in order or around what had changed.
    Counted,
    /// Counted without order, column by column.
    Unordered,
    /// No edge entered, left or passed another: the boundaries of the line above, in new columns.
    Carried,
    /// Nothing moved at all: the line above again.
    Repeated,
}

/// What is told of scanlines.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
pub struct Explanation {
    /// Width of the page in pixels.
    pub width: u32,
    /// The inks, as `#rrggbb`.
    pub inks: Vec<String>,
    /// Lines that follow each other and came about alike: the first, how many, and how.
    pub lines: Vec<(u32, u32, How)>,
    /// The line, if one was asked for.
    pub line: Option<Line>,
}

/// A scanline, walked from left to right.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "serve", schema(as = ExplainedLine))]
pub struct Line {
    /// Which.
    pub y: u32,
    /// The line that was counted last: this one, or one above.
    pub since: u32,
    /// The nodes of the expression that have a part in this line, inputs before what they feed.
    pub nodes: Vec<Vertex>,
    /// The columns in which edges are crossed.
    pub steps: Vec<Step>,
    /// The runs: first column, column behind the last, ink.
    pub runs: Vec<[u32; 3]>,
}

/// A node of the expression: a count and a rule.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "serve", schema(as = ExplainedNode))]
pub struct Vertex {
    /// The id in the document, or the shape's description there.
    pub name: Option<String>,
    /// When it holds: `nonzero`, `odd`, `everywhere`, or `atleast` with `k`.
    pub rule: &'static str,
    /// Its count must be at least this.
    pub k: Option<i32>,
    /// What feeds it, of the nodes told here: which, and its weight.
    pub inputs: Vec<(usize, i32)>,
    /// How many feed it in all.
    pub operands: usize,
    /// Its count at the left side.
    pub start: i32,
    /// The ink that it paints, if it is a layer of the picture.
    pub ink: Option<u32>,
}

/// A column in which edges are crossed, all of them before any node is looked at.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "serve", schema(as = ExplainedStep))]
pub struct Step {
    /// The first pixel behind the crossings.
    pub column: u32,
    /// The edges: which node's, and what it adds there.
    pub crossed: Vec<(usize, i32)>,
    /// Counts that are others now: which node's, and the count.
    pub counts: Vec<(usize, i32)>,
}

/// How the lines of `options` came about; if it is one line, it is walked.
///
/// # Errors
/// Those of [`Job::prepare`]; more lines, work or crossings than can be told.
pub fn explain(mut scene: Scene, options: &Options, warnings: &mut Vec<Warning>) -> Result<Explanation> {
    let layers = layers(&mut scene, options, warnings)?;
    let job = Job::of(scene.clone(), &layers, options)?;
    let Source::Plane(picture) = &job.source else { return Err(Error::input(Kind::Refused, "only lines of plane shapes can be told of")) };
    let header = job.header();
    if header.height() > MOST_LINES {
        let what = format!("{} lines are asked about: at most {MOST_LINES} are told of at once, so name some with lines", header.height());
        return Err(Error::input(Kind::Limit, what));
    }
    let mut told = Explanation {
        width: header.width,
        inks: header.inks.listed().iter().map(|&ink| Hex::of(ink).to_string()).collect(),
        lines: Vec::new(),
        line: None,
    };
    let (mut since, mut runs) = (0, Vec::new());
    let mut steps = 0;
    for band in job.bands() {
        // From the band's first line on, as when the page is drawn.
        let mut rows = Rows::new(picture.clone(), band.start / job.band * job.band..band.end);
        let mut before = *rows.cost();
        while let Some(Lines { y, n, runs: at_hand }) = rows.next() {
            if y < band.end && band.start < y + n {
                runs = at_hand.iter().map(|run| [run.start, run.end, run.ink]).collect();
            }
            let cost = *rows.cost();
            let how = match () {
                () if cost.unordered > before.unordered => How::Unordered,
                () if cost.counted > before.counted => How::Counted,
                () => How::Carried,
            };
            since = if how == How::Carried { since } else { y };
            before = cost;
            for (lines, how) in [(y..y + 1, how), (y + 1..y + n, How::Repeated)] {
                told.add(lines.start.max(band.start)..lines.end.min(band.end), how);
            }
            steps += rows.stepped() as u64;
            if steps > MOST_STEPS {
                return Err(Error::input(Kind::Limit, "the lines have too many crossings to be told of: name fewer with lines"));
            }
        }
    }
    if header.height() == 1 {
        let mut walk = Walk::new(&scene, &layers, options)?;
        let (nodes, steps) = walk.line(picture, header.width, header.lines.start)?;
        told.line = Some(Line { y: header.lines.start, since, nodes, steps, runs });
    }
    Ok(told)
}

impl Explanation {
    fn add(&mut self, lines: std::ops::Range<u32>, how: How) {
        match self.lines.last_mut() {
            _ if lines.is_empty() => {}
            Some((_, n, last)) if *last == how => *n += lines.len() as u32,
            _ => self.lines.push((lines.start, lines.len() as u32, how)),
        }
    }
}
