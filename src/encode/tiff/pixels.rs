//! What the pixels of a TIFF are, and the bytes of a row of them.

use super::super::rows;
use crate::run::{BLACK, Inks, Rgb, Run};

/// What a pixel is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pixels {
    /// A bit, 1 where there is ink.
    Bilevel,
    /// A byte, the grey of the ink or of paper.
    Gray,
    /// The index of the ink, from 1; paper is 0.
    Palette {
        /// Bits of a pixel, 4 or 8.
        depth: u32,
    },
    /// Red, green, blue.
    Rgb,
}

impl Pixels {
    /// The smallest that shows those inks.
    pub fn of(inks: &Inks) -> Pixels {
        match inks {
            Inks::Shaded { .. } => Pixels::Rgb,
            Inks::Listed(list) if list.iter().all(|&ink| ink == BLACK) => Pixels::Bilevel,
            Inks::Listed(list) if list.iter().all(|[r, g, b]| r == g && g == b) => Pixels::Gray,
            Inks::Listed(list) => match list.len() {
                ..=15 => Pixels::Palette { depth: 4 },
                16..=255 => Pixels::Palette { depth: 8 },
                _ => Pixels::Rgb,
            },
        }
    }

    /// Bits of a pixel.
    pub fn depth(self) -> u32 {
        match self {
            Pixels::Bilevel => 1,
            Pixels::Gray => 8,
            Pixels::Palette { depth } => depth,
            Pixels::Rgb => 24,
        }
    }

    /// Bytes of a row of so many pixels.
    pub fn row_bytes(self, width: u32) -> usize {
        (width as usize * self.depth() as usize).div_ceil(8)
    }

    /// What makes rows of that width.
    pub fn painter(self, inks: &Inks, width: u32) -> Painter {
        let values = match self {
            Pixels::Bilevel => vec![0, 1],
            Pixels::Gray => (0..=inks.end()).map(|pixel| inks.pixel(pixel)[0]).collect(),
            Pixels::Palette { .. } => (0..=255).collect(),
            Pixels::Rgb => Vec::new(),
        };
        Painter { pixels: self, width, values, colours: rows::Colours::new(inks), inks: inks.clone() }
    }
}

/// Makes bytes of the rows of a raster.
pub struct Painter {
    pixels: Pixels,
    width: u32,
    /// Of every pixel (0 is paper), but of RGB.
    values: Vec<u8>,
    colours: rows::Colours,
    inks: Inks,
}

impl Painter {
    /// Writes what changes over a row (`Shown`).
    pub fn paint(&self, changes: &[Run], row: &mut [u8]) {
        match self.pixels {
            Pixels::Rgb => self.colours.paint(row, changes),
            _ => rows::packed(row, self.pixels.depth(), changes, |pixel| self.value(pixel)),
        }
    }

    /// Hands out the bytes of a row, from left to right, each with how often it comes. Those that follow each other may be equal.
    pub fn bytes(&self, runs: &[Run], mut take: impl FnMut(u8, usize)) {
        match self.pixels {
            Pixels::Rgb => pieces(runs, self.width, |pixel, n| match self.inks.pixel(pixel) {
                [r, g, b] if r == g && g == b => take(r, 3 * n as usize),
                colour => (0..n).for_each(|_| colour.iter().for_each(|&byte| take(byte, 1))),
            }),
            _ => self.packed(runs, take),
        }
    }

    /// Hands out the differences between the bytes of a pixel and of the one before, in RGB, and elsewhere the bytes.
    pub fn predicted(&self, runs: &[Run], mut take: impl FnMut(u8, usize)) {
        if self.pixels != Pixels::Rgb {
            return self.packed(runs, take);
        }
        let mut before: Rgb = [0; 3];
        pieces(runs, self.width, |pixel, n| {
            let colour = self.inks.pixel(pixel);
            colour.iter().zip(before).for_each(|(byte, before)| take(byte.wrapping_sub(before), 1));
            if n > 1 {
                take(0, 3 * (n as usize - 1));
            }
            before = colour;
        });
    }

    /// [`Painter::bytes`] of pixels that share a byte, or fill it.
    fn packed(&self, runs: &[Run], mut take: impl FnMut(u8, usize)) {
        let depth = self.pixels.depth();
        let most = 8 / depth;
        // Pixels of a byte that is not full.
        let (mut byte, mut held) = (0, 0);
        let low = |pixels: u32| (0xff_u16 >> (pixels * depth)) as u8;
        pieces(runs, self.width, |pixel, n| {
            let pattern = rows::spread(depth, self.value(pixel));
            let first = n.min((most - held) % most);
            byte |= pattern & low(held) & !low(held + first);
            held += first;
            if held == most {
                take(byte, 1);
                (byte, held) = (0, 0);
            }
            let rest = n - first;
            if rest >= most {
                take(pattern, (rest / most) as usize);
            }
            if !rest.is_multiple_of(most) {
                held = rest % most;
                byte = pattern & !low(held);
            }
        });
        if held > 0 {
            take(byte, 1);
        }
    }

    fn value(&self, pixel: u32) -> u8 {
        self.values[pixel as usize]
    }
}

/// Hands out the pixels of a row from left to right, each with how often it comes: 0 is paper, the inks count from 1.
fn pieces(runs: &[Run], width: u32, mut take: impl FnMut(u32, u32)) {
    let mut x = 0;
    for run in runs {
        if run.start > x {
            take(0, run.start - x);
        }
        take(run.ink + 1, run.end - run.start);
        x = run.end;
    }
    if x < width {
        take(0, width - x);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encode::changes::Shown;
    use proptest::prelude::*;

    proptest! {
        /// The row as its changes are painted over paper, and as bytes are counted from the runs.
        #[test]
        fn counted_bytes_are_those_of_the_painted_row(
            pieces in prop::collection::vec((1..40u32, prop_oneof![Just(None), (0..3u32).prop_map(Some)]), 1..20),
            inks in prop_oneof![
                Just(Inks::Listed(vec![BLACK])),
                Just(Inks::Listed(vec![BLACK, [7; 3], [200; 3]])),
                Just(Inks::Listed(vec![[1, 2, 3], [200; 3], BLACK])),
                Just(Inks::Listed((0..20).map(|i| [i, 0, 9]).collect())),
                Just(Inks::Listed((0..300).map(|i| [i as u8, (i >> 8) as u8, 9]).collect())),
                Just(Inks::Shaded { paper: [0, 0, 1] }),
            ],
        ) {
            let (mut runs, mut x): (Vec<Run>, u32) = (Vec::new(), 0);
            for (n, ink) in pieces {
                if let Some(ink) = ink.map(|ink| ink.min(inks.end() - 1)) {
                    match runs.last_mut() {
                        Some(last) if last.end == x && last.ink == ink => last.end += n,
                        _ => runs.push(Run { start: x, end: x + n, ink }),
                    }
                }
                x += n;
            }
            let pixels = Pixels::of(&inks);
            let (painter, mut shown) = (pixels.painter(&inks, x), Shown::new(x, pixels.depth()));
            let mut row = vec![0; pixels.row_bytes(x)];
            painter.paint(&[shown.paper()], &mut row);
            shown.show(&runs);
            painter.paint(shown.changes(), &mut row);
            let (mut bytes, mut predicted) = (Vec::new(), Vec::new());
            painter.bytes(&runs, |byte, n| bytes.extend(std::iter::repeat_n(byte, n)));
            painter.predicted(&runs, |byte, n| predicted.extend(std::iter::repeat_n(byte, n)));
            // What fills up the last byte is 0 in both: a row of paper is painted to the last pixel alone.
            prop_assert_eq!(&bytes, &row);
            if pixels == Pixels::Rgb {
                for i in 3..predicted.len() {
                    predicted[i] = predicted[i].wrapping_add(predicted[i - 3]);
                }
            }
            prop_assert_eq!(&predicted, &row);
        }
    }
}
