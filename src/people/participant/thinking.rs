//! Interpretation of events by the simulated participant (own presses, robot presses, passing time), and its decisions
//! on next presses.

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{
    Agent, AspectId, ButtonAction, ButtonId, ContentId, DishId, Kitchen, LocationId, LocationKind, OrderContent, State,
    World,
};

use super::beliefs::{ParticipantBeliefs, wanted_dish};
use super::decision::{DecisionContext, Impatience, Lapses};
use super::simulated::SimulatedParticipant;
use super::{chance, rare_chance};

/// Probability that the participant looks at the location that the participant's last press changed.
const LOOKS_AT_RESULT: f64 = 0.5;
/// Time after reading a location during which the participant relies on the content that was read, in seconds.
const SEEN_JUST_NOW_S: f64 = 5.0;
/// Probability that the participant gives to a right guess about what the robot's press did.
const GUESSED_CERTAINTY: f64 = 0.85;
/// Probability with which the participant expects a served order to have disappeared after the usual time.
const EXPECTED: f64 = 0.8;

impl SimulatedParticipant {
    /// Reacts to a robot press: beliefs about unseen locations become uncertain.
    pub(super) fn wonder(&mut self) {
        let kitchen = self.kitchen.clone();
        let hand = kitchen.hands[Agent::Robot.index()];
        let own = kitchen.hands[Agent::Human.index()];
        let World { state, .. } = self.beliefs.point(&kitchen);
        let held = state.content(hand);
        for (index, location) in kitchen.locations.iter().enumerate() {
            let id = LocationId(index as u8);
            if location.kind == LocationKind::Order || id == own || self.attention.looking_at == Some(id) {
                continue;
            }
            let aspect = AspectId::of_location(id);
            let values = &kitchen.aspects[aspect.index()].values;
            let mut towards = vec![0.0; values.len()];
            let mut think_of = |content: ContentId, weight: f64| {
                if let Some(value) = values.iter().position(|&code| code == content.0) {
                    towards[value] += weight;
                }
            };
            think_of(ContentId::EMPTY, 1.0);
            if id == hand {
                for storage in kitchen.storages.iter().filter(|storage| storage.agent == Agent::Robot) {
                    think_of(storage.item, 0.5);
                }
            } else if !held.is_empty() {
                think_of(held, 1.0);
            }
            let weight = if id == hand { self.person.doubts_robot_hand } else { self.person.doubts_places };
            self.beliefs.mix(aspect, &towards, weight);
        }
    }

    /// Reacts to a robot press whose effect the participant guesses rightly: the participant believes the present
    /// content of the places that the press changed.
    pub(super) fn guess(&mut self, before: State, after: State) {
        let kitchen = self.kitchen.clone();
        for place in kitchen.changed(before, after) {
            settle(&kitchen, &mut self.beliefs, place, after, GUESSED_CERTAINTY);
        }
        self.rethink = true;
    }

    /// Reacts to the participant's own press, effective or not.
    pub(super) fn take_in(&mut self, now: SessionTime, button: ButtonId, effective: bool) {
        let kitchen = self.kitchen.clone();
        let action = kitchen.button(Agent::Human, button).action;
        let World { state, recipes } = self.beliefs.point(&kitchen);
        self.intent.lapses = Lapses::draw(&self.person, &mut self.mind);
        let has_failed = !effective && kitchen.press(state, &recipes, Agent::Human, button).is_some();
        if has_failed && self.population.insists > 0.0 && chance(&mut self.mind, self.population.insists) {
            self.intent.lapses.insists_on = Some(button);
            self.rethink = true;
            return;
        }
        let is_surprised = learn(&kitchen, &mut self.beliefs, button, effective);
        for place in kitchen.involved(Agent::Human, button) {
            if is_surprised {
                self.attention.first(place);
            } else if chance(&mut self.mind, LOOKS_AT_RESULT) {
                self.attention.later(place);
            }
        }
        if let (ButtonAction::Serve(order), OrderContent::Dish(dish)) = (action, serve_of(action, state)) {
            match effective {
                true => {
                    let variant = kitchen.dish(dish).variants.iter().position(|&v| v == recipes.get(dish));
                    self.memory.confirm(&kitchen, &mut self.beliefs, dish, variant.unwrap_or(0));
                    self.intent.last_dish = Some(recipes.get(dish));
                    let gone = now + SessionTime::from_secs_f64(kitchen.served_shown_s);
                    self.clearing.push((gone, order));
                }
                // The participant first doubts the belief about the plate's content; the recipe is doubted only if the
                // plate was just seen.
                false if now.secs_since(self.attention.read_at[kitchen.plate.index()]) < SEEN_JUST_NOW_S => {
                    self.memory.fail(&kitchen, &mut self.beliefs, dish);
                }
                false => {}
            }
        }
        let is_stuck = rare_chance(&mut self.mind, self.person.gets_stuck);
        self.stuck_in = is_stuck.then(|| self.beliefs.point(&kitchen));
        self.rethink = true;
    }

    /// Decides on the participant's next presses and queues looks at their locations. A proposal that the participant
    /// follows replaces the decision. A participant who does not know how to go on decides on nothing.
    pub(super) fn think(&mut self, now: SessionTime) {
        self.rethink = false;
        if !self.population.all_knowing {
            self.pass_time(now);
        }
        let world = self.beliefs.point(&self.kitchen);
        self.stuck_in = self.stuck_in.filter(|stuck| *stuck == world);
        if self.stuck_in.is_some() {
            return self.intent.plan.clear();
        }
        self.intent.order = self.intent.order.filter(|&(_, until)| now < until);
        let before = self.intent.plan.front().copied();
        let resolution = self.decision(Impatience::Calm).resolve(&world);
        let commitment = SessionTime::from_secs_f64(self.person.commitment_s);
        let kept = self.intent.order.filter(|&(order, _)| Some(order) == resolution.order);
        self.intent.order = kept.or(resolution.order.map(|order| (order, now + commitment)));
        let follows = &self.signals.follows;
        self.intent.plan = if follows.is_empty() { resolution.plan } else { follows.clone() };
        let next = self.intent.plan.front().copied();
        if next != before {
            for place in self.needed() {
                if chance(&mut self.mind, self.person.checks) {
                    self.attention.later(place);
                }
            }
        }
    }

    /// The data of the participant's decision that is due, without the world that the participant believes.
    pub(super) fn decision(&self, urgency: Impatience) -> DecisionContext<'_> {
        DecisionContext {
            kitchen: &self.kitchen,
            knowledge: &self.knowledge,
            habits: &self.habits,
            depth: self.person.depth as usize,
            in_progress: self.intent.order.map(|(order, _)| order),
            last_dish: self.intent.last_dish,
            lapses: self.intent.lapses,
            urgency,
        }
    }

    /// Accounts for passing time: memories fade, recipes in use are forgotten, served orders are expected to disappear.
    fn pass_time(&mut self, now: SessionTime) {
        let kitchen = self.kitchen.clone();
        let orders = kitchen.orders.iter();
        let in_use: Vec<DishId> = orders.filter_map(|&order| wanted_dish(&kitchen, &self.beliefs, order)).collect();
        let passed_s = self.memory.since_s(now);
        self.memory.fade(&kitchen, &mut self.beliefs, now, &in_use);
        for &dish in &in_use {
            if chance(&mut self.mind, 1.0 - (-self.person.loses_thread_per_min / 60.0 * passed_s).exp()) {
                self.memory.lose_thread(&kitchen, &mut self.beliefs, dish);
            }
        }
        let (beliefs, served) = (&mut self.beliefs, OrderContent::Served.code());
        self.clearing.retain(|&(gone, order)| {
            let aspect = AspectId::of_location(order);
            let values = &kitchen.aspects[aspect.index()];
            let is_due = now >= gone;
            if is_due
                && values.values[beliefs.most_likely(aspect)] == served
                && let Some(none) = values.index_of(OrderContent::None.code())
            {
                beliefs.settle(aspect, none, EXPECTED);
            }
            !is_due
        });
    }
}

/// What the order shows that a serve button serves; `OrderContent::None` for other buttons.
fn serve_of(action: ButtonAction, state: State) -> OrderContent {
    match action {
        ButtonAction::Serve(order) => state.order(order),
        _ => OrderContent::None,
    }
}

/// Probability that the simulated participant gives to the expected result of an own effective press.
const ACTED_CERTAINTY: f64 = 0.97;
/// Certainty that the participant gains about the own hand's content when explaining an ineffective press, because
/// people feel what they hold.
const FELT_CERTAINTY: f64 = 0.3;
/// Factor on the probability of values with which the ineffective press would have had an effect.
const CONTRADICTED_FACTOR: f64 = 0.04;

/// Updates the participant's beliefs after an own press, effective or not. Returns true if the press's effect
/// contradicted the beliefs.
pub fn learn(kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, button: ButtonId, effective: bool) -> bool {
    let World { state, recipes } = beliefs.point(kitchen);
    let expected = kitchen.press(state, &recipes, Agent::Human, button);
    match (expected, effective) {
        (Some(next), true) => carry_out(kitchen, beliefs, button, next),
        (None, true) => make_sense(kitchen, beliefs, button),
        (Some(_), false) => blame(kitchen, beliefs, state, button),
        (None, false) => {}
    }
    expected.is_some() != effective
}

/// Adopts an expected effect of a press: the locations involved take the values that the rules predict, with the
/// certainty before the press.
fn carry_out(kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, button: ButtonId, next: State) {
    let places = kitchen.involved(Agent::Human, button);
    let sure =
        places.iter().map(|&place| beliefs.certainty(AspectId::of_location(place))).fold(ACTED_CERTAINTY, f64::min);
    for place in places {
        settle(kitchen, beliefs, place, next, sure);
    }
}

fn settle(kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, place: LocationId, state: State, sure: f64) {
    let aspect = AspectId::of_location(place);
    if let Some(value) = kitchen.aspects[aspect.index()].index_of(state.code(place)) {
        beliefs.settle(aspect, value, sure);
    }
}

/// Explains an unexpected effect of a press: values that the effect implies are adopted, other values at the locations
/// involved become uncertain.
fn make_sense(kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, button: ButtonId) {
    let hand = kitchen.hands[Agent::Human.index()];
    let World { mut state, .. } = beliefs.point(kitchen);
    match kitchen.button(Agent::Human, button).action {
        ButtonAction::Take(item) => {
            state.set_content(hand, item);
            settle(kitchen, beliefs, hand, state, ACTED_CERTAINTY);
        }
        ButtonAction::Trash => {
            state.set_content(hand, ContentId::EMPTY);
            settle(kitchen, beliefs, hand, state, ACTED_CERTAINTY);
        }
        ButtonAction::Serve(order) => {
            state.set_content(kitchen.plate, ContentId::EMPTY);
            state.set_order(order, OrderContent::Served);
            settle(kitchen, beliefs, kitchen.plate, state, ACTED_CERTAINTY);
            settle(kitchen, beliefs, order, state, ACTED_CERTAINTY);
        }
        ButtonAction::Use(_) | ButtonAction::Process(_) => {
            for place in kitchen.involved(Agent::Human, button) {
                let aspect = AspectId::of_location(place);
                let open = vec![1.0; beliefs.distribution(aspect).len()];
                beliefs.mix(aspect, &open, 0.6);
            }
        }
    }
}

/// Explains an unexpected lack of effect: the belief about the least certain of the press's locations is weakened.
fn blame(kitchen: &Kitchen, beliefs: &mut ParticipantBeliefs, state: State, button: ButtonId) {
    if matches!(kitchen.button(Agent::Human, button).action, ButtonAction::Serve(_)) {
        // The participant sees the plate's content, so the recipe is doubted instead; see `RecipeMemory::doubt`.
        return;
    }
    let recipes = kitchen.true_recipes();
    let mut places = kitchen.involved(Agent::Human, button);
    // The participant feels what the own hand holds, so this belief is hardly doubted.
    let hand = kitchen.hands[Agent::Human.index()];
    let trust =
        |place| beliefs.certainty(AspectId::of_location(place)) + if place == hand { FELT_CERTAINTY } else { 0.0 };
    places.sort_by(|&a, &b| trust(a).total_cmp(&trust(b)));
    let Some(&place) = places.first() else { return };
    let aspect = AspectId::of_location(place);
    let would_work = |value: usize| {
        let mut other = state;
        other.set_code(place, kitchen.aspects[aspect.index()].values[value]);
        kitchen.press(other, &recipes, Agent::Human, button).is_some()
    };
    beliefs.weigh(aspect, |value| if would_work(value) { CONTRADICTED_FACTOR } else { 1.0 });
}
