//! Simulated participants that follow a recorded session: a hypothesis about the person who was recorded.
//!
//! The eyes of such a participant are the recorded ones: it reads what the recorded gaze fixated. Its memory, plans and
//! hand are its own. Whoever follows a recording tells the participant about presses and the start of the trial by the
//! same functions as the engine does, and moves its hand by [`SimulatedParticipant::try_hand`] instead of
//! [`SimulatedParticipant::act`]. A participant that presses as recorded may believe what the recorded person believed:
//! that is the ideal observer of `examples/ideal_observer`.

use super::draws::chance;
use super::habits::Habits;
use super::simulated::{ParticipantAction, SimulatedParticipant};
use super::true_beliefs::wanted_dish;
use crate::base::rng::{Stream, stream};
use crate::base::time::SessionTime;
use crate::kitchen::{ButtonId, DishId, LocationId, State};

impl SimulatedParticipant {
    /// Gives the participant new random streams for all that it does from now on, named by `seed` and `number`.
    pub fn reseed(&mut self, seed: u64, number: u64) {
        self.mind = stream(seed, "shadowing participant's mind", number);
        self.hand = stream(seed, "shadowing participant's hand", number);
        self.memory.reseed(stream(seed, "shadowing participant's memory", number));
    }

    /// Draws some of the participant's lasting properties again, as if another person had come to the same beliefs:
    /// the place of each ingredient in the order of fetching with probability `share`, and all traits together with
    /// the same probability.
    pub fn vary(&mut self, share: f64, random: &mut Stream) {
        let other = Habits::draw(&self.kitchen, random);
        self.habits = self.habits.mixed(&other, |_| chance(random, share));
        if chance(random, share) {
            self.person = self.population.draw(random);
        }
    }

    /// Takes over another participant's memories of the recipes of dishes that neither of them believes to be ordered.
    /// Such memories have nothing to do with what either of them does now.
    pub fn take_unused_recipes(&mut self, other: &SimulatedParticipant) {
        let kitchen = self.kitchen.clone();
        let orders = |one: &SimulatedParticipant| -> Vec<Option<DishId>> {
            kitchen.orders.iter().map(|&order| wanted_dish(&kitchen, &one.beliefs, order)).collect()
        };
        let used = [orders(self), orders(other)].concat();
        for index in 0..kitchen.dishes.len() {
            let dish = DishId(index as u8);
            if !used.contains(&Some(dish)) {
                self.memory.take_recipe(&kitchen, &mut self.beliefs, (&other.memory, &other.beliefs), dish);
            }
        }
    }

    /// Begins a recorded fixation of this point of the display, in fractions of its width and height, and of the
    /// location there (`None`: a storage, or any point outside of the locations).
    pub fn fixate(&mut self, now: SessionTime, point: [f64; 2], location: Option<LocationId>) {
        self.think_if_due(now);
        self.eyes.rest_at(now, point);
        self.attention.looking_at = location;
        // Looks that the participant intended before this one did not take place.
        let intended = self.attention.glances.iter().position(|&other| Some(other) == location);
        self.attention.glances.drain(..intended.map_or(self.attention.glances.len(), |place| place + 1));
    }

    /// Reads the fixated location, at the time at which the recorded person read it, and thinks about what is new.
    pub fn read_fixated(&mut self, now: SessionTime, state: State) {
        if let Some(location) = self.attention.looking_at {
            self.read(now, location, state);
        }
        self.think_if_due(now);
    }

    /// Lets a change of the display to `state` capture the participant's attention, and thinks if there is a reason to.
    pub fn see_change(&mut self, now: SessionTime, state: State) {
        self.notice_changes(now, state);
        self.think_if_due(now);
    }

    /// Session time at which the participant's hand moves next.
    pub fn hand_due(&self) -> SessionTime {
        self.press_at
    }

    /// Moves the hand: the button that the participant presses now; `None` if it waits or looks first. The kitchen does
    /// not change by it: the press counts when the recorded press is told.
    pub fn try_hand(&mut self, now: SessionTime, state: State) -> Option<ButtonId> {
        match self.move_hand(now, state)? {
            ParticipantAction::Press { button, .. } => Some(button),
            ParticipantAction::Gaze(_) => None,
        }
    }

    /// Postpones the hand's next movement by `by`, because the recorded person pressed later than this participant.
    pub fn postpone_hand(&mut self, by: SessionTime) {
        self.press_at = self.press_at + by;
    }

    /// Prepares for a recorded press that the participant did not intend and that it knows to have happened, like a
    /// slip that is noticed at once.
    pub fn press_unintended(&mut self, now: SessionTime) {
        self.meant = None;
        self.looks_first = 0;
        self.idle_since = None;
        self.presses += 1;
        self.press_at = now + self.reaction();
    }

    fn think_if_due(&mut self, now: SessionTime) {
        if self.rethink {
            self.think(now);
        }
    }
}
