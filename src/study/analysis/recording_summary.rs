//! Summary of one recording (presses, errors, beliefs, signals, gaze), and the list of the recordings in a folder.

use serde::Serialize;

use crate::analysis::trial_summary::{FalseBeliefErrorSummary, TrialSummary};
use tomcom_core::base::text::count;
use tomcom_core::gaze::quality::{DroppedInputCounts, GazeFaultCounts};
use tomcom_session::follower::SessionFollower;
use tomcom_session::gaze_samples::faults;
use tomcom_session::settings::{Condition, ParticipantKind, SessionSpec};
use tomcom_session::study_arm::StudyArm;
use tomcom_session::{Session, TrialPhase};

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
    /// Errors that follow from false beliefs.
    #[serde(flatten)]
    pub beliefs: FalseBeliefErrorSummary,
    pub signals: u64,
    /// Whether the wizard saw the assistants' recommendations beside the signals that the wizard sent.
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

/// Whether a recording is complete, cut, excluded, running or unreadable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RecordingState {
    /// Complete recording: the session was closed properly.
    Whole,
    /// Cut recording: it lacks its end event, and no session is writing to it.
    Cut,
    /// Excluded recording: the trial was aborted or excluded, and the analysis leaves it out.
    Excluded,
    /// Running recording: the session is still writing to it.
    Running,
    /// Unreadable recording: its log cannot be read.
    Unreadable,
}

impl RecordingState {
    pub fn name(self) -> &'static str {
        match self {
            RecordingState::Whole => "whole",
            RecordingState::Cut => "cut",
            RecordingState::Excluded => "excluded",
            RecordingState::Running => "running",
            RecordingState::Unreadable => "unreadable",
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ListedRecording {
    pub recording: String,
    /// The participant's code; null if the recording cannot be read.
    pub code: Option<String>,
    /// Condition of the trial: who could send signals; null if the recording cannot be read.
    pub condition: Option<Condition>,
    /// Study arm of the trial as it was carried out; null if the recording cannot be read.
    pub arm: Option<StudyArm>,
    /// Absent if the recording cannot be read.
    #[serde(flatten)]
    pub kind: Option<TrialKind>,
    /// Time at which the recording began (UTC, RFC 3339); null for a simulated trial.
    pub date: Option<String>,
    pub trial_s: Option<f64>,
    /// Number of the human's presses that were errors; null where errors are not counted.
    pub errors: Option<u64>,
    /// State of the recording: complete, cut, excluded, running or unreadable.
    pub state: RecordingState,
    /// Reason for the trial's exclusion, or why the recording cannot be read.
    pub reason: Option<String>,
}

/// What a recording is of, beside a trial of a person that counts in a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct TrialKind {
    /// Whether the participant is simulated.
    pub simulated: bool,
    /// Whether the recording is a plan's tutorial or practice, which no analysis counts.
    pub practice: bool,
}

impl TrialKind {
    pub fn from_spec(spec: &SessionSpec) -> TrialKind {
        TrialKind {
            simulated: spec.participant.kind == ParticipantKind::Simulated,
            practice: spec.step.as_ref().is_some_and(|step| step.period.is_none()),
        }
    }

    /// "person", "practice", "simulated practice".
    pub fn words(self) -> &'static str {
        match (self.simulated, self.practice) {
            (false, false) => "person",
            (false, true) => "practice",
            (true, false) => "simulated",
            (true, true) => "simulated practice",
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordingList {
    pub folder: String,
    pub recordings: Vec<ListedRecording>,
}

impl RecordingList {
    /// Column headings of the list, in the order of [`ListedRecording::cells`].
    pub const HEADINGS: [&'static str; 8] =
        ["code", "condition", "kind", "date", "length", "errors", "state", "recording"];

    pub fn new(folder: String, mut recordings: Vec<ListedRecording>) -> RecordingList {
        let key = |one: &ListedRecording| (one.code.clone(), one.date.clone(), one.recording.clone());
        recordings.sort_by_key(key);
        RecordingList { folder, recordings }
    }

    pub fn describe(&self) -> String {
        let mut rows: Vec<[String; 8]> = vec![RecordingList::HEADINGS.map(str::to_string)];
        rows.extend(self.recordings.iter().map(ListedRecording::cells));
        let widths: Vec<usize> = (0..8).map(|column| widest(&rows, column)).collect();
        let mut text = String::new();
        for (row, one) in rows.iter().zip(std::iter::once(None).chain(self.recordings.iter().map(Some))) {
            let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
            text.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
            let reason = one.and_then(|one| one.reason.as_ref());
            text.push_str(&reason.map_or("\n".to_string(), |reason| format!("  ({reason})\n")));
        }
        text + &format!("{} in {}\n", count(self.recordings.len() as u64, "recording", "recordings"), self.folder)
    }
}

fn widest(rows: &[[String; 8]], column: usize) -> usize {
    rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0)
}

impl ListedRecording {
    pub fn cells(&self) -> [String; 8] {
        let or_dash = |cell: Option<String>| cell.unwrap_or_else(|| "-".to_string());
        let minutes = |seconds: f64| format!("{}:{:02}", seconds as u64 / 60, seconds as u64 % 60);
        [
            or_dash(self.code.clone()),
            or_dash(self.arm.map(|arm| arm.title().to_string())),
            or_dash(self.kind.map(|kind| kind.words().to_string())),
            or_dash(self.date.as_deref().map(|date| date.chars().take(16).collect::<String>().replace('T', " "))),
            or_dash(self.trial_s.map(minutes)),
            or_dash(self.errors.map(|errors| errors.to_string())),
            self.state.name().to_string(),
            self.recording.clone(),
        ]
    }
}

/// Gaze quality of a recording: numbers of samples, faults and losses, and measured accuracy.
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
    /// Gaze accuracy in the last accepted accuracy check, in degrees, after correction if the correction is in use;
    /// null without a check.
    pub accuracy_deg: Option<f64>,
    /// Precision of the gaze in the last accepted accuracy check, in degrees.
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

/// Whether a trial was aborted or excluded; an analysis leaves out aborted and excluded trials.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ExclusionStatus {
    /// Reason for aborting the trial; null if the trial was not aborted.
    pub aborted: Option<String>,
    /// Reason for excluding the trial; null if the trial is not excluded.
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
    /// that counts. `is_running`: a program is still recording the session.
    pub fn left_out(self, session: &Session, is_running: bool) -> Option<String> {
        let is_over = matches!(session.phase, TrialPhase::Over(_) | TrialPhase::Closed);
        match self {
            ExclusionStatus { aborted: Some(reason), .. } => Some(format!("aborted: {reason}")),
            ExclusionStatus { excluded: Some(reason), .. } => Some(format!("excluded: {reason}")),
            _ if !is_over && is_running => Some("running: its trial is not over".to_string()),
            _ if !is_over => Some("cut before the trial's end".to_string()),
            _ if session.presses == [0, 0] => Some("no press in it".to_string()),
            _ => None,
        }
    }

    /// The exclusion status as text; empty for a trial that counts.
    pub fn describe(&self) -> String {
        let said = |word: &str, reason: &Option<String>| reason.as_ref().map(|reason| format!("{word}: {reason}"));
        let both = [said("aborted", &self.aborted), said("excluded", &self.excluded)];
        both.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }
}
