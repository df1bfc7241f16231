//! Hand of the simulated participant: timed presses, slips, and waiting while no press is useful.

use rand::RngExt;
use tomcom_core::base::rng::Stream;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{Agent, AspectId, ButtonId, DishId, Kitchen, LocationId, State, World};

use super::beliefs::wanted_dish;
use super::decision::{Impatience, effective_presses};
use super::simulated::{ParticipantAction, SimulatedParticipant};
use super::witness::PressReason;
use super::{chance, drawn_by_weight, normal, witness};

/// Certainty about a location's content below which the participant looks at the location before using it.
const UNSURE_BELOW: f64 = 0.6;
/// Delay of a press by a look at a location that the press uses, in seconds, and largest number of such looks per
/// press.
const LOOK_FIRST_S: f64 = 0.4;
const MOST_LOOKS_FIRST: u32 = 2;
/// Time since the last reading of a location, in seconds, after which the participant may look at the location again
/// before using it.
const FRESH_S: f64 = 0.8;
/// Interval between two decisions while no press is useful, in seconds: shortest and longest.
const THINK_AGAIN_S: [f64; 2] = [0.4, 0.8];
/// Multiple of the participant's patience, without a useful press, after which a seemingly useless press is tried.
const PATIENCE_FACTOR: f64 = 3.0;
/// Probability that the participant then doubts a recipe instead of trying a press that seems useless.
const DOUBTS_RECIPE: f64 = 0.5;
/// Share of the belief in a recipe that remains after the participant doubted the recipe because no press was useful.
const STANDSTILL_TRUST: f64 = 0.4;

impl SimulatedParticipant {
    /// Presses the planned button when the press is due, or waits if no press is planned.
    pub(super) fn move_hand(&mut self, now: SessionTime, state: State) -> Option<ParticipantAction> {
        self.think(now);
        let Some(&button) = self.intent.plan.front() else { return self.wait(now, state) };
        if self.looks_first < MOST_LOOKS_FIRST
            && let Some(place) = self.worth_a_look(now, button)
        {
            self.looks_first += 1;
            self.attention.first(place);
            self.press_at = now + SessionTime::from_secs_f64(LOOK_FIRST_S);
            return None;
        }
        let (pressed, slip) = self.slip(button);
        let is_proposed = self.signals.follows.front() == Some(&button);
        let reason = match slip {
            Some(slip) => PressReason::slip(slip),
            None if is_proposed => PressReason::proposed(),
            None => self.reason(Impatience::Calm, state, button),
        };
        self.intent.plan.pop_front();
        Some(self.press(now, state, pressed, reason))
    }

    /// The reason for which the participant presses this button, found by repeating the decision with the truth.
    fn reason(&self, urgency: Impatience, state: State, button: ButtonId) -> PressReason {
        let (believed, truth) = (self.beliefs.point(&self.kitchen), World::with_true_recipes(&self.kitchen, state));
        PressReason::decided(&self.decision(urgency), &believed, &truth, button)
    }

    /// The location to look at before a press: the participant is unsure of the location's content, or is cautious and
    /// has not read the location for a while. Before taking an item from a storage, the participant looks at the
    /// robot's hand, because the robot may be fetching the same item.
    fn worth_a_look(&mut self, now: SessionTime, button: ButtonId) -> Option<LocationId> {
        let kitchen = self.kitchen.clone();
        let own = kitchen.hands[Agent::Human.index()];
        let is_unsure = |&place: &LocationId| self.beliefs.certainty(AspectId::of_location(place)) < UNSURE_BELOW;
        let unsure = kitchen.involved(Agent::Human, button).into_iter().find(is_unsure);
        if unsure.is_some() {
            return unsure;
        }
        let is_old = |place: LocationId| now.secs_since(self.attention.read_at[place.index()]) > FRESH_S;
        let old = kitchen.watched(button).into_iter().find(|&place| place != own && is_old(place));
        old.filter(|_| self.looks_first == 0 && chance(&mut self.hand, self.person.makes_sure))
    }

    fn press(&mut self, now: SessionTime, state: State, button: ButtonId, reason: PressReason) -> ParticipantAction {
        self.presses += 1;
        self.has_pressed(button);
        self.looks_first = 0;
        self.idle_since = None;
        self.press_at = now + self.reaction();
        ParticipantAction::Press { button, belief: witness::witness(&self.kitchen, &self.beliefs, state, reason) }
    }

    /// Draws whether the press is a slip: the button that is pressed instead of the intended one, and a description.
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
        let hit = if is_neighbour { slipped_button(&kitchen, button, &mut self.hand) } else { None };
        let (pressed, cause) = match (alike, hit) {
            (Some(other), _) => (other, format!("slip: took the look-alike, meant {}", name(button))),
            (None, Some(other)) => (other, format!("slip: hit a button nearby, meant {}", name(button))),
            (None, None) if is_thoughtless => {
                let possible = effective_presses(&kitchen, &self.beliefs.point(&kitchen));
                if possible.is_empty() {
                    return (button, None);
                }
                let other = possible[self.hand.random_range(0..possible.len())];
                return (other, Some("without thinking".to_string()));
            }
            (None, None) => return (button, None),
        };
        if !chance(&mut self.hand, self.population.notices_slip) {
            self.meant = Some(button);
        }
        (pressed, Some(cause))
    }

    /// Waits while no press is useful: the participant looks around, then doubts the recipes, and at last tries a
    /// press. Who does not know how to go on only looks around.
    fn wait(&mut self, now: SessionTime, state: State) -> Option<ParticipantAction> {
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
        let mut stale: Vec<LocationId> = kitchen.location_ids().collect();
        stale.sort_by_key(|location| self.attention.read_at[location.index()]);
        for &location in stale.iter().take(3) {
            self.attention.later(location);
        }
        if self.stuck_in.is_some() {
            return None;
        }
        if standstill_s >= self.person.patience_s
            && let Some(action) = self.press_urgently(now, state, Impatience::Impatient)
        {
            return Some(action);
        }
        if idle_s < self.person.patience_s * PATIENCE_FACTOR && standstill_s < self.person.patience_s {
            return None;
        }
        if chance(&mut self.mind, DOUBTS_RECIPE) {
            self.idle_since = Some(now);
            let wanted = kitchen.orders.iter().filter_map(|&order| wanted_dish(&kitchen, &self.beliefs, order));
            let wanted: Vec<DishId> = wanted.collect();
            if !wanted.is_empty() {
                let dish = wanted[self.mind.random_range(0..wanted.len())];
                self.memory.doubt(&kitchen, &mut self.beliefs, dish, STANDSTILL_TRUST, |_| false);
            }
            return None;
        }
        self.press_urgently(now, state, Impatience::Desperate)
    }

    /// Decides again with this urgency, and presses at once if the decision names a press.
    fn press_urgently(&mut self, now: SessionTime, state: State, urgency: Impatience) -> Option<ParticipantAction> {
        let plan = self.decision(urgency).resolve(&self.beliefs.point(&self.kitchen)).plan;
        let button = *plan.front()?;
        self.meant = None;
        let reason = self.reason(urgency, state, button);
        Some(self.press(now, state, button, reason))
    }

    /// Draws the time from one press to the next: log-normal, shorter with practice.
    pub(super) fn reaction(&mut self) -> SessionTime {
        let population = &self.population;
        let novice = population.novice_slowdown * 0.5_f64.powf(f64::from(self.presses) / population.practice_presses);
        let spread = (population.press_jitter * normal(&mut self.hand)).exp();
        SessionTime::from_secs_f64(self.person.press_s * (1.0 + novice) * spread)
    }
}

// Slips of the hand: which other button is hit instead of the intended one.
//
// The neighbour that a slip of the assistant's human model hits ([`Kitchen::nearest_button`]) is another mechanism:
// inference must not be tested on the human that the assistant models exactly.

/// Distance from the intended button, in metres, at which a button is hit e times less often than next to the intended
/// button: the spacing of the buttons in a row of the sushi kitchen. End points of quick reaches scatter normally
/// around their target (Schmidt et al. 1979), so weights fall with the square of the distance: two spacings away, to
/// 2 %.
const SLIP_REACH_M: f64 = 0.12;
/// How many times as often a button is hit whose cap has the colour of the intended button's cap, at the same distance.
/// What resembles the intended object attracts slips (Norman 1981, description errors), and search is guided by colour
/// (Wolfe 1994). No source has a number for buttons; with 2, of two buttons at the same distance the one of like colour
/// gets two thirds of the slips.
const LIKE_COLOUR: f64 = 2.0;

/// Draws the button of the human that a slip hits instead of the button `meant`: buttons nearby and of like colour are
/// hit more often. If the layout gives the intended button no colour, distance alone decides. `None` if the human has
/// no other button.
pub fn slipped_button(kitchen: &Kitchen, meant: ButtonId, random: &mut Stream) -> Option<ButtonId> {
    let buttons = &kitchen.buttons[Agent::Human.index()];
    let own = &buttons[meant.index()];
    let apart_m = |other: usize| {
        let [x, y] = buttons[other].at_m;
        (x - own.at_m[0]).hypot(y - own.at_m[1])
    };
    let others: Vec<usize> = (0..buttons.len()).filter(|&other| other != meant.index()).collect();
    let nearest_m = others.iter().map(|&other| apart_m(other)).fold(f64::INFINITY, f64::min);
    // Relative to the nearest button, so that the weights of buttons that stand far apart do not all vanish.
    let weight = |other: usize| {
        let is_alike = own.colour.is_some() && buttons[other].colour == own.colour;
        let factor = if is_alike { LIKE_COLOUR } else { 1.0 };
        factor * ((nearest_m.powi(2) - apart_m(other).powi(2)) / SLIP_REACH_M.powi(2)).exp()
    };
    let weights: Vec<f64> = others.iter().map(|&other| weight(other)).collect();
    // What rounding leaves after the last weight belongs to it.
    drawn_by_weight(random, &weights).or(others.len().checked_sub(1)).map(|index| ButtonId(others[index] as u8))
}
