//! Settings of the wizard in a session file.

use serde::{Deserialize, Serialize};

/// Settings of the wizard: a person at the console, or a script with human limits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WizardSpec {
    /// Whether the wizard is a person or a script.
    pub kind: WizardKind,
    /// Median time from noticing a false belief to sending the signal, in seconds.
    pub reaction_s: f64,
    /// Standard deviation of the logarithm of the wizard's reaction time.
    pub reaction_spread: f64,
    /// Probability of noticing that a press of the participant was an error.
    pub sees_errors: f64,
    /// Probability of noticing that the participant overlooks a change and may err because of it.
    pub sees_overlooked: f64,
    /// Time after a change at which the wizard checks whether the participant has seen the change, in seconds.
    pub overlooked_after_s: f64,
    /// Duration of gaze on a location after which the wizard assumes that the participant has read it, in seconds.
    pub look_s: f64,
    /// Probability of signalling about another plausible aspect instead of the suspected one.
    pub guesses_wrong: f64,
    /// Shortest time between two signals, in seconds.
    pub rest_s: f64,
    /// How the scripted wizard treats the assistant's offers where the session shows recommendations; `None`: the
    /// wizard ignores offers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub offers: Option<OfferReading>,
}

/// How the scripted wizard treats the assistant's offers. Nobody has measured how often people take offers: the values
/// of these settings are assumptions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OfferReading {
    /// Probability that the scripted wizard takes an offer; otherwise the wizard follows its own judgement alone.
    pub takes: f64,
    /// Median time from the opening of an offer to the key that takes the offer, in seconds. The relative spread of
    /// this time is that of the reaction time.
    pub reads_s: f64,
}

impl Default for OfferReading {
    fn default() -> Self {
        OfferReading { takes: 0.8, reads_s: 2.0 }
    }
}

/// Whether a person or a script acts as the wizard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WizardKind {
    /// A person at the console acts as the wizard.
    Person,
    /// The scripted wizard, for simulated studies, acts as the wizard.
    Scripted,
}

impl Default for WizardSpec {
    fn default() -> Self {
        WizardSpec {
            kind: WizardKind::Person,
            reaction_s: 1.6,
            reaction_spread: 0.4,
            sees_errors: 0.7,
            sees_overlooked: 0.4,
            overlooked_after_s: 3.0,
            look_s: 0.15,
            guesses_wrong: 0.15,
            rest_s: 5.0,
            offers: None,
        }
    }
}

impl WizardSpec {
    /// Whether all settings of the wizard have their default values.
    pub fn is_default(&self) -> bool {
        *self == WizardSpec::default()
    }
}
