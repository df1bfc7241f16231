//! The effect of signals on the simulated participant, who may notice and read a signal; reading costs time and
//! attention.
//!
//! The values of these effects come from the literature on glances and interruptions and were fixed before any
//! condition with signals was simulated:
//!
//! - Reading takes a glance, during which the participant sees and presses nothing else: 0.5 to 1.5 s, as people
//!   allocate to single glances at displays beside a primary task (Green 1998, "Visual and Task Demands of Driver
//!   Information Systems", UMTRI-98-16).
//! - Now and then the participant loses its next intention, and resumes the work after a lag of a second: interruptions
//!   of 2.8 s doubled the rate of sequence errors (Altmann, Trafton and Hambrick 2014, "Momentary interruptions can
//!   derail the train of thought"). A signal takes half of that time and loses the intention in 5 %, half of the rate
//!   at which simulated people err anyway.
//! - After useless signals the next ones are noticed less: people respond to alarms about as often as these are right
//!   (Bliss, Gilson and Deaton 1995, "Human probability matching behaviour in response to alarms of varying
//!   reliability").

use std::collections::VecDeque;

use rand::RngExt;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::kitchen::{Agent, ButtonId, DishId, Kitchen, LocationId, OrderContent, State};

use super::simulated::SimulatedParticipant;
use super::{chance, rare_chance};

/// Number of grid steps along each side of the display in the search for free room on it.
const ROOM_STEPS: usize = 20;

/// Least share of signals that a participant still notices when all signals so far were useless.
const LEAST_HEED: f64 = 0.3;

impl SimulatedParticipant {
    /// Reacts to a signal: the participant may notice the signal, and then looks at it after a short delay.
    pub fn on_signal(&mut self, now: SessionTime, location: Option<LocationId>, signal: &Signal) {
        let [least, most] = self.population.signal_after_s;
        let after_s = least + (most - least) * self.mind.random::<f64>();
        let heed = LEAST_HEED + (1.0 - LEAST_HEED) * self.signals.worth;
        let is_noticed = chance(&mut self.mind, self.person.notices_signal * heed);
        self.signals.pending =
            is_noticed.then(|| (now + SessionTime::from_secs_f64(after_s), location, signal.clone()));
    }

    /// Removes the signal from the display, so that the participant cannot read it any more. The participant does not
    /// make proposed presses that are out of date.
    pub fn on_signal_end(&mut self, is_outdated: bool) {
        self.signals.pending = None;
        if is_outdated {
            self.signals.follows.clear();
        }
    }

    pub(super) fn is_reading_signal(&self, now: SessionTime) -> bool {
        now < self.signals.busy_until
    }

    /// Reads the signal whose reading is due. If the signal told nothing new, the participant notices later signals
    /// less.
    pub(super) fn read_signal(&mut self, now: SessionTime, state: State) {
        let is_due = self.signals.pending.as_ref().is_some_and(|(time, _, _)| now >= *time);
        let Some((_, location, signal)) = self.signals.pending.take_if(|_| is_due) else { return };
        let kitchen = self.kitchen.clone();
        (self.rethink, self.stuck_in) = (true, None);
        let point = location.map_or_else(|| roomiest(&kitchen), |location| kitchen.location(location).display.centre());
        self.eyes.look_at(now, point);
        self.attention.looking_at = location;
        let is_useful = match (signal, location) {
            (Signal::Propose(presses), _) => self.read_proposal(&presses),
            (Signal::Highlight(_), Some(location)) => {
                let before = self.beliefs.point(&kitchen);
                self.read(now, location, state);
                self.beliefs.point(&kitchen) != before
            }
            (Signal::ShowRecipe(_), Some(location)) => {
                let before = self.beliefs.point(&kitchen);
                if let OrderContent::Dish(dish) = state.order(location) {
                    self.read(now, location, state);
                    self.read_recipe(dish);
                }
                self.beliefs.point(&kitchen) != before
            }
            (_, None) => false,
        };
        self.pay_for_signal(now, is_useful);
    }

    /// Reads the recipe that a signal shows, occasionally wrongly; the participant may keep the own version of the
    /// recipe.
    fn read_recipe(&mut self, dish: DishId) {
        let kitchen = self.kitchen.clone();
        let variants = kitchen.dish(dish).variants.len();
        let is_wrong = variants > 1 && chance(&mut self.mind, self.population.misreads_signal);
        let seen = if is_wrong { self.mind.random_range(1..variants) } else { 0 };
        let is_own = self.beliefs.most_likely(kitchen.aspect_of_dish(dish)) == seen;
        if is_own || !rare_chance(&mut self.mind, self.person.keeps_own_recipe) {
            self.memory.confirm(&kitchen, &mut self.beliefs, dish, seen);
        }
    }

    /// Reads proposed presses, which the participant may intend to make. Proposals reveal nothing about contents and
    /// recipes, so beliefs do not change. Returns whether the proposed presses differ from the planned ones.
    fn read_proposal(&mut self, presses: &[String]) -> bool {
        let buttons = presses.iter().filter_map(|name| self.kitchen.button_named(Agent::Human, name));
        let buttons: VecDeque<ButtonId> = buttons.collect();
        let is_new = self.intent.plan.front() != buttons.front();
        if rare_chance(&mut self.mind, self.person.follows_proposal) {
            self.signals.follows = buttons;
        }
        is_new
    }

    /// Records an own press: a proposal is followed press by press, and any other press ends following it.
    pub(super) fn has_pressed(&mut self, button: ButtonId) {
        if self.signals.follows.pop_front() != Some(button) {
            self.signals.follows.clear();
        }
    }

    /// Applies the costs of a signal that was read: time, possibly the loss of the next intention, and less attention
    /// to later signals if the signal was useless.
    fn pay_for_signal(&mut self, now: SessionTime, is_useful: bool) {
        let [least, most] = self.population.reads_signal_s;
        let reading_s = least + (most - least) * self.mind.random::<f64>();
        let until = now + SessionTime::from_secs_f64(reading_s);
        self.signals.busy_until = until;
        self.eyes.rest_until(until);
        let worth = f64::from(u8::from(is_useful));
        self.signals.worth += self.person.tires_of_signals * (worth - self.signals.worth);
        self.press_at = self.press_at.max(until);
        if chance(&mut self.mind, self.person.loses_intention) {
            let lag = SessionTime::from_secs_f64(self.population.resumes_after_s);
            self.press_at = self.press_at.max(until + lag);
            self.intent.lose();
        }
    }
}

/// Where the participant's display shows proposed presses: the point that is farthest from all locations and storages,
/// in fractions of the display's width and height.
fn roomiest(kitchen: &Kitchen) -> [f64; 2] {
    let at = |step: usize| step as f64 / ROOM_STEPS as f64;
    // The corners of the display are reserved for the eye tracker's markers.
    let inside = || 2..ROOM_STEPS - 1;
    let points = inside().flat_map(|x| inside().map(move |y| [at(x), at(y)]));
    let areas =
        || kitchen.locations.iter().map(|one| one.display).chain(kitchen.storages.iter().map(|one| one.display));
    let room_m =
        |point: &[f64; 2]| areas().map(|area| area.distance_m(*point, kitchen.display_m)).fold(f64::INFINITY, f64::min);
    points.max_by(|a, b| room_m(a).total_cmp(&room_m(b))).unwrap_or([0.5, 0.5])
}

#[derive(Clone, Debug)]
pub(super) struct SignalSense {
    /// A noticed signal: the time at which the participant will read the signal, the signal's location, and the signal.
    pub pending: Option<(SessionTime, Option<LocationId>, Signal)>,
    /// Proposed presses that the participant intends to make next.
    pub follows: VecDeque<ButtonId>,
    pub(crate) busy_until: SessionTime,
    /// How useful the signals so far have been to the participant, from 0 to 1.
    pub worth: f64,
}

impl Default for SignalSense {
    fn default() -> SignalSense {
        SignalSense { pending: None, follows: VecDeque::new(), busy_until: SessionTime::ZERO, worth: 1.0 }
    }
}

impl SignalSense {
    pub fn postpone(&mut self, by: SessionTime) {
        self.pending = self.pending.take().map(|(time, location, signal)| (time + by, location, signal));
        self.busy_until = self.busy_until + by;
    }
}
