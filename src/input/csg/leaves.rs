//! What statements without operands describe, and the arguments of those that have some.

use std::str::FromStr;

use super::Reader;
use super::modules::Kind as Module;
use super::values::{Arguments, Value};
use crate::error::{Error, Kind, Place, Result, Warning};
use crate::mesh::build::Builder;
use crate::mesh::extrude::Extrusion;
use crate::mesh::outline::{Contour, Outline, Tangled};
use crate::mesh::turn::sin_cos;
use crate::mesh::{Matrix, Mesh, Point, primitive};
use crate::run::Rgb;

/// The matrix of `multmatrix`: two to four rows of up to four numbers, what is missing is that of the identity.
pub(super) fn matrix(arguments: &Arguments<'_, '_>) -> Result<Matrix> {
    let mut m = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    let Some(value) = arguments.get("m") else { return Ok([m[0], m[1], m[2]]) };
    let rows = value.list().ok_or_else(|| arguments.wrong(&value, "the matrix must be a list of four rows"))?;
    for (i, row) in rows.enumerate() {
        let numbers = row.list().filter(|_| i < 4).ok_or_else(|| arguments.wrong(&row, "the matrix must be four rows of four numbers"))?;
        for (j, number) in numbers.enumerate() {
            match number.number() {
                Some(x) if x.is_finite() && j < 4 => m[i][j] = x,
                Some(_) if j < 4 => return Err(arguments.wrong(&number, "the matrix must be of finite numbers")),
                _ => return Err(arguments.wrong(&number, "the matrix must be four rows of four numbers")),
            }
        }
        if i == 3 && m[3] != [0.0, 0.0, 0.0, 1.0] {
            return Err(arguments.wrong(&row, "the last row of the matrix must be [0, 0, 0, 1]: there is no perspective in a model"));
        }
    }
    Ok([m[0], m[1], m[2]])
}

/// The colour of `color`: a name of CSS, `#rrggbb`, or numbers from 0 to 1; none if it says none.
pub(super) fn color(arguments: &Arguments<'_, '_>, place: Place, warnings: &mut Vec<Warning>) -> Result<Option<Rgb>> {
    let Some(value) = arguments.get("c") else { return Ok(None) };
    if let Some(name) = value.words() {
        let name = name.to_ascii_lowercase();
        let color = svgtypes::Color::from_str(&name).ok().map(|c| [c.red, c.green, c.blue]);
        // The one name that CSS has and SVG 1.1 has not.
        let color = color.or((name == "rebeccapurple").then_some([102, 51, 153]));
        if color.is_none() {
            let what = format!("the colour {} is unknown: it is ignored", crate::scene::quoted(&name));
            warnings.push(Warning { place: Some(place), ..Warning::input(what) });
        }
        return Ok(color);
    }
    let wrong = || arguments.wrong(&value, "the colour must be a name or a list of three or four numbers");
    let [r, g, b, a] = match value.numbers::<3>() {
        Some([r, g, b]) => [r, g, b, 1.0],
        None => value.numbers::<4>().ok_or_else(wrong)?,
    };
    // OpenSCAD writes -1 where there is no colour.
    let valid = [r, g, b, a].iter().all(|x| *x >= 0.0);
    Ok(valid.then(|| [r, g, b].map(|x| (x.min(1.0) * 255.0).round() as u8)))
}

/// The arguments of `linear_extrude`.
pub(super) fn extrusion(arguments: &Arguments<'_, '_>) -> Result<Extrusion> {
    let height = arguments.number("height", 100.0)?;
    let z = if arguments.truth("center")? { [-height / 2.0, height / 2.0] } else { [0.0, height] };
    Ok(Extrusion {
        z,
        twist: arguments.number_if("twist")?,
        slices: arguments.number_if("slices")?,
        scale: arguments.vector::<2>("scale", 1.0)?.map(|s| s.max(0.0)),
        fineness: arguments.fineness()?,
    })
}

impl Reader<'_, '_> {
    /// A square, circle or polygon; empty if it has no size.
    pub(super) fn outline(&mut self, kind: Module, arguments: &Arguments<'_, '_>, place: Place) -> Result<Outline> {
        match kind {
            Module::Square => {
                let [x, y] = arguments.vector::<2>("size", 1.0)?;
                let [[left, right], [low, high]] = spans([x, y], arguments.truth("center")?);
                let ring = vec![[left, low], [right, low], [right, high], [left, high]];
                Ok(if x > 0.0 && y > 0.0 { Outline::simple(ring) } else { Outline::default() })
            }
            Module::Circle => {
                let radius = arguments.radius("r", "d")?.unwrap_or(1.0);
                if radius <= 0.0 {
                    return Ok(Outline::default());
                }
                let sides = self.fragments(arguments.fineness()?.of_circle(radius), "sides", place)?;
                let corner = |i| {
                    let [sine, cosine] = sin_cos(360.0 * f64::from(i) / f64::from(sides));
                    [radius * cosine, radius * sine]
                };
                Ok(Outline::simple((0..sides).map(corner).collect()))
            }
            _ => {
                let contours = polygon(arguments)?;
                let outline = Outline::around(contours);
                self.work(&outline, place)?;
                outline.odd().map_err(|Tangled| super::tangled(place))
            }
        }
    }

    /// A cube, sphere, cylinder, polyhedron or imported file; empty if it has no size, none if it was left out.
    pub(super) fn mesh(&mut self, kind: Module, arguments: &Arguments<'_, '_>, place: Place) -> Result<Option<Mesh>> {
        let nothing = || Ok(Some(Mesh::default()));
        match kind {
            Module::Cube => {
                let size = arguments.vector::<3>("size", 1.0)?;
                let spans = spans(size, arguments.truth("center")?);
                if size.iter().any(|s| *s <= 0.0) {
                    return nothing();
                }
                Ok(Some(primitive::cuboid(spans.map(|s| s[0]), spans.map(|s| s[1]))))
            }
            Module::Sphere => {
                let radius = arguments.radius("r", "d")?.unwrap_or(1.0);
                if radius <= 0.0 {
                    return nothing();
                }
                let sides = self.fragments(arguments.fineness()?.of_circle(radius), "sides", place)?;
                self.would_spend(primitive::faces_of_stack(u64::from(sides.div_ceil(2)), u64::from(sides)) as f64, place)?;
                Ok(Some(primitive::sphere(radius, sides)))
            }
            Module::Cylinder => {
                let height = arguments.number("h", 1.0)?;
                let both = arguments.radius("r", "d")?;
                let radius = |radius, diameter| Ok(arguments.radius(radius, diameter)?.or(both).unwrap_or(1.0));
                let radii = [radius("r1", "d1")?, radius("r2", "d2")?];
                let [z] = spans([height], arguments.truth("center")?);
                if height <= 0.0 || radii.iter().any(|r| *r < 0.0) || radii == [0.0; 2] {
                    return nothing();
                }
                let sides = self.fragments(arguments.fineness()?.of_circle(radii[0].max(radii[1])), "sides", place)?;
                self.would_spend(f64::from(sides) + 2.0, place)?;
                Ok(Some(primitive::cylinder(radii, z, sides)))
            }
            Module::Polyhedron => polyhedron(arguments).map(Some),
            _ => self.import(arguments, place),
        }
    }

    /// An STL beside the document.
    fn import(&mut self, arguments: &Arguments<'_, '_>, place: Place) -> Result<Option<Mesh>> {
        let Some(file) = arguments.get("file").and_then(|value| value.words()) else {
            return Err(Error::input(Kind::Malformed, "import names no file: add file = \"…\"").at(place));
        };
        let Some(folder) = self.folder else {
            let what = format!("import of {}: files beside the model are not read here", crate::scene::quoted(&file));
            self.warnings.push(Warning { place: Some(place), outside: true, ..Warning::input(what + "; it is left out, as if empty") });
            return Ok(None);
        };
        let named = crate::scene::quoted(&file);
        if !file.to_ascii_lowercase().ends_with(".stl") {
            self.warn(place, format!("import of {named}: only STL is read; it is left out, as if empty"));
            return Ok(None);
        }
        let fails = |kind, what: String| Error::input(kind, format!("import of {named}: {what}")).at(place);
        let bytes = super::super::file::read_file(&folder.join(&file), self.limits.input).map_err(|e| fails(Kind::Io, e.to_string()))?;
        if bytes.len() as u64 > self.limits.input {
            return Err(fails(Kind::Limit, format!("larger than {} bytes: raise --max-input", self.limits.input)));
        }
        let mesh = super::super::stl::read(&bytes, self.limits).map_err(|e| fails(e.kind, e.to_string()))?;
        Ok(Some(mesh))
    }
}

/// From 0 on, or around 0.
fn spans<const N: usize>(size: [f64; N], center: bool) -> [[f64; 2]; N] {
    size.map(|s| if center { [-s / 2.0, s / 2.0] } else { [0.0, s] })
}

/// The faces of a polyhedron, clockwise as seen from outside as OpenSCAD has them.
fn polyhedron(arguments: &Arguments<'_, '_>) -> Result<Mesh> {
    let points: Vec<Point> = coordinates(arguments)?;
    let mut mesh = Builder::with_capacity(points.len(), 0);
    let Some(faces) = arguments.get("faces").or_else(|| arguments.get("triangles")) else { return Ok(Mesh::default()) };
    let list = faces.list().ok_or_else(|| arguments.wrong(&faces, "faces must be a list of lists of indices"))?;
    for face in list {
        let mut ring = indices(arguments, &face, points.len())?.map(|i| i.map(|i| mesh.point(points[i]))).collect::<Result<Vec<u32>>>()?;
        ring.reverse();
        mesh.face([ring]);
    }
    Ok(mesh.finish())
}

/// The contours of a polygon: its paths, or all points in order.
fn polygon(arguments: &Arguments<'_, '_>) -> Result<Vec<Contour>> {
    let points: Vec<[f64; 2]> = coordinates(arguments)?;
    let Some(paths) = arguments.get("paths") else { return Ok(vec![points]) };
    let wrong = || arguments.wrong(&paths, "paths must be a list of lists of indices");
    let contour = |path: &Value<'_>| indices(arguments, path, points.len())?.map(|i| i.map(|i| points[i])).collect::<Result<Contour>>();
    // One path may stand without its list.
    if paths.list().ok_or_else(wrong)?.next().is_some_and(|first| first.number().is_some()) {
        return Ok(vec![contour(&paths)?]);
    }
    paths.list().ok_or_else(wrong)?.map(|path| contour(&path)).collect()
}

/// The points of a polyhedron or a polygon.
fn coordinates<const N: usize>(arguments: &Arguments<'_, '_>) -> Result<Vec<[f64; N]>> {
    let Some(points) = arguments.get("points") else { return Ok(Vec::new()) };
    let list = points.list().ok_or_else(|| arguments.wrong(&points, "points must be a list of points"))?;
    list.map(|point| point.numbers().ok_or_else(|| arguments.wrong(&point, format!("a point must be {N} finite numbers")))).collect()
}

/// Indices of points.
fn indices<'v>(arguments: &'v Arguments<'_, '_>, list: &Value<'v>, points: usize) -> Result<impl Iterator<Item = Result<usize>> + 'v> {
    let list = list.list().ok_or_else(|| arguments.wrong(list, "this must be a list of indices"))?;
    Ok(list.map(move |index| {
        let number = index.number().filter(|x| *x >= 0.0 && *x < points as f64);
        number.map(|x| x as usize).ok_or_else(|| match index.number() {
            Some(x) => arguments.wrong(&index, format!("there is no point {x}: there are {points}, counted from 0")),
            None => arguments.wrong(&index, "an index must be a number"),
        })
    }))
}
