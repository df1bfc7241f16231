//! Assignment of participants to starting groups by permuted blocks (Pocock 1983, Clinical Trials, ch. 5): groups are
//! equal after every block, and the next assignment is unpredictable.

use super::groups::{StartingGroup, orders};
use super::plan_spec::PlanSpec;
use tomcom_core::base::rng::{shuffle, stream};

impl PlanSpec {
    /// The starting group of the participant with this index: a function of plan and seed alone.
    pub fn group(&self, seed: u64, participant: usize) -> StartingGroup {
        let orders = orders(self.conditions.len());
        let block = self.block.map_or(2 * orders.len(), |block| block as usize);
        let mut places: Vec<usize> = (0..block).map(|place| place % orders.len()).collect();
        let mut random = stream(seed, "groups", (participant / block) as u64);
        shuffle(&mut places, &mut random);
        let order = &orders[places[participant % block]];
        StartingGroup {
            name: order.iter().map(|&index| char::from(b'A' + index as u8)).collect(),
            conditions: order.iter().map(|&index| self.conditions[index]).collect(),
        }
    }
}
