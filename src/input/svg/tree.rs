//! The resolved drawing, walked into shapes, areas and layers.
//!
//! `usvg` gives a tree of groups and paths: coordinates and matrices in 32-bit, which are kept as they are, but for those that it multiplies itself
//! ([`super::viewport`]), and multiplied in 64-bit on the way down. What clips or masks a group is an area too ([`super::cut`]): a [`Part`] of the drawing is where a shape is
//! filled, together with the area that all groups around it are cut to.
//!
//! One loop with an explicit stack walks the drawing, the clip paths and the masks. What paints is kept in a [`Sink`], one for the
//! drawing and one for each clip path or mask under way, which is walked before the group that it cuts. A stroke is a shape of its own beside
//! the fill; text arrives as a group of the outlines of its glyphs.

use std::iter::Peekable;
use std::sync::Arc;

use foldhash::HashMap;
use usvg::{BlendMode, Group, MaskType, Node, PaintOrder};

use super::cut::{Cuts, Cutter, Key};
use super::drawn::{Drawn, Walked};
use super::geometry::{IDENTITY, matrix, outline, product, stroke};
use super::ink;
use super::notes::{Element, Notes};
use super::parts::{Part, Sink, closed, joined};
use super::tags::Tags;
use super::text;
use super::viewport::Viewport;
use crate::error::{Error, Kind, Result};
use crate::input::finite;
use crate::scene::{Area, Layer, Limits, Picture, Scene};
use crate::shape::{FillRule, Path, Shape, Transform};

/// Walks a drawing. `page` is the viewport of its root element.
pub(super) fn walk<'t>(
    drawing: &'t usvg::Tree,
    page: Option<&'t Viewport>,
    tags: &'t Tags,
    limits: &Limits,
    notes: &mut Notes,
) -> Result<Walked<'t>> {
    let size = [drawing.size().width(), drawing.size().height()].map(f64::from);
    let [width, height] = page.map_or(size, |page| page.page(size));
    let scene = Scene::new(width, height);
    let walked = Walked { scene, drawn: HashMap::default(), paints: Vec::new() };
    let mut walk = Walk { walked, tags, limits, notes, sinks: vec![Sink::default()], cuts: Cuts::default(), verbs: 0 };
    let root = drawing.root();
    let outside = Step::new(root, IDENTITY, Element { id: "", own: false });
    let mut way = vec![Step { page, ..walk.enter(root, matrix(root.transform()), &outside) }];
    while let Some(step) = way.last_mut() {
        match step.children.peek().copied() {
            Some(Node::Group(group)) => {
                let transform = walk.transform(group, step);
                if walk.opacity(group) == 0.0 {
                    step.children.next();
                } else if let Some(cutter) = walk.cuts.missing(group, transform) {
                    let inner = walk.open(cutter, transform, group, step);
                    way.push(inner);
                } else {
                    let inner = walk.enter(group, transform, step);
                    step.children.next();
                    way.push(inner);
                }
            }
            Some(Node::Path(path)) => {
                walk.path(path, step)?;
                step.children.next();
            }
            Some(Node::Text(text)) => {
                text::note(text, drawing.fontdb(), element(text.id(), step.element), walk.notes);
                let transform = walk.transform(text.flattened(), step);
                let inner = walk.enter(text.flattened(), transform, step);
                step.children.next();
                way.push(inner);
            }
            Some(Node::Image(_)) => {
                // `usvg` is given no images: this one is from a font.
                walk.notes.add(step.element, "characters that a font has as images only are not drawn");
                step.children.next();
            }
            None => {
                let done = way.pop().expect("there was a last step");
                walk.leave(&done)?;
            }
        }
    }
    Ok(walk.end())
}

struct Walk<'t, 'l, 'n> {
    walked: Walked<'t>,
    tags: &'t Tags,
    limits: &'l Limits,
    notes: &'n mut Notes,
    sinks: Vec<Sink>,
    cuts: Cuts,
    verbs: u64,
}

/// A group on the way.
struct Step<'t> {
    children: Peekable<std::slice::Iter<'t, Node>>,
    /// Its ids; empty where there are fewer.
    ids: [&'t str; 3],
    element: Element<'t>,
    transform: [f64; 6],
    /// The viewport of the page, if the next group is the one that `usvg` puts all into.
    page: Option<&'t Viewport>,
    /// The nearest `use` around.
    user: Option<&'t Viewport>,
    cut: Option<Area>,
    /// Product of the opacities of this group and those around it, which counts in masks.
    opacity: f32,
    first_part: usize,
    first_paint: usize,
    /// Whether a shape in it without an id of its own is its element.
    shape: bool,
    /// The outline of the path in it, if `usvg` has a stand-in.
    outline: Option<&'t Arc<Path>>,
    /// The clip path or mask of which this is the root.
    cutter: Option<(Cutter<'t>, Key)>,
}

impl<'t> Step<'t> {
    /// A group that nothing is known of yet.
    fn new(group: &'t Group, transform: [f64; 6], element: Element<'t>) -> Step<'t> {
        let children = group.children().iter().peekable();
        Step {
            children,
            ids: [""; 3],
            element,
            transform,
            page: None,
            user: None,
            cut: None,
            opacity: 1.0,
            first_part: 0,
            first_paint: 0,
            shape: false,
            outline: None,
            cutter: None,
        }
    }
}

impl<'t> Walk<'t, '_, '_> {
    /// The opacity that a group has for those who look at it.
    fn opacity(&self, group: &Group) -> f32 {
        self.tags.of(group.opacity()).map_or(group.opacity().get(), |tag| tag.opacity)
    }

    /// The element that a group stands for: one with the group's id, or the only shape in it, around which `usvg` put the group.
    fn element(&self, group: &'t Group, outer: Element<'t>) -> Element<'t> {
        let tagged = self.tags.of(group.opacity()).map_or("", |tag| &tag.id);
        let only = if let [Node::Path(path)] = group.children() { path.id() } else { "" };
        let id = [tagged, group.id(), only].into_iter().find(|id| !id.is_empty());
        element(id.unwrap_or_default(), outer)
    }

    /// The full transform of a group.
    fn transform(&self, group: &Group, outer: &Step<'t>) -> [f64; 6] {
        let viewport = self.tags.of(group.opacity()).and_then(|tag| tag.viewport.as_deref()).or(outer.page);
        let own = matrix(group.transform());
        product(outer.transform, viewport.map_or(own, |viewport| viewport.refined(own, outer.user)))
    }

    /// A group whose clip path and mask are known, under its full transform.
    fn enter(&mut self, group: &'t Group, transform: [f64; 6], outer: &Step<'t>) -> Step<'t> {
        let tag = self.tags.of(group.opacity());
        let [own, marker] = tag.map_or(["", ""], |tag| [if tag.first { &*tag.id } else { "" }, &*tag.marker]);
        let element = self.element(group, outer.element);
        let reasons = [
            (self.opacity(group) < 1.0 && self.sink().mask.is_none(), "transparency is not drawn yet: painted opaque"),
            (group.blend_mode() != BlendMode::Normal, "blend modes are not drawn yet: painted opaque"),
            (!group.filters().is_empty(), "filters are not drawn yet"),
        ];
        reasons.iter().filter(|r| r.0).for_each(|r| self.notes.add(element, r.1));
        Step {
            user: tag.and_then(|tag| tag.viewport.as_ref()?.user()).or(outer.user),
            ids: [group.id(), if own == group.id() { "" } else { own }, marker],
            cut: self.cuts.of(group, transform, outer.cut, &mut self.walked.scene.formula),
            opacity: outer.opacity * self.opacity(group),
            first_part: self.sink().parts.len(),
            first_paint: self.walked.paints.len(),
            shape: tag.is_some_and(|tag| tag.shape),
            outline: tag.and_then(|tag| tag.outline.as_ref()),
            ..Step::new(group, transform, element)
        }
    }

    /// The root of a clip path or mask, as seen from the group that it cuts.
    fn open(&mut self, cutter: Cutter<'t>, transform: [f64; 6], group: &'t Group, outer: &Step<'t>) -> Step<'t> {
        let (root, inner, mask) = match cutter {
            Cutter::Clip(clip) => (clip.root(), matrix(clip.transform()), None),
            Cutter::Mask(mask) => (mask.root(), IDENTITY, Some(mask.kind())),
        };
        self.sinks.push(Sink { mask, ..Sink::default() });
        let element = match cutter {
            Cutter::Clip(_) => self.element(group, outer.element),
            Cutter::Mask(mask) => Element { id: mask.id(), own: false },
        };
        Step { cutter: Some((cutter, cutter.key(transform))), ..Step::new(root, product(transform, inner), element) }
    }

    fn leave(&mut self, step: &Step<'t>) -> Result<()> {
        if let Some((cutter, key)) = step.cutter {
            let sink = self.sinks.pop().expect("a cutter has its own sink");
            let frame = match cutter {
                Cutter::Mask(mask) => Some(self.frame(mask, step)?),
                Cutter::Clip(_) => None,
            };
            self.cuts.add(cutter, key, sink, frame, &mut self.walked.scene.formula);
        } else {
            self.name(step.ids, step.first_part, step.first_paint);
        }
        Ok(())
    }

    /// The rectangle that a mask ends at.
    fn frame(&mut self, mask: &usvg::Mask, step: &Step<'t>) -> Result<Area> {
        let [x, y, right, bottom] = [mask.rect().x(), mask.rect().y(), mask.rect().right(), mask.rect().bottom()].map(f64::from);
        let mut path = Path::default();
        path.ring(&[[x, y], [right, y], [right, bottom], [x, bottom]]);
        let name = step.element.named();
        self.shape(Shape { transform: Transform::Affine(step.transform), ..Shape::new(name, path) }, step.element)
    }

    fn path(&mut self, path: &'t usvg::Path, step: &Step<'t>) -> Result<()> {
        if !path.is_visible() {
            return Ok(());
        }
        let element = if path.id().is_empty() && step.shape { step.element } else { element(path.id(), step.element) };
        let (first_part, first_paint) = (self.sink().parts.len(), self.walked.paints.len());
        let outline = step.outline.map_or_else(|| Arc::new(outline(path)), Arc::clone);
        let name = if element.own { element.id.to_owned() } else { element.named() };
        let shape = Shape { transform: Transform::Affine(step.transform), ..Shape::new(name, outline) };
        let fill = path.fill().map(|fill| {
            let rule = match fill.rule() {
                usvg::FillRule::NonZero => FillRule::NonZero,
                usvg::FillRule::EvenOdd => FillRule::EvenOdd,
            };
            let opacity = self.tags.of(fill.opacity()).map_or(fill.opacity().get(), |tag| tag.opacity);
            (Shape { rule, ..shape.clone() }, fill.paint(), opacity)
        });
        let stroke = path.stroke().map(|line| {
            let opacity = self.tags.of(line.opacity()).map_or(line.opacity().get(), |tag| tag.stroke_opacity);
            (Shape { stroke: Some(stroke(line)), ..shape }, line.paint(), opacity)
        });
        let order = match path.paint_order() {
            PaintOrder::FillAndStroke => [fill, stroke],
            PaintOrder::StrokeAndFill => [stroke, fill],
        };
        for (shape, paint, opacity) in order.into_iter().flatten() {
            self.paint(shape, paint, opacity, element, step)?;
        }
        // The parts of a text have no groups of their own.
        let part = path.fill().and_then(|f| self.tags.of(f.opacity())).or(path.stroke().and_then(|s| self.tags.of(s.opacity())));
        let id = if step.ids.contains(&path.id()) { "" } else { path.id() };
        for tag in part.into_iter().flat_map(|part| self.tags.and_around(part)).filter(|tag| tag.first) {
            self.name([&tag.id, "", ""], first_part, first_paint);
        }
        self.name([id, "", ""], first_part, first_paint);
        Ok(())
    }

    /// Paints a shape, if it is to be seen.
    fn paint(&mut self, shape: Shape, paint: &usvg::Paint, opacity: f32, element: Element<'t>, step: &Step<'t>) -> Result<()> {
        if opacity == 0.0 {
            return Ok(());
        }
        let ink = ink::of(paint, element, self.notes);
        if let Some(kind) = self.sink().mask {
            let opacity = opacity * step.opacity;
            let flat = kind == MaskType::Alpha || matches!(ink, [0, 0, 0] | [255, 255, 255]);
            if opacity < 1.0 || !flat {
                self.notes.add(element, "this part of a mask is neither black nor white: rounded to the nearest");
            }
            if opacity < 0.5 {
                return Ok(());
            }
        } else if opacity < 1.0 {
            self.notes.add(element, "transparency is not drawn yet: painted opaque");
        }
        let index = self.walked.scene.shapes.len() as u32;
        let part = Part { raw: self.shape(shape, element)?, cut: step.cut };
        if let [_] = &self.sinks[..] {
            self.walked.paints.push((index, ink));
        }
        let sink = self.sinks.last_mut().expect("the drawing's sink stays");
        sink.parts.push(part);
        match sink.layers.last_mut() {
            Some((last, parts)) if *last == ink => parts.push(part),
            _ => sink.layers.push((ink, vec![part])),
        }
        Ok(())
    }

    fn shape(&mut self, shape: Shape, element: Element<'_>) -> Result<Area> {
        if !finite(&shape) {
            let what = format!("{}: its transform takes it out of the range of 64-bit numbers: use smaller ones", element.named());
            return Err(Error::input(Kind::Refused, what));
        }
        self.verbs += shape.path.verbs().len() as u64;
        if self.verbs > self.limits.edges || self.walked.scene.shapes.len() as u64 >= self.limits.nodes {
            let what = format!("more than {} shapes or {} lines and curves: split the drawing", self.limits.nodes, self.limits.edges);
            return Err(Error::input(Kind::Limit, what));
        }
        Ok(self.walked.scene.add_shape(shape))
    }

    /// What was painted since then is one area to what is around it, if it has an id, and an area of that name.
    fn name(&mut self, ids: [&'t str; 3], first_part: usize, first_paint: usize) {
        if ids == [""; 3] || self.sinks.len() > 1 {
            return;
        }
        let formula = &mut self.walked.scene.formula;
        let sink = self.sinks.last_mut().expect("the drawing's sink stays");
        let part = joined(&sink.parts[first_part..], formula);
        sink.parts.truncate(first_part);
        sink.parts.push(part);
        let paints = first_paint..self.walked.paints.len();
        let area = closed(&[part], formula);
        for id in ids.into_iter().filter(|id| !id.is_empty()) {
            let more = |drawn: &mut Drawn| drawn.more.push((area, paints.clone()));
            self.walked.drawn.entry(id).and_modify(more).or_insert_with(|| Drawn { area, paints: paints.clone(), more: Vec::new() });
        }
    }

    fn end(mut self) -> Walked<'t> {
        let sink = self.sinks.pop().expect("the drawing's sink stays");
        let scene = &mut self.walked.scene;
        scene.art = closed(&sink.parts, &mut scene.formula);
        let layers = sink.layers.into_iter().map(|(ink, parts)| Layer { area: closed(&parts, &mut scene.formula), ink });
        scene.picture = Picture::Layers(layers.collect());
        self.walked
    }

    fn sink(&self) -> &Sink {
        self.sinks.last().expect("the drawing's sink stays")
    }
}

fn element<'t>(id: &'t str, parent: Element<'t>) -> Element<'t> {
    if id.is_empty() { Element { own: false, ..parent } } else { Element { id, own: true } }
}
