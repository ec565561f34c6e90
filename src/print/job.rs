//! A job as its printer sees it (RFC 8011, section 5.3).

use ipp::model::Operation;
use ipp::value::IppValue;
use serde::{Deserialize, Serialize};

use super::client::Client;
use super::failure::{Failure, Why};
use super::message::{Answer, Attributes, Request, keywords, title};

/// What tells a job from others at its printer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Job {
    /// Its number there.
    pub id: i32,
    /// Its address, for people and for other programs.
    pub uri: String,
}

/// The states of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum State {
    /// It waits.
    Pending,
    /// It waits for something: a document, or a word.
    Held,
    /// It is being printed.
    Processing,
    /// Printing has stopped.
    Stopped,
    /// It was cancelled.
    Canceled,
    /// The printer gave it up.
    Aborted,
    /// It is printed.
    Completed,
}

impl State {
    fn of(number: i32) -> Option<State> {
        Some(match number {
            3 => State::Pending,
            4 => State::Held,
            5 => State::Processing,
            6 => State::Stopped,
            7 => State::Canceled,
            8 => State::Aborted,
            9 => State::Completed,
            _ => return None,
        })
    }

    /// Whether it stays so.
    pub fn is_final(self) -> bool {
        matches!(self, State::Canceled | State::Aborted | State::Completed)
    }

    /// Its keyword.
    pub fn name(self) -> &'static str {
        match self {
            State::Pending => "pending",
            State::Held => "pending-held",
            State::Processing => "processing",
            State::Stopped => "processing-stopped",
            State::Canceled => "canceled",
            State::Aborted => "aborted",
            State::Completed => "completed",
        }
    }
}

/// What a printer says of a job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Status {
    /// How it is.
    pub state: State,
    /// Why, as keywords.
    pub reasons: Vec<String>,
    /// In the printer's words.
    pub message: Option<String>,
    /// Sides of sheets that are printed.
    pub impressions: Option<i32>,
    /// Documents that it has received.
    pub documents: Option<i32>,
}

const ASKED: [&str; 6] = [
    "job-state",
    "job-state-reasons",
    "job-state-message",
    "job-impressions-completed",
    "number-of-documents",
    "job-printer-state-reasons",
];

impl Status {
    /// What an answer says.
    pub(super) fn of(job: Attributes<'_>) -> Option<Status> {
        let mut reasons = job.texts("job-state-reasons");
        reasons.extend(job.texts("job-printer-state-reasons"));
        reasons.retain(|reason| reason != "none");
        Some(Status {
            state: State::of(job.number("job-state")?)?,
            reasons,
            message: job.text("job-state-message").map(str::to_owned),
            impressions: job.number("job-impressions-completed"),
            documents: job.number("number-of-documents"),
        })
    }

    /// Whether the printer says that it waits for a document and has nothing of one. `untouched`: nothing of it was sent, or the printer has refused it.
    pub(super) fn has_nothing(&self, untouched: bool) -> bool {
        let has = |reason: &str| self.reasons.iter().any(|own| own == reason);
        let waits = matches!(self.state, State::Pending | State::Held) && !has("job-incoming");
        waits
            && match self.documents {
                Some(documents) => documents == 0,
                None => untouched && has("job-data-insufficient"),
            }
    }

    /// The state with its reasons.
    pub fn told(&self) -> String {
        let mut text = self.state.name().to_owned();
        if !self.reasons.is_empty() {
            text.push_str(&format!(" ({})", self.reasons.join(", ")));
        }
        text
    }
}

/// Asks a printer about a job; none if it does not know it (any more).
///
/// # Errors
/// It does not answer, or with something else.
pub(super) async fn status(client: &Client, job: &Job) -> Result<Option<Status>, Failure> {
    let request = about(client, Operation::GetJobAttributes, job).with("requested-attributes", keywords(&ASKED));
    let answer = client.ask(&request).await?;
    match answer.status {
        // Not found, gone.
        0x0406 | 0x0407 => Ok(None),
        _ if answer.is_success() => {
            let strange = || Failure::new(Why::Malformed, format!("{}: the printer tells no state of job {}", client.name(), job.id));
            Status::of(answer.job()).map(Some).ok_or_else(strange)
        }
        _ => Err(refused(client, &answer, "it does not tell how the job is")),
    }
}

/// Asks a printer to cancel a job. A job that is not there, or has ended, is as good as cancelled.
pub(super) async fn cancel(client: &Client, job: &Job) -> Result<(), Failure> {
    let answer = client.ask(&about(client, Operation::CancelJob, job)).await?;
    match answer.status {
        // Not possible (it has ended), not found, gone.
        0x0404 | 0x0406 | 0x0407 => Ok(()),
        _ if answer.is_success() => Ok(()),
        _ => Err(refused(client, &answer, "it does not cancel the job")),
    }
}

/// A request about a job.
pub(super) fn about(client: &Client, operation: Operation, job: &Job) -> Request {
    Request::new(operation, "printer-uri", &client.address)
        .with("job-id", IppValue::Integer(job.id))
        .with("requesting-user-name", title(&user()))
}

/// Who prints.
pub(super) fn user() -> String {
    let named = ["USER", "LOGNAME"].into_iter().find_map(|name| std::env::var(name).ok().filter(|user| !user.is_empty()));
    named.unwrap_or_else(|| "anonymous".to_owned())
}

/// The failure that an answer without success is.
pub(super) fn refused(client: &Client, answer: &Answer, what: &str) -> Failure {
    let why = match answer.status {
        // Service unavailable, temporary error, not accepting jobs, busy.
        0x0502 | 0x0505 | 0x0506 | 0x0507 => Why::Busy,
        _ => Why::Refused,
    };
    Failure::new(why, format!("{}: {what}: {}", client.name(), answer.complaint()))
}
