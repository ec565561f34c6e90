//! The sweep: scanline after scanline, the active edges in the order of their columns.
//!
//! Edges come in chains: edges of one tag that follow each other downwards without a gap. Chains are sorted by their first
//! scanline (the y-entry lists of "CSG" in ARCHITECTURE.md, section 2.1.2, laid end to end, so that no array is as long as the page); the active
//! list ([`Sweep`]) takes those that begin, drops those that end, and steps the others, all in integers. Where an edge ends and its chain goes on, the
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

mod active;
mod loose;
mod slots;

pub use active::{Entry, Scanline, Sweep};
pub use loose::Loose;

use crate::line::Line;

/// An edge of a chain: a line and where it ends. It begins where the edge before it ends, or where its chain begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The scanline behind its last.
    pub last: u32,
    /// The line, at its first scanline; its columns are on the page.
    pub line: Line,
}

impl Edge {
    /// The edge, so many scanlines further down.
    fn down(self, rows: u32) -> Edge {
        if rows == 0 { self } else { Edge { line: self.line.down(rows), ..self } }
    }
}

/// Edges that follow each other downwards. The first stands here, so that a chain of one, and any chain that enters, is at hand.
#[derive(Clone, Copy, Debug)]
struct Chain<T> {
    first: u32,
    last: u32,
    edge: Edge,
    /// The others, among all.
    start: u32,
    end: u32,
    tag: T,
}

impl<T> Chain<T> {
    /// What chains are sorted by: first scanline, then column.
    fn key(&self) -> u64 {
        u64::from(self.first) << 32 | u64::from(self.edge.line.column())
    }
}

/// All chains of a drawing, in the order in which a sweep meets them; shared by all sweeps over it.
#[derive(Clone, Debug)]
pub struct Edges<T> {
    /// Those that are not the first of their chains.
    edges: Vec<Edge>,
    chains: Vec<Chain<T>>,
    /// For every `BLOCK` chains, the scanline behind the last of any: finds who is active at a given scanline.
    reach: Vec<u32>,
}

const BLOCK: usize = 64;

impl<T> Default for Edges<T> {
    fn default() -> Edges<T> {
        Edges { edges: Vec::new(), chains: Vec::new(), reach: Vec::new() }
    }
}

impl<T: Copy> Edges<T> {
    /// Adds a chain that begins at scanline `first`. Each edge ends below the one before; an empty chain is nothing.
    pub fn add(&mut self, first: u32, edges: impl IntoIterator<Item = Edge>, tag: T) {
        let index = |v: usize| u32::try_from(v).expect("edges are limited at the door");
        let mut edges = edges.into_iter();
        let Some(edge) = edges.next() else { return };
        let start = index(self.edges.len());
        self.edges.extend(edges);
        let end = index(self.edges.len());
        let last = self.edges[start as usize..].last().unwrap_or(&edge).last;
        self.chains.push(Chain { first, last, edge, start, end, tag });
        debug_assert!(self.check_chain(self.chains.len() - 1));
    }

    /// Puts the chains of others behind these; neither are sorted yet.
    pub fn append(&mut self, others: Edges<T>) {
        let before = u32::try_from(self.edges.len()).expect("edges are limited at the door");
        self.edges.extend(others.edges);
        self.chains.extend(others.chains.into_iter().map(|chain| Chain { start: chain.start + before, end: chain.end + before, ..chain }));
    }

    /// Sorts the chains. To be called once, behind the last [`Edges::add`].
    #[must_use]
    pub fn finish(mut self) -> Edges<T> {
        sort(&mut self.chains);
        self.reach = self.chains.chunks(BLOCK).map(|block| block.iter().map(|chain| chain.last).max().unwrap_or(0)).collect();
        self.edges.shrink_to_fit();
        self.chains.shrink_to_fit();
        self
    }

    /// How many are active on the scanline that most are.
    pub fn peak(&self) -> u32 {
        let rows = self.chains.iter().fold(0, |rows, chain| rows.max(chain.last));
        let mut changes = vec![0_i64; rows as usize + 1];
        for chain in &self.chains {
            changes[chain.first as usize] += 1;
            changes[chain.last as usize] -= 1;
        }
        let active = changes.iter().scan(0, |active, change| {
            *active += change;
            Some(*active)
        });
        active.max().unwrap_or(0) as u32
    }

    /// Number of edges stored.
    pub fn len(&self) -> usize {
        self.edges.len() + self.chains.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.chains.is_empty()
    }

    fn check_chain(&self, chain: usize) -> bool {
        let chain = &self.chains[chain];
        let lasts = self.edges[chain.start as usize..chain.end as usize].iter().map(|edge| edge.last);
        let lasts = std::iter::once(chain.edge.last).chain(lasts);
        std::iter::once(chain.first).chain(lasts.clone()).zip(lasts).all(|(before, last)| before < last)
    }

    /// Index of the first chain that begins at or below `row`.
    fn entry(&self, row: u32) -> usize {
        self.chains.partition_point(|chain| chain.first < row)
    }

    /// The scanline at which the chain of that index begins; `u32::MAX` behind the last.
    fn first(&self, chain: usize) -> u32 {
        self.chains.get(chain).map_or(u32::MAX, |chain| chain.first)
    }

    /// The chains from that index on that begin at scanline `row`.
    fn entering(&self, from: usize, row: u32) -> &[Chain<T>] {
        let waiting = &self.chains[from..];
        &waiting[..waiting.iter().take_while(|chain| chain.first == row).count()]
    }

    /// Chains that begin above `row` and have not ended there.
    fn straddling(&self, row: u32) -> impl Iterator<Item = &Chain<T>> {
        let before = &self.chains[..self.entry(row)];
        let blocks = before.chunks(BLOCK).zip(&self.reach).filter(move |&(_, &reach)| reach > row);
        blocks.flat_map(|(block, _)| block).filter(move |chain| chain.last > row)
    }

    /// The edge of a chain that is active on a scanline, at that scanline, and the index of the one behind it.
    #[inline]
    fn edge_at(&self, chain: &Chain<T>, row: u32) -> (Edge, u32) {
        let (start, end) = (chain.start as usize, chain.end as usize);
        if row < chain.edge.last {
            return (chain.edge.down(row - chain.first), chain.start);
        }
        let next = start + self.edges[start..end].partition_point(|edge| edge.last <= row);
        let first = if next == start { chain.edge.last } else { self.edges[next - 1].last };
        (self.edges[next].down(row - first), next as u32 + 1)
    }
}

/// Sorts chains by first scanline, then column: spread in place over buckets of some scanlines each, as in section 2.1.2, and in each compared.
fn sort<T: Copy>(chains: &mut [Chain<T>]) {
    let rows = chains.iter().fold(0, |rows, chain| rows.max(chain.first)) as usize + 1;
    // About two chains a bucket, if they are evenly spread, and a power of two of scanlines.
    let shift = rows.checked_div(chains.len() / 2).map_or(usize::BITS, |some| some.max(1).ilog2());
    let bucket = |chain: &Chain<T>| (chain.first as usize).checked_shr(shift).unwrap_or(0);
    let mut ends = vec![0; rows.checked_shr(shift).unwrap_or(0) + 1];
    chains.iter().for_each(|chain| ends[bucket(chain)] += 1);
    for i in 1..ends.len() {
        ends[i] += ends[i - 1];
    }
    // Up to here a bucket holds what belongs to it.
    let mut filled: Vec<usize> = [0].iter().chain(&ends).copied().take(ends.len()).collect();
    for here in 0..ends.len() {
        while filled[here] < ends[here] {
            let there = bucket(&chains[filled[here]]);
            chains.swap(filled[here], filled[there]);
            filled[there] += 1;
        }
    }
    let mut start = 0;
    for end in ends {
        chains[start..end].sort_unstable_by_key(Chain::key);
        start = end;
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
                    let [from, to] = [x, to].map(|x| x.clamp(0, i64::from(WIDTH) * 256));
                    let rows = (last - row) as u32;
                    let line = Line::through([from, row * 256 + 1], [to, last * 256 + 1], row as u32, rows, WIDTH).unwrap();
                    edges.push(Edge { last: last as u32, line });
                    (row, x) = (last, to);
                }
                (first as u32, edges)
            })
            .collect()
    }

    fn table(drawing: &Drawing) -> Edges<usize> {
        let mut edges = Edges::default();
        drawing.iter().enumerate().for_each(|(tag, (first, chain))| edges.add(*first, chain.iter().copied(), tag));
        edges.finish()
    }

    /// Tags in the order of the list.
    fn tags<T: Copy>(sweep: &Sweep<T>) -> impl Iterator<Item = T> {
        sweep.list().iter().map(|entry| sweep.tags()[entry.slot()])
    }

    /// Who is active on a scanline, and where: looked up chain by chain.
    fn brute(drawing: &Drawing, y: u32) -> Vec<(u32, usize)> {
        let mut active = Vec::new();
        for (tag, (first, chain)) in drawing.iter().enumerate() {
            let mut start = *first;
            for edge in chain {
                if (start..edge.last).contains(&y) {
                    active.push((edge.line.down(y - start).column(), tag));
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
                        let mut active: Vec<(u32, usize)> = sweep.columns().iter().copied().zip(tags(&sweep)).collect();
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
                let now = Some((tags(&sweep).collect::<Vec<_>>(), ties));
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
    fn a_loose_sweep_has_the_same_columns_and_can_be_put_in_order_again() {
        let mut random = Random(3);
        let (mut loose_rows, mut unchanged) = (0, 0);
        for _ in 0..400 {
            let drawing = drawing(&mut random);
            let edges = table(&drawing);
            let mut sweep = Sweep::new(0..HEIGHT as u32);
            let mut loose = false;
            let mut before: Option<Vec<(u32, usize)>> = None;
            loop {
                let y = if loose {
                    let Some(Loose { y, active, changed }) = sweep.next_loose(&edges, WIDTH) else { break };
                    let mut columns: Vec<u32> =
                        sweep.positions().iter().map(|&at| crate::line::column(at)).filter(|&c| c < WIDTH).collect();
                    columns.sort_unstable();
                    let expected = brute(&drawing, y);
                    assert_eq!(expected.len(), active);
                    assert!(columns.iter().copied().eq(expected.iter().map(|a| a.0).filter(|&c| c < WIDTH)));
                    // What is told as changed is: others are active, or two of them stand the other way round.
                    let order = |active: &[(u32, usize)], a: usize, b: usize| {
                        let column = |tag| active.iter().find(|other| other.1 == tag).map(|other| other.0);
                        Some(column(a)?.cmp(&column(b)?))
                    };
                    let tags: Vec<usize> = expected.iter().map(|a| a.1).collect();
                    let crossed = |before: &[(u32, usize)]| {
                        tags.iter().any(|&a| tags.iter().any(|&b| order(before, a, b) != order(&expected, a, b)))
                            || before.len() != tags.len()
                    };
                    assert!(!changed || before.as_deref().is_none_or(crossed), "line {y}");
                    loose_rows += 1;
                    unchanged += u32::from(!changed);
                    if random.below(4) == 0 {
                        sweep.tighten();
                        loose = false;
                    }
                    y
                } else {
                    let Some(Scanline { y, n, .. }) = sweep.next(&edges) else { break };
                    loose = n == 1 && random.below(3) == 0;
                    if loose {
                        sweep.loosen();
                    }
                    y + n - 1
                };
                if !loose {
                    let mut active: Vec<(u32, usize)> = sweep.columns().iter().copied().zip(tags(&sweep)).collect();
                    assert!(active.is_sorted_by_key(|a| a.0));
                    active.sort_unstable();
                    assert_eq!(active, brute(&drawing, y), "line {y}");
                }
                before = Some(brute(&drawing, y));
            }
        }
        assert!(loose_rows > 3000 && unchanged > 100, "{loose_rows} {unchanged}");
    }

    #[test]
    fn the_peak_is_that_of_the_scanlines() {
        let mut random = Random(4);
        for _ in 0..100 {
            let drawing = drawing(&mut random);
            let most = (0..HEIGHT as u32).map(|y| brute(&drawing, y).len()).max();
            assert_eq!(Some(table(&drawing).peak() as usize), most);
        }
    }

    #[test]
    fn a_chain_that_goes_on_is_no_event() {
        let mut edges = Edges::default();
        let corner = |i: i64| [i * i * 40, i * 2560];
        let side = (0..20)
            .map(|i| Edge { last: i as u32 * 10 + 10, line: Line::through(corner(i), corner(i + 1), i as u32 * 10, 10, 1000).unwrap() });
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
        let mut edges = Edges::default();
        edges.add(100, [Edge { last: 5_000_000, line: Line::vertical(3) }], 'a');
        edges.add(7000, [Edge { last: 8_000_000, line: Line::vertical(3) }], 'b');
        let edges = edges.finish();
        let mut sweep = Sweep::new(0..8_388_608);
        let mut rows = Vec::new();
        while let Some(Scanline { y, n, .. }) = sweep.next(&edges) {
            rows.push((y, n, tags(&sweep).collect::<String>()));
        }
        let expected = [(0, 100, ""), (100, 6900, "a"), (7000, 4_993_000, "ab"), (5_000_000, 3_000_000, "b"), (8_000_000, 388_608, "")];
        assert_eq!(rows, expected.map(|(y, n, tags)| (y, n, tags.to_owned())));
    }
}
