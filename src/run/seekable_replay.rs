//! A seekable replay: the recording is read once with all presses judged; the shown session applies the same events.
//!
//! A log of hours has millions of gaze samples, so events are not kept in memory: they are read again from the file, a
//! chunk of `CHUNK` events at a time, when the shown session comes there. What is kept are the places of the chunks, the
//! events at which a replay stops, and snapshots of the session, so that every move applies few events. The console can
//! begin before the recording is read to its end.

use std::ops::Range;
use std::path::Path;

use crate::console::console_model::ReplayAction;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::Agent;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::follower::SessionFollower;
use tomcom_session::history::belief_track::{BeliefHistory, BeliefSnapshot};
use tomcom_session::history::error_reasons::ExplainedError;
use tomcom_session::history::false_beliefs::{EstimatedFalseBelief, FalseBeliefsBefore};
use tomcom_session::history::{event_words, signal_words};
use tomcom_session::log::LogPlace;
use tomcom_session::replay::RecordingReplay;
use tomcom_session::replay::ReplayLandmark;
use tomcom_session::settings::WizardVisibility;
use tomcom_session::wizard_log::signal_verdicts;
use tomcom_session::{Event, Session, TimelineEntry, TimelineEvent, TimestampedEvent, TrialPhase, apply};
use tomcom_study::analysis::recording_summary::ExclusionStatus;
use tomcom_study::standing::exclusion_status;

/// Largest number of events in a chunk.
const CHUNK: usize = 4096;
/// Largest number of snapshots of the session; when there are more, every second one is dropped.
const MOST_SNAPSHOTS: usize = 256;

/// Event without effect that replaces hidden events in a replay for raters, so that sequence numbers stay.
const HIDDEN: Event = Event::ClockJumped { by_ms: 0 };

/// Whether the replay stops at this event when it is moved step by step. The estimate from before a press is recorded after
/// the press: beside its words the screen would show the one after it.
fn is_step(event: &Event) -> bool {
    !event.is_sample() && !matches!(event, Event::BeliefEstimated(_)) && *event != HIDDEN
}

/// Events of a recording that are read again together; all of them are in one file.
#[derive(Debug)]
struct Chunk {
    /// Number of events before this chunk.
    first: usize,
    /// Number of the chunk's events.
    number: usize,
    place: LogPlace,
    /// Time of the chunk's first event.
    time: SessionTime,
}

/// An event at which the replay stops when it is moved step by step.
#[derive(Clone, Copy, Debug)]
struct Step {
    /// Number of events before this one.
    index: usize,
    time: SessionTime,
    landmark: Option<ReplayLandmark>,
    starts_trial: bool,
    is_shown_to_raters: bool,
}

/// The session after the first `position` events, without its timeline.
#[derive(Debug)]
struct Snapshot {
    position: usize,
    session: Session,
    /// Number of entries of the timeline.
    entries: usize,
}

/// Snapshots of a session, the first before the first event. A session's timeline only grows, so the timelines of all
/// snapshots are beginnings of the longest one, which is kept once.
#[derive(Debug)]
struct Snapshots {
    kept: Vec<Snapshot>,
    /// Number of events after the last snapshot, from which on another one is kept.
    spacing: usize,
    timeline: Vec<TimelineEntry>,
}

/// A recording that can be shown at any position.
#[derive(Debug)]
pub struct SeekableReplay {
    pub(super) replay: RecordingReplay,
    /// The human's errors in the order of time.
    pub errors: Vec<ExplainedError>,
    judged: usize,
    /// History of the belief estimate over the recording.
    pub beliefs: BeliefHistory,
    /// For each snapshot in `beliefs` the number of events after which it was taken.
    estimated_after: Vec<usize>,
    /// The shown session, after the first `position` events.
    pub session: Session,
    /// Number of events that have been applied to the shown session.
    pub position: usize,
    /// The recording's events, as far as they were read.
    chunks: Vec<Chunk>,
    /// Time of the last event that was read.
    read_to: SessionTime,
    /// Events that are neither gaze or arm samples nor hidden from raters.
    steps: Vec<Step>,
    /// What was advised, in words.
    advised: Vec<(SessionTime, String)>,
    /// The chunk with this index that was read again last, with its events.
    loaded: Option<(usize, Vec<TimestampedEvent>)>,
    /// Why a chunk could not be read again.
    trouble: Option<FileError>,
    is_blinded: bool,
    snapshots: Snapshots,
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
        let mut session = replay.session().clone();
        // Nobody sat at the console of a simulated trial, so that nothing is to be hidden that a wizard did not see.
        if replay.log().header.started.is_none() {
            let visibility = &mut session.spec.console.visibility;
            *visibility = WizardVisibility::Belief.max(*visibility);
        }
        let snapshots = Snapshots::new(&mut session);
        Ok(SeekableReplay {
            replay,
            errors: Vec::new(),
            judged: 0,
            beliefs: BeliefHistory::default(),
            estimated_after: Vec::new(),
            session,
            position: 0,
            chunks: Vec::new(),
            read_to: SessionTime::ZERO,
            steps: Vec::new(),
            advised: Vec::new(),
            loaded: None,
            trouble: None,
            is_blinded: false,
            snapshots,
            unread_end,
        })
    }

    /// Hides the estimate and all signals for raters, who must not know whether the participant was assisted. This
    /// function must be called before the replay is moved.
    pub fn blinded(mut self) -> SeekableReplay {
        self.loaded = None;
        self.is_blinded = true;
        self.session.spec.console.visibility = WizardVisibility::State;
        self.steps.retain(|step| step.is_shown_to_raters);
        // The snapshots so far contain what is hidden.
        self.snapshots = Snapshots::new(&mut self.session);
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
        let before = self.read_events();
        while goes_on() && self.read_event()? {}
        let SessionFollower { judged, session, .. } = &self.replay.follower;
        self.errors.extend(ExplainedError::among(session, &judged[self.judged..]));
        self.judged = judged.len();
        Ok(self.read_events() > before)
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
        let place = self.replay.log().place();
        let Some(event) = self.replay.step()? else {
            self.unread_end = None;
            return Ok(false);
        };
        let (session, belief) = (self.replay.session(), self.replay.follower.filter.belief());
        let (stamped, index) = (event.stamped, self.read_events());
        let by_gaze = stamped.event.is_sample();
        let moment = BeliefSnapshot::new(&session.kitchen, session.state, belief, stamped.time, by_gaze);
        if self.beliefs.note(moment) {
            self.estimated_after.push(index + 1);
        }
        self.read_to = stamped.time;
        if matches!(stamped.event, Event::Advised(_)) {
            let words = event_words::words(&stamped, &self.replay.follower);
            self.advised.extend(words.map(|words| (stamped.time, words)));
        }
        self.steps.extend(Step::at(index, &stamped).filter(|step| !self.is_blinded || step.is_shown_to_raters));
        match self.chunks.last_mut().filter(|last| last.number < CHUNK && last.place.is_in_file_of(&place)) {
            Some(last) => last.number += 1,
            None => self.chunks.push(Chunk { first: index, number: 1, place, time: stamped.time }),
        }
        if !self.is_blinded {
            self.snapshots.note(index + 1, &mut self.replay.follower.session);
        }
        Ok(true)
    }

    /// Number of events that were read so far.
    pub fn read_events(&self) -> usize {
        self.chunks.last().map_or(0, |last| last.first + last.number)
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
        self.unread_end.unwrap_or_else(|| (self.read_to, self.read_events()))
    }

    /// The time on the trial's clock at the end of the recording; what is not read yet counts as time of the trial.
    pub fn trial_length(&self) -> SessionTime {
        let (session, read) = (self.replay.session(), self.read_to());
        let goes_on = matches!(session.phase, TrialPhase::Ready | TrialPhase::Running) && !self.is_read();
        let unread = if goes_on { self.length().0 - read } else { SessionTime::ZERO };
        session.trial_clock(read) + unread
    }

    /// When the trial's clock first showed this time, as far as the recording was read; `None` if the trial was shorter.
    pub fn at_clock(&self, clock: SessionTime) -> Option<SessionTime> {
        let (session, end) = (self.replay.session(), self.trial_length());
        let later = |time: SessionTime, &(from, until): &(SessionTime, SessionTime)| {
            if from < time { time + (until - from) } else { time }
        };
        let is_there = !clock.is_shown_after(end);
        is_there.then(|| session.pauses.iter().fold(session.trial_start + clock.min(end), later))
    }

    /// Position after the events at the time of the trial's start; 0 in a recording without a trial.
    pub fn trial_start(&mut self) -> usize {
        let start = self.steps.iter().find(|step| step.starts_trial).map(|step| step.time);
        start.map_or(0, |start| self.until(start))
    }

    /// The time of the last event that was read.
    pub fn read_to(&self) -> SessionTime {
        self.read_to
    }

    /// Why the recording could not be read again; the replay then stands where it was.
    pub fn take_trouble(&mut self) -> Option<FileError> {
        self.trouble.take()
    }

    /// Applies the next event to the shown session, and returns the event; `None` at the end, or if the recording cannot be
    /// read again.
    pub fn forward(&mut self) -> Option<&TimestampedEvent> {
        let within = self.load(self.position)?;
        let (_, events) = self.loaded.as_ref()?;
        apply(&mut self.session, &events[within]).expect("it was applied when it was read");
        self.position += 1;
        self.snapshots.note(self.position, &mut self.session);
        Some(&events[within])
    }

    /// Makes `shown` the history of the belief estimate up to the shown position. Events can have the same time, so that
    /// the time does not tell what the estimate had seen.
    pub fn show_beliefs(&self, shown: &mut BeliefHistory) {
        shown.follow(&self.beliefs, self.estimated_after.partition_point(|&after| after <= self.position));
    }

    /// Calls `visit` with the events between two positions, as far as they were read.
    pub fn each(&mut self, positions: Range<usize>, mut visit: impl FnMut(&TimestampedEvent)) {
        for index in positions {
            let Some(within) = self.load(index) else { return };
            self.loaded.iter().for_each(|(_, events)| visit(&events[within]));
        }
    }

    /// Moves the shown session to the position after the first `position` events, which must have been read.
    pub fn wind(&mut self, position: usize) {
        let kept = self.snapshots.last_until(position);
        if position < self.position || kept.position > self.position {
            self.session = self.snapshots.session(kept);
            self.position = kept.position;
        }
        while self.position < position && self.forward().is_some() {}
    }

    /// Number of the recording's events up to and including those at a time.
    pub fn until(&mut self, time: SessionTime) -> usize {
        let Some(index) = self.chunks.partition_point(|chunk| chunk.time <= time).checked_sub(1) else { return 0 };
        let Chunk { first, number, .. } = self.chunks[index];
        // All of the chunk, also what it has grown by.
        if self.load(first + number - 1).is_none() {
            return first;
        }
        let events = self.loaded.as_ref().map_or(&[][..], |(_, events)| events);
        first + events.partition_point(|stamped| stamped.time <= time)
    }

    /// Reads the chunk with the event at this index again, unless it is loaded; returns the event's index in the chunk.
    fn load(&mut self, index: usize) -> Option<usize> {
        let of = self.chunks.partition_point(|chunk| chunk.first <= index).checked_sub(1)?;
        let chunk = &self.chunks[of];
        let within = index - chunk.first;
        if within >= chunk.number {
            return None;
        }
        // A chunk of a running session can have grown since it was loaded.
        let is_loaded = self.loaded.as_ref().is_some_and(|(loaded, events)| *loaded == of && within < events.len());
        if !is_loaded {
            match chunk.place.read_again(chunk.number) {
                Ok(mut events) => {
                    let hidden =
                        events.iter_mut().filter(|stamped| self.is_blinded && stamped.event.is_hidden_from_raters());
                    hidden.for_each(|stamped| stamped.event = HIDDEN);
                    self.loaded = Some((of, events));
                }
                Err(error) => {
                    self.trouble = Some(error);
                    return None;
                }
            }
        }
        Some(within)
    }

    /// Position after the next event that is neither a gaze or arm sample nor hidden from raters.
    pub fn next_step(&self) -> usize {
        let next = self.steps.partition_point(|step| step.index < self.position);
        self.steps.get(next).map_or(self.read_events(), |step| step.index) + 1
    }

    /// The last position before the present one that is after such an event.
    pub fn last_step(&self) -> usize {
        let number = self.steps.partition_point(|step| step.index + 1 < self.position);
        number.checked_sub(1).map_or(0, |last| self.steps[last].index + 1)
    }

    /// The false beliefs of the estimate at which a replay stops: those that last, as far as the recording was read.
    fn false_beliefs(&self) -> impl Iterator<Item = &EstimatedFalseBelief> {
        let SessionFollower { false_beliefs, session, .. } = &self.replay.follower;
        false_beliefs.all().filter(|one| one.lasts(session))
    }

    /// Times of the landmarks of this kind, as far as the recording was read.
    pub fn landmarks(&self, what: ReplayLandmark) -> Vec<SessionTime> {
        match what {
            ReplayLandmark::Error => self.errors.iter().map(|error| error.time).collect(),
            ReplayLandmark::FalseBelief => self.false_beliefs().map(|one| one.began).collect(),
            ReplayLandmark::Signal | ReplayLandmark::Marker => {
                self.steps.iter().filter(|step| step.landmark == Some(what)).map(|step| step.time).collect()
            }
        }
    }

    /// Position after all events at the time of the next or previous landmark of this kind. `here`: one at the present
    /// position is found, too.
    pub fn landmark(&mut self, what: ReplayLandmark, forward: bool, here: bool) -> Option<usize> {
        let (now, times) = (self.time(), self.landmarks(what));
        // Before the last event of this time its landmarks are ahead.
        let is_ahead = self.position < self.until(now);
        let found = match forward {
            true => times.into_iter().find(|&time| time > now || time == now && (here || is_ahead)),
            false => times.into_iter().rev().find(|&time| time < now || time == now && here && !is_ahead),
        };
        found.map(|time| self.until(time))
    }

    /// The landmark of this kind at which the replay stands: "error 5 of 17: take salmon: order 1 needs tuna".
    pub fn named(&self, what: ReplayLandmark) -> Option<String> {
        let times = self.landmarks(what);
        let index = times.iter().position(|&time| time == self.time())?;
        // False beliefs can begin together.
        let number = match times.iter().filter(|&&time| time == self.time()).count() {
            0 | 1 => (index + 1).to_string(),
            several => format!("{} to {}", index + 1, index + several),
        };
        Some(format!("{} {number} of {}: {}", what.name(), times.len(), self.told(what)?))
    }

    /// The event at which the replay stands, in words; `None` at the beginning, and for raters, who would read estimates
    /// and causes.
    pub fn named_event(&mut self) -> Option<String> {
        let last = self.position.checked_sub(1).filter(|_| !self.is_blinded)?;
        let within = self.load(last)?;
        let stamped = &self.loaded.as_ref()?.1[within];
        Some(event_words::step_words(stamped, &self.replay.follower))
    }

    /// The events of the list of events, advice and estimated false beliefs in words, with the trial's clock and of errors the
    /// reason, as far as the recording was read, each with the action that goes there; none for raters, who would read signals.
    pub fn told_events(&self) -> Vec<(ReplayAction, String)> {
        let session = self.replay.session();
        if self.is_blinded {
            return Vec::new();
        }
        let happened = session.timeline.iter().map(|entry: &TimelineEntry| {
            let (who, mut what) = event_words::happening(&session.kitchen, &entry.what);
            let mut to = ReplayAction::ToTime(entry.time);
            let error = self.errors.binary_search_by_key(&entry.time, |error| error.time).ok();
            if let (Some(index), TimelineEvent::Press { agent: Agent::Human, no_effect, .. }) = (error, &entry.what) {
                let (number, error) = (index + 1, &self.errors[index]);
                to = ReplayAction::ToNth(ReplayLandmark::Error, number);
                // The reason says why a press had no effect.
                let pressed = if no_effect.is_some() { &error.press } else { &what };
                what = format!("{pressed}; error {number}: {}", error.why);
            }
            (entry.time, to, format!("{who}{}{what}", if who.is_empty() { "" } else { " " }))
        });
        let advised = self.advised.iter().map(|(time, words)| (*time, ReplayAction::ToTime(*time), words.clone()));
        let believed = self.false_beliefs().zip(1..).map(|(one, number)| {
            let (what, name) = (ReplayLandmark::FalseBelief, ReplayLandmark::FalseBelief.name());
            (one.began, ReplayAction::ToNth(what, number), format!("{name} {number}: {}", one.whole(session)))
        });
        let mut all: Vec<(SessionTime, ReplayAction, String)> = happened.chain(advised).chain(believed).collect();
        all.sort_by_key(|(time, ..)| *time);
        let told = |(time, to, words): (SessionTime, ReplayAction, String)| {
            (to, format!("{:>7}  {words}", session.trial_clock_at(time).with_tenths()))
        };
        all.into_iter().map(told).collect()
    }

    /// What the landmark of this kind is at which the replay stands.
    fn told(&self, what: ReplayLandmark) -> Option<String> {
        let (session, now) = (self.replay.session(), self.time());
        match what {
            ReplayLandmark::Error => {
                let error = self.errors.iter().find(|error| error.time == now)?;
                if self.is_blinded {
                    return Some(format!("{}: {}", error.press, error.why));
                }
                Some(error.told(self.replay.follower.believed_wrong(now).and_then(FalseBeliefsBefore::told)))
            }
            ReplayLandmark::Signal => {
                let follower = &self.replay.follower;
                let nth = follower.signals.shown.iter().position(|shown| shown.time == now)?;
                Some(signal_words::told(follower, signal_verdicts(follower).as_deref(), nth))
            }
            // The whole recording knows the words of a note that the wizard typed later.
            ReplayLandmark::Marker => {
                let from = session.timeline.partition_point(|entry| entry.time < now);
                let those = session.timeline[from..].iter().take_while(|entry| entry.time == now);
                those.filter_map(|entry| event_words::note(&entry.what)).last()
            }
            ReplayLandmark::FalseBelief => {
                let told = self.false_beliefs().filter(|one| one.began == now).map(|one| one.whole(session));
                Some(told.collect::<Vec<_>>().join("; "))
            }
        }
    }

    /// Session time of the last applied event.
    pub fn time(&self) -> SessionTime {
        self.session.time
    }
}

impl Step {
    /// The event with this index as a step; `None` for a sample.
    fn at(index: usize, stamped: &TimestampedEvent) -> Option<Step> {
        let landmark = match stamped.event {
            Event::SignalShown { .. } => Some(ReplayLandmark::Signal),
            Event::Marker { .. } => Some(ReplayLandmark::Marker),
            _ => None,
        };
        is_step(&stamped.event).then(|| Step {
            index,
            time: stamped.time,
            landmark,
            starts_trial: stamped.event == Event::TrialStarted,
            is_shown_to_raters: !stamped.event.is_hidden_from_raters(),
        })
    }
}

impl Snapshots {
    fn new(session: &mut Session) -> Snapshots {
        let mut snapshots = Snapshots { kept: Vec::new(), spacing: CHUNK, timeline: Vec::new() };
        snapshots.keep(0, session);
        snapshots
    }

    /// Notes the session after the first `position` events, and keeps a snapshot if the last one is far enough back.
    fn note(&mut self, position: usize, session: &mut Session) {
        let known = self.timeline.len().min(session.timeline.len());
        self.timeline.extend_from_slice(&session.timeline[known..]);
        if self.kept.last().is_none_or(|last| position >= last.position + self.spacing) {
            self.keep(position, session);
        }
        if self.kept.len() > MOST_SNAPSHOTS {
            let mut number = 0;
            self.kept.retain(|_| {
                number += 1;
                number % 2 == 1
            });
            self.spacing *= 2;
        }
    }

    fn keep(&mut self, position: usize, session: &mut Session) {
        let timeline = std::mem::take(&mut session.timeline);
        self.kept.push(Snapshot { position, session: session.clone(), entries: timeline.len() });
        session.timeline = timeline;
    }

    /// The last snapshot after at most `position` events.
    fn last_until(&self, position: usize) -> &Snapshot {
        &self.kept[self.kept.partition_point(|kept| kept.position <= position).max(1) - 1]
    }

    /// The session of a snapshot with its timeline.
    fn session(&self, kept: &Snapshot) -> Session {
        let mut session = kept.session.clone();
        session.timeline = self.timeline[..kept.entries].to_vec();
        session
    }
}
