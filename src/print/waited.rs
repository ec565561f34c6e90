//! How long a printer has been waited for.

use std::time::Duration;

use tokio::time::{Instant, sleep};

use super::errand::Watch;
use super::failure::Failure;

/// How long a printer has been waited for.
pub(super) struct Waited {
    limit: Duration,
    since: Option<Instant>,
    pauses: Pauses,
}

impl Waited {
    pub(super) fn new(limit: Duration) -> Waited {
        Waited { limit, since: None, pauses: Pauses::new() }
    }

    /// Waits a while, or is the failure itself if it was waited for long enough.
    pub(super) async fn pause(&mut self, failure: Failure, watch: &mut impl Watch) -> Result<(), Failure> {
        let since = *self.since.get_or_insert_with(Instant::now);
        if since.elapsed() >= self.limit {
            let what = format!("{} (asked again for {:.1} s: --wait says for how long)", failure.what, since.elapsed().as_secs_f32());
            return Err(Failure::new(failure.why, what));
        }
        watch.waits(&failure.what);
        sleep(self.pauses.next()).await;
        Ok(())
    }

    /// The printer answers again.
    pub(super) fn over(&mut self) {
        *self = Waited::new(self.limit);
    }
}

/// How long it is waited between two questions: twice as long each time, up to some seconds.
pub(super) struct Pauses(Duration);

impl Pauses {
    pub(super) fn new() -> Pauses {
        Pauses(Duration::from_millis(100))
    }

    pub(super) fn next(&mut self) -> Duration {
        let pause = self.0;
        self.0 = (2 * pause).min(Duration::from_secs(5));
        pause
    }
}
