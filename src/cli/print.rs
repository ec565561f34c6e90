//! `runset print`: drawings to a printer, followed until it says that they are printed.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::atomic::{AtomicI32, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use runset::encode::{FORMATS, Format};
use runset::job::{Job, Options, Stats, TOLERANCE, render_sheets};
use runset::print::body::Body;
use runset::print::choice::{self, Choice};
use runset::print::sheet::{self, Scaling};
use runset::print::wishes::{Quality, Wishes};
use runset::print::{self, Address, Client, Document, Errand, Failure as Unprinted, Limits, Stage, Status, Watch, Why};
use runset::run::Pixels;
use runset::scene::Scene;
use tokio_util::sync::CancellationToken;

use super::input::{FontOptions, Source};
use super::messages::{Ends, Failure, print as say, tell};
use super::printers::{known, remember};
use super::progress::Progress;
use super::values::{self, positive, seconds, whole};
use super::work::Work;

const EXAMPLES: &str = "\
Examples:
  runset print poster.svg --to ipp://printer.local/ipp/print --remember
      asks the printer what it can, sends the drawing as it is made, and waits until it is printed
  runset print poster.svg --expr 'art & frame - logo' --media a3 --print-scaling fit
      on the printer that was remembered
  runset print a.svg b.svg c.svg d.svg --pages 1-2,4 --copies 3 --dry-run
      says what would be sent, and sends nothing
  runset print --cancel ipp://printer.local/ipp/print/17

The address of the job at the printer is printed on standard output when the printer has made it. Ctrl-C cancels it there.";

/// Print drawings on an IPP printer
///
/// The printer is asked what it can: format, resolution and medium are the best that it has, and standard error says which and why. The raster is sent as it is
/// made, in the memory of a few lines. A printer that is busy or does not answer is asked again; a document is sent again only if the printer says that it has
/// nothing of it. The run ends with status 0 when the printer says that the job is completed.
#[derive(clap::Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Print {
    /// Drawings or scenes, a page each; - is standard input
    #[arg(value_name = "FILE", value_hint = clap::ValueHint::FilePath, required_unless_present = "cancel")]
    files: Vec<PathBuf>,

    /// Printer, such as ipp://printer.local/ipp/print [default: the one that is remembered]
    #[arg(long, value_name = "URI", env = "RUNSET_PRINTER_URI", value_parser = Address::parse)]
    to: Option<Address>,

    /// Remember the printer for the next time
    #[arg(long, requires = "to")]
    remember: bool,

    /// Only these of the FILEs, counted from 1, such as 1-3,5
    #[arg(long, value_name = "PAGES", value_parser = pages)]
    pages: Option<Pages>,

    /// Copies, 1 to 9999
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole(1..=9999))]
    copies: u32,

    /// Medium: its name, a part of it, or a size, such as iso_a4_210x297mm, a4, 914x1200mm [default: one of the drawing's size, else the printer's choice]
    #[arg(long, value_name = "NAME")]
    media: Option<String>,

    /// Resolution in dots an inch [default: the finest that the printer has]
    #[arg(long, value_name = "D", value_parser = whole(1..=100_000))]
    dpi: Option<u32>,

    /// Format of the document [default: the best that the printer takes]
    #[arg(long, value_name = "FORMAT", value_parser = format())]
    format: Option<&'static Format>,

    /// How a drawing is brought to the size of the sheet: none: as it is, in the middle; fit: as large as the printer reaches; fill: as large as the sheet,
    /// and cut off; auto: none if it is no larger than the sheet, else fit
    #[arg(long, value_name = "HOW", default_value = "auto", value_parser = scaling())]
    print_scaling: Scaling,

    /// What is printed around the drawing's own page, in millimetres
    #[arg(long, value_name = "MM", default_value_t = 0.0, value_parser = bleed)]
    bleed: f64,

    /// Never turn a drawing by a quarter to make it fit
    #[arg(long)]
    no_turn: bool,

    /// How well it is printed: draft, normal or high [default: the printer's choice]
    #[arg(long, value_name = "QUALITY", value_parser = quality())]
    print_quality: Option<Quality>,

    /// Area to fill, over the ids of the input, instead of the input's own picture
    #[arg(long, value_name = "E")]
    expr: Option<String>,

    /// Farthest that a flattened curve may be from the true one, in pixels, 0.001 to 16
    #[arg(long, value_name = "PX", default_value_t = TOLERANCE, value_parser = values::tolerance, allow_negative_numbers = true)]
    tolerance: f64,

    /// Say what would be sent and why, and send nothing
    #[arg(long)]
    dry_run: bool,

    /// Cancel a job at its printer, by the job's address
    #[arg(long, value_name = "JOB-URI", value_parser = Address::parse, conflicts_with_all = ["files", "to", "remember", "dry_run"])]
    cancel: Option<Address>,

    /// Put the document into a file first, and send it with its length, for printers that take no other
    #[arg(long)]
    spool: bool,

    #[command(flatten)]
    patience: Patience,

    #[command(flatten)]
    fonts: FontOptions,

    #[command(flatten)]
    work: Work,
}

/// For how long a printer is asked.
#[derive(clap::Args)]
pub struct Patience {
    /// Ask a printer that is busy or does not answer again for so many seconds
    #[arg(long, value_name = "S", default_value = "120", value_parser = seconds)]
    wait: std::time::Duration,

    /// Follow a job that the printer has for so many seconds
    #[arg(long, value_name = "S", default_value = "86400", value_parser = seconds)]
    follow: std::time::Duration,

    /// Largest document that is put into a file first, in bytes
    #[arg(long, value_name = "BYTES", default_value = "16G", value_parser = values::bytes)]
    max_spool: u64,
}

impl Patience {
    fn limits(&self) -> Limits {
        Limits { wait: self.wait, follow: self.follow, spool: self.max_spool, ..Limits::default() }
    }
}

/// Numbers of pages, from 1, in ranges.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Pages(Vec<(usize, usize)>);

fn pages(text: &str) -> Result<Pages, String> {
    let number = |text: &str| text.trim().parse::<usize>().ok().filter(|n| (1..=1_000_000).contains(n));
    let range = |part: &str| {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        Some((number(first)?, number(last)?)).filter(|(first, last)| first <= last)
    };
    let ranges: Option<Vec<_>> = text.split(',').map(range).collect();
    ranges.map(Pages).ok_or_else(|| "give numbers of pages from 1 on, such as 1-3,5".to_owned())
}

fn bleed(text: &str) -> Result<f64, String> {
    let zero = text.parse::<f64>().is_ok_and(|x| x == 0.0);
    let mm = if zero { Ok(0.0) } else { positive(text) };
    mm.ok().filter(|mm| *mm <= 1000.0).ok_or_else(|| "give a number of millimetres from 0 to 1000".to_owned())
}

fn format() -> impl clap::builder::TypedValueParser<Value = &'static Format> {
    use clap::builder::TypedValueParser as _;
    let names = FORMATS.iter().map(|format| clap::builder::PossibleValue::new(format.name).help(format.about));
    clap::builder::PossibleValuesParser::new(names).map(|name| runset::encode::by_name(&name).expect("one of them"))
}

fn scaling() -> impl clap::builder::TypedValueParser<Value = Scaling> {
    use clap::builder::TypedValueParser as _;
    clap::builder::PossibleValuesParser::new(Scaling::ALL.map(Scaling::name))
        .map(|name| Scaling::ALL.into_iter().find(|scaling| scaling.name() == name).expect("one of them"))
}

fn quality() -> impl clap::builder::TypedValueParser<Value = Quality> {
    use clap::builder::TypedValueParser as _;
    clap::builder::PossibleValuesParser::new(Quality::ALL.map(Quality::name))
        .map(|name| Quality::ALL.into_iter().find(|quality| quality.name() == name).expect("one of them"))
}

/// A page that is to be printed.
struct Page {
    name: String,
    scene: Scene,
}

/// Runs the subcommand. `started` is when the process began.
///
/// # Errors
/// Whatever keeps the drawings from being printed.
pub fn run(args: &Print, started: Instant) -> Result<(), Failure> {
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build();
    let runtime = runtime.map_err(|error| Failure::at("runset", error))?;
    let caught = Arc::new(AtomicI32::new(0));
    let ended = runtime.block_on(async {
        let cancelled = CancellationToken::new();
        tokio::spawn(signals(cancelled.clone(), caught.clone()));
        if let Some(job) = &args.cancel {
            let client = Client::new(job.clone(), args.patience.limits());
            return print::cancel(&client, job).await.map_err(failure);
        }
        print_all(args, started, &cancelled).await
    });
    // A renderer that nobody waits for any more ends by itself.
    runtime.shutdown_background();
    match caught.load(Ordering::Acquire) {
        0 => ended,
        signal => {
            if let Err(Failure::Failed(line)) = ended {
                tell(&line);
            }
            let _ = signal_hook::low_level::emulate_default_handler(signal);
            std::process::exit(128 + signal);
        }
    }
}

/// Cancels at the first signal; the second ends the process at once.
async fn signals(cancelled: CancellationToken, caught: Arc<AtomicI32>) {
    use tokio::signal::unix::{SignalKind, signal};
    let (Ok(mut term), Ok(mut int)) = (signal(SignalKind::terminate()), signal(SignalKind::interrupt())) else { return };
    loop {
        let signal = tokio::select! {
            _ = term.recv() => 15,
            _ = int.recv() => 2,
        };
        if caught.swap(signal, Ordering::AcqRel) != 0 {
            std::process::exit(128 + signal);
        }
        cancelled.cancel();
    }
}

fn failure(failure: Unprinted) -> Failure {
    match failure.why {
        Why::Wish => Failure::Usage(failure.what),
        _ => Failure::Failed(failure.what),
    }
}

async fn print_all(args: &Print, started: Instant, cancelled: &CancellationToken) -> Result<(), Failure> {
    let address = match &args.to {
        Some(address) => address.clone(),
        None => known()?.ok_or_else(|| Failure::Usage("no printer is remembered: name one with --to, see runset printers".to_owned()))?,
    };
    let pages = read(args)?;
    let client = Client::new(address.clone(), args.patience.limits());
    let mut said = Said::default();
    let asked = tokio::select! {
        asked = print::ask(&client, |why| said.once(&waiting(&why.what))) => asked,
        () = cancelled.cancelled() => Err(Unprinted::new(Why::Cancelled, "cancelled: nothing was sent")),
    };
    let printer = asked.map_err(failure)?;
    if args.remember {
        remember(&address)?;
    }
    let wishes = Wishes {
        format: args.format,
        dpi: args.dpi,
        media: args.media.clone(),
        scaling: args.print_scaling,
        turn: !args.no_turn,
        copies: args.copies,
        quality: args.print_quality,
    };
    let inks = pages.iter().map(|page| sheet::pixels(&page.scene, args.expr.as_deref()));
    let inks = inks.max_by_key(|inks| *inks as u8).unwrap_or(Pixels::Black);
    let choice = choice::choose(&printer, &wishes, sheet::size(&pages[0].scene), inks).map_err(failure)?;
    tell(&format!("{address}: {}", choice.line()));
    let pages = prepare(args, started, pages, &choice, &wishes)?;
    let all: Vec<_> = (0..choice.repeats).flat_map(|_| pages.iter().cloned()).collect();
    // A document holds all pages, or one.
    let documents: Vec<&[(String, Job)]> = if choice.format.pages { vec![&all] } else { all.chunks(1).collect() };
    if args.dry_run {
        dry(&address, &choice, &documents);
        return Ok(());
    }
    for pages in documents {
        send(args, &client, &choice, pages.to_vec(), cancelled).await?;
    }
    Ok(())
}

/// Says what would be sent.
fn dry(address: &Address, choice: &Choice, documents: &[&[(String, Job)]]) {
    for (i, pages) in documents.iter().enumerate() {
        for (title, job) in *pages {
            let (sheet, header) = (&choice.sheet, job.header());
            tell(&format!("document {}: {title}: {} x {} px, {} copies", i + 1, header.width, header.height(), choice.copies));
            if i == 0 {
                let [x, y] = sheet.placement.offset;
                tell(&format!("{title}: the drawing at {x:.1}, {y:.1} px, {:.4} px to a user unit", sheet.placement.scale));
            }
        }
    }
    let attributes: Vec<String> = choice.attributes.iter().map(|(name, value)| format!("{name}={value}")).collect();
    tell(&format!("{address}: job attributes {}", attributes.join(" ")));
    tell(&format!("{address}: nothing was sent"));
}

/// Reads the pages that are wanted.
fn read(args: &Print) -> Result<Vec<Page>, Failure> {
    let wanted: Vec<usize> = match &args.pages {
        None => (1..=args.files.len()).collect(),
        Some(Pages(ranges)) => {
            ranges.iter().flat_map(|(first, last)| *first..=*last).take_while(|page| *page <= args.files.len() + 1).collect()
        }
    };
    let limits = args.work.limits();
    let fonts = args.fonts.load(&args.work.limit)?;
    let mut pages = Vec::new();
    for page in wanted {
        let Some(file) = args.files.get(page - 1) else {
            return Err(Failure::Usage(format!("there is no page {page}: {} files are given", args.files.len())));
        };
        let source = Source::find(file)?;
        let name = source.name();
        let ends = Ends { input: &name, output: "printer" };
        let mut warnings = Vec::new();
        let read = runset::input::read_with(source.read(limits.input)?, &limits, &fonts, &mut warnings);
        let scene = read.map_err(|error| ends.failure(&error))?;
        ends.warn(&warnings, args.work.strict)?;
        pages.push(Page { name, scene });
    }
    Ok(pages)
}

/// Prepares the pages, each on a sheet of its own.
fn prepare(args: &Print, started: Instant, pages: Vec<Page>, choice: &Choice, wishes: &Wishes) -> Result<Vec<(String, Job)>, Failure> {
    let limits = args.work.limits();
    let prepared = pages.into_iter().map(|Page { name, mut scene }| {
        let ends = Ends { input: &name, output: "printer" };
        let mut warnings = Vec::new();
        let sheet = choice.place(sheet::size(&scene), wishes);
        let options = sheet::compose(&mut scene, args.expr.as_deref(), args.bleed * 100.0, &sheet, &limits, &mut warnings)
            .map_err(|error| ends.failure(&error))?;
        let options = Options { tolerance: args.tolerance, started, ..options };
        let job = Job::prepare(scene, &options, &mut warnings).map_err(|error| ends.failure(&error))?;
        ends.warn(&warnings, args.work.strict)?;
        choice.format.check(job.header()).map_err(|error| ends.failure(&error))?;
        Ok((name, job))
    });
    prepared.collect()
}

async fn send(
    args: &Print,
    client: &Client,
    choice: &Choice,
    pages: Vec<(String, Job)>,
    cancelled: &CancellationToken,
) -> Result<(), Failure> {
    let title = match &pages[..] {
        [(title, _)] => title.clone(),
        [(title, _), others @ ..] => format!("{title} and {} more", others.len()),
        [] => return Ok(()),
    };
    let errand = Errand {
        title,
        format: choice.format.media_type,
        attributes: choice.attributes.clone(),
        pages: u32::try_from(pages.len()).unwrap_or(u32::MAX),
        spool: args.spool,
    };
    let jobs: Arc<Vec<Job>> = Arc::new(pages.into_iter().map(|(_, job)| job).collect());
    let total = jobs.iter().fold(0_u32, |lines, job| lines.saturating_add(job.header().height()));
    let lines = Arc::new(AtomicU32::new(0));
    let stats = Arc::new(Mutex::new(Vec::new()));
    let mut document =
        Rendered { format: choice.format, threads: args.work.limits().threads, lines: lines.clone(), stats: stats.clone(), jobs };
    let mut shown = Shown { client, progress: Some(Progress::new(&args.work.watch, Some(total), false)), lines, said: Said::default() };
    let printed = print::run(client, &errand, &mut document, Stage::New, &mut shown, cancelled).await;
    drop(shown);
    let printed = printed.map_err(failure)?;
    let count = printed.status.impressions.filter(|n| *n > 0).map_or_else(String::new, |n| format!(", {n} impressions"));
    tell(&format!("{}: the job {} is printed{count}", client.name(), printed.job.id));
    stats.lock().unwrap_or_else(PoisonError::into_inner).iter().for_each(|stats| args.work.tell(stats));
    Ok(())
}

/// Pages that are rendered as the printer takes them.
struct Rendered {
    jobs: Arc<Vec<Job>>,
    format: &'static Format,
    threads: usize,
    /// Lines of all pages that were written.
    lines: Arc<AtomicU32>,
    /// Of each page, once all are written.
    stats: Arc<Mutex<Vec<Stats>>>,
}

impl Document for Rendered {
    async fn open(&mut self, _length: bool) -> Result<Body, Unprinted> {
        let (jobs, format, threads) = (self.jobs.clone(), self.format, self.threads);
        let (lines, stats) = (self.lines.clone(), self.stats.clone());
        let body = Body::made(move |out| {
            let before = |page: u32| jobs[..page as usize].iter().fold(0_u32, |lines, job| lines.saturating_add(job.header().height()));
            let mut progress = |page: u32, done: u32| lines.store(before(page).saturating_add(done), Ordering::Relaxed);
            let mut page = |page: u32| Ok(jobs[page as usize].clone());
            let of = u32::try_from(jobs.len()).unwrap_or(u32::MAX);
            let done = render_sheets(of, &mut page, format, threads, out, &mut progress)?;
            *stats.lock().unwrap_or_else(PoisonError::into_inner) = done;
            Ok(())
        });
        body.map_err(|error| Unprinted::new(Why::Raster, error.to_string()))
    }
}

/// Tells a user how an errand gets on.
struct Shown<'c> {
    client: &'c Client,
    progress: Option<Progress>,
    lines: Arc<AtomicU32>,
    said: Said,
}

/// What is said while a printer is asked again.
fn waiting(why: &str) -> String {
    format!("{why}; waiting")
}

impl Watch for Shown<'_> {
    async fn reached(&mut self, stage: &Stage) -> Result<(), Unprinted> {
        match stage {
            // Whoever reads it may be gone: the job is not.
            Stage::Created(job) => drop(say(&format!("{}\n", job.uri))),
            Stage::Sent(_) => self.progress = None,
            Stage::New | Stage::Sending(_) => {}
        }
        Ok(())
    }

    fn waits(&mut self, why: &str) {
        self.said.once(&waiting(why));
    }

    fn sent(&mut self, _bytes: u64) {
        let lines = self.lines.load(Ordering::Relaxed);
        self.progress.iter_mut().for_each(|progress| progress.set(lines));
    }

    fn prints(&mut self, status: &Status) {
        if !status.state.is_final() && !status.reasons.is_empty() {
            self.said.once(&format!("{}: {}", self.client.name(), status.told()));
        }
    }
}

/// The last few lines that were told: none of them is told again.
#[derive(Default)]
struct Said(VecDeque<String>);

impl Said {
    fn once(&mut self, line: &str) {
        if self.0.iter().all(|said| said != line) {
            tell(line);
            self.0.truncate(7);
            self.0.push_front(line.to_owned());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_are_ranges_from_one() {
        assert_eq!(pages("1-3,5"), Ok(Pages(vec![(1, 3), (5, 5)])));
        assert_eq!(pages("2, 1"), Ok(Pages(vec![(2, 2), (1, 1)])));
        for text in ["", "0", "3-1", "1-", "-1", "a", "1,,2", "1-2-3", "99999999999999999999"] {
            assert!(pages(text).is_err(), "{text}");
        }
    }
}
