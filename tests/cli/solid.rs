//! solid: models in, pictures and numbers out.

use crate::support::Folder;

/// A cube of 10 with a square hole of 4 through it along z.
const MODEL: &str = "difference() {
\tcube(size = [10, 10, 10], center = true);
\tcube(size = [4, 4, 20], center = true);
}
";

/// From above without perspective: 16 px are 2 * 100 * tan(11.25 degrees) = 39.78 units, so the cube is 4.02 px wide and the hole 1.61.
const ABOVE: &str = "--camera 0,0,0,0,0,0,100 --projection o --imgsize 16,16";

#[test]
fn a_model_from_above_by_hand() {
    let folder = Folder::new();
    folder.put("m.csg", MODEL);
    let out =
        folder.run(&format!("solid m.csg {ABOVE} --format pbm --aov primitive=p.pgm --aov depth=d.pfm --aov normal=n.pfm")).done().to_vec();
    let rows: Vec<u16> = out.strip_prefix(b"P4\n16 16\n").unwrap().chunks(2).map(|row| u16::from_be_bytes([row[0], row[1]])).collect();
    // Pixels 6 to 9; the hole is from 7.2 to 8.8 and holds the centres of 7 and 8.
    let expected: Vec<u16> = (0..16)
        .map(|y| match y {
            6 | 9 => 0b0000_0011_1100_0000,
            7 | 8 => 0b0000_0010_0100_0000,
            _ => 0,
        })
        .collect();
    assert_eq!(rows, expected);

    let parts = folder.get("p.pgm");
    let parts = parts.strip_prefix(b"P5\n16 16\n65535\n").unwrap();
    let bits = |y: usize, x: usize| expected[y] >> (15 - x) & 1;
    for y in 0..16 {
        for x in 0..16 {
            assert_eq!(u16::from_be_bytes([parts[2 * (16 * y + x)], parts[2 * (16 * y + x) + 1]]), bits(y, x), "{x} {y}");
        }
    }
    // The bottom row comes first; the upper side of the cube is 95 away.
    let depths = folder.get("d.pfm");
    let normals = folder.get("n.pfm");
    let numbers = |bytes: &[u8]| bytes.chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect::<Vec<_>>();
    let depths = numbers(depths.strip_prefix(b"Pf\n16 16\n-1.0\n").unwrap());
    let normals = numbers(normals.strip_prefix(b"PF\n16 16\n-1.0\n").unwrap());
    for y in 0..16 {
        for x in 0..16 {
            let (at, shown) = (16 * (15 - y) + x, bits(y, x) == 1);
            assert!(if shown { (depths[at] - 95.0).abs() < 1e-4 } else { depths[at] == f32::INFINITY }, "{x} {y}: {}", depths[at]);
            assert_eq!(&normals[3 * at..3 * at + 3], if shown { &[0.0, 0.0, 1.0] } else { &[0.0; 3] }, "{x} {y}");
        }
    }
}

/// Corners of the triangles of a binary STL.
fn triangles(stl: &[u8]) -> Vec<[[f32; 3]; 3]> {
    assert!(!stl.starts_with(b"solid"));
    let number = |bytes: &[u8]| f32::from_le_bytes(bytes.try_into().unwrap());
    let triangles: Vec<_> = stl[84..].chunks(50).map(|t| [12, 24, 36].map(|i| [0, 4, 8].map(|k| number(&t[i + k..i + k + 4])))).collect();
    assert_eq!(triangles.len(), u32::from_le_bytes(stl[80..84].try_into().unwrap()) as usize);
    triangles
}

#[test]
fn an_stl_is_the_surface_of_the_model() {
    let folder = Folder::new();
    folder.put("m.csg", MODEL);
    folder.run("solid m.csg -o m.stl").done();
    let stl = folder.get("m.stl");
    assert_eq!(folder.run("solid m.csg --format stl").done(), stl);
    let sixth = |[a, b, c]: &[[f32; 3]; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    let volume: f32 = triangles(&stl).iter().map(|t| sixth(t) / 6.0).sum();
    assert!((volume - 840.0).abs() < 1e-3, "{volume}");
    // It is a model again, and looks the same.
    let [tree, mesh] = ["m.csg", "m.stl"].map(|name| folder.run(&format!("solid {name} {ABOVE} --format pbm")).done().to_vec());
    assert_eq!(tree, mesh);
    folder.run("solid m.stl -o again.STL --strict").done();
}

#[test]
fn an_stl_that_cannot_be_is_not_written() {
    let folder = Folder::new();
    let open = "polyhedron(points = [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], faces = [[0,1,2],[0,3,1],[0,2,3]]);";
    for (text, args, status, start) in [
        ("group();", "solid m.csg -o m.stl", 1, "m.csg: the model is empty"),
        ("difference() { cube(1); cube(1); }", "solid m.csg -o m.stl", 1, "m.csg: the model is empty"),
        (open, "solid m.csg -o m.stl --strict", 1, "m.csg:1:1: 3 open edges"),
        (MODEL, "solid m.csg -o m.stl --viewall", 2, "runset: --viewall is for pictures"),
        (MODEL, "solid m.csg -o m.stl --camera 0,0,9,0,0,0", 2, "runset: --camera is for pictures"),
        (MODEL, "solid m.csg -o m.stl --section 0,0,1,0", 2, "runset: --section is for pictures"),
        (r#"{"width":1,"height":1,"shapes":{},"expr":"page"}"#, "fill m.csg -o m.stl", 2, "runset: stl is for surfaces"),
    ] {
        folder.put("m.csg", text);
        let ran = folder.run(args);
        assert_eq!((ran.status, ran.stderr.lines().count()), (Some(status), 1), "{text} {args}: {}", ran.stderr);
        assert!(ran.stderr.starts_with(start), "{args}: {}", ran.stderr);
        assert!(!folder.path("m.stl").exists());
    }
}

#[test]
fn what_is_rendered_can_be_worked_out_first() {
    let folder = Folder::new();
    folder.put("m.csg", MODEL);
    folder.put("r.csg", format!("render(convexity = 1) {{ {MODEL} }}"));
    let picture = |args: &str| folder.run(&format!("solid {args} {ABOVE} --format pbm")).done().to_vec();
    let plain = picture("m.csg");
    for args in ["r.csg", "r.csg --evaluate", "m.csg --evaluate"] {
        assert_eq!(picture(args), plain, "{args}");
    }
    let stats = |args: &str| folder.run(&format!("solid {args} {ABOVE} --format pbm --stats")).stderr;
    // Ten faces: those of a cube and of the hole's four sides.
    assert!(stats("r.csg").contains("\"faces\":12,\"primitives\":2"), "{}", stats("r.csg"));
    assert!(stats("r.csg --evaluate").contains("\"faces\":10,\"primitives\":1"), "{}", stats("r.csg --evaluate"));
}

#[test]
fn formats_threads_and_streams_show_one_picture() {
    let folder = Folder::new();
    folder.put("m.csg", MODEL);
    folder.run("solid m.csg -o one.png --threads 1 --imgsize 200,150").done();
    folder.run("solid m.csg -o three.png --threads 3 --imgsize 200,150").done();
    assert_eq!(folder.get("one.png"), folder.get("three.png"));
    folder.run("solid m.csg -o m.ppm --imgsize 200,150").done();
    let picture = image::load_from_memory(&folder.get("one.png")).unwrap().into_rgb8();
    assert_eq!((picture.dimensions(), picture.get_pixel(0, 0).0), ((200, 150), [0xff, 0xff, 0xe5]));
    assert_eq!(folder.get("m.ppm"), [b"P6\n200 150\n255\n", &picture.as_raw()[..]].concat());
    for stream in ["m.rls", "m.ndjson"] {
        folder.run(&format!("solid m.csg -o {stream} --imgsize 200,150")).done();
        folder.run(&format!("convert {stream} -o again.ppm")).done();
        assert_eq!(folder.get("again.ppm"), folder.get("m.ppm"), "{stream}");
    }
    let ran = folder.run("solid m.csg -o m.png --stats");
    assert_eq!(ran.status, Some(0));
    let stats: serde_json::Value = serde_json::from_str(ran.stderr.lines().last().unwrap()).unwrap();
    assert_eq!((&stats["primitives"], &stats["faces"], &stats["height"]), (&2.into(), &12.into(), &512.into()), "{stats}");
    assert!(["spans", "depth_tests", "crossings"].iter().all(|key| stats[key].is_u64()), "{stats}");
}

#[test]
fn what_is_wrong_is_one_line_with_its_place() {
    let folder = Folder::new();
    for (text, args, status, start) in [
        ("cube(1); fooo();", "", 1, "m.csg:1:10: unknown module \"fooo\""),
        ("group();", "--strict", 1, "m.csg: the model is empty"),
        (MODEL, "--camera 1,2", 2, "runset: invalid value '1,2' for '--camera <NUMBERS>': give seven numbers"),
        (MODEL, "--camera 1,1,1,1,1,1", 2, "runset: invalid value '1,1,1,1,1,1' for '--camera <NUMBERS>': the eye is where it looks"),
        (MODEL, "--camera nan,0,0,1,1,1", 2, "runset: invalid value 'nan,0,0,1,1,1' for '--camera <NUMBERS>': give seven numbers"),
        (MODEL, "--camera 0,0,0,0,0,0,1e999", 2, "runset: invalid value '0,0,0,0,0,0,1e999' for '--camera <NUMBERS>': give seven numbers"),
        (
            MODEL,
            "--camera 0,0,0,0,0,0,-1",
            2,
            "runset: invalid value '0,0,0,0,0,0,-1' for '--camera <NUMBERS>': the last number is the distance",
        ),
        (MODEL, "--imgsize 0,5", 2, "runset: invalid value '0,5' for '--imgsize <W,H>': give a width"),
        (MODEL, "--antialias 9", 2, "runset: invalid value '9' for '--antialias <N>': give a whole number from 1 to 8"),
        (MODEL, "--antialias 2 --imgsize 600000,10", 2, "runset: antialias 2 takes a page of 1200000 x 20 px, and at most 1048576 x"),
        (MODEL, "--smooth 181", 2, "runset: invalid value '181' for '--smooth <ANGLE>': give an angle"),
        (MODEL, "--smooth 0", 2, "runset: the angle of smooth shading is out of range: give one above 0"),
        (MODEL, "--edges=x", 2, "runset: invalid value 'x' for '--edges[=<ANGLE>]': give an angle"),
        (MODEL, "--translucent 2-1", 2, "runset: invalid value '2-1' for '--translucent <ID>': give a primitive's number"),
        (MODEL, "--translucent 1-3", 2, "runset: there is no translucent part 3: give numbers from 1 to 2, in the order"),
        (MODEL, "--aov colour=x", 2, "runset: invalid value 'colour=x' for '--aov <WHAT=FILE>': give primitive"),
    ] {
        folder.put("m.csg", text);
        let ran = folder.run(&format!("solid m.csg -o m.png {args}"));
        assert_eq!((ran.status, ran.stderr.lines().count()), (Some(status), 1), "{text} {args}: {}", ran.stderr);
        assert!(ran.stderr.starts_with(start), "{args}: {}", ran.stderr);
        assert!(!folder.path("m.png").exists());
    }
}

#[test]
fn sections_take_away_the_side_that_their_normals_point_to() {
    let folder = Folder::new();
    folder.put("m.csg", MODEL);
    // By hand as above, in pixels of 2.486 units: without what is right of x = 0, and without what is above y = 0 as well.
    let shown = |sections: &str| {
        let out = folder.run(&format!("solid m.csg {ABOVE} --format pbm {sections}")).done().to_vec();
        let rows: Vec<u16> = out.strip_prefix(b"P4\n16 16\n").unwrap().chunks(2).map(|row| u16::from_be_bytes([row[0], row[1]])).collect();
        (rows[6], rows[7], rows[8], rows[9], rows.iter().map(|row| row.count_ones()).sum::<u32>())
    };
    assert_eq!(shown("--section 1,0,0,0"), (0b11 << 8, 0b10 << 8, 0b10 << 8, 0b11 << 8, 6));
    assert_eq!(shown("--section -2,0,0,0"), (0b11 << 6, 0b01 << 6, 0b01 << 6, 0b11 << 6, 6));
    assert_eq!(shown("--section 1,0,0,0 --section 0,1,0,0"), (0, 0, 0b10 << 8, 0b11 << 8, 3));
    assert_eq!(shown("--section 0,0,1,-6"), (0, 0, 0, 0, 0), "nothing is left");
    // The cap at z = 2 is 98 away.
    folder.run(&format!("solid m.csg {ABOVE} --section 0,0,3,6 -o m.pbm --aov depth=d.pfm")).done();
    let depths = folder.get("d.pfm");
    let near = depths.strip_prefix(b"Pf\n16 16\n-1.0\n").unwrap().chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap()));
    let near: Vec<f32> = near.filter(|depth| depth.is_finite()).collect();
    assert!(near.len() == 12 && near.iter().all(|depth| (depth - 98.0).abs() < 1e-4), "{near:?}");
    for (section, what) in [
        ("0,0,0,1", "a, b and c are all 0, so there is no plane: give the direction of the side that is taken away"),
        ("0,0,1", "give four numbers a,b,c,d, such as 0,0,1,5: what is at a x + b y + c z <= d stays"),
        ("0,0,inf,1", "give four numbers a,b,c,d, such as 0,0,1,5: what is at a x + b y + c z <= d stays"),
    ] {
        let line = format!("runset: invalid value '{section}' for '--section <A,B,C,D>': {what} (see runset solid --help)");
        folder.run(&format!("solid m.csg --section {section} -o n.png")).refused(2, &line);
    }
    let many = "--section 0,0,1,5 ".repeat(17);
    folder.run(&format!("solid m.csg {many} -o n.png")).refused(2, "runset: 17 sections: give at most 16 (see runset solid --help)");
}

/// The colours of some pixels.
fn shown<const N: usize>(folder: &Folder, options: &str, pixels: [(usize, usize); N]) -> [[u8; 3]; N] {
    let out = folder.run(&format!("solid m.csg {ABOVE} --format ppm {options}")).done().to_vec();
    let rgb = out.strip_prefix(b"P6\n16 16\n255\n").unwrap();
    pixels.map(|(x, y)| rgb[3 * (16 * y + x)..][..3].try_into().unwrap())
}

/// Light meets what faces the camera at a cosine of 0.75 / 1.07; 0.35 + 0.65 of that is how bright it is: 0.8056.
#[test]
fn glass_and_means_by_hand() {
    let folder = Folder::new();
    let (paper, top) = ([255, 255, 229], [201, 173, 35]);
    folder.put("m.csg", MODEL);
    let pixels = [(7, 7), (6, 7), (3, 3)];
    assert_eq!(shown(&folder, "", pixels), [paper, top, paper]);
    // In the hole: top and bottom of what is cut away, and of what cuts. Each leaves 0.7 of what is behind it.
    let cut = [214, 193, 82];
    assert_eq!(shown(&folder, "--glass", pixels), [cut, top, paper]);
    // The hole is from 7.1955 to 8.8045: 9 of 16 finer pixels.
    assert_eq!(shown(&folder, "--antialias 4", pixels), [[231, 219, 144], top, paper]);

    // A red sheet of 8.04 px over the cube.
    let sheet = "color([1, 0, 0, 1]) { multmatrix([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 20], [0, 0, 0, 1]]) { cube(size = [20, 20, 2], center = true); } }";
    folder.put("m.csg", format!("cube(size = [10, 10, 10], center = true);\n{sheet}\n"));
    let pixels = [(7, 7), (4, 4), (3, 3)];
    assert_eq!(shown(&folder, "", pixels), [[205, 0, 0], [205, 0, 0], paper]);
    assert_eq!(shown(&folder, "--translucent 2", pixels), [[203, 85, 17], [230, 125, 112], paper]);
}

#[test]
fn edges_by_hand() {
    let folder = Folder::new();
    folder.put("m.csg", MODEL);
    let out = folder.run(&format!("solid m.csg {ABOVE} --format ppm --edges")).done().to_vec();
    let rgb = out.strip_prefix(b"P6\n16 16\n255\n").unwrap();
    let rows: Vec<String> = rgb
        .chunks(48)
        .map(|row| {
            row.chunks(3)
                .map(|pixel| {
                    if pixel == [0; 3] {
                        '#'
                    } else if pixel == [201, 173, 35] {
                        'o'
                    } else {
                        '.'
                    }
                })
                .collect()
        })
        .collect();
    let expected = ["......#####.....", "......#####.....", "......##.##.....", "......###o#.....", "......####......"];
    assert_eq!(rows[6..11], expected);
    assert!(rows[..6].iter().chain(&rows[11..]).all(|row| row == "................"), "{rows:?}");
}

#[test]
fn several_cameras_make_several_pictures() {
    let folder = Folder::new();
    folder.put("m.csg", MODEL);
    let cameras = ["0,0,0,55,0,0,99", "0,0,0,55,0,90,99", "20,30,40,0,0,0"];
    let asked: Vec<_> = cameras.iter().map(|camera| format!("--camera {camera}")).collect();
    let asked = asked.join(" ");
    let ran = folder.run(&format!("solid m.csg {asked} --imgsize 50,40 -o v-%02d.ppm --aov depth=d%d.pfm --stats"));
    assert_eq!((ran.status, ran.stderr.lines().filter(|line| line.starts_with('{')).count()), (Some(0), 3), "{}", ran.stderr);
    for (camera, n) in cameras.iter().zip(1..) {
        folder.run(&format!("solid m.csg --camera {camera} --imgsize 50,40 -o one.ppm --aov depth=one.pfm")).done();
        assert_eq!(folder.get(&format!("v-0{n}.ppm")), folder.get("one.ppm"), "{camera}");
        assert_eq!(folder.get(&format!("d{n}.pfm")), folder.get("one.pfm"), "{camera}");
    }
    folder.run("solid m.csg --imgsize 50,40 -o 100%d.ppm").done();
    assert!(folder.path("1001.ppm").exists(), "one view has a number too");
    for (output, name) in [("", "<stdout>"), ("-o n.png", "n.png"), ("-o n%3d.png", "n%3d.png"), ("-o n%d.png --aov depth=n.pfm", "n.pfm")]
    {
        let what = "is one output: put %d or %03d into its name, for the number of the camera (see runset solid --help)";
        folder.run(&format!("solid m.csg {asked} {output}")).refused(2, &format!("runset: 3 cameras, and {name} {what}"));
    }
    assert!(folder.names().iter().all(|name| !name.starts_with('n')), "{:?}", folder.names());
}

#[test]
fn slices_are_what_the_whole_holds_there() {
    let folder = Folder::new();
    folder.put("m.csg", MODEL);
    let view = "--imgsize 60,50 --section 1,1,0,2";
    folder.run(&format!("solid m.csg {view} -o whole.ppm --aov primitive=whole.pgm --aov depth=whole.pfm")).done();
    folder.run(&format!("solid m.csg {view} --lines 13..31 -o part.ppm --aov primitive=part.pgm --aov depth=part.pfm")).done();
    for (name, head, pixel) in [("ppm", "P6\n60 H\n255\n", 3), ("pgm", "P5\n60 H\n65535\n", 2), ("pfm", "Pf\n60 H\n-1.0\n", 4)] {
        let rows = |file: &str, height: usize| {
            let bytes = folder.get(&format!("{file}.{name}"));
            let rows = bytes.strip_prefix(head.replace('H', &height.to_string()).as_bytes()).unwrap().to_vec();
            assert_eq!(rows.len(), height * 60 * pixel, "{file}.{name}");
            rows
        };
        let (whole, part) = (rows("whole", 50), rows("part", 18));
        // A PFM begins with the bottom row.
        let first = if name == "pfm" { 50 - 31 } else { 13 };
        assert!(whole[first * 60 * pixel..][..part.len()] == part, "{name}");
    }
    folder
        .run("solid m.csg --lines 3..513 -o n.png")
        .refused(2, "runset: lines 3..513 are not on the page: it has 512 lines, 0..512 (see runset solid --help)");
}
