//! Under the output's name there is a complete file, or what was there before.

use std::fs::{self, File};
use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
use std::process::{Command, Stdio};

use crate::support::{Folder, LONG, PBM, RUNSET, SCENE, feed, have, ran, skip};

#[test]
fn a_file_is_complete_and_alone() {
    let folder = Folder::new();
    folder.run("fill scene.json -o out.pbm").done();
    assert_eq!(folder.get("out.pbm"), PBM);
    assert_eq!(folder.names(), ["out.pbm", "scene.json"]);
}

#[test]
fn standard_output_has_many_names() {
    let folder = Folder::new();
    for out in ["", "-o -", "-o /dev/stdout", "-o /dev/fd/1", "-o /proc/self/fd/1"] {
        assert_eq!(folder.run(&format!("fill scene.json --format pbm {out}")).done(), PBM, "{out}");
    }
    // Also where it is a file: the raster goes where the shell's redirection stands, before and behind what is there.
    let line = "{ echo before; $R fill scene.json --format pbm -o /dev/stdout; echo behind; } > out";
    ran(folder.shell(line).output().unwrap()).done();
    assert_eq!(folder.get("out"), [b"before\n", PBM, b"behind\n"].concat());
    assert_eq!(folder.names(), ["out", "scene.json"]);
}

#[test]
fn the_mode_is_that_of_the_old_file_or_of_any_new_one() {
    let folder = Folder::new();
    let mode = |name: &str| fs::metadata(folder.path(name)).unwrap().mode() & 0o7777;
    ran(folder.shell("umask 027; $R fill scene.json -o new.pbm").output().unwrap()).done();
    assert_eq!(mode("new.pbm"), 0o640);
    ran(folder.shell("touch old.pbm; chmod 666 old.pbm; umask 077; $R fill scene.json -o old.pbm").output().unwrap()).done();
    assert_eq!((mode("old.pbm"), folder.get("old.pbm").as_slice()), (0o666, PBM));
}

#[test]
fn links_are_followed_and_stay() {
    let folder = Folder::new();
    fs::create_dir(folder.path("there")).unwrap();
    folder.put("there/old.pbm", "old");
    symlink("there/old.pbm", folder.path("link.pbm")).unwrap();
    symlink("link.pbm", folder.path("link2.pbm")).unwrap();
    symlink("there/new.pbm", folder.path("dangling.pbm")).unwrap();
    for (link, target) in [("link2.pbm", "there/old.pbm"), ("dangling.pbm", "there/new.pbm")] {
        folder.run(&format!("fill scene.json -o {link}")).done();
        assert!(folder.path(link).is_symlink());
        assert_eq!(folder.get(target), PBM, "{link}");
    }
    assert_eq!(fs::read_dir(folder.path("there")).unwrap().count(), 2);

    symlink("circle.pbm", folder.path("circle.pbm")).unwrap();
    folder.run("fill scene.json -o circle.pbm").refused(1, "circle.pbm: too many symbolic links, or a circle of them");
}

#[test]
fn fifos_and_devices_are_written_directly() {
    let folder = Folder::new();
    assert!(Command::new("mkfifo").arg(folder.path("fifo.pbm")).status().unwrap().success());
    let reader = folder.command("cat").arg("fifo.pbm").spawn().unwrap();
    folder.run("fill scene.json -o fifo.pbm").done();
    assert_eq!(reader.wait_with_output().unwrap().stdout, PBM);
    folder.run("fill scene.json --format pbm -o /dev/null").done();
    assert_eq!(folder.names(), ["fifo.pbm", "scene.json"]);

    ran(folder.shell("$R fill <(cat scene.json) --format pbm -o >(cat > copy); wait $!").output().unwrap()).done();
    assert_eq!(folder.get("copy"), PBM);

    // And read: the scene through the FIFO.
    let runset = folder.runset("fill fifo.pbm --format pbm").spawn().unwrap();
    fs::write(folder.path("fifo.pbm"), SCENE).unwrap();
    assert_eq!(ran(runset.wait_with_output().unwrap()).done(), PBM);
}

#[test]
fn a_reader_that_has_had_enough_ends_the_run_quietly() {
    let folder = Folder::new();
    folder.put("long.json", LONG);
    for command in [
        "fill long.json",
        "fill long.json --format pbm --threads 2 --stats",
        "fill long.json -o /dev/stdout --format png",
        "fill long.json --lines 0..9999 --format tiff",
    ] {
        let line = format!("$R {command} | head -c 10 | wc -c; echo ${{PIPESTATUS[0]}}");
        assert_eq!(ran(folder.shell(&line).output().unwrap()).done(), b"10\n0\n", "{command}");
    }
    for command in ["--help", "formats", "man fill", "completions bash", "info scene.json", "info scene.json --json"] {
        let line = format!("trap '' PIPE; $R {command} | true; echo ${{PIPESTATUS[0]}}");
        assert_eq!(ran(folder.shell(&line).output().unwrap()).done(), b"0\n", "{command}");
    }
}

/// What a pipe gets is what stands in a file, and nothing is left behind of what it went through.
#[test]
fn tiff_goes_into_pipes_through_a_temporary_file() {
    let folder = Folder::new();
    fs::create_dir(folder.path("tmp")).unwrap();
    for options in
        ["", "--compression g4", "--compression packbits", "--compression deflate", "--compression none", "--threads 1 --lines 2..9"]
    {
        folder.run(&format!("fill scene.json --scale 9 -o out.tiff {options}")).done();
        let line = format!("TMPDIR=$PWD/tmp $R fill scene.json --scale 9 --format tiff {options} | cat > copy");
        ran(folder.shell(&line).output().unwrap()).done();
        assert!(folder.get("copy") == folder.get("out.tiff") && folder.get("copy").starts_with(b"II*\0"), "{options}");
    }
    ran(folder.shell("$R fill scene.json --scale 9 | $R convert - -o converted.tif").output().unwrap()).done();
    folder.run("fill scene.json --scale 9 -o out.tiff").done();
    assert!(folder.get("converted.tif") == folder.get("out.tiff"));
    assert_eq!(fs::read_dir(folder.path("tmp")).unwrap().count(), 0);

    let line = "TMPDIR=$PWD/missing $R fill scene.json --format tiff > /dev/null";
    let ran = ran(folder.shell(line).output().unwrap());
    assert!(ran.stderr.starts_with("<stdout>: the temporary file in ") && ran.stderr.lines().count() == 1, "{}", ran.stderr);
    assert_eq!(ran.status, Some(1));
}

#[test]
fn a_full_disk_costs_one_line_and_nothing_else() {
    let folder = Folder::new();
    folder.put("long.json", LONG);
    folder.run("fill scene.json --format pbm -o /dev/full").refused(1, "/dev/full: No space left on device");
    for command in ["formats", "info scene.json", "man"] {
        let mut command = folder.runset(command);
        let output = command.stdout(File::options().write(true).open("/dev/full").unwrap()).output().unwrap();
        ran(output).refused(1, "<stdout>: No space left on device");
    }

    let disk = folder.path("disk");
    fs::create_dir(&disk).unwrap();
    let mount = Command::new("mount").args(["-t", "tmpfs", "-o", "size=256k", "tmpfs"]).arg(&disk).stderr(Stdio::null()).status();
    if !mount.is_ok_and(|status| status.success()) {
        skip("a full disk: a small file system cannot be mounted");
        return;
    }
    fs::write(disk.join("out.pbm"), "old").unwrap();
    let ran = folder.run("fill long.json -o disk/out.pbm");
    let spooled = folder
        .shell("TMPDIR=$PWD/disk $R fill long.json --format tiff --compression packbits | wc -c; echo ${PIPESTATUS[0]}")
        .output()
        .unwrap();
    let left: Vec<_> = fs::read_dir(&disk).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    let old = fs::read(disk.join("out.pbm"));
    assert!(Command::new("umount").arg(&disk).status().unwrap().success());
    ran.refused(1, "disk/out.pbm: No space left on device");
    assert_eq!(left, ["out.pbm"]);
    assert_eq!(old.unwrap(), b"old");
    let said = String::from_utf8(spooled.stderr).unwrap();
    assert!(said.starts_with("<stdout>: the temporary file in ") && said.ends_with("No space left on device\n"), "{said}");
    assert_eq!(spooled.stdout, b"0\n1\n", "nothing was written");
}

#[test]
fn a_file_past_the_size_limit_is_a_write_that_fails() {
    let folder = Folder::new();
    folder.put("out.pbm", "old");
    let ran = ran(folder.shell("ulimit -f 1; $R fill scene.json --scale 500 -o out.pbm").output().unwrap());
    ran.refused(1, "out.pbm: File too large");
    assert_eq!(folder.get("out.pbm"), b"old");
    assert_eq!(folder.names(), ["out.pbm", "scene.json"]);
}

#[test]
fn what_may_not_be_written_is_said_in_one_line() {
    let folder = Folder::new();
    folder.put("theirs.pbm", "old");
    let program = folder.path("runset");
    fs::copy(RUNSET, &program).unwrap();
    let nobody = |out: &str| {
        let mut command = folder.command("setpriv");
        command.args(["--reuid=65534", "--regid=65534", "--clear-groups"]).arg(&program).args(["fill", "scene.json", "-o", out]);
        ran(command.output().unwrap())
    };
    let allow = |mode: u32| fs::set_permissions(folder.path("."), fs::Permissions::from_mode(mode)).unwrap();
    allow(0o755);
    if !have("setpriv", "a folder of somebody else") || nobody("-").status != Some(0) {
        skip("a folder of somebody else: only root can become nobody");
        return;
    }
    nobody("new.pbm").refused(1, "new.pbm: cannot write in the folder .: Permission denied");
    allow(0o777);
    nobody("theirs.pbm").refused(1, "theirs.pbm: cannot write: Permission denied");
    assert_eq!(folder.get("theirs.pbm"), b"old");
    nobody("new.pbm").done();
}

#[test]
fn what_cannot_be_written_is_said_before_anything_is_read() {
    let folder = Folder::new();
    // The input is a pipe that nobody closes: whoever reads it first waits for ever.
    let refused = |args: &str, line: &str| {
        let mut child = folder.runset(args).stdin(Stdio::piped()).spawn().unwrap();
        let held = child.stdin.take();
        ran(child.wait_with_output().unwrap()).refused(1, line);
        drop(held);
    };
    refused("fill - -o missing/out.pbm", "missing/out.pbm: the folder missing does not exist; make it first");
    refused("convert - -o missing/out.pbm", "missing/out.pbm: the folder missing does not exist; make it first");
    refused("fill - --format pbm -o .", ".: this is a folder; name a file");
    refused("fill - --format pbm -o out/", "out/: this is a folder; name a file");
    refused("fill - -o scene.json/out.pbm", "scene.json/out.pbm: cannot write: Not a directory");
    let long = "n".repeat(300);
    refused(&format!("fill - --format pbm -o {long}"), &format!("{long}: cannot write: File name too long"));
    let ran = folder.run("fill scene.json -o /proc/out.pbm");
    assert_eq!((ran.status, ran.stderr.lines().count()), (Some(1), 1), "{}", ran.stderr);
}

#[test]
fn an_output_that_is_the_input_is_refused() {
    let folder = Folder::new();
    symlink("scene.json", folder.path("link.json")).unwrap();
    fs::hard_link(folder.path("scene.json"), folder.path("hard.json")).unwrap();
    for args in [
        "fill scene.json --format pbm -o scene.json",
        "fill scene.json --format pbm -o ./scene.json",
        "fill scene.json --format pbm -o link.json",
        "fill link.json --format pbm -o scene.json",
        "fill scene.json --format pbm -o hard.json",
        "convert scene.json --format pbm -o link.json",
    ] {
        let out = args.rsplit(' ').next().unwrap();
        folder.run(args).refused(1, &format!("{out}: this is the input too; name another output"));
    }
    for (line, out) in [
        ("$R fill - --format pbm -o scene.json < scene.json", "scene.json"),
        ("$R fill - --format pbm < scene.json >> scene.json", "<stdout>"),
        ("$R fill scene.json --format pbm >> link.json", "<stdout>"),
        ("$R fill scene.json --format pbm -o /dev/stdout >> hard.json", "<stdout>"),
    ] {
        let ran = ran(folder.shell(line).output().unwrap());
        ran.refused(1, &format!("{out}: this is the input too; name another output"));
    }
    assert_eq!(folder.get("scene.json"), SCENE.as_bytes());
    assert_eq!(folder.names(), ["hard.json", "link.json", "scene.json"]);
}

#[test]
fn a_refused_input_leaves_the_old_file() {
    let folder = Folder::new();
    folder.put("out.pbm", "old");
    let ran = feed(folder.runset("fill - -o out.pbm"), b"{");
    assert_eq!((ran.status, ran.stderr.lines().count()), (Some(1), 1), "{}", ran.stderr);
    assert!(ran.stderr.starts_with("<stdin>:1:"), "{}", ran.stderr);
    assert_eq!(folder.get("out.pbm"), b"old");
    assert_eq!(folder.names(), ["out.pbm", "scene.json"]);
}
