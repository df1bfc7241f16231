//! Simulated participants: people for tests, who err for reasons that one can name.
//!
//! A simulated participant is not the assistant's model of a human: it holds one version of the world for true and acts on
//! it, it thinks in sub-goals and keeps to them, it sees only what it looks at, and its memory of recipes fails in steps.

mod attention;
pub mod beliefs;
mod decision;
mod eyes;
mod hand;
mod learning;
mod memory;
pub mod population;
mod targets;
mod witness;

use std::sync::Arc;

use rand::RngExt;

use crate::base::rng::{Stream, stream};
use crate::base::time::SessionTime;
use crate::communication::Signal;
use crate::gaze::GazeSample;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, AspectId, ButtonAction, ButtonId, ContentId, DishId, Kitchen, LocationId, LocationKind};
use crate::kitchen::{OrderContent, Press, State};
use crate::mind::BeliefWitness;
use attention::Attention;
use beliefs::{ParticipantBeliefs, wanted_dish};
use decision::Intent;
use eyes::Eyes;
use memory::Memory;
use population::{Experience, Individual, Population, chance};

/// Something that the participant does.
#[derive(Clone, Debug, PartialEq)]
pub enum ParticipantAction {
    /// What an eye tracker sees of it.
    Gaze(GazeSample),
    /// It presses a button; `belief` is what it believes at this moment, and why it presses.
    Press { button: ButtonId, belief: BeliefWitness },
}

/// Belief in what the empty kitchen looks like at the start.
const SURE_AT_START: f64 = 0.97;
/// Chance to glance at what the last press changed.
const LOOKS_AT_RESULT: f64 = 0.5;
/// What was read so many seconds ago one takes for granted.
const SEEN_JUST_NOW_S: f64 = 5.0;
/// Belief that an order which was served is gone after the usual time.
const EXPECTED: f64 = 0.8;

/// A simulated participant in one trial.
#[derive(Clone, Debug)]
pub struct SimulatedParticipant {
    kitchen: Arc<Kitchen>,
    population: Population,
    person: Individual,
    beliefs: ParticipantBeliefs,
    memory: Memory,
    eyes: Eyes,
    /// While the calibration is checked.
    at_targets: Option<Eyes>,
    attention: Attention,
    intent: Intent,
    /// The mind's chances: attention, reading, thinking; and the hand's: times and slips.
    mind: Stream,
    hand: Stream,
    is_started: bool,
    /// The display as it was when changes were last looked out for.
    display: State,
    rethink: bool,
    press_at: SessionTime,
    presses: u32,
    looks_first: u32,
    idle_since: Option<SessionTime>,
    /// When the robot last pressed something.
    robot_pressed_at: SessionTime,
    /// The press under way: what was meant, if the person takes it for done.
    meant: Option<ButtonId>,
    signal: Option<(SessionTime, LocationId, Signal)>,
    /// Orders that were served and will be gone at this time.
    clearing: Vec<(SessionTime, LocationId)>,
}

impl SimulatedParticipant {
    /// The participant of this trial, drawn from a population. Who it is follows from `person`, what it happens to do from
    /// `trial`: one person may have several trials. What the earlier ones taught it, `experience` says.
    pub fn new(
        kitchen: Arc<Kitchen>,
        population: &Population,
        seed: u64,
        person: u64,
        trial: u64,
        experience: Experience,
    ) -> Self {
        let person = population.draw(&mut stream(seed, "participant", person)).after(experience, population);
        let mut beliefs = ParticipantBeliefs::of_state(&kitchen, kitchen.empty_state(), SURE_AT_START);
        let recall = stream(seed, "participant's memory", trial);
        let memory = Memory::new(&kitchen, population, &person, recall, &mut beliefs);
        let sight = stream(seed, "participant's eyes", trial);
        let eyes = Eyes::new(sight, kitchen.display_m, &person, population.tracker_offset_m);
        let read_at = vec![SessionTime::ZERO; kitchen.locations.len()];
        let display = kitchen.empty_state();
        SimulatedParticipant {
            population: population.clone(),
            person,
            beliefs,
            memory,
            eyes,
            at_targets: None,
            attention: Attention { read_at, ..Attention::default() },
            intent: Intent::default(),
            mind: stream(seed, "participant's mind", trial),
            hand: stream(seed, "participant's hand", trial),
            is_started: false,
            display,
            rethink: true,
            press_at: SessionTime::ZERO,
            presses: (experience.presses * population.practice_kept) as u32,
            looks_first: 0,
            idle_since: None,
            robot_pressed_at: SessionTime::ZERO,
            meant: None,
            signal: None,
            clearing: Vec::new(),
            kitchen,
        }
    }

    /// Who it is.
    pub fn person(&self) -> &Individual {
        &self.person
    }

    /// What it believes.
    pub fn beliefs(&self) -> &ParticipantBeliefs {
        &self.beliefs
    }

    /// When it does something next; nothing before the trial's start.
    pub fn next_due(&self) -> Option<SessionTime> {
        self.is_started.then(|| self.press_at.min(self.eyes.due()))
    }

    /// The press that it means to make next, and when, as far as that is decided.
    pub fn next_press(&self) -> Option<(ButtonId, SessionTime)> {
        let button = self.intent.plan.front().filter(|_| self.is_started)?;
        Some((*button, self.press_at))
    }

    /// The trial starts: the kitchen is seen to be empty.
    pub fn on_trial_start(&mut self, now: SessionTime, state: State) {
        self.is_started = true;
        self.display = state;
        self.eyes.start(now);
        self.memory.fade(&self.kitchen, &mut self.beliefs, now, &[]);
        self.attention.read_at.fill(now);
        self.robot_pressed_at = now;
        self.press_at = now + self.reaction();
    }

    /// Everything that it meant to do happens later by `by`.
    pub fn postpone(&mut self, by: SessionTime) {
        self.eyes.postpone(by);
        self.memory.postpone(by);
        self.press_at = self.press_at + by;
        self.robot_pressed_at = self.robot_pressed_at + by;
        self.idle_since = self.idle_since.map(|since| since + by);
        self.signal = self.signal.take().map(|(time, location, signal)| (time + by, location, signal));
        self.intent.order = self.intent.order.map(|(order, until)| (order, until + by));
        for time in self.attention.read_at.iter_mut().chain(self.clearing.iter_mut().map(|(time, _)| time)) {
            *time = *time + by;
        }
    }

    /// Does what is due now. `state` is the truth: only what the eyes rest on is taken from it, and the record's P(truth).
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

    /// An agent pressed a button: of the robot's press only that it happened is noticed.
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

    /// A signal appears: mostly it is noticed, and read after a moment.
    pub fn on_signal(&mut self, now: SessionTime, location: LocationId, signal: &Signal, _state: State) {
        let [least, most] = self.population.signal_after_s;
        let after_s = least + (most - least) * self.mind.random::<f64>();
        let is_noticed = chance(&mut self.mind, self.person.notices_signal);
        self.signal = is_noticed.then(|| (now + SessionTime::from_secs_f64(after_s), location, signal.clone()));
    }

    /// The signal vanishes; what was not read yet is not read any more.
    pub fn on_signal_end(&mut self, _now: SessionTime) {
        self.signal = None;
    }

    fn read_signal(&mut self, now: SessionTime, state: State) {
        let is_due = self.signal.as_ref().is_some_and(|(time, _, _)| now >= *time);
        let Some((_, location, signal)) = self.signal.take_if(|_| is_due) else { return };
        let kitchen = self.kitchen.clone();
        self.rethink = true;
        let point = kitchen.location(location).display.centre();
        self.eyes.look_at(now, point);
        self.attention.looking_at = Some(location);
        match signal {
            Signal::Highlight(_) => self.read(now, location, state),
            Signal::ShowRecipe(_) => {
                let OrderContent::Dish(dish) = state.order(location) else { return };
                self.read(now, location, state);
                let variants = kitchen.dish(dish).variants.len();
                let is_wrong = variants > 1 && chance(&mut self.mind, self.population.misreads_signal);
                let seen = if is_wrong { self.mind.random_range(1..variants) } else { 0 };
                self.memory.confirm(&kitchen, &mut self.beliefs, dish, seen);
            }
        }
    }

    /// The robot pressed something: what is out of sight may be otherwise now.
    fn wonder(&mut self) {
        let kitchen = self.kitchen.clone();
        let hand = kitchen.hands[Agent::Robot.index()];
        let own = kitchen.hands[Agent::Human.index()];
        let (state, _) = self.beliefs.point(&kitchen);
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

    /// The own press did something, or not.
    fn take_in(&mut self, now: SessionTime, button: ButtonId, effective: bool) {
        let kitchen = self.kitchen.clone();
        let action = kitchen.button(Agent::Human, button).action;
        let (state, recipes) = self.beliefs.point(&kitchen);
        let has_failed = !effective && kitchen.press(state, &recipes, Agent::Human, button).is_some();
        if has_failed && self.population.insists > 0.0 && chance(&mut self.mind, self.population.insists) {
            self.intent.plan.push_front(button);
            return;
        }
        let is_surprised = learning::learn(&kitchen, &mut self.beliefs, button, effective);
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
                    let gone = now + SessionTime::from_secs_f64(kitchen.served_shown_s);
                    self.clearing.push((gone, order));
                }
                // Was it on the plate at all? Only who has just seen it there asks himself about the recipe.
                false if now.secs_since(self.attention.read_at[kitchen.plate.index()]) < SEEN_JUST_NOW_S => {
                    self.memory.fail(&kitchen, &mut self.beliefs, dish);
                }
                false => {}
            }
        }
        self.rethink = true;
    }

    /// Thinks about what to do next, and looks where that will happen.
    fn think(&mut self, now: SessionTime, cost: &mut CostToGo) {
        self.rethink = false;
        let kitchen = self.kitchen.clone();
        self.pass_time(now);
        let commitment = SessionTime::from_secs_f64(self.person.commitment_s);
        let before = self.intent.plan.front().copied();
        decision::think(&kitchen, cost, &self.beliefs, &mut self.intent, now + commitment, now, &mut self.mind);
        let next = self.intent.plan.front().copied();
        if next != before {
            for place in self.needed() {
                if chance(&mut self.mind, self.person.checks) {
                    self.attention.later(place);
                }
            }
        }
    }

    /// Memories fade, threads are lost, served orders are expected to be gone.
    fn pass_time(&mut self, now: SessionTime) {
        let kitchen = self.kitchen.clone();
        let orders = kitchen.orders.iter();
        let in_use: Vec<DishId> = orders.filter_map(|&order| wanted_dish(&kitchen, &self.beliefs, order)).collect();
        let passed_s = self.memory.since_s(now);
        self.memory.fade(&kitchen, &mut self.beliefs, now, &in_use);
        for &dish in &in_use {
            if chance(&mut self.mind, 1.0 - (-self.person.loses_thread_per_s * passed_s).exp()) {
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

/// What a serve button would serve.
fn serve_of(action: ButtonAction, state: State) -> OrderContent {
    match action {
        ButtonAction::Serve(order) => state.order(order),
        _ => OrderContent::None,
    }
}
