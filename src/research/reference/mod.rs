//! The reference filter: inference of the human's belief implemented directly from the equations, without optimisation,
//! for tests and benchmarks. It shares with [`tomcom_core::mind::filter`] only the parameters, the kitchen's rules, the robot's
//! policy, the cost to go, and the accounting of known and unknown gaze time.
//!
//! A set of explicit beliefs is drawn from the Dirichlets, every component by a gamma variate. Each event updates every
//! belief by the human model ([`person`]); a press of the human weights the beliefs by p(a | b). Then the beliefs are
//! projected onto Dirichlets by moment matching, and drawn anew. Gaze samples update the explicit beliefs as well;
//! several samples in a row are projected together, which is equivalent, since they change first and second moments
//! linearly.

pub mod belief_set;
pub mod looks;
pub mod person;
pub mod planner;

use std::sync::Arc;

use rand::RngExt;

use self::belief_set::ParticleSet;
use self::person::Particle;
use tomcom_core::base::rng::{Stream, stream};
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, Kitchen};
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_core::mind::model::HumanModel;
use tomcom_core::mind::observation::{Observation, ObservedEvidence};

/// The reference estimator of the human's belief without optimisations, to check the optimised filter.
#[derive(Clone, Debug)]
pub struct ReferenceFilter {
    kitchen: Arc<Kitchen>,
    /// Number of belief samples that the filter draws.
    beliefs: usize,
    seed: u64,
    people: ParticleSet,
    /// Number of observations so far, which seeds the random stream.
    observed: u64,
    /// Whether gaze samples have updated the beliefs since they were last drawn.
    looked: bool,
    log_p: Option<f64>,
}

impl ReferenceFilter {
    /// A reference filter with the estimate before the trial's start.
    pub fn new(kitchen: Arc<Kitchen>, model: HumanModel, seed: u64) -> ReferenceFilter {
        let beliefs = model.inference.beliefs;
        ReferenceFilter {
            people: ParticleSet::new(kitchen.clone(), model),
            kitchen,
            beliefs,
            seed,
            observed: 0,
            looked: false,
            log_p: None,
        }
    }

    /// The present estimate of the human's belief.
    pub fn belief(&self) -> DirichletBelief {
        match self.people.of.is_empty() {
            true => self.people.prior.clone(),
            false => self.people.projected(&vec![1.0; self.people.of.len()]),
        }
    }

    /// ln p of the human's last press, given that a button is pressed, under the estimate before that press, in nats.
    pub fn log_p(&self) -> Option<f64> {
        self.log_p
    }

    /// Updates the estimate with one observation. The random stream depends on the seed and the number of observations
    /// only.
    pub fn observe(&mut self, observation: &Observation, cost: &mut CostToGo) {
        self.observed += 1;
        let mut random = stream(self.seed, "reference", self.observed);
        if let ObservedEvidence::Started { state } = observation.what {
            self.people.start(observation.time, state, self.beliefs, &mut random);
            return;
        }
        let is_gaze = matches!(observation.what, ObservedEvidence::Gaze { .. });
        if self.looked && !is_gaze {
            self.project(&vec![1.0; self.people.of.len()], &mut random);
        }
        let weights = self.people.experience(observation, cost, &mut random);
        self.looked = is_gaze;
        if matches!(observation.what, ObservedEvidence::Pressed(press) if press.agent == Agent::Human) {
            self.log_p = Some((weights.iter().sum::<f64>() / weights.len() as f64).ln());
        }
        if !is_gaze {
            self.project(&weights, &mut random);
        }
    }

    /// Projects the weighted explicit beliefs onto Dirichlets.
    fn project(&mut self, weights: &[f64], random: &mut Stream) {
        if !self.people.of.is_empty() {
            let estimate = self.people.projected(weights);
            self.draw(&estimate, weights, random);
            self.people.doubt = estimate;
        }
    }

    /// Draws all explicit beliefs anew; the number of beliefs that have read each location in the present look is
    /// preserved, and so is the weighted share that has read the signal on the display.
    fn draw(&mut self, estimate: &DirichletBelief, weights: &[f64], random: &mut Stream) {
        let with_signal = self.people.share_with_signal(weights);
        let count = self.people.of.len() as f64;
        let read = |index: usize| self.people.of.iter().filter(|person| person.read[index]).count() as f64 / count;
        let read: Vec<f64> = (0..self.kitchen.locations.len()).map(read).collect();
        let person = |random: &mut Stream| {
            let mut person = Particle::draw(&self.kitchen, estimate, random);
            person.read = read.iter().map(|&share| random.random::<f64>() < share).collect();
            person.read_signal = with_signal > 0.0 && random.random::<f64>() < with_signal;
            person
        };
        let people = (0..self.beliefs).map(|_| person(random)).collect();
        self.people.replace(people);
    }
}
