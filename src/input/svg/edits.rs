//! A document rewritten as text: what changes is put in, all else is copied.

use std::ops::Range;

use usvg::roxmltree::{Attribute, Node};

/// A text with edits, made from front to back.
pub(super) struct Edits<'t> {
    text: &'t str,
    /// What takes the place of what.
    edits: Vec<(Range<usize>, String)>,
    /// Underscores, more in a row than the document has anywhere; empty until they are needed.
    blank: String,
    /// Whether they stand for a namespace.
    prefixed: bool,
    /// Which insertion was the last `style` attribute.
    styled: Option<usize>,
}

impl<'t> Edits<'t> {
    /// No edits yet.
    pub(super) fn new(text: &'t str) -> Edits<'t> {
        Edits { text, edits: Vec::new(), blank: String::new(), prefixed: false, styled: None }
    }

    /// Puts a text in the place of another.
    pub(super) fn replace(&mut self, place: Range<usize>, mut new: String) {
        // There are many, and at once.
        new.shrink_to_fit();
        self.edits.push((place, new));
    }

    fn insert(&mut self, at: usize, new: String) {
        self.replace(at..at, new);
    }

    /// A name, or a piece of one, that the document does not have.
    fn blank(&mut self) -> &str {
        if self.blank.is_empty() {
            let longest = self.text.split(|c| c != '_').map(str::len).max().unwrap_or(0);
            self.blank = "_".repeat(longest + 1);
        }
        &self.blank
    }

    /// Takes an id out of SVG. It keeps its name within another namespace, because style sheets look at the name alone.
    pub(super) fn rename(&mut self, id: Attribute<'_, '_>) {
        let prefix = format!("{}:", self.blank());
        self.prefixed = true;
        self.insert(id.range().start, prefix);
    }

    /// Gives an attribute a name that nobody looks for.
    pub(super) fn disguise(&mut self, attribute: Attribute<'_, '_>) {
        let suffix = self.blank().to_owned();
        self.insert(attribute.range_qname().end, suffix);
    }

    /// Puts declarations before those of an element's style; of one element twice at most, one after the other.
    pub(super) fn style(&mut self, node: Node<'_, '_>, declarations: &str) {
        if let Some(style) = node.attributes().find(|a| a.namespace().is_none() && a.name() == "style") {
            self.insert(style.range_value().start, declarations.to_owned());
            return;
        }
        let at = self.behind_name(node);
        if let Some(own) = self.styled.and_then(|i| self.edits.get_mut(i)).filter(|own| own.0.start == at) {
            own.1.insert_str(own.1.len() - 1, declarations);
        } else {
            self.styled = Some(self.edits.len());
            self.insert(at, format!(" style=\"{declarations}\""));
        }
    }

    /// Where the name of an element ends.
    fn behind_name(&self, node: Node<'_, '_>) -> usize {
        let start = node.range().start;
        let name = self.text[start..].find(|c: char| c.is_ascii_whitespace() || matches!(c, '/' | '>'));
        start + name.unwrap_or(0)
    }

    /// The new text; none if nothing was edited.
    pub(super) fn finish(mut self, root: Node<'_, '_>) -> Option<String> {
        if self.prefixed {
            self.insert(self.behind_name(root), format!(" xmlns:{}=\"urn:runset:duplicate\"", self.blank));
        }
        if self.edits.is_empty() {
            return None;
        }
        self.edits.sort_by_key(|(place, _)| place.start);
        let (removed, added) = self.edits.iter().fold((0, 0), |(removed, added), (place, new)| (removed + place.len(), added + new.len()));
        let mut text = String::with_capacity(self.text.len() + added - removed);
        let mut from = 0;
        for (place, new) in &self.edits {
            text.push_str(&self.text[from..place.start]);
            text.push_str(new);
            from = place.end;
        }
        text.push_str(&self.text[from..]);
        Some(text)
    }
}
