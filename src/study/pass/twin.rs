//! Usefulness of the signals in a simulated trial, judged by running the trial without these signals (unassisted
//! twins).
//!
//! The trial is run again from its recording. At every signal the run is copied, and the copy (the twin) continues with
//! the same random streams and without this or any later signal, until the false beliefs that the signal is about have
//! ended. The signal is useful if the twin has more errors from these beliefs than the trial had until the beliefs
//! ended there. A proposal of k presses is useful if the twin has more errors in its next k presses, whatever their
//! cause, so that a prevented slip counts, too.

use std::collections::VecDeque;
use std::path::Path;

use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::communication::recommendation::aspects_told;
use tomcom_core::kitchen::AspectId;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::measures::attribution::ErrorCause;
use tomcom_core::measures::sequences::FalseBeliefEpisode;
use tomcom_session::admit::is_external;
use tomcom_session::engine::SessionEngine;
use tomcom_session::files::file_error::FileResult;
use tomcom_session::follower::SessionFollower;
use tomcom_session::headless::SimulatedRobotOperator;
use tomcom_session::log::{LogReader, event_line};
use tomcom_session::settings::Condition;
use tomcom_session::{Event, Session, TimestampedEvent, TrialPhase};

/// Which errors a signal can prevent.
enum SignalScope {
    /// The signal can prevent errors that follow from false beliefs about these state aspects.
    Beliefs(Vec<AspectId>),
    /// The signal can prevent errors in this number of next presses.
    Presses(usize),
}

impl SignalScope {
    fn of_signal(session: &Session, signal: &Signal) -> SignalScope {
        match signal {
            Signal::Propose(presses) => SignalScope::Presses(presses.len()),
            signal => SignalScope::Beliefs(aspects_told(&session.kitchen, session.state, signal)),
        }
    }
}

/// A signal of the trial, with the errors of the twin that continues without it.
struct TwinResult {
    time: SessionTime,
    scope: SignalScope,
    /// Number of errors in the twin that the signal could have prevented.
    errors: u64,
}

/// Number of useful signals of a recorded trial of a simulated participant. `cost`: the cost to go of the trial's
/// kitchen, whose caches may be filled. `None` if the trial cannot be run again: the program version that recorded it
/// had other simulated participants, or this build lacks the robot's arm.
///
/// # Errors
/// The recording cannot be read.
pub(super) fn useful_signals(recording: &Path, cost: CostToGo) -> FileResult<Option<u64>> {
    let mut log = LogReader::open(recording)?;
    let (kitchen, header) = (log.kitchen.clone(), log.header.clone());
    if header.session.require_built().is_err() {
        return Ok(None);
    }
    let mut again = SessionEngine::for_header(kitchen, &header, cost);
    let (mut produced, mut twins) = (VecDeque::new(), Vec::new());
    while let Some(line) = log.next_line()? {
        if produced.is_empty() {
            produced.extend(run_to(&mut again, &line.stamped, &mut twins));
        }
        let same = produced.pop_front().is_some_and(|one: TimestampedEvent| event_line(&one) == line.text);
        if !same {
            return Ok(None);
        }
    }
    let trial = again.into_follower();
    let is_useful = |one: &&TwinResult| one.errors > errors_after(&trial, one.time, &one.scope);
    Ok(Some(twins.iter().filter(is_useful).count() as u64))
}

/// Runs the session up to a recorded event, and a twin for every signal before that event. Recommendations are taken
/// from the recording.
fn run_to(
    again: &mut SessionEngine,
    recorded: &TimestampedEvent,
    twins: &mut Vec<TwinResult>,
) -> Vec<TimestampedEvent> {
    let is_signal = match &recorded.event {
        Event::SignalShown { .. } => true,
        Event::Advised(advice) => {
            let may_act = advice.best.is_some() || advice.proposal.is_some();
            may_act && again.session().spec.trial.condition == Condition::Assistant
        }
        _ => false,
    };
    let before = is_signal.then(|| again.clone());
    let mut events = Vec::new();
    if is_external(again.session(), &recorded.event) {
        events = again.input(recorded.time, recorded.event.clone()).events;
    } else {
        // The participant can act without an event, so the next due action is tried until an event occurs.
        while events.is_empty() && again.next_due().is_some_and(|due| due <= recorded.time) {
            events = again.fire();
        }
    }
    let _ = again.take_questions();
    let shown = events.iter().find_map(|stamped| match &stamped.event {
        Event::SignalShown { signal, .. } => Some((stamped.time, signal)),
        _ => None,
    });
    if let (Some(before), Some((time, signal))) = (before, shown) {
        twins.push(twin(before.unassisted(), time, signal));
    }
    events
}

/// Runs a twin (the trial continued without further signals) until the false beliefs that a signal at `time` is about
/// have ended.
fn twin(mut engine: SessionEngine, time: SessionTime, signal: &Signal) -> TwinResult {
    let scope = SignalScope::of_signal(engine.session(), signal);
    let presses = engine.judged().len();
    let mut attendant = SimulatedRobotOperator::default();
    while engine.session().phase == TrialPhase::Running || engine.session().is_frozen() {
        attendant.step(&mut engine);
        let _ = engine.take_questions();
        // The belief is over once the twin's recorded beliefs, which are recorded before each press, say so.
        let is_over = match &scope {
            SignalScope::Beliefs(told) => {
                let corrected = open_at(engine.follower(), time, told).all(|episode| episode.corrected.is_some());
                corrected && engine.judged().len() > presses
            }
            SignalScope::Presses(next) => engine.judged().len() >= presses + next,
        };
        if is_over {
            break;
        }
    }
    let errors = errors_after(engine.follower(), time, &scope);
    TwinResult { time, scope, errors }
}

/// False belief episodes about these state aspects that were open at this time.
fn open_at<'a>(
    follower: &'a SessionFollower,
    time: SessionTime,
    told: &'a [AspectId],
) -> impl Iterator<Item = &'a FalseBeliefEpisode> {
    let is_open =
        move |episode: &&FalseBeliefEpisode| episode.began <= time && episode.corrected.is_none_or(|end| end > time);
    follower.episodes.all().filter(|episode| told.contains(&episode.aspect)).filter(is_open)
}

/// Number of errors after this time that a signal sent at this time can prevent.
fn errors_after(follower: &SessionFollower, time: SessionTime, scope: &SignalScope) -> u64 {
    match scope {
        SignalScope::Beliefs(told) => belief_errors_after(follower, time, told),
        SignalScope::Presses(next) => {
            let after = follower.judged.iter().filter(|press| press.time > time).take(*next);
            after.filter(|press| press.verdict.error).count() as u64
        }
    }
}

/// Number of errors after this time that follow from false beliefs, held at this time, about the aspects in `told`;
/// errors are counted until each belief is corrected.
fn belief_errors_after(follower: &SessionFollower, time: SessionTime, told: &[AspectId]) -> u64 {
    let kitchen = &follower.session.kitchen;
    let open: Vec<&FalseBeliefEpisode> = open_at(follower, time, told).collect();
    let errors = follower.judged.iter().filter(|press| {
        let Some(ErrorCause::Belief { target, .. }) = press.cause.filter(|_| press.time > time) else { return false };
        let mut aspects = target.aspects(kitchen);
        aspects.any(|aspect| {
            let is_in = |episode: &&FalseBeliefEpisode| episode.corrected.is_none_or(|end| press.time <= end);
            open.iter().filter(|episode| episode.aspect == aspect).any(is_in)
        })
    });
    errors.count() as u64
}
