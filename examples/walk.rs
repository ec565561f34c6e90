//! Build two shapes, subtract one from the other, and walk the rows: `cargo run --example walk`

use runset::error::Error;
use runset::job::{Job, Options};
use runset::scene::{Picture, Scene};
use runset::shape::{Path, Shape};

fn main() -> Result<(), Error> {
    // A page of 48 x 24 pixels: at scale 1 a user unit is a pixel.
    let mut scene = Scene::new(48.0, 24.0);
    let mut moon = Path::default();
    moon.circle([20.0, 12.0], 11.0);
    let mut shadow = Path::default();
    shadow.circle([26.0, 9.0], 10.0);
    let moon = scene.add_shape(Shape::new("moon", moon));
    let shadow = scene.add_shape(Shape::new("shadow", shadow));
    let crescent = scene.formula.without(moon, &[shadow]);
    scene.picture = Picture::Region(crescent);

    let mut warnings = Vec::new();
    let job = Job::prepare(scene, &Options::default(), &mut warnings)?;
    let mut rows = job.rows();
    while let Some(lines) = rows.next() {
        let mut text = vec!['.'; 48];
        for run in lines.runs {
            text[run.start as usize..run.end as usize].fill('#');
        }
        let text: String = text.into_iter().collect();
        for y in lines.y..lines.y + lines.n {
            println!("{y:3} {text}  {:?}", lines.runs.iter().map(|run| (run.start, run.end)).collect::<Vec<_>>());
        }
    }
    println!("counted on {} of 24 lines", rows.cost().rows.counted);
    Ok(())
}
