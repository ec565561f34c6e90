//! What a query asks of a drawing.

use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use utoipa::IntoParams;

use super::super::problem::Problem;
use super::{compression_name, format_name, lines, read};
use crate::grid::{MAX_HEIGHT, MAX_WIDTH};
use crate::job::{Options, Size, TOLERANCE, TOLERANCES};

/// The query of a drawing's raster.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct FillParams {
    /// An expression over the ids of the drawing, instead of its own picture
    #[serde(skip_serializing_if = "Option::is_none")]
    pub expr: Option<String>,
    /// Dots an inch; a user unit is 1/96 inch. One of dpi, scale, and width or height or both
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(minimum = 0.000001, maximum = 1000000000.0)]
    pub dpi: Option<f64>,
    /// Pixels to a user unit
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(minimum = 0.000001, maximum = 1000000000.0)]
    pub scale: Option<f64>,
    /// Width of the page in pixels; alone it keeps the aspect, with height the drawing is fitted inside and centred
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(minimum = 1, maximum = 1048576)]
    pub width: Option<u32>,
    /// Height of the page in pixels; alone it keeps the aspect
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(minimum = 1, maximum = 8388608)]
    pub height: Option<u32>,
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
    /// Farthest that a flattened curve may be from the true one, in pixels
    #[serde(skip_serializing_if = "Option::is_none")]
    #[param(minimum = 0.001, maximum = 16.0)]
    pub tolerance: Option<f64>,
}

/// Longest expression in a query, in bytes; longer ones go into a scene.
const LONGEST_EXPRESSION: usize = 1 << 16;

impl FillParams {
    /// Those of a query.
    ///
    /// # Errors
    /// Unknown names; values that are none of theirs.
    pub fn read(query: &str) -> Result<FillParams, Problem> {
        read(query)
    }

    /// What they ask of a document.
    ///
    /// # Errors
    /// Values out of bounds, or that contradict each other.
    pub fn options(&self) -> Result<Options, Problem> {
        let number = |name: &str, value: Option<f64>| match value {
            Some(value) if !(value.is_finite() && value > 0.0) => {
                Err(Problem::malformed(format!("{name} is {value}: give a number above 0")))
            }
            value => Ok(value),
        };
        let pixels = |name: &str, value: Option<u32>, most: u32| match value {
            Some(value) if !(1..=most).contains(&value) => {
                Err(Problem::malformed(format!("{name} is {value}: give a whole number from 1 to {most}")))
            }
            value => Ok(value),
        };
        let size = match (number("dpi", self.dpi)?, number("scale", self.scale)?, self.width, self.height) {
            (None, scale, None, None) => Size::Scale(scale.unwrap_or(1.0)),
            (Some(dpi), None, None, None) => Size::Dpi(dpi),
            (None, None, width, height) => {
                Size::Pixels { width: pixels("width", width, MAX_WIDTH)?, height: pixels("height", height, MAX_HEIGHT)? }
            }
            _ => return Err(Problem::malformed("dpi, scale, and width and height exclude each other: give one of the three")),
        };
        let tolerance = self.tolerance.unwrap_or(TOLERANCE);
        if !TOLERANCES.contains(&tolerance) {
            let what = format!("tolerance is {tolerance}: give a number of pixels from {} to {}", TOLERANCES.start(), TOLERANCES.end());
            return Err(Problem::malformed(what));
        }
        let lines = lines(self.lines.as_deref())?;
        if self.expr.as_ref().is_some_and(|expr| expr.len() > LONGEST_EXPRESSION) {
            let what = format!("expr has more than {LONGEST_EXPRESSION} bytes: put it into a scene");
            return Err(Problem::new(StatusCode::UNPROCESSABLE_ENTITY, "limit", what));
        }
        Ok(Options { expr: self.expr.clone(), size, lines, tolerance, ..Options::default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_exclude_each_other() {
        let bad = |params: FillParams| assert!(params.options().is_err(), "{params:?}");
        bad(FillParams { dpi: Some(1.0), scale: Some(1.0), ..FillParams::default() });
        bad(FillParams { scale: Some(1.0), width: Some(1), ..FillParams::default() });
        bad(FillParams { dpi: Some(f64::NAN), ..FillParams::default() });
        bad(FillParams { scale: Some(-1.0), ..FillParams::default() });
        bad(FillParams { width: Some(0), ..FillParams::default() });
        bad(FillParams { tolerance: Some(0.0), ..FillParams::default() });
        bad(FillParams { lines: Some("5..5".to_owned()), ..FillParams::default() });
        let fit =
            FillParams { width: Some(3), height: Some(4), lines: Some("0..4".to_owned()), ..FillParams::default() }.options().unwrap();
        assert_eq!((fit.size, fit.lines), (Size::Pixels { width: Some(3), height: Some(4) }, Some(0..4)));
    }
}
