//! What a simulated participant believes: one categorical distribution per state aspect; and its memory of recipes, which
//! are learned in the instruction, fade without use, are recalled (rightly or wrongly) for an order, and doubted after
//! unexpected events.

use tomcom_core::base::rng::Stream;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{AspectId, ContentId, DishId, Kitchen, LocationId, OrderContent, State, World};

use super::population::{ParticipantTraits, Population};
use super::{drawn_by_weight, normal, rare_chance};

/// Beliefs of a simulated participant: one distribution per state aspect. Every distribution sums to 1, and every value
/// of an aspect has a positive probability.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticipantBeliefs {
    of: Vec<Vec<f64>>,
}

/// Probability that is spread evenly over all values of an aspect, so that no value becomes impossible.
const RESIDUE: f64 = 1e-6;

impl ParticipantBeliefs {
    /// Beliefs with probability `sure` on each aspect's value in `state` and on the true recipes; the participant's
    /// memory changes the beliefs about recipes afterwards.
    pub(crate) fn of_state(kitchen: &Kitchen, state: State, sure: f64) -> ParticipantBeliefs {
        let mut beliefs = ParticipantBeliefs { of: kitchen.aspects.iter().map(|a| uniform(a.values.len())).collect() };
        for aspect in kitchen.aspect_ids() {
            beliefs.settle(aspect, kitchen.true_value(state, aspect), sure);
        }
        beliefs
    }

    pub fn distribution(&self, aspect: AspectId) -> &[f64] {
        &self.of[aspect.index()]
    }

    /// Index of the most probable value of a state aspect; ties go to the first value.
    pub fn most_likely(&self, aspect: AspectId) -> usize {
        let values = self.distribution(aspect);
        (1..values.len()).fold(0, |best, index| if values[index] > values[best] { index } else { best })
    }

    pub fn certainty(&self, aspect: AspectId) -> f64 {
        self.distribution(aspect)[self.most_likely(aspect)]
    }

    /// Sets the probability of one value of an aspect to `sure`; the other values share the rest in their present
    /// proportions.
    pub fn settle(&mut self, aspect: AspectId, value: usize, sure: f64) {
        let values = &mut self.of[aspect.index()];
        let others = 1.0 - values[value];
        let left = 1.0 - sure;
        for (index, p) in values.iter_mut().enumerate() {
            *p = match index == value {
                true => sure,
                false if others > 0.0 => *p / others * left,
                false => 0.0,
            };
        }
        normalise(values);
    }

    /// Moves the distribution of an aspect by the share `weight` towards another distribution, which `towards` gives as
    /// unnormalised weights.
    pub fn mix(&mut self, aspect: AspectId, towards: &[f64], weight: f64) {
        let total: f64 = towards.iter().sum();
        if total <= 0.0 {
            return;
        }
        let values = &mut self.of[aspect.index()];
        for (p, other) in values.iter_mut().zip(towards) {
            *p = *p * (1.0 - weight) + weight * other / total;
        }
        normalise(values);
    }

    pub fn weigh(&mut self, aspect: AspectId, factor: impl Fn(usize) -> f64) {
        let values = &mut self.of[aspect.index()];
        for (index, p) in values.iter_mut().enumerate() {
            *p *= factor(index);
        }
        normalise(values);
    }

    /// Replaces the distribution of an aspect by unnormalized weights.
    pub fn replace(&mut self, aspect: AspectId, weights: &[f64]) {
        self.mix(aspect, weights, 1.0);
    }

    /// The world (state and recipes) that is most probable in the participant's beliefs.
    pub fn point(&self, kitchen: &Kitchen) -> World {
        let mut world = World::empty(kitchen);
        for aspect in kitchen.aspect_ids() {
            world.set_value(kitchen, aspect, self.most_likely(aspect));
        }
        world
    }

    pub fn p_truth(&self, kitchen: &Kitchen, state: State, aspect: AspectId) -> f64 {
        self.distribution(aspect)[kitchen.true_value(state, aspect)]
    }
}

pub(crate) fn wanted_dish(kitchen: &Kitchen, beliefs: &ParticipantBeliefs, order: LocationId) -> Option<DishId> {
    let aspect = AspectId::of_location(order);
    match OrderContent::from_code(kitchen.aspects[aspect.index()].values[beliefs.most_likely(aspect)]) {
        OrderContent::Dish(dish) => Some(dish),
        _ => None,
    }
}

fn uniform(length: usize) -> Vec<f64> {
    vec![1.0 / length as f64; length]
}

fn normalise(values: &mut [f64]) {
    let total: f64 = values.iter().sum();
    if !(total.is_finite() && total > 0.0) {
        values.fill(1.0 / values.len() as f64);
        return;
    }
    let share = RESIDUE / values.len() as f64;
    for p in values.iter_mut() {
        *p = *p / total * (1.0 - RESIDUE) + share;
    }
}

/// Probability that the participant gives to the version of a recipe that was just recalled: people do not hedge.
const RECALLED_CERTAINTY: f64 = 0.92;
/// Probability that the participant gives to a recipe that was just shown or served.
const CONFIRMED_CERTAINTY: f64 = 0.97;
/// Share of the belief in a recipe that remains after a stack made by this recipe could not be served.
const FAILED_TRUST: f64 = 0.05;
/// Number of dishes on the menu for which the parameters of the population's memory were set.
const USUAL_MENU_DISHES: f64 = 6.0;
/// Factor on the weight of versions of a recipe that agree with an observation.
const FITTING_FACTOR: f64 = 4.0;

#[derive(Clone, Debug)]
pub struct RecipeMemory {
    random: Stream,
    /// Distribution over the versions of each dish's recipe to which the participant's memory of the recipe fades.
    faded: Vec<Vec<f64>>,
    /// Distribution to which the memory of a recipe fades once the recipe was shown or served, which corrects what was
    /// learned wrongly.
    corrected: Vec<Vec<f64>>,
    /// Distribution over the versions of each dish's recipe after the instruction, which is restored when the
    /// participant doubts the recipe.
    learned: Vec<Vec<f64>>,
    /// Remaining weight of each version of a recipe after doubts; set back when a version is confirmed.
    left: Vec<Vec<f64>>,
    half_life_s: f64,
    last: SessionTime,
}

impl RecipeMemory {
    /// Memory of the recipes after the instruction; creating it also sets the beliefs about recipes in `beliefs`.
    pub fn new(
        kitchen: &Kitchen,
        population: &Population,
        person: &ParticipantTraits,
        mut random: Stream,
        beliefs: &mut ParticipantBeliefs,
    ) -> RecipeMemory {
        let (mut faded, mut learned, mut corrected) = (Vec::new(), Vec::new(), Vec::new());
        // With fewer dishes on the menu, recipes are easier to remember.
        let ease = USUAL_MENU_DISHES / kitchen.dishes.len() as f64;
        let odds_of = |p: f64| p / (1.0 - p) * ease;
        for (index, dish) in kitchen.dishes.iter().enumerate() {
            let alike = &kitchen.content(dish.stack()).look_alikes;
            let weight = |variant: &ContentId| {
                if alike.contains(variant) { population.confuses_look_alikes } else { 1.0 }
            };
            let weights: Vec<f64> = dish.variants[1..].iter().map(weight).collect();
            let total: f64 = weights.iter().sum::<f64>().max(f64::MIN_POSITIVE);
            let with_truth = |p_truth: f64| -> Vec<f64> {
                std::iter::once(p_truth).chain(weights.iter().map(|w| w / total * (1.0 - p_truth))).collect()
            };
            // Individual dishes differ in how well their recipes are remembered.
            let odds = odds_of(person.learned) * (0.5 * normal(&mut random)).exp();
            let known = with_truth(odds / (1.0 + odds));
            let odds = odds_of(person.half_forgotten);
            corrected.push(with_truth(odds / (1.0 + odds)));
            let is_misremembered = !weights.is_empty() && rare_chance(&mut random, person.misremembers);
            let [known, half_forgotten] = match is_misremembered {
                true => {
                    let version = drawn_by_weight(&mut random, &weights).unwrap_or(0);
                    let wrong = sure_of(1 + version, 1 + weights.len());
                    [wrong.clone(), wrong]
                }
                false => [known, corrected[index].clone()],
            };
            beliefs.replace(kitchen.aspect_of_dish(DishId(index as u8)), &known);
            learned.push(known);
            faded.push(half_forgotten);
        }
        let left = learned.iter().map(|known| vec![1.0; known.len()]).collect();
        let (half_life_s, last) = (person.half_life_s, SessionTime::ZERO);
        RecipeMemory { random, faded, corrected, learned, left, half_life_s, last }
    }

    /// Lets the memory of recipes fade for dishes that are not in preparation.
    pub fn fade(&mut self, kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, now: SessionTime, in_use: &[DishId]) {
        let lost = 1.0 - 0.5_f64.powf(now.secs_since(self.last) / self.half_life_s);
        self.last = now;
        for (index, faded) in self.faded.iter().enumerate() {
            let dish = DishId(index as u8);
            if !in_use.contains(&dish) {
                beliefs.mix(kitchen.aspect_of_dish(dish), faded, lost);
            }
        }
    }

    /// Seconds since the memory of recipes was last made to fade.
    pub fn since_s(&self, now: SessionTime) -> f64 {
        now.secs_since(self.last)
    }

    pub fn postpone(&mut self, by: SessionTime) {
        self.last = self.last + by;
    }

    /// Recalls one version of an ordered dish's recipe, in which the participant then believes.
    pub fn recall(&mut self, kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, dish: DishId) {
        let aspect = kitchen.aspect_of_dish(dish);
        let versions = beliefs.distribution(aspect);
        let recalled = drawn_by_weight(&mut self.random, versions).unwrap_or(versions.len() - 1);
        let sure = RECALLED_CERTAINTY.max(beliefs.certainty(aspect).min(CONFIRMED_CERTAINTY));
        beliefs.settle(aspect, recalled, sure);
    }

    /// Lets the participant lose the thread while working on an order: the recipe is recalled again from a partly faded
    /// memory.
    pub(crate) fn lose_thread(&mut self, kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, dish: DishId) {
        beliefs.mix(kitchen.aspect_of_dish(dish), &self.faded[dish.index()], 0.5);
        self.recall(kitchen, beliefs, dish);
    }

    /// Doubts the believed version of a recipe and recalls another version, preferably one that `fits` an observation.
    /// `trust` is the share of the belief in the doubted version that remains.
    pub fn doubt(
        &mut self,
        kitchen: &Kitchen,
        beliefs: &mut ParticipantBeliefs,
        dish: DishId,
        trust: f64,
        fits: impl Fn(ContentId) -> bool,
    ) {
        let aspect = kitchen.aspect_of_dish(dish);
        let held = beliefs.most_likely(aspect);
        let variants = &kitchen.dish(dish).variants;
        beliefs.replace(aspect, &self.learned[dish.index()]);
        let left = &mut self.left[dish.index()];
        left[held] *= trust;
        beliefs.weigh(aspect, |value| match (value == held, fits(variants[value])) {
            (true, _) => left[value],
            (false, true) => FITTING_FACTOR * left[value],
            (false, false) => left[value],
        });
        self.recall(kitchen, beliefs, dish);
    }

    /// Rejects the believed version of a recipe, because a stack made by this version could not be served.
    pub fn fail(&mut self, kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, dish: DishId) {
        self.doubt(kitchen, beliefs, dish, FAILED_TRUST, |_| false);
    }

    /// Confirms a version of a recipe that was shown or served.
    pub fn confirm(&mut self, kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, dish: DishId, variant: usize) {
        self.left[dish.index()].fill(1.0);
        self.faded[dish.index()].clone_from(&self.corrected[dish.index()]);
        beliefs.settle(kitchen.aspect_of_dish(dish), variant, CONFIRMED_CERTAINTY);
    }
}

/// The distribution over `versions` of a recipe for a person who is sure of one version.
fn sure_of(version: usize, versions: usize) -> Vec<f64> {
    let other = (1.0 - CONFIRMED_CERTAINTY) / (versions - 1) as f64;
    (0..versions).map(|index| if index == version { CONFIRMED_CERTAINTY } else { other }).collect()
}
