//! Scanlines of a stage in colour: a function of the stage, its paint and the line, whichever lines are drawn before.

use std::ops::Range;
use std::sync::Arc;

use super::average::{Average, push};
use super::beside::beside;
use super::glass;
use super::outlines::{INK, Outlines};
use super::paint::Paint;
use super::savings::Savings;
use super::shade::{lit, rgb};
use super::smooth::Shading;
use super::spans::{Cost, Layer, Span, Spans};
use super::stage::Stage;
use crate::run::{Lines, Run};

/// The scanlines of a picture, pulled from top to bottom; what shows nothing is paper.
pub struct Rows {
    finer: Finer,
    average: Option<Average>,
    /// The next scanline.
    y: u32,
    end: u32,
    runs: Vec<Run>,
    stepped: usize,
}

impl Rows {
    /// The scanlines `rows` of a page that the stage has as large, or [`Look::antialias`](super::look::Look::antialias) times as large.
    pub fn new(stage: Arc<Stage>, paint: Arc<Paint>, rows: Range<u32>) -> Rows {
        let n = paint.antialias;
        let average = (n > 1).then(|| Average::new(n, stage.view.width / n, paint.paper));
        let Range { start, end } = rows;
        Rows { finer: Finer::new(stage, paint, n * start..n * end), average, y: start, end, runs: Vec::new(), stepped: 0 }
    }

    /// The next scanline; none behind the last.
    #[expect(clippy::should_implement_trait, reason = "the rows are lent, not given")]
    pub fn next(&mut self) -> Option<Lines<'_>> {
        if self.y == self.end {
            return None;
        }
        self.stepped = 0;
        if let Some(average) = &mut self.average {
            for _ in 0..self.finer.paint.antialias {
                self.finer.next()?;
                average.add(&self.finer.runs);
                self.stepped += self.finer.spans.active();
            }
            average.finish(&mut self.runs);
        } else {
            self.finer.next()?;
            self.stepped = self.finer.spans.active();
        }
        self.y += 1;
        Some(Lines { y: self.y - 1, n: 1, runs: self.runs() })
    }

    /// The runs of the scanline that was given last.
    pub fn runs(&self) -> &[Run] {
        if self.average.is_some() { &self.runs } else { &self.finer.runs }
    }

    /// About how much work the last scanline was, in edges.
    pub fn stepped(&self) -> usize {
        self.stepped
    }

    /// What the scanlines have cost so far.
    pub fn cost(&self) -> &Cost {
        self.finer.spans.cost()
    }
}

/// The scanlines of the stage itself.
struct Finer {
    stage: Arc<Stage>,
    paint: Arc<Paint>,
    spans: Spans,
    shading: Option<Shading>,
    outlines: Option<Outlines>,
    /// The first scanline that is asked for: those above it are only looked at.
    first: u32,
    runs: Vec<Run>,
    /// Runs while others are laid over them.
    under: Vec<Run>,
}

impl Finer {
    fn new(stage: Arc<Stage>, paint: Arc<Paint>, rows: Range<u32>) -> Finer {
        let wide = paint.antialias;
        // What outlines depend on above the first scanline.
        let above = if paint.edges.is_some() { wide.min(rows.start) } else { 0 };
        Finer {
            spans: Spans::with_glass(stage.clone(), rows.start - above..rows.end, Savings::default(), paint.glass.clone()),
            shading: paint.smooth.clone().map(Shading::new),
            outlines: paint.edges.map(|angle| Outlines::new(angle, wide)),
            first: rows.start,
            runs: Vec::new(),
            under: Vec::new(),
            stage,
            paint,
        }
    }

    /// Makes the runs of the next scanline; none is behind the last.
    fn next(&mut self) -> Option<()> {
        let Finer { stage, paint, spans, shading, outlines, first, runs, under } = self;
        runs.clear();
        let y = loop {
            let (y, line) = spans.next()?;
            let dark = match outlines {
                Some(outlines) => outlines.next(stage, y, line),
                None => &[],
            };
            if y < *first {
                continue;
            }
            let mut shades = Shades { stage, paint, shading: shading.as_mut(), y };
            for &Span { start, end, face, inside } in line {
                shades.of((face, inside), inside, start..end, |columns, ink| push(runs, columns, ink));
            }
            if !dark.is_empty() {
                std::mem::swap(runs, under);
                runs.clear();
                beside(under, dark, |columns, run, dark| {
                    push(runs, columns, if dark.is_some() { INK } else { run.map_or(INK, |run| run.ink) });
                });
            }
            break y;
        };
        if !spans.stretches().is_empty() {
            std::mem::swap(runs, under);
            runs.clear();
            let mut shades = Shades { stage, paint, shading: shading.as_mut(), y };
            beside(under, spans.stretches(), |columns, run, stretch| match stretch {
                Some(stretch) => shades.behind(run.map(|run| run.ink), spans.layers(stretch), columns, runs),
                None => push(runs, columns, run.map_or(INK, |run| run.ink)),
            });
        }
        Some(())
    }
}

/// The colours of faces on a scanline.
struct Shades<'a> {
    stage: &'a Stage,
    paint: &'a Paint,
    shading: Option<&'a mut Shading>,
    y: u32,
}

impl Shades<'_> {
    /// Those of one side of a face on some columns, whether it was cut there or not: one for all, or one for each.
    #[inline]
    fn of(&mut self, (face, inside): Layer, cut: bool, columns: Range<u32>, mut take: impl FnMut(Range<u32>, u32)) {
        let flat = self.paint.colours.of(face, cut);
        match &mut self.shading {
            Some(shading) if !shading.is_flat(face) => {
                let colour = self.paint.colours.of_part(self.stage.faces[face as usize].origin, cut);
                shading.along(face, inside, self.y, columns, |x, cosine| take(x..x + 1, cosine.map_or(flat, |cosine| lit(colour, cosine))));
            }
            _ => take(columns, flat),
        }
    }

    /// What is seen on some columns through layers, of an ink or of paper.
    fn behind(&mut self, ink: Option<u32>, layers: &[Layer], columns: Range<u32>, runs: &mut Vec<Run>) {
        let back = ink.map_or(self.paint.paper, rgb);
        let flat = |layer: &Layer| self.shading.as_ref().is_none_or(|shading| shading.is_flat(layer.0));
        let pieces = if layers.iter().all(flat) { columns.len() } else { 1 };
        let mut colours = Vec::with_capacity(layers.len());
        for start in columns.clone().step_by(pieces.max(1)) {
            let piece = start..start + pieces as u32;
            colours.clear();
            for &layer in layers {
                self.of(layer, false, piece.clone(), |_, ink| colours.push(rgb(ink)));
            }
            let [r, g, b] = glass::behind(back, colours.iter().copied());
            push(runs, piece, u32::from_be_bytes([0, r, g, b]));
        }
    }
}
