//! ToM: the communication concept with theory of mind, but without planning. ToM sends signals about false or uncertain
//! beliefs, whether the beliefs matter now or not (paper, "Concept comparisons"; Buehler and Weisswange 2018).
//!
//! ToM has the paper's signals: the recipe of an order, and highlights of the places where both agents get into each
//! other's way, the robot's hand and the assembly board. Among those that can be sent, the one whose aspect has the
//! largest expected belief deviation, 1 - E[P(truth)], is recommended if that deviation exceeds a threshold (0.4 to
//! 0.99 in the paper).

use std::sync::Arc;

use super::concept::{Concept, DecisionPoint};
use super::recommendation::{Recommendation, SignalOption, SignalReason, aspects_told};
use super::signal::{HighlightSet, Signal, unavailable};
use crate::kitchen::Kitchen;
use crate::kitchen::cost_to_go::CostToGo;
use crate::mind::recorded_estimate::rounded;

/// The ToM concept: signals about the aspect with the largest expected belief deviation.
#[derive(Clone, Debug)]
pub struct TomConcept {
    kitchen: Arc<Kitchen>,
    threshold: f64,
}

impl TomConcept {
    /// A ToM concept with this threshold of the expected belief deviation, a probability.
    pub fn new(kitchen: Arc<Kitchen>, threshold: f64) -> TomConcept {
        TomConcept { kitchen, threshold }
    }

    /// Whether the paper has this signal.
    fn is_of_paper(&self, signal: &Signal) -> bool {
        match signal {
            Signal::ShowRecipe(_) => true,
            Signal::Highlight(_) => {
                let highlights = HighlightSet::of_paper(&self.kitchen);
                signal.location(&self.kitchen).is_some_and(|location| highlights.holds(location))
            }
            Signal::Propose(_) => false,
        }
    }

    /// Largest expected belief deviation among the state aspects that a signal shows.
    fn deviation(&self, moment: &DecisionPoint, signal: &Signal) -> f64 {
        let (kitchen, state, belief) = (&self.kitchen, moment.situation.state, moment.situation.belief);
        let aspects = aspects_told(kitchen, state, signal).into_iter();
        aspects.map(|aspect| 1.0 - belief.p_truth(kitchen, state, aspect)).fold(0.0, f64::max)
    }
}

impl Concept for TomConcept {
    /// The advice of ToM: a signal's benefit is the expected belief deviation; the net benefit is the deviation minus
    /// the threshold.
    fn advise(&mut self, _: &mut CostToGo, moment: &DecisionPoint) -> Recommendation {
        let (kitchen, state) = (&self.kitchen, moment.situation.state);
        let of_paper = moment.signals.iter().filter(|signal| self.is_of_paper(signal));
        let possible = of_paper.filter(|signal| unavailable(kitchen, state, signal).is_none());
        let mut ranked: Vec<(f64, &Signal)> = possible.map(|signal| (self.deviation(moment, signal), signal)).collect();
        // The sort is stable, so that signals with equal deviations keep the layout's order.
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
            reason: best
                .and_then(|(_, signal)| SignalReason::for_signal(kitchen, state, moment.situation.belief, signal)),
            ..Recommendation::silent(moment.seq, moment.time)
        }
    }
}
