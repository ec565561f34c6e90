//! Colours of faces.
//!
//! A face that is flat has one colour: that of its part, as bright as the angle at which light from the camera's upper left meets it. Where a part that is taken away has left its
//! surface, that is shown in the part's own colour, or in the scheme's colour for cuts if it has none.

use glam::DVec3;

use super::stage::Stage;
use super::view::View;
use crate::mesh::Origin;
use crate::run::Rgb;

/// Colours of what has none of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scheme {
    /// Its name, as OpenSCAD has it.
    pub name: &'static str,
    /// Where nothing is.
    pub background: Rgb,
    /// Surfaces.
    pub front: Rgb,
    /// Surfaces that were cut.
    pub back: Rgb,
}

macro_rules! schemes {
    ($($name:literal $background:literal $front:literal $back:literal;)*) => {
        &[$(Scheme { name: $name, background: rgb($background), front: rgb($front), back: rgb($back) }),*]
    };
}

/// The channels of 0xRRGGBB.
pub(super) const fn rgb(value: u32) -> Rgb {
    let [_, r, g, b] = value.to_be_bytes();
    [r, g, b]
}

/// OpenSCAD's colour schemes; the first is the default.
pub const SCHEMES: &[Scheme] = schemes! {
    "Cornfield"      0xffffe5 0xf9d72c 0x9dcb51;
    "Metallic"       0xaaaaff 0xddddff 0xdd22dd;
    "Sunset"         0xaa4444 0xffaaaa 0x882233;
    "Starnight"      0x000000 0xffffe0 0x00ffff;
    "BeforeDawn"     0x333333 0xcccccc 0x5563dd;
    "Nature"         0xfafafa 0x16a085 0xdbf4da;
    "DeepOcean"      0x333333 0xeeeeee 0x0babc8;
    "Solarized"      0xfdf6e3 0xb58800 0x882233;
    "Tomorrow"       0xf8f8f8 0x4271ae 0xf5871f;
    "Tomorrow Night" 0x1d1f21 0x81a2be 0xde935f;
    "Monotone"       0xffffe5 0xf9d72c 0xf9d72c;
};

/// How bright a face is that no light meets.
const AMBIENT: f64 = 0.35;

/// Where light comes from, in the camera's coordinates: right, down, forward.
const LIGHT: DVec3 = DVec3::new(-0.4, -0.65, -0.75);

/// Where light comes from, as a unit vector in the model's coordinates.
pub fn light(view: &View) -> DVec3 {
    let [right, down, forward] = view.axes;
    (right * LIGHT.x + down * LIGHT.y + forward * LIGHT.z).normalize()
}

/// A colour in light that meets its surface at an angle with this cosine, as 0xRRGGBB.
pub fn lit(colour: Rgb, cosine: f64) -> u32 {
    let bright = AMBIENT + (1.0 - AMBIENT) * cosine.max(0.0);
    let [r, g, b] = colour.map(|c| (f64::from(c) * bright).round() as u32);
    r << 16 | g << 8 | b
}

/// The colours of a stage's faces, seen from outside and from inside of their parts.
#[derive(Clone, Debug)]
pub struct Colours {
    /// Of the faces, lit as planes.
    faces: Vec<[u32; 2]>,
    /// Of the parts, in no light.
    parts: Vec<[Rgb; 2]>,
}

impl Colours {
    /// The colours of all faces of a stage whose parts have these, or none of their own.
    pub fn new(stage: &Stage, parts: &[Option<Rgb>], scheme: &Scheme) -> Colours {
        let light = LIGHT.normalize();
        let parts: Vec<[Rgb; 2]> = parts.iter().map(|own| [own.unwrap_or(scheme.front), own.unwrap_or(scheme.back)]).collect();
        let colours = stage.faces.iter().map(|face| {
            let normal = stage.planes[face.plane as usize].normal;
            let [right, down, forward] = stage.view.axes;
            let normal = DVec3::new(right.dot(normal), down.dot(normal), forward.dot(normal));
            // What is seen of a plane is turned to the eye, whichever side that is.
            let toward = if stage.is_toward(face.plane) { normal } else { -normal };
            let sides = parts[face.origin.part as usize];
            [false, true].map(|inside| lit(sides[usize::from(inside != face.origin.turned)], toward.dot(light)))
        });
        Colours { faces: colours.collect(), parts }
    }

    /// The colour of a face, as 0xRRGGBB.
    #[inline]
    pub fn of(&self, face: u32, inside: bool) -> u32 {
        self.faces[face as usize][usize::from(inside)]
    }

    /// About how many bytes they hold.
    pub fn weight(&self) -> usize {
        size_of_val(&self.faces[..]) + size_of_val(&self.parts[..])
    }

    /// The colour of a part's surface, in no light.
    #[inline]
    pub fn of_part(&self, origin: Origin, inside: bool) -> Rgb {
        self.parts[origin.part as usize][usize::from(inside != origin.turned)]
    }
}
