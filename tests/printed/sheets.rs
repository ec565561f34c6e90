//! What stands in the headers of pages, and pages that are drawn by jobs.

use crate::raster::{Raster, Rng, inks};
use crate::readers::{cups, print_raster};
use runset::encode::by_name;
use runset::error::Kind;
use runset::input;
use runset::job::{Job, Options, Size, render_sheets};
use runset::run::Pixels;
use runset::scene::Limits;

/// A page of that many pixels.
fn page(width: u32, height: u32, dpi: f64) -> Raster {
    let mut raster = Raster::random(&mut Rng(1), width, 0..1, inks(1));
    raster.rows = vec![vec![0; width as usize]; height as usize];
    raster.header.lines = 0..height;
    raster.header.dpi = Some(dpi);
    raster
}

#[test]
fn sizes_of_pages() {
    // Pixels, dots an inch, points, the name of the size or none of its own.
    let cases = [
        ((4961, 7016, 600.0), [595, 842], "iso_a4_210x297mm"),
        ((1240, 1754, 150.0), [595, 842], "iso_a4_210x297mm"),
        ((5100, 6600, 600.0), [612, 792], "na_letter_8.5x11in"),
        ((816, 1056, 96.0), [612, 792], "na_letter_8.5x11in"),
        ((1985, 2806, 72.0), [1985, 2806], ""),
        ((9933, 14_043, 300.0), [2384, 3370], "iso_a0_841x1189mm"),
        ((1200, 1800, 300.4), [288, 432], "na_index-4x6_4x6in"),
        ((7016, 4961, 600.0), [842, 595], ""),
        ((1, 1, 600.0), [1, 1], ""),
    ];
    let rasters: Vec<_> = cases.iter().map(|&((width, height, dpi), ..)| page(width, height, dpi)).collect();
    let files: Vec<_> = rasters.iter().map(|raster| raster.encode("pwg")).collect();
    for (file, (_, points, name)) in files.iter().zip(&cases) {
        let page = &print_raster(file, "pwg")[0];
        assert_eq!(page.points, *points);
        assert!(if name.is_empty() { page.name.starts_with("custom_") } else { page.name == *name }, "{}", page.name);
    }
    let Some(read) = cups(&files, "pwg") else { return };
    for (page, ((width, height, dpi), points, _)) in read.iter().map(|pages| &pages[0]).zip(cases) {
        assert_eq!((page.points, page.image, page.pages), (points, [0, 0, width, height], 1));
        // The size that libcups knows for the name is that of the page.
        for (pixels, hundredths) in [width, height].into_iter().zip(page.size) {
            let exact = f64::from(pixels) * 2540.0 / dpi.round();
            assert!((exact - f64::from(hundredths)).abs() <= 50.0, "{}: {exact}", page.name);
        }
    }
}

/// The layout by PWG 5102.4, table 2, byte by byte.
#[test]
fn a_header_by_hand() {
    let mut raster = page(9, 2, 600.0);
    raster.rows[0] = vec![0, 1, 1, 1, 1, 1, 1, 1, 1];
    let file = raster.encode("pwg");
    let mut expected = vec![0; 4 + 1796];
    expected[..4].copy_from_slice(b"RaS2");
    expected[4..13].copy_from_slice(b"PwgRaster");
    let name = b"custom_0.38x0.08mm_0.38x0.08mm";
    expected[4 + 1732..][..name.len()].copy_from_slice(name);
    for (at, number) in [
        (276, 600),
        (280, 600),
        (340, 1),
        (352, 1),
        (356, 1),
        (372, 9),
        (376, 2),
        (384, 1),
        (388, 1),
        (392, 2),
        (400, 3),
        (420, 1),
        (452, 1),
        (456, 1),
        (460, 1),
        (472, 9),
        (476, 2),
        (480, 0xff_ffff),
    ] {
        expected[4 + at..][..4].copy_from_slice(&u32::to_be_bytes(number));
    }
    // A line of 0111 1111 1000 0000: two literals. A line of two equal bytes.
    expected.extend([0, 255, 0x7f, 0x80, 0, 1, 0]);
    assert!(file == expected, "{file:02x?}");
    let mut expected = b"UNIRAST\0\0\0\0\x01".to_vec();
    expected.extend([8, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 9, 0, 0, 0, 2, 0, 0, 2, 88]);
    expected.extend([0; 8]);
    // A white pixel as it is, eight black ones; a line that is white to its end.
    expected.extend([0, 0, 255, 7, 0, 0, 128]);
    assert!(raster.encode("urf") == expected, "{:02x?}", raster.encode("urf"));
}

fn job(drawing: &str, options: &Options) -> Job {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/art").join(drawing);
    let mut warnings = Vec::new();
    let scene = input::read(std::fs::read(path).unwrap(), &Limits::default(), &mut warnings).unwrap();
    Job::prepare(scene, options, &mut warnings).unwrap()
}

fn rendered(job: &Job, format: &str) -> Vec<u8> {
    let mut out = Vec::new();
    job.render(by_name(format).unwrap(), 2, &mut out, &mut |_| ()).unwrap();
    out
}

/// The pixels of a pixmap: what stands behind its head of three lines.
fn behind_head(pixmap: &[u8]) -> &[u8] {
    let end = pixmap.iter().enumerate().filter(|byte| *byte.1 == b'\n').map(|byte| byte.0).nth(2).unwrap();
    &pixmap[end + 1..]
}

#[test]
fn drawings_are_the_pages_of_a_file() {
    let drawings = [("poster.svg", Pixels::Rgb), ("board.svg", Pixels::Gray), ("scene.json", Pixels::Rgb)];
    for format in ["pwg", "urf"] {
        let make = |number: u32| {
            let (drawing, pixels) = drawings[number as usize];
            job(drawing, &Options { size: Size::Dpi(150.0), pixels: Some(pixels), ..Options::default() })
        };
        let (mut out, mut told) = (Vec::new(), Vec::new());
        let format = by_name(format).unwrap();
        let costs =
            render_sheets(3, &mut |number| Ok(make(number)), format, 2, &mut out, &mut |page, lines| told.push((page, lines))).unwrap();
        assert!(told.is_sorted() && costs.iter().zip(0..).all(|(cost, page)| told.contains(&(page, cost.lines))));
        let pages = print_raster(&out, format.name);
        assert_eq!(pages.len(), 3);
        for (page, number) in pages.iter().zip(0..) {
            let job = make(number);
            let pixmap = rendered(&job, if drawings[number as usize].1 == Pixels::Gray { "pgm" } else { "ppm" });
            assert_eq!((page.width, page.height, page.dpi), (job.header().width, job.header().height(), 150));
            assert!(page.pixels == behind_head(&pixmap), "{}, page {number}", format.name);
        }
        let Some(read) = cups(&[out], format.name) else { return };
        assert!(read[0].iter().zip(&pages).all(|(cups, page)| cups.pixels == page.pixels));
    }
}

#[test]
fn what_a_format_does_not_hold_is_refused_before_the_first_byte() {
    let refused = |format: &str, options: &Options, of: u32| {
        let mut out = Vec::new();
        let format = by_name(format).unwrap();
        let error = render_sheets(of, &mut |_| Ok(job("scene.json", options)), format, 1, &mut out, &mut |_, _| ()).unwrap_err();
        assert!(out.is_empty());
        error
    };
    let pages = refused("png", &Options::default(), 2);
    assert!(
        pages.what.starts_with("a file of png is one page, and 2 are asked for: ask for one, or for a format of pwg, urf, pcl"),
        "{pages}"
    );
    assert_eq!(refused("pwg", &Options::default(), 0).kind, Kind::Refused);
    for dpi in [0.3, 1e12, -5.0, f64::NAN, f64::INFINITY] {
        for format in ["pwg", "urf"] {
            let error = refused(format, &Options { dpi: Some(dpi), ..Options::default() }, 1);
            assert!(error.kind == Kind::Limit && error.what.contains("dots an inch"), "{error}");
        }
    }
}
