//! Timed behaviour of the simulated participant: actions that are due, and reactions to events of the session.

use super::draws::rare_chance;
use super::simulated::{ParticipantAction, SimulatedParticipant};
use super::true_beliefs::ParticipantBeliefs;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{Agent, Press, State, World};

/// Probability that all-knowing participants (a setting of the population) give to the true value of every aspect.
const SURE: f64 = 0.99;

impl SimulatedParticipant {
    /// Starts the trial for the participant, who sees that the kitchen is empty.
    pub fn on_trial_start(&mut self, now: SessionTime, state: State) {
        self.is_started = true;
        self.display = state;
        self.eyes.start(now);
        self.memory.fade(&self.kitchen, &mut self.beliefs, now, &[]);
        self.attention.read_at.fill(now);
        self.robot_pressed_at = now;
        self.press_at = now + self.reaction();
    }

    /// Performs the simulated participant's next due action. Of the true `state` the participant uses only fixated
    /// locations; the record of the participant's belief also uses P(truth).
    pub fn act(&mut self, now: SessionTime, state: State) -> Option<ParticipantAction> {
        if !self.is_started {
            return None;
        }
        if self.population.all_knowing {
            self.know(state);
        }
        if now >= self.press_at && self.press_at <= self.eyes.due() {
            return self.move_hand(now, state);
        }
        if now < self.eyes.due() {
            return None;
        }
        self.read_signal(now, state);
        self.look(now, state);
        if self.rethink && !self.is_reading_signal(now) {
            self.think(now);
        }
        Some(ParticipantAction::Gaze(self.eyes.sample(now)))
    }

    /// Makes the beliefs of an all-knowing participant true: the most probable world is then the true one.
    fn know(&mut self, state: State) {
        let kitchen = self.kitchen.clone();
        if self.beliefs.point(&kitchen) != World::with_true_recipes(&kitchen, state) {
            self.beliefs = ParticipantBeliefs::of_state(&kitchen, state, SURE);
            self.rethink = true;
        }
    }

    /// Reacts to a press. Of a robot's press the simulated participant notices that it happened, but not which button
    /// it was.
    pub fn on_press(&mut self, now: SessionTime, press: &Press) {
        match press.agent {
            Agent::Robot => {
                self.robot_pressed_at = now;
                match press.result().filter(|_| rare_chance(&mut self.mind, self.person.guesses_robot)) {
                    Some(after) => self.guess(press.before, after),
                    None => self.wonder(),
                }
            }
            Agent::Human => {
                let button = self.meant.take().unwrap_or(press.button);
                self.take_in(now, button, press.effective);
                if let Some(after) = press.result() {
                    self.display = after;
                }
            }
        }
    }
}
