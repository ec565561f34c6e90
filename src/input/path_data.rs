//! SVG path data to a [`Path`].
//!
//! The text is cut by [`Scanner`]; here relative commands become absolute, smooth curves get their reflected control point, arcs become
//! cubics, all in 64-bit. In a scene an error refuses the whole; in an SVG a path is drawn up to its first error.

use super::arc::Arc;
use super::scan::{Scanner, Stop};
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

/// Reads path data of a scene. The path has at most `limit` verbs.
pub(super) fn parse(text: &str, limit: u64) -> Result<Path, Fault> {
    let mut scanner = Scanner::new(text);
    let mut pen = Pen::<false>::new(text);
    let mut segments = 0;
    while let Some(command) = scanner.command().map_err(|stop| fault(text, stop))? {
        segments += 1;
        pen.draw(command, &mut scanner).map_err(|stop| fault(text, stop))?;
        if !pen.finite {
            let what = format!("segment {segments} leaves the range of 64-bit numbers: use smaller coordinates");
            return Err(Fault { character: None, what, limit: false });
        }
        if pen.path.verbs().len() as u64 > limit {
            let what = format!("more than {limit} lines and curves: raise the limit or split the drawing");
            return Err(Fault { character: None, what, limit: true });
        }
    }
    Ok(pen.end())
}

/// A path as `usvg` reads it.
pub(super) struct Single {
    /// The path; every coordinate is that of a 32-bit number.
    pub(super) path: Path,
    /// Whether the text has no error, and all numbers are below 10^18 and written without an exponent.
    pub(super) plain: bool,
}

/// Reads path data of an SVG up to their first error. None if `usvg` makes nothing of them, or something else: arcs are cubics of its own.
pub(super) fn parse_single(text: &str) -> Option<Single> {
    let mut scanner = Scanner::new(text);
    let mut pen = Pen::<true>::new(text);
    let whole = loop {
        match scanner.command() {
            Ok(Some(b'A' | b'a')) => return None,
            Ok(Some(command)) if pen.draw(command, &mut scanner).is_ok() => {}
            end => break end == Ok(None),
        }
        if !pen.finite {
            return None;
        }
    };
    if pen.moved {
        pen.begin();
    }
    let path = pen.end();
    (path.verbs().len() > 1).then_some(Single { path, plain: scanner.plain && whole })
}

/// The control point that a smooth curve reflects.
enum Control {
    None,
    Quad(Point),
    Cubic(Point),
}

/// Draws a path; with `SINGLE` its coordinates are rounded to 32-bit where they go into the path.
struct Pen<const SINGLE: bool> {
    path: Path,
    at: Point,
    start: Point,
    control: Control,
    /// No subpath is open: the next segment that draws begins one.
    closed: bool,
    /// The last segment was a move.
    moved: bool,
    /// Whether all points so far are.
    finite: bool,
}

impl<const SINGLE: bool> Pen<SINGLE> {
    /// A pen for a text.
    fn new(text: &str) -> Self {
        // An estimate: coordinates of seven characters. What is not used is given back at the end.
        let mut path = Path::default();
        path.reserve(text.len() / 16);
        Pen { path, at: [0.0; 2], start: [0.0; 2], control: Control::None, closed: true, moved: false, finite: true }
    }

    /// Draws a segment.
    fn draw(&mut self, command: u8, scanner: &mut Scanner<'_>) -> Result<(), Stop> {
        let at = self.at;
        let relative = command.is_ascii_lowercase();
        let place = |x: f64, y: f64| if relative { [at[0] + x, at[1] + y] } else { [x, y] };
        let mut point = || Ok::<Point, Stop>(place(scanner.number()?, scanner.number()?));
        let control = std::mem::replace(&mut self.control, Control::None);
        match command.to_ascii_lowercase() {
            b'l' => {
                let to = point()?;
                self.line(to);
            }
            b'm' => {
                self.at = point()?;
                self.held(self.at);
                self.start = self.at;
                self.closed = true;
                self.moved = true;
            }
            b'h' => {
                let x = scanner.number()?;
                self.line([place(x, 0.0)[0], at[1]]);
            }
            b'v' => {
                let y = scanner.number()?;
                self.line([at[0], place(0.0, y)[1]]);
            }
            b'c' => {
                let [c, d, to] = [point()?, point()?, point()?];
                self.cubic(c, d, to);
            }
            b's' => {
                let [d, to] = [point()?, point()?];
                let first = if let Control::Cubic(c) = control { self.reflected(c) } else { at };
                self.cubic(first, d, to);
            }
            b'q' => {
                let [c, to] = [point()?, point()?];
                self.quad(c, to);
            }
            b't' => {
                let to = point()?;
                let middle = if let Control::Quad(c) = control { self.reflected(c) } else { at };
                self.quad(middle, to);
            }
            b'a' => {
                let radii = [scanner.number()?, scanner.number()?];
                let rotation = scanner.number()?;
                let [large, sweep] = [scanner.flag()?, scanner.flag()?];
                let to = place(scanner.number()?, scanner.number()?);
                self.begin();
                let arc = Arc { from: at, to, radii, rotation, large, sweep };
                arc.cubics(|c, d, p| {
                    let [c, d, p] = [c, d, p].map(|p| self.held(p));
                    self.path.cubic_to(c, d, p);
                });
                self.held(to);
                self.at = to;
            }
            _ => {
                // To `usvg` a path that is closed twice is closed once.
                if !(SINGLE && self.closed && !self.moved) {
                    self.begin();
                    self.path.close();
                }
                self.at = self.start;
                self.closed = true;
            }
        }
        Ok(())
    }

    fn begin(&mut self) {
        self.moved = false;
        if std::mem::replace(&mut self.closed, false) {
            let at = self.held(self.at);
            self.path.move_to(at);
        }
    }

    fn line(&mut self, p: Point) {
        self.begin();
        let held = self.held(p);
        self.path.line_to(held);
        self.at = p;
    }

    fn quad(&mut self, c: Point, p: Point) {
        self.begin();
        let held = [c, p].map(|p| self.held(p));
        self.path.quad_to(held[0], held[1]);
        self.control = Control::Quad(c);
        self.at = p;
    }

    fn cubic(&mut self, c: Point, d: Point, p: Point) {
        self.begin();
        let held = [c, d, p].map(|p| self.held(p));
        self.path.cubic_to(held[0], held[1], held[2]);
        self.control = Control::Cubic(d);
        self.at = p;
    }

    fn reflected(&self, c: Point) -> Point {
        [2.0 * self.at[0] - c[0], 2.0 * self.at[1] - c[1]]
    }

    /// A point as the path keeps it.
    fn held(&mut self, p: Point) -> Point {
        let held = if SINGLE { p.map(|v| f64::from(v as f32)) } else { p };
        self.finite &= held[0].is_finite() & held[1].is_finite();
        held
    }

    fn end(mut self) -> Path {
        self.path.shrink_to_fit();
        self.path
    }
}

fn fault(text: &str, stop: Stop) -> Fault {
    let (byte, what) = match stop {
        Stop::Start(at) => (at, "path data begin with M"),
        Stop::Command(at) => (at, "expected a command (M L H V C S Q T A Z) with its numbers, or a flag 0 or 1 in an arc"),
        Stop::Number(at) => (at, "expected a finite number"),
        Stop::End => (text.len(), "the path data end within a command: add its numbers"),
    };
    Fault { character: Some(text[..byte].chars().count() + 1), what: what.to_owned(), limit: false }
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
