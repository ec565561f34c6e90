//! What `usvg` has in 32-bit, as it is in 64-bit.

use usvg::tiny_skia_path::PathSegment;
use usvg::{LineCap, LineJoin};

use crate::grid::Point;
use crate::shape::{Cap, Join, Path, Stroke};

/// Every point stays.
pub(super) const IDENTITY: [f64; 6] = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];

/// A transform in SVG's order of the six numbers.
pub(super) fn matrix(t: usvg::Transform) -> [f64; 6] {
    [t.sx, t.ky, t.kx, t.sy, t.tx, t.ty].map(f64::from)
}

/// The map that applies `inner` first, in SVG's order of the six numbers.
pub(super) fn product(outer: [f64; 6], inner: [f64; 6]) -> [f64; 6] {
    let ([a, b, c, d, e, f], [g, h, i, j, k, l]) = (outer, inner);
    [a * g + c * h, b * g + d * h, a * i + c * j, b * i + d * j, a * k + c * l + e, b * k + d * l + f]
}

/// How a line is stroked.
pub(super) fn stroke(line: &usvg::Stroke) -> Stroke {
    Stroke {
        width: f64::from(line.width().get()),
        join: match line.linejoin() {
            LineJoin::Miter => Join::Miter,
            LineJoin::MiterClip => Join::MiterClip,
            LineJoin::Round => Join::Round,
            LineJoin::Bevel => Join::Bevel,
        },
        cap: match line.linecap() {
            LineCap::Butt => Cap::Butt,
            LineCap::Round => Cap::Round,
            LineCap::Square => Cap::Square,
        },
        miter_limit: f64::from(line.miterlimit().get()),
        dashes: line.dasharray().unwrap_or_default().iter().copied().map(f64::from).collect(),
        dash_offset: f64::from(line.dashoffset()),
    }
}

/// The outline that a path describes.
pub(super) fn outline(path: &usvg::Path) -> Path {
    let point = |p: usvg::tiny_skia_path::Point| -> Point { [f64::from(p.x), f64::from(p.y)] };
    let mut outline = Path::default();
    for segment in path.data().segments() {
        match segment {
            PathSegment::MoveTo(p) => outline.move_to(point(p)),
            PathSegment::LineTo(p) => outline.line_to(point(p)),
            PathSegment::QuadTo(c, p) => outline.quad_to(point(c), point(p)),
            PathSegment::CubicTo(c, d, p) => outline.cubic_to(point(c), point(d), point(p)),
            PathSegment::Close => outline.close(),
        }
    }
    outline.shrink_to_fit();
    outline
}
