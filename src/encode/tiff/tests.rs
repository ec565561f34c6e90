//! The file around the strips, read by a crate that is not ours.

use super::*;
use crate::run::{BLACK, Inks, Sheet};
use tiff::decoder::{Decoder, DecodingResult};
use tiff::tags::{PhotometricInterpretation, Tag};

fn header(width: u32, height: u32, inks: Inks) -> Header {
    Header { width, lines: 7..7 + height, inks, dpi: None, sheet: Sheet::default() }
}

/// A raster of which line `y` has `runs(y)`, whole: written by one writer, and its head by another.
fn written(header: &Header, packing: Packing, classic: u64, runs: impl Fn(u32) -> Vec<Run>) -> Vec<u8> {
    let new = || writer(header, packing, classic);
    let (mut first, mut out, mut head) = (new(), Vec::new(), Vec::new());
    first.begin(&mut out);
    header.lines.clone().for_each(|y| first.lines(Lines { y, n: 1, runs: &runs(y) }, &mut out));
    first.end(&mut out);
    if !first.head_is_known() {
        let mut second = new();
        second.know(first.table().unwrap());
        second.begin(&mut head);
        assert_eq!(second.length(), Some(out.len() as u64));
        assert!(out[..head.len()].iter().all(|byte| *byte == 0));
        out[..head.len()].copy_from_slice(&head);
    }
    out
}

const ALL: [Packing; 4] = [Packing::None, Packing::G4, Packing::PackBits, Packing::Deflate];

fn grays() -> Inks {
    Inks::Listed(vec![[80; 3], BLACK])
}

fn step(y: u32) -> Vec<Run> {
    vec![Run { start: y % 5, end: y % 5 + 1 + y % 40, ink: y % 2 }, Run { start: 60, end: 70, ink: 1 }]
}

/// The values of a field that are one number each.
fn numbers(decoder: &mut Decoder<std::io::Cursor<&[u8]>>, tag: Tag) -> Vec<u64> {
    decoder.get_tag(tag).unwrap().into_u64_vec().unwrap()
}

#[test]
fn both_forms_hold_the_same_strips() {
    // Several strips of two rows; 2^20 bytes of rows are 16 of them.
    let header = Header { width: 70_000, ..header(0, 45, grays()) };
    for packing in [Packing::None, Packing::PackBits, Packing::Deflate] {
        let classic = written(&header, packing, CLASSIC, step);
        let big = written(&header, packing, classic.len() as u64 - 1, step);
        assert_eq!(written(&header, packing, classic.len() as u64, step), classic, "as long as may be");
        assert_eq!((&classic[..4], &big[..4], classic.len()), (&b"II*\0"[..], &b"II+\0"[..], big.len()));
        for bytes in [&classic, &big] {
            let mut decoder = Decoder::new(std::io::Cursor::new(&bytes[..])).unwrap();
            assert_eq!(decoder.dimensions().unwrap(), (70_000, 45));
            let (offsets, lengths) = (numbers(&mut decoder, Tag::StripOffsets), numbers(&mut decoder, Tag::StripByteCounts));
            // 14 rows would be a MiB, a power of two is 8.
            assert_eq!((offsets.len(), numbers(&mut decoder, Tag::RowsPerStrip)), (6, vec![8]));
            assert_eq!(offsets[5] + lengths[5], bytes.len() as u64, "nothing behind the last strip");
            assert!(offsets.windows(2).zip(&lengths).all(|(pair, length)| pair[0] + length == pair[1]), "and nothing between");
            let DecodingResult::U8(pixels) = decoder.read_image().unwrap() else { panic!("bytes") };
            for (y, row) in pixels.chunks(70_000).enumerate() {
                let mut expected = vec![255; 70_000];
                for run in step(y as u32 + 7) {
                    expected[run.start as usize..run.end as usize].fill([80, 0][run.ink as usize]);
                }
                assert!(row == expected, "{packing:?}, line {y}");
            }
        }
        let start = classic.len() - numbers(&mut Decoder::new(std::io::Cursor::new(&classic[..])).unwrap(), Tag::StripByteCounts).iter().sum::<u64>() as usize;
        assert!(classic[start..] == big[start..], "strips begin at the same byte");
    }
}

#[test]
fn fields_say_what_the_pixels_are() {
    let many = Inks::Listed((0..300).map(|i| [i as u8, (i >> 8) as u8, 9]).collect());
    let cases = [
        (Inks::Listed(vec![BLACK]), vec![1], PhotometricInterpretation::WhiteIsZero),
        (Inks::Listed(vec![]), vec![1], PhotometricInterpretation::WhiteIsZero),
        (grays(), vec![8], PhotometricInterpretation::BlackIsZero),
        (Inks::Listed(vec![[7; 3]]), vec![8], PhotometricInterpretation::BlackIsZero),
        (Inks::Listed(vec![[1, 2, 3]]), vec![4], PhotometricInterpretation::RGBPalette),
        (Inks::Listed((0..16).map(|i| [i, 0, 9]).collect()), vec![8], PhotometricInterpretation::RGBPalette),
        (Inks::Listed((0..255).map(|i| [i, 0, 9]).collect()), vec![8], PhotometricInterpretation::RGBPalette),
        (many, vec![8, 8, 8], PhotometricInterpretation::RGB),
        (Inks::Shaded { paper: [1, 2, 3] }, vec![8, 8, 8], PhotometricInterpretation::RGB),
    ];
    for (inks, bits, meaning) in cases {
        for (dpi, resolution) in [(None, None), (Some(600.0), Some((600, 1))), (Some(90.5), Some((90_500_000, 1_000_000))), (Some(5e9), None)] {
            for packing in ALL {
                let header = Header { dpi, ..header(9, 3, inks.clone()) };
                let bytes = written(&header, packing, CLASSIC, |_| vec![]);
                // The crate reads no palette and no group 4; fields are read without the pixels.
                let Ok(mut decoder) = Decoder::new(std::io::Cursor::new(&bytes[..])) else {
                    assert!(bits == [1] || bits == [4] || bits == [8], "{packing:?}");
                    continue;
                };
                assert_eq!(numbers(&mut decoder, Tag::BitsPerSample), bits);
                assert_eq!(numbers(&mut decoder, Tag::PhotometricInterpretation), [meaning as u64]);
                let found = decoder.find_tag(Tag::XResolution).unwrap().map(|value| format!("{value:?}"));
                let rational = resolution.map(|(n, d)| format!("{:?}", tiff::decoder::ifd::Value::Rational(n, d)));
                assert_eq!(found, rational, "{dpi:?}");
                let unit = decoder.find_tag(Tag::ResolutionUnit).unwrap().map(|unit| unit.into_u16().unwrap());
                assert_eq!(unit, resolution.map(|_| 2));
            }
        }
    }
}

#[test]
fn tall_pages_have_no_more_strips_than_there_is_room_for() {
    for (width, height) in [(1 << 20, 1 << 23), (1, 1 << 23), (1 << 20, 3), (79_465, 112_346)] {
        for inks in [Inks::Listed(vec![BLACK]), Inks::Shaded { paper: [0; 3] }] {
            let mut encoder = writer(&Header { width, lines: 0..height, inks, dpi: None, sheet: Sheet::default() }, Packing::PackBits, CLASSIC);
            let (rows, mut head) = (encoder.strip_lines(), Vec::new());
            assert!(rows.is_power_of_two() && height.div_ceil(rows) <= MOST_STRIPS);
            encoder.begin(&mut head);
            assert!(head.len() < 2000 + 12 * MOST_STRIPS as usize);
        }
    }
}

#[test]
fn a_table_that_is_none_is_not_taken() {
    let header = header(9, 3, grays());
    for table in [&[][..], &[1, 2], &[u64::MAX]] {
        let mut encoder = writer(&header, Packing::Deflate, CLASSIC);
        encoder.know(table);
        assert!(!encoder.head_is_known() && encoder.length().is_none(), "{table:?}");
    }
}
