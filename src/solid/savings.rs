//! What is saved by knowing more than one face, span or scanline.

/// Each can be switched off: what is seen does not depend on it ("CSG" in ARCHITECTURE.md, sections 3.4 and 4.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Savings {
    /// Parts are clipped to where they matter: the boxes of products (3.4.1).
    pub boxes: bool,
    /// Counting ends at the first depth at which the model holds (4.2.3); if not, it goes on to the last.
    pub early: bool,
    /// What is seen is taken from the span before where what is in front has not changed (4.3.1).
    pub spans: bool,
    /// Crossings behind the visible face end no span (4.3.2).
    pub hidden: bool,
    /// What is seen is taken from the scanline above where that is alike (3.4.2, b1 to b4).
    pub lines: bool,
}

impl Default for Savings {
    fn default() -> Savings {
        Savings { boxes: true, early: true, spans: true, hidden: true, lines: true }
    }
}

impl Savings {
    /// The five switches as bits, the first the lowest.
    pub fn from_bits(bits: u32) -> Savings {
        let on = |switch: u32| bits >> switch & 1 == 1;
        Savings { boxes: on(0), early: on(1), spans: on(2), hidden: on(3), lines: on(4) }
    }
}
