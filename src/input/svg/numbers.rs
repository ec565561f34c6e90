//! Numbers beyond what `usvg`'s 32-bit coordinates hold: it leaves such an element out without a word, here it is refused.

use usvg::roxmltree::Document;

use super::geometry::{IDENTITY, product};
use super::notes::element;
use super::outlines::Outlines;
use super::style::Styles;
use super::{is_svg, transform};
use crate::error::{Error, Kind, Result};

/// Decimal digits before the point, exponent included, that no coordinate and no transform may pass. A coordinate of that size under a
/// transform of that size is still within 32-bit range.
const DIGITS: i64 = 18;

/// Refuses a document with such a number, or with nested transforms that multiply to one. Outlines that have been read may be known to have none.
pub(super) fn check<'a>(xml: &'a Document<'_>, styles: &Styles<'a>, outlines: &Outlines) -> Result<()> {
    let mut products = vec![IDENTITY];
    // For every node the index of its product.
    let mut under: Vec<u32> = Vec::new();
    for node in xml.descendants() {
        under.push(node.parent().map_or(0, |p| under[p.id().get_usize()]));
        let declared = Some(node).filter(|n| is_svg(*n)).and_then(|node| styles.declaration(node, "transform"));
        for attribute in node.attributes().filter(|a| a.namespace().is_none() && is_svg(node)) {
            let (name, value) = (attribute.name(), attribute.value());
            let transform = name == "transform" && declared.is_none();
            let known = name == "d" && outlines.of(node).is_some_and(|outline| outline.plain);
            if known || (!transform && !is_geometry(name)) {
                continue;
            }
            let refuse = |what: String, offset: usize| {
                let at = attribute.range_value().start + offset;
                let what = format!("{}, {name}: {what}", element(node).named());
                Err(Error::input(Kind::Refused, what).at_byte(xml.input_text().as_bytes(), at))
            };
            if let Some(offset) = too_large(value) {
                return refuse(format!("a number of more than {DIGITS} digits: SVG coordinates are 32-bit, use smaller ones"), offset);
            }
            let own = transform.then(|| transform::matrix(value)).flatten();
            if own.is_some_and(|own| !multiply(own, &mut products, &mut under)) {
                return refuse(TRANSFORMS.to_owned(), 0);
            }
        }
        if declared.and_then(transform::matrix).is_some_and(|own| !multiply(own, &mut products, &mut under)) {
            let what = format!("{}, transform: {TRANSFORMS}", element(node).named());
            return Err(Error::input(Kind::Refused, what).at_byte(xml.input_text().as_bytes(), node.range().start));
        }
    }
    Ok(())
}

const TRANSFORMS: &str = "with the transforms around it too large for 32-bit coordinates: use smaller ones";

/// Takes in the transform of the last node; false if it becomes too large.
fn multiply(own: [f64; 6], products: &mut Vec<[f64; 6]>, under: &mut [u32]) -> bool {
    let last = under.last_mut().expect("there is a last node");
    let whole = product(products[*last as usize], own);
    *last = products.len() as u32;
    products.push(whole);
    whole.iter().all(|x| x.abs() < 10_f64.powi(DIGITS as i32))
}

fn is_geometry(attribute: &str) -> bool {
    const NAMES: [&str; 16] = ["d", "points", "x", "y", "width", "height", "r", "rx", "ry", "cx", "cy", "x1", "y1", "x2", "y2", "viewBox"];
    NAMES.contains(&attribute)
}

/// Where the first number begins that has more than [`DIGITS`] digits before the point once its exponent is taken in.
fn too_large(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut at = 0;
    while at < bytes.len() {
        let start = at;
        let zeros = bytes[at..].iter().take_while(|&&b| b == b'0').count();
        let whole = digits(at);
        at += whole;
        if bytes.get(at) == Some(&b'.') {
            at += 1 + digits(at + 1);
        }
        if at == start {
            at += 1;
            continue;
        }
        let mut exponent = 0;
        if matches!(bytes.get(at), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(at + 1), Some(b'+' | b'-')));
            let end = at + 1 + sign + digits(at + 1 + sign);
            // More digits than fit are too large, or too small, in any case.
            exponent = text[at + 1 + sign..end].parse().unwrap_or(if end > at + 1 + sign { i64::from(i32::MAX) } else { 0 });
            if bytes.get(at + 1) == Some(&b'-') {
                exponent = -exponent;
            }
            at = end.max(at + 1);
        }
        if (whole - zeros.min(whole)) as i64 + exponent > DIGITS {
            return Some(start);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_numbers_are_found_where_they_begin() {
        for (text, found) in [
            ("M 1 2", None),
            ("M0 0l1e17-1E17.5.5", None),
            ("1234567890.5e8", None),
            ("1234567890.5e9", Some(0)),
            ("M1e18 0", Some(1)),
            ("5 -1E+99", Some(3)),
            ("1e-400 2e-99999999999999999999", None),
            ("00000000000000000000001", None),
            ("0 1234567890123456789", Some(2)),
            ("1e99999999999999999999", Some(0)),
            ("1em 2ex 5e", None),
            ("scale(1e2) translate(.e 1.e30)", Some(24)),
            ("ü1e30", Some(2)),
        ] {
            assert_eq!(too_large(text), found, "{text}");
        }
    }
}
