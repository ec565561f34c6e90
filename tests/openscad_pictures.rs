//! Pictures of models beside those of `openscad --render`, pixel by pixel: which pixels show something, and in which colour.
//!
//! OpenSCAD draws the surface that CGAL has computed, each facet in one colour: that of a front or of a cut, times `0.2 + |n l|` where n is the facet's
//! normal and l the direction of its lights, to the upper left behind the camera, as read off its pictures. So its picture follows from our normals, and from whether
//! ours shows a front or a cut. Colours of parts are left out: CGAL forgets them.
//!
//! A pixel may differ where a neighbour, in either picture, differs from it; elsewhere not at all. Coverage is compared first and by itself, so that among
//! small facets, where every pixel has such a neighbour, an error of the silhouette is still seen.
//!
//! Without `openscad`, its examples and `xvfb-run` nothing is compared, and that is said.

#![allow(clippy::unwrap_used)] // all of this is tests

#[path = "../benches/solids/mod.rs"]
#[allow(dead_code)] // benches use the rest
mod solids;

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use glam::DVec3;
use image::RgbImage;
use runset::encode::by_name;
use runset::input::{ModelOptions, read_model};
use runset::job::{Aov, Job, Kept, SolidOptions};
use runset::mesh::check::all_placed;
use runset::scene::Limits;
use runset::solid::camera::{Camera, Setup};
use runset::solid::shade::SCHEMES;

fn effort() -> u64 {
    std::env::var("RUNSET_EFFORT").ok().and_then(|n| n.parse().ok()).unwrap_or(1)
}

/// OpenSCAD's examples that need nothing that is not supported, and are drawn by it in some seconds; those behind the bar only at effort 10.
const EXAMPLES: &str = "Basics/CSG Basics/linear_extrude Basics/projection Functions/functions Advanced/assert Old/example001 Old/example002 Old/example003 Old/example004 \
    Old/example005 Old/example011 Old/example012 Old/example014 Old/example016 Old/example017 \
    | Advanced/animation Basics/CSG-modules Basics/logo Old/example006 Old/example018 Old/example019 Old/example020 Old/example022 \
    Old/example024 Parametric/candleStand";

/// The workloads of `benches/solids` that are drawn at every effort.
const WORKLOADS: &str = "fig313/3/diff fig313/6/union fig313/10/diff fig313/32/diff fig316/1 fig316/2 fig316/3 fig47/10/0 fig47/10/4 fig47/10/8 fig414/1 fig414/2 \
    fig414/3 fig414/4 fig46/half fig46/zero menger/1 menger/2 blowup/4";

/// Those that OpenSCAD takes minutes for, and one that it gets wrong: it leaves slivers where faces coincide but for rounding.
const NOT: &str = "menger/3 plate/1000 blowup/20 blowup/50 blowup/200 fig46/skew";

/// What both draw.
struct Shot {
    name: String,
    csg: PathBuf,
    setup: Setup,
}

impl Shot {
    fn new(name: String, csg: &Path, camera: Option<Camera>, orthographic: bool) -> Shot {
        Shot { name, csg: csg.to_owned(), setup: Setup { camera, orthographic, width: SIZE[0], height: SIZE[1], ..Setup::default() } }
    }

    /// The options of both.
    fn options(&self) -> String {
        let Setup { camera, orthographic, view_all, autocenter, width, height } = self.setup;
        let numbers = match camera {
            None => Vec::new(),
            Some(Camera::Vector(numbers)) => numbers.to_vec(),
            Some(Camera::Gimbal(numbers)) => numbers.to_vec(),
        };
        let numbers = numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        let mut options = format!("--imgsize={width},{height} --projection={}", if orthographic { "o" } else { "p" });
        for (option, given) in
            [(format!(" --camera={numbers}"), camera.is_some()), (" --viewall".into(), view_all), (" --autocenter".into(), autocenter)]
        {
            options.push_str(if given { &option } else { "" });
        }
        options
    }
}

const SIZE: [u32; 2] = [480, 360];

/// A picture as OpenSCAD would draw it: its colour for every pixel.
fn ours(shot: &Shot) -> RgbImage {
    let mut warnings = Vec::new();
    let options = ModelOptions { folder: shot.csg.parent().map(Path::to_owned), ..ModelOptions::default() };
    let mut model = read_model(&std::fs::read(&shot.csg).unwrap(), &options, &mut warnings).unwrap();
    model.parts.iter_mut().for_each(|part| part.color = None);
    let kept = Kept::new(&model, &Limits::default(), &mut warnings).unwrap();
    let job = Job::solid(&kept, &SolidOptions { setup: shot.setup, ..SolidOptions::default() }).unwrap();
    assert!(warnings.iter().all(|w| w.what.contains("is empty") || w.what.contains("open edges")), "{}: {warnings:?}", shot.name);
    let (mut colours, mut normals) = (Vec::new(), Vec::new());
    job.render(by_name("ppm").unwrap(), 1, &mut colours, &mut |_| ()).unwrap();
    job.aov(Aov::Normal, &mut normals).unwrap();
    let colours = image::load_from_memory(&colours).unwrap().into_rgb8();
    let numbers = &normals[normals.len() - 12 * (SIZE[0] * SIZE[1]) as usize..];
    let number = |i: usize| f64::from(f32::from_le_bytes(numbers[4 * i..4 * i + 4].try_into().unwrap()));

    let [right, down, forward] = shot.setup.view(None).axes;
    let light = -(right + down + forward).normalize();
    let scheme = SCHEMES[0];
    RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        let at = 3 * ((SIZE[1] - 1 - y) * SIZE[0] + x) as usize;
        let normal = DVec3::new(number(at), number(at + 1), number(at + 2));
        if normal == DVec3::ZERO {
            return image::Rgb(scheme.background);
        }
        // Of the scheme's colours the front is rather red, the cut rather green.
        let [r, g, _] = colours.get_pixel(x, y).0;
        let base = if r > g { scheme.front } else { scheme.back };
        let bright = 0.2 + normal.dot(light).abs();
        image::Rgb(base.map(|c| (f64::from(c) * bright).round().min(255.0) as u8))
    })
}

/// Has OpenSCAD draw them all, two at a time, under one X server.
fn theirs(shots: &[Shot], folder: &Path) -> Vec<Result<RgbImage, String>> {
    // Seconds of processor time for each of them.
    let mut script = "ulimit -t 600\n".to_owned();
    for lane in 0..2 {
        script.push_str("(\n");
        for (i, shot) in shots.iter().enumerate().filter(|(i, _)| i % 2 == lane) {
            let [out, log] = ["png", "log"].map(|e| folder.join(format!("{i}.{e}")));
            writeln!(
                script,
                "openscad --render -o '{}' {} '{}' >'{}' 2>&1",
                out.display(),
                shot.options(),
                shot.csg.display(),
                log.display()
            )
            .unwrap();
        }
        script.push_str(") &\n");
    }
    script.push_str("wait\n");
    std::fs::write(folder.join("script"), script).unwrap();
    let ran =
        Command::new("xvfb-run").args(["-a", "-s", "-screen 0 1280x1024x24 -noreset", "sh"]).arg(folder.join("script")).output().unwrap();
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let read = |i: usize| {
        let log = std::fs::read_to_string(folder.join(format!("{i}.log"))).unwrap_or_default();
        image::open(folder.join(format!("{i}.png")))
            .map(image::DynamicImage::into_rgb8)
            .map_err(|e| format!("{}: {e}: {log}", shots[i].name))
    };
    (0..shots.len()).map(read).collect()
}

/// Levels by which a colour may be off: both are rounded, and OpenSCAD's normals are those of triangles.
const LEVELS: u8 = 4;

fn alike(a: [u8; 3], b: [u8; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= LEVELS)
}

/// Whether a picture is the same all around a pixel.
fn is_even(picture: &RgbImage, x: u32, y: u32, same: impl Fn([u8; 3], [u8; 3]) -> bool) -> bool {
    let middle = picture.get_pixel(x, y).0;
    let around = |x: u32, most: u32| x.saturating_sub(1)..(x + 2).min(most);
    around(y, SIZE[1]).all(|j| around(x, SIZE[0]).all(|i| same(picture.get_pixel(i, j).0, middle)))
}

/// How two pictures differ.
#[derive(Debug, Default)]
struct Differences {
    /// Pixels that show something in one of them at least.
    shown: u32,
    /// Of these, those whose colours are compared: with equal pixels around them, in both.
    compared: u32,
    /// Pixels that show something in one of them alone.
    coverage: u32,
    /// Of these, those that are not beside an outline.
    uncovered: Vec<[u32; 2]>,
    /// Pixels of other colours with equal pixels around them.
    colours: Vec<([u32; 2], [u8; 3], [u8; 3])>,
}

fn differences(a: &RgbImage, b: &RgbImage) -> Differences {
    let mut found = Differences::default();
    let shown = |colour| colour != SCHEMES[0].background;
    for (x, y, pixel) in a.enumerate_pixels() {
        let (one, other) = (pixel.0, b.get_pixel(x, y).0);
        found.shown += u32::from(shown(one) || shown(other));
        let even = |same: &dyn Fn([u8; 3], [u8; 3]) -> bool| is_even(a, x, y, same) && is_even(b, x, y, same);
        if shown(one) != shown(other) {
            found.coverage += 1;
            if even(&|a, b| shown(a) == shown(b)) {
                found.uncovered.push([x, y]);
            }
        } else if shown(one) && even(&alike) {
            found.compared += 1;
            if !alike(one, other) {
                found.colours.push(([x, y], one, other));
            }
        }
    }
    found
}

/// Names of a list: those up to its bar, from effort 10 on all.
fn some(list: &'static str) -> impl Iterator<Item = &'static str> {
    list.split_whitespace().take_while(|name| *name != "|" || effort() >= 10).filter(|name| *name != "|")
}

/// Sees all of a model.
fn camera(csg: &Path, direction: [f64; 3]) -> Option<Camera> {
    let options = ModelOptions { folder: csg.parent().map(Path::to_owned), ..ModelOptions::default() };
    let model = read_model(&std::fs::read(csg).unwrap(), &options, &mut Vec::new()).unwrap();
    let points: Vec<DVec3> =
        all_placed(&model, &mut Vec::new()).iter().flat_map(|p| p.mesh.points.iter().map(|p| DVec3::from(*p))).collect();
    let least = points.iter().copied().reduce(DVec3::min).unwrap();
    let most = points.iter().copied().reduce(DVec3::max).unwrap();
    let target = (least + most) / 2.0;
    let eye = target + DVec3::from(direction).normalize() * (most - least).length() * 2.2;
    Some(Camera::Vector([eye.x, eye.y, eye.z, target.x, target.y, target.z]))
}

/// Whether what draws is there; in CI it has to be.
fn is_there() -> bool {
    let examples = Path::new(FOLDER).is_dir();
    let there = examples && ["openscad", "xvfb-run"].iter().all(|tool| Command::new(tool).arg("--help").output().is_ok());
    if !there {
        assert!(std::env::var_os("CI").is_none_or(|ci| ci != "true"), "openscad, its examples or xvfb-run are missing");
        println!("skipped: openscad, its examples or xvfb-run are not installed");
    }
    there
}

const FOLDER: &str = "/usr/share/openscad/examples";

/// From where they are looked at: never along a plane of many models, where faces are seen edge-on and their colours are a matter of rounding.
const DIRECTIONS: [[f64; 3]; 4] = [[0.5, -0.9, 0.6], [-0.8, -0.55, 0.35], [0.31, 0.93, -0.42], [0.12, -0.3, 0.9]];

fn compare(shots: &[Shot], folder: &Path) {
    let (mut wrong, mut total) = (Vec::new(), Differences::default());
    for (shot, theirs) in shots.iter().zip(theirs(shots, folder)) {
        let theirs = match theirs {
            Ok(theirs) => theirs,
            Err(error) => {
                wrong.push(error);
                continue;
            }
        };
        let found = differences(&ours(shot), &theirs);
        println!(
            "{}: {} shown, {} compared, coverage {} ({} off outlines), colours {}",
            shot.name,
            found.shown,
            found.compared,
            found.coverage,
            found.uncovered.len(),
            found.colours.len()
        );
        if !found.uncovered.is_empty() || !found.colours.is_empty() {
            wrong.push(format!("{}: {:?} {:?}", shot.name, found.uncovered.first(), found.colours.first()));
        }
        total.shown += found.shown;
        total.compared += found.compared;
        total.coverage += found.coverage;
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), shots.len(), wrong.join("\n"));
    assert!(total.compared * 2 > total.shown, "{} of {} pixels are not beside others", total.compared, total.shown);
    println!(
        "{} pictures, {} pixels shown, {} compared, coverage differs beside outlines in {}",
        shots.len(),
        total.shown,
        total.compared,
        total.coverage
    );
}

#[test]
fn models_look_as_openscad_renders_them() {
    if !is_there() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    // The tree names what it imports as the program does: without a folder.
    let imported = ["Basics/projection.stl", "Old/example012.stl", "Old/example016.stl"].map(Path::new);
    imported.iter().for_each(|stl| _ = std::fs::copy(Path::new(FOLDER).join(stl), folder.path().join(stl.file_name().unwrap())).unwrap());
    let mut models = Vec::new();
    for name in some(EXAMPLES) {
        let csg = folder.path().join(format!("{}.csg", name.replace('/', "_")));
        let scad = Path::new(FOLDER).join(format!("{name}.scad"));
        let ran = Command::new("openscad").arg("-o").arg(&csg).arg(&scad).output().unwrap();
        assert!(csg.is_file(), "{name}: {}", String::from_utf8_lossy(&ran.stderr));
        models.push((name, csg));
    }
    let all = solids::names();
    let workloads: Vec<&str> = match effort() {
        0..10 => WORKLOADS.split_whitespace().collect(),
        _ => all.iter().map(String::as_str).filter(|name| NOT.split_whitespace().all(|not| not != *name)).collect(),
    };
    for name in workloads {
        let csg = folder.path().join(format!("{}.csg", name.replace('/', "_")));
        std::fs::write(&csg, solids::solid(name).unwrap().csg).unwrap();
        models.push((name, csg));
    }
    let shots = models.iter().enumerate().map(|(i, (name, csg))| {
        let from = i % 4;
        Shot::new(format!("{name} from {from}"), csg, camera(csg, DIRECTIONS[from]), i % 2 == 1)
    });
    let shots: Vec<Shot> = shots.collect();
    compare(&shots, folder.path());
}

/// A model that fills its bounds, not around 0: the options say the same to both programs.
#[test]
fn cameras_are_openscads() {
    if !is_there() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let csg = folder.path().join("m.csg");
    let text = "union() { multmatrix([[1, 0, 0, 7], [0, 1, 0, -3], [0, 0, 1, 2], [0, 0, 0, 1]]) { cube(size = [12, 8, 5], center = false); cylinder($fn = 6, h = 9, \
                r1 = 4, r2 = 2, center = false); } }";
    std::fs::write(&csg, text).unwrap();
    let cameras = [
        None,
        Some(Camera::Gimbal([10.0, 0.0, 4.0, 62.0, 0.0, 31.0, 90.0])),
        Some(Camera::Gimbal([10.0, -2.0, 4.0, 20.0, 35.0, 110.0, 70.0])),
        Some(Camera::Gimbal([0.0, 0.0, 0.0, 235.0, -15.0, 300.0, 140.0])),
        Some(Camera::Vector([40.0, -35.0, 30.0, 10.0, 0.0, 4.0])),
        Some(Camera::Vector([-30.0, 35.0, -30.0, 10.0, 0.0, 4.0])),
        Some(Camera::Vector([11.0, 1.0, 90.0, 11.0, 1.0, 0.0])),
        Some(Camera::Vector([11.0, 1.0, -90.0, 11.0, 1.0, 0.0])),
    ];
    let mut shots = Vec::new();
    for camera in cameras {
        // Without --viewall OpenSCAD does not heed --autocenter.
        for (view_all, autocenter) in [(false, false), (true, false), (true, true)] {
            for orthographic in [false, true] {
                let mut shot = Shot::new(String::new(), &csg, camera, orthographic);
                (shot.setup.view_all, shot.setup.autocenter) = (view_all, autocenter);
                shot.name = shot.options();
                shots.push(shot);
            }
        }
    }
    compare(&shots, folder.path());
}
