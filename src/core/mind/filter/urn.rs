//! Polya urns: draws from a categorical distribution that is itself a draw from a Dirichlet, without drawing that
//! categorical distribution.
//!
//! The first draw follows the Dirichlet's mean; the n-th draw repeats one of the previous draws with the probability
//! (n - 1) / (A + n - 1). Given the draws, the distribution is Dir(alpha + counts) (Blackwell and MacQueen 1973).

use rand::RngExt;

use crate::base::rng::Stream;
use crate::mind::dirichlet::Dirichlet;

/// In aspects with at least [`MANY`] values, the values with a smaller expected probability than this form the tail,
/// which one of them represents.
const TAIL: f64 = 0.01;
const MANY: usize = 8;

/// The Polya urn of one state aspect. One of the improbable values (the tail) represents the tail, drawn anew for every
/// urn in proportion to the probabilities: over time every value is used, while each press evaluates few improbable
/// worlds.
#[derive(Clone, Debug, Default)]
pub struct PolyaUrn {
    /// The value that represents the tail of improbable values; `None` without a tail.
    stand_in: Option<u8>,
    /// Values in decreasing order of probability, with cumulative probabilities.
    order: Vec<(u8, f64)>,
    /// Values with cumulative probabilities for first draws, where first draws are not drawn from the mean.
    proposal: Vec<(u8, f64)>,
    /// `stays[k]`: probability that each of the draws 1 to k repeats an earlier draw (draw 0 is the first).
    stays: Vec<f64>,
}

impl PolyaUrn {
    /// Prepares the urn for `draws` draws from a distribution that this Dirichlet gives.
    pub fn fill(&mut self, dirichlet: &Dirichlet, draws: usize, random: &mut Stream) {
        let mean = dirichlet.mean();
        self.order.clear();
        self.proposal.clear();
        self.order.extend(
            (0..mean.len()).filter(|&value| !PolyaUrn::is_tail(mean, value)).map(|value| (value as u8, mean[value])),
        );
        let tail = || (0..mean.len()).filter(|&value| PolyaUrn::is_tail(mean, value));
        let of_tail: f64 = tail().map(|value| mean[value]).sum();
        let mut left = random.random::<f64>() * of_tail;
        let chosen = tail().find(|&value| {
            left -= mean[value];
            left < 0.0
        });
        self.stand_in = chosen.or(tail().next_back()).map(|value| value as u8);
        self.order.extend(self.stand_in.map(|value| (value, of_tail)));
        self.order.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let mut sum = 0.0;
        for (_, p) in &mut self.order {
            sum += *p;
            *p = sum;
        }
        self.stays.clear();
        let mut stays = 1.0;
        for drawn in 0..draws {
            if drawn > 0 {
                stays *= drawn as f64 / (dirichlet.precision() + drawn as f64);
            }
            self.stays.push(stays);
        }
    }

    /// The value that represents the tail of improbable values; `None` without a tail.
    pub fn stand_in(&self) -> Option<usize> {
        self.stand_in.map(usize::from)
    }

    /// Whether a value belongs to the tail of a distribution with these expected probabilities.
    pub fn is_tail(mean: &[f64], value: usize) -> bool {
        mean.len() > MANY && mean[value] < TAIL
    }

    /// The value at a point, from 0 to 1, of the cumulative mean.
    #[inline]
    fn value_at(&self, point: f64) -> u8 {
        let reached = self.order.iter().find(|(_, sum)| point < *sum);
        reached.or(self.order.last()).map_or(0, |(value, _)| *value)
    }

    /// A first draw of a value, from the Dirichlet's mean.
    #[inline]
    pub fn draw(&self, random: &mut Stream) -> u8 {
        self.value_at(random.random::<f64>())
    }

    /// Makes first draws come from a mixture: evenly from all values with probability `share`, else from the mean.
    /// Returns the importance weight of a draw of each value.
    pub fn spread(&mut self, share: f64) -> Vec<f64> {
        let values = self.order.iter().map(|(value, _)| usize::from(*value) + 1).max().unwrap_or(0);
        let mut counts = vec![1.0; values];
        let (even, mut last, mut sum) = (1.0 / self.order.len() as f64, 0.0, 0.0);
        self.proposal.clear();
        for &(value, cumulated) in &self.order {
            let p = cumulated - last;
            let drawn = (1.0 - share) * p + share * even;
            (last, sum) = (cumulated, sum + drawn);
            counts[usize::from(value)] = p / drawn;
            self.proposal.push((value, sum));
        }
        counts
    }

    /// First draws for many samples by stratified sampling from the mean (or from the mixture of [`PolyaUrn::spread`]),
    /// in random order.
    pub fn first_draws(&self, random: &mut Stream, out: &mut [u8]) {
        let from = if self.proposal.is_empty() { &self.order } else { &self.proposal };
        let step = 1.0 / out.len() as f64;
        let offset = random.random::<f64>();
        let mut at = 0;
        for (index, first) in out.iter_mut().enumerate() {
            let point = (index as f64 + offset) * step;
            while at + 1 < from.len() && point >= from[at].1 {
                at += 1;
            }
            *first = from[at].0;
        }
        for last in (1..out.len()).rev() {
            out.swap(last, random.random_range(0..=last));
        }
    }

    /// Fills `drawn` with the draws that follow the first one. Returns true if all draws are equal; then the content of
    /// `drawn` is undefined.
    #[inline]
    pub fn draw_on(&self, random: &mut Stream, first: u8, drawn: &mut [u8]) -> bool {
        let mut next_new = self.next_new(random, 0);
        let (other, value) = loop {
            if next_new == drawn.len() {
                return true;
            }
            let index = next_new;
            next_new = self.next_new(random, index);
            let value = self.draw(random);
            if value != first {
                break (index, value);
            }
        };
        drawn[..other].fill(first);
        drawn[other] = value;
        for index in other + 1..drawn.len() {
            drawn[index] = if index == next_new {
                next_new = self.next_new(random, index);
                self.draw(random)
            } else {
                drawn[random.random_range(0..index)]
            };
        }
        false
    }

    /// Index of the next draw after draw `after` that does not repeat a previous draw.
    #[inline]
    fn next_new(&self, random: &mut Stream, after: usize) -> usize {
        let limit = random.random::<f64>() * self.stays[after];
        if self.stays[self.stays.len() - 1] > limit {
            return self.stays.len();
        }
        (after + 1..self.stays.len()).find(|&draw| self.stays[draw] <= limit).unwrap_or(self.stays.len())
    }
}

/// The value at a point, from 0 to 1, of a cumulative distribution with these probabilities.
pub fn value_at(distribution: &[f64], point: f64) -> u8 {
    let mut left = point;
    let reached = distribution.iter().position(|p| {
        left -= p;
        left < 0.0
    });
    reached.unwrap_or(distribution.len() - 1) as u8
}
