//! A simulated participant: who it is, what it has in mind, and what it is about to do.

use std::sync::Arc;

use super::attention::Attention;
use super::beliefs::ParticipantBeliefs;
use super::decision::Intent;
use super::eyes::Eyes;
use super::memory::Memory;
use super::population::{Experience, Individual, Population};
use crate::base::rng::{Stream, stream};
use crate::base::time::SessionTime;
use crate::communication::Signal;
use crate::gaze::GazeSample;
use crate::kitchen::{ButtonId, Kitchen, LocationId, State};
use crate::mind::BeliefWitness;

/// Belief in what the empty kitchen looks like at the start.
const SURE_AT_START: f64 = 0.97;

/// Something that the participant does.
#[derive(Clone, Debug, PartialEq)]
pub enum ParticipantAction {
    /// What an eye tracker sees of it.
    Gaze(GazeSample),
    /// It presses a button; `belief` is what it believes at this moment, and why it presses.
    Press { button: ButtonId, belief: BeliefWitness },
}

/// A simulated participant in one trial.
#[derive(Clone, Debug)]
pub struct SimulatedParticipant {
    pub(super) kitchen: Arc<Kitchen>,
    pub(super) population: Population,
    pub(super) person: Individual,
    pub(super) beliefs: ParticipantBeliefs,
    pub(super) memory: Memory,
    pub(super) eyes: Eyes,
    /// While the calibration is checked.
    pub(super) at_targets: Option<Eyes>,
    pub(super) attention: Attention,
    pub(super) intent: Intent,
    /// The mind's chances: attention, reading, thinking; and the hand's: times and slips.
    pub(super) mind: Stream,
    pub(super) hand: Stream,
    pub(super) is_started: bool,
    /// The display as it was when changes were last looked out for.
    pub(super) display: State,
    pub(super) rethink: bool,
    pub(super) press_at: SessionTime,
    pub(super) presses: u32,
    pub(super) looks_first: u32,
    pub(super) idle_since: Option<SessionTime>,
    /// When the robot last pressed something.
    pub(super) robot_pressed_at: SessionTime,
    /// The press under way: what was meant, if the person takes it for done.
    pub(super) meant: Option<ButtonId>,
    pub(super) signal: Option<(SessionTime, LocationId, Signal)>,
    /// Orders that were served and will be gone at this time.
    pub(super) clearing: Vec<(SessionTime, LocationId)>,
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
}
