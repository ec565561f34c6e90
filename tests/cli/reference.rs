//! formats, completions and manual pages.

use std::process::Stdio;

use crate::support::{Folder, feed, have, ran};

#[test]
fn formats_are_a_table() {
    let ran = Folder::new().run("formats");
    let text = String::from_utf8(ran.done().to_vec()).unwrap();
    let column = text.find("media type").unwrap();
    let tiff = text.lines().find(|line| line.starts_with("tiff")).unwrap();
    assert!(tiff.contains(" tiff tif ") && tiff.contains(" g4 packbits deflate none "), "{tiff}");
    for (name, media_type) in
        [("png", "image/png"), ("pbm", "image/x-portable-bitmap"), ("ndjson", "application/x-ndjson"), ("stl", "model/stl")]
    {
        let line = text.lines().find(|line| line.starts_with(name)).unwrap();
        assert!(line[column..].starts_with(media_type), "{line}");
    }
}

#[test]
fn shells_take_the_completions() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish"] {
        let script = folder.run(&format!("completions {shell}")).done().to_vec();
        let text = String::from_utf8(script.clone()).unwrap();
        for word in ["max-input", "convert", "ndjson", "always"] {
            assert!(text.contains(word), "{shell}: {word}");
        }
        if have(shell, "the syntax of its completions") {
            let mut check = folder.command(shell);
            check.arg("-n");
            if shell == "fish" {
                check.arg("/dev/stdin");
            }
            feed(check, &script).done();
        }
    }
}

#[test]
fn bash_completes_an_option() {
    let folder = Folder::new();
    let line = "source <($R completions bash); COMP_WORDS=(runset fill --dp); COMP_CWORD=2; _runset runset --dp fill; echo ${COMPREPLY[@]}";
    let ran = ran(folder.shell(line).output().unwrap());
    assert_eq!(ran.done(), b"--dpi\n");
}

#[test]
fn manual_pages_render_without_a_warning() {
    let folder = Folder::new();
    if !have("groff", "manual pages") {
        return;
    }
    for args in ["man", "man fill", "man convert", "man print", "man printers", "man info", "man formats", "man completions", "man man"] {
        let page = folder.run(args).done().to_vec();
        let mut groff = folder.command("groff");
        groff.args(["-man", "-ww", "-Tascii", "-P-cbou"]).stdin(Stdio::piped());
        let shown = feed(groff, &page);
        let text = String::from_utf8(shown.done().to_vec()).unwrap();
        let name = args.replace("man ", "runset-");
        let name = if args == "man" { "runset" } else { &name };
        assert!(text.starts_with(&format!("{name}(1)")), "{text}");
        for section in ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS"] {
            assert!(text.lines().any(|line| line == section), "{args}: {section}");
        }
    }
}
