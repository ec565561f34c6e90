//! Columns of text, aligned by what the characters take up on a terminal.

use unicode_width::UnicodeWidthStr;

/// Widest cell that others are aligned with; what is wider pushes its row to the right.
const WIDEST: usize = 40;

/// A table of so many rows, the columns two spaces apart; those for which `right` holds are flush right. `write` adds the text of a row's cells to empty
/// ones; it is asked for each row twice, so that none is kept.
pub fn table<const N: usize>(rows: usize, right: [bool; N], write: impl Fn(usize, &mut [String; N])) -> String {
    let mut cells = [const { String::new() }; N];
    let mut cells_of = |row: usize, see: &mut dyn FnMut(&[String; N])| {
        cells.iter_mut().for_each(String::clear);
        write(row, &mut cells);
        see(&cells);
    };
    let mut widths = [0; N];
    for row in 0..rows {
        cells_of(row, &mut |cells| {
            for (width, cell) in widths.iter_mut().zip(cells) {
                *width = cell.width().min(WIDEST).max(*width);
            }
        });
    }
    let mut text = String::new();
    for row in 0..rows {
        cells_of(row, &mut |cells| line(&mut text, cells, &widths, &right));
    }
    text
}

/// Writes a number with two decimals, or in powers of ten where that would be long.
pub fn number(x: f64, text: &mut String) {
    if x.abs() >= 1e9 {
        text.push_str(&format!("{x:.6e}"));
        return;
    }
    let hundredths = (x * 100.0).round() as i64;
    if hundredths < 0 {
        text.push('-');
    }
    let [whole, rest] = [hundredths.unsigned_abs() / 100, hundredths.unsigned_abs() % 100];
    text.push_str(itoa::Buffer::new().format(whole));
    text.push_str(if rest < 10 { ".0" } else { "." });
    text.push_str(itoa::Buffer::new().format(rest));
}

fn line(text: &mut String, cells: &[String], widths: &[usize], right: &[bool]) {
    let start = text.len();
    for ((cell, width), right) in cells.iter().zip(widths).zip(right) {
        let space = std::iter::repeat_n(' ', width.saturating_sub(cell.width()));
        if *right {
            text.extend(space);
            text.push_str(cell);
        } else {
            text.push_str(cell);
            text.extend(space);
        }
        text.push_str("  ");
    }
    text.truncate(start + text[start..].trim_end().len());
    text.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_characters_take_two_columns() {
        let rows = [["名前", "1"], ["abcde", "22"]];
        assert_eq!(table(2, [false, true], |row, cells| *cells = rows[row].map(str::to_owned)), "名前    1\nabcde  22\n");
    }

    #[test]
    fn a_very_long_cell_does_not_move_the_others() {
        let rows = [["x".repeat(100), "1".to_owned()], ["y".to_owned(), "2".to_owned()]];
        let text = table(2, [false, true], |row, cells| cells.clone_from(&rows[row]));
        assert_eq!(text, format!("{}  1\ny{}  2\n", "x".repeat(100), " ".repeat(39)));
    }
}
