//! Shards of simulations and analyses, which several computers share.

use std::str::FromStr;

/// Largest number of shards of a simulation.
const MAX_SHARDS: u64 = 100_000;

/// A shard of a simulation's trials, so that several computers can share the simulation: number `number` (from 1) of
/// `of` disjoint parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SimulationShard {
    /// Number of this shard, from 1.
    pub number: u64,
    /// Number of shards into which the simulation is divided.
    pub of: u64,
}

impl SimulationShard {
    /// The only shard of an undivided simulation, with all trials.
    pub const WHOLE: SimulationShard = SimulationShard { number: 1, of: 1 };
}

impl FromStr for SimulationShard {
    type Err = String;

    fn from_str(text: &str) -> Result<SimulationShard, String> {
        let parts = text.split_once('/').and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
        match parts {
            Some((number, of)) if number >= 1 && number <= of && of <= MAX_SHARDS => Ok(SimulationShard { number, of }),
            _ => Err("a part and how many there are, such as 1/8 to 8/8".to_string()),
        }
    }
}
