//! The rules of the task: the state after a press follows from the state before it, by table look-ups.

use serde::Serialize;

use super::compiled::Kitchen;
use super::parts::{Agent, ButtonAction, ButtonId, ContentId, DishId, LocationId};
use super::state::{OrderContent, Recipes, State};

impl Kitchen {
    /// Whether the location `location`, when empty, accepts the content `content`.
    #[inline]
    pub fn accepts(&self, location: LocationId, content: ContentId) -> bool {
        self.tables.accepts[location.index() * self.tables.width + content.index()]
    }

    /// The stack of two contents; `None` if the contents do not stack.
    #[inline]
    pub fn stacked(&self, below: ContentId, above: ContentId) -> Option<ContentId> {
        let stack = self.tables.stacks[below.index() * self.tables.width + above.index()];
        (!stack.is_empty()).then_some(stack)
    }

    /// The result of a processing step; `None` if the step does not apply to the content.
    #[inline]
    pub fn processed(&self, process: u8, content: ContentId) -> Option<ContentId> {
        let result = self.tables.becomes[usize::from(process) * self.tables.width + content.index()];
        (!result.is_empty()).then_some(result)
    }

    /// The locations whose contents determine the effect of this button; the place comes before the hand.
    pub fn involved(&self, agent: Agent, button: ButtonId) -> Vec<LocationId> {
        let hand = self.hands[agent.index()];
        match self.button(agent, button).action {
            ButtonAction::Take(_) | ButtonAction::Trash => vec![hand],
            ButtonAction::Use(location) => vec![location, hand],
            ButtonAction::Process(process) => vec![self.processes[usize::from(process)].place.unwrap_or(hand)],
            ButtonAction::Serve(order) => vec![self.plate, order],
        }
    }

    /// The locations at which the human looks before a press: those that determine the press's effect and, before
    /// fetching an item, the robot's hand, which may be bringing the item.
    pub fn watched(&self, button: ButtonId) -> Vec<LocationId> {
        let fetches = matches!(self.button(Agent::Human, button).action, ButtonAction::Take(_));
        let robots_hand = fetches.then_some(self.hands[Agent::Robot.index()]);
        self.involved(Agent::Human, button).into_iter().chain(robots_hand).collect()
    }

    /// The state of the kitchen after `agent` presses `button`; `None` if the press has no effect.
    #[inline]
    pub fn press(&self, state: State, recipes: &Recipes, agent: Agent, button: ButtonId) -> Option<State> {
        self.act(state, recipes, agent, self.button(agent, button).action)
    }

    /// The state of the kitchen after an action of an agent; `None` if the action is not available. The argument
    /// `recipes` decides what can be served.
    pub fn act(&self, state: State, recipes: &Recipes, agent: Agent, action: ButtonAction) -> Option<State> {
        let hand = self.hands[agent.index()];
        let held = state.content(hand);
        let mut next = state;
        match action {
            ButtonAction::Take(item) => {
                if !held.is_empty() {
                    return None;
                }
                next.set_content(hand, item);
            }
            ButtonAction::Use(location) => {
                let (in_hand, at_location) = self.exchanged(location, held, state.content(location))?;
                next.set_content(hand, in_hand);
                next.set_content(location, at_location);
            }
            ButtonAction::Process(process) => {
                let place = self.processes[usize::from(process)].place.unwrap_or(hand);
                next.set_content(place, self.processed(process, state.content(place))?);
            }
            ButtonAction::Trash => {
                if held.is_empty() {
                    return None;
                }
                next.set_content(hand, ContentId::EMPTY);
            }
            ButtonAction::Serve(order) => {
                let OrderContent::Dish(dish) = state.order(order) else { return None };
                if state.content(self.plate) != recipes.get(dish) {
                    return None;
                }
                next.set_content(self.plate, ContentId::EMPTY);
                next.set_order(order, OrderContent::Served);
            }
        }
        Some(next)
    }

    /// Contents of hand and location after a press of the location's button picked up, put down or stacked an item.
    #[inline]
    fn exchanged(&self, location: LocationId, held: ContentId, there: ContentId) -> Option<(ContentId, ContentId)> {
        match (held.is_empty(), there.is_empty()) {
            (true, true) => None,
            (true, false) => Some((there, ContentId::EMPTY)),
            (false, true) => self.accepts(location, held).then_some((ContentId::EMPTY, held)),
            (false, false) if location == self.board => {
                self.stacked(there, held).map(|stack| (ContentId::EMPTY, stack))
            }
            (false, false) => None,
        }
    }

    /// The ordered dishes with the locations of their orders.
    pub fn wanted(&self, state: State) -> impl Iterator<Item = (LocationId, DishId)> + '_ {
        self.orders.iter().filter_map(move |&order| match state.order(order) {
            OrderContent::Dish(dish) => Some((order, dish)),
            _ => None,
        })
    }
}

/// Why a press has no effect. The reason follows from the button and the true contents alone, and reveals no more than
/// the display shows: nothing about recipes, and nothing about beliefs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum NoEffectReason {
    /// No effect because the agent's hand holds something, but would have to be empty.
    HandFull,
    /// No effect because the agent's hand is empty, but would have to hold something.
    HandEmpty,
    /// No effect because the agent's hand and the place are both empty.
    BothEmpty,
    /// No effect because the place is empty, but would have to hold something.
    PlaceEmpty,
    /// No effect because the place is occupied, and nothing can be stacked on its content.
    PlaceFull,
    /// No effect because the place does not accept the content of the hand.
    NotAccepted,
    /// No effect because the stack at the place has an item of this kind already.
    NotStacked,
    /// No effect because the content of the place was processed in this way already.
    AlreadyProcessed,
    /// No effect because the content of the place can be processed in this way, or that of the hand be stacked, only
    /// after another step. The reason does not say which step.
    NeedsOtherStep,
    /// No effect because the content of the place is never processed in this way.
    NotProcessed,
    /// No effect because the order location shows no order.
    NoOrder,
    /// No effect because the content of the plate cannot be served for this order. The reason does not say which dish
    /// the content is, or what is wrong with it.
    NotServed,
}

impl Kitchen {
    /// Why a press would have no effect in this state with the true recipes, and the location that the reason is about;
    /// `None` if the press would have an effect.
    pub fn no_effect(&self, state: State, agent: Agent, button: ButtonId) -> Option<(NoEffectReason, LocationId)> {
        if self.press(state, &self.true_recipes(), agent, button).is_some() {
            return None;
        }
        let hand = self.hands[agent.index()];
        let is_empty = |location: LocationId| state.content(location).is_empty();
        Some(match self.button(agent, button).action {
            ButtonAction::Take(_) => (NoEffectReason::HandFull, hand),
            ButtonAction::Trash => (NoEffectReason::HandEmpty, hand),
            ButtonAction::Use(location) => match (is_empty(hand), is_empty(location)) {
                (true, _) => (NoEffectReason::BothEmpty, location),
                (false, true) => (NoEffectReason::NotAccepted, location),
                (false, false) if location != self.board => (NoEffectReason::PlaceFull, location),
                (false, false) => match self.not_stacked(state.content(location), state.content(hand)) {
                    NoEffectReason::NeedsOtherStep => (NoEffectReason::NeedsOtherStep, hand),
                    reason => (reason, location),
                },
            },
            ButtonAction::Process(process) => {
                let place = self.processes[usize::from(process)].place.unwrap_or(hand);
                match is_empty(place) {
                    true if place == hand => (NoEffectReason::HandEmpty, hand),
                    true => (NoEffectReason::PlaceEmpty, place),
                    false => (self.not_processed(process, state.content(place)), place),
                }
            }
            ButtonAction::Serve(order) => match (state.order(order), is_empty(self.plate)) {
                (OrderContent::None | OrderContent::Served, _) => (NoEffectReason::NoOrder, order),
                (OrderContent::Dish(_), true) => (NoEffectReason::PlaceEmpty, self.plate),
                (OrderContent::Dish(_), false) => (NoEffectReason::NotServed, order),
            },
        })
    }

    /// Why these contents, which do not stack, do not.
    fn not_stacked(&self, below: ContentId, above: ContentId) -> NoEffectReason {
        let mut all = (0..self.contents.len()).map(|index| ContentId(index as u8));
        if all.all(|other| self.stacked(below, other).is_none()) {
            NoEffectReason::PlaceFull
        } else if self.made_of(above).iter().any(|&made| self.stacked(below, made).is_some()) {
            NoEffectReason::NeedsOtherStep
        } else {
            NoEffectReason::NotStacked
        }
    }

    /// Why this processing step, which does not apply to the content, does not.
    fn not_processed(&self, process: u8, content: ContentId) -> NoEffectReason {
        let steps = &self.processes[usize::from(process)].steps;
        let made = self.made_of(content);
        if steps.iter().any(|&(_, to)| self.made_of(to).contains(&content)) {
            NoEffectReason::AlreadyProcessed
        } else if steps.iter().any(|(from, _)| made.contains(from)) {
            NoEffectReason::NeedsOtherStep
        } else {
            NoEffectReason::NotProcessed
        }
    }

    /// This content, and all that processing steps make of it, one after another.
    fn made_of(&self, content: ContentId) -> Vec<ContentId> {
        let mut made = vec![content];
        let mut at = 0;
        while let Some(&from) = made.get(at) {
            for &(_, to) in self.processes.iter().flat_map(|process| &process.steps).filter(|step| step.0 == from) {
                if !made.contains(&to) {
                    made.push(to);
                }
            }
            at += 1;
        }
        made
    }
}
