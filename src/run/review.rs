//! The console over a recording, or over a session that is still running: pause, step, seek, speed.

use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use tokio::time::{Instant, sleep_until};

use super::seekable_replay::SeekableReplay;
use super::watch_desk::ComparisonDesk;
use crate::analysis::watcher::{CompareRequest, ComparisonFollower};
use crate::base::time::SessionTime;
use crate::console::compared::ComparisonView;
use crate::console::key_action::KeyError;
use crate::console::notice::NoticeLevel;
use crate::console::playback::{Playback, ReplayKey, SPEEDS};
use crate::console::rater_session::RaterSession;
use crate::console::{ConsoleCommand, ConsoleMessage, ConsoleModel, KeyBindings, update};
use crate::edge::file_error::FileError;
use crate::edge::key_file::key_map;
use crate::edge::log::{LogEnding, codes};
use crate::edge::terminal::{TerminalInput, TerminalScreen, asked_to_end, theme};
use crate::history::landmark::ReplayLandmark;
use crate::measures::coding::Codable;
use crate::session::Event;

/// At most 30 frames a second.
const FRAME: Duration = Duration::from_millis(33);
/// At full speed, so much of every frame goes into applying events.
const WORK: Duration = Duration::from_millis(20);
/// A growing recording is looked at so often.
const LOOK: Duration = Duration::from_millis(50);
/// How far a seek goes.
const SEEK: SessionTime = SessionTime(10_000_000_000);

/// Why a recording could not be shown.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ReviewError {
    #[error("the console cannot be opened: {0}")]
    #[diagnostic(help("run it in a terminal; `tomcom replay RECORDING` tells a recording in words through a pipe"))]
    Terminal(io::Error),
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] Box<FileError>),
    #[error("{}: the training cannot be recorded: {reason}", path.display())]
    #[diagnostic(help("a folder that can be written to, with --out"))]
    Training { path: PathBuf, reason: io::Error },
    #[error("the header of the recording: {0}")]
    #[diagnostic(help("{}", .0.remedy))]
    Keys(#[from] KeyError),
}

impl From<FileError> for ReviewError {
    fn from(error: FileError) -> ReviewError {
        ReviewError::File(Box::new(error))
    }
}

/// Opens the console over a recording; with `follow`, at the growing end of a running session; with a comparison of wizard
/// and assistants, where that is asked for.
///
/// # Errors
/// The recording cannot be read, or there is no terminal.
pub fn review(recording: &Path, follow: bool, compare: Option<&CompareRequest>) -> Result<(), ReviewError> {
    let film = SeekableReplay::open(recording)?;
    on_thread(Review::open(film, recording, follow, compare, None)?)
}

/// Opens the console over a recording for a rater, who codes its errors and sees what a wizard without estimates sees; what
/// was said is kept beside the log after every key.
///
/// # Errors
/// The recording or its codes cannot be read, or there is no terminal.
pub fn rate(recording: &Path, rater: &str) -> Result<(), ReviewError> {
    let film = SeekableReplay::open(recording)?.blinded();
    let codable = Codable::from_presses(&film.replay.session().kitchen, &film.replay.follower.judged);
    let codes = codes::read(film.replay.log().folder(), rater, &codable)?;
    let coding = RaterSession { rater: rater.to_string(), errors: codable.errors, codes };
    on_thread(Review::open(film, recording, false, None, Some(coding))?)
}

fn on_thread(review: Review) -> Result<(), ReviewError> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(ReviewError::Terminal)?;
    runtime.block_on(review.run())
}

struct Review {
    film: SeekableReplay,
    model: ConsoleModel,
    screen: TerminalScreen,
    opened: Instant,
    /// The moment that is shown, and when it was reached.
    now: SessionTime,
    at: Instant,
    /// When the newest event of a growing recording was read.
    read_at: Instant,
    grows: bool,
    dirty: bool,
    /// Who compares wizard and assistants.
    watch: Option<ComparisonDesk>,
}

impl Review {
    fn open(
        film: SeekableReplay,
        recording: &Path,
        follow: bool,
        compare: Option<&CompareRequest>,
        coding: Option<RaterSession>,
    ) -> Result<Review, ReviewError> {
        let screen = TerminalScreen::take().map_err(ReviewError::Terminal)?;
        let size = TerminalScreen::size().map_err(ReviewError::Terminal)?;
        let keys = film.replay.log().header.keys.as_ref();
        let keys = KeyBindings::replay(&film.session.kitchen, &key_map(keys)?)?;
        let keys = if compare.is_some() { keys.with_comparison() } else { keys };
        let keys = if coding.is_some() { keys.with_coding(&film.session.kitchen) } else { keys };
        let mut model = ConsoleModel::new(keys, theme(&film.session.spec.console, screen.ground), size);
        model.comparison = compare.map(|_| ComparisonView::default());
        model.coding = coding;
        let watch = compare.map(|request| {
            let session = film.replay.log().session();
            ComparisonFollower::new(session, request).without_causes().on_thread()
        });
        let name = recording.file_name().unwrap_or(recording.as_os_str()).to_string_lossy().into_owned();
        let excluded = film.standing()?.excluded.is_some();
        let running = !follow && film.replay.log().ending() == LogEnding::Running;
        model.playback = Some(Playback { excluded, running, ..Playback::new(name) });
        let now = Instant::now();
        let mut review = Review {
            film,
            model,
            screen,
            opened: now,
            now: SessionTime::ZERO,
            at: now,
            read_at: now,
            grows: follow,
            dirty: true,
            watch,
        };
        review.tell(0);
        // Who codes goes from error to error.
        let plays = review.model.coding.is_none();
        review.playback(|playback| playback.playing = plays);
        if follow {
            review.go(ReplayKey::ToEnd);
        }
        Ok(review)
    }

    async fn run(mut self) -> Result<(), ReviewError> {
        let mut hands = TerminalInput::default();
        let end = asked_to_end();
        tokio::pin!(end);
        let mut next_frame = Instant::now();
        let mut next_look = Instant::now();
        while !self.screen.is_lost() {
            tokio::select! {
                biased;
                _ = &mut end => break,
                message = hands.next() => match message {
                    Some(message) => if self.take(message) { break },
                    None => break,
                },
                () = sleep_until(next_look), if self.grows => {
                    next_look = Instant::now() + LOOK;
                    self.look()?;
                }
                () = sleep_until(next_frame) => {
                    next_frame = Instant::now() + FRAME;
                    self.play();
                    self.draw().map_err(ReviewError::Terminal)?;
                }
            }
        }
        Ok(())
    }

    /// Takes a message of the terminal; whether somebody has quit.
    fn take(&mut self, message: ConsoleMessage) -> bool {
        self.dirty = true;
        self.tick();
        match update(&mut self.model, &self.film.session, message) {
            Some(ConsoleCommand::Move(to)) => self.go(to),
            Some(ConsoleCommand::Code) => self.keep(),
            Some(ConsoleCommand::Quit) => return true,
            Some(ConsoleCommand::Input(_) | ConsoleCommand::Start(_) | ConsoleCommand::Next | ConsoleCommand::Redo)
            | None => {}
        }
        false
    }

    /// Keeps what the rater says.
    fn keep(&mut self) {
        let Some(coding) = &self.model.coding else { return };
        if let Err(error) = codes::write(self.film.replay.log().folder(), &coding.rater, &coding.codes) {
            self.model.say(NoticeLevel::Alarm, format!("not kept: {error}"));
        }
    }

    /// Moves the clock on that also runs while the replay stands.
    fn tick(&mut self) {
        self.model.clock = SessionTime(self.opened.elapsed().as_nanos() as u64);
    }

    fn playback(&mut self, change: impl FnOnce(&mut Playback)) {
        if let Some(playback) = &mut self.model.playback {
            change(playback);
        }
    }

    fn is(&self, what: impl FnOnce(&Playback) -> bool) -> bool {
        self.model.playback.as_ref().is_some_and(what)
    }

    fn go(&mut self, to: ReplayKey) {
        let speeds = SPEEDS.len() - 1;
        match to {
            ReplayKey::PlayPause => {
                let at_end = self.film.position == self.film.length().1 && !self.grows;
                if at_end {
                    self.stand_at(0);
                }
                self.playback(|playback| playback.playing = !playback.playing);
            }
            ReplayKey::Faster => self.playback(|playback| playback.speed = (playback.speed + 1).min(speeds)),
            ReplayKey::Slower => self.playback(|playback| playback.speed = playback.speed.saturating_sub(1)),
            ReplayKey::StepForward => self.stand_at(self.film.next_step()),
            ReplayKey::StepBack => self.stand_at(self.film.last_step()),
            ReplayKey::On(what) => self.look_for(what, true),
            ReplayKey::BackTo(what) => self.look_for(what, false),
            ReplayKey::ToStart => self.stand_at(0),
            ReplayKey::ToEvent(number) => self.stand_at(number as usize + 1),
            ReplayKey::SeekForward => self.seek(self.now + SEEK),
            ReplayKey::SeekBack => self.seek(self.now - SEEK),
            ReplayKey::ToEnd => {
                let (length, events) = self.film.length();
                self.wind(events);
                self.now = length;
                let grows = self.grows;
                self.playback(|playback| playback.playing = grows);
            }
        }
        let follows = self.grows && to == ReplayKey::ToEnd;
        if !matches!(to, ReplayKey::Faster | ReplayKey::Slower) {
            self.playback(|playback| playback.follows = follows);
        }
        self.at = Instant::now();
    }

    fn stand_at(&mut self, position: usize) {
        self.wind(position);
        self.now = self.film.time();
        self.playback(|playback| playback.playing = false);
    }

    /// Stands at the next or the last moment of this kind; where there is none it stays.
    fn look_for(&mut self, what: ReplayLandmark, forward: bool) {
        match self.film.landmark(what, forward) {
            Some(position) => self.stand_at(position),
            None => {
                let which = if forward { "further" } else { "earlier" };
                let what = match what {
                    ReplayLandmark::Error => "error",
                    ReplayLandmark::Signal => "signal",
                    ReplayLandmark::Marker => "marker",
                    ReplayLandmark::FalseBelief => "false belief",
                };
                self.model.say(NoticeLevel::Refused, format!("no {which} {what}"));
            }
        }
    }

    fn seek(&mut self, time: SessionTime) {
        self.now = time.min(self.film.length().0);
        self.wind(self.film.until(self.now));
    }

    fn wind(&mut self, position: usize) {
        self.model.trail.clear();
        self.film.wind(position);
    }

    /// Tells whoever compares what was read from the event with this place on.
    fn tell(&self, from: usize) {
        if let Some(watch) = &self.watch {
            self.film.events[from..].iter().for_each(|stamped| watch.tell(stamped));
        }
    }

    /// Reads on in a growing recording.
    fn look(&mut self) -> Result<(), ReviewError> {
        let (_, known) = self.film.length();
        if self.film.read()? {
            self.read_at = Instant::now();
            self.tell(known);
        }
        if !self.film.is_cut() {
            self.grows = false;
        }
        Ok(())
    }

    /// Moves on by the time that has passed.
    fn play(&mut self) {
        let passed = self.at.elapsed();
        self.at = Instant::now();
        let (length, events) = self.film.length();
        if self.is(|playback| playback.follows) {
            // Between two events of the running session its clock goes on.
            let ahead = if self.grows { self.read_at.elapsed().as_nanos() as u64 } else { 0 };
            self.now = self.now.max(length + SessionTime(ahead));
        } else if self.is(|playback| playback.playing) {
            let speed = self.model.playback.as_ref().map_or(1.0, |playback| SPEEDS[playback.speed]);
            self.now = match speed.is_finite() {
                true => (self.now + SessionTime::from_secs_f64(passed.as_secs_f64() * speed)).min(length),
                false => length,
            };
        } else {
            return;
        }
        let until = self.film.until(self.now);
        let began = Instant::now();
        while self.film.position < until && began.elapsed() < WORK {
            let Some(stamped) = self.film.forward() else { break };
            if let Event::Gaze(sample) = stamped.event {
                self.model.see(stamped.time, sample);
            }
        }
        if self.film.position < until {
            self.now = self.film.time();
        } else if self.film.position == events && !self.grows {
            self.playback(|playback| playback.playing = false);
        }
        self.dirty = true;
    }

    fn draw(&mut self) -> io::Result<()> {
        if let (Some(newest), Some(compared)) =
            (self.watch.as_ref().and_then(ComparisonDesk::newest), &mut self.model.comparison)
        {
            compared.show(newest);
            self.dirty = true;
        }
        if !self.dirty || !self.screen.is_ready() {
            return Ok(());
        }
        self.dirty = false;
        self.tick();
        self.model.now = self.now;
        self.model.errors.clone_from(&self.film.errors);
        self.model.belief.catch_up(&self.film.beliefs);
        let (length, events) = self.film.length();
        let (event, cut) = (self.film.position, self.film.is_cut());
        self.playback(|playback| *playback = Playback { length, event, events, cut, ..playback.clone() });
        self.screen.draw(&self.film.session, &self.model)
    }
}
