//! Section 2.2.2: every polygon scan-converted by itself into a mask that is kept, and the masks combined: as bitmaps of one bit a pixel
//! and as run-length images.
//!
//! Both take their polygons' scanlines from our own plain fill, so that only the way of combining differs.

use runset::job::Job;

/// A bitmap: 64 pixels to a word, the leftmost low.
pub struct Bitmap {
    words: Vec<u64>,
    row: usize,
}

impl Bitmap {
    /// A bitmap of a square page, all 0.
    pub fn new(side: u32) -> Bitmap {
        let row = (side as usize).div_ceil(64);
        Bitmap { words: vec![0; row * side as usize], row }
    }

    /// Becomes the mask of a fill.
    pub fn fill(&mut self, job: &Job) {
        self.words.fill(0);
        let mut rows = job.rows();
        while let Some(lines) = rows.next() {
            for y in lines.y..lines.y + lines.n {
                let row = &mut self.words[y as usize * self.row..][..self.row];
                for run in lines.runs {
                    set(row, run.start as usize, run.end as usize);
                }
            }
        }
    }

    /// Combines every word with the other's.
    pub fn combine(&mut self, other: &Bitmap, how: impl Fn(u64, u64) -> u64) {
        self.words.iter_mut().zip(&other.words).for_each(|(word, &with)| *word = how(*word, with));
    }

    /// Number of pixels set.
    pub fn pixels(&self) -> u64 {
        self.words.iter().map(|word| u64::from(word.count_ones())).sum()
    }
}

fn set(row: &mut [u64], start: usize, end: usize) {
    let (first, last) = (start / 64, (end - 1) / 64);
    let (head, tail) = (u64::MAX << (start % 64), u64::MAX >> (63 - (end - 1) % 64));
    if first == last {
        row[first] |= head & tail;
    } else {
        row[first] |= head;
        row[first + 1..last].fill(u64::MAX);
        row[last] |= tail;
    }
}

/// A run-length image: the columns at which every line changes, one line's behind the other's.
#[derive(Default)]
pub struct RunLength {
    columns: Vec<u32>,
    /// Where each line's columns end.
    ends: Vec<usize>,
}

impl RunLength {
    /// Becomes the mask of a fill.
    pub fn fill(&mut self, job: &Job) {
        self.columns.clear();
        self.ends.clear();
        let mut rows = job.rows();
        while let Some(lines) = rows.next() {
            for _ in 0..lines.n {
                self.columns.extend(lines.runs.iter().flat_map(|run| [run.start, run.end]));
                self.ends.push(self.columns.len());
            }
        }
    }

    fn line(&self, y: usize) -> &[u32] {
        let start = if y == 0 { 0 } else { self.ends[y - 1] };
        &self.columns[start..self.ends[y]]
    }

    /// Becomes the combination of two images, line by line, by merging their columns. Nothing is where neither is.
    pub fn combine(&mut self, a: &RunLength, b: &RunLength, how: impl Fn(bool, bool) -> bool) {
        self.columns.clear();
        self.ends.clear();
        for y in 0..a.ends.len() {
            let (a, b) = (a.line(y), b.line(y));
            let (mut i, mut j, mut inside) = (0, 0, false);
            while i < a.len() || j < b.len() {
                let column = a.get(i).copied().unwrap_or(u32::MAX).min(b.get(j).copied().unwrap_or(u32::MAX));
                i += usize::from(a.get(i) == Some(&column));
                j += usize::from(b.get(j) == Some(&column));
                let now = how(i % 2 == 1, j % 2 == 1);
                if now != inside {
                    self.columns.push(column);
                    inside = now;
                }
            }
            self.ends.push(self.columns.len());
        }
    }

    /// Number of pixels inside.
    pub fn pixels(&self) -> u64 {
        self.columns.chunks_exact(2).map(|run| u64::from(run[1] - run[0])).sum()
    }
}
