//! `GET /v1/jobs/{id}/events`: how a job gets on, as server-sent events.

use std::convert::Infallible;
use std::time::Duration;

use axum::extract::State;
use axum::response::sse::{Event, KeepAlive, Sse};
use futures_util::Stream;
use futures_util::stream;

use super::super::Service;
use super::super::problem::{Details, Problem};
use super::{Id, Phase};

/// Events follow each other at this distance at least.
const DISTANCE: Duration = Duration::from_millis(200);

/// Silence after which a comment is sent, so that whatever stands between sees that the stream lives.
const KEEP_ALIVE: Duration = Duration::from_secs(15);

/// How a job gets on
///
/// Server-sent events of the type `progress`, each with the job as its data: one at once, then one whenever it changes, at most five a second. Behind one whose
/// state is `done`, `failed` or `cancelled` the stream ends.
#[utoipa::path(
    get,
    path = "/v1/jobs/{id}/events",
    tag = "jobs",
    params(("id" = String, Path, description = "The job's id")),
    responses(
        (status = 200, description = "Events", body = String, content_type = "text/event-stream"),
        (status = 404, description = "There is no such job", body = Details, content_type = "application/problem+json"),
        (status = 503, description = "Too many are followed", body = Details, content_type = "application/problem+json"),
    )
)]
pub async fn events(State(service): State<Service>, Id(id): Id) -> Result<Sse<impl Stream<Item = Result<Event, Infallible>>>, Problem> {
    let live = service.jobs.find(&id)?;
    let full = || Problem::busy("events", "too many event streams are open: try again later", 5);
    let place = service.events.clone().try_acquire_owned().map_err(|_| full())?;
    let changes = live.changes.subscribe();
    let ending = service.ending.clone();
    let events = stream::unfold((changes, false, false), move |(mut changes, begun, ended)| {
        let (live, ending, _place) = (live.clone(), ending.clone(), &place);
        async move {
            if ended {
                return None;
            }
            if begun {
                tokio::select! {
                    () = ending.cancelled() => return None,
                    () = tokio::time::sleep(DISTANCE) => {}
                }
                tokio::select! {
                    () = ending.cancelled() => return None,
                    changed = changes.changed() => changed.ok()?,
                }
            }
            changes.mark_unchanged();
            let view = live.view();
            let ended = matches!(view.state, Phase::Done | Phase::Failed | Phase::Cancelled);
            let event = Event::default().event("progress").json_data(&view).unwrap_or_else(|_| Event::default().comment("no data"));
            Some((Ok(event), (changes, true, ended)))
        }
    });
    Ok(Sse::new(events).keep_alive(KeepAlive::new().interval(KEEP_ALIVE)))
}
