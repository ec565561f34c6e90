//! Transforms as style sheets write them, with units and functions of one axis, which SVG's own syntax and `usvg` do not have.

use svgtypes::{Angle, Length, LengthUnit};

use super::geometry::{IDENTITY, product};

/// The matrix of a list of transform functions, in SVG's order of the six numbers; none if it is not understood.
pub(super) fn matrix(list: &str) -> Option<[f64; 6]> {
    if let Ok(t) = list.parse::<svgtypes::Transform>() {
        return Some([t.a, t.b, t.c, t.d, t.e, t.f]);
    }
    let mut whole = IDENTITY;
    let mut rest = list.trim();
    while !rest.is_empty() {
        let (name, behind) = rest.split_once('(')?;
        let (arguments, behind) = behind.split_once(')')?;
        let arguments: Vec<&str> = arguments.split(',').map(str::trim).collect();
        whole = product(whole, function(&name.trim().to_ascii_lowercase(), &arguments)?);
        rest = behind.trim_start();
    }
    Some(whole)
}

fn function(name: &str, arguments: &[&str]) -> Option<[f64; 6]> {
    let slope = |text: &str| angle(text).map(f64::tan);
    Some(match (name, arguments) {
        ("translate", [x]) | ("translatex", [x]) => [1.0, 0.0, 0.0, 1.0, length(x)?, 0.0],
        ("translatey", [y]) => [1.0, 0.0, 0.0, 1.0, 0.0, length(y)?],
        ("translate", [x, y]) => [1.0, 0.0, 0.0, 1.0, length(x)?, length(y)?],
        ("scale", [s]) => [factor(s)?, 0.0, 0.0, factor(s)?, 0.0, 0.0],
        ("scalex", [x]) => [factor(x)?, 0.0, 0.0, 1.0, 0.0, 0.0],
        ("scaley", [y]) => [1.0, 0.0, 0.0, factor(y)?, 0.0, 0.0],
        ("scale", [x, y]) => [factor(x)?, 0.0, 0.0, factor(y)?, 0.0, 0.0],
        ("rotate" | "rotatez", [turn]) => {
            let (sin, cos) = angle(turn)?.sin_cos();
            [cos, sin, -sin, cos, 0.0, 0.0]
        }
        ("skew" | "skewx", [x]) => [1.0, 0.0, slope(x)?, 1.0, 0.0, 0.0],
        ("skewy", [y]) => [1.0, slope(y)?, 0.0, 1.0, 0.0, 0.0],
        ("skew", [x, y]) => [1.0, slope(y)?, slope(x)?, 1.0, 0.0, 0.0],
        ("matrix", [_, _, _, _, _, _]) => {
            let numbers: Vec<f64> = arguments.iter().map(|a| factor(a)).collect::<Option<_>>()?;
            numbers.try_into().ok()?
        }
        _ => return None,
    })
}

/// A length in user units; what depends on a font or on a size is not known here.
pub(super) fn length(text: &str) -> Option<f64> {
    let Length { number, unit } = text.parse().ok()?;
    let size = match unit {
        LengthUnit::None | LengthUnit::Px => 1.0,
        LengthUnit::In => 96.0,
        LengthUnit::Cm => 96.0 / 2.54,
        LengthUnit::Mm => 96.0 / 25.4,
        LengthUnit::Pt => 96.0 / 72.0,
        LengthUnit::Pc => 16.0,
        LengthUnit::Em | LengthUnit::Ex | LengthUnit::Percent => return None,
    };
    Some(number * size)
}

/// An angle in radians.
fn angle(text: &str) -> Option<f64> {
    text.parse::<Angle>().ok().map(|angle| angle.to_degrees().to_radians())
}

fn factor(text: &str) -> Option<f64> {
    match text.parse().ok()? {
        Length { number, unit: LengthUnit::None } => Some(number),
        Length { number, unit: LengthUnit::Percent } => Some(number / 100.0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_products() {
        let near = |list: &str, expected: [f64; 6]| {
            let found = matrix(list).unwrap_or_else(|| panic!("{list}"));
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{list}: {found:?}");
        };
        near("translate(10px, 1in) scale(150%)", [1.5, 0.0, 0.0, 1.5, 10.0, 96.0]);
        near("rotate(90deg)translateX(3px)", [0.0, 1.0, -1.0, 0.0, 0.0, 3.0]);
        near("rotate(.25turn) scaleY(2)", [0.0, 1.0, -2.0, 0.0, 0.0, 0.0]);
        near("skewX(45deg) translateY(2px)", [1.0, 0.0, 1.0, 1.0, 2.0, 2.0]);
        near("skew(45deg, 0deg)", [1.0, 0.0, 1.0, 1.0, 0.0, 0.0]);
        near("MATRIX(1, 2, 3, 4, 5, 6)  ", [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        near("rotate(90 1 1)", [0.0, 1.0, -1.0, 0.0, 2.0, 0.0]);
        for list in [
            "translate(50%)",
            "translate(1em)",
            "rotate(90deg",
            "rotate(90px)",
            "scale(1px)",
            "perspective(5px)",
            "rotate3d(1,0,0,9deg)",
            "x",
        ] {
            assert_eq!(matrix(list), None, "{list}");
        }
    }
}
