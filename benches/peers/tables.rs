//! The tables: which workloads, at which sizes, against whom, and what is aimed at.

use std::io::Write;
use std::iter::Peekable;

use anyhow::{Context, Result};

use super::floor;
use super::measure::{Ours, Times, ms, ratio};
use super::peer;
use super::probe::{self, Probed};
use super::shapes::{SIDE, Shapes, Workload};

/// A peer that takes longer, in seconds, is not timed again.
const LONG: f64 = 4.0;

/// Repetitions stop once a peer's take so many seconds together.
const ENOUGH: f64 = 10.0;

/// Workload, pixels to a unit, how many times faster than i_overlay's boolean edges and sweep should be.
const RUNS: [(&str, u32, Option<f64>); 15] = [
    ("coast1e3", 1, None),
    ("coast1e3", 4, None),
    ("coast1e5", 1, Some(50.0)),
    ("coast1e5", 4, Some(13.0)),
    ("coast1e5", 16, Some(5.0)),
    ("coast1e6", 4, Some(80.0)),
    ("spiky1e3", 4, None),
    ("spiky1e5", 1, Some(130.0)),
    ("self1e3", 4, None),
    ("self1e5", 4, None),
    ("kway1000", 1, Some(8.0)),
    ("kway1000", 4, Some(5.0)),
    ("manh1e5", 1, None),
    ("manh1e5", 4, Some(6.0)),
    ("manh1e5", 16, Some(2.5)),
];

/// Most nanoseconds an edge-line, on the tangle.
const EDGE_LINE: (&str, f64) = ("spiky1e5", 3.0);

/// Workload, pixels to a unit, how many times faster than i_overlay and tiny-skia packed bits should be made.
const PICTURES: [(&str, u32, Option<f64>); 7] = [
    ("coast1e3", 1, None),
    ("coast1e3", 4, None),
    ("coast1e5", 1, None),
    ("coast1e5", 4, Some(20.0)),
    ("coast1e6", 4, None),
    ("kway1000", 4, None),
    ("manh1e5", 4, None),
];

/// Workload and pixels to a unit of a page that is little but writing, and at most how many times the floor it may take.
const PAGES: [(&str, u32, Option<f64>); 2] = [("coast1e3", 4, None), ("coast1e3", 16, Some(1.3))];

/// Something aimed at, and whether it was reached.
pub struct Target {
    what: String,
    aim: String,
    measured: String,
    met: bool,
}

/// Those rows of a table whose workload was asked for, with its shapes.
fn chosen<'a, A: Copy>(
    rows: &'a [(&'static str, u32, A)],
    workloads: &'a [Workload],
) -> Peekable<impl Iterator<Item = (&'static str, u32, A, Shapes)>> {
    let rows = rows.iter().filter_map(|&(name, scale, aim)| {
        let (_, make) = workloads.iter().find(|workload| workload.0 == name)?;
        Some((name, scale, aim, make()))
    });
    rows.peekable()
}

fn page(scale: u32) -> String {
    format!("{}²", SIDE * scale)
}

/// Our runs against a boolean of polygons.
pub fn runs(workloads: &[Workload], repetitions: u32, targets: &mut Vec<Target>, out: &mut impl Write) -> Result<()> {
    let mut rows = chosen(&RUNS, workloads);
    if rows.peek().is_none() {
        return Ok(());
    }
    writeln!(out, "Runs against i_overlay's boolean, ms:\n")?;
    writeln!(
        out,
        "| workload | page | edge-lines | edges | sweep | both | ns an edge-line, sweep (both) | i_overlay | ratio | aim | ratio to the sweep alone | differ |"
    )?;
    writeln!(out, "|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|")?;
    for (name, scale, aim, shapes) in rows {
        let mut ours = Ours::new(shapes.scene(), f64::from(scale));
        let peer = paired("i_overlay", name, scale, &shapes, repetitions, &mut ours, |ours| ours.runs().map(|_| ()))?;
        let (edges, sweep, whole) = (ours.edges.median(), ours.sweep.median(), ours.whole.median());
        let lines = shapes.edge_lines(scale);
        let each = |seconds: f64| seconds * 1e9 / lines as f64;
        writeln!(
            out,
            "| {name} | {} | {lines} | {} | {} | {} | {:.2} ({:.2}) | {} | {} | {} | {} | {} |",
            page(scale),
            ms(edges),
            ms(sweep),
            ms(whole),
            each(sweep),
            each(whole),
            peer.said(),
            peer.times(whole),
            aim.map_or(String::new(), |aim| aim.to_string()),
            peer.times(sweep),
            peer.differ()
        )?;
        out.flush()?;
        targets.extend(aim.map(|aim| at_least(format!("runs of {name} at {}, against i_overlay", page(scale)), aim, &peer, whole)));
        if (name, scale) == (EDGE_LINE.0, 1) {
            targets.push(Target {
                what: format!("runs of {name} at {}", page(scale)),
                aim: format!("at most {} ns an edge-line", EDGE_LINE.1),
                measured: format!("{:.2} ns", each(whole)),
                met: each(whole) <= EDGE_LINE.1,
            });
        }
    }
    Ok(writeln!(out)?)
}

/// Our packed bits against masks.
pub fn pictures(workloads: &[Workload], repetitions: u32, targets: &mut Vec<Target>, out: &mut impl Write) -> Result<()> {
    let mut rows = chosen(&PICTURES, workloads);
    if rows.peek().is_none() {
        return Ok(());
    }
    let peers = &peer::NAMES[1..];
    writeln!(out, "Packed bits, edges included, against a mask of one byte a pixel, ms (times ours; pixels that differ):\n")?;
    writeln!(out, "| workload | page | edges + packed | clearing a mask | {} |", peers.join(" | "))?;
    writeln!(out, "|---|---|--:|--:|{}", "--:|".repeat(peers.len()))?;
    for (name, scale, aim, shapes) in rows {
        let mut ours = Ours::new(shapes.scene(), f64::from(scale));
        let mut cells = Vec::new();
        for &with in peers {
            let peer = paired(with, name, scale, &shapes, repetitions, &mut ours, Ours::pictures)?;
            cells.push(peer);
        }
        let picture = ours.picture.median();
        let mut clear = Times::default();
        let mut mask = vec![0; (SIDE * scale) as usize * (SIDE * scale) as usize];
        (0..repetitions.min(5)).for_each(|_| floor::clear(&mut mask, &mut clear));
        write!(out, "| {name} | {} | {} | {} |", page(scale), ms(picture), ms(clear.median()))?;
        for peer in &cells {
            write!(out, " {} ({}; {}) |", peer.said(), peer.times(picture), peer.differ())?;
        }
        writeln!(out)?;
        out.flush()?;
        let against = &cells[0];
        targets.extend(
            aim.map(|aim| at_least(format!("packed bits of {name} at {}, against {}", page(scale), peers[0]), aim, against, picture)),
        );
    }
    Ok(writeln!(out)?)
}

/// Our packed bits against the least that writing a page takes.
pub fn pages(workloads: &[Workload], repetitions: u32, targets: &mut Vec<Target>, out: &mut impl Write) -> Result<()> {
    let mut rows = chosen(&PAGES, workloads);
    if rows.peek().is_none() {
        return Ok(());
    }
    writeln!(out, "Packed bits of a large page against writing it in batches of 64 KiB, ms:\n")?;
    writeln!(out, "| workload | page | edges | packed | bytes set in batches | rows copied in batches | times the first |")?;
    writeln!(out, "|---|---|--:|--:|--:|--:|--:|")?;
    for (name, scale, aim, shapes) in rows {
        let mut ours = Ours::new(shapes.scene(), f64::from(scale));
        let (mut set, mut copy) = (Times::default(), Times::default());
        let side = (SIDE * scale) as usize;
        for _ in 0..repetitions {
            ours.pictures()?;
            floor::set(side, side / 8, &mut set);
            floor::copy(side, side / 8, &mut copy);
        }
        let times = ours.picture.median() / set.median();
        let [edges, packed, floor, copied] = [&ours.edges, &ours.packed, &set, &copy].map(|times| ms(times.median()));
        writeln!(out, "| {name} | {} | {edges} | {packed} | {floor} | {copied} | {} |", page(scale), ratio(times))?;
        out.flush()?;
        targets.extend(aim.map(|aim| Target {
            what: format!("packed bits of {name} at {}, against writing in batches", page(scale)),
            aim: format!("at most {aim} times"),
            measured: format!("{times:.2} times"),
            met: times <= aim,
        }));
    }
    Ok(writeln!(out)?)
}

/// What was aimed at, and whether it was reached.
pub fn targets(targets: &[Target], out: &mut impl Write) -> Result<()> {
    writeln!(out, "| aim | | measured | reached |\n|---|---|---|---|")?;
    for Target { what, aim, measured, met } in targets {
        writeln!(out, "| {what} | {aim} | {measured} | {} |", if *met { "yes" } else { "no" })?;
    }
    Ok(())
}

/// A peer's time, in seconds, beside ours.
struct Beside {
    seconds: f64,
    probed: Result<Probed, &'static str>,
}

impl Beside {
    fn said(&self) -> String {
        self.probed.map_or_else(str::to_owned, |_| ms(self.seconds))
    }

    /// How many times ours it takes.
    fn times(&self, ours: f64) -> String {
        self.probed.map_or_else(|_| "-".to_owned(), |_| ratio(self.seconds / ours))
    }

    fn differ(&self) -> String {
        self.probed.map_or_else(|_| "-".to_owned(), |probed| probed.differ.to_string())
    }
}

/// Times ours and a peer in turn, each first every other time.
fn paired(
    with: &str,
    name: &str,
    scale: u32,
    shapes: &Shapes,
    repetitions: u32,
    ours: &mut Ours,
    mut run: impl FnMut(&mut Ours) -> Result<()>,
) -> Result<Beside> {
    let probed = probe::probe(with, name, scale)?;
    let mut times = Times::default();
    let again = probed.is_ok_and(|probed| probed.seconds <= LONG);
    let mut peer = if again { Some(peer::by_name(with, &shapes.input(scale)).context("a peer of the list")?) } else { None };
    for repetition in 0..repetitions {
        if repetition % 2 == 0 {
            run(ours)?;
        }
        if let Some(peer) = &mut peer {
            times.time(|| peer.run());
        }
        if repetition % 2 == 1 {
            run(ours)?;
        }
        if times.sum() > ENOUGH || ours.whole.sum() > ENOUGH {
            break;
        }
    }
    let seconds = if again { times.median() } else { probed.map_or(probe::SECONDS, |probed| probed.seconds) };
    Ok(Beside { seconds, probed })
}

/// A peer that does not finish is taken for one that just did within the limit.
fn at_least(what: String, aim: f64, peer: &Beside, ours: f64) -> Target {
    let times = ratio(peer.seconds / ours);
    let measured = peer.probed.map_or_else(|limit| format!("it {limit}; {times} times by the limit of 30 s"), |_| format!("{times} times"));
    Target { what, aim: format!("{aim} times"), measured, met: peer.seconds >= aim * ours }
}
