//! The shapes of a JSON scene.

use serde::de::{Error as _, MapAccess, SeqAccess, Visitor};

use super::json::{self, Number, Reader, Text};
use crate::error::Kind;
use crate::grid::Point;
use crate::input::{finite, path_data};
use crate::scene::{Named, quoted};
use crate::shape::{FillRule, Path, Shape, Transform};

/// The object `shapes`: goes into the reader's scene.
pub(super) struct Shapes<'r, 'l>(pub(super) &'r mut Reader<'l>);

json::seed!(Shapes<'_, '_> => (), deserialize_map);

impl<'de> Visitor<'de> for Shapes<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("an object of shapes")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let reader = self.0;
        while let Some(key) = map.next_key::<Text<'de>>()? {
            let id = &*key.0;
            reader.within = format!("shape {}: ", quoted(id));
            if reader.scene.named(id).is_some() {
                return Err(reader.malformed(&key, "a second shape of that name: rename one"));
            }
            reader.count(2)?;
            let mut shape = map.next_value_seed(OneShape(reader))?;
            if !finite(&shape) {
                let what = "its transform takes it out of the range of 64-bit numbers: use smaller ones".to_owned();
                return Err(reader.refuse(Kind::Refused, what, None));
            }
            let id = key.0.into_owned();
            shape.name.clone_from(&id);
            let index = u32::try_from(reader.scene.shapes.len()).map_err(A::Error::custom)?;
            let area = reader.scene.add_shape(shape);
            reader.scene.add_name(Named {
                id,
                kind: "shape",
                area,
                shapes: std::iter::once(index..index + 1).collect(),
                ink: None,
                depth: 0,
            });
        }
        reader.within.clear();
        Ok(())
    }
}

struct OneShape<'r, 'l>(&'r mut Reader<'l>);

json::seed!(OneShape<'_, '_> => Shape, deserialize_map);

impl<'de> Visitor<'de> for OneShape<'_, '_> {
    type Value = Shape;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a shape: an object with rings or path")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Shape, A::Error> {
        let reader = self.0;
        let (mut path, mut rule, mut transform) = (None, None, None);
        while let Some(key) = map.next_key::<Text<'de>>()? {
            match &*key.0 {
                "rings" | "path" if path.is_some() => {
                    return Err(reader.malformed(&key, "a second outline: give rings or path, and once"));
                }
                "rings" => path = Some(map.next_value_seed(Rings(reader))?),
                "path" => path = Some(path_of(reader, &map.next_value()?)?),
                "rule" if rule.is_none() => {
                    let text: Text<'de> = map.next_value()?;
                    rule = Some(match &*text.0 {
                        "nonzero" => FillRule::NonZero,
                        "evenodd" => FillRule::EvenOdd,
                        other => {
                            let what = format!("unknown rule {}: write nonzero or evenodd", quoted(other));
                            return Err(reader.malformed(&text, &what));
                        }
                    });
                }
                "transform" if transform.is_none() => transform = Some(map.next_value_seed(Matrix)?),
                "rule" | "transform" => return Err(reader.again(&key)),
                _ => return Err(reader.unknown(&key, "a shape has rings or path, rule and transform")),
            }
        }
        Ok(Shape {
            name: String::new(),
            path: path.ok_or_else(|| A::Error::custom("no outline: give rings or path"))?.into(),
            rule: rule.unwrap_or_default(),
            stroke: None,
            transform: transform.unwrap_or(Transform::IDENTITY),
        })
    }
}

fn path_of<E: serde::de::Error>(reader: &mut Reader<'_>, text: &Text<'_>) -> Result<Path, E> {
    let path = path_data::parse(&text.0, reader.limits.edges - reader.verbs).map_err(|fault| {
        let kind = if fault.limit { Kind::Limit } else { Kind::Malformed };
        match fault.character {
            Some(n) => reader.refuse(kind, format!("path, character {n}: {}", fault.what), reader.place(text, n - 1)),
            None => reader.refuse(kind, format!("path: {}", fault.what), reader.place(text, 0)),
        }
    })?;
    reader.verbs += path.verbs().len() as u64;
    Ok(path)
}

/// An array of rings.
struct Rings<'r, 'l>(&'r mut Reader<'l>);

json::seed!(Rings<'_, '_> => Path, deserialize_seq);

impl<'de> Visitor<'de> for Rings<'_, '_> {
    type Value = Path;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("an array of rings, each an array of points [x, y]")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Path, A::Error> {
        let mut path = Path::default();
        while let Some(()) = seq.next_element_seed(Ring(self.0, &mut path))? {}
        Ok(path)
    }
}

/// An array of points; one or two are empty.
struct Ring<'r, 'l>(&'r mut Reader<'l>, &'r mut Path);

json::seed!(Ring<'_, '_> => (), deserialize_seq);

impl<'de> Visitor<'de> for Ring<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a ring: an array of points [x, y]")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        let Ring(reader, path) = self;
        let (Some(first), Some(second)) = (seq.next_element_seed(Pair)?, seq.next_element_seed(Pair)?) else { return Ok(()) };
        let Some(third) = seq.next_element_seed(Pair)? else { return Ok(()) };
        path.move_to(first);
        path.line_to(second);
        path.line_to(third);
        reader.verbs += 4;
        while let Some(p) = seq.next_element_seed(Pair)? {
            path.line_to(p);
            reader.verbs += 1;
            if reader.verbs > reader.limits.edges {
                break;
            }
        }
        if reader.verbs > reader.limits.edges {
            let what = format!("more than {} edges: raise the limit or split the drawing", reader.limits.edges);
            return Err(reader.refuse(Kind::Limit, what, None));
        }
        path.close();
        Ok(())
    }
}

/// A point `[x, y]`.
struct Pair;

json::seed!(Pair => Point, deserialize_seq);

impl<'de> Visitor<'de> for Pair {
    type Value = Point;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a point [x, y]")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Point, A::Error> {
        match (seq.next_element_seed(Number)?, seq.next_element_seed(Number)?) {
            (Some(x), Some(y)) if seq.next_element_seed(Number)?.is_none() => Ok([x, y]),
            _ => Err(A::Error::custom("a point has two numbers: [x, y]")),
        }
    }
}

/// Six numbers of an affine map or nine of a homography.
struct Matrix;

json::seed!(Matrix => Transform, deserialize_seq);

impl<'de> Visitor<'de> for Matrix {
    type Value = Transform;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a transform: an array of six or nine numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Transform, A::Error> {
        let (mut m, mut n) = ([0.0; 9], 0);
        while let Some(x) = seq.next_element_seed(Number)? {
            if n == 9 {
                return Err(A::Error::custom("a transform has six or nine numbers, here are more"));
            }
            m[n] = x;
            n += 1;
        }
        match n {
            6 => Ok(Transform::Affine([m[0], m[1], m[2], m[3], m[4], m[5]])),
            9 if singular(&m) => Err(A::Error::custom("the transform is singular: it maps the plane onto a line")),
            9 => Ok(Transform::Projective(m)),
            _ => Err(A::Error::custom(format!("a transform has six or nine numbers, here are {n}"))),
        }
    }
}

/// Whether the determinant is zero as far as 64-bit numbers tell.
fn singular(m: &[f64; 9]) -> bool {
    let mut m = *m;
    for row in m.chunks_mut(3) {
        let largest = row.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        row.iter_mut().for_each(|x| *x /= largest);
    }
    let terms = [m[0] * m[4] * m[8], m[1] * m[5] * m[6], m[2] * m[3] * m[7], -m[2] * m[4] * m[6], -m[1] * m[3] * m[8], -m[0] * m[5] * m[7]];
    let sum: f64 = terms.iter().sum();
    let size: f64 = terms.iter().map(|t| t.abs()).sum();
    // A row of zeros gives NaN.
    sum.is_nan() || sum.abs() <= 8.0 * f64::EPSILON * size
}
