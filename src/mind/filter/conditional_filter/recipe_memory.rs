//! Memory of recipes in the estimate: forgetting, and recall of one version while a dish is ordered.

use super::ConditionalFilter;
use crate::base::time::SessionTime;
use crate::kitchen::{AspectKind, State};

impl ConditionalFilter {
    /// Lets beliefs about recipes decay to what is left of a forgotten recipe. Where recipes are recalled, each belief fades
    /// while its dish is not ordered, and some are recalled anew from what is left while it is.
    pub(super) fn forget(&mut self, now: SessionTime) {
        let Some(last) = self.forgot else { return };
        self.forgot = Some(now.max(last));
        let transition = &self.model.transition;
        let lost = |half_life_s: f64| 1.0 - 0.5_f64.powf(now.secs_since(last) / half_life_s);
        let (faded, recalled_anew) = (lost(transition.recipe_half_life_s), lost(transition.recall_half_life_s));
        for index in 0..self.kitchen.aspects.len() {
            let AspectKind::Recipe(dish) = self.kitchen.aspects[index].kind else { continue };
            let is_ordered = self.kitchen.is_ordered(self.shown, dish);
            let before = self.stretch.as_mut().map(|stretch| &mut stretch.before[index]);
            for belief in std::iter::once(&mut self.belief.aspects[index]).chain(before) {
                let forgotten = &self.forgotten.aspects[index];
                match transition.recall_precision {
                    None => belief.mix(faded, forgotten),
                    Some(_) if !is_ordered => belief.fade(faded, forgotten.mean()),
                    Some(precision) => belief.mix(recalled_anew, &forgotten.redrawn(precision)),
                }
            }
        }
    }

    /// Lets the human recall the recipes of the dishes that are ordered in the state `after` and not in `before`.
    pub(super) fn recall_ordered(&mut self, before: State, after: State) {
        let Some(precision) = self.model.transition.recall_precision else { return };
        for index in 0..self.kitchen.aspects.len() {
            let AspectKind::Recipe(dish) = self.kitchen.aspects[index].kind else { continue };
            if self.kitchen.is_ordered(after, dish) && !self.kitchen.is_ordered(before, dish) {
                self.belief.aspects[index] = self.belief.aspects[index].redrawn(precision);
            }
        }
    }
}
