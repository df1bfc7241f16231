//! The state of the console besides the session: active keys, open dialog, last notice.

use std::collections::VecDeque;

use crossterm::event::KeyCode;

use super::chord::KeyChord;
use super::click::SendQuestion;
use super::compared::ComparisonView;
use super::display_status::DisplayHealth;
use super::gaze_advice::CalibrationAdvice;
use super::gaze_pairing::GazePairing;
use super::key_action::KeyLayer;
use super::keys::KeyBindings;
use super::lesson::TrainingPanel;
use super::list_cursor::ListCursor;
use super::note::TextInput;
use super::notice::NoticeLevel;
use super::panel::Panel;
use super::picker::Picker;
use super::playback::Playback;
use super::probe_entry::ProbeEntry;
use super::rater_session::RaterSession;
use super::view::theme::Theme;
use crate::base::time::SessionTime;
use crate::base::words::count;
use crate::gaze::GazeSample;
use crate::history::belief_track::BeliefHistory;
use crate::history::signal_judge::SignalJudge;
use crate::kitchen::{Agent, AspectId};
use crate::session::settings::GazeSource;
use crate::session::{TimelineEntry, TimelineEvent};

/// Display time of a notice, in seconds.
const NOTICE_S: f64 = 4.0;

/// Largest number of senders of gaze that give a notice.
const REFUSED: usize = 16;
/// Least time between two notices about the same sender of gaze, in seconds.
const REFUSED_AGAIN_S: f64 = 10.0;
/// Number of gaze samples in the trail of the gaze map.
const TRAIL: usize = 240;

/// An open dialog.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Dialog {
    /// The table of keys.
    Help,
    /// Asks whether to end the session and leave.
    Quit,
    /// Asks whether to end the trial.
    EndTrial,
    /// A list to choose an entry from.
    Pick(Picker),
    /// The list of all actions that have keys.
    Palette(ListCursor),
    /// Asks whether to send the signal that was clicked.
    Send(SendQuestion),
    /// The preflight checks.
    Preflight,
    /// The gaze accuracy check: targets, then the result.
    Calibration,
    /// Input of a free text note.
    Note(TextInput),
    /// Input of an answer to the shown item of a questionnaire: words or a number.
    Answer(TextInput),
    /// Details of a difference between wizard and assistant, as lines of text.
    Difference(Vec<String>),
    /// Report of a training, as lines of text; closed with enter.
    Report(Vec<String>),
}

/// A message to the wizard.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// The line.
    pub text: String,
    /// How urgent it is.
    pub level: NoticeLevel,
    /// Time on [`ConsoleModel::clock`].
    pub at: SessionTime,
}

/// State of the recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RecordingStatus {
    /// Nothing is recorded.
    Off,
    /// Written to this folder.
    On(String),
    /// The log cannot be written.
    Lost,
}

/// State of the stream to Rerun viewers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ViewerStreamStatus {
    /// Address at which viewers connect; `None` if the stream is only written to its file.
    pub address: Option<String>,
    /// Number of rows written.
    pub written: u64,
    /// Number of rows dropped because the viewers were too slow.
    pub dropped: u64,
}

/// State of the streams of the Lab Streaming Layer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LslStatus {
    /// Which streams are sent.
    pub streams: Vec<String>,
    /// Number of samples sent.
    pub sent: u64,
    /// Number of samples that were dropped or refused.
    pub lost: u64,
}

/// A key that is held down, with times on [`ConsoleModel::clock`].
#[derive(Clone, Copy, Debug)]
pub(super) struct PressedKey {
    pub code: KeyCode,
    /// Time of the last report by the terminal.
    pub reported: SessionTime,
    /// Time at which it last counted as a press.
    pub counted: SessionTime,
}

/// State of the console: everything that concerns only the screen and the keyboard.
#[derive(Clone, Debug)]
pub struct ConsoleModel {
    /// Session time that is drawn.
    pub now: SessionTime,
    /// A clock for keys and notices that also runs while a replay is paused.
    pub clock: SessionTime,
    /// Columns and rows of the terminal.
    pub size: (u16, u16),
    /// Colours and signs.
    pub theme: Theme,
    /// The table of keys.
    pub keys: KeyBindings,
    /// The layer of keys that is active.
    pub layer: KeyLayer,
    /// What is open above the panels.
    pub dialog: Option<Dialog>,
    /// The newest line to the wizard.
    pub notice: Option<Notice>,
    /// Whether the session is recorded.
    pub recording: RecordingStatus,
    /// The stream to Rerun's viewers, if there is one.
    pub viewers: Option<ViewerStreamStatus>,
    /// The streams of the Lab Streaming Layer, if there are any.
    pub lsl: Option<LslStatus>,
    /// Free disk space of the recording's folder in bytes; `None` if unknown.
    pub free_bytes: Option<u64>,
    /// The panel that is shown at full size, if any.
    pub alone: Option<Panel>,
    /// First visible column of the help, or first visible line of a report.
    pub help_from: usize,
    /// Scroll position of the list of events, in entries.
    pub events_back: usize,
    /// Scroll position of the timeline, in seconds.
    pub timeline_back_s: u32,
    /// Whether the terminal has keyboard focus.
    pub focused: bool,
    /// Display point under the mouse pointer, in fractions; outside 0 to 1 beside the kitchen.
    pub pointer: Option<[f64; 2]>,
    /// Latest gaze samples with their times, the oldest first, for the gaze map.
    pub trail: VecDeque<(SessionTime, GazeSample)>,
    /// Number of rejected senders of gaze: connections and datagrams that are not a tracker's.
    pub rejected_senders: u64,
    /// Notices that were given of senders that nobody let in, and when last.
    refused_senders: Vec<(String, SessionTime)>,
    /// How senders of gaze at other computers pair, if they do.
    pub gaze_pairing: Option<GazePairing>,
    /// State of the participant's display, if there is one.
    pub display: Option<DisplayHealth>,
    /// Times of the human's errors, in order.
    pub errors: Vec<SessionTime>,
    /// How the signals of this trial were judged when they were sent.
    pub signals: SignalJudge,
    /// History of the belief estimate.
    pub belief: BeliefHistory,
    /// Aspect whose belief is shown over time.
    pub belief_focus: Option<AspectId>,
    /// Comparison of wizard and assistants, if it is shown.
    pub comparison: Option<ComparisonView>,
    /// Training panel, in a wizard training.
    pub lesson: Option<TrainingPanel>,
    /// Rater session, while the errors of a recording are coded.
    pub coding: Option<RaterSession>,
    /// Playback position, in a replay.
    pub playback: Option<Playback>,
    /// The answer to the question of a probe that is being entered here.
    pub probe_entry: ProbeEntry,
    /// Index of the chosen reason for waiving the criterion of the practice, until enter confirms it.
    pub waiver: Option<usize>,
    /// What the wizard has chosen to do with the result of a gaze check, until enter confirms it.
    pub gaze_choice: Option<CalibrationAdvice>,
    /// Time at which enter took a row of a list, on [`ConsoleModel::clock`].
    pub(super) answered: Option<SessionTime>,
    /// The key of the last click, and its time on [`ConsoleModel::clock`].
    pub(super) clicked: Option<(KeyChord, SessionTime)>,
    /// Whether the terminal distinguishes key repeat from key press.
    pub(super) exact_keys: bool,
    /// The last pressed key, to detect key repeat.
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
            lsl: None,
            free_bytes: None,
            alone: None,
            help_from: 0,
            events_back: 0,
            timeline_back_s: 0,
            focused: true,
            pointer: None,
            trail: VecDeque::with_capacity(TRAIL),
            rejected_senders: 0,
            refused_senders: Vec::new(),
            gaze_pairing: None,
            display: None,
            errors: Vec::new(),
            signals: SignalJudge::default(),
            belief: BeliefHistory::default(),
            belief_focus: None,
            comparison: None,
            lesson: None,
            coding: None,
            playback: None,
            probe_entry: ProbeEntry::default(),
            waiver: None,
            gaze_choice: None,
            answered: None,
            clicked: None,
            exact_keys: false,
            pressed: None,
        }
    }

    /// Shows a notice.
    pub fn say(&mut self, level: NoticeLevel, text: impl Into<String>) {
        self.notice = Some(Notice { text: text.into(), level, at: self.clock });
    }

    /// Shows a warning about something that came from outside, unless an alarm is shown.
    pub fn warn(&mut self, text: impl Into<String>) {
        if !self.is_alarmed() {
            self.say(NoticeLevel::Refused, text);
        }
    }

    /// Removes the last notice, unless it is an alarm: it was about the last key, and another key is pressed.
    pub(super) fn forget_notice(&mut self) {
        if !self.is_alarmed() {
            self.notice = None;
        }
    }

    /// The last notice, while it is shown.
    pub fn shown_notice(&self) -> Option<&Notice> {
        self.notice.as_ref().filter(|notice| self.clock.secs_since(notice.at) < NOTICE_S)
    }

    fn is_alarmed(&self) -> bool {
        self.shown_notice().is_some_and(|notice| notice.level == NoticeLevel::Alarm)
    }

    /// Counts rejected senders of gaze. The first one, and every doubling of their number, gives a notice: whoever sends can
    /// neither flood the notices nor replace an alarm.
    pub fn count_rejected(&mut self, more: u64) {
        let before = self.rejected_senders;
        self.rejected_senders += more;
        let has_doubled = self.rejected_senders.checked_ilog2() > before.checked_ilog2();
        if has_doubled {
            let told = count(self.rejected_senders, "sender", "senders");
            self.warn(format!("gaze: {told} rejected and not read: no JSON object, or not the tracker's address"));
        }
    }

    /// Counts senders of gaze that nobody let in, the last one at this address and for this reason. Each address gives a notice for a
    /// reason now and then, and no more than a few do.
    pub fn refuse_sender(&mut self, address: &str, why: &str, senders: u64) {
        self.rejected_senders += senders;
        let told = format!("gaze from {address} is rejected: {why}");
        let (now, is_full) = (self.clock, self.refused_senders.len() == REFUSED);
        match self.refused_senders.iter_mut().find(|(other, _)| *other == told) {
            Some((_, at)) if now.secs_since(*at) < REFUSED_AGAIN_S => return,
            Some((_, at)) => *at = now,
            None if is_full => return,
            None => self.refused_senders.push((told.clone(), now)),
        }
        self.warn(told);
    }

    /// Adds a gaze sample to the trail of the gaze map.
    pub fn see(&mut self, at: SessionTime, sample: GazeSample) {
        if self.trail.len() == TRAIL {
            self.trail.pop_front();
        }
        self.trail.push_back((at, sample));
    }

    /// Shows the next aspect in this order over time, at full size; after the last one, all panels.
    pub fn focus_next_belief(&mut self, ranked: &[AspectId]) {
        let at = self.belief_focus.and_then(|focus| ranked.iter().position(|&aspect| aspect == focus));
        let next = match (self.belief_focus, at) {
            (None, _) => ranked.first(),
            (Some(_), at) => at.and_then(|at| ranked.get(at + 1)),
        };
        self.focus_belief(next.copied());
    }

    /// Shows this aspect over time, at full size; without one, all panels.
    pub fn focus_belief(&mut self, aspect: Option<AspectId>) {
        self.belief_focus = aspect;
        self.alone = aspect.map(|_| Panel::Belief);
    }

    /// Whether a timeline entry is an error of the human.
    pub fn is_error(&self, entry: &TimelineEntry) -> bool {
        matches!(entry.what, TimelineEvent::Press { agent: Agent::Human, .. })
            && self.errors.binary_search(&entry.time).is_ok()
    }

    /// Name of a gaze source on the screen.
    pub fn gaze_label(source: GazeSource) -> &'static str {
        match source {
            GazeSource::Simulated => "simulated",
            GazeSource::Mouse => "mouse",
            GazeSource::Pupil => "pupil",
            GazeSource::File => "file",
            GazeSource::Json => "json",
            GazeSource::Lsl => "lsl",
            GazeSource::None => "none",
        }
    }
}
