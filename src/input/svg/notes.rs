//! What is drawn but not supported: one warning for an element and a reason.

use std::collections::{HashMap, HashSet};

use usvg::roxmltree::{Document, Node};

use super::style::Styles;
use super::{attribute, href, is_svg, unsupported};
use crate::error::{Place, Places, Warning};
use crate::scene::quoted;

/// Gathers warnings.
pub(super) struct Notes {
    /// Where the elements with ids begin, in bytes; of equal ids the first.
    starts: HashMap<String, usize>,
    /// Where the element begins that a note is about, if that is known.
    notes: Vec<(Option<usize>, String)>,
    given: HashSet<(String, String)>,
    /// The places of bytes, in the text's order.
    places: Vec<(usize, Place)>,
}

/// An element in a message: by its id, or by the nearest ancestor that has one.
#[derive(Clone, Copy)]
pub(super) struct Element<'a> {
    /// Empty if there is none at all.
    pub(super) id: &'a str,
    pub(super) own: bool,
}

impl Element<'_> {
    pub(super) fn named(self) -> String {
        match self {
            Element { id: "", .. } => "an element without an id".to_owned(),
            Element { id, own: true } => quoted(id),
            Element { id, own: false } => format!("an element in {}", quoted(id)),
        }
    }
}

/// How a node is named.
pub(super) fn element<'a>(node: Node<'a, '_>) -> Element<'a> {
    let mut named = node.ancestors().filter_map(|n| attribute(n, "id").map(|id| Element { id, own: n == node }));
    named.next().unwrap_or(Element { id: "", own: false })
}

impl Notes {
    /// Notes what `usvg` leaves out without a word, images above all.
    pub(super) fn read<'a>(xml: &'a Document<'_>, styles: &Styles<'a>) -> Notes {
        let ids = xml.descendants().filter_map(|n| Some((attribute(n, "id")?, n.range().start)));
        let mut starts = HashMap::new();
        ids.for_each(|(id, start)| _ = starts.entry(id.to_owned()).or_insert(start));
        let mut notes = Notes { starts, notes: Vec::new(), given: HashSet::new(), places: Vec::new() };
        notes.look(xml, styles);
        notes
    }

    /// Warns, once for equal words.
    pub(super) fn add(&mut self, element: Element<'_>, what: impl Into<String>) {
        self.add_at(self.starts.get(element.id).copied(), element, what);
    }

    /// Warns of the element that begins at a byte, once for equal words.
    pub(super) fn add_at(&mut self, start: Option<usize>, element: Element<'_>, what: impl Into<String>) {
        let (element, what) = (element.named(), what.into());
        if self.given.insert((element.clone(), what.clone())) {
            self.notes.push((start, format!("{element}: {what}")));
        }
    }

    /// Finds the places of all elements with ids and of what is noted already: from here on the text is not needed.
    pub(super) fn find_places(&mut self, text: &str) {
        let mut bytes: Vec<usize> = self.starts.values().copied().chain(self.notes.iter().filter_map(|note| note.0)).collect();
        bytes.sort_unstable();
        bytes.dedup();
        let mut places = Places::new(text.as_bytes());
        self.places = bytes.into_iter().map(|byte| (byte, places.of_byte(byte))).collect();
    }

    /// The warnings in the order of the document, those without a place behind the others.
    pub(super) fn warnings(mut self) -> Vec<Warning> {
        self.notes.sort_by_key(|(start, _)| start.unwrap_or(usize::MAX));
        let place = |byte| self.places.binary_search_by_key(&byte, |place| place.0).ok().map(|i| self.places[i].1);
        let warning = |(start, what): (Option<usize>, String)| Warning { place: start.and_then(place), ..Warning::input(what) };
        self.notes.into_iter().map(warning).collect()
    }

    fn look<'a>(&mut self, xml: &'a Document<'_>, styles: &Styles<'a>) {
        let used: HashSet<&str> = xml.descendants().filter(|n| n.has_tag_name("use")).filter_map(|n| href(n)?.strip_prefix('#')).collect();
        let mut drawn: Vec<bool> = Vec::new();
        for node in xml.descendants() {
            let parent = node.parent().is_none_or(|p| drawn[p.id().get_usize()]);
            drawn.push(attribute(node, "id").is_some_and(|id| used.contains(id)) || (parent && is_drawn(node)));
            if drawn[node.id().get_usize()] {
                self.see(node, styles);
            }
        }
    }

    fn see<'a>(&mut self, node: Node<'a, '_>, styles: &Styles<'a>) {
        if !is_svg(node) {
            return;
        }
        let mut words: Vec<String> = unsupported::of_element(node).into_iter().collect();
        let attributes = node.attributes().filter(|a| a.namespace().is_none());
        words.extend(attributes.filter_map(|a| unsupported::of_property(a.name(), a.value())));
        styles.declared(node, |name, value| words.extend(unsupported::of_declaration(name, value)));
        words.into_iter().for_each(|what| self.add_at(Some(node.range().start), element(node), what));
    }
}

/// Whether an element is drawn where it stands, if its parent is.
fn is_drawn(node: Node<'_, '_>) -> bool {
    let hidden = matches!(node.tag_name().name(), "defs" | "symbol" | "clipPath" | "mask" | "pattern" | "marker");
    // A branch of a switch for programs that know an extension.
    let foreign = attribute(node, "requiredExtensions").is_some();
    !hidden && !foreign && !is_styled(node, "display", "none")
}

/// Whether an attribute of an element or its `style` sets a property to that value.
fn is_styled(node: Node<'_, '_>, property: &str, value: &str) -> bool {
    let declared = |d: &str| d.split_once(':').is_some_and(|(p, v)| p.trim() == property && v.trim() == value);
    attribute(node, property).is_some_and(|v| v.trim() == value)
        || attribute(node, "style").is_some_and(|style| style.split(';').any(declared))
}
