//! Adler-32, the checksum of zlib streams, put together from those of parts.
//!
//! Source: RFC 1950.

/// Adler-32 (RFC 1950) as a sum that can be put together: the sums over the bytes, and over the sums, without the leading 1. All are kept below the
/// modulus.
#[derive(Clone, Copy, Default)]
pub struct Adler {
    a: u64,
    b: u64,
    len: u64,
}

impl Adler {
    const MODULUS: u64 = 65_521;

    /// The sum of that tally.
    pub fn new(tally: [u64; 3]) -> Adler {
        let [a, b, len] = tally.map(|sum| sum % Self::MODULUS);
        Adler { a, b, len }
    }

    /// Its tally.
    pub fn tally(&self) -> [u64; 3] {
        [self.a, self.b, self.len]
    }

    /// Of some bytes.
    pub fn of(data: &[u8]) -> Adler {
        let mut sum = simd_adler32::Adler32::from_checksum(0);
        sum.write(data);
        let sum = u64::from(sum.finish());
        Adler { a: sum & 0xffff, b: sum >> 16, len: data.len() as u64 % Self::MODULUS }
    }

    /// Of `n` equal bytes, fewer than 2^28.
    pub fn equal(byte: u8, n: u64) -> Adler {
        let byte = u64::from(byte);
        Adler { a: byte * n % Self::MODULUS, b: byte * (n * (n + 1) / 2) % Self::MODULUS, len: n % Self::MODULUS }
    }

    /// That of its bytes and those of `next` behind them.
    pub fn append(&mut self, next: Adler) {
        self.b = (self.b + self.a * next.len + next.b) % Self::MODULUS;
        self.a = (self.a + next.a) % Self::MODULUS;
        self.len = (self.len + next.len) % Self::MODULUS;
    }

    /// The checksum.
    pub fn value(&self) -> u32 {
        let (a, b) = ((1 + self.a) % Self::MODULUS, (self.len + self.b) % Self::MODULUS);
        (b << 16 | a) as u32
    }
}
