//! The training console: a wizard sends signals while a recording is played; the program compares each signal with the
//! known false beliefs and gives immediate feedback.

use std::time::Instant;

use super::error::{ReviewError, TerminalError};
use super::event_loop::{ConsoleShell, LoopEvent, ShellView};
use super::leaving::LeavingReason;
use super::operator_station::OperatorStation;
use super::seekable_replay::SeekableReplay;
use crate::console::console_model::{Dialog, NoticeLevel, Playback, SPEEDS, TrainingFeedback, TrainingPanel};
use crate::console::{ConsoleCommand, ConsoleMessage, ConsoleModel, KeyBindings, update};
use crate::run::key_file::key_map;
use crate::run::terminal::{TerminalScreen, theme};
use tomcom_core::base::text::count;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::recommendation::aspects_told;
use tomcom_core::kitchen::{Agent, AspectId, Kitchen};
use tomcom_core::measures::wizard_performance::{
    FalseBeliefPeriod, SignalVerdict, TrainingCriterion, WizardMeasures, WizardSignal, verdicts,
};
use tomcom_core::mind::RecordedBelief;
use tomcom_session::event::SignalEndReason;
use tomcom_session::history::wording;
use tomcom_session::{Event, TimestampedEvent, apply};
use tomcom_study::analysis::lesson_report;
use tomcom_study::analysis::lesson_report::{HarmfulFalseBelief, JudgedSignal, WatchedRecording, WizardTrainingRecord};

/// The training console for one recording.
pub(super) struct TrainingShell {
    film: SeekableReplay,
    name: String,
    periods: Vec<FalseBeliefPeriod>,
    /// Periods of false belief in the recording that led to errors, with the judgement of the wizard's signals.
    beliefs: Vec<HarmfulFalseBelief>,
    criterion: TrainingCriterion,
    model: ConsoleModel,
    sent: Vec<WizardSignal>,
    signals: Vec<JudgedSignal>,
    /// Whether the final score of the recording has been shown.
    concluded: bool,
    /// For each period of false belief, whether the wizard was told that no signal corrected it.
    told_missed: Vec<bool>,
    now: SessionTime,
    opened: Instant,
    at: Instant,
}

impl TrainingShell {
    /// The training console before its first frame; `speed` is an index into [`SPEEDS`].
    ///
    /// # Errors
    /// Key bindings of the recording are not valid for its kitchen any more, or the terminal was closed.
    pub fn new(
        film: SeekableReplay,
        periods: Vec<FalseBeliefPeriod>,
        name: String,
        criterion: TrainingCriterion,
        speed: usize,
        station: &OperatorStation,
    ) -> Result<TrainingShell, ReviewError> {
        let spec = &film.session.spec;
        let keys =
            KeyBindings::training(&film.session.kitchen, spec, &key_map(film.replay.log().header.keys.as_ref())?)?;
        let size = TerminalScreen::size().map_err(TerminalError)?;
        let mut model = ConsoleModel::new(keys, theme(&spec.console, station.screen.ground), size);
        model.playback = Some(Playback { speed, ..Playback::new(name.clone()) });
        model.lesson = Some(TrainingPanel { task: lesson_report::task(&criterion), ..Default::default() });
        let beliefs = periods.iter().map(|period| lesson_report::unheard(&film.session, period)).collect();
        let (now, told_missed) = (Instant::now(), vec![false; periods.len()]);
        let mut shell = TrainingShell {
            film,
            name,
            periods,
            beliefs,
            criterion,
            model,
            sent: Vec::new(),
            signals: Vec::new(),
            concluded: false,
            told_missed,
            now: SessionTime::ZERO,
            opened: now,
            at: now,
        };
        // The replay is paused at the start of the trial until the wizard begins.
        let start = shell.film.trial_start();
        shell.film.wind(start);
        shell.now = shell.film.session.time;
        Ok(shell)
    }

    fn is_over(&self) -> bool {
        self.film.position == self.film.length().1
    }

    /// Whether the recording is finished and the wizard has closed the final score.
    fn is_done(&self) -> bool {
        self.concluded && self.model.dialog.is_none()
    }

    /// Shows the final score of the recording once.
    fn conclude(&mut self) {
        if self.is_over() && !self.concluded {
            self.concluded = true;
            let judged = self.judged(&[]);
            let lines = lesson_report::lines(&[&judged], &self.criterion);
            (self.model.dialog, self.model.help_from) = (Some(Dialog::Report(lines)), 0);
        }
    }

    /// Handles a message from the terminal; returns how the wizard leaves the recording, if the message leaves it.
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
            let text = if playback.playing { "the recording plays" } else { "the recording is paused" };
            self.model.say(NoticeLevel::Done, text);
            if let Some(lesson) = &mut self.model.lesson {
                lesson.begun = true;
            }
        }
    }

    /// Adds a line of feedback on a signal, or on a false belief that was missed.
    fn tell(&mut self, level: NoticeLevel, text: String) {
        let clock = self.film.session.trial_clock(self.now);
        if let Some(lesson) = &mut self.model.lesson {
            lesson.feedback.push(TrainingFeedback { clock, level, text });
        }
        self.model.notice = None;
    }

    /// Shows a signal of the wizard on the timeline and as the participant would see it. Impossible signals are
    /// ignored.
    fn show(&mut self, event: Event) {
        let shown =
            TimestampedEvent { seq: self.film.position as u64, time: self.now.max(self.film.session.time), event };
        let _ = apply(&mut self.film.session, &shown);
    }

    /// Judges a signal of the wizard and gives feedback on the signal.
    fn signal(&mut self, shown: Event) {
        let Event::SignalShown { signal, .. } = &shown else { return };
        if !self.model.playback.as_ref().is_some_and(|playback| playback.playing) {
            self.model.say(NoticeLevel::Refused, "signal not counted: the recording is paused; . plays it");
            return;
        }
        let signal = signal.clone();
        let session = &self.film.session;
        let (clock, press) = (session.trial_clock(self.now), session.presses[Agent::Human.index()]);
        let aspects = aspects_told(&session.kitchen, session.state, &signal);
        self.sent.push(WizardSignal { clock, press, aspects, to_display_ms: None, taken_back: false });
        let words = wording::signal(&signal);
        let Some(verdict) = verdicts(&self.sent, &self.periods).pop() else { return };
        self.signals.push(JudgedSignal { press, clock_ns: clock, signal, worth: verdict.name().to_string() });
        self.show(shown);
        use NoticeLevel::{Done, Refused};
        let (level, text) = match verdict {
            SignalVerdict::Hit { latency_s, .. } => {
                (Done, format!("hit: the belief has been false for {latency_s:.1} s"))
            }
            SignalVerdict::Repeated => (Done, "repeated: a signal already told this".to_string()),
            SignalVerdict::Harmless => (Done, "harmless: the belief is false, but leads to no error".to_string()),
            SignalVerdict::Late => (Refused, "late: the false belief was corrected a moment ago".to_string()),
            SignalVerdict::Wrong => (Refused, format!("wrong: the false belief is about {}", self.wrong_now(clock))),
            SignalVerdict::Needless => (Refused, "needless: no belief is false now".to_string()),
        };
        self.tell(level, format!("{words}: {text}"));
    }

    /// The false beliefs that the participant has at a time of the trial's clock, as text.
    fn wrong_now(&self, clock: SessionTime) -> String {
        let kitchen = &self.film.session.kitchen;
        let open = self.periods.iter().filter(|period| period.holds(clock));
        let names: Vec<String> = open.map(|period| name(kitchen, period.aspect)).collect();
        names.join(", ")
    }

    fn tick(&mut self) {
        self.model.clock = SessionTime(self.opened.elapsed().as_nanos() as u64);
    }

    /// Advances the replay by the time that has passed, and reports false beliefs that no signal corrected.
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
                Event::ParticipantBelieves(witness) => self.note_belief(&witness),
                _ => {}
            }
        }
        self.tick();
        if self.film.session.shown.as_ref().is_some_and(|shown| shown.until <= self.now) {
            self.show(Event::SignalEnded { reason: SignalEndReason::Elapsed });
        }
        self.say_missed();
    }

    /// Updates the present false beliefs from a recorded belief of the participant.
    fn note_belief(&mut self, witness: &RecordedBelief) {
        let session = &self.film.session;
        let clock = session.trial_clock(session.time);
        let open = self.periods.iter().zip(&mut self.beliefs).filter(|(period, _)| period.holds(clock));
        open.for_each(|(period, belief)| lesson_report::hear(belief, session, period.aspect, witness));
    }

    fn say_missed(&mut self) {
        let clock = self.film.session.trial_clock(self.now);
        let hits = self.hits();
        for index in 0..self.periods.len() {
            let period = &self.periods[index];
            let is_over = period.corrected.is_some_and(|(end, _)| end <= clock);
            if is_over && period.errors > 0 && !hits.contains(&index) && !self.told_missed[index] {
                self.told_missed[index] = true;
                let errors = count(period.errors, "error", "errors");
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

    /// Indices of the periods of false belief that the wizard's signals hit.
    fn hits(&self) -> Vec<usize> {
        let hit =
            |verdict: SignalVerdict| if let SignalVerdict::Hit { period, .. } = verdict { Some(period) } else { None };
        verdicts(&self.sent, &self.periods).into_iter().filter_map(hit).collect()
    }

    /// The wizard's performance on the periods of false belief that have begun.
    fn measures(&self) -> WizardMeasures {
        let clock = self.film.session.trial_clock(self.now);
        let begun: Vec<FalseBeliefPeriod> =
            self.periods.iter().filter(|period| period.began <= clock).cloned().collect();
        WizardMeasures::from_signals(&self.sent, Some(&begun))
    }

    /// The false beliefs that led to errors and have begun so far.
    fn judged_beliefs(&self) -> Vec<HarmfulFalseBelief> {
        let clock = self.film.session.trial_clock(self.now);
        let verdicts = verdicts(&self.sent, &self.periods);
        let hit_by = |index: usize| {
            verdicts.iter().position(|verdict| matches!(verdict, SignalVerdict::Hit { period, .. } if *period == index))
        };
        let begun = self.periods.iter().enumerate().filter(|(_, period)| period.errors > 0 && period.began <= clock);
        begun.map(|(index, _)| HarmfulFalseBelief { hit_by: hit_by(index), ..self.beliefs[index].clone() }).collect()
    }

    /// The training record's entry for this recording; `before` are the wizard's earlier training records.
    pub fn judged(&self, before: &[WizardTrainingRecord]) -> WatchedRecording {
        let mut judged = WatchedRecording {
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

impl ConsoleShell for TrainingShell {
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
        let wrong = measures.wrong_or_needless().unwrap_or(0);
        let missed = self.told_missed.iter().filter(|&&told| told).count();
        if let Some(lesson) = &mut self.model.lesson {
            lesson.score = format!("{} hit, {missed} missed, {wrong} wrong or needless", measures.hits.unwrap_or(0));
        }
        self.model.now = self.now;
        let ((_, events), trial_length) = (self.film.length(), self.film.trial_length());
        let event = self.film.position;
        if let Some(playback) = &mut self.model.playback {
            *playback = Playback { trial_length, event, events, ..playback.clone() };
        }
    }

    fn view(&self) -> ShellView<'_> {
        ShellView::Console(&self.film.session, &self.model)
    }
}

fn name(kitchen: &Kitchen, aspect: AspectId) -> String {
    kitchen.aspects[aspect.index()].name.replace('_', " ")
}
