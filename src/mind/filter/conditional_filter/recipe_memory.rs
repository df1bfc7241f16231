//! Memory of recipes in the estimate: forgetting towards the prior, and recall of one version when a dish is ordered.

use super::ConditionalFilter;
use crate::base::time::SessionTime;
use crate::kitchen::{AspectKind, State};

impl ConditionalFilter {
    /// Lets beliefs about recipes decay towards their prior, and beliefs about recipes in use towards what is recalled from
    /// the prior.
    pub(super) fn forget(&mut self, now: SessionTime) {
        let Some(last) = self.forgot else { return };
        self.forgot = Some(now.max(last));
        let transition = &self.model.transition;
        let lost = 1.0 - 0.5_f64.powf(now.secs_since(last) / transition.recipe_half_life_s);
        for index in 0..self.kitchen.aspects.len() {
            let AspectKind::Recipe(dish) = self.kitchen.aspects[index].kind else { continue };
            let mut prior = self.prior.aspects[index].clone();
            if let Some(precision) = transition.recall_precision.filter(|_| self.kitchen.is_ordered(self.shown, dish)) {
                prior.redraw(precision);
            }
            self.belief.aspects[index].mix(lost, &prior);
            if let Some(stretch) = &mut self.stretch {
                stretch.before[index].mix(lost, &prior);
            }
        }
    }

    /// Lets the human recall the recipes of the dishes that are ordered in the state `after` and not in `before`.
    pub(super) fn recall_ordered(&mut self, before: State, after: State) {
        let Some(precision) = self.model.transition.recall_precision else { return };
        for index in 0..self.kitchen.aspects.len() {
            let AspectKind::Recipe(dish) = self.kitchen.aspects[index].kind else { continue };
            if self.kitchen.is_ordered(after, dish) && !self.kitchen.is_ordered(before, dish) {
                self.belief.aspects[index].redraw(precision);
            }
        }
    }
}
