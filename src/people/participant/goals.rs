//! Goals of a simulated participant in the state that the participant believes: for each order, the missing parts of
//! the dish, and what is available for these parts.

use tomcom_core::kitchen::{
    Agent, ButtonAction, ButtonId, ContentId, DishId, Kitchen, LocationId, LocationKind, Recipes, State,
};

/// A content in the kitchen that can be made into a part of a dish, or that is a finished dish.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PartSource {
    pub at: LocationId,
    pub content: ContentId,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MissingPart {
    /// The part in the form in which it is put on the board: an item, or a stack of several items.
    pub part: ContentId,
    /// The content that can be made into the part; `None` if the part has to come from a storage.
    pub source: Option<PartSource>,
}

/// The simulated participant's goal for one order: the dish, and what is missing for it.
#[derive(Clone, Debug, PartialEq)]
pub struct OrderGoal {
    pub order: LocationId,
    /// The stack of items that the participant believes to be the ordered dish.
    pub stack: ContentId,
    /// The location of the finished stack; `None` if the dish is not finished.
    pub finished: Option<LocationId>,
    /// Whether the stack on the board is the beginning of the ordered dish.
    pub(crate) has_base: bool,
    pub needs: Vec<MissingPart>,
}

/// The participant's goals for all orders that the participant believes in, the order in progress first, and the
/// contents that these goals use.
#[derive(Clone, Debug, PartialEq)]
pub struct Goals {
    pub orders: Vec<OrderGoal>,
    claimed: u32,
}

/// What a simulated participant takes into account to determine the goals.
#[derive(Clone, Copy, Debug)]
pub struct GoalContext<'a> {
    pub kitchen: &'a Kitchen,
    pub knowledge: &'a TaskKnowledge,
    pub recipes: &'a Recipes,
    /// Whether the participant forgets parts that lie at parking places (places without processing).
    pub forgets_parked: bool,
    /// Whether the participant takes items without checking whether they can be used next.
    pub skips_check: bool,
    /// Whether the participant waits for what the robot holds in its hand.
    pub(crate) waits_for_robot: bool,
}

impl Goals {
    /// The goals in a state; the order `first` claims available contents before the other orders.
    pub(crate) fn in_state(prospect: &GoalContext, state: State, first: LocationId) -> Goals {
        let mut wanted: Vec<(LocationId, DishId)> = prospect.kitchen.wanted(state).collect();
        wanted.sort_by_key(|&(order, _)| order != first);
        let mut goals = Goals { orders: Vec::with_capacity(wanted.len()), claimed: 0 };
        for (order, dish) in wanted {
            let goal = goals.of_order(prospect, state, order, prospect.recipes.get(dish));
            goals.orders.push(goal);
        }
        goals
    }

    /// Whether the goal of some order uses the content of this location.
    pub fn uses(&self, location: LocationId) -> bool {
        self.claimed >> location.0 & 1 == 1
    }

    fn claim(&mut self, location: LocationId) {
        self.claimed |= 1 << location.0;
    }

    fn of_order(&mut self, prospect: &GoalContext, state: State, order: LocationId, stack: ContentId) -> OrderGoal {
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
            goal.needs.push(MissingPart { part: source.content, source: Some(source) });
        }
        for part in missing {
            let source = self.find(prospect, state, |_, content| prospect.knowledge.steps_to(content, part));
            if let Some(source) = source {
                self.claim(source.at);
            }
            goal.needs.push(MissingPart { part, source });
        }
        goal
    }

    /// The content that no goal has claimed and that needs the fewest processing steps; ties go to the own hand, then
    /// to places, then to the robot's hand.
    fn find(
        &self,
        prospect: &GoalContext,
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

/// Longest chain of processing steps from an ingredient to a part of a dish.
const MOST_STEPS: usize = 8;

/// How an item is made: the processing step, and the item to which the step is applied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ItemPreparation {
    /// The processing step, as an index into the kitchen's list [`Kitchen::processes`].
    pub process: u8,
    pub from: ContentId,
    /// Place of the processing step; `None` if the step is done in the hand of the agent who presses.
    pub place: Option<LocationId>,
}

/// The task as the participant knows it: the human's buttons by their actions, and the processing steps of every item.
#[derive(Clone, Debug)]
pub struct TaskKnowledge {
    actions: Vec<ButtonAction>,
    makings: Vec<Option<ItemPreparation>>,
    is_station: Vec<bool>,
}

impl TaskKnowledge {
    pub fn new(kitchen: &Kitchen) -> TaskKnowledge {
        let mut knowledge = TaskKnowledge {
            actions: kitchen.buttons[Agent::Human.index()].iter().map(|button| button.action).collect(),
            makings: vec![None; kitchen.contents.len()],
            is_station: vec![false; kitchen.locations.len()],
        };
        for (index, process) in kitchen.processes.iter().enumerate() {
            if let Some(place) = process.place {
                knowledge.is_station[place.index()] = true;
            }
            for &(from, to) in &process.steps {
                let making = ItemPreparation { process: index as u8, from, place: process.place };
                knowledge.makings[to.index()].get_or_insert(making);
            }
        }
        knowledge.is_station[kitchen.board.index()] = true;
        knowledge.is_station[kitchen.plate.index()] = true;
        knowledge
    }

    /// The human's button with this action; `None` if only the robot has one.
    pub fn button(&self, action: ButtonAction) -> Option<ButtonId> {
        self.actions.iter().position(|own| *own == action).map(|index| ButtonId(index as u8))
    }

    /// Whether items are stacked, processed or served at a place, so that the place is more than a parking place.
    pub(crate) fn is_station(&self, place: LocationId) -> bool {
        self.is_station[place.index()]
    }

    /// How an item is made; `None` for an item that comes from a storage.
    pub fn making(&self, item: ContentId) -> Option<ItemPreparation> {
        self.makings[item.index()]
    }

    /// How a part is made, its last processing step first.
    fn makings(&self, part: ContentId) -> impl Iterator<Item = ItemPreparation> {
        std::iter::successors(self.making(part), move |making| self.making(making.from)).take(MOST_STEPS)
    }

    /// The number of processing steps from `content` to `part`; `None` if the content cannot become that part.
    pub(crate) fn steps_to(&self, content: ContentId, part: ContentId) -> Option<u8> {
        let items = std::iter::once(part).chain(self.makings(part).map(|making| making.from));
        items.take(MOST_STEPS).position(|item| item == content).map(|steps| steps as u8)
    }

    /// The next processing step of `content` on the way to `part`; `None` if the content is that part already, or can
    /// never become it.
    pub(crate) fn next_making(&self, content: ContentId, part: ContentId) -> Option<ItemPreparation> {
        self.makings(part).find(|making| making.from == content)
    }

    /// The ingredient, taken from a storage, from which a part is made.
    pub fn ingredient(&self, part: ContentId) -> ContentId {
        self.makings(part).last().map_or(part, |making| making.from)
    }
}
