//! Study plans: the series of recordings of each participant, with conditions and dish orders. Everything in this
//! module is a function of the plan and its seed, independent of the order in which participants come.
//!
//! A recording has at most one trial. The settings of a recording contain its `step` (plan, digest, group, period,
//! attempt, phases with all texts and items), so that it can be replayed after the plan has changed. Progress follows
//! from the recordings alone; there is no file with the state of a study. A step that is left early has no end event
//! and can be continued like one that was cut off.

use serde::{Deserialize, Serialize};

mod difference;
mod study;

use crate::person_code;
pub use crate::plan::difference::{PlanDifference, differences, listed};
pub use crate::plan::study::{
    NextRecording, ParticipantProgress, PhaseStand, PlanRecording, PlannedTrial, PlannedTrialProgress,
    RecordingOutcome, Study, TrialAttempt, WantedRecording,
};
pub use crate::questionnaire::{
    AnswerFormat, ItemOption, Questionnaire, QuestionnaireItem, QuestionnaireItemKind, RatingScale, SLIDER_END,
    ScoreRule,
};
use crate::settings::{SettingError, WizardVisibility, is_code};
use crate::study_arm::StudyArm;
pub use crate::tutorial::{Tutorial, TutorialStep, TutorialStepKind, TutorialTarget};
use crate::wall_display::AnswerDevice;
use tomcom_core::base::rng::{shuffle, stream};
use tomcom_core::base::text::count;

/// `[plan]` of a session file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanSpec {
    /// By which recordings of the plan are recognised.
    pub name: String,
    pub participants: Participants,
    /// Each participant has one trial in each, in counterbalanced order.
    pub conditions: Vec<StudyArm>,
    #[serde(default, skip_serializing_if = "StudyAims::are_default")]
    pub aims: StudyAims,
    /// Size of a permuted block, in participants; by default each order of the conditions occurs twice in it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub block: Option<u32>,
    /// Shown before anything is recorded.
    #[serde(default = "default_consent")]
    pub consent: String,
    /// By holding a button on the display, or by telling the wizard, who confirms it at the console.
    #[serde(default)]
    pub consent_on: AnswerDevice,
    /// Steps of the wizard.
    #[serde(default)]
    pub instruction: Vec<String>,
    /// File, relative to the session file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tutorial: Option<String>,
    /// Practice before the first trial.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub familiarisation: Option<FamiliarisationSpec>,
    #[serde(default)]
    pub questionnaire: Vec<QuestionnaireSpec>,
    /// Steps of the wizard after the last trial.
    #[serde(default)]
    pub debriefing: Vec<String>,
}

fn default_consent() -> String {
    "The participant was told what is recorded and for what it is used, and agrees to it.".to_string()
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "a number of participants, or a list of their codes")]
pub enum Participants {
    /// Their codes are P01, P02, …
    Count(u32),
    Codes(Vec<String>),
}

/// Practice trial, repeated until the participant meets a criterion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FamiliarisationSpec {
    #[serde(default)]
    pub condition: StudyArm,
    /// Of both agents, at which it ends, unless time or orders end it earlier.
    pub presses: u32,
    /// On the trial's clock.
    pub seconds: f64,
    /// Criterion: least number of served orders.
    pub orders: u32,
    /// Criterion: largest share of errors among the human's presses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_rate: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QuestionnaireSpec {
    /// Relative to the session file.
    pub file: String,
    /// Numbers of the trials after which it is asked, from 1; by default after each.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after: Option<Vec<u32>>,
    /// Whether it is asked once before the first trial; after trials it is then asked only if `after` says so.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub before: bool,
}

impl QuestionnaireSpec {
    pub(crate) fn is_asked_after(&self, period: u32) -> bool {
        self.after.as_ref().map_or(!self.before, |after| after.contains(&period))
    }
}

impl PlanSpec {
    /// In the order of the plan.
    pub fn codes(&self) -> Vec<String> {
        match &self.participants {
            Participants::Count(count) => (1..=*count).map(|number| numbered(number, *count)).collect(),
            Participants::Codes(codes) => codes.clone(),
        }
    }

    /// Empty beyond the last participant.
    pub fn code(&self, participant: usize) -> String {
        match &self.participants {
            Participants::Count(count) if participant < *count as usize => numbered(participant as u32 + 1, *count),
            Participants::Count(_) => String::new(),
            Participants::Codes(codes) => codes.get(participant).cloned().unwrap_or_default(),
        }
    }

    pub fn check(&self) -> Result<(), SettingError> {
        let wrong = |key: &'static str, found: String, remedy: &'static str| Err(SettingError::new(key, found, remedy));
        if !is_code(&self.name) {
            let remedy = "a short name of letters, digits, - and _, such as \"main-study\"";
            return wrong("plan.name", format!("name = \"{}\"", self.name), remedy);
        }
        self.check_participants()?;
        let twice = |index: usize| self.conditions[..index].contains(&self.conditions[index]);
        if self.conditions.is_empty() {
            let remedy = "different conditions, such as [\"none\", \"wizard\", \"tom-com\"]";
            return wrong("plan.conditions", "no conditions".to_string(), remedy);
        }
        if let Some(index) = (0..self.conditions.len()).find(|&index| twice(index)) {
            let found = format!("the condition \"{}\" twice", self.conditions[index].name());
            return wrong("plan.conditions", found, "different conditions: each participant has one trial in each");
        }
        let orders = orders(self.conditions.len()).len() as u32;
        if let Some(block) = self.block.filter(|&block| block == 0 || block % orders != 0) {
            let found = format!("block = {block}, with {orders} orders of the conditions");
            return wrong("plan.block", found, "a multiple of the number of orders, so that each comes equally often");
        }
        for asked in self.questionnaire.iter().flat_map(|questionnaire| questionnaire.after.iter().flatten()) {
            if *asked == 0 || *asked as usize > self.conditions.len() {
                let found =
                    format!("after = [{asked}], with {}", count(self.conditions.len() as u64, "trial", "trials"));
                return wrong("questionnaire.after", found, "the numbers of trials, 1 the first");
            }
        }
        Ok(())
    }

    /// A wizard without advice must not see recommendations.
    pub(crate) fn check_visibility(&self, visibility: WizardVisibility) -> Result<(), SettingError> {
        let practice = self.familiarisation.iter().map(|practice| practice.condition);
        let is_blind = self.conditions.iter().copied().chain(practice).any(|arm| arm == StudyArm::Wizard);
        if !is_blind || visibility < WizardVisibility::Recommendation {
            return Ok(());
        }
        let found = "the condition \"wizard\", and a wizard who sees recommendations".to_string();
        let remedy = "[console] with visibility = \"state\" or \"belief\", or the condition \"wizard+advice\": what the wizard sees is part of the \
                      condition";
        Err(SettingError::new("plan.conditions", found, remedy))
    }

    fn check_participants(&self) -> Result<(), SettingError> {
        let wrong = |found: String, remedy| Err(SettingError::new("plan.participants", found, remedy));
        let Participants::Codes(codes) = &self.participants else { return Ok(()) };
        if codes.is_empty() {
            return wrong("no participants".to_string(), "how many there are, or a list of their codes");
        }
        for (index, code) in codes.iter().enumerate() {
            let before = &codes[..index];
            if let Some(fault) = person_code::fault(code) {
                return wrong(format!("the code \"{code}\": {fault}"), person_code::REMEDY);
            }
            if before.contains(code) {
                return wrong(format!("the code \"{code}\" twice"), "each code once");
            }
            if let Some(other) = person_code::differing_in_case(code, before.iter().map(String::as_str)) {
                let found = format!("the codes \"{other}\" and \"{code}\"");
                return wrong(found, "codes that differ in more than capital letters");
            }
        }
        Ok(())
    }
}

/// "P07" if there are up to 99 participants.
fn numbered(number: u32, count: u32) -> String {
    let digits = count.to_string().len().max(2);
    format!("P{number:0digits$}")
}

/// Set before the study begins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StudyAims {
    /// What the analysis compares first between the conditions.
    pub outcome: PrimaryOutcome,
    /// Margin of non-inferiority: the assistant counts as not worse than the wizard if the ratio of their rates is
    /// below it.
    pub margin: f64,
}

impl Default for StudyAims {
    fn default() -> Self {
        StudyAims { outcome: PrimaryOutcome::Errors, margin: 1.25 }
    }
}

impl StudyAims {
    fn are_default(&self) -> bool {
        *self == StudyAims::default()
    }
}

/// Compared as a rate per press of the human.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PrimaryOutcome {
    #[default]
    Errors,
    /// Errors that a false belief caused; for people known from two raters' codes.
    BeliefRelatedErrors,
    /// Sequences of related errors; for people known from two raters' codes.
    Sequences,
}

impl PrimaryOutcome {
    pub fn title(self) -> &'static str {
        match self {
            PrimaryOutcome::Errors => "errors",
            PrimaryOutcome::BeliefRelatedErrors => "belief related errors",
            PrimaryOutcome::Sequences => "sequences of related errors",
        }
    }
}

/// An order of the study's conditions.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct StartingGroup {
    /// "AB" if the first condition of the plan comes first.
    pub name: String,
    /// Of each trial, in order.
    pub conditions: Vec<StudyArm>,
}

/// The orders of a Williams design (Williams 1949) for `count` conditions, as indices; the plan's own order is first if
/// it is one of them. Every condition is equally often in every position, and equally often directly after every other
/// one. An odd number of conditions needs twice as many orders.
pub fn orders(count: usize) -> Vec<Vec<usize>> {
    if count == 0 {
        return vec![Vec::new()];
    }
    // The sequence 0, 1, n-1, 2, n-2, ...: the differences between neighbours are all different modulo n.
    let first = |place: usize| if place % 2 == 1 { place.div_ceil(2) } else { (count - place / 2) % count };
    let mut all: Vec<Vec<usize>> =
        (0..count).map(|shift| (0..count).map(|place| (first(place) + shift) % count).collect()).collect();
    if count % 2 == 1 && count > 1 {
        let mirrored: Vec<Vec<usize>> = all.iter().map(|order| order.iter().rev().copied().collect()).collect();
        all.extend(mirrored);
    }
    all.sort();
    all
}

impl PlanSpec {
    /// By permuted blocks (Pocock 1983, Clinical Trials, ch. 5): groups are equal after every block, and the next
    /// assignment is unpredictable. A function of plan and seed alone.
    pub fn group(&self, seed: u64, participant: usize) -> StartingGroup {
        let orders = orders(self.conditions.len());
        let block = self.block.map_or(2 * orders.len(), |block| block as usize);
        let mut places: Vec<usize> = (0..block).map(|place| place % orders.len()).collect();
        let mut random = stream(seed, "groups", (participant / block) as u64);
        shuffle(&mut places, &mut random);
        let order = &orders[places[participant % block]];
        StartingGroup {
            name: order.iter().map(|&index| char::from(b'A' + index as u8)).collect(),
            conditions: order.iter().map(|&index| self.conditions[index]).collect(),
        }
    }
}

/// End of the name under which a tutorial alone is recorded.
pub(crate) const TUTORIAL_ALONE: &str = "-tutorial";

/// Position of a recording in its study plan, and its phases; part of the settings of every recording of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanPosition {
    pub plan: String,
    /// By which another version of the plan is recognised.
    pub digest: String,
    /// Index in the plan, from 0.
    pub participant: u32,
    /// Name of the starting group: "AB".
    pub group: String,
    /// Number of the trial, from 1; `None` for the familiarisation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period: Option<u32>,
    /// Number of counted trials per participant.
    pub periods: u32,
    /// `None` for a recording of the tutorial alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arm: Option<StudyArm>,
    #[serde(default, skip_serializing_if = "StudyAims::are_default")]
    pub aims: StudyAims,
    /// From 1.
    pub attempt: u32,
    /// Of the familiarisation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub criterion: Option<PracticeCriterion>,
    #[serde(rename = "phase")]
    pub phases: Vec<PhaseSpec>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PracticeCriterion {
    /// Least number of served orders.
    pub orders: u32,
    /// Largest share of errors among the human's presses, 0 to 1; `None`: errors do not matter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_rate: Option<f64>,
}

impl PracticeCriterion {
    pub fn is_met(&self, orders: u32, presses: u32, errors: u32) -> bool {
        let share = f64::from(errors) / f64::from(presses.max(1));
        orders >= self.orders && self.error_rate.is_none_or(|most| share <= most)
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, strum::EnumDiscriminants)]
#[serde(tag = "what", rename_all = "snake_case", deny_unknown_fields)]
#[strum_discriminants(name(StudyPhase), doc = "The kind of a phase.")]
#[strum_discriminants(derive(Serialize, Deserialize, strum::IntoStaticStr))]
#[strum_discriminants(serde(rename_all = "snake_case"), strum(serialize_all = "snake_case"))]
pub enum PhaseSpec {
    Instruction {
        steps: Vec<String>,
    },
    Tutorial {
        tutorial: Tutorial,
    },
    /// Practice, which does not count.
    Familiarisation,
    Trial,
    Questionnaire {
        questionnaire: Questionnaire,
    },
    Debriefing {
        steps: Vec<String>,
    },
}

impl PhaseSpec {
    pub fn phase(&self) -> StudyPhase {
        self.into()
    }

    /// Steps that the wizard ticks off.
    pub fn steps(&self) -> &[String] {
        match self {
            PhaseSpec::Instruction { steps } | PhaseSpec::Debriefing { steps } => steps,
            _ => &[],
        }
    }
}

impl PlanPosition {
    pub fn is_tutorial_alone(&self) -> bool {
        matches!(self.phases[..], [PhaseSpec::Tutorial { .. }])
    }

    /// Name of the plan to which the recording belongs; a tutorial alone is recorded under a name of its own.
    pub fn plan_of_study(&self) -> &str {
        let own = self.plan.strip_suffix(TUTORIAL_ALONE).filter(|_| self.is_tutorial_alone());
        own.unwrap_or(&self.plan)
    }

    /// "trial 1/2", "practice".
    pub fn label(&self) -> String {
        let again = if self.attempt > 1 { format!(", attempt {}", self.attempt) } else { String::new() };
        match self.period {
            Some(period) => format!("trial {period}/{}{again}", self.periods),
            None if self.is_tutorial_alone() => "tutorial".to_string(),
            None => format!("practice{again}"),
        }
    }
}
