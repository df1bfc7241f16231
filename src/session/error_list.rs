//! The errors of a recording as raters see them: number, time and press.

use serde::Serialize;

use crate::TimelineEvent;
use crate::follower::SessionFollower;
use crate::history::wording;
use crate::wizard_log::clock_at;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::Agent;

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ListedError {
    /// From 1.
    pub error: u64,
    /// Sequence number of the press in the log.
    pub press: u64,
    /// On the trial's clock.
    pub time_s: f64,
    pub button: String,
    /// Whether the press changed the kitchen.
    pub effective: bool,
}

impl ListedError {
    /// Of a recording that was read to its end.
    pub fn all(follower: &SessionFollower) -> Vec<ListedError> {
        let session = &follower.session;
        let presses = session.timeline.iter().filter_map(|entry| match entry.what {
            TimelineEvent::Press { agent: Agent::Human, button, no_effect, .. } => Some((button, no_effect.is_none())),
            _ => None,
        });
        // The judged presses and the human's presses on the timeline are the same presses in the same order.
        let errors = follower.judged.iter().zip(presses).filter(|(judged, _)| judged.verdict.error);
        let listed =
            |(index, (judged, (button, effective))): (usize, (&tomcom_core::measures::JudgedPress, _))| ListedError {
                error: index as u64 + 1,
                press: judged.seq,
                time_s: clock_at(session, judged.time).as_secs_f64(),
                button: wording::button(&session.kitchen, Agent::Human, button),
                effective,
            };
        errors.enumerate().map(listed).collect()
    }

    /// As the console shows it: "1:34".
    pub fn clock(&self) -> String {
        SessionTime::from_secs_f64(self.time_s).to_string()
    }

    /// "take rice", "cooking pot (no effect)".
    pub fn words(&self) -> String {
        match self.effective {
            true => self.button.clone(),
            false => format!("{} (no effect)", self.button),
        }
    }
}
