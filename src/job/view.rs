//! What people write to say how a model is seen: numbers between commas. The command line and the service take the same.

use std::ops::RangeInclusive;

use glam::DVec3;

use crate::grid::{MAX_HEIGHT, MAX_WIDTH};
use crate::solid::body::Plane;
use crate::solid::camera::Camera;

/// Finite numbers between commas; none if one of them is something else.
fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split(',').map(|number| number.trim().parse().ok().filter(|x: &f64| x.is_finite())).collect()
}

/// A page's size in pixels, `W,H`.
///
/// # Errors
/// What to give.
pub fn image_size(text: &str) -> Result<(u32, u32), String> {
    let size = text.split_once(',').and_then(|(w, h)| Some((w.trim().parse().ok()?, h.trim().parse().ok()?)));
    let fits = |&(w, h): &(u32, u32)| (1..=MAX_WIDTH).contains(&w) && (1..=MAX_HEIGHT).contains(&h);
    size.filter(fits).ok_or_else(|| format!("give a width from 1 to {MAX_WIDTH} and a height from 1 to {MAX_HEIGHT}, such as 1024,768"))
}

/// A camera: seven numbers turn it about a point, six are an eye and the point that it looks at.
///
/// # Errors
/// What to give.
pub fn camera(text: &str) -> Result<Camera, String> {
    let numbers = numbers(text).unwrap_or_default();
    match (<[f64; 7]>::try_from(&numbers[..]), <[f64; 6]>::try_from(&numbers[..])) {
        (Ok(gimbal), _) if gimbal[6] > 0.0 => Ok(Camera::Gimbal(gimbal)),
        (Ok(_), _) => Err("the last number is the distance: give one above 0".to_owned()),
        (_, Ok(vector)) if vector[..3] != vector[3..] => Ok(Camera::Vector(vector)),
        (_, Ok(_)) => Err("the eye is where it looks: give two points".to_owned()),
        _ => Err("give seven numbers, translate_x,y,z,rotate_x,y,z,distance, or six, eye_x,y,z,center_x,y,z".to_owned()),
    }
}

/// A plane that cuts a model, `a,b,c,d`: what is at `a x + b y + c z <= d` stays, and the side that (a, b, c) points to is taken away. The plane that is
/// given has the reverse normal, of length 1: it keeps what is before it.
///
/// # Errors
/// What to give.
pub fn section(text: &str) -> Result<Plane, String> {
    let numbers = numbers(text).and_then(|numbers| <[f64; 4]>::try_from(&numbers[..]).ok());
    let wrong = "give four numbers a,b,c,d, such as 0,0,1,5: what is at a x + b y + c z <= d stays";
    let [a, b, c, d] = numbers.ok_or(wrong)?;
    // By its largest component first: squares of large or small numbers leave the range of doubles.
    let largest = a.abs().max(b.abs()).max(c.abs());
    if largest == 0.0 {
        return Err("a, b and c are all 0, so there is no plane: give the direction of the side that is taken away".to_owned());
    }
    let scaled = DVec3::new(a / largest, b / largest, c / largest);
    let plane = Plane { normal: -scaled.normalize(), offset: -(d / largest / scaled.length()) };
    if plane.normal.is_finite() && plane.offset.is_finite() {
        Ok(plane)
    } else {
        Err("the plane is too far away: give a smaller d".to_owned())
    }
}

/// An angle in degrees, from 0 to 180.
///
/// # Errors
/// What to give.
pub fn angle(text: &str) -> Result<f64, String> {
    let angle = text.trim().parse().ok().filter(|angle| (0.0..=180.0).contains(angle));
    angle.ok_or_else(|| "give an angle from 0 to 180 degrees, such as 30".to_owned())
}

/// Numbers of parts, counted from 1: `3`, or `2-5`.
///
/// # Errors
/// What to give.
pub fn parts(text: &str) -> Result<RangeInclusive<u32>, String> {
    let number = |text: &str| text.trim().parse().ok().filter(|&number: &u32| number > 0);
    let range = match text.split_once('-') {
        Some((first, last)) => number(first).zip(number(last)).filter(|(first, last)| first <= last),
        None => number(text).map(|number| (number, number)),
    };
    let (first, last) = range.ok_or("give a primitive's number, counted from 1, or a range of them, such as 3 or 2-5")?;
    Ok(first..=last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_and_numbers_of_parts() {
        assert_eq!((angle("0"), angle(" 22.5 "), angle("180")), (Ok(0.0), Ok(22.5), Ok(180.0)));
        assert!(["", "-1", "180.1", "nan", "inf", "x"].iter().all(|text| angle(text).is_err()));
        assert_eq!((parts("3"), parts("2-5"), parts("7 - 7")), (Ok(3..=3), Ok(2..=5), Ok(7..=7)));
        assert!(["", "0", "0-3", "5-2", "-3", "3-", "1-2-3", "x", "4294967296"].iter().all(|text| parts(text).is_err()));
    }

    #[test]
    fn sections_keep_the_side_that_their_normal_points_away_from() {
        let plane = section("0, 0, 2, 10").unwrap();
        assert_eq!((plane.normal, plane.offset), (DVec3::NEG_Z, -5.0));
        let plane = section("3,4,0,-5").unwrap();
        assert!((plane.normal - DVec3::new(-0.6, -0.8, 0.0)).length() < 1e-15 && (plane.offset - 1.0).abs() < 1e-15, "{plane:?}");
        for text in ["1e300,1e300,0,1e300", "1e-310,0,0,1e-310", "1e-300,0,0,1"] {
            let plane = section(text).unwrap();
            assert!((plane.normal.length() - 1.0).abs() < 1e-12 && plane.offset.is_finite(), "{text}");
        }
        for text in ["", "0,0,1", "0,0,1,2,3", "0,0,0,1", "0,0,nan,1", "0,0,1,inf", "0,0,1,x", "0,0,1e-300,1e300", "-0,0,-0,1"] {
            assert!(section(text).is_err(), "{text}");
        }
    }
}
