//! A question of a freeze probe as the analysis needs it: what was true, estimated and (in simulations) believed when
//! the trial froze; and the answer.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use tomcom_core::measures::sequences::FALSE_BELOW;
use tomcom_session::probes::ProbeOrigin;
use tomcom_session::study_arm::StudyArm;

/// Kind of a probe question, by what the question asks about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum ProbeQuestionKind {
    /// The question asks for the content of an order location.
    Order,
    /// The question asks for the recipe of a dish.
    Recipe,
    /// The question asks for the content of a location other than an order.
    Place,
    /// The question asks which order will be ready next (level 2 of situation awareness).
    NextOrder,
    /// The question asks what the robot will press next (level 2 of situation awareness).
    NextPress,
}

impl ProbeQuestionKind {
    /// Name of the kind of probe question in tables.
    pub fn name(self) -> &'static str {
        match self {
            ProbeQuestionKind::Order => "order",
            ProbeQuestionKind::Recipe => "recipe",
            ProbeQuestionKind::Place => "place",
            ProbeQuestionKind::NextOrder => "next_order",
            ProbeQuestionKind::NextPress => "next_press",
        }
    }

    /// The kind of probe question in words, in the plural.
    pub fn words(self) -> &'static str {
        match self {
            ProbeQuestionKind::Order => "orders",
            ProbeQuestionKind::Recipe => "recipes",
            ProbeQuestionKind::Place => "other places",
            ProbeQuestionKind::NextOrder => "which order is ready next",
            ProbeQuestionKind::NextPress => "what the robot does next",
        }
    }

    /// Whether the probe question asks what comes next (level 2 of situation awareness and above), not what is the case
    /// now.
    pub fn is_level_2(self) -> bool {
        matches!(self, ProbeQuestionKind::NextOrder | ProbeQuestionKind::NextPress)
    }
}

/// Response of a participant to a probe question.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ProbeResponse {
    /// The participant answered with this value, given by its name.
    Value(String),
    /// The participant answered "I don't know".
    Unsure,
    /// The participant gave no answer, because the wizard skipped the rest of the probe.
    Skipped,
    /// The participant gave no answer within the time limit of the probe.
    Missing,
}

/// State aspect of a probe question at the time the trial froze: estimate, belief and history.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AspectAtFreeze {
    /// Number of values that the state aspect can have.
    pub values: usize,
    /// Name of the value that the participant most probably believes, in the estimate.
    pub estimate: String,
    /// Expected probability that the participant gives to each value, in the estimate, by the value's name.
    pub estimate_p: BTreeMap<String, f64>,
    /// Expected probability that the participant gives to the true value, in the estimate.
    pub estimate_p_truth: f64,
    /// Estimated probability that the participant's belief is false, as in [`tomcom_core::measures::detection`].
    pub estimate_p_false: f64,
    /// Recorded belief of a simulated participant; `None` for people.
    pub believed: Option<RecordedBeliefAtFreeze>,
    /// Time since the last change of the asked location, without pauses, in seconds; `None` for recipes, and for
    /// locations that have not changed in the trial.
    pub changed_s: Option<f64>,
    /// Whether somebody else changed the asked location since the participant last looked at it or changed it; `None`
    /// for recipes.
    pub changed_unseen: Option<bool>,
    /// Name of the value that the asked location had for the longest time so far; for a recipe, the true value.
    pub usual: String,
    /// Name of the value that the participant last saw at the location, or made there; for a recipe, the true value.
    pub last_seen: String,
}

/// Belief of a simulated participant about a state aspect when the trial froze.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordedBeliefAtFreeze {
    /// Name of the value that the simulated participant believed most probable.
    pub believes: String,
    /// Probability that the simulated participant gave to the true value.
    pub p_truth: f64,
}

impl RecordedBeliefAtFreeze {
    /// Whether the participant's belief is false: P(truth) is below [`FALSE_BELOW`].
    pub fn is_wrong(&self) -> bool {
        self.p_truth < FALSE_BELOW
    }
}

/// A probe question that a participant was shown, with truth, estimate and response.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProbedQuestion {
    /// Number of the freeze probe in the trial, from 1.
    pub probe: u32,
    /// Number of the question in the probe, from 1.
    pub question: u32,
    /// Time at which the trial froze, on the trial's clock in seconds.
    pub time_s: f64,
    /// Whether the schedule or the wizard started the freeze probe.
    pub origin: ProbeOrigin,
    /// Whether the belief estimate took part in the choice of the probe's questions.
    pub uses_estimate: bool,
    /// Kind of the probe question.
    pub kind: ProbeQuestionKind,
    /// Name of the state aspect that the question is about; for questions of level 2, name of the kind of question.
    pub aspect: String,
    /// Probability with which the question was drawn (inclusion probability).
    pub inclusion: f64,
    /// Name of the right answer; `None` for questions of level 2 if the trial ended before the right answer was known.
    pub truth: Option<String>,
    /// The participant's response to the probe question.
    pub response: ProbeResponse,
    /// Confidence of the participant in the answer, from 1 to 3, if it was asked for.
    pub confidence: Option<u8>,
    /// Response time from the question's appearance to the answer, in seconds.
    pub took_s: Option<f64>,
    /// The asked state aspect at the freeze; `None` for questions of level 2.
    pub frozen: Option<AspectAtFreeze>,
}

impl ProbedQuestion {
    /// Weight of the probe question in estimates over all state aspects at all probes: the inverse of its inclusion
    /// probability (Horvitz and Thompson 1952).
    pub fn weight(&self) -> f64 {
        1.0 / self.inclusion
    }

    /// Whether the answer to the probe question is wrong; "I don't know" counts as wrong. `None` without an answer in
    /// time, or if the truth is unknown.
    pub fn is_wrong(&self) -> Option<bool> {
        let truth = self.truth.as_ref()?;
        match &self.response {
            ProbeResponse::Value(answer) => Some(answer != truth),
            ProbeResponse::Unsure => Some(true),
            ProbeResponse::Skipped | ProbeResponse::Missing => None,
        }
    }

    /// Whether the probe question is part of the main results: drawn by the schedule, about the present state, and
    /// answered in time.
    pub fn is_counted(&self) -> bool {
        self.origin == ProbeOrigin::Schedule && !self.kind.is_level_2() && self.is_wrong().is_some()
    }

    /// Name of the value that the participant answered; `None` for "I don't know" and without an answer.
    pub fn answer(&self) -> Option<&str> {
        match &self.response {
            ProbeResponse::Value(answer) => Some(answer),
            ProbeResponse::Unsure | ProbeResponse::Skipped | ProbeResponse::Missing => None,
        }
    }
}

/// The freeze probes of one trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProbedTrial {
    /// Study arm under which the trial counts.
    pub planned_arm: StudyArm,
    /// Number of freeze probes that began in the trial.
    pub begun: u64,
    /// Number of probes that did not begin in time and were dropped.
    pub dropped: u64,
    /// Number of freeze probes of which the wizard skipped remaining questions.
    pub skipped: u64,
    /// The probe questions that the participant was shown, in order.
    pub questions: Vec<ProbedQuestion>,
}

/// Statistics of the freeze probes of one trial.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProbedTrialStatistics {
    /// Number of probe questions in the main results.
    pub counted: u64,
    /// Weighted share of wrong answers among the probe questions of the main results; `None` without such questions.
    pub share_wrong: Option<f64>,
}

impl ProbedTrial {
    /// Statistics of the trial's freeze probes.
    pub fn statistics(&self) -> ProbedTrialStatistics {
        ProbedTrialStatistics { counted: self.counted().count() as u64, share_wrong: self.share_wrong() }
    }

    /// Whether the trial had, or should have had, a freeze probe.
    pub fn is_any(&self) -> bool {
        self.begun + self.dropped > 0
    }

    /// The probe questions of the trial that belong to the main results.
    pub fn counted(&self) -> impl Iterator<Item = &ProbedQuestion> {
        self.questions.iter().filter(|question| question.is_counted())
    }

    /// Weighted share of wrong answers among the probe questions of the main results; `None` without such questions.
    pub fn share_wrong(&self) -> Option<f64> {
        weighted_share(self.counted().filter_map(|one| Some((one.weight(), one.is_wrong()?))))
    }
}

/// Weighted share of elements that are true; an element is a weight, and whether it is true. `None` without elements.
pub fn weighted_share(of: impl IntoIterator<Item = (f64, bool)>) -> Option<f64> {
    let (mut all, mut part) = (0.0, 0.0);
    for (weight, is_it) in of {
        all += weight;
        part += if is_it { weight } else { 0.0 };
    }
    (all > 0.0).then(|| part / all)
}
