//! Unusual silence: the human has not pressed for longer than most of the human's own intervals between presses in this
//! trial.
//!
//! [`apply()`](super::apply()) sets a timer at every counted press of the human where
//! [`SessionSpec::notes_silence`](super::SessionSpec::notes_silence); the running session then records the event
//! `human_waits`, at most once between two presses.

use super::session_state::Session;
use super::timeline_entry::TimelineEvent;
use crate::base::time::SessionTime;
use crate::kitchen::Agent;

/// Share of the human's intervals between presses that are at most as long as the usual silence.
const USUAL_SHARE: f64 = 0.8;
/// Least number of intervals between presses from which the usual silence is computed; with fewer, no silence is
/// unusual.
const LEAST_INTERVALS: usize = 8;

/// The longest usual silence after a press that has just been applied: the 80th percentile (nearest rank) of the
/// human's own intervals in this trial, without pauses. `None`: too few intervals are known.
pub(super) fn unusual_after(session: &Session) -> Option<SessionTime> {
    let times: Vec<SessionTime> = own_presses(session).collect();
    let mut intervals: Vec<SessionTime> = times.windows(2).map(|pair| session.age(pair[1], pair[0])).collect();
    if intervals.len() < LEAST_INTERVALS {
        return None;
    }
    intervals.sort_unstable();
    let rank = (USUAL_SHARE * intervals.len() as f64).ceil() as usize;
    Some(intervals[rank - 1])
}

/// For how long the human has not pressed at `now`, without pauses; before the human's first press, the time since the
/// trial's start.
pub fn lasted(session: &Session, now: SessionTime) -> SessionTime {
    session.age(own_presses(session).next().unwrap_or(session.trial_start), now)
}

/// Session times of the human's counted presses, the latest first.
fn own_presses(session: &Session) -> impl Iterator<Item = SessionTime> + '_ {
    let is_own = |what: &TimelineEvent| matches!(what, TimelineEvent::Press { agent: Agent::Human, .. });
    session.timeline.iter().rev().filter(move |entry| is_own(&entry.what)).map(|entry| entry.time)
}
