//! What properties ask for that `usvg` leaves out without a word, as the words of a warning.

use svgtypes::{Color, Length, Paint};
use usvg::roxmltree::Node;

use super::{attribute, transform};
use crate::scene::quoted;

/// What is drawn, or belongs to what is drawn, or is no drawing; the primitives of filters beside them.
const KNOWN: [&str; 36] = [
    "svg",
    "g",
    "a",
    "use",
    "symbol",
    "defs",
    "switch",
    "text",
    "tspan",
    "textPath",
    "path",
    "rect",
    "circle",
    "ellipse",
    "line",
    "polyline",
    "polygon",
    "image",
    "linearGradient",
    "radialGradient",
    "pattern",
    "stop",
    "clipPath",
    "mask",
    "marker",
    "filter",
    "style",
    "script",
    "title",
    "desc",
    "metadata",
    "view",
    "cursor",
    "mpath",
    "discard",
    "color-profile",
];

/// Whether an element is one of those that are understood.
pub(super) fn is_known(node: Node<'_, '_>) -> bool {
    let name = node.tag_name().name();
    KNOWN.contains(&name) || name.starts_with("fe")
}

/// What an element is, or has as an attribute, that is not drawn.
pub(super) fn of_element(node: Node<'_, '_>) -> Option<String> {
    match node.tag_name().name() {
        "image" => Some("images are not drawn yet".to_owned()),
        name if !is_known(node) => Some(format!("<{name}> is not drawn")),
        _ => attribute(node, "pathLength")
            .map(|_| "pathLength is not taken into account: lengths along the path are in user units".to_owned()),
    }
}

/// What an attribute of an element asks for.
pub(super) fn of_attribute(node: Node<'_, '_>, name: &str, value: &str) -> Option<String> {
    let is_length = match node.tag_name().name() {
        "rect" => matches!(name, "x" | "y" | "width" | "height" | "rx" | "ry"),
        "svg" | "use" | "image" => matches!(name, "x" | "y" | "width" | "height"),
        "circle" => matches!(name, "cx" | "cy" | "r"),
        "ellipse" => matches!(name, "cx" | "cy" | "rx" | "ry"),
        "line" => matches!(name, "x1" | "y1" | "x2" | "y2"),
        _ => false,
    };
    let value = value.trim();
    match is_length {
        // An element that needs it is left out.
        true if value == "auto" || value.parse::<Length>().is_ok() => None,
        true => of_property(name, value).or_else(|| Some(format!("{name}: {} is not understood: left out", quoted(value)))),
        false => of_property(name, value),
    }
}

/// What a property asks for, whether an attribute or a declaration sets it.
pub(super) fn of_property(name: &str, value: &str) -> Option<String> {
    let value = value.trim();
    // What else is drawn is none, a reference, or what stands around.
    let is_reference = |value: &str| value.get(..4).is_some_and(|start| start.eq_ignore_ascii_case("url("));
    let other = |value: &str| !matches!(value, "none" | "inherit" | "initial" | "unset" | "") && !is_reference(value);
    match name {
        "stroke-linejoin" if value == "arcs" => Some("joins of the kind arcs are not drawn: mitered instead".to_owned()),
        "vector-effect" if value == "non-scaling-stroke" => Some("strokes that do not scale are not drawn: scaled instead".to_owned()),
        "clip-path" if other(value) => Some(format!("clip paths of the kind {} are not drawn: not clipped", quoted(value))),
        "mask" | "mask-image" if other(value) => Some(format!("masks of the kind {} are not drawn: not masked", quoted(value))),
        "transform" if other(value) && value.parse::<svgtypes::Transform>().is_err() => {
            Some(format!("the transform {} is not understood: left out", quoted(value)))
        }
        "d" | "points" | "style" | "class" | "id" | "href" => None,
        "fill" | "stroke" | "color" if is_colour(name, value) => None,
        "fill" | "stroke" | "color" if other(value) && !value.contains("var(") => {
            Some(format!("{name}: the colour {} is not understood: left out", quoted(value)))
        }
        _ if value.contains("var(") || value.contains("calc(") => {
            Some(format!("{name}: {} is not understood: write the value out", quoted(value)))
        }
        _ => None,
    }
}

/// What a declaration asks for that an attribute of that name does not.
pub(super) fn of_declaration(name: &str, value: &str) -> Option<String> {
    match name {
        "x" | "y" | "width" | "height" | "rx" | "ry" | "cx" | "cy" | "r" | "d" => {
            Some(format!("{name} is not read in a style: make it an attribute"))
        }
        "rotate" | "translate" | "scale" | "offset-path" if !matches!(value.trim(), "none" | "auto") => {
            Some(format!("the property {name} is not drawn: use transform"))
        }
        "transform-box" if !matches!(value.trim(), "view-box" | "border-box") => {
            Some(format!("transform-box: {} is not drawn: origins are on the page", quoted(value.trim())))
        }
        "transform" if transform::matrix(value).is_some() => None,
        _ => of_property(name, value),
    }
}

fn is_colour(property: &str, value: &str) -> bool {
    if property == "color" { value.parse::<Color>().is_ok() || value == "currentColor" } else { Paint::from_str(value).is_ok() }
}
