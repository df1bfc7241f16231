//! A session as a viewer shows it, as plain data: which entity shows what from when on. Kitchen and arm, beliefs, what
//! signals are worth, and what happened, in words.
//!
//! A [`SessionScene`] follows a session event by event, live and from a recording alike. It knows nothing of the viewer.

mod arm;
mod belief;
mod colours;
mod happenings;
mod places;
pub mod shown;

use crate::base::time::SessionTime;
use crate::kitchen::Change;
use crate::measures::JudgedPress;
use crate::mind::dirichlet::DirichletBelief;
use crate::session::{Event, Session, Stamped, apply};
use arm::ArmScene;
use belief::BeliefScene;
pub use shown::{EntityData, EntityUpdate};

/// What is shown, and where, changes with this number: a stream of another one is made anew from the log.
pub const VERSION: u32 = 3;

/// What entities show from a time on.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneUpdate {
    pub time: SessionTime,
    /// The same by the trial's clock, as the console shows it: without what was before the trial, and without pauses.
    pub trial: SessionTime,
    /// The number of the newest event.
    pub step: u64,
    pub rows: Vec<EntityUpdate>,
}

/// What is derived from a session and shown with it.
#[derive(Clone, Copy, Debug)]
pub struct DerivedData<'a> {
    /// Every press of the human so far.
    pub judged: &'a [JudgedPress],
    /// The estimate after everything that has happened until now; none while more is to come at the same time.
    pub belief: Option<&'a DirichletBelief>,
}

/// A session that is shown.
#[derive(Clone, Debug)]
pub struct SessionScene {
    session: Session,
    arm: ArmScene,
    belief: BeliefScene,
    /// The number of the first event that it has not been told.
    next: u64,
    /// Entries of the timeline that were told.
    told: usize,
}

impl SessionScene {
    /// The scene of a session that goes on from here; its next event has the number `next`.
    pub fn new(session: &Session, next: u64) -> SessionScene {
        SessionScene {
            session: session.clone(),
            arm: ArmScene::new(session),
            belief: BeliefScene::default(),
            next,
            told: session.timeline.len(),
        }
    }

    /// What stays as it is, whatever happens.
    pub fn fixed(&self) -> Vec<EntityUpdate> {
        let kitchen = &self.session.kitchen;
        let mut rows = places::fixed(kitchen);
        rows.extend(self.arm.fixed(kitchen));
        rows.extend(belief::fixed(kitchen));
        rows.extend(happenings::fixed(&self.session));
        rows
    }

    /// How everything is at the beginning.
    pub fn opening(&mut self) -> SceneUpdate {
        let (kitchen, state) = (self.session.kitchen.clone(), self.session.state);
        let mut rows: Vec<EntityUpdate> = places::contents(&kitchen, None, state).collect();
        rows.extend(places::shown_signal(&self.session));
        rows.extend(self.arm.opening(&self.session));
        let time = self.session.time;
        SceneUpdate { time, trial: self.session.trial_clock(time), step: self.step(), rows }
    }

    /// The number of the newest event.
    fn step(&self) -> u64 {
        self.next.saturating_sub(1)
    }

    /// Whether the estimate would be shown at this time.
    pub fn wants_belief(&self, time: SessionTime) -> bool {
        self.belief.is_due(time)
    }

    /// The session's next event, and what it changes to see: moments in the order of their times. An event that cannot be
    /// at this point, or was there before, shows nothing.
    pub fn see(&mut self, stamped: &Stamped, derived: DerivedData<'_>) -> Vec<SceneUpdate> {
        if stamped.seq < self.next {
            return Vec::new();
        }
        let mut moments = self.until(stamped.time);
        let Ok(applied) = apply(&mut self.session, stamped) else { return moments };
        self.next = stamped.seq + 1;
        let rows = self.changes(stamped, &applied.change, derived);
        if !rows.is_empty() {
            let trial = self.session.trial_clock(stamped.time);
            moments.push(SceneUpdate { time: stamped.time, trial, step: stamped.seq, rows });
        }
        moments
    }

    /// What moves between events, until this time.
    pub fn until(&mut self, time: SessionTime) -> Vec<SceneUpdate> {
        let step = self.step();
        let session = &self.session;
        let moment = |(time, rows)| SceneUpdate { time, trial: session.trial_clock(time), step, rows };
        self.arm.until(time).into_iter().map(moment).collect()
    }

    fn changes(&mut self, stamped: &Stamped, change: &Change, derived: DerivedData<'_>) -> Vec<EntityUpdate> {
        let session = &self.session;
        let changed = change.states().into_iter();
        let mut rows: Vec<EntityUpdate> =
            changed.flat_map(|(before, after)| places::contents(&session.kitchen, Some(before), after)).collect();
        match &stamped.event {
            Event::Gaze(sample) => rows.push(places::gaze(session, *sample)),
            Event::SignalShown { .. } | Event::SignalEnded { .. } => rows.extend(places::shown_signal(session)),
            Event::TrialEnded { .. } | Event::TrialAborted { .. } | Event::SessionEnded => {
                rows.extend(places::shown_signal(session));
            }
            Event::Advised(advice) => rows.extend(happenings::advice(advice)),
            Event::Protocol(event) => rows.push(happenings::protocol(event)),
            _ => {}
        }
        let error = happenings::error(stamped, derived.judged);
        rows.extend(session.timeline[self.told..].iter().map(|entry| happenings::entry(session, entry, error)));
        self.told = session.timeline.len();
        rows.extend(happenings::in_order(&rows));
        rows.extend(error.map(|_| happenings::mark()));
        rows.extend(self.arm.follow(session, stamped, change));
        rows.extend(self.belief.follow(session, stamped, derived.belief));
        rows
    }
}
