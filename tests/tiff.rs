//! TIFF in all its forms is read by libtiff's own tools, netpbm and Pillow.

#![allow(clippy::unwrap_used)]

mod raster;

use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process::Command;

use ::tiff::decoder::{Decoder, DecodingResult};
use raster::{Raster, Rng, inks, name, program, run, shaded};
use runset::encode::{Format, by_name, tiff, variants};
use runset::input;
use runset::job::{Job, Options, Out, Size};
use runset::run::{Header, Inks, Lines, Run, Sheet};
use runset::scene::Limits;

/// How often the random laws are tried: `RUNSET_EFFORT` times as much as by default.
fn effort() -> u64 {
    std::env::var("RUNSET_EFFORT").map_or(1, |effort| effort.parse().expect("a number"))
}

/// TIFF in every compression that can hold a raster.
fn able(header: &Header) -> impl Iterator<Item = &'static Format> + use<'_> {
    variants().filter(move |format| format.name == "tiff" && format.check(header).is_ok())
}

/// Inks of every kind of pixel: 1 bit, 8-bit grey, palettes of 4 and 8 bits, RGB.
fn kinds() -> Vec<Inks> {
    let grays = Inks::Listed(vec![[0; 3], [85; 3], [254; 3]]);
    let mut kinds =
        vec![inks(1), Inks::Listed(vec![]), grays, Inks::Listed(vec![[228, 0, 127]]), inks(3), inks(15), inks(16), inks(255), inks(256)];
    kinds.extend(shaded());
    kinds
}

/// Rasters of one pixel, of odd widths and one past 16 bits; paper, checkerboards, and rows of all kinds.
fn rasters() -> Vec<Raster> {
    let (mut rng, mut all) = (Rng(11), Vec::new());
    for inks in kinds() {
        let blank = |width: u32, height: u32| {
            let header = Header { width, lines: 5..5 + height, inks: inks.clone(), dpi: Some(600.0), sheet: Sheet::default() };
            Raster { rows: vec![vec![0; width as usize]; height as usize], header }
        };
        all.push(blank(1, 1));
        all.push(blank(2481, 350));
        let mut board = blank(333, 60);
        if inks.end() > 0 {
            for (y, row) in board.rows.iter_mut().enumerate() {
                row.iter_mut().enumerate().for_each(|(x, pixel)| *pixel = ((x + y) % 2) as u32);
            }
            all.push(Raster { rows: vec![vec![1]], ..blank(1, 1) });
        }
        all.push(board);
        for width in [1, 7, 8, 9, 31, 1001] {
            let lines = rng.below(9000);
            all.push(Raster::random(&mut rng, width, lines..lines + 1 + lines % 60, inks.clone()));
        }
        // Several strips: past 1 MiB of rows.
        all.push(Raster::random(&mut rng, 65_537, 0..if inks.end() > 1 { 40 } else { 150 }, inks.clone()));
    }
    all
}

/// The pixels, three bytes each.
fn expected(raster: &Raster) -> Vec<u8> {
    let pixels = |y: usize| (0..raster.header.width as usize).map(move |x| (x, y));
    (0..raster.rows.len()).flat_map(pixels).flat_map(|(x, y)| raster.colour(x, y)).collect()
}

/// A file in a folder that goes with it.
fn file(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn netpbm_sees_the_pixels() {
    let Some(from_tiff) = program("tifftopnm") else { return };
    let folder = tempfile::tempdir().unwrap();
    for raster in rasters() {
        let right = expected(&raster);
        for format in able(&raster.header).map(name) {
            let path = file(folder.path(), "a.tiff", &raster.encode(&format));
            let image = image::load_from_memory(&run(&from_tiff, &["-quiet", path.to_str().unwrap()], b"")).unwrap().to_rgb8();
            assert_eq!(image.dimensions(), (raster.header.width, raster.header.height()), "{format}");
            assert!(image.as_raw() == &right, "{format} of {} inks, width {}", raster.header.inks.end(), raster.header.width);
        }
    }
}

/// Finds nothing to complain of, and reads the fields as they were meant.
#[test]
fn libtiff_finds_nothing() {
    let (Some(info), Some(copy)) = (program("tiffinfo"), program("tiffcp")) else { return };
    let folder = tempfile::tempdir().unwrap();
    for raster in rasters().iter().step_by(3) {
        for format in able(&raster.header).map(name) {
            let path = file(folder.path(), "a.tiff", &raster.encode(&format));
            // Every strip is decoded.
            let told = Command::new(&info).arg("-D").arg(&path).output().unwrap();
            let text = String::from_utf8(told.stdout).unwrap();
            assert!(told.status.success() && told.stderr.is_empty(), "{format}: {}", String::from_utf8_lossy(&told.stderr));
            assert!(text.contains("Resolution: 600, 600 pixels/inch") || raster.header.dpi.is_none(), "{text}");
            if [inks(1), Inks::Listed(vec![])].contains(&raster.header.inks) {
                assert!(text.contains("Photometric Interpretation: min-is-white") && text.contains("Bits/Sample: 1"), "{text}");
                assert!(!["tiff", "tiff/g4"].contains(&&*format) || text.contains("CCITT Group 4"), "{text}");
            }
            let copied = Command::new(&copy).args(["-c", "none"]).arg(&path).arg(folder.path().join("copy.tiff")).output().unwrap();
            assert!(copied.status.success() && copied.stderr.is_empty(), "{format}: {}", String::from_utf8_lossy(&copied.stderr));
        }
    }
}

/// Reads the files that its input names, and prints size and checksum of the pixels of each.
const PILLOW: &str = "
import sys, zlib
from PIL import Image
Image.MAX_IMAGE_PIXELS = None
for line in sys.stdin:
    with Image.open(line.strip()) as image:
        pixels = image.convert('RGB').tobytes()
        print(*image.size, '%08x' % zlib.crc32(pixels), image.info.get('dpi', (0, 0))[0] == 600)
";

/// Python with Pillow: that of the test command's folder, or one on the path that has it.
fn pillow() -> Option<PathBuf> {
    let own = std::env::var_os("RUNSET_TOOLS").map(|folder| PathBuf::from(folder).join("python3"));
    let has = |python: &PathBuf| Command::new(python).args(["-c", "import PIL"]).output().is_ok_and(|output| output.status.success());
    let found = own.into_iter().chain(program("python3")).find(has);
    if found.is_none() {
        eprintln!("skipped: Pillow is not installed");
        assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "Pillow is not installed");
    }
    found
}

#[test]
fn pillow_sees_the_pixels() {
    let Some(python) = pillow() else { return };
    let folder = tempfile::tempdir().unwrap();
    let (mut names, mut right) = (String::new(), String::new());
    for (i, raster) in rasters().iter().enumerate() {
        let crc = crc32fast::hash(&expected(raster));
        let (width, height, dpi) =
            (raster.header.width, raster.header.height(), if raster.header.dpi.is_some() { "True" } else { "False" });
        for format in able(&raster.header).map(name) {
            let path = file(folder.path(), &format!("{i}-{}.tiff", format.replace('/', "-")), &raster.encode(&format));
            names += &format!("{}\n", path.display());
            right += &format!("{width} {height} {crc:08x} {dpi}\n");
        }
    }
    let said = String::from_utf8(run(&python, &["-c", PILLOW], names.as_bytes())).unwrap();
    for ((name, said), right) in names.lines().zip(said.lines()).zip(right.lines()) {
        assert_eq!(said, right, "{name}");
    }
    assert_eq!(said.lines().count(), right.lines().count());
}

fn job(document: &[u8], options: &Options) -> Job {
    let scene = input::read(document.to_vec(), &Limits::default(), &mut Vec::new()).unwrap();
    Job::prepare(scene, options, &mut Vec::new()).unwrap()
}

/// The sample poster in its inks and as its plate, whole and in slices, by some threads, into memory and into a file: what png and pbm show.
#[test]
fn the_poster() {
    let Some(from_tiff) = program("tifftopnm") else { return };
    let poster = std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/art/poster.svg")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for expr in [None, Some("art & frame - logo".to_owned())] {
        for lines in [None, Some(700..2100)] {
            let size = Size::Pixels { width: Some(3001), height: None };
            let job = job(&poster, &Options { expr: expr.clone(), size, lines, ..Options::default() });
            let mut ppm = Vec::new();
            job.render(by_name("ppm").unwrap(), 2, &mut ppm, &mut |_| ()).unwrap();
            let right = image::load_from_memory(&ppm).unwrap().to_rgb8();
            for format in able(job.header()) {
                let path = folder.path().join("poster.tiff");
                let mut file = std::fs::File::create(&path).unwrap();
                job.render_to(format, 2, Out::File(&mut file), &mut |_| ()).unwrap();
                let mut bytes = Vec::new();
                job.render(format, 1, &mut bytes, &mut |_| ()).unwrap();
                assert!(std::fs::read(&path).unwrap() == bytes, "{}", name(format));
                let image = image::load_from_memory(&run(&from_tiff, &["-quiet", path.to_str().unwrap()], b"")).unwrap().to_rgb8();
                assert!(image == right, "{}", name(format));
            }
        }
    }
}

/// The form for files past 4 GiB, at any size: libtiff and Pillow read it.
#[test]
fn big_tiff_of_small_rasters() {
    let (Some(from_tiff), Some(info)) = (program("tifftopnm"), program("tiffinfo")) else { return };
    let python = pillow();
    let folder = tempfile::tempdir().unwrap();
    for raster in rasters().into_iter().step_by(2) {
        let right = expected(&raster);
        for packing in [tiff::Packing::None, tiff::Packing::G4, tiff::Packing::PackBits, tiff::Packing::Deflate] {
            let new = || tiff::writer(&raster.header, packing, 100);
            let (mut first, mut bytes) = (new(), Vec::new());
            first.begin(&mut bytes);
            for (y, row) in raster.header.lines.clone().zip(&raster.rows) {
                first.lines(Lines { y, n: 1, runs: &raster::runs(row) }, &mut bytes);
            }
            if let (false, Some(table)) = (first.head_is_known(), first.table()) {
                let (mut second, mut head) = (new(), Vec::new());
                second.know(table);
                second.begin(&mut head);
                bytes[..head.len()].copy_from_slice(&head);
            }
            assert!(bytes.starts_with(b"II+\0"), "{packing:?}");
            let path = file(folder.path(), "big.tiff", &bytes);
            let told = Command::new(&info).arg("-D").arg(&path).output().unwrap();
            assert!(told.status.success() && told.stderr.is_empty(), "{packing:?}: {}", String::from_utf8_lossy(&told.stderr));
            let image = image::load_from_memory(&run(&from_tiff, &["-quiet", path.to_str().unwrap()], b"")).unwrap().to_rgb8();
            assert!(image.as_raw() == &right, "{packing:?} of {} inks, width {}", raster.header.inks.end(), raster.header.width);
            // A process each: a few of them.
            if let Some(python) = python.as_ref().filter(|_| raster.header.width == 1001) {
                let said = String::from_utf8(run(python, &["-c", PILLOW], format!("{}\n", path.display()).as_bytes())).unwrap();
                assert!(said.contains(&format!("{:08x}", crc32fast::hash(&right))), "{packing:?}: {said}");
            }
        }
    }
}

/// A file that is a hole wherever zeros are written.
struct Sparse(std::fs::File);

impl Write for Sparse {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if bytes.iter().all(|byte| *byte == 0) {
            self.0.seek(SeekFrom::Current(bytes.len() as i64))?;
            return Ok(bytes.len());
        }
        self.0.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.0.flush()
    }
}

impl Seek for Sparse {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.0.seek(to)
    }
}

/// A page whose file is really longer than 4 GiB, at high effort: a crate that is not ours reads the first strip and the last.
#[test]
fn past_4_gib() {
    let height = if effort() >= 10 { 70_000 } else { 300 };
    // Black on grey, 65,536 a side and more: 4.3 GiB of zeros, but for a bar at the end of the first lines and of the last ones.
    let header = Header { width: 65_536, lines: 0..height, inks: Inks::Listed(vec![[0; 3], [77; 3]]), dpi: None, sheet: Sheet::default() };
    let rows = |y: u32| {
        let end = if y < 3 || y + 3 >= height { 65_530 } else { 65_536 };
        vec![Run { start: 0, end, ink: 0 }, Run { start: end, end: 65_536, ink: 1 }]
            .into_iter()
            .filter(|run| run.start < run.end)
            .collect::<Vec<_>>()
    };
    let folder = tempfile::tempdir().unwrap();
    for format in ["tiff/none", "tiff/packbits"] {
        let path = folder.path().join("past.tiff");
        let mut file = Sparse(std::fs::File::create(&path).unwrap());
        let format = raster::format(format);
        let (mut encoder, mut out) = ((format.encoder)(&header), Vec::new());
        encoder.begin(&mut out);
        for y in header.lines.clone() {
            file.write_all(&out).unwrap();
            out.clear();
            encoder.lines(Lines { y, n: 1, runs: &rows(y) }, &mut out);
        }
        encoder.end(&mut out);
        file.write_all(&out).unwrap();
        let length = file.stream_position().unwrap();
        if !encoder.head_is_known() {
            file.rewind().unwrap();
            file.write_all(&runset::encode::head(format, &header, encoder.table().unwrap())).unwrap();
        }
        file.0.set_len(length).unwrap();
        let mut start = [0; 4];
        std::fs::File::open(&path).unwrap().read_exact(&mut start).unwrap();
        assert_eq!(&start, if length > u64::from(u32::MAX) { b"II+\0" } else { b"II*\0" }, "{length}");
        assert!(effort() < 10 || format.compression_name() != Some("none") || length > 1 << 32);
        let mut decoder = Decoder::new(std::fs::File::open(&path).unwrap()).unwrap();
        assert_eq!(decoder.dimensions().unwrap(), (65_536, height));
        for strip in [0, decoder.strip_count().unwrap() - 1] {
            let DecodingResult::U8(pixels) = decoder.read_chunk(strip).unwrap() else { panic!("bytes") };
            let line = if strip == 0 { &pixels[..65_536] } else { &pixels[pixels.len() - 65_536..] };
            assert!(line[..65_530] == [0; 65_530] && line[65_530..] == [77; 6], "{}, strip {strip}", name(format));
        }
    }
}
