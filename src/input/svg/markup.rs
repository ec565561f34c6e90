//! What is refused before the text reaches the XML parser, because that would take memory or time without measure.
//!
//! The parser reserves a node for every `<` and an attribute for every `=`, compares the attributes of an element each with each, and
//! writes entities out wherever they are referred to. One pass over the text counts all four.

use std::collections::HashMap;

use memchr::{memchr, memchr_iter, memmem};

use crate::error::{Error, Kind, Result};
use crate::scene::Limits;

/// Most tags, comments and the like.
const MARKUP: usize = 3_000_000;

/// Most attributes in a document.
const ATTRIBUTES: usize = 16_000_000;

/// Most attributes of one element.
const ATTRIBUTES_OF_ONE: usize = 512;

/// Refuses a text that is past one of the limits.
pub(super) fn check(text: &str, limits: &Limits) -> Result<()> {
    let refuse = |what: String| Err(Error::input(Kind::Limit, what));
    let count = |sign: u8| memchr_iter(sign, text.as_bytes()).count();
    if count(b'<') > MARKUP || count(b'=') > ATTRIBUTES {
        return refuse(format!("more than {MARKUP} tags or {ATTRIBUTES} attributes: split the drawing"));
    }
    let mut at = 0;
    while let Some(offset) = memchr(b'<', &text.as_bytes()[at..]).map(|i| at + i) {
        let rest = &text[offset..];
        let skip = |end: &str| memmem::find(rest.as_bytes(), end.as_bytes()).unwrap_or(rest.len());
        let length = if rest.starts_with("<!--") {
            skip("-->")
        } else if rest.starts_with("<![CDATA[") {
            skip("]]>")
        } else if rest.starts_with("<?") {
            skip("?>")
        } else if rest.starts_with("<!") {
            // A declaration may hold entities with elements in them: look inside.
            2
        } else {
            let (length, attributes) = tag(rest);
            if attributes > ATTRIBUTES_OF_ONE {
                return refuse(format!("an element with more than {ATTRIBUTES_OF_ONE} attributes: give it fewer"))
                    .map_err(|e| e.at_byte(text.as_bytes(), offset));
            }
            length
        };
        at = offset + length.max(1);
    }
    let work = entity_work(text);
    if work > limits.input {
        return refuse(format!("entities that expand to more than {} bytes: write them out", limits.input));
    }
    Ok(())
}

/// Length and number of attributes of the tag that `text` begins with.
fn tag(text: &str) -> (usize, usize) {
    let bytes = text.as_bytes();
    let (mut at, mut attributes) = (0, 0);
    while let Some(&byte) = bytes.get(at) {
        match byte {
            b'"' | b'\'' => at += 1 + memchr(byte, &bytes[at + 1..]).unwrap_or(bytes.len() - at - 1),
            b'=' => attributes += 1,
            b'>' => return (at, attributes),
            _ => {}
        }
        at += 1;
    }
    (bytes.len(), attributes)
}

/// Bytes that the references to entities expand to, with the look-up of each; an upper bound.
fn entity_work(text: &str) -> u64 {
    let mut entities: HashMap<&str, (u64, &str)> = HashMap::new();
    let keyword = "<!ENTITY";
    for i in memmem::find_iter(text.as_bytes(), keyword) {
        let rest = text[i + keyword.len()..].trim_start();
        let (name, rest) = rest.split_at(rest.find(|c: char| c.is_whitespace() || c == '"' || c == '\'').unwrap_or(rest.len()));
        let Some(quote) = rest.trim_start().chars().next().filter(|c| matches!(c, '"' | '\'')) else { continue };
        let value = rest.trim_start()[1..].split(quote).next().unwrap_or_default();
        // Of several of one name the parser takes the first, here the longest counts.
        let entry = entities.entry(name).or_default();
        if value.len() >= entry.1.len() {
            *entry = (value.len() as u64, value);
        }
    }
    if entities.is_empty() {
        return 0;
    }
    let lookup = entities.len() as u64;
    let expanded = |text: &str, sizes: &HashMap<&str, (u64, &str)>| {
        let names = text.split('&').skip(1).filter_map(|rest| rest.split_once(';').map(|(name, _)| name));
        names.filter_map(|name| sizes.get(name)).fold(0_u64, |sum, (size, _)| sum.saturating_add(lookup.saturating_add(*size)))
    };
    // Entities nest at most ten deep, the parser sees to that.
    for _ in 0..10 {
        let next =
            entities.iter().map(|(&name, &(_, value))| (name, (expanded(value, &entities).saturating_add(value.len() as u64), value)));
        entities = next.collect();
    }
    expanded(text, &entities)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entities_are_counted_as_often_as_they_are_written() {
        let text = r#"<!DOCTYPE svg [<!ENTITY a "0123456789"> <!ENTITY b '&a;&a;'>]><svg x="&a;">&b;&amp;&b;</svg>"#;
        // b is 6 + 2 (10 + 2), and each of the five looks through two; those in the declaration of b count once more.
        assert_eq!(entity_work(text), (10 + 2) + 2 * (6 + 24 + 2) + 2 * (10 + 2));
        assert_eq!(entity_work("<svg>&a;</svg>"), 0);
    }

    #[test]
    fn what_only_looks_like_attributes_is_not() {
        let many = "=".repeat(5000);
        for text in [format!("<!-- <{many} -->"), format!("<![CDATA[<{many}]]>"), format!("<a b='{many}'/>"), format!("<a/>{many}")] {
            assert!(check(&text, &Limits::default()).is_ok());
        }
        assert_eq!(tag("<a b = \"1>2\" c='='>x"), (18, 2));
        let error = check(&format!("<svg>\n<a {}/>", "b='' ".repeat(5000)), &Limits::default()).unwrap_err();
        assert_eq!(error.to_string(), "2:1: an element with more than 512 attributes: give it fewer");
    }
}
