//! Polya urns: draws from a categorical distribution that is itself drawn from a Dirichlet, without drawing it.
//!
//! The first draw has the Dirichlet's mean; the n-th repeats one of those before it with probability (n - 1) / (A + n - 1).
//! Given the draws, the distribution is Dir(alpha + counts) (Blackwell and MacQueen 1973).

use rand::RngExt;

use crate::base::rng::Stream;
use crate::mind::dirichlet::Dirichlet;

/// Values with a smaller expected probability are the tail, where there are so many values: one of them stands for all.
const TAIL: f64 = 0.01;
const MANY: usize = 8;

/// The urn of one aspect. The values of its tail are drawn as one, which is chosen anew for every urn by their shares: so
/// each of them has its turn, and few strange states have to be thought through at a time.
#[derive(Clone, Debug, Default)]
pub struct Urn {
    /// The value that stands for the tail.
    stand_in: Option<u8>,
    /// Values, the likeliest first, and the chance that a draw is one of those up to it.
    order: Vec<(u8, f64)>,
    /// The same for first draws, where they do not come from the mean.
    proposal: Vec<(u8, f64)>,
    /// `stays[k]`: the chance that none of the draws 1 to k (the first is 0) is a new one.
    stays: Vec<f64>,
}

impl Urn {
    /// The urn of this Dirichlet, for `draws` draws.
    pub fn fill(&mut self, dirichlet: &Dirichlet, draws: usize, random: &mut Stream) {
        let mean = dirichlet.mean();
        self.order.clear();
        self.proposal.clear();
        self.order.extend(
            (0..mean.len()).filter(|&value| !Urn::is_tail(mean, value)).map(|value| (value as u8, mean[value])),
        );
        let tail = || (0..mean.len()).filter(|&value| Urn::is_tail(mean, value));
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

    /// Which of the values stands for the tail, if there is one.
    pub fn stand_in(&self) -> Option<usize> {
        self.stand_in.map(usize::from)
    }

    /// Whether a value belongs to the tail of the distribution with these expected probabilities.
    pub fn is_tail(mean: &[f64], value: usize) -> bool {
        mean.len() > MANY && mean[value] < TAIL
    }

    /// The value at this point of the cumulated mean, 0 to 1.
    #[inline]
    fn value_at(&self, point: f64) -> u8 {
        let reached = self.order.iter().find(|(_, sum)| point < *sum);
        reached.or(self.order.last()).map_or(0, |(value, _)| *value)
    }

    /// A draw from the mean.
    #[inline]
    pub fn draw(&self, random: &mut Stream) -> u8 {
        self.value_at(random.random::<f64>())
    }

    /// Lets first draws come from the mean and, with probability `share`, evenly from all values: rare ones are drawn more
    /// often then, and count the less. By value, how much a draw counts.
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

    /// First draws for many urns, each value as often as its mean (or [`Urn::spread`]) says, to a draw, in random order.
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

    /// The draws that follow the first one, as many as there is room for with it. True if all are the same; what `drawn`
    /// holds means nothing then.
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

    /// The next draw after this one that repeats none before it.
    #[inline]
    fn next_new(&self, random: &mut Stream, after: usize) -> usize {
        let limit = random.random::<f64>() * self.stays[after];
        if self.stays[self.stays.len() - 1] > limit {
            return self.stays.len();
        }
        (after + 1..self.stays.len()).find(|&draw| self.stays[draw] <= limit).unwrap_or(self.stays.len())
    }
}
