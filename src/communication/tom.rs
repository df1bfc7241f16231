//! ToM: theory of mind without planning. Says what is believed wrong or not known, whether that matters now or not (paper,
//! "Concept comparisons"; Buehler and Weisswange 2018).
//!
//! Of all that can be told, the aspect with the largest expected deviation of the belief, 1 - E[P(truth)], is told if that
//! passes a threshold (0.4 to 0.99 in the paper). An aspect that no signal is about cannot be told: the own hand, unless the
//! session allows it, and the recipes of dishes that no order wants.

use std::sync::Arc;

use super::concept::{Concept, DecisionPoint};
use super::recommendation::{Reason, Recommendation, SignalOption, aspects_told};
use super::signal::{Signal, unavailable};
use crate::kitchen::Kitchen;
use crate::kitchen::cost_to_go::CostToGo;
use crate::mind::witness::rounded;

/// Tells what deviates most.
#[derive(Clone, Debug)]
pub struct TomConcept {
    kitchen: Arc<Kitchen>,
    threshold: f64,
}

impl TomConcept {
    /// Speaks where the expected deviation of a belief is above `threshold`, a probability.
    pub fn new(kitchen: Arc<Kitchen>, threshold: f64) -> TomConcept {
        TomConcept { kitchen, threshold }
    }

    /// The largest deviation among the aspects that a signal is about.
    fn deviation(&self, moment: &DecisionPoint, signal: &Signal) -> f64 {
        let (kitchen, state, belief) = (&self.kitchen, moment.situation.state, moment.situation.belief);
        let aspects = aspects_told(kitchen, state, signal).into_iter();
        aspects.map(|aspect| 1.0 - belief.p_truth(kitchen, state, aspect)).fold(0.0, f64::max)
    }
}

impl Concept for TomConcept {
    /// The options' benefits are deviations, and their net benefits what these are above the threshold.
    fn advise(&mut self, _: &mut CostToGo, moment: &DecisionPoint) -> Recommendation {
        let (kitchen, state) = (&self.kitchen, moment.situation.state);
        let possible = moment.signals.iter().filter(|signal| unavailable(kitchen, state, signal).is_none());
        let mut ranked: Vec<(f64, &Signal)> = possible.map(|signal| (self.deviation(moment, signal), signal)).collect();
        // The sort is stable: the first of equals is the first in the layout.
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        let best = ranked.first().filter(|(deviation, _)| *deviation > self.threshold);
        let option = |&(deviation, signal): &(f64, &Signal)| SignalOption {
            signal: signal.clone(),
            benefit: rounded(deviation),
            standard_error: 0.0,
            net: rounded(deviation - self.threshold),
            rollouts: 0,
        };
        Recommendation {
            options: ranked.iter().map(option).collect(),
            best: best.map(|(_, signal)| (*signal).clone()),
            reason: best.and_then(|(_, signal)| Reason::for_signal(kitchen, state, moment.situation.belief, signal)),
            ..Recommendation::silent(moment.seq, moment.time)
        }
    }
}
