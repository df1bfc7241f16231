//! The `[plan]` of a session file: a study's participants, conditions and phases.

use serde::{Deserialize, Serialize};

use super::groups::orders;
use super::study_aims::StudyAims;
use crate::console_settings::WizardVisibility;
use crate::person_code;
use crate::setting_checks::{SettingError, is_code};
use crate::study_arm::StudyArm;
use crate::wall_display::AnswerDevice;
use tomcom_core::base::text::count;

/// The `[plan]` of a session file: participants, conditions, and the phases around the trials.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanSpec {
    /// Name of the study plan, by which recordings of the plan are recognised.
    pub name: String,
    /// The participants of the study.
    pub participants: Participants,
    /// Study arms that the study compares; each participant has one trial in each arm, in counterbalanced order.
    pub conditions: Vec<StudyArm>,
    /// The primary outcome of the study, and its margin of non-inferiority.
    #[serde(default, skip_serializing_if = "StudyAims::are_default")]
    pub aims: StudyAims,
    /// Size of a permuted block, in participants; by default each order of the conditions occurs twice in a block.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub block: Option<u32>,
    /// Consent text, which is shown before anything is recorded.
    #[serde(default = "default_consent")]
    pub consent: String,
    /// How the participant consents: by holding a button on the display, or by telling the wizard, who confirms the
    /// consent at the console.
    #[serde(default = "on_console")]
    pub consent_on: AnswerDevice,
    /// Steps of the wizard's instruction to the participant.
    #[serde(default)]
    pub instruction: Vec<String>,
    /// File of the tutorial that the participant sees on the display after the instruction, relative to the session
    /// file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tutorial: Option<String>,
    /// Practice trial before the first trial, if the plan has a practice trial.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub familiarisation: Option<FamiliarisationSpec>,
    /// The questionnaires, and after which trials the participant answers them.
    #[serde(default)]
    pub questionnaire: Vec<QuestionnaireSpec>,
    /// Steps of the wizard's debriefing after the last trial.
    #[serde(default)]
    pub debriefing: Vec<String>,
}

fn default_consent() -> String {
    "The participant was told what is recorded and for what it is used, and agrees to it.".to_string()
}

fn on_console() -> AnswerDevice {
    AnswerDevice::Console
}

/// The participants of a plan: their number, from which codes follow (P01, P02, …), or a list of their codes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "a number of participants, or a list of their codes")]
pub enum Participants {
    /// The number of participants; their codes are P01, P02, …
    Count(u32),
    /// The codes of the participants, in a list.
    Codes(Vec<String>),
}

/// Practice trial (familiarisation) before the first trial, repeated until the participant meets a criterion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FamiliarisationSpec {
    /// The study arm of the practice trial: who may send signals.
    #[serde(default)]
    pub condition: StudyArm,
    /// Number of presses of both agents at which the practice trial ends, unless time or orders end it earlier.
    pub presses: u32,
    /// Duration after which the practice trial ends, in seconds on the trial's clock.
    pub seconds: f64,
    /// Criterion of the practice trial: least number of served orders.
    pub orders: u32,
    /// Criterion of the practice trial: largest share of errors among the human's presses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_rate: Option<f64>,
}

/// A questionnaire of a plan, with the trials after which the participant answers it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QuestionnaireSpec {
    /// The questionnaire's file, relative to the session file.
    pub file: String,
    /// Numbers of the trials after which the participant answers the questionnaire, from 1; by default after each
    /// trial.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after: Option<Vec<u32>>,
    /// Whether the participant answers the questionnaire once before the first trial; after trials it is then asked
    /// only if `after` says so.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub before: bool,
}

impl QuestionnaireSpec {
    /// Whether the questionnaire is asked after the trial with this number.
    pub fn is_asked_after(&self, period: u32) -> bool {
        self.after.as_ref().map_or(!self.before, |after| after.contains(&period))
    }
}

impl PlanSpec {
    /// Participant codes in the order of the plan.
    pub fn codes(&self) -> Vec<String> {
        match &self.participants {
            Participants::Count(count) => (1..=*count).map(|number| numbered(number, *count)).collect(),
            Participants::Codes(codes) => codes.clone(),
        }
    }

    /// Code of the participant with this index in the plan; empty beyond the last participant.
    pub fn code(&self, participant: usize) -> String {
        match &self.participants {
            Participants::Count(count) if participant < *count as usize => numbered(participant as u32 + 1, *count),
            Participants::Count(_) => String::new(),
            Participants::Codes(codes) => codes.get(participant).cloned().unwrap_or_default(),
        }
    }

    /// Checks ranges and consistency of the study plan.
    ///
    /// # Errors
    /// An error names the first invalid setting.
    pub fn check(&self) -> Result<(), SettingError> {
        let wrong = |key: &'static str, found: String, remedy: &'static str| Err(SettingError::new(key, found, remedy));
        if !is_code(&self.name) {
            let remedy = "a short name of letters, digits, - and _, such as \"main-study\"";
            return wrong("plan.name", format!("name = \"{}\"", self.name), remedy);
        }
        self.check_participants()?;
        let twice = |index: usize| self.conditions[..index].contains(&self.conditions[index]);
        if self.conditions.is_empty() {
            let remedy = "one to six conditions, such as [\"none\", \"wizard\", \"tom-com\"]";
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

    /// Checks that the study arms agree with what the wizard sees in the session.
    ///
    /// # Errors
    /// The plan has a wizard without advice, but the settings show recommendations.
    pub fn check_visibility(&self, visibility: WizardVisibility) -> Result<(), SettingError> {
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
        match &self.participants {
            Participants::Count(_) => Ok(()),
            Participants::Codes(codes) if codes.is_empty() => {
                wrong("no participants".to_string(), "how many there are, or a list of their codes")
            }
            Participants::Codes(codes) => {
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
    }
}

/// The code of a participant with this number: "P07" if there are up to 99 participants.
fn numbered(number: u32, count: u32) -> String {
    let digits = count.to_string().len().max(2);
    format!("P{number:0digits$}")
}
