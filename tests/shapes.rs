//! The workloads are what they say: the same draws and the same vertices as numpy's.
//!
//! All expected values come from numpy 2.4.6: `default_rng(seed)`, and CRC-32s by `zlib.crc32` over the vertices, `x` and `y` as
//! little-endian 32-bit integers in 1/512 px, ring after ring, and over the files of the script that the recipes are taken from.

#[allow(dead_code, reason = "the benches fill them")]
#[path = "../benches/shapes/mod.rs"]
mod shapes;

use shapes::numpy::Rng;
use shapes::{Shapes, WORKLOADS};

#[test]
fn doubles_are_those_of_numpy() {
    for (seed, expected) in [
        (0, [0.6369616873214543, 0.2697867137638703, 0.04097352393619469]),
        (1004, [0.0008804527407150209, 0.13015131212763142, 0.13847736529859134]),
        (1005, [0.08221917306789372, 0.9305620423886036, 0.28728402836777045]),
        (100_000, [0.12593474592063136, 0.4685357423491585, 0.9975294796794693]),
        (u32::MAX, [0.2519435680449965, 0.21906579628685663, 0.28728472043517017]),
    ] {
        assert_eq!(Rng::new(seed).randoms(3), expected, "seed {seed}");
    }
}

#[test]
fn integers_are_those_of_numpy_also_between_doubles() {
    let mut rng = Rng::new(7);
    assert_eq!([(); 3].map(|()| rng.integers(40, 61)), [59, 53, 54]);
    assert_eq!(rng.random(), 0.7756856902451935);
    assert_eq!([(); 3].map(|()| rng.integers(40, 61)), [58, 57, 44]);
    assert_eq!(rng.uniform(-1.0, 1.0), -0.39966743017754913);

    // A range that rejects three draws in ten.
    let mut rng = Rng::new(7);
    let expected = [2052539808, 2691641401, 1734877354, 2500953063, 675621565, 166594727, 2620660335, 2737869578];
    assert_eq!([(); 8].map(|()| rng.integers(-5, 3_000_000_000)), expected);
}

#[test]
fn vertices_are_those_of_numpy() {
    for (name, vertices, crc) in [
        ("coast1e3", 2_000, 0x61af4b70),
        ("coast1e5", 200_000, 0x8aa4a8af),
        ("spiky1e3", 2_000, 0x9e317b79),
        ("spiky1e5", 200_000, 0xd8b876c7),
        ("self1e3", 2_000, 0x3bfa80ac),
        ("self1e5", 200_000, 0x82c6d97c),
        ("kway1000", 99_754, 0xe099a737),
        ("manh1e5", 400_000, 0xa0e5dd38),
    ] {
        let shapes = workload(name);
        let bytes: Vec<u8> = shapes.layers.iter().flatten().flatten().flatten().flat_map(|v| v.to_le_bytes()).collect();
        assert_eq!((shapes.vertices(), crc32fast::hash(&bytes)), (vertices, crc), "{name}");
    }
}

#[test]
fn files_are_those_of_the_script() {
    let shapes = workload("coast1e3");
    let (mut json, mut svg) = (Vec::new(), Vec::new());
    shapes.write_json(&mut json).unwrap();
    shapes.write_svg(&mut svg).unwrap();
    assert_eq!(crc32fast::hash(&json), 0x5f8c3339);
    assert_eq!(crc32fast::hash(&svg), 0xbf371f1e);
}

#[test]
fn an_unknown_name_is_told() {
    let error = shapes::named(&["coast".to_owned()]).unwrap_err();
    assert!(error.starts_with("no workload \"coast\"; there are coast1e3, coast1e5"), "{error}");
}

fn workload(name: &str) -> Shapes {
    WORKLOADS.iter().find(|workload| workload.0 == name).expect("a workload").1()
}

#[test]
fn edge_lines_are_the_pairs_of_an_edge_and_a_centre_between_its_ends() {
    let shapes = WORKLOADS.iter().find(|workload| workload.0 == "kway1000").unwrap().1();
    for scale in [1, 3] {
        let mut pairs = 0;
        for ring in shapes.layers.iter().flatten() {
            for (i, p) in ring.iter().enumerate() {
                let ends = [p[1], ring[(i + 1) % ring.len()][1]].map(|y| f64::from(y) / 512.0 * f64::from(scale));
                let (top, bottom) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
                pairs += (top as u32..=bottom as u32).filter(|&j| (top..bottom).contains(&(f64::from(j) + 0.5))).count() as u64;
            }
        }
        assert_eq!(shapes.edge_lines(scale), pairs);
    }
}
