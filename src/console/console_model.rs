//! State of the console besides the session: active keys, open dialog, latest notice.

use std::collections::VecDeque;

use crossterm::event::KeyCode;

use super::chord::KeyChord;
use super::click::SendConfirmation;
use super::compared::SenderComparisonView;
use super::display_status::ParticipantDisplayHealth;
use super::gaze_advice::AccuracyCheckAction;
use super::gaze_pairing::GazePairing;
use super::key_action::{KeyAction, KeyLayer};
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
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::gaze::recorded::RecordedGazeSummary;
use tomcom_core::kitchen::{Agent, AspectId};
use tomcom_session::history::belief_track::BeliefHistory;
use tomcom_session::history::signal_judge::SignalJudge;
use tomcom_session::preflight_checks::RejectedGaze;
use tomcom_session::settings::GazeSource;
use tomcom_session::{TimelineEntry, TimelineEvent};

/// Time for which a notice is shown, in seconds.
const NOTICE_S: f64 = 4.0;

/// Largest number of different rejections (address and reason) of gaze senders for which notices are given.
const REJECTIONS: usize = 16;
/// Least time between two notices about the same rejected gaze sender, in seconds.
const REJECTED_AGAIN_S: f64 = 10.0;
/// Number of recent gaze samples that the gaze map draws.
const TRAIL: usize = 240;

/// A dialog of the console that is open above its panels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Dialog {
    /// Help of the console: the table of keys. For each entry of the table, whether its key had an effect when the help
    /// was opened: the order of the lines does not change while the help is read.
    Help(Vec<bool>),
    /// Question whether to end the session and close the console.
    Quit,
    /// Question whether to end the trial.
    EndTrial,
    /// List from which the wizard chooses an answer.
    Pick(Picker),
    /// List of all actions that have keys (the palette).
    Palette(ListCursor),
    /// Question whether to send the signal that was clicked.
    Send(SendConfirmation),
    /// List of the preflight checks.
    Preflight,
    /// Gaze accuracy check: the targets, then the result.
    Calibration,
    /// Text input for the wizard's note.
    Note(TextInput),
    /// Text input of an answer to the shown questionnaire item: words or a number.
    Answer(TextInput),
    /// Details of a difference between wizard and assistant, as lines of text.
    Difference(Vec<String>),
    /// Report of a wizard training, as lines of text; closed with enter.
    Report(Vec<String>),
}

/// A short message of the console to the wizard, shown for a few seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// Text of the notice to the wizard, in one line.
    pub text: String,
    /// Severity of the notice.
    pub level: NoticeLevel,
    /// Time at which the notice was given, on [`ConsoleModel::clock`].
    pub at: SessionTime,
}

/// State of the session's recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RecordingStatus {
    /// The session is not recorded.
    Off,
    /// The session is recorded into this folder.
    On(String),
    /// The recording can no longer be written.
    Lost,
}

/// State of the stream to viewers of the Rerun program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RerunStreamStatus {
    /// Address to which Rerun viewers connect; `None` if the stream is only written to a file.
    pub address: Option<String>,
    /// Number of rows written to the Rerun stream.
    pub written: u64,
    /// Number of rows that the Rerun stream dropped because the viewers were too slow.
    pub dropped: u64,
}

/// State of the outgoing streams of the Lab Streaming Layer (LSL).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LslStatus {
    /// Names of the LSL streams that are sent.
    pub streams: Vec<String>,
    /// Number of samples sent over LSL.
    pub sent: u64,
    /// Number of samples that LSL dropped or refused.
    pub lost: u64,
}

/// A key that is held down, with times on [`ConsoleModel::clock`].
#[derive(Clone, Copy, Debug)]
pub(super) struct PressedKey {
    pub code: KeyCode,
    /// Time at which the terminal last reported the key.
    pub reported: SessionTime,
    /// Time at which the key last counted as newly pressed.
    pub counted: SessionTime,
}

/// State of the console: everything that concerns only the screen and the keyboard, not the trial.
#[derive(Clone, Debug)]
pub struct ConsoleModel {
    /// Session time that the console draws.
    pub now: SessionTime,
    /// Clock for keys and notices, which also runs while a replay is paused.
    pub clock: SessionTime,
    /// Columns and rows of the terminal.
    pub size: (u16, u16),
    /// Colours and signs of the console.
    pub theme: Theme,
    /// Table of the console's key bindings.
    pub keys: KeyBindings,
    /// Whose keys are active: the wizard's or the participant's.
    pub layer: KeyLayer,
    /// Dialog that is open above the console's panels, if any.
    pub dialog: Option<Dialog>,
    /// Latest notice to the wizard.
    pub notice: Option<Notice>,
    /// State of the session's recording: on, off or lost.
    pub recording: RecordingStatus,
    /// State of the stream to Rerun viewers, if there is one.
    pub viewers: Option<RerunStreamStatus>,
    /// State of the streams of the Lab Streaming Layer, if there are any.
    pub lsl: Option<LslStatus>,
    /// Free disk space of the recording's folder in bytes; `None` if unknown.
    pub free_bytes: Option<u64>,
    /// Panel of the console that is shown alone at full size, if any.
    pub alone: Option<Panel>,
    /// First visible column of the help, or first visible line of a training report.
    pub help_from: usize,
    /// Scroll position of the list of events: number of newer entries that are skipped.
    pub events_back: usize,
    /// Scroll position of the timeline: seconds before the present.
    pub timeline_back_s: u32,
    /// Whether the terminal has keyboard focus.
    pub focused: bool,
    /// Point of the wall display under the mouse pointer, in fractions of its size; below 0 or above 1 while the
    /// pointer is outside the kitchen panel.
    pub pointer: Option<[f64; 2]>,
    /// Latest gaze samples with their times, oldest first, for the gaze map.
    pub trail: VecDeque<(SessionTime, GazeSample)>,
    /// Number of rejected gaze senders.
    pub rejected_senders: u64,
    /// The last rejected gaze sender, and when it was rejected.
    pub rejected_gaze: Option<(RejectedGaze, SessionTime)>,
    /// Notices that were given about rejected gaze senders, with the time of the last one.
    rejections_told: Vec<(String, SessionTime)>,
    /// Address and pairing code for gaze senders at other computers, if they may connect.
    pub gaze_pairing: Option<GazePairing>,
    /// What the session reads from its gaze file; `None` for other gaze sources.
    pub recorded_gaze: Option<RecordedGazeSummary>,
    /// State of the participant's display, if there is one.
    pub display: Option<ParticipantDisplayHealth>,
    /// Session times of the human's errors, in ascending order.
    pub errors: Vec<SessionTime>,
    /// Number of the human's presses whose judgement rests on a cost to go that is not proven.
    pub unproven: u64,
    /// Judgement of each signal of the trial at the time when the signal was sent (hit, late or needless).
    pub signals: SignalJudge,
    /// History of the estimate of the participant's beliefs.
    pub belief: BeliefHistory,
    /// State aspect whose estimated belief is shown over time.
    pub belief_focus: Option<AspectId>,
    /// Comparison of wizard and assistants, if it is shown.
    pub comparison: Option<SenderComparisonView>,
    /// Training panel, in a wizard training.
    pub lesson: Option<TrainingPanel>,
    /// The rater's codes, while the errors of a recording are coded.
    pub coding: Option<RaterSession>,
    /// Playback position and speed, in a replay.
    pub playback: Option<Playback>,
    /// Answer to the current probe question that is being entered at this console.
    pub probe_entry: ProbeEntry,
    /// Index of the selected reason for waiving the practice criterion, until enter confirms it.
    pub waiver: Option<usize>,
    /// What the wizard has selected to do with the result of a gaze accuracy check, until enter confirms it.
    pub gaze_choice: Option<AccuracyCheckAction>,
    /// Action that the wizard chose last in the palette, if it may stand first there.
    pub(super) palette_chosen: Option<KeyAction>,
    /// Action that stands first in the open palette.
    pub(super) palette_first: Option<KeyAction>,
    /// Time at which enter last chose a row of a list, on [`ConsoleModel::clock`].
    pub(super) answered: Option<SessionTime>,
    /// Key that the last mouse click stood for, with the click's time on [`ConsoleModel::clock`].
    pub(super) clicked: Option<(KeyChord, SessionTime)>,
    /// Whether the terminal reports key repeats as such, separate from presses.
    pub(super) exact_keys: bool,
    /// Key that was pressed last, by which key repeat is detected.
    pub(super) pressed: Option<PressedKey>,
}

impl ConsoleModel {
    /// State of a console before its first frame.
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
            rejected_gaze: None,
            rejections_told: Vec::new(),
            gaze_pairing: None,
            recorded_gaze: None,
            display: None,
            errors: Vec::new(),
            unproven: 0,
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
            palette_chosen: None,
            palette_first: None,
            answered: None,
            clicked: None,
            exact_keys: false,
            pressed: None,
        }
    }

    /// Shows a notice to the wizard.
    pub fn say(&mut self, level: NoticeLevel, text: impl Into<String>) {
        self.notice = Some(Notice { text: text.into(), level, at: self.clock });
    }

    /// Shows a warning about an outside cause, unless an alarm is shown.
    pub fn warn(&mut self, text: impl Into<String>) {
        if !self.is_alarmed() {
            self.say(NoticeLevel::Refused, text);
        }
    }

    /// Removes the latest notice when another key is pressed, unless the notice is an alarm.
    pub(super) fn forget_notice(&mut self) {
        if !self.is_alarmed() {
            self.notice = None;
        }
    }

    /// The latest notice, for the few seconds that it is shown.
    pub fn shown_notice(&self) -> Option<&Notice> {
        self.notice.as_ref().filter(|notice| self.clock.secs_since(notice.at) < NOTICE_S)
    }

    fn is_alarmed(&self) -> bool {
        self.shown_notice().is_some_and(|notice| notice.level == NoticeLevel::Alarm)
    }

    /// Notes a rejected gaze sender, the last one of `senders` new ones. Repeated notices about the same address and
    /// reason are rate limited, and so is the number of those that give notices.
    pub fn reject_sender(&mut self, rejected: RejectedGaze, senders: u64) {
        self.rejected_senders += senders;
        let told = rejected.told.clone();
        self.rejected_gaze = Some((rejected, self.now));
        let (now, is_full) = (self.clock, self.rejections_told.len() == REJECTIONS);
        match self.rejections_told.iter_mut().find(|(other, _)| *other == told) {
            Some((_, at)) if now.secs_since(*at) < REJECTED_AGAIN_S => return,
            Some((_, at)) => *at = now,
            None if is_full => return,
            None => self.rejections_told.push((told.clone(), now)),
        }
        self.warn(told);
    }

    /// The gaze sender that was rejected since the last gaze sample arrived, if there is one.
    pub fn rejected_since(&self, arrived: Option<SessionTime>) -> Option<&RejectedGaze> {
        let (rejected, at) = self.rejected_gaze.as_ref()?;
        arrived.is_none_or(|arrived| arrived < *at).then_some(rejected)
    }

    /// Adds a gaze sample to the trail that the gaze map draws.
    pub fn see(&mut self, at: SessionTime, sample: GazeSample) {
        if self.trail.len() == TRAIL {
            self.trail.pop_front();
        }
        self.trail.push_back((at, sample));
    }

    /// Shows the estimated belief about the next state aspect of this list over time, at full size; after the last
    /// aspect, shows all panels.
    pub fn focus_next_belief(&mut self, ranked: &[AspectId]) {
        let at = self.belief_focus.and_then(|focus| ranked.iter().position(|&aspect| aspect == focus));
        let next = match (self.belief_focus, at) {
            (None, _) => ranked.first(),
            (Some(_), at) => at.and_then(|at| ranked.get(at + 1)),
        };
        self.focus_belief(next.copied());
    }

    /// Shows the estimated belief about this state aspect over time, at full size; `None` shows all panels.
    pub fn focus_belief(&mut self, aspect: Option<AspectId>) {
        self.belief_focus = aspect;
        self.alone = aspect.map(|_| Panel::Belief);
    }

    /// Whether a timeline entry is a press that was an error of the human.
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
