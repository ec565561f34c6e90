//! Pages for printers, read back by readers that are not ours.

#![allow(clippy::unwrap_used)]

#[path = "../raster/mod.rs"]
mod raster;

mod pcl;
mod pclm;
mod readers;
mod sheets;

use raster::{Raster, Rng, inks, shaded};
use readers::{Page, cups, print_raster};
use runset::run::{Inks, Pixels, Rgb, Sheet};

/// All kinds of pixels that a page can be asked to have.
const KINDS: [Option<Pixels>; 4] = [None, Some(Pixels::Black), Some(Pixels::Gray), Some(Pixels::Rgb)];

/// What a raster's pixels are, from its inks: black alone, gray inks, any colours.
fn kind(raster: &Raster, format: &str) -> Pixels {
    let header = &raster.header;
    let pixels = header.sheet.pixels.unwrap_or_else(|| match &header.inks {
        Inks::Listed(list) if list.iter().all(|ink| *ink == [0; 3]) => Pixels::Black,
        Inks::Listed(list) if list.iter().all(|ink| ink[0] == ink[1] && ink[1] == ink[2]) => Pixels::Gray,
        _ => Pixels::Rgb,
    });
    if format == "urf" && pixels == Pixels::Black { Pixels::Gray } else { pixels }
}

/// The bytes of a raster's pixels, row after row.
fn expected(raster: &Raster, pixels: Pixels) -> Vec<u8> {
    let width = raster.header.width as usize;
    let luma = |[r, g, b]: Rgb| (0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)).round() as u8;
    let row = |y: usize| -> Vec<u8> {
        match pixels {
            Pixels::Black => {
                let eight = |some: &[u32]| some.iter().enumerate().fold(0, |byte, (i, &pixel)| byte | u8::from(pixel > 0) << (7 - i));
                raster.rows[y].chunks(8).map(eight).collect()
            }
            Pixels::Gray => (0..width).map(|x| luma(raster.colour(x, y))).collect(),
            Pixels::Rgb => (0..width).flat_map(|x| raster.colour(x, y)).collect(),
        }
    };
    (0..raster.rows.len()).flat_map(row).collect()
}

/// Rasters of all kinds: a pixel, odd widths, more than 16 bits wide, white, a checkerboard, at random.
fn rasters() -> Vec<Raster> {
    let mut rng = Rng(11);
    let gray = Inks::Listed(vec![[0; 3], [9; 3], [255; 3], [200; 3]]);
    let kinds = [inks(0), inks(1), inks(3), inks(300), Inks::Listed(vec![[1, 2, 3]]), gray].into_iter().chain(shaded());
    let mut all = Vec::new();
    for inks in kinds {
        for width in [1, 2, 3, 7, 8, 9, 31, 127, 128, 129, 255, 257, 1000] {
            let (from, height) = (rng.below(9000), 1 + rng.below(700));
            all.push(Raster::random(&mut rng, width, from..from + height, inks.clone()));
        }
        let mut white = Raster::random(&mut rng, 777, 200..1100, inks.clone());
        white.rows.iter_mut().for_each(|row| row.fill(0));
        let mut board = Raster::random(&mut rng, 131, 0..67, inks.clone());
        let painted = u32::from(board.header.inks.end() > 0);
        board
            .rows
            .iter_mut()
            .zip(0..)
            .for_each(|(row, y)| row.iter_mut().zip(0..).for_each(|(pixel, x): (_, u32)| *pixel = (x + y) % 2 * painted));
        let wide = Raster::random(&mut rng, 65_537, 3..9, inks);
        all.extend([white, board, wide]);
    }
    for raster in &mut all {
        raster.header.dpi = [None, Some(600.0), Some(299.6), Some(1.0)][rng.below(4) as usize];
    }
    all
}

/// Holds the pages of a file to rasters.
fn compare(pages: &[Page], rasters: &[&Raster], format: &str) {
    assert_eq!(pages.len(), rasters.len(), "{format}");
    for (page, raster) in pages.iter().zip(rasters) {
        let (header, pixels) = (&raster.header, kind(raster, format));
        let (bits, space, colours) = match pixels {
            Pixels::Black => (1, 3, 1),
            Pixels::Gray => (8, 18, 1),
            Pixels::Rgb => (24, 19, 3),
        };
        let dpi = header.dpi.map_or(96, |dpi| dpi.round() as u32);
        assert_eq!((page.width, page.height, page.bits, page.dpi), (header.width, header.height(), bits, dpi), "{format}");
        assert_eq!((page.space, page.colours), (space, colours), "{format}, {pixels:?}");
        assert!(page.pixels == expected(raster, pixels), "{format}, {pixels:?}, {header:?}");
    }
}

#[test]
fn libcups_sees_the_pixels() {
    let mut all = rasters();
    for format in ["pwg", "urf"] {
        for pixels in KINDS {
            all.iter_mut().for_each(|raster| raster.header.sheet.pixels = pixels);
            let files: Vec<_> = all.iter().map(|raster| raster.encode(format)).collect();
            let Some(read) = cups(&files, format) else { return };
            read.iter().zip(&all).for_each(|(pages, raster)| compare(pages, &[raster], format));
        }
    }
}

#[test]
fn print_raster_sees_the_pixels() {
    let mut all = rasters();
    for format in ["pwg", "urf"] {
        for pixels in KINDS {
            for raster in &mut all {
                raster.header.sheet.pixels = pixels;
                compare(&print_raster(&raster.encode(format), format), &[raster], format);
            }
        }
    }
}

#[test]
fn files_of_several_pages() {
    let all = rasters();
    for format in ["pwg", "urf"] {
        let mut files = Vec::new();
        let groups: Vec<Vec<Raster>> = all
            .chunks(7)
            .map(|some| {
                let page = |(number, raster): (u32, &Raster)| {
                    let sheet = Sheet { number, of: some.len() as u32, pixels: None };
                    Raster { header: runset::run::Header { sheet, ..raster.header.clone() }, rows: raster.rows.clone() }
                };
                (0..).zip(some).map(page).collect()
            })
            .collect();
        for pages in &groups {
            let file: Vec<u8> = pages.iter().flat_map(|raster| raster.encode(format)).collect();
            let references: Vec<&Raster> = pages.iter().collect();
            let read = print_raster(&file, format);
            compare(&read, &references, format);
            // Apple raster counts its pages in front of them.
            assert!(format == "pwg" || read.iter().all(|page| page.pages == pages.len() as u32));
            files.push(file);
        }
        let Some(read) = cups(&files, format) else { return };
        for (pages, rasters) in read.iter().zip(&groups) {
            compare(pages, &rasters.iter().collect::<Vec<_>>(), format);
            // PWG raster has their number in every page's header.
            assert!(format == "urf" || pages.iter().all(|page| page.pages == rasters.len() as u32), "{format}");
        }
    }
}
