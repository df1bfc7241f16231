//! The cost to go that a command keeps from recording to recording, and from trial to trial.

use std::sync::Arc;

use tomcom_core::kitchen::Kitchen;
use tomcom_core::kitchen::cost_to_go::CostToGo;

/// Cost to go of the last recording's or trial's kitchen. Most recordings that a command reads, and all trials that it
/// simulates, are of one kitchen, so the tables and caches that one of them filled serve the next. They change computing
/// time, never results.
#[derive(Clone, Debug, Default)]
pub struct KeptCost(Option<(Arc<Kitchen>, CostToGo)>);

impl KeptCost {
    pub fn for_kitchen(&mut self, kitchen: &Arc<Kitchen>) -> &mut CostToGo {
        let cost = self.take(kitchen);
        let (_, cost) = self.0.insert((kitchen.clone(), cost));
        cost
    }

    /// Takes the cost to go for a trial in this kitchen, which owns it until [`KeptCost::keep`] gets it back.
    pub fn take(&mut self, kitchen: &Arc<Kitchen>) -> CostToGo {
        let kept = self.0.take().filter(|(known, _)| **known == **kitchen);
        kept.map_or_else(|| CostToGo::new(kitchen.clone()), |(_, cost)| cost)
    }

    pub fn keep(&mut self, kitchen: &Arc<Kitchen>, cost: CostToGo) {
        self.0 = Some((kitchen.clone(), cost));
    }
}
