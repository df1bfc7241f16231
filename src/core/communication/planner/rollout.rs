//! One planner rollout: decisions of a human whose belief is one sample, and presses of the robot in between.
//!
//! Rollouts with the same number use the same random numbers with and without a signal (paired rollouts), which makes
//! the differences between them precise. A rollout that reaches the same state as its baseline is not continued, since
//! it ends like the baseline.

use rand::RngExt;

use crate::base::rng::{Stream, mix};
use crate::communication::concept::{RobotIntent, Situation};
use crate::communication::settings::RolloutSettings;
use crate::kitchen::cost_to_go::{CostToGo, Fidelity, MAX_BUTTONS};
use crate::kitchen::state::MAX_LOCATIONS;
use crate::kitchen::{
    Agent, AspectId, AspectKind, ButtonAction, ButtonId, ContentId, Kitchen, OrderContent, Recipes, State,
    WeightedWorld, WeightedWorlds, World,
};
use crate::mind::choice::{ChoiceModel, ChoiceWeights, HumanChoice};
use crate::robot::policy;

/// Number of robot presses between two decisions of the human that have random numbers of their own.
const ROBOT_DRAWS: usize = 4;

/// Random numbers of one decision of the human and of the robot's presses before that decision; `looks` by location.
#[derive(Clone, Copy, Debug, Default)]
pub struct DecisionDraws {
    decision: f64,
    slip: f64,
    looks: [f64; MAX_LOCATIONS],
    choices: [f64; ROBOT_DRAWS],
    predictions: [f64; ROBOT_DRAWS],
    captures: [f64; ROBOT_DRAWS],
}

impl DecisionDraws {
    pub fn draw(random: &mut Stream) -> DecisionDraws {
        let mut draws = DecisionDraws { decision: random.random(), slip: random.random(), ..DecisionDraws::default() };
        draws.looks.iter_mut().for_each(|draw| *draw = random.random());
        draws.choices.iter_mut().for_each(|draw| *draw = random.random());
        draws.predictions.iter_mut().for_each(|draw| *draw = random.random());
        draws.captures.iter_mut().for_each(|draw| *draw = random.random());
        draws
    }

    /// Replaces three random numbers: of the decision, of the robot's first choice before the decision, and of whether
    /// the robot's first press attracts the gaze.
    pub fn begin_with(&mut self, first: &[f64]) {
        if let &[decision, choice, capture] = first {
            (self.decision, self.choices[0], self.captures[0]) = (decision, choice, capture);
        }
    }
}

/// Data shared by all rollouts of one recommendation.
pub struct RolloutContext<'a> {
    pub kitchen: &'a Kitchen,
    pub recipes: Recipes,
    pub choice: &'a ChoiceModel,
    /// For each button of the human, the state aspects of the locations on which the button's effect depends.
    pub involved: &'a [Vec<AspectId>],
    /// For each button of the human, the state aspects at which the human looks before the press.
    pub watched: &'a [Vec<AspectId>],
    pub model: &'a RolloutSettings,
    pub robot_press_s: f64,
    /// Probability that the human looks at a location that the next press needs, before that press.
    pub looks: f64,
    /// Probability that the human looks at any other location before a decision.
    pub other_looks: f64,
    /// Share of the changes by others that attract the human's gaze at once.
    pub capture: f64,
    /// Probability that the human infers the consequences of a robot press that the human did not see.
    pub foresight: f64,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct RolloutState {
    pub kitchen: State,
    pub worlds: WeightedWorlds<u32>,
    ongoing: Option<OngoingRobotPress>,
    is_still: bool,
    /// Number of presses of both agents since the start of the rollout, and of waits of the human while something is wanted.
    spent: i32,
    now_s: f64,
}

/// The baseline of a signal's rollouts: the rollout without a signal, with its states, the human's choices, and the
/// number of presses that it takes.
#[derive(Clone, Debug, Default)]
pub struct BaselineRollout {
    states: Vec<RolloutState>,
    choices: Vec<HumanChoice>,
    /// Index of the decision before which the human reads a signal. Up to the decision before that one, rollouts with a
    /// signal are the same as the baseline.
    reading_before: usize,
    /// State of the rollout after the last decision that a signal cannot change.
    unread: RolloutState,
    /// Number of presses of both agents and waits of the human up to the horizon, plus the cost to go from there.
    pub value: i32,
}

/// Result of a rollout with a signal, paired with the baseline without one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RolloutOutcome {
    /// Number of presses of both agents and waits of the human in the rollout, plus the cost to go at its end.
    pub value: i32,
    /// The first choice of the human that differs between the two rollouts: in the baseline, and with the signal.
    pub diverged: Option<(HumanChoice, HumanChoice)>,
}

impl RolloutState {
    /// Starts a rollout of a human with these worlds as the belief. `sees` says whether the latest change attracts the
    /// human's gaze.
    pub fn begin(&mut self, kitchen: &Kitchen, situation: &Situation, worlds: &WeightedWorlds<u32>, sees: bool) {
        self.kitchen = situation.state;
        self.worlds.copy_from(worlds);
        for &aspect in situation.changed.iter().filter(|_| sees) {
            self.worlds.learn(kitchen, aspect, self.kitchen);
        }
        self.is_still = situation.robot == RobotIntent::Still;
        self.ongoing = match situation.robot {
            RobotIntent::Busy { button, remaining_s, driven } => {
                Some(OngoingRobotPress { button, due_s: remaining_s, driven })
            }
            RobotIntent::Free | RobotIntent::Still => None,
        };
        (self.spent, self.now_s) = (0, 0.0);
    }

    /// The human looks at every location whose content has just changed.
    fn see_changes(&mut self, kitchen: &Kitchen, before: State) {
        for location in kitchen.changed(before, self.kitchen) {
            self.worlds.learn(kitchen, AspectId::of_location(location), self.kitchen);
        }
    }

    fn copy_from(&mut self, other: &RolloutState) {
        self.worlds.copy_from(&other.worlds);
        self.kitchen = other.kitchen;
        self.ongoing = other.ongoing;
        self.is_still = other.is_still;
        (self.spent, self.now_s) = (other.spent, other.now_s);
    }

    /// Whether this rollout continues exactly like another rollout that is in the state `other` at the same time.
    fn continues_like(&self, other: &RolloutState) -> bool {
        self.kitchen == other.kitchen && self.ongoing == other.ongoing && self.worlds == other.worlds
    }
}

pub struct Rollout<'a> {
    pub context: &'a RolloutContext<'a>,
    pub cost: &'a mut CostToGo,
    pub policy: &'a mut RobotPolicy,
    pub draws: &'a [DecisionDraws],
    /// Time of the human's first decision, in seconds since the start of the rollout.
    pub first_s: f64,
    /// Time at which the human reads a signal, in seconds since the start of the rollout.
    pub read_s: f64,
}

impl Rollout<'_> {
    /// Runs the rollout without a signal and stores its states and the human's choices.
    pub fn baseline(&mut self, state: &mut RolloutState, baseline: &mut BaselineRollout) {
        baseline.choices.clear();
        let is_unread = |step: &usize| self.decision_s(*step) < self.read_s;
        baseline.reading_before = (0..self.draws.len()).take_while(is_unread).count();
        for step in 0..self.draws.len() {
            if step == baseline.reading_before {
                baseline.unread.copy_from(state);
            }
            self.until_decision(state, step, &mut None);
            if baseline.states.len() == step {
                baseline.states.push(RolloutState::default());
            }
            baseline.states[step].copy_from(state);
            let choice = self.decide(state, step);
            baseline.choices.push(choice);
        }
        baseline.value = self.value(state);
    }

    /// Runs the rollout with a signal that makes these aspects certain, paired with the baseline, from the last decision
    /// before the signal is read. The rollout stops once both rollouts are in the same state.
    pub fn with_signal(
        &mut self,
        state: &mut RolloutState,
        aspects: &[AspectId],
        baseline: &BaselineRollout,
    ) -> RolloutOutcome {
        let (mut unread, mut diverged) = (Some(aspects), None);
        if baseline.reading_before == self.draws.len() {
            return RolloutOutcome { value: baseline.value, diverged };
        }
        state.copy_from(&baseline.unread);
        for step in baseline.reading_before..self.draws.len() {
            self.until_decision(state, step, &mut unread);
            let unsignalled = &baseline.states[step];
            if state.continues_like(unsignalled) {
                return RolloutOutcome { value: baseline.value + state.spent - unsignalled.spent, diverged };
            }
            let choice = self.decide(state, step);
            let unsignalled = baseline.choices[step];
            if diverged.is_none() && unsignalled != choice {
                diverged = Some((unsignalled, choice));
            }
        }
        RolloutOutcome { value: self.value(state), diverged }
    }

    fn value(&mut self, state: &RolloutState) -> i32 {
        state.spent + self.cost.all_orders(state.kitchen, &self.context.recipes) as i32
    }

    /// Time of a decision of the human, in seconds since the start of the rollout.
    fn decision_s(&self, step: usize) -> f64 {
        self.first_s + step as f64 * self.context.model.human_press_s
    }

    /// Lets the human read an unread signal, given by the aspects that it makes certain, if it is read by `now_s`.
    fn read_by(&self, now_s: f64, state: &mut RolloutState, unread: &mut Option<&[AspectId]>) {
        if let Some(aspects) = unread.take_if(|_| self.read_s <= now_s) {
            for &aspect in aspects {
                state.worlds.learn(self.context.kitchen, aspect, state.kitchen);
            }
        }
    }

    /// Runs the robot until the human's next decision; the human may read a signal meanwhile.
    fn until_decision(&mut self, state: &mut RolloutState, step: usize, unread: &mut Option<&[AspectId]>) {
        let until_s = self.decision_s(step);
        let mut presses = 0;
        if state.is_still {
            self.read_by(until_s, state, unread);
            state.now_s = until_s;
            return;
        }
        loop {
            self.set_out(state, step, presses);
            let Some(ongoing) = state.ongoing.filter(|press| press.due_s <= until_s) else { break };
            self.read_by(ongoing.due_s, state, unread);
            state.now_s = ongoing.due_s;
            state.ongoing = None;
            let choices = self.choices(state.kitchen);
            if ongoing.holds(choices) {
                let before = state.kitchen;
                state.kitchen = press_of_robot(self.context.kitchen, before, &self.context.recipes, ongoing.button);
                state.spent += 1;
                let draw = self.draws[step].predictions[presses % ROBOT_DRAWS];
                if draw < self.context.foresight {
                    let draw = draw / self.context.foresight;
                    state.worlds.robot_pressed(self.context.kitchen, self.cost, self.policy, draw);
                }
                if self.draws[step].captures[presses % ROBOT_DRAWS] < self.context.capture {
                    state.see_changes(self.context.kitchen, before);
                }
                presses += 1;
            }
        }
        self.read_by(until_s, state, unread);
        state.now_s = until_s;
    }

    fn choices(&mut self, state: State) -> RobotChoices {
        self.policy.choices(self.context.kitchen, self.cost, Fidelity::Searched, state, &self.context.recipes)
    }

    /// Starts the next press of an idle robot arm, as the robot's policy chooses.
    fn set_out(&mut self, state: &mut RolloutState, step: usize, presses: usize) {
        if state.ongoing.is_some() {
            return;
        }
        let choices = self.choices(state.kitchen);
        if choices.count() > 0 {
            let draw = self.draws[step].choices[presses % ROBOT_DRAWS];
            let button: ButtonId = choices.nth((draw * f64::from(choices.count())) as u32);
            state.ongoing =
                Some(OngoingRobotPress { button, due_s: state.now_s + self.context.robot_press_s, driven: false });
        }
    }

    fn decide(&mut self, state: &mut RolloutState, step: usize) -> HumanChoice {
        let (context, draws) = (self.context, &self.draws[step]);
        for (index, &draw) in draws.looks[..context.kitchen.locations.len()].iter().enumerate() {
            if draw < context.other_looks {
                state.worlds.learn(context.kitchen, AspectId(index as u8), state.kitchen);
            }
        }
        let weights = choice_weights(context.choice, self.cost, &state.worlds);
        let mut intended = context.choice.intended(&weights, draws.decision);
        if let HumanChoice::Press(button) = intended {
            let mut is_new = false;
            for &aspect in &context.watched[button.index()] {
                if draws.looks[aspect.index()] < context.looks {
                    is_new |= state.worlds.learn(context.kitchen, aspect, state.kitchen);
                }
            }
            if is_new {
                let weights = choice_weights(context.choice, self.cost, &state.worlds);
                intended = context.choice.intended(&weights, draws.decision);
            }
        }
        let choice = context.choice.executed(intended, draws.slip);
        let before = state.kitchen;
        // A wait counts as a press as long as something is wanted: after that there is nothing to lose by waiting.
        if matches!(choice, HumanChoice::Press(_)) || context.kitchen.wanted(before).next().is_some() {
            state.spent += 1;
        }
        if let HumanChoice::Press(button) = choice {
            let after = context.kitchen.press(before, &context.recipes, Agent::Human, button);
            state.kitchen = after.unwrap_or(before);
            state.worlds.pressed(context.kitchen, button, &context.involved[button.index()], before, after);
        }
        choice
    }
}

// The human in a rollout. The belief is one belief sample, represented by worlds drawn from it; equal worlds are merged,
// with their number of draws as weight. Most people are nearly certain of one value, so few distinct worlds remain.

/// Worlds that are drawn less than once in this many draws use the lower bound of their cost to go.
const FEW_DRAWS: u32 = 8;

impl WeightedWorlds<u32> {
    /// Whether a state aspect has its true value in all worlds.
    pub fn are_certain_of(&self, kitchen: &Kitchen, aspect: AspectId, truth: State) -> bool {
        match kitchen.aspects[aspect.index()].kind {
            AspectKind::Location(location) => {
                let code = truth.code(location);
                self.all.iter().all(|one| one.world.state.code(location) == code)
            }
            AspectKind::Recipe(dish) => {
                let stack: ContentId = kitchen.dish(dish).stack();
                self.all.iter().all(|one| one.world.recipes.get(dish) == stack)
            }
        }
    }

    /// Sets a state aspect to its true value in all worlds; returns whether a world changed.
    pub fn learn(&mut self, kitchen: &Kitchen, aspect: AspectId, truth: State) -> bool {
        if self.are_certain_of(kitchen, aspect, truth) {
            return false;
        }
        for WeightedWorld { world, .. } in &mut self.all {
            match kitchen.aspects[aspect.index()].kind {
                AspectKind::Location(location) => world.state.set_code(location, truth.code(location)),
                AspectKind::Recipe(dish) => world.recipes.set(dish, kitchen.dish(dish).stack()),
            }
        }
        self.merge();
        true
    }

    /// Conditions the worlds on the human's own press and on whether the press was effective. If no world is consistent
    /// with it, the aspects involved are set to their true values, as if the human looked at them.
    pub fn pressed(
        &mut self,
        kitchen: &Kitchen,
        button: ButtonId,
        involved: &[AspectId],
        before: State,
        after: Option<State>,
    ) {
        let press = |world: &World| kitchen.press(world.state, &world.recipes, Agent::Human, button);
        if self.all.iter().any(|one| press(&one.world).is_some() == after.is_some()) {
            self.all.retain_mut(|one| {
                let next = press(&one.world);
                one.world.state = next.unwrap_or(one.world.state);
                next.is_some() == after.is_some()
            });
            return self.merge();
        }
        let truth = after.unwrap_or(before);
        for &aspect in involved {
            self.learn(kitchen, aspect, truth);
        }
        if let ButtonAction::Serve(order) = kitchen.button(Agent::Human, button).action
            && let OrderContent::Dish(dish) = before.order(order)
        {
            self.learn(kitchen, kitchen.aspect_of_dish(dish), truth);
        }
    }

    /// Predicts a press of the robot, of which the human notices only that it happened: the weight of every world is
    /// divided evenly among the presses that the robot's policy allows in that world. The random number `draw`, uniform
    /// in [0, 1), distributes remainders of integer weights.
    pub fn robot_pressed(&mut self, kitchen: &Kitchen, cost: &mut CostToGo, policy: &mut RobotPolicy, draw: f64) {
        let n = self.draws();
        for index in 0..self.all.len() {
            let WeightedWorld { world: World { state, recipes }, weight: count } = self.all[index];
            let choices: RobotChoices = policy.choices(kitchen, cost, fidelity(count, n), state, &recipes);
            let ways = choices.count();
            if ways == 0 {
                continue;
            }
            let first = (draw * f64::from(ways)) as u32;
            let share = |way: u32| count / ways + u32::from(way < count % ways);
            let after = |way: u32| press_of_robot(kitchen, state, &recipes, choices.nth((first + way) % ways));
            self.all[index].world.state = after(0);
            self.all[index].weight = share(0);
            for way in (1..ways).filter(|&way| share(way) > 0) {
                let world = World { state: after(way), recipes };
                self.all.push(WeightedWorld { world, weight: share(way) });
            }
        }
        self.merge();
    }
}

/// Fidelity of the cost to go of a world that was drawn `count` times in `n` draws.
fn fidelity(count: u32, n: u32) -> Fidelity {
    if count * FEW_DRAWS >= n { Fidelity::PlanBound } else { Fidelity::LowerBound }
}

/// Softmax weights of the choices of a human whose belief is given by weighted worlds.
pub fn choice_weights(model: &ChoiceModel, cost: &mut CostToGo, worlds: &WeightedWorlds<u32>) -> ChoiceWeights {
    let mut sums = [0u32; MAX_BUTTONS];
    let n = worlds.draws();
    let mut here = 0u32;
    for &WeightedWorld { world: World { state, recipes }, weight } in &worlds.all {
        let decision = cost.decision_with(fidelity(weight, n), state, &recipes, Agent::Human);
        here += weight * u32::from(decision.here);
        for (sum, &after) in sums.iter_mut().zip(&decision.after) {
            *sum += weight * u32::from(after);
        }
    }
    model.weights(here, &sums[..model.buttons()], n)
}

/// The cache of the robot's policy has 2^15 entries.
const BITS: u32 = 15;

/// The robot's possible presses in a state, as bit sets of buttons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RobotChoices {
    /// The presses among which the policy chooses with equal probability, one bit for each button of the robot.
    pub choices: u64,
    /// The presses that the robot completes if its arm is already moving to their buttons, one bit for each button of
    /// the robot.
    pub useful: u64,
}

impl RobotChoices {
    /// Number of equally likely presses among which the robot chooses.
    pub fn count(self) -> u32 {
        self.choices.count_ones()
    }

    /// The n-th of the robot's equally likely choices, counted from 0.
    pub fn nth(self, n: u32) -> ButtonId {
        let mut left = self.choices;
        for _ in 0..n {
            left &= left - 1;
        }
        ButtonId(left.trailing_zeros() as u8)
    }
}

/// The robot's task policy with a cache by fidelity, state and ordered recipes. The policy's cache changes computing
/// time, never results.
#[derive(Clone, Debug)]
pub struct RobotPolicy {
    known: Vec<Option<(Fidelity, State, Recipes, RobotChoices)>>,
}

impl Default for RobotPolicy {
    fn default() -> Self {
        RobotPolicy { known: vec![None; 1 << BITS] }
    }
}

impl RobotPolicy {
    /// The possible choices of the robot's policy in a state, given the true recipes.
    #[inline]
    pub fn choices(
        &mut self,
        kitchen: &Kitchen,
        cost: &mut CostToGo,
        fidelity: Fidelity,
        state: State,
        recipes: &Recipes,
    ) -> RobotChoices {
        let wanted = wanted_recipes(kitchen, state, recipes);
        let hash = mix(World { state, recipes: wanted }.folded());
        let place = (mix(hash ^ fidelity as u64) >> (64 - BITS)) as usize;
        if let Some((of_fidelity, known, of, choices)) = self.known[place]
            && of_fidelity == fidelity
            && known == state
            && of == wanted
        {
            return choices;
        }
        let bits = |buttons: &[ButtonId]| buttons.iter().fold(0, |bits, button| bits | 1u64 << button.0);
        let best = policy::best_presses(kitchen, cost, fidelity, state, recipes);
        let useful = bits(&best);
        let choices =
            RobotChoices { choices: bits(&policy::chosen(kitchen, cost, fidelity, state, recipes, best)), useful };
        self.known[place] = Some((fidelity, state, wanted, choices));
        choices
    }
}

/// The recipes of ordered dishes, with all other recipes set to a fixed value, since decisions do not depend on those.
fn wanted_recipes(kitchen: &Kitchen, state: State, recipes: &Recipes) -> Recipes {
    let mut wanted = Recipes::default();
    for &order in &kitchen.orders {
        if let OrderContent::Dish(dish) = state.order(order) {
            wanted.set(dish, recipes.get(dish));
        }
    }
    wanted
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OngoingRobotPress {
    pub button: ButtonId,
    /// Time at which the arm touches the button, in seconds since the start of the rollout.
    pub due_s: f64,
    /// Whether the wizard chose the press, so that the robot makes the press even if it is not useful.
    pub driven: bool,
}

impl OngoingRobotPress {
    /// Whether the arm completes the press when it reaches the button.
    pub fn holds(&self, choices: RobotChoices) -> bool {
        self.driven || choices.useful >> self.button.0 & 1 == 1
    }
}

fn press_of_robot(kitchen: &Kitchen, state: State, recipes: &Recipes, button: ButtonId) -> State {
    kitchen.press(state, recipes, Agent::Robot, button).unwrap_or(state)
}
