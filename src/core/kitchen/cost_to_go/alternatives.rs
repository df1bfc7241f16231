//! All moves that can free a hand or a place: the alternatives at a step where the cost-to-go planner deviates from its
//! greedy plan.

use super::moves::{ClearingMove, ClearingMoves};
use super::needs::RequiredFreePlaces;
use super::partial_plan::PressPlan;
use super::task::{DeliveryTask, STORAGE};

impl PressPlan<'_> {
    /// All moves that can free the hands and places that the work on a target dish needs.
    pub(super) fn moves(&self, wants: &RequiredFreePlaces) -> ClearingMoves {
        let mut moves = ClearingMoves::new();
        for agent in 0..2 {
            self.empty(wants, agent, &mut moves);
        }
        for from in self.ground.places().filter(|&place| self.blocks(wants, place)) {
            self.take_away(wants, from, &mut moves);
        }
        self.exchange(&mut moves);
        self.fetch(&mut moves);
        moves
    }

    /// Adds the moves that empty the hand of an agent.
    fn empty(&self, wants: &RequiredFreePlaces, agent: usize, moves: &mut ClearingMoves) {
        let hand = self.ground.hands[agent];
        let wanted = wants.hand(agent);
        let Some((task, of)) = self.task_at(hand) else {
            if wanted && self.state[hand] != 0 {
                moves.add(ClearingMove::Throw { hand });
            }
            return;
        };
        if let Some((detour, to)) = self.best_place(task, wants.needs, true)
            && (wanted || detour == 0)
        {
            moves.add(ClearingMove::Bring { task, to });
        }
        if of.bits.count_ones() == 1 && wanted {
            moves.add(ClearingMove::Discard { task });
        }
        if let Some(from) = self.blocked_by(task) {
            self.take_away(wants, from, moves);
        }
    }

    /// Adds the moves that empty a place of the kitchen.
    fn take_away(&self, wants: &RequiredFreePlaces, from: usize, moves: &mut ClearingMoves) {
        for hand in self.ground.hands.into_iter().filter(|&hand| self.state[hand] == 0) {
            let Some((task, _)) = self.task_at(from) else {
                moves.add(ClearingMove::PickUp { from, hand });
                continue;
            };
            moves.add(ClearingMove::Bring { task, to: hand });
            if let Some((_, to)) = self.best_place(task, wants.needs, true) {
                moves.add(ClearingMove::Bring { task, to });
            }
        }
    }

    /// Adds exchanges of items between two target dishes that need no additional presses.
    fn exchange(&self, moves: &mut ClearingMoves) {
        let movable = |task: &DeliveryTask| task.bits.count_ones() == 1 && task.at != STORAGE && !self.is_ready(task);
        let way = |task: &DeliveryTask, at: u8| self.goal.way(&self.state, task, at).0;
        for (one, a) in self.tasks().filter(|(_, task)| movable(task)) {
            for (other, b) in self.tasks().filter(|(_, task)| movable(task) && task.target > a.target) {
                let fit = self.goal.fits(&self.state, &a, b.at) && self.goal.fits(&self.state, &b, a.at);
                if fit && way(&a, b.at) + way(&b, a.at) <= way(&a, a.at) + way(&b, b.at) {
                    moves.add(ClearingMove::Exchange { tasks: [one, other] });
                }
            }
        }
    }

    /// Adds moves that take an item from a storage early and put it on a free place on its way to the board, so that
    /// the hand is free later.
    fn fetch(&self, moves: &mut ClearingMoves) {
        let (ground, goal) = (self.ground, self.goal);
        for (task, of) in self.tasks().filter(|(_, task)| task.at == STORAGE) {
            let target = usize::from(of.target);
            let fresh = u32::from(goal.fresh[target][of.bits.trailing_zeros() as usize].0);
            for (agent, hand) in ground.hands.into_iter().enumerate().filter(|(_, hand)| self.state[*hand] == 0) {
                let fits = |class: &u8| goal.fills[target][usize::from(*class)] == of.bits;
                for class in goal.takes[agent].iter().copied().filter(fits) {
                    let at = |location: usize| u32::from(goal.presses_from(of.target, location, class));
                    let is_free = |place: &usize| {
                        let is_place = !ground.is_hand(*place) && *place != ground.board;
                        is_place && self.state[*place] == 0 && ground.accepts(*place, goal.content[usize::from(class)])
                    };
                    for to in ground.places().filter(is_free) {
                        if at(hand) + 1 == fresh && at(to) + 2 == fresh {
                            moves.add(ClearingMove::Fetch { task, class, hand, to });
                        }
                    }
                }
            }
        }
    }
}
