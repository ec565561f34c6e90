//! What a printer says of itself: formats, resolutions, media and margins, and how it is.

use ipp::model::Operation;
use ipp::value::IppValue;

use super::client::Client;
use super::failure::Failure;
use super::job::{refused, user};
use super::media::{Medium, size_of};
use super::message::{Attributes, Request, keywords, member, number, range, text, title};
use super::waited::Pauses;

/// What is asked for by name; many printers leave out `media-col-database` unless it is.
const ASKED: [&str; 30] = [
    "printer-name",
    "printer-info",
    "printer-make-and-model",
    "printer-location",
    "printer-state",
    "printer-state-reasons",
    "printer-state-message",
    "printer-is-accepting-jobs",
    "operations-supported",
    "document-format-supported",
    "printer-resolution-supported",
    "pwg-raster-document-resolution-supported",
    "pwg-raster-document-type-supported",
    "pclm-source-resolution-supported",
    "urf-supported",
    "media-supported",
    "media-ready",
    "media-default",
    "media-col-database",
    "media-col-ready",
    "media-col-supported",
    "media-size-supported",
    "media-top-margin-supported",
    "media-right-margin-supported",
    "media-bottom-margin-supported",
    "media-left-margin-supported",
    "copies-supported",
    "print-scaling-supported",
    "print-quality-supported",
    "job-creation-attributes-supported",
];

/// How a printer is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// It has nothing to do.
    Idle,
    /// It prints.
    Printing,
    /// Somebody has to see to it.
    Stopped,
    /// It does not say.
    Untold,
}

/// What a printer says of itself. Resolutions are pairs of dots an inch, across and along.
#[derive(Clone, Debug)]
pub struct Printer {
    /// Its name, or what its maker calls it.
    pub name: String,
    /// Its maker and model.
    pub model: Option<String>,
    /// How it is.
    pub status: Status,
    /// Why, as keywords.
    pub reasons: Vec<String>,
    /// Whether it takes jobs.
    pub accepting: bool,
    /// Media types, in lower case.
    pub formats: Vec<String>,
    /// Of any document.
    pub resolutions: Vec<[u32; 2]>,
    /// Of PWG raster.
    pub pwg_resolutions: Vec<[u32; 2]>,
    /// Of PCLm.
    pub pclm_resolutions: Vec<[u32; 2]>,
    /// Kinds of pixels of PWG raster, as `black_1`.
    pub pwg_types: Vec<String>,
    /// What it says of Apple raster, as `RS300-600`.
    pub urf: Vec<String>,
    /// All media, those that lie in it first.
    pub media: Vec<Medium>,
    /// What it takes if nothing is said.
    pub default_medium: Option<String>,
    /// Whether it takes sizes without a name.
    pub takes_sizes: bool,
    /// Most copies of a document.
    pub copies: u32,
    /// Attributes of jobs that it knows.
    pub knows: Vec<String>,
    /// Whether jobs are made in steps: Create-Job, then Send-Document.
    pub steps: bool,
}

/// Asks a printer what it can; again while it does not answer, for as long as the limits say. `waits` is told why.
///
/// # Errors
/// It does not answer, or is no printer.
pub async fn ask(client: &Client, mut waits: impl FnMut(&Failure)) -> Result<Printer, Failure> {
    let request = Request::new(Operation::GetPrinterAttributes, "printer-uri", &client.address)
        .with("requesting-user-name", title(&user()))
        .with("requested-attributes", keywords(&ASKED));
    let began = tokio::time::Instant::now();
    let mut pauses = Pauses::new();
    loop {
        let answered = match client.ask(&request).await {
            Ok(answer) if answer.is_success() => return Ok(Printer::of(answer.printer(), client)),
            Ok(answer) => Err(refused(client, &answer, "it does not tell what it can")),
            Err(failure) => Err(failure),
        };
        match answered {
            Err(failure) if failure.is_passing() && began.elapsed() < client.limits.wait => {
                waits(&failure);
                tokio::time::sleep(pauses.next()).await;
            }
            result => return result,
        }
    }
}

impl Printer {
    fn of(told: Attributes<'_>, client: &Client) -> Printer {
        let operations: Vec<i32> = told.values("operations-supported").iter().filter_map(number).collect();
        let has = |operation: Operation| operations.contains(&(operation as i32));
        let texts = |name| told.texts(name);
        let accepting = told.values("printer-is-accepting-jobs").first().is_none_or(|value| *value != IppValue::Boolean(false));
        Printer {
            name: told.text("printer-info").or_else(|| told.text("printer-name")).map_or_else(|| client.name(), str::to_owned),
            model: told.text("printer-make-and-model").map(str::to_owned),
            status: match told.number("printer-state") {
                Some(3) => Status::Idle,
                Some(4) => Status::Printing,
                Some(5) => Status::Stopped,
                _ => Status::Untold,
            },
            reasons: texts("printer-state-reasons").into_iter().filter(|reason| reason != "none").collect(),
            accepting,
            formats: texts("document-format-supported").iter().map(|format| format.to_ascii_lowercase()).collect(),
            resolutions: resolutions(told, "printer-resolution-supported"),
            pwg_resolutions: resolutions(told, "pwg-raster-document-resolution-supported"),
            pclm_resolutions: resolutions(told, "pclm-source-resolution-supported"),
            pwg_types: texts("pwg-raster-document-type-supported"),
            urf: texts("urf-supported"),
            media: media(told),
            default_medium: told.text("media-default").map(str::to_owned),
            takes_sizes: texts("media-col-supported").iter().any(|member| member == "media-size"),
            copies: told.values("copies-supported").first().and_then(range).map_or(1, |(_, most)| most.max(1) as u32),
            knows: texts("job-creation-attributes-supported"),
            steps: has(Operation::CreateJob) && has(Operation::SendDocument),
        }
    }

    /// Whether it knows an attribute of jobs. One that does not tell which it knows is asked by what values it has.
    pub fn knows(&self, attribute: &str) -> bool {
        self.knows.iter().any(|own| own == attribute)
    }

    /// The resolutions that it takes in a format.
    pub fn resolutions_of(&self, media_type: &str) -> Vec<[u32; 2]> {
        let own = match media_type {
            "image/pwg-raster" => self.pwg_resolutions.clone(),
            "application/pclm" => self.pclm_resolutions.clone(),
            "image/urf" => urf_resolutions(&self.urf),
            _ => Vec::new(),
        };
        if own.is_empty() { self.resolutions.clone() } else { own }
    }
}

/// `RS300-600` of Apple raster.
fn urf_resolutions(urf: &[String]) -> Vec<[u32; 2]> {
    let listed = urf.iter().filter_map(|word| word.strip_prefix("RS"));
    listed.flat_map(|list| list.split('-')).filter_map(|dpi| dpi.parse().ok()).filter(|dpi| *dpi > 0).map(|dpi| [dpi, dpi]).collect()
}

fn resolutions(told: Attributes<'_>, name: &str) -> Vec<[u32; 2]> {
    let of = |value: &IppValue| {
        let IppValue::Resolution { cross_feed, feed, units } = value else { return None };
        let inch = |n: i32| match units {
            3 => u32::try_from(n).ok(),
            // Dots a centimetre.
            4 => u32::try_from((i64::from(n) * 254 + 50) / 100).ok(),
            _ => None,
        };
        Some([inch(*cross_feed)?, inch(*feed)?]).filter(|dpi| dpi.iter().all(|dpi| (1..=100_000).contains(dpi)))
    };
    told.values(name).iter().filter_map(of).collect()
}

/// All media that a printer tells of, each size and set of margins once, those that are ready first.
fn media(told: Attributes<'_>) -> Vec<Medium> {
    let mut all: Vec<Medium> = Vec::new();
    let mut add = |medium: Medium| {
        let same = |own: &&mut Medium| (own.width, own.height, own.margins) == (medium.width, medium.height, medium.margins);
        match all.iter_mut().find(same) {
            Some(own) => own.name = own.name.take().or(medium.name),
            None => all.push(medium),
        }
    };
    // The largest margin of those that a printer has is safe for a medium that tells none.
    let margin = |name: &str| told.values(name).iter().filter_map(number).max().unwrap_or(0).max(0);
    let margins = ["top", "right", "bottom", "left"].map(|side| margin(&format!("media-{side}-margin-supported")));
    for (name, ready) in [("media-col-ready", true), ("media-col-database", false)] {
        told.values(name).iter().filter_map(|value| of_collection(value, ready, margins)).for_each(&mut add);
    }
    for (name, ready) in [("media-ready", true), ("media-supported", false)] {
        for name in told.texts(name) {
            let Some([width, height]) = size_of(&name) else { continue };
            // Ends of ranges: the collections tell the whole of them.
            if ["_min_", "_max_"].iter().any(|end| name.contains(end)) {
                continue;
            }
            add_named(&mut all, Medium { name: Some(name), width: (width, width), height: (height, height), margins, ready, source: None });
        }
    }
    for value in told.values("media-size-supported") {
        let (Some(width), Some(height)) = (side(value, "x-dimension"), side(value, "y-dimension")) else { continue };
        let medium = Medium { name: None, width, height, margins, ready: false, source: None };
        if !all.iter().any(|own| (own.width, own.height) == (medium.width, medium.height)) {
            all.push(medium);
        }
    }
    all.sort_by_key(|medium| !medium.ready);
    all
}

/// A medium that is known by its name alone: it gives the collections of that size their name, or stands for itself if there are none.
fn add_named(all: &mut Vec<Medium>, medium: Medium) {
    let size = [medium.width.0, medium.height.0];
    let mut known = false;
    for own in all.iter_mut().filter(|own| !own.is_roll() && own.is(size)) {
        known = true;
        own.name.get_or_insert_with(|| medium.name.clone().unwrap_or_default());
        own.ready |= medium.ready && own.name == medium.name;
    }
    if !known {
        all.push(medium);
    }
}

fn side(size: &IppValue, name: &str) -> Option<(i32, i32)> {
    member(size, name).and_then(range).filter(|(least, most)| *least > 0 && *most <= 100_000_000)
}

fn of_collection(value: &IppValue, ready: bool, margins: [i32; 4]) -> Option<Medium> {
    let size = member(value, "media-size")?;
    let margin = |i: usize, name: &str| member(value, name).and_then(number).map_or(margins[i], |margin| margin.clamp(0, 1_000_000));
    Some(Medium {
        name: member(value, "media-size-name").and_then(text).map(str::to_owned),
        width: side(size, "x-dimension")?,
        height: side(size, "y-dimension")?,
        margins: [
            margin(0, "media-top-margin"),
            margin(1, "media-right-margin"),
            margin(2, "media-bottom-margin"),
            margin(3, "media-left-margin"),
        ],
        ready,
        source: member(value, "media-source").and_then(text).map(str::to_owned),
    })
}

#[cfg(test)]
mod tests {
    use super::super::message::{collection, keyword};
    use super::*;

    fn size(width: IppValue, height: IppValue) -> IppValue {
        collection([("x-dimension", width), ("y-dimension", height)])
    }

    #[test]
    fn media_are_sizes_margins_and_rolls() {
        let number = IppValue::Integer;
        let a4 = collection([
            ("media-size", size(number(21000), number(29700))),
            ("media-top-margin", number(300)),
            ("media-right-margin", number(400)),
            ("media-bottom-margin", number(500)),
            ("media-left-margin", number(600)),
        ]);
        let full = collection([
            ("media-size", size(number(21000), number(29700))),
            ("media-top-margin", number(0)),
            ("media-right-margin", number(0)),
            ("media-bottom-margin", number(0)),
            ("media-left-margin", number(0)),
        ]);
        let roll = collection([("media-size", size(number(91440), IppValue::RangeOfInteger { min: 20000, max: 1_500_000 }))]);
        let wrong = collection([("media-size", size(number(-5), number(3)))]);
        let told = [
            ("media-col-ready", IppValue::Array(vec![roll])),
            ("media-col-database", IppValue::Array(vec![a4, full, wrong, keyword("none")])),
            (
                "media-supported",
                IppValue::Array(vec![keyword("iso_a4_210x297mm"), keyword("iso_a3_297x420mm"), keyword("roll_max_914x15000mm")]),
            ),
            ("media-left-margin-supported", IppValue::Array(vec![number(0), number(700)])),
        ]
        .map(|(name, value)| (name.to_owned(), value));
        let all = media(Attributes(&told));
        let short: Vec<_> = all.iter().map(|m| (m.name.as_deref(), m.width.0, m.height, m.margins, m.ready)).collect();
        assert_eq!(
            short,
            [
                (None, 91440, (20000, 1_500_000), [0, 0, 0, 700], true),
                (Some("iso_a4_210x297mm"), 21000, (29700, 29700), [300, 400, 500, 600], false),
                (Some("iso_a4_210x297mm"), 21000, (29700, 29700), [0; 4], false),
                (Some("iso_a3_297x420mm"), 29700, (42000, 42000), [0, 0, 0, 700], false),
            ]
        );
    }

    #[test]
    fn resolutions_are_dots_an_inch() {
        let dots = |x, y, units| IppValue::Resolution { cross_feed: x, feed: y, units };
        let told = [(
            "r".to_owned(),
            IppValue::Array(vec![dots(600, 600, 3), dots(600, 1200, 3), dots(236, 236, 4), dots(-1, 5, 3), dots(9, 9, 7)]),
        )];
        // 236 dots a centimetre are 599.44 an inch.
        assert_eq!(resolutions(Attributes(&told), "r"), [[600, 600], [600, 1200], [599, 599]]);
        let words = ["W8", "RS300-600", "RSx", "V1.4"].map(str::to_owned);
        assert_eq!(urf_resolutions(&words), [[300, 300], [600, 600]]);
    }
}
