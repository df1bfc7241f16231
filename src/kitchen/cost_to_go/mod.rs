//! Cost to go: the least number of presses, of both agents one after another, until the orders are served.
//!
//! It is computed backwards from the goal. For every part of the wanted stacks the tables of [`journeys`] say how many presses
//! it is away from the board, from every place and for everything that may be in the way. An [`assign::Assignment`] chooses
//! which item becomes which part, which gives a lower bound; a [`plan::Plan`] carries it out, press by press, and clears what
//! is in the way, which gives an upper bound. Where they agree, the value is settled; where they do not, a bounded
//! [`search`] over single presses decides. What was found is kept by state classes (see [`goal`]: all that is of no use is
//! one class), and whole decisions are kept by state. A value depends on the state and the recipes alone, never on what was
//! asked before.

mod assign;
mod cache;
mod clear;
mod goal;
mod ground;
mod journeys;
mod plan;
mod rating;
mod search;

use std::sync::Arc;

use self::cache::{Cache, Decisions};
pub use self::cache::{Decision, MAX_BUTTONS};
use self::goal::{Classes, Goal};
use self::ground::Ground;
use self::rating::Rating;
use self::search::Search;
use super::action::Agent;
use super::content::ContentId;
use super::layout::LocationId;
use super::state::{OrderContent, Recipes, State};
use super::{ButtonId, Kitchen};

/// The value of states from which the goal cannot be reached.
pub const UNREACHABLE: u32 = 255;
/// 2^20 values and 2^17 decisions: 8 MiB each.
const CACHE_BITS: u32 = 20;
const DECISION_BITS: u32 = 17;
/// Keys leave so many bits for the goal.
const SLOT_BITS: u32 = 17;
/// The highest of them tells rough values from exact ones.
const ROUGH_BIT: u32 = SLOT_BITS - 1;

/// Computes costs to go and remembers them.
#[derive(Clone, Debug)]
pub struct CostToGo {
    kitchen: Arc<Kitchen>,
    ground: Ground,
    /// `[first target * contents + second target]`, made when first wanted; no second target: 0.
    goals: Vec<Option<Arc<Goal>>>,
    cache: Cache,
    decisions: Decisions,
    counts: Counts,
}

/// How much care is taken of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Care {
    /// Where bound and plans do not agree, it is searched for.
    Exact,
    /// It is the bound: mostly exact, else a press or two too low. For what hardly counts.
    Rough,
}

/// How often what was done since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Decisions that had to be put together, button by button.
    pub decisions_missed: u64,
    /// Single values asked for, and those that had to be computed.
    pub values: u64,
    pub values_missed: u64,
    /// Those for which bound and plans did not agree.
    pub searches: u64,
}

impl CostToGo {
    pub fn new(kitchen: Arc<Kitchen>) -> CostToGo {
        let ground = Ground::new(&kitchen);
        let goals = vec![None; kitchen.contents.len() * kitchen.contents.len()];
        let (cache, decisions) = (Cache::new(CACHE_BITS), Decisions::new(DECISION_BITS));
        CostToGo { kitchen, ground, goals, cache, decisions, counts: Counts::default() }
    }

    /// C(s, recipes): presses until all present orders are served; 0 if there is none, [`UNREACHABLE`] if they never can be.
    pub fn all_orders(&mut self, state: State, recipes: &Recipes) -> u32 {
        let (mut targets, count) = self.targets(state, recipes);
        self.cost(Care::Exact, state, &mut targets[..count])
    }

    /// C_k(s, recipes): presses until the order at this location is served; 0 if it wants nothing.
    pub fn order(&mut self, state: State, recipes: &Recipes, order: LocationId) -> u32 {
        match state.order(order) {
            OrderContent::Dish(dish) => self.cost(Care::Exact, state, &mut [recipes.get(dish)]),
            _ => 0,
        }
    }

    /// C of the state and of every state that a button of `agent` leads to, in one look-up where it was asked before: what
    /// decisions, inference and rollouts need.
    #[inline]
    pub fn decision(&mut self, state: State, recipes: &Recipes, agent: Agent) -> &Decision {
        self.decision_with(Care::Exact, state, recipes, agent)
    }

    /// The same with more or less care. What is known of one is not used for the other, so that a value never depends on
    /// what was asked before.
    #[inline]
    pub fn decision_with(&mut self, care: Care, state: State, recipes: &Recipes, agent: Agent) -> &Decision {
        let (mut targets, count) = self.targets(state, recipes);
        let question =
            u32::from(targets[0].0) | u32::from(targets[1].0) << 8 | (agent as u32) << 16 | (care as u32) << 17;
        let (index, known) = self.decisions.find(state, question);
        if !known {
            let alike = self.stand_in(state, &mut targets[..count]);
            let (there, known) = self.decisions.find(alike, question);
            if !known {
                self.decide(there, question, care, alike, recipes, agent);
            }
            let found = *self.decisions.get(there);
            self.decisions.set(index, state, question, found.here, found.after);
        }
        self.decisions.get(index)
    }

    /// The state in which contents of no use are put by others that are pressed about in the same ways: its decisions are
    /// the same, and strange states have few of them.
    fn stand_in(&mut self, state: State, targets: &mut [ContentId]) -> State {
        targets.sort_unstable();
        if targets.is_empty() {
            return state;
        }
        let slot = self.slot(targets);
        self.make_goal(slot, targets);
        let Some(goal) = &self.goals[slot] else { return state };
        let mut alike = state;
        for location in self.ground.places() {
            let location = LocationId(location as u8);
            alike.set_content(location, goal.stands_for[state.content(location).index()]);
        }
        alike
    }

    /// How much was looked up and how much computed since the start.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Puts a decision together and keeps it.
    fn decide(&mut self, index: usize, question: u32, care: Care, state: State, recipes: &Recipes, agent: Agent) {
        self.counts.decisions_missed += 1;
        let kitchen = self.kitchen.clone();
        let mut value = |state: State| {
            let (mut targets, count) = self.targets(state, recipes);
            self.cost(care, state, &mut targets[..count]) as u8
        };
        let here = value(state);
        let mut after = [here; MAX_BUTTONS];
        for (button, after) in after.iter_mut().enumerate().take(kitchen.buttons[agent.index()].len()) {
            if let Some(next) = kitchen.press(state, recipes, agent, ButtonId(button as u8)) {
                *after = value(next);
            }
        }
        self.decisions.set(index, state, question, here, after);
    }

    /// The stacks that the present orders want, in the order of the orders, and their number.
    #[inline]
    fn targets(&self, state: State, recipes: &Recipes) -> ([ContentId; goal::MAX_TARGETS], usize) {
        let mut targets = [ContentId::EMPTY; goal::MAX_TARGETS];
        let mut count = 0;
        for order in 0..self.ground.first {
            if let OrderContent::Dish(dish) = state.order(LocationId(order as u8)) {
                targets[count] = recipes.get(dish);
                count += 1;
            }
        }
        (targets, count)
    }

    fn cost(&mut self, care: Care, state: State, targets: &mut [ContentId]) -> u32 {
        if targets.is_empty() {
            return 0;
        }
        self.counts.values += 1;
        targets.sort_unstable();
        let slot = self.slot(targets);
        self.make_goal(slot, targets);
        let Some(goal) = &self.goals[slot] else { return UNREACHABLE };
        let key = goal.key_of_state(state) << SLOT_BITS | slot as u64 | (care as u64) << ROUGH_BIT;
        if let Some(value) = self.cache.get(key) {
            return value;
        }
        let goal = goal.clone();
        let mut classes: Classes = [0; 16];
        for location in self.ground.places() {
            classes[location] = goal.class_of[state.content(LocationId(location as u8)).index()];
        }
        self.compute(care, key, slot, &goal, &classes)
    }

    /// The value of a state of classes without one of its targets, which has just been served.
    fn without(&mut self, goal: &Goal, state: &Classes, served: usize) -> u32 {
        let rest = goal.targets.iter().enumerate().filter(|(index, _)| *index != served);
        let rest: Vec<ContentId> = rest.map(|(_, &target)| target).collect();
        if rest.is_empty() {
            return 0;
        }
        let slot = self.slot(&rest);
        self.make_goal(slot, &rest);
        let Some(rest) = self.goals[slot].clone() else { return UNREACHABLE };
        let mut classes: Classes = [0; 16];
        for location in self.ground.places() {
            classes[location] = rest.class_of[goal.content[usize::from(state[location])].index()];
        }
        let key = self.key(slot, &rest, &classes);
        self.cache.get(key).unwrap_or_else(|| self.compute(Care::Exact, key, slot, &rest, &classes))
    }

    fn compute(&mut self, care: Care, key: u64, slot: usize, goal: &Goal, state: &Classes) -> u32 {
        self.counts.values_missed += 1;
        let value = self.solve(care, slot, goal, state).min(UNREACHABLE);
        self.cache.insert(key, value);
        value
    }

    fn solve(&mut self, care: Care, slot: usize, goal: &Goal, state: &Classes) -> u32 {
        let rating = Rating::new(&self.ground, goal, state);
        if care == Care::Rough {
            return rating.lower;
        }
        let upper = rating.upper(&self.ground, goal, state);
        if upper <= rating.lower {
            return upper;
        }
        self.counts.searches += 1;
        let best = Search::run(self, slot, goal, state, rating.lower, upper, search::NEAR);
        // One press above the bound is common with two targets, and then mostly exact.
        match best < rating.lower + goal.targets.len() as u32 {
            true => best,
            false => Search::run(self, slot, goal, state, rating.lower, best, search::FAR),
        }
    }

    fn key(&self, slot: usize, goal: &Goal, state: &Classes) -> u64 {
        goal.key_of_classes(state) << SLOT_BITS | slot as u64
    }

    fn slot(&self, targets: &[ContentId]) -> usize {
        let second = targets.get(1).map_or(0, |target| target.index());
        targets[0].index() * self.kitchen.contents.len() + second
    }

    #[inline]
    fn make_goal(&mut self, slot: usize, targets: &[ContentId]) {
        if self.goals[slot].is_none() {
            let goal = Goal::new(&self.kitchen, &self.ground.journeys, targets.to_vec());
            self.goals[slot] = Some(Arc::new(goal));
        }
    }
}
