//! Models as jobs.

use runset::job::{Job, Kept, SolidOptions};
use runset::mesh::Model;
use runset::scene::Limits;
use runset::solid::camera::{Camera, Setup};
use runset::solid::look::Look;

use super::{Random, random_model};

/// A camera from which most of a random model is seen.
pub fn random_setup(random: &mut Random, width: u32, height: u32) -> Setup {
    let mut direction = || 0.2 + random.unit() * 2.0;
    let [x, y, z] = [direction(), -direction(), direction() - 1.0];
    let away = (10.0 + random.unit() * 8.0) / (x * x + y * y + z * z).sqrt();
    let camera = Some(Camera::Vector([x * away, y * away, z * away, 0.1, 0.0, -0.1]));
    Setup { camera, orthographic: random.below(2) == 0, width, height, ..Setup::default() }
}

pub fn kept(model: &Model) -> Kept {
    Kept::new(model, &Limits::default(), &mut Vec::new()).expect("a small model")
}

pub fn job(model: &Model, setup: Setup) -> Job {
    Job::solid(&kept(model), &SolidOptions { setup, ..SolidOptions::default() }).expect("a page and a camera")
}

/// Any look of a model.
pub fn random_look(random: &mut Random, model: &Kept) -> Look {
    let mut one_in = |n: u64| random.below(n) == 0;
    let [smooth, edges, glass, named] = [one_in(3), one_in(3), one_in(6), one_in(4)];
    let mut part = || 1 + random.below(model.parts()) as u32;
    Look {
        translucent: if named { vec![part()..=model.parts() as u32, part()..=1] } else { Vec::new() },
        antialias: random.pick(&[1, 1, 1, 1, 2, 3]),
        smooth: smooth.then(|| 10.0 + random.unit() * 100.0),
        edges: edges.then(|| random.unit() * 90.0),
        glass,
    }
}

/// A random model in colours, some of its parts in those of the scheme.
pub fn colored_model(random: &mut Random, most: u64) -> Model {
    let mut model = random_model(random, most);
    for part in &mut model.parts {
        part.color = (random.below(4) > 0).then(|| [0; 3].map(|_| random.below(256) as u8));
    }
    model
}

/// A random model on a page, looking anyhow.
pub fn random_job(random: &mut Random, width: u32, height: u32) -> Job {
    let model = kept(&colored_model(random, 6));
    let setup = random_setup(random, width, height);
    let look = random_look(random, &model);
    Job::solid(&model, &SolidOptions { setup, look, ..SolidOptions::default() }).expect("a page and a camera")
}
