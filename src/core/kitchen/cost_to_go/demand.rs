//! The lower bound of the cost to go: least number of presses for a set of tasks, from the items' journeys to the board
//! and from clearing obstacles.

use super::classes::CompactState;
use super::goal::ServingGoal;
use super::ground::KitchenTables;
use super::journeys::JourneyNeeds;
use super::task::{DeliveryTask, STORAGE};

/// Requirements of a set of tasks: presses, places and target dishes.
#[derive(Clone, Copy, Debug, Default)]
pub struct TaskRequirements {
    /// Number of presses that the tasks would take without obstacles.
    presses: u32,
    /// Bit set of the locations whose content the tasks use.
    used: u32,
    /// Free hands and places that the items' journeys to the board require.
    needs: JourneyNeeds,
    /// For each processing place (station): free hands and places that the journeys through this station require.
    station_needs: [JourneyNeeds; 8],
    /// Bit set of the target dishes that have to be assembled on the board.
    assembled: u32,
    /// Whether anything remains to be done before the last press (serving).
    is_busy: bool,
}

impl TaskRequirements {
    /// The requirements of these tasks, with the tasks' items at their present places.
    pub fn from_tasks(
        ground: &KitchenTables,
        goal: &ServingGoal,
        state: &CompactState,
        tasks: impl Iterator<Item = DeliveryTask>,
    ) -> TaskRequirements {
        let mut demand = TaskRequirements::default();
        for task in tasks {
            let (target, at) = (usize::from(task.target), usize::from(task.at));
            if task.at != STORAGE {
                demand.used |= 1 << task.at;
            }
            demand.is_busy |= at != ground.plate;
            if task.bits == goal.complete[target] {
                demand.presses += ground.last_presses(at);
                continue;
            }
            if demand.assembled & 1 << target == 0 {
                demand.assembled |= 1 << target;
                demand.presses += ground.last_presses(ground.board);
            }
            if !goal.is_ready(ground, state, &task) {
                let (presses, needs) = goal.way(state, &task, task.at);
                demand.presses += u32::from(presses);
                demand.need(needs);
            }
        }
        demand
    }

    fn need(&mut self, needs: JourneyNeeds) {
        self.needs |= needs;
        let mut stations = needs >> 2;
        while stations != 0 {
            self.station_needs[stations.trailing_zeros() as usize & 7] |= needs;
            stations &= stations - 1;
        }
    }

    /// Lower bound of the number of presses: presses of the journeys plus presses for clearing obstacles. It is a press
    /// too high in a few states, in which a hand that a journey through an occupied station needs is free again before
    /// the station is cleared.
    pub fn bound(&self, ground: &KitchenTables, state: &CompactState) -> u32 {
        self.least(ground, state, |needs| needs & 3 != 3)
    }

    /// Lower bound of the number of presses that holds in every state.
    pub fn floor(&self, ground: &KitchenTables, state: &CompactState) -> u32 {
        self.least(ground, state, |_| true)
    }

    /// Least number of presses; `can_keep` says whether a hand can keep the content of a station, through which journeys
    /// with these needs lead, until the end.
    fn least(&self, ground: &KitchenTables, state: &CompactState, can_keep: fn(JourneyNeeds) -> bool) -> u32 {
        let unused = |location: usize| state[location] != 0 && self.used & (1 << location) == 0;
        let mut in_the_way = 0;
        // Every useless content of a hand has to be thrown away, except in a hand that is not needed any more.
        let mut kept = false;
        if unused(ground.plate) {
            in_the_way += 1;
            kept = true;
        }
        if self.assembled != 0 && unused(ground.board) {
            in_the_way += 1;
            kept = true;
        }
        for (index, &station) in ground.journeys.stations.iter().enumerate() {
            let needs = self.station_needs[index];
            if needs != 0 && unused(station.index()) && station.index() != ground.plate {
                in_the_way += 1;
                kept |= can_keep(needs);
            }
        }
        let held = ground.hands.map(unused);
        kept |= held[0] && self.needs & 1 == 0 || held[1] && self.needs & 2 == 0;
        let thrown = u32::from(held[0]) + u32::from(held[1]) + in_the_way - u32::from(kept);
        self.presses + in_the_way + if in_the_way > 0 || self.is_busy { thrown } else { 0 }
    }
}
