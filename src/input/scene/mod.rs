//! JSON scenes: shapes, and an expression or layers of inks.
//!
//! The text is read once and in order, straight into the [`Scene`]: coordinates go from the text into their path, strings are
//! borrowed from it. What is found wrong on the way is kept aside with its place, which `serde_json` does not carry.

mod json;
mod shape;

use serde::de::{DeserializeSeed as _, Error as _, MapAccess, SeqAccess, Visitor};

use self::json::{Number, Reader, Text};
use crate::error::{self, Error, Place, Places, Warning};
use crate::run::{Hex, Rgb};
use crate::scene::{Area, Expression, Layer, Limits, Picture, Scene, quoted};

/// Reads a JSON scene.
///
/// # Errors
/// With place and the name of the shape or key: what is not JSON, what does not belong, what is missing, an expression that cannot
/// be resolved, more than the limits allow.
pub(super) fn read(bytes: &[u8], limits: &Limits, warnings: &mut Vec<Warning>) -> error::Result<Scene> {
    let mut reader = Reader::new(bytes, limits);
    let mut json = serde_json::Deserializer::from_slice(bytes);
    let document = Document(&mut reader).deserialize(&mut json).and_then(|d| json.end().map(|()| d)).map_err(|e| reader.error(&e))?;
    let mut scene = reader.scene;
    scene.width = document.width;
    scene.height = document.height;
    let everything: Vec<Area> = scene.names().iter().map(|n| n.area).collect();
    scene.art = scene.formula.any(&everything);
    let mut places = Places::new(bytes);
    scene.picture = match document.drawn {
        Drawn::Expr(text) => Picture::Region(resolve(&mut scene, "expr", &text, &mut places, limits, warnings)?),
        Drawn::Layers(layers) => {
            let mut painted = Vec::with_capacity(layers.len());
            for (i, (text, ink)) in layers.iter().enumerate() {
                let area = resolve(&mut scene, &format!("layers[{i}].expr"), text, &mut places, limits, warnings)?;
                painted.push(Layer { area, ink: *ink });
            }
            Picture::Layers(painted)
        }
    };
    Ok(scene)
}

/// The area of an expression that stands in the document under `key`.
fn resolve(
    scene: &mut Scene,
    key: &str,
    text: &Text<'_>,
    places: &mut Places<'_>,
    limits: &Limits,
    warnings: &mut Vec<Warning>,
) -> error::Result<Area> {
    let within = |place: Option<Place>, what: &str| match place {
        Some(Place { line: 1, column }) => format!("{key}, column {column}: {what}"),
        Some(Place { line, column }) => format!("{key}, line {line}, column {column}: {what}"),
        None => format!("{key}: {what}"),
    };
    // A string without escapes stands in the document as it is, on one line.
    let mut place = |within: Option<Place>| {
        let start = text.offset(places.text()).map(|byte| places.of_byte(byte));
        start.zip(within).map(|(start, p)| Place { column: start.column.saturating_add(p.column - 1), ..start })
    };
    let mut own = Vec::new();
    let area = Expression::parse(&text.0, limits).and_then(|e| scene.resolve(&e, &mut own));
    warnings.extend(own.iter().map(|w| Warning { place: place(w.place), ..Warning::input(within(w.place, &w.what)) }));
    area.map_err(|e| Error { place: place(e.place), ..Error::input(e.kind, within(e.place, &e.what)) })
}

/// What a document says besides its shapes, which are in the reader's scene.
struct DocumentParts<'de> {
    width: f64,
    height: f64,
    drawn: Drawn<'de>,
}

enum Drawn<'de> {
    Expr(Text<'de>),
    Layers(Vec<(Text<'de>, Rgb)>),
}

struct Document<'r, 'l>(&'r mut Reader<'l>);

json::seed!(Document<'_, '_> => DocumentParts<'de>, deserialize_map);

impl<'de> Visitor<'de> for Document<'_, '_> {
    type Value = DocumentParts<'de>;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a scene: an object with width, height, shapes, and expr or layers")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let (mut width, mut height, mut shapes, mut drawn) = (None, None, None, None);
        while let Some(key) = map.next_key::<Text<'de>>()? {
            match &*key.0 {
                "width" if width.is_none() => width = Some(size(self.0, &key, &mut map)?),
                "height" if height.is_none() => height = Some(size(self.0, &key, &mut map)?),
                "shapes" if shapes.is_none() => shapes = Some(map.next_value_seed(shape::Shapes(self.0))?),
                "expr" | "layers" if drawn.is_some() => {
                    return Err(self.0.malformed(&key, "a second expr or layers: a scene has exactly one of them"));
                }
                "expr" => drawn = Some(Drawn::Expr(map.next_value()?)),
                "layers" => drawn = Some(Drawn::Layers(map.next_value_seed(Layers(self.0))?)),
                "width" | "height" | "shapes" => return Err(self.0.again(&key)),
                "runset" => return Err(self.0.malformed(&key, "this is a line stream, not a scene: read it with runset convert")),
                _ => return Err(self.0.unknown(&key, "a scene has width, height, shapes, and expr or layers")),
            }
        }
        let missing = |what: &str| A::Error::custom(format!("the scene has no {what}: add it"));
        shapes.ok_or_else(|| missing("shapes"))?;
        Ok(DocumentParts {
            width: width.ok_or_else(|| missing("width"))?,
            height: height.ok_or_else(|| missing("height"))?,
            drawn: drawn.ok_or_else(|| A::Error::custom("the scene has neither expr nor layers: add one"))?,
        })
    }
}

/// A width or height, in pixels at scale 1.
fn size<'de, A: MapAccess<'de>>(reader: &mut Reader<'_>, key: &Text<'_>, map: &mut A) -> Result<f64, A::Error> {
    let size = map.next_value_seed(Number)?;
    if size > 0.0 { Ok(size) } else { Err(reader.malformed(key, &format!("{} is {size}: give a positive number of pixels", key.0))) }
}

struct Layers<'r, 'l>(&'r mut Reader<'l>);

json::seed!(Layers<'_, '_> => Vec<(Text<'de>, Rgb)>, deserialize_seq);

impl<'de> Visitor<'de> for Layers<'_, '_> {
    type Value = Vec<(Text<'de>, Rgb)>;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("an array of layers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
        let mut layers = Vec::new();
        loop {
            self.0.within = format!("layers[{}]: ", layers.len());
            self.0.count(1)?;
            let Some(layer) = seq.next_element_seed(OneLayer(self.0))? else { break };
            layers.push(layer);
        }
        self.0.within.clear();
        Ok(layers)
    }
}

struct OneLayer<'r, 'l>(&'r mut Reader<'l>);

json::seed!(OneLayer<'_, '_> => (Text<'de>, Rgb), deserialize_map);

impl<'de> Visitor<'de> for OneLayer<'_, '_> {
    type Value = (Text<'de>, Rgb);

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a layer: an object with expr and ink")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let (mut expr, mut ink) = (None, None);
        while let Some(key) = map.next_key::<Text<'de>>()? {
            match &*key.0 {
                "expr" if expr.is_none() => expr = Some(map.next_value()?),
                "ink" if ink.is_none() => {
                    let text: Text<'de> = map.next_value()?;
                    let colour = Hex::parse(text.0.as_bytes());
                    let wrong = || self.0.malformed(&text, &format!("the ink {} is not a colour: write #rrggbb", quoted(&text.0)));
                    ink = Some(colour.ok_or_else(wrong)?);
                }
                "expr" | "ink" => return Err(self.0.again(&key)),
                _ => return Err(self.0.unknown(&key, "a layer has expr and ink")),
            }
        }
        let missing = |what: &str| A::Error::custom(format!("the layer has no {what}: add it"));
        Ok((expr.ok_or_else(|| missing("expr"))?, ink.ok_or_else(|| missing("ink"))?))
    }
}
