//! Names of sizes of paper, from the size of a page.
//!
//! A standard name ends in its size, so the names are the table. Other sizes have names of their own, made the same way.
//!
//! Source: PWG 5101.1-2013, Media Standardized Names, section 5.

/// Millimetres to an inch.
const INCH: f64 = 25.4;

/// Most that a side may differ from that of a name, in millimetres: pixels at 72 dots an inch are a third.
const NEAR: f64 = 0.5;

/// Standard names.
#[rustfmt::skip]
const NAMES: [&str; 86] = [
    "iso_2a0_1189x1682mm", "iso_a0_841x1189mm", "iso_a1_594x841mm", "iso_a2_420x594mm", "iso_a3_297x420mm", "iso_a4_210x297mm",
    "iso_a5_148x210mm", "iso_a6_105x148mm", "iso_a7_74x105mm", "iso_a8_52x74mm", "iso_a9_37x52mm", "iso_a10_26x37mm",
    "iso_b0_1000x1414mm", "iso_b1_707x1000mm", "iso_b2_500x707mm", "iso_b3_353x500mm", "iso_b4_250x353mm", "iso_b5_176x250mm",
    "iso_b6_125x176mm", "iso_b7_88x125mm", "iso_b8_62x88mm", "iso_b9_44x62mm", "iso_b10_31x44mm", "iso_c0_917x1297mm",
    "iso_c1_648x917mm", "iso_c2_458x648mm", "iso_c3_324x458mm", "iso_c4_229x324mm", "iso_c5_162x229mm", "iso_c6_114x162mm",
    "iso_c7_81x114mm", "iso_c8_57x81mm", "iso_c9_40x57mm", "iso_c10_28x40mm", "iso_dl_110x220mm", "iso_ra0_860x1220mm",
    "iso_ra1_610x860mm", "iso_ra2_430x610mm", "iso_ra3_305x430mm", "iso_ra4_215x305mm", "iso_sra0_900x1280mm", "iso_sra1_640x900mm",
    "iso_sra2_450x640mm", "iso_sra3_320x450mm", "iso_sra4_225x320mm", "na_f_44x68in", "na_arch-e_36x48in", "na_e_34x44in",
    "na_arch-d_24x36in", "na_d_22x34in", "na_arch-c_18x24in", "na_c_17x22in", "na_super-b_13x19in", "na_arch-b_12x18in",
    "na_ledger_11x17in", "na_arch-a_9x12in", "na_foolscap_8.5x13in", "na_legal_8.5x14in", "na_letter_8.5x11in",
    "na_govt-legal_8x13in", "na_govt-letter_8x10in", "na_executive_7.25x10.5in", "na_invoice_5.5x8.5in", "na_5x7_5x7in",
    "na_index-5x8_5x8in", "na_number-10_4.125x9.5in", "na_index-4x6_4x6in", "na_monarch_3.875x7.5in", "na_index-3x5_3x5in",
    "jis_b0_1030x1456mm", "jis_b1_728x1030mm", "jis_b2_515x728mm", "jis_b3_364x515mm", "jis_b4_257x364mm", "jis_b5_182x257mm",
    "jis_b6_128x182mm", "jis_b7_91x128mm", "jis_b8_64x91mm", "jis_b9_45x64mm", "jis_b10_32x45mm", "jpn_oufuku_148x200mm",
    "jpn_hagaki_100x148mm", "oe_photo-l_3.5x5in", "om_folio_210x330mm", "om_italian_110x230mm", "om_small-photo_100x150mm",
];

/// The name of a page of that many pixels a side, at so many dots an inch (at least 1): the standard name that is nearest, as the page stands, or one of its own,
/// `custom_WxHmm_WxHmm`. At most 63 bytes.
pub fn name(width: u32, height: u32, dpi: u32) -> String {
    let sides = [width, height].map(|pixels| f64::from(pixels) * INCH / f64::from(dpi));
    let distance = |name: &str| size(name).map(|named| (named[0] - sides[0]).abs().max((named[1] - sides[1]).abs()));
    let near = NAMES.iter().filter_map(|name| Some((distance(name)?, *name))).filter(|near| near.0 <= NEAR);
    near.min_by(|a, b| a.0.total_cmp(&b.0)).map_or_else(|| custom(sides), |near| near.1.to_owned())
}

/// The sides in millimetres that a name ends in.
fn size(name: &str) -> Option<[f64; 2]> {
    let (_, size) = name.rsplit_once('_')?;
    let (size, unit) = size.split_at_checked(size.len().checked_sub(2)?)?;
    let (width, height) = size.split_once('x')?;
    let unit = if unit == "in" { INCH } else { 1.0 };
    Some([width.parse::<f64>().ok()? * unit, height.parse::<f64>().ok()? * unit])
}

/// A name for a size in millimetres, in hundredths, at least one of them.
fn custom(sides: [f64; 2]) -> String {
    let [width, height] = sides.map(|side| (side * 100.0).round().max(1.0) / 100.0);
    format!("custom_{width}x{height}mm_{width}x{height}mm")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{MAX_HEIGHT, MAX_WIDTH};

    #[test]
    fn pages_have_the_name_of_their_paper() {
        // 210 mm at 600 dots an inch are 4960.6 px; 8.5 in are 5100.
        assert_eq!(name(4961, 7016, 600), "iso_a4_210x297mm");
        assert_eq!(name(794, 1123, 96), "iso_a4_210x297mm");
        assert_eq!(name(5100, 6600, 600), "na_letter_8.5x11in");
        assert_eq!(name(6600, 5100, 600), "custom_279.4x215.9mm_279.4x215.9mm");
        assert_eq!(name(6000, 12_000, 600), "custom_254x508mm_254x508mm");
        // 216 x 330 mm and 8.5 x 13 in are a fifth of a millimetre apart.
        assert_eq!(name(5100, 7800, 600), "na_foolscap_8.5x13in");
        assert_eq!(name(1, 1, u32::MAX), "custom_0.01x0.01mm_0.01x0.01mm");
        let longest = name(MAX_WIDTH, MAX_HEIGHT, 1);
        assert!(longest.len() <= 63, "{longest}");
    }

    #[test]
    fn every_name_ends_in_its_size() {
        for name in NAMES {
            let [width, height] = size(name).expect("a size");
            assert!(25.0 < width && width <= height, "{name}");
        }
    }
}
