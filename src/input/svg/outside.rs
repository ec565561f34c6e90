//! References that lead out of the document, or nowhere in it: never followed, each named in a warning with the element that makes it.
//!
//! They stand in `href` and in the `url()` of a property, whether an attribute, a `style` or a rule sets it; for those of style sheets themselves see
//! [`super::sheet`]. Links that a reader may click on (`a`), scripts and cursors draw nothing and are left alone.

use usvg::roxmltree::{Document, Node};

use super::notes::{Notes, element};
use super::references::Missing;
use super::style::Styles;
use super::{href, is_svg};
use crate::scene::quoted;

/// Notes all of them.
pub(super) fn note<'a>(xml: &'a Document<'_>, styles: &Styles<'a>, missing: &Missing, notes: &mut Notes) {
    for (node, words) in missing.iter().filter_map(|(node, words)| Some((xml.get_node(*node)?, words))) {
        notes.add_at(node.range().start, element(node), words);
    }
    for node in xml.root().children() {
        let Some(pi) = node.pi().filter(|pi| pi.target == "xml-stylesheet") else { continue };
        add(node, "the style sheet ", pi.value.unwrap_or_default(), notes);
    }
    let properties = urls(xml.input_text()).any(|url| !url.starts_with('#'));
    for node in xml.descendants().filter(|n| is_svg(*n)) {
        let name = node.tag_name().name();
        if let Some(address) = href(node).map(str::trim).filter(|_| !matches!(name, "a" | "script")) {
            // The images themselves are warned about.
            let image = matches!(name, "image" | "feImage") && address.starts_with("data:");
            if !address.starts_with('#') && !image {
                add(node, "", address, notes);
            }
        }
        if properties {
            styles.of(node, |property, value| {
                // What stands in `style` comes declaration by declaration too.
                let outside = urls(value).filter(|url| !url.starts_with('#') && !matches!(property, "style" | "cursor"));
                outside.for_each(|url| add(node, "", url, notes));
            });
        }
    }
}

/// Notes an address that is not read.
pub(super) fn add(node: Node<'_, '_>, what: &str, address: &str, notes: &mut Notes) {
    let (start, element) = (node.range().start, element(node));
    if address.starts_with("data:") {
        notes.add_at(start, element, format!("{what}{} is a document of its own and not read", quoted(address)));
    } else {
        notes.add_outside(start, element, format!("{what}{} is outside the document and not read", quoted(address)));
    }
}

/// What stands in the `url()` of a text, empty ones left out.
pub(super) fn urls(text: &str) -> impl Iterator<Item = &str> {
    let opens = text.match_indices('(').map(|(at, _)| at).filter(|&at| at >= 3 && text.as_bytes()[at - 3..at].eq_ignore_ascii_case(b"url"));
    opens.map(|at| string(&text[at + 1..], ')')).filter(|url| !url.is_empty())
}

/// What a text begins with: a string in quotes, or all up to `end`.
pub(super) fn string(text: &str, end: char) -> &str {
    let text = text.trim_start();
    let quote = text.chars().next().filter(|c| matches!(c, '"' | '\''));
    let inside = quote.map_or(text, |_| &text[1..]);
    inside.split(quote.unwrap_or(end)).next().unwrap_or_default().trim()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn urls_are_found_in_all_their_forms() {
        let found: Vec<&str> = urls("red url(#a) URL( 'x)y' ) url(\"b.svg#c\") curl(d) url() url(é").collect();
        assert_eq!(found, ["#a", "x)y", "b.svg#c", "d", "é"]);
    }
}
