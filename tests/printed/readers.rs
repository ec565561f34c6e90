//! Readers of pages that are not ours: libcups, through `cups.py`, and the crate `print_raster`.

use std::io::Write;

use crate::raster::program;
use futures::io::{AsyncRead, AsyncReadExt, Cursor};
use print_raster::model::cups::CupsPageHeaderV2;
use print_raster::reader::cups::unified::CupsRasterUnifiedReader;
use print_raster::reader::urf::UrfReader;
use print_raster::reader::{RasterPageReader, RasterReader};

/// What a reader says of a page.
#[derive(Debug, Default)]
pub struct Page {
    pub width: u32,
    pub height: u32,
    /// Of a pixel.
    pub bits: u32,
    /// 3 black, 18 gray, 19 sRGB, as CUPS numbers them.
    pub space: u32,
    pub colours: u32,
    pub dpi: u32,
    /// Size in points of 1/72 inch.
    pub points: [u32; 2],
    /// Pages of the file.
    pub pages: u32,
    /// Left, top, right, bottom of the image.
    pub image: [u32; 4],
    /// The sides of the size of that name in hundredths of a millimetre.
    pub size: [u32; 2],
    pub name: String,
    pub pixels: Vec<u8>,
}

/// The pages of every file; none where Python or libcups is missing.
pub fn cups(files: &[Vec<u8>], format: &str) -> Option<Vec<Vec<Page>>> {
    let python = program("python3")?;
    let folder = tempfile::tempdir().unwrap();
    let mut all = Vec::new();
    for (number, some) in files.chunks(100).enumerate() {
        let mut command = std::process::Command::new(&python);
        command.arg(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/printed/cups.py"));
        for (i, file) in some.iter().enumerate() {
            let path = folder.path().join(format!("{number}-{i}.{format}"));
            std::fs::File::create(&path).unwrap().write_all(file).unwrap();
            command.arg(path);
        }
        let output = command.output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        if said.contains("libcups.so.2: cannot open") {
            eprintln!("skipped: libcups is not installed");
            assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "libcups is not installed");
            return None;
        }
        assert!(output.status.success(), "{said}");
        let mut rest = &output.stdout[..];
        for _ in some {
            let mut pages = Vec::new();
            while let Some(page) = page(&mut rest) {
                pages.push(page);
            }
            all.push(pages);
        }
    }
    Some(all)
}

/// The next page of a file in what `cups.py` prints.
fn page(rest: &mut &[u8]) -> Option<Page> {
    let end = rest.iter().position(|byte| *byte == b'\n').unwrap();
    let (line, behind) = (std::str::from_utf8(&rest[..end]).unwrap(), &rest[end + 1..]);
    *rest = behind;
    let mut words = line.split(' ');
    let mut number = || words.next().unwrap().parse::<u32>();
    let Ok(width) = number() else {
        assert_eq!(line, "end");
        return None;
    };
    let mut number = || number().unwrap();
    let [height, per_colour, bits, row, order, space, colours, dpi, feed, x, y, pages] = std::array::from_fn(|_| number());
    let [cross, along, left, top, right, bottom, wide, long] = std::array::from_fn(|_| number());
    assert_eq!((order, dpi, bits), (0, feed, per_colour * colours), "{line}");
    assert_eq!(row, (width * bits).div_ceil(8), "{line}");
    // Apple raster knows no turns.
    assert!([[0, 0], [1, 1]].contains(&[cross, along]), "{line}");
    let (pixels, behind) = rest.split_at(row as usize * height as usize);
    *rest = behind;
    Some(Page {
        width,
        height,
        bits,
        space,
        colours,
        dpi,
        points: [x, y],
        pages,
        image: [left, top, right, bottom],
        size: [wide, long],
        name: words.next().unwrap_or_default().to_owned(),
        pixels: pixels.to_vec(),
    })
}

/// The pages of a file; what is wrong with it is a panic.
pub fn print_raster(file: &[u8], format: &str) -> Vec<Page> {
    futures::executor::block_on(async {
        let mut reader = Cursor::new(file);
        let mut pages = Vec::new();
        if format == "urf" {
            let reader = UrfReader::new(std::pin::Pin::new(&mut reader)).await.unwrap();
            let count = reader.header().page_count;
            let mut next = reader.next_page().await.unwrap();
            while let Some(mut page) = next {
                let pixels = all(page.content_mut()).await;
                let header = page.header();
                let gray = header.bits_per_pixel == 8;
                assert_eq!(header.color_space as u8, u8::from(!gray));
                pages.push(Page {
                    width: header.width,
                    height: header.height,
                    bits: header.bits_per_pixel.into(),
                    space: if gray { 18 } else { 19 },
                    colours: if gray { 1 } else { 3 },
                    dpi: header.dot_per_inch,
                    pages: count,
                    pixels,
                    ..Page::default()
                });
                next = page.next_page().await.unwrap();
            }
        } else {
            let reader = CupsRasterUnifiedReader::new(std::pin::Pin::new(&mut reader)).await.unwrap();
            let mut next = reader.next_page().await.unwrap();
            while let Some(mut page) = next {
                let pixels = all(page.content_mut()).await;
                let header: &CupsPageHeaderV2 = page.header();
                pages.push(Page {
                    width: header.v1.width,
                    height: header.v1.height,
                    bits: header.v1.bits_per_pixel,
                    space: header.v1.color_space as u32,
                    colours: header.num_colors,
                    dpi: header.v1.resolution.feed,
                    points: [header.v1.page_size.width, header.v1.page_size.height],
                    name: header.page_size_name.clone(),
                    pixels,
                    ..Page::default()
                });
                next = page.next_page().await.unwrap();
            }
        }
        pages
    })
}

async fn all(content: &mut (impl AsyncRead + Unpin)) -> Vec<u8> {
    let mut bytes = Vec::new();
    content.read_to_end(&mut bytes).await.unwrap();
    bytes
}
