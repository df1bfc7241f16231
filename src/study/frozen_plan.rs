//! What is frozen before a study begins (preregistration): its plan, the definitions of the measures, and the analysis.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::arm_design::pairs;
use super::definitions::DEFINITIONS;
use super::effect::LEVEL;
use crate::session::plan::{PrimaryOutcome, Study};
use crate::session::study_arm::StudyArm;

/// Version of the format.
pub const FROZEN_FORMAT: u32 = 1;

/// Why a trial is left out of the analysis, in the words of the frozen plan.
const EXCLUSIONS: [&str; 5] = [
    "Trials that were aborted, with their reason.",
    "Trials that were excluded by the experimenter (tomcom exclude, or at the console), with their reason.",
    "Trials whose recording was cut before the trial's end.",
    "Trials without a press.",
    "Of a trial that was repeated, all attempts but the last; practice is no trial.",
];

/// How the conditions are compared.
const METHODS: [&str; 5] = [
    "Primary: linear mixed model of log((events + 0.5) / presses of the human); participant random, condition and number of the trial fixed; \
     REML, Satterthwaite's degrees of freedom; Holm's correction over all contrasts.",
    "Beside it: mixed negative binomial model of the events with log presses of the human as offset; Laplace's approximation, Wald's tests.",
    "Two conditions of which one is unassisted: mixed ANOVA of errors per press of the human, interaction of period and starting group; \
     Pearson's r, permutation test, Hodges-Lehmann estimate (the paper's analysis).",
    "From three conditions on: the primary model with the condition of the trial before, as a sensitivity analysis (carry-over).",
    "Non-inferiority of an assistant to the wizard: the upper end of the one-sided interval of 97.5 % of the ratio of rates is below the margin.",
];

/// A definition of the report.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrozenDefinition {
    /// The term.
    pub term: String,
    /// What it means.
    pub meaning: String,
}

/// The analysis of a study, as it is frozen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrozenAnalysis {
    /// Version of the program that computes it.
    pub program: String,
    /// What the analysis compares first.
    pub outcome: PrimaryOutcome,
    /// The contrasts: an arm, and the arm that it is compared with.
    pub contrasts: Vec<[StudyArm; 2]>,
    /// Margin of non-inferiority, as a ratio of rates.
    pub margin: f64,
    /// Level of intervals.
    pub level: f64,
    /// How the conditions are compared.
    pub methods: Vec<String>,
    /// Which trials are left out.
    pub exclusions: Vec<String>,
}

/// A plan with definitions and analysis, as it stands in the frozen file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrozenPlan {
    /// Version of the format.
    pub frozen_plan: u32,
    /// The plan's name.
    pub plan: String,
    /// Checksum of plan and settings that every recording of the plan has.
    pub plan_digest: String,
    /// The seed that groups and trials follow from.
    pub seed: u64,
    /// Codes of the participants.
    pub participants: Vec<String>,
    /// The starting group of each participant, in the same order.
    pub groups: Vec<String>,
    /// Number of recordings of the plan that were there when it was frozen.
    pub recordings_before: u64,
    /// The analysis.
    pub analysis: FrozenAnalysis,
    /// The definitions of the report.
    pub definitions: Vec<FrozenDefinition>,
    /// The table `[plan]`, the settings of its trials, questionnaires, tutorial and kitchen files.
    pub settings: Value,
}

impl FrozenAnalysis {
    /// The analysis that this version of the program makes of a study.
    pub fn from_study(study: &Study) -> FrozenAnalysis {
        let conditions = &study.plan.conditions;
        let arms: Vec<StudyArm> = StudyArm::ALL.into_iter().filter(|arm| conditions.contains(arm)).collect();
        FrozenAnalysis {
            program: env!("CARGO_PKG_VERSION").to_string(),
            outcome: study.plan.aims.outcome,
            contrasts: pairs(&arms).into_iter().map(|(arm, against)| [arm, against]).collect(),
            margin: study.plan.aims.margin,
            level: LEVEL,
            methods: METHODS.map(str::to_string).to_vec(),
            exclusions: EXCLUSIONS.map(str::to_string).to_vec(),
        }
    }
}

impl FrozenPlan {
    /// The plan as it is now. `kitchen` are the texts of the layout and of the recipes.
    pub fn new(study: &Study, kitchen: [&str; 2], recordings_before: u64) -> FrozenPlan {
        let participants = study.plan.codes();
        let [layout, recipes] = kitchen;
        FrozenPlan {
            frozen_plan: FROZEN_FORMAT,
            plan: study.plan.name.clone(),
            plan_digest: study.digest.clone(),
            seed: study.session.seed,
            groups: (0..participants.len()).map(|index| study.group(index).name).collect(),
            participants,
            recordings_before,
            analysis: FrozenAnalysis::from_study(study),
            definitions: current_definitions(),
            settings: serde_json::json!({
                "plan": study.plan,
                "session": study.session,
                "questionnaires": study.questionnaires,
                "tutorial": study.tutorial,
                "layout": layout,
                "recipes": recipes,
            }),
        }
    }

    /// What this version of the program defines or computes otherwise, in words.
    pub fn differs_from_program(&self) -> Vec<String> {
        let mut found = Vec::new();
        let (own, program) = (&self.analysis, env!("CARGO_PKG_VERSION"));
        if own.program != program {
            found.push(format!("the analysis is made by tomcom {program}, and was frozen for tomcom {}", own.program));
        }
        let lists = [("methods", &own.methods, &METHODS), ("exclusions", &own.exclusions, &EXCLUSIONS)];
        for (what, frozen, now) in lists {
            if !frozen.iter().map(String::as_str).eq(now.iter().copied()) {
                found.push(format!("the {what} of the analysis are worded otherwise than in the frozen plan"));
            }
        }
        if own.level != LEVEL {
            found.push(format!("intervals have the level {LEVEL}, frozen: {}", own.level));
        }
        let now = current_definitions();
        let frozen_meaning = |term: &str| self.definitions.iter().find(|one| one.term == term).map(|one| &one.meaning);
        for one in &now {
            match frozen_meaning(&one.term) {
                Some(meaning) if *meaning == one.meaning => {}
                Some(_) => found.push(format!("the definition of \"{}\" is another one", one.term)),
                None => found.push(format!("the definition of \"{}\" is not in the frozen plan", one.term)),
            }
        }
        let gone = self.definitions.iter().filter(|frozen| now.iter().all(|one| one.term != frozen.term));
        found.extend(gone.map(|frozen| format!("the definition of \"{}\" is gone", frozen.term)));
        found
    }
}

fn current_definitions() -> Vec<FrozenDefinition> {
    let one =
        |(term, meaning): &(&str, &str)| FrozenDefinition { term: term.to_string(), meaning: meaning.to_string() };
    DEFINITIONS.iter().map(one).collect()
}
