//! The sweep: scanline after scanline, the active edges in the order of their columns.
//!
//! Edges come in chains: edges of one tag that follow each other downwards without a gap. Chains are sorted by their first
//! scanline (the y-entry lists of "CSG" in ARCHITECTURE.md, section 2.1.2, laid end to end, so that no array is as long as the page); the active
//! list takes those that begin, drops those that end, and steps the others, all in integers. Where an edge ends and its chain goes on, the
//! next edge takes its place in the list: that is no event, so finer flattening causes none.
//!
//! ```text
//!   row   active list, by column            change
//!    0    a1    b1                          enter
//!    1    a1  b1                            -
//!    2    a2  b1          a1 -> a2          -          the chain goes on in its place
//!    3    [a2 b1]                           tie forms
//!    4    b1  a2                            tie parts, order
//! ```
//!
//! The sweep knows order and nothing else: what the tags mean, and what is counted, is the caller's. It tells when nothing changed but
//! positions ([`Scanline::changed`]), and when not even those do for some lines ([`Scanline::n`]); section 2.2.3 rests on that.
//! It starts at any scanline.
//!
//! Cost: a step and two comparisons for every active edge on every scanline; a scanline on which all active edges are vertical costs
//! nothing until one enters or leaves.

use std::ops::Range;

use crate::line::Line;

/// An edge of a chain: a line and where it ends. It begins where the edge before it ends, or where its chain begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The scanline behind its last.
    pub last: u32,
    /// The line, at its first scanline.
    pub line: Line,
}

/// Edges that follow each other downwards.
#[derive(Clone, Copy, Debug)]
struct Chain<T> {
    first: u32,
    last: u32,
    start: u32,
    end: u32,
    tag: T,
}

/// All chains of a drawing, in the order in which a sweep meets them; shared by all sweeps over it.
#[derive(Clone, Debug)]
pub struct Edges<T> {
    width: i32,
    edges: Vec<Edge>,
    chains: Vec<Chain<T>>,
    /// For every `BLOCK` chains, the scanline behind the last of any: finds who is active at a given scanline.
    reach: Vec<u32>,
}

const BLOCK: usize = 64;

impl<T: Copy> Edges<T> {
    /// No edges yet. Columns are clamped to `0..=width`, so that nothing beyond the page's sides is an event.
    pub fn new(width: u32) -> Edges<T> {
        let width = i32::try_from(width).expect("a page's width");
        Edges { width, edges: Vec::new(), chains: Vec::new(), reach: Vec::new() }
    }

    /// Adds a chain that begins at scanline `first`. Each edge ends below the one before; an empty chain is nothing.
    pub fn add(&mut self, first: u32, edges: impl IntoIterator<Item = Edge>, tag: T) {
        let index = |v: usize| u32::try_from(v).expect("edges are limited at the door");
        let start = index(self.edges.len());
        self.edges.extend(edges);
        let end = index(self.edges.len());
        if start < end {
            let last = self.edges[end as usize - 1].last;
            self.chains.push(Chain { first, last, start, end, tag });
            debug_assert!(self.check_chain(self.chains.len() - 1));
        }
    }

    /// Sorts the chains. To be called once, behind the last [`Edges::add`].
    #[must_use]
    pub fn finish(mut self) -> Edges<T> {
        let edges = &self.edges;
        self.chains.sort_by_cached_key(|chain| (chain.first, edges[chain.start as usize].line.column()));
        self.reach = self.chains.chunks(BLOCK).map(|block| block.iter().map(|chain| chain.last).max().unwrap_or(0)).collect();
        self.edges.shrink_to_fit();
        self.chains.shrink_to_fit();
        self
    }

    /// Number of edges stored.
    pub fn len(&self) -> usize {
        self.edges.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    fn check_chain(&self, chain: usize) -> bool {
        let chain = &self.chains[chain];
        let lasts = self.edges[chain.start as usize..chain.end as usize].iter().map(|edge| edge.last);
        std::iter::once(chain.first).chain(lasts.clone()).zip(lasts).all(|(before, last)| before < last)
    }

    /// Index of the first chain that begins at or below `row`.
    fn entry(&self, row: u32) -> usize {
        self.chains.partition_point(|chain| chain.first < row)
    }

    /// The column and the state of edge `edge` of a chain, which began `down` scanlines above.
    fn activate(&self, chain: &Chain<T>, edge: usize, down: u32) -> (i32, Active) {
        let Edge { last, line } = self.edges[edge];
        let line = if down > 0 { line.down(down) } else { line };
        (line.column().clamp(0, self.width), Active { line, until: last, edge: edge as u32, end: chain.end })
    }

    /// Chains that begin above `row` and have not ended there.
    fn straddling(&self, row: u32) -> impl Iterator<Item = &Chain<T>> {
        let before = &self.chains[..self.entry(row)];
        let blocks = before.chunks(BLOCK).zip(&self.reach).filter(move |&(_, &reach)| reach > row);
        blocks.flat_map(|(block, _)| block).filter(move |chain| chain.last > row)
    }
}

/// What a sweep has come to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scanline {
    /// The scanline.
    pub y: u32,
    /// It and the `n - 1` below have the same edges in the same columns.
    pub n: u32,
    /// Whether edges entered or left since the scanline before, or their order, or which of them share a column. True on the first.
    pub changed: bool,
}

/// An active edge beside its column and its tag.
#[derive(Clone, Copy, Debug)]
struct Active {
    line: Line,
    /// The scanline behind the last of this edge.
    until: u32,
    /// Index of the edge, and behind the last of its chain.
    edge: u32,
    end: u32,
}

/// A sweep over a range of scanlines: the active list, and where it stands. The edges are lent to each call, so that a suspended sweep is only its list.
#[derive(Clone, Debug)]
pub struct Sweep<T> {
    /// The scanlines still to come.
    rows: Range<u32>,
    /// The first chain that has not entered.
    entry: usize,
    columns: Vec<i32>,
    /// `ties[i]`: edge i is in the column of edge i - 1.
    ties: Vec<bool>,
    tags: Vec<T>,
    actives: Vec<Active>,
    /// How many active edges are not vertical.
    moving: usize,
    /// The first scanline at which an active edge has ended.
    leave: u32,
    started: bool,
}

impl<T: Copy> Sweep<T> {
    /// A sweep over `rows`.
    pub fn new(rows: Range<u32>) -> Sweep<T> {
        Sweep {
            rows,
            entry: 0,
            columns: Vec::new(),
            ties: Vec::new(),
            tags: Vec::new(),
            actives: Vec::new(),
            moving: 0,
            leave: u32::MAX,
            started: false,
        }
    }

    /// Columns of the active edges, ascending.
    pub fn columns(&self) -> &[i32] {
        &self.columns
    }

    /// Tags of the active edges, in the same order.
    pub fn tags(&self) -> &[T] {
        &self.tags
    }

    /// Goes to the next scanline that may differ; `None` behind the last.
    pub fn next(&mut self, edges: &Edges<T>) -> Option<Scanline> {
        let y = self.rows.start;
        if y >= self.rows.end {
            return None;
        }
        let changed = if self.started { self.advance(edges, y) } else { self.start(edges, y) };
        let n = if self.moving > 0 {
            1
        } else {
            let enter = edges.chains.get(self.entry).map_or(u32::MAX, |chain| chain.first);
            self.leave.min(enter).min(self.rows.end) - y
        };
        self.rows.start = y + n;
        debug_assert!(self.check(y));
        Some(Scanline { y, n, changed })
    }

    /// Whether the list is what it should be at scanline `y`.
    fn check(&self, y: u32) -> bool {
        let ties = (0..self.columns.len()).all(|i| self.ties[i] == (i > 0 && self.columns[i] == self.columns[i - 1]));
        let lengths = [self.ties.len(), self.tags.len(), self.actives.len()].iter().all(|&n| n == self.columns.len());
        let leave = self.actives.iter().map(|active| active.until).min().unwrap_or(u32::MAX);
        self.columns.is_sorted() && ties && lengths && leave == self.leave && leave > y
    }

    /// Fills the list for the first scanline.
    fn start(&mut self, edges: &Edges<T>, y: u32) -> bool {
        self.started = true;
        for chain in edges.straddling(y) {
            let (start, end) = (chain.start as usize, chain.end as usize);
            let edge = start + edges.edges[start..end].partition_point(|edge| edge.last <= y);
            let first = if edge == start { chain.first } else { edges.edges[edge - 1].last };
            let (column, active) = edges.activate(chain, edge, y - first);
            self.columns.push(column);
            self.tags.push(chain.tag);
            self.actives.push(active);
        }
        self.sort();
        self.entry = edges.entry(y);
        self.enter(edges, y);
        self.measure();
        self.ties.resize(self.columns.len(), false);
        self.tie();
        true
    }

    /// Merges the chains that begin at scanline `y` into the list, from its end, so that only what lies right of them moves. True if there are any.
    fn enter(&mut self, edges: &Edges<T>, y: u32) -> bool {
        let waiting = &edges.chains[self.entry..];
        let entering = &waiting[..waiting.iter().take_while(|chain| chain.first == y).count()];
        let mut old = self.columns.len();
        for chain in entering {
            let (column, active) = edges.activate(chain, chain.start as usize, 0);
            self.columns.push(column);
            self.tags.push(chain.tag);
            self.actives.push(active);
        }
        for (i, chain) in entering.iter().enumerate().rev() {
            let (column, active) = edges.activate(chain, chain.start as usize, 0);
            let mut to = old + i;
            while old > 0 && self.columns[old - 1] > column {
                old -= 1;
                self.columns[to] = self.columns[old];
                self.tags[to] = self.tags[old];
                self.actives[to] = self.actives[old];
                to -= 1;
            }
            self.columns[to] = column;
            self.tags[to] = chain.tag;
            self.actives[to] = active;
        }
        self.entry += entering.len();
        !entering.is_empty()
    }

    /// From the scanline before to `y`. True if anything but columns changed.
    fn advance(&mut self, edges: &Edges<T>, y: u32) -> bool {
        let mut left = false;
        let mut replaced = false;
        if y < self.leave {
            for (active, column) in self.actives.iter_mut().zip(&mut self.columns) {
                active.line.step();
                *column = active.line.column().clamp(0, edges.width);
            }
        } else {
            for (active, column) in self.actives.iter_mut().zip(&mut self.columns) {
                if active.until > y {
                    active.line.step();
                } else if active.edge + 1 < active.end {
                    active.edge += 1;
                    let Edge { last, line } = edges.edges[active.edge as usize];
                    (active.until, active.line) = (last, line);
                    replaced = true;
                } else {
                    left = true;
                }
                *column = active.line.column().clamp(0, edges.width);
            }
            if left {
                self.remove_ended(y);
            }
        }
        let ordered = self.columns.is_sorted();
        if !ordered {
            self.settle();
        }
        let entered = self.enter(edges, y);
        if left || replaced || entered {
            self.measure();
        }
        self.ties.resize(self.columns.len(), false);
        // Not in the expression: tie() also renews the ties.
        let parted = self.tie();
        left || entered || !ordered || parted
    }

    /// Drops the edges that have ended, keeping the order of the others.
    fn remove_ended(&mut self, y: u32) {
        let mut kept = 0;
        for i in 0..self.actives.len() {
            if self.actives[i].until > y {
                self.columns[kept] = self.columns[i];
                self.tags[kept] = self.tags[i];
                self.actives[kept] = self.actives[i];
                kept += 1;
            }
        }
        self.columns.truncate(kept);
        self.tags.truncate(kept);
        self.actives.truncate(kept);
    }

    /// Puts the list in order of columns: by insertion where little is out of place, as coherence lets expect (section 2.2.3), else by
    /// sorting.
    fn settle(&mut self) {
        let mut budget = 4 * self.columns.len() + 64;
        for i in 1..self.columns.len() {
            let column = self.columns[i];
            if self.columns[i - 1] <= column {
                continue;
            }
            let to = self.columns[..i].partition_point(|&other| other <= column);
            self.columns[to..=i].rotate_right(1);
            self.tags[to..=i].rotate_right(1);
            self.actives[to..=i].rotate_right(1);
            match budget.checked_sub(i - to) {
                Some(left) => budget = left,
                None => {
                    self.sort();
                    break;
                }
            }
        }
    }

    fn sort(&mut self) {
        let mut order: Vec<u32> = (0..self.columns.len() as u32).collect();
        order.sort_by_key(|&i| self.columns[i as usize]);
        self.columns = order.iter().map(|&i| self.columns[i as usize]).collect();
        self.tags = order.iter().map(|&i| self.tags[i as usize]).collect();
        self.actives = order.iter().map(|&i| self.actives[i as usize]).collect();
    }

    /// Renews what is known of the list as a whole.
    fn measure(&mut self) {
        self.moving = self.actives.iter().filter(|active| !active.line.is_vertical()).count();
        self.leave = self.actives.iter().map(|active| active.until).min().unwrap_or(u32::MAX);
    }

    /// Renews the ties; true if one formed or parted.
    fn tie(&mut self) -> bool {
        let mut parted = false;
        if let Some(first) = self.ties.first_mut() {
            parted = std::mem::take(first);
        }
        for (tie, pair) in self.ties[1.min(self.columns.len())..].iter_mut().zip(self.columns.windows(2)) {
            let now = pair[0] == pair[1];
            parted |= now != *tie;
            *tie = now;
        }
        parted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A small linear congruential generator: tests only need variety.
    struct Random(u64);

    impl Random {
        fn below(&mut self, n: i64) -> i64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 33) as i64 % n
        }
    }

    /// Chains as they were added: first scanline and edges.
    type Drawing = Vec<(u32, Vec<Edge>)>;

    const WIDTH: u32 = 40;
    const HEIGHT: i64 = 60;

    /// Random chains of few or many edges, some upright; the tag is the chain's index.
    fn drawing(random: &mut Random) -> Drawing {
        let upright = random.below(3) == 0;
        (0..random.below(30))
            .map(|_| {
                let first = random.below(HEIGHT);
                let (mut row, mut x) = (first, random.below(60) * 256 - 2560);
                let mut edges = Vec::new();
                for _ in 0..=random.below(5) {
                    let last = (row + 1 + random.below(12)).min(HEIGHT);
                    if last <= row {
                        break;
                    }
                    let to = if upright || random.below(4) == 0 { x } else { x + random.below(8000) - 4000 };
                    let line = Line::through([x, row * 256 + 1], [to, last * 256 + 1], row as u32, (last - row) as u32);
                    edges.push(Edge { last: last as u32, line });
                    (row, x) = (last, to);
                }
                (first as u32, edges)
            })
            .collect()
    }

    fn table(drawing: &Drawing) -> Edges<usize> {
        let mut edges = Edges::new(WIDTH);
        drawing.iter().enumerate().for_each(|(tag, (first, chain))| edges.add(*first, chain.iter().copied(), tag));
        edges.finish()
    }

    /// Who is active on a scanline, and where: looked up chain by chain.
    fn brute(drawing: &Drawing, y: u32) -> Vec<(i32, usize)> {
        let mut active = Vec::new();
        for (tag, (first, chain)) in drawing.iter().enumerate() {
            let mut start = *first;
            for edge in chain {
                if (start..edge.last).contains(&y) {
                    active.push((edge.line.down(y - start).column().clamp(0, WIDTH as i32), tag));
                }
                start = edge.last;
            }
        }
        active.sort_unstable();
        active
    }

    #[test]
    fn active_edges_are_those_that_meet_the_scanline_in_order_of_columns() {
        let mut random = Random(1);
        for _ in 0..600 {
            let drawing = drawing(&mut random);
            let edges = table(&drawing);
            let start = random.below(HEIGHT) as u32;
            for rows in [0..HEIGHT as u32, start..HEIGHT as u32] {
                let mut sweep = Sweep::new(rows.clone());
                let mut next = rows.start;
                while let Some(Scanline { y, n, .. }) = sweep.next(&edges) {
                    assert_eq!(y, next);
                    for same in y..y + n {
                        let mut active: Vec<(i32, usize)> = sweep.columns().iter().copied().zip(sweep.tags().iter().copied()).collect();
                        assert!(active.is_sorted_by_key(|a| a.0));
                        active.sort_unstable();
                        assert_eq!(active, brute(&drawing, same));
                    }
                    next = y + n;
                }
                assert_eq!(next, rows.end);
            }
        }
    }

    #[test]
    fn a_scanline_is_changed_if_the_order_or_its_ties_are() {
        let mut random = Random(2);
        let (mut kept, mut changes) = (0, 0);
        for _ in 0..600 {
            let edges = table(&drawing(&mut random));
            let mut sweep = Sweep::new(0..HEIGHT as u32);
            let mut before = None;
            while let Some(scanline) = sweep.next(&edges) {
                let ties: Vec<bool> = sweep.columns().windows(2).map(|pair| pair[0] == pair[1]).collect();
                let now = Some((sweep.tags().to_vec(), ties));
                if scanline.changed {
                    changes += 1;
                    assert_ne!(before, now, "line {}", scanline.y);
                } else {
                    kept += 1;
                    assert_eq!(before, now, "line {}", scanline.y);
                }
                before = now;
            }
        }
        assert!(kept > 3000 && changes > 3000, "{kept} {changes}");
    }

    #[test]
    fn a_chain_that_goes_on_is_no_event() {
        let mut edges = Edges::new(1000);
        let corner = |i: i64| [i * i * 40, i * 2560];
        let side = (0..20).map(|i| Edge { last: i as u32 * 10 + 10, line: Line::through(corner(i), corner(i + 1), i as u32 * 10, 10) });
        edges.add(0, side, 'a');
        edges.add(0, [Edge { last: 200, line: Line::vertical(900) }], 'b');
        let edges = edges.finish();
        let mut sweep = Sweep::new(0..200);
        let mut changed = Vec::new();
        while let Some(scanline) = sweep.next(&edges) {
            changed.extend(scanline.changed.then_some(scanline.y));
        }
        assert_eq!(changed, [0]);
    }

    #[test]
    fn upright_edges_cost_their_events() {
        let mut edges = Edges::new(10);
        edges.add(100, [Edge { last: 5_000_000, line: Line::vertical(3) }], 'a');
        edges.add(7000, [Edge { last: 8_000_000, line: Line::vertical(3) }], 'b');
        let edges = edges.finish();
        let mut sweep = Sweep::new(0..8_388_608);
        let mut rows = Vec::new();
        while let Some(Scanline { y, n, .. }) = sweep.next(&edges) {
            rows.push((y, n, sweep.tags().iter().collect::<String>()));
        }
        let expected = [(0, 100, ""), (100, 6900, "a"), (7000, 4_993_000, "ab"), (5_000_000, 3_000_000, "b"), (8_000_000, 388_608, "")];
        assert_eq!(rows, expected.map(|(y, n, tags)| (y, n, tags.to_owned())));
    }
}
