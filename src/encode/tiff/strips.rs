//! What codes the rows of a strip, and two simple ways: PackBits, and zlib streams.
//!
//! PackBits codes every row by itself, in packets of at most 128 bytes: a byte `n` below 128 and `n + 1` bytes as they are, or a byte `257 - n` and one that comes
//! `n` times. Only three equal bytes or more are such a packet: two would end the one before and save nothing.
//!
//! Source: TIFF Revision 6.0, section 9; RFC 1950.

use super::super::adler::Adler;
use super::super::deflate::{self, Block};
use super::pixels::Painter;
use crate::run::Run;

/// Codes the rows of one strip after another.
pub trait Coder: Send {
    /// Takes `n` more equal rows, one at least.
    fn rows(&mut self, runs: &[Run], n: u32);
    /// Ends the strip and appends its bytes.
    fn end(&mut self, out: &mut Vec<u8>);
}

/// Codes by PackBits.
pub struct PackBits {
    painter: Painter,
    /// Of the strip.
    bytes: Vec<u8>,
}

impl PackBits {
    /// Of rows that are painted so.
    pub fn new(painter: Painter) -> PackBits {
        PackBits { painter, bytes: Vec::new() }
    }
}

impl Coder for PackBits {
    fn rows(&mut self, runs: &[Run], n: u32) {
        let start = self.bytes.len();
        let mut packets = Packets { out: &mut self.bytes, last: (0, 0), open: None };
        self.painter.bytes(runs, |byte, n| packets.push(byte, n));
        packets.end_run();
        let end = self.bytes.len();
        (1..n).for_each(|_| self.bytes.extend_from_within(start..end));
    }

    fn end(&mut self, out: &mut Vec<u8>) {
        out.append(&mut self.bytes);
    }
}

/// Longest packet, in bytes that it stands for.
const PACKET: usize = 128;

/// The packets of a row.
struct Packets<'b> {
    out: &'b mut Vec<u8>,
    /// The byte at the end, and how often it stands there.
    last: (u8, usize),
    /// Where the packet of bytes as they are began that may go on.
    open: Option<usize>,
}

impl Packets<'_> {
    fn push(&mut self, byte: u8, n: usize) {
        if self.last.0 != byte {
            self.end_run();
            self.last.0 = byte;
        }
        self.last.1 += n;
    }

    fn end_run(&mut self) {
        let (byte, mut n) = self.last;
        self.last.1 = 0;
        while n >= 3 {
            let taken = n.min(PACKET);
            self.out.extend([(257 - taken) as u8, byte]);
            self.open = None;
            n -= taken;
        }
        for _ in 0..n {
            match self.open {
                Some(start) if usize::from(self.out[start]) + 1 < PACKET => self.out[start] += 1,
                _ => {
                    self.open = Some(self.out.len());
                    self.out.push(0);
                }
            }
            self.out.push(byte);
        }
    }
}

/// Codes by zlib: bytes as they are, or in RGB differences to the pixel before.
pub struct Deflate {
    painter: Painter,
    block: Block,
    adler: Adler,
    /// Of the strip: its header and the blocks that have ended.
    bytes: Vec<u8>,
}

/// Symbols after which a block ends: 256 KiB of them.
const BLOCK: usize = 1 << 16;

/// A zlib header: deflate with a window of 32 KiB, fast, no dictionary.
const ZLIB: [u8; 2] = [0x78, 0x5e];

impl Deflate {
    /// Of rows that are painted so.
    pub fn new(painter: Painter) -> Deflate {
        Deflate { painter, block: Block::new(), adler: Adler::default(), bytes: ZLIB.to_vec() }
    }
}

impl Coder for Deflate {
    fn rows(&mut self, runs: &[Run], n: u32) {
        for _ in 0..n {
            self.painter.predicted(runs, |byte, n| {
                self.block.push_equal(byte, n);
                self.adler.append(Adler::equal(byte, n as u64));
            });
            if self.block.symbols() >= BLOCK {
                self.block.end(&mut self.bytes);
            }
        }
    }

    fn end(&mut self, out: &mut Vec<u8>) {
        self.block.end(&mut self.bytes);
        out.append(&mut self.bytes);
        out.extend(deflate::LAST);
        out.extend(std::mem::take(&mut self.adler).value().to_be_bytes());
        self.bytes.extend(ZLIB);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn packed(bytes: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        let mut packets = Packets { out: &mut out, last: (0, 0), open: None };
        bytes.iter().for_each(|&byte| packets.push(byte, 1));
        packets.end_run();
        out
    }

    #[test]
    fn the_example_of_the_specification() {
        let bytes = [0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0xaa, 0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0x22]
            .into_iter()
            .chain([0xaa; 10])
            .collect::<Vec<_>>();
        let coded = [0xfe, 0xaa, 0x02, 0x80, 0x00, 0x2a, 0xfd, 0xaa, 0x03, 0x80, 0x00, 0x2a, 0x22, 0xf7, 0xaa];
        assert_eq!(packed(&bytes), coded);
    }

    proptest! {
        /// Unpacked by the rule of the specification; no packet is longer than it may be.
        #[test]
        fn packets_hold_the_bytes(runs in prop::collection::vec((0..3u8, prop_oneof![1..4usize, 1..400usize]), 0..60)) {
            let bytes: Vec<u8> = runs.iter().flat_map(|&(byte, n)| std::iter::repeat_n(byte, n)).collect();
            let (coded, mut read) = (packed(&bytes), Vec::new());
            let mut rest = &coded[..];
            while let [n, after @ ..] = rest {
                prop_assert_ne!(*n, 128, "a packet that says nothing");
                if *n < 128 {
                    let (literal, after) = after.split_at(usize::from(*n) + 1);
                    read.extend(literal);
                    rest = after;
                } else {
                    read.extend(std::iter::repeat_n(after[0], 257 - usize::from(*n)));
                    rest = &after[1..];
                }
            }
            prop_assert_eq!(&read, &bytes);
            prop_assert!(coded.len() <= bytes.len() + bytes.len().div_ceil(PACKET));
        }
    }
}
