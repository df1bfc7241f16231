//! The estimate of a belief: a Dirichlet distribution over the values of every state aspect; the joint distribution is
//! the product of these.
//!
//! Each Dirichlet is stored as its mean and its precision (the sum of the alphas). Moment matching (Minka 2000)
//! preserves the mean and the pooled second moment S = sum_k E[b_k^2]; the precision follows as (1 - S) / (S - sum_k
//! m_k^2).

use super::model::PriorModel;
use crate::kitchen::{AspectId, AspectKind, ContentId, Kitchen, State};

/// Lower bound of a value's expected probability, which lets later evidence still raise the probability.
pub const LEAST_MEAN: f64 = 1e-7;
/// Lower and upper bound of a Dirichlet's precision (the sum of its alphas).
pub const PRECISIONS: [f64; 2] = [1e-3, 1e4];

/// A Dirichlet distribution over the values of one state aspect.
#[derive(Clone, Debug, PartialEq)]
pub struct Dirichlet {
    mean: Vec<f64>,
    precision: f64,
}

impl Dirichlet {
    /// A Dirichlet with this mean (weights of at least 0, in any scale) and this precision, both moved inside their
    /// bounds.
    pub fn new(mean: Vec<f64>, precision: f64) -> Dirichlet {
        let mut made = Dirichlet { mean, precision: 1.0 };
        made.put_right(precision);
        made
    }

    /// A Dirichlet with this mean and this pooled second moment.
    pub fn of_moments(mean: Vec<f64>, second: f64) -> Dirichlet {
        let mut made = Dirichlet { mean, precision: 1.0 };
        made.set_second(second);
        made
    }

    /// Expected probability of each value of the aspect.
    pub fn mean(&self) -> &[f64] {
        &self.mean
    }

    /// The precision of the Dirichlet: the sum of its parameters alpha.
    pub fn precision(&self) -> f64 {
        self.precision
    }

    /// The parameter alpha of one value: expected probability times precision.
    pub fn alpha(&self, value: usize) -> f64 {
        self.precision * self.mean[value]
    }

    /// The pooled second moment S = sum_k E[b_k^2] of the Dirichlet.
    pub fn second(&self) -> f64 {
        (self.precision * self.square() + 1.0) / (self.precision + 1.0)
    }

    /// Index of the value with the highest expected probability; ties go to the lowest index.
    pub fn most_likely(&self) -> usize {
        (1..self.mean.len()).fold(0, |best, value| if self.mean[value] > self.mean[best] { value } else { best })
    }

    fn square(&self) -> f64 {
        sum_of(&self.mean, |m| m * m)
    }

    /// With probability q = `share` the belief becomes certain of one value, drawn from the distribution c = `values`,
    /// otherwise the belief stays unchanged: m' = (1 - q) m + q c, S' = (1 - q) S + q.
    pub fn learn(&mut self, share: f64, values: impl IntoIterator<Item = f64>) {
        self.blend(share, values, 1.0);
    }

    /// Mixes this Dirichlet with another one over the same values, matching mean and second moment of the mixture.
    pub fn mix(&mut self, share: f64, other: &Dirichlet) {
        self.blend(share, other.mean.iter().copied(), other.second());
    }

    fn blend(&mut self, share: f64, values: impl IntoIterator<Item = f64>, second: f64) {
        let second = (1.0 - share) * self.second() + share * second;
        for (mean, value) in self.mean.iter_mut().zip(values) {
            *mean = (1.0 - share) * *mean + share * value;
        }
        self.set_second(second);
    }

    /// Moves all probability of the value `from` to the value `to`; the result is an exact Dirichlet.
    pub fn shift(&mut self, from: usize, to: usize) {
        self.mean[to] += std::mem::take(&mut self.mean[from]);
        self.put_right(self.precision);
    }

    /// Sets the Dirichlet's precision from a pooled second moment and the present mean.
    fn set_second(&mut self, second: f64) {
        let spread = second - self.square();
        let precision = if spread > 0.0 { (1.0 - second) / spread } else { PRECISIONS[1] };
        self.put_right(precision);
    }

    /// Normalises the Dirichlet's mean, and moves means and precision inside their bounds.
    fn put_right(&mut self, precision: f64) {
        for mean in &mut self.mean {
            // The function `max` also replaces a mean that is NaN.
            *mean = mean.max(LEAST_MEAN);
        }
        let total = sum_of(&self.mean, |m| m);
        let even = 1.0 / self.mean.len() as f64;
        for mean in &mut self.mean {
            *mean = if total.is_finite() { *mean / total } else { even };
        }
        self.precision = if precision >= PRECISIONS[0] { precision.min(PRECISIONS[1]) } else { PRECISIONS[0] };
    }
}

/// Sum of `of(value)` over all values, computed in four partial sums that the compiler vectorises, since every gaze
/// sample needs several such sums.
#[inline]
fn sum_of(values: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    let mut parts = [0.0; 4];
    let chunks = values.chunks_exact(4);
    let rest: f64 = chunks.remainder().iter().map(|&value| of(value)).sum();
    for chunk in chunks {
        parts.iter_mut().zip(chunk).for_each(|(part, &value)| *part += of(value));
    }
    (parts[0] + parts[1]) + (parts[2] + parts[3]) + rest
}

/// The estimate of what the human believes: one Dirichlet per state aspect, in the order of the kitchen's aspects.
#[derive(Clone, Debug, PartialEq)]
pub struct DirichletBelief {
    /// For each state aspect, in the kitchen's order, the Dirichlet over its values.
    pub aspects: Vec<Dirichlet>,
}

impl DirichletBelief {
    /// The estimate of the belief at the start of a trial, when the kitchen is in `state`.
    pub fn prior(kitchen: &Kitchen, prior: &PriorModel, state: State) -> DirichletBelief {
        let of = |index: usize| match kitchen.aspects[index].kind {
            AspectKind::Location(_) => {
                let aspect = AspectId(index as u8);
                let values = kitchen.aspects[index].values.len();
                let others = (1.0 - prior.location_truth) / (values - 1).max(1) as f64;
                let mut mean = vec![others; values];
                mean[kitchen.true_value(state, aspect)] = prior.location_truth;
                Dirichlet::new(mean, prior.location_precision)
            }
            AspectKind::Recipe(dish) => {
                let stack = kitchen.dish(dish).stack();
                let variants = &kitchen.aspects[index].values;
                let is_alike = |code: &u8| kitchen.content(stack).look_alikes.contains(&ContentId(*code));
                let alike = variants[1..].iter().filter(|code| is_alike(code)).count();
                let others = variants.len() - 1 - alike;
                let (to_alike, to_others) = match (alike, others) {
                    (0, _) => (0.0, 1.0),
                    (_, 0) => (1.0, 0.0),
                    _ => (prior.recipe_look_alike, 1.0 - prior.recipe_look_alike),
                };
                let left = 1.0 - prior.recipe_truth;
                let mean = variants.iter().enumerate().map(|(value, code)| match (value, is_alike(code)) {
                    (0, _) => prior.recipe_truth,
                    (_, true) => left * to_alike / alike as f64,
                    (_, false) => left * to_others / others as f64,
                });
                Dirichlet::new(mean.collect(), prior.recipe_precision)
            }
        };
        DirichletBelief { aspects: (0..kitchen.aspects.len()).map(of).collect() }
    }

    /// The Dirichlet distribution of this aspect.
    pub fn aspect(&self, aspect: AspectId) -> &Dirichlet {
        &self.aspects[aspect.index()]
    }

    /// Expected probability that the human's belief gives to the true value of an aspect.
    pub fn p_truth(&self, kitchen: &Kitchen, state: State, aspect: AspectId) -> f64 {
        self.aspect(aspect).mean()[kitchen.true_value(state, aspect)]
    }
}
