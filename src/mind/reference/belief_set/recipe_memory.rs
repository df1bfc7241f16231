//! Memory of recipes in explicit beliefs: forgetting, and recall of one version while a dish is ordered.

use super::ParticleSet;
use crate::base::rng::Stream;
use crate::base::time::SessionTime;
use crate::kitchen::{DishId, State};

impl ParticleSet {
    pub(super) fn forget(&mut self, now: SessionTime, random: &mut Stream) {
        let Some(last) = self.forgot else { return };
        self.forgot = Some(now.max(last));
        let transition = &self.model.transition;
        let lost = |half_life_s: f64| 1.0 - 0.5_f64.powf(now.secs_since(last) / half_life_s);
        let (faded, recalled_anew) = (lost(transition.recipe_half_life_s), lost(transition.recall_half_life_s));
        let dishes: Vec<DishId> = (0..self.kitchen.dishes.len()).map(|index| DishId(index as u8)).collect();
        for person in &mut self.of {
            for &dish in &dishes {
                let aspect = self.kitchen.aspect_of_dish(dish);
                let (forgotten, is_ordered) =
                    (self.forgotten.aspect(aspect), self.kitchen.is_ordered(self.shown, dish));
                match transition.recall_precision {
                    None => {
                        person.forget(aspect, forgotten, faded, random);
                    }
                    Some(_) if !is_ordered => person.fade(aspect, forgotten.mean(), faded),
                    Some(precision) => {
                        if person.forget(aspect, forgotten, recalled_anew, random) {
                            person.recall(aspect, precision, random);
                        }
                    }
                }
            }
        }
    }

    /// Lets the human of every belief recall the recipes of dishes that are ordered in `after` and not in `before`.
    pub(super) fn recall_ordered(&mut self, before: State, after: State, random: &mut Stream) {
        let Some(precision) = self.model.transition.recall_precision else { return };
        for dish in (0..self.kitchen.dishes.len()).map(|index| DishId(index as u8)) {
            if self.kitchen.is_ordered(after, dish) && !self.kitchen.is_ordered(before, dish) {
                let aspect = self.kitchen.aspect_of_dish(dish);
                self.of.iter_mut().for_each(|person| person.recall(aspect, precision, random));
            }
        }
    }
}
