//! Columns of text, aligned by what the characters take up on a terminal.

use unicode_width::UnicodeWidthStr;

/// Widest cell that others are aligned with; what is wider pushes its row to the right.
const WIDEST: usize = 40;

/// Lines of `rows`, the columns two spaces apart; those for which `right` holds are flush right. The rows are asked for twice, so that none is kept.
pub fn table<const N: usize>(rows: impl Iterator<Item = [String; N]> + Clone, right: [bool; N]) -> String {
    let mut widths = [0; N];
    for row in rows.clone() {
        for (width, cell) in widths.iter_mut().zip(&row) {
            *width = cell.width().min(WIDEST).max(*width);
        }
    }
    let mut text = String::new();
    for row in rows {
        let start = text.len();
        for ((cell, width), right) in row.iter().zip(widths).zip(right) {
            let space = std::iter::repeat_n(' ', width.saturating_sub(cell.width()));
            if right {
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
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_characters_take_two_columns() {
        let rows = [["名前", "1"], ["abcde", "22"]].map(|row| row.map(str::to_owned));
        assert_eq!(table(rows.iter().cloned(), [false, true]), "名前    1\nabcde  22\n");
    }

    #[test]
    fn a_very_long_cell_does_not_move_the_others() {
        let rows = [["x".repeat(100), "1".to_owned()], ["y".to_owned(), "2".to_owned()]];
        assert_eq!(table(rows.iter().cloned(), [false, true]), format!("{}  1\ny{}  2\n", "x".repeat(100), " ".repeat(39)));
    }
}
