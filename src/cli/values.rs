//! Values of options: text to numbers within bounds, with messages that say what is allowed.

use std::ops::RangeInclusive;
use std::time::Duration;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use runset::encode::{Compression, FORMATS, Format, by_name, variants};
use runset::job::TOLERANCES;
use runset::mesh::stl;

/// What an output holds.
#[derive(Clone, Copy)]
pub enum Content {
    /// A raster in a format.
    Raster(&'static Format),
    /// The surface of a model, as STL.
    Surface,
}

/// The name of a format.
pub fn format() -> impl TypedValueParser<Value = Content> {
    let names = FORMATS.iter().map(|format| (format.name, format.about)).chain([(stl::NAME, stl::ABOUT)]);
    PossibleValuesParser::new(names.map(|(name, about)| PossibleValue::new(name).help(about)))
        .map(|name| by_name(&name).map_or(Content::Surface, Content::Raster))
}

/// The name of a compression that some format has.
pub fn compression() -> impl TypedValueParser<Value = String> {
    let mut all: Vec<Compression> = Vec::new();
    for compression in variants().filter_map(|format| format.compression) {
        if all.iter().all(|known| known.name != compression.name) {
            all.push(compression);
        }
    }
    PossibleValuesParser::new(all.into_iter().map(|compression| PossibleValue::new(compression.name).help(compression.about)))
}

/// A whole number within bounds.
pub fn whole(allowed: RangeInclusive<u32>) -> impl Fn(&str) -> Result<u32, String> + Clone + Send + Sync + 'static {
    move |text| {
        let what = || format!("give a whole number from {} to {}", allowed.start(), allowed.end());
        text.parse().ok().filter(|n| allowed.contains(n)).ok_or_else(what)
    }
}

/// A positive finite number: a scale or dots an inch.
pub fn positive(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x: &f64| x.is_finite() && *x > 0.0).ok_or_else(|| "give a number above 0, such as 2 or 0.5".to_owned())
}

/// A flattening tolerance in pixels, one of [`TOLERANCES`].
pub fn tolerance(text: &str) -> Result<f64, String> {
    let allowed = || format!("give a number of pixels from {} to {}", TOLERANCES.start(), TOLERANCES.end());
    text.parse().ok().filter(|x| TOLERANCES.contains(x)).ok_or_else(allowed)
}

/// A time in seconds, above 0.
pub fn seconds(text: &str) -> Result<Duration, String> {
    let time = positive(text).ok().and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    time.ok_or_else(|| "give a number of seconds above 0, such as 30 or 0.5".to_owned())
}

/// A number of bytes, at least 1, with an optional suffix k, M or G (powers of 1024).
pub fn bytes(text: &str) -> Result<u64, String> {
    let (digits, shift) = match text.char_indices().next_back() {
        Some((at, 'k' | 'K')) => (&text[..at], 10),
        Some((at, 'm' | 'M')) => (&text[..at], 20),
        Some((at, 'g' | 'G')) => (&text[..at], 30),
        _ => (text, 0),
    };
    let bytes = digits.parse().ok().and_then(|n: u64| n.checked_mul(1 << shift)).filter(|&n| n > 0);
    bytes.ok_or_else(|| "give a number of bytes such as 1000000, 512k, 128M or 2G".to_owned())
}

/// A number of bytes for people, in the notation that [`bytes`] reads.
pub fn show_bytes(bytes: u64) -> String {
    let (shift, suffix) = match bytes.trailing_zeros() {
        30.. => (30, "G"),
        20.. => (20, "M"),
        10.. => (10, "k"),
        _ => (0, ""),
    };
    format!("{}{suffix}", bytes >> shift)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_bytes() {
        for (text, expected) in [("1", 1), ("512k", 524_288), ("128M", 134_217_728), ("128m", 134_217_728), ("2G", 2_147_483_648)] {
            assert_eq!(bytes(text), Ok(expected), "{text}");
        }
        for text in ["", "0", "k", "-1", "1.5M", "1T", "1é", "18446744073709551616", "18014398509481984k"] {
            assert!(bytes(text).is_err(), "{text}");
        }
        for n in [1, 1023, 1024, 3 << 20, 5 << 30, (5 << 30) + 1] {
            assert_eq!(bytes(&show_bytes(n)), Ok(n));
        }
    }

    #[test]
    fn numbers_that_are_none_are_refused() {
        assert_eq!(positive("0.5"), Ok(0.5));
        for text in ["0", "-1", "nan", "inf", "1e999", "", "1px"] {
            assert!(positive(text).is_err(), "{text}");
        }
        assert_eq!((tolerance("0.001"), tolerance("16")), (Ok(0.001), Ok(16.0)));
        for text in ["0.0009", "16.1", "nan", "0"] {
            assert!(tolerance(text).is_err(), "{text}");
        }
    }
}
