//! The errors of a recording as raters see them: number, time, press and reason.

use serde::Serialize;

use crate::follower::SessionFollower;
use crate::history::error_reasons::ExplainedError;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{Agent, Kitchen};
use tomcom_core::measures::JudgedPress;

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
    /// What would have been right, for the screen: "order 1 needs tuna".
    #[serde(skip)]
    pub why: String,
    /// What the places of the press held before it, for the screen: "cutting board raw salmon, human hand empty".
    #[serde(skip)]
    pub shown: String,
}

impl ListedError {
    /// Of a recording that was read to its end.
    pub fn all(follower: &SessionFollower) -> Vec<ListedError> {
        let (session, kitchen) = (&follower.session, &follower.session.kitchen);
        let errors = follower.judged.iter().filter(|judged| judged.verdict.error);
        let explained = ExplainedError::among(session, &follower.judged);
        let listed = |(index, (judged, explained)): (usize, (&JudgedPress, ExplainedError))| ListedError {
            error: index as u64 + 1,
            press: judged.seq,
            time_s: session.trial_clock_at(judged.time).as_secs_f64(),
            button: explained.press,
            effective: kitchen.no_effect(judged.before, Agent::Human, judged.button).is_none(),
            why: explained.why,
            shown: shown(kitchen, judged),
        };
        errors.zip(explained).enumerate().map(listed).collect()
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

/// Contents of the places that decide what the press does, as the display showed them before it.
fn shown(kitchen: &Kitchen, press: &JudgedPress) -> String {
    let places = kitchen.involved(Agent::Human, press.button);
    let content = |place| format!("{} {}", kitchen.location(place).label(), kitchen.content_label(press.before, place));
    places.into_iter().map(content).collect::<Vec<_>>().join(", ")
}
