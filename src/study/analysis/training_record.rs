//! Record of a wizard's training session, as the program saves it to a file.

use serde::{Deserialize, Serialize};

use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::measures::wizard_performance::{TrainingCriterion, WizardMeasures};

/// Record of one training session of a wizard.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WizardTrainingRecord {
    /// The wizard's code, never a name.
    pub wizard: String,
    /// Wall clock time at which the training began (UTC, RFC 3339).
    pub at: String,
    /// Duration of the training, in minutes.
    pub minutes: f64,
    /// Playback speed as a multiple of real time.
    pub speed: f64,
    /// Criterion for passing the training.
    pub criterion: TrainingCriterion,
    /// Whether the wizard met the criterion over all recordings that were watched to their end.
    pub met: bool,
    /// Recordings that the wizard watched, in order.
    pub recordings: Vec<WatchedRecording>,
}

/// A recording that a wizard watched in training, with the judgement of the signals.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WatchedRecording {
    /// Name of the recording's folder; a recording that was simulated for the training has its length in front of the
    /// name.
    pub recording: String,
    /// Whether the wizard watched the recording to its end.
    pub complete: bool,
    /// Presses of the human in the part that was watched.
    pub presses: u32,
    /// Signals that the wizard sent while watching, with their judgements.
    pub signals: Vec<JudgedSignal>,
    /// False beliefs that led to errors, among those that began in the part that was watched.
    pub beliefs: Vec<HarmfulFalseBelief>,
    /// Measures of the wizard's performance: hits and wrong signals.
    pub measures: WizardMeasures,
    /// Cohen's kappa between the wizard's signals now and in the previous pass through the same recording; null without
    /// a previous pass.
    pub kappa_with_oneself: Option<f64>,
}

/// A signal that the wizard sent in training, with its judgement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JudgedSignal {
    /// Number of the human's presses before the signal.
    pub press: u32,
    /// Time of the signal on the trial's clock, in nanoseconds.
    pub clock_ns: SessionTime,
    /// The signal that the wizard sent.
    pub signal: Signal,
    /// Judgement of the signal: "hit", "again", "harmless", "late", "wrong" or "needless".
    pub worth: String,
}

/// A false belief that led to errors, and whether the wizard corrected it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HarmfulFalseBelief {
    /// The state aspect about which the belief was false.
    pub aspect: String,
    /// Time at which the false belief began, on the trial's clock.
    pub began_ns: SessionTime,
    /// Time at which the belief was corrected, on the trial's clock; null if the participant held it until the end.
    pub corrected_ns: Option<SessionTime>,
    /// Number of errors that followed from the false belief.
    pub errors: u32,
    /// The value that the participant believed most probable, by the last recorded belief while it was false.
    pub believed: String,
    /// The true value of the aspect while the belief was false.
    pub truth: String,
    /// Believed and true value in words for screens; filled in only while signals are judged, not in records on disk.
    #[serde(skip)]
    pub words: String,
    /// The signal that would have corrected the belief; null if no signal can.
    pub signal: Option<Signal>,
    /// Index, from 0, of the wizard's signal that hit the false belief; null if no signal hit it.
    pub hit_by: Option<usize>,
}
