//! A session with what is derived from it press by press. Live runs and replays go through it alike.

use std::sync::Arc;

use crate::base::time::SessionTime;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, Kitchen};
use crate::measures::errors::{Judge, Verdict};
use crate::session::apply::ApplyError;
use crate::session::{Effect, Event, Session, SessionSpec, Stamped, apply};

/// A press of the human during the trial and what it was worth. The nth of them is the nth press of the human on the
/// session's timeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedPress {
    pub seq: u64,
    pub time: SessionTime,
    pub verdict: Verdict,
}

/// A session, and the errors in it.
#[derive(Clone, Debug)]
pub struct Follower {
    pub session: Session,
    /// Every press of the human so far.
    pub judged: Vec<JudgedPress>,
    pub(super) cost: CostToGo,
    judge: Judge,
}

impl Follower {
    pub fn new(kitchen: Arc<Kitchen>, spec: SessionSpec, cost: CostToGo) -> Follower {
        let judge = Judge::new(kitchen.clone());
        Follower { session: Session::new(kitchen, spec), judged: Vec::new(), cost, judge }
    }

    /// Moves on by one event.
    ///
    /// # Errors
    /// Those of [`apply`].
    pub fn apply(&mut self, stamped: &Stamped) -> Result<Vec<Effect>, ApplyError> {
        let before = self.session.state;
        let counts = self.session.is_running();
        let effects = apply(&mut self.session, stamped)?;
        let Event::Press { agent, button } = &stamped.event else { return Ok(effects) };
        if !counts {
            return Ok(effects);
        }
        let (now, after) = (stamped.time, self.session.state);
        match agent {
            Agent::Robot => self.judge.robot_pressed(now, before, after),
            Agent::Human => {
                if let Some(button) = self.session.kitchen.button_named(Agent::Human, button) {
                    let verdict = self.judge.human_pressed(&mut self.cost, now, button, before, after);
                    self.judged.push(JudgedPress { seq: stamped.seq, time: now, verdict });
                }
            }
        }
        Ok(effects)
    }

    /// The number of errors so far.
    pub fn errors(&self) -> usize {
        self.judged.iter().filter(|press| press.verdict.error).count()
    }
}
