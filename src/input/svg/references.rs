//! Elements refer to elements: `use` to what it draws, fills to patterns, shapes to clip paths, masks, markers and filters.
//!
//! `usvg` follows references and nesting by recursion and copies what they lead to. One walk over the graph of both, with an
//! explicit stack, refuses circles, chains that are too deep, and documents that grow too large when everything is written out.

use foldhash::HashMap;
use usvg::roxmltree::{Document, Node, NodeId};

use super::style::Styles;
use super::{attribute, href, is_svg};
use crate::error::{Error, Kind, Result};
use crate::scene::{Limits, quoted};

/// How deep elements may be nested, references followed.
pub(super) const DEEPEST: u32 = 500;

/// Most gradients, patterns, clip paths, masks and filters: `usvg` compares each with each.
const DEFINITIONS: usize = 30_000;

/// Most children of a gradient: those that `usvg` leaves out cost a move of all behind them.
const STOPS: usize = 20_000;

/// Properties that refer to elements. Shapes inherit the first [`INHERITED`].
const PROPERTIES: [&str; 8] = ["fill", "stroke", "marker-start", "marker-mid", "marker-end", "clip-path", "mask", "filter"];
const INHERITED: usize = 5;
const MARKERS: std::ops::Range<usize> = 2..5;

/// Stands for `href` beside the numbers of [`PROPERTIES`].
const HREF: usize = PROPERTIES.len();

/// Elements, each with words for a reference of it that leads to nothing, or to what it cannot use.
pub(super) type Missing = Vec<(NodeId, String)>;

/// Refuses what must not be followed. Gives the style sheets, and the references that lead nowhere.
pub(super) fn check<'a>(xml: &'a Document<'_>, limits: &Limits) -> Result<(Styles<'a>, Missing)> {
    let (elements, depth) = measure(xml)?;
    let styles = Styles::read(xml, elements, u64::from(depth))?;
    let graph = Graph::read(xml, &styles);
    graph.walk(limits)?;
    let missing = graph.missing;
    Ok((styles, missing))
}

/// Number of elements and how deep they are nested.
fn measure(xml: &Document<'_>) -> Result<(u64, u32)> {
    let mut depths: Vec<u32> = Vec::new();
    let (mut elements, mut definitions, mut deepest) = (0, 0, 0);
    for node in xml.descendants() {
        let depth = node.parent().map_or(0, |p| depths[p.id().get_usize()] + 1);
        depths.push(depth);
        deepest = deepest.max(depth);
        elements += u64::from(node.is_element());
        let name = node.tag_name().name();
        definitions += usize::from(matches!(name, "linearGradient" | "radialGradient" | "pattern" | "clipPath" | "mask" | "filter"));
        if depth > DEEPEST {
            return Err(at(node, Kind::Limit, format!("elements nested more than {DEEPEST} deep: flatten the groups")));
        }
        if matches!(name, "linearGradient" | "radialGradient") && node.children().take(STOPS + 1).count() > STOPS {
            return Err(at(node, Kind::Limit, format!("a gradient with more than {STOPS} stops: use fewer")));
        }
        if definitions > DEFINITIONS {
            let what = format!("more than {DEFINITIONS} gradients, patterns, clip paths, masks and filters: share them");
            return Err(at(node, Kind::Limit, what));
        }
    }
    Ok((elements, deepest))
}

fn at(node: Node<'_, '_>, kind: Kind, what: String) -> Error {
    Error::input(kind, what).at_byte(node.document().input_text().as_bytes(), node.range().start)
}

/// A property of an element that refers to another.
#[derive(Clone, Copy)]
struct Reference {
    property: usize,
    to: NodeId,
}

struct Graph<'a, 'i> {
    xml: &'a Document<'i>,
    /// The references that stand on an element itself, for those that have some.
    own: HashMap<NodeId, Vec<Reference>>,
    missing: Missing,
    /// For every node and inherited property: the nearest of it and its ancestors that sets it.
    setter: Vec<[Option<NodeId>; INHERITED]>,
}

impl<'a, 'i> Graph<'a, 'i> {
    fn read(xml: &'a Document<'i>, styles: &Styles<'a>) -> Graph<'a, 'i> {
        let mut ids: HashMap<&str, (NodeId, NodeId)> = HashMap::default();
        for node in xml.descendants() {
            if let Some(id) = attribute(node, "id") {
                ids.entry(id).or_insert((node.id(), node.id())).1 = node.id();
            }
        }
        let mut graph = Graph { xml, own: HashMap::default(), missing: Vec::new(), setter: Vec::new() };
        for node in xml.descendants() {
            let mut setter = node.parent().map_or([None; INHERITED], |p| graph.setter[p.id().get_usize()]);
            let (mut own, missing) = (Vec::new(), &mut graph.missing);
            // Of equal ids usvg takes the first for use and the last for the others.
            let targets =
                |id: &str| ids.get(id).into_iter().flat_map(|&(first, last)| [Some(first), (first != last).then_some(last)]).flatten();
            if is_svg(node) {
                styles.of(node, |name, value| {
                    let all = if name == "marker" { MARKERS } else { 0..HREF };
                    for property in all.filter(|&p| name == "marker" || PROPERTIES[p] == name) {
                        if property < INHERITED && value != "inherit" {
                            setter[property] = Some(node.id());
                        }
                        own.extend(urls(value).flat_map(targets).map(|to| Reference { property, to }));
                    }
                    // What stands behind a reference is drawn where it fails.
                    let fails = |id: &&str| !ids.contains_key(id) && value.trim_end().ends_with(')');
                    if PROPERTIES.contains(&name) || name == "marker" {
                        missing.extend(urls(value).filter(fails).map(|id| (node.id(), not_there(id))));
                        missing.extend(urls(value).filter_map(|id| Some((node.id(), unfit(xml, name, id, targets(id))?))));
                    }
                });
                let id = href(node).and_then(|h| h.trim().strip_prefix('#')).filter(|_| node.tag_name().name() != "a");
                missing.extend(id.filter(|id| !ids.contains_key(id)).map(|id| (node.id(), not_there(id))));
                if matches!(node.tag_name().name(), "use" | "pattern" | "feImage") {
                    let id = href(node).and_then(|h| h.trim().strip_prefix('#'));
                    own.extend(id.into_iter().flat_map(targets).map(|to| Reference { property: HREF, to }));
                }
            }
            graph.setter.push(setter);
            if !own.is_empty() {
                graph.own.insert(node.id(), own);
            }
        }
        graph
    }

    /// What following an element leads to.
    fn edges(&self, node: Node<'_, '_>) -> Vec<Edge> {
        let mut edges: Vec<Edge> = node.children().filter(Node::is_element).map(|c| Edge { to: c.id(), markers: 0 }).collect();
        if !is_svg(node) {
            return edges;
        }
        let own = |id: NodeId| self.own.get(&id).into_iter().flatten();
        edges.extend(own(node.id()).filter(|r| r.property >= INHERITED).map(|r| Edge { to: r.to, markers: 0 }));
        let inherited = match node.tag_name().name() {
            // Markers on all of them, as usvg has it.
            "path" | "line" | "polyline" | "polygon" | "rect" | "circle" | "ellipse" => INHERITED,
            "text" | "tspan" | "use" => MARKERS.start,
            _ => 0,
        };
        for (property, setter) in self.setter[node.id().get_usize()].iter().enumerate().take(inherited) {
            let markers = if MARKERS.contains(&property) { vertices(node) + 4 } else { 0 };
            let references = setter.iter().flat_map(|&s| own(s)).filter(|r| r.property == property);
            edges.extend(references.map(|r| Edge { to: r.to, markers }));
        }
        edges
    }

    /// Walks depth first, every element once.
    fn walk(&self, limits: &Limits) -> Result<()> {
        struct Step<'a, 'i> {
            node: Node<'a, 'i>,
            edges: Vec<Edge>,
            size: u64,
            vertices: u64,
            depth: u32,
        }
        #[derive(Clone, Copy)]
        enum Seen {
            Not,
            OnTheWay,
            Whole { size: u64, vertices: u64, depth: u32 },
        }
        let step = |node| Step { node, edges: self.edges(node), size: 1, vertices: vertices(node), depth: 0 };
        let mut seen = vec![Seen::Not; self.setter.len()];
        let mut way = vec![step(self.xml.root_element())];
        while let Some(here) = way.last_mut() {
            let Some(&edge) = here.edges.last() else {
                seen[here.node.id().get_usize()] = Seen::Whole { size: here.size, vertices: here.vertices, depth: here.depth };
                way.pop();
                continue;
            };
            let to = self.xml.get_node(edge.to).expect("edges lead to nodes of this document");
            match seen[edge.to.get_usize()] {
                Seen::Not => {
                    seen[edge.to.get_usize()] = Seen::OnTheWay;
                    way.push(step(to));
                    continue;
                }
                // A marker that would draw itself is left out by usvg.
                Seen::OnTheWay if edge.markers > 0 => {}
                Seen::OnTheWay => {
                    let (tag, id) = (to.tag_name().name(), quoted(attribute(to, "id").unwrap_or_default()));
                    let what = format!("<{tag}> {id} is drawn within itself, through what it refers to: break the circle");
                    return Err(at(to, Kind::Refused, what));
                }
                Seen::Whole { size, vertices, depth } => {
                    here.size = here.size.saturating_add(size.saturating_mul(edge.markers.max(1)));
                    here.vertices = here.vertices.saturating_add(vertices.saturating_mul(edge.markers.max(1)));
                    here.depth = here.depth.max(depth + 1);
                }
            }
            here.edges.pop();
            if here.depth > DEEPEST {
                let what = format!("elements more than {DEEPEST} deep, references followed: shorten the chain");
                return Err(at(here.node, Kind::Limit, what));
            }
            for (count, limit, what) in [(here.size, limits.nodes, "elements"), (here.vertices, limits.edges, "vertices")] {
                if count > limit {
                    let what = format!("more than {limit} {what} when all references are written out: use fewer");
                    return Err(at(here.node, Kind::Limit, what));
                }
            }
        }
        Ok(())
    }
}

fn not_there(id: &str) -> String {
    format!("{} is not in the document", quoted(&format!("#{id}")))
}

/// What is wrong with what a property refers to, if none of it is of a kind that the property can use.
fn unfit(xml: &Document<'_>, property: &str, id: &str, targets: impl Iterator<Item = NodeId>) -> Option<String> {
    let fits = |tag: &str| match property {
        "fill" | "stroke" => matches!(tag, "linearGradient" | "radialGradient" | "pattern"),
        "clip-path" => tag == "clipPath",
        "mask" | "filter" => tag == property,
        _ => tag == "marker",
    };
    let mut tags = targets.filter_map(|to| xml.get_node(to)).map(|to| to.tag_name().name()).peekable();
    let first = *tags.peek()?;
    (!tags.any(fits)).then(|| format!("{property}: {} is a <{first}>, which is not drawn there", quoted(&format!("#{id}"))))
}

/// From an element to one that it holds or refers to.
#[derive(Clone, Copy)]
struct Edge {
    to: NodeId,
    /// For a marker: how often it is drawn at most.
    markers: u64,
}

/// An upper bound of the number of vertices that are written out for a shape, from the length of its text.
fn vertices(node: Node<'_, '_>) -> u64 {
    attribute(node, "d").or(attribute(node, "points")).map_or(0, str::len) as u64 / 2
}

/// The ids in the `url(#id)` of a value.
fn urls(value: &str) -> impl Iterator<Item = &str> {
    value.split("url(").skip(1).filter_map(|rest| rest.split(')').next()?.trim().trim_matches(['"', '\'']).trim().strip_prefix('#'))
}
