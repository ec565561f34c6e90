//! What is sent to a printer: format, resolution, medium and place, and why these.

use ipp::value::IppValue;

use super::failure::{Failure, Why};
use super::media::{Chosen, Medium, is_meant, size_of};
use super::message::{collection, keyword};
use super::printer::Printer;
use super::sheet::{self, Scaling, Sheet};
use super::wishes::Wishes;
use crate::encode::{FORMATS, Format};
use crate::run::Pixels;

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
        Sheet { pixels: self.sheet.pixels, ..sheet::lay(drawing, &self.medium, self.dpi, wishes.scaling, turned) }
    }
}

/// Chooses for a drawing of that size, in hundredths of a millimetre, whose inks need such pixels.
///
/// # Errors
/// What is wanted is not what the printer can.
pub fn choose(printer: &Printer, wishes: &Wishes, drawing: [f64; 2], inks: Pixels) -> Result<Choice, Failure> {
    let mut why = Vec::new();
    let format = format(printer, wishes, &mut why)?;
    if !printer.steps {
        let what = "the printer takes no jobs in steps (Create-Job, Send-Document), so that what it has received would not be known";
        return Err(Failure::new(Why::Refused, what));
    }
    let dpi = resolution(printer, wishes, format, &mut why)?;
    let medium = medium(printer, wishes, drawing, &mut why)?;
    let turned = wishes.turn && turns(drawing, &medium);
    let pixels = pixels(printer, format, inks, &mut why);
    let sheet = Sheet { pixels, ..sheet::lay(drawing, &medium, dpi, wishes.scaling, turned) };
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

/// The least pixels that the printer takes in a format and that show all inks; the most that it takes, if it takes no such. None where it does not say.
fn pixels(printer: &Printer, format: &Format, inks: Pixels, why: &mut Vec<String>) -> Option<Pixels> {
    let has = |list: &[String], word: &str| list.iter().any(|own| own == word);
    let (pwg, urf) = (&printer.pwg_types, &printer.urf);
    let takes = |pixels: Pixels| match (format.media_type, pixels) {
        ("image/pwg-raster", Pixels::Black) => has(pwg, "black_1"),
        ("image/pwg-raster", Pixels::Gray) => has(pwg, "sgray_8"),
        ("image/pwg-raster", Pixels::Rgb) => has(pwg, "srgb_8"),
        ("image/urf", Pixels::Gray) => has(urf, "W8"),
        ("image/urf", Pixels::Rgb) => has(urf, "SRGB24"),
        _ => false,
    };
    const ALL: [Pixels; 3] = [Pixels::Black, Pixels::Gray, Pixels::Rgb];
    let rank = |pixels: Pixels| ALL.iter().position(|own| *own == pixels);
    let enough = ALL.into_iter().filter(|pixels| rank(*pixels) >= rank(inks)).find(|pixels| takes(*pixels));
    enough.or_else(|| {
        let most = ALL.into_iter().rev().find(|pixels| takes(*pixels))?;
        why.push(format!("the printer has no colours in {}", format.name));
        Some(most)
    })
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
    // A name alone means the usual margins; a sheet that is to be filled is better without.
    let fill = wishes.scaling == Scaling::Fill;
    let order = |medium: &&Medium| {
        let margins: i32 = medium.margins.iter().sum();
        (!medium.ready, if fill { margins } else { -margins })
    };
    let preferred = |list: &mut dyn Iterator<Item = &Medium>| list.min_by_key(order).cloned();
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
    let borderless = wishes.scaling == Scaling::Fill && medium.margins == [0; 4] && printer.takes_sizes;
    match &medium.name {
        Some(name) if medium.named && !borderless => add("media", keyword(name)),
        _ => {
            let [width, height] = medium.size.map(IppValue::Integer);
            let size = ("media-size", collection([("x-dimension", width), ("y-dimension", height)]));
            let margins = ["media-top-margin", "media-right-margin", "media-bottom-margin", "media-left-margin"];
            let margins = margins.into_iter().filter(|_| borderless).map(|name| (name, IppValue::Integer(0)));
            add("media-col", collection(std::iter::once(size).chain(margins)));
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

#[cfg(test)]
mod tests {
    use super::super::printer::Status;
    use super::*;
    use crate::encode::by_name;

    fn medium(name: &str, width: i32, height: (i32, i32), margin: i32, ready: bool) -> Medium {
        let name = (!name.is_empty()).then(|| name.to_owned());
        Medium { name, width: (width, width), height, margins: [margin; 4], ready, source: None }
    }

    fn printer(media: Vec<Medium>) -> Printer {
        Printer {
            name: "printer".to_owned(),
            model: None,
            status: Status::Idle,
            reasons: Vec::new(),
            accepting: true,
            formats: ["image/png", "image/urf", "image/pwg-raster"].map(str::to_owned).to_vec(),
            resolutions: vec![[600, 600]],
            pwg_resolutions: vec![[300, 300], [600, 1200], [1200, 1200]],
            pclm_resolutions: Vec::new(),
            pwg_types: vec!["sgray_8".to_owned()],
            urf: vec!["W8".to_owned(), "RS300-600".to_owned()],
            media,
            default_medium: Some("na_letter_8.5x11in".to_owned()),
            takes_sizes: true,
            copies: 99,
            knows: vec!["print-scaling".to_owned()],
            steps: true,
        }
    }

    const A4: [f64; 2] = [21000.0, 29700.0];

    fn choice(printer: &Printer, wishes: &Wishes, drawing: [f64; 2]) -> Result<Choice, Failure> {
        choose(printer, wishes, drawing, Pixels::Black)
    }

    #[test]
    fn formats_and_resolutions() {
        let own = printer(vec![medium("iso_a4_210x297mm", 21000, (29700, 29700), 0, true)]);
        let of = |wishes: Wishes| choice(&own, &wishes, A4).map(|choice| (choice.format.name, choice.dpi));
        let named = |name| by_name(name);
        assert_eq!(of(Wishes::default()), Ok(("pwg", 1200)), "the finest that is the same both ways");
        assert_eq!(of(Wishes { dpi: Some(300), ..Wishes::default() }), Ok(("pwg", 300)));
        assert_eq!(of(Wishes { format: named("urf"), ..Wishes::default() }), Ok(("urf", 600)));
        assert_eq!(of(Wishes { format: named("png"), ..Wishes::default() }), Ok(("png", 600)));
        assert!(of(Wishes { format: named("png"), dpi: Some(1200), ..Wishes::default() }).unwrap_err().what.contains("it has 600"));
        assert!(of(Wishes { format: named("pbm"), ..Wishes::default() }).unwrap_err().what.contains("it takes png, pwg, urf"));
        let steps = Printer { steps: false, ..own.clone() };
        assert_eq!(choice(&steps, &Wishes::default(), A4).unwrap_err().why, Why::Refused);
    }

    #[test]
    fn pixels_are_the_least_that_show_the_inks() {
        let own = printer(vec![medium("iso_a4_210x297mm", 21000, (29700, 29700), 0, true)]);
        let pixels = |inks| choose(&own, &Wishes::default(), A4, inks).map(|choice| choice.sheet.pixels);
        assert_eq!(pixels(Pixels::Black), Ok(Some(Pixels::Gray)), "there is no black of a bit");
        assert_eq!(pixels(Pixels::Rgb), Ok(Some(Pixels::Gray)), "there are no colours");
        let own = Printer { pwg_types: ["black_1", "sgray_8", "srgb_8"].map(str::to_owned).to_vec(), ..own.clone() };
        for inks in [Pixels::Black, Pixels::Gray, Pixels::Rgb] {
            assert_eq!(choose(&own, &Wishes::default(), A4, inks).map(|choice| choice.sheet.pixels), Ok(Some(inks)));
        }
    }

    #[test]
    fn media_of_the_drawings_size_come_first() {
        let letter = || medium("na_letter_8.5x11in", 21590, (27940, 27940), 600, true);
        let a4 = |ready, margin| medium("iso_a4_210x297mm", 21000, (29700, 29700), margin, ready);
        let roll = || medium("", 91440, (20000, 1_500_000), 300, true);
        let of = |media: Vec<Medium>, drawing: [f64; 2]| {
            let choice = choice(&printer(media), &Wishes::default(), drawing).unwrap();
            (choice.medium.to_string(), choice.sheet.turned, choice.medium.margins[0])
        };
        assert_eq!(of(vec![letter(), a4(true, 0), a4(true, 400)], A4), ("iso_a4_210x297mm".to_owned(), false, 400));
        let fill = Wishes { scaling: Scaling::Fill, ..Wishes::default() };
        let filled = choice(&printer(vec![a4(true, 400), a4(true, 0)]), &fill, A4).unwrap();
        assert_eq!((filled.medium.margins, filled.attributes[0].0.as_str()), ([0; 4], "media-col"), "its margins are named");
        assert_eq!(of(vec![letter(), a4(true, 400)], [29700.0, 21000.0]), ("iso_a4_210x297mm".to_owned(), true, 400));
        // A roll is there, a sheet of that size is not: 841 x 1189 mm.
        assert_eq!(of(vec![letter(), roll(), a4(false, 0)], [84100.0, 118_900.0]), ("914.4 x 1189 mm".to_owned(), false, 300));
        assert_eq!(of(vec![letter(), roll()], [118_900.0, 84100.0]), ("914.4 x 1189 mm".to_owned(), true, 300));
        assert_eq!(of(vec![letter(), a4(false, 0)], A4), ("iso_a4_210x297mm".to_owned(), false, 0));
        assert_eq!(of(vec![letter(), a4(false, 0)], [1e6, 1e6]), ("na_letter_8.5x11in".to_owned(), false, 600));
        assert!(choice(&Printer { default_medium: None, ..printer(Vec::new()) }, &Wishes::default(), A4).is_err());
    }

    #[test]
    fn a_medium_that_is_named() {
        let own =
            printer(vec![medium("iso_a4_210x297mm", 21000, (29700, 29700), 400, true), medium("", 91440, (20000, 1_500_000), 300, true)]);
        let of = |media: &str| choice(&own, &Wishes { media: Some(media.to_owned()), ..Wishes::default() }, A4);
        let attribute = |media: &str| of(media).map(|choice| choice.attributes[0].clone());
        assert_eq!(attribute("a4"), Ok(("media".to_owned(), keyword("iso_a4_210x297mm"))));
        let size =
            |x, y| collection([("media-size", collection([("x-dimension", IppValue::Integer(x)), ("y-dimension", IppValue::Integer(y))]))]);
        assert_eq!(attribute("914.4x1200mm"), Ok(("media-col".to_owned(), size(91440, 120_000))));
        // The printer tells of none; it is asked.
        assert_eq!(attribute("iso_a0_841x1189mm"), Ok(("media".to_owned(), keyword("iso_a0_841x1189mm"))));
        assert!(of("a7").unwrap_err().what.contains("iso_a4_210x297mm"));
        let copies = of("a4").map(|choice| (choice.copies, choice.repeats));
        assert_eq!(copies, Ok((1, 1)));
        let many = choice(&own, &Wishes { copies: 100, ..Wishes::default() }, A4).map(|choice| (choice.copies, choice.repeats));
        assert_eq!(many, Ok((1, 100)), "the printer makes 99");
    }
}
