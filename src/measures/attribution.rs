//! Why a press was an error: because of a false belief, or a slip.
//!
//! An error is belief related if log p(a | b) - log p(a | truth) >= ln 3, with b from before the press and p of the human
//! model. It is put down to the target whose replacement by the truth lowers p(a | b) most. A single target explains the
//! error if the press would not be belief related any more; where none does, the best pair is named. Whatever is not
//! belief related is a slip.

use crate::base::rng::stream;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{
    AspectId, ButtonId, DishId, Kitchen, LocationId, LocationKind, OrderContent, Press, State, WeightedWorlds, World,
};
use crate::mind::ChoiceModel;
use crate::mind::belief::Belief;
use crate::mind::decision::DecisionModel;

/// So many times likelier under the belief than under the truth.
pub const LIKELIER: f64 = 3.0;
/// What is believed wrong at least so surely can be one of the two causes of an error.
const DOUBTFUL: f64 = 0.1;

/// What a human can be wrong about and be told: an order and the recipe of its dish count as one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Target {
    /// What an order wants, and how that is made.
    Order(LocationId, Option<DishId>),
    /// What lies at a location that is no order.
    Place(LocationId),
    /// The recipe of a dish that no order wants.
    Recipe(DishId),
}

/// Why a press was an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// Not likelier for the belief than for the truth.
    Slip,
    Belief {
        /// log p(a | b) - log p(a | truth), in nats.
        gain_nats: f64,
        target: Target,
        /// The second target, where one alone does not explain the error.
        with: Option<Target>,
    },
}

impl Target {
    /// Everything that a human can be told in this state.
    pub fn all(kitchen: &Kitchen, state: State) -> Vec<Target> {
        let locations = (0..kitchen.locations.len()).map(|index| LocationId(index as u8));
        let of_location = |location: LocationId| match (kitchen.location(location).kind, state.order(location)) {
            (LocationKind::Order, OrderContent::Dish(dish)) => Target::Order(location, Some(dish)),
            (LocationKind::Order, _) => Target::Order(location, None),
            _ => Target::Place(location),
        };
        let dishes = (0..kitchen.dishes.len()).map(|index| DishId(index as u8));
        let unwanted = dishes.filter(|dish| kitchen.wanted(state).all(|(_, wanted)| wanted != *dish));
        locations.map(of_location).chain(unwanted.map(Target::Recipe)).collect()
    }

    /// The state aspects that it is about.
    pub fn aspects(self, kitchen: &Kitchen) -> impl Iterator<Item = AspectId> {
        let (location, dish) = match self {
            Target::Order(location, dish) => (Some(location), dish),
            Target::Place(location) => (Some(location), None),
            Target::Recipe(dish) => (None, Some(dish)),
        };
        let recipe = dish.map(|dish| kitchen.aspect_of_dish(dish));
        location.map(AspectId::of_location).into_iter().chain(recipe)
    }

    /// In words: "cooking pot", "tuna maki of order 1".
    pub fn label(self, kitchen: &Kitchen) -> String {
        match self {
            Target::Order(order, Some(dish)) => {
                format!("{} of {}", kitchen.dish(dish).name, kitchen.location(order).label())
            }
            Target::Order(location, None) | Target::Place(location) => kitchen.location(location).label(),
            Target::Recipe(dish) => format!("recipe of {}", kitchen.dish(dish).name),
        }
    }
}

/// Finds the causes of errors.
#[derive(Clone, Debug)]
pub struct Attributor {
    model: DecisionModel,
    /// Everything random follows from it.
    seed: u64,
}

/// An error that is looked into.
struct Inquiry<'a> {
    kitchen: &'a Kitchen,
    model: ChoiceModel,
    /// The worlds that stand for the belief.
    worlds: WeightedWorlds,
    state: State,
    button: ButtonId,
}

impl Attributor {
    pub fn new(model: DecisionModel, seed: u64) -> Attributor {
        Attributor { model, seed }
    }

    /// The cause of a press that was an error, given the belief before it. `number`: how many presses both agents have
    /// made, this one included; it seeds the random stream.
    pub fn cause(&self, kitchen: &Kitchen, cost: &mut CostToGo, belief: &Belief, press: &Press, number: u32) -> Cause {
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
            Some((target, with)) => Cause::Belief { gain_nats, target, with },
            None => Cause::Slip,
        }
    }
}

impl Inquiry<'_> {
    /// The log probability of the press under a belief.
    fn log_p(&self, cost: &mut CostToGo, worlds: &WeightedWorlds) -> f64 {
        self.model.probabilities(cost, worlds).press[self.button.index()].ln()
    }

    /// The target, or pair of targets, that makes the press unlikely when it is put right.
    fn explain(&self, cost: &mut CostToGo, informed: f64) -> Option<(Target, Option<Target>)> {
        let mut targets = Target::all(self.kitchen, self.state);
        targets.retain(|&target| self.doubt(target) > 0.0);
        let mut singles: Vec<(f64, Target)> =
            targets.into_iter().map(|target| (self.log_p(cost, &self.told(&self.worlds, target)), target)).collect();
        // The sort is stable: of equals the first location.
        singles.sort_by(|a, b| a.0.total_cmp(&b.0));
        let &(least, target) = singles.first()?;
        if least - informed < LIKELIER.ln() {
            return Some((target, None));
        }
        singles.retain(|&(_, target)| self.doubt(target) >= DOUBTFUL);
        Some(self.best_pair(cost, &singles, least).map_or((target, None), |(one, other)| (one, Some(other))))
    }

    /// The pair of these targets that makes the press least likely when it is put right, if it becomes less likely than
    /// `least`; the one that does more by itself comes first.
    fn best_pair(&self, cost: &mut CostToGo, targets: &[(f64, Target)], mut least: f64) -> Option<(Target, Target)> {
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

    /// How likely it is, for the human, that the target is other than it truly is.
    fn doubt(&self, target: Target) -> f64 {
        let told = self.told(&self.worlds, target);
        let wrong = self.worlds.all.iter().zip(&told.all).filter(|(held, true_one)| held != true_one);
        wrong.map(|(held, _)| held.weight).sum()
    }

    /// The same worlds with one target as it truly is.
    fn told(&self, worlds: &WeightedWorlds, target: Target) -> WeightedWorlds {
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
