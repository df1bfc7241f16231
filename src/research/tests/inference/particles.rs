//! The unprojected filter: explicit beliefs that are kept from event to event and weighed by every press; no Dirichlet ever
//! stands for them. A bootstrap particle filter (Gordon et al. 1993) with systematic resampling.

use std::sync::Arc;

use rand::RngExt;
use tomcom_core::base::rng::{Stream, stream};
use tomcom_core::kitchen::Kitchen;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::mind::model::HumanModel;
use tomcom_core::mind::observation::{Observation, ObservedEvidence};
use tomcom_research::reference::belief_set::ParticleSet;

pub struct ParticleFilter {
    pub people: ParticleSet,
    pub weights: Vec<f64>,
    count: usize,
    chance: Stream,
}

impl ParticleFilter {
    pub fn new(kitchen: &Arc<Kitchen>, model: &HumanModel, count: usize, seed: u64, index: u64) -> ParticleFilter {
        let people = ParticleSet::new(kitchen.clone(), model.clone());
        ParticleFilter { people, weights: Vec::new(), count, chance: stream(seed, "particles", index) }
    }

    pub fn observe(&mut self, observation: &Observation, cost: &mut CostToGo) {
        if let ObservedEvidence::Started { state } = observation.what {
            self.people.start(observation.time, state, self.count, &mut self.chance);
            self.weights = vec![1.0 / self.count as f64; self.count];
            return;
        }
        let likelihoods = self.people.experience(observation, cost, &mut self.chance);
        self.weights.iter_mut().zip(&likelihoods).for_each(|(weight, p)| *weight *= p);
        let total: f64 = self.weights.iter().sum();
        self.weights.iter_mut().for_each(|weight| *weight /= total);
        let effective = 1.0 / self.weights.iter().map(|weight| weight * weight).sum::<f64>();
        if effective < self.count as f64 / 2.0 {
            self.resample();
        }
    }

    /// Expected probabilities, by aspect and value.
    pub fn mean(&self) -> Vec<Vec<f64>> {
        let mut mean: Vec<Vec<f64>> = self.people.of[0].of.iter().map(|values| vec![0.0; values.len()]).collect();
        for (person, weight) in self.people.of.iter().zip(&self.weights) {
            for (sums, values) in mean.iter_mut().zip(&person.of) {
                sums.iter_mut().zip(values).for_each(|(sum, p)| *sum += weight * p);
            }
        }
        mean
    }

    fn resample(&mut self) {
        let step = 1.0 / self.count as f64;
        let mut point = step * self.chance.random::<f64>();
        let (mut sum, mut kept) = (0.0, Vec::with_capacity(self.count));
        for (person, weight) in self.people.of.iter().zip(&self.weights) {
            sum += weight;
            while point < sum && kept.len() < self.count {
                kept.push(person.clone());
                point += step;
            }
        }
        while kept.len() < self.count {
            kept.push(kept[kept.len() - 1].clone());
        }
        self.people.of = kept;
        self.weights = vec![step; self.count];
    }
}
