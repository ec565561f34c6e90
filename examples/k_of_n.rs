//! Where at least k of n shapes overlap, for every k: `cargo run --example k_of_n`
//!
//! One counter does it; the expression is never expanded into the 792 products that "5 of 12" stands for.

use runset::error::Error;
use runset::job::{Job, Options};
use runset::scene::{Picture, Scene};
use runset::shape::{Path, Shape};

fn main() -> Result<(), Error> {
    for k in 1..=12 {
        let mut scene = Scene::new(400.0, 400.0);
        let discs: Vec<_> = (0..12)
            .map(|i| {
                let turn = f64::from(i) / 12.0 * std::f64::consts::TAU;
                let mut disc = Path::default();
                disc.circle([200.0 + 100.0 * turn.cos(), 200.0 + 100.0 * turn.sin()], 130.0);
                scene.add_shape(Shape::new(format!("disc{i}"), disc))
            })
            .collect();
        scene.picture = Picture::Region(scene.formula.at_least(k, &discs));

        let job = Job::prepare(scene, &Options::default(), &mut Vec::new())?;
        let mut rows = job.rows();
        let mut pixels = 0;
        while let Some(lines) = rows.next() {
            pixels += lines.runs.iter().map(|run| u64::from(run.end - run.start)).sum::<u64>() * u64::from(lines.n);
        }
        println!("{k:2} of 12: {pixels:6} pixels, {:4} crossings counted", rows.cost().rows.toggles);
    }
    Ok(())
}
