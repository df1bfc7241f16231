//! Draws of beliefs and worlds: Polya urns, Dirichlets, and the distinct ones among the drawn worlds.
//!
//! A Polya urn draws from a categorical distribution that is itself a draw from a Dirichlet, without drawing that
//! distribution. The first draw follows the Dirichlet's mean; the n-th draw repeats one of the previous draws with the
//! probability (n - 1) / (A + n - 1). Given the draws, the distribution is Dir(alpha + counts) (Blackwell and MacQueen
//! 1973).

use rand::RngExt;
use rand_distr::{Distribution, Gamma};

use crate::base::rng::{Stream, shuffle};
use crate::kitchen::cost_to_go::{CostToGo, Fidelity, MAX_BUTTONS};
use crate::kitchen::{Agent, World};
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
    pub(crate) fn stand_in(&self) -> Option<usize> {
        self.stand_in.map(usize::from)
    }

    /// Whether a value belongs to the tail of a distribution with these expected probabilities.
    pub(crate) fn is_tail(mean: &[f64], value: usize) -> bool {
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
    pub(crate) fn first_draws(&self, random: &mut Stream, out: &mut [u8]) {
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
        shuffle(out, random);
    }

    /// Fills `drawn` with the draws that follow the first one. Returns true if all draws are equal; then the content of
    /// `drawn` is undefined.
    #[inline]
    pub(crate) fn draw_on(&self, random: &mut Stream, first: u8, drawn: &mut [u8]) -> bool {
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
pub(crate) fn value_at(distribution: &[f64], point: f64) -> u8 {
    let mut left = point;
    let reached = distribution.iter().position(|p| {
        left -= p;
        left < 0.0
    });
    reached.unwrap_or(distribution.len() - 1) as u8
}

/// Sampler of one Dirichlet. Gamma variates are drawn as logarithms (Gamma(a) = Gamma(a + 1) U^(1/a); Marsaglia and
/// Tsang 2000), since variates with small alphas would underflow.
pub struct DirichletSampler {
    of: Vec<(Option<Gamma<f64>>, f64)>,
}

impl DirichletSampler {
    /// The sampler of the Dirichlet with these alphas, all above 0.
    pub fn new(alphas: &[f64]) -> DirichletSampler {
        DirichletSampler { of: alphas.iter().map(|&alpha| (Gamma::new(alpha + 1.0, 1.0).ok(), alpha)).collect() }
    }

    /// Fills `out` with a draw from the Dirichlet.
    pub fn draw(&self, random: &mut Stream, out: &mut [f64]) {
        let mut most = f64::NEG_INFINITY;
        for (log, (gamma, alpha)) in out.iter_mut().zip(&self.of) {
            let gamma = gamma.map_or(1.0, |gamma| gamma.sample(random));
            *log = gamma.ln() + (1.0 - random.random::<f64>()).ln() / alpha;
            most = most.max(*log);
        }
        let mut total = 0.0;
        for p in out.iter_mut() {
            *p = (*p - most).exp();
            total += *p;
        }
        out.iter_mut().for_each(|p| *p /= total);
    }
}

/// The draws of one belief sample that give the same world: index of the first draw, and number of draws.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub(super) world: u32,
    pub(super) first: u32,
    pub(super) draws: u32,
}

/// The values of up to 32 aspects, one byte each.
type Key = [u64; 4];
/// Number of values in one of the four parts of a key.
const KEY_PART: usize = (u64::BITS / u8::BITS) as usize;

/// The equal draws of one belief sample: their values, the index of the first draw, and the number of draws.
#[derive(Clone, Copy, Debug)]
pub(super) struct Alike {
    key: Key,
    pub(super) first: usize,
    pub(super) draws: u32,
}

#[derive(Clone, Debug, Default)]
pub(super) struct DistinctDraws {
    pub(super) groups: Vec<Alike>,
    /// The values of the aspects with several values in the belief sample, by draw.
    keys: Vec<Key>,
}

impl DistinctDraws {
    /// Groups `states` draws by equality of their values; `rows` has a row of values for each aspect of which there are
    /// several.
    pub(super) fn tell_apart(&mut self, states: usize, rows: &[u8]) {
        self.groups.clear();
        if rows.is_empty() {
            return self.groups.push(Alike { key: Key::default(), first: 0, draws: states as u32 });
        }
        self.keys.clear();
        self.keys.resize(states, Key::default());
        for (index, row) in rows.chunks_exact(states).enumerate() {
            for (key, &value) in self.keys.iter_mut().zip(row) {
                let part = &mut key[index / KEY_PART];
                *part = *part << u8::BITS | u64::from(value);
            }
        }
        for (first, &key) in self.keys.iter().enumerate() {
            match self.groups.iter_mut().find(|alike| alike.key == key) {
                Some(alike) => alike.draws += 1,
                None => self.groups.push(Alike { key, first, draws: 1 }),
            }
        }
    }
}

/// A world's costs to go are computed with [`Fidelity::PlanBound`] if the world has at least this share of all draws,
/// or of the posterior weight; else with [`Fidelity::LowerBound`].
const COUNTS: f64 = 0.01;

/// Number of worlds by which prefetching from memory is ahead of the computation.
const AHEAD: usize = 4;

/// Distinct worlds with the number of draws of each.
#[derive(Clone, Debug, Default)]
pub struct DistinctWorlds {
    known: Vec<RatedWorld>,
    /// Hash table with open addressing: index + 1 of a world, 0 for a free slot.
    slots: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct RatedWorld {
    world: World,
    draws: u32,
    /// Costs to go of the decision in the world; `None` until the costs are computed.
    costs: Option<WorldCosts>,
}

/// The costs to go of the human's decision in one world.
#[derive(Clone, Copy, Debug)]
struct WorldCosts {
    after: [u8; MAX_BUTTONS],
    fidelity: Fidelity,
}

impl DistinctWorlds {
    /// Removes all worlds and reserves hash slots for `draws` draws.
    pub fn clear(&mut self, draws: usize) {
        self.known.clear();
        self.slots.clear();
        self.slots.resize((draws * 2).next_power_of_two(), 0);
    }

    /// Adds `times` draws of a world and returns the world's index.
    #[inline]
    pub fn count(&mut self, world: World, times: u32) -> u32 {
        let mask = self.slots.len() - 1;
        let mut slot = world.folded() as usize & mask;
        loop {
            match self.slots[slot] {
                0 => {
                    self.known.push(RatedWorld { world, draws: times, costs: None });
                    self.slots[slot] = self.known.len() as u32;
                    return self.known.len() as u32 - 1;
                }
                index => {
                    let known = &mut self.known[index as usize - 1];
                    if known.world == world {
                        known.draws += times;
                        return index - 1;
                    }
                }
            }
            slot = (slot + 1) & mask;
        }
    }

    /// Computes the costs to go of all worlds for which they are missing; `draws` is the total number of draws.
    pub fn rate(&mut self, cost: &mut CostToGo, draws: usize) {
        let fidelity = |rated: &RatedWorld| {
            if f64::from(rated.draws) >= COUNTS * draws as f64 { Fidelity::PlanBound } else { Fidelity::LowerBound }
        };
        for index in 0..self.known.len() {
            if let Some(later) = self.known.get(index + AHEAD).filter(|later| later.costs.is_none()) {
                cost.prefetch(fidelity(later), later.world.state, &later.world.recipes, Agent::Human);
            }
            let rated = &mut self.known[index];
            if rated.costs.is_none() {
                rated.rate(cost, fidelity(rated));
            }
        }
    }

    /// Recomputes costs with [`Fidelity::PlanBound`] for worlds that have lower bounds only and whose posterior weight
    /// (`weights` by world, with total `sum`) is now relevant: a lower bound that is one press too low would be strong
    /// but wrong evidence. Returns whether there were such worlds.
    pub(crate) fn rate_again(&mut self, cost: &mut CostToGo, weights: &[f64], sum: f64) -> bool {
        let mut any = false;
        for (rated, &weight) in self.known.iter_mut().zip(weights) {
            if weight >= COUNTS * sum && rated.costs.is_some_and(|costs| costs.fidelity == Fidelity::LowerBound) {
                rated.rate(cost, Fidelity::PlanBound);
                any = true;
            }
        }
        any
    }

    /// Number of distinct worlds among the draws.
    pub(crate) fn len(&self) -> usize {
        self.known.len()
    }

    /// Cost to go after each button of the human in a world whose costs have been computed.
    #[inline]
    pub fn after(&self, index: u32) -> &[u8; MAX_BUTTONS] {
        const UNKNOWN: [u8; MAX_BUTTONS] = [0; MAX_BUTTONS];
        self.known[index as usize].costs.as_ref().map_or(&UNKNOWN, |costs| &costs.after)
    }
}

impl RatedWorld {
    fn rate(&mut self, cost: &mut CostToGo, fidelity: Fidelity) {
        let decision = cost.decision_with(fidelity, self.world.state, &self.world.recipes, Agent::Human);
        self.costs = Some(WorldCosts { after: decision.after, fidelity });
    }
}
