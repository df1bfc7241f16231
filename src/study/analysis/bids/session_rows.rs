//! The BIDS table of a participant's sessions, with a row for each recording.

use super::event_cells;
use super::tsv::{self, BidsColumn, BidsFile, YES_NO, or_nothing, seconds, yes};
use tomcom_core::base::time::SessionTime;
use tomcom_session::event::TrialEndReason;
use tomcom_session::{LogHeader, Session};

const CONDITIONS: &[(&str, &str)] = &[
    ("none", "Nobody sent signals"),
    ("wizard", "The wizard could send signals"),
    ("assistant", "The assistant sent signals by itself"),
];
const ENDS: &[(&str, &str)] = &[
    ("presses", "The set number of presses was reached"),
    ("time", "The set time was reached"),
    ("orders", "The set number of orders was served"),
    ("wizard", "The wizard ended it"),
    ("aborted", "It was aborted and does not count"),
];

const COLUMNS: [BidsColumn; 21] = [
    BidsColumn::new("session_id", "The recording's session"),
    BidsColumn::new("acq_time", "When the recording began (UTC); n/a: simulated"),
    BidsColumn::new("recording", "Name of the recording's folder"),
    BidsColumn::new("kitchen", "Name of the kitchen"),
    BidsColumn::of_levels("condition", CONDITIONS, "Who could send signals"),
    BidsColumn::new("concept", "Communication concept of the assistant"),
    BidsColumn::new(
        "study_arm",
        "Arm by what was done: none, wizard, wizard+advice (the wizard saw recommendations), tom-com, tom or dev",
    ),
    BidsColumn::new(
        "planned_arm",
        "Arm under which the trial counts: that of the plan, without a plan that of the settings",
    ),
    BidsColumn::of_levels("practice", YES_NO, "Whether it is practice, which no analysis takes"),
    BidsColumn::new("period", "Number of the trial in the plan, from 1"),
    BidsColumn::new("attempt", "Number of the attempt, from 1"),
    BidsColumn::new("gaze", "Where gaze came from"),
    BidsColumn::new("arm", "Kind of the robot's arm"),
    BidsColumn::of_unit("trial_time", "s", "Length of the trial by its own clock"),
    BidsColumn::of_levels("ended", ENDS, "Why the trial ended; n/a: it did not"),
    BidsColumn::of_levels("complete", YES_NO, "Whether the recording has its end"),
    BidsColumn::of_levels(
        "excluded",
        YES_NO,
        "Whether the trial was aborted or is left out of the analysis; the reason is in the recording",
    ),
    BidsColumn::new("seed", "Seed of all random numbers"),
    BidsColumn::new("trial", "Index of the trial: with the same seed, another index gives other orders"),
    BidsColumn::new("log_version", "Version of the log's format"),
    BidsColumn::new("program", "Version of tomcom that made the recording"),
];

/// Row of a recording in the BIDS table of sessions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BidsSessionRow(String);

impl BidsSessionRow {
    /// The row of a recording that was read to its end. `label`: BIDS label of the recording's session; `ended`: why
    /// the trial ended; `is_complete`: whether the log is complete; `counts`: whether analyses include the trial.
    pub fn new(
        (label, recording): (&str, &str),
        header: &LogHeader,
        session: &Session,
        ended: Option<TrialEndReason>,
        [is_complete, counts]: [bool; 2],
    ) -> BidsSessionRow {
        let (spec, step) = (&session.spec, session.spec.step.as_ref());
        let clock = session.trial_clock(session.time);
        BidsSessionRow(tsv::line([
            format!("ses-{label}"),
            or_nothing(header.started.clone()),
            recording.to_string(),
            session.kitchen.name.clone(),
            spec.trial.condition.name().to_string(),
            spec.assistant.concept.name().to_string(),
            session.study_arm().name().to_string(),
            session.planned_arm().name().to_string(),
            yes(step.is_some_and(|step| step.period.is_none())),
            or_nothing(step.and_then(|step| step.period)),
            or_nothing(step.map(|step| step.attempt)),
            event_cells::name(&spec.participant.gaze),
            event_cells::name(&spec.robot.arm),
            or_nothing((clock > SessionTime::ZERO).then(|| seconds(clock))),
            or_nothing(ended.map(TrialEndReason::name)),
            yes(is_complete),
            yes(!counts),
            session.seed().to_string(),
            header.trial.to_string(),
            header.version.to_string(),
            header.program.clone(),
        ]))
    }
}

/// The table of sessions of the participant with this label, with its sidecar file.
pub fn sessions_files(participant: &str, rows: &[BidsSessionRow]) -> [BidsFile; 2] {
    let path = format!("sub-{participant}/sub-{participant}_sessions");
    let text: String = rows.iter().map(|row| row.0.as_str()).collect();
    let text = tsv::line(tsv::names(&COLUMNS)) + &text;
    let about = tsv::described(&COLUMNS);
    [BidsFile::new(format!("{path}.tsv"), text), BidsFile::json(format!("{path}.json"), &about.into())]
}
