//! The checksum of a raster: zlib's CRC-32 over all its pixels, at the cost of its runs.
//!
//! It is taken over the rows from top to bottom. With one ink (or none) a row is 1 bit a pixel, painted = 1, most significant
//! bit first, padded with zeros to a byte; with several inks it is one byte a pixel, 0 for paper and ink + 1, or two bytes,
//! big-endian, past 255 inks. Of a shaded raster it is three bytes a pixel, red, green, blue, paper's colour among them.
//!
//! A CRC is linear: its register is a polynomial over GF(2) modulo the generator, and feeding a row takes it from `R` to
//! `R·X + row`, where `X` is x to the number of bits of a row and `row` is what the row alone leaves in an empty register. So
//!
//! ```text
//! row             = paper · tail(0) + sum over its runs of (value + paper) · (tail(start) + tail(end)),
//!                   tail(x) = what a row leaves whose pixels from x to the end are all 1: one table for every width
//! R·X             = four look-ups, a table for each byte of R
//! n equal rows    : n times that, or for many R·X^n + row·(1 + X + … + X^(n-1)), both factors by doubling
//! ```
//!
//! Cost: two look-ups a run (with several inks or shaded also a step for each bit of a pixel) and four a line, at most as many as `STEPPED` lines
//! take a record, or some 100 steps for each doubling; the page is never expanded. The table of tails takes four bytes a pixel of the
//! width, rounded up to a power of two, and is shared by all rasters of the process.
//!
//! Source: the arithmetic on reflected polynomials is that of `crc32_combine` in zlib by Mark Adler.

use std::sync::OnceLock;

use crate::run::{Header, Inks, Lines, ink_of};

/// Up to so many equal rows are taken one by one: as long as that is less work than doubling.
const STEPPED: u32 = 64;

/// Gathers lines, runs and the CRC-32 of a raster as its lines go by.
#[derive(Clone, Debug)]
pub struct Checksum {
    /// Bytes a pixel; 0: one bit.
    bytes: u32,
    /// Width of a row with its padding, in pixels.
    width: u32,
    tails: &'static [Poly],
    /// The ink of paper, where that is a colour; else 0.
    paper: u32,
    /// What a row of paper leaves.
    blank: Poly,
    /// x to the number of bits of a row.
    row_shift: Poly,
    /// `by_row[i][v]` is the product of that and the polynomial whose byte i is v, all others 0.
    by_row: Box<[[Poly; 256]; 4]>,
    register: Poly,
    lines: u32,
    runs: u64,
}

impl Checksum {
    /// The checksum of a raster of which no line has been seen.
    pub fn new(header: &Header) -> Checksum {
        let (bytes, paper) = match &header.inks {
            Inks::Listed(list) => (if list.len() < 2 { 0 } else { 1 + u32::from(list.len() > 255) }, 0),
            Inks::Shaded { paper } => (3, ink_of(*paper)),
        };
        let width = if bytes == 0 { header.width.next_multiple_of(8) } else { header.width };
        let row_shift = power(TO_8, if bytes == 0 { width / 8 } else { width * bytes });
        let by_row = multiples(row_shift);
        let tails = tails(bytes, width);
        let blank = times(paper.swap_bytes(), tails[width as usize]);
        Checksum { bytes, width, tails, paper, blank, row_shift, by_row, register: u32::MAX, lines: 0, runs: 0 }
    }

    /// Takes the next lines. They must keep the invariants of [`Lines`] for the header's width.
    pub fn add(&mut self, lines: Lines<'_>) {
        let from = |x: u32| self.tails[(self.width - x) as usize];
        let spans = lines.runs.iter().map(|run| (run.ink, from(run.start) ^ from(run.end)));
        // The high byte comes first: it has the higher powers, which are the lower bits.
        let row = match self.bytes {
            0 => spans.fold(0, |row, (_, span)| row ^ span),
            1 => products::<8>(spans.map(|(ink, span)| ((ink + 1) << 24, span))),
            2 => products::<16>(spans.map(|(ink, span)| ((ink + 1).swap_bytes(), span))),
            _ => self.blank ^ products::<24>(spans.map(|(ink, span)| ((ink ^ self.paper).swap_bytes(), span))),
        };
        if lines.n <= STEPPED {
            for _ in 0..lines.n {
                let [a, b, c, d] = self.register.to_le_bytes().map(usize::from);
                let [by_a, by_b, by_c, by_d] = &*self.by_row;
                self.register = by_a[a] ^ by_b[b] ^ by_c[c] ^ by_d[d] ^ row;
            }
        } else {
            let (shift, series) = geometric(self.row_shift, lines.n);
            self.register = times(self.register, shift) ^ times(series, row);
        }
        self.lines += lines.n;
        self.runs += u64::from(lines.n) * lines.runs.len() as u64;
    }

    /// Starts anew in the middle of a raster: what follows is to be put behind what another has seen, by [`Checksum::append`].
    pub fn restart(&mut self) {
        (self.register, self.lines, self.runs) = (0, 0, 0);
    }

    /// What was seen since [`Checksum::restart`]: register, lines, runs.
    pub fn tally(&self) -> [u64; 3] {
        [self.register.into(), self.lines.into(), self.runs]
    }

    /// Takes the tally of lines that another has seen, of the same raster, which follow those seen here.
    pub fn append(&mut self, [register, lines, runs]: [u64; 3]) {
        let lines = lines as u32;
        self.register = times(self.register, power(self.row_shift, lines)) ^ register as u32;
        self.lines += lines;
        self.runs += runs;
    }

    /// Number of lines seen.
    pub fn lines(&self) -> u32 {
        self.lines
    }

    /// Number of runs seen; those of n equal lines count n times.
    pub fn runs(&self) -> u64 {
        self.runs
    }

    /// CRC-32 of the lines seen.
    pub fn crc32(&self) -> u32 {
        !self.register
    }
}

/// A polynomial of degree below 32 over GF(2), reflected: bit 31 is x^0, bit 0 is x^31.
type Poly = u32;

const ONE: Poly = 1 << 31;

/// x^8.
const TO_8: Poly = ONE >> 8;

/// x^32 modulo the generator, which is the generator without its highest term.
const TO_32: Poly = 0xEDB8_8320;

fn times_x(a: Poly) -> Poly {
    (a >> 1) ^ (TO_32 & (a & 1).wrapping_neg())
}

/// The product modulo the generator, in as many steps as `a` has terms up to its highest.
fn times(mut a: Poly, mut b: Poly) -> Poly {
    let mut product = 0;
    while a != 0 {
        product ^= b & (a >> 31).wrapping_neg();
        a <<= 1;
        b = times_x(b);
    }
    product
}

/// The sum of the products of pairs, of which the first has a degree below `N`. It is Horner's rule for all at once: what the powers of x multiply is summed up
/// first.
fn products<const N: usize>(pairs: impl Iterator<Item = (Poly, Poly)>) -> Poly {
    let mut factors = [0; N];
    for (a, b) in pairs {
        for (power, factor) in factors.iter_mut().enumerate() {
            *factor ^= if a & (ONE >> power) == 0 { 0 } else { b };
        }
    }
    factors.iter().rev().fold(0, |sum, factor| times_x(sum) ^ factor)
}

/// `x^n` and `1 + x + … + x^(n-1)`.
fn geometric(x: Poly, n: u32) -> (Poly, Poly) {
    let (mut power, mut sum) = (ONE, 0);
    for bit in (0..u32::BITS - n.leading_zeros()).rev() {
        sum ^= times(sum, power);
        power = times(power, power);
        if n >> bit & 1 == 1 {
            sum = times(sum, x) ^ ONE;
            power = times(power, x);
        }
    }
    (power, sum)
}

fn power(x: Poly, n: u32) -> Poly {
    geometric(x, n).0
}

/// The products of `a` and every polynomial that is one byte, byte by byte.
fn multiples(a: Poly) -> Box<[[Poly; 256]; 4]> {
    let mut table = Box::new([[0; 256]; 4]);
    // a times the highest bit, which is x^0, and so on down.
    let mut weight = a;
    for bit in (0..32).rev() {
        let (byte, first) = (&mut table[bit / 8], 1 << (bit % 8));
        for value in (first..256).filter(|value| value & first > 0) {
            byte[value] ^= weight;
        }
        weight = times_x(weight);
    }
    table
}

/// `tails(…)[d]` is what `d` pixels of value 1 at the end of a row leave in an empty register, for `d` up to `width` at least.
fn tails(bytes: u32, width: u32) -> &'static [Poly] {
    static TABLES: [[OnceLock<Vec<Poly>>; 32]; 4] = [const { [const { OnceLock::new() }; 32] }; 4];
    let size = width.next_power_of_two();
    TABLES[bytes as usize][size.trailing_zeros() as usize].get_or_init(|| {
        let mut table = Vec::with_capacity(size as usize + 8);
        table.push(0);
        let (mut weight, mut sum) = (TO_32, 0);
        while table.len() <= size as usize {
            let mut powers = [0; 8];
            for power in &mut powers {
                (*power, weight) = (weight, times_x(weight));
            }
            if bytes == 0 {
                // The last pixel of a byte is its bit 0, which the CRC takes first: the highest power.
                table.extend(powers.iter().rev().map(|power| {
                    sum ^= power;
                    sum
                }));
            } else {
                sum ^= powers[0];
                table.push(sum);
                (1..bytes).for_each(|_| weight = times(TO_8, weight));
            }
        }
        table
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::{Run, Sheet};
    use proptest::prelude::*;

    /// Plain CRC-32, by a library, over rows that are written out pixel by pixel.
    fn expanded(header: &Header, lines: &[(u32, Vec<Run>)]) -> u32 {
        let mut crc = crc32fast::Hasher::new();
        for (n, runs) in lines {
            let ink = |x: u32| runs.iter().find(|r| r.start <= x && x < r.end).map_or(0, |r| r.ink + 1);
            let mut row = Vec::new();
            match header.inks.listed().len() {
                _ if matches!(header.inks, Inks::Shaded { .. }) => (0..header.width).for_each(|x| row.extend(header.inks.pixel(ink(x)))),
                0 | 1 => {
                    row.resize(header.width.div_ceil(8) as usize, 0);
                    (0..header.width).filter(|&x| ink(x) > 0).for_each(|x| row[x as usize / 8] |= 0x80 >> (x % 8));
                }
                2..=255 => row.extend((0..header.width).map(|x| ink(x) as u8)),
                _ => (0..header.width).for_each(|x| row.extend((ink(x) as u16).to_be_bytes())),
            }
            (0..*n).for_each(|_| crc.update(&row));
        }
        crc.finalize()
    }

    fn header(width: u32, inks: Inks) -> Header {
        Header { width, lines: 0..1, inks, dpi: None, sheet: Sheet::default() }
    }

    fn listed(inks: usize) -> Inks {
        Inks::Listed(vec![[0; 3]; inks])
    }

    fn raster() -> impl Strategy<Value = (Header, Vec<(u32, Vec<Run>)>)> {
        let number = prop_oneof![Just(0usize), Just(1), 2..=255usize, Just(255), Just(256), Just(300)];
        let paper = prop_oneof![Just([0; 3]), Just([255; 3]), any::<[u8; 3]>()];
        let inks = prop_oneof![2 => number.prop_map(listed), 1 => paper.prop_map(|paper| Inks::Shaded { paper })];
        (1..400u32, inks).prop_flat_map(|(width, inks)| {
            let header = header(width, inks);
            let inks = header.inks.end();
            let runs = prop::collection::btree_set(0..=width, 0..30).prop_flat_map(move |cuts| {
                let cuts: Vec<u32> = cuts.into_iter().collect();
                let spans = cuts.windows(2).step_by(if inks > 1 { 1 } else { 2 }).map(|w| (w[0], w[1])).collect::<Vec<_>>();
                let count = if inks == 0 { 0 } else { spans.len() };
                prop::collection::vec(0..inks.max(1), count).prop_map(move |colours| {
                    spans.iter().zip(colours).map(|(&(start, end), ink)| Run { start, end, ink }).collect::<Vec<_>>()
                })
            });
            (Just(header), prop::collection::vec((prop_oneof![1..3u32, 1..140u32], runs), 0..12))
        })
    }

    proptest! {
        #[test]
        fn it_is_the_crc_of_the_expanded_rows((header, lines) in raster()) {
            let mut sum = Checksum::new(&header);
            for (n, runs) in &lines {
                sum.add(Lines { y: 0, n: *n, runs });
            }
            prop_assert_eq!(sum.crc32(), expanded(&header, &lines));
            prop_assert_eq!(sum.lines(), lines.iter().map(|l| l.0).sum::<u32>());
            prop_assert_eq!(sum.runs(), lines.iter().map(|l| u64::from(l.0) * l.1.len() as u64).sum::<u64>());
        }
    }

    #[test]
    fn the_widest_rows_of_every_depth() {
        for inks in [listed(1), listed(2), listed(300), Inks::Shaded { paper: [1, 2, 3] }] {
            let header = header(1 << 20, inks);
            let ink = header.inks.end() - 1;
            let lines = [(3, vec![Run { start: 5, end: 1 << 20, ink }]), (1, vec![Run { start: 0, end: 999_999, ink }])];
            let mut sum = Checksum::new(&header);
            lines.iter().for_each(|(n, runs)| sum.add(Lines { y: 0, n: *n, runs }));
            assert_eq!(sum.crc32(), expanded(&header, &lines), "{ink}");
        }
    }

    #[test]
    fn an_empty_page_costs_its_records_and_not_its_pixels() {
        let header = header(1 << 20, listed(1));
        let started = std::time::Instant::now();
        let mut sum = Checksum::new(&header);
        for y in (0..1 << 23).step_by(4096) {
            sum.add(Lines { y, n: 4096, runs: &[] });
        }
        assert!(started.elapsed().as_secs_f64() < 10.0, "{:?}", started.elapsed());
        // 2^40 zero bytes, put together by a library from two halves, again and again.
        let mut half = crc32fast::Hasher::new();
        half.update(&[0]);
        for _ in 0..40 {
            let other = half.clone();
            half.combine(&other);
        }
        assert_eq!(sum.crc32(), half.finalize());
    }
}
