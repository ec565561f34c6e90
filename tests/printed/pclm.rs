//! PCLm pages, read by Ghostscript and MuPDF.

use crate::raster::{Raster, Rng, inks, program, shaded};
use crate::{expected, kind, rasters};
use runset::encode::by_name;
use runset::error::Kind;
use runset::run::{Header, Inks, Pixels, Sheet};

/// The size and the pixels of a pixmap or a graymap, and whether it is a pixmap.
fn pixmap(file: &[u8]) -> (usize, usize, bool, Vec<u8>) {
    let image = image::load_from_memory(file).unwrap();
    let is_rgb = image.color() == image::ColorType::Rgb8;
    let (width, height) = (image.width() as usize, image.height() as usize);
    (width, height, is_rgb, if is_rgb { image.into_rgb8().into_raw() } else { image.into_luma8().into_raw() })
}

/// The pixels of a raster as RGB.
fn rgb(raster: &Raster) -> Vec<u8> {
    match kind(raster, "urf") {
        Pixels::Rgb => expected(raster, Pixels::Rgb),
        _ => expected(raster, Pixels::Gray).into_iter().flat_map(|luma| [luma; 3]).collect(),
    }
}

/// Rasters that are drawn as they are at 72 dots an inch, where a pixel is a point.
fn pages() -> Vec<Raster> {
    let mut rng = Rng(21);
    let mut all: Vec<Raster> =
        rasters().into_iter().filter(|raster| raster.header.width < 2000 && raster.header.width > 2).step_by(3).collect();
    // One row repeated through many strips, beginning in the middle of one.
    for inks in [inks(1), inks(3)].into_iter().chain(shaded()) {
        let mut raster = Raster::random(&mut rng, 300, 5..505, inks);
        let row = raster.rows[0].clone();
        raster.rows[3..300].fill(row);
        all.push(raster);
    }
    for raster in &mut all {
        raster.header.dpi = Some(72.0);
        raster.header.sheet.pixels = [None, Some(Pixels::Gray), Some(Pixels::Rgb), Some(Pixels::Black)][rng.below(4) as usize];
    }
    all
}

#[test]
fn readers_of_pdf_see_the_pixels() {
    let (Some(gs), Some(mutool)) = (program("gs"), program("mutool")) else { return };
    let folder = tempfile::tempdir().unwrap();
    let [pdf, ppm] = ["page.pdf", "page.ppm"].map(|name| folder.path().join(name));
    let path = |path: &std::path::Path| path.to_str().unwrap().to_owned();
    for raster in pages() {
        std::fs::write(&pdf, raster.encode("pclm")).unwrap();
        let to_file = format!("-sOutputFile={}", path(&ppm));
        let gs_options = [
            "-q",
            "-dNOPAUSE",
            "-dBATCH",
            "-dSAFER",
            "-dPDFSTOPONERROR",
            "-dNOINTERPOLATE",
            "-r72",
            "-sDEVICE=ppmraw",
            &to_file,
            &path(&pdf),
        ];
        let mu_options = ["draw", "-q", "-r", "72", "-F", "ppm", "-o", &path(&ppm), &path(&pdf)];
        for (reader, options) in [(&gs, &gs_options[..]), (&mutool, &mu_options)] {
            let ran = std::process::Command::new(reader).args(options).output().unwrap();
            let said = String::from_utf8_lossy(&ran.stderr).replace("warning: ICC support is not available", "");
            assert!(ran.status.success() && said.trim().is_empty(), "{reader:?}: {said}");
            let (width, height, _, pixels) = pixmap(&std::fs::read(&ppm).unwrap());
            assert_eq!((width, height), (raster.header.width as usize, raster.rows.len()), "{reader:?}");
            assert!(pixels == rgb(&raster), "{reader:?}, {:?}", raster.header);
        }
    }
}

/// Every strip by MuPDF, which knows the objects by the table at the end: their pixels as they are, whatever the resolution.
#[test]
fn strips_are_taken_out() {
    let Some(mutool) = program("mutool") else { return };
    let folder = tempfile::tempdir().unwrap();
    for (raster, number) in rasters().into_iter().step_by(7).zip(0..).filter(|(raster, _)| raster.header.width < 65_536) {
        let folder = folder.path().join(format!("{number}"));
        std::fs::create_dir(&folder).unwrap();
        std::fs::write(folder.join("page.pdf"), raster.encode("pclm")).unwrap();
        let ran = std::process::Command::new(&mutool).args(["extract", "page.pdf"]).current_dir(&folder).output().unwrap();
        let said = String::from_utf8_lossy(&ran.stderr).replace("warning: ICC support is not available", "");
        assert!(ran.status.success() && said.trim().is_empty(), "{said}");
        let lines = &raster.header.lines;
        let strips = lines.end.div_ceil(16) - lines.start / 16;
        let read = |strip: u32| pixmap(&std::fs::read(folder.join(format!("image-{:04}.png", 3 + 2 * strip))).unwrap());
        let kind = kind(&raster, "urf");
        let mut pixels = Vec::new();
        for strip in 0..strips {
            let (width, height, is_rgb, bytes) = read(strip);
            assert_eq!((width, is_rgb), (raster.header.width as usize, kind == Pixels::Rgb));
            assert!(height == 16 || strip == 0 || strip + 1 == strips);
            pixels.extend(bytes);
        }
        assert!(pixels == expected(&raster, kind), "{:?}", raster.header);
    }
}

#[test]
fn a_file_begins_and_ends_as_it_should() {
    let mut raster = Raster::random(&mut Rng(1), 4961, 0..33, inks(1));
    raster.header.dpi = Some(600.0);
    let file = raster.encode("pclm");
    assert!(file.starts_with(b"%PDF-1.7\n%PCLm 1.0\n1 0 obj\n"));
    let text = String::from_utf8_lossy(&file).into_owned();
    assert!(text.contains("/MediaBox [ 0 0 595.32 3.96 ]") && text.contains("0.12 0 0 0.12 0 0 cm"), "{}", &text[..400]);
    assert!(text.contains("q 4961 0 0 16 0 17 cm /Image0 Do Q") && text.contains("q 4961 0 0 1 0 0 cm /Image2 Do Q"));
    // Every place in the table is where its object begins.
    let (table, end) = text.split_once("\nxref\n").unwrap();
    let mut lines = end.lines();
    let count: usize = lines.next().unwrap().split_once(' ').unwrap().1.parse().unwrap();
    assert_eq!((count, lines.next()), (11, Some("0000000000 65535 f ")));
    for number in 1..count {
        let place: usize = lines.next().unwrap()[..10].parse().unwrap();
        assert!(file[place..].starts_with(format!("{number} 0 obj\n").as_bytes()), "{number}");
    }
    let start: usize = lines.nth(3).unwrap().parse().unwrap();
    assert!(file[start..].starts_with(b"xref\n") && file.ends_with(b"%%EOF\n") && !table.is_empty());
}

#[test]
fn what_is_too_large_is_refused() {
    let pclm = by_name("pclm").unwrap();
    let header =
        |width: u32, height: u32, inks: Inks, dpi: Option<f64>| Header { width, lines: 5..5 + height, inks, dpi, sheet: Sheet::default() };
    let colour = || Inks::Listed(vec![[1, 2, 3]]);
    assert!((pclm.fits)(&header(65_535, 65_535, inks(1), None)).is_ok());
    for (header, about) in [
        (header(65_536, 1, inks(1), None), "65535 px a side"),
        (header(65_535, 65_535, colour(), None), "8000000000 bytes of pixels"),
        (header(1, 1, colour(), Some(0.4)), "dots an inch"),
    ] {
        let error = (pclm.fits)(&header).unwrap_err();
        assert!(error.kind == Kind::Limit && error.what.contains(about), "{error}");
    }
    let two = Header { sheet: Sheet { of: 2, ..Sheet::default() }, ..header(1, 1, colour(), None) };
    assert!(pclm.check(&two).is_err());
}
