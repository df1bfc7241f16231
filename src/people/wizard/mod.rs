//! Scripted wizard for simulated studies. The script sends signals as a person at the console would, who observes
//! kitchen, presses and gaze and knows the recipes, but not the participant's beliefs.
//!
//! The wizard remembers the last seen content of each location and the last presses. The wizard notices an error with a
//! set probability, and then searches for a single false belief that explains the press: the last seen content of a
//! location, or another recipe. Among several explanations, the wizard prefers those that explain most of the last
//! presses. When the robot changes a location and the participant does not look there, the wizard may foresee an error.
//! The wizard handles one false belief at a time, reacts after a delay, sometimes signals about another aspect, and
//! drops a planned signal once the false belief would mislead nobody. The wizard's signals are therefore sometimes
//! late, missing or wrong, as a person's signals are.
//!
//! Where the session shows recommendations, the scripted wizard also reads the assistant's offers: the wizard takes an
//! offer after a while, or ignores it and follows its own judgement alone.

mod scripted;
mod seen;

use serde::{Deserialize, Serialize};
use tomcom_core::base::settings_table;

pub use scripted::{ScriptedWizard, WizardAction};

settings_table! {
    /// Settings of the wizard: a person at the console, or a script with human limits.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields, default)]
    WizardSpec {
        kind: WizardKind = WizardKind::Person,
        /// Median time from noticing a false belief to sending the signal, in seconds.
        reaction_s: f64 = 1.6,
        /// Standard deviation of the logarithm of the wizard's reaction time.
        reaction_spread: f64 = 0.4,
        /// Probability of noticing that a press of the participant was an error.
        sees_errors: f64 = 0.7,
        /// Probability of noticing that the participant overlooks a change and may err because of it.
        sees_overlooked: f64 = 0.4,
        /// Time after a change at which the wizard checks whether the participant has seen the change, in seconds.
        overlooked_after_s: f64 = 3.0,
        /// Duration of gaze on a location after which the wizard assumes that the participant has read it, in seconds.
        look_s: f64 = 0.15,
        /// Probability of signalling about another plausible aspect instead of the suspected one.
        guesses_wrong: f64 = 0.15,
        /// Shortest time between two signals, in seconds.
        rest_s: f64 = 5.0,
        /// How the scripted wizard treats the assistant's offers where the session shows recommendations; `None`: the
        /// wizard ignores offers.
        #[serde(skip_serializing_if = "Option::is_none")]
        offers: Option<OfferReading> = None,
    }
}

settings_table! {
    /// How the scripted wizard treats the assistant's offers. Nobody has measured how often people take offers: the values
    /// of these settings are assumptions.
    #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields, default)]
    OfferReading {
        /// Probability that the scripted wizard takes an offer; otherwise the wizard follows its own judgement alone.
        takes: f64 = 0.8,
        /// Median time from the opening of an offer to the key that takes the offer, in seconds. The relative spread of
        /// this time is that of the reaction time.
        reads_s: f64 = 2.0,
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WizardKind {
    Person,
    Scripted,
}
