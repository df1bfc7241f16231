//! The participant's hand: presses in time, slips, and what it does when there is nothing to do.

use rand::RngExt;

use super::beliefs::wanted_dish;
use super::population::{chance, normal};
use super::simulated::{ParticipantAction, SimulatedParticipant};
use super::{decision, witness};
use crate::base::time::SessionTime;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, AspectId, ButtonAction, ButtonId, DishId, LocationId, State};

/// Below this certainty of a place one looks before using it.
const UNSURE: f64 = 0.6;
/// How long a press waits for such a look, in seconds, and how often.
const LOOK_FIRST_S: f64 = 0.4;
const MOST_LOOKS_FIRST: u32 = 2;
/// What was read so many seconds ago may be otherwise by now.
const FRESH_S: f64 = 0.8;
/// While there is nothing to do one thinks again after this time, in seconds.
const THINK_AGAIN_S: [f64; 2] = [0.4, 0.8];
/// After its patience without a press of anybody, or so many times that without anything to do, a person tries something.
const DESPAIR: f64 = 3.0;
/// Chance that it then asks itself whether it has a recipe right, before it tries something.
const WONDERS: f64 = 0.5;
/// What is left of the belief in a recipe when nothing goes on.
const STANDSTILL_LEAVES: f64 = 0.4;

impl SimulatedParticipant {
    /// Presses, or waits for something to do.
    pub(super) fn move_hand(
        &mut self,
        now: SessionTime,
        state: State,
        cost: &mut CostToGo,
    ) -> Option<ParticipantAction> {
        let kitchen = self.kitchen.clone();
        self.think(now, cost);
        let Some(&button) = self.intent.plan.front() else { return self.wait(now, state, cost) };
        if self.looks_first < MOST_LOOKS_FIRST
            && let Some(place) = self.worth_a_look(now, button)
        {
            self.looks_first += 1;
            self.attention.first(place);
            self.press_at = now + SessionTime::from_secs_f64(LOOK_FIRST_S);
            return None;
        }
        self.intent.plan.pop_front();
        self.intent.tried = None;
        let (pressed, cause) = self.slip(button);
        let cause = match cause {
            Some(cause) => cause,
            None => witness::cause(&kitchen, cost, &self.beliefs, state, button),
        };
        Some(self.press(now, state, pressed, cause))
    }

    /// A place to look at before pressing: one that the person is unsure of, or one that it has not seen for a while, if
    /// it is careful. Before fetching something one looks whether the robot does so already.
    fn worth_a_look(&mut self, now: SessionTime, button: ButtonId) -> Option<LocationId> {
        let kitchen = self.kitchen.clone();
        let own = kitchen.hands[Agent::Human.index()];
        let mut places = kitchen.involved(Agent::Human, button);
        let unsure = places.iter().find(|&&place| self.beliefs.certainty(AspectId::of_location(place)) < UNSURE);
        if unsure.is_some() {
            return unsure.copied();
        }
        if let ButtonAction::Take(_) = kitchen.button(Agent::Human, button).action {
            places.push(kitchen.hands[Agent::Robot.index()]);
        }
        let is_old = |place: LocationId| now.secs_since(self.attention.read_at[place.index()]) > FRESH_S;
        let old = places.into_iter().find(|&place| place != own && is_old(place));
        old.filter(|_| self.looks_first == 0 && chance(&mut self.hand, self.person.makes_sure))
    }

    fn press(&mut self, now: SessionTime, state: State, button: ButtonId, cause: String) -> ParticipantAction {
        self.presses += 1;
        self.looks_first = 0;
        self.idle_since = None;
        self.press_at = now + self.reaction();
        ParticipantAction::Press { button, belief: witness::witness(&self.kitchen, &self.beliefs, state, cause) }
    }

    /// The hand does not always press what was meant: the button pressed instead, and why.
    fn slip(&mut self, button: ButtonId) -> (ButtonId, Option<String>) {
        let kitchen = self.kitchen.clone();
        let name = |button| kitchen.button(Agent::Human, button).name.clone();
        self.meant = None;
        let (is_neighbour, is_alike, is_thoughtless) = (
            chance(&mut self.hand, self.person.slip),
            chance(&mut self.hand, self.person.look_alike_slip),
            chance(&mut self.hand, self.person.thoughtless),
        );
        let alike = kitchen.look_alike_button(Agent::Human, button).filter(|_| is_alike);
        let next = kitchen.nearest_button(Agent::Human, button).filter(|_| is_neighbour);
        let (pressed, cause) = match (alike, next) {
            (Some(other), _) => (other, format!("slip: took the look-alike, meant {}", name(button))),
            (None, Some(other)) => (other, format!("slip: hit the neighbouring button, meant {}", name(button))),
            (None, None) if is_thoughtless => {
                let (state, recipes) = self.beliefs.point(&kitchen);
                let possible = decision::effective_presses(&kitchen, state, &recipes);
                match possible.is_empty() {
                    true => return (button, None),
                    false => {
                        let (other, _) = possible[self.hand.random_range(0..possible.len())];
                        return (other, Some("without thinking".to_string()));
                    }
                }
            }
            (None, None) => return (button, None),
        };
        if !chance(&mut self.hand, self.population.notices_slip) {
            self.meant = Some(button);
        }
        (pressed, Some(cause))
    }

    /// There is nothing to do: looks around, begins to doubt what it remembers, and at last tries something.
    fn wait(&mut self, now: SessionTime, state: State, cost: &mut CostToGo) -> Option<ParticipantAction> {
        let kitchen = self.kitchen.clone();
        let since = *self.idle_since.get_or_insert(now);
        let idle_s = now.secs_since(since);
        let standstill_s = now.secs_since(since.max(self.robot_pressed_at));
        let again_s = THINK_AGAIN_S[0] + (THINK_AGAIN_S[1] - THINK_AGAIN_S[0]) * self.hand.random::<f64>();
        self.press_at = now + SessionTime::from_secs_f64(again_s);
        self.rethink = true;
        if idle_s < self.person.patience_s {
            return None;
        }
        let mut stale: Vec<LocationId> = (0..kitchen.locations.len()).map(|index| LocationId(index as u8)).collect();
        stale.sort_by_key(|location| self.attention.read_at[location.index()]);
        for &location in stale.iter().take(3) {
            self.attention.later(location);
        }
        if idle_s < self.person.patience_s * DESPAIR && standstill_s < self.person.patience_s {
            return None;
        }
        if chance(&mut self.mind, WONDERS) {
            self.idle_since = Some(now);
            let wanted = kitchen.orders.iter().filter_map(|&order| wanted_dish(&kitchen, &self.beliefs, order));
            let wanted: Vec<DishId> = wanted.collect();
            if !wanted.is_empty() {
                let dish = wanted[self.mind.random_range(0..wanted.len())];
                self.memory.doubt(&kitchen, &mut self.beliefs, dish, STANDSTILL_LEAVES, |_| false);
            }
            return None;
        }
        let (believed, recipes) = self.beliefs.point(&kitchen);
        kitchen.wanted(believed).next()?;
        let button = decision::try_something(&kitchen, cost, believed, &recipes, &mut self.mind)?;
        self.meant = None;
        self.intent.tried = Some(button);
        Some(self.press(now, state, button, "tries something, as nothing goes on".to_string()))
    }

    /// From one press to the next: log-normal, faster with practice.
    pub(super) fn reaction(&mut self) -> SessionTime {
        let population = &self.population;
        let novice = population.novice_slowdown * 0.5_f64.powf(f64::from(self.presses) / population.practice_presses);
        let spread = (population.press_jitter * normal(&mut self.hand)).exp();
        SessionTime::from_secs_f64(self.person.press_s * (1.0 + novice) * spread)
    }
}
