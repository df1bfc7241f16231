//! What the analysis keeps of a trial: a few numbers, so that memory grows by some lines a trial and not by recordings.

use serde::Serialize;

use super::robot_tally::RobotSummary;
use super::roc::SweptTrial;
use crate::measures::coding::Codes;
use crate::measures::matching::CommunicationEvent;
use crate::measures::wizard::WizardMeasures;
use crate::session::event::EndReason;
use crate::session::settings::{ArmKind, Condition, ParticipantKind};

/// One trial as the analysis sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// The folder's path below the folder that was named.
    pub recording: String,
    /// The participant's code; where several seeds have simulated participants of the same codes, with the seed.
    pub participant: String,
    pub seed: u64,
    pub kind: ParticipantKind,
    /// When it began, by the wall clock; none of simulated ones.
    pub started: Option<String>,
    /// The starting group of a plan, and the number of the trial in it, 1 the first.
    pub group: Option<String>,
    pub period: Option<u32>,
    /// It has a place in a plan, which says its period.
    pub is_planned: bool,
    pub condition: Condition,
    /// Why it is left out, if it is.
    pub left_out: Option<String>,
    /// How it ended; none of one that was cut.
    pub ended: Option<EndReason>,
    pub arm: ArmKind,
    pub robot: RobotSummary,
    pub human_presses: u64,
    pub robot_presses: u64,
    /// Errors of the human, races left out.
    pub errors: u64,
    /// Presses that the robot may have overtaken.
    pub races: u64,
    /// None where nobody can say what the human believed.
    pub beliefs: Option<BeliefErrors>,
    /// Orders served, and the median of the seconds from one to the next, the first from the trial's start.
    pub orders: u64,
    pub order_s: Option<f64>,
    /// The median of the presses of both agents for an order.
    pub presses_per_order: Option<f64>,
    /// The median of the seconds from one press of the human to the next.
    pub press_s: Option<f64>,
    /// Signals that were shown.
    pub signals: u64,
    /// The trial's length by its own clock.
    pub seconds: f64,
    pub answers: Vec<QuestionnaireAnswer>,
    /// Of a wizard.
    pub wizard: Option<WizardMeasures>,
    /// What was sent, and what the assistant would have said, where a wizard sends signals.
    pub lanes: Option<[Vec<CommunicationEvent>; 2]>,
    /// What concepts would have done, where nobody sends signals.
    pub swept: Vec<SweptTrial>,
    /// What two raters say about its errors, where that is what is gone by.
    pub raters: Option<[Codes; 2]>,
}

/// How it is known what the human believed when it erred.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BeliefBasis {
    /// A simulated participant tells what it really believed.
    Recorded,
    /// Two people coded every error; what both put down to a belief is belief related.
    Raters,
    /// The assistant's estimate: no headline figure.
    Estimate,
}

impl BeliefBasis {
    /// As it stands in tables.
    pub fn name(self) -> &'static str {
        match self {
            BeliefBasis::Recorded => "recorded",
            BeliefBasis::Raters => "raters",
            BeliefBasis::Estimate => "estimate",
        }
    }
}

/// What false beliefs did in a trial.
#[derive(Clone, Debug, PartialEq)]
pub struct BeliefErrors {
    pub basis: BeliefBasis,
    /// Belief related errors.
    pub errors: u64,
    /// Of those, the ones that it takes two false beliefs to explain.
    pub of_two: u64,
    /// The number of errors of each sequence.
    pub lengths: Vec<u32>,
    /// The same by single aspects.
    pub lengths_by_aspect: Vec<u32>,
    /// Seconds from the first error of a sequence to the first correct press after its last, where there is one.
    pub recovery_s: Vec<f64>,
    /// False belief episodes that caused at least one error; none where they are not known.
    pub episodes: Option<u64>,
}

/// An answer to an item of a questionnaire.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QuestionnaireAnswer {
    pub questionnaire: String,
    pub item: String,
    pub text: String,
    pub about: Option<String>,
    pub reversed: bool,
    /// None: it was left out.
    pub answer: Option<u8>,
    pub points: u8,
}

impl Trial {
    /// Whether it counts.
    pub fn counts(&self) -> bool {
        self.left_out.is_none()
    }

    /// The kind of participant as it stands in tables.
    pub fn kind_name(&self) -> &'static str {
        match self.kind {
            ParticipantKind::Simulated => "simulated",
            ParticipantKind::Keyboard => "keyboard",
            ParticipantKind::Display => "display",
        }
    }

    /// Presses of both agents.
    pub fn presses(&self) -> u64 {
        self.human_presses + self.robot_presses
    }

    /// Errors per press of the human; none without presses.
    pub fn error_rate_human(&self) -> Option<f64> {
        (self.human_presses > 0).then(|| self.errors as f64 / self.human_presses as f64)
    }

    /// Errors per press of both agents; none without presses.
    pub fn error_rate(&self) -> Option<f64> {
        (self.presses() > 0).then(|| self.errors as f64 / self.presses() as f64)
    }

    /// Errors in a sequence, in the mean.
    pub fn sequence_length(&self) -> Option<f64> {
        mean_length(&self.beliefs.as_ref()?.lengths)
    }

    /// Seconds to recover from a sequence, in the mean.
    pub fn recovery_s(&self) -> Option<f64> {
        mean(self.beliefs.as_ref()?.recovery_s.iter().copied())
    }

    /// Whether somebody sends signals in it.
    pub fn is_assisted(&self) -> bool {
        self.condition != Condition::None
    }
}

/// The mean of lengths; none of nothing.
pub fn mean_length(lengths: &[u32]) -> Option<f64> {
    mean(lengths.iter().map(|&length| f64::from(length)))
}

/// The mean; none of nothing.
pub fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0u32, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / f64::from(count))
}

/// Gives the trials their participants and, where no plan says them, their periods, and puts them into the order of
/// participants and periods. Without a plan a live trial is the participant's first or second by the wall clock, if there are
/// two of them that count.
pub fn arrange(trials: &mut [Trial]) {
    let mut seeds: Vec<u64> = simulated(trials).map(|trial| trial.seed).collect();
    seeds.sort_unstable();
    seeds.dedup();
    for trial in trials.iter_mut().filter(|trial| trial.started.is_none() && seeds.len() > 1) {
        trial.participant = format!("seed{}-{}", trial.seed, trial.participant);
    }
    let key = |trial: &Trial| (trial.participant.clone(), trial.period, trial.started.clone(), trial.recording.clone());
    trials.sort_by_cached_key(key);
    for of_one in trials.chunk_by_mut(|a, b| a.participant == b.participant) {
        let unplanned = |trial: &Trial| trial.counts() && !trial.is_planned && trial.started.is_some();
        if of_one.iter().filter(|trial| unplanned(trial)).count() == 2 {
            let mut period = 0;
            for trial in of_one.iter_mut().filter(|trial| unplanned(trial)) {
                period += 1;
                trial.period = Some(period);
            }
        }
    }
}

/// Those that were simulated as a whole, of which codes are given anew with every seed.
fn simulated(trials: &[Trial]) -> impl Iterator<Item = &Trial> {
    trials.iter().filter(|trial| trial.started.is_none())
}
