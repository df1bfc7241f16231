//! Goals of a participant in the state that it believes: for each order the parts that are missing, and what is at hand for them.

use super::knowledge::TaskKnowledge;
use crate::kitchen::{Agent, ContentId, DishId, Kitchen, LocationId, LocationKind, Recipes, State};

/// Something in the kitchen that can become a part, or a finished dish.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PartSource {
    /// Where it is.
    pub at: LocationId,
    /// What it is now.
    pub content: ContentId,
}

/// A missing part of a dish.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PartNeed {
    /// The part as it goes on the board: an item, or a stack of several.
    pub part: ContentId,
    /// What is there for it; `None` if it has to come from a storage.
    pub source: Option<PartSource>,
}

/// The goal of one order.
#[derive(Clone, Debug, PartialEq)]
pub struct OrderGoal {
    /// The order.
    pub order: LocationId,
    /// The stack that the participant believes to be the dish.
    pub stack: ContentId,
    /// Where the finished stack is.
    pub finished: Option<LocationId>,
    /// Whether the stack on the board is the beginning of this dish.
    pub has_base: bool,
    /// What is missing.
    pub needs: Vec<PartNeed>,
}

/// The goals of all believed orders, the one in progress first, and which contents they use.
#[derive(Clone, Debug, PartialEq)]
pub struct Goals {
    /// One goal per order.
    pub orders: Vec<OrderGoal>,
    claimed: u32,
}

/// What the participant looks at when it thinks of goals.
#[derive(Clone, Copy, Debug)]
pub struct Prospect<'a> {
    /// The kitchen.
    pub kitchen: &'a Kitchen,
    /// What the participant knows of it.
    pub knowledge: &'a TaskKnowledge,
    /// The recipes that it believes.
    pub recipes: &'a Recipes,
    /// Whether parts that lie at parking places do not come to its mind.
    pub forgets_parked: bool,
    /// Whether it takes things without a look at where they go next.
    pub skips_check: bool,
    /// Whether what the robot holds is waited for.
    pub waits_for_robot: bool,
}

impl Goals {
    /// The goals in a state; those of `first` claim what is there before the others.
    pub fn in_state(prospect: &Prospect, state: State, first: LocationId) -> Goals {
        let mut wanted: Vec<(LocationId, DishId)> = prospect.kitchen.wanted(state).collect();
        wanted.sort_by_key(|&(order, _)| order != first);
        let mut goals = Goals { orders: Vec::with_capacity(wanted.len()), claimed: 0 };
        for (order, dish) in wanted {
            let goal = goals.of_order(prospect, state, order, prospect.recipes.get(dish));
            goals.orders.push(goal);
        }
        goals
    }

    /// Whether some order uses the content of a location.
    pub fn uses(&self, location: LocationId) -> bool {
        self.claimed >> location.0 & 1 == 1
    }

    fn claim(&mut self, location: LocationId) {
        self.claimed |= 1 << location.0;
    }

    fn of_order(&mut self, prospect: &Prospect, state: State, order: LocationId, stack: ContentId) -> OrderGoal {
        let kitchen = prospect.kitchen;
        let mut goal = OrderGoal { order, stack, finished: None, has_base: false, needs: Vec::new() };
        goal.finished = self.find(prospect, state, |_, content| (content == stack).then_some(0)).map(|one| one.at);
        if let Some(at) = goal.finished {
            self.claim(at);
            return goal;
        }
        let mut missing = kitchen.content(stack).items.clone();
        let base = kitchen.content(state.content(kitchen.board));
        goal.has_base = !base.items.is_empty() && !self.uses(kitchen.board) && is_within(&base.items, &missing);
        if goal.has_base {
            self.claim(kitchen.board);
            missing.retain(|item| !base.items.contains(item));
        }
        while let Some(source) = self.find(prospect, state, |at, content| {
            let part = kitchen.content(content);
            (at != kitchen.board && part.is_stack() && is_within(&part.items, &missing)).then_some(0)
        }) {
            self.claim(source.at);
            missing.retain(|item| !kitchen.content(source.content).items.contains(item));
            goal.needs.push(PartNeed { part: source.content, source: Some(source) });
        }
        for part in missing {
            let source = self.find(prospect, state, |_, content| prospect.knowledge.steps_to(content, part));
            if let Some(source) = source {
                self.claim(source.at);
            }
            goal.needs.push(PartNeed { part, source });
        }
        goal
    }

    /// The unclaimed content that needs the fewest steps; of several the own hand's, then that of places, then the robot's.
    fn find(
        &self,
        prospect: &Prospect,
        state: State,
        steps: impl Fn(LocationId, ContentId) -> Option<u8>,
    ) -> Option<PartSource> {
        let mut best: Option<(u8, u8, PartSource)> = None;
        for (index, location) in prospect.kitchen.locations.iter().enumerate() {
            let at = LocationId(index as u8);
            let rank = match location.kind {
                LocationKind::Order => continue,
                LocationKind::Hand(Agent::Human) => 0,
                LocationKind::Place => 1,
                LocationKind::Hand(Agent::Robot) if !prospect.waits_for_robot => continue,
                LocationKind::Hand(Agent::Robot) => 2,
            };
            let content = state.content(at);
            let is_forgotten =
                prospect.forgets_parked && location.kind == LocationKind::Place && !prospect.knowledge.is_station(at);
            if content.is_empty() || self.uses(at) || is_forgotten {
                continue;
            }
            if let Some(steps) = steps(at, content)
                && best.is_none_or(|(least, least_rank, _)| (steps, rank) < (least, least_rank))
            {
                best = Some((steps, rank, PartSource { at, content }));
            }
        }
        best.map(|(_, _, source)| source)
    }
}

fn is_within(items: &[ContentId], all: &[ContentId]) -> bool {
    items.iter().all(|item| all.contains(item))
}
