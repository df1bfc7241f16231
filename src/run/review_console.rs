//! The console that shows a recording, or a session that is still running: pause, step, seek, speed.

mod playing;

use std::path::Path;
use std::time::{Duration, Instant};

use super::comparison_thread::ComparisonThreadHandle;
use super::error::{ReviewError, TerminalError};
use super::event_loop::{self, ConsoleShell, LoopEvent, ShellView};
use super::film_player::{self, FilmPlayer};
use super::operator_station::OperatorStation;
use super::rater_files;
use super::seekable_replay::SeekableReplay;
use crate::console::coding::RaterSession;
use crate::console::console_model::{Dialog, NoticeLevel, Playback, ReplayAction, SPEEDS, SenderComparisonView};
use crate::console::key_action::KeyAction;
use crate::console::{ConsoleCommand, ConsoleMessage, ConsoleModel, KeyBindings, update};
use crate::run::key_file::key_map;
use crate::run::terminal::TerminalScreen;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::measures::raters::ErrorCauseCode;
use tomcom_session::error_list::ListedError;
use tomcom_session::history::wording;
use tomcom_session::log::{LogEnding, RecordingLock, video_file};
use tomcom_session::replay::ReplayLandmark;
use tomcom_session::watcher::{SenderComparisonFollower, SenderComparisonSettings};

/// Time spent on reading the rest of a recording, of the 50 ms between two ticks for files.
const READING: Duration = Duration::from_millis(35);

/// Opens the console that shows a recording; with `follow`, at the growing end of a running session; optionally with a
/// comparison of wizard and assistants.
///
/// # Errors
/// The recording cannot be read, or there is no terminal.
pub fn review(recording: &Path, follow: bool, compare: Option<&SenderComparisonSettings>) -> Result<(), ReviewError> {
    // The console begins at once, and the rest is read beside it; a running session is shown at its end.
    let mut film = if follow { SeekableReplay::open(recording) } else { SeekableReplay::begin(recording) }?;
    film.read_to_trial()?;
    at_station(film, recording, follow, compare, None)?;
    Ok(())
}

/// Opens the console over a recording for a rater, who codes its errors without seeing estimates, signals or condition;
/// codes are saved beside the log after every key. Returns what the rater has coded and where it is saved, in words.
///
/// # Errors
/// The recording or its codes cannot be read, another program codes as this rater, the codes cannot be saved, or there
/// is no terminal.
pub fn rate(recording: &Path, rater: &str) -> Result<String, ReviewError> {
    let film = SeekableReplay::open(recording)?.blinded();
    let _lock = RecordingLock::take_for_codes(film.replay.log().folder(), &[rater])?;
    let coding = rater_files::of_rater(&film, rater)?;
    at_station(film, recording, false, None, Some(coding))?.end_coding()
}

/// Opens the console over a recording for two raters, who settle together what they coded differently; their consensus
/// is saved beside the log after every key. Returns what the raters have settled and where it is saved, in words.
///
/// # Errors
/// The recording or its codes cannot be read, one of the raters has no codes, other raters settled the recording
/// already, the consensus cannot be written, or there is no terminal.
pub fn code_as_pair(recording: &Path, raters: [&str; 2]) -> Result<String, ReviewError> {
    let film = SeekableReplay::open(recording)?.blinded();
    let _lock = RecordingLock::take_for_codes(film.replay.log().folder(), &raters)?;
    let coding = rater_files::of_pair(&film, raters)?;
    at_station(film, recording, false, None, Some(coding))?.end_coding()
}

/// Shows a recording at an operator's station without devices, until the wizard or rater leaves it.
fn at_station(
    film: SeekableReplay,
    recording: &Path,
    follow: bool,
    compare: Option<&SenderComparisonSettings>,
    coding: Option<RaterSession>,
) -> Result<Review, ReviewError> {
    event_loop::in_runtime(async {
        let mut station = OperatorStation::without_devices(&film.session.spec.console)?;
        let mut review = Review::open(film, &station, recording, follow, compare, coding)?;
        event_loop::run(&mut review, &mut station).await?;
        Ok(review)
    })
}

struct Review {
    film: SeekableReplay,
    model: ConsoleModel,
    opened: Instant,
    now: SessionTime,
    at: Instant,
    /// Instant at which the newest event of a running session's recording was read.
    read_at: Instant,
    grows: bool,
    /// Whether a program on this machine was seen to write the recording. A log that is only copied here has no such.
    was_written: bool,
    dirty: bool,
    /// Comparison of wizard and assistants, if it was asked for.
    comparison: Option<ComparisonThreadHandle>,
    /// Number of events that were read when the marks on the bar of the recording were made.
    marked: usize,
    /// Windows with the recording's films.
    players: Vec<FilmPlayer>,
}

impl Review {
    fn open(
        film: SeekableReplay,
        station: &OperatorStation,
        recording: &Path,
        follow: bool,
        compare: Option<&SenderComparisonSettings>,
        coding: Option<RaterSession>,
    ) -> Result<Review, ReviewError> {
        let size = TerminalScreen::size().map_err(TerminalError)?;
        let keys = film.replay.log().header.keys.as_ref();
        let keys = KeyBindings::replay(&film.session.kitchen, &key_map(keys)?)?;
        let keys = if compare.is_some() { keys.with_comparison() } else { keys };
        let keys = if coding.is_some() { keys.with_coding(&film.session.kitchen) } else { keys };
        let mut model = ConsoleModel::new(keys, station.theme, size);
        model.comparison = compare.map(|_| SenderComparisonView::default());
        model.coding = coding;
        let comparison = compare.map(|request| {
            let session = film.replay.log().session();
            let cost = CostToGo::new(session.kitchen.clone());
            ComparisonThreadHandle::start(SenderComparisonFollower::new(session, cost, request).without_causes())
        });
        let name = recording.file_name().unwrap_or(recording.as_os_str()).to_string_lossy().into_owned();
        let excluded = film.standing()?.excluded.is_some();
        let running = !follow && film.replay.log().ending() == LogEnding::Running;
        model.playback = Some(Playback { excluded, running, ..Playback::new(name) });
        let folder = film.replay.log().folder();
        let (players, unshown) = film_player::open_all(&video_file::read(folder)?.films, folder);
        let now = Instant::now();
        let mut review = Review {
            film,
            model,
            opened: now,
            now: SessionTime::ZERO,
            at: now,
            read_at: now,
            grows: follow,
            was_written: false,
            dirty: true,
            comparison,
            marked: 0,
            players,
        };
        review.tell(0);
        let start = review.film.trial_start();
        review.stand_at(start);
        let plays = review.model.keys.chord_for(&KeyAction::Move(ReplayAction::PlayPause));
        if follow {
            review.go(ReplayAction::ToEnd);
        } else if let Some(key) = plays {
            review.model.say(NoticeLevel::Done, format!("paused; {key} plays"));
        }
        review.begin_coding();
        // Raters have to know before they code without it.
        if let Some(why) = unshown {
            let coding = review.model.coding.as_ref().map(rater_files::opening_words);
            let coding = coding.map_or(String::new(), |words| format!("{words}; "));
            review.model.say(NoticeLevel::Done, format!("{coding}the film of this recording is not shown: {why}"));
        }
        Ok(review)
    }

    /// Handles a message from the terminal; returns whether the wizard leaves the review.
    fn take_message(&mut self, message: ConsoleMessage) -> Result<bool, ReviewError> {
        self.dirty = true;
        self.tick();
        // Keys can come faster than frames: a code is for the error that the key before it went to.
        let event = self.film.position;
        self.playback(|playback| playback.event = event);
        match update(&mut self.model, &self.film.session, message) {
            Some(ConsoleCommand::Move(to)) => {
                if !matches!(to, ReplayAction::PlayPause | ReplayAction::Faster | ReplayAction::Slower) {
                    self.read_rest(|| true)?;
                }
                self.go(to);
            }
            Some(ConsoleCommand::Code { press, was }) => self.keep(press, was),
            Some(ConsoleCommand::Quit) => return Ok(true),
            Some(ConsoleCommand::Input(_) | ConsoleCommand::Start(_) | ConsoleCommand::Next | ConsoleCommand::Redo)
            | None => {}
        }
        Ok(false)
    }

    /// Saves the raters' codes, and goes to the error whose code changed; `was`: the code before the change.
    fn keep(&mut self, press: u64, was: Option<ErrorCauseCode>) {
        let present = self.model.coding.as_ref().and_then(|coding| coding.present(self.film.position));
        if present.map(|error| error.press) != Some(press) {
            self.go(ReplayAction::ToEvent(press));
        }
        let Some(coding) = &self.model.coding else { return };
        let error = coding.errors.iter().find(|error| error.press == press);
        // A code that is given again replaces nothing.
        let was = was.filter(|was| coding.codes.0.get(&press) != Some(was));
        let was = was.map_or(String::new(), |was| format!(", was {}", wording::code(&was)));
        let said = match (coding.next_step(), error) {
            (Some(next), _) => format!("code saved{was}; {next}"),
            (None, Some(error)) => match coding.code(error) {
                Some(code) => format!("saved: error {}, {}{was}", error.error, wording::code(code)),
                None => format!("saved: code of error {} removed{was}", error.error),
            },
            (None, None) => "saved".to_string(),
        };
        let saved = rater_files::save(&self.film, coding);
        if let Some(coding) = &mut self.model.coding {
            coding.is_saved = saved.is_ok();
        }
        match saved {
            Ok(()) => self.model.say(NoticeLevel::Done, said),
            Err(error) => self.model.say(NoticeLevel::Alarm, format!("code not saved: {error}")),
        }
    }

    /// Saves codes that could not be saved before; returns what was coded and where it is saved, in words.
    fn end_coding(self) -> Result<String, ReviewError> {
        Ok(match &self.model.coding {
            Some(coding) => rater_files::closing_words(&self.film, coding)?,
            None => String::new(),
        })
    }

    /// Goes to the first error without a code, and shows a message about it.
    fn begin_coding(&mut self) {
        let Some(coding) = &self.model.coding else { return };
        let said = rater_files::opening_words(coding);
        let first = coding.errors.get(coding.first_open().unwrap_or(0)).map(|error| error.press);
        if let Some(press) = first {
            self.go(ReplayAction::ToEvent(press));
        }
        self.model.say(NoticeLevel::Done, said);
    }

    /// Advances the clock of the screen, which also runs while the replay is paused.
    fn tick(&mut self) {
        self.model.clock = SessionTime(self.opened.elapsed().as_nanos() as u64);
    }

    fn playback(&mut self, change: impl FnOnce(&mut Playback)) {
        if let Some(playback) = &mut self.model.playback {
            change(playback);
        }
    }

    /// Marks errors, signals, false beliefs and notes on the bar of the recording; for raters, only the errors of their list.
    fn mark(&mut self) {
        let read = self.film.read_events();
        if self.marked == read {
            return;
        }
        self.marked = read;
        // Where two marks meet, the later one of this list is seen.
        use ReplayLandmark::{Error, FalseBelief, Marker, Signal};
        let session = self.film.replay.session();
        let times = |what: ReplayLandmark| {
            self.film.landmarks(what).into_iter().map(move |time| (session.trial_clock_at(time), what))
        };
        let listed = |error: &ListedError| (SessionTime::from_secs_f64(error.time_s), Error);
        let marks: Vec<(SessionTime, ReplayLandmark)> = match &self.model.coding {
            Some(coding) => coding.errors.iter().map(listed).collect(),
            None => [FalseBelief, Error, Signal, Marker].into_iter().flat_map(times).collect(),
        };
        self.playback(|playback| playback.marks = marks.into());
    }

    /// Lists the events in words for the palette as long as it is open.
    fn list_events(&mut self) {
        let is_open = matches!(self.model.dialog, Some(Dialog::Palette(_)));
        if is_open == self.is(|playback| playback.told.is_empty()) {
            let told = if is_open { self.film.told_events() } else { Vec::new() };
            self.playback(|playback| playback.told = told.into());
        }
    }

    /// Lets the films follow the replay.
    fn show_films(&mut self) {
        let (now, before) = (self.now, self.players.len());
        let speed = match &self.model.playback {
            Some(playback) if playback.follows => 1.0,
            // At full speed the films stand until the replay does.
            Some(playback) if playback.playing && SPEEDS[playback.speed].is_finite() => SPEEDS[playback.speed],
            _ => 0.0,
        };
        self.players.retain_mut(|player| player.show(now, speed));
        if self.players.len() < before {
            self.model.say(NoticeLevel::Done, "the window with the film was closed".to_string());
            self.dirty = true;
        }
    }

    fn is(&self, what: impl FnOnce(&Playback) -> bool) -> bool {
        self.model.playback.as_ref().is_some_and(what)
    }

    /// Passes the events from this position on to the comparison of wizard and assistants.
    fn tell(&mut self, from: usize) {
        if let Some(comparison) = &self.comparison {
            let read = self.film.read_events();
            self.film.each(from..read, |stamped| comparison.tell(stamped));
        }
    }

    /// Reads on in a recording that is not yet read to its end, as long as `goes_on` returns true.
    fn read_rest(&mut self, goes_on: impl Fn() -> bool) -> Result<(), ReviewError> {
        if self.film.is_read() {
            return Ok(());
        }
        let known = self.film.read_events();
        self.film.read_while(goes_on)?;
        self.tell(known);
        self.dirty = true;
        if self.film.is_read() {
            let excluded = self.film.standing()?.excluded.is_some();
            self.playback(|playback| playback.excluded = excluded);
        }
        Ok(())
    }

    /// Reads new events of a recording that a running session is still writing.
    fn look(&mut self) -> Result<(), ReviewError> {
        let (_, known) = self.film.length();
        if self.film.read()? {
            self.read_at = Instant::now();
            self.tell(known);
        }
        if !self.film.is_cut() {
            self.grows = false;
            return Ok(());
        }
        self.film.replay.log().check_there()?;
        match self.film.replay.log().ending() {
            LogEnding::Running => self.was_written = true,
            // What the program wrote at its end can have come since the log was read.
            LogEnding::Cut if self.was_written && !self.film.read()? => {
                self.grows = false;
                self.playback(|playback| (playback.follows, playback.playing) = (false, false));
                let folder = self.film.replay.log().folder().display();
                let text = format!(
                    "the program that recorded this has ended without closing it; tomcom operate --continue {folder} goes on"
                );
                self.model.say(NoticeLevel::Alarm, text);
                self.dirty = true;
            }
            LogEnding::Cut | LogEnding::Closed => {}
        }
        Ok(())
    }
}

impl ConsoleShell for Review {
    type Outcome = ();
    type Error = ReviewError;

    fn take(&mut self, event: LoopEvent) -> Result<Option<()>, ReviewError> {
        if let Some(error) = self.film.take_trouble() {
            return Err(error.into());
        }
        match event {
            LoopEvent::Terminal(message) => return Ok(self.take_message(message)?.then_some(())),
            LoopEvent::FileTick if self.grows => self.look()?,
            LoopEvent::FileTick => {
                let began = Instant::now();
                self.read_rest(|| began.elapsed() < READING)?;
            }
            _ => {}
        }
        Ok(None)
    }

    fn advance(&mut self) -> bool {
        self.play();
        self.show_films();
        if let (Some(newest), Some(compared)) =
            (self.comparison.as_ref().and_then(ComparisonThreadHandle::newest), &mut self.model.comparison)
        {
            compared.show(newest);
            self.dirty = true;
        }
        self.dirty
    }

    fn prepare(&mut self) {
        self.dirty = false;
        self.tick();
        self.model.now = self.now;
        let known = self.model.errors.len();
        self.model.errors.extend_from_slice(&self.film.errors[known..]);
        self.film.show_beliefs(&mut self.model.belief);
        let (_, events) = self.film.length();
        let (event, cut) = (self.film.position, self.film.is_cut());
        let trial_length = self.film.trial_length();
        // Where one of the films has the moment, nothing is missing.
        let has_moment = |player: &FilmPlayer| player.film.outside(self.now).is_none();
        let first = self.players.first().filter(|_| !self.players.iter().any(has_moment));
        let outside_film = first.and_then(|player| player.film.outside(self.now));
        self.mark();
        self.list_events();
        self.playback(|playback| {
            *playback = Playback { trial_length, event, events, cut, outside_film, ..playback.clone() };
        });
    }

    fn view(&self) -> ShellView<'_> {
        ShellView::Console(&self.film.session, &self.model)
    }
}
