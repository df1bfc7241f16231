//! A simulated participant: its data, and what it does at which time.

use std::collections::VecDeque;
use std::sync::Arc;

use tomcom_core::base::rng::{Stream, of_trial, stream};
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::{Agent, ButtonId, Kitchen, LocationId, Press, State, World};
use tomcom_core::mind::RecordedBelief;

use super::beliefs::{ParticipantBeliefs, RecipeMemory};
use super::decision::{Habits, Lapses, ParticipantPlan};
use super::eyes::Eyes;
use super::goals::TaskKnowledge;
use super::population::{Experience, ParticipantTraits, Population};
use super::rare_chance;
use super::signals::SignalSense;

/// Probability with which the simulated participant believes that the kitchen is empty at the start of a trial.
const SURE_AT_START: f64 = 0.97;

#[derive(Clone, Debug, PartialEq)]
pub enum ParticipantAction {
    Gaze(GazeSample),
    /// A press of a button; `belief` records the participant's beliefs at the press and the cause of the press.
    Press {
        button: ButtonId,
        belief: RecordedBelief,
    },
}

#[derive(Clone, Debug)]
pub struct SimulatedParticipant {
    pub(super) kitchen: Arc<Kitchen>,
    pub(super) knowledge: Arc<TaskKnowledge>,
    pub(super) habits: Habits,
    pub(super) population: Population,
    pub(super) person: ParticipantTraits,
    pub(super) beliefs: ParticipantBeliefs,
    pub(super) memory: RecipeMemory,
    pub(super) eyes: Eyes,
    /// Copy of the eyes that looks at the targets of a gaze accuracy check; `None` while no check is running.
    pub(super) at_targets: Option<Eyes>,
    pub(super) attention: LookQueue,
    pub(super) intent: ParticipantPlan,
    /// Random streams of the participant: of the mind (attention, reading, thinking), and of the hand (press times,
    /// slips).
    pub(super) mind: Stream,
    pub(super) hand: Stream,
    pub(super) is_started: bool,
    /// State that the display showed when the participant last compared it for changes.
    pub(super) display: State,
    pub(super) rethink: bool,
    pub(super) press_at: SessionTime,
    pub(super) presses: u32,
    pub(super) looks_first: u32,
    pub(super) idle_since: Option<SessionTime>,
    pub(super) robot_pressed_at: SessionTime,
    /// The button that the participant intended, if the last press was a slip that went unnoticed; else `None`.
    pub(super) meant: Option<ButtonId>,
    pub(super) signals: SignalSense,
    /// What the participant believed when the participant no longer knew how to go on; `None` if the participant knows.
    pub(super) stuck_in: Option<World>,
    pub(super) answer_seed: u64,
    /// Served orders, each with the session time at which the participant expects the order to disappear.
    pub(super) clearing: Vec<(SessionTime, LocationId)>,
}

impl SimulatedParticipant {
    /// Draws the simulated participant of a trial from a population. Traits are seeded by `person`, random events of
    /// the trial by `trial`, so one person can have several trials. `experience` describes the person's earlier trials.
    pub fn new(
        kitchen: Arc<Kitchen>,
        population: &Population,
        seed: u64,
        person: u64,
        trial: u64,
        experience: Experience,
    ) -> Self {
        let habits = Habits::draw(&kitchen, &mut stream(seed, "participant's habits", person));
        let person = population.draw(&mut stream(seed, "participant", person)).after(experience, population);
        let mut beliefs = ParticipantBeliefs::of_state(&kitchen, kitchen.empty_state(), SURE_AT_START);
        let recall = stream(seed, "participant's memory", trial);
        let memory = RecipeMemory::new(&kitchen, population, &person, recall, &mut beliefs);
        let sight = stream(seed, "participant's eyes", trial);
        let eyes = Eyes::new(sight, kitchen.display_m, &person, population.tracker_offset_m);
        let read_at = vec![SessionTime::ZERO; kitchen.locations.len()];
        let display = kitchen.empty_state();
        let mut mind = stream(seed, "participant's mind", trial);
        let lapses = Lapses::draw(&person, &mut mind);
        SimulatedParticipant {
            population: population.clone(),
            knowledge: Arc::new(TaskKnowledge::new(&kitchen)),
            habits,
            person,
            beliefs,
            memory,
            eyes,
            at_targets: None,
            attention: LookQueue { read_at, ..LookQueue::default() },
            intent: ParticipantPlan { lapses, ..ParticipantPlan::default() },
            mind,
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
            signals: SignalSense::default(),
            stuck_in: None,
            answer_seed: of_trial(seed, trial),
            clearing: Vec::new(),
            kitchen,
        }
    }

    pub fn person(&self) -> &ParticipantTraits {
        &self.person
    }

    pub fn beliefs(&self) -> &ParticipantBeliefs {
        &self.beliefs
    }

    /// Session time of the participant's next action; `None` before the trial's start.
    pub fn next_due(&self) -> Option<SessionTime> {
        self.is_started.then(|| self.press_at.min(self.eyes.due()))
    }

    /// The participant's planned next press and the press's time; `None` if not decided yet.
    pub fn next_press(&self) -> Option<(ButtonId, SessionTime)> {
        let button = self.intent.plan.front().filter(|_| self.is_started)?;
        Some((*button, self.press_at))
    }

    pub fn postpone(&mut self, by: SessionTime) {
        self.eyes.postpone(by);
        self.memory.postpone(by);
        self.press_at = self.press_at + by;
        self.robot_pressed_at = self.robot_pressed_at + by;
        self.idle_since = self.idle_since.map(|since| since + by);
        self.signals.postpone(by);
        self.intent.order = self.intent.order.map(|(order, until)| (order, until + by));
        for time in self.attention.read_at.iter_mut().chain(self.clearing.iter_mut().map(|(time, _)| time)) {
            *time = *time + by;
        }
    }
}

const MOST_GLANCES: usize = 6;

/// Queue of locations at which a simulated participant intends to look, and the time of the last reading of each
/// location.
#[derive(Clone, Debug, Default)]
pub struct LookQueue {
    pub glances: VecDeque<LocationId>,
    pub(crate) looking_at: Option<LocationId>,
    /// Session time of the participant's last reading of each location.
    pub read_at: Vec<SessionTime>,
}

impl LookQueue {
    /// Puts a location at the front of the queue of locations to look at.
    pub fn first(&mut self, location: LocationId) {
        self.glances.retain(|&other| other != location);
        self.glances.push_front(location);
        self.glances.truncate(MOST_GLANCES);
    }

    /// Puts a location at the end of the queue of locations to look at.
    pub fn later(&mut self, location: LocationId) {
        if !self.glances.contains(&location) && self.glances.len() < MOST_GLANCES {
            self.glances.push_back(location);
        }
    }
}

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

impl SimulatedParticipant {
    /// Shows a target of the gaze accuracy check, or removes it. A copy of the eyes looks at the target, so a check
    /// changes nothing in the trial; the copy has the same offset of the eye tracker.
    pub fn on_target(&mut self, now: SessionTime, target: Option<[f64; 2]>) {
        match (target, &mut self.at_targets) {
            (None, eyes) => *eyes = None,
            (Some(point), Some(eyes)) => eyes.look_at(now, point),
            (Some(point), eyes) => {
                let mut begun = self.eyes.clone();
                begun.start(now);
                begun.look_at(now, point);
                *eyes = Some(begun);
            }
        }
    }

    pub fn target_due(&self) -> Option<SessionTime> {
        self.at_targets.as_ref().map(|eyes| eyes.due())
    }

    pub fn look_at_target(&mut self, now: SessionTime) -> Option<GazeSample> {
        self.at_targets.as_mut().map(|eyes| eyes.sample(now))
    }
}
