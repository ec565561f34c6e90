//! Physical sizes and fitted view boxes, against transforms worked out by hand.

use runset::job::{Job, Options, Size};
use runset::scene::{Limits, Scene};
use runset::shape::Transform;

fn read(attributes: &str) -> Scene {
    let text = format!(r#"<svg xmlns="http://www.w3.org/2000/svg" {attributes}><rect id="a" x="10" y="20" width="5" height="5"/></svg>"#);
    runset::input::read(text.into_bytes(), &Limits::default(), &mut Vec::new()).unwrap()
}

#[test]
fn pages_have_their_physical_size() {
    // A user unit is 1/96 inch, a point 1/72 inch, a pica 12 points.
    for (attributes, pixels) in [
        (r#"width="25.4mm" height="50.8mm""#, (300, 600)),
        (r#"width="2.54cm" height="1in""#, (300, 300)),
        (r#"width="72pt" height="6pc""#, (300, 300)),
        (r#"width="96px" height="48""#, (300, 150)),
        (r#"width="210mm" height="297mm" viewBox="0 0 2100 2970""#, (2480, 3508)),
        (r#"viewBox="0 0 96 192""#, (300, 600)),
        (r#"width="100%" height="100%" viewBox="0 0 96 192""#, (300, 600)),
        (r#"width="50%" height="50%" viewBox="0 0 96 192""#, (150, 300)),
        (r#"width="1in" viewBox="0 0 10 20""#, (300, 600)),
        (r#"height="1in" viewBox="0 0 10 20""#, (150, 300)),
    ] {
        let options = Options { size: Size::Dpi(300.0), expr: Some("a".to_owned()), ..Options::default() };
        let job = Job::prepare(read(attributes), &options, &mut Vec::new()).unwrap();
        assert_eq!((job.header().width, job.header().height()), pixels, "{attributes}");
    }
}

/// Sizes that come out at half a pixel are rounded up, worked out in whole numbers: a length is a number of steps, each such a part of an inch.
#[test]
fn half_pixels_are_rounded_up() {
    let mut halves = 0;
    for (unit, step, steps_an_inch) in [("mm", 0.05, 508), ("cm", 0.01, 254), ("pt", 0.25, 288), ("pc", 0.125, 48), ("in", 0.001, 1000)] {
        for dpi in [5, 10, 20, 60, 72, 100, 127, 150, 254, 300, 360, 508, 600, 720, 1016, 1200, 2400, 2540] {
            let is_half = |steps: &u64| steps * dpi % steps_an_inch * 2 == steps_an_inch;
            for steps in (1..4000).filter(is_half).step_by(7) {
                let length = format!("{:.3}{unit}", step * steps as f64);
                let scene = read(&format!(r#"width="{length}" height="1""#));
                let page = Size::Dpi(dpi as f64).page(scene.width, scene.height).unwrap();
                assert_eq!(u64::from(page.width), steps * dpi / steps_an_inch + 1, "{length} at {dpi} dpi");
                halves += 1;
            }
        }
    }
    assert!(halves > 1000, "{halves}");
}

#[test]
fn view_boxes_are_fitted_as_they_ask() {
    // The view box 10 20 100 50 on 100 x 200: it fits with 1 (150 left over below), and covers with 4 (300 beyond the sides).
    let box_on_page = r#"width="100" height="200" viewBox="10 20 100 50""#;
    for (fit, scale, corner) in [
        ("", [1., 1.], [0., 75.]),
        ("none", [1., 4.], [0., 0.]),
        ("xMinYMin meet", [1., 1.], [0., 0.]),
        ("xMidYMid", [1., 1.], [0., 75.]),
        ("xMaxYMax meet", [1., 1.], [0., 150.]),
        ("xMinYMin slice", [4., 4.], [0., 0.]),
        ("xMidYMid slice", [4., 4.], [-150., 0.]),
        ("xMaxYMin slice", [4., 4.], [-300., 0.]),
        ("xMaxYMax slice", [4., 4.], [-300., 0.]),
    ] {
        let fit_attribute = if fit.is_empty() { String::new() } else { format!(r#"preserveAspectRatio="{fit}""#) };
        let scene = read(&format!("{box_on_page} {fit_attribute}"));
        let shape = &scene.shapes[0];
        let Transform::Affine([a, b, c, d, e, f]) = shape.transform else { panic!("an SVG is affine") };
        // The rectangle's first corner is the box's.
        let [x, y] = shape.path.points()[0];
        let found = [a, b, c, d, a * x + c * y + e, b * x + d * y + f];
        let expected = [scale[0], 0.0, 0.0, scale[1], corner[0], corner[1]];
        assert!(found.iter().zip(expected).all(|(p, q)| (p - q).abs() < 1e-4), "{fit}: {found:?}");
    }
}
