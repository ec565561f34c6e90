//! Marks that survive `usvg`, so that what it gives can be told apart by the elements it comes from.
//!
//! `usvg` keeps the ids of groups and shapes, but not those of what a `use` or a marker draws, nor of `switch`, `symbol` and nested
//! `svg`. What it does keep everywhere, unrounded and unshared, is the opacity of an element, as the opacity of a group that holds all
//! that the element draws, its markers too. So elements whose ids would be lost are given an opacity that is a serial number, far
//! below any that can be seen:
//!
//! ```text
//! <path id="p" style="opacity:.5"/>   ->   <path id="p" style="opacity:2.4e-30!important;opacity:.5"/>      tag 2: "p", opacity .5
//! ```
//!
//! and the true opacity is kept beside it. Parts of a `text` are marked in the same way by the opacity of their fill and of their stroke.
//! Transforms with units, which only style sheets know, are written out as matrices. Attributes of other namespaces that `usvg` would take for
//! SVG's own, such as `s:id`, get a name that means nothing.
//! A document in which no id would be lost is left as it is. The document is rewritten as text, once: by insertions, and by stand-ins for long outlines
//! ([`super::outlines`]), which are kept with the tag of their element.
//!
//! Rejected: writing `use` out as groups, which means doing again what `usvg` does with symbols, viewports, percentages and inherited
//! paint, and costs a copy of the text for each use; and marks by clip paths, each of which `usvg` compares with each.

use std::sync::Arc;

use foldhash::{HashMap, HashSet};
use usvg::roxmltree::{Attribute, Document, Node, NodeId};

use super::edits::Edits;
use super::outlines::{self, Outlines};
use super::style::Styles;
use super::viewport::Viewport;
use super::{attribute, href, is_svg, transform};
use crate::shape::Path;

/// Most tags: serial numbers are exact in the 24 bits of an opacity.
const TAGS: usize = 1 << 23;

/// What serial number 1 is as an opacity.
const UNIT: f64 = 1.0 / (1_u128 << 100) as f64;

/// An element that is tagged.
#[derive(Debug, Default)]
pub(super) struct Tag {
    /// Its id; empty if it has none.
    pub(super) id: String,
    /// Whether it is the first of that id, whose area counts.
    pub(super) first: bool,
    /// Whether it is a shape, so that what its group holds is the shape itself and its markers.
    pub(super) shape: bool,
    /// The id of the marker that it stands in, which `usvg` gives no group of its own; empty if there is none.
    pub(super) marker: String,
    /// The opacity that it has: of the element, or for a part of a text of its fill.
    pub(super) opacity: f32,
    /// For a part of a text the opacity of its stroke.
    pub(super) stroke_opacity: f32,
    /// Its outline, if `usvg` is given a stand-in.
    pub(super) outline: Option<Arc<Path>>,
    /// What it says of the coordinates of its content, if it is such an element.
    pub(super) viewport: Option<Box<Viewport>>,
    /// For a part of a text the serial number of the part around it; 0 if there is none.
    outer: u32,
}

/// The tags of a document.
#[derive(Debug, Default)]
pub(super) struct Tags(Vec<Tag>);

impl Tags {
    /// The tag that an opacity stands for.
    pub(super) fn of(&self, opacity: usvg::Opacity) -> Option<&Tag> {
        let serial = f64::from(opacity.get()) / UNIT;
        (serial >= 1.0 && serial.fract() == 0.0).then(|| self.0.get(serial as usize - 1)).flatten()
    }

    /// A part of a text and the parts around it.
    pub(super) fn and_around<'a>(&'a self, part: &'a Tag) -> impl Iterator<Item = &'a Tag> {
        std::iter::successors(Some(part), |tag| self.0.get((tag.outer as usize).checked_sub(1)?))
    }
}

/// What a node stands in.
#[derive(Clone, Copy, Default)]
struct Around {
    /// In what a `use` draws.
    used: bool,
    /// In a marker.
    marker: bool,
    /// Under a property that sets markers.
    marked: bool,
    /// In a text.
    text: bool,
    /// In the tagged part of a text of this serial number.
    part: u32,
}

/// The document with tags and with stand-ins for outlines, as text, if it needs some. Ids that stand a second time lose their meaning.
pub(super) fn rewrite<'a>(xml: &'a Document<'_>, styles: &Styles<'a>, outlines: &Outlines) -> Option<(String, Tags)> {
    let ids = Ids::read(xml);
    let root = xml.root_element();
    let has_markers = xml.descendants().any(|n| n.has_tag_name("marker"));
    let mut tags = Tags::default();
    let mut text = Edits::new(xml.input_text());
    let mut around: Vec<Around> = Vec::new();
    for node in xml.descendants() {
        let mut here = node.parent().map_or(Around::default(), |p| around[p.id().get_usize()]);
        // What an entity holds stands in several places at once.
        let fixed = !node.is_element() || node.range().start < root.range().start;
        let own = id(node);
        let name = node.tag_name().name();
        if node.is_element() {
            here.used |= own.is_some_and(|id| ids.used.contains(id.value()));
            here.marker |= name == "marker";
            here.text |= name == "text";
            here.marked |= has_markers && sets_markers(node, styles);
        }
        around.push(here);
        if !fixed {
            node.attributes().filter(is_mistaken).for_each(|a| text.disguise(a));
        }
        if let Some([a, b, c, d, e, f]) = Some(node).filter(|_| !fixed).and_then(|node| foreign_transform(node, styles)) {
            text.style(node, &format!("transform:matrix({a} {b} {c} {d} {e} {f})!important;"));
        }
        if fixed || !is_svg(node) || node == root {
            continue;
        }
        let first = own.filter(|id| ids.of.get(id.value()).is_some_and(|found| found.first == node.id()));
        if let (Some(own), None) = (own, first) {
            text.rename(own);
        }
        let marker = node.parent().filter(|p| p.has_tag_name("marker")).and_then(id);
        let lost = own.is_some() != first.is_some()
            || first.is_some_and(|id| here.loses(name) || ids.of.get(id.value()).is_some_and(|found| found.twice));
        let outline = outlines.of(node);
        let viewport = Viewport::read(node, styles);
        if (!lost && marker.is_none() && outline.is_none() && viewport.is_none()) || tags.0.len() == TAGS {
            continue;
        }
        let id_of = |attribute: Option<Attribute<'_, '_>>| attribute.map(|a| a.value().to_owned()).unwrap_or_default();
        let mut tag = Tag {
            id: id_of(own),
            first: first.is_some(),
            shape: SHAPES.contains(&name),
            marker: id_of(marker),
            opacity: 1.0,
            stroke_opacity: 1.0,
            outline: outline.map(|outline| outline.path.clone()),
            viewport: viewport.map(Box::new),
            outer: here.part,
        };
        let serial = tags.0.len() as u32 + 1;
        let value = UNIT * f64::from(serial);
        if here.text && is_part(name) {
            // Inherited, unlike the opacity of an element.
            let opacity = |property| node.ancestors().find_map(|n| styles.opacity(n, property)).unwrap_or(1.0);
            (tag.opacity, tag.stroke_opacity) = (opacity("fill-opacity"), opacity("stroke-opacity"));
            text.style(node, &format!("fill-opacity:{value:e}!important;stroke-opacity:{value:e}!important;"));
            around[node.id().get_usize()].part = serial;
        } else if is_drawn(name) {
            tag.opacity = styles.opacity(node, "opacity").unwrap_or(1.0);
            text.style(node, &format!("opacity:{value:e}!important;"));
        } else {
            continue;
        }
        if let (Some(outline), Some(data)) = (outline, outlines::data(node)) {
            text.replace(data.range_value(), outline.stand_in());
        }
        tags.0.push(tag);
    }
    text.finish(root).map(|text| (text, tags))
}

impl Around {
    /// Whether `usvg` loses the id of an element of that name that stands here.
    fn loses(self, name: &str) -> bool {
        let shape = matches!(name, "path" | "line" | "polyline" | "polygon" | "rect" | "circle" | "ellipse");
        self.used || self.marker || (self.text && is_part(name)) || matches!(name, "svg" | "symbol" | "switch") || (self.marked && shape)
    }
}

const SHAPES: [&str; 9] = ["path", "rect", "circle", "ellipse", "line", "polyline", "polygon", "text", "image"];

/// Whether `usvg` makes a group, or something in a group, of an element of that name.
fn is_drawn(name: &str) -> bool {
    SHAPES.contains(&name) || matches!(name, "g" | "a" | "use" | "svg" | "symbol" | "switch")
}

/// Whether an element of that name is a part of the text that it stands in.
fn is_part(name: &str) -> bool {
    matches!(name, "tspan" | "textPath" | "tref" | "a")
}

/// Whether an element says something of markers.
fn sets_markers(node: Node<'_, '_>, styles: &Styles<'_>) -> bool {
    let mut sets = false;
    styles.of(node, |name, value| sets |= name.starts_with("marker") && value.contains("url("));
    sets
}

/// The attribute `id` of an element of SVG.
fn id<'a, 'i>(node: Node<'a, 'i>) -> Option<Attribute<'a, 'i>> {
    node.attributes().find(|a| a.namespace().is_none() && a.name() == "id" && !a.value().is_empty()).filter(|_| is_svg(node))
}

/// The transform that an element's style declares, if `usvg` does not understand it.
fn foreign_transform<'a>(node: Node<'a, '_>, styles: &Styles<'a>) -> Option<[f64; 6]> {
    let declared = styles.declaration(node, "transform").filter(|t| is_svg(node) && t.parse::<svgtypes::Transform>().is_err())?;
    transform::matrix(declared)
}

/// Whether an attribute is not SVG's, but looks so to `usvg`: it takes any name of these namespaces for SVG's own, and for some looks at the
/// name alone.
fn is_mistaken(attribute: &Attribute<'_, '_>) -> bool {
    match attribute.namespace() {
        None => false,
        Some("http://www.w3.org/2000/svg") => true,
        Some("http://www.w3.org/1999/xlink") => {
            !matches!(attribute.name(), "href" | "type" | "role" | "arcrole" | "title" | "show" | "actuate")
        }
        Some("http://www.w3.org/XML/1998/namespace") => !matches!(attribute.name(), "space" | "lang" | "base"),
        Some(_) => matches!(attribute.name(), "id" | "class" | "style"),
    }
}

/// The ids of a document.
struct Ids<'a> {
    of: HashMap<&'a str, Found>,
    /// Those that a `use` refers to.
    used: HashSet<&'a str>,
}

struct Found {
    first: NodeId,
    twice: bool,
}

impl<'a> Ids<'a> {
    fn read(xml: &'a Document<'_>) -> Ids<'a> {
        let mut ids = Ids { of: HashMap::default(), used: HashSet::default() };
        for node in xml.descendants().filter(Node::is_element) {
            if let Some(id) = attribute(node, "id").filter(|id| is_svg(node) && !id.is_empty()) {
                ids.of.entry(id).and_modify(|found| found.twice = true).or_insert(Found { first: node.id(), twice: false });
            }
            if node.has_tag_name("use") {
                ids.used.extend(href(node).and_then(|h| h.trim().strip_prefix('#')));
            }
        }
        ids
    }
}
