//! The trial's clock: how it stops and goes on. It stands still in pauses and freeze probes.

use super::phase::Phase;
use super::session_state::Session;
use crate::base::time::SessionTime;

/// Brings the trial to a stand.
pub(super) fn pause(session: &mut Session, now: SessionTime) {
    stop(session, now);
    session.phase = Phase::Paused;
    session.gaze.steady_since = None;
}

/// Stops the clock, if it goes.
pub(super) fn stop(session: &mut Session, now: SessionTime) {
    match session.phase {
        Phase::Running => session.paused_at = now,
        Phase::Ready => {
            session.trial_start = now;
            session.paused_at = now;
        }
        _ => {}
    }
}

/// Lets the trial go on; returns for how long it stood still, by which all pending times are to be postponed.
pub(super) fn resume(session: &mut Session, now: SessionTime) -> SessionTime {
    let by = now - session.paused_at;
    session.pauses.push((session.paused_at, now));
    session.gaze.steady_since = None;
    session.paused_total = session.paused_total + by;
    session.phase = Phase::Running;
    if let Some((_, _, until)) = &mut session.robot.intention {
        *until = *until + by;
    }
    if let Some(shown) = &mut session.shown {
        shown.until = shown.until + by;
    }
    by
}
