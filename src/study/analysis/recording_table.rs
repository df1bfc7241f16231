//! List of the recordings in a folder: participant, date, length, number of errors, and state.

use serde::Serialize;

use tomcom_core::base::text::count;
use tomcom_session::settings::Condition;
use tomcom_session::study_arm::StudyArm;

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
    /// The state of the recording as one word.
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

/// A recording in the list of a folder.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ListedRecording {
    /// Name of the recording's folder.
    pub recording: String,
    /// The participant's code; null if the recording cannot be read.
    pub code: Option<String>,
    /// Condition of the trial: who could send signals; null if the recording cannot be read.
    pub condition: Option<Condition>,
    /// Study arm of the trial as it was carried out; null if the recording cannot be read.
    pub arm: Option<StudyArm>,
    /// Time at which the recording began (UTC, RFC 3339); null for a simulated trial.
    pub date: Option<String>,
    /// Duration of the trial by its own clock, in seconds.
    pub trial_s: Option<f64>,
    /// Number of the human's presses that were errors; null where errors are not counted.
    pub errors: Option<u64>,
    /// State of the recording: complete, cut, excluded, running or unreadable.
    pub state: RecordingState,
    /// Reason for the trial's exclusion, or why the recording cannot be read.
    pub reason: Option<String>,
}

/// List of the recordings in a folder, as `tomcom list` prints it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordingList {
    /// Path of the folder with the recordings.
    pub folder: String,
    /// The recordings, sorted by the participant's code, then by date, then by name.
    pub recordings: Vec<ListedRecording>,
}

impl RecordingList {
    /// Column headings of the list, in the order of [`ListedRecording::cells`].
    pub const HEADINGS: [&'static str; 7] = ["code", "condition", "date", "length", "errors", "state", "recording"];

    /// The list of recordings, sorted by the participant's code, then by date, then by name.
    pub fn new(folder: String, mut recordings: Vec<ListedRecording>) -> RecordingList {
        let key = |one: &ListedRecording| (one.code.clone(), one.date.clone(), one.recording.clone());
        recordings.sort_by_key(key);
        RecordingList { folder, recordings }
    }

    /// The list of recordings as a table of text.
    pub fn describe(&self) -> String {
        let mut rows: Vec<[String; 7]> = vec![RecordingList::HEADINGS.map(str::to_string)];
        rows.extend(self.recordings.iter().map(ListedRecording::cells));
        let widths: Vec<usize> = (0..7).map(|column| widest(&rows, column)).collect();
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

fn widest(rows: &[[String; 7]], column: usize) -> usize {
    rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0)
}

impl ListedRecording {
    /// The recording's cell for each column of [`RecordingList::HEADINGS`]; "-" for unknown values.
    pub fn cells(&self) -> [String; 7] {
        let or_dash = |cell: Option<String>| cell.unwrap_or_else(|| "-".to_string());
        let minutes = |seconds: f64| format!("{}:{:02}", seconds as u64 / 60, seconds as u64 % 60);
        [
            or_dash(self.code.clone()),
            or_dash(self.arm.map(|arm| arm.title().to_string())),
            or_dash(self.date.as_deref().map(|date| date.chars().take(16).collect::<String>().replace('T', " "))),
            or_dash(self.trial_s.map(minutes)),
            or_dash(self.errors.map(|errors| errors.to_string())),
            self.state.name().to_string(),
            self.recording.clone(),
        ]
    }
}
