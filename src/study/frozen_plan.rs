//! The frozen plan of a study (preregistration): study plan, definitions of the measures, and analysis, as written down
//! before the study begins.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::arm_design::pairs;
use super::definitions::DEFINITIONS;
use super::effect::LEVEL;
use tomcom_session::plan::{PrimaryOutcome, Study};
use tomcom_session::study_arm::StudyArm;

/// Version of the frozen plan's file format.
pub const FROZEN_FORMAT: u32 = 1;

/// Reasons for excluding a trial from the analysis, in the words of the frozen plan.
const EXCLUSIONS: [&str; 5] = [
    "Trials that were aborted, with their reason.",
    "Trials that were excluded by the experimenter (tomcom exclude, or at the console), with their reason.",
    "Trials whose recording was cut before the trial's end.",
    "Trials without a press.",
    "Of a trial that was repeated, all attempts but the last; practice is no trial.",
];

/// Statistical methods that compare the conditions, in the words of the frozen plan.
const METHODS: [&str; 6] = [
    "Each trial counts in the condition to which the plan assigned it. Trials that were carried out in another condition are listed, and the \
     same analysis by the conditions as carried out is given beside.",
    "Primary: linear mixed model of log((events + 0.5) / presses of the human); participant random, condition and number of the trial fixed; \
     REML, Satterthwaite's degrees of freedom; Holm's correction over all contrasts.",
    "Beside it: mixed negative binomial model of the events with log presses of the human as offset; Laplace's approximation, Wald's tests.",
    "Two conditions of which one is unassisted: mixed ANOVA of errors per press of the human, interaction of period and starting group, sums of squares of type III; \
     Pearson's r, permutation test, Hodges-Lehmann estimate (the paper's analysis).",
    "From three conditions on: the primary model with the condition of the trial before, as a sensitivity analysis (carry-over).",
    "Non-inferiority of an assistant to the wizard: the upper end of the one-sided interval of 97.5 % of the ratio of rates is below the margin.",
];

/// A term of the report with its definition, as the frozen plan has it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrozenDefinition {
    /// The term that the report defines.
    pub term: String,
    /// Definition of the term, as the report prints it.
    pub meaning: String,
}

/// The analysis of a study as its frozen plan states it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrozenAnalysis {
    /// Version of the program that will do the analysis.
    pub program: String,
    /// Primary outcome of the study.
    pub outcome: PrimaryOutcome,
    /// Contrasts that the analysis computes: each an arm, and the arm with which it is compared.
    pub contrasts: Vec<[StudyArm; 2]>,
    /// Margin of non-inferiority, as a ratio of rates (assistant to wizard).
    pub margin: f64,
    /// Confidence level of the intervals in the analysis.
    pub level: f64,
    /// Statistical methods that compare the conditions.
    pub methods: Vec<String>,
    /// Reasons for which trials are excluded.
    pub exclusions: Vec<String>,
}

/// Content of a frozen plan's file: study plan, definitions and analysis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrozenPlan {
    /// Version of the file format of frozen plans.
    pub frozen_plan: u32,
    /// Name of the study plan.
    pub plan: String,
    /// Checksum of study plan and settings, which every recording of the plan contains.
    pub plan_digest: String,
    /// Seed from which starting groups and trials follow.
    pub seed: u64,
    /// Pseudonymous codes of the participants.
    pub participants: Vec<String>,
    /// Starting group of each participant, in the order of `participants`.
    pub groups: Vec<String>,
    /// Number of recordings of the plan that existed when the plan was frozen.
    pub recordings_before: u64,
    /// The analysis of the study, as frozen before the study.
    pub analysis: FrozenAnalysis,
    /// Definitions of the report's terms, as frozen before the study.
    pub definitions: Vec<FrozenDefinition>,
    /// The table `[plan]`, the settings of the plan's trials, and the questionnaires, tutorial and kitchen files.
    pub settings: Value,
}

impl FrozenAnalysis {
    /// The analysis that this version of the program does for a study.
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
    /// Freezes a study's present plan. `kitchen`: the texts of the layout file and of the recipe file.
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

    /// Definitions and methods in which this version of the program differs from the frozen plan, in words.
    pub fn differs_from_program(&self) -> Vec<String> {
        let mut found = Vec::new();
        let (own, program) = (&self.analysis, env!("CARGO_PKG_VERSION"));
        if own.program != program {
            found.push(format!("the analysis is made by tomcom {program}, and was frozen for tomcom {}", own.program));
        }
        let lists = [("methods", &own.methods, &METHODS[..]), ("exclusions", &own.exclusions, &EXCLUSIONS[..])];
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
