//! Gaze control of the simulated participant: fixation targets, reading of locations, attention capture by changes.

use rand::RngExt;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{
    Agent, AspectId, ContentId, DishId, Kitchen, LocationId, LocationKind, OrderContent, State, World,
};

use super::beliefs::wanted_dish;
use super::eyes::FixationProgress;
use super::simulated::SimulatedParticipant;
use super::{chance, drawn_by_weight};

/// Probability that the participant gives to the content that was just read at a location.
const READ_CERTAINTY: f64 = 0.97;
/// Factor on the probability of a misreading if the look-alike is expected; divisor if the true content is expected.
const EXPECTATION_FACTOR: f64 = 4.0;
/// Distance from the fixation point at which a change captures attention half as often, in metres on the display.
const CAPTURE_REACH_M: f64 = 0.6;
/// Number of independent chances to capture attention that a change at a location of the next presses has.
const WATCHED_ATTEMPTS: i32 = 3;
/// Number of planned presses at whose locations the participant looks.
const LOOKS_AHEAD: usize = 2;
/// Time constant with which a location becomes more likely as a fixation target after its last reading, in seconds.
const STALE_S: f64 = 6.0;
/// Share of the belief in a recipe that remains when the robot's behaviour contradicts the recipe.
const HINT_TRUST: f64 = 0.2;

impl SimulatedParticipant {
    /// Moves the eyes: changes capture attention, the location of a completed fixation is read, then a target is
    /// chosen.
    pub(super) fn look(&mut self, now: SessionTime, state: State) {
        self.notice_changes(now, state);
        match self.eyes.advance(now) {
            FixationProgress::Nothing => {}
            FixationProgress::Read => {
                if let Some(location) = self.attention.looking_at {
                    self.read(now, location, state);
                }
            }
            FixationProgress::Done => {
                let target = self.choose_target(now);
                self.attention.looking_at = target;
                let point = match target {
                    Some(location) => self.kitchen.location(location).display.centre(),
                    None => self.elsewhere(),
                };
                self.eyes.look_at(now, point);
            }
        }
    }

    /// Lets changes on the display capture attention; a change at the fixated location is read again.
    pub(super) fn notice_changes(&mut self, now: SessionTime, state: State) {
        if state == self.display {
            return;
        }
        if self.is_reading_signal(now) {
            self.display = state;
            return;
        }
        let kitchen = self.kitchen.clone();
        let eye = self.eyes.position(now);
        let needed = self.needed();
        for id in kitchen.changed(self.display, state) {
            let location = kitchen.location(id);
            if self.attention.looking_at == Some(id) && self.eyes.has_landed(now) {
                self.eyes.look_again(now);
                continue;
            }
            let strength = match location.kind {
                LocationKind::Order => self.person.order_capture,
                _ => self.person.capture,
            };
            let distance_m = location.display.distance_m(eye, kitchen.display_m);
            let seen = strength * 0.5_f64.powf(distance_m / CAPTURE_REACH_M);
            // Locations that the next presses use are watched in peripheral vision, so changes there are noticed more
            // often.
            let seen = if needed.contains(&id) { 1.0 - (1.0 - seen).powi(WATCHED_ATTEMPTS) } else { seen };
            if chance(&mut self.mind, seen) {
                self.attention.first(id);
            }
        }
        self.display = state;
    }

    /// The next location to look at; `None` for a point outside of the task's locations.
    fn choose_target(&mut self, now: SessionTime) -> Option<LocationId> {
        if let Some(location) = self.attention.glances.pop_front() {
            return Some(location);
        }
        if chance(&mut self.mind, self.person.wanders) {
            return None;
        }
        let weights = self.target_weights(now);
        drawn_by_weight(&mut self.mind, &weights).map(|index| LocationId(index as u8))
    }

    /// Weight of each location in the choice of the next fixation target: more for locations that the next presses
    /// need, that were not read for long, or of whose content the participant is unsure.
    fn target_weights(&self, now: SessionTime) -> Vec<f64> {
        let kitchen = &self.kitchen;
        let needed = self.needed();
        let weight = |index: usize| {
            let id = LocationId(index as u8);
            let worth = match kitchen.locations[index].kind {
                _ if needed.contains(&id) => 1.0,
                LocationKind::Hand(Agent::Robot) => self.person.watches_robot,
                LocationKind::Hand(Agent::Human) => 0.15,
                LocationKind::Order if wanted_dish(kitchen, &self.beliefs, id).is_none() => 0.8,
                LocationKind::Order => 0.2,
                LocationKind::Place if id == kitchen.board => 0.5,
                LocationKind::Place => 0.25,
            };
            let stale = 1.0 - (-now.secs_since(self.attention.read_at[index]) / STALE_S).exp();
            let open = 1.0 - self.beliefs.certainty(AspectId::of_location(id));
            worth * (stale + open)
        };
        (0..kitchen.locations.len()).map(weight).collect()
    }

    /// Locations of the next two planned presses, except the own hand, whose content the participant feels.
    pub(super) fn needed(&self) -> Vec<LocationId> {
        let next = self.intent.plan.iter().take(LOOKS_AHEAD);
        let mut places: Vec<LocationId> =
            next.flat_map(|&button| self.kitchen.involved(Agent::Human, button)).collect();
        places.retain(|&place| place != self.kitchen.hands[Agent::Human.index()]);
        places
    }

    /// A point outside of the task's locations to look at: a storage, or a random point of the display.
    fn elsewhere(&mut self) -> [f64; 2] {
        let storages: Vec<[f64; 2]> = self.kitchen.storages.iter().map(|storage| storage.display.centre()).collect();
        match storages.is_empty() || chance(&mut self.mind, 0.4) {
            true => [self.mind.random::<f64>(), self.mind.random::<f64>()],
            false => storages[self.mind.random_range(0..storages.len())],
        }
    }

    /// Reads the content of a location, which is occasionally mistaken for a look-alike.
    pub(super) fn read(&mut self, now: SessionTime, location: LocationId, state: State) {
        let kitchen = self.kitchen.clone();
        let aspect = AspectId::of_location(location);
        let believed = self.beliefs.most_likely(aspect);
        let values = &kitchen.aspects[aspect.index()];
        let Some(shown) = values.index_of(state.code(location)) else { return };
        let alike = kitchen.look_alike_codes(location, state.code(location));
        let alike: Vec<usize> = alike.into_iter().filter_map(|code| values.index_of(code)).collect();
        let mut seen = shown;
        for other in alike {
            let bias = match believed {
                expected if expected == other => EXPECTATION_FACTOR,
                expected if expected == shown => 1.0 / EXPECTATION_FACTOR,
                _ => 1.0,
            };
            if chance(&mut self.mind, (self.person.misreads * bias).min(0.5)) {
                seen = other;
            }
        }
        self.attention.read_at[location.index()] = now;
        self.beliefs.settle(aspect, seen, READ_CERTAINTY);
        if seen != believed {
            self.rethink = true;
            self.on_news(location, values.values[believed], values.values[seen]);
        }
    }

    /// Reacts to reading a content that differs from the believed content.
    fn on_news(&mut self, location: LocationId, believed: u8, code: u8) {
        let kitchen = self.kitchen.clone();
        let wanted: Vec<_> = kitchen
            .orders
            .iter()
            .filter(|&&order| order != location)
            .filter_map(|&order| wanted_dish(&kitchen, &self.beliefs, order))
            .collect();
        if kitchen.location(location).kind == LocationKind::Order {
            if let OrderContent::Dish(dish) = OrderContent::from_code(code)
                && !wanted.contains(&dish)
            {
                self.memory.recall(&kitchen, &mut self.beliefs, dish);
            }
            return;
        }
        // The robot knows the true recipes, so what it carries, stacks or discards reveals something about the recipes.
        let World { recipes, .. } = self.beliefs.point(&kitchen);
        let (before, now) = (ContentId(believed), ContentId(code));
        let has_place =
            |content: ContentId| wanted.iter().any(|&dish| could_become(&kitchen, content, recipes.get(dish)));
        let is_robots_hand = location == kitchen.hands[Agent::Robot.index()];
        let is_strange = (is_robots_hand || location == kitchen.board) && !now.is_empty() && !has_place(now);
        let is_lost =
            is_robots_hand && now.is_empty() && !before.is_empty() && has_place(before) && !self.is_about(before);
        if is_strange {
            self.take_hint(&wanted, |variant| could_become(&kitchen, now, variant));
        } else if is_lost {
            self.take_hint(&wanted, |variant| !could_become(&kitchen, before, variant));
        }
    }

    /// Whether the participant believes that all items of `content` are in the kitchen.
    fn is_about(&self, content: ContentId) -> bool {
        let kitchen = &self.kitchen;
        let World { state, .. } = self.beliefs.point(kitchen);
        let places = kitchen.location_ids();
        let places = places.filter(|&place| kitchen.location(place).kind != LocationKind::Order);
        let lying: Vec<ContentId> =
            places.flat_map(|place| kitchen.content(state.content(place)).items.clone()).collect();
        kitchen.content(content).items.iter().all(|item| lying.contains(item))
    }

    /// Reacts to a hint: no believed recipe explains the robot's press, so the participant may recall another version
    /// of a recipe, one that `fits` the press.
    fn take_hint(&mut self, wanted: &[DishId], fits: impl Fn(ContentId) -> bool) {
        if !chance(&mut self.mind, self.person.takes_hints) {
            return;
        }
        let kitchen = self.kitchen.clone();
        let candidates = wanted.iter().filter(|&&dish| kitchen.dish(dish).variants.iter().any(|&v| fits(v)));
        if let Some(dish) = self.least_sure(candidates.copied()) {
            self.memory.doubt(&kitchen, &mut self.beliefs, dish, HINT_TRUST, fits);
        }
    }

    pub(super) fn least_sure(&self, dishes: impl Iterator<Item = DishId>) -> Option<DishId> {
        let sure = |dish| self.beliefs.certainty(self.kitchen.aspect_of_dish(dish));
        dishes.min_by(|&a, &b| sure(a).total_cmp(&sure(b)))
    }
}

/// Whether `content` can become part of the dish `stack`: of a stacked content all items must occur in the dish, of a
/// single item only its ingredient.
fn could_become(kitchen: &Kitchen, content: ContentId, stack: ContentId) -> bool {
    let (content, stack) = (kitchen.content(content), kitchen.content(stack));
    match content.is_stack() {
        true => content.items.iter().all(|item| stack.items.contains(item)),
        false => stack.items.iter().any(|&item| kitchen.content(item).ingredient == content.ingredient),
    }
}
