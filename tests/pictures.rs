//! Small documents beside their pictures: every file of `tests/pictures` is a test.
//!
//! A file is a document, a line `----`, and the picture: `.` is paper, `#` the region, or the number of the ink where there are several. They are
//! small enough to be checked by hand; `UPDATE_PICTURES=1` writes what the engine makes, for a person to look at before it is kept.

use std::fs;
use std::path::{Path, PathBuf};

use libtest_mimic::{Arguments, Failed, Trial};
use runset::input;
use runset::job::{Job, Options};
use runset::scene::Limits;

fn main() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pictures");
    let mut files: Vec<PathBuf> = fs::read_dir(folder).expect("the folder is there").map(|entry| entry.expect("readable").path()).collect();
    files.sort();
    assert!(files.len() > 5, "pictures are found");
    let trial = |file: PathBuf| {
        let name = file.file_stem().expect("a file").to_string_lossy().into_owned();
        Trial::test(name, move || compare(&file))
    };
    libtest_mimic::run(&Arguments::from_args(), files.into_iter().map(trial).collect()).exit();
}

fn compare(file: &Path) -> Result<(), Failed> {
    let text = fs::read_to_string(file)?;
    let (document, drawn) = text.split_once("\n----\n").ok_or("a picture file has a line ----")?;
    let made = picture(document.as_bytes().to_vec())?;
    if std::env::var_os("UPDATE_PICTURES").is_some() {
        fs::write(file, format!("{document}\n----\n{made}"))?;
    } else if made != drawn {
        return Err(format!("drawn:\n{drawn}\nmade:\n{made}").into());
    }
    Ok(())
}

fn picture(document: Vec<u8>) -> runset::error::Result<String> {
    let mut warnings = Vec::new();
    let scene = input::read(document, &Limits::default(), &mut warnings)?;
    let job = Job::prepare(scene, &Options::default(), &mut warnings)?;
    let inks = job.header().inks.end();
    let mut text = String::new();
    let mut rows = job.rows();
    while let Some(lines) = rows.next() {
        let mut row = vec!['.'; job.header().width as usize];
        for run in lines.runs {
            let mark = if inks == 1 { '#' } else { char::from_digit(run.ink, 36).unwrap_or('?') };
            row[run.start as usize..run.end as usize].fill(mark);
        }
        for _ in 0..lines.n {
            text.extend(row.iter());
            text.push('\n');
        }
    }
    Ok(text)
}
