//! Attribution of an error to a cause: a false belief, or a slip.
//!
//! An error is belief related if log p(a | b) - log p(a | truth) >= ln 3, with the belief b from before the press and p
//! of the human model. A belief related error is attributed to the target (a location, or a recipe) whose replacement
//! by the truth lowers p(a | b) most. A single target explains the error if, after the replacement, the press would not
//! be belief related any more; where no single target explains the error, the best pair of targets is named. Every
//! error that is not belief related is a slip. Simulated participants do not decide by the human model: they record the
//! cause of an error themselves, by repeating their decision with the truth, and distinguish planning errors from
//! slips.

use crate::base::rng::stream;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{
    AspectId, ButtonId, DishId, Kitchen, LocationId, LocationKind, OrderContent, Press, State, WeightedWorlds, World,
};
use crate::mind::belief::Belief;
use crate::mind::choice::ChoiceParameters;
use crate::mind::{ChoiceModel, PressOrigin, RecordedBelief};

/// Least likelihood ratio of belief to truth for a belief related error.
pub(crate) const LIKELIER: f64 = 3.0;
/// Least probability of a false belief about a target that can be part of a pair of causes.
const DOUBTFUL: f64 = 0.1;

/// What a false belief behind an error is about, so that a signal can correct the belief; an order and the recipe of
/// its dish are one target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FalseBeliefTarget {
    /// A false belief about an order or about the recipe of its dish.
    Order(LocationId, Option<DishId>),
    /// A false belief about the content of a location other than an order.
    Place(LocationId),
    /// A false belief about the recipe of a dish that is not ordered.
    Recipe(DishId),
}

/// Cause of an error: slip, planning error or false belief.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ErrorCause {
    /// A slip: the press is not likelier under the belief than under the truth, or a simulated participant recorded a
    /// slip.
    Slip,
    /// A planning error: a simulated participant would have pressed the same button with true beliefs.
    Planning,
    /// A false belief: the belief made the press likelier than the truth would have.
    Belief {
        /// log p(a | b) - log p(a | truth) of the press, in nats; infinite where a simulated participant recorded the
        /// cause of the error, NaN where raters coded the cause.
        gain_nats: f64,
        /// What the false belief is about.
        target: FalseBeliefTarget,
        /// Second target of the false belief, where a single target does not explain the error.
        with: Option<FalseBeliefTarget>,
    },
}

impl FalseBeliefTarget {
    /// The target of a false belief about what this location shows in a state of the kitchen.
    pub(crate) fn of_location(kitchen: &Kitchen, state: State, location: LocationId) -> FalseBeliefTarget {
        match (kitchen.location(location).kind, state.order(location)) {
            (LocationKind::Order, OrderContent::Dish(dish)) => FalseBeliefTarget::Order(location, Some(dish)),
            (LocationKind::Order, _) => FalseBeliefTarget::Order(location, None),
            _ => FalseBeliefTarget::Place(location),
        }
    }

    /// All targets that a false belief of the human can be about in a state of the kitchen.
    pub fn all(kitchen: &Kitchen, state: State) -> Vec<FalseBeliefTarget> {
        let locations = kitchen.location_ids().map(|location| FalseBeliefTarget::of_location(kitchen, state, location));
        let dishes = (0..kitchen.dishes.len()).map(|index| DishId(index as u8));
        let unwanted = dishes.filter(|dish| kitchen.wanted(state).all(|(_, wanted)| wanted != *dish));
        locations.chain(unwanted.map(FalseBeliefTarget::Recipe)).collect()
    }

    /// The state aspects that this target of a false belief covers.
    pub fn aspects(self, kitchen: &Kitchen) -> impl Iterator<Item = AspectId> {
        let (location, dish) = match self {
            FalseBeliefTarget::Order(location, dish) => (Some(location), dish),
            FalseBeliefTarget::Place(location) => (Some(location), None),
            FalseBeliefTarget::Recipe(dish) => (None, Some(dish)),
        };
        let recipe = dish.map(|dish| kitchen.aspect_of_dish(dish));
        location.map(AspectId::of_location).into_iter().chain(recipe)
    }

    /// The target of the false belief in words: "cooking pot", "recipe of tuna maki (order 1)".
    pub fn label(self, kitchen: &Kitchen) -> String {
        match self {
            FalseBeliefTarget::Order(order, Some(dish)) => {
                format!("recipe of {} ({})", kitchen.dish(dish).name, kitchen.location(order).label())
            }
            FalseBeliefTarget::Order(location, None) | FalseBeliefTarget::Place(location) => {
                kitchen.location(location).label()
            }
            FalseBeliefTarget::Recipe(dish) => format!("recipe of {}", kitchen.dish(dish).name),
        }
    }
}

impl ErrorCause {
    /// What the false belief is about; nothing for other causes.
    pub fn targets(self) -> impl Iterator<Item = FalseBeliefTarget> {
        let targets = match self {
            ErrorCause::Belief { target, with, .. } => [Some(target), with],
            ErrorCause::Slip | ErrorCause::Planning => [None, None],
        };
        targets.into_iter().flatten()
    }

    /// The cause of an error that a simulated participant recorded before its press in `state`; `None` if the
    /// record leads to no press.
    pub fn recorded(kitchen: &Kitchen, state: State, witness: &RecordedBelief) -> Option<ErrorCause> {
        match witness.origin? {
            PressOrigin::Plan => return Some(ErrorCause::Planning),
            PressOrigin::Slip => return Some(ErrorCause::Slip),
            PressOrigin::Belief => {}
        }
        let is_told = |target: &FalseBeliefTarget| {
            target.aspects(kitchen).any(|aspect| witness.targets.contains(&kitchen.aspects[aspect.index()].name))
        };
        let mut told = FalseBeliefTarget::all(kitchen, state).into_iter().filter(is_told);
        Some(ErrorCause::Belief { gain_nats: f64::INFINITY, target: told.next()?, with: told.next() })
    }
}

/// Attributes errors of the human to causes.
#[derive(Clone, Debug)]
pub struct ErrorAttributor {
    model: ChoiceParameters,
    seed: u64,
}

struct Inquiry<'a> {
    kitchen: &'a Kitchen,
    model: ChoiceModel,
    /// The worlds that represent the human's belief before the press.
    worlds: WeightedWorlds,
    state: State,
    button: ButtonId,
}

impl ErrorAttributor {
    /// Creates an attributor that uses this choice model; `seed` names the random stream of the worlds that the
    /// attributor draws.
    pub fn new(model: ChoiceParameters, seed: u64) -> ErrorAttributor {
        ErrorAttributor { model, seed }
    }

    /// The cause of an error, given the human's belief before the error. `number` is the number of presses of both
    /// agents including the erroneous press; the number seeds the random stream.
    pub fn cause(
        &self,
        kitchen: &Kitchen,
        cost: &mut CostToGo,
        belief: &Belief,
        press: &Press,
        number: u32,
    ) -> ErrorCause {
        let (state, button) = (press.before, press.button);
        let mut random = stream(self.seed, "attribution", u64::from(number));
        let worlds = self.model.worlds(kitchen, belief, &mut random);
        let model = ChoiceModel::new(kitchen, &self.model);
        let error = Inquiry { kitchen, model, worlds, state, button };
        let believed = error.log_p(cost, &error.worlds);
        let informed = error.log_p(cost, &WeightedWorlds::certain(World::with_true_recipes(kitchen, state)));
        let gain_nats = believed - informed;
        let is_related = gain_nats >= LIKELIER.ln();
        match is_related.then(|| error.explain(cost, informed)).flatten() {
            Some((target, with)) => ErrorCause::Belief { gain_nats, target, with },
            None => ErrorCause::Slip,
        }
    }
}

impl Inquiry<'_> {
    fn log_p(&self, cost: &mut CostToGo, worlds: &WeightedWorlds) -> f64 {
        self.model.probabilities(cost, worlds).press[self.button.index()].ln()
    }

    /// The target, or pair of targets, of a false belief whose replacement by the truth makes the press unlikely
    /// enough.
    fn explain(&self, cost: &mut CostToGo, informed: f64) -> Option<(FalseBeliefTarget, Option<FalseBeliefTarget>)> {
        let mut targets = FalseBeliefTarget::all(self.kitchen, self.state);
        targets.retain(|&target| self.doubt(target) > 0.0);
        let mut singles: Vec<(f64, FalseBeliefTarget)> =
            targets.into_iter().map(|target| (self.log_p(cost, &self.told(&self.worlds, target)), target)).collect();
        // The sort is stable: targets with equal values stay in the layout's order.
        singles.sort_by(|a, b| a.0.total_cmp(&b.0));
        let &(least, target) = singles.first()?;
        if least - informed < LIKELIER.ln() {
            return Some((target, None));
        }
        singles.retain(|&(_, target)| self.doubt(target) >= DOUBTFUL);
        Some(self.best_pair(cost, &singles, least).map_or((target, None), |(one, other)| (one, Some(other))))
    }

    /// The pair of targets whose replacement by the truth lowers the log probability of the press most, if the log
    /// probability falls below `least`; the target with the larger effect of its own comes first.
    fn best_pair(
        &self,
        cost: &mut CostToGo,
        targets: &[(f64, FalseBeliefTarget)],
        mut least: f64,
    ) -> Option<(FalseBeliefTarget, FalseBeliefTarget)> {
        let mut best = None;
        for (index, &(_, one)) in targets.iter().enumerate() {
            let told = self.told(&self.worlds, one);
            for &(_, other) in &targets[index + 1..] {
                let p = self.log_p(cost, &self.told(&told, other));
                if p < least {
                    (least, best) = (p, Some((one, other)));
                }
            }
        }
        best
    }

    /// Probability that the human's belief about the target differs from the truth.
    fn doubt(&self, target: FalseBeliefTarget) -> f64 {
        let told = self.told(&self.worlds, target);
        let wrong = self.worlds.all.iter().zip(&told.all).filter(|(held, true_one)| held != true_one);
        wrong.map(|(held, _)| held.weight).sum()
    }

    /// The same worlds with the value of one target of a false belief replaced by the truth.
    fn told(&self, worlds: &WeightedWorlds, target: FalseBeliefTarget) -> WeightedWorlds {
        let mut worlds = worlds.clone();
        for aspect in target.aspects(self.kitchen) {
            let truth = self.kitchen.true_value(self.state, aspect);
            for one in &mut worlds.all {
                one.world.set_value(self.kitchen, aspect, truth);
            }
        }
        worlds
    }
}
