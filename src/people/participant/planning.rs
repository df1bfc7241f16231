//! Backward chaining of a simulated participant: from the goal of an order, over the preconditions of the kitchen's
//! rules, to a press that is possible now.
//!
//! A dish is served from the plate, stacked on the board from parts, and parts are made of ingredients at stations. An
//! unmet precondition of a press becomes the next goal: an occupied place is cleared, the content of a full hand is put
//! down. The participant waits for what only the robot can do, and for what the robot holds. A press that undoes
//! something for the sake of another is a detour.

use tomcom_core::kitchen::{Agent, ButtonAction, ButtonId, ContentId, LocationId, LocationKind, State};

use super::decision::Habits;
use super::goals::{GoalContext, Goals, MissingPart, OrderGoal, PartSource};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProposedPress {
    pub button: ButtonId,
    /// Whether the press is a detour, which only makes room, at the cost of another press later.
    pub(crate) is_detour: bool,
}

/// Backward chaining from the participant's goals in one believed state.
pub struct BackwardChaining<'a> {
    prospect: &'a GoalContext<'a>,
    state: State,
    goals: Goals,
    hand: LocationId,
    held: ContentId,
}

impl<'a> BackwardChaining<'a> {
    pub fn new(prospect: &'a GoalContext<'a>, state: State, in_progress: LocationId) -> BackwardChaining<'a> {
        let hand = prospect.kitchen.hands[Agent::Human.index()];
        let goals = Goals::in_state(prospect, state, in_progress);
        BackwardChaining { prospect, state, goals, hand, held: state.content(hand) }
    }

    /// The presses that advance the participant's goals, the preferred press first: for the order in progress by the
    /// participant's habit, then for other orders.
    pub fn proposals(&self, habits: &Habits) -> Vec<ProposedPress> {
        let mut proposals: Vec<ProposedPress> = Vec::with_capacity(8);
        let mut propose = |press: Option<ProposedPress>| {
            if let Some(press) = press.filter(|press| proposals.iter().all(|other| other.button != press.button)) {
                proposals.push(press);
            }
        };
        for goal in &self.goals.orders {
            if let Some(at) = goal.finished {
                propose(self.serve(goal, at));
                continue;
            }
            let mut needs: Vec<&MissingPart> = goal.needs.iter().collect();
            let is_held = |need: &MissingPart| need.source.is_some_and(|source| source.at == self.hand);
            needs.sort_by_key(|need| (!is_held(need), habits.rank(self.prospect.knowledge.ingredient(need.part))));
            needs.into_iter().for_each(|need| propose(self.advance(goal, need, habits)));
        }
        let is_litter = !self.held.is_empty() && !self.goals.uses(self.hand) && !self.goals.orders.is_empty();
        propose(is_litter.then(|| self.free_hand()).flatten());
        proposals
    }

    /// The next press that brings a finished dish (stack) to its order.
    fn serve(&self, goal: &OrderGoal, at: LocationId) -> Option<ProposedPress> {
        let plate = self.prospect.kitchen.plate;
        match self.prospect.kitchen.location(at).kind {
            _ if at == plate => self.forward(ButtonAction::Serve(goal.order)),
            LocationKind::Hand(Agent::Human) if self.is_free(plate, goal.stack) => self.press_at(plate),
            LocationKind::Hand(Agent::Human) => self.clear(plate),
            LocationKind::Hand(Agent::Robot) if self.state.content(plate).is_empty() => None,
            LocationKind::Hand(Agent::Robot) => self.make_way(plate),
            _ if !self.held.is_empty() => self.free_hand(),
            _ if self.state.content(plate).is_empty() => self.press_at(at),
            _ => self.clear(plate),
        }
    }

    /// The next press towards a missing part of a dish.
    fn advance(&self, goal: &OrderGoal, need: &MissingPart, habits: &Habits) -> Option<ProposedPress> {
        let kitchen = self.prospect.kitchen;
        let Some(source) = need.source else { return self.fetch(goal, need.part, habits) };
        let making = self.prospect.knowledge.next_making(source.content, need.part);
        let station = making.map_or(Some(kitchen.board), |making| making.place);
        if source.at == kitchen.hands[Agent::Robot.index()] {
            return station
                .filter(|&station| !self.takes(station, source.content, goal))
                .and_then(|one| self.make_way(one));
        }
        if let Some(making) = making
            && station.unwrap_or(self.hand) == source.at
        {
            let process = self.forward(ButtonAction::Process(making.process));
            return process.or_else(|| if source.at == self.hand { self.park() } else { None });
        }
        match station {
            Some(station) if source.at != self.hand && self.held.is_empty() => {
                if self.is_ready(station, source.content, goal) {
                    self.press_at(source.at)
                } else {
                    self.clear(station)
                }
            }
            None if source.at != self.hand && self.held.is_empty() => self.press_at(source.at),
            _ if source.at != self.hand => self.free_hand(),
            Some(station) if self.takes(station, source.content, goal) => self.press_at(station),
            Some(station) => self.clear(station),
            None => None,
        }
    }

    /// Takes the ingredient of a part from a storage; by habit the participant may take the ingredient of the last
    /// dish's part instead.
    fn fetch(&self, goal: &OrderGoal, part: ContentId, habits: &Habits) -> Option<ProposedPress> {
        let knowledge = self.prospect.knowledge;
        let meant = habits.part_instead(self.prospect.kitchen, goal.stack, part);
        let take = |part: ContentId| self.forward(ButtonAction::Take(knowledge.ingredient(part)));
        let take = meant.and_then(take).or_else(|| take(part))?;
        if !self.held.is_empty() {
            return self.free_hand();
        }
        let ingredient = knowledge.ingredient(part);
        let making = knowledge.next_making(ingredient, part);
        let station = making.map_or(Some(self.prospect.kitchen.board), |making| making.place);
        match station.filter(|&station| !self.is_ready(station, ingredient, goal)) {
            Some(blocked) => self.clear(blocked),
            None => Some(take),
        }
    }

    /// Clears a place that the robot needs to put down what its hand holds.
    fn make_way(&self, place: LocationId) -> Option<ProposedPress> {
        self.clear(place).map(|press| ProposedPress { is_detour: press.is_detour || !self.held.is_empty(), ..press })
    }

    /// Clears an occupied place: its content is processed or taken away, for which the hand has to be empty. The
    /// beginning of another dish stays on the board.
    fn clear(&self, place: LocationId) -> Option<ProposedPress> {
        let knowledge = self.prospect.knowledge;
        if place == self.prospect.kitchen.board && self.goals.orders.iter().any(|goal| goal.has_base) {
            return if self.held.is_empty() { None } else { self.free_hand() };
        }
        let needs = self.goals.orders.iter().flat_map(|goal| &goal.needs);
        let lying =
            needs.filter_map(|need| need.source.filter(|source| source.at == place).map(|one| (one, need.part)));
        for (source, part) in lying {
            if let Some(making) = knowledge.next_making(source.content, part)
                && making.place == Some(place)
                && let Some(process) = self.forward(ButtonAction::Process(making.process))
            {
                return Some(process);
            }
        }
        if !self.held.is_empty() {
            return self.free_hand();
        }
        Some(ProposedPress { is_detour: self.goals.uses(place), ..self.press_at(place)? })
    }

    /// Empties the hand: where the held content helps an order, else at a parking place; what no order needs is thrown
    /// away.
    fn free_hand(&self) -> Option<ProposedPress> {
        let knowledge = self.prospect.knowledge;
        if !self.goals.uses(self.hand) {
            return self.forward(ButtonAction::Trash).or_else(|| self.park());
        }
        for goal in &self.goals.orders {
            if goal.finished == Some(self.hand) && self.is_free(self.prospect.kitchen.plate, self.held) {
                return self.press_at(self.prospect.kitchen.plate);
            }
            let Some(need) = goal.needs.iter().find(|need| need.source.is_some_and(|one| one.at == self.hand)) else {
                continue;
            };
            match knowledge.next_making(self.held, need.part) {
                Some(making) if making.place.is_none() => {
                    return self.forward(ButtonAction::Process(making.process)).or_else(|| self.park());
                }
                making => {
                    let station = making.and_then(|making| making.place).unwrap_or(self.prospect.kitchen.board);
                    if self.takes(station, self.held, goal) {
                        return self.press_at(station);
                    }
                }
            }
        }
        self.park()
    }

    /// Puts the held content down where it is least in the way; if no place is free, it is thrown away.
    fn park(&self) -> Option<ProposedPress> {
        let knowledge = self.prospect.knowledge;
        let places = self.prospect.kitchen.location_ids();
        let free = places.filter(|&place| self.press_at(place).is_some() && self.is_free(place, self.held));
        // Board and plate are the last choice for parking, since every dish needs them.
        let kitchen = self.prospect.kitchen;
        let price = |place: &LocationId| {
            (u8::from(knowledge.is_station(*place)), u8::from(*place == kitchen.board || *place == kitchen.plate))
        };
        let best = free.filter(|&place| !self.is_next(place)).min_by_key(price).and_then(|place| self.press_at(place));
        let press = best.or_else(|| self.forward(ButtonAction::Trash))?;
        Some(ProposedPress { is_detour: true, ..press })
    }

    /// Whether some part that is available needs this place next.
    fn is_next(&self, place: LocationId) -> bool {
        let needs = self.goals.orders.iter().flat_map(|goal| &goal.needs);
        let sources = needs.filter_map(|need| need.source.map(|source| (source, need.part)));
        let station = |(source, part): (PartSource, ContentId)| {
            let making = self.prospect.knowledge.next_making(source.content, part);
            making.map_or(Some(self.prospect.kitchen.board), |making| making.place)
        };
        sources.filter(|(source, _)| source.at != self.hand).any(|one| station(one) == Some(place))
    }

    /// Whether a station will accept a part, as far as the participant checks before taking the part into the hand.
    fn is_ready(&self, station: LocationId, item: ContentId, goal: &OrderGoal) -> bool {
        self.prospect.skips_check || self.takes(station, item, goal)
    }

    fn takes(&self, station: LocationId, item: ContentId, goal: &OrderGoal) -> bool {
        let there = self.state.content(station);
        match there.is_empty() {
            true => self.prospect.kitchen.accepts(station, item),
            false => {
                let is_base = station == self.prospect.kitchen.board && goal.has_base;
                is_base && self.prospect.kitchen.stacked(there, item).is_some()
            }
        }
    }

    fn is_free(&self, place: LocationId, item: ContentId) -> bool {
        self.state.content(place).is_empty() && self.prospect.kitchen.accepts(place, item)
    }

    fn press_at(&self, place: LocationId) -> Option<ProposedPress> {
        self.forward(ButtonAction::Use(place))
    }

    /// The press of the human's button with this action, which is no detour.
    fn forward(&self, action: ButtonAction) -> Option<ProposedPress> {
        let button = self.prospect.knowledge.button(action)?;
        Some(ProposedPress { button, is_detour: false })
    }
}
