//! How models look, against pictures that are made pixel by pixel.

mod models;

use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec3;
use models::drawn::{Seen, body, drawn, rays, stage_with};
use models::jobs::{colored_model, kept, random_look, random_setup};
use models::{Random, cube, part, random_model, random_view, shifted};
use runset::job::{Job, SolidOptions};
use runset::mesh::{Face, Mesh, Model};
use runset::run::{Inks, Rgb};
use runset::scene::{Area, Formula, Gate};
use runset::solid::body::Plane;
use runset::solid::camera::{Camera, Setup};
use runset::solid::glass::OPACITY;
use runset::solid::look::Look;
use runset::solid::savings::Savings;
use runset::solid::shade::{Colours, SCHEMES, light, lit};
use runset::solid::smooth::{Shading, Smooth};
use runset::solid::spans::Spans;
use runset::solid::stage::Stage;

fn effort() -> u64 {
    std::env::var("RUNSET_EFFORT").ok().and_then(|n| n.parse().ok()).unwrap_or(1)
}

/// The colours of all pixels, none where nothing is painted.
fn pixels(job: &Job) -> Vec<Vec<Option<u32>>> {
    let (mut rows, mut lines) = (job.rows(), Vec::new());
    while let Some(row) = rows.next() {
        assert!(row.check(job.header()), "line {}", row.y);
        let mut pixels = vec![None; job.header().width as usize];
        row.runs.iter().for_each(|run| pixels[run.start as usize..run.end as usize].fill(Some(run.ink)));
        lines.extend((0..row.n).map(|_| pixels.clone()));
    }
    lines
}

#[test]
fn antialiasing_is_the_box_filter_of_the_finer_picture() {
    let mut random = Random(71);
    for round in 0..40 * effort() {
        let parts = colored_model(&mut random, 6);
        let model = kept(&parts);
        let n = 2 + random.below(7) as u32;
        let (width, height) = (1 + random.below(40) as u32, 1 + random.below(30) as u32);
        let setup = random_setup(&mut random, width, height);
        let mut look = Look { antialias: n, ..random_look(&mut random, &model) };
        if look.edges.is_some() {
            (look.glass, look.translucent) = (false, Vec::new());
        }
        let options = SolidOptions { setup, look: look.clone(), ..SolidOptions::default() };
        let page = Setup { width: n * width, height: n * height, ..setup };
        let plain = Look { antialias: 1, edges: None, ..look.clone() };
        let finer = Job::solid(&model, &SolidOptions { setup: page, look: plain, ..options.clone() }).unwrap();
        let job = Job::solid(&model, &options).unwrap();
        let middle = |x: u32| n * x + n / 2;
        for (x, y) in [(width / 2, height / 2), (width - 1, 0), (width, 0), (0, height)] {
            assert_eq!(job.pick(x, y), finer.pick(middle(x), middle(y)), "round {round}, pixel {x}, {y} of {n} x {n}");
        }
        let mut finer = pixels(&finer);
        if let Some(angle) = look.edges {
            // Lines of the finer picture go on to the right and down for as many of its pixels as one of the page has.
            let of_stage = body(&parts);
            let stage = stage_with(&parts, page.view(of_stage.bounds), &[], Savings::default());
            let outlines = outlines(&stage, &drawn(&stage, 0..page.height, Savings::default()), angle);
            for (y, line) in finer.iter_mut().enumerate() {
                for (x, ink) in line.iter_mut().enumerate() {
                    let left = (0..(n as usize).min(x + 1)).any(|k| outlines[y][x - k][0]);
                    let above = (0..(n as usize).min(y + 1)).any(|k| outlines[y - k][x][1]);
                    if left || above {
                        *ink = Some(0);
                    }
                }
            }
        }
        let Inks::Shaded { paper } = job.header().inks else { panic!("shaded") };
        for (y, line) in pixels(&job).iter().enumerate() {
            for (x, &shown) in line.iter().enumerate() {
                let square = || (0..n * n).map(|i| finer[y * n as usize + (i / n) as usize][x * n as usize + (i % n) as usize]);
                let mean = |channel: usize| {
                    let of = |ink: Option<u32>| ink.map_or(paper[channel], |ink| ink.to_be_bytes()[channel + 1]);
                    (square().map(|ink| f64::from(of(ink))).sum::<f64>() / f64::from(n * n) + 0.5).floor() as u32
                };
                let expected = square().any(|ink| ink.is_some()).then(|| mean(0) << 16 | mean(1) << 8 | mean(2));
                assert_eq!(shown, expected, "round {round}, pixel {x}, {y} of {n} x {n}");
            }
        }
        let numbers = Job::solid(&model, &options.of_numbers()).unwrap();
        let mut bytes = Vec::new();
        assert!(job.aov(runset::job::Aov::Depth, &mut bytes).is_err() && bytes.is_empty());
        numbers.aov(runset::job::Aov::Depth, &mut bytes).unwrap();
        assert_eq!(bytes.len(), format!("Pf\n{width} {height}\n-1.0\n").len() + 4 * (width * height) as usize);
    }
}

/// The model of what is opaque: where parts that are glass add they are empty.
fn opaque(model: &Model, glass: &[bool]) -> Model {
    fn of(gates: &[Gate], area: Area, adds: bool, glass: &[bool], new: &mut Formula) -> Area {
        match &gates[area.index()] {
            Gate::Shape(part) if adds && glass[*part as usize] => new.any(&[]),
            Gate::Shape(part) => new.shape(*part),
            Gate::Odd(inputs) => {
                let inputs: Vec<Area> = inputs.iter().map(|input| of(gates, input.area, true, glass, new)).collect();
                new.odd(&inputs)
            }
            // What counts -1 where it holds counts 1 where it does not, less 1.
            Gate::AtLeast(k, inputs) => {
                let (mut k, mut areas) = (*k, Vec::new());
                for input in inputs {
                    let area = of(gates, input.area, adds == (input.weight > 0), glass, new);
                    let area = if input.weight > 0 { area } else { new.not(area) };
                    k += if input.weight > 0 { 0 } else { -input.weight };
                    areas.extend((0..input.weight.abs()).map(|_| area));
                }
                new.at_least(k, &areas)
            }
        }
    }
    let mut formula = Formula::default();
    let area = of(model.formula.gates(), model.area, true, glass, &mut formula);
    Model { parts: model.parts.clone(), formula, area }
}

#[test]
fn layers_of_glass_are_all_faces_in_front() {
    let mut random = Random(72);
    let mut layered = 0;
    for round in 0..100 * effort() {
        let model = random_model(&mut random, 6);
        let parts = model.parts.len();
        // Some parts, or all that is cut away.
        let named: Vec<bool> = (0..parts).map(|_| random.below(3) == 0).collect();
        let (empty, glass) = if random.below(3) == 0 { (vec![false; parts], vec![true; parts]) } else { (named.clone(), named) };
        let view = random_view(&mut random, 30);
        let sections = if random.below(4) == 0 {
            vec![Plane { normal: DVec3::new(0.3, 0.2 - random.unit(), 0.4).normalize(), offset: 0.1 }]
        } else {
            Vec::new()
        };
        let none = Savings::from_bits(0);
        let whole = stage_with(&model, view, &sections, none);
        let solid = stage_with(&opaque(&model, &empty), view, &sections, none);
        let seen = drawn(&solid, 0..view.height, none);
        let rays = rays(&whole);
        // The stage that jobs make, with the program of what is opaque.
        let (program, leaves) = runset::scene::compile(&model.formula, parts, &[model.area], |_| runset::count::Rule::AtLeast(1));
        let mut of_leaves = vec![false; program.leaves()];
        let mut glass_leaves = of_leaves.clone();
        leaves.iter().for_each(|&(part, leaf)| (of_leaves[leaf as usize], glass_leaves[leaf as usize]) = (empty[part], glass[part]));
        if !glass_leaves.contains(&true) {
            continue;
        }
        let program = runset::solid::glass::without(&program, &of_leaves);
        let of_stage = body(&model);
        let stage = Arc::new(Stage::new(&of_stage, program, &leaves, view, &sections, none));
        for bits in (0..32).filter(|bits| bits & 1 == 0) {
            let mut spans = Spans::with_glass(stage.clone(), 0..view.height, Savings::from_bits(bits), glass_leaves.clone().into());
            while let Some((y, line)) = spans.next() {
                let mut shown = vec![None; view.width as usize];
                for span in line {
                    shown[span.start as usize..span.end as usize].fill(Some((span.face, span.inside)));
                }
                let mut layers = vec![Vec::new(); view.width as usize];
                for stretch in spans.stretches() {
                    layers[stretch.start as usize..stretch.end as usize].fill(spans.layers(stretch).to_vec());
                }
                for (x, (shown, layers)) in shown.into_iter().zip(layers).enumerate() {
                    let (ray, seen) = (&rays[y as usize][x], seen[y as usize][x]);
                    assert_eq!(shown.map(|shown| shown.0), seen.map(|seen| seen.1), "round {round}, {x}, {y}");
                    let ahead = ray
                        .iter()
                        .filter(|hit| glass[stage.faces[hit.0 as usize].origin.part as usize] && seen.is_none_or(|seen| hit.2 > seen.2));
                    let expected: Vec<(u32, bool)> = ahead.map(|hit| (hit.0, hit.1 < 0)).collect();
                    layered += usize::from(expected.len() > 1);
                    assert_eq!(layers, expected, "round {round}, {x}, {y}, {bits:05b}");
                }
            }
        }
    }
    assert!(layered > 1000, "{layered}");
}

#[test]
fn colours_behind_glass_are_those_of_its_layers() {
    let mut random = Random(73);
    for round in 0..40 * effort() {
        let model = colored_model(&mut random, 6);
        let of_job = kept(&model);
        let parts = model.parts.len();
        let setup = random_setup(&mut random, 50, 40);
        let look = Look { antialias: 1, edges: None, ..random_look(&mut random, &of_job) };
        let mut named = vec![false; parts];
        look.translucent.iter().flat_map(|range| range.clone()).for_each(|part| named[part as usize - 1] = true);
        let glass = if look.glass { vec![true; parts] } else { named.clone() };
        let options = |look: Look| SolidOptions { setup, look, ..SolidOptions::default() };
        let job = Job::solid(&of_job, &options(look.clone())).unwrap();
        let solid = opaque(&model, &named);
        let plain = Look { smooth: look.smooth, ..Look::default() };
        let behind = pixels(&Job::solid(&kept(&solid), &options(plain)).unwrap());

        let of_stage = body(&model);
        let view = setup.view(of_stage.bounds);
        let none = Savings::from_bits(0);
        let (whole, solid) = (stage_with(&model, view, &[], none), stage_with(&solid, view, &[], none));
        let seen = drawn(&solid, 0..view.height, none);
        let colours: Vec<Option<Rgb>> = model.parts.iter().map(|part| part.color).collect();
        let flat = Colours::new(&whole, &colours, &SCHEMES[0]);
        let mut shading = look.smooth.map(|angle| Shading::new(Arc::new(Smooth::new(&of_stage, angle, view, light(&view)))));
        let (got, rays) = (pixels(&job), rays(&whole));
        for (y, line) in got.iter().enumerate() {
            for (x, &shown) in line.iter().enumerate() {
                let near = seen[y][x].map(|seen| seen.2);
                let ahead: Vec<_> = rays[y][x]
                    .iter()
                    .filter(|hit| glass[whole.faces[hit.0 as usize].origin.part as usize] && near.is_none_or(|near| hit.2 > near))
                    .collect();
                if ahead.is_empty() {
                    assert_eq!(shown, behind[y][x], "round {round}, {x}, {y}");
                    continue;
                }
                let channels = |ink: u32| [16, 8, 0].map(|shift| f64::from(ink >> shift & 255));
                let mut colour = behind[y][x].map_or([255.0, 255.0, 229.0], channels);
                for &&(face, turns, _) in ahead.iter().rev() {
                    let mut layer = flat.of(face, false);
                    if let Some(shading) = shading.as_mut().filter(|shading| !shading.is_flat(face)) {
                        shading.along(face, turns < 0, y as u32, x as u32..x as u32 + 1, |_, cosine| {
                            layer = lit(flat.of_part(whole.faces[face as usize].origin, false), cosine.expect("a direction"));
                        });
                    }
                    colour.iter_mut().zip(channels(layer)).for_each(|(under, layer)| *under += (layer - *under) * OPACITY);
                }
                let [r, g, b] = colour.map(|channel| channel.round() as u32);
                assert_eq!(shown, Some(r << 16 | g << 8 | b), "round {round}, {x}, {y}");
            }
        }
    }
}

/// For every pixel whether there is an outline at its left, and above it.
fn outlines(stage: &Stage, seen: &[Vec<Seen>], angle: f64) -> Vec<Vec<[bool; 2]>> {
    let depth = |face: u32, (x, y): (u32, u32)| stage.depths[stage.faces[face as usize].plane as usize].at(x, y);
    let differ = |from: (u32, u32), to: (u32, u32)| {
        let at = |(x, y): (u32, u32)| seen[y as usize][x as usize];
        let (one, other) = match (at(from), at(to)) {
            (None, None) => return false,
            (Some(one), Some(other)) => (one, other),
            _ => return true,
        };
        let toward = |face: u32| {
            let plane = stage.faces[face as usize].plane;
            stage.planes[plane as usize].normal * if stage.is_toward(plane) { 1.0 } else { -1.0 }
        };
        let steps = [one.1, other.1].map(|face| depth(face, to) - depth(face, from));
        let (step, room) = (other.2 - one.2, steps[0].abs() + steps[1].abs());
        let said = steps[0].min(steps[1]) - room..=steps[0].max(steps[1]) + room;
        let coplanar = stage.faces[one.1 as usize].plane == stage.faces[other.1 as usize].plane;
        one.0 != other.0 || (!coplanar && (toward(one.1).dot(toward(other.1)) < angle.to_radians().cos() || !said.contains(&step)))
    };
    let [width, height] = [stage.view.width, stage.view.height];
    let of = |x: u32, y: u32| [x > 0 && differ((x.saturating_sub(1), y), (x, y)), y > 0 && differ((x, y.saturating_sub(1)), (x, y))];
    (0..height).map(|y| (0..width).map(|x| of(x, y)).collect()).collect()
}

#[test]
fn edges_are_where_neighbours_do_not_go_on() {
    let mut random = Random(74);
    let mut counts = [0; 2];
    for round in 0..60 * effort() {
        let model = colored_model(&mut random, 6);
        let of_job = kept(&model);
        let setup = random_setup(&mut random, 60, 50);
        let angle = random.pick(&[0.0, 1.0, 30.0, 60.0, 100.0, 180.0]);
        let options = |edges| SolidOptions { setup, look: Look { edges, ..Look::default() }, ..SolidOptions::default() };
        let [plain, lined] = [None, Some(angle)].map(|edges| pixels(&Job::solid(&of_job, &options(edges)).unwrap()));
        let of_stage = body(&model);
        let stage = stage_with(&model, setup.view(of_stage.bounds), &[], Savings::default());
        let seen = drawn(&stage, 0..50, Savings::default());
        let outlines = outlines(&stage, &seen, angle);
        for y in 0..50 {
            for x in 0..60 {
                let dark = outlines[y][x] != [false; 2];
                counts[usize::from(dark)] += 1;
                assert_eq!(lined[y][x], if dark { Some(0) } else { plain[y][x] }, "round {round}, {x}, {y}, {angle} degrees");
            }
        }
    }
    assert!(counts[1] * 50 > counts[0], "{counts:?}");
}

/// A ball of triangles, with bumps: an octahedron divided `n` times.
fn bumpy(random: &mut Random, n: u32) -> Mesh {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let mut points: Vec<DVec3> = axes.map(DVec3::from_array).to_vec();
    let mut faces: Vec<[u32; 3]> = (0..4).flat_map(|i| [[i, (i + 1) % 4, 4], [(i + 1) % 4, i, 5]]).collect();
    for _ in 0..n {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push((points[a as usize] + points[b as usize]).normalize());
                points.len() as u32 - 1
            })
        };
        faces = faces
            .into_iter()
            .flat_map(|[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let points = points.into_iter().map(|p| (p * (2.0 + random.unit() * 0.4)).to_array()).collect();
    Mesh { points, faces: faces.iter().map(|ring| Face::new(vec![ring.to_vec()])).collect() }
}

/// From the definitions: normals of corners by walking around them, and where the ray of a pixel meets the triangle.
#[test]
fn smooth_shades_are_those_of_interpolated_normals() {
    let mut random = Random(75);
    for round in 0..6 * effort() {
        let mesh = bumpy(&mut random, 1 + round as u32 % 2);
        let mut formula = Formula::default();
        let area = formula.shape(0);
        let model = Model { parts: vec![part(mesh.clone(), shifted(0.0, 0.0, 0.0))], formula, area };
        let (setup, angle) = (random_setup(&mut random, 70, 60), random.pick(&[20.0_f64, 40.0, 70.0, 180.0]));
        let of_job = kept(&model);
        let look = Look { smooth: Some(angle), ..Look::default() };
        let job = Job::solid(&of_job, &SolidOptions { setup, look, ..SolidOptions::default() }).unwrap();

        let at = |corner: u32| DVec3::from_array(mesh.points[corner as usize]);
        let rings: Vec<[u32; 3]> = mesh.faces.iter().map(|face| face.rings[0][..].try_into().unwrap()).collect();
        let flat = |face: usize| (at(rings[face][1]) - at(rings[face][0])).cross(at(rings[face][2]) - at(rings[face][0])).normalize();
        let normal = |face: usize, corner: u32| {
            let (mut joined, mut open, mut sum) = (vec![face], vec![face], DVec3::ZERO);
            while let Some(face) = open.pop() {
                let i = rings[face].iter().position(|&other| other == corner).unwrap();
                let [a, b] = [1, 2].map(|k| (at(rings[face][(i + k) % 3]) - at(corner)).normalize());
                sum += flat(face) * a.dot(b).acos();
                for other in (0..rings.len()).filter(|&other| other != face && rings[other].contains(&corner)) {
                    let shared = rings[face].iter().filter(|corner| rings[other].contains(corner)).count();
                    let apart = flat(face).dot(flat(other)).min(1.0).acos().to_degrees();
                    if shared == 2 && apart < angle && !joined.contains(&other) {
                        joined.push(other);
                        open.push(other);
                    }
                }
            }
            sum.normalize()
        };
        let view = setup.view(body(&model).bounds);
        let [right, down, forward] = view.axes;
        let light = (right * -0.4 + down * -0.65 + forward * -0.75).normalize();
        let Some(Camera::Vector(_)) = setup.camera else { panic!("an eye") };
        let mut shown = 0;
        for (y, line) in pixels(&job).iter().enumerate() {
            for (x, &ink) in line.iter().enumerate() {
                let [u, v] = [x as f64 + 0.5 - 35.0, y as f64 + 0.5 - 30.0];
                let (origin, along) = match view.projection {
                    runset::solid::view::Projection::Perspective { focal, .. } => (view.eye, forward * focal + right * u + down * v),
                    runset::solid::view::Projection::Orthographic { scale } => (view.eye + (right * u + down * v) / scale, forward),
                };
                let hits = (0..rings.len()).filter_map(|face| {
                    let [a, b, c] = rings[face].map(at);
                    let (n, p) = ((b - a).cross(c - a), origin - a);
                    let t = -p.dot(n) / along.dot(n);
                    let p = p + along * t;
                    let (wb, wc) = (p.cross(c - a).dot(n) / n.dot(n), (b - a).cross(p).dot(n) / n.dot(n));
                    let inside = [1.0 - wb - wc, wb, wc];
                    inside.iter().all(|w| *w > -1e-4).then_some((t, face, inside))
                });
                let Some((_, face, weights)) = hits.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
                // Not where rounding decides which face it is.
                if weights.iter().any(|w| *w < 1e-4) {
                    continue;
                }
                let sum: DVec3 = rings[face].iter().zip(weights).map(|(&corner, weight)| normal(face, corner) * weight).sum();
                let bright = 0.35 + 0.65 * sum.normalize().dot(light).max(0.0);
                let expected = [0xf9, 0xd7, 0x2c].map(|c| f64::from(c) * bright);
                let Some(ink) = ink else { continue };
                shown += 1;
                for (i, expected) in expected.iter().enumerate() {
                    let got = f64::from(ink.to_be_bytes()[i + 1]);
                    assert!((got - expected).abs() < 1.0, "round {round}, {x}, {y}, face {face}: {ink:06x}, {expected:?}");
                }
            }
        }
        assert!(shown > 200, "{shown}");
    }
}

#[test]
fn sections_show_the_model_without_a_large_box() {
    let mut random = Random(76);
    let (mut same, mut shown) = (0_usize, 0_usize);
    for round in 0..60 * effort() {
        let model = random_model(&mut random, 6);
        let view = random_view(&mut random, 40);
        let normal = DVec3::new(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5).normalize_or(DVec3::X);
        let plane = Plane { normal: -normal, offset: -(random.unit() - 0.5) };
        // From the plane on along the normal, which is the box's z.
        let turn = glam::DQuat::from_rotation_arc(DVec3::Z, normal);
        let tall = models::matrix(turn, DVec3::ONE, normal * -plane.offset);
        let mut cut = model.clone();
        cut.parts.push(part(cube([-50.0, -50.0, 0.0], [50.0, 50.0, 50.0]), tall));
        let the_box = model.parts.len() as u32;
        let taken = cut.formula.shape(the_box);
        cut.area = cut.formula.without(cut.area, &[taken]);
        let [one, other] = [stage_with(&model, view, &[plane], Savings::default()), stage_with(&cut, view, &[], Savings::default())];
        let [section, minus] = [&one, &other].map(|stage| drawn(stage, 0..view.height, Savings::default()));
        for (y, (section, minus)) in section.iter().zip(&minus).enumerate() {
            for (x, (section, minus)) in section.iter().zip(minus).enumerate() {
                assert_eq!(section.is_some(), minus.is_some(), "round {round}, {x}, {y}");
                let (Some(section), Some(minus)) = (section, minus) else { continue };
                let far = |stage: &Stage, near: i128| stage.view.distance(near, stage.farthest);
                let (a, b) = (far(&one, section.2), far(&other, minus.2));
                assert!((a - b).abs() <= 1e-6 * a.abs().max(1.0), "round {round}, {x}, {y}: {a} {b}");
                let face = &one.planes[one.faces[section.1 as usize].plane as usize];
                let capped = (face.normal.dot(normal).abs() - 1.0).abs() < 1e-9 && (face.offset.abs() - plane.offset.abs()).abs() < 1e-9;
                shown += 1;
                // A cap belongs to the part that was cut, there it is the box's.
                same += usize::from(minus.0 == section.0 || (capped && minus.0 == the_box));
            }
        }
    }
    // What is left are faces of several parts that are equally near.
    assert!(shown > 10_000 && 100 * same > 99 * shown, "{same} of {shown}");
}
