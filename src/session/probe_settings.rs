//! Settings of freeze probes in a session file.

use serde::{Deserialize, Serialize};

use crate::settings::SettingError;
use tomcom_core::kitchen::Kitchen;

/// `[probes]` of a session file; without it there are no freeze probes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ProbeSpec {
    /// Number of scheduled probes.
    pub per_trial: u32,
    /// Least time before the first probe and between two, on the trial's clock.
    pub apart_s: f64,
    /// Time after a signal or a probe in which none begins, on the trial's clock.
    pub after_signal_s: f64,
    /// Longest time for which a probe waits while it may not begin, on the trial's clock; then it is cancelled.
    pub wait_s: f64,
    /// Time for each question; one without an answer in it is missed.
    pub limit_s: f64,
    /// Count-down before the task continues.
    pub count_down_s: f64,
    pub least_questions: u32,
    pub most_questions: u32,
    /// Share of blind probes, whose questions are chosen without the belief estimate.
    pub blind_share: f64,
    /// Least inclusion probability of any question.
    pub least_inclusion: f64,
    /// Probability, for the belief filter, that the participant looks at a place because a question was about it.
    pub teaches: f64,
    /// Whether the participant also reports the confidence in each answer.
    pub confidence: bool,
    /// Whether a probe can also ask what happens next (level 2 of situation awareness).
    pub level_2: bool,
    /// Names of locations, and recipes as "recipe of DISH", about which nothing is asked.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub leave_out: Vec<String>,
}

impl Default for ProbeSpec {
    fn default() -> Self {
        ProbeSpec {
            per_trial: 4,
            apart_s: 60.0,
            after_signal_s: 10.0,
            wait_s: 15.0,
            limit_s: 12.0,
            count_down_s: 3.0,
            least_questions: 2,
            most_questions: 4,
            blind_share: 0.5,
            least_inclusion: 0.05,
            teaches: 0.0,
            confidence: false,
            level_2: false,
            leave_out: Vec::new(),
        }
    }
}

impl ProbeSpec {
    pub(crate) fn check(&self, trial_s: f64) -> Result<(), SettingError> {
        let ProbeSpec { per_trial, apart_s, wait_s, least_questions, most_questions, .. } = *self;
        if least_questions > most_questions {
            let found = format!("least_questions = {least_questions}, and most_questions = {most_questions}");
            return Err(SettingError::new("probes.least_questions", found, "no more than most_questions"));
        }
        let needs_s = f64::from(per_trial) * apart_s + wait_s;
        if per_trial > 0 && needs_s > trial_s {
            let found = format!(
                "per_trial = {per_trial}, which takes {needs_s} s with apart_s = {apart_s} and wait_s = {wait_s}, in a trial of \
                 {trial_s} s"
            );
            let remedy = "fewer probes, a smaller apart_s under [probes], or more seconds under [trial]";
            return Err(SettingError::new("probes.per_trial", found, remedy));
        }
        Ok(())
    }

    /// The kitchen must have what the settings name, and enough state aspects for the questions.
    pub fn check_kitchen(&self, kitchen: &Kitchen) -> Result<(), SettingError> {
        let is_there = |name: &String| kitchen.aspects.iter().any(|aspect| aspect.name == *name);
        if let Some(name) = self.leave_out.iter().find(|name| !is_there(name)) {
            let found = format!("leave_out = \"{name}\", which the kitchen does not have");
            let remedy = "names of the layout's locations, or \"recipe of DISH\"";
            return Err(SettingError::new("probes.leave_out", found, remedy));
        }
        let asked = kitchen.aspects.iter().filter(|aspect| self.asks_about(&aspect.name, aspect.labels.len())).count();
        if (self.most_questions as usize) > asked {
            let found =
                format!("most_questions = {}, and {asked} locations and recipes to ask about", self.most_questions);
            return Err(SettingError::new("probes.most_questions", found, "no more questions than that"));
        }
        if self.least_inclusion * asked as f64 > f64::from(self.least_questions) {
            let found = format!(
                "least_inclusion = {} for each of {asked} locations and recipes, in probes with least_questions = {}",
                self.least_inclusion, self.least_questions
            );
            let remedy = format!("at most {:.3}, or more questions", f64::from(self.least_questions) / asked as f64);
            return Err(SettingError::new("probes.least_inclusion", found, remedy));
        }
        Ok(())
    }

    /// `values`: number of the aspect's possible values.
    pub(crate) fn asks_about(&self, aspect: &str, values: usize) -> bool {
        values > 1 && !self.leave_out.iter().any(|name| name == aspect)
    }
}
