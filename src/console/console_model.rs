//! State of the console besides the session, the messages that it receives, and the commands that it returns.

use std::collections::VecDeque;
use std::sync::Arc;

use crossterm::event::{KeyCode, KeyEvent};

use super::chord::KeyChord;
use super::coding::RaterSession;
use super::form::ItemChoice;
use super::gaze_check::AccuracyCheckAction;
use super::key_action::{KeyAction, KeyLayer};
use super::keys::KeyBindings;
use super::lists::{ListCursor, Picker, ReasonFor};
use super::mouse::SendConfirmation;
use super::panels::Panel;
use super::preflight::{GazePairing, ObserverStatus, ParticipantDisplayHealth};
use super::probe_keys::ProbeEntry;
use super::text_input::TextInput;
use super::view::theme::Theme;
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::gaze::recorded::RecordedGazeSummary;
use tomcom_core::kitchen::{Agent, AspectId};
use tomcom_core::measures::raters::ErrorCauseCode;
use tomcom_core::measures::wizard_performance::WizardMeasures;
use tomcom_session::history::belief_track::BeliefHistory;
use tomcom_session::history::comparison::{SenderComparison, UnmatchedCommunication};
use tomcom_session::history::error_reasons::ExplainedError;
use tomcom_session::preflight_checks::{PreflightCheck, RejectedGaze};
use tomcom_session::replay::ReplayLandmark;
use tomcom_session::{Event, TimelineEntry, TimelineEvent};

/// Time for which a notice is shown, in seconds.
const NOTICE_S: f64 = 4.0;

/// Largest number of different rejections (address and reason) of gaze senders for which notices are given.
const REJECTIONS: usize = 16;
/// Least time between two notices about the same rejected gaze sender, in seconds.
const REJECTED_AGAIN_S: f64 = 10.0;
/// Number of recent gaze samples that the gaze map draws.
const TRAIL: usize = 240;
/// Duration of the trail of gaze on the gaze map, in seconds.
pub const TRAIL_S: f64 = 2.0;

/// A dialog of the console that is open above its panels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Dialog {
    /// Help of the console: the table of keys. For each entry of the table, whether its key had an effect when the help
    /// was opened: the order of the lines does not change while the help is read.
    Help(Vec<bool>),
    Quit,
    EndTrial,
    EndTutorial,
    Pick(Picker),
    Palette(ListCursor),
    Send(SendConfirmation),
    Preflight,
    /// Gaze accuracy check: the targets, then the result.
    Calibration,
    Note(TextInput),
    /// Text input of further words beside a chosen reason.
    Reason(ReasonFor, String, TextInput),
    /// Text input of an answer to the shown questionnaire item: words or a number.
    Answer(TextInput),
    /// Lines of text below a title: what wizard and assistant knew at a difference, or where a replay stands; any key closes
    /// it.
    Details(&'static str, Vec<String>),
    /// Report of a wizard training, as lines of text; closed with enter.
    Report(Vec<String>),
}

/// A short message of the console to the wizard, shown for a few seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    pub text: String,
    pub level: NoticeLevel,
    /// Time at which the notice was given, on [`ConsoleModel::clock`].
    pub at: SessionTime,
}

/// State of the session's recording.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum RecordingStatus {
    #[default]
    Off,
    On(String),
    Lost,
}

/// State of the stream to viewers of the Rerun program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RerunStreamStatus {
    /// Address to which Rerun viewers connect; `None` if the stream is only written to a file.
    pub address: Option<String>,
    pub written: u64,
    pub dropped: u64,
}

/// State of the films that the session records.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilmStatus {
    /// Whether the trial can be filmed, as was found before it.
    pub check: PreflightCheck,
    pub cameras: usize,
    /// Number of cameras whose pictures arrive.
    pub filming: usize,
    pub lost: usize,
    /// Whether the cameras are to film now.
    pub is_on: bool,
}

/// State of the outgoing streams of the Lab Streaming Layer (LSL).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LslStatus {
    pub streams: Vec<String>,
    pub sent: u64,
    pub lost: u64,
}

/// A key that is held down, with times on [`ConsoleModel::clock`].
#[derive(Clone, Copy, Debug)]
pub(super) struct PressedKey {
    pub code: KeyCode,
    pub reported: SessionTime,
    /// Time at which the key last counted as newly pressed.
    pub counted: SessionTime,
}

/// State of the console: everything that concerns only the screen and the keyboard, not the trial.
#[derive(Clone, Debug, Default)]
pub struct ConsoleModel {
    pub now: SessionTime,
    /// Clock for keys and notices, which also runs while a replay is paused.
    pub clock: SessionTime,
    pub size: (u16, u16),
    pub theme: Theme,
    pub keys: KeyBindings,
    pub layer: KeyLayer,
    pub dialog: Option<Dialog>,
    pub notice: Option<Notice>,
    pub recording: RecordingStatus,
    pub viewers: Option<RerunStreamStatus>,
    pub lsl: Option<LslStatus>,
    pub films: Option<FilmStatus>,
    /// The checks of a real arm and its controller.
    pub arm: Vec<PreflightCheck>,
    /// Free disk space of the recording's folder in bytes; `None` if unknown.
    pub free_bytes: Option<u64>,
    /// Panel that is shown alone at full size.
    pub alone: Option<Panel>,
    /// Panel that the keys of panels refer to: its frame is stronger, the arrow keys scroll it.
    pub focus: Option<Panel>,
    /// First visible column of the help, or first visible line of a training report.
    pub help_from: usize,
    /// Scroll position of the list of events: number of newer entries that are skipped.
    pub events_back: usize,
    /// Scroll position of the beliefs: number of beliefs that are skipped.
    pub beliefs_from: usize,
    /// Scroll position of the timeline: seconds before the present.
    pub timeline_back_s: u32,
    pub focused: bool,
    /// Point of the wall display under the mouse pointer, in fractions of its size; below 0 or above 1 while the
    /// pointer is outside the kitchen panel.
    pub pointer: Option<[f64; 2]>,
    /// Latest gaze samples with their times, oldest first, for the gaze map.
    pub trail: VecDeque<(SessionTime, GazeSample)>,
    pub rejected_senders: u64,
    /// The last rejected gaze sender, and when it was rejected.
    pub rejected_gaze: Option<(RejectedGaze, SessionTime)>,
    /// Notices that were given about rejected gaze senders, with the time of the last one.
    rejections_told: Vec<(String, SessionTime)>,
    /// When a gaze sender last closed its connection.
    pub gaze_closed: Option<SessionTime>,
    /// Address and pairing code for gaze senders at other computers, if they may connect.
    pub gaze_pairing: Option<GazePairing>,
    /// What the session reads from its gaze file; `None` for other gaze sources.
    pub recorded_gaze: Option<RecordedGazeSummary>,
    pub display: Option<ParticipantDisplayHealth>,
    /// State of the observers' page; `None` if there is none.
    pub observers: Option<ObserverStatus>,
    /// In a plan: number of participants who have done everything, and of all of them.
    pub participants_done: Option<(usize, usize)>,
    /// In a plan: whether nothing of the participant's series is left after this recording.
    pub is_last_recording: bool,
    /// Whether the terminal is to ring with the next frame.
    pub rings: bool,
    /// The human's errors in the order of time, with reasons that were found once, when the press was judged.
    pub errors: Vec<ExplainedError>,
    /// Number of the human's presses whose judgement rests on a cost to go that is not proven.
    pub unproven: u64,
    /// The wizard's signals as the study judges them, once the trial is over.
    pub wizard: WizardMeasures,
    pub belief: BeliefHistory,
    /// State aspect whose estimated belief is shown over time.
    pub belief_focus: Option<AspectId>,
    pub comparison: Option<SenderComparisonView>,
    pub lesson: Option<TrainingPanel>,
    pub coding: Option<RaterSession>,
    pub playback: Option<Playback>,
    pub probe_entry: ProbeEntry,
    /// Chosen answer to the shown questionnaire item, until enter records it.
    pub item_choice: Option<ItemChoice>,
    /// Index of the selected reason for waiving the practice criterion, until enter confirms it.
    pub waiver: Option<usize>,
    /// What the wizard has selected to do with the result of a gaze accuracy check, until enter confirms it.
    pub gaze_choice: Option<AccuracyCheckAction>,
    pub(super) palette_chosen: Option<KeyAction>,
    /// Action that stands first in the open palette.
    pub(super) palette_first: Option<KeyAction>,
    /// Actions that had no effect when the palette was opened.
    pub(super) palette_idle: Vec<KeyAction>,
    /// Time at which enter last chose a row of a list, on [`ConsoleModel::clock`].
    pub(super) answered: Option<SessionTime>,
    /// Key that the last mouse click stood for, with the click's time on [`ConsoleModel::clock`].
    pub(super) clicked: Option<(KeyChord, SessionTime)>,
    /// Whether the terminal reports key repeats as such, separate from presses.
    pub(super) exact_keys: bool,
    pub(super) pressed: Option<PressedKey>,
}

impl ConsoleModel {
    /// State of a console before its first frame.
    pub fn new(keys: KeyBindings, theme: Theme, size: (u16, u16)) -> ConsoleModel {
        ConsoleModel { size, theme, keys, focused: true, ..ConsoleModel::default() }
    }

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

    /// The error that this entry of the timeline is, if it is one.
    pub fn error(&self, entry: &TimelineEntry) -> Option<&ExplainedError> {
        let is_press = matches!(entry.what, TimelineEvent::Press { agent: Agent::Human, .. });
        let found = self.errors.binary_search_by_key(&entry.time, |error| error.time);
        found.ok().filter(|_| is_press).map(|index| &self.errors[index])
    }
}

/// Input of the console: a key, a mouse event, pasted text or a change of the terminal.
#[derive(Clone, Debug, PartialEq)]
pub enum ConsoleMessage {
    Key(KeyEvent),
    /// The mouse pointer moved to this cell (column, row).
    Pointer(u16, u16),
    Click(u16, u16),
    Wheel(u16, u16, i8),
    /// The terminal was resized to these columns and rows.
    Resized(u16, u16),
    Focus(bool),
    /// Text was pasted into the terminal; `None` if the paste had no end, so that it was given up.
    Paste(Option<String>),
}

/// A command of the console to the program that runs it.
#[derive(Clone, Debug, PartialEq)]
pub enum ConsoleCommand {
    Input(Event),
    Start(Event),
    Move(ReplayAction),
    /// Save the rater's codes, and move the replay to the error whose code changed.
    Code {
        press: u64,
        /// The code before the change.
        was: Option<ErrorCauseCode>,
    },
    Redo,
    Next,
    Quit,
}

/// Severity of a notice, the console's short message to the wizard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoticeLevel {
    Done,
    Refused,
    /// Alarm: a fault that lasts until it is fixed.
    Alarm,
}

/// Content of the wizard training's panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrainingPanel {
    /// Task and scoring rules of the training, as paragraphs; shown until there is feedback.
    pub task: Vec<String>,
    pub feedback: Vec<TrainingFeedback>,
    /// Score of the training so far: "2 hit, 1 missed, 3 wrong".
    pub score: String,
    pub begun: bool,
}

/// Feedback on a signal that the trainee sent or missed.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainingFeedback {
    pub clock: SessionTime,
    pub level: NoticeLevel,
    pub text: String,
}

/// Action of a key in the list of differences between wizard and assistant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ComparisonAction {
    Next,
    Last,
    Open,
}

/// Comparison of wizard and assistants at the console, with the selected difference.
#[derive(Clone, Debug, Default)]
pub struct SenderComparisonView {
    /// Newest comparison; `None` until the trial's first press or order.
    pub seen: Option<SenderComparison>,
    /// Selected communication that has no match; `None` selects the newest one.
    chosen: Option<UnmatchedCommunication>,
}

impl SenderComparisonView {
    /// Takes over the newest comparison; the selected difference stays selected if it is still one.
    pub fn show(&mut self, newest: SenderComparison) {
        self.chosen = self.chosen.filter(|chosen| newest.differences.contains(chosen));
        self.seen = Some(newest);
    }

    /// Index of the selected difference, and the comparison that contains it.
    pub fn chosen(&self) -> Option<(usize, &SenderComparison)> {
        let seen = self.seen.as_ref()?;
        let newest = seen.differences.len().checked_sub(1)?;
        let is_it = |chosen: UnmatchedCommunication| seen.differences.iter().position(|one| *one == chosen);
        Some((self.chosen.and_then(is_it).unwrap_or(newest), seen))
    }

    /// Selects the next or the previous difference. From the last one on, the newest difference is always selected.
    pub fn choose(&mut self, step: ComparisonAction) {
        let Some((at, seen)) = self.chosen() else { return };
        let to = match step {
            ComparisonAction::Next => at + 1,
            ComparisonAction::Last => at.saturating_sub(1),
            ComparisonAction::Open => at,
        };
        self.chosen = seen.differences.get(to).copied().filter(|_| to + 1 < seen.differences.len());
    }
}

/// Speeds of a replay as multiples of real time; infinity for as fast as possible.
pub const SPEEDS: [f64; 8] = [0.25, 0.5, 1.0, 2.0, 4.0, 16.0, 64.0, f64::INFINITY];

/// Action of a replay's keys: play, move, or change the speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReplayAction {
    PlayPause,
    /// Go to the next event of the recording that is not a gaze sample.
    StepForward,
    /// Go to the previous event of the recording that is not a gaze sample.
    StepBack,
    On(ReplayLandmark),
    BackTo(ReplayLandmark),
    /// Go ten seconds forward in the recording.
    SeekForward,
    /// Go ten seconds back in the recording.
    SeekBack,
    Faster,
    Slower,
    ToStart,
    /// Go to the position after the event with this sequence number.
    ToEvent(u64),
    ToTime(SessionTime),
    /// Go to a time of the trial's clock.
    ToClock(SessionTime),
    /// Go to the landmark of this kind with this number, from 1.
    ToNth(ReplayLandmark, usize),
    /// Go to the end of the recording; in a recording that is still being made, stay at its growing end.
    ToEnd,
}

/// State of a replay: its position, its speed, and the recording's state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Playback {
    pub name: String,
    pub playing: bool,
    /// Playback speed, as an index into [`SPEEDS`].
    pub speed: usize,
    /// Errors, signals, false beliefs and notes of the recording, as far as it was read, by the trial's clock.
    pub marks: Arc<[(SessionTime, ReplayLandmark)]>,
    /// The recording's events in words, each with the action that goes there, while the palette is open, which finds them.
    pub told: Arc<[(ReplayAction, String)]>,
    pub trial_length: SessionTime,
    /// Number of events of the recording up to the replay's position.
    pub event: usize,
    pub events: usize,
    /// The landmark that a key went to last, in words, with the replay's position there; shown while the replay is there.
    /// Without a kind it is an event to which the replay was moved step by step.
    pub landmark: Option<(usize, Option<ReplayLandmark>, String)>,
    /// That no film of the recording has this moment, in words.
    pub outside_film: Option<&'static str>,
    pub follows: bool,
    pub cut: bool,
    /// Whether the recording is still being made, but the replay does not follow it.
    pub running: bool,
    /// Whether the recording was excluded from the analysis after it was closed.
    pub excluded: bool,
}

impl Playback {
    /// A replay at the beginning of a recording.
    pub fn new(name: String) -> Playback {
        Playback { name, speed: 2, ..Playback::default() }
    }

    /// The landmark or event at which the replay stands, if a key went there.
    pub fn stands_at(&self) -> Option<(Option<ReplayLandmark>, &str)> {
        let there = self.landmark.as_ref().filter(|(event, ..)| *event == self.event);
        there.map(|(_, what, words)| (*what, words.as_str()))
    }

    /// The playback speed in words: "2x", "0.25x", "max".
    pub fn speed_label(&self) -> String {
        let speed = SPEEDS[self.speed.min(SPEEDS.len() - 1)];
        if speed.is_finite() { format!("{speed}x") } else { "max".to_string() }
    }
}
