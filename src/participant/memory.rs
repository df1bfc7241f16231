//! Memory of the recipes: learned in the instruction, half forgotten when unused, recalled (rightly or not) when an order
//! asks for them, doubted when the work does not go as it should.

use rand::RngExt;

use super::beliefs::ParticipantBeliefs;
use super::population::{Individual, Population, normal};
use crate::base::rng::Stream;
use crate::base::time::SessionTime;
use crate::kitchen::{ContentId, DishId, Kitchen};

/// Belief in what was just recalled: people do not hedge.
const RECALLED: f64 = 0.92;
/// Belief in a recipe that was just shown, or that has just been served.
const CONFIRMED: f64 = 0.97;
/// What is left of the belief in a recipe when what it says cannot be served.
const FAILED: f64 = 0.05;
/// The length of menu that the population's memory parameters are for.
const USUAL_MENU: f64 = 6.0;
/// How much more a variant is thought of that fits what was seen.
const FITS: f64 = 4.0;

/// The memory of one person for the recipes.
#[derive(Clone, Debug)]
pub struct Memory {
    random: Stream,
    /// What each dish's memory decays to, over its variants.
    faded: Vec<Vec<f64>>,
    /// What was learned in the instruction: it comes back when the person stops to think.
    learned: Vec<Vec<f64>>,
    /// What is left of each version of a recipe after it was doubted, until one is confirmed.
    left: Vec<Vec<f64>>,
    half_life_s: f64,
    last: SessionTime,
}

impl Memory {
    /// A memory after the instruction; writes the recipe aspects of `beliefs`.
    pub fn new(
        kitchen: &Kitchen,
        population: &Population,
        person: &Individual,
        mut random: Stream,
        beliefs: &mut ParticipantBeliefs,
    ) -> Memory {
        let (mut faded, mut learned) = (Vec::new(), Vec::new());
        // A short menu is easier to remember.
        let ease = USUAL_MENU / kitchen.dishes.len() as f64;
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
            // Some dishes are remembered better than others.
            let odds = odds_of(person.learned) * (0.5 * normal(&mut random)).exp();
            let known = with_truth(odds / (1.0 + odds));
            beliefs.replace(kitchen.aspect_of_dish(DishId(index as u8)), &known);
            learned.push(known);
            let odds = odds_of(person.half_forgotten);
            faded.push(with_truth(odds / (1.0 + odds)));
        }
        let left = learned.iter().map(|known| vec![1.0; known.len()]).collect();
        Memory { random, faded, learned, left, half_life_s: person.half_life_s, last: SessionTime::ZERO }
    }

    /// Time passes: memories of dishes that are not being made fade.
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

    /// Seconds since memories last faded.
    pub fn since_s(&self, now: SessionTime) -> f64 {
        now.secs_since(self.last)
    }

    /// A pause: nothing fades meanwhile.
    pub fn postpone(&mut self, by: SessionTime) {
        self.last = self.last + by;
    }

    /// An order asks for the dish: one version of its recipe comes to mind and is held for the true one.
    pub fn recall(&mut self, kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, dish: DishId) {
        let aspect = kitchen.aspect_of_dish(dish);
        let mut draw = self.random.random::<f64>();
        let values = beliefs.distribution(aspect);
        let recalled = values.iter().position(|p| {
            draw -= p;
            draw < 0.0
        });
        let sure = RECALLED.max(beliefs.certainty(aspect).min(CONFIRMED));
        beliefs.settle(aspect, recalled.unwrap_or(0), sure);
    }

    /// The thread is lost in the middle of the work: the recipe is recalled from a memory that has half faded.
    pub fn lose_thread(&mut self, kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, dish: DishId) {
        beliefs.mix(kitchen.aspect_of_dish(dish), &self.faded[dish.index()], 0.5);
        self.recall(kitchen, beliefs, dish);
    }

    /// What is held for the recipe may be wrong: one stops to think, and another version comes to mind, rather one that
    /// `fits`. `trust` is what is left of the belief in the one that was held.
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
            (false, true) => FITS * left[value],
            (false, false) => left[value],
        });
        self.recall(kitchen, beliefs, dish);
    }

    /// What is held for the recipe could not be served: it is another one.
    pub fn fail(&mut self, kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, dish: DishId) {
        self.doubt(kitchen, beliefs, dish, FAILED, |_| false);
    }

    /// The recipe was shown, or what it says was served.
    pub fn confirm(&mut self, kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, dish: DishId, variant: usize) {
        self.left[dish.index()].fill(1.0);
        beliefs.settle(kitchen.aspect_of_dish(dish), variant, CONFIRMED);
    }
}
