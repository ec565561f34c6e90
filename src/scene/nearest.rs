//! The known names nearest to one that is unknown.
//!
//! Nearness is the edit distance (Levenshtein: insertions, deletions, substitutions of one character), over the first
//! [`COMPARED`] characters. The third best so far bounds the search, so tens of thousands of names cost milliseconds.

use super::BUILT_IN;
use super::token::written;

/// How many characters of a name are looked at.
const COMPARED: usize = 48;

/// How many names are given.
const GIVEN: usize = 3;

/// The ids and built-in names nearest to `id`, as they are written in an expression: best first, at most three; of equally near
/// ones those that come first, the built-in ones last.
pub(super) fn nearest<'a>(id: &str, ids: impl Iterator<Item = &'a str>) -> Vec<String> {
    let wanted: Vec<char> = id.chars().take(COMPARED).collect();
    let mut best: Vec<(usize, &str, bool)> = Vec::new();
    let mut name = Vec::new();
    let mut row = Vec::new();
    for (known, built_in) in ids.map(|id| (id, false)).chain(BUILT_IN.map(|word| (word, true))) {
        name.clear();
        name.extend(known.chars().take(COMPARED));
        let bound = if best.len() < GIVEN { usize::MAX } else { best[GIVEN - 1].0 };
        if let Some(distance) = distance_below(bound, &wanted, &name, &mut row) {
            best.truncate(GIVEN - 1);
            let place = best.partition_point(|b| b.0 <= distance);
            best.insert(place, (distance, known, built_in));
        }
    }
    best.into_iter().map(|(_, known, built_in)| if built_in { known.to_owned() } else { written(known) }).collect()
}

/// The edit distance of `a` and `b`, if it is less than `bound`. `row` is scratch space.
fn distance_below(bound: usize, a: &[char], b: &[char], row: &mut Vec<usize>) -> Option<usize> {
    if a.len().abs_diff(b.len()) >= bound {
        return None;
    }
    row.clear();
    row.extend(0..=b.len());
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = i;
        let mut smallest = i + 1;
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(diagonal + 1).min(row[j] + 1);
            smallest = smallest.min(row[j + 1]);
        }
        if smallest >= bound {
            return None;
        }
    }
    Some(row[b.len()]).filter(|&d| d < bound)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_levenshtein_s() {
        for (a, b, d) in [("kitten", "sitting", 3), ("", "abc", 3), ("flaw", "lawn", 2), ("Ü", "U", 1), ("same", "same", 0)] {
            let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
            assert_eq!(distance_below(usize::MAX, &a, &b, &mut Vec::new()), Some(d));
            assert_eq!(distance_below(d, &a, &b, &mut Vec::new()), None);
            assert_eq!(distance_below(d + 1, &a, &b, &mut Vec::new()), Some(d));
        }
    }

    #[test]
    fn best_first_then_in_order() {
        assert_eq!(nearest("logo", ["frame", "Logo 2", "logos", "logo1", "lugo"].into_iter()), ["logos", "logo1", "lugo"]);
        assert_eq!(nearest("pag", ["x", "page"].into_iter()), ["\"page\"", "page", "x"]);
        assert_eq!(nearest("x", [].into_iter()), ["art", "page"]);
    }

    #[test]
    fn long_names_and_many_names_are_cheap() {
        let names: Vec<String> = (0..50_000).map(|i| format!("path{i}-some-longer-name-that-goes-on-and-on-{i}")).collect();
        let wanted = "path".repeat(10 << 18);
        let start = std::time::Instant::now();
        assert_eq!(nearest(&wanted, names.iter().map(String::as_str)).len(), 3);
        assert!(start.elapsed().as_secs_f64() < 20.0);
    }
}
