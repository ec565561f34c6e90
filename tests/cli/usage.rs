//! Wrong usage is one line and status 2; help is an answer and status 0.

use crate::support::{Folder, have, ran};

#[test]
fn wrong_usage_is_one_line() {
    let folder = Folder::new();
    for (args, line) in [
        ("fil scene.json", "unrecognized subcommand 'fil'; a similar subcommand exists: 'fill' (see runset --help)"),
        ("--frob", "unexpected argument '--frob' found (see runset --help)"),
        ("fill", "the following required arguments were not provided: <INPUT>... (see runset fill --help)"),
        ("convert scene.json more.json", "unexpected argument 'more.json' found (see runset convert --help)"),
        (
            "fill scene.json --lins 0..1",
            "unexpected argument '--lins' found; a similar argument exists: '--lines' (see runset fill --help)",
        ),
        ("fill scene.json --dpi 96 --scale 2", "the argument '--dpi <D>' cannot be used with '--scale <S>' (see runset fill --help)"),
        ("fill scene.json --height 9 --dpi 96", "the argument '--height <H>' cannot be used with '--dpi <D>' (see runset fill --help)"),
        ("fill scene.json --scale 2 --width 9", "the argument '--scale <S>' cannot be used with '--width <W>' (see runset fill --help)"),
        (
            "fill scene.json --scale -1",
            "invalid value '-1' for '--scale <S>': give a number above 0, such as 2 or 0.5 (see runset fill --help)",
        ),
        (
            "fill scene.json --width 0",
            "invalid value '0' for '--width <W>': give a whole number from 1 to 1048576 (see runset fill --help)",
        ),
        (
            "fill scene.json --threads 0",
            "invalid value '0' for '--threads <N>': give a whole number from 1 to 1024 (see runset fill --help)",
        ),
        (
            "fill scene.json --tolerance 17",
            "invalid value '17' for '--tolerance <PX>': give a number of pixels from 0.001 to 16 (see runset fill --help)",
        ),
        (
            "fill scene.json --max-input 12T",
            "invalid value '12T' for '--max-input <BYTES>': give a number of bytes such as 1000000, 512k, 128M or 2G (see runset fill --help)",
        ),
        (
            "fill scene.json --progress yes",
            "invalid value 'yes' for '--progress <WHEN>' [possible values: auto, always, never] (see runset fill --help)",
        ),
        ("fill scene.json --lines 3..11", "lines 3..11 are not on the page: it has 10 lines, 0..10 (see runset fill --help)"),
        (
            "fill scene.json --scale 1e6",
            "the page would be 16000000 x 10000000 px: at most 1048576 x 8388608, so ask for a smaller size (see runset fill --help)",
        ),
        (
            "man frob",
            "no subcommand 'frob'; the subcommands are fill, convert, solid, print, printers, serve, info, formats, completions, man (see runset man --help)",
        ),
    ] {
        folder.run(args).refused(2, &format!("runset: {line}"));
    }
    assert_eq!(folder.names(), ["scene.json"]);
}

#[test]
fn an_unknown_format_or_extension_is_answered_with_all_of_them() {
    let folder = Folder::new();
    for args in ["fill scene.json --format frob", "fill scene.json -o a.frob", "convert scene.json -o a.frob"] {
        let ran = folder.run(args);
        assert_eq!((ran.status, ran.stderr.lines().count()), (Some(2), 1), "{}", ran.stderr);
        for format in ["pbm", "pgm", "ppm", "png", "pwg", "urf", "pcl", "pclm", "ndjson", "rls"] {
            assert!(ran.stderr.contains(format), "{format}: {}", ran.stderr);
        }
    }
    assert_eq!(folder.names(), ["scene.json"]);
}

#[test]
fn without_arguments_the_help_goes_to_standard_error() {
    let ran = Folder::new().run("");
    assert_eq!((ran.status, ran.stdout.as_slice()), (Some(2), &b""[..]));
    assert!(ran.stderr.contains("Usage: runset <COMMAND>"), "{}", ran.stderr);
}

#[test]
fn help_and_version_are_answers() {
    let folder = Folder::new();
    for args in ["--help", "-h", "help", "fill --help", "help fill", "convert -h", "info --help", "formats --help", "man --help"] {
        let ran = folder.run(args);
        let text = String::from_utf8(ran.done().to_vec()).unwrap();
        assert!(text.contains("Usage: runset"), "{args}: {text}");
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{args}: {text}");
    }
    assert_eq!(folder.run("--version").done(), format!("runset {}\n", env!("CARGO_PKG_VERSION")).as_bytes());
}

#[test]
fn every_promised_option_is_in_the_help() {
    let ran = Folder::new().run("fill --help");
    let text = String::from_utf8(ran.done().to_vec()).unwrap();
    for option in [
        "--expr <E>",
        "-o, --output <OUT>",
        "--dpi <D>",
        "--scale <S>",
        "--width <W>",
        "--height <H>",
        "--format <FORMAT>",
        "--lines <Y0..Y1>",
        "--threads <N>",
        "--tolerance <PX>",
        "--font <FILE>",
        "--system-fonts",
        "--stats",
        "--progress <WHEN>",
        "--strict",
        "--max-input <BYTES>",
    ] {
        assert!(text.contains(option), "{option}");
    }
}

#[test]
fn a_terminal_is_not_shown_a_binary_format() {
    let folder = Folder::new();
    if !have("script", "a binary format to a terminal") {
        return;
    }
    let mut command = folder.command("script");
    command.args(["-qec", &format!("{} fill scene.json --format png", crate::support::RUNSET), "/dev/null"]);
    let ran = ran(command.output().unwrap());
    let said = String::from_utf8(ran.stdout).unwrap();
    let line = "runset: png is a binary format and <stdout> is a terminal; name a file with -o (see runset fill --help)";
    assert_eq!((said.trim_end(), ran.status), (line, Some(2)));
}
