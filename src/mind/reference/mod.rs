//! The reference filter: inference of the human's belief implemented directly from the equations, without optimisation,
//! for tests and benchmarks. It shares with [`super::filter`] only the parameters, the kitchen's rules, the robot's
//! policy, the cost to go, and the accounting of known and unknown gaze time.
//!
//! Where the attention of the person is learned, there is a [`ConditionalReference`] for each possible attention, and
//! the estimate has mean and second moment of their mixture.

pub mod belief_set;
pub mod conditional_reference;
pub mod order_focus;
pub mod person;
pub mod plausible_looks;
pub mod reading_effect;
pub mod signal_reading;

use std::sync::Arc;

use self::conditional_reference::ConditionalReference;
use super::attention_posterior::{ATTENTIONS, RETURNING, with_attention};
use super::dirichlet::{Dirichlet, DirichletBelief};
use super::model::HumanModel;
use super::observation::{Observation, ObservedEvidence};
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, Kitchen, Press};

/// The reference estimator of the human's belief without optimisations, to check the optimised filter.
#[derive(Clone, Debug)]
pub struct ReferenceFilter {
    /// For each possible attention its probability before the first press, its probability now, and the filter of a
    /// human with that attention.
    of: Vec<(f64, f64, ConditionalReference)>,
    log_p: Option<f64>,
}

impl ReferenceFilter {
    /// A reference filter with the estimate before the trial's start.
    pub fn new(kitchen: Arc<Kitchen>, model: HumanModel, seed: u64) -> ReferenceFilter {
        let possible = if model.adapt.attention { ATTENTIONS.to_vec() } else { vec![(1.0, 1.0)] };
        let filter = |(times, p): (f64, f64)| {
            (p, p, ConditionalReference::new(kitchen.clone(), with_attention(&model, times), seed))
        };
        ReferenceFilter { of: possible.into_iter().map(filter).collect(), log_p: None }
    }

    /// The present estimate of the human's belief.
    pub fn belief(&self) -> DirichletBelief {
        let beliefs: Vec<(f64, DirichletBelief)> = self.of.iter().map(|(_, p, filter)| (*p, filter.belief())).collect();
        let mixed = |index: usize| {
            let mut mean = vec![0.0; beliefs[0].1.aspects[index].mean().len()];
            for (p, belief) in &beliefs {
                mean.iter_mut().zip(belief.aspects[index].mean()).for_each(|(sum, m)| *sum += p * m);
            }
            let second = beliefs.iter().map(|(p, belief)| p * belief.aspects[index].second()).sum();
            Dirichlet::of_moments(mean, second)
        };
        DirichletBelief { aspects: (0..beliefs[0].1.aspects.len()).map(mixed).collect() }
    }

    /// ln p of the human's last press, given that a button is pressed, under the estimate before that press, in nats.
    pub fn log_p(&self) -> Option<f64> {
        self.log_p
    }

    /// The expected share of presses that slip.
    pub fn lapse(&self) -> f64 {
        self.of.iter().map(|(_, p, filter)| p * filter.lapse()).sum()
    }

    /// The probability of each possible attention.
    pub fn attention(&self) -> Vec<f64> {
        self.of.iter().map(|(_, p, _)| *p).collect()
    }

    /// Updates the estimate with one observation. The random stream depends on the seed and the number of observations
    /// only.
    pub fn observe(&mut self, observation: &Observation, cost: &mut CostToGo) {
        for (_, _, filter) in &mut self.of {
            filter.observe(observation, cost);
        }
        match observation.what {
            ObservedEvidence::Started { .. } => self.of.iter_mut().for_each(|(prior, p, _)| *p = *prior),
            ObservedEvidence::Pressed(Press { agent: Agent::Human, .. }) => {
                // Bayes' rule, then a share of the probability returns to the prior.
                let joint =
                    |(_, p, filter): &(f64, f64, ConditionalReference)| p * filter.log_p().map_or(1.0, f64::exp);
                let joint: Vec<f64> = self.of.iter().map(joint).collect();
                let total: f64 = joint.iter().sum();
                for ((prior, p, _), joint) in self.of.iter_mut().zip(joint) {
                    *p = (1.0 - RETURNING) * joint / total + RETURNING * *prior;
                }
                self.log_p = Some(total.ln());
            }
            _ => {}
        }
    }
}
