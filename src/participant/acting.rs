//! Timed behaviour of the simulated participant: actions that are due, and reactions to events of the session.

use rand::RngExt;

use super::population::chance;
use super::simulated::{ParticipantAction, SimulatedParticipant};
use crate::base::time::SessionTime;
use crate::communication::Signal;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, LocationId, Press, State};

impl SimulatedParticipant {
    /// Starts the trial; the participant sees that the kitchen is empty.
    pub fn on_trial_start(&mut self, now: SessionTime, state: State) {
        self.is_started = true;
        self.display = state;
        self.eyes.start(now);
        self.memory.fade(&self.kitchen, &mut self.beliefs, now, &[]);
        self.attention.read_at.fill(now);
        self.robot_pressed_at = now;
        self.press_at = now + self.reaction();
    }

    /// Performs the next due action. `state` is the true state; only fixated locations and the recorded P(truth) are taken from it.
    pub fn act(&mut self, now: SessionTime, state: State, cost: &mut CostToGo) -> Option<ParticipantAction> {
        if !self.is_started {
            return None;
        }
        if now >= self.press_at && self.press_at <= self.eyes.due() {
            return self.move_hand(now, state, cost);
        }
        if now < self.eyes.due() {
            return None;
        }
        self.read_signal(now, state);
        self.look(now, state);
        if self.rethink {
            self.think(now, cost);
        }
        Some(ParticipantAction::Gaze(self.eyes.sample(now)))
    }

    /// Reacts to a press. The participant notices that the robot pressed, but not which button.
    pub fn on_press(&mut self, now: SessionTime, press: &Press) {
        match press.agent {
            Agent::Robot => {
                self.robot_pressed_at = now;
                self.wonder();
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

    /// Reacts to a signal: the participant probably notices it and looks at it after a short delay.
    pub fn on_signal(&mut self, now: SessionTime, location: LocationId, signal: &Signal, _state: State) {
        let [least, most] = self.population.signal_after_s;
        let after_s = least + (most - least) * self.mind.random::<f64>();
        let is_noticed = chance(&mut self.mind, self.person.notices_signal);
        self.signal = is_noticed.then(|| (now + SessionTime::from_secs_f64(after_s), location, signal.clone()));
    }

    /// Removes the signal; the participant cannot read it any more.
    pub fn on_signal_end(&mut self, _now: SessionTime) {
        self.signal = None;
    }
}
