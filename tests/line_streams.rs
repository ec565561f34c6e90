//! Line streams: written, read back by our reader and by a foreign one, cut, damaged and made up.

#![allow(clippy::unwrap_used)]

mod raster;

use std::io::{BufRead, BufReader, Read};

use raster::{Raster, Rng, inks, program, run, shaded};
use runset::error::{Kind, Result};
use runset::input::lines::LineReader;
use runset::run::{Header, Inks, Lines, Run, Sheet};

const STREAMS: [&str; 2] = ["ndjson", "rls"];

fn rasters(widths: &'static [u32]) -> impl Iterator<Item = Raster> {
    let mut rng = Rng(11);
    let inks = [0, 1, 2, 3, 255, 256, 300].map(inks).into_iter().chain(shaded());
    inks.flat_map(move |inks| widths.iter().map(move |&width| (inks.clone(), width))).map(move |(inks, width)| {
        let from = 4080 + rng.below(30);
        let height = 1 + rng.below(50);
        Raster::random(&mut rng, width, from..from + height, inks)
    })
}

/// Header and records of a stream.
type Stream = (Header, Vec<(u32, u32, Vec<Run>)>);

fn read(input: &mut dyn BufRead) -> Result<Stream> {
    let mut reader = LineReader::open(input)?;
    let mut records = Vec::new();
    loop {
        match reader.next_lines() {
            Ok(Some(lines)) => records.push((lines.y, lines.n, lines.runs.to_vec())),
            Ok(None) => break,
            Err(error) => {
                assert_eq!(reader.next_lines(), Err(error.clone()), "an error lasts");
                return Err(error);
            }
        }
    }
    assert_eq!(reader.next_lines(), Ok(None), "the end lasts");
    Ok((reader.header().clone(), records))
}

/// The records that are promised: maximal, but broken at multiples of 4096.
fn records(raster: &Raster) -> Vec<(u32, u32, Vec<Run>)> {
    let mut records: Vec<(u32, u32, Vec<Run>)> = Vec::new();
    for (y, row) in raster.header.lines.clone().zip(&raster.rows) {
        match records.last_mut() {
            Some((_, n, runs)) if *runs == raster::runs(row) && y % 4096 != 0 => *n += 1,
            _ => records.push((y, 1, raster::runs(row))),
        }
    }
    records
}

/// Writes what was read, record by record.
fn write(format: &str, (header, records): &Stream) -> Vec<u8> {
    let mut encoder = (runset::encode::by_name(format).unwrap().encoder)(header);
    let mut out = Vec::new();
    encoder.begin(&mut out);
    records.iter().for_each(|(y, n, runs)| encoder.lines(Lines { y: *y, n: *n, runs }, &mut out));
    encoder.end(&mut out);
    out
}

#[test]
fn our_reader_sees_the_records() {
    for raster in rasters(&[1, 2, 7, 8, 64, 129, 1000]) {
        for format in STREAMS {
            let bytes = raster.encode(format);
            let stream = read(&mut &bytes[..]).unwrap();
            assert_eq!(stream, (raster.header.clone(), records(&raster)), "{format}");
            assert_eq!(read(&mut BufReader::with_capacity(1, &bytes[..])).unwrap(), stream, "byte by byte");
            for other in STREAMS {
                assert!(write(other, &stream) == raster.encode(other), "{format} to {other}");
            }
        }
    }
}

#[test]
fn a_foreign_reader_sees_the_pixels() {
    let Some(python) = program("python3") else { return };
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/line_streams.py");
    for raster in rasters(&[1, 9, 300]) {
        let mut pixels = format!("{} {}\n", raster.header.width, raster.rows.len()).into_bytes();
        raster.rows.iter().flatten().for_each(|&pixel| pixels.extend(pixel.to_be_bytes()));
        for format in STREAMS {
            assert!(run(&python, &[script], &raster.encode(format)) == pixels, "{format} of {} inks", raster.header.inks.end());
        }
    }
}

/// An example of the specification, as ndjson or in rls: what stands between a line of three backquotes with a name and one without. Example 0 is of
/// two inks, 1 is shaded.
fn example_text(n: usize) -> String {
    fenced("json", n)
}

fn example_bytes(n: usize) -> Vec<u8> {
    let digits: String = fenced("hex", n).lines().map(|line| line.split('#').next().unwrap()).collect();
    let digits: Vec<u32> = digits.chars().filter_map(|c| c.to_digit(16)).collect();
    digits.chunks(2).map(|pair| (pair[0] * 16 + pair[1]) as u8).collect()
}

fn fenced(language: &str, n: usize) -> String {
    let doc = include_str!("../docs/rls.md");
    let rest = doc.split(&format!("```{language}\n")).nth(n + 1).unwrap();
    rest.split_once("```").unwrap().0.to_string()
}

#[test]
fn the_examples_of_the_specification_are_true() {
    let two =
        Header { width: 300, lines: 4094..4100, inks: Inks::Listed(vec![[0; 3], [0xe4, 0, 0x7f]]), dpi: None, sheet: Sheet::default() };
    let shaded = Header { width: 4, lines: 0..3, inks: Inks::Shaded { paper: [255, 255, 0xe5] }, dpi: None, sheet: Sheet::default() };
    for (n, header) in [two, shaded].into_iter().enumerate() {
        let (text, bytes) = (example_text(n), example_bytes(n));
        let stream = read(&mut &bytes[..]).unwrap();
        assert_eq!(read(&mut text.as_bytes()).unwrap(), stream);
        assert_eq!(stream.0, header);
        assert_eq!(write("rls", &stream), bytes);
        assert_eq!(String::from_utf8(write("ndjson", &stream)).unwrap(), text);
    }
}

#[test]
fn records_that_are_not_maximal_are_gathered_anew() {
    let text = example_text(0);
    let split = text.replace("{\"y\":4094,\"n\":2,\"runs\":[[10,20,0],[20,300,1]]}\n{\"y\":4096,\"n\":2,", "{\"y\":4094,\"n\":4,");
    assert_ne!(split, text);
    assert_eq!(write("ndjson", &read(&mut split.as_bytes()).unwrap()), text.as_bytes());
    let line = "{\"y\":4096,\"n\":2,\"runs\":[[10,20,0],[20,300,1]]}\n";
    let split = text.replace(line, &format!("{}{}", line.replace("\"n\":2", "\"n\":1"), line.replace("4096,\"n\":2", "4097,\"n\":1")));
    assert_ne!(split, text);
    assert_eq!(write("rls", &read(&mut split.as_bytes()).unwrap()), example_bytes(0));
}

#[test]
fn blanks_between_tokens_are_read() {
    let text = example_text(0);
    let spaced = text.replace(',', ", ").replace(':', " :\t").replace('\n', " \r\n");
    assert_eq!(read(&mut spaced.as_bytes()).unwrap(), read(&mut text.as_bytes()).unwrap());
}

#[test]
fn every_cut_is_found() {
    for raster in rasters(&[1, 40]) {
        for format in STREAMS {
            let bytes = raster.encode(format);
            for len in 0..bytes.len() {
                let error = read(&mut &bytes[..len]).unwrap_err();
                assert_eq!(error.kind, Kind::Malformed);
                let (text, place) = (error.to_string(), error.place);
                let placed = if format == "rls" { text.starts_with(&format!("byte {len}: the stream ends here")) } else { place.is_some() };
                assert!(len == 0 || placed, "{format} cut at {len}: {text}");
            }
            assert!(read(&mut &[&bytes[..], b"\n"].concat()[..]).unwrap_err().what.contains("follows the end record"));
        }
    }
}

/// CRC-32 of a stream's pixels, by a library, over rows written out pixel by pixel.
fn crc32((header, records): &Stream) -> u32 {
    let mut crc = crc32fast::Hasher::new();
    for (_, n, runs) in records {
        let mut row = vec![0u32; header.width as usize];
        runs.iter().for_each(|run| row[run.start as usize..run.end as usize].fill(run.ink + 1));
        let bytes: Vec<u8> = match header.inks.listed().len() {
            _ if header.inks.end() == 1 << 24 => row.iter().flat_map(|&pixel| header.inks.pixel(pixel)).collect(),
            0 | 1 => row.chunks(8).map(|byte| (0..8).map(|i| (*byte.get(i).unwrap_or(&0) as u8) << (7 - i)).sum()).collect(),
            2..=255 => row.iter().map(|&pixel| pixel as u8).collect(),
            _ => row.iter().flat_map(|&pixel| (pixel as u16).to_be_bytes()).collect(),
        };
        (0..*n).for_each(|_| crc.update(&bytes));
    }
    crc.finalize()
}

#[test]
fn damage_is_found_or_does_no_harm() {
    let mut rng = Rng(13);
    for raster in rasters(&[3, 40]).filter(|raster| raster.header.inks.listed().len() < 4) {
        for format in STREAMS {
            let bytes = raster.encode(format);
            let mut accepted = 0;
            for at in 0..bytes.len() {
                for byte in [bytes[at] ^ 1, bytes[at] ^ 0x80, bytes[at].wrapping_add(1), b'0', b' ', 0, rng.next() as u8] {
                    let mut damaged = bytes.clone();
                    damaged[at] = byte;
                    let Ok(stream) = read(&mut &damaged[..]) else { continue };
                    accepted += usize::from(byte != bytes[at]);
                    let written = match format {
                        "rls" => u32::from_be_bytes(*damaged.last_chunk().unwrap()),
                        _ => {
                            let text = String::from_utf8(damaged).unwrap();
                            u32::from_str_radix(text.rsplit('"').nth(1).unwrap(), 16).unwrap()
                        }
                    };
                    assert_eq!(crc32(&stream), written);
                }
            }
            // Only what the checksum does not cover: colours, the width within the last byte, where the page begins.
            assert!(accepted < 7 * (6 * raster.header.inks.listed().len() + 20), "{accepted} of {} bytes", bytes.len());
        }
    }
}

/// Refused ndjson streams: what to replace in the example of the specification, by what, and the message.
const REFUSED: &[(&str, &str, &str)] = &[
    ("{\"runset\":1", "{\"width\":1", "1:2: not a line stream"),
    ("\"runset\":1", "\"runset\":2", "1:11: version 2"),
    ("\"width\":300", "\"width\":0", "1:21: the width is 0"),
    ("\"width\":300", "\"width\":1048577", "1:21: the width is 1048577; 1 to 1048576"),
    ("\"width\":300", "\"width\":-3", "1:21: expected a whole number"),
    ("\"width\":300", "\"width\":0300", "1:21: a number with a leading zero"),
    ("\"width\":300", "\"width\":3e2", "1:22: expected `,\"height\":`"),
    ("\"width\":300", "\"width\":99999999999999999999", "1:21: a number past 64 bits"),
    ("\"width\":300,\"height\":6", "\"height\":6,\"width\":300", "1:13: expected `,\"width\":`"),
    ("\"width\":300,", "", "1:13: expected `,\"width\":`"),
    ("\"height\":6", "\"height\":7", "1:34: the height is 7"),
    ("\"to\":4100", "\"to\":4094", "1:43: the lines are 4094 to 4094"),
    ("\"to\":4100", "\"to\":8388609", "1:43: the lines are 4094 to 8388609"),
    ("#e4007f", "#E4007F", "1:76: expected a colour"),
    ("#e4007f", "#e4007", "1:76: expected a colour"),
    ("#e4007f", "#000000", "1:58: the ink #000000 is there twice"),
    ("#e4007f\"]", "#e4007f\",]", "1:86: expected `\"`"),
    ("#e4007f\"]", "#e4007f\"],\"dpi\":600", "1:86: expected `}`"),
    ("#e4007f\"]}", "#e4007f\"]}}", "1:87: something follows the record"),
    ("{\"y\":4094", "\n{\"y\":4094", "2:1: expected `{`"),
    ("{\"y\":4094", "{\"runset\":4094", "2:2: the first key of a record"),
    ("\"y\":4094", "\"y\":4095", "2:6: line 4095 where line 4094 was to come"),
    ("\"y\":4096", "\"y\":4094", "3:6: line 4094 where line 4096 was to come"),
    ("\"y\":4094,\"n\":2", "\"y\":4094,\"n\":0", "2:15: a record of no lines"),
    ("\"y\":4099,\"n\":1", "\"y\":4099,\"n\":2", "5:15: the record of 2 lines from line 4099 passes the end at line 4100"),
    ("\"y\":4094,\"n\":2", "\"y\":4094,\"m\":2", "2:11: expected `,\"n\":`"),
    ("[[10,20,0],", "[[10,10,0],", "2:26: the run from 10 to 10 is empty"),
    ("[20,300,1]", "[20,301,1]", "2:36: the run from 20 to 301 leaves the width of 300"),
    ("[20,300,1]", "[19,300,1]", "2:36: the run from 19 overlaps"),
    ("[20,300,1]", "[20,300,0]", "2:36: the run from 20 touches"),
    ("[20,300,1]", "[20,300,2]", "2:36: ink 2 of 2"),
    ("[20,300,1]", "[20,300]", "2:42: expected `,`"),
    ("[20,300,1]", "[20,300,1,1]", "2:44: expected `]`"),
    ("{\"y\":4099,\"n\":1,\"runs\":[[0,300,0]]}\n", "", "5:2: the end record comes before line 4099; lines are missing"),
    ("\"end\":true", "\"end\":false", "6:8: expected `true`"),
    ("\"lines\":6", "\"lines\":7", "6:2: the end record counts 7 lines where there were 6"),
    ("\"runs\":9", "\"runs\":8", "6:2: the end record counts 8 runs where there were 9"),
    ("ca0872a5", "ca0872a6", "6:2: the checksum is ca0872a5 and should be ca0872a6"),
    ("ca0872a5", "CA0872A5", "6:40: expected eight hexadecimal digits"),
    ("[0,300,0]", "[0,299,0]", "6:2: the checksum is"),
];

/// The same in the shaded example.
const REFUSED_SHADED: &[(&str, &str, &str)] = &[
    ("\"rgb\"", "\"cmyk\"", "1:57: inks are a list of colours, or \"rgb\""),
    ("\"rgb\"", "rgb", "1:57: expected `[`"),
    ("\"rgb\",\"paper\":\"#ffffe5\"", "\"rgb\"", "1:62: expected `,\"paper\":`"),
    ("#ffffe5", "white", "1:71: expected a colour"),
    ("#ffffe5", "#FFFFE5", "1:71: expected a colour"),
    ("#102030", "#1020300", "2:27: expected a colour"),
    ("\"#102030\"", "0", "2:27: expected `\"`"),
    (",\"#102030\"", "", "2:26: expected `,`"),
    ("[3,4", "[2,4", "2:39: the run from 2 overlaps"),
    ("\"#102030\"],[3,4,\"#ffffe5\"", "\"#ffffe5\"],[3,4,\"#ffffe5\"", "2:39: the run from 3 touches"),
    ("#102030", "#102031", "4:2: the checksum is"),
    ("\"paper\":\"#ffffe5\"", "\"paper\":\"#ffffe4\"", "4:2: the checksum is"),
];

#[test]
fn ndjson_is_refused_with_its_place() {
    let of =
        |n, refused: &'static [(&str, &str, &str)]| refused.iter().map(move |(old, new, message)| (example_text(n), old, new, message));
    for (text, old, new, message) in of(0, REFUSED).chain(of(1, REFUSED_SHADED)) {
        let text = text.replacen(old, new, 1);
        let error = read(&mut text.as_bytes()).expect_err(new);
        assert!(error.to_string().starts_with(message), "{old} -> {new}: {error}");
    }
}

#[test]
fn rls_is_refused_with_its_place() {
    // At which byte of the example, how many to replace, by what, and the message.
    let refused: &[(usize, usize, &[u8], &str)] = &[
        (5, 1, b"", "byte 0: not an rls stream, or one that was treated as text"),
        (8, 1, &[2], "byte 8: version 2"),
        (9, 1, &[2], "byte 9: a stream of kind 2; this program reads kind 0"),
        (10, 2, &[0], "byte 10: the width is 0"),
        (10, 2, &[0x81, 0x80, 0x40], "byte 10: the width is 1048577"),
        (10, 2, &[0xac, 0x82, 0], "byte 10: a number with a needless last byte"),
        (10, 2, &[0xff; 11], "byte 10: a number past 64 bits"),
        (14, 2, &[0x80, 0x10], "byte 12: the lines are 4094 to 2048"),
        (16, 1, &[0x80, 0x80, 0x04], "byte 16: 65536 inks"),
        (20, 3, &[0, 0, 0], "byte 16: the ink #000000 is there twice"),
        (23, 1, &[0x80, 0x80, 0x80, 0x04], "byte 23: the record of 8388608 lines from line 4094 passes the end at line 4100"),
        (24, 1, &[0xad, 0x02], "byte 24: 301 runs on a line of 300"),
        (26, 1, &[0], "byte 25: the run from 10 to 10 is empty"),
        (25, 1, &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01], "byte 25: the run from 18446744073709551615"),
        (29, 2, &[0x99, 0x02], "byte 28: the run from 20 to 301 leaves"),
        (31, 1, &[0], "byte 28: the run from 20 touches"),
        (31, 1, &[2], "byte 28: ink 2 of 2"),
        (43, 6, &[], "byte 43: the end record comes before line 4099"),
        (50, 1, &[5], "byte 49: the end record counts 5 lines"),
        (51, 1, &[7], "byte 49: the end record counts 7 runs"),
        (55, 1, &[0], "byte 49: the checksum is ca0872a5 and should be ca087200"),
        (56, 0, &[0], "byte 56: something follows the end record"),
    ];
    assert_eq!(example_bytes(0).len(), 56);
    for (at, len, new, message) in refused {
        let mut bytes = example_bytes(0);
        bytes.splice(at..&(at + len), new.iter().copied());
        let error = read(&mut &bytes[..]).expect_err(message);
        assert!(error.to_string().starts_with(message), "{error} where {message} was expected");
    }
}

#[test]
fn what_is_no_line_stream_is_refused() {
    for (bytes, message) in [
        (&b""[..], "the input is empty"),
        (b"<svg/>", "not a line stream"),
        (b"P4\n1 1\n\0", "not a line stream"),
        (b"{\"width\":4}\n", "1:2: not a line stream"),
        (b"\x89PNG\r\n\x1a\n", "byte 0: not an rls stream"),
    ] {
        let error = read(&mut &bytes[..]).unwrap_err();
        assert!(error.to_string().starts_with(message), "{error}");
    }
}

#[test]
fn a_line_without_end_is_given_up() {
    let endless = |head: String| BufReader::new(std::io::Cursor::new(head.into_bytes()).chain(std::io::repeat(b' ')));
    let header = read(&mut endless("{".into())).unwrap_err();
    assert!(header.to_string().contains("a line of more than 1049584 bytes"), "{header}");
    let first = example_text(0).split_inclusive('\n').next().unwrap().to_string();
    let record = read(&mut endless(first + "{")).unwrap_err();
    assert!(record.to_string().starts_with("2:10625: a line of more than 10624 bytes"), "{record}");
}

#[test]
fn the_longest_record_is_read() {
    let width = 1 << 20;
    let run = |x: u32, end: u32| Run { start: x, end: x + 1, ink: end - 2 + x % 2 };
    let inks = (0..65_535u32).map(|i| [(i >> 16) as u8, (i >> 8) as u8, i as u8]).collect();
    for inks in [Inks::Listed(inks), Inks::Shaded { paper: [1, 2, 3] }] {
        let header = Header { width, lines: 8_388_607..8_388_608, inks, dpi: None, sheet: Sheet::default() };
        let runs = (0..width).map(|x| run(x, header.inks.end())).collect();
        let stream = (header, vec![(8_388_607, 1, runs)]);
        for format in STREAMS {
            assert!(read(&mut &write(format, &stream)[..]).unwrap() == stream, "{format}");
        }
    }
}

#[test]
fn a_failing_input_is_not_an_end() {
    struct Failing;
    impl Read for Failing {
        fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
            Err(std::io::Error::other("the disk is on fire"))
        }
    }
    for format in STREAMS {
        let bytes = Raster::random(&mut Rng(2), 50, 0..9, inks(1)).encode(format);
        for len in [0, 10, bytes.len() - 1, bytes.len()] {
            let error = read(&mut BufReader::new((&bytes[..len]).chain(Failing))).unwrap_err();
            assert_eq!((error.kind, &error.what[..]), (Kind::Io, "the disk is on fire"), "{format} {len}");
        }
    }
}
