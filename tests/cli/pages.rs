//! Files of several pages, and the resolution that is written into an output.

use super::support::{Folder, PBM, SCENE};

/// The page's pixels as PWG raster has them at a bit a pixel: lines 0, 1 to 8, and 9.
const ROWS: &[u8] = b"\0\x01\0\x07\xff\x78\0\0\x01\0";

fn number(bytes: &[u8], at: usize) -> u32 {
    u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap())
}

#[test]
fn several_inputs_are_the_pages_of_a_file() {
    let folder = Folder::new();
    folder.put("second.json", SCENE.replace("\"height\": 10", "\"height\": 9"));
    folder.run("fill scene.json second.json scene.json --dpi 96 -o pages.pwg").done();
    let file = folder.get("pages.pwg");
    assert!(file.starts_with(b"RaS2PwgRaster\0"));
    let page = 1796 + ROWS.len();
    for (number_of_page, height) in [(0, 10), (1, 9), (2, 10)] {
        // The second page has no white line at its end.
        let at = 4 + number_of_page * page - if number_of_page == 2 { 3 } else { 0 };
        assert_eq!((number(&file, at + 372), number(&file, at + 376), number(&file, at + 452)), (16, height, 3));
        assert_eq!((number(&file, at + 276), number(&file, at + 352)), (96, 12));
        let rows = if height == 10 { ROWS } else { &ROWS[..ROWS.len() - 3] };
        assert_eq!(&file[at + 1796..][..rows.len()], rows);
    }
    assert_eq!(file.len(), 4 + 3 * page - 3);
    let piped = folder.shell("$R fill scene.json - scene.json --dpi 96 --format pwg < second.json | cmp - pages.pwg");
    crate::support::ran({ piped }.output().unwrap()).done();
    let stats = folder.run("fill scene.json second.json -o pages.urf --stats");
    assert_eq!((stats.status, stats.stderr.lines().count()), (Some(0), 2), "{}", stats.stderr);
    assert!(folder.get("pages.urf").starts_with(b"UNIRAST\0\0\0\0\x02"));
}

#[test]
fn what_cannot_be_pages_is_refused() {
    let folder = Folder::new();
    folder.put("wrong.json", "{");
    let line =
        "runset: a file of png is one page, and 2 are asked for: ask for one, or for a format of pwg, urf, pcl (see runset fill --help)";
    folder.run("fill scene.json scene.json -o out.png").refused(2, line);
    let line = "runset: standard input is named twice, and can be read once (see runset fill --help)";
    folder.run("fill - - -o out.pwg").refused(2, line);
    // What is wrong with a page names it, and leaves nothing behind.
    let ran = folder.run("fill scene.json wrong.json -o out.pwg");
    assert!(ran.status == Some(1) && ran.stderr.starts_with("wrong.json:1:2: "), "{}", ran.stderr);
    let ran = folder.run("fill scene.json out.pwg -o out.pwg");
    assert!(ran.status == Some(1) && ran.stderr.starts_with("out.pwg: "), "{}", ran.stderr);
    folder.put("out.pwg", SCENE);
    folder.run("fill scene.json out.pwg -o out.pwg").refused(1, "out.pwg: this is the input too; name another output");
    assert_eq!(folder.get("out.pwg"), SCENE.as_bytes());
}

#[test]
fn a_resolution_is_written_into_the_output() {
    let folder = Folder::new();
    folder.run("fill scene.json -o out.rls").done();
    folder.run("convert out.rls --dpi 299.6 -o out.pwg").done();
    assert_eq!(number(&folder.get("out.pwg"), 4 + 276), 300);
    folder.run("convert out.rls -o plain.pwg").done();
    assert_eq!(number(&folder.get("plain.pwg"), 4 + 276), 96);
    folder.run("convert out.rls -o out.pbm --dpi 7").done();
    assert_eq!(folder.get("out.pbm"), PBM);
    folder.put("m.csg", "cube(2);");
    folder.run("solid m.csg --imgsize 40,30 --dpi 150 -o m.urf").done();
    assert_eq!(number(&folder.get("m.urf"), 12 + 20), 150);
    let line =
        "runset: pwg takes 1 to 2147483647 dots an inch, and 0.4 were asked for: ask for another resolution (see runset convert --help)";
    folder.run("convert out.rls --dpi 0.4 -o no.pwg").refused(2, line);
    let ran = folder.run("fill scene.json --dpi 0.4 -o no.pwg");
    assert!(ran.status == Some(2) && ran.stderr.contains("0.4 were asked for"), "{}", ran.stderr);
    assert!(!folder.path("no.pwg").exists());
}
