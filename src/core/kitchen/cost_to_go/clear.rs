//! The greedy choice of a move that clears an obstacle: throw the obstacle away, pick it up, or put it aside.

use super::moves::ClearingMove;
use super::needs::RequiredFreePlaces;
use super::partial_plan::PressPlan;

impl PressPlan<'_> {
    /// Clears an obstacle to the work on a target dish by the move that is usually best (one or two presses); returns
    /// whether there is such a move.
    pub(super) fn clear(&mut self, wants: &RequiredFreePlaces) -> bool {
        let best = self
            .put_down(wants)
            .or_else(|| self.throw_away(wants))
            .or_else(|| self.empty_place(wants))
            .or_else(|| self.make_way(wants))
            .or_else(|| self.empty_hand(wants));
        if let Some(best) = best {
            self.make(best);
        }
        best.is_some()
    }

    /// Puts down the content of a hand that has to be free, at a place on the content's way to the board.
    fn put_down(&self, wants: &RequiredFreePlaces) -> Option<ClearingMove> {
        let wanted = (0..2).filter(|&agent| wants.hand(agent));
        wanted.into_iter().find_map(|agent| {
            let (task, _) = self.task_at(self.ground.hands[agent])?;
            match self.best_place(task, wants.needs, true)? {
                (0, to) => Some(ClearingMove::Bring { task, to }),
                _ => None,
            }
        })
    }

    /// Throws away a useless content of a hand that has to be free, or of one of two full hands.
    fn throw_away(&self, wants: &RequiredFreePlaces) -> Option<ClearingMove> {
        let hands = self.ground.hands;
        let useless = |agent: usize| self.state[hands[agent]] != 0 && self.task_at(hands[agent]).is_none();
        let needed = (0..2).find(|&agent| wants.needs & (1 << agent) != 0 && useless(agent));
        // A hand that is needed later is emptied first; the other hand may keep its content until the plan's end.
        let full = (0..2).filter(|&agent| wants.hands_full && useless(agent));
        let full = full.max_by_key(|&agent| (wants.later & (1 << agent) != 0, agent == 0));
        needed.or(full).map(|agent| ClearingMove::Throw { hand: hands[agent] })
    }

    /// Removes a content that blocks the parts of the target dish, if a hand is free.
    fn empty_place(&self, wants: &RequiredFreePlaces) -> Option<ClearingMove> {
        let ground = self.ground;
        let [human, robot] = ground.hands;
        let hand = match (self.state[human] == 0, self.state[robot] == 0) {
            (false, false) => return None,
            (true, false) => human,
            (false, true) => robot,
            (true, true) if wants.later & 1 == 0 => human,
            (true, true) => robot,
        };
        let blocking = ground.places().filter(|&location| self.blocks(wants, location));
        // Order of preference: contents that move on along their own way, useless contents, contents that have to be
        // put aside.
        let ranked = blocking.filter_map(|from| match self.task_at(from) {
            None => Some((1, ClearingMove::PickUp { from, hand })),
            Some((task, _)) => {
                let (detour, made) = self.put_aside(wants, task, hand)?;
                Some((2 * detour.min(1), made))
            }
        });
        ranked.min_by_key(|&(rank, _)| rank).map(|(_, made)| made)
    }

    /// Moves a part out of the way: along the part's own way, into a hand, or to another place; returns the additional
    /// presses and the move.
    fn put_aside(&self, wants: &RequiredFreePlaces, task: usize, hand: usize) -> Option<(u32, ClearingMove)> {
        let of = self.choice.tasks[task];
        let from = usize::from(of.at);
        // A part of the present target dish on the board that cannot stay there would otherwise come back at once.
        let returns =
            usize::from(of.target) == wants.target && from == self.ground.board && self.leads(task, from, hand);
        if returns {
            return Some((0, ClearingMove::Bring { task, to: hand }));
        }
        let spare_hand = wants.needs & self.ground.journeys.bit[hand] == 0;
        match self.best_place(task, wants.needs, false) {
            Some((detour, to)) if detour == 0 || !spare_hand => Some((detour, ClearingMove::Bring { task, to })),
            _ if spare_hand => Some((1, ClearingMove::Bring { task, to: hand })),
            _ => None,
        }
    }

    /// Removes a content from the place to which the item in a needed hand has to go.
    fn make_way(&self, wants: &RequiredFreePlaces) -> Option<ClearingMove> {
        let ground = self.ground;
        let needed = (0..2).filter(|&agent| !wants.hands_full && wants.needs & (1 << agent) != 0);
        needed.into_iter().find_map(|agent| {
            let (held, _) = self.task_at(ground.hands[agent])?;
            let other = ground.hands[1 - agent];
            let from = self.blocked_by(held)?;
            let Some((task, _)) = self.task_at(from) else { return Some(ClearingMove::PickUp { from, hand: other }) };
            let spare_hand = wants.needs & ground.journeys.bit[other] == 0;
            match self.best_place(task, wants.needs, true) {
                Some((0, to)) => Some(ClearingMove::Bring { task, to }),
                _ if spare_hand && self.leads(task, from, other) => Some(ClearingMove::Bring { task, to: other }),
                _ => None,
            }
        })
    }

    /// Puts down the content of a hand that has to be free, or throws the content away if there is no place for it.
    fn empty_hand(&self, wants: &RequiredFreePlaces) -> Option<ClearingMove> {
        let mut best: Option<(u32, ClearingMove)> = None;
        let mut consider = |rest: u32, made: ClearingMove| {
            if best.is_none_or(|(least, _)| rest < least) {
                best = Some((rest, made));
            }
        };
        for agent in (0..2).filter(|&agent| wants.hand(agent)) {
            let Some((task, of)) = self.task_at(self.ground.hands[agent]) else { continue };
            if let Some((detour, to)) = self.best_place(task, wants.needs, true) {
                consider(detour, ClearingMove::Bring { task, to });
            }
            if of.bits.count_ones() == 1 {
                let (fresh, _) = self.goal.fresh[usize::from(of.target)][of.bits.trailing_zeros() as usize];
                // Throwing the item away costs one press, plus the presses of a fresh item.
                consider((u32::from(fresh) + 1).saturating_sub(self.least(&of)), ClearingMove::Discard { task });
            }
        }
        best.map(|(_, best)| best)
    }
}
