//! What the style sheets of a document ask for that is not read or not applied.

use usvg::roxmltree::{Document, Node};

use super::is_svg;
use super::notes::{Notes, element};
use super::outside::{self, string, urls};
use crate::scene::quoted;

/// Pseudo-classes that are understood, or never hold in a picture that stands still.
const PSEUDO_CLASSES: [&str; 6] = ["first-child", "link", "visited", "hover", "active", "focus"];

/// Notes it all.
pub(super) fn note(xml: &Document<'_>, notes: &mut Notes) {
    for node in xml.descendants().filter(|n| is_svg(*n) && n.tag_name().name() == "style") {
        let text = without_comments(node.text().unwrap_or_default());
        text.split('@').skip(1).for_each(|rule| note_rule(node, rule, notes));
        for selector in text.split('}').filter_map(|block| block.rsplit_once('{')).flat_map(|block| block.0.split(',')) {
            // Behind rules that have no block, or the head of one around it.
            let selector = selector.rsplit([';', '{']).next().unwrap_or_default().trim();
            if !selector.contains(['@', '[']) && selector.split(':').skip(1).any(|pseudo| !is_understood(pseudo)) {
                let what = format!("the selector {} is not understood: its rule is not applied", quoted(selector));
                notes.add_at(node.range().start, element(node), what);
            }
        }
    }
}

/// Notes a rule that begins with a sign of its own, which is left out here.
fn note_rule(node: Node<'_, '_>, rule: &str, notes: &mut Notes) {
    let keyword = rule.split(|c: char| !c.is_ascii_alphabetic() && c != '-').next().unwrap_or_default();
    match &*keyword.to_ascii_lowercase() {
        "import" => {
            let target = rule[keyword.len()..].split(';').next().unwrap_or_default();
            outside::add(node, "the style sheet ", urls(target).next().unwrap_or(string(target, ' ')), notes);
        }
        "font-face" => {
            let block = rule.split('}').next().unwrap_or_default();
            urls(block).filter(|url| !url.starts_with("data:")).for_each(|url| outside::add(node, "the font ", url, notes));
        }
        within @ ("media" | "supports" | "layer" | "container") => {
            notes.add_at(node.range().start, element(node), format!("rules under @{within} are not applied"));
        }
        _ => {}
    }
}

/// Whether a pseudo-class, and what may stand behind it, is one of [`PSEUDO_CLASSES`].
fn is_understood(pseudo: &str) -> bool {
    let name = pseudo.split(|c: char| !c.is_ascii_alphanumeric() && c != '-').next().unwrap_or_default();
    PSEUDO_CLASSES.contains(&name)
}

fn without_comments(text: &str) -> String {
    let mut parts = text.split("/*");
    let first = parts.next().unwrap_or_default();
    let others = parts.map(|part| part.split_once("*/").map_or("", |(_, rest)| rest));
    std::iter::once(first).chain(others).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_do_not_count() {
        assert_eq!(without_comments("a/*b*/c/*d/*e*/f/*g"), "acf");
    }
}
