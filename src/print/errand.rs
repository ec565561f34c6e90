//! An errand: a document goes to a printer, once.

use std::future::Future;
use std::sync::Arc;
use std::time::Duration;

use ipp::model::{DelimiterTag, Operation};
use ipp::value::IppValue;
use serde::{Deserialize, Serialize};
use tokio::time::{Instant, sleep};
use tokio_util::sync::CancellationToken;

use super::address::Address;
use super::body::Body;
use super::client::{Client, Pauses, Way};
use super::failure::{Failure, Why};
use super::job::{self, Job, State, Status, refused, user};
use super::message::{Request, media_type, title};

/// How often a job is asked for that its printer has.
const LOOK: Duration = Duration::from_millis(500);

/// How long a printer is given to end a job that it is to cancel.
const CANCELLING: Duration = Duration::from_secs(10);

/// What is to be printed.
pub trait Document: Send {
    /// Its bytes, from the first on; with `length` their number has to be known. Asked for again only if the printer has nothing of it.
    fn open(&mut self, length: bool) -> impl Future<Output = Result<Body, Failure>> + Send;
}

/// Who is told how an errand gets on.
pub trait Watch: Send {
    /// An errand comes to a stage. What comes next waits until this is done, and is not done if it fails.
    fn reached(&mut self, stage: &Stage) -> impl Future<Output = Result<(), Failure>> + Send;
    /// It waits, and why.
    fn waits(&mut self, why: &str);
    /// So many bytes of the document were sent.
    fn sent(&mut self, bytes: u64);
    /// What the printer says of the job.
    fn prints(&mut self, status: &Status);
}

/// How far an errand is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "stage", rename_all = "lowercase")]
pub enum Stage {
    /// The printer knows of nothing, or of a job without a document, which it ends by itself.
    New,
    /// The printer has made a job, and nothing was sent.
    Created(Job),
    /// The document is on its way.
    Sending(Job),
    /// The printer has confirmed the whole document.
    Sent(Job),
}

impl Stage {
    /// The job at the printer.
    pub fn job(&self) -> Option<&Job> {
        match self {
            Stage::New => None,
            Stage::Created(job) | Stage::Sending(job) | Stage::Sent(job) => Some(job),
        }
    }
}

/// What is asked of the printer.
#[derive(Clone, Debug)]
pub struct Errand {
    /// A name for the job.
    pub title: String,
    /// Media type of the document.
    pub format: &'static str,
    /// Attributes of the job.
    pub attributes: Vec<(String, IppValue)>,
    /// Pages of the document, for the printer's count to be held against.
    pub pages: u32,
    /// Whether to send it with its length in any case.
    pub spool: bool,
}

/// A job that its printer has printed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Printed {
    /// The job.
    pub job: Job,
    /// What the printer says of it last.
    pub status: Status,
}

/// Sees an errand through, from the stage at which it is.
///
/// # Errors
/// It is not printed, or that is not known; the message says which.
pub async fn run(
    client: &Client,
    errand: &Errand,
    document: &mut impl Document,
    from: Stage,
    watch: &mut impl Watch,
    cancelled: &CancellationToken,
) -> Result<Printed, Failure> {
    let mut run = Run { client, errand, stage: from, watch, length: errand.spool || client.wants_length() };
    let ended = tokio::select! {
        biased;
        () = cancelled.cancelled() => None,
        ended = run.all(document) => Some(ended),
    };
    match ended {
        Some(ended) => ended,
        None => Err(run.cancel().await),
    }
}

/// Cancels a job at its printer, by its address.
///
/// # Errors
/// The printer does not do it, or does not answer.
pub async fn cancel(client: &Client, uri: &Address) -> Result<(), Failure> {
    let request = Request::new(Operation::CancelJob, "job-uri", uri).with("requesting-user-name", title(&user()));
    let answer = client.ask(&request).await?;
    if answer.is_success() { Ok(()) } else { Err(refused(client, &answer, "it does not cancel the job")) }
}

struct Run<'r, W> {
    client: &'r Client,
    errand: &'r Errand,
    stage: Stage,
    watch: &'r mut W,
    /// Whether the length of the document has to be known.
    length: bool,
}

/// What has become of a document on its way.
struct Broken {
    failure: Failure,
    /// Whether the printer cannot have anything of it: none of it was sent, or the printer has answered that it does not take it.
    untouched: bool,
    bytes: u64,
}

impl<W: Watch> Run<'_, W> {
    async fn all(&mut self, document: &mut impl Document) -> Result<Printed, Failure> {
        let mut waited = Waited::new(self.client.limits.wait);
        // A process before this one was sending: what the printer has of it only the printer knows.
        if let Stage::Sending(job) = self.stage.clone() {
            let failure = Failure::new(Why::Broken, format!("{}: sending was interrupted", self.client.name()));
            self.recover(job, Broken { failure, untouched: false, bytes: 0 }, &mut waited).await?;
        }
        loop {
            match self.stage.clone() {
                Stage::New => {
                    let job = self.create(&mut waited).await?;
                    self.reach(Stage::Created(job)).await?;
                }
                Stage::Created(job) => {
                    self.reach(Stage::Sending(job.clone())).await?;
                    match self.send(document, &job).await? {
                        Ok(()) => self.reach(Stage::Sent(job)).await?,
                        Err(broken) => self.recover(job, broken, &mut waited).await?,
                    }
                }
                Stage::Sending(job) => {
                    let failure = Failure::new(Why::Broken, "sending was interrupted");
                    self.recover(job, Broken { failure, untouched: false, bytes: 0 }, &mut waited).await?;
                }
                Stage::Sent(job) => return self.follow(job).await,
            }
        }
    }

    async fn reach(&mut self, stage: Stage) -> Result<(), Failure> {
        self.watch.reached(&stage).await?;
        self.stage = stage;
        Ok(())
    }

    /// Validate-Job and Create-Job, again while the printer is busy: nothing is printed of a job without a document.
    async fn create(&mut self, waited: &mut Waited) -> Result<Job, Failure> {
        let request = |operation: Operation| {
            Request::new(operation, "printer-uri", &self.client.address)
                .with("requesting-user-name", title(&user()))
                .with("job-name", title(&self.errand.title))
                .with("ipp-attribute-fidelity", IppValue::Boolean(true))
        };
        let validate =
            request(Operation::ValidateJob).with("document-format", media_type(self.errand.format)).with_job(&self.errand.attributes);
        let create = request(Operation::CreateJob).with_job(&self.errand.attributes);
        loop {
            let made = async {
                let answer = self.client.ask(&validate).await?;
                if !answer.is_success() {
                    return Err(refused(self.client, &answer, "it refuses the job"));
                }
                let answer = self.client.ask(&create).await?;
                if !answer.is_success() {
                    return Err(refused(self.client, &answer, "it makes no job"));
                }
                let told = answer.group(DelimiterTag::JobAttributes);
                let strange =
                    || Failure::new(Why::Malformed, format!("{}: the printer tells no number of the job that it made", self.client.name()));
                let id = told.number("job-id").filter(|id| *id > 0).ok_or_else(strange)?;
                // Its host may be a name that only the printer knows.
                let path = told.text("job-uri").and_then(|uri| Address::parse(uri).ok()).map(|uri| uri.path().to_owned());
                let uri = self.client.address.with_path(&path.unwrap_or_else(|| format!("{}/{id}", self.client.address.path())));
                Ok(Job { id, uri: uri.to_string() })
            };
            match made.await {
                Err(failure) if failure.is_passing() => waited.pause(failure, self.watch).await?,
                made => {
                    waited.over();
                    return made;
                }
            }
        }
    }

    /// Send-Document. The outer failure ends the errand: the raster itself could not be made.
    async fn send(&mut self, document: &mut impl Document, job: &Job) -> Result<Result<(), Broken>, Failure> {
        self.length |= self.client.wants_length();
        let body = match document.open(self.length).await {
            Ok(body) => body,
            Err(failure) => return Err(self.give_up(job, failure).await),
        };
        // Files and others alike: a length that is wanted is known.
        let body = if self.length {
            match body.spooled(self.client.limits.spool).await {
                Ok(body) => body,
                Err(failure) => return Err(self.give_up(job, failure).await),
            }
        } else {
            body
        };
        let request = job::about(self.client, Operation::SendDocument, job)
            .with("document-name", title(&self.errand.title))
            .with("document-format", media_type(self.errand.format))
            .with("last-document", IppValue::Boolean(true));
        let way = Arc::new(Way::default());
        let (mut seen, mut looked) = (0, Instant::now());
        let answered = {
            let sending = self.client.send(&request, body, way.clone());
            let mut sending = std::pin::pin!(sending);
            loop {
                tokio::select! {
                    answered = &mut sending => break Some(answered),
                    () = sleep(LOOK) => {}
                }
                let bytes = way.bytes();
                if bytes != seen {
                    (seen, looked) = (bytes, Instant::now());
                    self.watch.sent(bytes);
                    continue;
                }
                // Nothing moves: out of paper, or gone?
                match job::status(self.client, job).await {
                    Ok(Some(status)) if status.state == State::Canceled || status.state == State::Aborted => break None,
                    Ok(Some(status)) => {
                        looked = Instant::now();
                        self.watch.prints(&status);
                    }
                    Ok(None) => break None,
                    Err(_) if looked.elapsed() > self.client.limits.wait => break None,
                    Err(failure) => self.watch.waits(&failure.what),
                }
            }
        };
        let bytes = way.bytes();
        self.watch.sent(bytes);
        let untouched = bytes == 0;
        Ok(match answered {
            Some(Ok(answer)) if answer.is_success() && way.is_whole() => Ok(()),
            Some(Ok(answer)) if answer.is_success() => {
                let what = format!("{}: the printer answered before it had the whole document", self.client.name());
                Err(Broken { failure: Failure::new(Why::Broken, what), untouched: false, bytes })
            }
            Some(Ok(answer)) => {
                Err(Broken { failure: refused(self.client, &answer, "it does not take the document"), untouched: true, bytes })
            }
            Some(Err(failure)) if failure.why == Why::Raster => return Err(self.give_up(job, failure).await),
            Some(Err(failure)) => {
                let untouched = untouched || matches!(failure.why, Why::Length | Why::Unreachable | Why::Busy);
                self.length |= failure.why == Why::Length;
                Err(Broken { failure, untouched, bytes })
            }
            None => {
                let what = format!("{}: the printer took no more of the document after {bytes} bytes", self.client.name());
                Err(Broken { failure: Failure::new(Why::Broken, what), untouched, bytes })
            }
        })
    }

    /// Finds out at the printer what has become of a document that it did not confirm: it is sent again only if the printer has nothing of it.
    async fn recover(&mut self, job: Job, broken: Broken, waited: &mut Waited) -> Result<(), Failure> {
        let Broken { failure, untouched, bytes } = broken;
        let again = failure.is_passing() || failure.why == Why::Length;
        let status = loop {
            match job::status(self.client, &job).await {
                Ok(status) => break status,
                Err(lost) if lost.is_passing() => {
                    if let Err(lost) = waited.pause(lost, self.watch).await {
                        let what = format!(
                            "{}; then {}: whether anything is printed is not known; runset print --cancel {} cancels what is left",
                            failure.what, lost.what, job.uri
                        );
                        return Err(Failure::new(Why::Unknown, what));
                    }
                }
                Err(other) => return Err(other),
            }
        };
        match status {
            None if untouched && again => {
                // The printer has forgotten a job of which it never had anything.
                waited.pause(failure, self.watch).await?;
                self.reach(Stage::New).await
            }
            None => Err(Failure::new(
                Why::Unknown,
                format!("{}; the printer knows the job {} no more: look whether it is printed", failure.what, job.id),
            )),
            Some(status) if again && status.has_nothing(untouched) => {
                waited.pause(failure, self.watch).await?;
                self.reach(Stage::Created(job)).await
            }
            Some(status) if status.state == State::Canceled => {
                Err(Failure::new(Why::Cancelled, format!("{}: the job {} was cancelled at the printer", self.client.name(), job.id)))
            }
            Some(status) if status.state == State::Aborted && failure.why != Why::Refused => Err(Failure::new(
                Why::Aborted,
                format!("{}; the printer has given the job {} up: {}{}", failure.what, job.id, status.told(), counted(&status)),
            )),
            Some(status) if status.state == State::Completed => {
                let what = format!(
                    "{}; the printer calls the job {} completed although it did not confirm the whole document: look at the sheet",
                    failure.what, job.id
                );
                Err(Failure::new(Why::Unknown, what))
            }
            Some(_) => {
                let cut = if bytes > 0 && failure.why != Why::Refused { " of a document that was cut off" } else { "" };
                let told = self.give_up(&job, failure).await;
                Err(Failure::new(
                    told.why,
                    format!("{}{}", told.what, if cut.is_empty() { String::new() } else { format!(": nothing{cut} counts as printed") }),
                ))
            }
        }
    }

    /// Cancels the job at the printer, and tells that beside why.
    async fn give_up(&mut self, job: &Job, failure: Failure) -> Failure {
        let end = self.cancel_at_printer(job).await;
        Failure::new(failure.why, format!("{}; {end}", failure.what))
    }

    /// Cancels a job and says what came of that.
    async fn cancel_at_printer(&mut self, job: &Job) -> String {
        let asked = job::cancel(self.client, job).await;
        let deadline = Instant::now() + CANCELLING;
        if let Err(failure) = asked {
            return format!("the job {} could not be cancelled ({}): runset print --cancel {} tries again", job.id, failure.what, job.uri);
        }
        loop {
            match job::status(self.client, job).await {
                Ok(None) => return format!("the job {} was cancelled at the printer", job.id),
                Ok(Some(status)) if status.state == State::Completed => {
                    return format!("the printer had already completed the job {}", job.id);
                }
                Ok(Some(status)) if status.state.is_final() => {
                    return format!("the job {} was cancelled at the printer{}", job.id, counted(&status));
                }
                _ if Instant::now() > deadline => return format!("the printer was asked to cancel the job {}", job.id),
                _ => sleep(LOOK).await,
            }
        }
    }

    /// Follows a job that the printer has, to its end.
    async fn follow(&mut self, job: Job) -> Result<Printed, Failure> {
        let began = Instant::now();
        let name = self.client.name();
        let mut waited = Waited::new(self.client.limits.wait);
        loop {
            match job::status(self.client, &job).await {
                Ok(Some(status)) => {
                    waited.over();
                    self.watch.prints(&status);
                    if status.state.is_final() {
                        return self.end(job, status);
                    }
                }
                Ok(None) => {
                    let what =
                        format!("{name}: the printer knows the job {} no more, which it had received: look whether it is printed", job.id);
                    return Err(Failure::new(Why::Unknown, what));
                }
                Err(failure) if failure.is_passing() => {
                    if let Err(lost) = waited.pause(failure, self.watch).await {
                        let what = format!("{}; it has the whole document: whether the job {} is printed is not known", lost.what, job.id);
                        return Err(Failure::new(Why::Unknown, what));
                    }
                }
                Err(failure) => return Err(failure),
            }
            if began.elapsed() > self.client.limits.follow {
                let what = format!(
                    "{name}: the job {} is not printed after {} s: it is still at the printer ({})",
                    job.id,
                    began.elapsed().as_secs(),
                    job.uri
                );
                return Err(Failure::new(Why::Unknown, what));
            }
            sleep(LOOK).await;
        }
    }

    /// What the last word of the printer means.
    fn end(&self, job: Job, status: Status) -> Result<Printed, Failure> {
        let name = self.client.name();
        let failed = |why: Why, what: &str| {
            Err(Failure::new(why, format!("{name}: {what} the job {}: {}{}", job.id, status.told(), counted(&status))))
        };
        let has = |reason: &str| status.reasons.iter().any(|own| own == reason);
        let missing = status.impressions.is_some_and(|n| n > 0 && n.unsigned_abs() < self.errand.pages);
        match status.state {
            State::Canceled => failed(Why::Cancelled, "somebody cancelled"),
            State::Aborted => failed(Why::Aborted, "the printer gave up"),
            _ if has("job-completed-with-errors") || has("document-format-error") => failed(Why::Aborted, "the printer ended with errors"),
            _ if missing => failed(Why::Aborted, &format!("the printer has not printed all of {} pages of", self.errand.pages)),
            _ => Ok(Printed { job, status }),
        }
    }

    /// Cancels what there is.
    async fn cancel(mut self) -> Failure {
        let what = match self.stage.job().cloned() {
            None => "cancelled: the printer has no job".to_owned(),
            Some(job) => format!("cancelled: {}", self.cancel_at_printer(&job).await),
        };
        Failure::new(Why::Cancelled, what)
    }
}

fn counted(status: &Status) -> String {
    match status.impressions {
        Some(n) if n > 0 => format!(", {n} impressions printed"),
        _ => String::new(),
    }
}

/// How long a printer has been waited for.
struct Waited {
    limit: Duration,
    since: Option<Instant>,
    pauses: Pauses,
}

impl Waited {
    fn new(limit: Duration) -> Waited {
        Waited { limit, since: None, pauses: Pauses::new() }
    }

    /// Waits a while, or is the failure itself if it was waited for long enough.
    async fn pause(&mut self, failure: Failure, watch: &mut impl Watch) -> Result<(), Failure> {
        let since = *self.since.get_or_insert_with(Instant::now);
        if since.elapsed() >= self.limit {
            let what = format!("{} (asked again for {} s: --wait says for how long)", failure.what, since.elapsed().as_secs());
            return Err(Failure::new(failure.why, what));
        }
        watch.waits(&failure.what);
        sleep(self.pauses.next()).await;
        Ok(())
    }

    /// The printer answers again.
    fn over(&mut self) {
        *self = Waited::new(self.limit);
    }
}
