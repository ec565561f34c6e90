//! An errand: a document goes to a printer, once.

use std::future::Future;

use ipp::model::{DelimiterTag, Operation};
use ipp::value::IppValue;
use serde::{Deserialize, Serialize};
use tokio_util::sync::CancellationToken;

use super::address::Address;
use super::body::Body;
use super::client::Client;
use super::failure::{Failure, Why};
use super::job::{Job, Status, refused, user};
use super::message::{Request, media_type, title};
use super::sending::Broken;
use super::waited::Waited;

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

/// An errand under way.
pub(super) struct Run<'r, W> {
    pub(super) client: &'r Client,
    pub(super) errand: &'r Errand,
    pub(super) stage: Stage,
    pub(super) watch: &'r mut W,
    /// Whether the length of the document has to be known.
    pub(super) length: bool,
}

impl<W: Watch> Run<'_, W> {
    async fn all(&mut self, document: &mut impl Document) -> Result<Printed, Failure> {
        let mut waited = Waited::new(self.client.limits.wait);
        // A process before this one was sending: what the printer has of it only the printer knows.
        if let Stage::Sending(job) = self.stage.clone() {
            let failure = Failure::new(Why::Broken, format!("{}: sending was interrupted", self.client.name()));
            self.recover(job, Broken { failure, untouched: false }, &mut waited).await?;
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
                    self.recover(job, Broken { failure, untouched: false }, &mut waited).await?;
                }
                Stage::Sent(job) => return self.follow(job).await,
            }
        }
    }

    pub(super) async fn reach(&mut self, stage: Stage) -> Result<(), Failure> {
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

    /// Cancels what there is.
    async fn cancel(mut self) -> Failure {
        let what = match self.stage.job().cloned() {
            None => "cancelled: the printer has no job".to_owned(),
            Some(job) => format!("cancelled: {}", self.cancel_at_printer(&job).await),
        };
        Failure::new(Why::Cancelled, what)
    }
}
