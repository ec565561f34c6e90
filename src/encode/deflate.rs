//! Deflate for filtered rows: runs of equal bytes, and Huffman codes made for each block.
//!
//! What a filter leaves of a drawing is zeros, and a few other bytes where boundaries move. So the only matches looked for are those at
//! distance 1, which is what zlib calls its strategy RLE: no window is searched, nothing is hashed, and 258 zeros are a bit or two.
//!
//! ```text
//!   2 0 0 0 0 0 0 0 0 7 7 7 7 3 0 0 ...       ->    2  0 (7 more)  7 (3 more)  3  0 (...)
//! ```
//!
//! A block is kept as symbols until its end, when their numbers are known; then it is written with the code that suits them, and an
//! empty stored block behind it, so that it ends at a byte. A block refers to nothing before it.
//!
//! Source: RFC 1951.

// Bytes of the same filtered rows in segments of 256 KiB, as zlib 1.2.13 writes them: level 4, and strategy RLE at level 6. The first 64 MiB
// of each.
//
//     wavy outlines   rectangles    a map, 35 inks     a poster
//     133,012         756,020       2,728,721          476,125     level 4
//     110,503         596,061       2,593,646          395,168     RLE

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Literals and lengths: 256 bytes, the end of the block, and 29 classes of lengths.
const SYMBOLS: usize = 286;

/// The symbol that ends a block.
const END: usize = 256;

/// Lengths of matches.
const SHORTEST: usize = 3;
const LONGEST: usize = 258;

/// The symbol of every length from [`SHORTEST`] on, how many further bits it has, and which.
const LENGTHS: [(u16, u8, u8); LONGEST - SHORTEST + 1] = {
    let mut table = [(0, 0, 0); LONGEST - SHORTEST + 1];
    let (mut symbol, mut extra, mut length) = (257, 0, 0);
    while length < table.len() {
        // Eight symbols without further bits, then four of each number of them; 258 has a symbol of its own.
        let mut value = 0;
        while value < 1usize << extra && length < table.len() {
            table[length] = (symbol, extra, value as u8);
            length += 1;
            value += 1;
        }
        symbol += 1;
        if symbol > 264 && (symbol - 265) % 4 == 0 {
            extra += 1;
        }
    }
    table[LONGEST - SHORTEST] = (285, 0, 0);
    table
};

/// A block that is being gathered.
pub struct Block {
    /// A literal below 256, else 256 + length - 3 of a match; and how often it comes, in the high half.
    symbols: Vec<u32>,
    /// How often each literal and class of lengths comes.
    counts: [u32; SYMBOLS],
    /// The byte at the end, and how often it stands there: not among the symbols yet, as more may follow.
    last: (u8, usize),
    /// The same of pixels of three bytes; a block is one or the other.
    last_pixel: ([u8; 3], usize),
    /// How far back matches lie: 1, or 3 in a block of pixels.
    distance: usize,
}

impl Block {
    /// Nothing yet.
    pub fn new() -> Block {
        Block { symbols: Vec::new(), counts: [0; SYMBOLS], last: (0, 0), last_pixel: ([0; 3], 0), distance: 1 }
    }

    /// Nothing yet, of pixels of three bytes.
    pub fn of_pixels() -> Block {
        Block { distance: 3, ..Block::new() }
    }

    /// Takes `n` times the same pixel, in a block of pixels. How equal ones were divided among calls makes no difference.
    pub fn push_pixels(&mut self, pixel: [u8; 3], n: usize) {
        debug_assert_eq!(self.distance, 3, "a block of pixels");
        if n > 0 && self.last_pixel.0 != pixel {
            self.end_pixels();
            self.last_pixel.0 = pixel;
        }
        self.last_pixel.1 += n;
    }

    /// Makes symbols of the equal pixels at the end: the first as it is, the others as matches.
    fn end_pixels(&mut self) {
        let (pixel, n) = std::mem::take(&mut self.last_pixel);
        if n > 0 {
            for byte in pixel {
                self.symbols.push(u32::from(byte) | 1 << 16);
                self.counts[byte as usize] += 1;
            }
            self.matching(3 * (n - 1));
        }
    }

    /// Takes the next bytes.
    pub fn push(&mut self, bytes: &[u8]) {
        let mut rest = bytes;
        while let Some(&byte) = rest.first() {
            let n = equal(rest);
            self.push_equal(byte, n);
            rest = &rest[n..];
        }
    }

    /// Takes `n` times the same byte. How bytes were divided among calls makes no difference.
    pub fn push_equal(&mut self, byte: u8, n: usize) {
        if self.last.0 != byte {
            self.end_run();
            self.last.0 = byte;
        }
        self.last.1 += n;
    }

    /// Makes symbols of the equal bytes at the end.
    fn end_run(&mut self) {
        let (byte, n) = self.last;
        self.last.1 = 0;
        let literals = if n <= SHORTEST { n } else { 1 };
        for _ in 0..literals {
            self.symbols.push(u32::from(byte) | 1 << 16);
        }
        self.counts[byte as usize] += literals as u32;
        self.matching(n - literals);
    }

    /// Makes symbols of so many bytes that are as those before them: none, or three and more.
    fn matching(&mut self, n: usize) {
        let (mut longest, mut last) = (n / LONGEST, n % LONGEST);
        if (1..SHORTEST).contains(&last) && longest > 0 {
            // Too short to stand alone: the match before gives it three.
            longest -= 1;
            self.matches(LONGEST - SHORTEST, 1);
            last += SHORTEST;
        }
        while longest > 0 {
            let times = longest.min(usize::from(u16::MAX));
            self.matches(LONGEST, times);
            longest -= times;
        }
        if last > 0 {
            self.matches(last, 1);
        }
    }

    fn matches(&mut self, length: usize, times: usize) {
        self.symbols.push((256 + length - SHORTEST) as u32 | (times as u32) << 16);
        self.counts[LENGTHS[length - SHORTEST].0 as usize] += times as u32;
    }

    /// Writes the block, not as the last of its stream, up to the end of a byte, and begins a new one.
    pub fn end(&mut self, out: &mut Vec<u8>) {
        self.end_run();
        self.end_pixels();
        self.counts[END] = 1;
        let code = Code::new(&self.counts, 15);
        let mut bits = Bits { out, held: 0, n: 0 };
        bits.put(0b10 << 1, 3);
        code.describe(self.distance, &mut bits);
        // A match is its symbol, its further bits, and the distance, of which there is one: one bit, 0.
        let lengths = LENGTHS.map(|(symbol, extra, value)| {
            let (bits, n) = code.of[symbol as usize];
            (bits | u32::from(value) << n, n + u32::from(extra) + 1)
        });
        for symbol in &self.symbols {
            let (index, times) = ((symbol & 0xffff) as usize, symbol >> 16);
            let (code, n) = index.checked_sub(256).map_or_else(|| code.of[index], |length| lengths[length]);
            (0..times).for_each(|_| bits.put(code, n));
        }
        let (end, n) = code.of[END];
        bits.put(end, n);
        // An empty stored block: its type, and its length behind the end of the byte.
        bits.put(0, 3);
        bits.pad();
        out.extend_from_slice(&[0, 0, 0xff, 0xff]);
        self.symbols.clear();
        self.counts = [0; SYMBOLS];
    }
}

/// An empty last block, from a byte's beginning on.
pub const LAST: [u8; 2] = [3, 0];

/// How many bytes at the start are equal; there is one at least.
fn equal(bytes: &[u8]) -> usize {
    const STRIDE: usize = 64;
    let byte = bytes[0];
    if bytes.get(1) != Some(&byte) {
        return 1;
    }
    let differs = |chunk: &[u8; STRIDE]| chunk.iter().fold(0, |any, b| any | (b ^ byte)) != 0;
    let (strides, _) = bytes.as_chunks::<STRIDE>();
    let whole = strides.iter().position(differs).unwrap_or(strides.len()) * STRIDE;
    let rest = &bytes[whole..];
    let (words, _) = rest.as_chunks::<8>();
    let word = u64::from_le_bytes([byte; 8]);
    for (i, w) in words.iter().enumerate() {
        let difference = u64::from_le_bytes(*w) ^ word;
        if difference != 0 {
            return whole + 8 * i + difference.trailing_zeros() as usize / 8;
        }
    }
    let tail = &rest[8 * words.len()..];
    bytes.len() - tail.len() + tail.iter().position(|b| *b != byte).unwrap_or(tail.len())
}

/// Bits on their way out, the low ones first.
struct Bits<'o> {
    out: &'o mut Vec<u8>,
    held: u64,
    n: u32,
}

impl Bits<'_> {
    /// Puts the low `n` bits, at most 32.
    fn put(&mut self, bits: u32, n: u32) {
        self.held |= u64::from(bits) << self.n;
        self.n += n;
        if self.n >= 32 {
            self.out.extend_from_slice(&(self.held as u32).to_le_bytes());
            self.held >>= 32;
            self.n -= 32;
        }
    }

    /// Fills up the last byte with zeros.
    fn pad(&mut self) {
        let bytes = self.n.div_ceil(8) as usize;
        self.out.extend_from_slice(&self.held.to_le_bytes()[..bytes]);
        (self.held, self.n) = (0, 0);
    }
}

/// A Huffman code: the bits of every symbol, in the order in which they are written, and how many.
struct Code {
    of: Vec<(u32, u32)>,
}

impl Code {
    /// A code for symbols that come so often, of at most `limit` bits each.
    fn new(counts: &[u32], limit: u32) -> Code {
        let mut counts = counts.to_vec();
        // A code of one symbol is no code: there are two at least.
        while counts.iter().filter(|count| **count > 0).count() < 2 {
            let absent = counts.iter().position(|count| *count == 0).expect("alphabets have more than two symbols");
            counts[absent] = 1;
        }
        let mut lengths = lengths(&counts);
        while lengths.iter().any(|length| *length > limit) {
            // Flatter counts make a flatter tree.
            counts.iter_mut().for_each(|count| *count = count.div_ceil(2));
            lengths = self::lengths(&counts);
        }
        let mut of = vec![(0, 0); counts.len()];
        let mut next = 0_u32;
        for length in 1..=limit {
            for (of, _) in of.iter_mut().zip(&lengths).filter(|(_, l)| **l == length) {
                *of = (next.reverse_bits() >> (32 - length), length);
                next += 1;
            }
            next <<= 1;
        }
        Code { of }
    }

    /// Writes the code of literals and lengths, and that of distances, which has one symbol: those below 5 are their own, counted from 0.
    fn describe(&self, distance: usize, bits: &mut Bits<'_>) {
        /// The order in which the lengths of the lengths' code are written.
        const ORDER: [usize; 19] = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];
        let used = self.of.iter().rposition(|of| of.1 > 0).map_or(257, |last| (last + 1).max(257));
        let lengths: Vec<u32> = self.of[..used].iter().map(|of| of.1).chain(std::iter::repeat_n(0, distance - 1)).chain([1]).collect();
        // Symbol, further bits, how many.
        let mut symbols: Vec<(usize, u32, u32)> = Vec::new();
        let mut rest = &lengths[..];
        while let Some(&length) = rest.first() {
            let n = rest.iter().take_while(|l| **l == length).count();
            let taken = match (length, n) {
                (0, 11..) => {
                    symbols.push((18, n.min(138) as u32 - 11, 7));
                    n.min(138)
                }
                (0, 3..) => {
                    symbols.push((17, n as u32 - 3, 3));
                    n
                }
                (1.., 4..) => {
                    let again = (n - 1).min(6);
                    symbols.extend([(length as usize, 0, 0), (16, again as u32 - 3, 2)]);
                    again + 1
                }
                _ => {
                    symbols.push((length as usize, 0, 0));
                    1
                }
            };
            rest = &rest[taken..];
        }
        let mut counts = [0; 19];
        symbols.iter().for_each(|symbol| counts[symbol.0] += 1);
        let code = Code::new(&counts, 7);
        let written = ORDER.iter().rposition(|i| code.of[*i].1 > 0).map_or(4, |last| (last + 1).max(4));
        bits.put(used as u32 - 257, 5);
        bits.put(distance as u32 - 1, 5);
        bits.put(written as u32 - 4, 4);
        ORDER[..written].iter().for_each(|i| bits.put(code.of[*i].1, 3));
        for (symbol, further, n) in symbols {
            let (code, length) = code.of[symbol];
            bits.put(code, length);
            bits.put(further, n);
        }
    }
}

/// The depths of the symbols in Huffman's tree; 0 where one does not come.
fn lengths(counts: &[u32]) -> Vec<u32> {
    let mut heap: BinaryHeap<_> = (0..counts.len()).filter(|i| counts[*i] > 0).map(|i| Reverse((u64::from(counts[i]), i))).collect();
    // Inner nodes are numbered behind the symbols, parents after their children.
    let mut parents = vec![0; counts.len()];
    while let (Some(Reverse(a)), Some(Reverse(b))) = (heap.pop(), heap.pop()) {
        let parent = parents.len();
        (parents[a.1], parents[b.1]) = (parent, parent);
        parents.push(parent);
        heap.push(Reverse((a.0 + b.0, parent)));
    }
    let mut depths = vec![0; parents.len()];
    for node in (0..parents.len().saturating_sub(1)).rev().filter(|node| *node >= counts.len() || counts[*node] > 0) {
        depths[node] = depths[parents[node]] + 1;
    }
    depths.truncate(counts.len());
    depths
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::Read;

    fn inflated(blocks: &[Vec<u8>]) -> Vec<u8> {
        let (mut out, mut block) = (Vec::new(), Block::new());
        for bytes in blocks {
            block.push(bytes);
            block.end(&mut out);
        }
        out.extend(LAST);
        let mut bytes = Vec::new();
        flate2::read::DeflateDecoder::new(&out[..]).read_to_end(&mut bytes).expect("zlib reads it");
        bytes
    }

    proptest! {
        #[test]
        fn zlib_reads_what_was_written(blocks in prop::collection::vec(
            prop::collection::vec((prop_oneof![Just(0), Just(2), 0..4u8, any::<u8>()], prop_oneof![1..5usize, 1..600usize]), 0..200), 0..4),
        ) {
            let blocks: Vec<Vec<u8>> =
                blocks.iter().map(|runs| runs.iter().flat_map(|&(byte, n)| std::iter::repeat_n(byte, n)).collect()).collect();
            prop_assert_eq!(inflated(&blocks), blocks.concat());
        }
    }

    proptest! {
        #[test]
        fn zlib_reads_pixels(blocks in prop::collection::vec(prop::collection::vec((any::<[u8; 3]>(), 0..3u8, 0..400usize), 0..100), 0..4)) {
            let (mut out, mut block, mut expected) = (Vec::new(), Block::of_pixels(), Vec::new());
            for runs in blocks {
                for (pixel, few, n) in runs {
                    let pixel = if few > 0 { [few; 3] } else { pixel };
                    block.push_pixels(pixel, n);
                    expected.extend(std::iter::repeat_n(pixel, n).flatten());
                }
                block.end(&mut out);
            }
            out.extend(LAST);
            let mut bytes = Vec::new();
            flate2::read::DeflateDecoder::new(&out[..]).read_to_end(&mut bytes).expect("zlib reads it");
            prop_assert_eq!(bytes, expected);
        }
    }

    #[test]
    fn every_length_of_a_run() {
        for n in (0..1200).chain([258 * 70_000 + 2]) {
            let bytes = vec![9; n];
            assert_eq!(inflated(std::slice::from_ref(&bytes)), bytes, "{n}");
        }
    }

    #[test]
    fn codes_that_would_be_too_long() {
        // Counts that grow as Fibonacci numbers make the deepest tree: 24 levels here.
        let (mut bytes, mut counts) = (Vec::new(), (1, 1));
        for byte in 0..24u8 {
            // No two are equal next to each other, so all are literals.
            bytes.extend((0..counts.0).flat_map(|_| [byte, 255]));
            counts = (counts.1, counts.0 + counts.1);
        }
        assert_eq!(inflated(std::slice::from_ref(&bytes)), bytes);
    }
}
