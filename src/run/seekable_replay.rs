//! A seekable replay: the recording is read once with all presses judged; the shown session applies the same events.
//! Snapshots of the session, kept while reading, make every move cheap: at most `KEEP_EVERY` events are applied. The
//! console can begin before the recording is read to its end.

use std::path::Path;

use super::replay::RecordingReplay;
use super::standing::exclusion_status;
use crate::analysis::exclusion_status::ExclusionStatus;
use crate::base::time::SessionTime;
use crate::edge::file_error::FileResult;
use crate::history::belief_track::{BeliefHistory, BeliefSnapshot};
use crate::history::landmark::ReplayLandmark;
use crate::session::settings::WizardVisibility;
use crate::session::{Event, Session, TimestampedEvent, TrialPhase, apply};

/// Number of events between two snapshots of the session.
const KEEP_EVERY: usize = 4096;

/// Event without effect that replaces hidden events in a replay for raters, so that sequence numbers stay.
const HIDDEN: Event = Event::ClockJumped { by_ms: 0 };

/// Whether an event is hidden from raters: it reveals the trial's condition (a signal, an offer, a recommendation), or
/// what the wizard thought.
fn is_hidden(event: &Event) -> bool {
    matches!(
        event,
        Event::SignalShown { .. }
            | Event::SignalDrawn { .. }
            | Event::SignalEnded { .. }
            | Event::OfferOpened(_)
            | Event::OfferClosed { .. }
            | Event::Advised(_)
            | Event::Unblinded { .. }
            | Event::Marker { .. }
    )
}

/// Whether the replay stops at this event when it is moved step by step.
fn is_step(event: &Event) -> bool {
    !event.is_sample() && *event != HIDDEN
}

/// A recording that can be shown at any position.
#[derive(Debug)]
pub struct SeekableReplay {
    pub(super) replay: RecordingReplay,
    pub(super) events: Vec<TimestampedEvent>,
    /// Session times of the human's errors.
    pub errors: Vec<SessionTime>,
    judged: usize,
    /// History of the belief estimate over the recording.
    pub beliefs: BeliefHistory,
    /// The shown session, after the first `position` events.
    pub session: Session,
    /// Number of events that have been applied to the shown session.
    pub position: usize,
    /// Snapshots of the session before the first event and after every `KEEP_EVERY` events.
    kept: Vec<Session>,
    /// Time of the log's last event and number of the log's events; `None` once all events are read.
    unread_end: Option<(SessionTime, usize)>,
}

impl SeekableReplay {
    /// Reads a recording to its end and moves the replay to the recording's beginning.
    ///
    /// # Errors
    /// The errors of [`RecordingReplay::step`].
    pub fn open(recording: &Path) -> FileResult<SeekableReplay> {
        let mut film = SeekableReplay::begin(recording)?;
        film.read()?;
        Ok(film)
    }

    /// Opens a recording without reading its events.
    ///
    /// # Errors
    /// The errors of [`RecordingReplay::open`].
    pub fn begin(recording: &Path) -> FileResult<SeekableReplay> {
        let replay = RecordingReplay::open(recording)?;
        let last = replay.log().last_event()?;
        let unread_end = Some(last.map_or((SessionTime::ZERO, 0), |last| (last.time, last.seq as usize + 1)));
        let session = replay.session().clone();
        let kept = vec![session.clone()];
        Ok(SeekableReplay {
            replay,
            events: Vec::new(),
            errors: Vec::new(),
            judged: 0,
            beliefs: BeliefHistory::default(),
            session,
            position: 0,
            kept,
            unread_end,
        })
    }

    /// Hides the estimate and all signals for raters, who must not know whether the participant was assisted. This
    /// function must be called before the replay is moved.
    pub fn blinded(mut self) -> SeekableReplay {
        // Later snapshots contain what is hidden, so only the first one is kept.
        self.kept.truncate(1);
        for session in self.kept.iter_mut().chain([&mut self.session]) {
            session.spec.console.visibility = WizardVisibility::State;
        }
        for stamped in self.events.iter_mut().filter(|stamped| is_hidden(&stamped.event)) {
            stamped.event = HIDDEN;
        }
        self
    }

    /// Reads events that were appended to the log; returns whether there were any.
    ///
    /// # Errors
    /// The errors of [`RecordingReplay::step`].
    pub fn read(&mut self) -> FileResult<bool> {
        self.read_while(|| true)
    }

    /// Reads appended events, as long as `goes_on` returns true; returns whether there were any.
    ///
    /// # Errors
    /// The errors of [`RecordingReplay::step`].
    pub fn read_while(&mut self, goes_on: impl Fn() -> bool) -> FileResult<bool> {
        let before = self.events.len();
        while goes_on() && self.read_event()? {}
        let judged = &self.replay.follower.judged;
        let new = judged[self.judged..].iter().filter(|press| press.verdict.error).map(|press| press.time);
        self.errors.extend(new);
        self.judged = judged.len();
        Ok(self.events.len() > before)
    }

    /// Reads up to the start of the trial, or to the end of a recording without a trial. Before the trial there are no
    /// presses, and so no errors.
    ///
    /// # Errors
    /// Errors of [`RecordingReplay::step`].
    pub fn read_to_trial(&mut self) -> FileResult<()> {
        while self.replay.session().phase == TrialPhase::Ready && self.read_event()? {}
        Ok(())
    }

    /// Reads the next event; returns whether there was one.
    fn read_event(&mut self) -> FileResult<bool> {
        let Some(event) = self.replay.step()? else {
            self.unread_end = None;
            return Ok(false);
        };
        let (session, belief) = (self.replay.session(), self.replay.follower.filter.belief());
        let by_gaze = event.stamped.event.is_sample();
        let moment = BeliefSnapshot::new(&session.kitchen, session.state, belief, event.stamped.time, by_gaze);
        self.beliefs.note(moment);
        self.events.push(event.stamped);
        if self.events.len() == self.kept.len() * KEEP_EVERY {
            self.kept.push(self.replay.session().clone());
        }
        Ok(true)
    }

    /// Whether all events were read that the recording has for now.
    pub fn is_read(&self) -> bool {
        self.unread_end.is_none()
    }

    /// Whether the recording has no end event, as far as the recording was read.
    pub fn is_cut(&self) -> bool {
        self.is_read() && self.replay.log().is_cut()
    }

    /// Whether the trial was aborted or excluded from the analysis.
    ///
    /// # Errors
    /// The errors of [`exclusion_status`].
    pub fn standing(&self) -> FileResult<ExclusionStatus> {
        exclusion_status(self.replay.session(), self.replay.log())
    }

    /// Time of the recording's last event, and number of its events, including events that are not read yet.
    pub fn length(&self) -> (SessionTime, usize) {
        self.unread_end.unwrap_or_else(|| (self.read_to(), self.events.len()))
    }

    /// The time on the trial's clock at the end of the recording; what is not read yet counts as time of the trial.
    pub fn trial_length(&self) -> SessionTime {
        let (session, read) = (self.replay.session(), self.read_to());
        let goes_on = matches!(session.phase, TrialPhase::Ready | TrialPhase::Running) && !self.is_read();
        let unread = if goes_on { self.length().0 - read } else { SessionTime::ZERO };
        session.trial_clock(read) + unread
    }

    /// Position after the events at the time of the trial's start; 0 in a recording without a trial.
    pub fn trial_start(&self) -> usize {
        let start = self.events.iter().find(|stamped| stamped.event == Event::TrialStarted);
        start.map_or(0, |start| self.until(start.time))
    }

    /// The time of the last event that was read.
    pub fn read_to(&self) -> SessionTime {
        self.events.last().map_or(SessionTime::ZERO, |stamped| stamped.time)
    }

    /// Applies the next event to the shown session, and returns the event.
    pub fn forward(&mut self) -> Option<&TimestampedEvent> {
        let stamped = self.events.get(self.position)?;
        apply(&mut self.session, stamped).expect("it was applied when it was read");
        self.position += 1;
        if self.position == self.kept.len() * KEEP_EVERY {
            self.kept.push(self.session.clone());
        }
        Some(stamped)
    }

    /// Moves the shown session to the position after the first `position` events, which must have been read.
    pub fn wind(&mut self, position: usize) {
        let index = (position / KEEP_EVERY).min(self.kept.len() - 1);
        if position < self.position || index * KEEP_EVERY > self.position {
            self.session = self.kept[index].clone();
            self.position = index * KEEP_EVERY;
        }
        while self.position < position && self.forward().is_some() {}
    }

    /// Number of the recording's events up to and including those at a time.
    pub fn until(&self, time: SessionTime) -> usize {
        self.events.partition_point(|stamped| stamped.time <= time)
    }

    /// Position after the next event that is neither a gaze or arm sample nor hidden from raters.
    pub fn next_step(&self) -> usize {
        let rest = self.events[self.position..].iter();
        self.position + rest.take_while(|stamped| !is_step(&stamped.event)).count() + 1
    }

    /// Position after the previous event that is neither a gaze or arm sample nor hidden from raters.
    pub fn last_step(&self) -> usize {
        let steps = |end: usize| self.events[..end].iter().rposition(|stamped| is_step(&stamped.event));
        let last = steps(self.position).unwrap_or(0);
        steps(last).map_or(0, |index| index + 1)
    }

    /// Position after all events at the time of the next or previous landmark of this kind.
    pub fn landmark(&self, what: ReplayLandmark, forward: bool) -> Option<usize> {
        let now = self.time();
        let is_it = |event: &Event| match what {
            ReplayLandmark::Signal => matches!(event, Event::SignalShown { .. }),
            ReplayLandmark::Marker => matches!(event, Event::Marker { .. }),
            ReplayLandmark::Error | ReplayLandmark::FalseBelief => false,
        };
        let times: Vec<SessionTime> = match what {
            ReplayLandmark::Error => self.errors.clone(),
            ReplayLandmark::FalseBelief => self.beliefs.newly_false().collect(),
            ReplayLandmark::Signal | ReplayLandmark::Marker => {
                self.events.iter().filter(|stamped| is_it(&stamped.event)).map(|stamped| stamped.time).collect()
            }
        };
        let found = match forward {
            true => times.into_iter().find(|&time| time > now),
            false => times.into_iter().rev().find(|&time| time < now),
        };
        found.map(|time| self.until(time))
    }

    /// Session time of the last applied event.
    pub fn time(&self) -> SessionTime {
        self.session.time
    }
}
