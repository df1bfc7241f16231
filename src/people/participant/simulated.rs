//! Data of a simulated participant: traits, beliefs, plan, and the times of the participant's next actions.

use std::sync::Arc;

use super::attention::LookQueue;
use super::decision::ParticipantPlan;
use super::eyes::Eyes;
use super::habits::{Habits, Lapses};
use super::knowledge::TaskKnowledge;
use super::memory::RecipeMemory;
use super::population::{Experience, ParticipantTraits, Population};
use super::signal_sense::SignalSense;
use super::true_beliefs::ParticipantBeliefs;
use tomcom_core::base::rng::{Stream, of_trial, stream};
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::{ButtonId, Kitchen, LocationId, State, World};
use tomcom_core::mind::RecordedBelief;

/// Probability with which the simulated participant believes that the kitchen is empty at the start of a trial.
const SURE_AT_START: f64 = 0.97;

/// Action of a simulated participant.
#[derive(Clone, Debug, PartialEq)]
pub enum ParticipantAction {
    /// A gaze sample of the participant's simulated eye tracker.
    Gaze(GazeSample),
    /// A press of a button; `belief` records the participant's beliefs at the press and the cause of the press.
    Press {
        /// The pressed button, as an index into the human's buttons.
        button: ButtonId,
        /// The participant's beliefs at the press, and the cause of the press.
        belief: RecordedBelief,
    },
}

/// A simulated participant in one trial.
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
    /// Time of the robot's last press.
    pub(super) robot_pressed_at: SessionTime,
    /// The button that the participant intended, if the last press was a slip that went unnoticed; else `None`.
    pub(super) meant: Option<ButtonId>,
    pub(super) signals: SignalSense,
    /// What the participant believed when the participant no longer knew how to go on; `None` if the participant knows.
    pub(super) stuck_in: Option<World>,
    /// Seed of the random numbers with which the participant answers probes.
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

    /// Individual traits of this simulated participant.
    pub fn person(&self) -> &ParticipantTraits {
        &self.person
    }

    /// Present beliefs of the simulated participant.
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

    /// Postpones all planned actions of the participant by `by`.
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
