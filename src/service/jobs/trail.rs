//! Where a raster whose length is not fixed can be taken up again: checkpoints at about equal distances, few enough to be kept; or the table of its format.

use crate::job::{Checkpoint, Table};

/// Checkpoints that are kept at most; past that every second is dropped.
const MOST: usize = 2048;

/// Bytes between two of them at least.
const DISTANCE: u64 = 64 << 10;

/// Checkpoints of one raster, in the order of their offsets, or its table.
#[derive(Clone, Debug, PartialEq)]
pub struct Trail {
    distance: u64,
    points: Vec<Checkpoint>,
    /// The table of a raster that has been measured, in formats that have one.
    pub table: Option<Table>,
}

impl Default for Trail {
    fn default() -> Trail {
        Trail { distance: DISTANCE, points: Vec::new(), table: None }
    }
}

impl Trail {
    /// Keeps a checkpoint if it is far enough behind those that are kept.
    pub fn add(&mut self, point: Checkpoint) {
        let far = self.points.last().is_none_or(|last| point.offset >= last.offset.saturating_add(self.distance));
        if !far || point.offset == 0 {
            return;
        }
        self.points.push(point);
        if self.points.len() > MOST {
            self.distance *= 2;
            let mut i = 0;
            self.points.retain(|_| {
                i += 1;
                i % 2 == 0
            });
        }
    }

    /// The last at or before a byte.
    pub fn before(&self, offset: u64) -> Option<Checkpoint> {
        let behind = self.points.partition_point(|point| point.offset <= offset);
        behind.checked_sub(1).map(|i| self.points[i])
    }

    /// As bytes for the store, little-endian: the distance, then offset, line and tally of each. Before that stands the table, if there is one: 0, which is no distance, its
    /// length, its numbers.
    pub fn to_bytes(&self) -> Vec<u8> {
        let table = self.table.iter().flat_map(|table| [0, table.len() as u64].into_iter().chain(table.iter().copied()));
        let numbers = self.points.iter().flat_map(|point| {
            let [a, b, c] = point.tally;
            [point.offset, point.line.into(), a, b, c]
        });
        table.chain([self.distance]).chain(numbers).flat_map(u64::to_le_bytes).collect()
    }

    /// What [`Trail::to_bytes`] made; an empty one of anything else.
    pub fn from_bytes(bytes: &[u8]) -> Trail {
        let (numbers, rest) = bytes.as_chunks::<8>();
        let numbers: Vec<u64> = numbers.iter().map(|number| u64::from_le_bytes(*number)).collect();
        let (table, numbers) = match &numbers[..] {
            [0, length, rest @ ..] => match usize::try_from(*length).ok().and_then(|length| rest.split_at_checked(length)) {
                Some((table, rest)) => (Some(Table::from(table)), rest),
                None => return Trail::default(),
            },
            numbers => (None, numbers),
        };
        let [distance, points @ ..] = numbers else { return Trail::default() };
        let (points, more) = points.as_chunks::<5>();
        let read = |&[offset, line, a, b, c]: &[u64; 5]| Some(Checkpoint { offset, line: u32::try_from(line).ok()?, tally: [a, b, c] });
        let points: Option<Vec<Checkpoint>> = points.iter().map(read).collect();
        match points {
            Some(points)
                if rest.is_empty() && more.is_empty() && points.is_sorted_by(|a, b| a.offset < b.offset) && *distance >= DISTANCE =>
            {
                Trail { distance: *distance, points, table }
            }
            _ => Trail::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(offset: u64) -> Checkpoint {
        Checkpoint { offset, line: (offset >> 10) as u32, tally: [offset, 1, 2] }
    }

    #[test]
    fn any_byte_has_a_checkpoint_near_before_it() {
        let mut trail = Trail::default();
        let step = 40_000;
        for i in 0..100_000 {
            trail.add(point(i * step));
        }
        assert!(trail.points.len() <= MOST && trail.points.len() > MOST / 4, "{}", trail.points.len());
        for offset in (0..100_000 * step).step_by(7_777_777) {
            let before = trail.before(offset).map_or(0, |point| point.offset);
            assert!(before <= offset && offset - before < 2 * trail.distance + step, "{offset} {before} {}", trail.distance);
        }
        assert_eq!(trail.before(DISTANCE / 2), None);
        assert_eq!(Trail::from_bytes(&trail.to_bytes()), trail);
    }

    #[test]
    fn what_is_no_trail_is_an_empty_one() {
        let mut trail = Trail::default();
        (1..5).for_each(|i| trail.add(point(i << 20)));
        for table in [None, Some(Table::from([5, u64::MAX, 0]))] {
            trail.table = table;
            let bytes = trail.to_bytes();
            assert_eq!(Trail::from_bytes(&bytes), trail);
            for cut in 0..bytes.len() {
                let read = Trail::from_bytes(&bytes[..cut]);
                assert!(trail.points.starts_with(&read.points) && (read.table.is_none() || read.table == trail.table), "{cut}");
            }
            let mut wrong = bytes;
            // The first offset, or the length of the table.
            wrong[8 + 7] = 0xff;
            assert_eq!(Trail::from_bytes(&wrong), Trail::default());
        }
    }
}
