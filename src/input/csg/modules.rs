//! The modules that a `.csg` can name, and their parameters in OpenSCAD's order.

/// What a module does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Union,
    Render,
    Difference,
    Intersection,
    Matrix,
    Color,
    Cube,
    Sphere,
    Cylinder,
    Polyhedron,
    LinearExtrude,
    RotateExtrude,
    Projection,
    Hull,
    Square,
    Circle,
    Polygon,
    Import,
    /// Named in a warning and left out.
    Unsupported,
}

/// A module.
pub(super) struct Module {
    pub(super) name: &'static str,
    pub(super) kind: Kind,
    /// The first of them may be given without their names.
    pub(super) parameters: &'static [&'static str],
}

macro_rules! modules {
    ($($name:literal $kind:ident $parameters:expr;)*) => {
        /// All modules.
        pub(super) const MODULES: &[Module] = &[$(Module { name: $name, kind: Kind::$kind, parameters: &$parameters }),*];
    };
}

modules! {
    "group" Union [];
    "union" Union [];
    "render" Render ["convexity"];
    "difference" Difference [];
    "intersection" Intersection [];
    "multmatrix" Matrix ["m"];
    "color" Color ["c", "alpha"];
    "cube" Cube ["size", "center"];
    "sphere" Sphere ["r", "d"];
    "cylinder" Cylinder ["h", "r1", "r2", "center", "r", "d", "d1", "d2"];
    "polyhedron" Polyhedron ["points", "faces", "convexity", "triangles"];
    "linear_extrude" LinearExtrude ["height", "center", "convexity", "twist", "slices", "scale"];
    "rotate_extrude" RotateExtrude ["angle", "convexity"];
    "projection" Projection ["cut", "convexity"];
    "hull" Hull [];
    "square" Square ["size", "center"];
    "circle" Circle ["r", "d"];
    "polygon" Polygon ["points", "paths", "convexity"];
    "import" Import ["file", "layer", "convexity", "origin", "scale", "timestamp"];
    "minkowski" Unsupported ["convexity"];
    "text" Unsupported [];
    "surface" Unsupported [];
    "resize" Unsupported [];
    "offset" Unsupported [];
    "roof" Unsupported [];
    "fill" Unsupported [];
}
