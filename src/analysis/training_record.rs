//! What came of a wizard's training, as it is kept.

use serde::{Deserialize, Serialize};

use crate::base::time::SessionTime;
use crate::communication::Signal;
use crate::measures::wizard_performance::{TrainingCriterion, WizardMeasures};

/// A wizard's training at one time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingRecord {
    /// The wizard's code, never a name.
    pub wizard: String,
    /// When it began (UTC, RFC 3339).
    pub at: String,
    /// How long it took, in minutes.
    pub minutes: f64,
    /// How many times as fast as it was it was played; null in records from before that was written down.
    #[serde(default)]
    pub speed: Option<f64>,
    /// When the training is passed.
    pub criterion: TrainingCriterion,
    /// Over all recordings, each watched to its end.
    pub met: bool,
    /// The recordings that were watched, in turn.
    pub recordings: Vec<JudgedRecording>,
}

/// A recording that was watched.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JudgedRecording {
    /// The name of its folder; of one that was simulated for the training, with its length before it.
    pub recording: String,
    /// It was watched to its end.
    pub complete: bool,
    /// Presses of the human in what was watched.
    pub presses: u32,
    /// The signals that the wizard sent.
    pub signals: Vec<JudgedSignal>,
    /// The false beliefs that led to errors, as far as they had begun.
    #[serde(default)]
    pub beliefs: Vec<JudgedBelief>,
    /// How well the wizard did.
    pub measures: WizardMeasures,
    /// Kappa with what the same wizard signalled in the same recording the time before; null: there was none.
    pub kappa_with_oneself: Option<f64>,
}

/// A signal that was sent in training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JudgedSignal {
    /// Presses of the human before it.
    pub press: u32,
    /// On the trial's clock.
    pub clock_ns: SessionTime,
    /// The signal.
    pub signal: Signal,
    /// What it was: "hit", "again", "harmless", "late", "wrong" or "needless"; empty in records from before that was written
    /// down.
    #[serde(default)]
    pub worth: String,
}

/// A false belief that led to errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JudgedBelief {
    /// The state aspect about which the belief was false.
    pub aspect: String,
    /// On the trial's clock.
    pub began_ns: SessionTime,
    /// Null: it was held until the end.
    pub corrected_ns: Option<SessionTime>,
    /// Errors that are put down to it.
    pub errors: u32,
    /// What was believed most, when the participant last told it while the belief was held.
    pub believed: String,
    /// What was true then.
    pub truth: String,
    /// Both as screens word them; only in the program that judges, records have the names.
    #[serde(skip)]
    pub words: String,
    /// The signal that would have been right; null: none tells it.
    pub signal: Option<Signal>,
    /// Which of the signals hit it, 0 the first; null: it was missed.
    pub hit_by: Option<usize>,
}
