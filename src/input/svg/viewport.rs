//! Where `svg`, `symbol` and `use` put what they hold, and how large the page is, in 64-bit.
//!
//! `usvg` multiplies an element's transform, its place and the map from its `viewBox` in 32-bit, with an error of some hundredths of a pixel on large pages. Here
//! the product is worked out again from the document, and taken where it agrees with that of `usvg` but for rounding. So whatever `usvg`
//! knows better (lengths in `em`, sizes that come from far outside, origins of transforms) stays as it has it.

use svgtypes::{Align, AspectRatio, Length, LengthUnit, ViewBox};
use usvg::roxmltree::Node;

use super::geometry::{IDENTITY, product};
use super::style::Styles;
use super::{attribute, is_svg, transform};

/// Largest difference to a product of rounded numbers, relative to its terms: some steps of 24 bits.
const ROUNDING: f64 = 1e-6;

/// What an element says of the coordinates of its content.
#[derive(Debug)]
pub(super) struct Viewport {
    /// Whether it is a `use`, whose place and size count for a symbol, and whose size counts for an `svg`.
    is_use: bool,
    is_symbol: bool,
    transform: [f64; 6],
    /// Place and size, as far as they are known.
    place: [Option<f64>; 2],
    size: [Option<f64>; 2],
    view_box: Option<(ViewBox, AspectRatio)>,
}

impl Viewport {
    /// That of an `svg`, `symbol` or `use`; other elements have none.
    pub(super) fn read<'a>(node: Node<'a, '_>, styles: &Styles<'a>) -> Option<Viewport> {
        let name = node.tag_name().name();
        if !is_svg(node) || !matches!(name, "svg" | "symbol" | "use") {
            return None;
        }
        let view_box = view_box(node).filter(|_| name != "use");
        let is_root = node.parent_element().is_none();
        let around = match &view_box {
            Some((own, _)) if is_root => [Some(own.w), Some(own.h)],
            _ => around(node),
        };
        let written = styles.declaration(node, "transform").or_else(|| attribute(node, "transform"));
        let whole = "100%";
        let mut size = [length(node, "width", whole, around[0]), length(node, "height", whole, around[1])];
        if let (true, Some((own, _))) = (is_root, &view_box) {
            // What is not given follows from the other.
            match (size, ["width", "height"].map(|name| attribute(node, name).is_some())) {
                ([Some(width), _], [true, false]) => size[1] = Some(own.h * width / own.w),
                ([_, Some(height)], [false, true]) => size[0] = Some(own.w * height / own.h),
                _ => {}
            }
        }
        let place = [length(node, "x", "0", around[0]), length(node, "y", "0", around[1])];
        Some(Viewport {
            is_use: name == "use",
            is_symbol: name == "symbol",
            transform: written.map_or(Some(IDENTITY), transform::matrix)?,
            place: if is_root { [Some(0.0); 2] } else { place },
            size,
            view_box,
        })
    }

    /// The size of a page, which is about the given one.
    pub(super) fn page(&self, given: [f64; 2]) -> [f64; 2] {
        let agrees = |i: usize| self.size[i].filter(|own| (own - given[i]).abs() <= ROUNDING * own);
        [0, 1].map(|i| agrees(i).unwrap_or(given[i]))
    }

    /// The matrix that a group of this element has, which is about the given one. `user` is the `use` around it.
    pub(super) fn refined(&self, given: [f64; 6], user: Option<&Viewport>) -> [f64; 6] {
        let Some(host) = (if self.is_symbol { user } else { Some(self) }) else { return given };
        let sizes = [user.map(|user| user.size), Some(self.size)].into_iter().flatten();
        let inner = sizes.filter_map(|size| self.inner(host.place, size));
        let all = inner
            .flat_map(|(matrix, terms)| [(matrix, terms), (product(host.transform, matrix), product(host.transform.map(f64::abs), terms))]);
        let agrees = |(matrix, terms): &([f64; 6], [f64; 6])| (0..6).all(|i| (matrix[i] - given[i]).abs() <= ROUNDING * terms[i]);
        let mut all = all.filter(agrees);
        all.next().map_or(given, |(matrix, _)| matrix)
    }

    /// The map from the content to a viewport of that place and size, and what its terms are at most.
    fn inner(&self, place: [Option<f64>; 2], size: [Option<f64>; 2]) -> Option<([f64; 6], [f64; 6])> {
        let [x, y] = [place[0]?, place[1]?];
        let Some((ViewBox { x: left, y: top, w, h }, aspect)) = &self.view_box else {
            return Some(([1.0, 0.0, 0.0, 1.0, x, y], [1.0, 0.0, 0.0, 1.0, x.abs(), y.abs()]));
        };
        let size = [size[0]?, size[1]?];
        let scales = [size[0] / w, size[1] / h];
        let alike = if aspect.slice { scales[0].max(scales[1]) } else { scales[0].min(scales[1]) };
        let [sx, sy] = if aspect.align == Align::None { scales } else { [alike; 2] };
        let (across, down) = shares(aspect.align);
        let spare = [size[0] - w * sx, size[1] - h * sy];
        let moved = [x - left * sx + across * spare[0], y - top * sy + down * spare[1]];
        let terms = [x.abs() + (left * sx).abs() + size[0] + w * sx, y.abs() + (top * sy).abs() + size[1] + h * sy];
        Some(([sx, 0.0, 0.0, sy, moved[0], moved[1]], [sx, 0.0, 0.0, sy, terms[0], terms[1]]))
    }

    /// Itself, if it is that of a `use`.
    pub(super) fn user(&self) -> Option<&Viewport> {
        self.is_use.then_some(self)
    }
}

/// Which shares of the spare room are left of a `viewBox` and above it.
fn shares(align: Align) -> (f64, f64) {
    match align {
        Align::None | Align::XMinYMin => (0.0, 0.0),
        Align::XMidYMin => (0.5, 0.0),
        Align::XMaxYMin => (1.0, 0.0),
        Align::XMinYMid => (0.0, 0.5),
        Align::XMidYMid => (0.5, 0.5),
        Align::XMaxYMid => (1.0, 0.5),
        Align::XMinYMax => (0.0, 1.0),
        Align::XMidYMax => (0.5, 1.0),
        Align::XMaxYMax => (1.0, 1.0),
    }
}

fn view_box(node: Node<'_, '_>) -> Option<(ViewBox, AspectRatio)> {
    let own: ViewBox = attribute(node, "viewBox")?.parse().ok().filter(|own: &ViewBox| own.w > 0.0 && own.h > 0.0)?;
    let aspect = attribute(node, "preserveAspectRatio").and_then(|text| text.parse().ok()).unwrap_or_default();
    Some((own, aspect))
}

/// What percentages on an element are of, as it stands in the document: the `viewBox` or size of the `svg` around it.
fn around(node: Node<'_, '_>) -> [Option<f64>; 2] {
    let Some(outer) = node.ancestors().skip(1).find(|n| n.tag_name().name() == "svg") else { return [None; 2] };
    match view_box(outer) {
        Some((own, _)) => [Some(own.w), Some(own.h)],
        None => ["width", "height"].map(|name| length(outer, name, "100%", None)),
    }
}

/// A length in user units.
fn length(node: Node<'_, '_>, name: &str, default: &str, whole: Option<f64>) -> Option<f64> {
    let text = attribute(node, name).unwrap_or(default);
    match text.parse().ok()? {
        Length { number, unit: LengthUnit::Percent } => Some(number / 100.0 * whole?),
        _ => transform::length(text),
    }
}
