//! How attentive this person is: a discrete posterior distribution over the attention, updated by every press of the
//! trial.
//!
//! The attention is a factor on the rates at which the human reads what the gaze is at, and at which the human looks at
//! places while the gaze is unknown. The belief depends on the attention through everything that the human has seen, so
//! there is no closed form: the belief filter follows one estimate for each possible attention (a bank of filters;
//! Magill 1965). The likelihood of an attention is that of the press under its estimate. All estimates use the same
//! random numbers, so that sampling noise hardly changes the ratio of their likelihoods.

use super::model::{HumanModel, LookingModel};

/// Possible attentions as multiples of the human model's rates, with their probabilities before the first press.
pub const ATTENTIONS: [(f64, f64); 3] = [(1.0 / 3.0, 0.25), (1.0, 0.5), (3.0, 0.25)];
/// Share of the probabilities that returns to those before the first press, at every press: no attention becomes
/// impossible, and evidence counts for some fifty presses.
pub const RETURNING: f64 = 0.02;

/// Posterior probabilities of the possible attentions of a person.
#[derive(Clone, Debug, PartialEq)]
pub struct AttentionPosterior {
    /// Each possible attention, as a multiple of the human model's rates.
    times: Vec<f64>,
    /// Probability of each attention before the first press.
    prior: Vec<f64>,
    /// Probability of each attention now.
    probabilities: Vec<f64>,
}

impl AttentionPosterior {
    /// The distribution before the first press. Where the model does not learn the attention, the human model's rates
    /// are certain.
    pub fn for_model(model: &HumanModel) -> AttentionPosterior {
        let possible: &[(f64, f64)] = if model.adapt.attention { &ATTENTIONS } else { &[(1.0, 1.0)] };
        let (times, prior): (Vec<f64>, Vec<f64>) = possible.iter().copied().unzip();
        AttentionPosterior { times, probabilities: prior.clone(), prior }
    }

    /// The possible attentions, as multiples of the human model's rates.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The probability of each possible attention, in the order of [`AttentionPosterior::times`].
    pub fn probabilities(&self) -> &[f64] {
        &self.probabilities
    }

    /// The expected attention on a logarithmic scale (geometric mean), as a multiple of the human model's rates. Before
    /// the first press it is 1. It changes gradually, where the most probable attention would jump.
    pub fn expected(&self) -> f64 {
        let logs = self.times.iter().zip(&self.probabilities).map(|(times, p)| p * times.ln());
        logs.sum::<f64>().exp()
    }

    /// Returns to the distribution before the first press.
    pub fn restart(&mut self) {
        self.probabilities.clone_from(&self.prior);
    }

    /// Updates the probabilities by a press with this log likelihood, in nats, under each attention. A press that is
    /// impossible under every attention changes nothing.
    pub fn learn(&mut self, log_likelihoods: &[f64]) {
        let most = log_likelihoods.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let weights: Vec<f64> =
            self.probabilities.iter().zip(log_likelihoods).map(|(p, log)| p * (log - most).exp()).collect();
        let total: f64 = weights.iter().sum();
        if !(total.is_finite() && total > 0.0) {
            return;
        }
        for ((p, weight), prior) in self.probabilities.iter_mut().zip(weights).zip(&self.prior) {
            *p = (1.0 - RETURNING) * weight / total + RETURNING * prior;
        }
    }
}

/// The human model of a person who reads and looks `times` as fast as the human of `model`.
pub fn with_attention(model: &HumanModel, times: f64) -> HumanModel {
    let mut own = model.clone();
    own.perception.reading_rate_hz *= times;
    let LookingModel { looks_hz, other_looks_hz, display_lost_looks_hz, .. } = &mut own.looking;
    for rate_hz in [looks_hz, other_looks_hz, display_lost_looks_hz] {
        *rate_hz *= times;
    }
    own
}

#[cfg(test)]
mod tests {
    use super::*;

    fn learning() -> AttentionPosterior {
        let mut model = HumanModel::default();
        model.adapt.attention = true;
        AttentionPosterior::for_model(&model)
    }

    #[test]
    fn the_expected_attention_begins_at_that_of_the_model_and_follows_the_evidence() {
        let mut attention = learning();
        assert!((attention.expected() - 1.0).abs() < 1e-12);
        attention.learn(&[-1.0, -2.0, -3.0]);
        assert!(attention.expected() < 1.0);
        attention.restart();
        assert_eq!(attention, learning());
    }

    #[test]
    fn no_attention_becomes_impossible_and_the_evidence_can_turn() {
        let mut attention = learning();
        (0..500).for_each(|_| attention.learn(&[-800.0, -900.0, -2000.0]));
        assert!(attention.probabilities()[0] > 0.9);
        assert!(attention.probabilities().iter().all(|p| *p >= RETURNING * 0.25 - 1e-12));
        (0..20).for_each(|_| attention.learn(&[-3.0, -2.0, -1.0]));
        assert!(attention.probabilities()[2] > 0.9, "{:?}", attention.probabilities());
    }

    #[test]
    fn what_is_no_likelihood_changes_nothing() {
        for logs in [[f64::NEG_INFINITY; 3], [f64::NAN; 3]] {
            let mut attention = learning();
            attention.learn(&logs);
            assert_eq!(attention, learning());
        }
    }
}
