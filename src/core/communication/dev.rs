//! DEV: the deviation based communication concept. When the human's press was an error, DEV proposes the next good
//! presses (paper, "Concept comparisons": 1 to 5 presses).
//!
//! A proposal has a kind of signal of its own ([`Signal::Propose`](super::Signal::Propose)): "next: …". Most good
//! presses involve the human's own hand or a storage, about which there is no other signal, and highlighting the
//! location of a press would reveal its content, as the theory of mind concepts do. In trials of DEV the assistant
//! sends proposals; beside a wizard, proposals are shown at the console only. No other concept proposes presses. The
//! offline comparison of concepts assumes that participants follow proposals, as in the paper.

use std::sync::Arc;

use super::concept::{Concept, DecisionPoint};
use super::recommendation::{HumanPressProposal, Recommendation};
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, ButtonId, Kitchen, State};

/// Largest number of presses of both agents that a proposal of DEV plans ahead.
const MOST_AHEAD: usize = 40;

/// The DEV concept: proposes the next good presses after an error.
#[derive(Clone, Debug)]
pub struct DevConcept {
    kitchen: Arc<Kitchen>,
    presses: usize,
}

impl DevConcept {
    /// A DEV concept that proposes `presses` presses at a time.
    pub fn new(kitchen: Arc<Kitchen>, presses: usize) -> DevConcept {
        DevConcept { kitchen, presses }
    }

    /// The next good presses of the human: presses that lower the cost to go of all orders. Where no press of the human
    /// lowers the cost, a press of the robot that does is assumed in between.
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

    /// The agent's best press if the press lowers the cost to go; ties go to the layout's order.
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
    /// The advice of DEV: a proposal of presses is valid, and is updated, until the human's next press.
    fn advise(&mut self, cost: &mut CostToGo, moment: &DecisionPoint) -> Recommendation {
        let name = |button: ButtonId| self.kitchen.button(Agent::Human, button).name.clone();
        let proposal = moment.error.map(|error| {
            let presses = self.good(cost, moment.situation.state).into_iter().map(name).collect();
            HumanPressProposal { error, presses }
        });
        let proposal = proposal.filter(|proposal| !proposal.presses.is_empty());
        Recommendation { proposal, ..Recommendation::silent(moment.seq, moment.time) }
    }
}
