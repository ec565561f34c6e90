//! Long outlines, which are read here, by several threads, and not by `usvg`.
//!
//! In the text that `usvg` gets, a stand-in takes the place of their path data: a line across the box around the outline. The element is tagged
//! ([`super::tags`]), and where the walk meets the tag it takes the outline from there. The box is exactly that which `usvg` finds around the
//! outline, so units of bounding boxes and what else it derives from them stay as they are.
//!
//! ```text
//! d="M0.5 7L3 1L9 4L6.5 8Z"   ->   d="M5e-1 1e0L9e0 8e0"
//! ```
//!
//! What looks at more of an outline than its box keeps it: documents with markers, which stand on vertices, and with text along paths. So do clip paths,
//! whose children cannot be tagged, and arcs, of which `usvg` makes cubics in its own way.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use usvg::roxmltree::{Attribute, Document, Node, NodeId};
use usvg::tiny_skia_path::PathBuilder;

use super::{attribute, href, is_svg};
use crate::input::path_data;
use crate::shape::{Path, Verb};
use crate::spread::spread;

/// Path data of so many bytes are long.
const LONG: usize = 1024;

/// Bytes of path data for which another thread pays.
const SHARE: usize = 128 << 10;

/// An outline that has been read.
pub(super) struct Outline {
    /// As `usvg` would give it.
    pub(super) path: Arc<Path>,
    /// Whether its numbers are known not to be too large.
    pub(super) plain: bool,
    /// Left, top, right, bottom.
    bounds: [f32; 4],
}

impl Outline {
    fn read(data: &str) -> Option<Outline> {
        let single = path_data::parse_single(data)?;
        Some(Outline { bounds: bounds(&single.path)?, path: single.path.into(), plain: single.plain })
    }

    /// Path data with the same box.
    pub(super) fn stand_in(&self) -> String {
        let [left, top, right, bottom] = self.bounds.map(f64::from);
        format!("M{left:e} {top:e}L{right:e} {bottom:e}")
    }
}

/// The long outlines of a document.
#[derive(Default)]
pub(super) struct Outlines(HashMap<NodeId, Outline>);

impl Outlines {
    /// Reads them, with at most so many threads.
    pub(super) fn read(xml: &Document<'_>, threads: usize) -> Outlines {
        let long = long(xml);
        let bytes: usize = long.iter().map(|(_, data)| data.len()).sum();
        let threads = threads.min(1 + bytes / SHARE);
        let read = spread(&long, threads, |&(id, data)| Some((id, Outline::read(data)?)));
        Outlines(read.into_iter().flatten().collect())
    }

    /// The outline of an element, if it was read here.
    pub(super) fn of(&self, node: Node<'_, '_>) -> Option<&Outline> {
        self.0.get(&node.id())
    }
}

/// Path data of an element.
pub(super) fn data<'a, 'i>(node: Node<'a, 'i>) -> Option<Attribute<'a, 'i>> {
    node.attributes().find(|a| a.namespace().is_none() && a.name() == "d")
}

/// The elements whose outlines are to be read here, in the document's order, with their path data.
fn long<'a>(xml: &'a Document<'_>) -> Vec<(NodeId, &'a str)> {
    let (mut found, mut within, mut clipping) = (Vec::new(), Vec::new(), HashSet::new());
    for node in xml.descendants() {
        let name = node.tag_name().name();
        if matches!(name, "marker" | "textPath") {
            return Vec::new();
        }
        let clips = name == "clipPath" || node.parent().is_some_and(|p| within[p.id().get_usize()]);
        within.push(clips);
        if clips && name == "use" {
            clipping.extend(href(node).and_then(|h| h.trim().strip_prefix('#')));
        }
        // What an entity holds stands in several places at once.
        let fixed = node.range().start < xml.root_element().range().start;
        if let Some(data) = data(node).filter(|d| d.value().len() >= LONG && name == "path" && is_svg(node) && !clips && !fixed) {
            found.push((node.id(), data.value()));
        }
    }
    let clips = |node: &Node<'_, '_>| attribute(*node, "id").is_some_and(|id| clipping.contains(id));
    if !clipping.is_empty() && xml.descendants().filter(clips).any(|n| n.has_children() || n.has_tag_name("use")) {
        // More than a shape, which might lead anywhere.
        return Vec::new();
    }
    found.retain(|&(id, _)| !xml.get_node(id).is_some_and(|node| clips(&node)));
    found
}

/// The box around a path, curves as `usvg` bounds them.
fn bounds(path: &Path) -> Option<[f32; 4]> {
    let mut points = path.points();
    let first = *points.first()?;
    let [mut least, mut most] = [first; 2];
    let mut see = |p: [f64; 2]| {
        for axis in 0..2 {
            least[axis] = if p[axis] < least[axis] { p[axis] } else { least[axis] };
            most[axis] = if p[axis] > most[axis] { p[axis] } else { most[axis] };
        }
    };
    let mut at = first;
    for verb in path.verbs() {
        let curve;
        (curve, points) = points.split_at(match verb {
            Verb::Move | Verb::Line => 1,
            Verb::Quad => 2,
            Verb::Cubic => 3,
            Verb::Close => 0,
        });
        if let [.., _, _] = curve {
            let single = |p: [f64; 2]| p.map(|v| v as f32);
            let mut builder = PathBuilder::new();
            let [x, y] = single(at);
            builder.move_to(x, y);
            match *curve {
                [c, p] => {
                    let ([a, b], [x, y]) = (single(c), single(p));
                    builder.quad_to(a, b, x, y);
                }
                [c, d, p] => {
                    let ([a, b], [e, f], [x, y]) = (single(c), single(d), single(p));
                    builder.cubic_to(a, b, e, f, x, y);
                }
                _ => {}
            }
            let tight = builder.finish()?.compute_tight_bounds()?;
            see([tight.left(), tight.top()].map(f64::from));
            see([tight.right(), tight.bottom()].map(f64::from));
        } else {
            curve.iter().for_each(|&p| see(p));
        }
        at = curve.last().copied().unwrap_or(at);
    }
    Some([least[0], least[1], most[0], most[1]].map(|v| v as f32))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Path;

    /// The path that `usvg` makes of path data, with its box.
    fn theirs(data: &str) -> Option<(Path, [f32; 4])> {
        let text = format!("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9\" height=\"9\"><path d=\"{data}\"/></svg>");
        let tree = usvg::Tree::from_str(&text, &usvg::Options::default()).unwrap();
        let [usvg::Node::Path(path)] = tree.root().children() else { return None };
        let b = path.bounding_box();
        Some((super::super::geometry::outline(path), [b.left(), b.top(), b.right(), b.bottom()]))
    }

    #[test]
    fn outlines_and_their_boxes_are_those_of_usvg() {
        let mut state = 1_u64;
        let mut random = |n: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % n
        };
        let (mut read, mut drawn) = (0, 0);
        for _ in 0..20_000 {
            let mut data = String::new();
            for i in 0..1 + random(12) {
                let command = b"MmLlHhVvCcSsQqTtZz"[if i == 0 { random(2) } else { random(18) } as usize];
                data.push(char::from(command));
                let numbers = match command.to_ascii_lowercase() {
                    b'm' | b'l' | b't' => 2,
                    b'h' | b'v' => 1,
                    b'c' => 6,
                    b's' | b'q' => 4,
                    _ => 0,
                };
                for _ in 0..numbers * (1 + u64::from(random(4) == 0)) {
                    data += &match random(60) {
                        0 => "x ".to_owned(),
                        1..=5 => "3 ".to_owned(),
                        _ => format!("{:.*} ", random(9) as usize, random(4_000_000) as f64 / 1000.0 - 2000.0),
                    };
                }
            }
            let ours = Outline::read(&data);
            assert_eq!(ours.as_ref().map(|o| (&*o.path, o.bounds)), theirs(&data).as_ref().map(|(path, bounds)| (path, *bounds)), "{data}");
            if let Some(ours) = ours {
                read += 1;
                drawn += usize::from(theirs(&ours.stand_in()).is_some_and(|(_, bounds)| bounds == ours.bounds));
            }
        }
        assert_eq!(read, drawn);
        assert!(read > 10_000, "{read}");
    }

    #[test]
    fn what_is_looked_at_more_closely_is_left_to_usvg() {
        let data = format!("M1 1L2 2{}", " ".repeat(LONG));
        let count = |inside: &str| {
            let text = format!("<svg xmlns=\"http://www.w3.org/2000/svg\">{}</svg>", inside.replace('$', &format!("d='{data}'")));
            Outlines::read(&Document::parse(&text).unwrap(), 2).0.len()
        };
        assert_eq!(count("<path $/><g><path $/></g><path d='M1 1L2 2'/>"), 2);
        assert_eq!(count("<path $/><marker/>"), 0);
        assert_eq!(count("<path $/><text><textPath/></text>"), 0);
        assert_eq!(count("<path $/><clipPath><path $/></clipPath>"), 1);
        assert_eq!(count("<path $/><path id='a' $/><clipPath><use href='#a'/></clipPath>"), 1);
        assert_eq!(count("<path $/><path id='a' $/><use id='b' href='#a'/><clipPath><use href='#b'/></clipPath>"), 0);
        assert_eq!(count(&format!("<path d='M0 0A1 1 0 0 0 5 5{}'/>", " ".repeat(LONG))), 0);
    }
}
