//! Two lists of ranges along one scanline, walked at once.

use std::ops::Range;

/// What covers a range of columns.
pub(super) trait Columns {
    /// Those columns, at least one.
    fn columns(&self) -> Range<u32>;
}

/// Hands out columns, from left to right, on which each of two lists has one item or none, and at least one of them has one. Both are sorted, and no items of one list overlap.
pub(super) fn beside<'a, A: Columns, B: Columns>(
    one: &'a [A],
    other: &'a [B],
    mut take: impl FnMut(Range<u32>, Option<&'a A>, Option<&'a B>),
) {
    let (mut i, mut j, mut x) = (0, 0, 0);
    while i < one.len() || j < other.len() {
        let (a, b) = (one.get(i), other.get(j));
        let ((a, until), (b, also)) = (from(a, x), from(b, x));
        let end = until.min(also);
        if a.is_some() || b.is_some() {
            take(x..end, a, b);
        }
        x = end;
        i += usize::from(a.is_some() && until == x);
        j += usize::from(b.is_some() && also == x);
    }
}

/// What an item covers at a column, and up to where that is so.
fn from<T: Columns>(item: Option<&T>, column: u32) -> (Option<&T>, u32) {
    match item.map(|item| (item, item.columns())) {
        Some((item, columns)) if columns.start <= column => (Some(item), columns.end),
        Some((_, columns)) => (None, columns.start),
        None => (None, u32::MAX),
    }
}

impl Columns for Range<u32> {
    fn columns(&self) -> Range<u32> {
        self.clone()
    }
}

impl Columns for crate::run::Run {
    fn columns(&self) -> Range<u32> {
        self.start..self.end
    }
}

impl Columns for super::spans::Span {
    fn columns(&self) -> Range<u32> {
        self.start..self.end
    }
}

impl Columns for super::spans::Stretch {
    fn columns(&self) -> Range<u32> {
        self.start..self.end
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn columns_have_what_covers_them(pieces in prop::collection::vec((0u32..4, 1u32..5), 0..8), more in prop::collection::vec((0u32..4, 1u32..5), 0..8)) {
            let ranges = |pieces: Vec<(u32, u32)>| {
                let place = |x: &mut u32, (gap, wide): (u32, u32)| {
                    *x += gap + wide;
                    Some(*x - wide..*x)
                };
                pieces.into_iter().scan(0, place).collect::<Vec<_>>()
            };
            let (one, other) = (ranges(pieces), ranges(more));
            let covering = |ranges: &[Range<u32>], x: u32| ranges.iter().position(|range| range.contains(&x));
            let mut got = vec![(None, None); 80];
            beside(&one, &other, |columns, a, b| {
                let place = |ranges: &[Range<u32>], item: Option<&Range<u32>>| item.and_then(|item| ranges.iter().position(|range| range == item));
                got[columns.start as usize..columns.end as usize].fill((place(&one, a), place(&other, b)));
            });
            for (x, got) in (0..80).zip(got) {
                prop_assert_eq!(got, (covering(&one, x), covering(&other, x)));
            }
        }
    }
}
