//! A question of a probe as the analysis sees it: what was true, known and estimated when the trial froze, and what was answered.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::measures::sequences::FALSE_BELOW;
use crate::session::probes::ProbeOrigin;
use crate::session::study_arm::StudyArm;

/// What a question was about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum ProbedKind {
    /// What an order location shows.
    Order,
    /// The recipe of a dish.
    Recipe,
    /// What is at another location.
    Place,
    /// Which order will be ready next (level 2).
    NextOrder,
    /// What the robot will do next (level 2).
    NextPress,
}

impl ProbedKind {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            ProbedKind::Order => "order",
            ProbedKind::Recipe => "recipe",
            ProbedKind::Place => "place",
            ProbedKind::NextOrder => "next_order",
            ProbedKind::NextPress => "next_press",
        }
    }

    /// The kind in words, in the plural.
    pub fn words(self) -> &'static str {
        match self {
            ProbedKind::Order => "orders",
            ProbedKind::Recipe => "recipes",
            ProbedKind::Place => "other places",
            ProbedKind::NextOrder => "which order is ready next",
            ProbedKind::NextPress => "what the robot does next",
        }
    }

    /// Whether the question is about what comes next (level 2 of situation awareness and above), not about what is.
    pub fn is_level_2(self) -> bool {
        matches!(self, ProbedKind::NextOrder | ProbedKind::NextPress)
    }
}

/// What came back to a question.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ProbeResponse {
    /// The name of a value.
    Value(String),
    /// "I don't know".
    Unsure,
    /// Nothing until the wizard skipped the rest of the probe.
    Skipped,
    /// Nothing in time.
    Missing,
}

/// What was known of a question's aspect when the trial froze.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrozenAspect {
    /// Number of values that the aspect can have.
    pub values: usize,
    /// Name of the most probable value in the estimate.
    pub estimate: String,
    /// Expected probability of every value in the estimate, by name.
    pub estimate_p: BTreeMap<String, f64>,
    /// Expected probability of the true value in the estimate.
    pub estimate_p_truth: f64,
    /// Probability by the estimate that the belief is false, as in [`crate::measures::belief_detection`].
    pub estimate_p_false: f64,
    /// A simulated participant's belief; `None` for people.
    pub believed: Option<FrozenBelief>,
    /// Time since the last change of a location, without pauses, in seconds; `None` for recipes, and if it has not changed in the trial.
    pub changed_s: Option<f64>,
    /// Whether somebody else changed a location since the participant last looked at it or changed it; `None` for recipes.
    pub changed_unseen: Option<bool>,
    /// Name of the value that lay there longest until then; of a recipe the true one.
    pub usual: String,
    /// Name of the value that the participant last saw there, or made; of a recipe the true one.
    pub last_seen: String,
}

/// What a simulated participant believed about an aspect when the trial froze.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrozenBelief {
    /// Name of the most probable value.
    pub believes: String,
    /// Probability of the true value.
    pub p_truth: f64,
}

impl FrozenBelief {
    /// Whether the belief is false.
    pub fn is_wrong(&self) -> bool {
        self.p_truth < FALSE_BELOW
    }
}

/// A question that a participant was shown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProbedQuestion {
    /// Number of the probe in the trial, from 1.
    pub probe: u32,
    /// Number of the question in the probe, from 1.
    pub question: u32,
    /// Time of the freeze on the trial's clock, in seconds.
    pub time_s: f64,
    /// Who asked for the probe.
    pub origin: ProbeOrigin,
    /// Whether the estimate had a part in the choice of questions.
    pub uses_estimate: bool,
    /// What it is about.
    pub kind: ProbedKind,
    /// Name of the aspect; for questions of level 2 the kind's name.
    pub aspect: String,
    /// Probability with which the question was drawn.
    pub inclusion: f64,
    /// Name of the right answer; `None` for questions of level 2 if the trial ended before.
    pub truth: Option<String>,
    /// What came back.
    pub response: ProbeResponse,
    /// Confidence from 1 to 3, if it was asked.
    pub confidence: Option<u8>,
    /// Time from the question's appearance to the answer, in seconds.
    pub took_s: Option<f64>,
    /// What was known of the aspect; `None` for questions of level 2.
    pub frozen: Option<FrozenAspect>,
}

impl ProbedQuestion {
    /// Weight in estimates over all aspects at all probes (Horvitz and Thompson 1952).
    pub fn weight(&self) -> f64 {
        1.0 / self.inclusion
    }

    /// Whether the answer is wrong; "I don't know" is. `None` without an answer in time, or without a truth.
    pub fn is_wrong(&self) -> Option<bool> {
        let truth = self.truth.as_ref()?;
        match &self.response {
            ProbeResponse::Value(answer) => Some(answer != truth),
            ProbeResponse::Unsure => Some(true),
            ProbeResponse::Skipped | ProbeResponse::Missing => None,
        }
    }

    /// Whether the question is part of the main results: drawn by the schedule, about what is, and answered in time.
    pub fn is_counted(&self) -> bool {
        self.origin == ProbeOrigin::Schedule && !self.kind.is_level_2() && self.is_wrong().is_some()
    }

    /// Name of the answered value, if one was named.
    pub fn answer(&self) -> Option<&str> {
        match &self.response {
            ProbeResponse::Value(answer) => Some(answer),
            ProbeResponse::Unsure | ProbeResponse::Skipped | ProbeResponse::Missing => None,
        }
    }
}

/// The probes of one trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProbedTrial {
    /// The arm of the trial.
    pub study_arm: StudyArm,
    /// Number of probes that began.
    pub begun: u64,
    /// Number of probes that waited in vain and were dropped.
    pub dropped: u64,
    /// Number of probes that the wizard skipped.
    pub skipped: u64,
    /// The questions that were shown, in order.
    pub questions: Vec<ProbedQuestion>,
}

impl ProbedTrial {
    /// Whether there was any probe, or should have been.
    pub fn is_any(&self) -> bool {
        self.begun + self.dropped > 0
    }

    /// The questions of the main results.
    pub fn counted(&self) -> impl Iterator<Item = &ProbedQuestion> {
        self.questions.iter().filter(|question| question.is_counted())
    }

    /// Weighted share of wrong answers among the questions of the main results; `None` without any.
    pub fn share_wrong(&self) -> Option<f64> {
        weighted_share(self.counted().filter_map(|one| Some((one.weight(), one.is_wrong()?))))
    }
}

/// Share of the weight of true ones; `None` without elements.
pub fn weighted_share(of: impl IntoIterator<Item = (f64, bool)>) -> Option<f64> {
    let (mut all, mut part) = (0.0, 0.0);
    for (weight, is_it) in of {
        all += weight;
        part += if is_it { weight } else { 0.0 };
    }
    (all > 0.0).then(|| part / all)
}
