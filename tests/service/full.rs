//! No room: a job is stored whole or not at all.
//!
//! A limit of a file's size stands for a full disk: it needs no rights, and writes fail at the same places. Where a small file system can be mounted, a disk
//! is filled in earnest too.

use std::path::Path;
use std::process::Command;

use crate::support::{Folder, SCENE, Server, command, empty, ids};

/// A service whose files have so many KiB at most.
fn limited(data: &Path, kib: u32) -> Server {
    let plain = command(data, &["--log", "error"]);
    let mut limited = Command::new("bash");
    // The signal that comes with the fault is left out, as on a full disk.
    limited.args(["-c", &format!("trap '' XFSZ; ulimit -f {kib}; exec \"$@\""), "-", plain.get_program().to_str().unwrap()]);
    limited.args(plain.get_args()).env_remove("RUNSET_TOKEN");
    Server::run(limited, data)
}

/// Fills the store up with small jobs; gives those that were accepted.
fn fill_up(server: &Server) -> Vec<String> {
    let mut accepted = Vec::new();
    loop {
        let answer = server.post_job("", &[], SCENE);
        if answer.status != 201 {
            answer.problem(507, "disk-full");
            return accepted;
        }
        accepted.push(answer.header("location").rsplit('/').next().unwrap().to_owned());
        assert!(accepted.len() < 5000, "there is room for everything");
    }
}

#[test]
fn a_document_for_which_there_is_no_room() {
    let folder = Folder::new();
    let server = limited(&folder.data(), 600);
    let large = empty(8, 8) + &" ".repeat(700 << 10);
    server.post_job("", &[], large).problem(507, "disk-full");
    assert!(ids(&server).is_empty() && folder.documents().is_empty());
    let job = server.job("", SCENE);
    server.get(&format!("{job}/raster")).ok(200);
    assert_eq!(folder.documents(), ids(&server));
}

#[test]
fn a_record_for_which_there_is_no_room() {
    let folder = Folder::new();
    let server = limited(&folder.data(), 400);
    let mut accepted = fill_up(&server);
    assert!(accepted.len() > 5);
    accepted.sort();
    assert_eq!((ids(&server), folder.documents()), (accepted.clone(), accepted.clone()));
    let raster = server.get(&format!("/v1/jobs/{}/raster", accepted[0])).ok(200).body;
    server.kill();
    let server = Server::start(&folder.data(), &[]);
    assert_eq!((ids(&server), folder.documents()), (accepted.clone(), accepted.clone()));
    assert!(server.get(&format!("/v1/jobs/{}/raster", accepted[0])).ok(200).body == raster);
    server.job("", SCENE);
}

/// A file system of two MiB in memory, which goes when this is dropped.
struct Disk<'f>(&'f Path);

impl Disk<'_> {
    /// None where it may not be mounted.
    fn mount(at: &Path) -> Option<Disk<'_>> {
        std::fs::create_dir(at).unwrap();
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", "size=2m", "tmpfs"])
            .arg(at)
            .output()
            .is_ok_and(|output| output.status.success());
        mounted.then_some(Disk(at))
    }
}

impl Drop for Disk<'_> {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0).status();
    }
}

#[test]
fn a_disk_that_is_full() {
    let folder = Folder::new();
    let at = folder.file("disk");
    let Some(_disk) = Disk::mount(&at) else {
        // Containers seldom let anybody mount: the limits above are checked everywhere.
        return eprintln!("skipped: a file system cannot be mounted here");
    };
    // The log stays outside.
    std::fs::create_dir(at.join("data")).unwrap();
    std::os::unix::fs::symlink(at.join("data"), folder.data()).unwrap();
    let server = Server::start(&folder.data(), &["--log", "error"]);
    server.post_job("", &[], empty(8, 8) + &" ".repeat(3 << 20)).problem(507, "disk-full");
    let accepted = fill_up(&server);
    assert_eq!((ids(&server), folder.documents()), (accepted.clone(), accepted.clone()));
    server.get(&format!("/v1/jobs/{}/raster", accepted[0])).ok(200);
    server.kill();
    let server = Server::start(&folder.data(), &["--log", "error"]);
    assert_eq!((ids(&server), folder.documents()), (accepted.clone(), accepted));
}
