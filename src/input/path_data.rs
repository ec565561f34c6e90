//! SVG path data to a [`Path`], in 64-bit.
//!
//! The text is cut by `svgtypes`; here relative commands become absolute, smooth curves get their reflected control point, arcs become
//! cubics. Unlike in an SVG, where a path is drawn up to its first error, an error refuses the whole.

use svgtypes::{PathParser, PathSegment};

use super::arc::Arc;
use crate::grid::Point;
use crate::shape::Path;

/// What is wrong with path data.
#[derive(Debug, PartialEq)]
pub(super) struct Fault {
    /// Where, in characters from 1, if it is known.
    pub(super) character: Option<usize>,
    /// What is wrong and what to do.
    pub(super) what: String,
    /// Whether it is past the limit.
    pub(super) limit: bool,
}

/// Reads path data. The path has at most `limit` verbs.
pub(super) fn parse(text: &str, limit: u64) -> Result<Path, Fault> {
    let mut pen = Pen { path: Path::default(), at: [0.0; 2], start: [0.0; 2], control: Control::None, closed: true, checked: 0 };
    for (i, segment) in PathParser::from(text).enumerate() {
        pen.draw(segment.map_err(|e| fault(text, &e))?);
        if !pen.finite() {
            let what = format!("segment {} leaves the range of 64-bit numbers: use smaller coordinates", i + 1);
            return Err(Fault { character: None, what, limit: false });
        }
        if pen.path.verbs().len() as u64 > limit {
            let what = format!("more than {limit} lines and curves: raise the limit or split the drawing");
            return Err(Fault { character: None, what, limit: true });
        }
    }
    Ok(pen.path)
}

/// The control point that a smooth curve reflects.
enum Control {
    None,
    Quad(Point),
    Cubic(Point),
}

struct Pen {
    path: Path,
    at: Point,
    start: Point,
    control: Control,
    /// No subpath is open: the next segment that draws begins one.
    closed: bool,
    /// How many points are known to be finite.
    checked: usize,
}

impl Pen {
    fn draw(&mut self, segment: PathSegment) {
        let base = if segment.is_abs() { [0.0; 2] } else { self.at };
        let point = |x, y| [base[0] + x, base[1] + y];
        let control = std::mem::replace(&mut self.control, Control::None);
        match segment {
            PathSegment::MoveTo { x, y, .. } => {
                self.at = point(x, y);
                self.start = self.at;
                self.closed = true;
            }
            PathSegment::LineTo { x, y, .. } => self.line(point(x, y)),
            PathSegment::HorizontalLineTo { x, .. } => self.line([base[0] + x, self.at[1]]),
            PathSegment::VerticalLineTo { y, .. } => self.line([self.at[0], base[1] + y]),
            PathSegment::CurveTo { x1, y1, x2, y2, x, y, .. } => self.cubic(point(x1, y1), point(x2, y2), point(x, y)),
            PathSegment::SmoothCurveTo { x2, y2, x, y, .. } => {
                let first = if let Control::Cubic(c) = control { self.reflected(c) } else { self.at };
                self.cubic(first, point(x2, y2), point(x, y));
            }
            PathSegment::Quadratic { x1, y1, x, y, .. } => self.quad(point(x1, y1), point(x, y)),
            PathSegment::SmoothQuadratic { x, y, .. } => {
                let middle = if let Control::Quad(c) = control { self.reflected(c) } else { self.at };
                self.quad(middle, point(x, y));
            }
            PathSegment::EllipticalArc { rx, ry, x_axis_rotation, large_arc, sweep, x, y, .. } => {
                let to = point(x, y);
                self.begin();
                let arc = Arc { from: self.at, to, radii: [rx, ry], rotation: x_axis_rotation, large: large_arc, sweep };
                arc.cubics(|c, d, p| self.path.cubic_to(c, d, p));
                self.at = to;
            }
            PathSegment::ClosePath { .. } => {
                self.begin();
                self.path.close();
                self.at = self.start;
                self.closed = true;
            }
        }
    }

    fn begin(&mut self) {
        if std::mem::replace(&mut self.closed, false) {
            self.path.move_to(self.at);
        }
    }

    fn line(&mut self, p: Point) {
        self.begin();
        self.path.line_to(p);
        self.at = p;
    }

    fn quad(&mut self, c: Point, p: Point) {
        self.begin();
        self.path.quad_to(c, p);
        self.control = Control::Quad(c);
        self.at = p;
    }

    fn cubic(&mut self, c: Point, d: Point, p: Point) {
        self.begin();
        self.path.cubic_to(c, d, p);
        self.control = Control::Cubic(d);
        self.at = p;
    }

    fn reflected(&self, c: Point) -> Point {
        [2.0 * self.at[0] - c[0], 2.0 * self.at[1] - c[1]]
    }

    /// Whether all that the last segment added is finite.
    fn finite(&mut self) -> bool {
        let points = self.path.points();
        let new = &points[self.checked..];
        self.checked = points.len();
        new.iter().chain([&self.at]).all(|p| p[0].is_finite() && p[1].is_finite())
    }
}

fn fault(text: &str, error: &svgtypes::Error) -> Fault {
    let (character, what) = match *error {
        svgtypes::Error::UnexpectedData(1) => (1, "path data begin with M"),
        svgtypes::Error::UnexpectedData(at) => {
            (at, "expected a command (M L H V C S Q T A Z) with its numbers, or a flag 0 or 1 in an arc")
        }
        svgtypes::Error::InvalidNumber(at) => (at, "expected a finite number"),
        _ => (text.chars().count() + 1, "the path data end within a command: add its numbers"),
    };
    Fault { character: Some(character), what: what.to_owned(), limit: false }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Verb;

    #[test]
    fn relative_smooth_and_short_forms() {
        let long = "M 10 20 L 15 20 L 15 30 C 1 2 3 4 5 6 C 7 8 1 1 2 2 Q 3 5 4 4 Q 5 3 6 4 Z M 10 20 L 11 21";
        let short = "m10 20h5v10C1 2 3 4 5 6S1 1 2 2Q3 5 4 4T6 4zl1 1";
        assert_eq!(parse(long, 99), parse(short, 99));
        // A smooth curve after something else takes the current point.
        assert_eq!(parse("M1 1L2 3S5 5 6 6T8 8", 99), parse("M1 1L2 3C2 3 5 5 6 6Q6 6 8 8", 99));
        assert_eq!(parse("M1 1 2 2 3 3", 99), parse("M1 1L2 2L3 3", 99));
        assert_eq!(parse("m1 1 2 2", 99), parse("M1 1L3 3", 99));
    }

    #[test]
    fn a_move_alone_draws_nothing() {
        for text in ["", "  ", "M 1 2", "M1 2M3 4"] {
            assert_eq!(parse(text, 9).unwrap().verbs(), [], "{text}");
        }
        assert_eq!(parse("M1 2Z", 9).unwrap().verbs(), [Verb::Move, Verb::Close]);
    }

    #[test]
    fn errors_point_into_the_text() {
        let table = [
            ("L 1 1", Some(1), "path data begin with M"),
            ("M 1", Some(4), "the path data end within a command: add its numbers"),
            ("M 1 x", Some(5), "expected a finite number"),
            ("M 1 1e999", Some(5), "expected a finite number"),
            ("M 1 1 Z 5", Some(9), "expected a command (M L H V C S Q T A Z) with its numbers, or a flag 0 or 1 in an arc"),
            ("M 1 1 ü", Some(7), "expected a command (M L H V C S Q T A Z) with its numbers, or a flag 0 or 1 in an arc"),
            ("M0 0A1 1 0 2 1 5 5", Some(12), "expected a command (M L H V C S Q T A Z) with its numbers, or a flag 0 or 1 in an arc"),
            ("M1e308 0l1e308 0", None, "segment 2 leaves the range of 64-bit numbers: use smaller coordinates"),
            ("M0 0A1e-320 1 0 0 1 9 9", None, "segment 2 leaves the range of 64-bit numbers: use smaller coordinates"),
            ("M0 0C9 9 1e308 0 -1e308 0S 0 0 0 0", None, "segment 3 leaves the range of 64-bit numbers: use smaller coordinates"),
        ];
        for (text, character, what) in table {
            let fault = parse(text, 99).expect_err(text);
            assert_eq!((fault.character, fault.what.as_str()), (character, what), "{text}");
        }
        assert!(parse("M0 0L1 1L2 2", 2).unwrap_err().limit);
    }
}
