//! A document rewritten so that only one of its elements is painted: the second opinion on what an id stands for.
//!
//! Nothing is removed and nothing moves, so that selectors, bounding boxes and the flow of text stay as they are. `visibility` is inherited, also
//! through `use`: it is hidden at the root and given back to the element. What clips and masks keeps its own visibility, because it paints
//! nothing itself. For an element within a marker the shapes that carry markers stay visible, without fill and stroke.
//!
//! A file that is about `visibility` keeps all of its own: what neither is the element nor leads to it is put into `defs`, where it stands
//! and can still be used, but is not drawn. Only within a text, whose parts cannot be taken apart, the visibility is set, in attributes.

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
    if element == xml.root_element() {
        return xml.input_text().to_owned();
    }
    if xml.input_text().contains("visibility") { put_away(xml, element) } else { hidden(xml, element) }
}

/// The document with everything hidden but an element.
fn hidden(xml: &Document<'_>, element: Node<'_, '_>) -> String {
    let mut edits = Edits::default();
    let marker = element.ancestors().find(|n| n.tag_name().name() == "marker");
    let kept = reached(element);
    let resources = resources(xml);
    for node in xml.descendants().filter(|n| is_svg(*n)) {
        let name = node.tag_name().name();
        if node == element {
            edits.style(node, "visibility", visibility(node));
        } else if node == xml.root_element() || (name == "marker" && marker.is_some()) {
            edits.style(node, "visibility", "hidden");
        } else if is_resource(name) {
            edits.style(node, "visibility", visibility(node));
        } else if marker.is_some() && SHAPES.contains(&name) && !resources.contains(&node.id()) {
            ["fill", "stroke"].iter().for_each(|property| edits.style(node, property, "none"));
            edits.style(node, "visibility", visibility(node));
        } else if own_visibility(node).is_some() && !kept.contains(&node.id()) && !resources.contains(&node.id()) {
            edits.style(node, "visibility", "hidden");
        }
    }
    edits.write(xml)
}

/// The document with everything in `defs` but an element and what leads to it.
fn put_away(xml: &Document<'_>, element: Node<'_, '_>) -> String {
    let mut edits = Edits::default();
    let resources = resources(xml);
    let in_marker = element.ancestors().any(|n| n.tag_name().name() == "marker");
    let kept = reached(element);
    let leading: HashSet<NodeId> = xml.descendants().filter(|n| reached(*n).contains(&element.id())).map(|n| n.id()).collect();
    let mut open = vec![xml.root_element()];
    while let Some(node) = open.pop() {
        let name = node.tag_name().name();
        if name == "text" {
            // Leads to one of its parts.
            edits.style(node, "visibility", "hidden");
            for part in node.descendants().skip(1).filter(|n| own_visibility(*n).is_some() && !kept.contains(&n.id())) {
                edits.style(part, "visibility", "hidden");
            }
            edits.style(element, "visibility", visibility(element));
            continue;
        }
        for child in node.children().filter(|n| is_svg(*n) && *n != element) {
            let name = child.tag_name().name();
            if leading.contains(&child.id()) {
                open.push(child);
            } else if in_marker && SHAPES.contains(&name) && !resources.contains(&child.id()) {
                ["fill", "stroke"].iter().for_each(|property| edits.style(child, property, "none"));
            } else if in_marker && matches!(name, "g" | "svg" | "a") {
                open.push(child);
            } else if matches!(name, "path" | "use" | "text" | "g" | "svg" | "a" | "switch" | "image") || SHAPES.contains(&name) {
                edits.put_away(child);
            }
        }
    }
    edits.write(xml)
}

/// Whether elements of that name serve others, and paint nothing where they stand.
fn is_resource(name: &str) -> bool {
    matches!(name, "clipPath" | "mask" | "pattern" | "marker")
}

/// All such elements, with what they draw.
fn resources(xml: &Document<'_>) -> HashSet<NodeId> {
    xml.descendants().filter(|n| is_svg(*n) && is_resource(n.tag_name().name())).flat_map(reached).collect()
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

/// What is put into a document.
#[derive(Default)]
struct Edits {
    /// Declarations, behind those of `style` attributes.
    styles: HashMap<NodeId, String>,
    /// Texts, each at a place, in their order.
    inserts: Vec<(usize, String)>,
}

impl Edits {
    fn style(&mut self, node: Node<'_, '_>, property: &str, value: &str) {
        *self.styles.entry(node.id()).or_default() += &format!(";{property}:{value}");
    }

    /// Puts an element into `defs`.
    fn put_away(&mut self, node: Node<'_, '_>) {
        self.inserts.push((node.range().start, "<defs>".to_owned()));
        self.inserts.push((node.range().end, "</defs>".to_owned()));
    }

    /// The text of the document with them.
    fn write(mut self, xml: &Document<'_>) -> String {
        let text = xml.input_text();
        for (id, declarations) in &self.styles {
            let node = xml.get_node(*id).unwrap();
            match attribute(node, "style") {
                Some(style) => self.inserts.push((style.range_value().end, declarations.clone())),
                None => {
                    let start = node.range().start + 1;
                    let end = text[start..].find(|c: char| c.is_whitespace() || c == '/' || c == '>').unwrap();
                    self.inserts.push((start + end, format!(" style=\"{}\"", &declarations[1..])));
                }
            }
        }
        // What ends where another begins, ends first: it was put in first.
        self.inserts.sort_by_key(|i| (i.0, i.1 != "</defs>"));
        let (mut whole, mut at) = (String::new(), 0);
        for (place, insert) in self.inserts {
            whole += &text[at..place];
            whole += &insert;
            at = place;
        }
        whole + &text[at..]
    }
}
