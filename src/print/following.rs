//! A job that its printer has is followed to its end, or cancelled there.

use std::time::Duration;

use tokio::time::{Instant, sleep};

use super::errand::{Printed, Run, Watch};
use super::failure::{Failure, Why};
use super::job::{self, Job, State, Status};
use super::waited::Waited;

/// How often a job is asked for that its printer has.
pub(super) const LOOK: Duration = Duration::from_millis(500);

/// How long a printer is given to end a job that it is to cancel.
const CANCELLING: Duration = Duration::from_secs(10);

impl<W: Watch> Run<'_, W> {
    /// Follows a job that the printer has, to its end.
    pub(super) async fn follow(&mut self, job: Job) -> Result<Printed, Failure> {
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

    /// Cancels a job and says what came of that.
    pub(super) async fn cancel_at_printer(&mut self, job: &Job) -> String {
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
}

/// What the printer has counted, for messages.
pub(super) fn counted(status: &Status) -> String {
    match status.impressions {
        Some(n) if n > 0 => format!(", {n} impressions printed"),
        _ => String::new(),
    }
}
