//! The tree of a model as text.

use runset::job::{ModelEntry, ModelInfo};

use super::table::{number, table};

/// Deepest indentation.
const DEEPEST: u32 = 12;

/// Primitives, faces and bounds of a model, and a row for every statement.
pub fn describe(info: &ModelInfo) -> String {
    let several = |n: u64, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    let mut text = format!("{}, {}", several(info.primitives, "primitive"), several(info.faces, "face"));
    match info.bounds {
        None => text.push_str(", empty\n"),
        Some([low, high]) => {
            for (word, point) in [(" from", low), (" to", high)] {
                text.push_str(word);
                for x in point {
                    text.push(' ');
                    number(x, &mut text);
                }
            }
            text.push('\n');
        }
    }
    if info.tree.is_empty() {
        return text + "no statements\n";
    }
    let heading = ["statement", "line", "faces", "x", "y", "z", "size", "color"];
    let right = [false, true, true, true, true, true, true, false];
    let cells = |i: usize, cells: &mut [String; 8]| match i.checked_sub(1) {
        Some(i) => row(&info.tree[i], cells),
        None => *cells = heading.map(str::to_owned),
    };
    text + "\n" + &table(1 + info.tree.len(), right, cells)
}

/// Adds what is told of a statement to empty cells: the least coordinates, and the size from there.
fn row(entry: &ModelEntry, [statement, line, faces, x, y, z, size, color]: &mut [String; 8]) {
    statement.extend(std::iter::repeat_n("  ", entry.depth.min(DEEPEST) as usize));
    statement.push_str(entry.kind);
    let whole = |n: Option<u64>, cell: &mut String| match n {
        Some(n) => cell.push_str(itoa::Buffer::new().format(n)),
        None => cell.push('-'),
    };
    whole(entry.line.map(u64::from), line);
    whole(entry.faces, faces);
    for (i, cell) in [x, y, z].into_iter().enumerate() {
        match entry.bounds {
            Some([low, _]) => number(low[i], cell),
            None => cell.push('-'),
        }
    }
    if let Some([low, high]) = entry.bounds {
        for i in 0..3 {
            size.push_str(if i > 0 { " x " } else { "" });
            number(high[i] - low[i], size);
        }
    } else {
        size.push('-');
    }
    color.push_str(entry.color.as_deref().unwrap_or("-"));
}
