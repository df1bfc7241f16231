//! Decisions of the simulated participant, in a world that the participant believes: on which order to work, and which
//! press comes next.
//!
//! A decision is a function of beliefs: when it is repeated with the truth and the same lapses, the result tells
//! whether a press came from a false belief.

use std::collections::VecDeque;

use rand::RngExt;
use tomcom_core::base::rng::Stream;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{Agent, ButtonAction, ButtonId, ContentId, Kitchen, LocationId, LocationKind, State, World};

use super::chance;
use super::goals::{GoalContext, Goals, TaskKnowledge};
use super::planning::{BackwardChaining, ProposedPress};
use super::population::ParticipantTraits;

/// Number of presses after which the participant makes a new plan even if all goes well; the participant looks at the
/// places of planned presses.
const PLANNED_PRESSES: usize = 2;
/// Weights for the choice of an order to work on: of the finished dish, of each part on the board, of each other part
/// that is available.
const FINISHED_WORTH: usize = 100;
const BASE_WORTH: usize = 10;
const PART_WORTH: usize = 2;

/// Share of the decisions without any useful press (desperate ones) in which the participant still waits for the robot.
const HOPES: f64 = 0.5;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParticipantPlan {
    pub plan: VecDeque<ButtonId>,
    /// The order on which the participant works, and the session time until which the participant stays with this
    /// order.
    pub order: Option<(LocationId, SessionTime)>,
    pub(crate) last_dish: Option<ContentId>,
    /// Lapses (omissions and habits) that hold for the decisions until the next press.
    pub lapses: Lapses,
}

impl ParticipantPlan {
    /// Forgets the planned presses and the order in progress, as after an interruption.
    pub fn lose(&mut self) {
        self.plan.clear();
        self.order = None;
    }
}

/// How long the simulated participant has found no useful press, and what the participant therefore does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Impatience {
    Calm,
    /// The participant also considers detours (presses that undo something for another press).
    Impatient,
    /// The participant does not wait for the robot any more, and tries anything.
    Desperate,
}

/// The data for a decision on the participant's next presses, except for the world in which the decision is made.
#[derive(Clone, Debug)]
pub struct DecisionContext<'a> {
    pub kitchen: &'a Kitchen,
    pub knowledge: &'a TaskKnowledge,
    pub(crate) habits: &'a Habits,
    /// Number of own presses ahead that the participant thinks through.
    pub depth: usize,
    pub(crate) in_progress: Option<LocationId>,
    pub(crate) last_dish: Option<ContentId>,
    pub lapses: Lapses,
    pub(crate) urgency: Impatience,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct DecisionResult {
    pub order: Option<LocationId>,
    /// The participant's next presses; empty if the participant waits.
    pub plan: VecDeque<ButtonId>,
}

struct Foreseen {
    path: VecDeque<ButtonId>,
    /// Number of detours (presses that undo something for the sake of another) among the foreseen presses.
    detours: u32,
    fills_hand: bool,
    /// Whether the press itself is a detour, which only makes room.
    is_detour: bool,
}

impl DecisionContext<'_> {
    /// Decides on the participant's next presses in a world that the participant believes to be true.
    pub fn resolve(&self, world: &World) -> DecisionResult {
        let presses = |button: ButtonId| self.kitchen.press(world.state, &world.recipes, Agent::Human, button);
        if let Some(button) = self.lapses.insists_on.filter(|&button| presses(button).is_some()) {
            return DecisionResult { order: self.in_progress, plan: VecDeque::from([button]) };
        }
        let prospect = GoalContext {
            kitchen: self.kitchen,
            knowledge: self.knowledge,
            recipes: &world.recipes,
            forgets_parked: self.lapses.forgets_parked,
            skips_check: self.lapses.skips_check,
            waits_for_robot: self.urgency < Impatience::Desperate || self.lapses.whim < HOPES,
        };
        let habits = self.habits.with_last(self.last_dish.filter(|_| self.lapses.follows_habit));
        let orders = self.orders(&prospect, world.state);
        // If nothing can be done for an order now, the decision considers the next order.
        for &order in &orders {
            if let Some(plan) = self.choose(&prospect, world.state, order, &habits) {
                return DecisionResult { order: Some(order), plan };
            }
        }
        let is_desperate = self.urgency == Impatience::Desperate && !orders.is_empty();
        let plan = is_desperate.then(|| self.try_something(world)).flatten().into_iter().collect();
        DecisionResult { order: orders.first().copied(), plan }
    }

    /// The orders by preference: the order in progress first, then those for which most is available already; ties are
    /// broken at random.
    fn orders(&self, prospect: &GoalContext, state: State) -> Vec<LocationId> {
        let worth = |order: LocationId| {
            let goals = Goals::in_state(prospect, state, order);
            let goal = &goals.orders[0];
            let base =
                if goal.has_base { self.kitchen.content(state.content(self.kitchen.board)).items.len() } else { 0 };
            let parts = goal.needs.iter().filter(|need| need.source.is_some()).count();
            let ready =
                goal.needs.iter().filter(|need| need.source.is_some_and(|one| one.content == need.part)).count();
            FINISHED_WORTH * usize::from(goal.finished.is_some()) + BASE_WORTH * base + PART_WORTH * (parts + ready)
        };
        let mut orders: Vec<(bool, usize, LocationId)> = self
            .kitchen
            .wanted(state)
            .map(|(order, _)| (Some(order) == self.in_progress, worth(order), order))
            .collect();
        let turn = (self.lapses.whim * orders.len() as f64) as usize;
        let turn = turn.min(orders.len());
        orders.rotate_left(turn);
        // The sort is stable: among equally preferred orders, the random rotation decides.
        orders.sort_by_key(|&(in_progress, worth, _)| std::cmp::Reverse((in_progress, worth)));
        orders.into_iter().map(|(_, _, order)| order).collect()
    }

    /// The press with the fewest foreseen detours; ties go to the first of the presses.
    fn choose(
        &self,
        prospect: &GoalContext,
        state: State,
        order: LocationId,
        habits: &Habits,
    ) -> Option<VecDeque<ButtonId>> {
        let chaining = BackwardChaining::new(prospect, state, order);
        let mut proposals = chaining.proposals(habits);
        if self.lapses.takes_along
            && let Some(index) = proposals.iter().position(|press| self.is_quick(press))
        {
            let quick = proposals.remove(index);
            proposals.insert(0, quick);
        }
        if self.urgency == Impatience::Calm {
            proposals.retain(|press| !press.is_detour);
        }
        let mut best: Option<Foreseen> = None;
        for press in proposals {
            let Some(foreseen) = self.foresee(prospect, state, order, habits, press) else { continue };
            if best.as_ref().is_none_or(|one| foreseen.detours < one.detours) {
                best = Some(foreseen);
            }
            if self.lapses.skips_check || best.as_ref().is_some_and(|one| one.detours == 0) {
                break;
            }
        }
        let best = best?;
        // The participant does not fill a hand that would stay full, except to make room: the robot may make room
        // meanwhile.
        let is_trap = best.fills_hand && best.detours > 0 && !best.is_detour && !self.lapses.skips_check;
        (!is_trap).then_some(best.path)
    }

    /// Whether a press needs no foresight: processing and serving take one press and no room.
    fn is_quick(&self, press: &ProposedPress) -> bool {
        let action = self.kitchen.button(Agent::Human, press.button).action;
        matches!(action, ButtonAction::Process(_) | ButtonAction::Serve(_))
    }

    /// Simulates a press and the participant's next presses; `None` if the press would have no effect.
    fn foresee(
        &self,
        prospect: &GoalContext,
        state: State,
        order: LocationId,
        habits: &Habits,
        press: ProposedPress,
    ) -> Option<Foreseen> {
        let act = |state: State, button: ButtonId| self.kitchen.press(state, prospect.recipes, Agent::Human, button);
        let hand = self.kitchen.hands[Agent::Human.index()];
        let mut after = act(state, press.button)?;
        let fills_hand = state.content(hand).is_empty() && !after.content(hand).is_empty();
        let (path, is_detour) = (VecDeque::from([press.button]), press.is_detour);
        let mut foreseen = Foreseen { path, detours: u32::from(is_detour), fills_hand, is_detour };
        let depth = if self.lapses.skips_check { PLANNED_PRESSES } else { self.depth.max(PLANNED_PRESSES) };
        for _ in 1..depth {
            let chaining = BackwardChaining::new(prospect, after, order);
            let proposals = chaining.proposals(habits);
            let forward = proposals.iter().find(|next| !next.is_detour);
            let Some(next) = forward.or(proposals.first()) else { break };
            let Some(then) = act(after, next.button) else { break };
            foreseen.detours += u32::from(next.is_detour);
            if foreseen.path.len() < PLANNED_PRESSES && !next.is_detour {
                foreseen.path.push_back(next.button);
            }
            after = then;
        }
        Some(foreseen)
    }

    /// A press that may end a standstill: a press that empties the hand, or takes something away from a place.
    fn try_something(&self, world: &World) -> Option<ButtonId> {
        let presses = effective_presses(self.kitchen, world);
        let action = |button: &ButtonId| self.kitchen.button(Agent::Human, *button).action;
        let trash = presses.iter().copied().find(|button| action(button) == ButtonAction::Trash);
        if trash.is_some() {
            return trash;
        }
        let clears = |button: &ButtonId| match action(button) {
            ButtonAction::Use(place) => self.kitchen.location(place).kind == LocationKind::Place,
            _ => false,
        };
        let clearing: Vec<ButtonId> = presses.iter().copied().filter(clears).collect();
        let choices = if clearing.is_empty() { presses } else { clearing };
        let index = (self.lapses.whim * choices.len() as f64) as usize;
        choices.get(index).copied()
    }
}

pub(crate) fn effective_presses(kitchen: &Kitchen, world: &World) -> Vec<ButtonId> {
    let press = |button: ButtonId| kitchen.press(world.state, &world.recipes, Agent::Human, button);
    kitchen.button_ids(Agent::Human).filter(|&button| press(button).is_some()).collect()
}

/// Habits of one simulated participant, including the dish that the participant made last.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Habits {
    /// Rank of each content as an ingredient: the participant fetches ingredients of lower rank first.
    ranks: Vec<u8>,
    /// The stack that the participant served last, if the participant confuses it with the present dish in this
    /// decision.
    last: Option<ContentId>,
}

impl Habits {
    pub fn draw(kitchen: &Kitchen, random: &mut Stream) -> Habits {
        Habits { ranks: kitchen.contents.iter().map(|_| random.random_range(0..=u8::MAX)).collect(), last: None }
    }

    /// The same habits for a decision in which the participant confuses the present dish with the last one; with
    /// `None`, for a decision without such a confusion.
    pub fn with_last(&self, last: Option<ContentId>) -> Habits {
        Habits { last, ..self.clone() }
    }

    pub fn rank(&self, ingredient: ContentId) -> u8 {
        self.ranks[ingredient.index()]
    }

    /// The part of the last dish that the participant takes by habit instead of a part of the present dish. Both parts
    /// belong in the same slot of a dish, so that they do not stack.
    pub(crate) fn part_instead(&self, kitchen: &Kitchen, stack: ContentId, part: ContentId) -> Option<ContentId> {
        let last = &kitchen.content(self.last?).items;
        let own = &kitchen.content(stack).items;
        if last.contains(&part) {
            return None;
        }
        last.iter().copied().find(|&other| !own.contains(&other) && kitchen.stacked(part, other).is_none())
    }
}

/// Lapses of a simulated participant (omissions, habits and chance) in the decisions until the next press. A repeated
/// decision has the same lapses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lapses {
    /// Lapse: the participant does not check the preconditions of presses after the next one.
    pub skips_check: bool,
    /// Lapse: the participant confuses the present dish with the last one.
    pub follows_habit: bool,
    /// Lapse: the participant forgets parts that lie at parking places.
    pub forgets_parked: bool,
    /// Lapse: the participant first does what is within reach for another order.
    pub takes_along: bool,
    /// Random number from 0 to 1 that decides between equally good choices.
    pub(crate) whim: f64,
    /// The button of the press that just had no effect, if the participant tries that press again.
    pub(crate) insists_on: Option<ButtonId>,
}

impl Lapses {
    pub fn draw(person: &ParticipantTraits, random: &mut Stream) -> Lapses {
        Lapses {
            skips_check: chance(random, person.skips_check),
            follows_habit: chance(random, person.follows_habit),
            forgets_parked: chance(random, person.forgets_parked),
            takes_along: chance(random, person.takes_along),
            whim: random.random::<f64>(),
            insists_on: None,
        }
    }
}
