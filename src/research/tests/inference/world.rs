//! Kitchens in which humans live who are simulated from the human model itself: what they believe is one draw of the prior,
//! moved on by the model's own equations; what they press is drawn from p(a | b).

use std::sync::Arc;

use rand::RngExt;
use tomcom_core::base::rng::{Stream, stream};
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::cost_to_go::{CostToGo, Fidelity};
use tomcom_core::kitchen::{Agent, ButtonId, DishId, Kitchen, LocationId, OrderContent, State};
use tomcom_core::mind::model::HumanModel;
use tomcom_core::mind::observation::{Observation, ObservedEvidence};
use tomcom_core::robot::policy;
use tomcom_research::reference::belief_set::ParticleSet;
use tomcom_research::reference::person::pick;

/// From one press to the next of each agent, and from one fixation to the next, in seconds.
const PRESS_S: [f64; 2] = [1.2, 2.8];
const FIXATION_S: [f64; 2] = [0.2, 0.6];
/// The share of signals that show a recipe if there is an order.
const RECIPES: f64 = 0.6;

/// A kitchen at work.
pub struct KitchenAtWork {
    pub kitchen: Arc<Kitchen>,
    pub cost: CostToGo,
    chance: Stream,
    /// Gaze samples a second.
    gaze_hz: f64,
    /// The truth.
    pub state: State,
    gaze_at: f64,
    fixation: (f64, [f64; 2]),
    /// When human and robot press next.
    press_at: [f64; 2],
    /// From one signal to the next, in seconds (none: nobody sends any), and when the next one comes.
    signal_s: Option<f64>,
    signal_at: f64,
    /// Orders that change: when, which, to what.
    changes: Vec<(f64, LocationId, OrderContent)>,
}

impl KitchenAtWork {
    pub fn new(
        kitchen: Arc<Kitchen>,
        cost: CostToGo,
        gaze_hz: f64,
        signal_s: Option<f64>,
        seed: u64,
        index: u64,
    ) -> KitchenAtWork {
        let mut chance = stream(seed, "world", index);
        let shows = kitchen.orders.iter().enumerate().map(|(at, &order)| {
            let dish = DishId(chance.random_range(0..kitchen.dishes.len()) as u8);
            (0.01 * at as f64, order, OrderContent::Dish(dish))
        });
        let changes = shows.collect();
        let state = kitchen.empty_state();
        let (fixation, press_at) = ((0.0, [0.5, 0.5]), [2.0, 3.0]);
        let (gaze_at, signal_at) = (0.05, signal_s.map_or(f64::INFINITY, |_| 1.0));
        KitchenAtWork {
            kitchen,
            cost,
            chance,
            gaze_hz,
            state,
            gaze_at,
            fixation,
            press_at,
            signal_s,
            signal_at,
            changes,
        }
    }

    /// The beginning of a trial.
    pub fn start(&mut self) -> Observation {
        self.observation(0.0, ObservedEvidence::Started { state: self.state })
    }

    /// What happens next; the human presses what `choose` says.
    pub fn next(&mut self, choose: impl FnOnce(f64, &mut CostToGo) -> ButtonId) -> Observation {
        let change = self.changes.iter().map(|(at, _, _)| *at).fold(f64::INFINITY, f64::min);
        let [human, robot] = self.press_at;
        let now = change.min(human).min(robot).min(self.gaze_at).min(self.signal_at);
        match now {
            _ if now == self.signal_at => self.signal(now),
            _ if now == self.gaze_at => self.gaze(now),
            _ if now == change => self.change(now),
            _ if now == human => {
                self.press_at[0] = now + self.between(PRESS_S);
                let button = choose(now, &mut self.cost);
                self.press(now, Agent::Human, button)
            }
            _ => {
                self.press_at[1] = now + self.between(PRESS_S);
                let recipes = self.kitchen.true_recipes();
                let choices = policy::choices(&self.kitchen, &mut self.cost, Fidelity::Searched, self.state, &recipes);
                match choices.is_empty() {
                    true => self.next(choose),
                    false => {
                        let button = choices[self.chance.random_range(0..choices.len())];
                        self.press(now, Agent::Robot, button)
                    }
                }
            }
        }
    }

    fn between(&mut self, [least, most]: [f64; 2]) -> f64 {
        least + (most - least) * self.chance.random::<f64>()
    }

    fn observation(&mut self, now: f64, what: ObservedEvidence) -> Observation {
        Observation { time: SessionTime::from_secs_f64(now), what }
    }

    /// Looks here and there.
    fn gaze(&mut self, now: f64) -> Observation {
        self.gaze_at = now + 1.0 / self.gaze_hz;
        if now >= self.fixation.0 {
            let place = self.chance.random_range(0..self.kitchen.locations.len());
            let until = now + self.between(FIXATION_S);
            self.fixation = (until, self.kitchen.locations[place].display.centre());
        }
        let [x, y] = self.fixation.1;
        let sample = GazeSample::new(x, y, 0.9);
        self.observation(now, ObservedEvidence::Gaze { sample, taken: SessionTime::from_secs_f64(now) })
    }

    /// Shows a recipe, mostly, or highlights what a place holds.
    fn signal(&mut self, now: f64) -> Observation {
        self.signal_at = self.signal_s.map_or(f64::INFINITY, |every_s| now + every_s);
        let wants = |order: &LocationId| matches!(self.state.order(*order), OrderContent::Dish(_));
        let orders: Vec<LocationId> = self.kitchen.orders.iter().copied().filter(wants).collect();
        let is_recipe = self.chance.random::<f64>() < RECIPES && !orders.is_empty();
        let location = match is_recipe {
            true => orders[self.chance.random_range(0..orders.len())],
            false => LocationId(self.chance.random_range(0..self.kitchen.locations.len()) as u8),
        };
        self.observation(now, ObservedEvidence::Told { location })
    }

    fn change(&mut self, now: f64) -> Observation {
        let first = (0..self.changes.len()).min_by(|&a, &b| self.changes[a].0.total_cmp(&self.changes[b].0));
        let (_, order, content) = self.changes.swap_remove(first.expect("a change"));
        self.state.set_order(order, content);
        self.observation(now, ObservedEvidence::Displayed { state: self.state })
    }

    fn press(&mut self, now: f64, agent: Agent, button: ButtonId) -> Observation {
        let before = self.state;
        let press = self.kitchen.try_press(before, agent, button);
        self.state = press.after;
        for &order in &self.kitchen.orders.clone() {
            if self.state.order(order) == OrderContent::Served && before.order(order) != OrderContent::Served {
                let dish = DishId(self.chance.random_range(0..self.kitchen.dishes.len()) as u8);
                self.changes.push((now + self.kitchen.served_shown_s, order, OrderContent::None));
                self.changes.push((now + self.kitchen.new_order_after_s, order, OrderContent::Dish(dish)));
            }
        }
        self.observation(now, ObservedEvidence::Pressed(press))
    }
}

/// A human who is simulated from the model.
pub struct Human {
    pub people: ParticleSet,
    model: HumanModel,
    chance: Stream,
}

impl Human {
    pub fn new(kitchen: &Arc<Kitchen>, model: &HumanModel, seed: u64, index: u64) -> Human {
        let people = ParticleSet::new(kitchen.clone(), model.clone());
        Human { people, model: model.clone(), chance: stream(seed, "human of the model", index) }
    }

    /// What it presses at this time, after the looks of the time in which nobody saw its gaze.
    pub fn choose(&mut self, kitchen: &Kitchen, now: f64, cost: &mut CostToGo) -> ButtonId {
        self.people.advance(SessionTime::from_secs_f64(now), cost, &mut self.chance);
        let (decision, states) = (&self.model.decision, self.model.inference.states);
        let chances = self.people.of[0].press_chances(kitchen, cost, decision, states, &mut self.chance);
        ButtonId(pick(&chances, &mut self.chance) as u8)
    }

    pub fn experience(&mut self, observation: &Observation, cost: &mut CostToGo) {
        match observation.what {
            ObservedEvidence::Started { state } => self.people.start(observation.time, state, 1, &mut self.chance),
            _ => {
                self.people.experience(observation, cost, &mut self.chance);
            }
        }
    }
}

/// Lives through a trial of this number of the human's presses. `each` sees every observation before the human makes it.
pub fn live(
    world: &mut KitchenAtWork,
    human: &mut Human,
    presses: usize,
    mut each: impl FnMut(&Observation, &Human, &mut CostToGo),
) {
    let kitchen = world.kitchen.clone();
    let mut left = presses;
    let mut observation = world.start();
    loop {
        each(&observation, human, &mut world.cost);
        human.experience(&observation, &mut world.cost);
        if matches!(observation.what, ObservedEvidence::Pressed(press) if press.agent == Agent::Human) {
            left -= 1;
        }
        if left == 0 {
            return;
        }
        observation = world.next(|now, cost| human.choose(&kitchen, now, cost));
    }
}

/// The largest distance in total variation between two estimates' means, over the aspects.
pub fn distance(one: &[Vec<f64>], other: &[Vec<f64>]) -> f64 {
    let of = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>() / 2.0;
    one.iter().zip(other).map(of).fold(0.0, f64::max)
}
