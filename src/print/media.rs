//! Sizes of media and their names (PWG 5101.1), in hundredths of a millimetre, which is IPP's unit.

use std::fmt;

/// Hundredths of a millimetre to an inch.
pub const INCH: f64 = 2540.0;

/// How far apart two sizes may be that count as the same: a millimetre, what names round away.
const SAME: i32 = 100;

/// A size that a printer has, or the sizes that it takes of a roll.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Medium {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Smallest and largest width.
    pub width: (i32, i32),
    /// Smallest and largest length.
    pub height: (i32, i32),
    /// What the printer cannot reach: top, right, bottom, left.
    pub margins: [i32; 4],
    /// Whether it lies in the printer.
    pub ready: bool,
    /// The tray that it lies in.
    pub source: Option<String>,
}

/// A medium to print on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chosen {
    /// Its name; a size of a roll has none.
    pub name: Option<String>,
    /// Width and height in hundredths of a millimetre.
    pub size: [i32; 2],
    /// Top, right, bottom, left.
    pub margins: [i32; 4],
    /// Whether the printer knows this size by its name.
    pub named: bool,
}

impl Medium {
    /// Whether the sizes that it has hold this one, within a millimetre.
    pub fn is(&self, [width, height]: [i32; 2]) -> bool {
        let within = |(least, most): (i32, i32), x: i32| (least - SAME..=most + SAME).contains(&x);
        within(self.width, width) && within(self.height, height)
    }

    /// Whether it has more than one size.
    pub fn is_roll(&self) -> bool {
        self.width.0 != self.width.1 || self.height.0 != self.height.1
    }

    /// The size of it that is nearest to this one.
    pub fn sized(&self, [width, height]: [i32; 2]) -> Chosen {
        let clamp = |(least, most): (i32, i32), x: i32| x.clamp(least, most);
        let name = self.name.clone().filter(|_| !self.is_roll());
        Chosen { named: name.is_some(), name, size: [clamp(self.width, width), clamp(self.height, height)], margins: self.margins }
    }
}

impl fmt::Display for Chosen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.size.map(|x| f64::from(x) / 100.0);
        match &self.name {
            Some(name) => f.write_str(name),
            None => write!(f, "{width} x {height} mm"),
        }
    }
}

/// The size that a self-describing name tells, such as `iso_a4_210x297mm` or `na_letter_8.5x11in`; in roll sizes (`roll_max_…`, `custom_min_…`) too.
pub fn size_of(name: &str) -> Option<[i32; 2]> {
    let last = name.rsplit('_').next()?;
    let (numbers, unit) = match (last.strip_suffix("mm"), last.strip_suffix("in")) {
        (Some(numbers), _) => (numbers, 100.0),
        (_, Some(numbers)) => (numbers, INCH),
        _ => return None,
    };
    let (width, height) = numbers.split_once('x')?;
    let read = |text: &str| {
        let plain = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit() || b == b'.');
        let size = text.parse::<f64>().ok().filter(|size| plain && *size > 0.0)? * unit;
        // No medium is a kilometre long.
        (size <= 1e8).then(|| size.round() as i32)
    };
    Some([read(width)?, read(height)?])
}

/// Whether a name is meant by what people write: the name itself, its part in the middle (`a4`, `letter`), or its size (`210x297mm`).
pub fn is_meant(name: &str, written: &str) -> bool {
    let middle = || name.split_once('_').and_then(|(_, rest)| rest.rsplit_once('_')).map(|(middle, _)| middle);
    name.eq_ignore_ascii_case(written)
        || middle().is_some_and(|middle| middle.eq_ignore_ascii_case(written))
        || name.rsplit('_').next().is_some_and(|size| size.eq_ignore_ascii_case(written))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_sizes() {
        for (name, size) in [
            ("iso_a4_210x297mm", Some([21000, 29700])),
            ("na_letter_8.5x11in", Some([21590, 27940])),
            ("na_number-10_4.125x9.5in", Some([10478, 24130])),
            ("roll_max_36.1025x3622.0472in", Some([91700, 9_200_000])),
            ("custom_914x1200mm_914x1200mm", Some([91400, 120_000])),
            ("210x297mm", Some([21000, 29700])),
            ("iso_a4", None),
            ("x_0x5mm", None),
            ("x_1e3x5mm", None),
            ("x_-1x5mm", None),
            ("x_99999999999x5mm", None),
            ("", None),
        ] {
            assert_eq!(size_of(name), size, "{name}");
        }
        assert!(is_meant("iso_a4_210x297mm", "A4") && is_meant("iso_a4_210x297mm", "210x297mm") && !is_meant("iso_a4_210x297mm", "a"));
    }

    #[test]
    fn rolls_have_sizes_within_their_bounds() {
        let roll = Medium {
            name: Some("roll".to_owned()),
            width: (91400, 91400),
            height: (10000, 900_000),
            margins: [300; 4],
            ready: true,
            source: None,
        };
        assert!(roll.is_roll() && roll.is([91400, 120_000]) && roll.is([91350, 120_000]) && !roll.is([60000, 120_000]));
        let chosen = roll.sized([60000, 120_000]);
        assert_eq!((chosen.size, chosen.name.as_deref(), chosen.to_string().as_str()), ([91400, 120_000], None, "914 x 1200 mm"));
    }
}
