//! The rules of freeze probes: when one is due, which of its events a session accepts, and what they change.
//!
//! A running session asks [`upcoming`] after every event and records the event of a probe that is due; a replay applies
//! the recorded events. While a probe is open the trial is paused, and the probe has a time of its own, which stands
//! still while the wizard pauses the probe.

use super::event::{Event, TimestampedEvent};
use super::phase::TrialPhase;
pub use super::probe_event::{ProbeDelayReason, ProbeEndReason, ProbeEvent, ProbeOrigin, ProbeQuestion, ProbeSubject};
use super::probe_sampling;
pub use super::probe_schedule::{ScheduledProbe, of_trial};
use super::probe_schedule::{draw, requested_uses_estimate};
use super::probe_settings::ProbeSpec;
pub use super::probe_state::{ProbeAnswer, StartedProbe, TrialProbes, WaitingProbe};
use super::session_state::Session;
use super::timeline_entry::TimelineEvent;
use super::trial_clock;
use tomcom_core::base::time::SessionTime;

/// Time between the freeze of the task and the first question, in seconds: the kitchen disappears from the display
/// before any question is shown.
const BLANK_S: f64 = 1.0;

/// What the rules of freeze probes require next.
#[derive(Clone, Debug, PartialEq)]
pub enum DueProbeEvent {
    /// A freeze probe begins; its questions have to be drawn.
    Begin {
        /// Number of the freeze probe within the trial, counted from 1.
        probe: u32,
        /// Whether the schedule or the wizard caused the probe.
        origin: ProbeOrigin,
        /// Whether the belief estimate influences the choice of the probe's questions.
        uses_estimate: bool,
    },
    /// Any event of a freeze probe except its beginning is due.
    Event(ProbeEvent),
}

/// The next due event of freeze probes and its time; none without freeze probes, and while a probe is paused.
pub fn upcoming(session: &Session) -> Option<(SessionTime, DueProbeEvent)> {
    let spec = of_trial(&session.spec)?;
    match &session.probes.open {
        Some(open) => in_probe(session, spec, open),
        None if session.is_running() => to_begin(session, spec),
        None => None,
    }
}

fn in_probe(session: &Session, spec: &ProbeSpec, open: &StartedProbe) -> Option<(SessionTime, DueProbeEvent)> {
    let (now, probe) = (session.time, open.number);
    let when = |at, seconds| open.when(at, SessionTime::from_secs_f64(seconds)).max(now);
    let closes = |at, reason| Some((at, DueProbeEvent::Event(ProbeEvent::Closed { probe, reason })));
    if let TrialPhase::Over(_) = session.phase {
        return closes(now, ProbeEndReason::TrialEnded);
    }
    if open.is_paused() {
        return None;
    }
    if let Some((_, closed)) = open.closed {
        return Some((when(closed, spec.count_down_s), DueProbeEvent::Event(ProbeEvent::Ended { probe })));
    }
    if open.skipped.is_some() {
        return closes(now, ProbeEndReason::Skipped);
    }
    let next = open.shown.map_or(0, |shown| shown + 1);
    let asked = match open.shown {
        None => when(open.begun, BLANK_S),
        Some(_) => now,
    };
    let limit = when(open.begun, spec.limit_s);
    if open.question().is_some() || limit < asked {
        return closes(limit, ProbeEndReason::TimeOver);
    }
    match next < open.questions.len() {
        true => Some((asked, DueProbeEvent::Event(ProbeEvent::Asked { probe, question: next as u32 + 1 }))),
        false => closes(now, ProbeEndReason::Answered),
    }
}

fn to_begin(session: &Session, spec: &ProbeSpec) -> Option<(SessionTime, DueProbeEvent)> {
    let book = &session.probes;
    let Some(waiting) = &book.waiting else {
        let ScheduledProbe { at, uses_estimate } = *book.schedule.get(book.came_due)?;
        let (at, probe) = (at_clock(session, at), book.numbered + 1);
        return Some((
            at,
            match block(session, spec, at) {
                Some((reason, _)) => DueProbeEvent::Event(ProbeEvent::Delayed { probe, reason }),
                None => DueProbeEvent::Begin { probe, origin: ProbeOrigin::Schedule, uses_estimate },
            },
        ));
    };
    let WaitingProbe { number: probe, origin, uses_estimate, since, reason } = *waiting;
    let begins = DueProbeEvent::Begin { probe, origin, uses_estimate };
    let now = session.time;
    let Some((reason_now, until)) = block(session, spec, now) else { return Some((now, begins)) };
    if reason.is_none() {
        return Some((now, DueProbeEvent::Event(ProbeEvent::Delayed { probe, reason: reason_now })));
    }
    let latest = at_clock(session, since + SessionTime::from_secs_f64(spec.wait_s));
    Some(match until <= latest {
        true => (until, begins),
        false => (latest, DueProbeEvent::Event(ProbeEvent::Dropped { probe, reason: reason_now })),
    })
}

/// Session time at which the running trial's clock will show `clock`; the present session time, if it shows more
/// already.
fn at_clock(session: &Session, clock: SessionTime) -> SessionTime {
    session.time + (clock - session.trial_clock(session.time))
}

/// Why a freeze probe cannot begin at session time `at`, and the session time until which it cannot.
fn block(session: &Session, spec: &ProbeSpec, at: SessionTime) -> Option<(ProbeDelayReason, SessionTime)> {
    let after = SessionTime::from_secs_f64(spec.after_signal_s);
    let last =
        [(ProbeDelayReason::Signal, session.probes.signalled_at), (ProbeDelayReason::Probe, session.probes.ended_at)];
    let blocks = last.into_iter().filter_map(|(reason, last)| {
        let age = session.age(last?, at);
        (age < after).then(|| (reason, at + (after - age)))
    });
    blocks.max_by_key(|(_, until)| *until)
}

/// Whether the session accepts this event of a freeze probe now.
///
/// # Errors
/// Why the session refuses the event, in words for the wizard.
pub(super) fn admit(session: &Session, event: &ProbeEvent) -> Result<(), &'static str> {
    let spec = of_trial(&session.spec).ok_or("this trial has no freeze probes")?;
    let unless = |holds: bool, reason: &'static str| if holds { Ok(()) } else { Err(reason) };
    let book = &session.probes;
    let is_next = |probe: u32| probe == book.waiting.as_ref().map_or(book.numbered + 1, |waiting| waiting.number);
    match event {
        ProbeEvent::Requested => {
            unless(book.open.is_none(), "a freeze probe is running already")?;
            unless(session.phase == TrialPhase::Running, "a freeze probe can begin only while the trial runs")?;
            unless(book.waiting.is_none(), "a freeze probe is waiting already")
        }
        ProbeEvent::Delayed { probe, .. } => {
            unless(session.phase == TrialPhase::Running && is_next(*probe), "this freeze probe is not due")
        }
        ProbeEvent::Dropped { probe, .. } => {
            let waits = book.waiting.as_ref().is_some_and(|waiting| waiting.number == *probe);
            unless(session.phase == TrialPhase::Running && waits, "this freeze probe is not waiting")
        }
        ProbeEvent::Begun { probe, questions, .. } => {
            unless(session.phase == TrialPhase::Running && is_next(*probe), "this freeze probe is not due")?;
            unless(!questions.is_empty(), "a freeze probe needs at least one question")?;
            let fit = questions.iter().all(|question| probe_sampling::fits(&session.kitchen, question));
            unless(fit, "the probe asks about something that the kitchen does not have")
        }
        ProbeEvent::Asked { probe, question } => {
            let open = opened(session, *probe)?;
            let next = open.shown.map_or(1, |shown| shown as u32 + 2);
            unless(open.question().is_none() && *question == next, "another question of the probe comes next")?;
            unless(*question as usize <= open.questions.len(), "the probe has no question with this number")
        }
        ProbeEvent::Answered { probe, question, answer, confidence, .. } => {
            let open = opened(session, *probe)?;
            let (shown, asked) = open.question().ok_or("no question of the probe waits for an answer")?;
            unless(shown as u32 + 1 == *question, "another question of the probe is shown")?;
            unless(!open.is_paused(), "the probe is paused")?;
            let is_choice = answer.as_ref().is_none_or(|answer| asked.choices.contains(answer));
            unless(is_choice, "the probe's question has no such choice")?;
            let is_step = confidence.is_none_or(|step| spec.confidence && (1..=3).contains(&step));
            unless(is_step, "the probe's question has no such confidence")
        }
        ProbeEvent::Skipped { probe, reason } => {
            unless(opened(session, *probe)?.skipped.is_none(), "the probe's questions are over")?;
            unless(!reason.trim().is_empty(), "skipping questions of a probe needs a reason")
        }
        ProbeEvent::Closed { probe, .. } => opened(session, *probe).map(drop),
        ProbeEvent::Ended { probe } => {
            let open = book.open.as_ref().filter(|open| open.number == *probe).ok_or(
                "this freeze probe is not \
                                                                                      running",
            )?;
            unless(open.closed.is_some() && session.phase == TrialPhase::Paused, "the probe's questions are not over")?;
            unless(!open.is_paused(), "the probe is paused")
        }
    }
}

/// The open freeze probe with this number, if its questions have not ended.
fn opened(session: &Session, probe: u32) -> Result<&StartedProbe, &'static str> {
    let open = session.probes.open.as_ref().filter(|open| open.number == probe).ok_or(
        "this freeze probe is not \
                                                                                       running",
    )?;
    match open.closed.is_some() {
        true => Err("the probe's questions are over"),
        false => Ok(open),
    }
}

impl Session {
    /// Duration of the freeze probe that this event, which was just applied, ended; `None` for every other event.
    pub fn probe_pause(&self, stamped: &TimestampedEvent) -> Option<SessionTime> {
        let Event::Probe(ProbeEvent::Ended { .. }) = stamped.event else { return None };
        self.probes.over.last().map(|over| stamped.time - over.begun)
    }

    /// Whether the task is frozen for a freeze probe: from the probe's beginning until the task continues.
    pub fn is_frozen(&self) -> bool {
        self.probes.open.is_some()
    }

    /// Whether the wizard can pause the trial or the open freeze probe now.
    pub fn can_be_paused(&self) -> bool {
        self.is_running() || self.probes.open.as_ref().is_some_and(|open| !open.is_paused())
    }
}

/// Draws the schedule of freeze probes at the start of a trial.
pub(super) fn start(session: &mut Session) {
    session.probes = TrialProbes { schedule: draw(&session.spec, session.trial), ..TrialProbes::default() };
}

/// Applies an event of a freeze probe that the session accepts; returns for how long the task stood still, if the event
/// lets the task continue.
pub(super) fn apply(session: &mut Session, now: SessionTime, event: &ProbeEvent) -> Option<SessionTime> {
    if !matches!(event, ProbeEvent::Asked { .. } | ProbeEvent::Answered { .. }) {
        session.note(now, TimelineEvent::Probe(event.clone()));
    }
    match event {
        ProbeEvent::Requested => {
            let number = session.probes.numbered + 1;
            let uses_estimate = requested_uses_estimate(&session.spec, session.trial, number);
            let since = session.trial_clock(now);
            let (origin, reason) = (ProbeOrigin::Wizard, None);
            session.probes.numbered = number;
            session.probes.waiting = Some(WaitingProbe { number, origin, uses_estimate, since, reason });
        }
        ProbeEvent::Delayed { reason, .. } => {
            let mut waiting = take_due(session, now);
            waiting.reason = Some(*reason);
            session.probes.waiting = Some(waiting);
        }
        ProbeEvent::Dropped { probe, reason } => {
            session.probes.waiting = None;
            session.probes.dropped.push((*probe, *reason));
        }
        ProbeEvent::Begun { origin, uses_estimate, questions, .. } => {
            let number = take_due(session, now).number;
            trial_clock::pause(session, now);
            session.probes.open = Some(StartedProbe {
                number,
                origin: *origin,
                uses_estimate: *uses_estimate,
                questions: questions.clone(),
                shown: None,
                answers: vec![None; questions.len()],
                begun: now,
                asked_at: now,
                skipped: None,
                closed: None,
                paused_since: None,
                pauses: Vec::new(),
            });
        }
        ProbeEvent::Ended { .. } => {
            session.probes.over.extend(session.probes.open.take());
            session.probes.ended_at = Some(now);
            return Some(trial_clock::resume(session, now));
        }
        _ => in_open(session, now, event),
    }
    None
}

/// Applies an event of the open freeze probe, such as a question or an answer.
fn in_open(session: &mut Session, now: SessionTime, event: &ProbeEvent) {
    let is_over = matches!(session.phase, TrialPhase::Over(_));
    let Some(open) = &mut session.probes.open else { return };
    match event {
        ProbeEvent::Asked { question, .. } => {
            open.shown = Some(*question as usize - 1);
            open.asked_at = now;
        }
        ProbeEvent::Answered { answer, confidence, on, .. } => {
            let took = open.age(open.asked_at, now);
            let answer = ProbeAnswer { answer: answer.clone(), confidence: *confidence, took, on: *on };
            if let Some(place) = open.shown.and_then(|shown| open.answers.get_mut(shown)) {
                *place = Some(answer);
            }
        }
        ProbeEvent::Skipped { reason, .. } => open.skipped = Some(reason.clone()),
        ProbeEvent::Closed { reason, .. } => {
            open.closed = Some((*reason, now));
            if is_over {
                session.probes.over.extend(session.probes.open.take());
            }
        }
        _ => {}
    }
}

/// Removes the freeze probe that begins or is delayed: the waiting probe, or else the next one of the schedule.
fn take_due(session: &mut Session, now: SessionTime) -> WaitingProbe {
    let clock = session.trial_clock(now);
    let book = &mut session.probes;
    if let Some(waiting) = book.waiting.take() {
        return waiting;
    }
    let scheduled = book.schedule.get(book.came_due).copied();
    let ScheduledProbe { at, uses_estimate } = scheduled.unwrap_or(ScheduledProbe { at: clock, uses_estimate: false });
    book.came_due += 1;
    book.numbered += 1;
    let (number, origin) = (book.numbered, ProbeOrigin::Schedule);
    WaitingProbe { number, origin, uses_estimate, since: at, reason: None }
}

/// Stops the freeze probe's own time, because the wizard pauses.
pub(super) fn pause(session: &mut Session, now: SessionTime) {
    if let Some(open) = &mut session.probes.open {
        open.paused_since = Some(now);
    }
}

/// Continues the freeze probe after a pause by the wizard.
pub(super) fn resume(session: &mut Session, now: SessionTime) {
    if let Some(open) = &mut session.probes.open
        && let Some(since) = open.paused_since.take()
    {
        open.pauses.push((since, now));
    }
}

/// Handles the end of the trial: a freeze probe in its count-down ends, too; a probe with remaining questions is closed
/// by an event of its own.
pub(super) fn trial_ends(session: &mut Session, now: SessionTime) {
    resume(session, now);
    session.probes.waiting = None;
    if session.probes.open.as_ref().is_some_and(|open| open.closed.is_some()) {
        session.probes.over.extend(session.probes.open.take());
    }
}

/// Handles the end of the session: an open freeze probe ends with the session.
pub(super) fn session_ends(session: &mut Session, now: SessionTime) {
    trial_ends(session, now);
    if let Some(mut open) = session.probes.open.take() {
        open.closed = Some((ProbeEndReason::TrialEnded, now));
        session.probes.over.push(open);
    }
}
