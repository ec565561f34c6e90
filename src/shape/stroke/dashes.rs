//! Dash patterns: at which distances along a subpath a stroke begins and ends.
//!
//! Boundaries are computed from whole periods and never added up, so a pattern does not drift, and any place of it is found by one
//! division and one binary search: what lies beyond the page costs nothing.

/// A pattern with its phase.
#[derive(Debug)]
pub(super) struct Dashes {
    /// Where the dashes (even) and gaps (odd) of a period end.
    ends: Vec<f64>,
    pub(super) period: f64,
    /// Where in the pattern a subpath begins.
    pub(super) offset: f64,
}

/// A dash or a gap of a pattern.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor {
    /// Whole periods before it.
    cycle: f64,
    index: usize,
}

impl Dashes {
    /// None where SVG draws a solid line: no lengths, negative ones, or a sum of 0.
    pub(super) fn new(lengths: &[f64], offset: f64) -> Option<Dashes> {
        let twice = if lengths.len() % 2 == 1 { 2 } else { 1 };
        let mut period = 0.0;
        let ends = std::iter::repeat_n(lengths, twice).flatten().map(|length| {
            period += length;
            period
        });
        let ends: Vec<f64> = ends.collect();
        let valid = lengths.iter().all(|length| *length >= 0.0) && period > 0.0 && period.is_finite() && offset.is_finite();
        valid.then(|| Dashes { ends, period, offset: offset.rem_euclid(period) })
    }

    /// What lies at a place of the pattern; where two meet, the second, and of a dash without length the dash.
    pub(super) fn at(&self, place: f64) -> Cursor {
        let cycle = (place / self.period).floor();
        let within = place - cycle * self.period;
        let index = self.ends.partition_point(|end| *end < within);
        let start = if index == 0 { 0.0 } else { self.ends[index - 1] };
        let cursor = Cursor { cycle, index: index.min(self.ends.len() - 1) };
        let over = self.ends.get(index).is_none_or(|end| *end == within && start < within);
        if over { self.next(cursor) } else { cursor }
    }

    pub(super) fn next(&self, Cursor { cycle, index }: Cursor) -> Cursor {
        if index + 1 < self.ends.len() { Cursor { cycle, index: index + 1 } } else { Cursor { cycle: cycle + 1.0, index: 0 } }
    }

    /// About how many dashes and gaps a length has.
    pub(super) fn number(&self, length: f64) -> f64 {
        length / self.period * self.ends.len() as f64
    }

    /// Where it ends.
    pub(super) fn end(&self, cursor: Cursor) -> f64 {
        cursor.cycle * self.period + self.ends[cursor.index]
    }
}

impl Cursor {
    /// Whether it is a dash.
    pub(super) fn on(self) -> bool {
        self.index.is_multiple_of(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_of_a_pattern() {
        let dashes = Dashes::new(&[4.0, 2.0, 0.0, 1.0], -1.0).unwrap();
        assert_eq!(dashes.offset, 6.0);
        for (place, on, end) in [
            (0.0, true, 4.0),
            (3.9, true, 4.0),
            (4.0, false, 6.0),
            (5.0, false, 6.0),
            (6.5, false, 7.0),
            (7.0, true, 11.0),
            (700_004.0, false, 700_006.0),
        ] {
            let found = dashes.at(place);
            assert_eq!((found.on(), dashes.end(found)), (on, end), "{place}");
        }
        let dot = Dashes::new(&[0.0, 10.0], 0.0).unwrap();
        assert!(dot.at(0.0).on() && dot.at(20.0).on() && !dot.at(5.0).on());
    }

    #[test]
    fn an_odd_pattern_is_repeated() {
        let dashes = Dashes::new(&[3.0], 0.0).unwrap();
        assert_eq!([1.0, 4.0, 7.0].map(|place| dashes.at(place).on()), [true, false, true]);
    }

    #[test]
    fn what_is_no_pattern_is_solid() {
        for lengths in [&[][..], &[0.0], &[0.0, 0.0], &[1.0, -1.0], &[f64::NAN], &[f64::INFINITY], &[1e308, 1e308]] {
            assert!(Dashes::new(lengths, 0.0).is_none(), "{lengths:?}");
        }
        assert!(Dashes::new(&[1.0], f64::NAN).is_none());
    }
}
