//! What is sent to a printer: format, resolution, medium and place, and why these.

use ipp::value::IppValue;

use super::failure::{Failure, Why};
use super::media::{Chosen, Medium, is_meant, size_of};
use super::message::{collection, keyword};
use super::printer::Printer;
use super::sheet::{self, Scaling, Sheet};
use crate::encode::{FORMATS, Format, by_name};

/// Media types that are printed, the best first: formats made for pages, which printers know by their sizes, before those of pictures.
const PREFERENCE: [&str; 9] = [
    "image/pwg-raster",
    "image/urf",
    "application/PCLm",
    "application/vnd.hp-PCL",
    "image/tiff",
    "image/png",
    "image/x-portable-bitmap",
    "image/x-portable-graymap",
    "image/x-portable-pixmap",
];

/// What the printer finds out by itself.
const ANY: &str = "application/octet-stream";

/// What is wanted of a printer.
#[derive(Clone, Debug)]
pub struct Wishes {
    /// This format.
    pub format: Option<&'static Format>,
    /// This resolution, in dots an inch.
    pub dpi: Option<u32>,
    /// This medium, by its name, a part of it (`a4`), or its size (`914x1200mm`).
    pub media: Option<String>,
    /// How the drawing is brought to the sheet's size.
    pub scaling: Scaling,
    /// Whether the drawing may be turned by a quarter where that lets it fit.
    pub turn: bool,
    /// How often.
    pub copies: u32,
    /// Draft, normal or high.
    pub quality: Option<Quality>,
}

impl Default for Wishes {
    fn default() -> Wishes {
        Wishes { format: None, dpi: None, media: None, scaling: Scaling::Auto, turn: true, copies: 1, quality: None }
    }
}

/// How well it is printed (print-quality).
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Quality {
    /// Fast.
    Draft,
    /// As usual.
    Normal,
    /// Slow.
    High,
}

impl Quality {
    /// All of them.
    pub const ALL: [Quality; 3] = [Quality::Draft, Quality::Normal, Quality::High];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Quality::Draft => "draft",
            Quality::Normal => "normal",
            Quality::High => "high",
        }
    }
}

/// What is sent.
#[derive(Clone, Debug)]
pub struct Choice {
    /// In this format.
    pub format: &'static Format,
    /// In this resolution.
    pub dpi: u32,
    /// On this medium.
    pub medium: Chosen,
    /// The first drawing's place on it.
    pub sheet: Sheet,
    /// Copies that the printer makes.
    pub copies: u32,
    /// How often the pages are sent; 1 where the printer makes the copies.
    pub repeats: u32,
    /// Attributes of the job.
    pub attributes: Vec<(String, IppValue)>,
    /// Why, a line for each choice.
    pub why: Vec<String>,
}

impl Choice {
    /// The choice in one line.
    pub fn line(&self) -> String {
        let turned = if self.sheet.turned { ", turned" } else { "" };
        format!(
            "{} at {} dpi on {}, scaling {}{turned}: {}",
            self.format.name,
            self.dpi,
            self.medium,
            self.sheet.scaling.name(),
            self.why.join("; ")
        )
    }

    /// The place of another drawing of that size, in hundredths of a millimetre, on a sheet of its own.
    pub fn place(&self, drawing: [f64; 2], wishes: &Wishes) -> Sheet {
        let turned = wishes.turn && turns(drawing, &self.medium);
        sheet::lay(drawing, &self.medium, self.dpi, wishes.scaling, turned)
    }
}

/// Chooses for a drawing of that size, in hundredths of a millimetre.
///
/// # Errors
/// What is wanted is not what the printer can.
pub fn choose(printer: &Printer, wishes: &Wishes, drawing: [f64; 2]) -> Result<Choice, Failure> {
    let mut why = Vec::new();
    let format = format(printer, wishes, &mut why)?;
    if !printer.steps {
        let what = "the printer takes no jobs in steps (Create-Job, Send-Document), so that what it has received would not be known";
        return Err(Failure::new(Why::Refused, what));
    }
    let dpi = resolution(printer, wishes, format, &mut why)?;
    let medium = medium(printer, wishes, drawing, &mut why)?;
    let turned = wishes.turn && turns(drawing, &medium);
    let sheet = sheet::lay(drawing, &medium, dpi, wishes.scaling, turned);
    if sheet.cut {
        why.push("the printer does not reach the edge of the sheet, where the drawing goes".to_owned());
    }
    let at_printer = wishes.copies <= printer.copies;
    if !at_printer {
        why.push(format!("the printer makes at most {} copies, so the pages are sent {} times", printer.copies, wishes.copies));
    }
    let (copies, repeats) = if at_printer { (wishes.copies, 1) } else { (1, wishes.copies) };
    let attributes = attributes(printer, wishes, &medium, dpi, copies);
    Ok(Choice { format, dpi, medium, sheet, copies, repeats, attributes, why })
}

fn wish(what: String) -> Failure {
    Failure::new(Why::Wish, what)
}

fn format(printer: &Printer, wishes: &Wishes, why: &mut Vec<String>) -> Result<&'static Format, Failure> {
    let takes = |format: &Format| printer.formats.iter().any(|own| own.eq_ignore_ascii_case(format.media_type));
    let known: Vec<&str> = FORMATS.iter().filter(|format| takes(format)).map(|format| format.name).collect();
    if let Some(format) = wishes.format {
        if takes(format) {
            why.push(format!("{} was asked for", format.name));
        } else if printer.formats.iter().any(|own| own == ANY) {
            why.push(format!("{} was asked for, and the printer finds out by itself what it gets", format.name));
        } else {
            let others = if known.is_empty() { "none that can be written".to_owned() } else { known.join(", ") };
            return Err(wish(format!("the printer does not take {} ({}): it takes {others}", format.name, format.media_type)));
        }
        return Ok(format);
    }
    let best =
        PREFERENCE.iter().find_map(|best| FORMATS.iter().find(|format| format.media_type.eq_ignore_ascii_case(best) && takes(format)));
    let Some(format) = best else {
        let what = format!("the printer takes no format that can be written, only {}; see runset formats", printer.formats.join(", "));
        return Err(Failure::new(Why::Refused, what));
    };
    why.push(format!("{} is the best of {}", format.name, known.join(", ")));
    Ok(format)
}

fn resolution(printer: &Printer, wishes: &Wishes, format: &Format, why: &mut Vec<String>) -> Result<u32, Failure> {
    let all = printer.resolutions_of(&format.media_type.to_ascii_lowercase());
    let mut square: Vec<u32> = all.iter().filter(|[across, along]| across == along).map(|[dpi, _]| *dpi).collect();
    square.sort_unstable();
    square.dedup();
    let list = square.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
    match (wishes.dpi, square.last()) {
        (Some(dpi), Some(_)) if square.contains(&dpi) => {
            why.push(format!("{dpi} dpi was asked for"));
            Ok(dpi)
        }
        (Some(dpi), Some(_)) => Err(wish(format!("the printer has no {dpi} dpi in {}: it has {list}", format.name))),
        (Some(dpi), None) => {
            why.push(format!("{dpi} dpi was asked for, and the printer tells none that is the same both ways"));
            Ok(dpi)
        }
        (None, Some(&finest)) => {
            why.push(format!("{finest} dpi is the finest of {list}"));
            Ok(finest)
        }
        (None, None) => Err(wish("the printer tells no resolution that is the same both ways: give one with --dpi".to_owned())),
    }
}

/// Whether a drawing goes better on a medium when it is turned by a quarter.
fn turns([w, h]: [f64; 2], medium: &Chosen) -> bool {
    let [width, height] = medium.size.map(f64::from);
    let fits = |w: f64, h: f64| w <= width + 100.0 && h <= height + 100.0;
    !fits(w, h) && (fits(h, w) || (w > h) != (width > height) && (w - h).abs() > 1.0)
}

fn medium(printer: &Printer, wishes: &Wishes, drawing: [f64; 2], why: &mut Vec<String>) -> Result<Chosen, Failure> {
    let whole = drawing.map(|x| x.round().min(1e8) as i32);
    let quarter = [whole[1], whole[0]];
    // Without margins, if all of the sheet is to be printed and the printer can; else with the smallest.
    let preferred =
        |list: &mut dyn Iterator<Item = &Medium>| list.min_by_key(|medium| (!medium.ready, medium.margins.iter().sum::<i32>())).cloned();
    if let Some(written) = &wishes.media {
        let by_name = &mut printer
            .media
            .iter()
            .filter(|medium| medium.name.as_deref().is_some_and(|name| !medium.is_roll() && is_meant(name, written)));
        if let Some(medium) = preferred(by_name) {
            why.push(format!("{} was asked for", medium.name.as_deref().unwrap_or(written)));
            return Ok(medium.sized(whole));
        }
        let Some(size) = size_of(written) else {
            let names: Vec<&str> = printer.media.iter().filter_map(|medium| medium.name.as_deref()).take(12).collect();
            return Err(wish(format!(
                "no medium is called {written:?}: the printer has {}; or give a size such as 914x1200mm",
                names.join(", ")
            )));
        };
        if let Some(medium) = preferred(&mut printer.media.iter().filter(|medium| medium.is(size))) {
            why.push(format!("{written} was asked for"));
            return Ok(medium.sized(size));
        }
        // It may know more than it tells: it is asked.
        why.push(format!("{written} was asked for, which the printer does not tell of"));
        let name = written.contains('_').then(|| written.clone());
        return Ok(Chosen { named: name.is_some(), name, size, margins: [0; 4] });
    }
    let found = |what: &str, size: [i32; 2], of: &dyn Fn(&&Medium) -> bool| {
        let medium = preferred(&mut printer.media.iter().filter(of).filter(|medium| medium.is(size)))?;
        Some((medium.sized(size), what.to_owned()))
    };
    let turned = |size: [i32; 2]| if wishes.turn { size } else { whole };
    let fixed = |medium: &&Medium| !medium.is_roll();
    let ready = |medium: &&Medium| medium.ready && fixed(medium);
    let roll = |medium: &&Medium| medium.is_roll();
    let default = || {
        let name = printer.default_medium.as_deref()?;
        let own = preferred(&mut printer.media.iter().filter(|medium| medium.name.as_deref() == Some(name)));
        let chosen = own
            .map(|medium| medium.sized(whole))
            .or_else(|| Some(Chosen { name: Some(name.to_owned()), size: size_of(name)?, margins: [0; 4], named: true }))?;
        Some((chosen, "the printer's own choice".to_owned()))
    };
    let widest = || {
        let fits = |size: [i32; 2]| {
            preferred(
                &mut printer.media.iter().filter(|m| m.is_roll() && size[0] <= m.width.1 && (m.height.0..=m.height.1).contains(&size[1])),
            )
        };
        let sized = |size: [i32; 2]| fits(size).map(|medium| (medium.sized(size), "a roll that is wide enough".to_owned()));
        sized(whole).or_else(|| sized(turned(quarter)))
    };
    let chosen = found("of the drawing's size, and ready", whole, &ready)
        .or_else(|| found("of the drawing's size, and ready", turned(quarter), &ready))
        .or_else(|| found("of the drawing's size, from a roll", whole, &roll))
        .or_else(|| found("of the drawing's size, from a roll", turned(quarter), &roll))
        .or_else(widest)
        .or_else(|| found("of the drawing's size, which has to be put in", whole, &fixed))
        .or_else(|| found("of the drawing's size, which has to be put in", turned(quarter), &fixed))
        .or_else(default)
        .or_else(|| printer.media.first().map(|medium| (medium.sized(whole), "the first that the printer tells of".to_owned())));
    let Some((chosen, what)) = chosen else {
        return Err(wish("the printer tells of no medium: name one with --media, such as iso_a4_210x297mm".to_owned()));
    };
    why.push(format!("{chosen} is {what}"));
    Ok(chosen)
}

fn attributes(printer: &Printer, wishes: &Wishes, medium: &Chosen, dpi: u32, copies: u32) -> Vec<(String, IppValue)> {
    let mut all = Vec::new();
    let mut add = |name: &str, value: IppValue| all.push((name.to_owned(), value));
    // A name says all; a size without one, or without margins, has to be described.
    match &medium.name {
        Some(name) if medium.named => add("media", keyword(name)),
        _ => {
            let [width, height] = medium.size.map(IppValue::Integer);
            add("media-col", collection([("media-size", collection([("x-dimension", width), ("y-dimension", height)]))]));
        }
    }
    if copies > 1 {
        add("copies", IppValue::Integer(i32::try_from(copies).unwrap_or(i32::MAX)));
    }
    // The sheet is what is sent: nothing is left to scale.
    if printer.knows("print-scaling") {
        add("print-scaling", keyword("none"));
    }
    if printer.knows("printer-resolution") && printer.resolutions.contains(&[dpi, dpi]) {
        let n = i32::try_from(dpi).unwrap_or(i32::MAX);
        add("printer-resolution", IppValue::Resolution { cross_feed: n, feed: n, units: 3 });
    }
    if let Some(quality) = wishes.quality {
        add("print-quality", IppValue::Enum(3 + quality as i32));
    }
    all
}

/// The format of that name, if it is one that is printed.
///
/// # Errors
/// No format has that name.
pub fn named(name: &str) -> Result<&'static Format, Failure> {
    by_name(name).ok_or_else(|| wish(format!("no format is called {name:?}: see runset formats")))
}
