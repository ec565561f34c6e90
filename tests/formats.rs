//! Every format of pixels is read back by readers that are not ours.

#![allow(clippy::unwrap_used)]

mod raster;

use raster::{Raster, Rng, inks, program, run, shaded};
use runset::encode::{FORMATS, by_extension, by_name};
use runset::run::{Inks, Rgb};

/// Numbers of inks around every change of a format's layout.
const INKS: [usize; 12] = [0, 1, 2, 3, 4, 15, 16, 254, 255, 256, 257, 300];

fn rasters() -> impl Iterator<Item = Raster> {
    let mut rng = Rng(1);
    let sizes = [1, 2, 7, 8, 9, 16, 31, 64, 65, 257, 1000];
    INKS.map(inks).into_iter().chain(shaded()).flat_map(move |inks| sizes.map(|width| (inks.clone(), width))).map(move |(inks, width)| {
        let (from, height) = (rng.below(9000), 1 + rng.below(40));
        Raster::random(&mut rng, width, from..from + height, inks)
    })
}

/// The raster's colours as a format shows them.
fn expected(raster: &Raster, format: &str) -> Vec<Rgb> {
    let show = |[r, g, b]: Rgb, painted: bool| match format {
        "pbm" if painted => [0; 3],
        "pbm" => [255; 3],
        "pgm" => [(0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)).round() as u8; 3],
        _ => [r, g, b],
    };
    let pixels = |y: usize| (0..raster.header.width as usize).map(move |x| (x, y));
    (0..raster.rows.len()).flat_map(pixels).map(|(x, y)| show(raster.colour(x, y), raster.rows[y][x] > 0)).collect()
}

fn check(bytes: &[u8], raster: &Raster, format: &str) {
    let image = image::load_from_memory(bytes).unwrap().to_rgb8();
    assert_eq!(image.dimensions(), (raster.header.width, raster.header.height()), "{format}");
    let pixels: Vec<Rgb> = image.pixels().map(|p| p.0).collect();
    assert!(pixels == expected(raster, format), "{format} of {} inks, width {}", raster.header.inks.end(), raster.header.width);
}

#[test]
fn the_image_crate_sees_the_pixels() {
    for raster in rasters() {
        for format in ["pbm", "pgm", "ppm", "png"] {
            check(&raster.encode(format), &raster, format);
        }
    }
}

#[test]
fn a_single_ink_that_is_not_black_keeps_its_colour() {
    let raster = Raster::random(&mut Rng(7), 77, 0..30, Inks::Listed(vec![[0xe4, 0, 0x7f]]));
    for format in ["pbm", "pgm", "ppm", "png"] {
        check(&raster.encode(format), &raster, format);
    }
}

#[test]
fn luma_of_pure_colours() {
    // 0.2126 · 255 = 54.2, 0.7152 · 255 = 182.4, 0.0722 · 255 = 18.4
    let mut raster = Raster::random(&mut Rng(0), 4, 0..1, Inks::Listed(vec![[255, 0, 0], [0, 255, 0], [0, 0, 255]]));
    raster.rows[0] = vec![0, 1, 2, 3];
    assert_eq!(raster.encode("pgm"), b"P5\n4 1\n255\n\xff\x36\xb6\x12");
}

#[test]
fn a_shaded_raster_by_hand() {
    // Paper is the least of all colours but black, and one pixel of four is painted in paper's colour.
    let mut raster = Raster::random(&mut Rng(0), 4, 0..1, Inks::Shaded { paper: [0, 0, 1] });
    raster.rows[0] = vec![0, 0x12_3456 + 1, 0x00_0001 + 1, 0xff_ffff + 1];
    assert_eq!(raster.encode("ppm"), b"P6\n4 1\n255\n\x00\x00\x01\x12\x34\x56\x00\x00\x01\xff\xff\xff");
    // 0.2126 · 18 + 0.7152 · 52 + 0.0722 · 86 = 47.2
    assert_eq!(raster.encode("pgm"), b"P5\n4 1\n255\n\x00\x2f\x00\xff");
    assert_eq!(raster.encode("pbm"), b"P4\n4 1\n\x70");
}

#[test]
fn line_streams_are_converted_to_every_format() {
    for raster in rasters().step_by(4) {
        for stream in ["ndjson", "rls"] {
            let bytes = raster.encode(stream);
            for format in FORMATS {
                let mut out = Vec::new();
                let header = runset::job::convert(&mut &bytes[..], format, None, &mut out, &mut |_| ()).unwrap();
                assert_eq!(header, raster.header);
                assert!(out == raster.encode(format.name), "{stream} to {}", format.name);
            }
        }
    }
}

#[test]
fn png_takes_the_smallest_colour_type() {
    use png::{BitDepth as D, ColorType as C};
    let types = [
        (0, C::Grayscale, D::One),
        (1, C::Grayscale, D::One),
        (2, C::Indexed, D::Two),
        (3, C::Indexed, D::Two),
        (4, C::Indexed, D::Four),
        (15, C::Indexed, D::Four),
        (16, C::Indexed, D::Eight),
        (255, C::Indexed, D::Eight),
        (256, C::Rgb, D::Eight),
    ];
    let types = types.map(|(n, colour, depth)| (inks(n), colour, depth)).into_iter();
    for (inks, colour, depth) in types.chain(shaded().map(|inks| (inks, C::Rgb, D::Eight))) {
        let mut raster = Raster::random(&mut Rng(3), 50, 0..20, inks.clone());
        for dpi in [None, Some(600.0)] {
            raster.header.dpi = dpi;
            let bytes = raster.encode("png");
            let reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
            let info = reader.info();
            assert_eq!((info.color_type, info.bit_depth), (colour, depth), "{inks:?}");
            // 600 dots an inch are 23,622.05 a metre.
            let per_metre = info.pixel_dims.map(|d| (d.xppu, d.yppu, d.unit == png::Unit::Meter));
            assert_eq!(per_metre, dpi.map(|_| (23_622, 23_622, true)));
        }
    }
    let coloured = Raster::random(&mut Rng(3), 50, 0..20, Inks::Listed(vec![[1, 2, 3]]));
    let bytes = coloured.encode("png");
    let reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
    assert_eq!((reader.info().color_type, reader.info().bit_depth), (C::Indexed, D::One));
    assert_eq!(reader.info().palette.as_deref(), Some(&[255, 255, 255, 1, 2, 3][..]));
}

#[test]
fn netpbm_sees_the_pixels() {
    let (Some(to_png), Some(from_png)) = (program("pnmtopng"), program("pngtopnm")) else { return };
    for raster in rasters().step_by(5) {
        for format in ["pbm", "pgm", "ppm"] {
            check(&run(&to_png, &["-quiet"], &raster.encode(format)), &raster, format);
        }
        check(&run(&from_png, &["-quiet"], &raster.encode("png")), &raster, "png");
    }
}

#[test]
fn pngcheck_finds_nothing() {
    let Some(pngcheck) = program("pngcheck") else { return };
    for mut raster in rasters().step_by(7).chain(talls()) {
        raster.header.dpi = Some(300.0);
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), raster.encode("png")).unwrap();
        run(&pngcheck, &["-q", file.path().to_str().unwrap()], b"");
    }
}

/// A raster of several PNG segments, some of them one row repeated.
fn tall(inks: Inks) -> Raster {
    let (width, height) = if inks.end() > 255 { (1200, 1400) } else { (6000, 7000) };
    let mut raster = Raster::random(&mut Rng(inks.end().into()), width, 0..height, inks);
    // Equal rows from the middle of a segment through whole segments into another one.
    let blank = vec![0; width as usize];
    raster.rows[height as usize / 3..height as usize * 9 / 10].fill(blank);
    raster
}

fn talls() -> [Raster; 3] {
    [inks(300), inks(1), Inks::Shaded { paper: [255, 255, 229] }].map(tall)
}

#[test]
fn bytes_depend_on_the_picture_alone() {
    let mut rng = Rng(5);
    let wide = Raster::random(&mut rng, 500_000, 0..9, inks(300));
    for raster in rasters().chain(talls()).chain([wide]) {
        for format in FORMATS {
            let bytes = raster.encode(format.name);
            assert!(bytes == raster.encode_in_groups(format.name, &mut rng, false), "{}, in large groups", format.name);
            assert!(bytes == raster.encode_in_groups(format.name, &mut rng, true), "{}, in groups", format.name);
            assert!(bytes == raster.encode_in_parts(format.name, &mut rng), "{}, in parts", format.name);
        }
    }
}

/// Contents of the IDAT chunks behind the zlib header.
fn segments(png: &[u8]) -> Vec<&[u8]> {
    let (mut rest, mut chunks) = (&png[8..], Vec::new());
    while let Some((len, after)) = rest.split_first_chunk() {
        let (chunk, next) = after.split_at(u32::from_be_bytes(*len) as usize + 8);
        if chunk.starts_with(b"IDAT") {
            chunks.push(&chunk[4..chunk.len() - 4]);
        }
        rest = next;
    }
    chunks.remove(0);
    chunks
}

#[test]
fn png_can_be_written_and_read_from_any_segment() {
    for (raster, row_bytes) in talls().into_iter().zip([1200 * 3, 6000 / 8, 1200 * 3]) {
        let whole = raster.encode("png");
        let part = |rows: std::ops::Range<usize>| {
            let lines = rows.start as u32..rows.end as u32;
            Raster { header: runset::run::Header { lines, ..raster.header.clone() }, rows: raster.rows[rows].to_vec() }.encode("png")
        };
        // Rows that are about 256 KiB, a power of two.
        let rows = 1 << ((1usize << 18) / row_bytes).ilog2();
        assert!(raster.rows.len() > 3 * rows, "several segments");
        for cut in (rows..raster.rows.len()).step_by(rows) {
            let (above, below) = (part(0..cut), part(cut..raster.rows.len()));
            let (above, below, whole) = (segments(&above), segments(&below), segments(&whole));
            // Both parts as they stand in the whole, but for the last chunk: the end of `above`, and checksums.
            let joined: Vec<_> = above[..above.len() - 1].iter().chain(&below[..below.len() - 1]).collect();
            assert!(joined.iter().copied().eq(&whole[..whole.len() - 1]), "{} inks, cut at row {cut}", raster.header.inks.end());
            let mut inflated = Vec::new();
            let rest = whole[above.len() - 1..].concat();
            std::io::Read::read_to_end(&mut flate2::read::DeflateDecoder::new(&rest[..]), &mut inflated).unwrap();
            assert_eq!(inflated.len(), (raster.rows.len() - cut) * (row_bytes + 1));
        }
    }
}

#[test]
fn formats_are_found_by_name_and_extension() {
    let names: Vec<_> = FORMATS.iter().map(|f| f.name).collect();
    assert_eq!(names, ["pbm", "pgm", "ppm", "png", "pwg", "urf", "pcl", "pclm", "ndjson", "rls"]);
    assert_eq!(by_extension("PNG").map(|f| f.name), Some("png"));
    assert_eq!(by_extension("jsonl").map(|f| f.name), Some("ndjson"));
    assert!(by_name("gif").is_none() && by_extension("").is_none());
}
