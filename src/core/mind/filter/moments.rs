//! Accumulation of weighted belief samples of one state aspect, and their projection onto a Dirichlet by mean and
//! second moment.

use super::urn::PolyaUrn;
use crate::mind::dirichlet::Dirichlet;

/// Mean and second moment of a mixture of Dirichlets that share one prior, accumulated as changes to the prior's
/// moments.
pub struct MixtureMoments<'a> {
    prior: &'a Dirichlet,
    mean: Vec<f64>,
    second: f64,
    square: f64,
    /// Weight of the prior's mean, which is added at the end.
    share: f64,
    /// Total weight of the belief samples whose draws all have the same value, by value; the last entry is for samples
    /// in which the aspect was not drawn.
    pure: Vec<f64>,
    /// Distinct values of one belief sample, each with its number of draws.
    counts: Vec<(u8, u32)>,
}

impl MixtureMoments<'_> {
    /// Starts the accumulation with the moments of the prior.
    pub fn from_prior(prior: &Dirichlet) -> MixtureMoments<'_> {
        let mean = prior.mean().to_vec();
        let square = mean.iter().map(|m| m * m).sum();
        let pure = vec![0.0; mean.len() + 1];
        MixtureMoments { prior, mean, second: prior.second(), square, share: 0.0, pure, counts: Vec::new() }
    }

    /// Adds Dir(alpha + counts of the drawn values) with this weight; `draws` is the number of draws. The weights of
    /// all added distributions sum to 0.
    pub fn add(&mut self, drawn: impl Iterator<Item = (u8, u32)>, draws: usize, weight: f64) {
        self.counts.clear();
        for (value, times) in drawn {
            match self.counts.iter_mut().find(|(other, _)| *other == value) {
                Some((_, count)) => *count += times,
                None => self.counts.push((value, times)),
            }
        }
        let (precision, prior) = (self.prior.precision(), self.prior.mean());
        let size = precision + draws as f64;
        let (mut cross, mut squares) = (0.0, 0.0);
        for &(value, count) in &self.counts {
            let (value, count) = (usize::from(value), f64::from(count));
            self.mean[value] += weight * count / size;
            cross += prior[value] * count;
            squares += count * count;
        }
        self.add_moments(weight, size, cross, squares);
    }

    /// Adds a belief sample whose draws all have one value (or were not drawn): such samples are summed first and added
    /// to the moments at the end.
    #[inline]
    pub fn add_later(&mut self, value: u8, weight: f64) {
        let last = self.pure.len() - 1;
        self.pure[usize::from(value).min(last)] += weight;
    }

    /// Adds a belief that is certain of one value, with this weight.
    pub fn add_certain(&mut self, value: u8, weight: f64) {
        self.mean[usize::from(value)] += weight;
        self.second += weight;
    }

    fn add_pure(&mut self, value: usize, draws: usize, weight: f64) {
        if value == self.mean.len() {
            self.share += weight;
            self.second += weight * self.prior.second();
            return;
        }
        let draws = draws as f64;
        let size = self.prior.precision() + draws;
        self.mean[value] += weight * draws / size;
        self.add_moments(weight, size, self.prior.mean()[value] * draws, draws * draws);
    }

    fn add_moments(&mut self, weight: f64, size: f64, cross: f64, squares: f64) {
        let precision = self.prior.precision();
        // The contribution of the prior's alphas, which cancels where all samples have the same number of draws.
        self.share += weight * precision / size;
        let second = precision * precision * self.square + 2.0 * precision * cross + squares + size;
        self.second += weight * second / (size * (size + 1.0));
    }

    /// The Dirichlet with the accumulated moments. A gain of the value that represents the improbable values (tail)
    /// belongs to that value alone; a loss is shared by the whole tail in proportion to the probabilities.
    pub fn collapsed(mut self, draws: usize, stand_in: Option<usize>) -> Dirichlet {
        for value in 0..self.pure.len() {
            if self.pure[value] != 0.0 {
                self.add_pure(value, draws, self.pure[value]);
            }
        }
        let prior = self.prior.mean();
        self.mean.iter_mut().zip(prior).for_each(|(mean, p)| *mean += self.share * p);
        if let Some(value) = stand_in
            && self.mean[value] < prior[value]
        {
            let tail = || (0..prior.len()).filter(|&value| PolyaUrn::is_tail(prior, value));
            let of_tail: f64 = tail().map(|value| prior[value]).sum();
            let left = (1.0 + (self.mean[value] - prior[value]) / of_tail).max(0.0);
            tail().for_each(|value| self.mean[value] = left * prior[value]);
        }
        Dirichlet::of_moments(self.mean, self.second)
    }
}
