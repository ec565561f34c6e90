//! PCL pages, read by a decoder of the manual's commands, which is first held to what Ghostscript, MuPDF and netpbm write.

use crate::raster::{Raster, Rng, inks, program, run, shaded};
use crate::{expected, rasters};
use runset::encode::by_name;
use runset::error::Kind;
use runset::run::{Header, Inks, Pixels, Sheet};

/// A page: rows of bytes at a bit a pixel, where something was printed.
#[derive(Default)]
struct Page {
    dpi: usize,
    /// Width and height of the raster, where they are told.
    size: [Option<usize>; 2],
    rows: Vec<Vec<u8>>,
    /// The paper's number.
    paper: Option<usize>,
}

/// What goes on from one command to the next.
#[derive(Default)]
struct Printer {
    page: Page,
    /// Line of the raster, in dots.
    y: usize,
    mode: usize,
    seed: Vec<u8>,
}

impl Printer {
    /// Takes the data of a row.
    fn row(&mut self, data: &[u8]) {
        let mut row = Vec::new();
        match self.mode {
            0 => row.extend(data),
            1 => data.chunks(2).for_each(|pair| row.extend(vec![pair[1]; usize::from(pair[0]) + 1])),
            2 => {
                let mut rest = data;
                while let [count, behind @ ..] = rest {
                    let taken = match count {
                        0..=127 => usize::from(*count) + 1,
                        128 => 0,
                        129.. => 1,
                    };
                    let times = if *count > 128 { 257 - usize::from(*count) } else { 1 };
                    row.extend(behind[..taken].repeat(times));
                    rest = &behind[taken..];
                }
            }
            3 => {
                row.clone_from(&self.seed);
                let (mut rest, mut at) = (data.iter(), 0);
                while let Some(command) = rest.next() {
                    let (count, mut offset) = (usize::from(command >> 5) + 1, usize::from(command & 31));
                    if offset == 31 {
                        loop {
                            let more = usize::from(*rest.next().unwrap());
                            offset += more;
                            if more < 255 {
                                break;
                            }
                        }
                    }
                    at += offset;
                    row.resize(row.len().max(at + count), 0);
                    row[at..at + count].fill_with(|| *rest.next().unwrap());
                    at += count;
                }
            }
            mode => panic!("mode {mode}"),
        }
        if row.iter().any(|byte| *byte > 0) {
            let rows = &mut self.page.rows;
            rows.resize(rows.len().max(self.y + 1), Vec::new());
            rows[self.y].clone_from(&row);
        }
        self.seed = row;
        self.y += 1;
    }

    fn command(&mut self, group: &[u8], sign: u8, number: usize, letter: u8) {
        match (group, letter.to_ascii_uppercase()) {
            (b"*t", b'R') => self.page.dpi = number,
            (b"*r", b'S') => self.page.size[0] = Some(number),
            (b"*r", b'T') => self.page.size[1] = Some(number),
            (b"*r", b'A') => self.seed.clear(),
            (b"*r", b'B') => {}
            (b"*r", b'C') => self.mode = 0,
            (b"*r", b'F') | (b"&l", b'O' | b'E' | b'L') => assert_eq!(number, 0, "upright, without margins"),
            (b"*b", b'M') => self.mode = number,
            (b"*b", b'Y') => {
                self.y += number;
                self.seed.clear();
            }
            (b"*p", b'Y') if sign == b'+' => self.y += number,
            (b"*p", b'X' | b'Y') => assert_eq!(number, 0, "from the corner"),
            (b"&u", b'D') => assert_eq!(number, self.page.dpi.max(number), "dots are the unit"),
            (b"&l", b'A') => self.page.paper = Some(number),
            // Offsets of a page, copies, sides; sizes and modes that MuPDF's and HP's drivers set.
            (b"&l", b'U' | b'Z' | b'X' | b'S' | b'H') | (b"&1" | b"&f" | b"&k", _) => {}
            _ => panic!("ESC {}{number}{}", String::from_utf8_lossy(group), char::from(letter)),
        }
    }
}

/// The pages of a file.
fn decode(file: &[u8]) -> Vec<Page> {
    let (mut printer, mut pages, mut rest) = (Printer::default(), Vec::new(), file);
    while let [byte, behind @ ..] = rest {
        rest = behind;
        if *byte == 0x0c {
            pages.push(std::mem::take(&mut printer).page);
            continue;
        }
        assert_eq!(*byte, 0x1b, "text, {} bytes before the end", rest.len());
        if let [b'E', behind @ ..] = rest {
            rest = behind;
            // A reset ends a page on which something was printed.
            let page = std::mem::take(&mut printer).page;
            if !page.rows.is_empty() {
                pages.push(page);
            }
            continue;
        }
        let (group, mut parameters) = rest.split_at(2);
        loop {
            let sign = parameters[0];
            parameters = parameters.trim_prefix_of(b"+-");
            let digits = parameters.iter().take_while(|byte| byte.is_ascii_digit()).count();
            let number = std::str::from_utf8(&parameters[..digits]).unwrap().parse().unwrap_or(0);
            let letter = parameters[digits];
            parameters = &parameters[digits + 1..];
            if (group, letter) == (b"*b", b'W') {
                let (data, behind) = parameters.split_at(number);
                printer.row(data);
                parameters = behind;
            } else {
                printer.command(group, sign, number, letter);
            }
            if letter.is_ascii_uppercase() {
                break;
            }
        }
        rest = parameters;
    }
    assert!(printer.page.rows.is_empty(), "the last page has no end");
    pages
}

trait Prefix {
    fn trim_prefix_of(&self, signs: &[u8]) -> &Self;
}

impl Prefix for [u8] {
    /// Without a first byte that is one of `signs`.
    fn trim_prefix_of(&self, signs: &[u8]) -> &[u8] {
        match self {
            [first, rest @ ..] if signs.contains(first) => rest,
            _ => self,
        }
    }
}

/// The rows of a page of that size in pixels, one after the other.
fn pixels(page: &Page, width: usize, height: usize) -> Vec<u8> {
    let bytes = width.div_ceil(8);
    assert!(page.rows.len() <= height, "{} rows", page.rows.len());
    let mut all = vec![0; bytes * height];
    for (y, row) in page.rows.iter().enumerate() {
        let (inside, outside) = row.split_at(row.len().min(bytes));
        assert!(outside.iter().all(|byte| *byte == 0), "row {y} is {} bytes long", row.len());
        all[y * bytes..][..inside.len()].copy_from_slice(inside);
    }
    all
}

/// The pixels that are painted, line and column from the first ones on where one is.
fn painted(rows: &[u8], width: usize) -> Vec<(usize, usize)> {
    let bit = |(y, row): (usize, &[u8])| {
        let columns: Vec<_> = (0..width).filter(|x| row[x / 8] << (x % 8) & 0x80 > 0).map(|x| (y, x)).collect();
        columns
    };
    let all: Vec<_> = rows.chunks(width.div_ceil(8)).enumerate().flat_map(bit).collect();
    let (top, left) = (all[0].0, all.iter().map(|pixel| pixel.1).min().unwrap());
    all.into_iter().map(|(y, x)| (y - top, x - left)).collect()
}

/// The size and the rows of a bitmap, P4, with or without a remark.
fn bitmap(file: &[u8]) -> (usize, usize, &[u8]) {
    let line = |file: &[u8]| file.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    let mut rest = &file[line(file)..];
    while rest[0] == b'#' {
        rest = &rest[line(rest)..];
    }
    let size = std::str::from_utf8(&rest[..line(rest)]).unwrap();
    let mut numbers = size.split_whitespace().map(|number| number.parse().unwrap());
    (numbers.next().unwrap(), numbers.next().unwrap(), &rest[line(rest)..])
}

/// A drawing of noise and bars in PostScript, on a page of that size in dots of 1/300 inch, with a margin of 200 dots.
fn postscript(width: u32, height: u32, rng: &mut Rng) -> String {
    let (w, h) = (width - 400, height - 400);
    let mut hex = String::new();
    for y in 0..h {
        let kind = [0, 1, 1, 1, 2, 3][(y / 16 % 6) as usize];
        for x in 0..w.div_ceil(8) {
            let byte = match kind {
                0 => 0,
                1 => [0, 255, x as u8][(x / 20 % 3) as usize],
                2 => rng.next() as u8,
                _ => (x + y / 4) as u8,
            };
            hex += &format!("{byte:02x}");
        }
    }
    let point = |dots: u32| f64::from(dots) * 0.24;
    format!(
        "%!PS\n<</PageSize [{} {}]>> setpagedevice\n{} {} translate {} {} scale\n{w} {h} true [{w} 0 0 -{h} 0 {h}]\n\
         currentfile /ASCIIHexDecode filter imagemask\n{hex}>\nshowpage\n",
        point(width),
        point(height),
        point(200),
        point(200),
        point(w),
        point(h)
    )
}

#[test]
fn files_of_others_are_decoded() {
    let mut rng = Rng(5);
    let folder = tempfile::tempdir().unwrap();
    let (width, height) = (1275, 1650);
    let source = postscript(width, height, &mut rng);
    let Some(gs) = program("gs") else { return };
    let print = |device: &str| {
        run(
            &gs,
            &["-q", "-dNOPAUSE", "-dBATCH", "-dSAFER", "-r300", &format!("-sDEVICE={device}"), "-sOutputFile=-", "-"],
            source.as_bytes(),
        )
    };
    let drawn = print("pbmraw");
    let (w, h, rows) = bitmap(&drawn);
    assert!(w.abs_diff(width as usize) <= 1 && rows.iter().any(|byte| *byte > 0));
    for device in ["ljet2p", "ljet3", "ljet4", "ljetplus"] {
        let pages = decode(&print(device));
        assert_eq!((pages.len(), pages[0].dpi), (1, 300), "{device}");
        if device == "ljet4" {
            assert!(pixels(&pages[0], w, h) == rows, "{device}");
        }
        // The others lay the page where these printers' margins end.
        let moved = pixels(&pages[0], w + 800, h + 800);
        assert!(painted(&moved, w + 800) == painted(rows, w), "{device}");
    }
    if let Some(mutool) = program("mutool") {
        let pdf = folder.path().join("page.pdf");
        std::fs::write(&pdf, print("pdfwrite")).unwrap();
        let draw = |format: &str| {
            let to = folder.path().join(format);
            let ran = std::process::Command::new(&mutool)
                .args(["draw", "-q", "-r", "300", "-F", format, "-o"])
                .args([&to, &pdf])
                .output()
                .unwrap();
            assert!(ran.status.success());
            std::fs::read(to).unwrap()
        };
        let drawn = draw("pbm");
        let (w, h, rows) = bitmap(&drawn);
        let pages = decode(&draw("pcl"));
        assert_eq!((pages.len(), pages[0].dpi), (1, 300));
        assert!(pixels(&pages[0], w, h) == rows, "MuPDF");
    }
    if let Some(pbmtolj) = program("pbmtolj") {
        // Not its mode 3: there it leaves white rows empty, which repeats the row above.
        for options in [&["-resolution", "600"][..], &["-resolution", "600", "-packbits"]] {
            let pages = decode(&run(&pbmtolj, options, &drawn));
            assert_eq!((pages.len(), pages[0].dpi), (1, 600));
            assert!(pixels(&pages[0], w, h) == rows, "netpbm, {options:?}");
        }
    }
}

/// Holds a page to a raster.
fn compare(page: &Page, raster: &Raster) {
    let (width, height) = (raster.header.width as usize, raster.rows.len());
    assert_eq!(page.size, [Some(width), Some(height)]);
    assert_eq!(page.dpi, raster.header.dpi.map_or(96, |dpi| dpi.round() as usize));
    assert!(pixels(page, width, height) == expected(raster, Pixels::Black), "{:?}", raster.header);
}

#[test]
fn the_decoder_sees_the_pixels() {
    for raster in rasters().iter().filter(|raster| raster.header.width < 65_536) {
        let pages = decode(&raster.encode("pcl"));
        assert_eq!(pages.len(), 1);
        compare(&pages[0], raster);
    }
    // As wide as it can be, with bytes that follow each other far apart.
    for inks in [inks(1), inks(3)].into_iter().chain(shaded()) {
        let mut raster = Raster::random(&mut Rng(9), 65_535, 100..400, inks);
        let mut rng = Rng(4);
        for y in 0..raster.rows.len() {
            let x = [rng.below(65_535), 248 * (y as u32 % 260), 8 * 31, 8 * (31 + 255)][y % 4] as usize;
            raster.rows[y] = vec![0; 65_535];
            raster.rows[y][x % 65_535] = 1;
            raster.rows[y][65_534] = (y % 3 == 0).into();
        }
        compare(&decode(&raster.encode("pcl"))[0], &raster);
    }
}

#[test]
fn pages_of_a_file() {
    let all: Vec<_> = rasters().into_iter().filter(|raster| raster.header.width < 65_536).take(12).collect();
    let page = |(number, raster): (u32, &Raster)| {
        let sheet = Sheet { number, of: all.len() as u32, pixels: None };
        Raster { header: Header { sheet, ..raster.header.clone() }, rows: raster.rows.clone() }.encode("pcl")
    };
    let file: Vec<u8> = (0..).zip(&all).flat_map(page).collect();
    let pages = decode(&file);
    assert_eq!(pages.len(), all.len());
    pages.iter().zip(&all).for_each(|(page, raster)| compare(page, raster));
    assert!(file.starts_with(b"\x1bE") && file.ends_with(b"\x0c\x1bE"));
    assert_eq!(file.windows(2).filter(|pair| pair == b"\x1bE").count(), 2);
}

#[test]
fn rows_by_hand() {
    let mut raster = Raster::random(&mut Rng(0), 24, 1..9, inks(1));
    raster.header.dpi = Some(600.0);
    let paint = |from: usize, to: usize| (0..24).map(|x| u32::from((from..to).contains(&x))).collect::<Vec<u32>>();
    // White twice; a row, again twice; one byte of it differs; white; bytes that differ at the end.
    raster.rows = vec![paint(0, 0), paint(0, 0), paint(0, 20), paint(0, 20), paint(0, 20), paint(4, 20), paint(0, 0), paint(23, 24)];
    let expected = [
        &b"\x1bE\x1b&l0o0e0L\x1b*p0x0Y\x1b*t600R\x1b*r0f8t24s1A"[..],
        b"\x1b*b2Y",
        // Two bytes of 255, a literal: 255 twice is 257 - 2. In mode 3, three bytes behind none are as long.
        b"\x1b*b2m4W\xff\xff\x00\xf0",
        b"\x1b*b3m0W\x1b*b0W",
        b"\x1b*b3m2W\x00\x0f",
        b"\x1b*b1Y",
        b"\x1b*b3m2W\x02\x01",
        b"\x1b*rC\x0c\x1bE",
    ]
    .concat();
    let got = raster.encode("pcl");
    assert!(got == expected, "{}", got.escape_ascii());
    // A4 has a number.
    let mut raster = Raster::random(&mut Rng(0), 1240, 0..1754, inks(1));
    raster.header.dpi = Some(150.0);
    assert_eq!(decode(&raster.encode("pcl"))[0].paper, Some(26));
}

#[test]
fn what_is_too_large_is_refused() {
    let pcl = by_name("pcl").unwrap();
    let header = |width: u32, height: u32, dpi: Option<f64>| Header {
        width,
        lines: 5..5 + height,
        inks: Inks::Listed(Vec::new()),
        dpi,
        sheet: Sheet::default(),
    };
    assert!((pcl.fits)(&header(65_535, 65_535, Some(32_767.4))).is_ok());
    for (header, about) in [
        (header(65_537, 1, None), "65535 px a side"),
        (header(1, 65_536, None), "65535 px a side"),
        (header(1, 1, Some(32_767.5)), "1 to 32767 dots an inch"),
        (header(1, 1, Some(0.4)), "1 to 32767 dots an inch"),
    ] {
        let error = (pcl.fits)(&header).unwrap_err();
        assert!(error.kind == Kind::Limit && error.what.contains(about), "{error}");
    }
}
