//! `tomcom train`: a wizard watches recordings in which it is known what was believed wrong, sends signals by the keys of a
//! session, and is told at once what each was; at the end there is a score, held against a criterion. Nothing reaches the
//! participant in the recording.

use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use tokio::time::{Instant, sleep_until};

use super::film::Film;
use super::review::ReviewError;
use super::wizard::spells;
use crate::base::time::SessionTime;
use crate::communication::Signal;
use crate::communication::recommendation::aspects_told;
use crate::console::model::Level;
use crate::console::playback::{Playback, SPEEDS};
use crate::console::words;
use crate::console::{Command, Keys, Message, Model, update};
use crate::edge::clock::WallTime;
use crate::edge::files::{FileError, FileResult, key_map};
use crate::edge::terminal::{Hands, Screen, asked_to_end, theme};
use crate::edge::training::{self, JudgedRecording, JudgedSignal, TrainingRecord};
use crate::kitchen::{Agent, AspectId, Kitchen};
use crate::measures::matching::{Content, Kind, Said, Tally, WINDOW};
use crate::measures::wizard::{Sent, Spell, TrainingCriterion, WizardMeasures, Worth, worths};
use crate::session::Event;
use crate::session::settings::{Condition, Visibility};

/// At most 30 frames a second.
const FRAME: Duration = Duration::from_millis(33);
/// What a signal was stands for so long, in seconds.
const FEEDBACK_S: f64 = 3.0;

/// What is trained.
#[derive(Clone, Debug)]
pub struct Lesson {
    /// Recordings of simulated participants without signals.
    pub recordings: Vec<PathBuf>,
    /// The wizard's code.
    pub wizard: String,
    /// Where the result goes.
    pub out: PathBuf,
    pub criterion: TrainingCriterion,
    /// An index into [`SPEEDS`].
    pub speed: usize,
}

/// Trains a wizard at the console. Returns what came of it, and the file that it was written to.
///
/// # Errors
/// A recording that cannot be trained with, no terminal, or no place for the result.
pub fn train(lesson: &Lesson) -> Result<(TrainingRecord, PathBuf), ReviewError> {
    let before = training::read(&lesson.out, &lesson.wizard)?;
    let films: Vec<(Film, Vec<Spell>)> = lesson.recordings.iter().map(|one| open(one)).collect::<FileResult<_>>()?;
    let at = WallTime::now().rfc3339();
    let began = Instant::now();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(ReviewError::Terminal)?;
    let recordings = runtime.block_on(watch(lesson, films, &before))?;
    let minutes = (began.elapsed().as_secs_f64() / 0.6).round() / 100.0;
    let is_complete = recordings.len() == lesson.recordings.len() && recordings.iter().all(|one| one.complete);
    let met = is_complete && lesson.criterion.is_met(&WizardMeasures::sum(recordings.iter().map(|one| &one.measures)));
    let (wizard, criterion) = (lesson.wizard.clone(), lesson.criterion);
    let record = TrainingRecord { wizard, at, minutes, criterion, met, recordings };
    let path = training::write(&lesson.out, &record)
        .map_err(|reason| ReviewError::Training { path: lesson.out.clone(), reason })?;
    Ok((record, path))
}

/// A recording with what was believed wrong in it.
fn open(recording: &Path) -> FileResult<(Film, Vec<Spell>)> {
    let mut film = Film::open(recording)?;
    let unfit = |found: &str| {
        let remedy = "a recording of a simulated participant without signals (tomcom simulate SESSION)".to_string();
        FileError::at(recording, "", None, found.to_string(), remedy)
    };
    if film.session.spec.trial.condition != Condition::None {
        return Err(unfit("a trial in which somebody sends signals"));
    }
    let spells =
        spells(&film.replay.follower).ok_or_else(|| unfit("a trial of which nobody knows what was believed"))?;
    // As a wizard's session, with what the paper's wizard had.
    film.session.spec.trial.condition = Condition::Wizard;
    film.session.spec.console.visibility = Visibility::State;
    Ok((film, spells))
}

/// Watches one recording after another, until all are over or somebody quits.
async fn watch(
    lesson: &Lesson,
    films: Vec<(Film, Vec<Spell>)>,
    before: &[TrainingRecord],
) -> Result<Vec<JudgedRecording>, ReviewError> {
    let mut screen = Screen::take().map_err(ReviewError::Terminal)?;
    let mut hands = Hands::default();
    let end = asked_to_end();
    tokio::pin!(end);
    let mut judged = Vec::new();
    for ((film, spells), recording) in films.into_iter().zip(&lesson.recordings) {
        let name = recording.file_name().unwrap_or(recording.as_os_str()).to_string_lossy().into_owned();
        let mut class = Class::new(film, spells, name, lesson.speed, &screen)?;
        let mut next_frame = Instant::now();
        let mut goes_on = true;
        while goes_on && !class.is_over() && !screen.is_lost() {
            tokio::select! {
                biased;
                _ = &mut end => goes_on = false,
                message = hands.next() => goes_on = message.is_some_and(|message| class.take(message)),
                () = sleep_until(next_frame) => {
                    next_frame = Instant::now() + FRAME;
                    class.play();
                    class.draw(&mut screen).map_err(ReviewError::Terminal)?;
                }
            }
        }
        judged.push(class.judged(before));
        if !goes_on || screen.is_lost() {
            break;
        }
    }
    Ok(judged)
}

/// A recording that is watched.
struct Class {
    film: Film,
    name: String,
    spells: Vec<Spell>,
    model: Model,
    sent: Vec<Sent>,
    signals: Vec<JudgedSignal>,
    /// Of each spell, whether it was said that it was missed.
    told_missed: Vec<bool>,
    now: SessionTime,
    opened: Instant,
    at: Instant,
}

impl Class {
    fn new(film: Film, spells: Vec<Spell>, name: String, speed: usize, screen: &Screen) -> Result<Class, ReviewError> {
        let spec = &film.session.spec;
        let keys = Keys::training(&film.session.kitchen, spec, &key_map(film.replay.log().header.keys.as_ref())?)?;
        let size = Screen::size().map_err(ReviewError::Terminal)?;
        let mut model = Model::new(keys, theme(&spec.console, screen.ground), size);
        model.playback = Some(Playback { speed, ..Playback::new("training".to_string()) });
        let (now, told_missed) = (Instant::now(), vec![false; spells.len()]);
        let mut class = Class {
            film,
            name,
            spells,
            model,
            sent: Vec::new(),
            signals: Vec::new(),
            told_missed,
            now: SessionTime::ZERO,
            opened: now,
            at: now,
        };
        // The trial has begun, and stands.
        class.film.wind(1);
        Ok(class)
    }

    fn is_over(&self) -> bool {
        self.film.position == self.film.length().1
    }

    /// Takes a message of the terminal; whether it goes on.
    fn take(&mut self, message: Message) -> bool {
        self.tick();
        match update(&mut self.model, &self.film.session, message) {
            Some(Command::Quit) => return false,
            Some(Command::Input(Event::SignalShown { signal, .. })) => self.signal(signal),
            Some(Command::Start(_) | Command::Input(Event::TrialPaused | Event::TrialResumed)) => self.pause(),
            _ => {}
        }
        true
    }

    fn pause(&mut self) {
        self.at = Instant::now();
        if let Some(playback) = &mut self.model.playback {
            playback.playing = !playback.playing;
            let text = if playback.playing { "it runs" } else { "it stands" };
            self.model.say(Level::Done, text);
        }
    }

    /// Judges a signal, and says at once what it was.
    fn signal(&mut self, signal: Signal) {
        let session = &self.film.session;
        let (clock, press) = (session.trial_clock(self.now), session.presses[Agent::Human.index()]);
        let aspects = aspects_told(&session.kitchen, session.state, &signal);
        self.sent.push(Sent { clock, press, aspects, to_display_ms: None, taken_back: false });
        let words = words::signal(&signal);
        self.signals.push(JudgedSignal { press, clock_ns: clock, signal });
        let Some(worth) = worths(&self.sent, &self.spells).pop() else { return };
        let (level, text) = match worth {
            Worth::Hit { latency_s, .. } => (Level::Done, format!("hit: believed wrong for {latency_s:.1} s")),
            Worth::Again => (Level::Done, "told already".to_string()),
            Worth::Harmless => (Level::Done, "believed wrong, but it leads to no error".to_string()),
            Worth::Late => (Level::Refused, "late: it was seen to be right a moment ago".to_string()),
            Worth::WrongTarget => {
                (Level::Refused, format!("wrong: that is known; it is about {}", self.wrong_now(clock)))
            }
            Worth::Needless => (Level::Refused, "wrong: nothing is believed wrong".to_string()),
        };
        self.model.say(level, format!("{words}: {text}"));
    }

    /// What is believed wrong at a moment.
    fn wrong_now(&self, clock: SessionTime) -> String {
        let open = |spell: &&Spell| spell.began <= clock && spell.corrected.is_none_or(|(end, _)| clock < end);
        let kitchen = &self.film.session.kitchen;
        let names: Vec<String> = self.spells.iter().filter(open).map(|spell| name(kitchen, spell.aspect)).collect();
        names.join(", ")
    }

    fn tick(&mut self) {
        self.model.clock = SessionTime(self.opened.elapsed().as_nanos() as u64);
    }

    /// Moves on by the time that has passed, and says what was missed.
    fn play(&mut self) {
        let passed_s = self.at.elapsed().as_secs_f64();
        self.at = Instant::now();
        let Some(speed) = self.model.playback.as_ref().filter(|one| one.playing).map(|one| SPEEDS[one.speed]) else {
            return;
        };
        self.now = (self.now + SessionTime::from_secs_f64(passed_s * speed)).min(self.film.length().0);
        let until = self.film.until(self.now);
        while self.film.position < until {
            let Some(stamped) = self.film.forward() else { break };
            if let Event::Gaze(sample) = stamped.event {
                self.model.see(stamped.time, sample);
            }
        }
        self.tick();
        let clock = self.film.session.trial_clock(self.now);
        let hits = self.hits();
        for index in 0..self.spells.len() {
            let spell = &self.spells[index];
            let is_over = spell.corrected.is_some_and(|(end, _)| end <= clock);
            if is_over && spell.errors > 0 && !hits.contains(&index) && !self.told_missed[index] {
                self.told_missed[index] = true;
                let text =
                    format!("missed: {}, with {} errors", name(&self.film.session.kitchen, spell.aspect), spell.errors);
                self.model.say(Level::Refused, text);
            }
        }
    }

    /// The spells that were hit.
    fn hits(&self) -> Vec<usize> {
        let hit = |worth: Worth| if let Worth::Hit { spell, .. } = worth { Some(spell) } else { None };
        worths(&self.sent, &self.spells).into_iter().filter_map(hit).collect()
    }

    /// The measures so far: of the spells that have begun.
    fn measures(&self) -> WizardMeasures {
        let clock = self.film.session.trial_clock(self.now);
        let begun: Vec<Spell> = self.spells.iter().filter(|spell| spell.began <= clock).cloned().collect();
        WizardMeasures::of(&self.sent, Some(&begun))
    }

    fn draw(&mut self, screen: &mut Screen) -> io::Result<()> {
        if !screen.is_ready() {
            return Ok(());
        }
        self.tick();
        let measures = self.measures();
        let wrong = measures.wrong_targets.unwrap_or(0) + measures.needless.unwrap_or(0);
        let missed = self.told_missed.iter().filter(|&&told| told).count();
        let is_running = self.model.playback.as_ref().is_some_and(|playback| playback.playing);
        let key = if is_running { "" } else { "press . to start; " };
        let score = format!("{key}training: {} hit, {missed} missed, {wrong} wrong", measures.hits.unwrap_or(0));
        // The score stands where nothing else is said.
        if self.model.notice.as_ref().is_none_or(|notice| self.model.clock.secs_since(notice.at) > FEEDBACK_S) {
            self.model.say(Level::Done, score);
        }
        self.model.now = self.now;
        let (length, events) = self.film.length();
        let event = self.film.position;
        if let Some(playback) = &mut self.model.playback {
            *playback = Playback { length, event, events, ..playback.clone() };
        }
        screen.draw(&self.film.session, &self.model)
    }

    /// What is kept of it.
    fn judged(&self, before: &[TrainingRecord]) -> JudgedRecording {
        let mut judged = JudgedRecording {
            recording: self.name.clone(),
            complete: self.is_over(),
            presses: self.film.session.presses[Agent::Human.index()],
            signals: self.signals.clone(),
            measures: self.measures(),
            kappa_with_oneself: None,
        };
        let earlier = before.iter().rev().flat_map(|record| &record.recordings);
        let earlier = earlier.filter(|one| one.recording == judged.recording && one.complete && judged.complete);
        let kitchen = &self.film.session.kitchen;
        judged.kappa_with_oneself = earlier.take(1).find_map(|one| with_oneself(kitchen, one, &judged));
        judged
    }
}

/// Kappa of two times that the same recording was watched.
fn with_oneself(kitchen: &Kitchen, one: &JudgedRecording, other: &JudgedRecording) -> Option<f64> {
    let said = |signal: &JudgedSignal| {
        let kind = match signal.signal {
            Signal::ShowRecipe(_) => Kind::Recipe,
            Signal::Highlight(_) => Kind::Highlight,
        };
        let content = Content { kind, target: kitchen.location_named(signal.signal.target()) };
        Said { press: signal.press, clock: signal.clock_ns, content }
    };
    let [one, again] = [one, other].map(|time| time.signals.iter().map(said).collect::<Vec<Said>>());
    let mut tally = Tally::default();
    tally.add(&one, &again, other.presses, WINDOW);
    tally.similarity().kappa
}

fn name(kitchen: &Kitchen, aspect: AspectId) -> String {
    kitchen.aspects[aspect.index()].name.replace('_', " ")
}

/// What came of it, for people.
pub fn describe(record: &TrainingRecord, path: &Path) -> String {
    let mut text = String::new();
    for one in &record.recordings {
        let measures = &one.measures;
        let latency =
            measures.latency_s.map_or(String::new(), |times| format!(" after {:.1} s in the median", times.median));
        let wrong = measures.wrong_targets.unwrap_or(0) + measures.needless.unwrap_or(0);
        let kappa =
            one.kappa_with_oneself.map_or(String::new(), |kappa| format!("; kappa with the time before {kappa:.2}"));
        let cut = if one.complete { "" } else { " (left before its end)" };
        text += &format!(
            "{}{cut}: {} of {} hit{latency}, {wrong} of {} signals wrong{kappa}\n",
            one.recording,
            measures.hits.unwrap_or(0),
            measures.episodes.unwrap_or(0),
            measures.signals,
        );
    }
    let met = if record.met { "met" } else { "not met" };
    text += &format!(
        "criterion {met}: at least {:.0} % hit, at most {:.0} % of the signals wrong; {:.1} minutes\nrecorded in {}\n",
        100.0 * record.criterion.hits,
        100.0 * record.criterion.wrong,
        record.minutes,
        path.display()
    );
    text
}
