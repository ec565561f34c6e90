//! SVG: what is painted, fills, strokes and text, as shapes with their ids.
//!
//! Four steps. [`markup`] looks at the text, [`references`] and [`numbers`] at the parsed XML, and refuse what the libraries would
//! choke on or silently leave out; [`outlines`] reads the long outlines in its stead, and [`tags`] marks their elements and others whose ids
//! `usvg` would lose; `usvg` resolves styles, units and `use`; [`tree`] walks what it gives into shapes, areas and layers, with [`cut`] for clip paths and masks. Ids come from the XML ([`names`]), because
//! `usvg` keeps only those that stand on something drawn. What is drawn but not supported is noted on the way, each with the element's id
//! ([`notes`]).
//!
//! Nothing outside the document is ever opened; what leads there is named ([`outside`]).

mod cut;
mod drawn;
mod edits;
mod geometry;
mod ink;
mod markup;
mod names;
mod notes;
mod numbers;
mod outlines;
mod outside;
mod parts;
mod references;
mod sheet;
mod style;
mod tags;
mod text;
mod transform;
mod tree;
mod unsupported;
mod viewport;

use std::thread;

use usvg::roxmltree;

use self::names::Names;
use self::notes::Notes;
use self::outlines::Outlines;
use self::tags::Tags;
use self::viewport::Viewport;
use crate::error::{Error, Kind, Place, Result, Warning};
use crate::input::fonts::{self, Fonts};
use crate::scene::{Limits, Scene};

/// Stack for `usvg`, which recurses on nested elements: enough for [`references::DEEPEST`], wherever this is called from.
const STACK: usize = 64 << 20;

/// Reads an SVG.
///
/// # Errors
/// With the place where there is one: what is not XML or not SVG, circular references, more than the limits allow, coordinates out
/// of range.
pub(super) fn read(bytes: Vec<u8>, limits: &Limits, fonts: &Fonts, warnings: &mut Vec<Warning>) -> Result<Scene> {
    let text = String::from_utf8(bytes).map_err(|e| {
        let what = "the document is not UTF-8: save it as UTF-8";
        Error::input(Kind::Malformed, what).at_byte(e.as_bytes(), e.utf8_error().valid_up_to())
    })?;
    markup::check(&text, limits)?;
    thread::scope(|scope| {
        let reader = thread::Builder::new().stack_size(STACK).spawn_scoped(scope, || document(text, limits, fonts, warnings));
        let reader = reader.map_err(|e| Error::input(Kind::Io, format!("no thread to read the SVG on: {e}")))?;
        // A panic there is a fault of a library; here it is an error like others.
        reader.join().unwrap_or_else(|_| Err(Error::input(Kind::Malformed, "the SVG library fails on this document: simplify it")))
    })
}

/// What is no longer needed goes as soon as it can: the text before the walk, and before `usvg` where that gets another.
fn document(text: String, limits: &Limits, fonts: &Fonts, warnings: &mut Vec<Warning>) -> Result<Scene> {
    let xml = parsed(&text)?;
    let root = xml.root_element();
    if !is_svg(root) || root.tag_name().name() != "svg" {
        let what = format!("the root element is <{}>: expected <svg>", root.tag_name().name());
        return Err(Error::input(Kind::Malformed, what).at_byte(text.as_bytes(), root.range().start));
    }
    let (styles, missing) = references::check(&xml, limits)?;
    let outlines = Outlines::read(&xml, limits.threads);
    numbers::check(&xml, &styles, &outlines)?;
    text::check(&xml)?;
    let mut notes = Notes::read(&xml, &styles);
    outside::note(&xml, &styles, &missing, &mut notes);
    sheet::note(&xml, &mut notes);
    let page = Viewport::read(root, &styles);
    let tagged = tags::rewrite(&xml, &styles, &outlines);
    drop((styles, missing, outlines));
    let (drawing, names, tags) = if let Some((rewritten, tags)) = tagged {
        let names = Names::read(&xml, &mut notes);
        notes.find_places(&text);
        drop(xml);
        drop(text);
        (resolved(&parsed(&rewritten)?, fonts)?, names, tags)
    } else {
        // `usvg` takes more than anything else: the names come behind it.
        let drawing = resolved(&xml, fonts)?;
        let names = Names::read(&xml, &mut notes);
        notes.find_places(&text);
        drop(xml);
        drop(text);
        (drawing, names, Tags::default())
    };
    let walked = tree::walk(&drawing, page.as_ref(), &tags, limits, &mut notes)?;
    let (scene, places) = names.give(walked, limits)?;
    warnings.append(&mut notes.warnings(|id| scene.position(id).map(|i| places[i])));
    Ok(scene)
}

fn parsed(text: &str) -> Result<roxmltree::Document<'_>> {
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    roxmltree::Document::parse_with_options(text, options).map_err(|e| xml_error(text, &e))
}

/// A document that has been looked through, with its styles, units and references resolved.
fn resolved(xml: &roxmltree::Document<'_>, fonts: &Fonts) -> Result<usvg::Tree> {
    usvg::Tree::from_xmltree(xml, &options_of_usvg(fonts)).map_err(|e| svg_error(&e))
}

/// Options under which `usvg` opens no file but the given fonts', and draws no image.
fn options_of_usvg(fonts: &Fonts) -> usvg::Options<'static> {
    let nothing = usvg::ImageHrefResolver { resolve_data: Box::new(|_, _, _| None), resolve_string: Box::new(|_, _| None) };
    usvg::Options { image_href_resolver: nothing, font_family: fonts::BUILT_IN.to_owned(), fontdb: fonts.0.clone(), ..Default::default() }
}

/// Whether an element is SVG's own; those without any namespace count, as `usvg` has it.
fn is_svg(node: roxmltree::Node<'_, '_>) -> bool {
    node.is_element() && matches!(node.tag_name().namespace(), None | Some("http://www.w3.org/2000/svg"))
}

/// The attribute of that name that has no namespace.
fn attribute<'a>(node: roxmltree::Node<'a, '_>, name: &str) -> Option<&'a str> {
    node.attributes().find(|a| a.namespace().is_none() && a.name() == name).map(|a| a.value())
}

/// The `href` of an element; the one without a namespace goes before `xlink:href`.
fn href<'a>(node: roxmltree::Node<'a, '_>) -> Option<&'a str> {
    attribute(node, "href").or_else(|| node.attribute(("http://www.w3.org/1999/xlink", "href")))
}

fn xml_error(text: &str, error: &roxmltree::Error) -> Error {
    use roxmltree::Error as E;
    match error {
        E::UnexpectedEndOfStream | E::UnclosedRootNode => {
            let what = "the XML ends too early: is the file complete?";
            return Error::input(Kind::Malformed, what).at_byte(text.as_bytes(), text.len());
        }
        E::NoRootNode => return Error::input(Kind::Malformed, "no element: expected <svg>"),
        _ => {}
    }
    let at = error.pos();
    let what = error.to_string().replace(&format!(" at {at}"), "");
    Error::input(Kind::Malformed, format!("not well-formed XML: {what}")).at(Place { line: at.row, column: at.col })
}

fn svg_error(error: &usvg::Error) -> Error {
    match error {
        usvg::Error::InvalidSize => Error::input(Kind::Malformed, "the svg has no size: give it a positive width and height, or a viewBox"),
        usvg::Error::ElementsLimitReached | usvg::Error::ParsingFailed(roxmltree::Error::NodesLimitReached) => {
            Error::input(Kind::Limit, "more than 1000000 elements, <use> counted where it draws: split the drawing")
        }
        other => Error::input(Kind::Malformed, format!("not an SVG that can be read: {other}")),
    }
}
