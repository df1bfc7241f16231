//! The frozen plan of a study (preregistration): study plan, definitions of the measures, and analysis, as written down
//! before the study begins; and the comparison of a study with it.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::arm_comparison::arm_pairs;
use crate::definitions::DEFINITIONS;
use crate::effect::LEVEL;
use tomcom_core::base::text::count;
use tomcom_session::header::RecordedFile;
use tomcom_session::plan::{PlanDifference, PrimaryOutcome, Study, differences, listed};
use tomcom_session::study_arm::StudyArm;
use tomcom_session::{LogHeader, SessionSpec};

pub(crate) const FROZEN_FORMAT: u32 = 1;

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

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrozenDefinition {
    pub term: String,
    pub meaning: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrozenAnalysis {
    pub program: String,
    pub outcome: PrimaryOutcome,
    /// Contrasts that the analysis computes: each an arm, and the arm with which it is compared.
    pub contrasts: Vec<[StudyArm; 2]>,
    /// Margin of non-inferiority, as a ratio of rates (assistant to wizard).
    pub margin: f64,
    pub level: f64,
    pub methods: Vec<String>,
    pub exclusions: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrozenPlan {
    pub frozen_plan: u32,
    pub plan: String,
    pub plan_digest: String,
    pub seed: u64,
    pub participants: Vec<String>,
    /// Starting group of each participant, in the order of `participants`.
    pub groups: Vec<String>,
    pub recordings_before: u64,
    pub analysis: FrozenAnalysis,
    pub definitions: Vec<FrozenDefinition>,
    pub settings: Value,
}

impl FrozenAnalysis {
    pub fn from_study(study: &Study) -> FrozenAnalysis {
        let conditions = &study.plan.conditions;
        let arms: Vec<StudyArm> = StudyArm::ALL.into_iter().filter(|arm| conditions.contains(arm)).collect();
        FrozenAnalysis {
            program: env!("CARGO_PKG_VERSION").to_string(),
            outcome: study.plan.aims.outcome,
            contrasts: arm_pairs(&arms).into_iter().map(|(arm, against)| [arm, against]).collect(),
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

    /// The settings of plan and session that differ from the frozen ones and can change a trial.
    pub fn differs_from(&self, study: &Study) -> Vec<PlanDifference> {
        let session = |study: &Study| SessionSpec { plan: Some(study.plan.clone()), ..study.session.clone() };
        self.study().map_or_else(Vec::new, |frozen| differences(&session(&frozen), &session(study)))
    }

    /// What participants are taught and asked that differs from what was frozen.
    pub fn texts_differ_from(&self, study: &Study) -> Vec<PlanDifference> {
        self.study().map_or_else(Vec::new, |frozen| study.texts_changed_since(&frozen))
    }

    /// The study as it was frozen; `None` if this version of the program has other settings.
    fn study(&self) -> Option<Study> {
        let part = |name: &str| self.settings[name].clone();
        Some(Study {
            plan: serde_json::from_value(part("plan")).ok()?,
            questionnaires: serde_json::from_value(part("questionnaires")).ok()?,
            tutorial: serde_json::from_value(part("tutorial")).ok()?,
            session: serde_json::from_value(part("session")).ok()?,
            digest: self.plan_digest.clone(),
        })
    }

    /// What is not as it was frozen in a recording of another version of the plan, in words.
    fn changed_in(&self, recorded: &LogHeader) -> Option<String> {
        let [layout, recipes] =
            [("layout", &recorded.layout), ("recipes", &recorded.recipes)].map(|(name, recorded)| {
                let text = self.settings[name].as_str().unwrap_or_default().to_string();
                RecordedFile { path: recorded.path.clone(), text }
            });
        let changed = self.study()?.changed_since(recorded, [&layout, &recipes]);
        Some(listed(&changed.into_iter().map(PlanDifference::reversed).collect::<Vec<_>>()))
    }

    fn differs_from_program(&self) -> Vec<String> {
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

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecordedPlan {
    pub participant: String,
    /// The code in the log, if it was corrected.
    pub recorded_as: Option<String>,
    /// Name and digest of the recording's study plan; `None` for a recording without a plan.
    pub plan: Option<(String, String)>,
    pub place: Option<PlaceInPlan>,
}

impl RecordedPlan {
    pub(crate) fn from_header(header: &LogHeader) -> RecordedPlan {
        let spec = &header.session;
        let plan = spec.step.as_ref().map(|step| (step.plan.clone(), step.digest.clone()));
        let place = spec.step.as_ref().map(|step| PlaceInPlan {
            participant: step.participant,
            group: step.group.clone(),
            period: step.period,
            periods: step.periods,
            arm: step.arm,
        });
        let recorded_as = header.correction.as_ref().map(|correction| correction.before.clone());
        RecordedPlan { participant: spec.participant.code.clone(), recorded_as, plan, place }
    }

    /// The participant's code in the log, to whom the place in the plan belongs.
    pub(crate) fn recorded_code(&self) -> &str {
        self.recorded_as.as_ref().unwrap_or(&self.participant)
    }
}

/// The first recording, by name, of each version of a plan.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct PlanVersions(BTreeMap<String, (String, LogHeader)>);

fn version(plan: &str, digest: &str) -> String {
    format!("{plan} {digest}")
}

impl PlanVersions {
    pub(crate) fn add(&mut self, recording: &str, header: &LogHeader) {
        let Some(step) = &header.session.step else { return };
        let version = version(&step.plan, &step.digest);
        let has_earlier = |(first, _): &(String, LogHeader)| first.as_str() <= recording;
        if !self.0.get(&version).is_some_and(has_earlier) {
            self.0.insert(version, (recording.to_string(), header.clone()));
        }
    }

    pub(crate) fn join(&mut self, others: &PlanVersions) {
        others.0.values().for_each(|(recording, header)| self.add(recording, header));
    }
}

/// Of the participant who has the code in the log, whose recording it may not be.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaceInPlan {
    /// From 0.
    pub participant: u32,
    /// Name of the starting group, with a letter for each trial.
    pub group: String,
    /// Number of the trial, from 1; `None` for practice.
    pub period: Option<u32>,
    /// Number of counted trials per participant; 0 for a recording of the tutorial alone.
    pub periods: u32,
    /// Condition of the trial.
    pub arm: Option<StudyArm>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PreregistrationCheck {
    /// SHA-256 digest of the frozen plan, in hexadecimal.
    pub digest: String,
    pub plan: String,
    pub recordings_before: u64,
    /// Differences between study and frozen plan, in words; empty if there are none.
    pub differences: Vec<String>,
    /// Codes of the plan's participants of whom there is no recording yet.
    pub to_come: Vec<String>,
}

impl PreregistrationCheck {
    /// Compares recordings, and this version's definitions, with the frozen plan that has this digest. `versions`: those of
    /// the recordings; `ended`: number of trials that count though the wizard ended them.
    pub fn new(
        digest: String,
        frozen: &FrozenPlan,
        recordings: &[RecordedPlan],
        versions: &PlanVersions,
        ended: u64,
    ) -> PreregistrationCheck {
        let mut differences = frozen.differs_from_program();
        let mut others: BTreeMap<String, u64> = BTreeMap::new();
        for recording in recordings {
            let what = match &recording.plan {
                None => "of no plan".to_string(),
                Some((plan, _)) if *plan != frozen.plan => format!("of the plan \"{plan}\""),
                Some((plan, digest)) if *digest != frozen.plan_digest => {
                    let recorded = versions.0.get(&version(plan, digest));
                    let changed = recorded.and_then(|(_, header)| frozen.changed_in(header));
                    let changed = changed.map_or(String::new(), |changed| format!(", which changed since: {changed}"));
                    format!(
                        "of another version of the plan ({}, frozen: {}){changed}",
                        start_of(digest),
                        start_of(&frozen.plan_digest)
                    )
                }
                Some(_) => continue,
            };
            *others.entry(what).or_default() += 1;
        }
        differences.extend(
            others.iter().map(|(what, number)| format!("{} {what}", count(*number, "recording is", "recordings are"))),
        );
        // Recordings of other plans are told above; their participants are not those of this plan.
        let is_own = |recording: &&RecordedPlan| recording.plan.as_ref().is_some_and(|(plan, _)| *plan == frozen.plan);
        let own = recordings.iter().filter(is_own);
        let there: BTreeSet<&str> = own.map(|recording| recording.participant.as_str()).collect();
        let is_planned = |code: &&&str| frozen.participants.iter().any(|planned| planned == **code);
        let strangers: Vec<&str> = there.iter().filter(|code| !is_planned(code)).copied().collect();
        let to_come = frozen.participants.iter().filter(|code| !there.contains(code.as_str())).cloned().collect();
        differences.extend(named("not in the frozen plan", &strangers));
        if ended > 0 {
            differences
                .push(format!("the wizard ended {} early", count(ended, "trial that counts", "trials that count")));
        }
        let (plan, recordings_before) = (frozen.plan.clone(), frozen.recordings_before);
        PreregistrationCheck { digest, plan, recordings_before, differences, to_come }
    }

    pub fn words(&self) -> String {
        let before = match self.recordings_before {
            0 => "when no recording of it was there".to_string(),
            number => format!("when {} of it there", count(number, "recording was", "recordings were")),
        };
        let frozen = format!("the plan \"{}\" was frozen {before}, SHA-256 {}…", self.plan, start_of(&self.digest));
        let to_come = match &self.to_come[..] {
            [] => String::new(),
            codes => {
                let are = count(codes.len() as u64, "participant has", "participants have");
                format!(" {are} no recording so far: {}.", codes.join(", "))
            }
        };
        let so_far = if to_come.is_empty() { "Preregistered" } else { "So far as preregistered" };
        let told = match &self.differences[..] {
            [] => format!("{so_far}: {frozen}; plan, definitions and analysis are those."),
            several => format!("Not as preregistered: {frozen}; differences: {}.", several.join("; ")),
        };
        told + &to_come
    }
}

/// Enough of a digest to tell versions apart.
fn start_of(digest: &str) -> &str {
    digest.get(..12).unwrap_or(digest)
}

fn named(who: &str, codes: &[&str]) -> Option<String> {
    let number = count(codes.len() as u64, "participant is", "participants are");
    (!codes.is_empty()).then(|| format!("{number} {who}: {}", codes.join(", ")))
}
