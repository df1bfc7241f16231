//! Study plans: the series of recordings of each participant, with conditions and dish orders. Everything in this
//! module is a function of the plan and its seed, independent of the order in which participants come.
//!
//! A recording has at most one trial. The settings of a recording contain its `step` (plan, digest, group, period,
//! attempt, phases with all texts and items), so that it can be replayed after the plan has changed. Progress follows
//! from the recordings alone; there is no file with the state of a study. A step that is left early has no end event
//! and can be continued like one that was cut off.
//!
//! The files from the ground up: `groups` (orders of conditions), `plan_spec` (the `[plan]` of a session file),
//! `starting_groups` (assignment of participants to groups), `item_form` (answer formats of items), `questionnaire` and
//! `questionnaire_checks` (its file), `tutorial`, `step` (one recording), `study_aims` (primary outcome and margin),
//! `planned_study` (all of them), `progress` (completed and missing recordings).

mod groups;
mod item_form;
mod plan_spec;
mod planned_study;
mod progress;
mod questionnaire;
mod questionnaire_checks;
mod starting_groups;
mod step;
mod study_aims;
mod tutorial;

pub use groups::{StartingGroup, orders};
pub use item_form::{AnswerFormat, ItemOption, QuestionnaireItemKind, RatingScale, SLIDER_END};
pub use plan_spec::{FamiliarisationSpec, Participants, PlanSpec, QuestionnaireSpec};
pub use planned_study::{PlannedTrial, Study, WantedRecording};
pub use progress::{
    NextRecording, ParticipantProgress, PlanRecording, PlannedTrialProgress, RecordingOutcome, TrialAttempt,
};
pub use questionnaire::{Questionnaire, QuestionnaireItem, ScoreRule};
pub use step::{PhaseSpec, PlanPosition, PracticeCriterion};
pub use study_aims::{PrimaryOutcome, StudyAims};
pub use tutorial::{Tutorial, TutorialStep, TutorialStepKind, TutorialTarget};
