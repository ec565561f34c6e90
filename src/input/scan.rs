//! Path data cut into commands and numbers (SVG 2, section 9.3).
//!
//! What is taken and where an error lies is as `svgtypes` has it, which the tests compare it with. A number of up to 19 digits is gathered into an integer
//! while it is read; that integer and a power of ten which a double holds exactly give the nearest double by one multiplication or division (Clinger,
//! "How to read floating point numbers accurately", 1990). Other numbers take the standard library's way.

/// Why path data end early. Offsets are in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    /// The data do not begin with M.
    Start(usize),
    /// Neither a command nor a number that goes on with the last one, or no flag.
    Command(usize),
    /// Not a finite number.
    Number(usize),
    /// The data end within a command.
    End,
}

/// Reads path data from front to back.
pub(super) struct Scanner<'t> {
    text: &'t str,
    bytes: &'t [u8],
    at: usize,
    command: Option<u8>,
    /// Whether all numbers so far are below 10^18 and written without an exponent.
    pub(super) plain: bool,
}

/// Powers of ten that a double holds exactly.
const POWERS: [f64; 23] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22];

impl<'t> Scanner<'t> {
    pub(super) fn new(text: &'t str) -> Scanner<'t> {
        Scanner { text, bytes: text.as_bytes(), at: 0, command: None, plain: true }
    }

    /// The command of the next segment, written or implied; none at the end.
    pub(super) fn command(&mut self) -> Result<Option<u8>, Stop> {
        self.skip_spaces();
        let Some(byte) = self.peek() else { return Ok(None) };
        match (byte, self.command) {
            (b'M' | b'm', _) => {}
            (_, None) => return Err(Stop::Start(self.at)),
            (
                b'Z' | b'z' | b'L' | b'l' | b'H' | b'h' | b'V' | b'v' | b'C' | b'c' | b'S' | b's' | b'Q' | b'q' | b'T' | b't' | b'A' | b'a',
                _,
            ) => {}
            (_, Some(b'Z' | b'z')) => return Err(Stop::Command(self.at)),
            (b'0'..=b'9' | b'.' | b'-' | b'+', Some(last)) => {
                return Ok(Some(match last {
                    b'M' => b'L',
                    b'm' => b'l',
                    other => other,
                }));
            }
            _ => return Err(Stop::Command(self.at)),
        }
        self.at += 1;
        self.command = Some(byte);
        Ok(self.command)
    }

    /// A number of a list.
    pub(super) fn number(&mut self) -> Result<f64, Stop> {
        if self.at >= self.bytes.len() {
            return Err(Stop::End);
        }
        self.skip_spaces();
        let value = self.value()?;
        self.skip_spaces();
        self.at += usize::from(self.peek() == Some(b','));
        Ok(value)
    }

    /// A flag of an arc, for which one character suffices.
    pub(super) fn flag(&mut self) -> Result<bool, Stop> {
        self.skip_spaces();
        let set = match self.peek().ok_or(Stop::End)? {
            b'0' => false,
            b'1' => true,
            _ => return Err(Stop::Command(self.at)),
        };
        self.at += 1;
        self.at += usize::from(self.peek() == Some(b','));
        self.skip_spaces();
        Ok(set)
    }

    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn skip_spaces(&mut self) {
        while let Some(b' ' | b'\t' | b'\n' | b'\r') = self.peek() {
            self.at += 1;
        }
    }

    fn value(&mut self) -> Result<f64, Stop> {
        let start = self.at;
        let negative = self.peek() == Some(b'-');
        self.at += usize::from(negative || self.peek() == Some(b'+'));
        let mut digits = 0_u64;
        let before = self.at;
        self.digits(&mut digits);
        let mut count = self.at - before;
        let mut fraction = 0;
        if self.peek() == Some(b'.') {
            self.at += 1;
            let point = self.at;
            self.digits(&mut digits);
            fraction = self.at - point;
            count += fraction;
        }
        let exponent = matches!(self.peek(), Some(b'e' | b'E')) && !matches!(self.bytes.get(self.at + 1), Some(b'm' | b'x'));
        if !exponent && (1..=19).contains(&count) && digits <= 1 << 53 {
            let value = digits as f64 / POWERS[fraction];
            self.plain &= value < 1e18;
            return Ok(if negative { -value } else { value });
        }
        if exponent {
            self.at += 1;
            self.at += usize::from(matches!(self.peek(), Some(b'-' | b'+')));
            self.digits(&mut 0);
        }
        self.plain = false;
        match self.text[start..self.at].parse() {
            Ok(value) if f64::is_finite(value) => Ok(value),
            _ => Err(Stop::Number(start)),
        }
    }

    /// Appends the digits that follow to a number; what does not fit wraps around. Eight are taken at once where eight bytes are left.
    fn digits(&mut self, number: &mut u64) {
        while let Some(&eight) = self.bytes.get(self.at..).and_then(|rest| rest.first_chunk::<8>()) {
            let (count, value) = leading(u64::from_le_bytes(eight));
            *number = number.wrapping_mul(TENS[count]).wrapping_add(value);
            self.at += count;
            if count < 8 {
                return;
            }
        }
        while let Some(digit) = self.peek().map(|b| b.wrapping_sub(b'0')).filter(|&d| d < 10) {
            *number = number.wrapping_mul(10).wrapping_add(u64::from(digit));
            self.at += 1;
        }
    }
}

/// Powers of ten up to that of eight digits.
const TENS: [u64; 9] = [1, 10, 100, 1000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];

/// How many of eight bytes, from the lowest on, are digits, and the number that these are.
fn leading(bytes: u64) -> (usize, u64) {
    let digits = bytes ^ 0x3030_3030_3030_3030;
    // The highest bit of a byte tells that it is above 9; what is carried goes only into bytes behind the first such.
    let others = (digits.wrapping_add(0x7676_7676_7676_7676) | digits) & 0x8080_8080_8080_8080;
    let bits = others.trailing_zeros() & !7;
    // Zeros in front; then neighbours are joined: to pairs, fours, and all eight.
    let eight = digits.unbounded_shl(64 - bits);
    let pairs = eight.wrapping_mul(10).wrapping_add(eight >> 8);
    let mask = 0x0000_00ff_0000_00ff;
    let first = (pairs & mask).wrapping_mul(100 + (1_000_000 << 32));
    let second = (pairs >> 16 & mask).wrapping_mul(1 + (10_000 << 32));
    ((bits / 8) as usize, first.wrapping_add(second) >> 32)
}

#[cfg(test)]
mod tests {
    use svgtypes::{PathParser, PathSegment};

    use super::*;

    /// The numbers of segments with their commands, and where the text goes wrong, in characters.
    type Read = (Vec<(u8, Vec<f64>)>, Option<Option<usize>>);

    fn ours(text: &str) -> Read {
        let mut scanner = Scanner::new(text);
        let mut segments = Vec::new();
        let mut segment = || {
            let Some(command) = scanner.command()? else { return Ok(false) };
            let numbers = match command.to_ascii_lowercase() {
                b'm' | b'l' | b't' => 2,
                b'h' | b'v' => 1,
                b'c' => 6,
                b's' | b'q' => 4,
                b'a' => 7,
                _ => 0,
            };
            let number = |i| match i {
                3 | 4 if numbers == 7 => scanner.flag().map(f64::from),
                _ => scanner.number(),
            };
            segments.push((command, (0..numbers).map(number).collect::<Result<_, Stop>>()?));
            Ok(true)
        };
        let stop = loop {
            match segment() {
                Ok(true) => {}
                Ok(false) => break None,
                Err(Stop::End) => break Some(None),
                Err(Stop::Start(at) | Stop::Command(at) | Stop::Number(at)) => break Some(Some(text[..at].chars().count() + 1)),
            }
        };
        (segments, stop)
    }

    fn theirs(text: &str) -> Read {
        let mut segments = Vec::new();
        for segment in PathParser::from(text) {
            let segment = match segment {
                Ok(segment) => segment,
                Err(svgtypes::Error::UnexpectedData(at) | svgtypes::Error::InvalidNumber(at)) => return (segments, Some(Some(at))),
                Err(_) => return (segments, Some(None)),
            };
            let numbers = match segment {
                PathSegment::MoveTo { x, y, .. } | PathSegment::LineTo { x, y, .. } | PathSegment::SmoothQuadratic { x, y, .. } => {
                    vec![x, y]
                }
                PathSegment::HorizontalLineTo { x, .. } => vec![x],
                PathSegment::VerticalLineTo { y, .. } => vec![y],
                PathSegment::CurveTo { x1, y1, x2, y2, x, y, .. } => vec![x1, y1, x2, y2, x, y],
                PathSegment::SmoothCurveTo { x2, y2, x, y, .. } => vec![x2, y2, x, y],
                PathSegment::Quadratic { x1, y1, x, y, .. } => vec![x1, y1, x, y],
                PathSegment::EllipticalArc { rx, ry, x_axis_rotation, large_arc, sweep, x, y, .. } => {
                    vec![rx, ry, x_axis_rotation, f64::from(large_arc), f64::from(sweep), x, y]
                }
                PathSegment::ClosePath { .. } => vec![],
            };
            segments.push((segment.command(), numbers));
        }
        (segments, None)
    }

    #[test]
    fn path_data_are_cut_as_svgtypes_cuts_them() {
        let parts = [
            "M",
            "m",
            "L",
            "l",
            "H",
            "v",
            "C",
            "s",
            "Q",
            "t",
            "A",
            "a",
            "Z",
            "z",
            " ",
            ",",
            "\n",
            "-",
            "+",
            ".",
            "0",
            "1",
            "9",
            "17",
            "0.1",
            "-.5",
            "5.",
            "1e5",
            "1e-5",
            "2E+",
            "3e",
            "4em",
            "123456789012345678901234567890",
            "0.0000000000000000000000001",
            "9007199254740993",
            "1e999",
            "é",
            "x",
            "0 0 1 1 0 10 10",
            "1 2",
            " 3,4 ",
            "M1 1",
            "L 5-6",
            "Z ",
        ];
        let mut state = 1_u64;
        let mut random = |n: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % n
        };
        for round in 0..200_000 {
            let begin = if round % 8 == 0 { "" } else { "M1 2" };
            let text: String = std::iter::once(begin).chain((0..random(9)).map(|_| parts[random(parts.len())])).collect();
            assert_eq!(ours(&text), theirs(&text), "{text:?}");
        }
    }

    #[test]
    fn eight_bytes_are_read_as_one_by_one() {
        for text in [
            "        ",
            "1       ",
            "12345678",
            "00000001",
            "99999999",
            "123.5678",
            "1234567/",
            "1234567:",
            "12\u{80}4567",
            "9\u{7ff}9\u{7ff}99",
        ] {
            let count = text.bytes().take_while(u8::is_ascii_digit).count();
            let value = text[..count].parse().unwrap_or(0);
            assert_eq!(leading(u64::from_le_bytes(*text.as_bytes().first_chunk().unwrap())), (count, value), "{text}");
        }
    }

    #[test]
    fn numbers_are_the_nearest_doubles() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state >> 11
        };
        for round in 0..200_000 {
            let whole = random() >> (random() % 53);
            let places = (random() % 20) as usize;
            let fraction = random().to_string() + &random().to_string();
            let text = if round % 9 == 0 {
                format!("{whole}e{}", random() % 40)
            } else {
                format!("-{whole}.{}", &fraction[..places.min(fraction.len())])
            };
            assert_eq!(Scanner::new(&text).number().map(f64::to_bits), Ok(text.parse::<f64>().unwrap().to_bits()), "{text}");
        }
    }
}
