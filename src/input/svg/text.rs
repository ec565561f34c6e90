//! Text: what is refused because it would take too long, and what is worth saying: fonts that are not there, styles that are not drawn,
//! characters that no font has.

use std::collections::BTreeSet;

use usvg::fontdb::{Database, Family, Query, Style, Weight};
use usvg::roxmltree::Document;
use usvg::{FontFamily, FontStyle, GlyphId};

use super::notes::{self, Element, Notes};
use crate::error::{Error, Kind, Result};
use crate::scene::quoted;

/// The glyph that stands for a missing one in every font.
const MISSING: GlyphId = GlyphId(0);

/// Most characters in a message.
const NAMED: usize = 8;

/// Most steps of laying text out: `usvg` takes some for every pair of bytes of a text, and [`SPAN`] times as many for a byte and a `tspan`.
const STEPS: u64 = 1 << 31;
const SPAN: u64 = 400;

/// Refuses text that would take too long to lay out.
pub(super) fn check(xml: &Document<'_>) -> Result<()> {
    let mut steps = 0_u64;
    for text in xml.descendants().filter(|n| n.tag_name().name() == "text") {
        let (mut bytes, mut spans) = (0, 0);
        for node in text.descendants() {
            bytes += node.text().filter(|_| node.is_text()).map_or(0, str::len) as u64;
            spans += u64::from(node.is_element());
        }
        steps = steps.saturating_add(bytes.saturating_mul(bytes + SPAN * spans));
        if steps > STEPS {
            let what = format!("{}: text too long to lay out: split it into several text elements", notes::element(text).named());
            return Err(Error::input(Kind::Limit, what).at_byte(xml.input_text().as_bytes(), text.range().start));
        }
    }
    Ok(())
}

/// Notes what differs from what a text asks for.
pub(super) fn note(text: &usvg::Text, fonts: &Database, element: Element<'_>, notes: &mut Notes) {
    for span in text.chunks().iter().flat_map(|chunk| chunk.spans()).filter(|span| span.is_visible()) {
        note_font(span.font(), fonts, element, notes);
    }
    let missing: BTreeSet<&str> =
        text.layouted().iter().flat_map(|span| &span.positioned_glyphs).filter(|g| g.id == MISSING).map(|g| g.text.as_str()).collect();
    if !missing.is_empty() {
        let named: Vec<String> = missing.iter().take(NAMED).map(|characters| character(characters)).collect();
        let more = if missing.len() > NAMED { format!(" and {} more", missing.len() - NAMED) } else { String::new() };
        notes.add(
            element,
            format!("no font has {}{more}: the font's sign for a missing character is drawn (add one with --font)", named.join(", ")),
        );
    }
}

fn note_font(font: &usvg::Font, fonts: &Database, element: Element<'_>, notes: &mut Notes) {
    let families: Vec<Family<'_>> = font.families().iter().map(family).collect();
    let query = |families: &[Family<'_>]| {
        let style = match font.style() {
            FontStyle::Normal => Style::Normal,
            FontStyle::Italic => Style::Italic,
            FontStyle::Oblique => Style::Oblique,
        };
        let id = fonts.query(&Query { families, weight: Weight(font.weight()), style, ..Query::default() })?;
        fonts.face(id)
    };
    let Some((name, face)) = query(&[families.as_slice(), &[Family::Serif]].concat()).and_then(|f| Some((&f.families.first()?.0, f)))
    else {
        return;
    };
    if let Some(Family::Name(asked)) = families.first().filter(|first| query(&[**first]).is_none()) {
        notes.add(element, format!("the font {} is not there: {} stands in (add it with --font)", quoted(asked), quoted(name)));
    }
    let bold = font.weight() >= Weight::SEMIBOLD.0 && face.weight.0 < Weight::SEMIBOLD.0;
    let italic = font.style() != FontStyle::Normal && face.style == Style::Normal;
    let lacks = match (bold, italic) {
        (false, false) => return,
        (true, false) => "bold",
        (false, true) => "italic",
        (true, true) => "bold italic",
    };
    notes.add(element, format!("{} has no {lacks} here: drawn without (add it with --font)", quoted(name)));
}

fn family(family: &FontFamily) -> Family<'_> {
    match family {
        FontFamily::Serif => Family::Serif,
        FontFamily::SansSerif => Family::SansSerif,
        FontFamily::Cursive => Family::Cursive,
        FontFamily::Fantasy => Family::Fantasy,
        FontFamily::Monospace => Family::Monospace,
        FontFamily::Named(name) => Family::Name(name),
    }
}

/// A character as people know it and as tables have it.
fn character(text: &str) -> String {
    let codes: Vec<String> = text.chars().take(4).map(|c| format!("U+{:04X}", c as u32)).collect();
    format!("{} ({})", quoted(text), codes.join(" "))
}
