//! What properties ask for that `usvg` leaves out without a word, as the words of a warning.

use usvg::roxmltree::Node;

use super::{attribute, transform};
use crate::scene::quoted;

/// What an element is, or has as an attribute, that is not drawn.
pub(super) fn of_element(node: Node<'_, '_>) -> Option<String> {
    match node.tag_name().name() {
        "image" => Some("images are not drawn yet".to_owned()),
        name @ ("foreignObject" | "video" | "iframe" | "canvas" | "animate" | "animateTransform" | "animateMotion" | "set") => {
            Some(format!("<{name}> is not drawn"))
        }
        _ => attribute(node, "pathLength")
            .map(|_| "pathLength is not taken into account: lengths along the path are in user units".to_owned()),
    }
}

/// What a property asks for, whether an attribute or a declaration sets it.
pub(super) fn of_property(name: &str, value: &str) -> Option<String> {
    let value = value.trim();
    // What else is drawn is none, a reference, or what stands around.
    let other = |value: &str| !matches!(value, "none" | "inherit" | "initial" | "unset" | "") && !value.starts_with("url(");
    match name {
        "stroke-linejoin" if value == "arcs" => Some("joins of the kind arcs are not drawn: mitered instead".to_owned()),
        "vector-effect" if value == "non-scaling-stroke" => Some("strokes that do not scale are not drawn: scaled instead".to_owned()),
        "clip-path" if other(value) => Some(format!("clip paths of the kind {} are not drawn: not clipped", quoted(value))),
        "mask" | "mask-image" if other(value) => Some(format!("masks of the kind {} are not drawn: not masked", quoted(value))),
        "transform" if other(value) && value.parse::<svgtypes::Transform>().is_err() => {
            Some(format!("the transform {} is not understood: left out", quoted(value)))
        }
        "d" | "points" | "style" | "class" | "id" | "href" => None,
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
