//! The cost to go that a command keeps from recording to recording.

use std::sync::Arc;

use crate::kitchen::Kitchen;
use crate::kitchen::cost_to_go::CostToGo;

/// Cost to go of the last recording's kitchen. Most recordings that a command reads are of one kitchen, so the tables
/// and caches that one recording filled serve the next. They change computing time, never results.
#[derive(Clone, Debug, Default)]
pub struct KeptCost(Option<(Arc<Kitchen>, CostToGo)>);

impl KeptCost {
    /// The cost to go for a recording of this kitchen.
    pub fn for_kitchen(&mut self, kitchen: &Arc<Kitchen>) -> &mut CostToGo {
        let kept = self.0.take().filter(|(known, _)| **known == **kitchen);
        let (_, cost) = self.0.insert(kept.unwrap_or_else(|| (kitchen.clone(), CostToGo::new(kitchen.clone()))));
        cost
    }
}
