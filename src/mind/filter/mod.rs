//! Inference of the human's belief, event by event: a product of Dirichlets over the state aspects (paper, section
//! "Inference of the human belief").
//!
//! [`ConditionalFilter`] estimates the belief for given rates of reading and looking. [`BeliefFilter`] is what the rest
//! of the program uses: one such filter, or, where the attention of the person is learned, one for each possible
//! attention (see [`super::attention_posterior`]), with the mixture of their estimates.

pub mod conditional_filter;
mod distinct;
mod distinct_draws;
mod evidence;
mod evidence_model;
mod exchange;
mod gamma;
mod human_act;
mod look_news;
mod moments;
pub mod order_focus;
mod own_press;
mod perception;
mod robot_press;
mod serving;
pub mod signals_so_far;
mod unknown_gaze;
mod unseen_looks;
pub mod urn;

use std::sync::{Arc, OnceLock};

use super::attention_posterior::{AttentionPosterior, with_attention};
use super::dirichlet::DirichletBelief;
use super::model::HumanModel;
use super::observation::{Observation, ObservedEvidence};
use super::signal_model::SignalReadingForecast;
use crate::base::time::SessionTime;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, Kitchen, Press};
use conditional_filter::ConditionalFilter;
pub use evidence::PressEvidence;
use signals_so_far::EndedSignal;

/// The recursive estimator of the human's belief.
#[derive(Clone, Debug)]
pub struct BeliefFilter {
    /// One filter for each possible attention.
    filters: Vec<ConditionalFilter>,
    attention: AttentionPosterior,
    /// The present mixture of the filters' estimates, once it has been asked for since the last observation.
    mixture: OnceLock<DirichletBelief>,
    evidence: Option<PressEvidence>,
}

impl BeliefFilter {
    /// A filter with the estimate before the trial's start.
    pub fn new(kitchen: Arc<Kitchen>, model: HumanModel, seed: u64) -> BeliefFilter {
        let attention = AttentionPosterior::for_model(&model);
        let filter = |&times: &f64| ConditionalFilter::new(kitchen.clone(), with_attention(&model, times), seed);
        let filters = attention.times().iter().map(filter).collect();
        BeliefFilter { filters, attention, mixture: OnceLock::new(), evidence: None }
    }

    /// The present estimate of the human's belief.
    pub fn belief(&self) -> &DirichletBelief {
        match &self.filters[..] {
            [only] => only.belief(),
            _ => self.mixture.get_or_init(|| self.mixed(|filter| filter.belief().clone())),
        }
    }

    /// Likelihood and effective sample size of the human's last press.
    pub fn evidence(&self) -> Option<PressEvidence> {
        self.evidence
    }

    /// The expected share of presses that slip: as learned in this trial, or else the human model's.
    pub fn lapse(&self) -> f64 {
        self.weighted().map(|(p, filter)| p * filter.lapse()).sum()
    }

    /// The probability of each order focus of this person ([`order_focus::OrderFocus`]).
    pub fn order_focus(&self) -> Vec<f64> {
        let mut expected = vec![0.0; self.filters[0].order_focus().len()];
        for (p, filter) in self.weighted() {
            expected.iter_mut().zip(filter.order_focus()).for_each(|(sum, of)| *sum += p * of);
        }
        expected
    }

    /// How attentive this person is.
    pub fn attention(&self) -> &AttentionPosterior {
        &self.attention
    }

    /// Updates the estimate with one observation. The random stream depends on the seed and the number of presses only.
    pub fn observe(&mut self, observation: &Observation, cost: &mut CostToGo) {
        self.mixture.take();
        self.filters.iter_mut().for_each(|filter| filter.observe(observation, cost));
        match observation.what {
            ObservedEvidence::Started { .. } => self.attention.restart(),
            ObservedEvidence::Pressed(Press { agent: Agent::Human, .. }) => self.learn_attention(),
            _ => {}
        }
    }

    /// Accounts for unknown gaze up to `now`, which the estimate before a press includes; [`BeliefFilter::observe`]
    /// does the same first, so a call of this function changes no later estimate.
    pub fn advance(&mut self, now: SessionTime, cost: &mut CostToGo) {
        self.mixture.take();
        self.filters.iter_mut().for_each(|filter| filter.advance(now, cost));
    }

    /// The estimate at `now`, including unknown gaze and forgetting since the last event. The call changes no later
    /// estimate.
    pub fn at(&self, now: SessionTime, cost: &mut CostToGo) -> DirichletBelief {
        self.mixed(|filter| filter.at(now, cost))
    }

    /// The estimate at `now` in which the signal on the display has been read as far as is to be expected: the same
    /// advice must not be given twice because the first signal has not been read yet. `is_current`: no time has passed
    /// since the last observation.
    pub fn foreseen(&self, now: SessionTime, is_current: bool, cost: &mut CostToGo) -> DirichletBelief {
        self.mixed(|filter| {
            let belief = if is_current { filter.belief().clone() } else { filter.at(now, cost) };
            filter.foreseen(now, belief)
        })
    }

    /// The forecast of how a signal that is shown now will be read.
    pub fn forecast(&self) -> SignalReadingForecast {
        let mut expected = SignalReadingForecast { recipe: 0.0, highlight: 0.0, delay_s: 0.0 };
        for (p, filter) in self.weighted() {
            let SignalReadingForecast { recipe, highlight, delay_s } = filter.forecast();
            expected.recipe += p * recipe;
            expected.highlight += p * highlight;
            // The delay is the human model's, and the same for every attention.
            expected.delay_s = delay_s;
        }
        expected
    }

    /// The signal that has left the display since the last call of this function; `None` if none has.
    pub fn take_signal_over(&mut self) -> Option<EndedSignal> {
        let mut over: Option<EndedSignal> = None;
        for (p, filter) in self.attention.probabilities().iter().zip(&mut self.filters) {
            if let Some(EndedSignal { location, read }) = filter.take_signal_over() {
                over.get_or_insert(EndedSignal { location, read: 0.0 }).read += p * read;
            }
        }
        over
    }

    /// The filters with the probabilities of their attentions.
    fn weighted(&self) -> impl Iterator<Item = (f64, &ConditionalFilter)> {
        self.attention.probabilities().iter().copied().zip(&self.filters)
    }

    /// The mixture of one estimate of each filter, as one product of Dirichlets with the same means and second moments.
    fn mixed(&self, mut estimate: impl FnMut(&ConditionalFilter) -> DirichletBelief) -> DirichletBelief {
        let (mut total, mut mixed) = (self.attention.probabilities()[0], estimate(&self.filters[0]));
        for (p, filter) in self.weighted().skip(1) {
            total += p;
            mixed.mix(p / total, &estimate(filter));
        }
        mixed
    }

    /// Updates evidence and attention by a press of the human that all filters have just observed.
    fn learn_attention(&mut self) {
        let found: Vec<PressEvidence> = self.filters.iter().filter_map(ConditionalFilter::evidence).collect();
        let [_, _, ..] = found[..] else { return self.evidence = found.first().copied() };
        let before = self.attention.probabilities().to_vec();
        let logs: Vec<f64> = found.iter().map(|one| one.log_p).collect();
        self.attention.learn(&logs);
        let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let relative: f64 = before.iter().zip(&logs).map(|(p, log)| p * (log - most).exp()).sum();
        // The filters share random numbers, so their samples are not independent: the harmonic mean is no larger than
        // the largest of the filters' sizes.
        let after = self.attention.probabilities().iter().zip(&found);
        self.evidence = Some(PressEvidence {
            log_p: most + relative.ln(),
            beliefs: found.iter().map(|one| one.beliefs).sum(),
            effective: 1.0 / after.map(|(p, one)| p / one.effective).sum::<f64>(),
        });
    }
}
