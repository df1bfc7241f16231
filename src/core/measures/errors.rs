//! Regret and error of a press.
//!
//! Regret: r(a) = 1 + C(s') - C(s), with the true state and recipes. A press is an error if its regret exceeds the
//! least regret among the human's presses by 1 or more, with two exceptions: the press brings an active order nearer
//! and the excess is at most 2 (preparation of one order at some cost of the other), or the press may have been
//! overtaken by the robot (a race). Where no press of the human helps, the least regret is 1 and the excess is counted
//! from 1. An ineffective press is judged like any other press.
//!
//! Costs to go are proven to be the least ([`CostToGo::proven_all_orders`]), as far as a budget of searched states for each
//! press suffices. A verdict that rests on a value that is not proven says so.

use std::sync::Arc;

use super::attribution::ErrorCause;
use crate::base::time::SessionTime;
use crate::kitchen::cost_to_go::{CostToGo, ProofBudget, ProvenCost};
use crate::kitchen::state::MAX_LOCATIONS;
use crate::kitchen::{Agent, ButtonAction, ButtonId, Kitchen, KitchenChange, Press, State};

/// Time in seconds after a change by somebody else within which a press at the same place is a race: the press comes
/// too early to be a reaction to the change.
pub(crate) const RACE_S: f64 = 0.3;
/// Largest excess regret of a press that counts as preparation of the other order.
pub(crate) const PREPARATION_EXCESS: i32 = 2;

/// Judgement of a press of the human: its regret, and whether it is an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PressVerdict {
    /// Regret r(a) of the press: number of additional presses of both agents that the press causes.
    pub regret: i32,
    /// Excess of the press's regret over that of the human's best press.
    pub excess: i32,
    /// Whether somebody else changed the same place within `RACE_S` before the press; such presses do not count as
    /// errors.
    pub race: bool,
    /// Whether the press counts as an error.
    pub error: bool,
    /// Whether all costs to go on which the verdict rests are proven to be the least.
    pub is_proven: bool,
    /// The human's press with the least regret; ties go to the layout's order. `None` if no press of the human helps.
    pub best: Option<ButtonId>,
}

/// Judges presses of the human; stores when somebody else last changed each location.
#[derive(Clone, Debug)]
pub struct PressJudge {
    kitchen: Arc<Kitchen>,
    others_changed_at: [Option<SessionTime>; MAX_LOCATIONS],
}

impl PressJudge {
    /// Creates a judge of presses at the start of a trial, when nobody has changed anything yet.
    pub fn new(kitchen: Arc<Kitchen>) -> PressJudge {
        PressJudge { kitchen, others_changed_at: [None; MAX_LOCATIONS] }
    }

    /// Takes note of a change of the kitchen; returns the verdict on a press of the human.
    pub fn note(&mut self, cost: &mut CostToGo, now: SessionTime, change: &KitchenChange) -> Option<PressVerdict> {
        match change {
            KitchenChange::Press { press, .. } if press.agent == Agent::Human => {
                return Some(self.human_pressed(cost, now, press));
            }
            KitchenChange::Press { press, .. } => self.others_changed(now, press.before, press.after),
            KitchenChange::Correction { before, after, .. } => self.others_changed(now, *before, *after),
            _ => {}
        }
        None
    }

    /// Records which locations a robot press, or a correction by the wizard, changed.
    pub fn others_changed(&mut self, now: SessionTime, before: State, after: State) {
        for location in self.kitchen.changed(before, after) {
            self.others_changed_at[location.index()] = Some(now);
        }
    }

    /// Shifts all stored times by the duration of a freeze probe, during which the task stood still.
    pub fn postpone(&mut self, by: SessionTime) {
        self.others_changed_at.iter_mut().flatten().for_each(|at| *at = *at + by);
    }

    /// Judges a press of the human: its regret, and whether the press is an error.
    pub fn human_pressed(&self, cost: &mut CostToGo, now: SessionTime, press: &Press) -> PressVerdict {
        let (kitchen, &Press { button, before, after, .. }) = (&self.kitchen, press);
        let recipes = kitchen.true_recipes();
        let (mut budget, mut is_proven) = (ProofBudget::default(), true);
        let mut presses = |found: ProvenCost| {
            is_proven &= found.is_proven;
            found.presses as i32
        };
        let here = presses(cost.proven_all_orders(before, &recipes, &mut budget));
        let mut regret_to = |state: State| match state == before {
            true => 1,
            false => 1 + presses(cost.proven_all_orders(state, &recipes, &mut budget)) - here,
        };
        let regret = regret_to(after);
        let buttons = kitchen.button_ids(Agent::Human);
        let (mut least, mut best) = (1, None);
        for other in buttons {
            let Some(state) = kitchen.press(before, &recipes, Agent::Human, other) else { continue };
            let regret = regret_to(state);
            if regret < least {
                (least, best) = (regret, Some(other));
            }
        }
        let excess = regret - least;
        let race = self.is_race(now, button);
        let mut nearer = || {
            kitchen.wanted(before).any(|(order, _)| {
                let [then, now] =
                    [after, before].map(|state| presses(cost.proven_order(state, &recipes, order, &mut budget)));
                then < now
            })
        };
        let error = !race && excess >= 1 && !(excess <= PREPARATION_EXCESS && nearer());
        PressVerdict { regret, excess, race, error, is_proven, best }
    }

    /// Whether somebody else changed a place where this button acts within [`RACE_S`] before now.
    fn is_race(&self, now: SessionTime, button: ButtonId) -> bool {
        let kitchen = &self.kitchen;
        let hand = kitchen.hands[Agent::Human.index()];
        let places = match kitchen.button(Agent::Human, button).action {
            ButtonAction::Use(location) => [location, hand],
            ButtonAction::Serve(order) => [order, kitchen.plate],
            ButtonAction::Process(process) => [kitchen.processes[usize::from(process)].place.unwrap_or(hand), hand],
            ButtonAction::Take(_) | ButtonAction::Trash => [hand, hand],
        };
        let recent = |time: SessionTime| now.secs_since(time) <= RACE_S;
        places.iter().any(|place| self.others_changed_at[place.index()].is_some_and(recent))
    }
}

/// A press of the human with the judgement whether it was an error. The nth judged press is the nth press of the human
/// on the session's timeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedPress {
    /// Sequence number of the press event in the log.
    pub seq: u64,
    /// Session time of the press.
    pub time: SessionTime,
    /// The button that the human pressed.
    pub button: ButtonId,
    /// State of the kitchen before the press.
    pub before: State,
    /// The regret of the press, and whether it was an error.
    pub verdict: PressVerdict,
    /// Whether the human's belief before the press is known.
    pub belief_known: bool,
    /// Cause of an error; `None` if the press was no error or the human's belief is not known.
    pub cause: Option<ErrorCause>,
}
