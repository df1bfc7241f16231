//! Inputs of a live session on their way to the engine: terminal, gaze, the participant's page, recommendations.

use super::display::PageEvent;
use super::live_session::Live;
use crate::console::console_model::NoticeLevel;
use crate::console::{ConsoleCommand, ConsoleMessage, update};
use crate::run::assistant_link::AssistantNews;
use crate::run::leaving::LeavingReason;
use crate::run::operator_station::{ArmNews, PageInput, Remark, lost_since};
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_devices::external::LocalMinds;
use tomcom_devices::gaze_input::TrackerMessage;
use tomcom_session::history::event_words;
use tomcom_session::preflight_checks::RejectedGaze;
use tomcom_session::tracker::{TrackerEvent, TrackerRecording};
use tomcom_session::wall_display::DisplayEvent;
use tomcom_session::{Event, TrialPhase};

/// Time without the page that takes part after which a trial is paused, in seconds.
const PAUSES_AFTER_S: f64 = 3.0;

impl Live {
    /// Handles a message from the terminal; returns how the wizard leaves the recording, if the message leaves it.
    pub(super) fn take_message(&mut self, message: ConsoleMessage) -> Option<LeavingReason> {
        self.tick();
        self.dirty |= !matches!(message, ConsoleMessage::Pointer(..));
        match update(&mut self.model, self.engine.session(), message) {
            Some(ConsoleCommand::Input(event)) => self.input(event),
            Some(ConsoleCommand::Start(preflight)) => {
                self.input(preflight);
                self.input(Event::TrialStarted);
            }
            Some(ConsoleCommand::Quit) => return Some(LeavingReason::Quit),
            Some(ConsoleCommand::Next) => return Some(LeavingReason::Next),
            Some(ConsoleCommand::Redo) => return Some(LeavingReason::Redo),
            Some(ConsoleCommand::Move(_) | ConsoleCommand::Code { .. }) | None => {}
        }
        None
    }

    /// Passes an event to the engine and records the result. The wizard sees why an event was refused, except for gaze
    /// samples and late recommendations.
    pub(super) fn input(&mut self, event: Event) {
        let is_silent = matches!(event, Event::Gaze(_) | Event::Advised(_) | Event::External(_));
        let outcome = self.engine.input(self.clock.now(), event);
        self.record(&outcome.events);
        if let Some(reason) = outcome.refused.filter(|_| !is_silent) {
            self.model.say(NoticeLevel::Refused, reason);
        }
    }

    /// Records an observer's remark, and tells the observer whether it is in the recording.
    pub(super) fn take_remark(&mut self, remark: Remark) {
        let outcome = self.engine.input(self.clock.now(), remark.event());
        self.record(&outcome.events);
        let lost = self.failed.as_ref().map(|_| "the recording cannot be written".to_string());
        remark.answer(match outcome.refused.or(lost) {
            Some(reason) => Err(reason),
            None => Ok(()),
        });
    }

    /// Takes what a real arm does as events of the session, and what is found of it as checks.
    #[cfg(feature = "ur")]
    pub(super) fn take_arm_news(&mut self, news: ArmNews) {
        self.dirty = true;
        match news {
            ArmNews::Event(event) if self.engine.session().phase != TrialPhase::Closed => self.input(*event),
            ArmNews::Event(_) => {}
            ArmNews::Checks(checks) => self.model.arm = checks,
            ArmNews::Message(words) => self.model.warn(format!("the arm's controller: {words}")),
        }
    }

    #[cfg(not(feature = "ur"))]
    pub(super) fn take_arm_news(&mut self, news: ArmNews) {
        match news {}
    }

    /// Takes what came back from whoever advises.
    pub(super) fn take_assistant_news(&mut self, news: AssistantNews) {
        let events = match news {
            AssistantNews::Participant(line) => {
                let link = self.participant.as_mut();
                link.map(|link| link.take(self.engine.session(), line)).unwrap_or_default()
            }
            advice => self.advisor.as_mut().map(|link| link.take(advice)).unwrap_or_default(),
        };
        events.into_iter().for_each(|event| self.input(event));
        self.ask_participant();
    }

    /// Asks a program in the participant's place, if its display changed.
    pub(super) fn ask_participant(&mut self) {
        let Some(link) = &mut self.participant else { return };
        let events = link.look(self.engine.session(), self.clock.now(), &LocalMinds);
        events.into_iter().for_each(|event| self.input(event));
    }

    /// When a program in the participant's place presses, or wants to be asked again.
    pub(super) fn participant_due(&self) -> Option<SessionTime> {
        self.participant.as_ref().and_then(|link| link.due(self.engine.session()))
    }

    /// Lets a program in the participant's place do what is due, or the engine raise due events, and records them.
    pub(super) fn fire(&mut self) {
        let is_due = self.participant_due().is_some_and(|due| due <= self.clock.now());
        if let Some(link) = self.participant.as_mut().filter(|_| is_due) {
            let events = link.act(self.engine.session());
            events.into_iter().for_each(|event| self.input(event));
            return self.ask_participant();
        }
        let events = self.engine.fire();
        // Most control cycles of the robot's arm lead to no event.
        if !events.is_empty() {
            self.record(&events);
        }
    }

    pub(super) fn take_page_input(&mut self, input: PageInput) {
        if self.engine.session().phase == TrialPhase::Closed {
            return;
        }
        let now = self.clock.now();
        let silent = lost_since(&input).map(|at| SessionTime::from_secs_f64(at.elapsed().as_secs_f64()));
        let PageEvent { event, notice } = PageEvent::from_input(input, self.engine.session(), now);
        match event {
            Some(Event::Display(DisplayEvent::Lost)) => self.page_lost = silent.map(|silent| now - silent),
            Some(Event::Display(DisplayEvent::Connected { .. })) => self.page_lost = None,
            _ => {}
        }
        if let Some(event) = event {
            self.input(event);
        }
        if let Some((level, text)) = notice {
            self.model.say(level, text);
        }
    }

    /// Pauses the trial once the page that takes part is lost for long, if the session wants that.
    pub(super) fn pause_without_page(&mut self) {
        let now = self.clock.now();
        let is_long = self.page_lost.take_if(|since| now.secs_since(*since) >= PAUSES_AFTER_S).is_some();
        let session = self.engine.session();
        let is_wanted = session.spec.display.pause_when_lost.unwrap_or(session.spec.step.is_some());
        if is_long && is_wanted && session.can_be_paused() {
            self.input(Event::TrialPaused);
            let text = format!("paused by itself: the participant's display is lost for {PAUSES_AFTER_S:.0} s");
            self.model.say(NoticeLevel::Alarm, text);
        }
    }

    pub(super) fn take_gaze(&mut self, news: TrackerMessage) {
        if let TrackerMessage::Rejected { from, why, senders } = &news {
            let told = format!("gaze from {from} is rejected: {}", why.words());
            self.model.reject_sender(RejectedGaze { told, remedy: why.remedy().to_string() }, *senders);
            self.dirty = true;
        }
        if news == TrackerMessage::Closed {
            self.model.gaze_closed = Some(self.clock.now());
            self.dirty = true;
        }
        if let Some(complaint) = self.gaze.complaint(&news) {
            self.model.warn(complaint);
            self.dirty = true;
        }
        if let Some(event) = self.gaze.event(news, self.clock.now()) {
            if let Event::Tracker(told) = &event
                && is_warning(told)
                && let Some(words) = event_words::tracker(told)
            {
                self.model.warn(words);
            }
            self.input(event);
        }
    }

    /// Handles the next sample of gaze that is replayed from a file.
    pub(super) fn take_file_gaze(&mut self) {
        if let Some(event) = self.gaze.next_of_file(self.engine.session()) {
            self.input(event);
        }
    }

    /// Records the position of the mouse pointer as a gaze sample, once the pointer has been moved.
    pub(super) fn sample_pointer(&mut self) {
        if let Some([x, y]) = self.model.pointer {
            self.input(Event::Gaze(GazeSample::new(x, y, 1.0)));
        }
    }
}

/// Whether a tracker event is shown to the wizard as a notice, in whichever view the wizard is.
fn is_warning(event: &TrackerEvent) -> bool {
    match event {
        TrackerEvent::ClockSet { .. } | TrackerEvent::OtherSurfaces { .. } => true,
        TrackerEvent::Stamps { fault } => fault.is_some(),
        TrackerEvent::SeveralStreams { streams } => !streams.is_empty(),
        TrackerEvent::Recording { state } => *state != TrackerRecording::Begun,
        _ => false,
    }
}
