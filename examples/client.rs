//! Post a drawing to `runset serve` and draw it in the terminal while its lines arrive:
//!
//! ```sh
//! runset serve &
//! cargo run --release --example client -- http://127.0.0.1:8080 examples/art/poster.svg
//! ```
//!
//! The stream ends with a record of its own, so that one that was cut is told from one that is whole.

use std::io::{self, BufReader, Write};

use anyhow::{Context, bail};
use runset::input::lines::LineReader;

/// Columns of the picture.
const WIDTH: usize = 78;

/// A character for each ink, again from the first where there are more.
const INKS: [char; 8] = ['#', '.', 'o', '+', '=', '*', '-', '%'];

fn main() -> anyhow::Result<()> {
    let mut args = std::env::args().skip(1);
    let (Some(service), Some(path)) = (args.next(), args.next()) else {
        bail!("usage: client SERVICE FILE, such as http://127.0.0.1:8080 poster.svg")
    };
    let document = std::fs::read(&path).with_context(|| path.clone())?;
    let kind = if document.trim_ascii_start().starts_with(b"{") { "application/json" } else { "image/svg+xml" };

    let agent: ureq::Agent = ureq::Agent::config_builder().http_status_as_error(false).build().into();
    let request = agent.post(format!("{service}/v1/fill?width={WIDTH}")).content_type(kind).header("accept", "application/vnd.runset.rls");
    let mut answer = request.send(&document)?;
    if answer.status() != 200 {
        bail!("{}: {}", answer.status(), answer.body_mut().read_to_string()?);
    }

    let mut body = BufReader::new(answer.body_mut().as_reader());
    let mut lines = LineReader::open(&mut body)?;
    let mut out = io::stdout().lock();
    // An error here: the connection broke, or the stream is not what its end record says.
    while let Some(group) = lines.next_lines().context("the picture is not whole")? {
        let mut row = [' '; WIDTH];
        for run in group.runs {
            row[run.start as usize..run.end as usize].fill(INKS[run.ink as usize % INKS.len()]);
        }
        let row = String::from_iter(row);
        // Characters are twice as high as wide: every second line is drawn.
        for _ in (group.y..group.y + group.n).filter(|y| y % 2 == 0) {
            writeln!(out, "{}", row.trim_end())?;
        }
        out.flush()?;
    }
    Ok(())
}
