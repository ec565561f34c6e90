//! A document is sent, and what has become of one that its printer did not confirm is found out: it is sent again only if the printer has nothing of it.

use std::pin::pin;
use std::sync::Arc;

use ipp::model::Operation;
use ipp::value::IppValue;
use tokio::time::{Instant, sleep};

use super::client::Way;
use super::errand::{Document, Run, Stage, Watch};
use super::failure::{Failure, Why};
use super::following::{LOOK, counted};
use super::job::{self, Job, State, refused};
use super::message::{media_type, title};
use super::waited::Waited;

/// What has become of a document on its way.
pub(super) struct Broken {
    pub(super) failure: Failure,
    /// Whether the printer cannot have anything of it: none of it was sent, or the printer has answered that it does not take it.
    pub(super) untouched: bool,
}

impl<W: Watch> Run<'_, W> {
    /// Send-Document. The outer failure ends the errand: the raster itself could not be made.
    pub(super) async fn send(&mut self, document: &mut impl Document, job: &Job) -> Result<Result<(), Broken>, Failure> {
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
            let mut sending = pin!(sending);
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
                Err(Broken { failure: Failure::new(Why::Broken, what), untouched: false })
            }
            Some(Ok(answer)) => Err(Broken { failure: refused(self.client, &answer, "it does not take the document"), untouched: true }),
            Some(Err(failure)) if failure.why == Why::Raster => return Err(self.give_up(job, failure).await),
            Some(Err(failure)) => {
                let untouched = untouched || matches!(failure.why, Why::Length | Why::Unreachable | Why::Busy);
                self.length |= failure.why == Why::Length;
                Err(Broken { failure, untouched })
            }
            None => {
                let what = format!("{}: the printer took no more of the document after {bytes} bytes", self.client.name());
                Err(Broken { failure: Failure::new(Why::Broken, what), untouched })
            }
        })
    }

    /// Finds out at the printer what has become of a document that it did not confirm: it is sent again only if the printer has nothing of it.
    pub(super) async fn recover(&mut self, job: Job, broken: Broken, waited: &mut Waited) -> Result<(), Failure> {
        let Broken { failure, untouched } = broken;
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
            Some(_) => Err(self.give_up(&job, failure).await),
        }
    }

    /// Cancels the job at the printer, and tells that beside why.
    async fn give_up(&mut self, job: &Job, failure: Failure) -> Failure {
        let end = self.cancel_at_printer(job).await;
        Failure::new(failure.why, format!("{}; {end}", failure.what))
    }
}
