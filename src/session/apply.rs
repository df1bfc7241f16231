//! `apply(&mut Session, &TimestampedEvent)`: the only function that changes a session, by applying one event; and the
//! effects that a running session then has to perform.

use crate::admit::{admit, is_too_early};
use crate::event::{SignalEndReason, TrialEndReason};
use crate::gaze_samples::{note_loss, take_sample};
use crate::tracker::TrackerEvent;
use crate::{
    Event, ServedOrder, Session, ShownSignal, TimelineEntry, TimelineEvent, TimestampedEvent, TrialPhase, gaze_check,
    offers, probes, protocol,
};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::offer::{GAP, HOLD, OfferCloseReason, OfferHistory};
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::communication::{Sender, Signal};
use tomcom_core::kitchen::{
    Agent, ButtonAction, ButtonId, ContentId, DishId, KitchenChange, LocationId, OrderContent, Press, State,
};
use tomcom_core::robot::ArmStage;

/// The session cannot accept an event: the log is damaged or was written by another program.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{found}; right would be {remedy}")]
pub struct ApplyError {
    pub seq: u64,
    pub found: String,
    pub remedy: String,
}

#[derive(Clone, Debug, PartialEq)]
pub struct AppliedEvent {
    pub effects: Vec<SessionEffect>,
    pub change: KitchenChange,
}

/// Applies an event. Unknown names, decreasing times and events that [`admit`] refuses are errors; the session is
/// unchanged then. Whoever reads a log checks the sequence number.
pub fn apply(session: &mut Session, stamped: &TimestampedEvent) -> Result<AppliedEvent, ApplyError> {
    let (named, now) = (Named { session, seq: stamped.seq }, stamped.time);
    if now < session.time {
        let found = format!("t_ns = {} after {}", now.0, session.time.0);
        return Err(named.error(found, "times that never decrease"));
    }
    if let Err(reason) = admit(session, &stamped.event) {
        let found = format!("\"{}\", but {reason}", stamped.event.kind());
        return Err(named.error(found, "an event that is possible at this point of the session"));
    }
    let (mut effects, mut change) = (Vec::new(), KitchenChange::None);
    match &stamped.event {
        Event::TrialStarted => {
            session.cue = Some(stamped.seq);
            change = start(session, now, &mut effects);
        }
        Event::TrialPaused => pause(session, now),
        Event::TrialResumed => resume(session, now, &mut effects),
        Event::TrialEnded { reason } => {
            session.cue = Some(stamped.seq);
            end_trial(session, now, *reason, &mut effects);
        }
        Event::TrialAborted { reason } => {
            session.cue = Some(stamped.seq);
            session.aborted = Some(reason.clone());
            end_trial(session, now, TrialEndReason::Aborted, &mut effects);
        }
        Event::TrialExcluded { reason } => {
            session.excluded = Some(reason.clone());
            session.note_event(now, &stamped.event);
        }
        Event::TrialIncluded => {
            session.excluded = None;
            session.note_event(now, &stamped.event);
        }
        Event::FocusLost | Event::FocusRegained | Event::RobotTouched { .. } => {
            session.note_event(now, &stamped.event);
        }
        Event::Gaze(sample) => take_sample(session, now, *sample),
        Event::Tracker(event) => {
            session.tracker.apply(now, event);
            if matches!(event, TrackerEvent::Connected { .. } | TrackerEvent::Lost { .. }) {
                session.note_event(now, &stamped.event);
            }
        }
        Event::ButtonBox(event) => session.button_box.apply(now, event),
        Event::Calibration(event) => gaze_check::apply(session, now, event),
        Event::Press { agent, button: name, button_box, .. } => {
            let button = named.button(*agent, name)?;
            if *button_box {
                session.button_box.note_press(now, name);
            }
            change = press(session, now, *agent, button, &mut effects);
        }
        Event::OrderShown { order, dish } => {
            let (order, dish) = (named.order(order)?, named.dish(dish)?);
            change = set_order(session, now, order, OrderContent::Dish(dish));
            session.note(now, TimelineEvent::OrderShown { order });
        }
        Event::OrderCleared { order } => {
            let order = named.order(order)?;
            change = set_order(session, now, order, OrderContent::None);
        }
        Event::RobotIntends { button, until_ns, initiative } => {
            let button = named.button(Agent::Robot, button)?;
            session.robot.sets_out(button, now, *until_ns, *initiative);
        }
        Event::RobotAborts { button, reason } => {
            named.button(Agent::Robot, button)?;
            session.robot.gives_up(*reason);
        }
        Event::RobotIdles { reason, waits_for } => {
            let waits_for =
                waits_for.iter().map(|button| named.button(Agent::Human, button)).collect::<Result<_, _>>()?;
            session.robot.idle = Some((*reason, waits_for));
        }
        Event::RobotMoves(moment) => session.robot.arm.last = Some((now, *moment)),
        Event::RobotSafety { mode, force_n, joint } => {
            let arm = &mut session.robot.arm;
            (arm.mode, arm.stopped_by_n, arm.stopped_by_joint) = (*mode, *force_n, *joint);
            // A stop by the wizard has an event of its own, so only other stops are noted here.
            if mode.is_stopped() && !session.robot.stopped {
                session.robot.stopped = true;
                session.robot.idle = None;
                session.note_event(now, &stamped.event);
            }
        }
        Event::RobotStage { stage, found } => {
            session.robot.arm.stage = Some((*stage, found.clone()));
            let has_begun = matches!(session.phase, TrialPhase::Running | TrialPhase::Paused);
            // While the arm starts again, the wizard has let it go on.
            let stops = matches!(stage, ArmStage::Lost | ArmStage::Off | ArmStage::Stopped);
            if stops && has_begun && !session.robot.stopped {
                session.robot.stopped = true;
                session.robot.idle = None;
                session.note_event(now, &stamped.event);
            }
        }
        Event::RobotStopped | Event::RobotResumed => {
            session.robot.stopped = stamped.event == Event::RobotStopped;
            session.robot.idle = None;
            session.note_event(now, &stamped.event);
        }
        Event::RobotHeld { .. } | Event::RobotReleased { .. } => {
            session.robot.held = matches!(stamped.event, Event::RobotHeld { .. });
            session.robot.idle = None;
            session.note_event(now, &stamped.event);
        }
        Event::RobotSkipped { .. } => {
            if let Some((button, ..)) = session.robot.intention {
                session.note(now, TimelineEvent::RobotSkipped(button));
            }
        }
        Event::RobotDriven { button, .. } => {
            let button = named.button(Agent::Robot, button)?;
            session.robot.driven_to = Some(button);
            session.note_event(now, &stamped.event);
        }
        Event::KitchenCorrected { location, content } => {
            let (location, content) = (named.location(location)?, named.content(content)?);
            let (before, after) = update(session, now, |state| state.set_content(location, content));
            change = KitchenChange::Correction { location, before, after };
            session.note_event(now, &stamped.event);
        }
        Event::Advised(advice) => advise(session, advice.clone()),
        Event::External(event) => session.external.apply(event),
        Event::OfferOpened(advice) => {
            session.offers.opens(stamped.seq, now, advice.clone());
            effects.push(SessionEffect::At { time: now + HOLD, timer: Timer::ReviewOffer });
        }
        Event::OfferClosed { reason, .. } => {
            session.offers.closes(now, *reason);
            effects.push(SessionEffect::At { time: now + GAP, timer: Timer::ReviewOffer });
        }
        Event::SignalShown { by, signal, offer, .. } => {
            let location = signal.target().map(|name| named.location(name)).transpose()?;
            session.cue = Some(stamped.seq);
            session.probes.signalled_at = Some(now);
            if *by == Sender::Wizard {
                offers::sends(session, now, signal, offer.is_some());
            }
            show(session, now, *by, (signal, location), &mut effects);
            session.note_event(now, &stamped.event);
        }
        Event::SignalEnded { reason } => {
            end_signal(session, *reason, &mut effects);
            if *reason == SignalEndReason::TakenBack {
                session.note_event(now, &stamped.event);
            }
        }
        Event::Marker { note: text, .. } => {
            session.note_event(now, &stamped.event);
            if text.is_empty() {
                session.open_marks.push((stamped.seq, now));
            }
        }
        Event::MarkerWorded { marker, note } => word_mark(session, *marker, note),
        Event::Probe(event) => effects.extend(probes::apply(session, now, event).map(SessionEffect::Postpone)),
        Event::Protocol(event) => protocol::apply(session, event, now),
        Event::Unblinded { .. } => session.unblinded = true,
        Event::Screen(_) => session.has_console = true,
        Event::HumanWaits { .. } => await_press(session, now, &mut effects),
        Event::Preflight { .. } | Event::Display(_) | Event::Film(_) | Event::SignalDrawn { .. } => {}
        Event::RobotConfirmed { .. } => {}
        Event::ClockJumped { .. } | Event::ParticipantBelieves(_) | Event::BeliefEstimated(_) => {}
        Event::SessionEnded => close(session, now, &mut effects),
    }
    session.time = now;
    Ok(AppliedEvent { effects, change })
}

/// Looks up what an event names in the session's kitchen.
struct Named<'a> {
    session: &'a Session,
    seq: u64,
}

impl Named<'_> {
    fn error(&self, found: String, remedy: &str) -> ApplyError {
        ApplyError { seq: self.seq, found, remedy: remedy.to_string() }
    }

    fn button(&self, agent: Agent, name: &str) -> Result<ButtonId, ApplyError> {
        let button = self.session.kitchen.button_named(agent, name);
        button.ok_or_else(|| self.error(format!("a press of \"{name}\""), "a button that the agent has in the layout"))
    }

    fn location(&self, name: &str) -> Result<LocationId, ApplyError> {
        let location = self.session.kitchen.location_named(name);
        location.ok_or_else(|| self.error(format!("the location \"{name}\""), "a location of the layout"))
    }

    fn order(&self, name: &str) -> Result<LocationId, ApplyError> {
        let order = self.location(name)?;
        match self.session.kitchen.orders.contains(&order) {
            true => Ok(order),
            false => Err(self.error(format!("the order \"{name}\""), "an order of the layout")),
        }
    }

    fn content(&self, name: &str) -> Result<ContentId, ApplyError> {
        let content = self.session.kitchen.content_named(name);
        content.ok_or_else(|| self.error(format!("the content \"{name}\""), "a content of the kitchen"))
    }

    fn dish(&self, name: &str) -> Result<DishId, ApplyError> {
        let dish = self.session.kitchen.dish_named(name);
        dish.ok_or_else(|| self.error(format!("the dish \"{name}\""), "a dish of the recipe file"))
    }
}

/// Changes the kitchen's state and notes which locations changed; returns the state before and after.
fn update(session: &mut Session, now: SessionTime, how: impl FnOnce(&mut State)) -> (State, State) {
    let before = session.state;
    how(&mut session.state);
    for location in session.kitchen.changed(before, session.state) {
        session.changed_at[location.index()] = now;
    }
    (before, session.state)
}

fn set_order(session: &mut Session, now: SessionTime, order: LocationId, content: OrderContent) -> KitchenChange {
    let (before, after) = update(session, now, |state| state.set_order(order, content));
    KitchenChange::Order { order, before, after }
}

fn start(session: &mut Session, now: SessionTime, effects: &mut Vec<SessionEffect>) -> KitchenChange {
    session.phase = TrialPhase::Running;
    session.trial_start = now;
    session.paused_total = SessionTime::ZERO;
    session.presses = [0; 2];
    session.served.clear();
    session.offers = OfferHistory::default();
    probes::start(session);
    let empty = session.kitchen.empty_state();
    let (before, after) = update(session, now, |state| *state = empty);
    session.note(now, TimelineEvent::Trial(TrialPhase::Running));
    let end = now + SessionTime::from_secs_f64(session.spec.trial.seconds);
    effects.push(SessionEffect::At { time: end, timer: Timer::EndTrial });
    for &order in &session.kitchen.orders {
        effects.push(SessionEffect::At { time: now, timer: Timer::NewOrder(order) });
    }
    await_press(session, now, effects);
    KitchenChange::TrialStarted { before, after }
}

/// Writes the words of a time mark where the mark stands in the timeline.
fn word_mark(session: &mut Session, marker: u64, note: &str) {
    let Some(index) = session.open_marks.iter().position(|(mark, _)| *mark == marker) else { return };
    let (_, at) = session.open_marks.remove(index);
    let mark = |note: &str| TimelineEvent::Noted(Event::Marker { note: note.to_string(), observer: None });
    let is_it = |entry: &&mut TimelineEntry| entry.time == at && entry.what == mark("");
    if let Some(entry) = session.timeline.iter_mut().find(is_it) {
        entry.what = mark(note);
    }
}

fn await_press(session: &Session, now: SessionTime, effects: &mut Vec<SessionEffect>) {
    let time = now + unusual_silence(session);
    effects.push(SessionEffect::At { time, timer: Timer::HumanWaits });
}

fn pause(session: &mut Session, now: SessionTime) {
    match session.is_frozen() {
        true => probes::pause(session, now),
        false => pause_clock(session, now),
    }
    session.note(now, TimelineEvent::Trial(TrialPhase::Paused));
}

/// Pending times are postponed by the pause. After a pause during a freeze probe, the probe continues.
fn resume(session: &mut Session, now: SessionTime, effects: &mut Vec<SessionEffect>) {
    if session.is_frozen() {
        return probes::resume(session, now);
    }
    effects.push(SessionEffect::Postpone(resume_clock(session, now)));
    session.note(now, TimelineEvent::Trial(TrialPhase::Running));
}

fn end_trial(session: &mut Session, now: SessionTime, reason: TrialEndReason, effects: &mut Vec<SessionEffect>) {
    note_loss(session, now);
    stop_clock(session, now);
    session.phase = TrialPhase::Over(reason);
    probes::trial_ends(session, now);
    session.robot.rests();
    session.shown = None;
    session.advice = None;
    effects.push(SessionEffect::CancelAll);
    session.note(now, TimelineEvent::Trial(session.phase));
}

fn close(session: &mut Session, now: SessionTime, effects: &mut Vec<SessionEffect>) {
    stop_clock(session, now);
    session.ended_early = !session.is_step_done();
    session.phase = TrialPhase::Closed;
    probes::session_ends(session, now);
    session.robot.intention = None;
    session.shown = None;
    session.offers.closes(now, OfferCloseReason::TrialEnded);
    session.advice = None;
    effects.push(SessionEffect::CancelAll);
}

fn show(
    session: &mut Session,
    now: SessionTime,
    by: Sender,
    (signal, location): (&Signal, Option<LocationId>),
    effects: &mut Vec<SessionEffect>,
) {
    let until = now + SessionTime::from_secs_f64(session.spec.signals.shown_s);
    let advised =
        session.advice.as_ref().filter(|advice| by == Sender::Assistant && advice.best.as_ref() == Some(signal));
    let (reason, words) = advised.map_or((None, None), |advice| (advice.reason.clone(), advice.words.clone()));
    session.shown = Some(ShownSignal { reason, words, signal: signal.clone(), location, by, since: now, until });
    if by == Sender::Wizard {
        session.signalled_at = Some(now);
        let cool_down = SessionTime::from_secs_f64(session.spec.signals.cool_down_s);
        effects.push(SessionEffect::At { time: now + cool_down, timer: Timer::ReviewOffer });
        if let Some(advice) = &mut session.advice {
            advice.remove(signal);
        }
    }
    effects.push(SessionEffect::Cancel(Timer::EndSignal));
    effects.push(SessionEffect::At { time: until, timer: Timer::EndSignal });
}

/// Stores a recommendation, without a signal that was sent since it was requested.
fn advise(session: &mut Session, mut advice: Recommendation) {
    let shown = session.shown.as_ref().filter(|shown| shown.by == Sender::Wizard && shown.since >= advice.for_ns);
    if let Some(shown) = shown {
        advice.remove(&shown.signal);
    }
    session.advice = Some(advice);
}

fn end_signal(session: &mut Session, reason: SignalEndReason, effects: &mut Vec<SessionEffect>) {
    session.shown = None;
    if reason != SignalEndReason::Elapsed {
        effects.push(SessionEffect::Cancel(Timer::EndSignal));
    }
}

fn press(
    session: &mut Session,
    now: SessionTime,
    agent: Agent,
    button: ButtonId,
    effects: &mut Vec<SessionEffect>,
) -> KitchenChange {
    if agent == Agent::Robot {
        session.robot.intention = None;
        session.robot.driven_to = None;
        session.robot.initiative_presses += u32::from(session.robot.initiative && session.is_running());
    }
    if !session.is_running() || (agent == Agent::Human && is_too_early(session, now)) {
        return KitchenChange::UncountedPress { agent, button };
    }
    let kitchen = session.kitchen.clone();
    let press = kitchen.try_press(session.state, agent, button);
    let no_effect = kitchen.no_effect(session.state, agent, button);
    session.presses[agent.index()] += 1;
    let Press { before, after, .. } = press;
    session.note(now, TimelineEvent::Press { agent, button, before, after, no_effect });
    if agent == Agent::Human {
        effects.push(SessionEffect::Cancel(Timer::HumanWaits));
        await_press(session, now, effects);
    }
    if press.effective {
        update(session, now, |state| *state = press.after);
        if let ButtonAction::Serve(order) = kitchen.button(agent, button).action
            && let OrderContent::Dish(dish) = press.before.order(order)
        {
            let presses = session.all_presses();
            session.served.push(ServedOrder { time: now, dish, presses });
            session.note(now, TimelineEvent::Served { order });
            let after_s = |seconds| now + SessionTime::from_secs_f64(seconds);
            effects.push(SessionEffect::At { time: after_s(kitchen.served_shown_s), timer: Timer::ClearOrder(order) });
            effects.push(SessionEffect::At { time: after_s(kitchen.new_order_after_s), timer: Timer::NewOrder(order) });
        }
        if session.spec.trial.orders.is_some_and(|orders| session.served.len() >= orders as usize) {
            effects.push(SessionEffect::At { time: now, timer: Timer::EndTrialByOrders });
        }
    }
    if session.all_presses() >= session.spec.trial.presses {
        effects.push(SessionEffect::At { time: now, timer: Timer::EndTrialByPresses });
    }
    KitchenChange::Press { press, presses: session.presses }
}

/// An action that the running session must perform after an event. A replay performs none.
#[derive(Clone, Debug, PartialEq)]
pub enum SessionEffect {
    At { time: SessionTime, timer: Timer },
    Cancel(Timer),
    CancelAll,
    Postpone(SessionTime),
}

/// What happens when a timer is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Timer {
    /// The location stops showing `served`.
    ClearOrder(LocationId),
    /// A new order appears; the running session draws the dish.
    NewOrder(LocationId),
    EndSignal,
    EndTrial,
    EndTrialByPresses,
    EndTrialByOrders,
    /// The rules of offers are asked whether an offer opens or closes.
    ReviewOffer,
    HumanWaits,
}

pub(crate) fn pause_clock(session: &mut Session, now: SessionTime) {
    stop_clock(session, now);
    session.phase = TrialPhase::Paused;
    session.gaze.measured = None;
}

fn stop_clock(session: &mut Session, now: SessionTime) {
    match session.phase {
        TrialPhase::Running => session.paused_at = now,
        TrialPhase::Ready => {
            session.trial_start = now;
            session.paused_at = now;
        }
        _ => {}
    }
}

/// Returns for how long the trial stood still, by which all pending times have to be postponed.
pub(crate) fn resume_clock(session: &mut Session, now: SessionTime) -> SessionTime {
    let by = now - session.paused_at;
    session.pauses.push((session.paused_at, now));
    session.gaze.measured = None;
    session.paused_total = session.paused_total + by;
    session.phase = TrialPhase::Running;
    if let Some((_, _, until)) = &mut session.robot.intention {
        *until = *until + by;
    }
    if let Some(shown) = &mut session.shown {
        shown.until = shown.until + by;
    }
    by
}

const SILENT_INTERVALS: u64 = 3;
/// Three usual intervals of the paper's participants.
const LEAST_SILENCE: SessionTime = SessionTime(6_000_000_000);

/// The time without a press after which silence is unusual, and the human may be stuck: three of the human's usual
/// intervals in this trial (the median, without pauses), and at least 6 s. The timer is set at the trial's start, at
/// each counted press of the human and at each `human_waits`, so this event comes once for every such time.
fn unusual_silence(session: &Session) -> SessionTime {
    let times: Vec<SessionTime> = own_presses(session).collect();
    let mut intervals: Vec<SessionTime> = times.windows(2).map(|pair| session.age(pair[1], pair[0])).collect();
    intervals.sort_unstable();
    let usual = intervals.get(intervals.len() / 2).copied().unwrap_or_default();
    SessionTime(SILENT_INTERVALS * usual.0).max(LEAST_SILENCE)
}

/// For how long the human has not pressed, without pauses; before the first press, since the trial's start.
pub fn silence_so_far(session: &Session, now: SessionTime) -> SessionTime {
    session.age(own_presses(session).next().unwrap_or(session.trial_start), now)
}

/// Times of the human's counted presses, the latest first.
pub(crate) fn own_presses(session: &Session) -> impl Iterator<Item = SessionTime> + '_ {
    let is_own = |what: &TimelineEvent| matches!(what, TimelineEvent::Press { agent: Agent::Human, .. });
    session.timeline.iter().rev().filter(move |entry| is_own(&entry.what)).map(|entry| entry.time)
}
