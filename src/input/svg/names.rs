//! The ids of a document, in its order: names for areas.
//!
//! An id that nothing drawn carries becomes an empty shape, so that an expression can name it, with a warning.

use std::ops::Range;

use foldhash::HashSet;
use usvg::roxmltree::Document;

use super::drawn::{Drawn, Walked};
use super::notes::{Element, Notes};
use super::{attribute, is_svg};
use crate::error::{Error, Kind, Place, Places, Result};
use crate::run::Rgb;
use crate::scene::{Area, Formula, Limits, Named, Scene};

/// The ids of a document; of equal ones the first.
pub(super) struct Names {
    names: Vec<Name>,
    /// Where their elements begin.
    places: Vec<Place>,
    /// The id of the root, which stands for everything.
    root: Option<String>,
}

struct Name {
    id: String,
    kind: &'static str,
    depth: u32,
}

impl Names {
    /// Reads them. Of an id that stands more than once there is a note.
    pub(super) fn read(xml: &Document<'_>, notes: &mut Notes) -> Names {
        let (mut names, mut starts) = (Vec::new(), Vec::new());
        let mut depths: Vec<u32> = Vec::new();
        let (mut once, mut twice) = (HashSet::default(), HashSet::default());
        for node in xml.descendants() {
            let depth = node.parent().map_or(0, |p| depths[p.id().get_usize()] + u32::from(named(p).is_some()));
            depths.push(depth);
            let Some(id) = named(node) else { continue };
            if once.insert(id) {
                names.push(Name { id: id.to_owned(), kind: kind(node.tag_name().name()), depth });
                starts.push(node.range().start);
            } else if twice.insert(id) {
                notes.add_at(node.range().start, Element { id, own: true }, "this id stands more than once: the first counts");
            }
        }
        Names { names, places: places(xml.input_text(), &starts), root: attribute(xml.root_element(), "id").map(str::to_owned) }
    }

    /// Gives the areas of a walked drawing these names. Also gives where the elements of the scene's names begin.
    pub(super) fn give(self, walked: Walked<'_>, limits: &Limits) -> Result<(Scene, Vec<Place>)> {
        let Walked { mut scene, mut drawn, paints } = walked;
        if let Some(id) = &self.root {
            drawn.insert(id, Drawn { area: scene.art, paints: 0..paints.len(), more: Vec::new() });
        }
        let nothing = scene.formula.any(&[]);
        let mut changes = vec![0; paints.len()];
        for i in 1..paints.len() {
            changes[i] = changes[i - 1] + u32::from(paints[i].1 != paints[i - 1].1);
        }
        if (self.names.len() + scene.shapes.len()) as u64 > limits.nodes {
            return Err(Error::input(Kind::Limit, format!("more than {} shapes and ids: split the drawing", limits.nodes)));
        }
        for Name { id, kind, depth } in self.names {
            let (area, shapes, ink) = match drawn.get(&*id) {
                Some(drawn) => (whole(drawn, &mut scene.formula), shapes(drawn, &paints), ink(drawn, &paints, &changes)),
                None => (nothing, Vec::new(), None),
            };
            scene.add_name(Named { id, kind, area, shapes, ink, depth });
        }
        Ok((scene, self.places))
    }
}

/// The places of bytes of a text.
fn places(text: &str, bytes: &[usize]) -> Vec<Place> {
    // What an entity holds begins further up than what stands around it.
    let mut order: Vec<u32> = (0..bytes.len() as u32).collect();
    order.sort_by_key(|&i| bytes[i as usize]);
    let mut known = Places::new(text.as_bytes());
    let mut places = vec![Place { line: 0, column: 0 }; bytes.len()];
    order.into_iter().for_each(|i| places[i as usize] = known.of_byte(bytes[i as usize]));
    places
}

/// All the places where an element is drawn, as one area.
fn whole(drawn: &Drawn, formula: &mut Formula) -> Area {
    if drawn.more.is_empty() {
        return drawn.area;
    }
    let places: Vec<Area> = drawn.places().map(|(area, _)| area).collect();
    formula.any(&places)
}

/// The shapes that paint an element.
fn shapes(drawn: &Drawn, paints: &[(u32, Rgb)]) -> Vec<Range<u32>> {
    let mut ranges: Vec<Range<u32>> = Vec::new();
    for place in drawn.places().map(|(_, range)| &paints[range]).filter(|place| !place.is_empty()) {
        let (first, last) = (place[0].0, place[place.len() - 1].0);
        // In most drawings nothing stands between them.
        if last - first == place.len() as u32 - 1 {
            ranges.push(first..last + 1);
            continue;
        }
        ranges.extend(place.chunk_by(|a, b| a.0 + 1 == b.0).map(|run| run[0].0..run[run.len() - 1].0 + 1));
    }
    ranges
}

/// The ink of an element, if it is of one colour. `changes` counts for every shape how often the ink has changed up to it.
fn ink(drawn: &Drawn, paints: &[(u32, Rgb)], changes: &[u32]) -> Option<Rgb> {
    let places = || drawn.places().map(|(_, range)| range).filter(|range| !range.is_empty());
    let first = paints[places().next()?.start].1;
    places().all(|range| paints[range.start].1 == first && changes[range.start] == changes[range.end - 1]).then_some(first)
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
