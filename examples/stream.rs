//! Stream a page of 1.7 gigapixel to any `Write`, a portion at a time: `cargo run --release --example stream > page.pbm`
//!
//! The stream is pulled: nothing is drawn before it is asked for, and between two calls it is a suspended sweep of a few KiB.

use std::io::{self, Write};

use runset::encode;
use runset::job::{Job, More, Options, Size};
use runset::scene::{Picture, Scene};
use runset::shape::{FillRule, Path, Shape, Transform};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A rosette: a star polygon of 61 points around the origin, filled even-odd, moved to the middle of the page.
    let corners: Vec<[f64; 2]> = (0..61)
        .map(|i| {
            let turn = f64::from(i * 25) / 61.0 * std::f64::consts::TAU;
            [480.0 * turn.sin(), -480.0 * turn.cos()]
        })
        .collect();
    let mut path = Path::default();
    path.ring(&corners);
    let centred = Transform::Affine([1.0, 0.0, 0.0, 1.0, 500.0, 500.0]);
    let mut scene = Scene::new(1000.0, 1000.0);
    let rosette = scene.add_shape(Shape { rule: FillRule::EvenOdd, transform: centred, ..Shape::new("rosette", path) });
    scene.picture = Picture::Region(rosette);

    let options = Options { size: Size::Pixels { width: Some(41_000), height: None }, ..Options::default() };
    let job = Job::prepare(scene, &options, &mut Vec::new())?;
    let format = encode::by_name("pbm").ok_or("no such format")?;
    let mut stream = job.stream(format);
    let mut out = io::stdout().lock();
    let mut portion = Vec::new();
    loop {
        let more = stream.next_band(&mut portion);
        match out.write_all(&portion) {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => return Ok(()),
            other => other?,
        }
        portion.clear();
        if more == More::End {
            return Ok(());
        }
    }
}
