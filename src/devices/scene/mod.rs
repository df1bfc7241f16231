//! The scene: a session as Rerun shows it, as plain data, namely updates of entities with their times. Entities are the
//! kitchen, the arm, beliefs, net benefits of signals, probes, and a text log.
//!
//! A [`SessionScene`] follows a session event by event, live and from a recording. The scene does not depend on the
//! viewer.

mod about;
mod arm;
mod bars;
mod beliefs;
mod entities;
pub mod entity_content;
mod happenings;
mod looks;
mod pictures;
mod probes;

pub use about::{facts, title};
pub use arm::has_poses;
pub use bars::TimedBars;
pub use entities::WIDE;
pub use entity_content::{EntityData, EntityUpdate};
pub use pictures::of_look as picture;

use arm::RobotArmScene;
use beliefs::BeliefScene;
use happenings::{AdviceScene, SignalScene};
use looks::LookScene;
use probes::ProbeScene;

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::KitchenChange;
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_session::follower::SessionFollower;
use tomcom_session::history::signal_words;
use tomcom_session::{Event, Session, TimestampedEvent, apply};

/// Version of the scene's content and layout. A stream with another version is rebuilt from the log.
pub const VERSION: u32 = 14;

/// A time on the trial's clock, in minutes, seconds and tenths. As on the console's clock, what is smaller is left out.
pub fn moment_on_clock(time: SessionTime) -> String {
    format!("{time}.{}", time.0 / 100_000_000 % 10)
}

/// Updates of entities at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneUpdate {
    pub time: SessionTime,
    pub trial: SessionTime,
    /// Sequence number of the newest event at the time of the updates.
    pub step: u64,
    pub rows: Vec<EntityUpdate>,
}

/// What the scene shows beside the session itself.
#[derive(Clone, Copy, Debug)]
pub struct SceneInputs<'a> {
    /// Judged presses, signals and false beliefs. It can have seen further events than the scene.
    pub follower: &'a SessionFollower,
    /// The belief estimate after all events so far; `None` while further events have the same time.
    pub belief: Option<&'a DirichletBelief>,
}

/// Converts the events of a session into entity updates for Rerun.
#[derive(Clone, Debug)]
pub struct SessionScene {
    session: Session,
    arm: Option<RobotArmScene>,
    belief: BeliefScene,
    advice: AdviceScene,
    signals: SignalScene,
    looks: LookScene,
    probes: ProbeScene,
    /// Sequence number of the first event that the scene has not shown yet.
    next: u64,
    told: usize,
}

impl SessionScene {
    /// Creates the scene of a session whose next event has the sequence number `next`.
    pub fn new(session: &Session, next: u64) -> SessionScene {
        SessionScene {
            session: session.clone(),
            arm: RobotArmScene::new(session),
            belief: BeliefScene::default(),
            advice: AdviceScene::default(),
            signals: SignalScene::new(session),
            looks: LookScene::default(),
            probes: ProbeScene::default(),
            next,
            told: session.timeline.len(),
        }
    }

    /// Entities that do not change during the session.
    pub fn fixed(&self) -> Vec<EntityUpdate> {
        let kitchen = &self.session.kitchen;
        let mut rows = entities::fixed_places(&self.session);
        rows.extend(self.arm.iter().flat_map(|arm| arm.fixed(kitchen)));
        rows.extend(beliefs::fixed_beliefs(kitchen));
        rows.extend(happenings::fixed(&self.session));
        rows.push(about::page(&self.session));
        rows
    }

    pub fn opening(&mut self) -> SceneUpdate {
        let (kitchen, state) = (self.session.kitchen.clone(), self.session.state);
        let mut rows = entities::contents(&kitchen, None, state);
        rows.extend(entities::shown_signal(&self.session));
        rows.extend(self.arm.iter().flat_map(|arm| arm.opening(&self.session)));
        let time = self.session.time;
        SceneUpdate { time, trial: self.session.trial_clock(time), step: self.step(), rows }
    }

    /// Sequence number of the newest event that the scene has shown.
    fn step(&self) -> u64 {
        self.next.saturating_sub(1)
    }

    /// Whether an update of the belief estimate is due at the next event.
    pub fn wants_belief(&self, next: &TimestampedEvent) -> bool {
        self.belief.is_due(next.time) || matches!(next.event, Event::Press { .. })
    }

    /// Applies the next event and returns the entity updates: first those of earlier times, of curves that begin. An event that
    /// is not valid in the session's state, or that the scene has already shown, gives no updates.
    pub fn see(&mut self, stamped: &TimestampedEvent, inputs: SceneInputs<'_>) -> Vec<SceneUpdate> {
        if stamped.seq < self.next {
            return Vec::new();
        }
        let Ok(applied) = apply(&mut self.session, stamped) else { return Vec::new() };
        self.next = stamped.seq + 1;
        let rows = self.changes(stamped, &applied.change, inputs);
        let trial = self.session.trial_clock(stamped.time);
        let mut moments = std::mem::take(&mut self.belief.begun);
        if !rows.is_empty() {
            moments.push(SceneUpdate { time: stamped.time, trial, step: stamped.seq, rows });
        }
        moments
    }

    fn changes(
        &mut self,
        stamped: &TimestampedEvent,
        change: &KitchenChange,
        inputs: SceneInputs<'_>,
    ) -> Vec<EntityUpdate> {
        let session = &self.session;
        let changed = change.states().into_iter();
        let mut rows: Vec<EntityUpdate> =
            changed.flat_map(|(before, after)| entities::contents(&session.kitchen, Some(before), after)).collect();
        match &stamped.event {
            Event::Gaze(sample) => rows.push(entities::gaze(session, *sample)),
            Event::SignalShown { signal, .. } => {
                rows.extend(entities::shown_signal(session));
                rows.extend(self.advice.sent(signal, inputs.follower));
            }
            Event::SignalEnded { .. } => rows.extend(entities::shown_signal(session)),
            Event::TrialEnded { .. } | Event::TrialAborted { .. } | Event::SessionEnded => {
                rows.extend(entities::shown_signal(session));
                rows.extend(self.advice.ended());
                rows.extend(self.belief.ended());
            }
            Event::TrialStarted => rows.push(happenings::cost_line()),
            Event::Advised(advice) => {
                let told = happenings::advised(session, advice);
                rows.extend(self.advice.follow(advice, &told));
                let unit = session.spec.assistant.concept.name().unit();
                self.belief.advice = if told.is_empty() { signal_words::not_advised(unit, advice) } else { told };
            }
            Event::OfferOpened(offer) => rows.push(happenings::offer_opened(offer)),
            Event::OfferClosed { reason, .. } => rows.push(happenings::offer_closed(*reason)),
            Event::Probe(event) => rows.extend(self.probes.follow(session, event, inputs.belief)),
            Event::Protocol(event) => rows.push(happenings::protocol(event)),
            Event::MarkerWorded { note, .. } if !note.is_empty() => rows.push(happenings::mark_worded(session, note)),
            _ => {}
        }
        let pressed = happenings::judged(stamped, inputs.follower);
        let new = &session.timeline[self.told..];
        if pressed.is_some() {
            rows.extend(self.looks.pressed(session));
        }
        rows.extend(self.signals.follow(session, inputs.follower));
        rows.extend(new.iter().map(|entry| happenings::entry(session, entry, pressed, inputs.follower)));
        rows.extend(pressed.filter(|pressed| pressed.press.verdict.error).map(|_| happenings::mark()));
        rows.extend(self.arm.iter_mut().flat_map(|arm| arm.follow(session, stamped, change)));
        rows.extend(self.looks.follow(session, &stamped.event));
        self.belief.gaze = self.looks.words(session);
        self.belief.robot = arm::robot_does(session);
        rows.extend(self.belief.follow(session, stamped, new, pressed, inputs));
        rows.extend(happenings::in_order(&rows));
        self.told = session.timeline.len();
        rows
    }
}
