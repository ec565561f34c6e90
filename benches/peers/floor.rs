//! Floors: what any engine has to do at least, measured beside it.

use std::hint::black_box;
use std::io::{self, Write};

use super::measure::Times;

/// Bytes of a batch that stays in the first-level cache.
const BATCH: usize = 64 << 10;

/// The least work of writing `rows` rows of `row_bytes` bytes in batches: every byte is set once.
pub fn set(rows: usize, row_bytes: usize, times: &mut Times) {
    batches(rows, row_bytes, times, |row| row.fill(black_box(0)));
}

/// The same when every row is copied from another.
pub fn copy(rows: usize, row_bytes: usize, times: &mut Times) {
    let source = vec![0x5a; row_bytes];
    batches(rows, row_bytes, times, |row| row.copy_from_slice(black_box(&source)));
}

fn batches(rows: usize, row_bytes: usize, times: &mut Times, mut make: impl FnMut(&mut [u8])) {
    let mut batch = vec![0; BATCH.max(row_bytes) / row_bytes * row_bytes];
    times.time(|| {
        let mut left = rows;
        while left > 0 {
            let take = left.min(batch.len() / row_bytes);
            let batch = &mut batch[..take * row_bytes];
            batch.chunks_exact_mut(row_bytes).for_each(&mut make);
            io::sink().write_all(black_box(batch)).expect("a sink takes everything");
            left -= take;
        }
    });
}

/// Clearing one byte a pixel of a page, as a mask begins.
pub fn clear(mask: &mut [u8], times: &mut Times) {
    times.time(|| black_box(&mut *mask).fill(0));
    black_box(mask);
}
