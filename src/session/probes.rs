//! Freeze probes: when one is due, which of its events a session accepts, and what they change.
//!
//! A running session asks `upcoming` after every event and records the event of a probe that is due; a replay
//! applies the recorded events. While a probe is open the trial is paused, and the probe has a time of its own, which
//! stands still while the wizard pauses the probe.

use rand::RngExt;
use serde::{Deserialize, Serialize};

use crate::admit::unless;
use crate::apply::{pause_clock, resume_clock};
use crate::probe_sampling::SOMETHING_ELSE;
use crate::probe_settings::ProbeSpec;
use crate::wall_display::AnswerDevice;
use crate::{Event, Session, SessionSpec, TimestampedEvent, TrialPhase, probe_sampling};
use tomcom_core::base::rng::{Stream, shuffle, stream};
use tomcom_core::base::time::SessionTime;

/// The task stands still, and the participant answers questions about the participant's beliefs (SAGAT, Endsley 1988).
/// Probes have numbers from 1 within a trial, scheduled and requested ones together; questions have numbers from 1
/// within a probe.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "did", rename_all = "snake_case")]
pub enum ProbeEvent {
    /// By the wizard.
    Requested,
    /// It is due but may not begin yet.
    Delayed { probe: u32, reason: ProbeDelayReason },
    /// It has waited for the longest allowed time, and is cancelled.
    Dropped {
        probe: u32,
        /// Why it still had to wait at the end.
        reason: ProbeDelayReason,
    },
    /// The task stands still from now on; all questions are drawn.
    Begun {
        probe: u32,
        origin: ProbeOrigin,
        /// Whether the belief estimate influenced the choice of questions.
        uses_estimate: bool,
        /// In the order in which they are asked.
        questions: Vec<ProbeQuestion>,
    },
    /// Its next question appears.
    Asked { probe: u32, question: u32 },
    /// The shown question gets an answer.
    Answered {
        probe: u32,
        question: u32,
        /// One of the question's choices; `None`: "I don't know".
        #[serde(default, skip_serializing_if = "Option::is_none")]
        answer: Option<String>,
        /// From 1 to 3, if it was asked for.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        confidence: Option<u8>,
        on: AnswerDevice,
    },
    /// The wizard skips the remaining questions.
    Skipped { probe: u32, reason: String },
    /// No more questions are asked: the count-down begins, unless the trial is over.
    Closed { probe: u32, reason: ProbeEndReason },
    /// The task continues.
    Ended { probe: u32 },
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProbeQuestion {
    pub about: ProbeSubject,
    /// The answers that are shown, by their names in the log, in the order in which they are shown; with
    /// [`SOMETHING_ELSE`] for all others, if these are not all.
    pub choices: Vec<String>,
    /// Probability with which this question was drawn, given the settings, the session so far, and the number of
    /// questions.
    pub inclusion: f64,
}

impl ProbeQuestion {
    /// The choice that stands for this value: itself, if it is shown.
    pub fn choice_for<'a>(&self, value: &'a str) -> &'a str {
        match self.choices.iter().any(|choice| choice == value) {
            false if self.choices.iter().any(|choice| choice == SOMETHING_ELSE) => SOMETHING_ELSE,
            _ => value,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(tag = "asks", rename_all = "snake_case")]
pub enum ProbeSubject {
    /// What is there.
    Location { location: String },
    /// What belongs into the dish.
    Recipe { dish: String },
    /// Which order will be served next.
    NextOrder,
    /// What the robot will press next.
    NextPress,
}

/// Why a probe that is due cannot begin yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProbeDelayReason {
    /// A signal was shown a short time before.
    Signal,
    /// Another probe ended a short time before.
    Probe,
}

impl ProbeDelayReason {
    pub fn words(self) -> &'static str {
        match self {
            ProbeDelayReason::Signal => "a signal was shown just before",
            ProbeDelayReason::Probe => "another probe ended just before",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum ProbeOrigin {
    Schedule,
    Wizard,
}

/// Why a probe asks no more questions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum ProbeEndReason {
    Answered,
    TimeOver,
    Skipped,
    TrialEnded,
}

named!(ProbeOrigin, ProbeEndReason);

impl ProbeEndReason {
    pub fn words(self) -> &'static str {
        match self {
            ProbeEndReason::Answered => "all questions of the probe are answered",
            ProbeEndReason::TimeOver => "the questions are over, and not all are answered in time",
            ProbeEndReason::Skipped => "the wizard skipped the other questions",
            ProbeEndReason::TrialEnded => "the trial is over",
        }
    }
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialProbes {
    /// The probe for which the task stands still, from its `begun` to its `ended`.
    pub open: Option<StartedProbe>,
    pub over: Vec<StartedProbe>,
    /// It is due and has not begun.
    pub waiting: Option<WaitingProbe>,
    /// Numbers of the cancelled probes, each with why it had to wait.
    pub dropped: Vec<(u32, ProbeDelayReason)>,
    /// Drawn at the trial's start.
    pub schedule: Vec<ScheduledProbe>,
    /// Number of scheduled probes that have become due.
    pub came_due: usize,
    /// The highest number of a probe so far.
    pub numbered: u32,
    /// When the last signal was shown.
    pub signalled_at: Option<SessionTime>,
    /// When the last probe ended.
    pub ended_at: Option<SessionTime>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct WaitingProbe {
    pub number: u32,
    pub origin: ProbeOrigin,
    pub uses_estimate: bool,
    /// When it became due, on the trial's clock.
    pub since: SessionTime,
    /// Why it has to wait, once that is recorded.
    pub reason: Option<ProbeDelayReason>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct StartedProbe {
    pub number: u32,
    pub origin: ProbeOrigin,
    pub uses_estimate: bool,
    pub questions: Vec<ProbeQuestion>,
    /// Index of the shown question.
    pub shown: Option<usize>,
    /// One for each question.
    pub answers: Vec<Option<ProbeAnswer>>,
    /// When the task was frozen.
    pub begun: SessionTime,
    /// When the shown question appeared.
    pub asked_at: SessionTime,
    /// The wizard's reason for skipping the remaining questions.
    pub skipped: Option<String>,
    /// Why and when the questions ended.
    pub closed: Option<(ProbeEndReason, SessionTime)>,
    pub paused_since: Option<SessionTime>,
    /// Start and end of each finished pause of the probe.
    pub pauses: Vec<(SessionTime, SessionTime)>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct ProbeAnswer {
    /// `None`: "I don't know".
    pub answer: Option<String>,
    /// From 1 to 3.
    pub confidence: Option<u8>,
    /// From the appearance of the question to the answer, without pauses.
    pub took: SessionTime,
    pub on: AnswerDevice,
}

impl StartedProbe {
    pub fn is_paused(&self) -> bool {
        self.paused_since.is_some()
    }

    /// The shown question, which waits for an answer, with its index.
    pub fn question(&self) -> Option<(usize, &ProbeQuestion)> {
        let shown = self.shown.filter(|&shown| self.closed.is_none() && self.answers[shown].is_none())?;
        Some((shown, &self.questions[shown]))
    }

    /// Time from `at` to `now` without the probe's pauses.
    pub fn age(&self, at: SessionTime, now: SessionTime) -> SessionTime {
        let end = self.paused_since.unwrap_or(now).min(now);
        let paused = self.pauses.iter().map(|&(from, until)| until.min(end) - from.max(at));
        paused.fold(end - at, |age, pause| age - pause)
    }

    /// When `after` will have passed since `at`, if no further pause comes.
    pub fn when(&self, at: SessionTime, after: SessionTime) -> SessionTime {
        let paused = self.pauses.iter().map(|&(from, until)| until - from.max(at));
        paused.fold(at + after, |when, pause| when + pause)
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScheduledProbe {
    /// On the trial's clock.
    pub at: SessionTime,
    pub uses_estimate: bool,
}

/// `None` in a practice trial, which does not count.
pub fn of_trial(spec: &SessionSpec) -> Option<&ProbeSpec> {
    let counts = spec.step.as_ref().is_none_or(|step| step.period.is_some());
    spec.probes.as_ref().filter(|_| counts)
}

/// Draws a trial's schedule from a random stream of its own. Each probe comes between once and twice `apart_s` after
/// the previous one (the first: after the trial's start), so that nobody can foresee it; in a trial that is hardly long
/// enough for all, intervals are closer to `apart_s`.
pub fn draw(spec: &SessionSpec, trial: u64) -> Vec<ScheduledProbe> {
    let Some(probes) = of_trial(spec) else { return Vec::new() };
    let mut random = stream(spec.seed, "times of probes", trial);
    let number = probes.per_trial as usize;
    let slack_s = spec.trial.seconds - probes.wait_s - probes.apart_s * number as f64;
    let spread_s = (slack_s / number.max(1) as f64).clamp(0.0, probes.apart_s);
    let mut at_s = 0.0;
    let times: Vec<SessionTime> = (0..number)
        .map(|_| {
            at_s += probes.apart_s + spread_s * random.random::<f64>();
            SessionTime::from_secs_f64(at_s)
        })
        .collect();
    let blind = blind(number, probes.blind_share, &mut random);
    times.into_iter().zip(blind).map(|(at, is_blind)| ScheduledProbe { at, uses_estimate: !is_blind }).collect()
}

/// Which probes are blind: a share of them, in random order. A fractional remainder of the number is the probability of
/// one more.
fn blind(number: usize, share: f64, random: &mut Stream) -> Vec<bool> {
    let wanted = number as f64 * share;
    let count = wanted.floor() as usize + usize::from(random.random::<f64>() < wanted.fract());
    let mut blind: Vec<bool> = (0..number).map(|index| index < count).collect();
    shuffle(&mut blind, random);
    blind
}

/// Drawn at random, as for scheduled probes.
fn requested_uses_estimate(spec: &SessionSpec, trial: u64, number: u32) -> bool {
    let share = spec.probes.as_ref().map_or(0.0, |probes| probes.blind_share);
    let name = format!("requested probes of trial {trial}");
    stream(spec.seed, &name, u64::from(number)).random::<f64>() >= share
}

/// Time between the freeze and the first question: the kitchen disappears before any question is shown.
const BLANK_S: f64 = 1.0;

/// What the rules require next.
#[derive(Clone, Debug, PartialEq)]
pub enum DueProbeEvent {
    /// Its questions have to be drawn.
    Begin { probe: u32, origin: ProbeOrigin, uses_estimate: bool },
    /// Any event but the beginning.
    Event(ProbeEvent),
}

/// The next due event and its time; `None` without freeze probes, and while a probe is paused.
pub(crate) fn upcoming(session: &Session) -> Option<(SessionTime, DueProbeEvent)> {
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
    let at = match open.question() {
        _ if open.shown.is_none() => when(open.begun, BLANK_S),
        Some(_) => when(open.asked_at, spec.limit_s),
        None => now,
    };
    match next < open.questions.len() {
        true => Some((at, DueProbeEvent::Event(ProbeEvent::Asked { probe, question: next as u32 + 1 }))),
        false if open.answers.iter().all(Option::is_some) => closes(at, ProbeEndReason::Answered),
        false => closes(at, ProbeEndReason::TimeOver),
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

/// When the running trial's clock will show `clock`; now, if it shows more already.
fn at_clock(session: &Session, clock: SessionTime) -> SessionTime {
    session.time + (clock - session.trial_clock(session.time))
}

/// Why no probe can begin at `at`, and until when.
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

pub(crate) fn admit(session: &Session, event: &ProbeEvent) -> Result<(), &'static str> {
    let spec = of_trial(&session.spec).ok_or("this trial has no freeze probes")?;
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
            unless(*question == next, "another question of the probe comes next")?;
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
            let open =
                book.open.as_ref().filter(|open| open.number == *probe).ok_or("this freeze probe is not running")?;
            unless(open.closed.is_some() && session.phase == TrialPhase::Paused, "the probe's questions are not over")?;
            unless(!open.is_paused(), "the probe is paused")
        }
    }
}

/// The open probe with this number, if its questions have not ended.
fn opened(session: &Session, probe: u32) -> Result<&StartedProbe, &'static str> {
    let open =
        session.probes.open.as_ref().filter(|open| open.number == probe).ok_or("this freeze probe is not running")?;
    unless(open.closed.is_none(), "the probe's questions are over")?;
    Ok(open)
}

impl Session {
    /// Duration of the probe that this event, which was just applied, ended.
    pub fn probe_pause(&self, stamped: &TimestampedEvent) -> Option<SessionTime> {
        let Event::Probe(ProbeEvent::Ended { .. }) = stamped.event else { return None };
        self.probes.over.last().map(|over| stamped.time - over.begun)
    }

    /// Whether the task is frozen: from a probe's beginning until the task continues.
    pub fn is_frozen(&self) -> bool {
        self.probes.open.is_some()
    }

    /// Whether the wizard can pause the trial or the open probe now.
    pub fn can_be_paused(&self) -> bool {
        self.is_running() || self.probes.open.as_ref().is_some_and(|open| !open.is_paused())
    }
}

pub(crate) fn start(session: &mut Session) {
    session.probes = TrialProbes { schedule: draw(&session.spec, session.trial), ..TrialProbes::default() };
}

/// Returns for how long the task stood still, if the event lets it continue.
pub(crate) fn apply(session: &mut Session, now: SessionTime, event: &ProbeEvent) -> Option<SessionTime> {
    if !matches!(event, ProbeEvent::Asked { .. } | ProbeEvent::Answered { .. }) {
        session.note_event(now, &Event::Probe(event.clone()));
    }
    match event {
        ProbeEvent::Requested => {
            session.probes.numbered += 1;
            let number = session.probes.numbered;
            session.probes.waiting = Some(WaitingProbe {
                number,
                origin: ProbeOrigin::Wizard,
                uses_estimate: requested_uses_estimate(&session.spec, session.trial, number),
                since: session.trial_clock(now),
                reason: None,
            });
        }
        ProbeEvent::Delayed { reason, .. } => {
            session.probes.waiting = Some(WaitingProbe { reason: Some(*reason), ..take_due(session, now) });
        }
        ProbeEvent::Dropped { probe, reason } => {
            session.probes.waiting = None;
            session.probes.dropped.push((*probe, *reason));
        }
        ProbeEvent::Begun { origin, uses_estimate, questions, .. } => {
            let number = take_due(session, now).number;
            pause_clock(session, now);
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
            return Some(resume_clock(session, now));
        }
        _ => in_open(session, now, event),
    }
    None
}

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

/// Removes the probe that begins or is delayed: the waiting one, or else the next one of the schedule.
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

/// The wizard pauses: the probe's own time stops.
pub(crate) fn pause(session: &mut Session, now: SessionTime) {
    if let Some(open) = &mut session.probes.open {
        open.paused_since = Some(now);
    }
}

pub(crate) fn resume(session: &mut Session, now: SessionTime) {
    if let Some(open) = &mut session.probes.open
        && let Some(since) = open.paused_since.take()
    {
        open.pauses.push((since, now));
    }
}

/// A probe in its count-down ends with the trial; one with remaining questions is closed by an event of its own.
pub(crate) fn trial_ends(session: &mut Session, now: SessionTime) {
    resume(session, now);
    session.probes.waiting = None;
    if session.probes.open.as_ref().is_some_and(|open| open.closed.is_some()) {
        session.probes.over.extend(session.probes.open.take());
    }
}

pub(crate) fn session_ends(session: &mut Session, now: SessionTime) {
    trial_ends(session, now);
    if let Some(mut open) = session.probes.open.take() {
        open.closed = Some((ProbeEndReason::TrialEnded, now));
        session.probes.over.push(open);
    }
}
