//! Unusual silence: the human has not pressed for three of the human's own usual intervals between presses, and may be
//! stuck.
//!
//! [`apply()`](super::apply()) sets a timer at the start of the trial, at every counted press of the human and at every
//! event `human_waits`, by which the running session records that the timer is due. So the event comes once for every
//! such time that passes without a press.

use super::session_state::Session;
use super::timeline_entry::TimelineEvent;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::Agent;

/// Number of the human's usual intervals between presses after which silence is unusual.
const INTERVALS: u64 = 3;
/// Least unusual silence, in nanoseconds: 6 s, three usual intervals of the paper's participants.
const LEAST: SessionTime = SessionTime(6_000_000_000);

/// The time without a press after which silence is unusual: three of the human's usual intervals in this trial (the
/// median of the intervals between counted presses, without pauses), and at least 6 s.
pub(super) fn unusual(session: &Session) -> SessionTime {
    let times: Vec<SessionTime> = own_presses(session).collect();
    let mut intervals: Vec<SessionTime> = times.windows(2).map(|pair| session.age(pair[1], pair[0])).collect();
    intervals.sort_unstable();
    let usual = intervals.get(intervals.len() / 2).copied().unwrap_or_default();
    SessionTime(INTERVALS * usual.0).max(LEAST)
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
