//! Hands and places that the work on a target dish requires, the obstacles to that work, and places for putting
//! obstacles aside.

use super::journeys::FreeMask;
use super::partial_plan::PressPlan;

/// Hands and places that the work on a target dish requires.
#[derive(Clone, Copy, Debug)]
pub struct RequiredFreePlaces {
    /// The index of the target dish.
    pub target: usize,
    /// Whether parts of the target dish still have to be brought to the board.
    pub assembling: bool,
    /// Mask of free hands and places that the parts of the dish require.
    pub needs: FreeMask,
    /// Mask of free hands and places that all remaining tasks require.
    pub later: FreeMask,
    /// Whether both agents' hands hold something.
    pub hands_full: bool,
}

impl RequiredFreePlaces {
    /// Whether the hand of this agent should be empty for the work on the target dish.
    pub fn hand(&self, agent: usize) -> bool {
        self.hands_full || self.needs & (1 << agent) != 0
    }
}

impl PressPlan<'_> {
    /// The present requirements of the work on a target dish: hands, places, and whether parts are missing.
    pub(super) fn wants(&self, target: usize) -> RequiredFreePlaces {
        let of_target = || self.tasks().filter(move |(_, task)| usize::from(task.target) == target);
        let complete = self.goal.complete[target];
        let assembling = of_target().any(|(_, task)| task.bits != complete && !self.is_ready(&task));
        let needs = of_target().filter(|(_, task)| !self.is_ready(task));
        let needs = needs.fold(0, |needs, (_, task)| needs | self.needs(&task));
        let later = self.tasks().fold(needs, |needs, (_, task)| needs | self.needs(&task));
        let hands_full = self.ground.hands.iter().all(|&hand| self.state[hand] != 0);
        RequiredFreePlaces { target, assembling, needs, later, hands_full }
    }

    /// Whether the content of a location blocks the parts of the target dish.
    pub(super) fn blocks(&self, wants: &RequiredFreePlaces, location: usize) -> bool {
        let ground = self.ground;
        match location {
            _ if self.state[location] == 0 => false,
            _ if location == ground.board => wants.assembling && !self.board_is_open(wants.target),
            _ if location == ground.plate => !wants.assembling,
            _ => !ground.is_hand(location) && wants.needs & ground.journeys.bit[location] != 0,
        }
    }

    /// The place where a part can be put down with the fewest additional presses: (additional presses, place).
    pub(super) fn best_place(&self, index: usize, needs: FreeMask, through: bool) -> Option<(u32, usize)> {
        let ground = self.ground;
        let task = self.choice.tasks[index];
        let from = usize::from(task.at);
        let class = self.state[from];
        let accepts = |place: usize| ground.accepts(place, self.goal.content[usize::from(class)]);
        let mut best: Option<(u32, u32, usize)> = None;
        for place in ground.places() {
            let taken = self.state[place] != 0 || ground.is_hand(place) || place == ground.board || !accepts(place);
            if taken {
                continue;
            }
            let in_use = needs & ground.journeys.bit[place] != 0;
            let detour = match task.bits.count_ones() {
                1 => {
                    let at = |location: usize| u32::from(self.goal.presses_from(task.target, location, class));
                    let moved = if ground.is_hand(from) { 1 } else { 2 };
                    (at(place) + moved).saturating_sub(at(from))
                }
                _ => 2,
            };
            if in_use && !(through && detour == 0) {
                continue;
            }
            let rank = u32::from(place == ground.plate) + 2 * u32::from(in_use);
            if best.is_none_or(|(least, least_rank, _)| (detour, rank) < (least, least_rank)) {
                best = Some((detour, rank, place));
            }
        }
        best.map(|(detour, _, place)| (detour, place))
    }

    /// The occupied place to which the single item of a task has to go next; `None` if its way is free.
    pub(super) fn blocked_by(&self, task: usize) -> Option<usize> {
        let ground = self.ground;
        let from = usize::from(self.choice.tasks[task].at);
        let content = self.goal.content[usize::from(self.state[from])];
        let places = ground.places().filter(|&place| !ground.is_hand(place) && place != ground.board);
        let mut blocked = places.filter(|&place| self.state[place] != 0 && ground.accepts(place, content));
        blocked.find(|&place| self.leads(task, from, place))
    }

    /// Whether moving the single item of a task from one location to another shortens the item's journey.
    pub(super) fn leads(&self, task: usize, from: usize, to: usize) -> bool {
        let of = self.choice.tasks[task];
        let class = self.state[usize::from(of.at)];
        let at = |location: usize| self.goal.presses_from(of.target, location, class);
        of.bits.count_ones() == 1 && at(to) + 1 == at(from)
    }
}
