//! What the console knows beside the session: which keys are active, what is open, what was said last.

use std::collections::VecDeque;

use crossterm::event::KeyCode;

use super::compared::ComparisonView;
use super::display::DisplayHealth;
use super::key_action::KeyLayer;
use super::keys::KeyBindings;
use super::lesson::TrainingPanel;
use super::note::TextInput;
use super::notice::NoticeLevel;
use super::panel::Panel;
use super::picker::Picker;
use super::playback::Playback;
use super::rater_session::RaterSession;
use super::view::theme::Theme;
use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::history::belief_track::BeliefHistory;
use crate::kitchen::{Agent, AspectId};
use crate::session::settings::GazeSource;
use crate::session::{TimelineEntry, TimelineEvent};

/// How many gaze samples the trail of the gaze map keeps.
const TRAIL: usize = 240;

/// What is open above the panels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Dialog {
    Help,
    /// Asks whether to end the session and leave.
    Quit,
    /// Asks whether to end the trial.
    EndTrial,
    /// A list to choose from.
    Pick(Picker),
    /// What was found before the trial.
    Preflight,
    /// Targets are looked at, or what came of it is shown.
    Calibration,
    /// A line for a note in words.
    Note(TextInput),
    /// What each knew where wizard and assistant differ, in lines.
    Difference(Vec<String>),
    /// What came of a training, in lines; it stays until enter.
    Report(Vec<String>),
}

/// A line to the wizard.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    pub text: String,
    pub level: NoticeLevel,
    /// On [`ConsoleModel::clock`].
    pub at: SessionTime,
}

/// Whether what happens is kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RecordingStatus {
    /// Nothing is recorded.
    Off,
    /// Written to this folder.
    On(String),
    /// The log cannot be written.
    Lost,
}

/// How the stream to Rerun's viewers fares.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ViewerStreamStatus {
    /// Where they connect; none: the stream is only written to its file.
    pub address: Option<String>,
    /// Rows that were written, and that were dropped because it was too slow.
    pub written: u64,
    pub dropped: u64,
}

/// A key that went down, with times on [`ConsoleModel::clock`].
#[derive(Clone, Copy, Debug)]
pub(super) struct PressedKey {
    pub code: KeyCode,
    /// When the terminal reported it last.
    pub reported: SessionTime,
    /// When it was last taken for a press.
    pub counted: SessionTime,
}

/// Everything that only concerns the screen and the hands at the keyboard.
#[derive(Clone, Debug)]
pub struct ConsoleModel {
    /// The moment that is drawn.
    pub now: SessionTime,
    /// A clock that always runs, also while a replay stands or races: for keys and notices.
    pub clock: SessionTime,
    /// Columns and rows of the terminal.
    pub size: (u16, u16),
    pub theme: Theme,
    pub keys: KeyBindings,
    pub layer: KeyLayer,
    pub dialog: Option<Dialog>,
    pub notice: Option<Notice>,
    pub recording: RecordingStatus,
    /// The stream to Rerun's viewers, if there is one.
    pub viewers: Option<ViewerStreamStatus>,
    /// Bytes that are free where the recording is; none: not known.
    pub free_bytes: Option<u64>,
    /// The panel that is shown alone, if one is.
    pub alone: Option<Panel>,
    /// The first column of the help, or the first line of a report, that is shown.
    pub help_from: usize,
    /// How far back events (in entries) and timeline (in seconds) are looked at.
    pub events_back: usize,
    pub timeline_back_s: u32,
    /// The terminal window has the keyboard.
    pub focused: bool,
    /// The cell under the mouse pointer, as a display point (fractions; outside of 0..1 beside the kitchen).
    pub pointer: Option<[f64; 2]>,
    /// The newest gaze samples with their times, oldest first, for the gaze map.
    pub trail: VecDeque<(SessionTime, GazeSample)>,
    /// The participant's display, if there is one.
    pub display: Option<DisplayHealth>,
    /// The times of the human presses that were errors, in order.
    pub errors: Vec<SessionTime>,
    /// What is estimated of the participant's belief.
    pub belief: BeliefHistory,
    /// The aspect whose belief is shown over time.
    pub belief_focus: Option<AspectId>,
    /// Wizard and assistants side by side, where that is asked for.
    pub comparison: Option<ComparisonView>,
    /// Set when a wizard is trained.
    pub lesson: Option<TrainingPanel>,
    /// Set when the errors of a recording are coded.
    pub coding: Option<RaterSession>,
    /// Set when a recording is replayed.
    pub playback: Option<Playback>,
    /// The terminal tells key repeat from key press.
    pub(super) exact_keys: bool,
    /// The key that was pressed last: against key repeat.
    pub(super) pressed: Option<PressedKey>,
}

impl ConsoleModel {
    /// A console before its first frame.
    pub fn new(keys: KeyBindings, theme: Theme, size: (u16, u16)) -> ConsoleModel {
        ConsoleModel {
            now: SessionTime::ZERO,
            clock: SessionTime::ZERO,
            size,
            theme,
            keys,
            layer: KeyLayer::Wizard,
            dialog: None,
            notice: None,
            recording: RecordingStatus::Off,
            viewers: None,
            free_bytes: None,
            alone: None,
            help_from: 0,
            events_back: 0,
            timeline_back_s: 0,
            focused: true,
            pointer: None,
            trail: VecDeque::with_capacity(TRAIL),
            display: None,
            errors: Vec::new(),
            belief: BeliefHistory::default(),
            belief_focus: None,
            comparison: None,
            lesson: None,
            coding: None,
            playback: None,
            exact_keys: false,
            pressed: None,
        }
    }

    /// Says something to the wizard.
    pub fn say(&mut self, level: NoticeLevel, text: impl Into<String>) {
        self.notice = Some(Notice { text: text.into(), level, at: self.clock });
    }

    /// Remembers a gaze sample for the gaze map.
    pub fn see(&mut self, at: SessionTime, sample: GazeSample) {
        if self.trail.len() == TRAIL {
            self.trail.pop_front();
        }
        self.trail.push_back((at, sample));
    }

    /// Shows the belief in the aspect that follows in this order over time; after the last one that of none.
    pub fn focus_next_belief(&mut self, ranked: &[usize]) {
        let at = self.belief_focus.and_then(|focus| ranked.iter().position(|&aspect| aspect == focus.index()));
        let next = match (self.belief_focus, at) {
            (None, _) => ranked.first(),
            (Some(_), at) => at.and_then(|at| ranked.get(at + 1)),
        };
        self.belief_focus = next.map(|&aspect| AspectId(aspect as u8));
    }

    /// Whether this entry of the timeline is a press of the human that was an error.
    pub fn is_error(&self, entry: &TimelineEntry) -> bool {
        matches!(entry.what, TimelineEvent::Press { agent: Agent::Human, .. })
            && self.errors.binary_search(&entry.time).is_ok()
    }

    /// The words for a source of gaze.
    pub fn gaze_label(source: GazeSource) -> &'static str {
        match source {
            GazeSource::Simulated => "simulated",
            GazeSource::Mouse => "mouse",
            GazeSource::Pupil => "pupil",
            GazeSource::File => "file",
            GazeSource::Json => "json",
            GazeSource::None => "none",
        }
    }
}
