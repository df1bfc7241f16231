//! Cost to go: the least number of presses, of both agents one after another, until the orders are served.

mod cache;
mod goal;
mod journeys;
mod plan;

use std::sync::Arc;

use self::cache::Cache;
use self::goal::{Classes, Goal};
use self::plan::{BLOCKED, Ground, Planner};
use super::content::ContentId;
use super::layout::LocationId;
use super::state::{OrderContent, Recipes, State};
use super::{Kitchen, LocationKind};

/// The value of states from which the goal cannot be reached.
pub const UNREACHABLE: u32 = 255;
/// Expansions of the bounded search, at most.
const MAX_EXPANSIONS: usize = 400;

/// Computes costs to go and remembers them.
#[derive(Clone, Debug)]
pub struct CostToGo {
    kitchen: Arc<Kitchen>,
    ground: Ground,
    /// `[first * (contents + 1) + second]`: goals by their targets, made when first wanted.
    goals: Vec<Option<Arc<Goal>>>,
    cache: Cache,
    pub stats: Stats,
}

#[derive(Clone, Copy, Debug, Default)]
pub struct Stats {
    pub calls: u64,
    pub misses: u64,
    pub searched: u64,
    pub expansions: u64,
}

impl CostToGo {
    pub fn new(kitchen: Arc<Kitchen>) -> CostToGo {
        let ground = Ground::new(&kitchen);
        let goals = vec![None; kitchen.contents.len() * kitchen.contents.len()];
        CostToGo { kitchen, ground, goals, cache: Cache::new(20), stats: Stats::default() }
    }

    /// C(s, recipes): presses until all present orders are served; 0 if there is none.
    pub fn all_orders(&mut self, state: State, recipes: &Recipes) -> u32 {
        let mut targets = [ContentId::EMPTY; 2];
        let mut count = 0;
        for order in 0..self.ground.first {
            if let OrderContent::Dish(dish) = state.order(LocationId(order as u8)) {
                targets[count] = recipes.get(dish);
                count += 1;
            }
        }
        self.cost(state, &mut targets[..count])
    }

    /// C_k(s, recipes): presses until the order at this location is served; 0 if there is none.
    pub fn order(&mut self, state: State, recipes: &Recipes, order: LocationId) -> u32 {
        debug_assert_eq!(self.kitchen.location(order).kind, LocationKind::Order);
        match state.order(order) {
            OrderContent::Dish(dish) => self.cost(state, &mut [recipes.get(dish)]),
            _ => 0,
        }
    }

    fn cost(&mut self, state: State, targets: &mut [ContentId]) -> u32 {
        if targets.is_empty() {
            return 0;
        }
        self.stats.calls += 1;
        targets.sort_unstable();
        let slot = self.goal_slot(targets);
        if self.goals[slot].is_none() {
            let goal = Goal::new(&self.kitchen, &self.ground.journeys, targets.to_vec());
            self.goals[slot] = Some(Arc::new(goal));
        }
        let Some(goal) = &self.goals[slot] else { return UNREACHABLE };
        let mut key = 0;
        for (index, parts) in goal.key_parts.iter().enumerate() {
            key += parts[usize::from(state.code(LocationId((self.ground.first + index) as u8)))];
        }
        let key = (key << 12) ^ slot as u64;
        if let Some(value) = self.cache.get(key) {
            return u32::from(value);
        }
        self.stats.misses += 1;
        let goal = goal.clone();
        let mut classes: Classes = [0; 16];
        for location in self.ground.first..self.ground.last {
            classes[location] = goal.class_of[state.content(LocationId(location as u8)).index()];
        }
        let value = solve(&self.ground, &goal, &classes, &mut self.stats).min(UNREACHABLE);
        self.cache.insert(key, value as u8);
        value
    }

    fn goal_slot(&self, targets: &[ContentId]) -> usize {
        let first = targets[0].index();
        let second = targets.get(1).map_or(0, |target| target.index());
        first * self.kitchen.contents.len() + second
    }
}

fn solve(ground: &Ground, goal: &Goal, start: &Classes, stats: &mut Stats) -> u32 {
    let planner = Planner { ground, goal };
    let lower = planner.serial(start, true);
    let mut best = planner.serial(start, false);
    if best <= lower {
        return best;
    }
    stats.searched += 1;
    // Best first over single presses; every state met ends at least in its serial plan.
    let mut open: Vec<Vec<(u32, Classes)>> = vec![Vec::new(); 128];
    let mut seen: std::collections::HashMap<Classes, u32> = std::collections::HashMap::new();
    open[lower as usize].push((0, *start));
    let mut expansions = 0;
    let mut bound = lower as usize;
    while bound < open.len() && (bound as u32) < best {
        let Some((cost, state)) = open[bound].pop() else {
            bound += 1;
            continue;
        };
        if seen.get(&state).is_some_and(|&seen| seen < cost) {
            continue;
        }
        expansions += 1;
        if expansions > MAX_EXPANSIONS && best < BLOCKED {
            break;
        }
        planner.successors(&state, |next| {
            let cost = cost + 1;
            if seen.get(&next).is_some_and(|&seen| seen <= cost) {
                return;
            }
            let lower = cost + planner.serial(&next, true);
            if lower >= best {
                return;
            }
            seen.insert(next, cost);
            let upper = cost + planner.serial(&next, false);
            best = best.min(upper);
            if lower < best && (lower as usize) < open.len() {
                open[(lower as usize).max(bound)].push((cost, next));
            }
        });
    }
    stats.expansions += expansions as u64;
    best
}
