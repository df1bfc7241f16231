//! A step of a plan: one recording, with at most one trial and what is around it.

use serde::{Deserialize, Serialize};

use super::questionnaire::Questionnaire;
use crate::session::protocol_event::StudyPhase;

/// Where a recording belongs in its plan, and what happens in it; part of the settings of every recording of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepSpec {
    /// The name of the plan.
    pub plan: String,
    /// Changes whenever something in plan, settings or questionnaires does.
    pub digest: String,
    /// The participant's place in the plan, from 0.
    pub participant: u32,
    /// The starting group, as in "AB".
    pub group: String,
    /// The number of the trial, 1 the first; none of the familiarisation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period: Option<u32>,
    /// How many trials there are.
    pub periods: u32,
    /// 1, or more where it had to be done again.
    pub attempt: u32,
    /// Of the familiarisation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub criterion: Option<Criterion>,
    /// What happens, in this order.
    #[serde(rename = "phase")]
    pub phases: Vec<PhaseSpec>,
}

/// When the familiarisation is over: so many orders served, at most this share of the human's presses errors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Criterion {
    pub orders: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_rate: Option<f64>,
}

impl Criterion {
    /// Whether it is met by so many served orders and errors among so many presses of the human.
    pub fn is_met(&self, orders: u32, presses: u32, errors: u32) -> bool {
        let share = f64::from(errors) / f64::from(presses.max(1));
        orders >= self.orders && self.error_rate.is_none_or(|most| share <= most)
    }
}

/// A phase with what is shown in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case", deny_unknown_fields)]
pub enum PhaseSpec {
    Instruction { steps: Vec<String> },
    Familiarisation,
    Trial,
    Questionnaire { questionnaire: Questionnaire },
    Debriefing { steps: Vec<String> },
}

impl PhaseSpec {
    pub fn phase(&self) -> StudyPhase {
        match self {
            PhaseSpec::Instruction { .. } => StudyPhase::Instruction,
            PhaseSpec::Familiarisation => StudyPhase::Familiarisation,
            PhaseSpec::Trial => StudyPhase::Trial,
            PhaseSpec::Questionnaire { .. } => StudyPhase::Questionnaire,
            PhaseSpec::Debriefing { .. } => StudyPhase::Debriefing,
        }
    }

    /// The steps that are ticked in it.
    pub fn steps(&self) -> &[String] {
        match self {
            PhaseSpec::Instruction { steps } | PhaseSpec::Debriefing { steps } => steps,
            _ => &[],
        }
    }
}

impl StepSpec {
    /// "trial 1/2", "familiarisation": where it is in the participant's series.
    pub fn label(&self) -> String {
        let again = if self.attempt > 1 { format!(", attempt {}", self.attempt) } else { String::new() };
        match self.period {
            Some(period) => format!("trial {period}/{}{again}", self.periods),
            None => format!("familiarisation{again}"),
        }
    }
}
