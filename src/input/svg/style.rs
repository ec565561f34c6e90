//! The style sheets of a document, as far as they refer to other elements, make them transparent, or ask for what is not drawn.
//!
//! `usvg` matches every rule with every element, and a descendant selector with every chain of ancestors; both are bounded here
//! before it begins. So is the parsing: `simplecss` counts lines and columns anew, from the first byte on, at the end of every value.

use simplecss::{AttributeOperator, Declaration, DeclarationTokenizer, Element, PseudoClass, StyleSheet};
use svgtypes::{Length, LengthUnit};
use usvg::roxmltree::{Document, Node};

use super::{attribute, unsupported};
use crate::error::{Error, Kind, Result};

/// Most steps of matching rules with elements.
const STEPS: u64 = 1 << 30;

/// Most steps of parsing; see [`parsing`].
const PARSING: u64 = 1 << 31;

/// Steps that it takes to match a rule with an element, besides those for its attributes.
const MATCH: u64 = 8;

/// Most declarations after those of `a, b { … }` are given to `a` and to `b`.
const DECLARATIONS: usize = 1 << 22;

/// Longest selector, in elements.
const SELECTOR: usize = 32;

/// The style sheets.
pub(super) struct Styles<'a>(StyleSheet<'a>);

impl<'a> Styles<'a> {
    /// Reads the `style` elements of a document with so many elements, nested so deep. Only rules in which a declaration has a
    /// `url()`, sets an opacity or a transform, or asks for what is not drawn are kept.
    ///
    /// # Errors
    /// A limit.
    pub(super) fn read(xml: &'a Document<'_>, elements: u64, depth: u64) -> Result<Styles<'a>> {
        let is_css = |n: &Node<'_, '_>| n.has_tag_name("style") && matches!(n.attribute("type"), None | Some("text/css"));
        let texts: Vec<&str> = xml.descendants().filter(is_css).filter_map(|n| n.text()).collect();
        let copies = texts.iter().flat_map(|t| t.split('}')).map(|block| {
            let (selectors, declarations) = block.split_once('{').unwrap_or((block, ""));
            (selectors.matches(',').count() + 1).saturating_mul(declarations.matches(';').count() + 1)
        });
        let refuse = || Err(Error::input(Kind::Limit, "style sheets too large for so many elements: use fewer and simpler rules"));
        let own = xml.descendants().filter_map(|n| attribute(n, "style"));
        let parsed: u64 = texts.iter().copied().chain(own).map(parsing).sum();
        if copies.fold(0, usize::saturating_add) > DECLARATIONS || parsed > PARSING {
            return refuse();
        }
        let mut sheet = StyleSheet::new();
        let mut steps = 0_u64;
        for text in texts {
            sheet.parse_more(text);
            // All rules are sorted anew.
            steps = steps.saturating_add(32 * sheet.rules.len() as u64);
            if steps > STEPS {
                return refuse();
            }
        }
        let all = sheet.rules.iter().any(|r| r.selector.to_string().contains('['));
        let attributes = xml.descendants().flat_map(|n| n.attributes()).filter(|a| all || a.name() == "class");
        let compared = attributes.map(|a| a.value().len() as u64).sum::<u64>() + elements * MATCH;
        for rule in &sheet.rules {
            let selector = rule.selector.to_string();
            let signs = selector.split_whitespace().filter(|w| matches!(*w, ">" | "+")).count();
            let joints = selector.split_whitespace().count() - 1;
            if joints - signs > SELECTOR {
                return refuse();
            }
            let descendants = joints.saturating_sub(2 * signs) as u32;
            steps = steps.saturating_add(compared.saturating_mul(depth.saturating_pow(descendants)));
        }
        if steps > STEPS {
            return refuse();
        }
        let telling = |d: &Declaration<'_>| {
            d.value.contains("url(")
                || d.name.ends_with("opacity")
                || d.name == "transform"
                || unsupported::of_declaration(d.name, d.value).is_some()
        };
        sheet.rules.retain(|r| r.declarations.iter().any(telling));
        Ok(Styles(sheet))
    }

    /// The value that counts among those that rules and the `style` attribute of an element declare.
    pub(super) fn declaration(&self, node: Node<'a, '_>, property: &str) -> Option<&'a str> {
        let mut found = None;
        let mut important = false;
        let mut declare = |d: &Declaration<'a>| {
            if d.name == property && !important {
                (found, important) = (Some(d.value), d.important);
            }
        };
        self.rules(node).for_each(&mut declare);
        let own = attribute(node, "style").filter(|style| style.contains(property));
        own.into_iter().flat_map(DeclarationTokenizer::from).for_each(|d| declare(&d));
        found
    }

    /// An opacity as the element itself has it, by one of its properties; none where it says nothing that can be understood.
    pub(super) fn opacity(&self, node: Node<'a, '_>, property: &str) -> Option<f32> {
        match self.declaration(node, property).or_else(|| attribute(node, property))?.parse().ok()? {
            Length { number, unit: LengthUnit::Percent } => Some((number as f32 / 100.0).clamp(0.0, 1.0)),
            Length { number, unit: LengthUnit::None } => Some((number as f32).clamp(0.0, 1.0)),
            _ => None,
        }
    }

    /// The declarations of the rules that apply to an element.
    fn rules(&self, node: Node<'a, '_>) -> impl Iterator<Item = &Declaration<'a>> {
        self.0.rules.iter().filter(move |r| r.selector.matches(&Styled(node))).flat_map(|r| &r.declarations)
    }

    /// Calls `see` with name and value of what rules and the `style` attribute of an element declare, that one roughly.
    pub(super) fn declared(&self, node: Node<'a, '_>, mut see: impl FnMut(&str, &'a str)) {
        self.rules(node).for_each(|d| see(d.name, d.value));
        let own = attribute(node, "style").into_iter().flat_map(|style| style.split(';')).filter_map(|d| d.split_once(':'));
        own.for_each(|(name, value)| see(name.trim(), value.trim_end().trim_end_matches("!important").trim()));
    }

    /// Calls `see` with name and value of everything that styles an element: attributes, rules, the `style` attribute.
    pub(super) fn of(&self, node: Node<'a, '_>, mut see: impl FnMut(&str, &'a str)) {
        node.attributes().filter(|a| a.namespace().is_none()).for_each(|a| see(a.name(), a.value()));
        let mut declare = |d: &Declaration<'a>| see(d.name, d.value);
        self.rules(node).for_each(&mut declare);
        attribute(node, "style").into_iter().flat_map(DeclarationTokenizer::from).for_each(|d| declare(&d));
    }
}

/// Steps of parsing a style sheet or a `style` attribute, about a nanosecond each: where a word ends that might go on, `simplecss` looks for its place, from
/// the first byte on for the line (sixteen bytes at once) and from the start of the line for the column.
fn parsing(text: &str) -> u64 {
    let (mut steps, mut column, mut before) = (0, 0, b' ');
    for (offset, b) in (0_u64..).zip(text.bytes()) {
        column = if b == b'\n' { 0 } else { column + 1 };
        let ends = match b {
            b'0'..=b'9' | b'A'..=b'Z' | b'a'..=b'z' | b'_' | b':' | 0x80.. => false,
            b'-' => !before.is_ascii_alphabetic(),
            _ => !b.is_ascii_whitespace() || before.is_ascii_alphanumeric(),
        };
        steps += if ends { column + offset / 16 } else { 0 };
        before = b;
    }
    steps
}

/// An element as selectors see it, in the same way as `usvg` has it.
struct Styled<'a, 'i>(Node<'a, 'i>);

impl Element for Styled<'_, '_> {
    fn parent_element(&self) -> Option<Self> {
        self.0.parent_element().map(Styled)
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.0.prev_sibling_element().map(Styled)
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.0.tag_name().name() == name
    }

    fn attribute_matches(&self, name: &str, operator: AttributeOperator<'_>) -> bool {
        self.0.attribute(name).is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, class: PseudoClass<'_>) -> bool {
        class == PseudoClass::FirstChild && self.0.prev_sibling_element().is_none()
    }
}
