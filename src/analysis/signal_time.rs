//! How long signals stood on the participant's display.

use crate::base::time::SessionTime;
use crate::session::{Session, TimelineEvent};

/// Seconds of the trial's clock with a signal on the display. At most one is there at a time: a new one takes the place of the last.
pub fn signal_seconds(session: &Session) -> f64 {
    let (mut shown, mut seconds): (Option<SessionTime>, f64) = (None, 0.0);
    for entry in &session.timeline {
        let ends = match entry.what {
            TimelineEvent::Signal { .. } => shown.replace(entry.time),
            TimelineEvent::SignalEnded(_) => shown.take(),
            _ => None,
        };
        seconds += ends.map_or(0.0, |since| session.age(since, entry.time).as_secs_f64());
    }
    // The end of the trial takes the last one off the display.
    seconds + shown.map_or(0.0, |since| session.age(since, session.time).as_secs_f64())
}
