//! A session with what is derived from it press by press. Live runs and replays go through it alike.

use std::sync::Arc;

use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, ButtonId, Kitchen, State};
use crate::measures::JudgedPress;
use crate::measures::attribution::Attributor;
use crate::measures::errors::Judge;
use crate::measures::sequences::Episodes;
use crate::mind::belief::Belief;
use crate::mind::decision::DecisionModel;
use crate::session::apply::ApplyError;
use crate::session::{Effect, Event, Session, SessionSpec, Stamped, apply};

/// A session, the errors in it, and their causes.
#[derive(Clone, Debug)]
pub struct Follower {
    pub session: Session,
    /// Every press of the human so far.
    pub judged: Vec<JudgedPress>,
    /// What was believed wrong for how long, as far as that is known.
    pub episodes: Episodes,
    pub(super) cost: CostToGo,
    judge: Judge,
    attributor: Attributor,
    /// What the participant believes before its next press.
    belief: Option<Belief>,
}

impl Follower {
    pub fn new(kitchen: Arc<Kitchen>, spec: SessionSpec, cost: CostToGo) -> Follower {
        let judge = Judge::new(kitchen.clone());
        let attributor = Attributor::new(DecisionModel::default(), spec.seed);
        let session = Session::new(kitchen, spec);
        let (judged, episodes) = (Vec::new(), Episodes::default());
        Follower { session, judged, episodes, cost, judge, attributor, belief: None }
    }

    /// Moves on by one event.
    ///
    /// # Errors
    /// Those of [`apply`].
    pub fn apply(&mut self, stamped: &Stamped) -> Result<Vec<Effect>, ApplyError> {
        let before = self.session.state;
        let counts = self.session.is_running();
        let effects = apply(&mut self.session, stamped)?;
        match &stamped.event {
            Event::ParticipantBelieves(witness) => {
                let session = &self.session;
                self.belief = Belief::of_witness(&session.kitchen, session.state, witness);
                if let Some(belief) = &self.belief {
                    let (now, changed_at) = (stamped.time, &session.changed_at);
                    self.episodes.believed(&session.kitchen, now, session.state, belief, changed_at);
                }
            }
            Event::Press { agent: Agent::Robot, .. } if counts => {
                self.judge.others_changed(stamped.time, before, self.session.state);
            }
            Event::KitchenCorrected { .. } => self.judge.others_changed(stamped.time, before, self.session.state),
            Event::Press { agent: Agent::Human, button } if counts => {
                if let Some(button) = self.session.kitchen.button_named(Agent::Human, button) {
                    self.human_pressed(stamped, button, before);
                }
            }
            _ => {}
        }
        Ok(effects)
    }

    /// Judges a press of the human that has just been applied, and finds out why it was an error.
    fn human_pressed(&mut self, stamped: &Stamped, button: ButtonId, before: State) {
        let (kitchen, after) = (self.session.kitchen.clone(), self.session.state);
        let verdict = self.judge.human_pressed(&mut self.cost, stamped.time, button, before, after);
        // A belief is told before every press, and is that of this press alone.
        let belief = self.belief.take();
        let cause = belief
            .as_ref()
            .filter(|_| verdict.error)
            .map(|belief| self.attributor.cause(&kitchen, &mut self.cost, belief, before, button, stamped.seq));
        if let Some(cause) = cause {
            self.episodes.erred(&kitchen, cause);
        }
        let belief_known = belief.is_some();
        self.judged.push(JudgedPress { seq: stamped.seq, time: stamped.time, verdict, belief_known, cause });
    }

    /// The number of errors so far.
    pub fn errors(&self) -> usize {
        self.judged.iter().filter(|press| press.verdict.error).count()
    }
}
