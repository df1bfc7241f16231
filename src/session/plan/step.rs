//! A step of a study plan: one recording with at most one trial and the phases around it.

use serde::{Deserialize, Serialize};

use super::questionnaire::Questionnaire;
use super::study_aims::StudyAims;
use super::tutorial::Tutorial;
use crate::protocol_event::StudyPhase;
use crate::study_arm::StudyArm;

/// Position of a recording in its study plan, and its phases; part of the settings of every recording of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanPosition {
    /// The name of the study plan to which the recording belongs.
    pub plan: String,
    /// Digest of the plan, its settings and questionnaires, by which another version of the plan is recognised.
    pub digest: String,
    /// Index of the participant in the plan, from 0.
    pub participant: u32,
    /// Name of the participant's starting group: "AB".
    pub group: String,
    /// Number of the trial, from 1; `None` for the familiarisation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period: Option<u32>,
    /// Number of counted trials per participant.
    pub periods: u32,
    /// The study arm that the plan assigns to the trial; `None` for a recording of the tutorial alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arm: Option<StudyArm>,
    /// The aims of the study, if they are not the default.
    #[serde(default, skip_serializing_if = "StudyAims::are_default")]
    pub aims: StudyAims,
    /// Number of the attempt at this trial, from 1.
    pub attempt: u32,
    /// Criterion that the participant has to meet in the practice trial (familiarisation).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub criterion: Option<PracticeCriterion>,
    /// The phases of the recording, in order, such as instruction, trial and questionnaire.
    #[serde(rename = "phase")]
    pub phases: Vec<PhaseSpec>,
}

/// Criterion of the practice trial (familiarisation): a least number of served orders, and a largest share of errors
/// among the human's presses.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PracticeCriterion {
    /// The least number of served orders in the practice trial.
    pub orders: u32,
    /// The largest share of errors among the human's presses, 0 to 1; `None`: errors do not matter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_rate: Option<f64>,
}

impl PracticeCriterion {
    /// Whether a practice trial with these numbers of served orders, human presses and errors meets the criterion.
    pub fn is_met(&self, orders: u32, presses: u32, errors: u32) -> bool {
        let share = f64::from(errors) / f64::from(presses.max(1));
        orders >= self.orders && self.error_rate.is_none_or(|most| share <= most)
    }
}

/// A phase of a study recording, such as instruction or trial, with its content.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case", deny_unknown_fields)]
pub enum PhaseSpec {
    /// The wizard instructs the participant.
    Instruction {
        /// The wizard's instructions, step by step.
        steps: Vec<String>,
    },
    /// The participant goes through a tutorial on the display.
    Tutorial {
        /// The tutorial, with all its texts.
        tutorial: Tutorial,
    },
    /// A practice trial, which does not count.
    Familiarisation,
    /// A trial that counts for the analysis.
    Trial,
    /// The participant answers a questionnaire.
    Questionnaire {
        /// The questionnaire, with the items that are asked in this phase.
        questionnaire: Questionnaire,
    },
    /// The participant is debriefed.
    Debriefing {
        /// The steps of the debriefing.
        steps: Vec<String>,
    },
}

impl PhaseSpec {
    /// The kind of the phase, without its content.
    pub fn phase(&self) -> StudyPhase {
        match self {
            PhaseSpec::Instruction { .. } => StudyPhase::Instruction,
            PhaseSpec::Tutorial { .. } => StudyPhase::Tutorial,
            PhaseSpec::Familiarisation => StudyPhase::Familiarisation,
            PhaseSpec::Trial => StudyPhase::Trial,
            PhaseSpec::Questionnaire { .. } => StudyPhase::Questionnaire,
            PhaseSpec::Debriefing { .. } => StudyPhase::Debriefing,
        }
    }

    /// The steps of an instruction or debriefing that the wizard ticks off.
    pub fn steps(&self) -> &[String] {
        match self {
            PhaseSpec::Instruction { steps } | PhaseSpec::Debriefing { steps } => steps,
            _ => &[],
        }
    }
}

impl PlanPosition {
    /// Whether the recording has only the participant's tutorial, without a trial.
    pub fn is_tutorial_alone(&self) -> bool {
        matches!(self.phases[..], [PhaseSpec::Tutorial { .. }])
    }

    /// Position of the recording in the participant's series, in words: "trial 1/2", "familiarisation".
    pub fn label(&self) -> String {
        let again = if self.attempt > 1 { format!(", attempt {}", self.attempt) } else { String::new() };
        match self.period {
            Some(period) => format!("trial {period}/{}{again}", self.periods),
            None if self.is_tutorial_alone() => "tutorial".to_string(),
            None => format!("familiarisation{again}"),
        }
    }
}
