//! The events of freeze probes: the task stands still, and the participant answers what it believes (SAGAT, Endsley 1988).

use serde::{Deserialize, Serialize};

use super::wall_display::Answering;

/// What happens around a freeze probe. Probes are numbered from 1 within a trial, scheduled and requested ones together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "did", rename_all = "snake_case")]
pub enum ProbeEvent {
    /// The wizard asks for a probe.
    Requested,
    /// A probe is due and may not begin yet; it waits.
    Delayed {
        /// The probe's number.
        probe: u32,
        /// What it waits for.
        reason: ProbeBlock,
    },
    /// A probe waited for the longest time allowed, and is not held.
    Dropped {
        /// The probe's number.
        probe: u32,
        /// What it waited for at the end.
        reason: ProbeBlock,
    },
    /// The task stands still from now on. All questions of the probe are drawn.
    Begun {
        /// The probe's number.
        probe: u32,
        /// Who wanted it.
        origin: ProbeOrigin,
        /// Whether the belief estimate had a part in the choice of the questions.
        uses_estimate: bool,
        /// The questions, in the order in which they are asked.
        questions: Vec<ProbeQuestion>,
    },
    /// A question is shown.
    Asked {
        /// The probe's number.
        probe: u32,
        /// The question, from 1.
        question: u32,
    },
    /// The participant answers the shown question.
    Answered {
        /// The probe's number.
        probe: u32,
        /// The question, from 1.
        question: u32,
        /// One of the question's choices; `None`: "I don't know".
        #[serde(default, skip_serializing_if = "Option::is_none")]
        answer: Option<String>,
        /// How sure the participant is, from 1 to 3, if it was asked.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        confidence: Option<u8>,
        /// Where the answer was entered.
        on: Answering,
    },
    /// The wizard skips the rest of the probe.
    Skipped {
        /// The probe's number.
        probe: u32,
        /// Why, in the wizard's words.
        reason: String,
    },
    /// No more questions are asked: the count-down to the task begins, unless the trial is over.
    Closed {
        /// The probe's number.
        probe: u32,
        /// Why.
        reason: ProbeEnd,
    },
    /// The task goes on.
    Ended {
        /// The probe's number.
        probe: u32,
    },
}

/// A question of a probe.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProbeQuestion {
    /// What it is about.
    pub about: ProbeSubject,
    /// The possible answers by their names in the log, in the order in which they are shown.
    pub choices: Vec<String>,
    /// Probability with which the question came into this probe, given the settings, the session so far, and the number of questions.
    pub inclusion: f64,
}

/// What a question is about.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(tag = "asks", rename_all = "snake_case")]
pub enum ProbeSubject {
    /// The content of a location.
    Location {
        /// The location's name.
        location: String,
    },
    /// The recipe of a dish.
    Recipe {
        /// The dish's name.
        dish: String,
    },
    /// The order that will be served next.
    NextOrder,
    /// The robot's next press.
    NextPress,
}

/// What keeps a probe that is due from beginning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProbeBlock {
    /// A signal was shown a short time ago.
    Signal,
    /// Another probe ended a short time ago.
    Probe,
}

impl ProbeBlock {
    /// The reason in words.
    pub fn words(self) -> &'static str {
        match self {
            ProbeBlock::Signal => "a signal was shown just before",
            ProbeBlock::Probe => "another probe ended just before",
        }
    }
}

/// Who wanted a probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProbeOrigin {
    /// The times that were drawn before the trial.
    Schedule,
    /// The wizard.
    Wizard,
}

impl ProbeOrigin {
    /// Name in logs.
    pub fn name(self) -> &'static str {
        match self {
            ProbeOrigin::Schedule => "schedule",
            ProbeOrigin::Wizard => "wizard",
        }
    }
}

/// Why no more questions are asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProbeEnd {
    /// All questions are answered.
    Answered,
    /// The time for a probe is over.
    TimeOver,
    /// The wizard skipped the rest.
    Skipped,
    /// The trial ended during the probe.
    TrialEnded,
}

impl ProbeEnd {
    /// Name in logs.
    pub fn name(self) -> &'static str {
        match self {
            ProbeEnd::Answered => "answered",
            ProbeEnd::TimeOver => "time_over",
            ProbeEnd::Skipped => "skipped",
            ProbeEnd::TrialEnded => "trial_ended",
        }
    }

    /// The reason in words.
    pub fn words(self) -> &'static str {
        match self {
            ProbeEnd::Answered => "all questions are answered",
            ProbeEnd::TimeOver => "its time is over",
            ProbeEnd::Skipped => "the wizard skipped the rest",
            ProbeEnd::TrialEnded => "the trial is over",
        }
    }
}
