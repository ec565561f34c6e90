//! Random rasters, pixel by pixel: a model too simple to be wrong, and its way into the writers.
#![allow(dead_code, clippy::unwrap_used)] // Not every test uses all of it.

use std::ops::Range;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use runset::encode::{self, Encode, Strip};
use runset::run::{Header, Inks, Lines, Rgb, Run, Sheet, ink_of};

/// SplitMix64: the same numbers from the same seed, everywhere.
pub struct Rng(pub u64);

impl Rng {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `n`.
    pub fn below(&mut self, n: u32) -> u32 {
        (self.next() % u64::from(n)) as u32
    }
}

/// A raster; pixel 0 is paper, others are ink + 1.
pub struct Raster {
    pub header: Header,
    pub rows: Vec<Vec<u32>>,
}

impl Raster {
    /// Rows of all kinds: empty, full, noise, a few runs; many are repeated, some for a long time.
    pub fn random(rng: &mut Rng, width: u32, lines: Range<u32>, inks: Inks) -> Raster {
        // Of all colours a few, paper's and black among them.
        let pixels: Vec<u32> = match &inks {
            Inks::Listed(list) => (0..=list.len() as u32).collect(),
            Inks::Shaded { paper } => [0, ink_of(*paper) + 1, 1].into_iter().chain((0..6).map(|_| 1 + rng.below(1 << 24))).collect(),
        };
        let top = pixels.len() as u32 - 1;
        let mut rows: Vec<Vec<u32>> = Vec::new();
        while rows.len() < lines.len() {
            let noise = rng.below(3) == 0;
            let mut row = vec![0; width as usize];
            match rng.below(6) {
                0 => {}
                1 => row.fill(pixels[top as usize]),
                _ if noise => row.iter_mut().for_each(|p| *p = pixels[rng.below(top + 1) as usize]),
                _ => {
                    for _ in 0..rng.below(8) {
                        let (a, b, ink) = (rng.below(width), rng.below(width), rng.below(top + 1));
                        row[a.min(b) as usize..=a.max(b) as usize].fill(pixels[ink as usize]);
                    }
                }
            }
            let times = [1, 1, 1, 2, 3 + rng.below(9), 1 + rng.below(lines.len() as u32)][rng.below(6) as usize];
            let size = (rows.len() + times as usize).min(lines.len());
            rows.resize(size, row);
        }
        Raster { header: Header { width, lines, inks, dpi: None, sheet: Sheet::default() }, rows }
    }

    /// The colour of a pixel.
    pub fn colour(&self, x: usize, y: usize) -> Rgb {
        match (&self.header.inks, self.rows[y][x]) {
            (Inks::Listed(_), 0) => [255; 3],
            (Inks::Listed(list), pixel) => list[pixel as usize - 1],
            (Inks::Shaded { paper }, 0) => *paper,
            (Inks::Shaded { .. }, pixel) => [16, 8, 0].map(|bit| ((pixel - 1) >> bit) as u8),
        }
    }

    /// Writes it line by line, and takes all bytes at the end.
    pub fn encode(&self, format: &str) -> Vec<u8> {
        let mut out = Vec::new();
        let mut encoder = encoder(format, &self.header);
        encoder.begin(&mut out);
        for (y, row) in self.header.lines.clone().zip(&self.rows) {
            encoder.lines(Lines { y, n: 1, runs: &runs(row) }, &mut out);
        }
        encoder.end(&mut out);
        out
    }

    /// Writes it in groups of equal lines, as large as they come or cut at random, and takes the bytes away now and then.
    pub fn encode_in_groups(&self, format: &str, rng: &mut Rng, cut: bool) -> Vec<u8> {
        let (mut bytes, mut out) = (Vec::new(), Vec::new());
        let mut encoder = encoder(format, &self.header);
        encoder.begin(&mut out);
        let mut at = 0;
        while at < self.rows.len() {
            let mut n = self.rows[at..].iter().take_while(|row| **row == self.rows[at]).count() as u32;
            if cut {
                n = 1 + rng.below(n);
            }
            encoder.lines(Lines { y: self.header.lines.start + at as u32, n, runs: &runs(&self.rows[at]) }, &mut out);
            at += n as usize;
            if rng.below(3) == 0 {
                bytes.append(&mut out);
            }
        }
        encoder.end(&mut out);
        bytes.append(&mut out);
        bytes
    }

    /// Writes it in strips, cut where the format likes it or at random, as threads do: parts by other writers, the rest by the raster's own.
    pub fn encode_in_parts(&self, format: &str, rng: &mut Rng) -> Vec<u8> {
        let (mut out, mut at) = (Vec::new(), 0);
        let mut encoder = encoder(format, &self.header);
        let mut others = [(); 2].map(|()| self::encoder(format, &self.header));
        encoder.begin(&mut out);
        while at < self.rows.len() {
            let y = self.header.lines.start + at as u32;
            let most = encoder.strip_lines() - y % encoder.strip_lines();
            let to = self.rows.len().min(at + if rng.below(2) == 0 { most } else { 1 + rng.below(most) } as usize);
            let mut strip = Strip::default();
            while at < to {
                let equal = self.rows[at..to].iter().take_while(|row| **row == self.rows[at]).count();
                let n = if rng.below(4) == 0 { 1 } else { equal };
                strip.push(Lines { y: self.header.lines.start + at as u32, n: n as u32, runs: &runs(&self.rows[at]) });
                at += n;
            }
            let mut bytes = Vec::new();
            let part = others[rng.below(2) as usize].part(&strip, &mut bytes);
            assert_eq!(part.lines.is_empty(), bytes.is_empty(), "{format}");
            strip.within(strip.lines().start..part.lines.start).for_each(|lines| encoder.lines(lines, &mut out));
            if !part.lines.is_empty() {
                encoder.join(&part, &mut out);
                out.append(&mut bytes);
            }
            strip.within(part.lines.end..strip.lines().end).for_each(|lines| encoder.lines(lines, &mut out));
        }
        encoder.end(&mut out);
        out
    }
}

fn encoder(format: &str, header: &Header) -> Box<dyn Encode> {
    (encode::by_name(format).expect("a format").encoder)(header)
}

/// The maximal runs of a row of pixels.
pub fn runs(row: &[u32]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (x, &pixel) in (0u32..).zip(row) {
        match runs.last_mut() {
            Some(run) if pixel == run.ink + 1 && run.end == x => run.end = x + 1,
            _ if pixel > 0 => runs.push(Run { start: x, end: x + 1, ink: pixel - 1 }),
            _ => {}
        }
    }
    runs
}

/// `n` distinct inks; the first is black.
pub fn inks(n: usize) -> Inks {
    Inks::Listed((0..n as u32).map(|i| [(i * 89) as u8, (i * 5) as u8, (i * 37 / 256 * 11) as u8]).collect())
}

/// Any colours, on papers of all kinds.
pub fn shaded() -> [Inks; 4] {
    [[255; 3], [0; 3], [255, 255, 229], [1, 0, 0]].map(|paper| Inks::Shaded { paper })
}

/// Where a program is, if it is installed. Without it the test that asks is skipped, which is said, and fails where `CI` is `true`.
pub fn program(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let found = std::env::split_paths(&path).map(|folder| folder.join(name)).find(|file| file.is_file());
    if found.is_none() {
        eprintln!("skipped: {name} is not installed");
        assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "{name} is not installed");
    }
    found
}

/// Runs a program on `input` and returns what it writes; it must succeed.
pub fn run(program: &PathBuf, arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let mut child = Command::new(program).args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let output = std::thread::scope(|scope| {
        scope.spawn(move || std::io::Write::write_all(&mut stdin, input).unwrap());
        child.wait_with_output().unwrap()
    });
    assert!(output.status.success(), "{program:?} {arguments:?}: {}", output.status);
    output.stdout
}
