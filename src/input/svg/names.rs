//! The ids of a document, in its order: names for areas.
//!
//! An id that nothing drawn carries becomes an empty shape, so that an expression can name it, with a warning.

use std::collections::HashSet;

use usvg::roxmltree::Document;

use super::notes::{Element, Notes};
use super::tree::{Drawn, Walked};
use super::{attribute, is_svg};
use crate::error::{Error, Kind, Result};
use crate::scene::{Limits, Named, Scene};

/// Gives the areas of a walked drawing the ids of the document.
pub(super) fn add(walked: Walked<'_>, xml: &Document<'_>, limits: &Limits, notes: &mut Notes<'_>) -> Result<Scene> {
    let Walked { mut scene, mut drawn } = walked;
    let everything = Drawn { area: scene.art, shapes: 0..scene.shapes.len() as u32 };
    if let Some(id) = attribute(xml.root_element(), "id") {
        drawn.insert(id, everything);
    }
    let nothing = scene.formula.any(&[]);
    let mut depths: Vec<u32> = Vec::new();
    let mut twice = HashSet::new();
    for node in xml.descendants() {
        let depth = node.parent().map_or(0, |p| depths[p.id().get_usize()] + u32::from(named(p).is_some()));
        depths.push(depth);
        let Some(id) = named(node) else { continue };
        let found = drawn.get(id).cloned().unwrap_or(Drawn { area: nothing, shapes: 0..0 });
        let kind = kind(node.tag_name().name());
        if !scene.add_name(Named { id: id.to_owned(), kind, area: found.area, shapes: found.shapes, depth }) && twice.insert(id) {
            notes.add_at(Some(node.range().start), Element { id, own: true }, "this id stands more than once: the first counts");
        }
        if (scene.names().len() + scene.shapes.len()) as u64 > limits.nodes {
            return Err(Error::input(Kind::Limit, format!("more than {} shapes and ids: split the drawing", limits.nodes)));
        }
    }
    Ok(scene)
}

/// The id of an element of SVG.
fn named<'a>(node: usvg::roxmltree::Node<'a, '_>) -> Option<&'a str> {
    attribute(node, "id").filter(|id| is_svg(node) && !id.is_empty())
}

fn kind(tag: &str) -> &'static str {
    const SHAPES: [&str; 9] = ["path", "rect", "circle", "ellipse", "line", "polyline", "polygon", "text", "image"];
    const OTHERS: [&str; 13] = [
        "svg",
        "use",
        "symbol",
        "defs",
        "switch",
        "clipPath",
        "mask",
        "pattern",
        "marker",
        "filter",
        "linearGradient",
        "radialGradient",
        "tspan",
    ];
    match tag {
        "g" | "a" => "group",
        _ => SHAPES.iter().chain(&OTHERS).find(|k| **k == tag).copied().unwrap_or("element"),
    }
}
