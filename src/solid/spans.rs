//! Scanlines of a stage, as spans that show one face each.
//!
//! The active edges are walked from left to right ("CSG" in ARCHITECTURE.md, sections 3.2 and 4.2.1). Crossing one changes the *turns* of its two faces: how often their
//! outlines have been passed, downwards less upwards. A face is active where its turns are not 0; they are 1 where it is seen from outside and -1
//! from inside, and where rounding turned a sliver over they are what the rounded outline says, so that the turns of a closed part always add up to 0.
//!
//! Between two columns the active faces are kept in the order of their depth, and counted from the eye on (section 3.3.4): the turns of a face are added to the
//! counter of its part, all of one depth together, and the first depth at which the model holds is what is seen.
//!
//! ```text
//!     eye   B+ A+     B-      A-           A - B:   B+ counts -1, A+ 1: 0;  B- gives it back: 1, seen from inside B
//!      o----|--|------|-------|--->
//! ```
//!
//! A span ends where that may change: at the next column of an edge, where two faces before the visible one cross or begin or cease to be equally near, or where one
//! behind it comes as near ([`Depth`] is linear in the column, so the first such pixel is a division; section 4.2.2 looks for the nearest crossing too). What
//! crosses behind the visible face is of no concern (section 4.3.2). If the parts and turns in front are those of the span before, so is what is seen
//! (section 4.3.1, with the conditions that were missing there): nothing is counted.

use std::ops::Range;
use std::sync::Arc;

use super::active::{Active, Faces};
use super::cells::{Cells, Known, Seen};
use super::savings::Savings;
use super::seen::Count;
use super::stage::{Crossing, Stage};
use super::timers::{Part, Timers};
use super::view::Depth;
use crate::line::FRACTION;
use crate::sweep::{Scanline, Sweep};

/// Pixels of a scanline that show one face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// First column.
    pub start: u32,
    /// Column behind the last.
    pub end: u32,
    /// The face: an index into [`Stage::faces`].
    pub face: u32,
    /// Whether it is seen from inside of its part: that part is taken away there.
    pub inside: bool,
}

/// Pixels of a scanline with the same layers of glass in front of what is seen, or of nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stretch {
    /// First column.
    pub start: u32,
    /// Column behind the last.
    pub end: u32,
    /// Which of [`Spans::layers`].
    pub layers: Range<usize>,
}

/// A layer of glass: its face, and whether that is seen from inside of its part.
pub type Layer = (u32, bool);

/// What a walk has cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Spans between columns of edges or crossings that were looked at.
    pub spans: u64,
    /// Spans between columns of edges that were taken from the scanline above.
    pub kept: u64,
    /// Counts along depth.
    pub counts: u64,
    /// Spans that ended at a crossing of faces.
    pub crossings: u64,
    /// Largest number of active edges.
    pub peak_active: u64,
}

impl Cost {
    /// Adds what another walk has cost.
    pub fn add(&mut self, other: &Cost) {
        self.spans += other.spans;
        self.kept += other.kept;
        self.counts += other.counts;
        self.crossings += other.crossings;
        self.peak_active = self.peak_active.max(other.peak_active);
    }
}

/// The scanlines of a stage, pulled from top to bottom.
pub struct Spans {
    stage: Arc<Stage>,
    savings: Savings,
    sweep: Sweep<Crossing>,
    /// The edges of the scanline at hand by column: those of the sweep.
    repeat: Option<Scanline>,
    faces: Faces,
    count: Count,
    cells: Cells,
    /// Whether what is seen on the scanline is taken from the one above, and noted.
    lines: bool,
    sight: Option<Sight>,
    spans: Vec<Span>,
    /// Columns at which spans of the scanline were split.
    splits: Vec<u32>,
    /// For every leaf of the program whether the faces of its part are glass.
    glass: Arc<[bool]>,
    /// The layers in front of what is in sight.
    front: Vec<Layer>,
    stretches: Vec<Stretch>,
    layers: Vec<Layer>,
    cost: Cost,
    timers: Timers,
}

/// What is seen from a pixel to the right.
#[derive(Clone, Copy, Debug)]
struct Sight {
    seen: Seen,
    /// The plane that is seen.
    plane: Option<u32>,
    /// The column behind the last in which it is seen, unless an edge changes that.
    until: u32,
    /// On how many pairs of faces that depends.
    pairs: usize,
    /// How many of the changes since the faces were listed are taken into account.
    told: usize,
}

/// Active edges to a column of the page up to which what is seen is noted.
const DENSE: usize = 4;

/// So many scanlines are looked down at once.
const DEEP: u32 = 256;

/// Bits of a pixel to which it is known there where pixels are.
const FINE: u32 = 20;

/// So many scanlines after a look downwards that did not pay the next is taken.
const AGAIN: u32 = 8;

impl Spans {
    /// The scanlines `rows` of a stage.
    pub fn new(stage: Arc<Stage>, rows: Range<u32>, savings: Savings) -> Spans {
        Spans::with_glass(stage, rows, savings, Arc::default())
    }

    /// The scanlines `rows` of a stage, with the layers of parts that are glass, by their leaves in the program; none if the list is empty. The stage must be one of whole parts ([`Savings::boxes`]).
    pub fn with_glass(stage: Arc<Stage>, rows: Range<u32>, savings: Savings, glass: Arc<[bool]>) -> Spans {
        // What is known from the scanline above is the face that is seen, and not what is in front of it.
        let savings = Savings { lines: savings.lines && glass.is_empty(), ..savings };
        let faces = stage.faces.len();
        Spans {
            savings,
            sweep: Sweep::new(rows),
            repeat: None,
            faces: Faces::new(faces),
            count: Count::new(&stage),
            cells: Cells::new(if savings.lines { faces } else { 0 }),
            lines: false,
            sight: None,
            spans: Vec::new(),
            splits: Vec::new(),
            glass,
            front: Vec::new(),
            stretches: Vec::new(),
            layers: Vec::new(),
            cost: Cost::default(),
            timers: Timers::default(),
            stage,
        }
    }

    /// Takes the time of each part of the work from here on, which costs some itself.
    pub fn time(&mut self) {
        self.timers.start();
    }

    /// How long each part of the work has taken, if that is taken.
    pub fn timers(&self) -> &Timers {
        &self.timers
    }

    /// The next scanline and what it shows; none behind the last.
    #[expect(clippy::should_implement_trait, reason = "the spans are lent, not given")]
    pub fn next(&mut self) -> Option<(u32, &[Span])> {
        let scanline = match self.repeat.take() {
            Some(again) => again,
            None => self.sweep.next(&self.stage.edges)?,
        };
        let Scanline { y, n, .. } = scanline;
        if n > 1 {
            self.repeat = Some(Scanline { y: y + 1, n: n - 1, changed: false });
        }
        self.timers.lap(Part::Edges);
        self.splits.clear();
        self.scanline(&scanline);
        self.cost.crossings += self.splits.len() as u64;
        Some((y, &self.spans))
    }

    /// Where there is glass on the scanline that was given last, from left to right.
    pub fn stretches(&self) -> &[Stretch] {
        &self.stretches
    }

    /// The layers of a stretch, the nearest first.
    pub fn layers(&self, stretch: &Stretch) -> &[Layer] {
        &self.layers[stretch.layers.clone()]
    }

    /// What the scanlines have cost so far.
    pub fn cost(&self) -> &Cost {
        &self.cost
    }

    /// The columns at which spans of the scanline that was given last ended at a crossing of faces.
    pub fn splits(&self) -> &[u32] {
        &self.splits
    }

    /// How many edges are active on the scanline that was given last.
    pub fn active(&self) -> usize {
        self.sweep.list().len()
    }

    fn scanline(&mut self, scanline: &Scanline) {
        let stage = self.stage.clone();
        let width = stage.view.width;
        self.spans.clear();
        self.stretches.clear();
        self.layers.clear();
        let edges = self.sweep.list().len();
        self.cost.peak_active = self.cost.peak_active.max(edges as u64);
        // Where edges are denser than pixels hardly a cell lasts.
        self.lines = self.savings.lines && edges <= DENSE * width as usize;
        if !self.lines {
            self.cells.forget();
        } else {
            if let Some(known) = self.cells.all(scanline, self.sweep.columns(), width) {
                self.cost.kept += known.len() as u64;
                let known = known.filter(|&(start, end, _)| start < end);
                self.spans.extend(known.map(|(start, end, (face, inside))| Span { start, end, face, inside }));
                self.timers.lap(Part::Spans);
                return;
            }
            self.cells.start(scanline, &self.sweep);
        }
        self.count.forget();
        self.sight = None;
        let mut i = 0;
        while i < edges {
            let column = self.sweep.columns()[i];
            if column >= width {
                break;
            }
            let first = i;
            while i < edges && self.sweep.columns()[i] == column {
                let entry = self.sweep.list()[i];
                self.faces.pass(self.sweep.tags()[entry.slot()]);
                if self.lines {
                    self.cells.pass(entry, &self.sweep);
                }
                i += 1;
            }
            self.cell(&stage, scanline.y, first..i);
        }
        if self.lines {
            // What is beyond the page stays there for as long as its edges do.
            let beyond = self.sweep.list()[i..].iter().map(|entry| self.sweep.until(entry.slot()));
            self.cells.bound(beyond.min().unwrap_or(u32::MAX));
        }
        self.faces.clear();
        self.timers.lap(Part::Faces);
    }

    /// Shows what is seen behind a group of edges that share a column, up to the next.
    fn cell(&mut self, stage: &Stage, y: u32, group: Range<usize>) {
        let width = stage.view.width;
        let columns = self.sweep.columns();
        let columns = columns[group.start]..columns.get(group.end).map_or(width, |&next| next.min(width));
        let known = if self.lines { self.cells.known(&group) } else { None };
        let known = match known {
            Some(known) if y < known.until => {
                self.cost.kept += 1;
                self.show(columns, known.seen);
                self.sight = None;
                known
            }
            _ => {
                self.keep(stage, columns.start, y);
                let again = known.is_some_and(|known| y >= known.again);
                if again {
                    self.sight = None;
                }
                let seen = self.fill(stage, y, columns.clone());
                match seen {
                    _ if !again => Known { again: known.map_or(y + 1, |known| known.again), ..Known::default() },
                    Some((seen, pairs)) => Known { seen, until: self.below(stage, y, columns, &group, pairs), again: y + AGAIN },
                    None => Known { again: y + AGAIN, ..Known::default() },
                }
            }
        };
        if self.lines {
            self.cells.note(&group, known);
        }
        self.timers.lap(Part::Spans);
    }

    /// Looks whether what is seen left of a group of edges that was just passed is still seen behind it: nothing in front came or went, and what came is
    /// behind (4.3.1).
    fn keep(&mut self, stage: &Stage, column: u32, y: u32) {
        let Some(sight) = self.sight.take().filter(|sight| column < sight.until && self.savings.spans && self.savings.hidden) else {
            return;
        };
        let Some(visible) = sight.plane else { return };
        let visible = &stage.depths[visible as usize];
        let (near, mut until) = (visible.at(column, y), sight.until);
        let news = self.faces.news(sight.told);
        for &face in news {
            if self.count.is_ahead(face) {
                return;
            }
            if self.faces.turns(face) != 0 && !self.faces.is_listed(face) {
                let behind = &stage.depths[stage.faces[face as usize].plane as usize];
                let by = near - behind.at(column, y);
                if by <= 0 {
                    return;
                }
                until = parts(visible, behind, by, column..until);
            }
        }
        self.sight = Some(Sight { until, told: sight.told + news.len(), ..sight });
    }

    fn show(&mut self, columns: Range<u32>, seen: Seen) {
        let Some((face, inside)) = seen else { return };
        match self.spans.last_mut() {
            Some(last) if (last.face, last.inside) == (face, inside) && last.end == columns.start => last.end = columns.end,
            _ => self.spans.push(Span { start: columns.start, end: columns.end, face, inside }),
        }
    }

    /// Lays what is in front of what is in sight over columns.
    fn lay(&mut self, columns: Range<u32>) {
        if self.front.is_empty() {
            return;
        }
        match self.stretches.last_mut() {
            Some(last) if last.end == columns.start && self.layers[last.layers.clone()] == self.front[..] => last.end = columns.end,
            _ => {
                let first = self.layers.len();
                self.layers.extend_from_slice(&self.front);
                self.stretches.push(Stretch { start: columns.start, end: columns.end, layers: first..self.layers.len() });
            }
        }
    }

    /// Shows what is seen on columns between which no edge is crossed. Gives what is seen in all of them, if that is one thing that was looked at here, and on how many
    /// pairs of faces it depends.
    fn fill(&mut self, stage: &Stage, y: u32, columns: Range<u32>) -> Option<(Seen, usize)> {
        let mut start = columns.start;
        let mut whole = None;
        while start < columns.end {
            let sight = match self.sight {
                Some(sight) if start < sight.until => sight,
                _ => {
                    let sight = self.look(stage, start, y);
                    whole = (start == columns.start && columns.end <= sight.until).then_some((sight.seen, sight.pairs));
                    *self.sight.insert(sight)
                }
            };
            let end = sight.until.min(columns.end);
            self.show(start..end, sight.seen);
            self.lay(start..end);
            self.cost.spans += 1;
            if end < columns.end {
                self.splits.push(end);
            }
            start = end;
        }
        whole
    }

    /// Puts the active faces in order at a pixel and looks which of them is seen, and how far to the right.
    fn look(&mut self, stage: &Stage, column: u32, y: u32) -> Sight {
        self.timers.lap(Part::Spans);
        self.faces.listed(stage);
        self.faces.order(stage, column, y);
        self.timers.lap(Part::Faces);
        let visible = self.count.visible(stage, &self.faces, self.savings);
        self.cost.counts += u64::from(visible.counted);
        self.timers.lap(Part::Count);
        let shown = visible.seen.map(|seen| self.faces.list()[seen]);
        if !self.glass.is_empty() {
            // For as long as this is in sight all that is in front of it stays, and in this order.
            let ahead = self.faces.list()[..visible.front].iter().take_while(|active| shown.is_none_or(|shown| active.near > shown.near));
            let is_glass = |active: &&Active| self.glass[stage.faces[active.face as usize].leaf as usize];
            self.front.clear();
            self.front.extend(ahead.filter(is_glass).map(|active| (active.face, self.faces.turns(active.face) < 0)));
        }
        let pairs = self.pairs(visible.front, shown.is_some());
        let until = self.until(stage, column..stage.view.width, pairs);
        let seen = shown.map(|shown| (shown.face, self.faces.turns(shown.face) < 0));
        Sight { seen, plane: shown.map(|shown| shown.plane), until, pairs, told: 0 }
    }

    /// On how many neighbours' order it depends what is seen; all that are behind them must also stay behind the last.
    fn pairs(&self, front: usize, seen: bool) -> usize {
        if seen && self.savings.hidden { front } else { self.faces.list().len() }
    }

    /// The pairs of faces whose order must stay, with the faces equally near only if they are so everywhere.
    fn ordered(&self, pairs: usize) -> impl Iterator<Item = (&Active, &Active)> {
        let list = self.faces.list();
        let (front, behind) = list.split_at(pairs);
        let last = front.last().into_iter().flat_map(move |last| behind.iter().map(move |behind| (last, behind)));
        front.windows(2).map(|pair| (&pair[0], &pair[1])).chain(last)
    }

    /// The first column in the range, behind its first, at which the order that decided on what is seen may be another; its end if there is none.
    fn until(&self, stage: &Stage, columns: Range<u32>, pairs: usize) -> u32 {
        self.ordered(pairs).fold(columns.end, |end, (first, second)| {
            let [a, b] = [first, second].map(|active| &stage.depths[active.plane as usize]);
            parts(a, b, first.near - second.near, columns.start..end)
        })
    }

    /// The scanline up to which that order stays between the edge before these columns and the one behind them; they are all looked at on this one.
    fn below(&self, stage: &Stage, y: u32, columns: Range<u32>, group: &Range<usize>, pairs: usize) -> u32 {
        if self.faces.list().is_empty() {
            return u32::MAX;
        }
        let slot = |i: usize| self.sweep.list().get(i).map(|entry| entry.slot());
        let (left, right) = (slot(group.end - 1), slot(group.end));
        let until = [left, right].into_iter().flatten().fold(stage.view.height, |until, slot| until.min(self.sweep.until(slot)));
        let rows = (until - 1 - y).min(DEEP);
        if rows == 0 {
            return y + 1;
        }
        // The leftmost and the rightmost that pixels are on this scanline and on the last, from the first column: faces often meet at the edges, and part behind the
        // first pixel only.
        let first = i128::from(columns.start) << FRACTION;
        let room = |slot: Option<usize>, side: usize| slot.map_or(0, |slot| i128::from(self.sweep.room_below(slot, rows)[side]));
        let (room_left, room_right) = (room(left, 1), room(right, 0));
        let ends = |below: u32| {
            let at = |slot: Option<usize>| slot.map(|slot| self.sweep.position_below(slot, below) - first);
            let last = i128::from(stage.view.width - 1 - columns.start) << FRACTION;
            let (left, right) = (at(left).map_or(0, |at| at + room_left), at(right).map_or(last, |at| at - room_right));
            // Where they have crossed, no pixel is between them.
            [left.min(right) >> (FRACTION - FINE), -(-left.max(right) >> (FRACTION - FINE))]
        };
        let (above, below) = (ends(0), ends(rows));
        let mut stays = rows;
        for (first, second) in self.ordered(pairs) {
            let [a, b] = [first, second].map(|active| &stage.depths[active.plane as usize]);
            let (by, across, down) = (first.near - second.near, a.a - b.a, a.b - b.b);
            if (by, across, down) == (0, 0, 0) {
                continue;
            }
            let at = |ends: [i128; 2], rows: u32| {
                let straight = by.checked_add(down.checked_mul(rows.into())?)?.checked_mul(1 << FINE)?;
                straight.checked_add(across.checked_mul(if across > 0 { ends[0] } else { ends[1] })?)
            };
            let (Some(top), Some(bottom)) = (at(above, 0), at(below, rows)) else { return y + 1 };
            if top <= 0 {
                return y + 1;
            }
            if bottom <= 0 {
                // Least distances in depth of scanlines in between are not less than on a straight line from one to the other. In doubles, with more than their error taken off.
                let safe = f64::from(rows) * (top as f64 / (top as f64 - bottom as f64)) * (1.0 - 1e-9);
                stays = stays.min(safe as u32);
            }
        }
        y + 1 + stays
    }
}

/// The first column of a range, behind its first, at which `ahead` is not before `behind` as it is at the first, where it is so much nearer (0: equally
/// near); the range's end if there is none.
#[inline]
fn parts(ahead: &Depth, behind: &Depth, by: i128, columns: Range<u32>) -> u32 {
    let slope = ahead.a - behind.a;
    if by == 0 {
        return if slope == 0 { columns.end } else { columns.start + 1 };
    }
    let last = i128::from(columns.end - columns.start - 1);
    if slope >= 0 || by + slope * last > 0 {
        return columns.end;
    }
    // The first n with by + slope n <= 0.
    let n = (by - slope - 1) / -slope;
    columns.start + n as u32
}
