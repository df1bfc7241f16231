//! DEV: the deviation based concept. When the human's press was an error, it proposes the next good presses (paper, "Concept
//! comparisons": 1 to 5 of them).
//!
//! A proposal is no signal: the display has signals about recipes and places, and none for a press, and most good presses
//! are about the own hand or a storage, which no signal is about. To highlight the place of a press instead would tell its
//! content, which is what the concepts with a theory of mind do. So a proposal is advice. It is recorded and shown at the
//! console, and nothing is sent, also where the assistant acts by itself; where concepts are compared, participants are taken
//! to follow it, as in the paper.

use std::sync::Arc;

use super::concept::{Concept, DecisionPoint};
use super::recommendation::{Proposal, Recommendation};
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, ButtonId, Kitchen, State};

/// A proposal looks at most so many presses of both agents ahead.
const MOST_AHEAD: usize = 40;

/// Proposes presses after errors.
#[derive(Clone, Debug)]
pub struct DevConcept {
    kitchen: Arc<Kitchen>,
    presses: usize,
}

impl DevConcept {
    /// Proposes so many presses at a time.
    pub fn new(kitchen: Arc<Kitchen>, presses: usize) -> DevConcept {
        DevConcept { kitchen, presses }
    }

    /// The next good presses of the human: each lowers the cost to go of all orders; where none of the human's does, a
    /// press of the robot that does is taken for granted.
    fn good(&self, cost: &mut CostToGo, state: State) -> Vec<ButtonId> {
        let mut state = state;
        let mut presses = Vec::new();
        for _ in 0..MOST_AHEAD {
            let step = self.step(cost, state, Agent::Human).map(|step| (Some(step.0), step.1));
            let step = step.or_else(|| Some((None, self.step(cost, state, Agent::Robot)?.1)));
            let Some((button, after)) = step.filter(|_| presses.len() < self.presses) else { break };
            presses.extend(button);
            state = after;
        }
        presses
    }

    /// The agent's best press, if it lowers the cost to go; of equals the first.
    fn step(&self, cost: &mut CostToGo, state: State, agent: Agent) -> Option<(ButtonId, State)> {
        let recipes = self.kitchen.true_recipes();
        let decision = *cost.decision(state, &recipes, agent);
        let buttons = self.kitchen.buttons[agent.index()].len();
        let best = (0..buttons).min_by_key(|&button| decision.after[button])?;
        let button = ButtonId(best as u8);
        let after = self.kitchen.press(state, &recipes, agent, button)?;
        (decision.after[best] < decision.here).then_some((button, after))
    }
}

impl Concept for DevConcept {
    /// The proposal stands, and is kept up to date, until the human's next press.
    fn advise(&mut self, cost: &mut CostToGo, moment: &DecisionPoint) -> Recommendation {
        let name = |button: ButtonId| self.kitchen.button(Agent::Human, button).name.clone();
        let proposal = moment.error.map(|error| {
            let presses = self.good(cost, moment.situation.state).into_iter().map(name).collect();
            Proposal { error, presses }
        });
        let proposal = proposal.filter(|proposal| !proposal.presses.is_empty());
        Recommendation { proposal, ..Recommendation::silent(moment.seq, moment.time) }
    }
}
