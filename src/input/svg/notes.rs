//! What is drawn but not supported: one warning for an element and a reason.

use std::fmt::Display;

use foldhash::HashSet;
use usvg::roxmltree::{Document, Node};

use super::style::Styles;
use super::{attribute, href, is_svg, unsupported};
use crate::error::{Place, Places, Warning};
use crate::scene::quoted;

/// Gathers warnings.
pub(super) struct Notes {
    notes: Vec<Note>,
    given: HashSet<String>,
}

struct Note {
    at: At,
    words: String,
    /// Whether it is about something outside the document.
    outside: bool,
}

/// Where the element begins that a note is about.
enum At {
    Byte(usize),
    Place(Place),
    /// Where the first of this id does.
    Id(String),
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
        let mut notes = Notes { notes: Vec::new(), given: HashSet::default() };
        notes.look(xml, styles);
        notes
    }

    /// Warns, once for equal words.
    pub(super) fn add(&mut self, element: Element<'_>, what: impl Display) {
        self.add_once(At::Id(element.id.to_owned()), format!("{}: {}", element.named(), what), false);
    }

    /// Warns of the element that begins at a byte, once for equal words.
    pub(super) fn add_at(&mut self, start: usize, element: Element<'_>, what: impl Display) {
        self.add_once(At::Byte(start), format!("{}: {}", element.named(), what), false);
    }

    /// Warns of something outside the document that the element which begins at a byte asks for, once for equal words.
    pub(super) fn add_outside(&mut self, start: usize, element: Element<'_>, what: impl Display) {
        self.add_once(At::Byte(start), format!("{}: {}", element.named(), what), true);
    }

    fn add_once(&mut self, at: At, words: String, outside: bool) {
        if self.given.insert(words.clone()) {
            self.notes.push(Note { at, words, outside });
        }
    }

    /// Finds the places of what is noted so far: from here on the text is not needed.
    pub(super) fn find_places(&mut self, text: &str) {
        let mut bytes: Vec<(usize, &mut At)> = Vec::new();
        for note in &mut self.notes {
            if let At::Byte(byte) = note.at {
                bytes.push((byte, &mut note.at));
            }
        }
        bytes.sort_unstable_by_key(|&(byte, _)| byte);
        let mut places = Places::new(text.as_bytes());
        bytes.into_iter().for_each(|(byte, at)| *at = At::Place(places.of_byte(byte)));
    }

    /// The warnings in the order of the document, those without a place behind the others. `first` tells where the first element of an id begins.
    pub(super) fn warnings(self, first: impl Fn(&str) -> Option<Place>) -> Vec<Warning> {
        let warning = |note: Note| {
            let place = match note.at {
                At::Byte(_) => None,
                At::Place(place) => Some(place),
                At::Id(id) => first(&id),
            };
            Warning { place, outside: note.outside, ..Warning::input(note.words) }
        };
        let mut warnings: Vec<Warning> = self.notes.into_iter().map(warning).collect();
        warnings.sort_by_key(|warning| warning.place.map_or((true, 0, 0), |place| (false, place.line, place.column)));
        warnings
    }

    fn look<'a>(&mut self, xml: &'a Document<'_>, styles: &Styles<'a>) {
        let used: HashSet<&str> = xml.descendants().filter(|n| n.has_tag_name("use")).filter_map(|n| href(n)?.strip_prefix('#')).collect();
        let mut drawn: Vec<bool> = Vec::new();
        for node in xml.descendants() {
            let parent = node.parent().is_none_or(|p| drawn[p.id().get_usize()]);
            drawn.push(attribute(node, "id").is_some_and(|id| used.contains(id)) || (parent && is_drawn(node)));
            if drawn[node.id().get_usize()] {
                self.see(node, styles);
                // What it holds is not drawn either, and goes without saying.
                drawn[node.id().get_usize()] = !is_svg(node) || unsupported::is_known(node);
            }
        }
    }

    fn see<'a>(&mut self, node: Node<'a, '_>, styles: &Styles<'a>) {
        if !is_svg(node) {
            return;
        }
        let mut words: Vec<String> = unsupported::of_element(node).into_iter().collect();
        let attributes = node.attributes().filter(|a| a.namespace().is_none());
        words.extend(attributes.filter_map(|a| unsupported::of_attribute(node, a.name(), a.value())));
        styles.declared(node, |name, value| words.extend(unsupported::of_declaration(name, value)));
        words.into_iter().for_each(|what| self.add_at(node.range().start, element(node), what));
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
