//! The trial's clock: how the clock stops and continues. The clock stands still in pauses and freeze probes.

use super::phase::TrialPhase;
use super::session_state::Session;
use tomcom_core::base::time::SessionTime;

/// Pauses the trial and stops its clock.
pub(super) fn pause(session: &mut Session, now: SessionTime) {
    stop(session, now);
    session.phase = TrialPhase::Paused;
    session.gaze.measured = None;
}

/// Stops the trial's clock, if it is running.
pub(super) fn stop(session: &mut Session, now: SessionTime) {
    match session.phase {
        TrialPhase::Running => session.paused_at = now,
        TrialPhase::Ready => {
            session.trial_start = now;
            session.paused_at = now;
        }
        _ => {}
    }
}

/// Resumes the trial; returns for how long the trial stood still, by which all pending times have to be postponed.
pub(super) fn resume(session: &mut Session, now: SessionTime) -> SessionTime {
    let by = now - session.paused_at;
    session.pauses.push((session.paused_at, now));
    session.gaze.measured = None;
    session.paused_total = session.paused_total + by;
    session.phase = TrialPhase::Running;
    if let Some((_, _, until)) = &mut session.robot.intention {
        *until = *until + by;
    }
    if let Some(shown) = &mut session.shown {
        shown.until = shown.until + by;
    }
    by
}
