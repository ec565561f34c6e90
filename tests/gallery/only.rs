//! A document rewritten so that only one of its elements is painted: the second opinion on what an id stands for.
//!
//! Nothing is removed and nothing moves, so that selectors, bounding boxes and the flow of text stay as they are. `visibility` is inherited, also
//! through `use`: it is hidden at the root and given back to the element. What clips and masks keeps its own visibility, because it paints
//! nothing itself. For an element within a marker the shapes that carry markers stay visible, without fill and stroke.
//!
//! The files help: those that set `visibility` do so in attributes, and not on what is drawn in several places.

use std::collections::{HashMap, HashSet};

use usvg::roxmltree::{Attribute, Document, Node, NodeId, ParsingOptions};

const XLINK: &str = "http://www.w3.org/1999/xlink";

/// Elements that carry markers.
const SHAPES: [&str; 7] = ["path", "line", "polyline", "polygon", "rect", "circle", "ellipse"];

pub fn options<'a>() -> ParsingOptions<'a> {
    ParsingOptions { allow_dtd: true, ..ParsingOptions::default() }
}

/// The attribute of that name that has no namespace.
fn attribute<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Attribute<'a, 'i>> {
    node.attributes().find(|a| a.namespace().is_none() && a.name() == name)
}

fn value<'a>(node: Node<'a, '_>, name: &str) -> Option<&'a str> {
    attribute(node, name).map(|a| a.value())
}

fn is_svg(node: Node<'_, '_>) -> bool {
    node.is_element() && matches!(node.tag_name().namespace(), None | Some("http://www.w3.org/2000/svg"))
}

/// All ids of a document, in its order, each once.
pub fn ids(xml: &Document<'_>) -> Vec<String> {
    let mut seen = HashSet::new();
    let ids = xml.descendants().filter(|n| is_svg(*n)).filter_map(|n| value(n, "id"));
    ids.filter(|id| !id.is_empty() && seen.insert(*id)).map(str::to_owned).collect()
}

/// The document with nothing painted but the first element of that id.
pub fn painted(xml: &Document<'_>, id: &str) -> String {
    let element = by_id(xml, id).unwrap();
    let mut styles = Styles::default();
    if element == xml.root_element() {
        return xml.input_text().to_owned();
    }
    let marker = element.ancestors().find(|n| n.tag_name().name() == "marker");
    let kept = reached(element);
    let mut resources = HashSet::new();
    for node in xml.descendants().filter(|n| is_svg(*n)) {
        if matches!(node.tag_name().name(), "clipPath" | "mask" | "pattern" | "marker") {
            resources.extend(reached(node));
        }
    }
    for node in xml.descendants().filter(|n| is_svg(*n)) {
        let name = node.tag_name().name();
        if node == element {
            styles.set(node, "visibility", visibility(node));
        } else if node == xml.root_element() || (name == "marker" && marker.is_some()) {
            styles.set(node, "visibility", "hidden");
        } else if matches!(name, "clipPath" | "mask" | "pattern" | "marker") {
            styles.set(node, "visibility", visibility(node));
        } else if marker.is_some() && SHAPES.contains(&name) && !resources.contains(&node.id()) {
            ["fill", "stroke"].iter().for_each(|property| styles.set(node, property, "none"));
            styles.set(node, "visibility", visibility(node));
        } else if own_visibility(node).is_some() && !kept.contains(&node.id()) && !resources.contains(&node.id()) {
            styles.set(node, "visibility", "hidden");
        }
    }
    styles.write(xml)
}

fn by_id<'a, 'i>(xml: &'a Document<'i>, id: &str) -> Option<Node<'a, 'i>> {
    xml.descendants().find(|n| is_svg(*n) && value(*n, "id") == Some(id))
}

/// An element, what it holds, and what the `use` elements among them draw.
fn reached(from: Node<'_, '_>) -> HashSet<NodeId> {
    let mut reached = HashSet::new();
    let mut open = vec![from];
    while let Some(node) = open.pop() {
        if reached.insert(node.id()) {
            open.extend(node.children());
            let href = value(node, "href").or(node.attribute((XLINK, "href"))).filter(|_| node.tag_name().name() == "use");
            open.extend(href.and_then(|h| by_id(node.document(), h.strip_prefix('#')?)));
        }
    }
    reached
}

/// The visibility of an element where it stands.
fn visibility<'a>(node: Node<'a, '_>) -> &'a str {
    node.ancestors().find_map(own_visibility).unwrap_or("visible")
}

/// The visibility that an element sets itself.
fn own_visibility<'a>(node: Node<'a, '_>) -> Option<&'a str> {
    let declared = |d: &'a str| d.split_once(':').filter(|(property, _)| property.trim() == "visibility").map(|(_, value)| value.trim());
    let style = value(node, "style").and_then(|s| s.split(';').rev().find_map(declared));
    style.or(value(node, "visibility")).filter(|v| *v != "inherit")
}

/// Declarations to be put behind those of `style` attributes.
#[derive(Default)]
struct Styles(HashMap<NodeId, String>);

impl Styles {
    fn set(&mut self, node: Node<'_, '_>, property: &str, value: &str) {
        *self.0.entry(node.id()).or_default() += &format!(";{property}:{value}");
    }

    /// The text of the document with them.
    fn write(&self, xml: &Document<'_>) -> String {
        let text = xml.input_text();
        let mut inserts = Vec::new();
        for (id, declarations) in &self.0 {
            let node = xml.get_node(*id).unwrap();
            match attribute(node, "style") {
                Some(style) => inserts.push((style.range_value().end, declarations.clone())),
                None => {
                    let start = node.range().start + 1;
                    let end = text[start..].find(|c: char| c.is_whitespace() || c == '/' || c == '>').unwrap();
                    inserts.push((start + end, format!(" style=\"{}\"", &declarations[1..])));
                }
            }
        }
        inserts.sort();
        let (mut whole, mut at) = (String::new(), 0);
        for (place, insert) in inserts {
            whole += &text[at..place];
            whole += &insert;
            at = place;
        }
        whole + &text[at..]
    }
}
