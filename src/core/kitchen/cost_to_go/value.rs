//! Cost to go of single states: number of presses until all orders or one order are served, and whether that number is
//! below a limit, which bounds mostly decide without a search.

use super::fidelity::Fidelity;
use super::partial_plan::BLOCKED;
use super::rating::RankedAssignments;
use super::search::{BestFirstSearch, FAR, NEAR};
use super::store::{CacheSlot, CostToGo, UNREACHABLE};
use crate::kitchen::{ContentId, LocationId, OrderContent, Recipes, State};

impl CostToGo {
    /// C(s, recipes): number of presses until all present orders are served; 0 without orders, [`UNREACHABLE`] if the
    /// orders cannot be served.
    pub fn all_orders(&mut self, state: State, recipes: &Recipes) -> u32 {
        self.all_orders_with(Fidelity::Searched, state, recipes)
    }

    /// Number of presses until all present orders are served, at a given fidelity.
    pub fn all_orders_with(&mut self, fidelity: Fidelity, state: State, recipes: &Recipes) -> u32 {
        let (mut targets, count) = self.targets(state, recipes);
        self.cost(fidelity, state, &mut targets[..count])
    }

    /// C_k(s, recipes): number of presses until the order at this location is served; 0 without an order.
    pub fn order(&mut self, state: State, recipes: &Recipes, order: LocationId) -> u32 {
        self.order_with(Fidelity::Searched, state, recipes, order)
    }

    /// Number of presses until the order at this location is served, at a given fidelity.
    pub fn order_with(&mut self, fidelity: Fidelity, state: State, recipes: &Recipes, order: LocationId) -> u32 {
        match state.order(order) {
            OrderContent::Dish(dish) => self.cost(fidelity, state, &mut [recipes.get(dish)]),
            _ => 0,
        }
    }

    /// Whether the order's cost to go is below `limit`, where `limit` is at most one press above the cost; cheaper than
    /// computing the cost to go.
    pub fn order_is_below(
        &mut self,
        fidelity: Fidelity,
        state: State,
        recipes: &Recipes,
        order: LocationId,
        limit: u32,
    ) -> bool {
        match state.order(order) {
            OrderContent::Dish(dish) if fidelity == Fidelity::Searched => {
                let kept = self.kept_for(state, &mut [recipes.get(dish)]);
                self.is_below(limit, state, kept)
            }
            _ => self.order_with(fidelity, state, recipes, order) < limit,
        }
    }

    pub(super) fn cost(&mut self, fidelity: Fidelity, state: State, targets: &mut [ContentId]) -> u32 {
        if targets.is_empty() {
            return 0;
        }
        let Some((slot, key)) = self.key_of_state(state, targets) else { return UNREACHABLE };
        if let Some(value) = self.known(fidelity, key) {
            return value;
        }
        self.compute_for(fidelity, key, slot, state)
    }

    pub(super) fn value_kept(&mut self, fidelity: Fidelity, state: State, kept: CacheSlot) -> u32 {
        match kept {
            CacheSlot::At(slot, key) => {
                self.known(fidelity, key).unwrap_or_else(|| self.compute_for(fidelity, key, slot, state))
            }
            CacheSlot::Always(value) => value,
        }
    }

    /// The lower bound of a state's cost to go and, if the bound is at most `most`, the length of the state's best
    /// plan.
    pub(super) fn bracket(&mut self, state: State, kept: CacheSlot, most: u32) -> (u32, Option<u32>) {
        let (slot, key) = match kept {
            CacheSlot::At(slot, key) => (slot, key),
            CacheSlot::Always(value) => return (value, Some(value)),
        };
        let known = self.known(Fidelity::LowerBound, key);
        if let Some(lower) = known {
            if lower > most {
                return (lower, None);
            }
            if let Some(upper) = self.known(Fidelity::PlanBound, key) {
                return (lower, Some(upper));
            }
        }
        let Some(goal) = self.goals[slot].clone() else { return (UNREACHABLE, None) };
        let classes = self.classes(&goal, state);
        let rating = RankedAssignments::new(&self.ground, &goal, &classes);
        let lower = known.unwrap_or_else(|| self.keep(Fidelity::LowerBound, key, rating.lower));
        if lower > most {
            return (lower, None);
        }
        let upper = match rating.close_upper(&self.ground, &goal, &classes) {
            BLOCKED => self.solve(Fidelity::PlanBound, slot, &goal, &classes),
            upper => upper,
        };
        (lower, Some(self.keep(Fidelity::PlanBound, key, upper)))
    }

    /// Whether the cost to go of a state is below `limit`, which is at most one press above the cost.
    pub(super) fn is_below(&mut self, limit: u32, state: State, kept: CacheSlot) -> bool {
        if limit == 0 {
            return false;
        }
        match (kept, self.bracket(state, kept, limit - 1)) {
            (_, (_, None)) => false,
            (CacheSlot::At(slot, _), (lower, Some(upper))) if upper >= limit => self.has_way(slot, state, lower, limit),
            (_, (_, Some(upper))) => upper < limit,
        }
    }

    /// Whether a search finds a solution with fewer than `limit` presses.
    fn has_way(&mut self, slot: usize, state: State, lower: u32, limit: u32) -> bool {
        let Some(goal) = self.goals[slot].clone() else { return false };
        let classes = self.classes(&goal, state);
        self.counts.searches += 1;
        let mut finds = |reach| BestFirstSearch::finds(self, slot, &goal, &classes, limit, reach);
        let far = limit >= lower + goal.targets.len() as u32;
        finds(NEAR) || far && finds(FAR)
    }
}
