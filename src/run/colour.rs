//! Colours, and how they are spelled.

use std::fmt;

/// A colour: red, green, blue, 0 to 255.
pub type Rgb = [u8; 3];

/// The ink of a region that was given no colour.
pub const BLACK: Rgb = [0, 0, 0];

/// What paper is, where it was given no colour.
pub const WHITE: Rgb = [255; 3];

/// The spelling of a colour: `#rrggbb`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hex([u8; 7]);

impl Hex {
    /// The spelling of `colour`, in lower case.
    pub fn of(colour: Rgb) -> Hex {
        const DIGITS: [u8; 16] = *b"0123456789abcdef";
        let mut text = *b"#000000";
        for (pair, value) in text[1..].as_chunks_mut().0.iter_mut().zip(colour) {
            *pair = [value >> 4, value & 15].map(|digit| DIGITS[usize::from(digit)]);
        }
        Hex(text)
    }

    /// Its seven characters, which are ASCII.
    pub fn as_bytes(&self) -> &[u8] {
        &self.0
    }

    /// The colour that is spelled so; digits may be of either case.
    pub fn parse(text: &[u8]) -> Option<Rgb> {
        let digits = text.strip_prefix(b"#").filter(|digits| digits.len() == 6)?;
        let digit = |byte: &u8| (*byte as char).to_digit(16);
        let number = digits.iter().try_fold(0, |number, byte| Some(number << 4 | digit(byte)?))?;
        let [_, colour @ ..] = u32::to_be_bytes(number);
        Some(colour)
    }
}

impl fmt::Display for Hex {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| fmt::Write::write_char(f, char::from(*byte)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_colour_has_its_spelling(colour: Rgb) {
            let [r, g, b] = colour;
            let text = format!("#{r:02x}{g:02x}{b:02x}");
            let hex = Hex::of(colour);
            prop_assert_eq!(hex.to_string(), &text[..]);
            prop_assert_eq!(hex.as_bytes(), text.as_bytes());
            prop_assert_eq!(Hex::parse(text.as_bytes()), Some(colour));
            prop_assert_eq!(Hex::parse(text.to_uppercase().as_bytes()), Some(colour));
        }
    }

    #[test]
    fn what_is_no_colour() {
        for text in ["", "#", "#12345", "#1234567", "123456", "#12345g", "#+12345", "#1234é", "##23456"] {
            assert_eq!(Hex::parse(text.as_bytes()), None, "{text}");
        }
    }
}
