//! Recording of events in the log, their distribution to viewers, comparison and tracker, and handling of write errors.

use super::live_session::Live;
use super::lsl_streaming::LslStreaming;
use super::viewing::StreamedSession;
use crate::console::console_model::{NoticeLevel, RecordingStatus};
use crate::run::doctor::free_bytes;
use tomcom_core::robot::ArmStage;
use tomcom_session::film::FilmEvent;
use tomcom_session::history::belief_track::{self, BeliefSnapshot};
use tomcom_session::history::error_reasons::ExplainedError;
use tomcom_session::history::event_words;
use tomcom_session::log::{LogWriter, RecordingWriteError};
use tomcom_session::probes::ProbeEvent;
use tomcom_session::settings::BellOccasion;
use tomcom_session::wizard_log::WizardSummary;
use tomcom_session::{Event, TimestampedEvent, TrialPhase};

impl Live {
    /// Writes events to the log. If writing fails, the session ends, since it would have no data.
    pub(super) fn record(&mut self, events: &[TimestampedEvent]) {
        self.dirty = true;
        let mut lost = Vec::new();
        for stamped in events {
            match stamped.event {
                Event::Gaze(sample) => self.model.see(stamped.time, self.engine.session().corrected(sample)),
                Event::SignalShown { .. } => self.undrawn = Some(stamped.seq),
                Event::OfferOpened(ref advice) if advice.visible => self.ring(BellOccasion::Offer),
                Event::RobotSafety { mode, force_n, joint } if mode.has_stopped_itself() => {
                    self.model.say(NoticeLevel::Alarm, event_words::arm_stopped(mode, force_n, joint));
                }
                Event::RobotStage { stage, ref found } => self.tell_arm_stage(stage, found),
                Event::External(ref event) => {
                    if let Some(words) = event.words() {
                        self.model.warn(words);
                    }
                }
                Event::Probe(ref event @ (ProbeEvent::Delayed { .. } | ProbeEvent::Dropped { .. })) => {
                    self.model.warn(event_words::probe(event));
                }
                _ => {}
            }
            self.tell_arm(&stamped.event);
            self.capture.tell(&stamped.event, self.clock.instant_of(stamped.time));
            lost.extend(self.filming.tell(&stamped.event));
            if let Some(comparison) = &self.comparison {
                comparison.tell(stamped);
            }
            self.write_log(|log| log.append(stamped));
        }
        self.order_arm();
        self.show_participant();
        if let Some(last) = events.last() {
            let by_gaze = events.iter().all(|stamped| stamped.event.is_sample());
            let session = self.engine.session();
            let moment = BeliefSnapshot::new(&session.kitchen, session.state, self.engine.belief(), last.time, by_gaze);
            if let Some(lsl) = &mut self.lsl {
                lsl.tell(events, &self.engine, &moment, &self.clock);
            }
            self.model.belief.note(moment);
            self.model.belief.forget(session, last.time, belief_track::SHOWN_S);
            if matches!(session.phase, TrialPhase::Over(_)) {
                self.model.wizard = WizardSummary::from_follower(self.engine.follower()).measures;
            }
        }
        let mut told = Vec::new();
        for question in self.engine.take_questions() {
            if let Some(advisor) = &mut self.advisor {
                told.extend(advisor.ask(question));
            }
        }
        let judged = self.engine.judged();
        self.model.errors.extend(ExplainedError::among(self.engine.session(), &judged[self.judged..]));
        self.model.unproven += judged[self.judged..].iter().filter(|press| !press.verdict.is_proven).count() as u64;
        self.judged = judged.len();
        if let Some(viewing) = &mut self.viewing {
            viewing.view(events, &self.engine);
        }
        told.into_iter().for_each(|event| self.input(event));
        self.record_films(lost);
        self.ask_participant();
    }

    /// Tells the wizard how far a real arm is.
    fn tell_arm_stage(&mut self, stage: ArmStage, found: &str) {
        let words = format!("arm: {}", event_words::arm_stage(stage, found));
        let has_begun = matches!(self.engine.session().phase, TrialPhase::Running | TrialPhase::Paused);
        match stage {
            ArmStage::Lost | ArmStage::Off | ArmStage::Stopped if has_begun => {
                self.model.say(NoticeLevel::Alarm, words);
            }
            _ => self.model.say(NoticeLevel::Done, words),
        }
    }

    /// Records what happened to films; the wizard is warned of lost ones.
    pub(super) fn record_films(&mut self, news: Vec<FilmEvent>) {
        for event in news {
            if matches!(event, FilmEvent::Lost { .. }) {
                self.model.warn(event.words());
                self.ring(BellOccasion::Film);
            }
            self.input(Event::Film(event));
        }
    }

    /// Has the terminal ring with the next frame, if the session asks for that.
    pub(super) fn ring(&mut self, occasion: BellOccasion) {
        self.model.rings |= self.engine.session().spec.console.bell.contains(&occasion);
    }

    /// Rings if gaze or page were there when the recording was last watched, and are lost now in a running trial.
    fn watch_for_bell(&mut self) {
        let session = self.engine.session();
        let gaze = session.gaze_hz(self.clock.now()).is_some();
        let page = self.model.display.as_ref().is_some_and(|display| display.page.is_some());
        let (was_gaze, was_page) = std::mem::replace(&mut self.watched, (gaze, page));
        let runs = session.is_running();
        for (is_lost, occasion) in [(was_gaze && !gaze, BellOccasion::Gaze), (was_page && !page, BellOccasion::Display)]
        {
            if is_lost && runs {
                self.ring(occasion);
            }
        }
    }

    /// Flushes the log, moves the robot's hand on the participant's display, and repeats the order for a real arm.
    pub(super) fn flush(&mut self) {
        self.order_arm();
        self.move_robot();
        self.flush_log();
    }

    pub(super) fn flush_log(&mut self) {
        self.write_log(LogWriter::flush);
    }

    /// Writes to the log. On a full disk the stream's file is given up first, since it can be made from the log; only if
    /// the log cannot be written even then, the session ends.
    fn write_log(&mut self, write: impl FnOnce(&mut LogWriter) -> Result<(), RecordingWriteError>) {
        if self.failed.is_some() {
            return;
        }
        let mut written = write(&mut self.log);
        if written.as_ref().is_err_and(RecordingWriteError::is_disk_full)
            && self.viewing.as_mut().is_some_and(|viewing| viewing.give_up_file())
        {
            written = self.log.flush();
            let text =
                "the disk is full: the Rerun stream's file was deleted to make room for the log; free some space";
            self.model.say(NoticeLevel::Alarm, text);
        }
        if let Err(error) = written {
            self.fail(error);
        }
    }

    /// Checks that the recording is still in place, and whether the computer's clock jumped.
    pub(super) fn watch(&mut self) {
        self.examine_display();
        self.pause_without_page();
        self.watch_for_bell();
        let films = self.filming.news(self.clock.now());
        if self.engine.session().phase != TrialPhase::Closed {
            self.record_films(films);
        }
        self.model.films = self.filming.status();
        if let Some(by_ms) = self.clock.jump() {
            self.input(Event::ClockJumped { by_ms });
            let ahead_s = by_ms as f64 / 1000.0;
            let text =
                format!("session time lost {ahead_s:.1} s: the program stood still, or the computer's clock was set");
            self.model.say(NoticeLevel::Alarm, text);
        }
        self.model.viewers = self.viewing.as_ref().map(StreamedSession::status);
        if let Some(complaint) = self.lsl.as_mut().and_then(LslStreaming::complaint) {
            self.model.warn(complaint);
            self.dirty = true;
        }
        self.model.lsl = self.lsl.as_ref().map(LslStreaming::status);
        if let Some(drops) = self.gaze.drops(self.engine.session()) {
            self.input(drops);
        }
        if self.engine.session().phase == TrialPhase::Ready {
            self.model.free_bytes = free_bytes(self.log.folder()).ok();
            self.filming.examine();
        }
        self.check_log(false);
    }

    /// Checks that the log file is in place and undamaged: a part of it, or the whole file.
    pub(super) fn check_log(&mut self, whole: bool) {
        if self.failed.is_none()
            && let Err(error) = self.log.check(whole)
        {
            self.fail(error);
        }
    }

    /// Handles a log that cannot be written: alarm, robot stop, end of the session. The console stays open until the
    /// wizard leaves it.
    pub(super) fn fail(&mut self, error: RecordingWriteError) {
        let (reason, saved) = match &error {
            RecordingWriteError::Unwritable { reason, saved, .. } => (reason.to_string(), saved.clone()),
            RecordingWriteError::Damaged { found, saved, .. } => (format!("the log {found}"), saved.clone()),
            error => (error.to_string(), None),
        };
        let saved = saved.map_or(String::new(), |saved| format!(", saved in {}", saved.display()));
        self.model.recording = RecordingStatus::Lost;
        self.model.say(NoticeLevel::Alarm, format!("session over, the recording ends here: {reason}{saved}"));
        self.failed = Some(error);
        self.dirty = true;
        self.tell_arm(&Event::RobotStopped);
        for event in [Event::RobotStopped, Event::SessionEnded] {
            // The result is ignored: events after the failure cannot be recorded, and a robot that is stopped already
            // refuses to stop.
            let _ = self.engine.input(self.clock.now(), event);
        }
    }
}
