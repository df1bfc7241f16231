//! The events of freeze probes: the task stands still, and the participant answers questions about the participant's
//! beliefs (SAGAT, Endsley 1988).

use serde::{Deserialize, Serialize};

use super::wall_display::AnswerDevice;

/// An event of a freeze probe. Probes have numbers from 1 within a trial, scheduled and requested ones together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "did", rename_all = "snake_case")]
pub enum ProbeEvent {
    /// The wizard requests a freeze probe.
    Requested,
    /// A freeze probe is due but may not begin yet; it waits.
    Delayed {
        /// Number of the freeze probe within the trial, counted from 1.
        probe: u32,
        /// Why the freeze probe has to wait.
        reason: ProbeDelayReason,
    },
    /// A freeze probe has waited for the longest allowed time, and is cancelled.
    Dropped {
        /// Number of the freeze probe within the trial, counted from 1.
        probe: u32,
        /// Why the cancelled freeze probe still had to wait at the end.
        reason: ProbeDelayReason,
    },
    /// A freeze probe begins: the task stands still from now on. All questions of the probe are drawn.
    Begun {
        /// Number of the freeze probe within the trial, counted from 1.
        probe: u32,
        /// Whether the schedule or the wizard caused the freeze probe.
        origin: ProbeOrigin,
        /// Whether the belief estimate influenced the choice of the probe's questions.
        uses_estimate: bool,
        /// The questions of the freeze probe, in the order in which they are asked.
        questions: Vec<ProbeQuestion>,
    },
    /// A question of the freeze probe is shown.
    Asked {
        /// Number of the freeze probe within the trial, counted from 1.
        probe: u32,
        /// Number of the question in the freeze probe, from 1.
        question: u32,
    },
    /// The participant answers the shown question of the freeze probe.
    Answered {
        /// Number of the freeze probe within the trial, counted from 1.
        probe: u32,
        /// Number of the question in the freeze probe, from 1.
        question: u32,
        /// The answer that the participant chose among the question's choices; `None`: "I don't know".
        #[serde(default, skip_serializing_if = "Option::is_none")]
        answer: Option<String>,
        /// The participant's confidence in the answer, from 1 to 3, if it was asked for.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        confidence: Option<u8>,
        /// Where the answer to the probe was entered: on the display or at the console.
        on: AnswerDevice,
    },
    /// The wizard skips the remaining questions of the freeze probe.
    Skipped {
        /// Number of the freeze probe within the trial, counted from 1.
        probe: u32,
        /// The wizard's reason for skipping the remaining questions.
        reason: String,
    },
    /// No more questions of the freeze probe are asked: the count-down to the task begins, unless the trial is over.
    Closed {
        /// Number of the freeze probe within the trial, counted from 1.
        probe: u32,
        /// Why no more questions of the freeze probe are asked.
        reason: ProbeEndReason,
    },
    /// The freeze probe ends, and the task continues.
    Ended {
        /// Number of the freeze probe within the trial, counted from 1.
        probe: u32,
    },
}

/// A question of a freeze probe.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProbeQuestion {
    /// What the question of the freeze probe is about.
    pub about: ProbeSubject,
    /// Possible answers to the probe's question, by their names in the log, in the order in which they are shown.
    pub choices: Vec<String>,
    /// Inclusion probability: the probability with which this question was drawn for the probe, given the settings, the
    /// session so far, and the number of questions.
    pub inclusion: f64,
}

/// What a question of a freeze probe is about.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(tag = "asks", rename_all = "snake_case")]
pub enum ProbeSubject {
    /// The question is about the content of a location.
    Location {
        /// Name of the location that the question is about.
        location: String,
    },
    /// The question is about the recipe of a dish.
    Recipe {
        /// Name of the dish that the question is about.
        dish: String,
    },
    /// The question is about the order that will be served next.
    NextOrder,
    /// The question is about the robot's next press.
    NextPress,
}

/// Why a freeze probe that is due cannot begin yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProbeDelayReason {
    /// The freeze probe waits because a signal was shown a short time before.
    Signal,
    /// The freeze probe waits because another freeze probe ended a short time before.
    Probe,
}

impl ProbeDelayReason {
    /// The reason for the freeze probe's delay in words.
    pub fn words(self) -> &'static str {
        match self {
            ProbeDelayReason::Signal => "a signal was shown just before",
            ProbeDelayReason::Probe => "another probe ended just before",
        }
    }
}

/// What caused a freeze probe: the schedule or the wizard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProbeOrigin {
    /// The freeze probe comes from the schedule, which was drawn before the trial.
    Schedule,
    /// The freeze probe comes from a request of the wizard.
    Wizard,
}

impl ProbeOrigin {
    /// Name of the freeze probe's origin in logs.
    pub fn name(self) -> &'static str {
        match self {
            ProbeOrigin::Schedule => "schedule",
            ProbeOrigin::Wizard => "wizard",
        }
    }
}

/// Why a freeze probe asks no more questions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProbeEndReason {
    /// All questions of the probe are answered.
    Answered,
    /// The time limit of the probe was reached.
    TimeOver,
    /// The wizard skipped the remaining questions.
    Skipped,
    /// The trial ended during the probe.
    TrialEnded,
}

impl ProbeEndReason {
    /// Name of the reason for which no more questions are asked, in logs.
    pub fn name(self) -> &'static str {
        match self {
            ProbeEndReason::Answered => "answered",
            ProbeEndReason::TimeOver => "time_over",
            ProbeEndReason::Skipped => "skipped",
            ProbeEndReason::TrialEnded => "trial_ended",
        }
    }

    /// The reason for the end of the questions in words.
    pub fn words(self) -> &'static str {
        match self {
            ProbeEndReason::Answered => "all questions of the probe are answered",
            ProbeEndReason::TimeOver => "the probe's time is over",
            ProbeEndReason::Skipped => "the wizard skipped the other questions",
            ProbeEndReason::TrialEnded => "the trial is over",
        }
    }
}
