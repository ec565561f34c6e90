//! What a query asks of a model.

use std::fmt::Display;
use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};
use utoipa::openapi::schema::{ObjectBuilder, Schema, Type};
use utoipa::{IntoParams, ToSchema};

use super::super::problem::Problem;
use super::{compression_name, format_name, lines, read, take};
use crate::job::{self, SolidOptions};
use crate::solid::camera::Setup;
use crate::solid::look::{Look, MAX_ANTIALIAS};
use crate::solid::shade::SCHEMES;

/// The query of a picture of a model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct SolidParams {
    /// Size of the page in pixels, W,H; 512,512 unless given
    #[serde(skip_serializing_if = "Option::is_none")]
    pub imgsize: Option<String>,
    /// Where the model is seen from: translate_x,y,z,rotate_x,y,z,distance or eye_x,y,z,center_x,y,z; without it from where all is seen
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<String>,
    /// o: orthographic, p: perspective (the default)
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(inline)]
    pub projection: Option<Projection>,
    /// Go so far away that all is seen
    #[serde(skip_serializing_if = "Option::is_none")]
    pub viewall: Option<bool>,
    /// Look at the middle of the model
    #[serde(skip_serializing_if = "Option::is_none")]
    pub autocenter: Option<bool>,
    /// Colours of what has none of its own
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(schema_with = scheme_name)]
    pub colorscheme: Option<String>,
    /// How curved surfaces are drawn
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(inline)]
    pub curves: Option<Curves>,
    /// Planes a,b,c,d that cut the model: what is at a x + b y + c z <= d stays. May be given several times
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[param(max_items = 16)]
    pub section: Vec<String>,
    /// Every pixel is the mean of N x N finer ones
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(minimum = 1, maximum = 8)]
    pub antialias: Option<u32>,
    /// Faces are shaded as one surface where they meet at less than so many degrees
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(minimum = 0, maximum = 180)]
    pub smooth: Option<f64>,
    /// Lines where a surface ends, or its faces meet at more than so many degrees
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(minimum = 0, maximum = 180)]
    pub edges: Option<f64>,
    /// Primitives that are shown as glass, by their numbers, counted from 1: 3, or 2-5. May be given several times
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[param(max_items = 1000)]
    pub translucent: Vec<String>,
    /// What is cut away is shown as glass
    #[serde(skip_serializing_if = "Option::is_none")]
    pub glass: Option<bool>,
    /// Name of the format
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(schema_with = format_name)]
    pub format: Option<String>,
    /// Compression, in a format that has several; without it what suits the raster
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(schema_with = compression_name)]
    pub compression: Option<String>,
    /// Only these scanlines, Y0..Y1, half-open, counted from 0
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(pattern = r"^\d{1,7}\.\.\d{1,7}$")]
    pub lines: Option<String>,
}

/// How space is shown on the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub enum Projection {
    /// Perspective.
    #[serde(rename = "p")]
    Perspective,
    /// Orthographic.
    #[serde(rename = "o")]
    Orthographic,
}

/// How curved surfaces are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Curves {
    /// As OpenSCAD has them.
    Facets,
}

/// The schema of a colour scheme's name.
fn scheme_name() -> Schema {
    let names = SCHEMES.iter().map(|scheme| scheme.name);
    ObjectBuilder::new().schema_type(Type::String).enum_values(Some(names)).into()
}

impl SolidParams {
    /// Those of a query.
    ///
    /// # Errors
    /// Unknown names; values that are none of theirs.
    pub fn read(query: &str) -> Result<SolidParams, Problem> {
        let (section, rest) = take(query, "section");
        let (translucent, rest) = take(&rest, "translucent");
        Ok(SolidParams { section, translucent, ..read(&rest)? })
    }

    /// What they ask of a model.
    ///
    /// # Errors
    /// Values out of bounds.
    pub fn options(&self) -> Result<SolidOptions, Problem> {
        let Setup { width, height, .. } = Setup::default();
        let (width, height) = given("imgsize", self.imgsize.as_deref(), job::image_size)?.unwrap_or((width, height));
        let scheme = |name: &str| {
            let names = || SCHEMES.iter().map(|scheme| scheme.name).collect::<Vec<_>>().join(", ");
            SCHEMES.iter().find(|scheme| scheme.name == name).ok_or_else(|| format!("give one of {}", names()))
        };
        let sections = self.section.iter().map(|text| given("section", Some(text), job::section));
        Ok(SolidOptions {
            setup: Setup {
                camera: given("camera", self.camera.as_deref(), job::camera)?,
                orthographic: self.projection == Some(Projection::Orthographic),
                view_all: self.viewall == Some(true),
                autocenter: self.autocenter == Some(true),
                width,
                height,
            },
            scheme: *given("colorscheme", self.colorscheme.as_deref(), scheme)?.unwrap_or(&SCHEMES[0]),
            sections: sections.filter_map(Result::transpose).collect::<Result<_, _>>()?,
            look: self.look()?,
            lines: lines(self.lines.as_deref())?,
            ..SolidOptions::default()
        })
    }

    /// How it looks.
    fn look(&self) -> Result<Look, Problem> {
        let translucent = self.translucent.iter().flat_map(|list| list.split(',')).map(|text| given("translucent", Some(text), job::parts));
        Ok(Look {
            antialias: within("antialias", self.antialias, 1..=MAX_ANTIALIAS)?.unwrap_or(1),
            smooth: within("smooth", self.smooth, 0.0..=180.0)?,
            edges: within("edges", self.edges, 0.0..=180.0)?,
            translucent: translucent.filter_map(Result::transpose).collect::<Result<_, _>>()?,
            glass: self.glass == Some(true),
        })
    }
}

/// A number that must be within bounds.
fn within<T: PartialOrd + Display>(name: &str, number: Option<T>, bounds: RangeInclusive<T>) -> Result<Option<T>, Problem> {
    let (least, most) = (bounds.start(), bounds.end());
    match number {
        Some(number) if !bounds.contains(&number) => {
            Err(Problem::malformed(format!("{name} is {number}: give a number from {least} to {most}")))
        }
        _ => Ok(number),
    }
}

/// A value that is given as text.
fn given<T>(name: &str, text: Option<&str>, read: impl Fn(&str) -> Result<T, String>) -> Result<Option<T>, Problem> {
    text.map(|text| read(text).map_err(|what| Problem::malformed(format!("{name} is {text:?}: {what}")))).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::camera::Camera;

    #[test]
    fn queries_are_those_of_the_command_line() {
        let options = |query: &str| SolidParams::read(query).and_then(|params| params.options());
        let asked = options(
            "imgsize=300,200&camera=1,2,3,4,5,6&projection=o&viewall=true&colorscheme=Tomorrow+Night&section=0,0,2,4&section=1,0,0,1&lines=3..9",
        );
        let asked = asked.unwrap();
        assert_eq!((asked.setup.width, asked.setup.height, asked.setup.orthographic), (300, 200, true));
        assert_eq!((asked.setup.view_all, asked.setup.autocenter, asked.lines), (true, false, Some(3..9)));
        assert_eq!(asked.setup.camera, Some(Camera::Vector([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])));
        assert_eq!((asked.scheme.name, asked.sections.len(), asked.sections[0].offset), ("Tomorrow Night", 2, -2.0));
        assert_eq!(options("").unwrap().setup, Setup::default());
        assert_eq!(options("").unwrap().look, Look::default());
        let look = options("antialias=4&smooth=30&edges=12.5&translucent=3&translucent=5-7,1&glass=true").unwrap().look;
        let expected = Look { antialias: 4, smooth: Some(30.0), edges: Some(12.5), translucent: vec![3..=3, 5..=7, 1..=1], glass: true };
        assert_eq!(look, expected);
        for query in [
            "imgsize=300",
            "imgsize=0,5",
            "camera=1,2,3",
            "camera=1,2,3,4,5,6,0",
            "camera=1,2,3,1,2,3",
            "projection=x",
            "viewall=1",
            "viewall",
            "colorscheme=Pink",
            "curves=smooth",
            "section=0,0,0,1",
            "section=1,0,0,1&section=",
            "antialias=x",
            "antialias=-1",
            "smooth=x",
            "edges",
            "translucent=0",
            "translucent=1,",
            "translucent=3-2",
            "glass=1",
            "lines=5..5",
            "expr=a",
            "kind=solid",
            "camera=1,2,3,4,5,6&camera=1,2,3,4,5,6",
        ] {
            assert!(options(query).is_err(), "{query}");
        }
    }
}
