//! Changes of locations at which the participant has not looked since the change: facts, not estimates.

use super::session_state::Session;
use super::timeline_entry::TimelineEvent;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{Agent, LocationId};

impl Session {
    /// Agent whose press changed a location at this session time, from the timeline.
    pub fn changed_by(&self, at: SessionTime) -> Option<Agent> {
        let since = self.timeline.iter().rev().take_while(|entry| entry.time >= at);
        since.filter(|entry| entry.time == at).find_map(|entry| match entry.what {
            TimelineEvent::Press { agent, no_effect: None, .. } => Some(agent),
            _ => None,
        })
    }

    /// Whether a location changed without a press of the human, and the participant has not looked at the location
    /// since.
    pub fn is_unseen(&self, location: LocationId) -> bool {
        let at = self.changed_at[location.index()];
        let seen = self.gaze.looked_at[location.index()].is_some_and(|seen| seen >= at);
        let knows = seen || self.gaze.samples == 0 || at == SessionTime::ZERO;
        !knows && self.changed_by(at) != Some(Agent::Human)
    }
}
