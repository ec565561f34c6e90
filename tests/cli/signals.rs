//! A run that is cut off leaves nothing behind, and is seen to have died of the signal.

use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Stdio};

use crate::support::{Folder, LONG, PBM, RUNSET, SCENE, kill, ran, wait_until};

/// Starts the program with signals as a terminal has them, whatever the tests were started with.
fn start(folder: &Folder, signals: &str, args: &str, stdin: Stdio) -> Child {
    let mut command = folder.command("env");
    command.arg(signals).arg(RUNSET).args(args.split_whitespace());
    command.stdin(stdin).spawn().unwrap()
}

/// The temporary file, if there is one now, with its size.
fn unfinished(folder: &Folder) -> Option<u64> {
    let name = folder.names().into_iter().find(|name| name.starts_with(".runset-"))?;
    std::fs::metadata(folder.path(&name)).ok().map(|metadata| metadata.len())
}

#[test]
fn half_way_through_writing() {
    for (signal, number) in [("INT", 2), ("TERM", 15), ("HUP", 1), ("QUIT", 3)] {
        let folder = Folder::new();
        folder.put("long.json", LONG);
        folder.put("out.pbm", "old");
        let mut child = start(&folder, "--default-signal", "fill long.json -o out.pbm", Stdio::null());
        wait_until("it has written something", || unfinished(&folder).is_some_and(|size| size > 100_000));
        kill(&child, signal);
        assert_eq!(child.wait().unwrap().signal(), Some(number), "{signal}");
        assert_eq!(folder.names(), ["long.json", "out.pbm", "scene.json"], "{signal}");
        assert_eq!(folder.get("out.pbm"), b"old");
    }
}

#[test]
fn while_it_waits_for_its_input() {
    let folder = Folder::new();
    for (signal, number) in [("INT", 2), ("TERM", 15)] {
        let mut child = start(&folder, "--default-signal", "fill - -o out.pbm", Stdio::piped());
        // Held open: waiting for a child closes its input, and then there is nothing to wait for any more.
        let _input = child.stdin.take();
        wait_until("the temporary file is there", || unfinished(&folder).is_some());
        kill(&child, signal);
        assert_eq!(child.wait().unwrap().signal(), Some(number), "{signal}");
        assert_eq!(folder.names(), ["scene.json"], "{signal}");
    }
}

#[test]
fn killed_outright_it_leaves_nothing_under_the_outputs_name() {
    let folder = Folder::new();
    folder.put("long.json", LONG);
    let mut child = start(&folder, "--default-signal", "fill long.json -o out.pbm", Stdio::null());
    wait_until("it has written something", || unfinished(&folder).is_some_and(|size| size > 100_000));
    kill(&child, "KILL");
    assert_eq!(child.wait().unwrap().signal(), Some(9));
    assert!(!folder.path("out.pbm").exists());
}

#[test]
fn what_is_ignored_stays_ignored() {
    let folder = Folder::new();
    let mut child = start(&folder, "--ignore-signal=HUP", "fill - -o out.pbm", Stdio::piped());
    wait_until("the temporary file is there", || unfinished(&folder).is_some());
    kill(&child, "HUP");
    std::io::Write::write_all(&mut child.stdin.take().unwrap(), SCENE.as_bytes()).unwrap();
    ran(child.wait_with_output().unwrap()).done();
    assert_eq!(folder.get("out.pbm"), PBM);
}
