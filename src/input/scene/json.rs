//! What the JSON scene's parts share: strings that know their place, numbers, keys, and errors.

use std::borrow::Cow;

use serde::Deserialize;
use serde::de::Visitor;

use crate::error::{Error, Kind, Place};
use crate::scene::{Limits, Scene, quoted};

/// What is carried along while the text is read.
pub(super) struct Reader<'l> {
    bytes: &'l [u8],
    pub(super) limits: &'l Limits,
    /// What has been read of the scene.
    pub(super) scene: Scene,
    /// Lines and curves so far.
    pub(super) verbs: u64,
    nodes: u64,
    /// What is being read, for messages: `shape "a": `.
    pub(super) within: String,
    refusal: Option<Error>,
}

impl<'l> Reader<'l> {
    pub(super) fn new(bytes: &'l [u8], limits: &'l Limits) -> Reader<'l> {
        Reader { bytes, limits, scene: Scene::new(1.0, 1.0), verbs: 0, nodes: 0, within: String::new(), refusal: None }
    }

    /// Counts things against [`Limits::nodes`].
    pub(super) fn count<E: serde::de::Error>(&mut self, n: u64) -> Result<(), E> {
        self.nodes += n;
        if self.nodes > self.limits.nodes {
            let what = format!("more than {} shapes, names and layers: split the drawing", self.limits.nodes);
            return Err(self.refuse(Kind::Limit, what, None));
        }
        Ok(())
    }

    /// Keeps an error with its own kind and place until `serde_json` has gone back up. Without a place it is where the reading stands.
    pub(super) fn refuse<E: serde::de::Error>(&mut self, kind: Kind, what: String, place: Option<Place>) -> E {
        self.refusal = Some(Error { place, ..Error::input(kind, what) });
        E::custom("refused")
    }

    /// The error for a string that is not what it should be.
    pub(super) fn malformed<E: serde::de::Error>(&mut self, text: &Text<'_>, what: &str) -> E {
        self.refuse(Kind::Malformed, what.to_owned(), self.place(text, 0))
    }

    /// The error for a key that has stood before.
    pub(super) fn again<E: serde::de::Error>(&mut self, key: &Text<'_>) -> E {
        self.malformed(key, &format!("a second {}: give it once", key.0))
    }

    /// The error for a key that does not belong; `belong` says which do.
    pub(super) fn unknown<E: serde::de::Error>(&mut self, key: &Text<'_>, belong: &str) -> E {
        self.malformed(key, &format!("unknown key {}: {belong}", quoted(&key.0)))
    }

    /// The place in the document of a character of a string, counted from 0; `None` if the string was written with escapes.
    pub(super) fn place(&self, text: &Text<'_>, character: usize) -> Option<Place> {
        let start = text.place(self.bytes)?;
        Some(Place { column: start.column.saturating_add(u32::try_from(character).unwrap_or(u32::MAX)), ..start })
    }

    /// The error that ended the reading.
    pub(super) fn error(&mut self, error: &serde_json::Error) -> Error {
        // A column is the number of bytes up to and with the last one read.
        if error.is_eof() {
            let what = format!("{}the scene ends too early: is the file complete?", self.within);
            return Error::input(Kind::Malformed, what).at_byte(self.bytes, self.bytes.len());
        }
        let line = self.bytes.split_inclusive(|&b| b == b'\n').take(error.line().saturating_sub(1)).map(<[u8]>::len).sum::<usize>();
        let place = Place::of_byte(self.bytes, line + error.column().saturating_sub(1));
        if let Some(refusal) = self.refusal.take() {
            let what = format!("{}{}", self.within, refusal.what);
            return Error { place: refusal.place.or(Some(place)), ..Error::input(refusal.kind, what) };
        }
        let what = error.to_string();
        let what = what.strip_suffix(&format!(" at line {} column {}", error.line(), error.column())).unwrap_or(&what);
        let what = if what == "trailing characters" { "something follows the scene: remove it" } else { what };
        Error::input(Kind::Malformed, format!("{}{what}", self.within)).at(place)
    }
}

/// A string, borrowed from the document where it has no escapes.
#[derive(Deserialize)]
pub(super) struct Text<'a>(#[serde(borrow)] pub(super) Cow<'a, str>);

impl Text<'_> {
    /// Where its first character stands in the document, if it is borrowed from there.
    pub(super) fn place(&self, document: &[u8]) -> Option<Place> {
        self.offset(document).map(|byte| Place::of_byte(document, byte))
    }

    /// The byte of the document at which it begins, if it is borrowed from there.
    pub(super) fn offset(&self, document: &[u8]) -> Option<usize> {
        let Cow::Borrowed(text) = self.0 else { return None };
        let offset = text.as_ptr().addr().checked_sub(document.as_ptr().addr())?;
        (offset <= document.len()).then_some(offset)
    }
}

/// Makes a visitor the seed of its own value: `seed!(Type => Value, the method that asks for it)`.
macro_rules! seed {
    ($seed:ty => $value:ty, $ask:ident) => {
        impl<'de> serde::de::DeserializeSeed<'de> for $seed {
            type Value = $value;

            fn deserialize<D: serde::Deserializer<'de>>(self, json: D) -> Result<Self::Value, D::Error> {
                json.$ask(self)
            }
        }
    };
}
pub(super) use seed;

/// A finite number.
pub(super) struct Number;

seed!(Number => f64, deserialize_f64);

impl Visitor<'_> for Number {
    type Value = f64;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a number")
    }

    fn visit_f64<E: serde::de::Error>(self, x: f64) -> Result<f64, E> {
        if x.is_finite() { Ok(x) } else { Err(E::custom("the number is not finite")) }
    }

    fn visit_u64<E>(self, x: u64) -> Result<f64, E> {
        Ok(x as f64)
    }

    fn visit_i64<E>(self, x: i64) -> Result<f64, E> {
        Ok(x as f64)
    }
}
