//! Runs a session in virtual time as fast as possible, by jumping from one due event to the next; and the shards of a
//! simulation.

use std::convert::Infallible;
use std::path::Path;
use std::str::FromStr;

use crate::advisor::{AdviceRequest, Advisor};
use crate::engine::SessionEngine;
use crate::external::concept::ConceptDialogue;
use crate::external::link::{Exchange, WaitedMind};
use crate::external::participant::ParticipantDialogue;
use crate::external::{ExternalMinds, MindDialogue, NoMinds};
use crate::files::file_error::{FileError, FileResult};
use crate::protocol::ProtocolEvent;
use crate::settings::ArmKind;
use crate::{Event, Session, SessionSpec, TimestampedEvent, TrialPhase};
use tomcom_core::base::time::SessionTime;

/// Time after which a simulated attendant resumes an arm that has stopped by itself.
const LOOKS_S: f64 = 3.0;

/// Stands in for a wizard in simulations: resumes an arm that has stopped by itself.
#[derive(Clone, Copy, Debug, Default)]
pub struct SimulatedRobotOperator {
    stopped: Option<SessionTime>,
}

impl SimulatedRobotOperator {
    /// Raises the next internal event, and resumes the arm if it has been stopped for a while.
    pub fn step(&mut self, engine: &mut SessionEngine) -> Vec<TimestampedEvent> {
        let now = engine.next_due().unwrap_or(engine.session().time);
        let mut events = engine.fire();
        self.stopped = engine.session().robot.stopped.then(|| self.stopped.unwrap_or(now));
        if self.stopped.is_some_and(|since| now.secs_since(since) >= LOOKS_S) {
            events.extend(engine.input(now, Event::RobotResumed).events);
        }
        events
    }
}

/// Refuses the settings of a session file that no run without a console can have: a real arm, or what this build lacks.
pub fn require(spec: &SessionSpec, file: &Path) -> FileResult<()> {
    if let ArmKind::Ur(address) = spec.robot.arm {
        let found = format!("arm = {{ ur = \"{address}\" }}: a real arm, in a run without a console");
        return Err(FileError::from_finding(file, found, "--arm physics or --arm timed"));
    }
    spec.require_built().map_err(|missing| FileError::not_built(file, missing))
}

/// Computing time of a trial's assistant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AdviceTime {
    pub questions: u64,
    pub total_ns: u64,
}

/// What a run without a console takes from outside.
#[derive(Clone, Copy, Debug)]
pub struct Outside<'a> {
    pub minds: &'a dyn ExternalMinds,
    /// A monotonic clock, by which computing times are measured.
    pub now_ns: fn() -> u64,
}

impl Outside<'_> {
    /// Nothing: no programs, no computing times.
    pub const NOTHING: Outside<'static> = Outside { minds: &NoMinds, now_ns: || 0 };
}

/// Who answers requests for advice.
enum Assistant {
    Own(Box<Advisor>),
    External(Box<WaitedMind<ConceptDialogue>>),
}

/// Puts into the session what came back; aborts the trial if nothing more can come.
fn take<E>(
    engine: &mut SessionEngine,
    exchange: Exchange,
    mut record: impl FnMut(&TimestampedEvent) -> Result<(), E>,
) -> Result<(), E> {
    let aborted = exchange.failed.map(|reason| Event::TrialAborted { reason });
    for event in exchange.events.into_iter().chain(aborted) {
        engine.input(engine.session().time, event).events.iter().try_for_each(&mut record)?;
    }
    Ok(())
}

/// Runs a session of one trial and passes every event to `note`.
pub fn run(engine: &mut SessionEngine, mut note: impl FnMut(&TimestampedEvent)) {
    let noted = run_with(engine, Outside::NOTHING, |stamped| {
        note(stamped);
        Ok::<(), Infallible>(())
    });
    noted.map(drop).unwrap_or_else(|never| match never {});
}

/// As [`run`], until the first error of `record`, and with programs of other people: an answer is waited for, and a trial whose
/// program does not answer in time or ends is aborted.
pub fn run_with<E>(
    engine: &mut SessionEngine,
    outside: Outside,
    mut record: impl FnMut(&TimestampedEvent) -> Result<(), E>,
) -> Result<AdviceTime, E> {
    if let Some(phase) = engine.session().next_phase() {
        let event = Event::Protocol(ProtocolEvent::PhaseStarted { phase, number: 1 });
        engine.input(SessionTime::ZERO, event).events.iter().try_for_each(&mut record)?;
    }
    engine.input(SessionTime::ZERO, Event::TrialStarted).events.iter().try_for_each(&mut record)?;
    let mut assistant = match engine.session().spec.external_concept().cloned() {
        Some(mind) => {
            let dialogue = ConceptDialogue::new(engine.session(), &mind);
            let begin = dialogue.begin(engine.session());
            let (concept, exchange) =
                WaitedMind::open(outside.minds, dialogue, begin, |dialogue, text| dialogue.take(text));
            take(engine, exchange, &mut record)?;
            Some(Assistant::External(Box::new(concept)))
        }
        None => engine.session().spec.asks_assistant().then(|| Assistant::Own(Box::new(engine.advisor()))),
    };
    let mut participant = match engine.session().spec.participant.external.clone() {
        Some(command) => {
            let (session, dialogue) = (engine.session(), ParticipantDialogue::new(&command));
            let [scene, _] = outside.minds.sight(session);
            let begin = dialogue.begin(session, scene);
            let (participant, exchange) =
                WaitedMind::open(outside.minds, dialogue, begin, |dialogue, text| dialogue.take(session, text));
            take(engine, exchange, &mut record)?;
            Some(participant)
        }
        None => None,
    };
    let mut attendant = SimulatedRobotOperator::default();
    let mut time = AdviceTime::default();
    // Until the trial ends, a next event is always pending, since the end of the trial's time is one.
    while engine.session().phase == TrialPhase::Running || engine.session().is_frozen() {
        for question in engine.take_questions() {
            let Some(assistant) = &mut assistant else { continue };
            let began = (outside.now_ns)();
            let exchange = match assistant {
                Assistant::Own(advisor) => {
                    Exchange { events: vec![Event::Advised(advisor.answer(&question))], failed: None }
                }
                Assistant::External(concept) => ask(concept, &question),
            };
            time.questions += 1;
            time.total_ns += (outside.now_ns)().saturating_sub(began);
            take(engine, exchange, &mut record)?;
        }
        if let Some(participant) = &mut participant {
            take(engine, look(participant, engine.session(), outside.minds), &mut record)?;
            let next = engine.next_due().unwrap_or(engine.session().time);
            // A press that was due while the task stood still is made when it goes on.
            if let Some(due) = participant.dialogue.due(engine.session()).filter(|due| *due < next) {
                let at = due.max(engine.session().time);
                for event in participant.dialogue.act(engine.session()) {
                    engine.input(at, event).events.iter().try_for_each(&mut record)?;
                }
                continue;
            }
        }
        if engine.session().phase == TrialPhase::Running || engine.session().is_frozen() {
            attendant.step(engine).iter().try_for_each(&mut record)?;
        }
    }
    let end = engine.session().time;
    engine.input(end, Event::SessionEnded).events.iter().try_for_each(&mut record)?;
    Ok(time)
}

fn ask(concept: &mut WaitedMind<ConceptDialogue>, request: &AdviceRequest) -> Exchange {
    let (question, mut events) = concept.dialogue.question(request);
    let wait_s = concept.dialogue.mind().wait_s;
    let Exchange { events: told, failed } = concept.exchange(question, wait_s, |dialogue, text| dialogue.take(text));
    events.extend(told);
    Exchange { events, failed }
}

/// Asks the participant, if the display changed and no press is under way.
fn look(participant: &mut WaitedMind<ParticipantDialogue>, session: &Session, minds: &dyn ExternalMinds) -> Exchange {
    let display = || {
        let [_, display] = minds.sight(session);
        display
    };
    let Some(question) = participant.dialogue.question(session, session.time, display) else {
        return Exchange::default();
    };
    let wait_s = participant.dialogue.mind().wait_s;
    participant.exchange(question, wait_s, |dialogue, text| dialogue.take(session, text))
}

const MAX_SHARDS: u64 = 100_000;

/// Part `number` (from 1) of `of` disjoint parts of a simulation's trials, which several computers share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SimulationShard {
    pub number: u64,
    pub of: u64,
}

impl SimulationShard {
    /// All trials.
    pub const WHOLE: SimulationShard = SimulationShard { number: 1, of: 1 };
}

impl FromStr for SimulationShard {
    type Err = String;

    fn from_str(text: &str) -> Result<SimulationShard, String> {
        let parts = text.split_once('/').and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
        match parts {
            Some((number, of)) if number >= 1 && number <= of && of <= MAX_SHARDS => Ok(SimulationShard { number, of }),
            _ => Err("a part and how many there are, such as 1/8 to 8/8".to_string()),
        }
    }
}
