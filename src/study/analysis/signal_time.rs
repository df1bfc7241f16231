//! Time for which signals were shown on the participant's display.

use tomcom_core::base::time::SessionTime;
use tomcom_session::wizard_log::clock_at;
use tomcom_session::{Event, Session, TimestampedEvent};

/// Session times at which signals appeared on the display (true) and vanished (false).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SignalTimes {
    changes: Vec<(SessionTime, bool)>,
}

impl SignalTimes {
    /// Notes when the next event of the session makes a signal appear or vanish.
    pub fn note(&mut self, stamped: &TimestampedEvent) {
        match stamped.event {
            Event::SignalShown { .. } => self.changes.push((stamped.time, true)),
            Event::SignalEnded { .. } => self.changes.push((stamped.time, false)),
            _ => {}
        }
    }

    /// Time with a signal on the display, in seconds of the trial's clock, after the session's last event. At most one
    /// signal is shown at a time: a new signal replaces the last one, and the end of the trial removes it.
    pub fn seconds(&self, session: &Session) -> f64 {
        let end = session.trial_clock(session.time);
        let (mut shown, mut seconds): (Option<SessionTime>, f64) = (None, 0.0);
        for &(time, appears) in &self.changes {
            let now = clock_at(session, time).min(end);
            let since = if appears { shown.replace(now) } else { shown.take() };
            seconds += since.map_or(0.0, |since| now.secs_since(since));
        }
        seconds + shown.map_or(0.0, |since| end.secs_since(since))
    }
}
