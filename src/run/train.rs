//! `tomcom train`: a wizard watches recordings in which it is known what was believed wrong, sends signals by the keys of a
//! session, and is told at once what each was; at the end there is a score, held against a criterion. Nothing reaches the
//! participant in the recording.

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::desk::OperatorDesk;
use super::error::{ReviewError, TerminalError};
use super::event_loop::{self, ConsoleShell, LoopEvent, ShellView};
use super::leaving::LeavingReason;
use super::lesson_report;
use super::seekable_replay::SeekableReplay;
use crate::analysis::wizard_log::spells;
use crate::base::time::SessionTime;
use crate::base::words::count;
use crate::communication::recommendation::aspects_told;
use crate::console::lesson::TrainingFeedback;
use crate::console::model::Dialog;
use crate::console::notice::NoticeLevel;
use crate::console::playback::{Playback, SPEEDS};
use crate::console::{self, ConsoleCommand, ConsoleMessage, ConsoleModel, KeyBindings, update};
use crate::edge::clock::WallTime;
use crate::edge::file_error::{FileError, FileResult};
use crate::edge::key_file::key_map;
use crate::edge::terminal::{TerminalScreen, theme};
use crate::edge::training::{self, JudgedBelief, JudgedRecording, JudgedSignal, TrainingRecord};
use crate::history::wording;
use crate::kitchen::{Agent, AspectId, Kitchen};
use crate::measures::wizard::{
    FalseBeliefPeriod, SignalVerdict, TrainingCriterion, WizardMeasures, WizardSignal, worths,
};
use crate::mind::BeliefWitness;
use crate::session::event::SignalEnd;
use crate::session::settings::{Condition, Visibility};
use crate::session::{Event, Stamped, apply};

/// What is trained.
#[derive(Clone, Debug)]
pub struct TrainingRequest {
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
pub fn train(lesson: &TrainingRequest) -> Result<(TrainingRecord, PathBuf), ReviewError> {
    let before = training::read(&lesson.out, &lesson.wizard)?;
    let films: Vec<(SeekableReplay, Vec<FalseBeliefPeriod>)> =
        lesson.recordings.iter().map(|one| open(one)).collect::<FileResult<_>>()?;
    let at = WallTime::now().rfc3339();
    let began = Instant::now();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(TerminalError)?;
    let recordings = runtime.block_on(watch(lesson, films, &before))?;
    let minutes = (began.elapsed().as_secs_f64() / 0.6).round() / 100.0;
    let is_complete = recordings.len() == lesson.recordings.len() && recordings.iter().all(|one| one.complete);
    let met = is_complete && lesson.criterion.is_met(&WizardMeasures::sum(recordings.iter().map(|one| &one.measures)));
    let (wizard, criterion, speed) = (lesson.wizard.clone(), lesson.criterion, Some(SPEEDS[lesson.speed]));
    let record = TrainingRecord { wizard, at, minutes, speed, criterion, met, recordings };
    let path = training::write(&lesson.out, &record)
        .map_err(|reason| ReviewError::Training { path: lesson.out.clone(), reason })?;
    Ok((record, path))
}

/// A recording with what was believed wrong in it.
fn open(recording: &Path) -> FileResult<(SeekableReplay, Vec<FalseBeliefPeriod>)> {
    let mut film = SeekableReplay::open(recording)?;
    let unfit = |found: &str| {
        let remedy = "a recording of a simulated participant without signals (tomcom simulate SESSION)".to_string();
        FileError::from_finding(recording, found.to_string(), remedy)
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
    lesson: &TrainingRequest,
    films: Vec<(SeekableReplay, Vec<FalseBeliefPeriod>)>,
    before: &[TrainingRecord],
) -> Result<Vec<JudgedRecording>, ReviewError> {
    let mut judged = Vec::new();
    let mut desk = None;
    for ((film, spells), recording) in films.into_iter().zip(&lesson.recordings) {
        let desk = match &mut desk {
            Some(desk) => desk,
            none => none.insert(OperatorDesk::without_devices(&film.session.spec.console)?),
        };
        let mut class = Class::new(film, spells, name_of(recording, lesson), lesson, desk)?;
        let left = event_loop::run(&mut class, desk).await?;
        judged.push(class.judged(before));
        if left != Some(LeavingReason::Next) {
            break;
        }
    }
    Ok(judged)
}

/// What a recording is called in the records: those that were simulated for the training by their length, too.
fn name_of(recording: &Path, lesson: &TrainingRequest) -> String {
    let simulated = recording.strip_prefix(lesson.out.join("recordings")).ok();
    let name = simulated.or(recording.file_name().map(Path::new)).unwrap_or(recording);
    name.display().to_string()
}

/// A recording that is watched.
struct Class {
    film: SeekableReplay,
    name: String,
    spells: Vec<FalseBeliefPeriod>,
    /// What is known of each of them.
    beliefs: Vec<JudgedBelief>,
    criterion: TrainingCriterion,
    model: ConsoleModel,
    sent: Vec<WizardSignal>,
    signals: Vec<JudgedSignal>,
    /// What came of it was shown.
    concluded: bool,
    /// Of each spell, whether it was said that it was missed.
    told_missed: Vec<bool>,
    now: SessionTime,
    opened: Instant,
    at: Instant,
}

impl Class {
    fn new(
        film: SeekableReplay,
        spells: Vec<FalseBeliefPeriod>,
        name: String,
        lesson: &TrainingRequest,
        desk: &OperatorDesk,
    ) -> Result<Class, ReviewError> {
        let spec = &film.session.spec;
        let keys =
            KeyBindings::training(&film.session.kitchen, spec, &key_map(film.replay.log().header.keys.as_ref())?)?;
        let size = TerminalScreen::size().map_err(TerminalError)?;
        let mut model = ConsoleModel::new(keys, theme(&spec.console, desk.screen.ground), size);
        model.playback = Some(Playback { speed: lesson.speed, ..Playback::new(name.clone()) });
        model.lesson =
            Some(console::lesson::TrainingPanel { task: lesson_report::task(&lesson.criterion), ..Default::default() });
        let beliefs = spells.iter().map(|spell| lesson_report::unheard(&film.session, spell)).collect();
        let (now, told_missed) = (Instant::now(), vec![false; spells.len()]);
        let mut class = Class {
            film,
            name,
            spells,
            beliefs,
            criterion: lesson.criterion,
            model,
            sent: Vec::new(),
            signals: Vec::new(),
            concluded: false,
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

    /// Whether it is over, and what came of it was read.
    fn is_done(&self) -> bool {
        self.concluded && self.model.dialog.is_none()
    }

    /// Shows what came of it, once.
    fn conclude(&mut self) {
        if self.is_over() && !self.concluded {
            self.concluded = true;
            let judged = self.judged(&[]);
            let lines = lesson_report::lines(&[&judged], &self.criterion);
            (self.model.dialog, self.model.help_from) = (Some(Dialog::Report(lines)), 0);
        }
    }

    /// Takes a message of the terminal; how the recording is left, if that follows from it.
    fn take_message(&mut self, message: ConsoleMessage) -> Option<LeavingReason> {
        self.tick();
        self.model.now = self.now;
        match update(&mut self.model, &self.film.session, message) {
            Some(ConsoleCommand::Quit) => return Some(LeavingReason::Quit),
            Some(ConsoleCommand::Input(shown @ Event::SignalShown { .. })) => self.signal(shown),
            Some(ConsoleCommand::Start(_) | ConsoleCommand::Input(Event::TrialPaused | Event::TrialResumed)) => {
                self.pause()
            }
            _ => {}
        }
        self.is_done().then_some(LeavingReason::Next)
    }

    fn pause(&mut self) {
        self.at = Instant::now();
        if let Some(playback) = &mut self.model.playback {
            playback.playing = !playback.playing;
            let text = if playback.playing { "it runs" } else { "it stands" };
            self.model.say(NoticeLevel::Done, text);
            if let Some(lesson) = &mut self.model.lesson {
                lesson.begun = true;
            }
        }
    }

    /// Says what a signal was, or what was missed; it can be looked back on.
    fn tell(&mut self, level: NoticeLevel, text: String) {
        let clock = self.film.session.trial_clock(self.now);
        if let Some(lesson) = &mut self.model.lesson {
            lesson.feedback.push(TrainingFeedback { clock, level, text });
        }
        self.model.notice = None;
    }

    /// Shows a signal as a session does, on the timeline and as what the participant would see. Nobody sees it: so what
    /// cannot be is left out.
    fn show(&mut self, event: Event) {
        let shown = Stamped { seq: self.film.position as u64, time: self.now.max(self.film.session.time), event };
        let _ = apply(&mut self.film.session, &shown);
    }

    /// Judges a signal, and says at once what it was.
    fn signal(&mut self, shown: Event) {
        let Event::SignalShown { signal, .. } = &shown else { return };
        let signal = signal.clone();
        let session = &self.film.session;
        let (clock, press) = (session.trial_clock(self.now), session.presses[Agent::Human.index()]);
        let aspects = aspects_told(&session.kitchen, session.state, &signal);
        self.sent.push(WizardSignal { clock, press, aspects, to_display_ms: None, taken_back: false });
        let words = wording::signal(&signal);
        let Some(worth) = worths(&self.sent, &self.spells).pop() else { return };
        self.signals.push(JudgedSignal { press, clock_ns: clock, signal, worth: worth.name().to_string() });
        self.show(shown);
        let (level, text) = match worth {
            SignalVerdict::Hit { latency_s, .. } => {
                (NoticeLevel::Done, format!("hit: believed wrong for {latency_s:.1} s"))
            }
            SignalVerdict::Again => (NoticeLevel::Done, "told already".to_string()),
            SignalVerdict::Harmless => (NoticeLevel::Done, "believed wrong, but it leads to no error".to_string()),
            SignalVerdict::Late => (NoticeLevel::Refused, "late: it was seen to be right a moment ago".to_string()),
            SignalVerdict::WrongTarget => {
                (NoticeLevel::Refused, format!("wrong: that is known; it is about {}", self.wrong_now(clock)))
            }
            SignalVerdict::Needless => (NoticeLevel::Refused, "wrong: nothing is believed wrong".to_string()),
        };
        self.tell(level, format!("{words}: {text}"));
    }

    /// What is believed wrong at a moment.
    fn wrong_now(&self, clock: SessionTime) -> String {
        let kitchen = &self.film.session.kitchen;
        let open = self.spells.iter().filter(|spell| spell.holds(clock));
        let names: Vec<String> = open.map(|spell| name(kitchen, spell.aspect)).collect();
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
            match stamped.event.clone() {
                Event::Gaze(sample) => {
                    let time = stamped.time;
                    self.model.see(time, sample);
                }
                Event::ParticipantBelieves(witness) => self.hear(&witness),
                _ => {}
            }
        }
        self.tick();
        if self.film.session.shown.as_ref().is_some_and(|shown| shown.until <= self.now) {
            self.show(Event::SignalEnded { reason: SignalEnd::Elapsed });
        }
        self.say_missed();
    }

    /// Takes over what is believed wrong now.
    fn hear(&mut self, witness: &BeliefWitness) {
        let session = &self.film.session;
        let clock = session.trial_clock(session.time);
        let open = self.spells.iter().zip(&mut self.beliefs).filter(|(spell, _)| spell.holds(clock));
        open.for_each(|(spell, belief)| lesson_report::hear(belief, session, spell.aspect, witness));
    }

    fn say_missed(&mut self) {
        let clock = self.film.session.trial_clock(self.now);
        let hits = self.hits();
        for index in 0..self.spells.len() {
            let spell = &self.spells[index];
            let is_over = spell.corrected.is_some_and(|(end, _)| end <= clock);
            if is_over && spell.errors > 0 && !hits.contains(&index) && !self.told_missed[index] {
                self.told_missed[index] = true;
                let errors = count(spell.errors, "error", "errors");
                let belief = &self.beliefs[index];
                let text = format!(
                    "missed, with {errors}: {}; {}",
                    lesson_report::about(belief),
                    lesson_report::right(belief)
                );
                self.tell(NoticeLevel::Refused, text);
            }
        }
    }

    /// The spells that were hit.
    fn hits(&self) -> Vec<usize> {
        let hit = |worth: SignalVerdict| if let SignalVerdict::Hit { spell, .. } = worth { Some(spell) } else { None };
        worths(&self.sent, &self.spells).into_iter().filter_map(hit).collect()
    }

    /// The measures so far: of the spells that have begun.
    fn measures(&self) -> WizardMeasures {
        let clock = self.film.session.trial_clock(self.now);
        let begun: Vec<FalseBeliefPeriod> = self.spells.iter().filter(|spell| spell.began <= clock).cloned().collect();
        WizardMeasures::from_signals(&self.sent, Some(&begun))
    }

    /// The false beliefs that led to errors, as far as they have begun.
    fn judged_beliefs(&self) -> Vec<JudgedBelief> {
        let clock = self.film.session.trial_clock(self.now);
        let worths = worths(&self.sent, &self.spells);
        let hit_by = |index: usize| {
            worths.iter().position(|worth| matches!(worth, SignalVerdict::Hit { spell, .. } if *spell == index))
        };
        let begun = self.spells.iter().enumerate().filter(|(_, spell)| spell.errors > 0 && spell.began <= clock);
        begun.map(|(index, _)| JudgedBelief { hit_by: hit_by(index), ..self.beliefs[index].clone() }).collect()
    }

    /// What is kept of it.
    fn judged(&self, before: &[TrainingRecord]) -> JudgedRecording {
        let mut judged = JudgedRecording {
            recording: self.name.clone(),
            complete: self.is_over(),
            presses: self.film.session.presses[Agent::Human.index()],
            signals: self.signals.clone(),
            beliefs: self.judged_beliefs(),
            measures: self.measures(),
            kappa_with_oneself: None,
        };
        let earlier = before.iter().rev().flat_map(|record| &record.recordings);
        let earlier = earlier.filter(|one| one.recording == judged.recording && one.complete && judged.complete);
        let kitchen = &self.film.session.kitchen;
        judged.kappa_with_oneself = earlier.take(1).find_map(|one| lesson_report::with_oneself(kitchen, one, &judged));
        judged
    }
}

impl ConsoleShell for Class {
    type Outcome = LeavingReason;
    type Error = ReviewError;

    fn take(&mut self, event: LoopEvent) -> Result<Option<LeavingReason>, ReviewError> {
        Ok(match event {
            LoopEvent::Terminal(message) => self.take_message(message),
            _ => None,
        })
    }

    fn advance(&mut self) -> bool {
        self.play();
        self.conclude();
        true
    }

    fn prepare(&mut self) {
        self.tick();
        let measures = self.measures();
        let wrong = measures.wrong_targets.unwrap_or(0) + measures.needless.unwrap_or(0);
        let missed = self.told_missed.iter().filter(|&&told| told).count();
        if let Some(lesson) = &mut self.model.lesson {
            lesson.score = format!("{} hit, {missed} missed, {wrong} wrong", measures.hits.unwrap_or(0));
        }
        self.model.now = self.now;
        let (length, events) = self.film.length();
        let event = self.film.position;
        if let Some(playback) = &mut self.model.playback {
            *playback = Playback { length, event, events, ..playback.clone() };
        }
    }

    fn view(&self) -> ShellView<'_> {
        ShellView::Console(&self.film.session, &self.model)
    }
}

fn name(kitchen: &Kitchen, aspect: AspectId) -> String {
    kitchen.aspects[aspect.index()].name.replace('_', " ")
}
