//! Summary of one recording (presses, errors, beliefs, signals, gaze), and the list of the recordings in a folder.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use crate::analysis::trial_summary::{FalseBeliefErrorSummary, TrialSummary};
use tomcom_core::base::text::count;
use tomcom_core::gaze::quality::{DroppedInputCounts, GazeFaultCounts};
use tomcom_session::event::TrialEndReason;
use tomcom_session::follower::SessionFollower;
use tomcom_session::gaze_samples::faults;
use tomcom_session::log::LogEnding;
use tomcom_session::settings::{Condition, ParticipantKind};
use tomcom_session::study_arm::StudyArm;
use tomcom_session::{Session, SessionSpec};

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordingSummary {
    pub events: u64,
    pub cut: bool,
    pub running: bool,
    #[serde(flatten)]
    pub standing: ExclusionStatus,
    pub human_actions: u64,
    pub robot_actions: u64,
    pub errors: u64,
    /// Number of the human's presses that were races with the robot, which do not count as errors.
    pub races: u64,
    #[serde(flatten)]
    pub beliefs: FalseBeliefErrorSummary,
    pub signals: u64,
    pub unblinded: bool,
    pub orders_served: u64,
    pub trial_s: f64,
    pub gaze: GazeQualitySummary,
    /// Faults of the gaze stream in words; null without faults.
    #[serde(skip)]
    gaze_faults: Option<String>,
}

impl RecordingSummary {
    pub fn from_follower(follower: &SessionFollower, events: u64, standing: ExclusionStatus) -> RecordingSummary {
        let trial = TrialSummary::from_follower(follower);
        RecordingSummary {
            events,
            cut: false,
            running: false,
            standing,
            human_actions: trial.human_actions,
            robot_actions: trial.robot_actions,
            errors: trial.errors,
            races: trial.races,
            beliefs: FalseBeliefErrorSummary::from_trials([&trial]),
            signals: trial.signals,
            unblinded: follower.session.unblinded,
            orders_served: trial.served.len() as u64,
            trial_s: trial.seconds,
            gaze: GazeQualitySummary::from_session(&follower.session),
            gaze_faults: describe_gaze_faults(&follower.session),
        }
    }

    pub fn describe(&self) -> String {
        let cut = match (self.running, self.cut) {
            (true, _) => "; it is still running: --follow",
            (false, true) => "; it ends without its end event",
            (false, false) => "",
        };
        let standing = match self.standing.counts() {
            true => String::new(),
            false => format!("left out of the analysis: {}\n", self.standing.describe()),
        };
        let gaze = self.gaze_faults.as_ref().map_or(String::new(), |faults| format!("{faults}\n"));
        format!(
            "{standing}{}, {:.0} s of trial{cut}\n{} of the human ({}), {} of the robot, {}, {} served\n{}\n{gaze}",
            count(self.events, "event", "events"),
            self.trial_s,
            count(self.human_actions, "press", "presses"),
            count(self.errors, "error", "errors"),
            self.robot_actions,
            count(self.signals, "signal", "signals"),
            count(self.orders_served, "order", "orders"),
            self.beliefs.describe(self.errors)
        )
    }
}

/// What became of a recording. The list, `--continue` and the study judge by the same facts: whether its session was
/// closed, and whether its trial and, in a plan, its step was done then.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum RecordingState {
    /// Everything was done, and the session closed.
    Whole,
    /// Likewise, but the wizard ended the trial before its number of presses, time or orders.
    #[strum(serialize = "ended by wizard")]
    EndedByWizard,
    /// The session was closed, by the wizard or by a signal to the program, before everything was done.
    #[strum(serialize = "ended early")]
    EndedEarly,
    /// The session's end is missing, and no program is writing: the program or its computer failed.
    Cut,
    /// Nothing happened in it. A session that is left like this removes its recording; a killed one leaves it.
    Empty,
    Excluded,
    /// Running recording: the session is still writing to it.
    Running,
    Unreadable,
}

impl RecordingState {
    /// The state of a recording that was read to its end.
    pub fn from_session(session: &Session, ending: LogEnding, standing: &ExclusionStatus) -> RecordingState {
        match ending {
            LogEnding::Running => RecordingState::Running,
            _ if !standing.counts() => RecordingState::Excluded,
            _ if session.is_empty() => RecordingState::Empty,
            LogEnding::Cut => RecordingState::Cut,
            LogEnding::Closed if session.ended_early => RecordingState::EndedEarly,
            LogEnding::Closed if session.trial_end() == Some(TrialEndReason::Wizard) => RecordingState::EndedByWizard,
            LogEnding::Closed => RecordingState::Whole,
        }
    }

    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// Whether a recording is of a person, and of a trial that the study counts or of practice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RecordingKind {
    Trial,
    Practice,
    SimulatedTrial,
    SimulatedPractice,
}

impl RecordingKind {
    pub fn from_spec(spec: &SessionSpec) -> RecordingKind {
        let is_practice = spec.step.as_ref().is_some_and(|step| step.period.is_none());
        match (spec.participant.kind == ParticipantKind::Simulated, is_practice) {
            (false, false) => RecordingKind::Trial,
            (false, true) => RecordingKind::Practice,
            (true, false) => RecordingKind::SimulatedTrial,
            (true, true) => RecordingKind::SimulatedPractice,
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            RecordingKind::Trial => "trial",
            RecordingKind::Practice => "practice",
            RecordingKind::SimulatedTrial => "simulated",
            RecordingKind::SimulatedPractice => "simulated practice",
        }
    }
}

/// The place of a recording in a study plan; of the fields of the header's step the ones that a list shows.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ListedPlace {
    pub plan: String,
    /// Number of the trial, from 1; null for practice.
    #[serde(default)]
    pub period: Option<u32>,
    pub periods: u32,
    pub attempt: u32,
}

impl ListedPlace {
    pub fn from_spec(spec: &SessionSpec) -> Option<ListedPlace> {
        let step = spec.step.as_ref()?;
        let (plan, period, periods, attempt) = (step.plan.clone(), step.period, step.periods, step.attempt);
        Some(ListedPlace { plan, period, periods, attempt })
    }

    /// After the kind of the recording: " 2/3 of main-study, attempt 2".
    fn words(&self) -> String {
        let trial = self.period.map_or(String::new(), |period| format!(" {period}/{}", self.periods));
        let again = if self.attempt > 1 { format!(", attempt {}", self.attempt) } else { String::new() };
        format!("{trial} of {}{again}", self.plan)
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ListedRecording {
    pub recording: String,
    /// The participant's code; null if the header cannot be read.
    pub code: Option<String>,
    pub condition: Option<Condition>,
    pub arm: Option<StudyArm>,
    /// Time at which the recording began (UTC, RFC 3339); null for a simulated trial.
    pub date: Option<String>,
    pub trial_s: Option<f64>,
    /// Number of the human's presses that were errors; null where errors are not counted.
    pub errors: Option<u64>,
    pub kind: Option<RecordingKind>,
    /// Null without a plan.
    pub place: Option<ListedPlace>,
    pub state: RecordingState,
    pub reason: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordingList {
    pub folder: String,
    pub recordings: Vec<ListedRecording>,
}

impl RecordingList {
    /// Column headings of the list, in the order of [`ListedRecording::cells`].
    pub const HEADINGS: [&'static str; 8] =
        ["code", "kind", "condition", "date", "length", "errors", "state", "recording"];

    pub fn new(folder: String, mut recordings: Vec<ListedRecording>) -> RecordingList {
        let key = |one: &ListedRecording| (one.code.clone(), one.date.clone(), one.recording.clone());
        recordings.sort_by_key(key);
        RecordingList { folder, recordings }
    }

    /// As text for a terminal of this width. Where it is too narrow, columns go in the order in which they are missed least,
    /// and at last the names of recordings stand below their lines.
    pub fn describe(&self, columns: u16) -> String {
        let mut rows: Vec<[String; 8]> = vec![RecordingList::HEADINGS.map(str::to_string)];
        rows.extend(self.recordings.iter().map(ListedRecording::cells));
        let plans: BTreeSet<Option<&str>> =
            self.recordings.iter().map(|one| Some(one.place.as_ref()?.plan.as_str())).collect();
        let mut shown: Vec<(usize, usize)> = (0..8).map(|column| (column, widest(&rows, column))).collect();
        let fits = |shown: &[(usize, usize)]| {
            shown.iter().map(|(_, width)| width + 2).sum::<usize>() <= usize::from(columns) + 2
        };
        if !fits(&shown) {
            shown.retain(|(column, _)| rows[1..].iter().any(|row| row[*column] != "-"));
        }
        if let ([Some(plan)], false) = (&plans.iter().copied().collect::<Vec<_>>()[..], fits(&shown)) {
            let of_plan = format!(" of {plan}");
            rows.iter_mut().for_each(|row| row[1] = row[1].replace(&of_plan, ""));
            shown.iter_mut().for_each(|(column, width)| *width = widest(&rows, *column));
        }
        for heading in ["date", "errors", "length"] {
            if !fits(&shown) {
                shown.retain(|(column, _)| RecordingList::HEADINGS[*column] != heading);
            }
        }
        let below = !fits(&shown);
        shown.retain(|(column, _)| !below || *column < rows[0].len() - 1);
        let mut text = String::new();
        for (row, one) in rows.iter().zip(std::iter::once(None).chain(self.recordings.iter().map(Some))) {
            let cells = shown.iter().map(|(column, width)| format!("{:<width$}", row[*column]));
            let line = cells.collect::<Vec<_>>().join("  ").trim_end().to_string();
            let reason = one.and_then(|one| one.reason.as_ref()).map(|reason| format!("({reason})"));
            let beside = reason.map_or(String::new(), |reason| {
                let is_short = line.chars().count() + 2 + reason.chars().count() <= usize::from(columns);
                format!("{}{reason}", if is_short { "  " } else { "\n    " })
            });
            let name = one.filter(|_| below).map_or(String::new(), |one| format!("\n    {}", one.recording));
            text += &format!("{line}{beside}{name}\n");
        }
        text + &format!("{} in {}\n", count(self.recordings.len() as u64, "recording", "recordings"), self.folder)
    }
}

fn widest(rows: &[[String; 8]], column: usize) -> usize {
    rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0)
}

impl ListedRecording {
    /// All that the line shows.
    pub fn words(&self) -> String {
        self.cells().join(" ") + " " + self.reason.as_deref().unwrap_or_default()
    }

    pub fn cells(&self) -> [String; 8] {
        let or_dash = |cell: Option<String>| cell.unwrap_or_else(|| "-".to_string());
        let minutes = |seconds: f64| format!("{}:{:02}", seconds as u64 / 60, seconds as u64 % 60);
        [
            or_dash(self.code.clone()),
            or_dash(
                self.kind.map(|kind| {
                    kind.name().to_string() + &self.place.as_ref().map_or(String::new(), ListedPlace::words)
                }),
            ),
            or_dash(self.arm.map(|arm| arm.title().to_string())),
            or_dash(self.date.as_deref().map(|date| date.chars().take(16).collect::<String>().replace('T', " "))),
            or_dash(self.trial_s.map(minutes)),
            or_dash(self.errors.map(|errors| errors.to_string())),
            self.state.name().to_string(),
            self.recording.clone(),
        ]
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GazeQualitySummary {
    pub samples: u64,
    /// Number of recorded gaze samples outside the display or with a confidence below the threshold.
    pub unusable: u64,
    /// Number of recorded gaze samples that the belief filter does not use, by kind of fault.
    #[serde(flatten)]
    pub faults: GazeFaultCounts,
    #[serde(flatten)]
    pub dropped: DroppedInputCounts,
    pub clock_steps: u64,
    pub fixations: u64,
    pub blinks: u64,
    pub losses: u64,
    /// In the last accepted check, after correction if that is in use; null without a check.
    pub accuracy_deg: Option<f64>,
    pub precision_deg: Option<f64>,
}

impl GazeQualitySummary {
    pub fn from_session(session: &Session) -> GazeQualitySummary {
        let (gaze, tracker) = (&session.gaze, &session.tracker);
        let calibrated = session.calibrated.as_ref();
        GazeQualitySummary {
            samples: gaze.samples,
            unusable: gaze.unusable,
            faults: gaze.judge.counts,
            dropped: tracker.dropped,
            clock_steps: tracker.clock_steps,
            fixations: tracker.fixations,
            blinks: tracker.blinks,
            losses: tracker.losses,
            accuracy_deg: calibrated.map(|calibrated| calibrated.accuracy_deg()),
            precision_deg: calibrated.map(|calibrated| calibrated.found.precision_deg),
        }
    }
}

/// One line of text about faults of the gaze; `None` without faults.
fn describe_gaze_faults(session: &Session) -> Option<String> {
    let kinds: Vec<String> = faults(session).iter().map(|(number, kind)| format!("{number} {kind}")).collect();
    let samples = count(session.gaze.samples, "sample", "samples");
    (!kinds.is_empty()).then(|| format!("gaze: {samples}; {}", kinds.join(", ")))
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ExclusionStatus {
    pub aborted: Option<String>,
    pub excluded: Option<String>,
}

impl ExclusionStatus {
    pub fn at_console(session: &Session) -> ExclusionStatus {
        ExclusionStatus { aborted: session.aborted.clone(), excluded: session.excluded.clone() }
    }

    /// Whether analyses include the trial: it was neither aborted nor excluded.
    pub fn counts(&self) -> bool {
        self.aborted.is_none() && self.excluded.is_none()
    }

    /// Why analyses leave out the trial of a session that was read as far as it is recorded, in words; `None` for a trial
    /// that counts: one that is over, also if its recording was cut or left after that.
    pub fn left_out(self, session: &Session, ending: LogEnding) -> Option<String> {
        let state = RecordingState::from_session(session, ending, &self);
        match self {
            ExclusionStatus { aborted: Some(reason), .. } => return Some(format!("aborted: {reason}")),
            ExclusionStatus { excluded: Some(reason), .. } => return Some(format!("excluded: {reason}")),
            _ => {}
        }
        match state {
            RecordingState::Empty => Some("empty: no trial in it".to_string()),
            _ if session.is_trial_over() => (session.presses == [0, 0]).then(|| "no press in it".to_string()),
            RecordingState::Running => Some("running: its trial is not over".to_string()),
            RecordingState::Cut => Some("cut before the trial's end".to_string()),
            _ => Some("ended early, before the trial's end".to_string()),
        }
    }

    pub fn describe(&self) -> String {
        let said = |word: &str, reason: &Option<String>| reason.as_ref().map(|reason| format!("{word}: {reason}"));
        let both = [said("aborted", &self.aborted), said("excluded", &self.excluded)];
        both.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }
}
