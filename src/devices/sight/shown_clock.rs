//! The trial's clock on the display. The page counts down by itself: a message tells the page whether the clock goes,
//! and the time that is left.

use serde::Serialize;

use super::probe_page::probe_left;
use tomcom_core::base::time::SessionTime;
use tomcom_session::Session;

/// Whether the trial's clock on the display goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TrialClockState {
    /// The trial's clock goes.
    Goes,
    /// The trial's clock stands still: before the trial, in a pause, and at the end.
    Stands,
}

/// The time left that the page shows at `now`: the time that an open probe still has, or else the time that the trial
/// still has, if the display shows the trial's clock.
pub fn time_left(session: &Session, now: SessionTime) -> Option<SessionTime> {
    let of_trial = || {
        let limit = SessionTime::from_secs_f64(session.spec.trial.seconds);
        let passed = session.trial_clock(now);
        session.spec.display.clock.then(|| SessionTime(limit.0.saturating_sub(passed.0)))
    };
    probe_left(session, now).or_else(of_trial)
}
