//! The resolved drawing, walked into shapes, areas and layers.
//!
//! `usvg` gives a tree of groups and paths: coordinates and matrices in 32-bit, which are kept as they are and multiplied in
//! 64-bit on the way down. Shapes are numbered in painting order, so what a group holds is a range of them. A stroke is a shape of its own beside the
//! fill; text arrives as a group of the outlines of its glyphs.

use std::collections::HashMap;
use std::ops::Range;

use usvg::tiny_skia_path::PathSegment;
use usvg::{BlendMode, Group, LineCap, LineJoin, Node, Opacity, Paint, PaintOrder};

use super::notes::{Element, Notes};
use super::text;
use crate::error::{Error, Kind, Result};
use crate::grid::Point;
use crate::input::finite;
use crate::run::Rgb;
use crate::scene::{Area, Layer, Limits, Picture, Scene};
use crate::shape::{Cap, FillRule, Join, Path, Shape, Stroke, Transform};

/// What stands for a pattern.
const PATTERN: Rgb = [0x80; 3];

/// A drawing without the names of its areas.
pub(super) struct Walked<'t> {
    pub(super) scene: Scene,
    /// What was drawn under an id that `usvg` kept; of equal ones the first.
    pub(super) drawn: HashMap<&'t str, Drawn>,
}

/// An area and the shapes that it is made of.
#[derive(Clone)]
pub(super) struct Drawn {
    pub(super) area: Area,
    pub(super) shapes: Range<u32>,
}

/// Walks a drawing, with an explicit stack.
pub(super) fn walk<'t>(drawing: &'t usvg::Tree, limits: &Limits, notes: &mut Notes<'_>) -> Result<Walked<'t>> {
    let size = drawing.size();
    let scene = Scene::new(f64::from(size.width()), f64::from(size.height()));
    let mut walk = Walk { walked: Walked { scene, drawn: HashMap::new() }, limits, notes, areas: Vec::new(), layers: Vec::new(), verbs: 0 };
    let none = Element { id: "", own: false };
    let mut way = vec![walk.enter(drawing.root(), [1.0, 0.0, 0.0, 1.0, 0.0, 0.0], none)];
    while let Some(step) = way.last_mut() {
        match step.children.next() {
            Some(Node::Group(group)) if group.opacity().get() > 0.0 => {
                let inner = walk.enter(group, step.transform, step.element);
                way.push(inner);
            }
            Some(Node::Path(path)) => walk.path(path, step.transform, step.element)?,
            Some(Node::Text(text)) => {
                let element = element(text.id(), step.element);
                text::note(text, drawing.fontdb(), element, walk.notes);
                let inner = walk.enter(text.flattened(), step.transform, step.element);
                way.push(inner);
            }
            // `usvg` is given no images: this one is from a font.
            Some(Node::Image(_)) => walk.notes.add(step.element, "characters that a font has as images only are not drawn"),
            // Invisible.
            Some(Node::Group(_)) => {}
            None => {
                let done = way.pop().expect("there was a last step");
                walk.leave(&done);
            }
        }
    }
    Ok(walk.end())
}

struct Walk<'t, 'l, 'w, 'n> {
    walked: Walked<'t>,
    limits: &'l Limits,
    notes: &'n mut Notes<'w>,
    /// Areas drawn so far that no group with an id has taken in.
    areas: Vec<Area>,
    /// Inks with what they paint, in painting order.
    layers: Vec<(Rgb, Vec<Area>)>,
    verbs: u64,
}

/// A group on the way.
struct Step<'t> {
    children: std::slice::Iter<'t, Node>,
    id: &'t str,
    element: Element<'t>,
    transform: [f64; 6],
    first_area: usize,
    first_shape: u32,
}

impl<'t> Walk<'t, '_, '_, '_> {
    fn enter(&mut self, group: &'t Group, outer: [f64; 6], parent: Element<'t>) -> Step<'t> {
        let element = element(group.id(), parent);
        let reasons = [
            (group.opacity().get() < 1.0, "transparency is not drawn yet: painted opaque"),
            (group.blend_mode() != BlendMode::Normal, "blend modes are not drawn yet: painted opaque"),
            (group.clip_path().is_some(), "clip paths do not clip yet"),
            (group.mask().is_some(), "masks do not mask yet"),
            (!group.filters().is_empty(), "filters are not drawn yet"),
        ];
        reasons.iter().filter(|r| r.0).for_each(|r| self.notes.add(element, r.1));
        let t = group.transform();
        Step {
            children: group.children().iter(),
            id: group.id(),
            element,
            transform: product(outer, [t.sx, t.ky, t.kx, t.sy, t.tx, t.ty].map(f64::from)),
            first_area: self.areas.len(),
            first_shape: self.shapes(),
        }
    }

    /// A group with an id is one area to what is around it.
    fn leave(&mut self, step: &Step<'t>) {
        if !step.id.is_empty() {
            let parts = self.areas.split_off(step.first_area);
            let area = self.union(&parts);
            self.areas.push(area);
            self.name(step.id, area, step.first_shape);
        }
    }

    fn path(&mut self, path: &'t usvg::Path, transform: [f64; 6], parent: Element<'t>) -> Result<()> {
        if !path.is_visible() {
            return Ok(());
        }
        let element = element(path.id(), parent);
        let (first_area, first_shape) = (self.areas.len(), self.shapes());
        let name = if element.own { element.id.to_owned() } else { element.named() };
        let shape = Shape { transform: Transform::Affine(transform), ..Shape::new(name, outline(path)) };
        let fill = path.fill().map(|fill| {
            let rule = match fill.rule() {
                usvg::FillRule::NonZero => FillRule::NonZero,
                usvg::FillRule::EvenOdd => FillRule::EvenOdd,
            };
            (Shape { rule, ..shape.clone() }, fill.paint(), fill.opacity())
        });
        let stroke = path.stroke().map(|line| (Shape { stroke: Some(stroke(line)), ..shape }, line.paint(), line.opacity()));
        let order = match path.paint_order() {
            PaintOrder::FillAndStroke => [fill, stroke],
            PaintOrder::StrokeAndFill => [stroke, fill],
        };
        for (shape, paint, opacity) in order.into_iter().flatten() {
            self.paint(shape, paint, opacity, element)?;
        }
        if !path.id().is_empty() && self.shapes() > first_shape {
            let parts = self.areas.split_off(first_area);
            let area = self.union(&parts);
            self.areas.push(area);
            self.name(path.id(), area, first_shape);
        }
        Ok(())
    }

    /// Adds a shape and paints it on what is there.
    fn paint(&mut self, shape: Shape, paint: &Paint, opacity: Opacity, element: Element<'_>) -> Result<()> {
        if opacity.get() == 0.0 {
            return Ok(());
        }
        if opacity.get() < 1.0 {
            self.notes.add(element, "transparency is not drawn yet: painted opaque");
        }
        let ink = self.ink(paint, element);
        let area = self.shape(shape, element)?;
        self.areas.push(area);
        match self.layers.last_mut() {
            Some((last, areas)) if *last == ink => areas.push(area),
            _ => self.layers.push((ink, vec![area])),
        }
        Ok(())
    }

    fn shape(&mut self, shape: Shape, element: Element<'_>) -> Result<Area> {
        if !finite(&shape) {
            let what = format!("{}: its transform takes it out of the range of 64-bit numbers: use smaller ones", element.named());
            return Err(Error::input(Kind::Refused, what));
        }
        self.verbs += shape.path.verbs().len() as u64;
        if self.verbs > self.limits.edges || u64::from(self.shapes()) >= self.limits.nodes {
            let what = format!("more than {} shapes or {} lines and curves: split the drawing", self.limits.nodes, self.limits.edges);
            return Err(Error::input(Kind::Limit, what));
        }
        Ok(self.walked.scene.add_shape(shape))
    }

    /// The flat colour of a paint, or what stands for it.
    fn ink(&mut self, paint: &Paint, element: Element<'_>) -> Rgb {
        let gradient = match paint {
            Paint::Color(c) => return [c.red, c.green, c.blue],
            Paint::Pattern(_) => {
                self.notes.add(element, "patterns are not drawn yet: filled with #808080");
                return PATTERN;
            }
            Paint::LinearGradient(g) => g.stops(),
            Paint::RadialGradient(g) => g.stops(),
        };
        let ink = gradient.first().map_or(PATTERN, |s| [s.color().red, s.color().green, s.color().blue]);
        let [r, g, b] = ink;
        self.notes.add(element, format!("gradients are not drawn yet: filled with the first stop's #{r:02x}{g:02x}{b:02x}"));
        ink
    }

    fn end(mut self) -> Walked<'t> {
        let parts = std::mem::take(&mut self.areas);
        self.walked.scene.art = self.union(&parts);
        let layers = std::mem::take(&mut self.layers);
        self.walked.scene.picture =
            Picture::Layers(layers.into_iter().map(|(ink, parts)| Layer { area: self.union(&parts), ink }).collect());
        self.walked
    }

    fn union(&mut self, parts: &[Area]) -> Area {
        if let [one] = parts { *one } else { self.walked.scene.formula.any(parts) }
    }

    fn name(&mut self, id: &'t str, area: Area, first_shape: u32) {
        let shapes = first_shape..self.shapes();
        self.walked.drawn.entry(id).or_insert(Drawn { area, shapes });
    }

    fn shapes(&self) -> u32 {
        self.walked.scene.shapes.len() as u32
    }
}

fn element<'t>(id: &'t str, parent: Element<'t>) -> Element<'t> {
    if id.is_empty() { Element { own: false, ..parent } } else { Element { id, own: true } }
}

/// The map that applies `inner` first, in SVG's order of the six numbers.
pub(super) fn product(outer: [f64; 6], inner: [f64; 6]) -> [f64; 6] {
    let ([a, b, c, d, e, f], [g, h, i, j, k, l]) = (outer, inner);
    [a * g + c * h, b * g + d * h, a * i + c * j, b * i + d * j, a * k + c * l + e, b * k + d * l + f]
}

fn stroke(line: &usvg::Stroke) -> Stroke {
    Stroke {
        width: f64::from(line.width().get()),
        join: match line.linejoin() {
            LineJoin::Miter => Join::Miter,
            LineJoin::MiterClip => Join::MiterClip,
            LineJoin::Round => Join::Round,
            LineJoin::Bevel => Join::Bevel,
        },
        cap: match line.linecap() {
            LineCap::Butt => Cap::Butt,
            LineCap::Round => Cap::Round,
            LineCap::Square => Cap::Square,
        },
        miter_limit: f64::from(line.miterlimit().get()),
        dashes: line.dasharray().unwrap_or_default().iter().copied().map(f64::from).collect(),
        dash_offset: f64::from(line.dashoffset()),
    }
}

fn outline(path: &usvg::Path) -> Path {
    let point = |p: usvg::tiny_skia_path::Point| -> Point { [f64::from(p.x), f64::from(p.y)] };
    let mut outline = Path::default();
    for segment in path.data().segments() {
        match segment {
            PathSegment::MoveTo(p) => outline.move_to(point(p)),
            PathSegment::LineTo(p) => outline.line_to(point(p)),
            PathSegment::QuadTo(c, p) => outline.quad_to(point(c), point(p)),
            PathSegment::CubicTo(c, d, p) => outline.cubic_to(point(c), point(d), point(p)),
            PathSegment::Close => outline.close(),
        }
    }
    outline
}
