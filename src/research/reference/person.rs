//! One explicit belief of a human (a categorical distribution per aspect) and its update by the human model,
//! implemented directly from the equations.
//!
//! The same code serves as a belief sample of the reference filter, as a particle of an unprojected filter, and as a
//! human simulated from the model.

use rand::RngExt;
use rand_distr::{Distribution, Gamma};

use super::looks::LocationReading;
use tomcom_core::base::rng::Stream;
use tomcom_core::kitchen::cost_to_go::{CostToGo, Fidelity};
use tomcom_core::kitchen::{Agent, AspectId, ButtonAction, ButtonId, ContentId, DishId, Kitchen, LocationId};
use tomcom_core::kitchen::{OrderContent, Recipes, State};
use tomcom_core::mind::choice::ChoiceParameters;
use tomcom_core::mind::dirichlet::{Dirichlet, DirichletBelief};
use tomcom_core::robot::policy;

/// Share of the fallback distribution in every belief, so that an observation with probability 0 still leaves a proper
/// distribution.
pub const DOUBT: f64 = 1e-6;
/// Probability below which enumerations of all worlds ignore a value.
const NEGLIGIBLE: f64 = 1e-4;

/// An explicit belief of a human: for every state aspect, the probabilities of its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Particle {
    /// For every state aspect the probabilities of its values, in the kitchen's order.
    pub of: Vec<Vec<f64>>,
    /// Whether each location has been read in the present look.
    pub read: Vec<bool>,
    /// Whether the human with this belief has read the signal on the display.
    pub read_signal: bool,
}

/// A hypothesis of kitchen state and recipes, with its probability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PossibleWorld {
    pub state: State,
    /// For every dish, the stack of items that is believed to be its recipe.
    pub recipes: Recipes,
    pub p: f64,
}

impl Particle {
    /// A belief drawn from an estimate; every component is drawn by a gamma variate.
    pub fn draw(kitchen: &Kitchen, estimate: &DirichletBelief, random: &mut Stream) -> Particle {
        let of = estimate.aspects.iter().map(|dirichlet| draw(dirichlet, random)).collect();
        Particle { of, read: vec![false; kitchen.locations.len()], read_signal: false }
    }

    /// Applies a gaze sample: a location that has not been read in this look is read with a probability, and the belief
    /// becomes certain of the value that was read. Where the sample is an observation, the belief is updated by Bayes'
    /// rule.
    pub fn look(&mut self, glances: &[LocationReading], random: &mut Stream) {
        for glance in glances {
            let location = glance.location.index();
            if glance.begins {
                self.read[location] = false;
            }
            if !self.read[location] && random.random::<f64>() < glance.chance {
                self.read[location] = true;
                let value = pick(&glance.reading, random);
                match &glance.observation {
                    None => self.settle(AspectId::of_location(glance.location), value),
                    Some(probabilities) => self.observe(location, value, probabilities),
                }
            }
        }
    }

    /// Updates the belief about a location by Bayes' rule: the value `seen` has the probability
    /// `probabilities[v][seen]` where v is the true value.
    fn observe(&mut self, location: usize, seen: usize, probabilities: &[Vec<f64>]) {
        let of = &mut self.of[location];
        for (p, row) in of.iter_mut().zip(probabilities) {
            *p *= row[seen];
        }
        let total: f64 = of.iter().sum();
        if total > 0.0 {
            of.iter_mut().for_each(|p| *p /= total);
        }
    }

    /// Makes the belief certain of a value of an aspect.
    pub fn settle(&mut self, aspect: AspectId, value: usize) {
        let of = &mut self.of[aspect.index()];
        of.fill(0.0);
        of[value] = 1.0;
    }

    /// Forgets a recipe with the probability `lost`, whereupon the belief is drawn anew from the prior.
    pub fn forget(&mut self, aspect: AspectId, prior: &Dirichlet, lost: f64, random: &mut Stream) {
        if random.random::<f64>() < lost {
            self.of[aspect.index()] = draw(prior, random);
        }
    }

    /// Moves the probability of "served" to "none" in the belief about an order.
    pub fn expect_cleared(&mut self, kitchen: &Kitchen, order: LocationId) {
        let aspect = &kitchen.aspects[order.index()];
        let [served, none] = [OrderContent::Served, OrderContent::None].map(|what| aspect.index_of(what.code()));
        if let (Some(served), Some(none)) = (served, none) {
            let of = &mut self.of[order.index()];
            of[none] += std::mem::take(&mut of[served]);
        }
    }

    /// E_b[C(s)], and E_b[C(s')] after every button of the human: expected costs to go over worlds drawn from the
    /// belief, or over all worlds where there are few.
    pub fn prospects(
        &self,
        kitchen: &Kitchen,
        cost: &mut CostToGo,
        states: usize,
        random: &mut Stream,
    ) -> (f64, Vec<f64>) {
        let mut here = 0.0;
        let mut after = vec![0.0; kitchen.buttons[Agent::Human.index()].len()];
        for way in self.ways(kitchen, states, random) {
            let decision = cost.decision(way.state, &way.recipes, Agent::Human);
            here += way.p * f64::from(decision.here);
            for (sum, &one) in after.iter_mut().zip(&decision.after) {
                *sum += way.p * f64::from(one);
            }
        }
        (here, after)
    }

    /// p(a | b) of every button of the human, given that a button is pressed.
    pub fn press_chances(
        &self,
        kitchen: &Kitchen,
        cost: &mut CostToGo,
        model: &ChoiceParameters,
        states: usize,
        random: &mut Stream,
    ) -> Vec<f64> {
        let (_, after) = self.prospects(kitchen, cost, states, random);
        press_chances(kitchen, model, &after)
    }

    /// Conditions the belief on the human's press and on whether it was effective: Bayes' rule over the aspects on
    /// which the press depends, then the kitchen's rules. `expected` is the fallback distribution of each aspect.
    pub fn pressed(&mut self, kitchen: &Kitchen, expected: &[Vec<f64>], button: ButtonId, effective: bool) {
        let action = kitchen.button(Agent::Human, button).action;
        let hand = kitchen.hands[Agent::Human.index()];
        let places = match action {
            ButtonAction::Take(_) | ButtonAction::Trash => vec![hand],
            ButtonAction::Use(location) => vec![hand, location],
            ButtonAction::Process(process) => vec![kitchen.processes[usize::from(process)].place.unwrap_or(hand)],
            ButtonAction::Serve(order) => vec![order, kitchen.plate],
        };
        // The hand is empty after "trash" whether the press was effective or not, and full after "take".
        let doubtful = |index: usize| -> Vec<f64> {
            self.of[index].iter().zip(&expected[index]).map(|(p, m)| (1.0 - DOUBT) * p + DOUBT * m).collect()
        };
        let before: Vec<Vec<f64>> = (0..self.of.len()).map(doubtful).collect();
        let mut after: Vec<Vec<f64>> = before.iter().map(|values| vec![0.0; values.len()]).collect();
        let mut total = 0.0;
        let mut outcome = |way: PossibleWorld, dish: Option<(AspectId, usize)>| {
            let next = kitchen.act(way.state, &way.recipes, Agent::Human, action);
            let is_possible = match (action, effective) {
                (ButtonAction::Trash, _) | (ButtonAction::Take(_), true) => true,
                _ => next.is_some() == effective,
            };
            if !is_possible {
                return;
            }
            total += way.p;
            let mut state = next.unwrap_or(way.state);
            if let (ButtonAction::Take(item), true) = (action, effective) {
                state.set_content(hand, item);
            }
            for &place in &places {
                if let Some(value) = kitchen.aspects[place.index()].index_of(state.code(place)) {
                    after[place.index()][value] += way.p;
                }
            }
            for recipe in kitchen.locations.len()..kitchen.aspects.len() {
                match dish.filter(|(aspect, _)| aspect.index() == recipe) {
                    Some((_, variant)) => after[recipe][variant] += way.p,
                    // Where another dish is ordered, the press carries no information about this dish's recipe.
                    None => after[recipe].iter_mut().zip(&before[recipe]).for_each(|(sum, p)| *sum += way.p * p),
                }
            }
        };
        match action {
            ButtonAction::Serve(order) => each_serving(kitchen, &before, order, &mut outcome),
            _ => each_exchange(kitchen, &before, &places, &mut outcome),
        }
        let changed = places.iter().map(|place| place.index()).chain(kitchen.locations.len()..kitchen.aspects.len());
        if total > 0.0 {
            for index in changed {
                self.of[index] = after[index].iter().map(|p| p / total).collect();
            }
        }
    }

    /// Updates the belief by a press of the robot: for each world of the belief, the robot's possible presses move
    /// probability between the values of each aspect.
    pub fn robot_pressed(&mut self, kitchen: &Kitchen, cost: &mut CostToGo, states: usize, random: &mut Stream) {
        let locations = kitchen.locations.len();
        let square = |index: usize| vec![vec![0.0; self.of[index].len()]; self.of[index].len()];
        let mut turned: Vec<Vec<Vec<f64>>> = (0..locations).map(square).collect();
        for way in self.ways(kitchen, states, random) {
            let choices = policy::choices(kitchen, cost, Fidelity::Searched, way.state, &way.recipes);
            let after: Vec<State> = choices
                .iter()
                .map(|&button| kitchen.press(way.state, &way.recipes, Agent::Robot, button).unwrap_or(way.state))
                .collect();
            let after = if after.is_empty() { vec![way.state] } else { after };
            for next in &after {
                for (index, turned) in turned.iter_mut().enumerate() {
                    let value_in = |state: &State| kitchen.aspects[index].index_of(state.code(LocationId(index as u8)));
                    if let (Some(from), Some(to)) = (value_in(&way.state), value_in(next)) {
                        turned[from][to] += way.p / after.len() as f64;
                    }
                }
            }
        }
        for (index, turned) in turned.iter().enumerate() {
            let mut next = vec![0.0; self.of[index].len()];
            for (from, to) in turned.iter().enumerate() {
                let occurred: f64 = to.iter().sum();
                match occurred > 0.0 {
                    true => next.iter_mut().zip(to).for_each(|(sum, p)| *sum += self.of[index][from] * p / occurred),
                    false => next[from] += self.of[index][from],
                }
            }
            self.of[index] = next;
        }
    }

    /// The worlds of this belief: all possible worlds if there are at most `draws`, else `draws` samples.
    pub fn ways(&self, kitchen: &Kitchen, draws: usize, random: &mut Stream) -> Vec<PossibleWorld> {
        let count = self.of.iter().map(|values| values.iter().filter(|p| **p > NEGLIGIBLE).count());
        let count = count.fold(1usize, |product, values| product.saturating_mul(values));
        let start = PossibleWorld { state: kitchen.empty_state(), recipes: kitchen.true_recipes(), p: 1.0 };
        if count > draws {
            let p = 1.0 / draws as f64;
            return (0..draws).map(|_| PossibleWorld { p, ..self.draw_way(kitchen, start, random) }).collect();
        }
        let mut ways = vec![start];
        for (index, values) in self.of.iter().enumerate() {
            let likely = || values.iter().enumerate().filter(|(_, p)| **p > NEGLIGIBLE);
            let with = |way: &PossibleWorld, value: usize, p: f64| {
                let mut way = PossibleWorld { p: way.p * p, ..*way };
                kitchen.set_value(&mut way.state, &mut way.recipes, AspectId(index as u8), value);
                way
            };
            let total: f64 = likely().map(|(_, p)| p).sum();
            ways = ways.iter().flat_map(|way| likely().map(move |(value, p)| with(way, value, p / total))).collect();
        }
        ways
    }

    fn draw_way(&self, kitchen: &Kitchen, mut way: PossibleWorld, random: &mut Stream) -> PossibleWorld {
        for (index, values) in self.of.iter().enumerate() {
            let value = pick(values, random);
            kitchen.set_value(&mut way.state, &mut way.recipes, AspectId(index as u8), value);
        }
        way
    }
}

/// Enumerates all pairs of contents of hand and location.
fn each_exchange(
    kitchen: &Kitchen,
    belief: &[Vec<f64>],
    places: &[LocationId],
    outcome: &mut impl FnMut(PossibleWorld, Option<(AspectId, usize)>),
) {
    let start = PossibleWorld { state: kitchen.empty_state(), recipes: kitchen.true_recipes(), p: 1.0 };
    let mut ways = vec![start];
    for place in places {
        let aspect = &kitchen.aspects[place.index()];
        let with = |way: &PossibleWorld, value: usize| {
            let mut way = PossibleWorld { p: way.p * belief[place.index()][value], ..*way };
            way.state.set_code(*place, aspect.values[value]);
            way
        };
        ways = ways.iter().flat_map(|way| (0..aspect.values.len()).map(move |value| with(way, value))).collect();
    }
    ways.into_iter().for_each(|way| outcome(way, None));
}

/// Enumerates all combinations of the order's dish, the plate's content, and the recipe of the ordered dish.
fn each_serving(
    kitchen: &Kitchen,
    belief: &[Vec<f64>],
    order: LocationId,
    outcome: &mut impl FnMut(PossibleWorld, Option<(AspectId, usize)>),
) {
    let (orders, plates) = (&kitchen.aspects[order.index()], &kitchen.aspects[kitchen.plate.index()]);
    for (wanted, &code) in orders.values.iter().enumerate() {
        for (held, &content) in plates.values.iter().enumerate() {
            let p = belief[order.index()][wanted] * belief[kitchen.plate.index()][held];
            let mut way = PossibleWorld { state: kitchen.empty_state(), recipes: kitchen.true_recipes(), p };
            way.state.set_code(order, code);
            way.state.set_content(kitchen.plate, ContentId(content));
            let OrderContent::Dish(dish) = OrderContent::from_code(code) else {
                outcome(way, None);
                continue;
            };
            each_recipe(kitchen, belief, way, dish, outcome);
        }
    }
}

fn each_recipe(
    kitchen: &Kitchen,
    belief: &[Vec<f64>],
    way: PossibleWorld,
    dish: DishId,
    outcome: &mut impl FnMut(PossibleWorld, Option<(AspectId, usize)>),
) {
    let recipe = kitchen.aspect_of_dish(dish);
    for (variant, p) in belief[recipe.index()].iter().enumerate() {
        let mut way = PossibleWorld { p: way.p * p, ..way };
        way.recipes.set(dish, ContentId(kitchen.aspects[recipe.index()].values[variant]));
        outcome(way, Some((recipe, variant)));
    }
}

/// p(a | b) of every button, given that a button is pressed, from the expected cost to go after each button.
pub fn press_chances(kitchen: &Kitchen, model: &ChoiceParameters, expected: &[f64]) -> Vec<f64> {
    let least = expected.iter().copied().fold(f64::INFINITY, f64::min);
    let weights: Vec<f64> = expected.iter().map(|after| (-model.tau * (after - least)).exp()).collect();
    let total: f64 = weights.iter().sum();
    let anywhere = model.lapse * model.lapse_anywhere / expected.len() as f64;
    let mut chances: Vec<f64> = weights.iter().map(|weight| (1.0 - model.lapse) * weight / total + anywhere).collect();
    for (index, weight) in weights.iter().enumerate() {
        let meant = ButtonId(index as u8);
        let next = kitchen.nearest_button(Agent::Human, meant).unwrap_or(meant);
        let alike = kitchen.look_alike_button(Agent::Human, meant).unwrap_or(next);
        for slipped in [next, alike] {
            chances[slipped.index()] += model.lapse * (1.0 - model.lapse_anywhere) / 2.0 * weight / total;
        }
    }
    chances
}

/// Draws a value in proportion to weights that sum to about 1.
pub fn pick(weights: &[f64], random: &mut Stream) -> usize {
    let mut left = random.random::<f64>() * weights.iter().sum::<f64>();
    let reached = weights.iter().position(|weight| {
        left -= weight;
        left < 0.0
    });
    reached.unwrap_or(weights.len() - 1)
}

/// A draw from a Dirichlet by gamma variates, as logarithms (Gamma(a) = Gamma(a + 1) U^(1/a)), since variates with
/// small alphas would underflow.
pub fn draw(dirichlet: &Dirichlet, random: &mut Stream) -> Vec<f64> {
    let log = |value: usize, random: &mut Stream| {
        let alpha = dirichlet.alpha(value);
        let gamma = Gamma::new(alpha + 1.0, 1.0).map_or(1.0, |gamma| gamma.sample(random));
        gamma.ln() + (1.0 - random.random::<f64>()).ln() / alpha
    };
    let logs: Vec<f64> = (0..dirichlet.mean().len()).map(|value| log(value, random)).collect();
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = logs.iter().map(|log| (log - most).exp()).collect();
    let total: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / total).collect()
}
